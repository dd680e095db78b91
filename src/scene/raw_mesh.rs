//! A mesh as a file gives it, before vertices and triangles are checked against each other.

/// Vertices and triangles as read.
pub(super) struct RawMesh {
    /// x, y, z.
    pub vertices: Vec<[f32; 3]>,
    /// Vertex indices; [`RawMesh::NO_VERTEX`] stands for an index beyond 32 bits.
    pub triangles: Vec<[u32; 3]>,
    /// Triangles already left out because of such an index.
    pub out_of_range: usize,
}

impl RawMesh {
    /// An index out of range in every mesh.
    pub const NO_VERTEX: u32 = u32::MAX;
}
