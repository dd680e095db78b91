//! What tests of builders share: one random generator, triangle soups, random cuts.

use crate::builders::binary::node::Node;
use crate::geometry::{Aabb, Mesh};
use glam::{Vec3, Vec3A};
