//! The watertight kernel as a [`Tracer`], told apart by its type.

#[cfg(target_arch = "x86_64")]
use super::avx2::{self, WatertightAvx2};
use super::corners::{CornerBlock, corner_blocks};
use super::scalar::WatertightScalar;
use super::sound_tree::{ProvenTree, SoundTree};
use super::traverse::{self, Query};
use crate::bvh::WideBvh;
use crate::geometry::{Aabb, Hit, Mesh, Ray, Tracer};
use crate::memory::catch_out_of_memory;
use crate::simd::Isa;
use std::borrow::Cow;

/// Traces rays through a tree so that none slips through an edge or a vertex that triangles share, as with Embree's
/// `RTC_SCENE_FLAG_ROBUST`: the interval and the order among equal distances are those of
/// [`BvhTracer`](super::BvhTracer); distances differ from its by rounding, as both are those of the triangles' planes.
///
/// It holds the corners of the leaves' triangles besides the tree's own blocks, 160 bytes for each. Sound for meshes
/// and origins within 1e12 of the scene's origin and for triangles of 1e-12 and larger.
#[derive(Debug)]
pub struct WatertightTracer<'a, const N: usize> {
    tree: SoundTree<'a, N>,
    corners: Cow<'a, Corners>,
    isa: Isa,
}

/// What its tests need besides a tree.
#[derive(Clone, Debug)]
pub(crate) struct Corners {
    blocks: Vec<CornerBlock>,
    /// Of the mesh.
    bounds: Aabb,
}

impl Corners {
    /// Those of `tree`, which was built over `mesh`. Unwinds to [`catch_out_of_memory`] where there is no memory.
    ///
    /// # Errors
    /// One line, if the tree names a triangle that the mesh lacks.
    pub(crate) fn of<const N: usize>(tree: &WideBvh<N>, mesh: &Mesh) -> Result<Self, String> {
        Ok(Self { blocks: corner_blocks(tree, mesh)?, bounds: mesh.bounds() })
    }

    /// Bytes of the blocks.
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(&self.blocks[..])
    }
}

impl<'a, const N: usize> WatertightTracer<'a, N> {
    /// A tracer over `tree`, which was built over `mesh`, with the best instructions of this machine. Copies the
    /// triangles on the current rayon pool.
    ///
    /// # Panics
    /// As [`BvhTracer::new`](super::BvhTracer::new), or if the tree names a triangle that `mesh` lacks.
    pub fn new(tree: &'a WideBvh<N>, mesh: &Mesh) -> Self {
        Self::with_isa(tree, mesh, Isa::best())
    }

    /// As [`WatertightTracer::new`] for a tree that may be of another mesh.
    ///
    /// # Errors
    /// One line: a malformed tree, a triangle that `mesh` lacks, or no memory for the corners.
    pub fn try_new(tree: &'a WideBvh<N>, mesh: &Mesh) -> Result<Self, String> {
        catch_out_of_memory(|| Self::checked(tree, mesh, Isa::best()))
            .unwrap_or_else(|error| Err(error.to_string()))
    }

    /// As [`WatertightTracer::new`] with instructions of choice.
    ///
    /// # Panics
    /// As [`WatertightTracer::new`].
    pub fn with_isa(tree: &'a WideBvh<N>, mesh: &Mesh, isa: Isa) -> Self {
        Self::checked(tree, mesh, isa).unwrap_or_else(|flaw| panic!("{flaw}"))
    }

    /// The tracer, or what is wrong with the tree. Unwinds to [`catch_out_of_memory`] where there is no memory.
    fn checked(tree: &'a WideBvh<N>, mesh: &Mesh, isa: Isa) -> Result<Self, String> {
        let sound = SoundTree::new(tree).map_err(|flaw| format!("malformed tree: {flaw}"))?;
        Ok(Self { tree: sound, corners: Cow::Owned(Corners::of(tree, mesh)?), isa: in_use(isa) })
    }

    /// The instructions in use: those of choice, or AVX2's of a processor with AVX-512.
    pub fn isa(&self) -> Isa {
        self.isa
    }

    fn run(&self, query: Query<'_>) {
        let Corners { blocks, bounds } = &*self.corners;
        let tree = self.tree.over(blocks);
        match self.isa {
            #[cfg(target_arch = "x86_64")]
            Isa::Avx2(token) => {
                avx2::run::<WatertightAvx2, (), N>(token, (token, *bounds), tree, query, &mut ());
            }
            #[cfg(target_arch = "x86_64")]
            Isa::Avx512(_) => unreachable!("lowered to AVX2 when the tracer was made"),
            Isa::Scalar => traverse::run::<WatertightScalar, (), N>(*bounds, tree, query, &mut ()),
            #[cfg(not(target_arch = "x86_64"))]
            Isa::Avx2(_) | Isa::Avx512(_) => unreachable!("tokens of x86-64 are made there alone"),
        }
    }
}

impl<const N: usize> ProvenTree<N> {
    /// A tracer over the tree, of which `corners` are; it costs nothing to make.
    pub(crate) fn watertight_tracer<'a>(&'a self, corners: &'a Corners) -> WatertightTracer<'a, N> {
        WatertightTracer { tree: self.sound(), corners: Cow::Borrowed(corners), isa: in_use(Isa::best()) }
    }
}

/// The instructions in use where these may be: AVX-512 would add nothing.
fn in_use(isa: Isa) -> Isa {
    isa.avx2().map_or(Isa::Scalar, Isa::Avx2)
}

impl<const N: usize> Tracer for WatertightTracer<'_, N> {
    fn closest(&self, rays: &[Ray], hits: &mut [Hit]) {
        self.run(Query::Closest(rays, hits));
    }

    fn any(&self, rays: &[Ray], occluded: &mut [bool]) {
        self.run(Query::Any(rays, occluded));
    }
}
