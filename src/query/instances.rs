//! Two levels: instances of trees, each under a transform of its own, and a tree over their boxes.

use super::placed::{Placed, Slabs};
use super::{Bvh, BvhConfig, BvhError, Hit, PrimitiveBvh};
use crate::geometry::{Aabb, Ray};
use crate::memory::huge_pages;
use glam::Affine3A;
use std::borrow::Borrow;

/// An object, a tree that many instances may share (`&Bvh`, `Arc<Bvh>`), at a place.
#[derive(Clone, Copy, Debug)]
pub struct Instance<B> {
    /// The object.
    pub bvh: B,
    /// From the object's space to the world's: an affine map, mirrors and shears included, that [`Instance::check`]
    /// finds to be of use. A ray whose origin or direction lies beyond 1.8e18 in the object's space misses it, one
    /// whose direction is shorter there than 1e-10 may miss it.
    pub transform: Affine3A,
}

impl<B: Borrow<Bvh>> Instance<B> {
    /// Whether the transform is of use: finite, with an inverse in the range of `f32`, its determinant more than 1e-7
    /// of the product of its columns' lengths, and the object within 1.8e18 of the origin.
    ///
    /// # Errors
    /// What it is not, as in [`BvhError::Transform`].
    pub fn check(&self) -> Result<(), &'static str> {
        Placed::new(self.bvh.borrow(), self.transform).map(drop)
    }
}

/// The closest hit of a ray among instances.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InstanceHit {
    /// Index of the instance.
    pub instance: u32,
    /// The hit in the object; distance and normal are the world's, the normal that of the transformed triangle.
    pub hit: Hit,
}

/// A tree over instances. A ray is taken to the space of each object that it may hit, its direction not to unit
/// length, so that distances stay the world's. Objects are traced as a [`Bvh`]: a ray may slip through their edges.
///
/// ```
/// use phr::geometry::{Mesh, Ray};
/// use phr::glam::{Affine3A, Vec3};
/// use phr::{Bvh, BvhConfig, Instance, InstanceBvh};
///
/// let (mesh, _) = Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
/// let object = Bvh::build(&mesh, &BvhConfig::default())?;
/// let place = |x: f32| Instance { bvh: &object, transform: Affine3A::from_translation(Vec3::new(x, 0.0, 0.0)) };
/// let mut world = InstanceBvh::build(vec![place(0.0), place(10.0)], &BvhConfig::default())?;
///
/// let ray = Ray::new([10.2, 0.3, 2.0], [0.0, 0.0, -1.0]);
/// assert_eq!(world.intersect(&ray).map(|found| (found.instance, found.hit.prim)), Some((1, 0)));
///
/// world.rebuild(vec![place(0.0), place(20.0)])?; // the next frame
/// assert!(!world.occluded(&ray));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct InstanceBvh<B> {
    placed: Vec<Placed<B>>,
    /// Of each instance, apart from what rays read.
    transforms: Vec<Affine3A>,
    top: PrimitiveBvh,
    bounds: Aabb,
}

impl<B: Borrow<Bvh> + Sync> InstanceBvh<B> {
    /// Builds the tree over `instances` on the current rayon pool. `lbvh`, `phr-draft` and `phr-turbo` build fastest.
    ///
    /// # Errors
    /// [`BvhError::Transform`]: one that cannot be inverted, or takes its object too far away; those of
    /// [`PrimitiveBvh::build`], of [`BvhError::Boxes`] only that there are too many.
    pub fn build(instances: Vec<Instance<B>>, config: &BvhConfig<'_>) -> Result<Self, BvhError> {
        let Ready { placed, transforms, .. } = Ready::strictly(instances)?;
        let top = PrimitiveBvh::build(&placed, config)?;
        Ok(Self { bounds: around(&placed), placed, transforms, top })
    }

    /// Builds the tree anew over other `instances`, or the same ones that moved, in the memory of this one; what it
    /// keeps of each instance, some 220 bytes, is written to new lists. Objects stay as they are. Those of the old list
    /// are dropped when the new tree is there: to change one that is in an `Arc` or behind a reference, rebuild over an
    /// empty list first.
    ///
    /// # Errors
    /// [`BvhError::Transform`] and, of too many instances, [`BvhError::Boxes`]; the tree is then as before.
    /// [`BvhError::OutOfMemory`]; it is then empty or as before, and may be rebuilt.
    pub fn rebuild(&mut self, instances: Vec<Instance<B>>) -> Result<(), BvhError> {
        self.rebuild_over(Ready::strictly(instances)?).map(drop)
    }

    /// The same without those whose transform is of no use, as [`Instance::check`] finds. Returns where in the list
    /// these were, in its order. The others move up: a hit's instance is its place among them.
    ///
    /// ```
    /// use phr::glam::{Affine3A, Vec3};
    /// use phr::{Bvh, BvhConfig, Instance, InstanceBvh};
    ///
    /// let object = Bvh::build(&phr::scene::scalable(1_000, 1).mesh, &BvhConfig::default())?;
    /// let scaled = |scale: f32| Instance { bvh: &object, transform: Affine3A::from_scale(Vec3::splat(scale)) };
    /// let mut world = InstanceBvh::build(vec![], &BvhConfig::default())?;
    /// let hidden = world.rebuild_skipping(vec![scaled(1.0), scaled(0.0), scaled(2.0)])?;
    /// assert_eq!((hidden, world.len()), (vec![1], 2));
    /// assert_eq!(world.transform(1), Some(scaled(2.0).transform));
    /// # Ok::<(), phr::query::BvhError>(())
    /// ```
    ///
    /// # Errors
    /// As of [`InstanceBvh::rebuild`], but for [`BvhError::Transform`].
    pub fn rebuild_skipping(&mut self, instances: Vec<Instance<B>>) -> Result<Vec<usize>, BvhError> {
        self.rebuild_over(Ready::of(instances, |_, _| Ok(()))?)
    }

    fn rebuild_over(&mut self, ready: Ready<B>) -> Result<Vec<usize>, BvhError> {
        // Before anything changes: it asks the caller's `Borrow`, which may panic.
        let bounds = around(&ready.placed);
        if let Err(error) = self.top.rebuild(&ready.placed) {
            if self.top.bounds().is_empty() {
                // Without memory there is no tree any more.
                self.placed.clear();
                self.transforms.clear();
                self.bounds = Aabb::EMPTY;
            }
            return Err(error);
        }
        self.bounds = bounds;
        (self.placed, self.transforms) = (ready.placed, ready.transforms);
        Ok(ready.left_out)
    }

    /// The closest hit of `ray`; the [`query`](crate::query) module says what is promised.
    pub fn intersect(&self, ray: &Ray) -> Option<InstanceHit> {
        self.closest(ray, |_, placed, local| placed.bvh.borrow().intersect(local))
    }

    /// Whether `ray` hits anything.
    pub fn occluded(&self, ray: &Ray) -> bool {
        self.any(ray, |_, placed, local| placed.bvh.borrow().occluded(local))
    }

    /// The closest hit of `ray`, where `closest` finds that of an instance by the ray in its object's space.
    #[inline(always)]
    pub(super) fn closest(
        &self,
        ray: &Ray,
        mut closest: impl FnMut(u32, &Placed<B>, &Ray) -> Option<Hit>,
    ) -> Option<InstanceHit> {
        let slabs = Slabs::of(ray);
        let mut nearest = None;
        let found = self.top.intersect_with(ray, |id, ray| {
            let placed = &self.placed[id as usize];
            if !slabs.meet(placed.bounds, ray) {
                return None;
            }
            let mut local = placed.local(ray);
            let hit = loop {
                let hit = closest(id, placed, &local)?;
                if ray.tnear < hit.t {
                    break hit;
                }
                // Rounded to the interval's open end: no hit, but there may be one behind it.
                local.tnear = local.tnear.next_up();
            };
            // As the traversal asks.
            if hit.t > ray.tfar {
                return None;
            }
            nearest = Some((id, hit));
            Some(hit.t)
        });
        let (instance, hit) = found.and(nearest)?;
        Some(InstanceHit { instance, hit: self.placed[instance as usize].to_world(hit) })
    }

    /// Whether `ray` hits anything, where `any` tells it of an instance likewise.
    #[inline(always)]
    pub(super) fn any(&self, ray: &Ray, mut any: impl FnMut(u32, &Placed<B>, &Ray) -> bool) -> bool {
        let slabs = Slabs::of(ray);
        self.top.occluded_with(ray, |id, ray| {
            let placed = &self.placed[id as usize];
            slabs.meet(placed.bounds, ray) && any(id, placed, &placed.local(ray))
        })
    }

    /// The tree over the instances, to upload it: its leaves hold their numbers.
    pub fn upper(&self) -> &PrimitiveBvh {
        &self.top
    }

    /// The object of an instance; `None` beyond the last.
    pub fn object(&self, instance: u32) -> Option<&B> {
        Some(&self.placed.get(instance as usize)?.bvh)
    }

    /// From the space of an instance's object to the world, as it was given; `None` beyond the last.
    pub fn transform(&self, instance: u32) -> Option<Affine3A> {
        self.transforms.get(instance as usize).copied()
    }

    /// From the world to the space of an instance's object; `None` beyond the last.
    pub fn to_object(&self, instance: u32) -> Option<Affine3A> {
        Some(self.placed.get(instance as usize)?.to_object)
    }

    /// Number of instances.
    pub fn len(&self) -> usize {
        self.placed.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.placed.is_empty()
    }

    /// The box of all instances of objects that have a triangle; [empty](Aabb::is_empty) without any.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }
}

/// The box of what rays may hit: objects without a triangle have a place, too, but nothing there.
fn around<B: Borrow<Bvh>>(placed: &[Placed<B>]) -> Aabb {
    let solid = placed.iter().filter(|placed| !placed.bvh.borrow().bounds().is_empty());
    solid.fold(Aabb::EMPTY, |bounds, placed| bounds.union(placed.bounds))
}

/// Instances, ready for rays.
struct Ready<B> {
    placed: Vec<Placed<B>>,
    transforms: Vec<Affine3A>,
    /// Indices of those whose transform is of no use.
    left_out: Vec<usize>,
}

impl<B: Borrow<Bvh>> Ready<B> {
    /// All, or the error of the first whose transform is of no use.
    fn strictly(instances: Vec<Instance<B>>) -> Result<Self, BvhError> {
        Self::of(instances, |instance, reason| Err(BvhError::Transform { instance, reason }))
    }

    /// Those that can be placed; what is wrong with the others is told to `refuse`.
    fn of(
        instances: Vec<Instance<B>>,
        refuse: impl Fn(usize, &'static str) -> Result<(), BvhError>,
    ) -> Result<Self, BvhError> {
        let mut ready = Self { placed: Vec::new(), transforms: Vec::new(), left_out: Vec::new() };
        huge_pages::try_reserve(&mut ready.placed, instances.len(), "instances")?;
        huge_pages::try_reserve(&mut ready.transforms, instances.len(), "transforms of instances")?;
        for (index, Instance { bvh, transform }) in instances.into_iter().enumerate() {
            match Placed::new(bvh, transform) {
                Ok(placed) => {
                    ready.placed.push(placed);
                    ready.transforms.push(transform);
                }
                Err(reason) => {
                    refuse(index, reason)?;
                    ready.left_out.push(index);
                }
            }
        }
        Ok(ready)
    }
}
