//! The rows of a PLY file's elements, as `serde-ply` deserializes them.

use super::raw_mesh::RawMesh;
use serde::de::{DeserializeSeed, Deserializer, Error, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde_ply::PlyReader;
use std::fmt;
use std::io::BufRead;

/// The names that exporters give a face's list.
pub(super) const INDEX_LISTS: [&str; 2] = ["vertex_indices", "vertex_index"];

/// Reads the next element into `rows`. Returns the index of the row that failed and the reason, if one did.
pub(super) fn take<R: BufRead>(
    mut ply: &mut PlyReader<R>,
    rows: impl Rows,
) -> Result<Option<(usize, String)>, String> {
    ply.next_value_seed(All(rows)).map_err(|e| explain(&e.0.to_string()))
}

/// `serde-ply`'s messages in plain words.
pub(super) fn explain(message: &str) -> String {
    let message = message.trim_start_matches("Error while deserializing ply: ");
    match message {
        "failed to fill whole buffer" | "unexpected end of file" => "the data ends here".to_owned(),
        _ => message.replacen("Failed to parse", "no number, cannot read", 1),
    }
}

/// What takes an element row by row; `None` after the last.
pub(super) trait Rows {
    fn take<'de, A: SeqAccess<'de>>(&mut self, rows: &mut A) -> Result<Option<()>, A::Error>;
}

/// `vertex`: x, y, z.
pub(super) struct Vertices<'a, 'g>(pub &'a mut RawMesh<'g>);
/// `face`: polygons as fans of triangles.
pub(super) struct Triangles<'a, 'g>(pub &'a mut RawMesh<'g>);
/// Any other element.
pub(super) struct Skipped;

impl Rows for Vertices<'_, '_> {
    fn take<'de, A: SeqAccess<'de>>(&mut self, rows: &mut A) -> Result<Option<()>, A::Error> {
        #[derive(serde::Deserialize)]
        struct Vertex {
            x: f32,
            y: f32,
            z: f32,
        }
        let Some(Vertex { x, y, z }) = rows.next_element()? else { return Ok(None) };
        self.0.push_vertex([x, y, z]).map_err(A::Error::custom).map(Some)
    }
}

impl Rows for Triangles<'_, '_> {
    fn take<'de, A: SeqAccess<'de>>(&mut self, rows: &mut A) -> Result<Option<()>, A::Error> {
        rows.next_element_seed(Face(self.0))
    }
}

impl Rows for Skipped {
    fn take<'de, A: SeqAccess<'de>>(&mut self, rows: &mut A) -> Result<Option<()>, A::Error> {
        struct Row;
        impl<'de> serde::Deserialize<'de> for Row {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                deserializer.deserialize_map(IgnoredAny).map(|_| Self)
            }
        }
        Ok(rows.next_element::<Row>()?.map(|_| ()))
    }
}

/// All rows of an element up to the first that could not be read: its index and the reason.
struct All<T>(T);

impl<'de, T: Rows> DeserializeSeed<'de> for All<T> {
    type Value = Option<(usize, String)>;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Self::Value, D::Error> {
        deserializer.deserialize_seq(self)
    }
}

impl<'de, T: Rows> Visitor<'de> for All<T> {
    type Value = Option<(usize, String)>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the rows of an element")
    }

    fn visit_seq<A: SeqAccess<'de>>(mut self, mut seq: A) -> Result<Self::Value, A::Error> {
        for row in 0.. {
            match self.0.take(&mut seq) {
                Ok(Some(())) => {}
                Ok(None) => break,
                Err(e) => return Ok(Some((row, e.to_string()))),
            }
        }
        Ok(None)
    }
}

/// A face, whose list of vertices is appended as triangles.
struct Face<'a, 'g>(&'a mut RawMesh<'g>);

impl<'de> DeserializeSeed<'de> for Face<'_, '_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_map(self)
    }
}

impl<'de> Visitor<'de> for Face<'_, '_> {
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
struct Fan<'a, 'g>(&'a mut RawMesh<'g>);

impl<'de> DeserializeSeed<'de> for Fan<'_, '_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_seq(self)
    }
}

impl<'de> Visitor<'de> for Fan<'_, '_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a list of vertices")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<(), A::Error> {
        let Some(Index(first)) = list.next_element()? else {
            self.0.contents.empty += 1;
            return Ok(());
        };
        let Some(Index(mut previous)) = list.next_element()? else {
            self.0.contents.points += 1;
            return Ok(());
        };
        let mut corners = 2;
        while let Some(Index(next)) = list.next_element()? {
            self.0.push_triangle([first, previous, next]).map_err(A::Error::custom)?;
            previous = next;
            corners = 3;
        }
        self.0.contents.lines += usize::from(corners == 2);
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
