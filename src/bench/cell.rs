//! A cell of the table: a builder at a width, with the kernels that trace its tree.

use super::row::NO_KERNEL;
use serde::{Deserialize, Serialize};

/// The code that traces a tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kernel {
    /// Embree's kernel on Embree's own tree, in Embree's own memory.
    EmbreeNative,
    /// Embree's kernel on any tree, all trees in one memory layout.
    EmbreeGrafted,
    /// Our kernel.
    Phr,
}

impl Kernel {
    /// All kernels, in the table's order.
    pub const ALL: [Self; 3] = [Self::EmbreeNative, Self::EmbreeGrafted, Self::Phr];

    /// The name in records.
    pub fn name(self) -> &'static str {
        match self {
            Self::EmbreeNative => "embree-native",
            Self::EmbreeGrafted => "embree-grafted",
            Self::Phr => "phr",
        }
    }

    /// The kernel called `name`.
    pub fn by_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kernel| kernel.name() == name)
    }
}

/// A builder at a width.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Cell {
    /// The builder's name.
    pub builder: String,
    /// Children per node.
    pub width: u32,
    /// Kernels that trace its tree; none if only builds are timed.
    pub kernels: Vec<Kernel>,
    /// What the builder is, by the name of [`crate::builders::Recipe`], where its own name does not say: a
    /// configuration from a file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub recipe: Option<String>,
}

impl Cell {
    /// A builder of the registry or of Embree's at a width, traced by `kernels`.
    pub fn new(builder: &str, width: u32, kernels: &[Kernel]) -> Self {
        Self { builder: builder.into(), width, kernels: kernels.into(), recipe: None }
    }

    /// Its place among the cells of a table: builders in their order, changed ones after the builder they were, by
    /// width.
    pub fn order(&self) -> (usize, &str, u32) {
        let changes = self.builder.split_once('[').map_or("", |(_, changes)| changes);
        (place(&self.builder), changes, self.width)
    }

    /// The name by which the builder is made.
    pub fn made_by(&self) -> &str {
        self.recipe.as_deref().unwrap_or(&self.builder)
    }

    /// The text that `--filter` is matched against.
    pub fn line(&self, scene: &str, kernel: &str) -> String {
        format!("{scene} {} {} {kernel}", self.builder, self.width)
    }

    /// One line per kernel.
    pub fn lines(&self, scene: &str) -> Vec<String> {
        if self.kernels.is_empty() {
            return vec![self.line(scene, NO_KERNEL)];
        }
        self.kernels.iter().map(|kernel| self.line(scene, kernel.name())).collect()
    }
}

/// The order of the table: the paper's, with our other builders beside their relatives.
pub const ORDER: [&str; 15] = [
    "lbvh",
    "embree-morton",
    "hunt-50",
    "aac",
    "ploc",
    "embree-sah",
    "hunt-500",
    "embree-fast-spatial",
    "phr-fast",
    "phr-hq",
    "phr-draft",
    "phr-turbo",
    "phr-speed",
    "phr-quality",
    "phr-best",
];

/// What the names of saved trees begin with. No builder's name does.
pub const SAVED: &str = "saved:";

/// Whether `builder` names a saved tree, which is loaded and not built.
pub fn is_saved(builder: &str) -> bool {
    builder.starts_with(SAVED)
}

/// A builder's place in the table, a changed one's that of the builder it was; builders not in [`ORDER`] come last.
pub fn place(builder: &str) -> usize {
    let builder = builder.split('[').next().unwrap_or_default();
    ORDER.iter().position(|name| *name == builder).unwrap_or(ORDER.len())
}
