//! Where Embree 3.13.5 and 4.3.3 keep the tree of a committed scene, and how nodes and leaves lie in memory: both
//! alike.
//!
//! This is private to Embree: offsets are known for these versions on one platform. Everything read is therefore
//! checked against what the public API says about the same scene, and any disagreement makes the
//! instrument [`Unavailable`]. The head of Embree's object is read through `/proc/self/mem`, where a wrong
//! address is an error and not a crash; only a head that passes every check is followed by pointer.

#![allow(unsafe_code)]

use crate::embree::device::version_name;
use crate::embree::{Device, EmbreeScene};
use crate::geometry::Aabb;
use std::fmt;
use std::fs::File;
use std::os::unix::fs::FileExt;

/// The versions with this layout, of Debian 12 and 13, for which tests hold it: trees read cost what Embree prints,
/// and set back they have the very same hits.
const VERSIONS: [isize; 2] = [31305, 40303];
/// Offset of the pointer to the tree in a scene of triangles only.
const SCENE_TREE: u64 = 88;
/// Bytes of the tree's head, up to and with the root.
const HEAD: usize = 120;
/// Offset of the root in the head.
const ROOT: u64 = 112;

/// Why Embree's tree cannot be read or replaced.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("not available, because {why}")]
pub struct Unavailable {
    /// The reason, to follow "because".
    pub why: String,
}

impl Unavailable {
    pub(super) fn because<T>(why: impl fmt::Display) -> Result<T, Self> {
        Err(Self { why: why.to_string() })
    }
}

/// References to nodes: an address, whose low four bits tell leaves from inner nodes.
pub(super) mod reference {
    /// No child.
    pub const EMPTY: u64 = 8;
    const LOW: u64 = 15;

    /// A reference, unpacked.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Target {
        Empty,
        /// Address of a node.
        Inner(usize),
        /// Address and number of blocks.
        Leaf(usize, usize),
    }

    /// What `bits` refers to; `None` if they are no reference.
    pub fn get(bits: u64) -> Option<Target> {
        let address = (bits & !LOW) as usize;
        match bits & LOW {
            _ if bits == EMPTY => Some(Target::Empty),
            // Addresses of user space have 47 bits, and nothing lies in the first page.
            _ if !(4096..1 << 47).contains(&address) => None,
            0 => Some(Target::Inner(address)),
            low @ 9..=15 => Some(Target::Leaf(address, low as usize - 8)),
            _ => None,
        }
    }

    /// Refers to the inner node at `address`, a multiple of 16.
    pub fn inner(address: usize) -> u64 {
        address as u64
    }

    /// Refers to 1 to 7 blocks from `address`, a multiple of 16.
    pub fn leaf(address: usize, blocks: usize) -> u64 {
        address as u64 | (8 + blocks as u64)
    }
}

/// An inner node of a BVH4 or BVH8.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub(super) struct Node<const N: usize> {
    pub children: [u64; N],
    /// Lower and upper plane of x, then of y, then of z.
    pub planes: [[[f32; N]; 2]; 3],
}

/// A leaf block of four triangles.
#[derive(Clone, Copy)]
#[repr(C, align(16))]
pub(super) struct Triangle4 {
    pub v0: [[f32; 4]; 3],
    pub e1: [[f32; 4]; 3],
    pub e2: [[f32; 4]; 3],
    pub geometries: [u32; 4],
    pub prims: [u32; 4],
}

const _: () =
    assert!(size_of::<Node<4>>() == 128 && size_of::<Node<8>>() == 256 && size_of::<Triangle4>() == 176);

/// The head of Embree's tree object.
#[derive(Clone, Debug)]
struct Head {
    bounds: [f32; 16],
    kind: u32,
    device: u64,
    scene: u64,
    root: u64,
}

/// The same values from the public API.
struct Expected {
    lanes: usize,
    bounds: Aabb,
    device: u64,
    scene: u64,
}

/// The place of a scene's root reference, found and checked.
pub(super) struct RootSlot {
    place: *mut u64,
}

// SAFETY: a place in Embree's heap, bound to no thread. Through `&RootSlot` it is only read; writing takes
// `&mut`, and whoever holds that owns the scene.
unsafe impl Send for RootSlot {}
// SAFETY: as above.
unsafe impl Sync for RootSlot {}

impl RootSlot {
    /// Finds the root of the `N`-wide tree of `scene`, which holds at least one triangle.
    pub fn find<const N: usize>(scene: &EmbreeScene<'_>) -> Result<Self, Unavailable> {
        known(scene.device())?;
        // Other blocks would be read as something else; those of a watertight device are as long as ours.
        let options =
            scene.device().config().split(',').filter_map(|option| option.strip_prefix("tri_accel="));
        match options.collect::<Vec<_>>()[..] {
            ["bvh4.triangle4" | "bvh8.triangle4"] => {}
            ["bvh4.triangle4v" | "bvh8.triangle4v"] => {
                return Unavailable::because("the leaves of a watertight device hold whole triangles");
            }
            _ => return Unavailable::because("the leaves of this device may be of another form"),
        }
        let expected = Expected {
            lanes: N,
            bounds: scene.bounds(),
            device: scene.device().raw().expose_provenance() as u64,
            scene: scene.raw().expose_provenance() as u64,
        };
        let (address, head) = read_head(expected.scene).map_err(|why| Unavailable {
            why: format!("this process's memory could not be inspected ({why})"),
        })?;
        head.check(&expected)?;
        Ok(Self { place: std::ptr::with_exposed_provenance_mut((address + ROOT) as usize) })
    }

    /// The root reference.
    ///
    /// # Safety
    /// The scene whose root this is lives.
    pub unsafe fn get(&self) -> u64 {
        // SAFETY: `find` proved the place to be the root of the scene's tree: the head around it names the scene,
        // its device and its bounds. The scene lives, and nobody writes to the slot during `&self`.
        unsafe { self.place.read() }
    }

    /// Sets the root reference.
    ///
    /// # Safety
    /// The scene whose root this is lives, and no thread traces it now; `root` refers to a tree in this layout
    /// that outlives its stay here; the original root is set again before the scene is committed again or
    /// released.
    pub unsafe fn set(&mut self, root: u64) {
        // SAFETY: the place is valid as in `get`, and the caller has it alone.
        unsafe { self.place.write(root) }
    }
}

/// Whether the layout is known of the scenes of `device`: of its Embree, on this platform.
///
/// # Errors
/// [`Unavailable`], saying for which it is.
pub fn known(device: &Device) -> Result<(), Unavailable> {
    if cfg!(not(all(target_os = "linux", target_arch = "x86_64"))) {
        return Unavailable::because("the layout is known for Linux on x86-64 only");
    }
    check_version(device.version_number())
}

fn check_version(version: isize) -> Result<(), Unavailable> {
    if VERSIONS.contains(&version) {
        return Ok(());
    }
    let known = VERSIONS.map(version_name).join(" and ");
    let this = version_name(version);
    Unavailable::because(format_args!("the layout is known for Embree {known}, and this is {this}"))
}

/// Reads the address of the scene's tree and the tree's head.
fn read_head(scene: u64) -> std::io::Result<(u64, Head)> {
    let memory = File::open("/proc/self/mem")?;
    let mut pointer = [0; 8];
    memory.read_exact_at(&mut pointer, scene + SCENE_TREE)?;
    let address = u64::from_le_bytes(pointer);
    let mut bytes = [0; HEAD];
    memory.read_exact_at(&mut bytes, address)?;
    let word = |at: usize| u32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]);
    let double_word = |at: usize| u64::from(word(at)) | u64::from(word(at + 4)) << 32;
    let head = Head {
        bounds: std::array::from_fn(|i| f32::from_bits(word(16 + 4 * i))),
        kind: word(80),
        device: double_word(96),
        scene: double_word(104),
        root: double_word(ROOT as usize),
    };
    Ok((address, head))
}

impl Head {
    fn check(&self, expected: &Expected) -> Result<(), Unavailable> {
        let kind = match expected.lanes {
            4 => 3,
            8 => 4,
            lanes => return Unavailable::because(format_args!("Embree has no trees of width {lanes}")),
        };
        if self.scene != expected.scene || self.device != expected.device {
            return Unavailable::because("the tree does not name its scene and device");
        }
        if self.kind != kind {
            return Unavailable::because(format_args!(
                "the scene's tree is of type {}, and width {} is type {kind}",
                self.kind, expected.lanes
            ));
        }
        let bits = |corner: &[f32]| [corner[0], corner[1], corner[2]].map(f32::to_bits);
        let (lower, upper) = (expected.bounds.min.to_array(), expected.bounds.max.to_array());
        let corners = [lower, upper, lower, upper];
        if self.bounds.chunks(4).zip(&corners).any(|(found, corner)| bits(found) != bits(corner)) {
            return Unavailable::because("the tree's bounds are not the scene's");
        }
        if reference::get(self.root).is_none() {
            return Unavailable::because("the root is no reference to a node");
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::reference::Target;
    use super::*;
    use glam::Vec3A;

    #[test]
    fn references_round_trip_and_others_are_refused() {
        assert_eq!(reference::get(reference::EMPTY), Some(Target::Empty));
        assert_eq!(reference::get(reference::inner(0x7f00_0000_1240)), Some(Target::Inner(0x7f00_0000_1240)));
        assert_eq!(
            reference::get(reference::leaf(0x7f00_0000_1240, 7)),
            Some(Target::Leaf(0x7f00_0000_1240, 7))
        );
        for bits in [0, 9, 0x7f00_0000_1241, 0x7f00_0000_1248, 1 << 63, 0x1234 << 48] {
            assert_eq!(reference::get(bits), None, "{bits:x}");
        }
    }

    #[test]
    fn each_guard_refuses() {
        assert!(check_version(31305).is_ok() && check_version(40303).is_ok());
        let why = check_version(40400).unwrap_err().why;
        assert_eq!(why, "the layout is known for Embree 3.13.5 and 4.3.3, and this is 4.4.0");
        let bounds = Aabb::new(Vec3A::ZERO, Vec3A::ONE);
        let expected = Expected { lanes: 4, bounds, device: 1, scene: 2 };
        let corner = |x: f32| [x, x, x, 99.0];
        let good = Head {
            bounds: [corner(0.0), corner(1.0), corner(0.0), corner(1.0)].concat().try_into().unwrap(),
            kind: 3,
            device: 1,
            scene: 2,
            root: 0x7f00_0000_1240,
        };
        good.check(&expected).unwrap();
        let mut elsewhere = good.bounds;
        elsewhere[9] = -0.0;
        for (bad, why) in [
            (Head { scene: 3, ..good.clone() }, "name its scene"),
            (Head { device: 3, ..good.clone() }, "name its scene"),
            (Head { kind: 4, ..good.clone() }, "type 4"),
            (Head { bounds: elsewhere, ..good.clone() }, "bounds"),
            (Head { root: 17, ..good.clone() }, "root"),
        ] {
            assert!(bad.check(&expected).unwrap_err().why.contains(why), "{bad:?}");
        }
        assert!(good.check(&Expected { lanes: 8, ..expected }).is_err());
    }
}
