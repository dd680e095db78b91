//! What takes part: a builder, and how its tree follows the scene.

use crate::bench::cell::Cell;
use crate::builders::Recipe;
use serde::{Deserialize, Serialize};

/// How a tree follows a moving scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Update {
    /// It is built again, in the memory of the one before.
    #[default]
    Rebuild,
    /// It is built once; its boxes are fitted to each frame.
    Refit,
    /// The auxiliary tree is built once and fitted to each frame; its cuts are refined again.
    Refine,
    /// The auxiliary tree of the static part is kept, that of the rest built, and cuts of both are refined.
    Merge,
    /// The same, where the static part's tree is built by binned SAH.
    MergeSah,
}

impl Update {
    /// The name in records.
    pub fn name(self) -> &'static str {
        match self {
            Self::Rebuild => "rebuild",
            Self::Refit => "refit",
            Self::Refine => "refine",
            Self::Merge => "merge",
            Self::MergeSah => "merge-sah",
        }
    }
}

/// A contestant.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Entrant {
    /// The builder.
    pub builder: String,
    /// How its tree follows.
    pub update: Update,
    /// What the builder is, as in [`Cell`]; records have the name alone.
    pub recipe: Option<String>,
}

impl Entrant {
    /// `phr-speed, refine`.
    pub fn name(&self) -> String {
        format!("{}, {}", self.builder, self.update.name())
    }
}

/// The contestants of our builders in `cells`, and Embree's where this program has it; static parts are merged
/// where the scene has one.
///
/// # Errors
/// No such builder of ours.
pub fn entrants(cells: &[Cell], has_static_part: bool) -> Result<Vec<Entrant>, String> {
    let mut entrants = Vec::new();
    for cell in cells {
        let recipe = Recipe::parse(cell.made_by()).map_err(|error| error.to_string())?;
        let mut updates = vec![Update::Rebuild, Update::Refit];
        if recipe.phr().is_some() {
            updates.push(Update::Refine);
            if has_static_part {
                updates.extend([Update::Merge, Update::MergeSah]);
            }
        }
        let of = |update| Entrant { builder: cell.builder.clone(), update, recipe: cell.recipe.clone() };
        entrants.extend(updates.into_iter().map(of));
    }
    if cfg!(feature = "embree") {
        let of = |builder: &str, update| Entrant { builder: builder.into(), update, recipe: None };
        entrants.extend([
            of("embree-morton", Update::Rebuild),
            of("embree-sah", Update::Rebuild),
            of("embree-sah", Update::Refit),
        ]);
    }
    Ok(entrants)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn builders_take_part_in_all_they_can() {
        let updates = |builder: &str, has_static_part| {
            let all = entrants(&[Cell::new(builder, 4, &[])], has_static_part).unwrap();
            let own = all.into_iter().filter(|entrant| entrant.builder == builder);
            own.map(|entrant| entrant.update.name()).collect::<Vec<_>>()
        };
        assert_eq!(updates("lbvh", true), ["rebuild", "refit"]);
        assert_eq!(updates("phr-fast", false), ["rebuild", "refit", "refine"]);
        assert_eq!(updates("phr-hq[delta=8]", true), ["rebuild", "refit", "refine", "merge", "merge-sah"]);
        let others = [Cell::new("embree-sah", 4, &[])];
        assert!(entrants(&others, true).unwrap_err().contains("no builder of ours is called embree-sah"));
    }
}
