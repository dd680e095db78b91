//! Indexed triangle meshes, valid by construction.

#![allow(unsafe_code)]

use super::mesh_error::{Dropped, MeshError, MoveError};
use super::{Aabb, Ray};
use crate::memory::huge_pages;
use glam::{Vec3A, Vec4};

/// An indexed triangle mesh. Every index is in range and every triangle's vertices are finite and below
/// [`Ray::LARGEST`], so that triangle ids mean the same to every builder, Embree's included.
#[derive(Clone, Debug)]
pub struct Mesh {
    /// One vertex more than there is, so that 16-byte loads of the last one stay inside (Embree reads so too).
    padded_vertices: Vec<[f32; 3]>,
    triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// Most triangles a mesh may have, 67 million: with four references to each, alone in a leaf block of its
    /// own, a tree still has no more than the 2^28 blocks that its links can name.
    pub const MAX_TRIANGLES: usize = 1 << 26;

    /// Takes vertices (x, y, z in scene units) and triangles (three vertex indices); drops and counts the
    /// triangles that no builder can hold. A mesh without triangles is allowed here: builders are total.
    ///
    /// Where triangles are dropped, those after them move up: a hit's `prim` is an index into
    /// [`Mesh::triangles`] and no longer one into the list that was given. [`Mesh::with_kept`] tells which are kept.
    ///
    /// # Errors
    /// [`MeshError::TooLarge`] beyond [`Mesh::MAX_TRIANGLES`], [`MeshError::OutOfMemory`].
    pub fn new(vertices: Vec<[f32; 3]>, triangles: Vec<[u32; 3]>) -> Result<(Self, Dropped), MeshError> {
        Self::sifted(vertices, triangles, None).map(|(mesh, dropped, _)| (mesh, dropped))
    }

    /// As [`Mesh::new`], with the index among the `triangles` given of each that is kept, by its index in the mesh,
    /// so that attributes by triangle are found from a hit's `prim`. `None` where no triangle was dropped: these are
    /// the same then.
    ///
    /// ```
    /// # use phr::geometry::Mesh;
    /// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    /// let (mesh, dropped, kept) = Mesh::with_kept(corners, vec![[0, 1, 2], [0, 1, 9], [2, 1, 0]])?;
    /// assert_eq!((mesh.len(), dropped.total(), kept), (2, 1, Some(vec![0, 2])));
    /// # Ok::<(), phr::geometry::MeshError>(())
    /// ```
    ///
    /// # Errors
    /// As [`Mesh::new`].
    pub fn with_kept(
        vertices: Vec<[f32; 3]>,
        triangles: Vec<[u32; 3]>,
    ) -> Result<(Self, Dropped, Option<Vec<u32>>), MeshError> {
        let mut kept = Vec::new();
        let (mesh, dropped, first) = Self::sifted(vertices, triangles, Some(&mut kept))?;
        Ok((mesh, dropped, first.map(|_| kept)))
    }

    /// As [`Mesh::new`], with the first triangle dropped: its place among those given. Where there is one, `kept` gets
    /// the places of all that are not.
    pub(crate) fn sifted(
        vertices: Vec<[f32; 3]>,
        triangles: Vec<[u32; 3]>,
        mut kept: Option<&mut Vec<u32>>,
    ) -> Result<(Self, Dropped, Option<usize>), MeshError> {
        if triangles.len() > Self::MAX_TRIANGLES {
            return Err(MeshError::TooLarge(triangles.len()));
        }
        let mut dropped = Dropped::default();
        let mut finite: Vec<bool> = Vec::new();
        huge_pages::try_reserve(&mut finite, vertices.len(), "a check of vertices")?;
        finite.extend(vertices.iter().map(|v| v.iter().all(|x| x.abs() < Ray::LARGEST)));
        let corners = |t: &[u32; 3]| t.map(|i| finite.get(i as usize).copied());
        let first = triangles.iter().position(|t| corners(t) != [Some(true); 3]);
        let mut triangles = triangles;
        if first.is_some() {
            if let Some(kept) = kept.as_deref_mut() {
                huge_pages::try_reserve(kept, triangles.len() - 1, "places of triangles")?;
            }
            // Not more than 2^26.
            let mut place = 0;
            triangles.retain(|t| {
                let corners = corners(t);
                let is_kept = corners == [Some(true); 3];
                if is_kept {
                    kept.iter_mut().for_each(|kept| kept.push(place));
                } else if corners.contains(&None) {
                    dropped.out_of_range += 1;
                } else {
                    dropped.non_finite += 1;
                }
                place += 1;
                is_kept
            });
        }
        let mut padded_vertices = vertices;
        // No more: `push` might double what millions of vertices take.
        let all = padded_vertices.len() + 1;
        huge_pages::try_reserve(&mut padded_vertices, all, "vertices")?;
        padded_vertices.push([0.0; 3]);
        Ok((Self { padded_vertices, triangles }, dropped, first))
    }

    /// Moves the vertices, in their order. Triangles keep their vertices and ids, so that trees over the mesh can be
    /// refitted.
    ///
    /// # Errors
    /// [`MoveError`]; the mesh is as before then.
    pub fn move_vertices(&mut self, vertices: &[[f32; 3]]) -> Result<(), MoveError> {
        let (given, own) = (vertices.len(), self.vertices().len());
        if given != own {
            return Err(MoveError::Count { given, vertices: own });
        }
        let is_bad = |vertex: &[f32; 3]| !vertex.iter().all(|x| x.abs() < Ray::LARGEST);
        // Vertices in no triangle may be anywhere.
        if vertices.iter().any(is_bad)
            && let Some(&bad) = self.triangles.iter().flatten().find(|&&i| is_bad(&vertices[i as usize]))
        {
            return Err(MoveError::NotFinite(bad));
        }
        self.padded_vertices[..own].copy_from_slice(vertices);
        Ok(())
    }

    /// Number of triangles.
    #[inline]
    pub fn len(&self) -> usize {
        self.triangles.len()
    }

    /// True without triangles.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// The vertices, x, y, z in scene units.
    #[inline]
    pub fn vertices(&self) -> &[[f32; 3]] {
        &self.padded_vertices[..self.padded_vertices.len() - 1]
    }

    /// The vertices followed by one of padding, for APIs that read 16 bytes per vertex.
    #[inline]
    pub fn padded_vertices(&self) -> &[[f32; 3]] {
        &self.padded_vertices
    }

    /// The triangles as vertex indices, all in range.
    #[inline]
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The three corners of triangle `prim`.
    ///
    /// # Panics
    /// If there is no such triangle.
    #[inline(always)]
    pub fn corners(&self, prim: u32) -> [Vec3A; 3] {
        self.corners_of(&self.triangles[prim as usize])
    }

    /// The corners of one of [`Mesh::triangles`].
    ///
    /// # Panics
    /// If the mesh has no such vertices.
    #[inline(always)]
    pub fn corners_of(&self, triangle: &[u32; 3]) -> [Vec3A; 3] {
        let [a, b, c] = *triangle;
        [self.vertex(a), self.vertex(b), self.vertex(c)]
    }

    #[inline(always)]
    fn vertex(&self, i: u32) -> Vec3A {
        // The fourth float is the next vertex's first, or the padding's.
        let floats = self.padded_vertices.as_flattened()[3 * i as usize..].first_chunk();
        Vec3A::from_vec4(vector_of(floats.expect("vertices of triangles are in range")))
    }

    /// The box of triangle `prim`.
    ///
    /// # Panics
    /// If there is no such triangle.
    #[inline]
    pub fn bounds_of(&self, prim: u32) -> Aabb {
        Aabb::of_triangle(self.corners(prim))
    }

    /// The box of all triangles (vertices in no triangle do not count).
    pub fn bounds(&self) -> Aabb {
        use rayon::prelude::*;
        (0..self.len() as u32)
            .into_par_iter()
            .with_min_len(1 << 14)
            .map(|prim| self.bounds_of(prim))
            .reduce(|| Aabb::EMPTY, Aabb::union)
    }
}

/// Loads four floats at once. Put together one by one, they are loaded again for each use that needs fewer.
#[inline(always)]
fn vector_of(floats: &[f32; 4]) -> Vec4 {
    // SAFETY: the floats may be read, and any four are a vector.
    unsafe { std::ptr::from_ref(floats).cast::<Vec4>().read_unaligned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bad_triangles_are_dropped_and_counted() {
        let vertices = vec![
            [0.0; 3],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [f32::NAN, 0.0, 0.0],
            [0.0, f32::INFINITY, 0.0],
            [2e18, 0.0, 0.0],
        ];
        let triangles = vec![[0, 1, 2], [0, 1, 3], [0, 1, 4], [0, 1, 5], [0, 1, 6]];
        let (mesh, dropped) = Mesh::new(vertices, triangles).unwrap();
        assert_eq!(mesh.triangles(), &[[0, 1, 2]]);
        assert_eq!(dropped, Dropped { non_finite: 3, out_of_range: 1 });
        assert_eq!(mesh.bounds(), mesh.bounds_of(0));
        let told = "4 triangles dropped: 3 with non-finite or huge vertices, 1 with indices out of range";
        assert_eq!(dropped.to_string(), told);
        let one = Dropped { non_finite: 0, out_of_range: 1 };
        assert_eq!(one.to_string(), "1 triangle dropped: 1 with indices out of range");
        let (_, _, first) =
            Mesh::sifted(vec![[0.0; 3]; 3], vec![[0, 1, 2], [0, 1, 3], [3, 3, 3]], None).unwrap();
        assert_eq!(first, Some(1));
    }

    #[test]
    fn kept_triangles_are_found_among_those_given() {
        let vertices = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [f32::NAN, 0.0, 0.0]];
        let given = vec![[3, 1, 2], [0, 1, 2], [0, 1, 4], [1, 2, 0], [2, 3, 0], [2, 0, 1]];
        let (mesh, dropped, kept) = Mesh::with_kept(vertices.clone(), given.clone()).unwrap();
        assert_eq!(dropped, Dropped { non_finite: 2, out_of_range: 1 });
        let kept = kept.unwrap();
        assert_eq!(kept, [1, 3, 5]);
        let found: Vec<_> = kept.iter().map(|&place| given[place as usize]).collect();
        assert_eq!(mesh.triangles(), found);
        let (_, _, kept) = Mesh::with_kept(vertices.clone(), vec![[0, 1, 2]]).unwrap();
        assert_eq!(kept, None, "all are");
        let (_, _, kept) = Mesh::with_kept(vertices, vec![[0, 1, 3]]).unwrap();
        assert_eq!(kept, Some(vec![]), "none is");
    }

    #[test]
    fn an_empty_mesh_is_no_error() {
        assert!(Mesh::new(vec![], vec![]).unwrap().0.is_empty());
    }

    #[test]
    fn vertices_move_all_together_or_not_at_all() {
        let vertices = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [f32::NAN; 3]];
        let (mut mesh, _) = Mesh::new(vertices.clone(), vec![[0, 1, 2]]).unwrap();
        let moved: Vec<[f32; 3]> = vertices.iter().map(|v| v.map(|x| x + 2.0)).collect();
        mesh.move_vertices(&moved).unwrap();
        assert_eq!(mesh.bounds().min, Vec3A::splat(2.0));
        let bad = [moved[0], [f32::INFINITY; 3], moved[2], moved[3]];
        assert_eq!(mesh.move_vertices(&bad), Err(MoveError::NotFinite(1)));
        assert_eq!(mesh.move_vertices(&moved[1..]), Err(MoveError::Count { given: 3, vertices: 4 }));
        assert_eq!(mesh.vertices()[1], moved[1]);
    }
}
