//! Cameras of a `views.json` beside a scene file.
//!
//! It may be another program's file of the same name, of any size and content: of it no more is read than a bound, and
//! nothing kept but the cameras of the scene.

use super::error::{Fault, SHORT, SceneError};
use super::source::read_small;
use crate::scene::one_line::one_line;
use crate::scene::views::View;
use serde::de::{DeserializeSeed, Deserializer, IgnoredAny, MapAccess, Visitor};
use std::collections::HashMap;
use std::path::Path;

/// Bytes that are read, some thousands of cameras.
const MOST_BYTES: u64 = 1 << 20;

const REMEDY: &str =
    r#"write {"SCENE": [{"eye": [x, y, z], "target": [x, y, z], "up": [x, y, z], "fov_y_deg": a}]}"#;

/// The cameras that `views.json` beside the scene file gives under `name`; none where there is no such file or entry. A
/// file of JSON that holds something else is told in `remarks`, as is a folder or what is too large or cannot be read.
///
/// # Errors
/// [`SceneError::Malformed`]: no JSON, or cameras of `name` that cannot be used.
pub(super) fn beside(scene: &Path, name: &str, remarks: &mut Vec<String>) -> Result<Vec<View>, SceneError> {
    let path = scene.with_file_name("views.json");
    let text = match read_small(&path, MOST_BYTES) {
        Ok(text) => text,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(Vec::new()),
        Err(error) => {
            remarks.push(format!("views.json is not read: {error}"));
            return Ok(Vec::new());
        }
    };
    let views = of_scene(&text, name).map_err(|error| {
        let place = format!("line {} column {}", error.line(), error.column());
        let problem = error.to_string();
        let problem = problem.strip_suffix(&format!(" at {place}")).unwrap_or(&problem);
        Fault::new(place, problem, REMEDY).in_file(&path)
    })?;
    let name = one_line(name, SHORT);
    let Some(views) = views else {
        if !is_of_scenes(&text) {
            remarks.push(format!("views.json has no cameras of {name} ({REMEDY})"));
        }
        return Ok(Vec::new());
    };
    for (i, view) in views.iter().enumerate() {
        view.check().map_err(|error| {
            let place = format!("view {i} of {name}");
            Fault::new(place, &error.to_string(), "give three finite vectors and an angle").in_file(&path)
        })?;
    }
    Ok(views)
}

/// What the JSON object `text` holds under `name`; `None` without it, and of JSON that is no object.
fn of_scene(text: &[u8], name: &str) -> Result<Option<Vec<View>>, serde_json::Error> {
    if !text.trim_ascii_start().starts_with(b"{") {
        return serde_json::from_slice(text).map(|IgnoredAny| None);
    }
    let mut json = serde_json::Deserializer::from_slice(text);
    let views = Entry(name).deserialize(&mut json)?;
    json.end()?;
    Ok(views)
}

/// Whether a file has the cameras of other scenes.
fn is_of_scenes(text: &[u8]) -> bool {
    serde_json::from_slice::<HashMap<String, Vec<View>>>(text).is_ok()
}

/// Looks for an entry by its name; others are passed over, whatever they hold.
struct Entry<'a>(&'a str);

impl<'de> DeserializeSeed<'de> for Entry<'_> {
    type Value = Option<Vec<View>>;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Self::Value, D::Error> {
        deserializer.deserialize_map(self)
    }
}

impl<'de> Visitor<'de> for Entry<'_> {
    type Value = Option<Vec<View>>;

    fn expecting(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str("cameras by scene")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
        let mut found = None;
        while let Some(name) = map.next_key::<String>()? {
            if name == self.0 {
                found = Some(map.next_value()?);
            } else {
                map.next_value::<IgnoredAny>()?;
            }
        }
        Ok(found)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_entry_of_the_scene_is_looked_at() {
        let found = |text: &str| of_scene(text.as_bytes(), "a").map(|views| views.map(|views| views.len()));
        let view = r#"{"eye": [1, 2, 3], "target": [0, 0, 0], "up": [0, 0, 1], "fov_y_deg": 50}"#;
        assert_eq!(
            found(&format!(r#"{{"b": [{{"fov": 3}}], "\u0061": [{view}], "c": 3}}"#)).unwrap(),
            Some(1)
        );
        for none in ["{}", r#"{"b": {"a": 3}}"#, "[1, 2]", "3", r#""a""#, "null"] {
            assert_eq!(found(none).unwrap(), None, "{none}");
        }
        let deep = format!(r#"{{"b": {}{}}}"#, "[".repeat(100_000), "]".repeat(100_000));
        assert_eq!(found(&deep).unwrap(), None, "without recursion");
        for bad in ["", "{", r#"{"a": 3}"#, r#"{"a": null}"#, r#"{"b": 3} 4"#, "[1", "// a comment"] {
            assert!(found(bad).is_err(), "{bad}");
        }
    }
}
