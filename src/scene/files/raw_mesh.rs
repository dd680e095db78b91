//! A mesh as a file gives it, before vertices and triangles are checked against each other.

use super::guard::{Guard, Refused};
use crate::scene::model::Contents;
use glam::Vec3;

/// Vertices and triangles as read. They grow within the guard's limits.
pub(super) struct RawMesh<'a> {
    guard: &'a Guard,
    /// Bytes held beside the mesh while it is read.
    pub held: u64,
    /// x, y, z.
    pub vertices: Vec<[f32; 3]>,
    /// Vertex indices; [`RawMesh::NO_VERTEX`] stands for an index beyond 32 bits.
    pub triangles: Vec<[u32; 3]>,
    /// Triangles already left out because of such an index.
    pub out_of_range: usize,
    /// Where the first triangle with such an index or one beyond the vertices is, where the reader knows.
    pub first_out_of_range: Option<String>,
    /// What the file had besides.
    pub contents: Contents,
    /// Cameras of the file itself, which are not applied.
    pub cameras: usize,
    /// The axis that the format calls up, if it does.
    pub up: Option<Vec3>,
}

impl<'a> RawMesh<'a> {
    /// An index out of range in every mesh.
    pub const NO_VERTEX: u32 = u32::MAX;
    /// Entries for which there is room at first: a header may lie.
    const FIRST: usize = 1 << 10;

    pub fn new(guard: &'a Guard) -> Self {
        Self {
            guard,
            held: 0,
            vertices: Vec::new(),
            triangles: Vec::new(),
            out_of_range: 0,
            first_out_of_range: None,
            contents: Contents::default(),
            cameras: 0,
            up: None,
        }
    }

    #[inline]
    pub fn push_vertex(&mut self, vertex: [f32; 3]) -> Result<(), Refused> {
        if self.vertices.len() == self.vertices.capacity() {
            let held = self.held.saturating_add(bytes(&self.triangles));
            grow(self.guard, &mut self.vertices, held)?;
        }
        self.vertices.push(vertex);
        Ok(())
    }

    #[inline]
    pub fn push_triangle(&mut self, triangle: [u32; 3]) -> Result<(), Refused> {
        if self.triangles.len() == self.triangles.capacity() {
            self.guard.allow_triangles(self.triangles.len() as u64 + 1)?;
            let held = self.held.saturating_add(bytes(&self.vertices));
            grow(self.guard, &mut self.triangles, held)?;
        }
        self.triangles.push(triangle);
        Ok(())
    }

    /// Room for `more` indices in `list`, beside the mesh.
    pub fn reserve_beside(&self, list: &mut Vec<u32>, more: usize) -> Result<(), Refused> {
        let mesh = bytes(&self.vertices).saturating_add(bytes(&self.triangles));
        self.guard.allow((more as u64).saturating_mul(4).saturating_add(mesh).saturating_add(self.held))?;
        self.guard.reserve(list, more)
    }

    /// Refuses so many vertices and triangles more where they are too many, without taking memory.
    pub fn announce(&self, vertices: u64, triangles: u64) -> Result<(), Refused> {
        let more = vertices.saturating_add(triangles).saturating_mul(size_of::<[f32; 3]>() as u64);
        let mesh = size_of::<[f32; 3]>() * (self.vertices.len() + self.triangles.len());
        self.guard.allow(more.saturating_add(mesh as u64).saturating_add(self.held))?;
        self.guard.allow_triangles(triangles.saturating_add(self.triangles.len() as u64))
    }
}

fn bytes<T>(list: &Vec<T>) -> u64 {
    (list.capacity() * size_of::<T>()) as u64
}

/// Doubles `list` beside `held` other bytes; by less where only that is allowed.
#[cold]
fn grow<T>(guard: &Guard, list: &mut Vec<T>, held: u64) -> Result<(), Refused> {
    let left = guard.memory().saturating_sub(held.saturating_add(bytes(list))) / size_of::<T>() as u64;
    let more = list.capacity().max(RawMesh::FIRST).min(usize::try_from(left).unwrap_or(usize::MAX));
    if more == 0 {
        guard.allow(guard.memory().saturating_add(1))?;
    }
    guard.reserve(list, more)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::files::guard::Limits;

    #[test]
    fn a_mesh_grows_up_to_its_limit() {
        let guard = Guard::new(&Limits { memory: 12 * 5000 });
        let mut raw = RawMesh::new(&guard);
        for i in 0..2000 {
            raw.push_vertex([i as f32; 3]).unwrap();
        }
        let mut triangles = 0;
        while raw.push_triangle([0, 1, 2]).is_ok() {
            triangles += 1;
            assert!(triangles < 10_000);
        }
        assert!(triangles >= 2000 && raw.vertices.len() + raw.triangles.len() <= 5000, "{triangles}");
        assert!(guard.reason().is_some());
        assert!(raw.announce(1, u64::MAX).is_err());
    }
}
