//! Which of Embree's builders runs, at which width: the device string.
//!
//! `tri_accel` alone makes Embree ignore the scene's build quality and run its SAH builder, so the builder
//! is always named too. [`super::inspect()`] checks that the one named ran.

/// Embree's builders, as in the paper's Table 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
pub enum EmbreeBuilder {
    /// Morton codes with tree rotations, build quality LOW.
    Morton,
    /// Binned SAH, build quality MEDIUM.
    Sah,
    /// Binned SAH with spatial splits, build quality HIGH.
    FastSpatial,
}

impl EmbreeBuilder {
    /// All builders, fastest first.
    pub const ALL: [Self; 3] = [Self::Morton, Self::Sah, Self::FastSpatial];

    /// The name used in commands and records.
    pub fn name(self) -> &'static str {
        match self {
            Self::Morton => "embree-morton",
            Self::Sah => "embree-sah",
            Self::FastSpatial => "embree-fast-spatial",
        }
    }

    /// The builder called `name`.
    pub fn by_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|builder| builder.name() == name)
    }

    /// The value of `tri_builder`.
    pub(super) fn option(self) -> &'static str {
        match self {
            Self::Morton => "morton",
            Self::Sah => "sah",
            Self::FastSpatial => "sah_fast_spatial",
        }
    }
}

/// How many children an inner node has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Width {
    /// BVH4, as in the paper.
    Four,
    /// BVH8, the default on CPUs with AVX: the same builder over `bvh8.triangle4`.
    Eight,
}

impl Width {
    /// Both widths.
    pub const ALL: [Self; 2] = [Self::Four, Self::Eight];

    /// 4 or 8.
    pub fn lanes(self) -> usize {
        match self {
            Self::Four => 4,
            Self::Eight => 8,
        }
    }
}

/// Settings of a [`super::Device`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Config {
    /// The builder.
    pub builder: EmbreeBuilder,
    /// The branching factor.
    pub width: Width,
    /// Threads that build; 0 for as many as the machine has. Embree keeps one limit per process, the
    /// largest over the devices alive.
    pub threads: usize,
}

impl Config {
    /// The device string, e.g. `threads=2,tri_accel=bvh4.triangle4,tri_builder=sah`.
    pub fn device_string(&self) -> String {
        let (lanes, builder) = (self.width.lanes(), self.builder.option());
        format!("threads={},tri_accel=bvh{lanes}.triangle4,tri_builder={builder}", self.threads)
    }

    /// For leaves that hold whole triangles, which Embree's watertight kernels want. Embree knows no names of
    /// builders for them at width 8; without one it takes that of the scene's build quality, SAH.
    pub(super) fn robust_string(&self) -> String {
        format!("threads={},tri_accel=bvh{}.triangle4v", self.threads, self.width.lanes())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_find_their_builder() {
        for builder in EmbreeBuilder::ALL {
            assert_eq!(EmbreeBuilder::by_name(builder.name()), Some(builder));
        }
        assert_eq!(EmbreeBuilder::by_name("embree"), None);
    }
}
