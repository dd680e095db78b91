//! Figure 4 of the paper: the average size of the cuts that are split, by depth, for every builder over cuts.

pub mod draw;
pub mod records;

pub use draw::draw;
pub use records::{CUT_SIZES, CutSizeRow, measure};

use crate::report::figures::scenes_of;
use crate::report::grid::short;

/// The builders shown.
pub const BUILDERS: [&str; 8] =
    ["phr-fast", "phr-hq", "hunt-50", "hunt-500", "phr-turbo", "phr-speed", "phr-quality", "phr-best"];

/// What the rows say, in a paragraph: the cuts of the top and where they have shrunk to ten nodes.
pub fn findings(rows: &[CutSizeRow]) -> String {
    let mut text = String::new();
    for scene in scenes_of(rows.iter().map(|row| &row.scene)) {
        text += &format!("{scene}: ");
        let of_builder = |builder: &str| {
            let rows: Vec<&CutSizeRow> =
                rows.iter().filter(|row| row.scene == scene && row.builder == builder).collect();
            let (first, most) =
                (rows.first()?, rows.iter().max_by(|a, b| a.mean_nodes.total_cmp(&b.mean_nodes))?);
            let small = rows.iter().find(|row| row.depth > most.depth && row.mean_nodes < 10.0);
            let all: u64 = rows.iter().map(|row| row.nodes).sum();
            let per_triangle = all as f64 / first.triangles as f64;
            let shrunk = small.map_or_else(
                || ", never below ten".to_owned(),
                |row| format!(", below ten from depth {} on", row.depth),
            );
            Some(format!(
                "{builder} begins with {} nodes, has at most {} on average (depth {}){shrunk}, and sweeps over {} nodes per \
                 triangle in all",
                first.nodes,
                short(most.mean_nodes),
                most.depth,
                short(per_triangle)
            ))
        };
        let told: Vec<String> = BUILDERS.iter().filter_map(|builder| of_builder(builder)).collect();
        text += &told.join("; ");
        text += ".\n";
    }
    text + "The paper (4.3): an adaptive threshold keeps cuts large at the top of the tree, where they decide its quality, \
            and small below, where a constant length is as large as the number of triangles left.\n"
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
        assert!(findings(&rows).contains("hunt-50 begins with 50 nodes"), "{}", findings(&rows));
        assert!(measure(&scene, &["lbvh"]).unwrap_err().contains("lbvh has no cuts"));
        assert!(draw(&[]).is_none());
    }
}
