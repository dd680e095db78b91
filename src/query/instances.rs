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
/// length, so that distances stay the world's.
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
    top: PrimitiveBvh,
    bounds: Aabb,
}

impl<B: Borrow<Bvh> + Sync> InstanceBvh<B> {
    /// Builds the tree over `instances` on the current rayon pool. `lbvh`, `phr-draft` and `phr-turbo` build fastest.
    ///
    /// # Errors
    /// [`BvhError::Transform`]: one that cannot be inverted, or takes its object too far away; those of
    /// [`PrimitiveBvh::build`].
    pub fn build(instances: Vec<Instance<B>>, config: &BvhConfig<'_>) -> Result<Self, BvhError> {
        let placed = placed(instances)?;
        let top = PrimitiveBvh::build(&placed, config)?;
        Ok(Self { bounds: around(&placed), placed, top })
    }

    /// Builds the tree anew over other `instances`, or the same ones that moved, in the memory of this one; what it
    /// keeps of each instance, some 160 bytes, is written to a new list. Objects stay as they are.
    ///
    /// # Errors
    /// [`BvhError::Transform`]; the tree is then as before. [`BvhError::OutOfMemory`]; it is then empty or as before,
    /// and may be rebuilt.
    pub fn rebuild(&mut self, instances: Vec<Instance<B>>) -> Result<(), BvhError> {
        let placed = placed(instances)?;
        self.top.rebuild(&placed)?;
        self.bounds = around(&placed);
        self.placed = placed;
        Ok(())
    }

    /// The closest hit of `ray`; the [`query`](crate::query) module says what is promised.
    pub fn intersect(&self, ray: &Ray) -> Option<InstanceHit> {
        let slabs = Slabs::of(ray);
        let mut closest = None;
        let found = self.top.intersect_with(ray, |id, ray| {
            let placed = &self.placed[id as usize];
            if !slabs.meet(placed.bounds, ray) {
                return None;
            }
            let mut local = placed.local(ray);
            let hit = loop {
                let hit = placed.bvh.borrow().intersect(&local)?;
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
            closest = Some((id, hit));
            Some(hit.t)
        });
        let (instance, hit) = found.and(closest)?;
        let normal = self.placed[instance as usize].to_world_normal(hit.normal);
        Some(InstanceHit { instance, hit: Hit { normal, ..hit } })
    }

    /// Whether `ray` hits anything.
    pub fn occluded(&self, ray: &Ray) -> bool {
        let slabs = Slabs::of(ray);
        self.top.occluded_with(ray, |id, ray| {
            let placed = &self.placed[id as usize];
            slabs.meet(placed.bounds, ray) && placed.bvh.borrow().occluded(&placed.local(ray))
        })
    }

    /// The tree over the instances, to upload it: its leaves hold their numbers.
    pub fn upper(&self) -> &PrimitiveBvh {
        &self.top
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
        // After a rebuild without memory there may be nothing any more.
        self.bounds.intersection(self.top.bounds())
    }
}

/// The box of what rays may hit: objects without a triangle have a place, too, but nothing there.
fn around<B: Borrow<Bvh>>(placed: &[Placed<B>]) -> Aabb {
    let solid = placed.iter().filter(|placed| !placed.bvh.borrow().bounds().is_empty());
    solid.fold(Aabb::EMPTY, |bounds, placed| bounds.union(placed.bounds))
}

/// The instances, ready for rays.
fn placed<B: Borrow<Bvh>>(instances: Vec<Instance<B>>) -> Result<Vec<Placed<B>>, BvhError> {
    let mut placed = Vec::new();
    huge_pages::try_reserve(&mut placed, instances.len(), "instances")?;
    for (instance, Instance { bvh, transform }) in instances.into_iter().enumerate() {
        let place = Placed::new(bvh, transform);
        placed.push(place.map_err(|reason| BvhError::Transform { instance, reason })?);
    }
    Ok(placed)
}
