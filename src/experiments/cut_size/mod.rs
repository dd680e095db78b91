//! Figure 4 of the paper: the average size of the cuts that are split, by depth, for every builder over cuts.

pub mod draw;
pub mod records;

pub use draw::draw;
pub use records::{CUT_SIZES, CutSizeRow, measure};

use crate::bench::statistics::geometric_mean;
use crate::report::figures::scenes_of;
use crate::report::grid::{Grid, short};
use crate::report::readme::findings::EVERY_SCENE;

/// The builders shown.
pub const BUILDERS: [&str; 7] =
    ["phr-fast", "phr-hq", "hunt-50", "hunt-500", "phr-speed", "phr-quality", "phr-best"];

/// The cuts of a builder in a scene.
struct Cuts {
    /// Nodes of the initial cut.
    first: u64,
    /// The longest mean length, and its depth.
    most: (f64, u32),
    /// From which depth on the mean is below ten nodes.
    below_ten: Option<u32>,
    /// Nodes swept over in all, per triangle.
    per_triangle: f64,
}

impl Cuts {
    fn of(rows: &[CutSizeRow], scene: &str, builder: &str) -> Option<Self> {
        let rows: Vec<&CutSizeRow> =
            rows.iter().filter(|row| row.scene == scene && row.builder == builder).collect();
        let first = rows.first()?;
        let most = rows.iter().max_by(|a, b| a.mean_nodes.total_cmp(&b.mean_nodes))?;
        let small = rows.iter().find(|row| row.depth > most.depth && row.mean_nodes < 10.0);
        let all: u64 = rows.iter().map(|row| row.nodes).sum();
        Some(Self {
            first: first.nodes,
            most: (most.mean_nodes, most.depth),
            below_ten: small.map(|row| row.depth),
            per_triangle: all as f64 / first.triangles as f64,
        })
    }
}

/// What the rows say: the cuts of the top, where they have shrunk to ten nodes, and how many nodes are swept over.
pub fn findings(rows: &[CutSizeRow]) -> String {
    let scenes = scenes_of(rows.iter().map(|row| &row.scene));
    let mut swept = Grid::new(["builder", "nodes swept per triangle", "least", "most"]);
    for builder in BUILDERS {
        let of: Vec<f64> =
            scenes.iter().filter_map(|scene| Some(Cuts::of(rows, scene, builder)?.per_triangle)).collect();
        let Some(mean) = geometric_mean(&of) else { continue };
        let ends =
            [f64::min, f64::max].map(|end| of.iter().copied().reduce(end).map_or_else(String::new, short));
        swept.push([builder.to_owned(), short(mean)].into_iter().chain(ends).collect());
    }
    let mut text = format!(
        "# cut-size\n\nThe average size of the cuts that are split, by depth (Figure 4), in {} scenes. The paper (4.3): an \
         adaptive threshold keeps cuts large at the top of the tree, where they decide its quality, and small below, where a \
         constant length is as large as the number of triangles left.\n\n{}\n{EVERY_SCENE}\n",
        scenes.len(),
        swept.markdown()
    );
    for scene in &scenes {
        let mut grid =
            Grid::new(["builder", "first cut", "longest on average", "at depth", "below ten from depth"]);
        for builder in BUILDERS {
            let Some(Cuts { first, most, below_ten, .. }) = Cuts::of(rows, scene, builder) else { continue };
            let below_ten = below_ten.map_or_else(|| "never".into(), |depth| depth.to_string());
            grid.push(vec![builder.into(), first.to_string(), short(most.0), most.1.to_string(), below_ten]);
        }
        text += &format!("\n{scene}\n\n{}", grid.markdown());
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::files::{read_csv_file, write_csv};
    use crate::scene::scalable;

    #[test]
    fn figure_4_is_drawn_from_what_was_counted() {
        let scene = scalable(3000, 1);
        let rows = measure(&scene, &["phr-fast", "hunt-50"]).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(CUT_SIZES);
        write_csv(&path, &rows).unwrap();
        let read: Vec<CutSizeRow> = read_csv_file(&path, "").unwrap();
        assert_eq!(read, rows);
        let svg = draw(&rows).unwrap();
        assert_eq!(draw(&read), Some(svg.clone()));
        assert!(svg.contains(">hunt-50<") && svg.contains("3 k triangles"), "{svg}");
        let told = findings(&rows);
        assert!(told.lines().any(|line| line.starts_with("| hunt-50 ") && line.contains(" 50 |")), "{told}");
        assert!(measure(&scene, &["lbvh"]).unwrap_err().contains("lbvh has no cuts"));
        assert!(draw(&[]).is_none());
    }
}
