//! The boxes of splits as CSV, from which the pictures are drawn.

#![cfg_attr(not(test), warn(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

use super::{Kind, Picture};
use crate::builders::steps::split_boxes::{OpenedNode, SideBoxes, SplitBoxes};
use crate::geometry::Aabb;
use glam::Vec3A;
use serde::{Deserialize, Serialize};

/// The file in a results folder.
pub const SPLITS: &str = "split.csv";

/// The names of the sides.
const SIDES: [&str; 2] = ["left", "right"];

/// A box of a split.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BoxRow {
    /// 3 or 5, the paper's number.
    pub figure: u32,
    /// Scene name.
    pub scene: String,
    /// Triangles of the scene.
    pub triangles: u64,
    /// Builder name.
    pub builder: String,
    /// Binary splits above.
    pub depth: u32,
    /// Axis of the split: 0, 1 or 2.
    pub axis: usize,
    /// Where the plane of a spatial split is.
    pub plane: Option<f32>,
    /// `cut`; of each side `kept-left`: nodes that stay; `opened-left`: one that is opened, followed by its children,
    /// `child-left` or, where they lie beyond a plane, `discarded-left`; and what is left of space, `clip-left`.
    pub part: String,
    /// Lower corner.
    pub min_x: f32,
    /// Lower corner.
    pub min_y: f32,
    /// Lower corner.
    pub min_z: f32,
    /// Upper corner.
    pub max_x: f32,
    /// Upper corner.
    pub max_y: f32,
    /// Upper corner.
    pub max_z: f32,
}

/// The boxes of a picture.
pub fn of_picture(picture: &Picture) -> Vec<BoxRow> {
    let split = &picture.split;
    let row = |part: &str, bounds: &Aabb| BoxRow {
        figure: picture.kind.figure(),
        scene: picture.scene.clone(),
        triangles: picture.triangles,
        builder: picture.builder.clone(),
        depth: split.depth,
        axis: split.axis,
        plane: split.plane,
        part: part.into(),
        min_x: bounds.min.x,
        min_y: bounds.min.y,
        min_z: bounds.min.z,
        max_x: bounds.max.x,
        max_y: bounds.max.y,
        max_z: bounds.max.z,
    };
    let mut rows: Vec<BoxRow> = split.cut.iter().map(|bounds| row("cut", bounds)).collect();
    for (side, name) in split.sides.iter().zip(SIDES) {
        let mut part = |part: &str, boxes: &[Aabb]| {
            rows.extend(boxes.iter().map(|bounds| row(&format!("{part}-{name}"), bounds)));
        };
        part("kept", &side.kept);
        for node in &side.opened {
            part("opened", &[node.bounds]);
            part("child", &node.children);
            part("discarded", &node.discarded);
        }
        part("clip", &[side.clip]);
    }
    rows
}

/// The pictures of some rows.
///
/// # Errors
/// One line, where boxes are missing.
pub fn pictures(rows: &[BoxRow]) -> Result<Vec<Picture>, String> {
    let mut pictures = Vec::new();
    for kind in Kind::ALL {
        let of_kind: Vec<&BoxRow> = rows.iter().filter(|row| row.figure == kind.figure()).collect();
        let Some(first) = of_kind.first() else { continue };
        let cut = of_kind.iter().filter(|row| row.part == "cut").map(|row| row.bounds()).collect();
        let split = SplitBoxes {
            depth: first.depth,
            axis: first.axis.min(2),
            plane: first.plane,
            cut,
            sides: [side(&of_kind, kind, SIDES[0])?, side(&of_kind, kind, SIDES[1])?],
        };
        if !split.bounds().extent().is_finite() {
            return Err(format!("figure {} has a box cut that is not finite, or none", kind.figure()));
        }
        let (scene, builder) = (first.scene.clone(), first.builder.clone());
        pictures.push(Picture { kind, scene, triangles: first.triangles, builder, split });
    }
    Ok(pictures)
}

/// A side of a picture.
fn side(rows: &[&BoxRow], kind: Kind, name: &str) -> Result<SideBoxes, String> {
    let (mut kept, mut opened, mut clips) = (Vec::new(), Vec::<OpenedNode>::new(), Vec::new());
    for row in rows {
        let Some(part) = row.part.strip_suffix(name).and_then(|part| part.strip_suffix('-')) else {
            continue;
        };
        let bounds = row.bounds();
        let no_node = || format!("figure {} has a box {} of no opened node", kind.figure(), row.part);
        match part {
            "kept" => kept.push(bounds),
            "opened" => opened.push(OpenedNode { bounds, children: Vec::new(), discarded: Vec::new() }),
            "child" => opened.last_mut().ok_or_else(no_node)?.children.push(bounds),
            "discarded" => opened.last_mut().ok_or_else(no_node)?.discarded.push(bounds),
            "clip" => clips.push(bounds),
            _ => return Err(format!("figure {} has an unknown box {}", kind.figure(), row.part)),
        }
    }
    match clips[..] {
        [clip] => Ok(SideBoxes { clip, kept, opened }),
        _ => Err(format!("figure {} has not one box clip-{name}", kind.figure())),
    }
}

impl BoxRow {
    fn bounds(&self) -> Aabb {
        Aabb::new(
            Vec3A::new(self.min_x, self.min_y, self.min_z),
            Vec3A::new(self.max_x, self.max_y, self.max_z),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::super::{choose, draw};
    use super::*;
    use crate::bench::files::{read_csv_file, write_csv};
    use crate::scene::generator;

    #[test]
    fn splits_are_drawn_from_their_boxes() {
        let scene = generator("rooms").unwrap().generate();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(SPLITS);
        let found =
            Kind::ALL.map(|kind| choose(&scene, "phr-fast", kind).unwrap().expect("rooms has such splits"));
        let rows: Vec<BoxRow> = found.iter().flat_map(of_picture).collect();
        write_csv(&path, &rows).unwrap();
        let read: Vec<BoxRow> = read_csv_file(&path, "").unwrap();
        assert_eq!(pictures(&read).unwrap(), found);
        for picture in &found {
            let svg = draw(picture);
            assert_eq!(svg, draw(&pictures(&read).unwrap()[usize::from(picture.kind == Kind::Spatial)]));
            assert!(svg.contains("refine") && svg.contains("rooms"));
            // An opened node is replaced by two, unless one of them is discarded.
            for side in &picture.split.sides {
                let (nodes, opened) = (side.nodes().count(), side.opened.len());
                let discarded: usize = side.opened.iter().map(|node| node.discarded.len()).sum();
                assert_eq!(side.refined().count(), nodes + opened - discarded);
                assert!(
                    svg.contains(&format!("refined: {} nodes, {opened} opened", nodes + opened - discarded))
                );
            }
        }
        let [object, spatial] = &found;
        assert!(
            object.split.sides.iter().all(|side| !side.opened.is_empty()),
            "one sees refining on both sides"
        );
        let discards = |side: &SideBoxes| side.opened.iter().any(|node| !node.discarded.is_empty());
        assert!(spatial.split.sides.iter().any(discards), "one sees a child that is discarded");
        let lacking: Vec<BoxRow> = read.into_iter().filter(|row| row.part != "clip-left").collect();
        assert!(pictures(&lacking).unwrap_err().contains("clip-left"));
        let orphan: Vec<BoxRow> =
            found.iter().flat_map(of_picture).filter(|row| row.part != "opened-left").collect();
        assert!(pictures(&orphan).unwrap_err().contains("child-left of no opened node"));
        for max_x in [f32::INFINITY, f32::MAX] {
            let boxes = found.iter().flat_map(of_picture);
            let far: Vec<BoxRow> = boxes.map(|row| BoxRow { min_x: -max_x, max_x, ..row }).collect();
            assert!(pictures(&far).unwrap_err().contains("a box cut that is not finite"));
        }
        for name in ["aac", "hunt-50"] {
            let error = choose(&scene, name, Kind::Object).unwrap_err();
            assert!(error.contains(&format!("{name} has no cuts")), "{error}");
        }
    }
}
