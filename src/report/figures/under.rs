//! Under which kernel traces are compared: kernels are never mixed silently.

use crate::bench::row::Row;

/// Every tree in Embree's node layout under Embree's kernel.
pub const GRAFTED: &str = "embree-grafted";
/// Embree's trees as Embree built them, under its kernel.
pub const NATIVE: &str = "embree-native";
/// Our kernel.
pub const PHR: &str = "phr";
/// Each tree under the kernel of whoever built it.
pub const OWN: &str = "own";

/// Under which kernel traces are compared.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Under {
    /// All trees under one kernel, of this name.
    One(String),
    /// Embree's trees under [`NATIVE`], ours under [`PHR`]: tree and kernel are compared together.
    Own,
}

impl Under {
    /// The fairest choice: [`GRAFTED`] if the run has it, else each tree under its own kernel.
    pub fn best(rows: &[Row]) -> Self {
        if kernels(rows).iter().any(|kernel| kernel == GRAFTED) {
            Self::One(GRAFTED.into())
        } else {
            Self::Own
        }
    }

    /// The choice called `name`, if `rows` have figures for it.
    ///
    /// # Errors
    /// One line that lists the known names.
    pub fn by_name(name: &str, rows: &[Row]) -> Result<Self, String> {
        let known = kernels(rows);
        if name == OWN {
            Ok(Self::Own)
        } else if known.iter().any(|kernel| kernel == name) {
            Ok(Self::One(name.into()))
        } else {
            Err(format!(
                "--kernel {name}: no traces under it; there are {}",
                [&known[..], &[OWN.into()]].concat().join(", ")
            ))
        }
    }

    /// The name on the command line.
    pub fn name(&self) -> &str {
        match self {
            Self::One(kernel) => kernel,
            Self::Own => OWN,
        }
    }

    /// The kernel under which trees of `builder` are traced.
    pub fn kernel_of(&self, builder: &str) -> &str {
        match self {
            Self::One(kernel) => kernel,
            Self::Own if builder.starts_with("embree-") => NATIVE,
            Self::Own => PHR,
        }
    }

    /// Whether the traces of a row are among those compared.
    pub fn compares(&self, row: &Row) -> bool {
        row.kernel == self.kernel_of(&row.builder)
    }

    /// The choice in words, for a legend.
    pub fn about(&self) -> String {
        match self {
            Self::One(kernel) if kernel == GRAFTED => {
                "all trees in Embree's node layout under Embree's kernel (embree-grafted)".into()
            }
            Self::One(kernel) => format!("all trees under the kernel {kernel}"),
            Self::Own => {
                "Embree's trees under embree-native, ours under phr: tree and kernel together".into()
            }
        }
    }
}

/// Kernels with figures, the most comparable first.
pub fn kernels<'a>(rows: impl IntoIterator<Item = &'a Row>) -> Vec<String> {
    let order = |name: &str| [GRAFTED, NATIVE, PHR].iter().position(|known| *known == name).unwrap_or(3);
    let traced = rows.into_iter().filter(|row| row.is_good() && row.trace_ms_median.is_some());
    let mut names: Vec<String> = traced.map(|row| row.kernel.clone()).collect();
    names.sort_by(|a, b| (order(a), a).cmp(&(order(b), b)));
    names.dedup();
    names
}
