//! A scene of a plan: a file or a generator, found by its name and loaded when its turn comes.

use crate::bench::error::PlanError;
use crate::scene::{self, Limits, Scene, SceneError};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// What scene files may take in this process, where that was said.
static LIMITS: OnceLock<Limits> = OnceLock::new();

/// Limits the scene files of this process, once; without, they may take what the machine has.
pub fn limit(limits: Limits) {
    LIMITS.get_or_init(|| limits);
}

/// Where a scene comes from.
#[derive(Clone, Debug)]
pub enum Source {
    /// A file.
    File(PathBuf),
    /// A generator, by name.
    Generated(&'static str),
    /// The generated scene of any size, by its triangles.
    Scalable(usize),
}

/// Seed of the scenes of any size; fixed, so that the name determines the scene.
const SCALABLE_SEED: u64 = 1;

/// A scene to be run.
#[derive(Clone, Debug)]
pub struct PlannedScene {
    /// Name in the records.
    pub name: String,
    /// Where it comes from.
    pub source: Source,
    /// Triangles, the progress bar's weight; of a file an estimate until [`super::Plan::check_files`].
    pub triangles: usize,
    /// Hash of the geometry, of a file since [`super::Plan::check_files`].
    pub sha: Option<String>,
}

/// `name` as records and tables can hold it: `_` for control characters and for what divides the cells of Markdown, and
/// before what a spreadsheet takes for a formula, or where nothing is left.
pub fn plain_name(name: &str) -> String {
    let is_plain = |c: char| !c.is_control() && !matches!(c, '|' | '`' | '<' | '>' | '\u{2028}' | '\u{2029}');
    let name: String = name.chars().map(|c| if is_plain(c) { c } else { '_' }).collect();
    let needs_more = name.trim().is_empty() || name.starts_with(['=', '+', '-', '@']);
    if needs_more { format!("_{name}") } else { name }
}

impl PlannedScene {
    /// The scenes called `names` on a command line, see [`PlannedScene::find`], no two of one name.
    ///
    /// # Errors
    /// Of the first that cannot be found; those of [`PlannedScene::check_names`].
    pub fn find_all(names: &[String]) -> Result<Vec<Self>, PlanError> {
        let scenes = names.iter().map(|name| Self::find(name)).collect::<Result<Vec<_>, _>>()?;
        Self::check_names(&scenes)?;
        Ok(scenes)
    }

    /// Refuses scenes of which tables could not tell two apart.
    ///
    /// # Errors
    /// The name that two have.
    pub fn check_names(scenes: &[Self]) -> Result<(), PlanError> {
        for (i, scene) in scenes.iter().enumerate() {
            if scenes.iter().take(i).any(|other| other.name == scene.name) {
                return Err(PlanError::SameName(scene.name.clone()));
            }
        }
        Ok(())
    }

    /// The scene called `name` on a command line: a file if there is one, else a generator's.
    ///
    /// # Errors
    /// Neither exists, or the path is a folder.
    pub fn find(name: &str) -> Result<Self, PlanError> {
        let path = Path::new(name);
        if let Some(generator) = scene::generator(name).filter(|_| !path.is_file()) {
            return Ok(Self::generated(generator));
        }
        if let Some(triangles) = scene::scalable_triangles(name).filter(|_| !path.is_file()) {
            let name = scene::scalable_name(triangles);
            return Ok(Self { name, source: Source::Scalable(triangles), triangles, sha: None });
        }
        if path.is_dir() {
            return Err(PlanError::Directory(path.to_owned()));
        }
        if !path.exists() {
            return Err(PlanError::NoSuchScene(name.into()));
        }
        Ok(Self::file(path))
    }

    pub(super) fn generated(generator: &'static scene::Generator) -> Self {
        let name = generator.name;
        let triangles = generator.triangles;
        Self { name: name.into(), source: Source::Generated(name), triangles, sha: None }
    }

    pub(super) fn file(path: &Path) -> Self {
        // A triangle takes some six bytes compressed, thirty plain; this only weighs the progress bar.
        let compressed = path.extension().is_some_and(|ending| ending == "gz" || ending == "zst");
        let bytes = path.metadata().map_or(0, |metadata| metadata.len() as usize);
        let file = path.file_name().unwrap_or_default().to_string_lossy();
        let stem = scene::stem(path).unwrap_or_else(|| file.split('.').next().unwrap_or_default().into());
        let name = plain_name(&stem);
        let triangles = bytes / if compressed { 6 } else { 30 };
        Self { name, source: Source::File(path.to_owned()), triangles, sha: None }
    }

    /// Where it comes from, without folders.
    pub fn origin(&self) -> String {
        match &self.source {
            Source::File(path) => format!("file {}", path.file_name().unwrap_or_default().to_string_lossy()),
            Source::Generated(name) => format!("generated: {name}"),
            Source::Scalable(_) => format!("generated: {}", self.name),
        }
    }

    /// Loads or generates it, under its name in the records.
    ///
    /// # Errors
    /// Those of [`scene::load_within`].
    pub fn load(&self) -> Result<Scene, SceneError> {
        let scene = match &self.source {
            Source::File(path) => scene::load_within(path, LIMITS.get().unwrap_or(&Limits::of_machine()))?,
            // It was found when the plan was made.
            Source::Generated(name) => scene::generator(name)
                .map(scene::Generator::generate)
                .ok_or_else(|| SceneError::UnknownFormat(name.into()))?,
            Source::Scalable(triangles) => scene::scalable(*triangles, SCALABLE_SEED),
        };
        Ok(Scene { name: self.name.clone(), ..scene })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scene_is_loaded_under_its_plain_name() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("=a|b.obj");
        std::fs::write(&path, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
        assert_eq!(PlannedScene::file(&path).load().unwrap().name, "_=a_b");
    }

    #[test]
    fn names_break_no_table() {
        for (name, plain) in [
            ("=cmd()", "_=cmd()"),
            ("a|b", "a_b"),
            ("two\nlines", "two_lines"),
            ("-x", "_-x"),
            ("", "_"),
            (" ", "_ "),
            ("San Miguel-2", "San Miguel-2"),
            ("San.Miguel", "San.Miguel"),
            ("Häuser", "Häuser"),
        ] {
            assert_eq!(plain_name(name), plain);
            assert_eq!(PlannedScene::file(Path::new(&format!("{name}.ply"))).name, plain);
        }
    }
}
