//! Figures.

use super::*;
use phr::report::figures::Under;
use phr::report::plot::{self, raster};

#[test]
fn the_plot_is_reproducible_and_names_every_method() {
    let rows = rows();
    let under = Under::best(&rows);
    let drawings = plot::figures(&rows, &[], &under);
    assert_eq!(drawings, plot::figures(&rows, &[], &under));
    assert_eq!(
        drawings.iter().map(|drawing| drawing.name).collect::<Vec<_>>(),
        ["figure6", "figure6-paper", "figure6-scenes"]
    );
    for drawing in &drawings {
        // A panel of a scene names the trees on its fronts alone.
        let is_panels = drawing.name == "figure6-scenes";
        let methods: &[&str] =
            if is_panels { &["phr-hq"] } else { &["lbvh", "hunt-50", "embree-sah", "phr-hq"] };
        for method in methods {
            assert!(
                drawing.svg.contains(&format!(">{method}<"))
                    || drawing.svg.contains(&format!(">{method} (1 of 2)<")),
                "{method}"
            );
        }
        let png = raster::png(&drawing.svg).unwrap();
        assert_eq!(png, raster::png(&drawing.svg).unwrap());
        assert!(png.starts_with(b"\x89PNG"));
    }
    // The paper's points: all by name in the mean, those of Conference in its panel.
    assert!(drawings[1].svg.contains(">embree-fast-spatial<"));
    assert!(drawings[2].svg.contains("paper: Conference"));
}

#[test]
fn the_command_draws_and_checks() {
    let folder = written(&rows());
    assert_eq!(phr(&["plot", "."], folder.path()).0, 0);
    let first = std::fs::read(folder.path().join("figure6.png")).unwrap();
    assert_eq!(phr(&["plot", ".", "--check"], folder.path()).0, 0);
    assert_eq!(phr(&["plot", "rows.csv"], folder.path()).0, 0);
    assert_eq!(std::fs::read(folder.path().join("figure6.png")).unwrap(), first);

    // A picture of another figure, and none.
    for picture in [std::fs::read(folder.path().join("figure6-paper.png")).unwrap(), Vec::new()] {
        std::fs::write(folder.path().join("figure6.png"), picture).unwrap();
        let (code, output) = phr(&["plot", ".", "--check"], folder.path());
        let error = String::from_utf8_lossy(&output.stderr);
        assert!(code == 1 && error.contains("figure6.png: not the figure of these rows"), "{error}");
    }
    std::fs::write(folder.path().join("figure6.png"), first).unwrap();
    assert_eq!(phr(&["plot", ".", "--check"], folder.path()).0, 0);

    let mut changed = rows();
    changed.iter_mut().filter(|row| row.builder == "phr-hq").for_each(|row| row.trace_ms_median = Some(17.0));
    row::write(&folder.path().join(ROWS), &changed).unwrap();
    assert_eq!(phr(&["plot", ".", "--check"], folder.path()).0, 1);
}
