//! What thresholds of area are relative to. The paper's are relative to the scene's area; choosing its parameters by
//! the scene is left open there (section 6). In a flat wide city most geometry is smaller than any threshold that suits
//! a room, so thresholds may be relative to the area of the scene's own parts.

use super::key::{MortonKey, reference};
use crate::builders::prims::geometry::Geometry;
use crate::builders::prims::refs::PrimRefs;
use crate::geometry::Aabb;
use crate::parallel;

/// References of a part of a scene.
pub(crate) const PART: usize = 2048;
/// Most parts that are measured.
pub(crate) const PARTS: usize = 64;
/// One of so many references of a part is measured.
pub(crate) const STRIDE: usize = 64;

/// Half areas of a scene.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct AreaScale {
    /// Of its box.
    pub scene: f32,
    /// What thresholds of clusters and of spatial splits are relative to: the scene's, or less with a calibration. That
    /// of equation 2 is relative to the scene's.
    pub relative_to: f32,
}

impl AreaScale {
    /// Those of a scene whose keys are sorted, or in the order of its tree. With a calibration thresholds are
    /// relative to so many times the median area of parts of the scene, runs of [`PART`] references along the Morton
    /// curve.
    pub fn in_order<G: Geometry>(
        scene: Aabb,
        keys: &[MortonKey],
        refs: &PrimRefs<'_, G>,
        calibration: Option<f32>,
    ) -> Self {
        let scene = scene.half_area();
        let Some(factor) = calibration else { return Self { scene, relative_to: scene } };
        let count = PARTS.min(keys.len() / PART);
        let area = |i: usize| {
            let first = i * keys.len() / count;
            let some = keys[first..first + PART].iter().step_by(STRIDE);
            some.map(|&key| refs.bounds(reference(key))).collect::<Aabb>().half_area()
        };
        let mut measured: Vec<f32> = parallel::map(0..count, area);
        measured.sort_by(f32::total_cmp);
        let median = measured.get(count / 2).copied().unwrap_or(f32::INFINITY);
        Self { scene, relative_to: scene.min(median * factor) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builders::lbvh::auxiliary::Auxiliary;
    use crate::builders::lbvh::config::AuxiliaryConfig;
    use crate::geometry::Mesh;

    /// Triangles of edge `size`, `n` by `n` of them `step` apart, on a plain of two triangles.
    fn city(n: usize, step: f32, size: f32) -> Mesh {
        let width = n as f32 * step;
        let mut vertices = vec![[0.0, 0.0, 0.0], [width, 0.0, 0.0], [0.0, width, 0.0], [width, width, 0.0]];
        for i in 0..n * n {
            let (x, y) = ((i % n) as f32 * step, (i / n) as f32 * step);
            vertices.extend([[x, y, 0.0], [x + size, y, size], [x, y + size, size]]);
        }
        let of_plain = [[0, 1, 2], [1, 2, 3]];
        let others = (0..(n * n) as u32).map(|i| [3 * i + 4, 3 * i + 5, 3 * i + 6]);
        Mesh::new(vertices, of_plain.into_iter().chain(others).collect()).unwrap().0
    }

    fn areas(mesh: &Mesh, calibration: Option<f32>) -> AreaScale {
        let mut auxiliary = Auxiliary::default();
        auxiliary.build(mesh, &AuxiliaryConfig { calibration, ..AuxiliaryConfig::PAPER });
        auxiliary.scale
    }

    #[test]
    fn areas_are_those_of_parts_where_the_scene_is_large_for_them() {
        let mesh = city(160, 10.0, 1.0);
        let scene = mesh.bounds().half_area();
        assert_eq!(areas(&mesh, None), AreaScale { scene, relative_to: scene });
        // A part of 2048 of the 160 x 160 is about a 12th of the scene, its box up to some times that.
        let part = areas(&mesh, Some(1.0)).relative_to / scene;
        assert!((0.04..0.5).contains(&part), "{part}");
        let half = areas(&mesh, Some(0.5));
        assert_eq!((half.scene, half.relative_to / scene), (scene, 0.5 * part));
        // No more than the scene's area, nor anything without a part.
        assert_eq!(areas(&mesh, Some(1e3)), AreaScale { scene, relative_to: scene });
        let small = city(40, 10.0, 1.0);
        assert_eq!(areas(&small, Some(1e-6)), areas(&small, None));
        assert_eq!(areas(&Mesh::new(vec![], vec![]).unwrap().0, Some(1.0)).relative_to, 0.0);
    }
}
