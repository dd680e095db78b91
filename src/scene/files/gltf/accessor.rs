//! Accessors: typed elements in a view of a buffer, some of them replaced by sparse ones.

use super::buffers::Buffers;
use crate::scene::files::error::Fault;
use gltf::json::accessor::{Accessor, ComponentType, Type};
use gltf::json::validation::Checked;
use gltf::json::{Index, Root, buffer};

/// Elements that lie within their bytes.
struct Elements<'a> {
    bytes: &'a [u8],
    stride: usize,
    count: usize,
    component: ComponentType,
    is_normalized: bool,
}

impl<'a> Elements<'a> {
    /// `count` elements of `width` components from `offset` on in a view, for accessor `index`.
    fn new(
        buffers: &'a Buffers,
        root: &Root,
        (index, view): (usize, Index<buffer::View>),
        [offset, count]: [u64; 2],
        component: ComponentType,
        width: usize,
    ) -> Result<Self, Fault> {
        let fault = |problem: &str| {
            let place = format!("accessor {index}, bufferView {}", view.value());
            Fault::new(place, problem, Fault::DAMAGED)
        };
        let bytes = buffers
            .view(root, view)
            .map_err(|of_view| Fault { place: format!("accessor {index}, {}", of_view.place), ..of_view })?;
        let size = component.size() * width;
        let stride = root.buffer_views.get(view.value()).and_then(|view| view.byte_stride);
        let stride = stride.map_or(size, |stride| stride.0);
        if stride < size {
            return Err(fault("a stride shorter than an element"));
        }
        let end = match count.checked_sub(1) {
            None => Some(offset),
            Some(last) => last
                .checked_mul(stride as u64)
                .and_then(|at| at.checked_add(offset)?.checked_add(size as u64)),
        };
        let range = end.and_then(|end| Some(usize::try_from(offset).ok()?..usize::try_from(end).ok()?));
        let bytes =
            range.and_then(|range| bytes.get(range)).ok_or_else(|| fault("ends before its last element"))?;
        Ok(Self { bytes, stride, count: count as usize, component, is_normalized: false })
    }

    /// Component `axis` of element `index`, both in range: the bytes of it.
    #[inline]
    #[allow(clippy::indexing_slicing, reason = "`new` has seen that all elements lie within the bytes")]
    fn raw<const N: usize>(&self, index: usize, axis: usize) -> [u8; N] {
        let at = index * self.stride + axis * N;
        std::array::from_fn(|i| self.bytes[at + i])
    }

    #[inline]
    fn integer(&self, index: usize) -> u32 {
        match self.component {
            ComponentType::U8 => u8::from_le_bytes(self.raw(index, 0)).into(),
            ComponentType::U16 => u16::from_le_bytes(self.raw(index, 0)).into(),
            _ => u32::from_le_bytes(self.raw(index, 0)),
        }
    }

    #[inline]
    fn float(&self, index: usize, axis: usize) -> f32 {
        let (value, most) = match self.component {
            ComponentType::F32 => return f32::from_le_bytes(self.raw(index, axis)),
            ComponentType::I8 => (f32::from(i8::from_le_bytes(self.raw(index, axis))), 127.0),
            ComponentType::U8 => (f32::from(u8::from_le_bytes(self.raw(index, axis))), 255.0),
            ComponentType::I16 => (f32::from(i16::from_le_bytes(self.raw(index, axis))), 32_767.0),
            ComponentType::U16 => (f32::from(u16::from_le_bytes(self.raw(index, axis))), 65_535.0),
            ComponentType::U32 => return u32::from_le_bytes(self.raw(index, axis)) as f32,
        };
        if self.is_normalized { (value / most).max(-1.0) } else { value }
    }

    fn vector(&self, index: usize) -> [f32; 3] {
        [0, 1, 2].map(|axis| self.float(index, axis))
    }
}

/// The accessor `index`, its component type and its type; a fault where there is none such.
pub(super) fn accessor(root: &Root, index: usize) -> Result<(&Accessor, ComponentType, Type), Fault> {
    let fault = |problem: &str| Fault::new(format!("accessor {index}"), problem, Fault::DAMAGED);
    let accessor = root.accessors.get(index).ok_or_else(|| fault("there is no such accessor"))?;
    match (&accessor.component_type, &accessor.type_) {
        (Checked::Valid(component), Checked::Valid(of)) => Ok((accessor, component.0, *of)),
        _ => Err(fault("of an unknown type")),
    }
}

/// Hands the positions of an accessor to `push`, in order, and returns those that replace some of them, with their
/// places.
pub(super) fn positions(
    root: &Root,
    buffers: &Buffers,
    index: usize,
    mut push: impl FnMut([f32; 3]) -> Result<(), Fault>,
) -> Result<Vec<(usize, [f32; 3])>, Fault> {
    let (accessor, component, of) = accessor(root, index)?;
    if of != Type::Vec3 {
        return Err(Fault::new(
            format!("accessor {index}"),
            "positions that are no vectors of three",
            Fault::DAMAGED,
        ));
    }
    let read = Read { root, buffers, accessor, index, component, width: 3 };
    match read.base()? {
        Some(base) => (0..base.count).try_for_each(|i| push(base.vector(i)))?,
        None => (0..accessor.count.0).try_for_each(|_| push([0.0; 3]))?,
    }
    let Some((places, values)) = read.sparse()? else { return Ok(Vec::new()) };
    (0..places.count).map(|i| Ok((read.place(&places, i)?, values.vector(i)))).collect()
}

/// Appends the indices of an accessor to `out`, which has room for them.
pub(super) fn indices(root: &Root, buffers: &Buffers, index: usize, out: &mut Vec<u32>) -> Result<(), Fault> {
    let (accessor, component, of) = accessor(root, index)?;
    if of != Type::Scalar || !matches!(component, ComponentType::U8 | ComponentType::U16 | ComponentType::U32)
    {
        return Err(Fault::new(
            format!("accessor {index}"),
            "indices that are no counting numbers",
            Fault::DAMAGED,
        ));
    }
    let read = Read { root, buffers, accessor, index, component, width: 1 };
    match read.base()? {
        Some(base) => out.extend((0..base.count).map(|i| base.integer(i))),
        None => out.extend((0..accessor.count.0).map(|_| 0)),
    }
    if let Some((places, values)) = read.sparse()? {
        for i in 0..places.count {
            let place = read.place(&places, i)?;
            *out.get_mut(place).ok_or_else(|| read.fault("fewer elements than it says"))? = values.integer(i);
        }
    }
    Ok(())
}

/// An accessor about to be read.
struct Read<'a> {
    root: &'a Root,
    buffers: &'a Buffers,
    accessor: &'a Accessor,
    index: usize,
    component: ComponentType,
    width: usize,
}

impl<'a> Read<'a> {
    fn elements(&self, view: Index<buffer::View>, range: [u64; 2]) -> Result<Elements<'a>, Fault> {
        let place = (self.index, view);
        let elements = Elements::new(self.buffers, self.root, place, range, self.component, self.width)?;
        Ok(Elements { is_normalized: self.accessor.normalized, ..elements })
    }

    /// The elements as such; `None` where all are zero but for sparse ones.
    fn base(&self) -> Result<Option<Elements<'a>>, Fault> {
        let range = [self.accessor.byte_offset.map_or(0, |offset| offset.0), self.accessor.count.0];
        match self.accessor.buffer_view {
            Some(view) => self.elements(view, range).map(Some),
            None if self.accessor.sparse.is_some() => Ok(None),
            None => {
                let place = format!("accessor {}", self.index);
                let problem = "no data: compressed, perhaps";
                Err(Fault::new(place, problem, "decompress it, as `gltf-transform copy` does"))
            }
        }
    }

    /// Which elements are replaced, and by which.
    fn sparse(&self) -> Result<Option<(Elements<'a>, Elements<'a>)>, Fault> {
        let Some(sparse) = &self.accessor.sparse else { return Ok(None) };
        let count = sparse.count.0;
        let Checked::Valid(component) = &sparse.indices.component_type else {
            return Err(self.fault("sparse indices of an unknown type"));
        };
        if count > self.accessor.count.0 {
            return Err(self.fault("more sparse elements than elements"));
        }
        let range = [sparse.indices.byte_offset.0, count];
        let place = (self.index, sparse.indices.buffer_view);
        let places = Elements::new(self.buffers, self.root, place, range, component.0, 1)?;
        let values = self.elements(sparse.values.buffer_view, [sparse.values.byte_offset.0, count])?;
        Ok(Some((places, values)))
    }

    /// The element that sparse element `i` replaces.
    fn place(&self, places: &Elements<'_>, i: usize) -> Result<usize, Fault> {
        let place = places.integer(i);
        if u64::from(place) < self.accessor.count.0 {
            Ok(place as usize)
        } else {
            Err(self.fault("a sparse element beyond the last"))
        }
    }

    fn fault(&self, problem: &str) -> Fault {
        Fault::new(format!("accessor {}", self.index), problem, Fault::DAMAGED)
    }
}
