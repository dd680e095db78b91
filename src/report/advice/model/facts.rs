//! Facts of a mesh that tell how it is built and traced: its size, and what the tree of `lbvh` over it costs and
//! overlaps, which takes milliseconds to build and stands in the rows of any run.

use crate::bench::row::Row;
use crate::builders;
use crate::bvh::{Statistics, sah_cost};
use crate::geometry::Mesh;
use serde::{Deserialize, Serialize};

/// The builder whose tree tells.
pub const BUILDER: &str = "lbvh";

/// A fact of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Fact {
    /// Number of triangles.
    Triangles,
    /// SAH cost of the tree.
    Sah,
    /// End-point overlap of the tree.
    Epo,
    /// Used lanes of its leaf blocks.
    LeafFill,
}

impl Fact {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Triangles, Self::Sah, Self::Epo, Self::LeafFill];

    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Triangles => "triangles",
            Self::Sah => "SAH cost",
            Self::Epo => "overlap",
            Self::LeafFill => "leaf fill",
        }
    }
}

/// The facts of a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SceneFacts {
    /// Number of triangles.
    pub triangles: f64,
    /// SAH cost of the 4-wide tree of [`BUILDER`].
    pub sah: f64,
    /// Its end-point overlap.
    pub epo: f64,
    /// Used lanes of its leaf blocks, 0 to 1.
    pub leaf_fill: f64,
}

impl SceneFacts {
    /// Of a mesh, on the current rayon pool; only the `needed` ones are found, the others 1.
    pub fn of(mesh: &Mesh, needed: &[Fact]) -> Self {
        let triangles = mesh.len() as f64;
        let nothing = Self { triangles, sah: 1.0, epo: 1.0, leaf_fill: 1.0 };
        if needed.iter().all(|fact| *fact == Fact::Triangles) {
            return nothing;
        }
        let mut builder = builders::by_name::<4>(BUILDER).expect("a name of the list");
        let tree = builder.build(mesh).tree;
        if needed.iter().all(|fact| [Fact::Triangles, Fact::Sah].contains(fact)) {
            // Overlaps take longer than the build.
            return Self { sah: sah_cost(&tree), ..nothing };
        }
        let statistics = Statistics::of(&tree, mesh);
        Self { triangles, sah: statistics.sah, epo: statistics.epo, leaf_fill: statistics.leaf_fill }
    }

    /// From a row of [`BUILDER`]; `None` where it lacks one.
    pub fn of_row(row: &Row) -> Option<Self> {
        Some(Self {
            triangles: row.triangles as f64,
            sah: row.sah?,
            epo: row.epo?,
            leaf_fill: row.leaf_fill?,
        })
    }

    /// The logarithm of a fact; a tree without overlap has a very small one.
    pub fn log(&self, fact: Fact) -> f64 {
        let value = match fact {
            Fact::Triangles => self.triangles,
            Fact::Sah => self.sah,
            Fact::Epo => self.epo,
            Fact::LeafFill => self.leaf_fill,
        };
        value.max(1e-2).ln()
    }
}
