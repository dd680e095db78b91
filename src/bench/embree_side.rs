//! Embree as a contender and as the reference: the only file of the driver that knows whether Embree is
//! there. Without it, the reference is our own best builder.

use super::contender::{Cell, Shown, Visit};
use super::environment::Library;
use crate::geometry::{Mesh, Tracer};
use rayon::ThreadPool;

#[cfg(feature = "embree")]
pub use with_embree::{cells, library, reference, visit};
#[cfg(not(feature = "embree"))]
pub use without_embree::{cells, library, reference, visit};

#[cfg(feature = "embree")]
mod with_embree {
    use super::super::contender::{Builds, Facts, Kernel, View, is_enough, ms};
    use super::super::load::Accounts;
    use super::{Cell, Library, Mesh, Shown, ThreadPool, Tracer, Visit};
    use crate::embree::{self, Config, Device, EmbreeBuilder, Inspection, Width};
    use std::time::Instant;

    /// Embree's builders in both widths.
    pub fn cells() -> Vec<Cell> {
        let cell = |builder: EmbreeBuilder, width: Width| Cell {
            builder: builder.name().into(),
            width: width.lanes() as u32,
            kernels: vec![Kernel::EmbreeNative],
        };
        EmbreeBuilder::ALL.iter().flat_map(|&builder| Width::ALL.map(|width| cell(builder, width))).collect()
    }

    /// Builds with Embree. In the clock is the commit alone; what it built is asserted from another, verbose
    /// one that is not timed.
    ///
    /// # Errors
    /// Embree's own words, or a builder that is not the one asked for.
    pub fn visit(cell: &Cell, visit: &Visit<'_>, observer: &mut dyn FnMut(Shown<'_>)) -> Result<(), String> {
        let config = config(cell, visit.pool.current_num_threads())?;
        let inspection = if visit.facts { Some(inspect(visit.mesh, &config)?) } else { None };
        let device = Device::new(&config).map_err(|error| error.to_string())?;
        let commit = || {
            let prepared = device.prepare(visit.mesh)?;
            device.reset_peak();
            let start = Instant::now();
            let scene = prepared.commit()?;
            Ok((start.elapsed(), scene))
        };
        let told = |error: embree::EmbreeError| error.to_string();
        let (cold, first) = commit().map_err(told)?;
        drop(first);
        let accounts = Accounts::read();
        let mut warm = Vec::new();
        let scene = loop {
            let (duration, scene) = commit().map_err(told)?;
            warm.push(duration);
            if is_enough(&warm) {
                break scene;
            }
        };
        let builds = Builds {
            cold_ms: ms(cold),
            warm_ms: warm.into_iter().map(ms).collect(),
            phases: Vec::new(),
            peak_bytes: Some(device.memory().peak_bytes as u64),
            load: accounts.since(),
        };
        let isa = inspection.as_ref().map(isa).unwrap_or_default();
        let views = visit.kernels.iter().map(|&kernel| View {
            kernel,
            isa: isa.clone(),
            tracer: match kernel {
                Kernel::EmbreeNative => Ok(&scene as &dyn Tracer),
                Kernel::Phr => Err("Embree's trees cannot be read".into()),
            },
            counter: None,
        });
        let facts = inspection.map(|inspection| facts(&inspection, &config));
        observer(Shown { builds, facts, views: views.collect() });
        Ok(())
    }

    fn config(cell: &Cell, threads: usize) -> Result<Config, String> {
        let builder = EmbreeBuilder::by_name(&cell.builder)
            .ok_or_else(|| format!("no builder is called {}", cell.builder))?;
        let width = Width::ALL
            .into_iter()
            .find(|width| width.lanes() as u32 == cell.width)
            .ok_or_else(|| format!("Embree has no trees of width {}", cell.width))?;
        Ok(Config { builder, width, threads })
    }

    fn inspect(mesh: &Mesh, config: &Config) -> Result<Inspection, String> {
        embree::inspect(mesh, config).map_err(|error| error.to_string())
    }

    /// The instruction set before the name of the kernel, as in `avx2::BVH4Triangle4Intersector1Moeller`.
    fn isa(inspection: &Inspection) -> String {
        inspection.intersector.split_once("::").map_or("unknown", |(isa, _)| isa).into()
    }

    fn facts(inspection: &Inspection, config: &Config) -> Facts {
        Facts {
            engine: format!("embree {}", embree::version()),
            config: config.device_string(),
            sah: Some(inspection.sah),
            nodes: Some(inspection.nodes),
            leaves: Some(inspection.leaves),
            depth: Some(inspection.depth),
            leaf_fill: Some(inspection.leaf_fill),
            bytes: Some(inspection.bytes),
            ..Facts::default()
        }
    }

    /// Shows Embree's SAH tree, whose hits are the reference.
    ///
    /// # Errors
    /// Embree's own words.
    pub fn reference(
        mesh: &Mesh,
        pool: &ThreadPool,
        observer: &mut dyn FnMut(&dyn Tracer),
    ) -> Result<(), String> {
        let threads = pool.current_num_threads();
        let config = Config { builder: EmbreeBuilder::Sah, width: Width::Four, threads };
        let told = |error: embree::EmbreeError| error.to_string();
        let device = Device::new(&config).map_err(told)?;
        let scene = device.prepare(mesh).map_err(told)?.commit().map_err(told)?;
        observer(&scene);
        Ok(())
    }

    /// The library in use.
    pub fn library() -> Library {
        Library::of(embree::version())
    }
}

#[cfg(not(feature = "embree"))]
mod without_embree {
    use super::{Cell, Library, Mesh, Shown, ThreadPool, Tracer, Visit};
    use crate::build;
    use crate::trace::BvhTracer;

    /// None.
    pub fn cells() -> Vec<Cell> {
        Vec::new()
    }

    /// There is no such builder.
    ///
    /// # Errors
    /// Always.
    pub fn visit(cell: &Cell, _: &Visit<'_>, _: &mut dyn FnMut(Shown<'_>)) -> Result<(), String> {
        Err(format!("no builder is called {}; this program was built without Embree", cell.builder))
    }

    /// Shows a tree of our last builder, whose hits are the reference.
    ///
    /// # Errors
    /// No builder at all.
    pub fn reference(
        mesh: &Mesh,
        pool: &ThreadPool,
        observer: &mut dyn FnMut(&dyn Tracer),
    ) -> Result<(), String> {
        let builder = build::NAMES.last().and_then(|name| build::by_name(name));
        let mut builder = builder.ok_or("this program has no builders")?;
        let built = pool.install(|| builder.build(mesh));
        observer(&BvhTracer::new(&built.tree));
        Ok(())
    }

    /// No library.
    pub fn library() -> Library {
        Library { note: "built without Embree".into(), ..Library::default() }
    }
}
