//! The splits of a build over cuts, as the builder makes them: sizes of cuts by depth (Figure 4 of the paper), and
//! single splits of PHR as boxes (Figures 3 and 5). Cuts that an extension splits down to their leaves in one go
//! are not seen.

use super::split_boxes::SplitBoxes;
use crate::builders::api::config_error::ConfigError;
use crate::builders::lbvh::auxiliary::Auxiliary;
use crate::builders::phr::config::Extensions;
use crate::builders::phr::cut::OwnedCut;
use crate::builders::phr::policy::{CutPolicy, SeenSplit};
use crate::builders::phr::recursion::CutRecursion;
use crate::builders::phr::watched::Watched;
use crate::builders::registry::CutConfig;
use crate::builders::wide::build::build;
use crate::builders::wide::memory::Memory;
use crate::builders::{hunt::pipeline as hunt, phr::pipeline as phr};
use crate::bvh::Bvh4;
use crate::geometry::Mesh;
use crate::simd::Isa;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

/// Depths that are told apart; deeper splits count to the last.
const DEPTHS: usize = 128;

/// The cuts at a depth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CutsAtDepth {
    /// Binary splits above.
    pub depth: u32,
    /// Cuts that were split.
    pub cuts: u64,
    /// Their nodes, all together.
    pub nodes: u64,
}

/// Builds over `mesh` on the current rayon pool, every split shown to `watcher`; the nodes are those of the
/// builder's tree.
fn watched(
    mesh: &Mesh,
    config: &CutConfig,
    watcher: &(dyn Fn(&SeenSplit<'_>) + Sync),
) -> Result<Bvh4, ConfigError> {
    let (mut auxiliary, isa) = (Auxiliary::default(), Isa::best());
    let cuts = match config {
        CutConfig::Phr(config) => *config,
        CutConfig::Hunt(config) => config.of_cuts()?,
    };
    cuts.check()?;
    let Extensions { auxiliary_tree, auxiliary: of_auxiliary, .. } = &cuts.extensions;
    auxiliary_tree.build(&mut auxiliary, (mesh, 0..mesh.len() as u32), of_auxiliary, isa);
    Ok(match config {
        CutConfig::Phr(_) => {
            tree(phr::recursion_and_cut(&auxiliary, mesh, &cuts, isa), &auxiliary, mesh, watcher)
        }
        CutConfig::Hunt(config) => tree(
            hunt::recursion_and_cut(&auxiliary, mesh, (&cuts, config.cut_length), isa),
            &auxiliary,
            mesh,
            watcher,
        ),
    })
}

fn tree<'a, P: CutPolicy>(
    (recursion, cut): (CutRecursion<'a, P>, Option<OwnedCut>),
    auxiliary: &'a Auxiliary,
    mesh: &'a Mesh,
    watcher: &(dyn Fn(&SeenSplit<'_>) + Sync),
) -> Bvh4 {
    let policy = Watched { policy: recursion.policy, watcher };
    let recursion = CutRecursion::new(auxiliary, mesh, recursion.config, policy, recursion.isa);
    build(&recursion, cut, mesh, &mut Memory::default())
}

/// The number of cuts and their nodes by depth, from the root down.
///
/// # Errors
/// A parameter out of range.
pub fn cut_sizes(mesh: &Mesh, config: &CutConfig) -> Result<Vec<CutsAtDepth>, ConfigError> {
    let counts: Vec<[AtomicU64; 2]> = (0..DEPTHS).map(|_| Default::default()).collect();
    watched(mesh, config, &|split| {
        let [cuts, nodes] = &counts[(split.depth as usize).min(DEPTHS - 1)];
        cuts.fetch_add(1, Ordering::Relaxed);
        nodes.fetch_add(split.cut.len() as u64, Ordering::Relaxed);
    })?;
    let all = counts.into_iter().zip(0..).map(|([cuts, nodes], depth)| CutsAtDepth {
        depth,
        cuts: cuts.into_inner(),
        nodes: nodes.into_inner(),
    });
    Ok(all.filter(|at| at.cuts > 0).collect())
}

/// The split that `choose` gives the highest score, of equal ones the first by depth and by the corners of its cut: the
/// same at any number of threads. `None` where no split has one.
///
/// # Errors
/// A parameter out of range.
pub fn best_split(
    mesh: &Mesh,
    config: &CutConfig,
    choose: impl Fn(&SplitBoxes) -> Option<f32> + Sync,
) -> Result<Option<SplitBoxes>, ConfigError> {
    let best: Mutex<Option<(f32, SplitBoxes)>> = Mutex::new(None);
    watched(mesh, config, &|split| {
        let boxes = SplitBoxes::of(split);
        let Some(score) = choose(&boxes) else { return };
        let mut best = best.lock().expect("no watcher panics");
        let is_better = best.as_ref().is_none_or(|(least, other)| {
            score > *least
                || score == *least && boxes.place().partial_cmp(&other.place()).is_some_and(|it| it.is_lt())
        });
        if is_better {
            *best = Some((score, boxes));
        }
    })?;
    Ok(best.into_inner().expect("no watcher panics").map(|(_, boxes)| boxes))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builders::naive::wide::Wide;
    use crate::builders::phr::cut::SPACE;
    use crate::builders::testing::soup;
    use crate::builders::{NAMES, by_name, cuts_of};

    /// Watching changes no node: without shortcuts only triangles of a leaf may stand in another order.
    #[test]
    fn a_watched_build_has_the_same_tree() {
        for (n, size) in [(3, 0.5), (600, 0.3), (5000, 0.05)] {
            let mesh = soup(n, size, n as u64);
            let over_cuts: Vec<&str> = NAMES.iter().copied().filter(|name| cuts_of(name).is_some()).collect();
            assert_eq!(over_cuts.len(), 7);
            for name in over_cuts.into_iter().filter(|name| *name != "phr-best") {
                let config = cuts_of(name).unwrap();
                let seen = AtomicU64::new(0);
                let tree = watched(&mesh, &config, &|_| {
                    seen.fetch_add(1, Ordering::Relaxed);
                });
                let built = by_name::<4>(name).unwrap().build(&mesh);
                let [tree, expected] = [&tree.unwrap(), &built.tree].map(Wide::of_tree);
                let difference = Wide::difference(tree.as_ref(), expected.as_ref());
                assert_eq!(difference, None, "{name} over {n} triangles");
                assert!(n == 3 || seen.into_inner() > 0, "{name} over {n} triangles");
            }
        }
    }

    #[test]
    fn the_first_cut_is_the_initial_one_and_hunts_are_of_constant_length() {
        let mesh = soup(5000, 0.05, 1);
        let sizes = cut_sizes(&mesh, &cuts_of("hunt-50").unwrap()).unwrap();
        assert_eq!(sizes[0], CutsAtDepth { depth: 0, cuts: 1, nodes: 50 });
        assert_eq!(sizes[1], CutsAtDepth { depth: 1, cuts: 2, nodes: 100 });
        let fast = cut_sizes(&mesh, &cuts_of("phr-fast").unwrap()).unwrap();
        let hq = cut_sizes(&mesh, &cuts_of("phr-hq").unwrap()).unwrap();
        assert!(fast[0].cuts == 1 && fast[0].nodes < hq[0].nodes, "{fast:?} {hq:?}");
    }

    #[test]
    fn the_chosen_split_does_not_depend_on_threads() {
        let mesh = soup(3000, 0.1, 2);
        let config = cuts_of("phr-hq").unwrap();
        let find = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let short = |split: &SplitBoxes| (split.cut.len() == 9).then(|| split.bounds().half_area());
            pool.install(|| best_split(&mesh, &config, short)).unwrap().unwrap()
        };
        let split = find(1);
        assert_eq!(split, find(4));
        assert!(split.cut.len() == 9 && split.sides.iter().all(|side| side.nodes().count() > 0));
    }

    /// Every node of a refined side is a node that stays or a child of one that was opened, whatever their boxes.
    #[test]
    fn nodes_that_were_opened_are_told_with_their_children() {
        let mesh = soup(3000, 0.3, 2);
        let config = cuts_of("phr-fast").unwrap();
        let opened = AtomicU64::new(0);
        watched(&mesh, &config, &|split| {
            let boxes = SplitBoxes::of(split);
            for (side, (nodes, refined)) in boxes.sides.iter().zip(split.sides.iter().zip(split.refined)) {
                assert_eq!((side.nodes().count(), side.refined().count()), (nodes.len(), refined.len()));
                for node in &side.opened {
                    assert_eq!(node.children.len() + node.discarded.len(), 2);
                    opened.fetch_add(1, Ordering::Relaxed);
                }
                let cut_off = side.opened.iter().any(|node| !node.discarded.is_empty());
                assert!(!cut_off || side.clip != SPACE, "nothing is discarded before a plane has cut space");
            }
        })
        .unwrap();
        assert!(opened.into_inner() > 100);
    }
}
