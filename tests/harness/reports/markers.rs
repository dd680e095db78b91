//! Figures within pages.

use super::*;
use phr::bench::{kernels, scaling};
use phr::experiments::animation;
use phr::report::readme;

#[test]
fn a_changed_figure_fails_the_check() {
    let folder = written(&rows());
    let readme = folder.path().join("README.md");
    let text = "# Text\n\nPHR-HQ traces in <!-- value: . geometric trace phr-hq -->?<!-- end --> of the time.\n\n\
                <!-- means: . --kernel phr -->\n<!-- end -->\n\n```\n<!-- means: nowhere -->\n```\n";
    std::fs::write(&readme, text).unwrap();
    assert_eq!(phr(&["readme", "--check", "README.md"], folder.path()).0, 1);
    assert_eq!(std::fs::read_to_string(&readme).unwrap(), text, "a check writes nothing");
    assert_eq!(phr(&["readme", "README.md"], folder.path()).0, 0);
    let made = std::fs::read_to_string(&readme).unwrap();
    assert!(made.contains("-->1.00 [0.13, 7.75]<!-- end --> of the time."), "{made}");
    assert!(made.contains("### Build time\n") && made.contains("<!-- means: nowhere -->"), "{made}");
    assert_eq!(phr(&["readme", "--check", "README.md"], folder.path()).0, 0);

    std::fs::write(&readme, made.replace("1.821", "1.812")).unwrap();
    let (code, output) = phr(&["readme", "--check", "README.md"], folder.path());
    let shown = String::from_utf8(output.stdout).unwrap();
    assert_eq!(code, 1);
    assert!(
        shown.contains("-| phr-hq") && shown.contains("+| phr-hq") && shown.lines().count() == 3,
        "{shown}"
    );
}

#[test]
fn markers_are_told_by_line() {
    let folder = written(&rows());
    let wrong = |text: &str| readme::regenerate(text, folder.path()).unwrap_err().to_string();
    assert!(wrong("\n<!-- end -->\n").starts_with("line 2: <!-- end --> without a beginning"));
    assert!(
        wrong("<!-- means: . -->\n<!-- table1: . -->\n<!-- end -->\n").starts_with("line 1: means without")
    );
    assert!(wrong("<!-- value: . mean trace phr-hq -->1<!-- end -->").contains("no mean mean"));
    assert!(wrong("<!-- value: . geometric trace aac -->1<!-- end -->").contains("no such figure of aac"));
    assert!(wrong("<!-- value: . geometric trace lbvh -->1<!-- end -->").contains("in 1 of 2 scenes"));
    assert!(wrong("<!-- means: nowhere -->\n<!-- end -->").starts_with("line 1: "));
    assert!(wrong("<!-- a comment -->\n").starts_with("no marker"));
}

#[test]
fn every_column_and_marker_is_described() {
    let folder = written(&rows());
    let text = std::fs::read_to_string(folder.path().join(ROWS)).unwrap();
    let described = include_str!("../../../results/README.md");
    let kernels = folder.path().join(kernels::row::KERNELS);
    kernels::row::write(&kernels, &[kernels::row::KernelRow::default()]).unwrap();
    let kernels = std::fs::read_to_string(kernels).unwrap();
    let scaling = folder.path().join(scaling::row::SCALING);
    scaling::row::write(&scaling, &[scaling::row::ScalingRow::default()]).unwrap();
    let scaling = std::fs::read_to_string(scaling).unwrap();
    let animation = folder.path().join(animation::ANIMATION);
    animation::records::write(&animation, &[animation::FrameRow::default()]).unwrap();
    let animation = std::fs::read_to_string(animation).unwrap();
    for column in
        [text, kernels, scaling, animation].iter().flat_map(|text| text.lines().next().unwrap().split(','))
    {
        assert!(described.contains(&format!("`{column}`")), "{column}");
    }
    // The kinds that there are, as the error tells them.
    let error = readme::regenerate("<!-- end -->", folder.path()).unwrap_err().to_string();
    let markers: Vec<&str> = error.split("there are ").nth(1).unwrap().trim().split(", ").collect();
    assert!(markers.len() > 20, "{error}");
    // `bars` is an older name of targets.
    for marker in markers.into_iter().filter(|marker| *marker != "bars") {
        assert!(described.contains(&format!("| `{marker}: ")), "{marker}");
        // What is described is understood: up to the rows, which are not there.
        let asked = match marker {
            "value" => "nowhere geometric trace aac",
            "ablation" => "nowhere phr-hq aac",
            "summary" => "nowhere aac",
            "holdout" | "fronts" => "nowhere nowhere",
            "assertions" => "nowhere nowhere nowhere",
            _ => "nowhere",
        };
        let text = format!("<!-- {marker}: {asked} -->\n<!-- end -->\n");
        let error = readme::regenerate(&text, folder.path()).unwrap_err().to_string();
        assert!(error.contains("nowhere"), "{error}");
    }
}
