//! The sizes of scenes whose hits single precision holds.

use crate::geometry::Mesh;

/// The test of a triangle multiplies two edges and a distance: in larger scenes, or smaller ones, these products leave
/// the range of `f32`, in Embree's kernels as in ours, and hits are lost.
const SIZES: std::ops::RangeInclusive<f32> = 1e-12..=1e12;

/// Refuses a mesh through which rays lose their hits.
///
/// # Errors
/// Its size and the remedy, in one line.
pub(crate) fn check_size(mesh: &Mesh) -> Result<(), String> {
    let size = mesh.bounds().extent().max_element();
    // Of no triangle, or all in one point, there is nothing to lose.
    if mesh.is_empty() || size == 0.0 || SIZES.contains(&size) {
        return Ok(());
    }
    let (least, most) = (SIZES.start(), SIZES.end());
    Err(format!(
        "{size:.1e} across: below {least:e} and above {most:e} tests of triangles in single precision lose hits; \
         scale the scene"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_at_the_ends_of_the_range_are_refused() {
        let of = |size: f32| {
            let vertices = vec![[0.0; 3], [size, 0.0, 0.0], [0.0, size, 0.0]];
            check_size(&Mesh::new(vertices, vec![[0, 1, 2]]).unwrap().0)
        };
        for size in [0.0, 1e-12, 1.0, 1e12] {
            assert_eq!(of(size), Ok(()));
        }
        for size in [1e-13, 2e12, 1e13, 1e18] {
            assert!(of(size).unwrap_err().contains("across: below 1e-12 and above 1e12"), "{size}");
        }
        assert_eq!(check_size(&Mesh::new(Vec::new(), Vec::new()).unwrap().0), Ok(()));
    }
}
