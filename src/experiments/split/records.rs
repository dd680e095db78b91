//! The boxes of splits as CSV, from which the pictures are drawn.

use super::{Kind, Picture};
use crate::builders::steps::watch::SplitBoxes;
use crate::geometry::Aabb;
use glam::Vec3A;
use serde::{Deserialize, Serialize};

/// The file in a results folder.
pub const SPLITS: &str = "split.csv";

const PARTS: [[&str; 2]; 3] =
    [["left", "right"], ["refined-left", "refined-right"], ["clip-left", "clip-right"]];

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
    /// `cut`; its sides `left` and `right`, clipped; both refined; what is left of space, `clip-left` and `clip-right`.
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
    for side in [0, 1] {
        rows.extend(split.sides[side].iter().map(|bounds| row(PARTS[0][side], bounds)));
        rows.extend(split.refined[side].iter().map(|bounds| row(PARTS[1][side], bounds)));
        rows.push(row(PARTS[2][side], &split.clips[side]));
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
        let boxes = |part: &str| -> Vec<Aabb> {
            of_kind.iter().filter(|row| row.part == part).map(|row| row.bounds()).collect()
        };
        let clip = |side: usize| match boxes(PARTS[2][side])[..] {
            [clip] => Ok(clip),
            _ => Err(format!("figure {} has not one box {}", kind.figure(), PARTS[2][side])),
        };
        let split = SplitBoxes {
            depth: first.depth,
            axis: first.axis.min(2),
            plane: first.plane,
            cut: boxes("cut"),
            sides: PARTS[0].map(boxes),
            refined: PARTS[1].map(boxes),
            clips: [clip(0)?, clip(1)?],
        };
        let (scene, builder) = (first.scene.clone(), first.builder.clone());
        pictures.push(Picture { kind, scene, triangles: first.triangles, builder, split });
    }
    Ok(pictures)
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
        }
        let lacking: Vec<BoxRow> = read.into_iter().filter(|row| row.part != "clip-left").collect();
        assert!(pictures(&lacking).unwrap_err().contains("clip-left"));
        assert!(choose(&scene, "aac", Kind::Object).unwrap_err().contains("aac has no cuts"));
    }
}
