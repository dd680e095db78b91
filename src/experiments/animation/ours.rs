//! Our builders following a moving scene, in each way.

use super::contestant::Contestant;
use super::entrant::{Entrant, Update};
use crate::bench::contender::{BuiltTree, EitherWidth, caught};
use crate::builders::{
    AuxiliaryConfig, AuxiliaryTree, BinnedSahConfig, Build, Builder, Extensions, MergedPhr, Phr, PhrConfig,
    Recipe, RefitError,
};
use crate::bvh::WideBvh;
use crate::geometry::Mesh;
use rayon::ThreadPool;
use std::time::{Duration, Instant};

/// A builder of ours with its tree.
pub struct Ours<const N: usize> {
    way: Way<N>,
    tree: Option<WideBvh<N>>,
}

/// How its tree follows.
enum Way<const N: usize> {
    Rebuild(Box<dyn Builder<N>>),
    Refit(Box<dyn Builder<N>>),
    Refine(Box<Phr<N>>),
    Merge { builder: Box<MergedPhr<N>>, fixed: usize, tree: AuxiliaryTree },
}

impl<const N: usize> Ours<N> {
    /// The builder of `entrant`; the first `fixed` triangles of the mesh never move.
    ///
    /// # Errors
    /// No such builder, or none that can follow so.
    pub fn new(entrant: &Entrant, fixed: usize) -> Result<Self, String> {
        let made_by = entrant.recipe.as_ref().unwrap_or(&entrant.builder);
        let recipe = Recipe::parse(made_by).map_err(|error| error.to_string())?;
        let config = || recipe.phr().ok_or_else(|| format!("{} has no cuts to be refined", entrant.builder));
        let merge = |config: PhrConfig, tree| {
            let builder = Box::new(MergedPhr::new(config).map_err(|error| error.to_string())?);
            Ok::<_, String>(Way::Merge { builder, fixed, tree })
        };
        let way = match entrant.update {
            Update::Rebuild => Way::Rebuild(recipe.builder()),
            Update::Refit => Way::Refit(recipe.builder()),
            Update::Refine => {
                // Pieces of needles cannot be refitted.
                let PhrConfig { extensions, .. } = config()?;
                let auxiliary = AuxiliaryConfig { presplit: None, ..extensions.auxiliary };
                let config = PhrConfig { extensions: Extensions { auxiliary, ..extensions }, ..config()? };
                Way::Refine(Box::new(Phr::new("refined", config).map_err(|error| error.to_string())?))
            }
            Update::Merge => {
                let config = config()?;
                merge(config, config.extensions.auxiliary_tree)?
            }
            Update::MergeSah => merge(config()?, AuxiliaryTree::BinnedSah(BinnedSahConfig::DEFAULT))?,
        };
        Ok(Self { way, tree: None })
    }

    /// The tree of the next frame, and how long it took.
    fn next(&mut self, mesh: &Mesh) -> Result<(Duration, WideBvh<N>), RefitError> {
        let last = self.tree.take();
        let is_first = last.is_none();
        let tree_of = |build: Build<N>| build.tree;
        // Memory that is given back costs nothing.
        match (&mut self.way, last) {
            (Way::Rebuild(builder), Some(tree)) => builder.recycle(tree),
            (Way::Refine(builder), Some(tree)) => builder.recycle(tree),
            (Way::Merge { builder, .. }, Some(tree)) => builder.recycle(tree),
            (Way::Refit(_), last) => self.tree = last,
            (_, None) => {}
        }
        let start = Instant::now();
        let tree = match &mut self.way {
            Way::Rebuild(builder) => tree_of(builder.build(mesh)),
            Way::Refit(builder) => match self.tree.take() {
                None => tree_of(builder.build(mesh)),
                Some(mut tree) => {
                    tree.refit(mesh)?;
                    tree
                }
            },
            Way::Refine(builder) if is_first => tree_of(builder.build(mesh)),
            Way::Refine(builder) => tree_of(builder.refit(mesh)?),
            Way::Merge { builder, fixed, tree } => {
                if is_first {
                    builder.keep(mesh, *fixed, *tree)?;
                }
                tree_of(builder.build(mesh)?)
            }
        };
        Ok((start.elapsed(), tree))
    }
}

impl<const N: usize> Contestant for Ours<N>
where
    EitherWidth: From<WideBvh<N>>,
    WideBvh<N>: TryFrom<EitherWidth>,
{
    fn update(&mut self, mesh: &Mesh, pool: &ThreadPool) -> Result<Duration, String> {
        let updated = caught("the builder", || pool.install(|| self.next(mesh)))?;
        let (duration, tree) = updated.map_err(|error| error.to_string())?;
        self.tree = Some(tree);
        Ok(duration)
    }

    fn show(
        &mut self,
        mesh: &Mesh,
        see: &mut dyn FnMut(&BuiltTree<'_>) -> Result<(), String>,
    ) -> Result<(), String> {
        let tree = self.tree.take().ok_or("no tree was built yet")?;
        let built = BuiltTree::of(mesh, Ok(tree.into()), None);
        let seen = see(&built);
        self.tree = built.into_tree().ok().and_then(|tree| tree.try_into().ok());
        seen
    }
}
