//! Builders of other crates, measured beside ours (feature `peers`): the presets of [`obvhs`] and [`svenstaro`]'s
//! `bvh`. A [`Peer`] builds its own structure from its own form of a mesh; what it built is then widened by our
//! collapse ([`crate::builders::widened`]), so that all trees are traced by the same kernels.

pub mod obvhs;
mod peer;
pub mod svenstaro;

pub use obvhs::Obvhs;
pub use peer::Peer;
pub use svenstaro::Svenstaro;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builders::{ForeignTree as _, widened};
    use crate::geometry::Mesh;
    use crate::scene::scalable;

    fn is_whole<P: Peer>(peer: &P, mesh: &Mesh) {
        let built = peer.build(&mut peer.input(mesh));
        let tree = peer.tree(&built);
        assert_eq!(tree.root().is_some(), !mesh.is_empty());
        let four = widened::<4>(&tree, mesh).unwrap();
        assert_eq!(four.validate(mesh), Ok(()));
        assert!(widened::<8>(&tree, mesh).unwrap().nodes.len() <= four.nodes.len());
    }

    #[test]
    fn their_trees_are_whole_in_both_widths() {
        for n in [1, 2, 5, 20_000] {
            let mesh = scalable(n, 1).mesh;
            Obvhs::ALL.iter().for_each(|obvhs| is_whole(obvhs, &mesh));
            is_whole(&Svenstaro, &mesh);
        }
    }

    #[test]
    fn versions_are_those_that_are_built() {
        let lock = include_str!("../../Cargo.lock");
        for (name, version) in [("obvhs", obvhs::VERSION), ("bvh", svenstaro::VERSION)] {
            assert!(
                lock.contains(&format!("name = \"{name}\"\nversion = \"{version}\"\n")),
                "{name} {version}"
            );
        }
    }
}
