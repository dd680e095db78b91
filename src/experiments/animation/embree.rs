//! Embree's builders following a moving scene: dynamic scenes, committed again for each frame.

use super::contestant::Contestant;
use super::entrant::{Entrant, Update};
use crate::bench::contender::{BuiltTree, embree_tree};
use crate::embree::{EmbreeBuilder, Following, MovingScene, Width};
use crate::geometry::Mesh;
use rayon::ThreadPool;
use std::time::{Duration, Instant};

/// A dynamic scene of Embree's.
struct Embree {
    scene: MovingScene,
    width: Width,
}

/// The contestant of `entrant`, with as many `threads`, if it is Embree's.
pub(super) fn contestant(
    entrant: &Entrant,
    width: u32,
    mesh: &Mesh,
    threads: usize,
) -> Option<Result<Box<dyn Contestant>, String>> {
    let builder = EmbreeBuilder::by_name(&entrant.builder)?;
    let following = match entrant.update {
        Update::Rebuild => Following::Rebuild(builder),
        Update::Refit if builder == EmbreeBuilder::Sah => Following::Refit,
        _ => return Some(Err(format!("Embree has no way to {}", entrant.name()))),
    };
    let width = if width == 8 { Width::Eight } else { Width::Four };
    let scene = MovingScene::new(mesh, following, width, threads).map_err(|error| error.to_string());
    Some(scene.map(|scene| Box::new(Embree { scene, width }) as Box<dyn Contestant>))
}

impl Contestant for Embree {
    fn update(&mut self, mesh: &Mesh, _: &ThreadPool) -> Result<Duration, String> {
        // An application writes its vertices to Embree's buffer at once.
        self.scene.follow(mesh);
        let start = Instant::now();
        self.scene.commit().map_err(|error| error.to_string())?;
        Ok(start.elapsed())
    }

    fn show(
        &mut self,
        mesh: &Mesh,
        see: &mut dyn FnMut(&BuiltTree<'_>) -> Result<(), String>,
    ) -> Result<(), String> {
        let tree = embree_tree(&self.scene.committed(mesh), self.width);
        see(&BuiltTree::of(mesh, tree, Some(Box::new(self.scene.committed(mesh)))))
    }
}
