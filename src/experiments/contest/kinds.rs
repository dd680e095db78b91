//! Kinds of scenes of which the paper speaks, among the shared and the generated ones.

use super::experiment::Among;

/// Single smooth surfaces of triangles of about one size: the paper's scenes of simple structure.
pub const SCANS: Among = Among::Kind(&["statue", "bunny_144k", "igea", "brain_icbm152", "buddha-like"]);

/// Buildings with what stands in them, of triangles of many sizes.
pub const BUILDINGS: Among = Among::Kind(&[
    "bodo_arch",
    "bodo_mep",
    "campus_vianen",
    "clinic",
    "dream_apartment",
    "duplex",
    "house_bitterli",
    "karhumaki_bridge",
    "kitchen_bitterli",
    "sanmiguel_partial",
]);

/// Large ones.
pub const LARGE: Among = Among::From(1_000_000);
