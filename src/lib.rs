//! Bounding volume hierarchies by *Progressive Hierarchical Refinement* (Hendrich, Meister, Bittner,
//! Eurographics 2017), and a benchmark that measures them against Embree's with the same rays.
//!
//! # A guided tour
//!
//! **A mesh** is a list of vertices and a list of triangles. Triangles that no builder can hold (not finite, out of
//! range) are dropped and counted.
//!
//! ```
//! use phr::geometry::Mesh;
//!
//! let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
//! let (mesh, dropped) = Mesh::new(corners, vec![[0, 1, 2], [0, 2, 3]])?;
//! assert_eq!((mesh.len(), dropped.total()), (2, 0));
//! # Ok::<(), phr::geometry::MeshError>(())
//! ```
//!
//! Larger ones come from files (`scene::load`, feature `files`) or from a generator:
//!
//! ```
//! let scene = phr::scene::scalable(20_000, 1);
//! assert_eq!(scene.mesh.len(), 20_000);
//! ```
//!
//! **A builder** turns a mesh into a tree. The main ones have their names in [`builders::NAMES`], variants of them in
//! [`builders::on_request`]; `phr-speed` is a good first choice.
//! A builder runs on the rayon pool that calls it, makes the same tree at any number of threads, and keeps its
//! memory for the next build.
//!
//! ```
//! use phr::builders;
//!
//! let scene = phr::scene::scalable(20_000, 1);
//! let mut builder = builders::by_name::<4>("phr-speed").expect("a name of the list");
//! let build = builder.build(&scene.mesh);
//! for phase in &build.phases {
//!     println!("{:<16} {:?}", phase.name, phase.duration);
//! }
//! builder.recycle(build.tree); // the next tree is built in its memory
//! ```
//!
//! **The tree** is a [`bvh::Bvh4`] (of `by_name::<8>` a [`bvh::Bvh8`]): nodes of up to four (eight) children, leaves of
//! blocks of four triangles. It knows its costs, and it can be checked against its mesh.
//!
//! ```
//! use phr::bvh::Statistics;
//!
//! let scene = phr::scene::scalable(20_000, 1);
//! let cost = |name: &str| {
//!     let tree = phr::builders::by_name::<4>(name).expect("a name of the list").build(&scene.mesh).tree;
//!     assert_eq!(tree.validate(&scene.mesh), Ok(()));
//!     Statistics::of(&tree, &scene.mesh).sah
//! };
//! assert!(cost("phr-quality") < cost("lbvh"));
//! ```
//!
//! **Rays** are what a tree is for. [`Bvh`] owns one that was proven sound, and answers rays with the best instructions
//! of the machine: the closest hit or any, one ray or many. [`query`] says what is promised of intervals, directions,
//! faces and invalid rays.
//!
//! ```
//! use phr::trace::Camera;
//! use phr::{Bvh, BvhConfig};
//!
//! let scene = phr::scene::scalable(20_000, 1);
//! let bvh = Bvh::build(&scene.mesh, &BvhConfig::default())?;
//! let camera = Camera::new(&scene.views[0], 64, 64);
//! let rays: Vec<_> = (0..64 * 64).map(|i| camera.ray(i % 64, i / 64, [0.5; 2])).collect();
//! let mut hits = vec![None; rays.len()];
//! bvh.intersect_batch(&rays, &mut hits);
//! let seen = hits.iter().position(Option::is_some).expect("the camera sees the scene");
//! let (hit, ray) = (bvh.intersect(&rays[seen]).expect("what the batch hit"), rays[seen]);
//! assert_eq!(Some(hit), hits[seen]);
//! println!("triangle {} at {}, facing {}", hit.prim, ray.org + hit.t * ray.dir, hit.normal);
//! # Ok::<(), phr::query::BvhError>(())
//! ```
//!
//! A `Bvh` is also made of a tree that a builder of your own parameters has built: `Bvh::try_from(build.tree)`.
//!
//! **Anything with a box** goes the same way: [`PrimitiveBvh`] is built over [`Primitives`] of yours, which your
//! closure tests. **Instances** of trees, each under a transform, are an [`InstanceBvh`], rebuilt in every frame
//! where they move.
//!
//! ```
//! use phr::glam::{Affine3A, Vec3};
//! use phr::{Bvh, BvhConfig, Instance, InstanceBvh};
//!
//! let object = Bvh::build(&phr::scene::scalable(5_000, 1).mesh, &BvhConfig::default())?;
//! let place = |i: u8| Affine3A::from_translation(Vec3::X * (100.0 * f32::from(i)));
//! let instances = (0..10).map(|i| Instance { bvh: &object, transform: place(i) }).collect();
//! let world = InstanceBvh::build(instances, &BvhConfig::default())?;
//! assert_eq!(world.len(), 10);
//! # Ok::<(), phr::query::BvhError>(())
//! ```
//!
//! How these fit into a renderer or an engine, how a tree lies in memory and how it is uploaded to a graphics
//! processor is in `INTEGRATION.md`, beside the README.
//!
//! **A mesh that moves** keeps its triangles, and its tree may keep its nodes: boxes are fitted to where the
//! vertices are now ([`Bvh::refit`]). When they have moved far, a tree built again traces faster ([`Bvh::rebuild`]);
//! [`builders::Phr::refit`] is in between, for configurations that presplit nothing, and [`builders::MergedPhr`] for
//! scenes of which a part stands still.
//!
//! ```
//! let animation = phr::scene::animated_by_name("wrung").expect("a name of the list").generate(5000);
//! let mut mesh = animation.scene.mesh.clone();
//! let mut bvh = phr::Bvh::build(&mesh, &phr::BvhConfig::default())?;
//! mesh.move_vertices(&animation.vertices(0.1))?;
//! bvh.refit(&mesh)?;
//! mesh.move_vertices(&animation.vertices(1.0))?;
//! bvh.rebuild(&mesh)?;
//! assert_eq!(bvh.len(), mesh.len());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # From a scene file to a row of the table
//!
//! 1. [`scene`] loads or generates an indexed triangle [`geometry::Mesh`] and its cameras;
//! 2. [`builders`] computes boxes of primitives, Morton codes and the auxiliary LBVH, and refines cuts of it;
//! 3. the result is a [`bvh::WideBvh`], whose cost [`bvh`] measures;
//! 4. [`trace`] records a path tracer's rays once per view and traces them through any tree;
//! 5. [`query`] traces the rays of an application;
//! 6. `embree` builds and traces with the distribution's Embree (feature `embree`), `peers` builds with other crates
//!    (feature `peers`);
//! 7. `bench` times all of these in interleaved rounds and writes rows, which `report` turns into tables and plots;
//!    `experiments` has the paper's other figures and its experiments, and `cli` turns all of it into commands
//!    (feature `harness`).
//!
//! A module imports only from those before it: `random`, `memory`, `geometry`, `scene`, `bvh`, `simd`, `parallel`,
//! `builders`, `embree`, `peers`, `trace`, `query`, `bench`, `report`, `experiments`, `cli`.
//!
//! # Features
//!
//! All but `peers` are on unless `default-features = false`: `files` (scene files; brings `serde`), `serde`
//! (configurations as JSON), `embree` (Debian's Embree 3 or Embree 4), `graft` (Embree's kernel over our trees),
//! `harness` (the program `phr`). `peers` has builders of other crates.

#![cfg_attr(docsrs, feature(doc_cfg))]
#![deny(missing_docs)]

pub mod builders;
pub mod bvh;
#[cfg(feature = "embree")]
pub mod embree;
pub mod geometry;
mod memory;
mod parallel;
#[cfg(feature = "peers")]
pub mod peers;
pub mod query;
pub mod random;
pub mod scene;
mod simd;
pub mod trace;

pub use builders::Primitives;
#[doc(no_inline)]
pub use glam;
pub use query::{Bvh, BvhConfig, Instance, InstanceBvh, PrimitiveBvh, WatertightBvh};

#[cfg(feature = "harness")]
pub mod bench;
#[cfg(feature = "harness")]
pub mod cli;
#[cfg(feature = "harness")]
pub mod experiments;
#[cfg(feature = "harness")]
pub mod report;

/// The examples of the README are compiled and run with the documentation's.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct ReadmeExamples;

/// Likewise those of the note on integration.
#[cfg(doctest)]
#[doc = include_str!("../INTEGRATION.md")]
pub struct IntegrationExamples;
