//! Sort keys: a Morton code and the reference it belongs to.

/// `code << 32 | reference`.
pub(crate) type MortonKey = u64;

/// The key of a reference with the given code.
#[inline]
pub(crate) fn key_of(code: u32, reference: u32) -> MortonKey {
    u64::from(code) << 32 | u64::from(reference)
}

/// The reference of a key.
#[inline]
pub(crate) fn reference(key: MortonKey) -> u32 {
    key as u32
}

/// The code of a key.
#[inline]
pub(crate) fn code(key: MortonKey) -> u32 {
    (key >> 32) as u32
}
