//! What can be told of the page without a browser.

use super::*;
use crate::bench::row::{FIRST, NO_KERNEL};
use serde_json::Value;

fn row(scene: &str, builder: &str, width: u32, build: f64, trace: f64) -> Row {
    Row {
        scene: scene.into(),
        utc: "2026-01-02T03:04:05Z".into(),
        rays: Some(1_000_000),
        mrays_s: Some(1000.0 / trace),
        triangles: 1000,
        ..Row::by_hand(builder, width, "embree-grafted", build, trace)
    }
}

fn rows() -> Vec<Row> {
    vec![
        row("</script><b>", "lbvh", 4, 1.25, 40.0),
        row("</script><b>", "embree-sah", 4, 10.0, 20.0),
        row("</script><b>", "phr-hq", 8, 15.0, 10.0),
        row("yard", "embree-sah", 4, 40.0, 80.0),
        row("yard", "phr-hq", 8, 60.0, 40.0),
    ]
}

fn data(page: &str) -> Value {
    let (_, rest) = page.split_once("id=\"data\">").unwrap();
    serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap()
}

#[test]
fn the_data_are_the_rows() {
    let folder = tempfile::tempdir().unwrap();
    let page = page(&rows(), None, folder.path(), &[]).unwrap();
    let data = data(&page);
    assert_eq!(data["places"][1]["name"], "</script><b>");
    assert!(
        page.contains("<option value=\"1\">&lt;&#x2f;script&gt;&lt;b&gt;</option>")
            && !page.contains("</script><b>")
    );
    let names: Vec<&str> =
        data["trees"].as_array().unwrap().iter().map(|tree| tree["name"].as_str().unwrap()).collect();
    assert_eq!((names, &data["base_tree"]), (vec!["lbvh", "embree-sah", "phr-hq / 8"], &1.into()));

    let entry = &data["places"][2]["entries"][2];
    assert_eq!(entry["builds"][0], serde_json::json!([60.0, 1.5, 1.5, 1.5]));
    assert_eq!(entry["traces"][0], serde_json::json!([40.0, 0.5, 0.5, 0.5]));
    assert_eq!(entry["speeds"][0], 25.0);
    assert!(data["places"][2]["entries"][0].is_null(), "lbvh was not measured there");
    // In the mean it is a mean over fewer scenes, and on no front.
    assert_eq!(data["places"][0]["entries"][0]["scenes"], serde_json::json!([[1]]));
    assert_eq!(data["places"][0]["fronts"][0][0], serde_json::json!([[1, 2], [1], [2]]));
    assert_eq!(data["places"][1]["fronts"][0][0], serde_json::json!([[0, 1, 2], [0, 1], [2]]));
    assert!(data["curves"][0][0][0].is_null());
    let curve = data["curves"][0][0][2].as_array().unwrap();
    assert_eq!(curve.len(), data["budgets"].as_array().unwrap().len());
    let (first, last) = (curve[0].as_f64().unwrap(), curve.last().unwrap().as_f64().unwrap());
    assert!(first > 1.45 && first < 1.5 && last > 0.5 && last < 0.51, "{first} to {last}");
}

#[test]
fn a_mean_over_fewer_scenes_is_one_under_its_kernel_and_regime() {
    let folder = tempfile::tempdir().unwrap();
    let (mut rows, others) = (rows(), rows());
    for row in others.into_iter().filter(|row| (&*row.scene, &*row.builder) != ("yard", "phr-hq")) {
        let untraced = Row { trace_ms_median: None, mrays_s: None, rays: None, ..row.clone() };
        rows.push(Row { kernel: "phr".into(), ..row });
        rows.push(Row { kernel: NO_KERNEL.into(), regime: FIRST.into(), ..untraced });
    }
    let data = data(&page(&rows, None, folder.path(), &[]).unwrap());
    assert_eq!((&data["kernels"][1]["name"], &data["regimes"][1]["name"]), (&"phr".into(), &"first".into()));
    let mean = &data["places"][0];
    assert_eq!(mean["entries"][1]["scenes"], serde_json::json!([[null, null], [null, null]]));
    assert_eq!(mean["entries"][2]["scenes"], serde_json::json!([[null, 1], [1, 1]]));
    let is_on_front = |kernel: usize, regime: usize| {
        mean["fronts"][kernel][regime][0].as_array().unwrap().contains(&2.into())
    };
    assert!(is_on_front(0, 0) && !is_on_front(0, 1) && !is_on_front(1, 0) && !is_on_front(1, 1));
}

#[test]
fn saved_trees_are_on_no_front_and_no_curve() {
    let folder = tempfile::tempdir().unwrap();
    let saved = ["</script><b>", "yard"].map(|scene| row(scene, "saved:x", 8, 0.1, 1.0));
    let page = page(&[rows(), saved.to_vec()].concat(), None, folder.path(), &[]).unwrap();
    assert!(page.contains("<b>saved:x &#x2f; 8</b> loads in 0.100 ms for yard."));
    assert!(!page.contains("<b>saved:x &#x2f; 8</b> traces") && page.contains("traces fastest"));
    let data = data(&page);
    let flags: Vec<bool> =
        data["trees"].as_array().unwrap().iter().map(|tree| tree["is_saved"].as_bool().unwrap()).collect();
    assert_eq!(flags, [false, false, false, true]);
    // Where they were measured, they have their figures.
    assert_eq!(data["places"][2]["entries"][3]["builds"][0][0], 0.1);
    assert_eq!(data["places"][0]["fronts"][0][0], serde_json::json!([[1, 2], [1], [2]]));
    assert!(data["curves"][0][0][3].is_null() && data["curves"][0][0][2].is_array());
}

#[test]
fn it_asks_for_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let page = page(&rows(), None, folder.path(), &[]).unwrap();
    assert!(page.contains("Content-Security-Policy") && page.contains("default-src 'none'"));
    for asks in ["src=\"http", "href=\"http", "src=\"//", "@import", "url(http"] {
        assert!(!page.contains(asks), "{asks}");
    }
    for licence in LICENCES {
        let mut holders = licence.lines().filter(|line| line.starts_with("Copyright")).peekable();
        assert!(holders.peek().is_some() && holders.all(|holder| page.contains(holder)), "{licence}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn libraries_are_as_published() {
    let vendor = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/report/page/vendor");
    let table = include_str!("vendor/README.md").lines().filter(|line| line.starts_with("| `"));
    let mut compared = 0;
    for line in table {
        let quoted: Vec<&str> = line.split('`').skip(1).step_by(2).collect();
        let sum = std::process::Command::new("sha256sum").arg(vendor.join(quoted[0])).output().unwrap();
        let sum = String::from_utf8(sum.stdout).unwrap();
        assert_eq!(sum.split(' ').next(), quoted.last().copied(), "{line}");
        compared += 1;
    }
    assert_eq!(compared, LIBRARIES.len());
}

#[test]
fn files_are_named_where_they_are() {
    let folder = tempfile::tempdir().unwrap();
    let told = || {
        let page = page(&rows(), None, folder.path(), &[]).unwrap();
        let parts = [
            "or read table1.md",
            "<code>samples.json</code>",
            "<code>shards&#x2f;*&#x2f;samples.json</code>",
        ];
        parts.map(|part| page.contains(part))
    };
    assert_eq!(told(), [false, false, false]);
    std::fs::create_dir_all(folder.path().join("shards/1-of-2")).unwrap();
    for (file, expected) in [
        ("shards/1-of-2/samples.json", [false, false, true]),
        ("samples.json", [false, true, false]),
        ("table1.md", [true, true, false]),
    ] {
        std::fs::write(folder.path().join(file), "").unwrap();
        assert_eq!(told(), expected, "{file}");
    }
}

#[test]
fn the_verdict_and_what_lies_beside_the_rows_are_on_it() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| {
        let file = folder.path().join(name);
        std::fs::create_dir_all(file.parent().unwrap()).unwrap();
        std::fs::write(file, text).unwrap();
    };
    let lines: String = (0..300).map(|line| format!("{line},{}\n", 2 * line)).collect();
    write("experiments/cut-sizes.csv", &format!("depth,size\n{lines}# rows: 300\n"));
    write("experiments/was-cut.csv", "depth,size\n1,2\n");
    write("experiments/cut-sizes.svg", "<svg xmlns=\"http://www.w3.org/2000/svg\"/>");
    write("experiments/grid/fronts-scenes.svg", "<svg xmlns=\"http://www.w3.org/2000/svg\"/>");
    write("experiments/grid/findings.md", "# grid\n\nThe front is < 1.");
    write("experiments/grid/rows.csv", "scene,builder\n");
    write("heatmaps/rooms.png", "pixels");
    write("heatmaps/rooms.counts.png", "counts");
    write("growth.svg", "<svg xmlns=\"http://www.w3.org/2000/svg\"/>");
    write("figure6.svg", "drawn by the page");
    std::fs::write(folder.path().join("experiments/latin.csv"), b"caf\xe9\n").unwrap();
    let mut rows = rows();
    rows[0].warnings = "HighSpread".into();
    rows.push(Row {
        build_ms_median: None,
        error: "out of memory".into(),
        ..row("yard", "lbvh", 4, 1.0, 1.0)
    });
    let page = page(&rows, None, folder.path(), &[]).unwrap();
    for part in [
        "<b>phr-hq &#x2f; 8</b> traces fastest: in 0.50",
        "No environment.json lies beside the rows",
        "<dt>HighSpread</dt><dd>1 of 6 rows:",
        "<code>--rounds.</code>",
        "<dt>yard, lbvh &#x2f; 4 under embree-grafted</dt><dd>out of memory</dd>",
        "alt=\"rooms\"",
        "cut sizes <small>experiments&#x2f;cut-sizes.csv</small>",
        "<td>199</td><td>398</td>",
        "100 more lines in the file.",
        "latin, not shown <small>experiments&#x2f;latin.csv</small>",
        "was cut, not shown <small>experiments&#x2f;was-cut.csv</small>",
        "1 rows, but not the last line `# rows: 1`: it may be cut; correct or remove it</pre>",
        "correct or remove it</pre>",
        "alt=\"growth\"",
        "alt=\"grid: fronts scenes\"",
        "<pre># grid\n\nThe front is &lt; 1.</pre>",
    ] {
        assert!(page.contains(part), "no {part} in {}", page.split("<script").next().unwrap());
    }
    assert!(!page.contains("rows.csv</small>") && !page.contains("rooms.counts"));
    assert!(!page.contains("<td>200</td><td>400</td>") && !page.contains("alt=\"figure6\""));
    // Of another folder, heat maps and experiments alone.
    let experiments = [folder.path().join("experiments")];
    let elsewhere = tempfile::tempdir().unwrap();
    let page = super::page(&rows, None, elsewhere.path(), &experiments).unwrap();
    assert!(
        page.contains("alt=\"grid: fronts scenes\"") && page.contains("<small>grid&#x2f;findings.md</small>")
    );
    let page = super::page(&rows, None, elsewhere.path(), &[folder.path().into()]).unwrap();
    assert!(page.contains("alt=\"rooms\"") && page.contains("<small>heatmaps&#x2f;rooms.png</small>"));
    assert!(matches!(super::page(&[], None, folder.path(), &[]), Err(PageError::Empty)));
}
