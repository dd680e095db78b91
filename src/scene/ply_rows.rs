//! The rows of a PLY file's elements, as `serde-ply` deserializes them.

use super::raw_mesh::RawMesh;
use serde::de::{DeserializeSeed, Deserializer, Error, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde_ply::PlyReader;
use std::fmt;
use std::io::BufRead;

/// Elements for which memory is reserved at most before one is read: a header may lie.
const TRUSTED_COUNT: usize = 1 << 20;
/// The names that exporters give a face's list.
pub(super) const INDEX_LISTS: [&str; 2] = ["vertex_indices", "vertex_index"];

/// Reads the next element into `out`. Returns the index of the row that failed and the reason, if one did.
pub(super) fn take<T: Rows>(
    ply: &mut PlyReader<impl BufRead>,
    out: &mut T,
) -> Result<Option<(usize, String)>, String> {
    let All { rows, stopped } = ply.next_element::<All<T>>().map_err(|e| explain(&e.0.to_string()))?;
    *out = rows;
    Ok(stopped)
}

/// `serde-ply`'s messages in plain words.
pub(super) fn explain(message: &str) -> String {
    let message = message.trim_start_matches("Error while deserializing ply: ");
    match message {
        "failed to fill whole buffer" | "unexpected end of file" => "the data ends here".to_owned(),
        _ => message.replacen("Failed to parse", "no number, cannot read", 1),
    }
}

/// A collection filled row by row.
pub(super) trait Rows: Default {
    fn reserve(&mut self, rows: usize);
    fn take<'de, A: SeqAccess<'de>>(&mut self, rows: &mut A) -> Result<Option<()>, A::Error>;
}

/// `vertex`: x, y, z.
#[derive(Default)]
pub(super) struct Vertices(pub Vec<[f32; 3]>);
/// `face`: polygons as fans of triangles.
#[derive(Default)]
pub(super) struct Triangles(pub Vec<[u32; 3]>);
/// Any other element.
#[derive(Default)]
pub(super) struct Skipped;

impl Rows for Vertices {
    fn reserve(&mut self, rows: usize) {
        self.0.reserve(rows);
    }

    fn take<'de, A: SeqAccess<'de>>(&mut self, rows: &mut A) -> Result<Option<()>, A::Error> {
        #[derive(serde::Deserialize)]
        struct Vertex {
            x: f32,
            y: f32,
            z: f32,
        }
        Ok(rows.next_element()?.map(|Vertex { x, y, z }| self.0.push([x, y, z])))
    }
}

impl Rows for Triangles {
    fn reserve(&mut self, rows: usize) {
        self.0.reserve(rows);
    }

    fn take<'de, A: SeqAccess<'de>>(&mut self, rows: &mut A) -> Result<Option<()>, A::Error> {
        rows.next_element_seed(Face(&mut self.0))
    }
}

impl Rows for Skipped {
    fn reserve(&mut self, _: usize) {}

    fn take<'de, A: SeqAccess<'de>>(&mut self, rows: &mut A) -> Result<Option<()>, A::Error> {
        rows.next_element_seed(Face(&mut Vec::new()))
    }
}

/// All rows of an element up to the first that could not be read.
struct All<T> {
    rows: T,
    stopped: Option<(usize, String)>,
}

impl<'de, T: Rows> serde::Deserialize<'de> for All<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Each<T>(T);
        impl<'de, T: Rows> Visitor<'de> for Each<T> {
            type Value = All<T>;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("the rows of an element")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<All<T>, A::Error> {
                let mut rows = self.0;
                rows.reserve(seq.size_hint().unwrap_or(0).min(TRUSTED_COUNT));
                for row in 0.. {
                    match rows.take(&mut seq) {
                        Ok(Some(())) => {}
                        Ok(None) => break,
                        Err(e) => return Ok(All { rows, stopped: Some((row, e.to_string())) }),
                    }
                }
                Ok(All { rows, stopped: None })
            }
        }
        deserializer.deserialize_seq(Each(T::default()))
    }
}

/// A row whose list of vertices, if it has one, is appended as triangles.
struct Face<'a>(&'a mut Vec<[u32; 3]>);

impl<'de> DeserializeSeed<'de> for Face<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_map(self)
    }
}

impl<'de> Visitor<'de> for Face<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the properties of a face")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        while let Some(IsIndexList(is)) = map.next_key()? {
            if is {
                map.next_value_seed(Fan(self.0))?;
            } else {
                map.next_value::<IgnoredAny>()?;
            }
        }
        Ok(())
    }
}

/// Whether a property's name is one of [`INDEX_LISTS`].
struct IsIndexList(bool);

impl<'de> serde::Deserialize<'de> for IsIndexList {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Name;
        impl Visitor<'_> for Name {
            type Value = IsIndexList;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a property's name")
            }

            fn visit_bytes<E: Error>(self, name: &[u8]) -> Result<IsIndexList, E> {
                Ok(IsIndexList(INDEX_LISTS.iter().any(|list| list.as_bytes() == name)))
            }
        }
        deserializer.deserialize_identifier(Name)
    }
}

/// A list of vertices, appended as a fan of triangles around the first.
struct Fan<'a>(&'a mut Vec<[u32; 3]>);

impl<'de> DeserializeSeed<'de> for Fan<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_seq(self)
    }
}

impl<'de> Visitor<'de> for Fan<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a list of vertices")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<(), A::Error> {
        let Some(Index(first)) = list.next_element()? else { return Ok(()) };
        let Some(Index(mut previous)) = list.next_element()? else { return Ok(()) };
        while let Some(Index(next)) = list.next_element()? {
            self.0.push([first, previous, next]);
            previous = next;
        }
        Ok(())
    }
}

/// A vertex index of any number type; [`RawMesh::NO_VERTEX`] where it is no index.
struct Index(u32);

impl<'de> serde::Deserialize<'de> for Index {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Number;
        impl Visitor<'_> for Number {
            type Value = Index;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a vertex index")
            }

            fn visit_i64<E: Error>(self, value: i64) -> Result<Index, E> {
                Ok(Index(u32::try_from(value).unwrap_or(RawMesh::NO_VERTEX)))
            }

            fn visit_u64<E: Error>(self, value: u64) -> Result<Index, E> {
                Ok(Index(u32::try_from(value).unwrap_or(RawMesh::NO_VERTEX)))
            }

            fn visit_f64<E: Error>(self, value: f64) -> Result<Index, E> {
                let index = value as u32;
                Ok(Index(if f64::from(index) == value { index } else { RawMesh::NO_VERTEX }))
            }
        }
        deserializer.deserialize_any(Number)
    }
}
