//! The builders that a command line asks for: by name, with some fields changed, or by a file with a configuration.

mod config_file;

pub use config_file::ConfigFile;

use crate::bench::cell::Cell;
use crate::bench::contender;
use crate::bench::error::PlanError;
use crate::builders::{Recipe, RecipeError, on_request};
use std::path::Path;

/// Where builders of other crates are.
const PEERS: &str = if cfg!(feature = "peers") {
    ""
} else {
    "; those of other crates with `cargo build --release --features peers`"
};

/// The builders asked for.
#[derive(Clone, Debug, Default)]
pub struct Chosen {
    /// Builders of the lists.
    names: Vec<String>,
    /// Others: their names, what they are, and the width where a file tells it.
    made: Vec<(String, Recipe, Option<u32>)>,
}

impl Chosen {
    /// The builders of `--builder`, `--set` and `--config`. The changes of one builder are of one changed builder,
    /// which stands beside the others.
    ///
    /// # Errors
    /// A builder or field that does not exist, a value that cannot be, a file that cannot be used.
    pub fn new(names: &[String], changes: &[String], files: &[impl AsRef<Path>]) -> Result<Self, PlanError> {
        let mut chosen = Self::default();
        for name in names {
            if let Some((builder, width)) = with_width(name) {
                let (name, builder) = (name.clone(), builder.into());
                return Err(PlanError::WidthInName { name, builder, width });
            }
            if name.contains('[') {
                let recipe = Recipe::parse(name)?;
                chosen.add(recipe.name(), recipe, None)?;
            } else {
                chosen.names.push(name.clone());
            }
        }
        let mut changed: Vec<Recipe> = Vec::new();
        for change in changes {
            let malformed = || RecipeError::Malformed(change.clone());
            let (base, change) = change.split_once('.').ok_or_else(malformed)?;
            match changed.iter_mut().find(|recipe| recipe.base() == base) {
                Some(recipe) => recipe.set_text(change)?,
                None => {
                    let mut recipe = Recipe::of(base)?;
                    recipe.set_text(change)?;
                    changed.push(recipe);
                }
            }
        }
        for recipe in changed {
            chosen.add(recipe.name(), recipe, None)?;
        }
        for file in files {
            let file = ConfigFile::read(file.as_ref())?;
            chosen.add(file.name.clone(), file.recipe()?, file.width)?;
        }
        Ok(chosen)
    }

    fn add(&mut self, name: String, recipe: Recipe, width: Option<u32>) -> Result<(), PlanError> {
        if self.made.iter().any(|(known, ..)| *known == name) {
            return Err(PlanError::SameBuilder(name));
        }
        self.made.push((name, recipe, width));
        Ok(())
    }

    /// True where nothing was asked for.
    pub fn is_empty(&self) -> bool {
        self.names.is_empty() && self.made.is_empty()
    }

    /// Adds a builder by name unless some were asked for.
    pub fn or(mut self, name: &str) -> Self {
        if self.is_empty() {
            self.names.push(name.into());
        }
        self
    }

    /// Adds builders by name where some were asked for; else they are among all.
    pub fn and(mut self, names: impl IntoIterator<Item = String>) -> Self {
        if !self.is_empty() {
            self.names.extend(names);
        }
        self
    }

    /// The cells of these builders, in the table's order; where none was asked for, of all that stand in tables.
    ///
    /// # Errors
    /// No such builder.
    pub fn cells(&self, build_only: bool) -> Result<Vec<Cell>, PlanError> {
        let mut cells = contender::cells(build_only);
        if let Some(name) = self.names.iter().find(|name| !cells.iter().any(|cell| cell.builder == **name)) {
            let is_in_tables = |name: &&str| !on_request().any(|known| known == *name);
            let mut known: Vec<&str> =
                cells.iter().map(|cell| cell.builder.as_str()).filter(is_in_tables).collect();
            known.dedup();
            let known = format!("{}, and variants of ours{}", known.join(", "), PEERS);
            return Err(PlanError::NoSuchBuilder { name: name.clone(), known });
        }
        cells.retain(|cell| {
            if self.is_empty() {
                !on_request().any(|name| name == cell.builder)
            } else {
                self.names.contains(&cell.builder)
            }
        });
        for (name, recipe, width) in &self.made {
            let both = contender::cells_of(name, recipe, build_only);
            cells.extend(both.into_iter().filter(|cell| width.is_none_or(|width| cell.width == width)));
        }
        cells.sort_by(|a, b| a.order().cmp(&b.order()));
        Ok(cells)
    }

    /// The one cell of each builder: of `width`, or its smallest.
    ///
    /// # Errors
    /// No such builder, or none of that width.
    pub fn single_cells(&self, width: Option<u32>) -> Result<Vec<Cell>, PlanError> {
        let mut left = self.cells(false)?;
        let mut found = Vec::new();
        if let Some(width) = width {
            self.check_width(&left, width)?;
        }
        while let Some(first) = left.first().cloned() {
            let (of_builder, others): (Vec<_>, Vec<_>) =
                left.into_iter().partition(|cell| cell.builder == first.builder);
            left = others;
            let fits = |cell: &Cell| width.is_none_or(|width| cell.width == width);
            found.extend(of_builder.into_iter().find(fits));
        }
        Ok(found)
    }

    /// Checks that each builder of `cells` has one of `width`.
    ///
    /// # Errors
    /// The first that has none.
    pub fn check_width(&self, cells: &[Cell], width: u32) -> Result<(), PlanError> {
        let of_builder = |builder: &str| -> Vec<u32> {
            cells.iter().filter(|cell| cell.builder == builder).map(|cell| cell.width).collect()
        };
        let lacks = |cell: &&Cell| !of_builder(&cell.builder).contains(&width);
        cells.iter().find(lacks).map_or(Ok(()), |Cell { builder, .. }| {
            let widths: Vec<String> = of_builder(builder).iter().map(u32::to_string).collect();
            Err(PlanError::NoSuchWidth { builder: builder.clone(), width, widths: widths.join(" and ") })
        })
    }
}

/// The builder and the width of a name as tables have it: `phr-speed / 8`.
fn with_width(name: &str) -> Option<(&str, u32)> {
    let (builder, width) = name.rsplit_once('/')?;
    let (builder, width) = (builder.trim(), width.trim().parse().ok()?);
    let is_known =
        Recipe::parse(builder).is_ok() || contender::cells(true).iter().any(|cell| cell.builder == builder);
    is_known.then_some((builder, width))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn strings(of: &[&str]) -> Vec<String> {
        of.iter().map(ToString::to_string).collect()
    }

    fn chosen(names: &[&str], changes: &[&str]) -> Result<Vec<String>, PlanError> {
        let none: [&Path; 0] = [];
        let cells = Chosen::new(&strings(names), &strings(changes), &none)?.cells(false)?;
        Ok(cells.iter().map(|cell| format!("{}/{}", cell.builder, cell.width)).collect())
    }

    #[test]
    fn changed_builders_stand_beside_the_named_ones() {
        let both = ["phr-hq/4", "phr-hq/8", "phr-hq[delta=8+max_cut=64]/4", "phr-hq[delta=8+max_cut=64]/8"];
        let mut found = chosen(&["phr-hq"], &["phr-hq.delta=8", "phr-hq.max_cut=64"]).unwrap();
        found.sort();
        assert_eq!(found, both);
        let found = chosen(&["phr-hq[delta=8]", "phr-hq[delta=7]"], &[]).unwrap();
        assert_eq!(found.len(), 4);
        assert_eq!(chosen(&[], &["lbvh"]).unwrap_err().to_string().lines().count(), 1);
        assert!(chosen(&["phr"], &[]).unwrap_err().to_string().contains("no builder is called phr;"));
        assert!(matches!(
            chosen(&["phr-hq[delta=8]"], &["phr-hq.delta=8.0"]),
            Err(PlanError::SameBuilder(_))
        ));
    }

    #[test]
    fn a_width_in_a_name_has_a_remedy() {
        for (name, remedy) in [
            ("phr-speed/8", "--builder phr-speed --width 8"),
            ("phr-speed / 4", "--builder phr-speed --width 4"),
            ("phr-hq[delta=8] / 8", "--builder phr-hq[delta=8] --width 8"),
        ] {
            let told = chosen(&[name], &[]).unwrap_err().to_string();
            assert!(told.contains(&format!("no builder is called {name}; give {remedy}")), "{told}");
        }
        for name in ["phr/8", "phr-speed/wide"] {
            let told = chosen(&[name], &[]).unwrap_err().to_string();
            assert!(told.contains(&format!("no builder is called {name}; there are ")), "{told}");
        }
    }

    #[test]
    fn a_file_makes_a_builder_of_its_name() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mine.json");
        let cells = |text: &str| {
            std::fs::write(&path, text).unwrap();
            Chosen::new(&[], &[], &[&path])?.cells(true)
        };
        let found =
            cells(r#"{"name": "mine", "base": "phr-hq", "fields": {"delta": 8, "presplit": null}}"#).unwrap();
        assert_eq!(found.iter().map(|cell| cell.width).collect::<Vec<_>>(), [4, 8]);
        assert!(found.iter().all(|cell| cell.builder == "mine"));
        assert_eq!(found[0].made_by(), "phr-hq[delta=8+presplit=none]");
        let found = cells(r#"{"name": "mine", "base": "phr-best", "width": 8}"#).unwrap();
        assert_eq!((found.len(), found[0].width, found[0].made_by()), (1, 8, "phr-best"));
        for (text, reason) in [
            (r#"{"name": "phr-hq", "base": "phr-fast"}"#, "name"),
            (r#"{"name": "embree-x", "base": "phr-fast"}"#, "name"),
            (r#"{"name": "a b", "base": "phr-fast"}"#, "name"),
            (r#"{"name": "mine", "base": "phr"}"#, "no builder of ours is called phr"),
            (r#"{"name": "mine", "base": "phr-hq", "fields": {"delta": "x"}}"#, "phr-hq.delta=x"),
            (r#"{"name": "mine", "base": "phr-hq", "width": 6}"#, "width"),
            (r#"{"name": "mine", "base": "phr-hq", "field": {}}"#, "unknown field"),
            ("nonsense", "expected"),
        ] {
            let error = cells(text).unwrap_err().to_string();
            assert!(error.contains("mine.json: ") && error.contains(reason), "{text}: {error}");
            assert_eq!(error.lines().count(), 1, "{error}");
        }
    }
}
