//! What a run consists of: scenes, cells (a builder at a width) with their kernels, and settings.
//! Everything that can be wrong with a request is found here, before anything is timed or written.

#![cfg_attr(not(test), warn(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

pub mod chosen;
pub mod planned_scene;
pub mod settings;
pub mod shard;

use super::cell::{Cell, Kernel};
use super::error::PlanError;
use crate::scene;
use crate::trace::scale::check_size;
use chosen::Chosen;
use planned_scene::{PlannedScene, Source};
use regex::Regex;
use serde::{Deserialize, Serialize};
use settings::Settings;
use shard::Shard;
use std::path::{Path, PathBuf};

/// Named sets of scenes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Set {
    /// Small generated scenes that need no download.
    Builtin,
    /// The paper's nine, or stand-ins for them.
    Paper,
}

/// The request for a run, not checked yet.
#[derive(Clone, Debug)]
pub struct Request {
    /// Files and generators by name.
    pub scenes: Vec<String>,
    /// A set of scenes.
    pub set: Option<Set>,
    /// Folder with the paper's own scene files.
    pub folder: Option<PathBuf>,
    /// The builders.
    pub builders: Chosen,
    /// Children per node of the trees; any if not given.
    pub width: Option<u32>,
    /// Only what matches "scene builder width kernel".
    pub filter: Option<Regex>,
    /// Only this part of the scenes.
    pub shard: Option<Shard>,
    /// The settings.
    pub settings: Settings,
}

/// A checked request: the scenes and cells to run.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The scenes, in order, with their cells.
    pub scenes: Vec<(PlannedScene, Vec<Cell>)>,
    /// Which part of the run this is; all of it if none.
    pub shard: Option<Shard>,
    /// Names of the scenes of all shards.
    pub all_scenes: Vec<String>,
    /// The cells of all scenes and shards, of which each scene has those that pass the filter.
    pub all_cells: Vec<Cell>,
    /// The filter.
    pub filter: Option<String>,
    /// The settings.
    pub settings: Settings,
}

impl Plan {
    /// Checks a request.
    ///
    /// # Errors
    /// The first fault found.
    pub fn new(request: &Request) -> Result<Self, PlanError> {
        request.settings.check()?;
        let mut scenes = Vec::new();
        match request.set {
            Some(Set::Builtin) => scenes.extend(scene::builtin().iter().map(PlannedScene::generated)),
            Some(Set::Paper) => scenes.extend(paper_scenes(request.folder.as_deref())?),
            None => {}
        }
        for name in &request.scenes {
            scenes.push(PlannedScene::find(name)?);
        }
        PlannedScene::check_names(&scenes)?;
        let mut cells = request.builders.cells(request.settings.build_only)?;
        if let Some(width) = request.width {
            if !request.builders.is_empty() {
                request.builders.check_width(&cells, width)?;
            }
            cells.retain(|cell| cell.width == width);
        }
        let mut plan = Self {
            scenes: Vec::new(),
            shard: request.shard,
            all_scenes: Vec::new(),
            all_cells: cells.clone(),
            filter: request.filter.as_ref().map(ToString::to_string),
            settings: request.settings.clone(),
        };
        for scene in scenes {
            let left: Vec<Cell> = cells
                .iter()
                .filter_map(|cell| filtered(cell, &scene.name, request.filter.as_ref()))
                .collect();
            if !left.is_empty() {
                plan.scenes.push((scene, left));
            }
        }
        if plan.scenes.is_empty() {
            let filter = request.filter.as_ref().map(|filter| format!("--filter {filter}"));
            let width = request.width.map(|width| format!("--width {width}"));
            let options: Vec<String> = filter.into_iter().chain(width).collect();
            return Err(PlanError::NothingLeft(options.join(" ")));
        }
        plan.all_scenes = plan.scenes.iter().map(|(scene, _)| scene.name.clone()).collect();
        if let Some(shard) = plan.shard {
            let (scenes, most) = (std::mem::take(&mut plan.scenes), plan.all_scenes.len());
            let numbered = scenes.into_iter().enumerate();
            plan.scenes = numbered.filter(|&(index, _)| shard.has(index)).map(|(_, scene)| scene).collect();
            if plan.scenes.is_empty() {
                return Err(PlanError::EmptyShard { shard: shard.of, most });
            }
        }
        Ok(plan)
    }

    /// One line per "scene builder width kernel", what `--filter` is matched against.
    pub fn lines(&self) -> impl Iterator<Item = String> + '_ {
        self.scenes.iter().flat_map(|(scene, cells)| cells.iter().flat_map(|cell| cell.lines(&scene.name)))
    }

    /// Reads every scene file once, so that a broken one, or one that cannot be traced, is found before anything is
    /// timed, and each one's triangles and hash are known.
    ///
    /// # Errors
    /// The first such one's.
    pub fn check_files(&mut self) -> Result<(), PlanError> {
        for (scene, _) in &mut self.scenes {
            if matches!(scene.source, Source::File(_)) {
                let loaded = scene.load()?;
                if !self.settings.build_only {
                    let refused = |why| PlanError::Size { scene: scene.name.clone(), why };
                    check_size(&loaded.mesh).map_err(refused)?;
                }
                scene.triangles = loaded.mesh.len();
                scene.sha = Some(loaded.sha);
            }
        }
        Ok(())
    }
}

/// The cell with the kernels that pass the filter, or `None` if none does.
fn filtered(cell: &Cell, scene: &str, filter: Option<&Regex>) -> Option<Cell> {
    let Some(filter) = filter else { return Some(cell.clone()) };
    if cell.kernels.is_empty() {
        return cell.lines(scene).iter().any(|line| filter.is_match(line)).then(|| cell.clone());
    }
    let passes = |kernel: &Kernel| filter.is_match(&cell.line(scene, kernel.name()));
    let kernels: Vec<_> = cell.kernels.iter().copied().filter(passes).collect();
    (!kernels.is_empty()).then(|| Cell { kernels, ..cell.clone() })
}

/// The paper's nine: the file where `folder` holds one, else the stand-in.
fn paper_scenes(folder: Option<&Path>) -> Result<Vec<PlannedScene>, PlanError> {
    if let Some(folder) = folder.filter(|folder| !folder.is_dir()) {
        return Err(PlanError::NotAFolder(folder.to_owned()));
    }
    let original = |paper| Some(PlannedScene::file(&scene::paper_scene_in(folder?, paper)?));
    let stand_in = |paper: &scene::PaperScene| paper.stand_in().map(PlannedScene::generated);
    Ok(scene::paper().iter().filter_map(|paper| original(paper).or_else(|| stand_in(paper))).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn request(scenes: &[&str], filter: Option<&str>) -> Request {
        Request {
            scenes: scenes.iter().map(ToString::to_string).collect(),
            set: None,
            folder: None,
            builders: Chosen::default(),
            width: None,
            filter: filter.map(|filter| Regex::new(filter).unwrap()),
            shard: None,
            settings: Settings::new(8, 1, 1, 1),
        }
    }

    #[test]
    fn builds_on_one_thread_stand_beside_those_on_more() {
        let plan = |threads, build_only| {
            let request = request(&["scalable-2k"], None);
            let settings = Settings { threads, build_only, one_thread: true, ..request.settings.clone() };
            Plan::new(&Request { settings, ..request })
        };
        assert!(plan(2, true).is_ok());
        assert!(matches!(plan(1, true), Err(PlanError::OneThread(_))));
        assert!(matches!(plan(2, false), Err(PlanError::OneThread(_))));
    }

    #[test]
    fn filters_pick_scenes_builders_and_kernels() {
        let names: Vec<&str> = scene::builtin().iter().take(2).map(|generator| generator.name).collect();
        let lines = |filter: Option<&str>| match Plan::new(&request(&names, filter)) {
            Ok(plan) => plan.lines().collect(),
            Err(_) => Vec::new(),
        };
        let all = lines(None);
        assert!(
            all.len() >= 2 * crate::builders::NAMES.len()
                && all.iter().all(|line| line.split(' ').count() == 4)
        );
        let hq: Vec<String> = names.iter().map(|name| format!("{name} phr-hq 4 phr")).collect();
        assert_eq!(lines(Some("phr-hq 4 phr$")), hq);
        let of_one = format!("^{} .*phr-fast 4 phr", names[1]);
        assert_eq!(lines(Some(&of_one)).len(), 1);
        assert!(lines(Some("nothing")).is_empty());
    }

    #[test]
    fn scenes_of_any_size_are_found_by_name_once() {
        let scene = PlannedScene::find("scalable-2k").unwrap();
        assert_eq!((scene.triangles, scene.load().unwrap().mesh.len()), (2000, 2000));
        assert_eq!(scene.load().unwrap().name, scene.name);
        let twice = Plan::new(&request(&["scalable-1M", "scalable-1000k"], None));
        assert!(matches!(twice, Err(PlanError::SameName(name)) if name == "scalable-1M"));
        assert!(matches!(PlannedScene::find("scalable-2G"), Err(PlanError::NoSuchScene(_))));
    }

    #[test]
    fn the_papers_set_has_nine_scenes_and_prefers_originals() {
        let paper = |folder: Option<PathBuf>| {
            Plan::new(&Request { set: Some(Set::Paper), folder, ..request(&[], None) })
        };
        let plan = paper(None).unwrap();
        assert_eq!(plan.scenes.len(), 9);
        assert!(plan.scenes.iter().all(|(scene, _)| scene.name.ends_with("-like")));
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("Conference.obj"), "").unwrap();
        let plan = paper(Some(folder.path().to_owned())).unwrap();
        assert_eq!(plan.scenes[0].0.name, "Conference");
        assert!(matches!(plan.scenes[0].0.source, Source::File(_)));
        assert!(matches!(paper(Some("nowhere".into())), Err(PlanError::NotAFolder(_))));
    }
}
