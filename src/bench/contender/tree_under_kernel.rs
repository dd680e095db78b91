//! A tree under one kernel: ready to be traced.

use super::built_tree::{BuiltTree, EitherWidth};
use super::caught::caught;
#[cfg(feature = "embree")]
use super::embree;
#[cfg(not(feature = "embree"))]
use super::without_embree as embree;
use crate::bench::cell::Kernel;
use crate::geometry::{Ray, Tracer};
use crate::trace::{self, BvhTracer, RayKind, TraversalCounts};
use rayon::prelude::*;

/// A tree under one kernel.
pub struct TreeUnderKernel<'a> {
    /// The kernel.
    pub kernel: Kernel,
    /// The kernel's instruction set.
    pub isa: String,
    traversal: Result<Traversal<'a>, String>,
}

/// How a kernel reaches the tree.
enum Traversal<'a> {
    /// Embree's own scene.
    Native(&'a dyn Tracer),
    /// A scene of Embree's whose root was replaced by the tree.
    Grafted(Box<dyn Tracer + 'a>),
    /// Our kernel on a 4-wide tree.
    Four(BvhTracer<'a, 4>),
    /// Our kernel on an 8-wide tree.
    Eight(BvhTracer<'a, 8>),
}

impl<'a> TreeUnderKernel<'a> {
    /// Puts `built` under `kernel`; a graft's scene is built with `threads`.
    ///
    /// # Errors
    /// A malformed tree, in one line.
    pub fn new(built: &'a BuiltTree<'_>, kernel: Kernel, threads: usize) -> Result<Self, String> {
        let isa = match kernel {
            Kernel::Phr => trace::kernel_isa().name().into(),
            Kernel::EmbreeNative | Kernel::EmbreeGrafted => {
                let [kernel, _] = embree::isas();
                kernel
            }
        };
        let tree = built.tree.as_ref().map_err(Clone::clone);
        let traversal = match (kernel, tree) {
            (Kernel::EmbreeNative, _) => match &built.native {
                Some(scene) => Ok(Traversal::Native(&**scene)),
                None => Err("Embree did not build it".into()),
            },
            (_, Err(reason)) => Err(reason),
            (Kernel::EmbreeGrafted, Ok(EitherWidth::Four(tree))) => {
                embree::graft(built.mesh, tree, threads).map(Traversal::Grafted)
            }
            (Kernel::EmbreeGrafted, Ok(EitherWidth::Eight(tree))) => {
                embree::graft(built.mesh, tree, threads).map(Traversal::Grafted)
            }
            (Kernel::Phr, Ok(EitherWidth::Four(tree))) => {
                Ok(Traversal::Four(caught("our kernel", || BvhTracer::new(tree))?))
            }
            (Kernel::Phr, Ok(EitherWidth::Eight(tree))) => {
                Ok(Traversal::Eight(caught("our kernel", || BvhTracer::new(tree))?))
            }
        };
        Ok(Self { kernel, isa, traversal })
    }

    /// Puts `built` under each of `kernels`.
    ///
    /// # Errors
    /// Those of [`TreeUnderKernel::new`].
    pub fn all(built: &'a BuiltTree<'_>, kernels: &[Kernel], threads: usize) -> Result<Vec<Self>, String> {
        kernels.iter().map(|&kernel| Self::new(built, kernel, threads)).collect()
    }

    /// The tracer.
    ///
    /// # Errors
    /// Why the kernel cannot trace it.
    pub fn tracer(&self) -> Result<&dyn Tracer, &str> {
        match &self.traversal {
            Ok(Traversal::Native(scene)) => Ok(*scene),
            Ok(Traversal::Grafted(scene)) => Ok(&**scene),
            Ok(Traversal::Four(tracer)) => Ok(tracer),
            Ok(Traversal::Eight(tracer)) => Ok(tracer),
            Err(reason) => Err(reason),
        }
    }

    /// Counts the node visits and block tests for `rays` of `kind` on the current rayon pool, untimed; `None`
    /// under Embree's kernels, which have no counters.
    pub fn count(&self, kind: RayKind, rays: &[Ray]) -> Option<TraversalCounts> {
        match &self.traversal {
            Ok(Traversal::Four(tracer)) => Some(count(tracer, kind, rays)),
            Ok(Traversal::Eight(tracer)) => Some(count(tracer, kind, rays)),
            _ => None,
        }
    }

    /// The node visits and block tests of each of `rays`, closest hits, on the current rayon pool, untimed; `None`
    /// under Embree's kernels.
    pub fn count_each(&self, rays: &[Ray]) -> Option<Vec<TraversalCounts>> {
        match &self.traversal {
            Ok(Traversal::Four(tracer)) => Some(count_each(tracer, rays)),
            Ok(Traversal::Eight(tracer)) => Some(count_each(tracer, rays)),
            _ => None,
        }
    }

    /// A tree that answers as `tracer` does.
    #[cfg(test)]
    pub fn of_tracer(tracer: &'a dyn Tracer) -> Self {
        Self { kernel: Kernel::Phr, isa: String::new(), traversal: Ok(Traversal::Native(tracer)) }
    }
}

fn count<const N: usize>(tracer: &BvhTracer<'_, N>, kind: RayKind, rays: &[Ray]) -> TraversalCounts {
    let count =
        |rays: &[Ray]| if kind.is_any_hit() { tracer.count_any(rays) } else { tracer.count_closest(rays) };
    rays.par_chunks(1 << 12).map(count).reduce(TraversalCounts::default, |a, b| a + b)
}

fn count_each<const N: usize>(tracer: &BvhTracer<'_, N>, rays: &[Ray]) -> Vec<TraversalCounts> {
    rays.par_iter().map(|ray| tracer.count_closest(std::slice::from_ref(ray))).collect()
}
