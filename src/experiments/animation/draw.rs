//! Draws an animation: for each scene the time of all frames so far, relative to one contestant's, that of each frame,
//! with marks where refitting begins to lose, and the steps of a ray.

use super::compared::{Track, loses_from, rebuilt, smoothed, tracks};
use super::entrant::{Entrant, Update};
use super::records::FrameRow;
use crate::bench::cell::place;
use crate::report::figures::scenes_of;
use crate::report::plot::chart::{Across, Front, INK, Line, Panel, Point, Range, SMALL, sheet};
use crate::report::plot::key::in_lines;
use crate::report::plot::labels::Rect;
use crate::report::plot::raster::text_width;
use crate::report::plot::svg::{Anchor, Shape};

/// Size of the texts in a panel.
const FONT: f64 = 12.0;
/// What a diamond in the panels of each frame means.
const LOSES: &str =
    "from here on a frame takes longer than with the same builder's rebuilding, medians of five frames";

/// The colours of builders, after Okabe and Ito, and those of the others by their place among these.
const COLOURS: [(&str, &str); 8] = [
    ("lbvh", "#000000"),
    ("embree-morton", "#56b4e9"),
    ("embree-sah", "#0072b2"),
    ("phr-fast", "#d55e00"),
    ("phr-draft", "#f0e442"),
    ("phr-turbo", "#e69f00"),
    ("phr-speed", "#cc79a7"),
    ("phr-quality", "#009e73"),
];
const OTHERS: [&str; 6] = ["#7f7f7f", "#8c564b", "#332288", "#999933", "#882255", "#44aa99"];

/// The line of one of `entrants`: a colour by its builder, and dashes by how it follows.
fn line(entrant: &Entrant, entrants: &[&Entrant]) -> Line {
    let own = |name: &str| COLOURS.iter().find(|(builder, _)| *builder == name).map(|(_, colour)| *colour);
    let colour = own(&entrant.builder).unwrap_or_else(|| {
        let mut others: Vec<&str> =
            entrants.iter().map(|it| &*it.builder).filter(|it| own(it).is_none()).collect();
        others.dedup();
        let place = others.iter().position(|it| *it == entrant.builder).unwrap_or_default();
        OTHERS[place % OTHERS.len()]
    });
    let (width, more) = match entrant.update {
        Update::Rebuild => (2.0, ""),
        Update::Refit => (2.0, " stroke-dasharray=\"2 3\""),
        Update::Refine => (2.0, " stroke-dasharray=\"9 4\""),
        Update::Merge => (2.0, " stroke-dasharray=\"9 3 2 3\""),
        // Wide and pale: dashes of four kinds are not told apart.
        Update::MergeSah => (5.0, " stroke-opacity=\"0.45\""),
    };
    Line { colour, width, more }
}

/// The figure; `None` without a contestant that came to the end of a scene.
pub fn draw(rows: &[FrameRow]) -> Option<String> {
    let scenes = scenes_of(rows.iter().map(|row| &row.scene));
    let scenes: Vec<(String, Vec<Track<'_>>)> = scenes
        .into_iter()
        .flat_map(|scene| {
            let tracks = tracks(rows, &scene);
            told_apart(scene, &tracks)
        })
        .filter(|(_, tracks)| !tracks.is_empty())
        .collect();
    let first = scenes.first()?.1[0].rows[0];
    let mut entrants: Vec<&Entrant> = Vec::new();
    for track in scenes.iter().flat_map(|(_, tracks)| tracks) {
        if !entrants.contains(&&track.entrant) {
            entrants.push(&track.entrant);
        }
    }
    entrants.sort_by_key(|entrant| (place(&entrant.builder), &entrant.builder));
    let (inside, pitch, left) = ((500.0, 330.0), (580.0, 420.0), 80.0);
    let wide = left + 3.0 * pitch.0 - 60.0;
    let mut names: Vec<String> = entrants.iter().map(|entrant| entrant.name()).collect();
    if scenes.iter().any(|(_, tracks)| !losers(tracks).is_empty()) {
        names.push(LOSES.into());
    }
    let widths = names.iter().map(|name| 72.0 + text_width(name, SMALL));
    let places = in_lines(widths, (26.0, 78.0), wide - 20.0, 20.0);
    let top = places.last().map_or(78.0, |(_, y)| *y) + 62.0;
    let about = format!(
        "build + trace, {}-wide trees, {} threads, {} rays a frame, traces under {}; left: all frames so far, \
         relative to the tree named there; middle: each frame, medians of five; right: node visits and block tests under our kernel",
        first.width,
        first.threads,
        rays_of_frames(rows),
        first.kernel
    );
    let size = (wide, top + scenes.len() as f64 * pitch.1 + 10.0);
    let mut svg = sheet(size, "Trees that follow a moving scene", &[&about]);
    for (index, (name, (x, y))) in names.iter().zip(&places).enumerate() {
        match entrants.get(index) {
            Some(entrant) => {
                let Line { colour, width, more } = line(entrant, &entrants);
                svg.line(&[(*x, *y), (x + 40.0, *y)], colour, width, more);
            }
            None => svg.point((x + 32.0, *y), Shape::Diamond, 0.36 * FONT, INK, false),
        }
        svg.text((x + 46.0, y + 4.5), Anchor::Start, SMALL, INK, name, "");
    }
    for (index, (scene, tracks)) in scenes.iter().enumerate() {
        for (column, panel) in
            panels(scene, (tracks, &entrants), index + 1 == scenes.len()).into_iter().enumerate()
        {
            let (x, y) = (left + column as f64 * pitch.0, top + index as f64 * pitch.1);
            panel.draw(&mut svg, Rect { x, y, width: inside.0, height: inside.1 });
        }
    }
    Some(svg.finish())
}

/// Rows of panels of a scene: trees that keep its static part stand beside those that are built again, in a row of
/// their own. Fifteen lines in a panel are too many.
fn told_apart<'a>(scene: String, tracks: &[Track<'a>]) -> Vec<(String, Vec<Track<'a>>)> {
    let (merged, others): (Vec<_>, Vec<_>) =
        tracks.iter().cloned().partition(|track| is_merge(&track.entrant));
    if merged.is_empty() {
        return vec![(scene, others)];
    }
    let rebuilt = others.iter().filter(|track| track.entrant.update == Update::Rebuild).cloned();
    let kept = (format!("{scene}, its static part kept"), rebuilt.chain(merged).collect());
    vec![(scene, others), kept]
}

fn is_merge(entrant: &Entrant) -> bool {
    matches!(entrant.update, Update::Merge | Update::MergeSah)
}

/// The least and the greatest number of rays of a frame, in thousands where that loses nothing of note.
fn rays_of_frames(rows: &[FrameRow]) -> String {
    let are_few = rows.iter().any(|row| row.rays < 10_000);
    let (unit, word) = if are_few { (1.0, "") } else { (1e3, " thousand") };
    let rays = || rows.iter().map(|row| (row.rays as f64 / unit).round());
    let (least, most) = (rays().fold(f64::INFINITY, f64::min), rays().fold(0.0, f64::max));
    if least < most { format!("{least} to {most}{word}") } else { format!("{most}{word}") }
}

/// Those whose frames take longer than with their builder's rebuilding from some frame on, with that frame.
fn losers<'a, 'b>(tracks: &'b [Track<'a>]) -> Vec<(&'b Track<'a>, usize)> {
    let loser = |track: &'b Track<'a>| {
        let base = rebuilt(tracks, &track.entrant)?;
        Some((track, loses_from(track, base, None)?))
    };
    tracks.iter().filter_map(loser).collect()
}

/// The panels of a scene.
fn panels(scene: &str, (tracks, entrants): (&[Track<'_>], &[&Entrant]), is_last: bool) -> [Panel; 3] {
    let sah = Entrant { builder: "embree-sah".into(), ..Entrant::default() };
    let base = rebuilt(tracks, &sah).unwrap_or(&tracks[0]);
    let so_far = base.cumulated(None);
    let relative = |track: &Track<'_>| -> Vec<f64> {
        track.cumulated(None).iter().zip(&so_far).map(|(sum, base)| sum / base).collect()
    };
    let triangles = (base.rows[0].triangles as f64 / 1000.0).round();
    let across = if is_last { "frame" } else { "" };
    let panel = |title: String, up: String, values: &dyn Fn(&Track<'_>) -> Vec<f64>, begin: f64| {
        let (mut fronts, mut points) = (Vec::new(), Vec::new());
        let mut range = Range { x: (0.0, 1.0), y: (begin, begin) };
        for track in tracks {
            let line = line(&track.entrant, entrants);
            let through: Vec<(f64, f64)> =
                values(track).into_iter().enumerate().map(|(i, value)| (i as f64, value)).collect();
            for &(x, y) in &through {
                range.x.1 = range.x.1.max(x);
                range.y = (range.y.0.min(y), range.y.1.max(y));
            }
            // A single frame has no line.
            if let [at] = through[..] {
                let (shape, colour) = (Shape::Circle, line.colour);
                points.push(Point { at, shape, colour, is_hollow: false, label: None, interval: None });
            }
            fronts.push(Front { through, line });
        }
        range.y = (range.y.0 / 1.04, range.y.1 * 1.04);
        Panel { title, axes: (across.into(), up), range, across: Across::Linear, fronts, points, font: FONT }
    };
    let of_frame = |track: &Track<'_>| smoothed(&track.totals(None));
    let least = of_frame(base).first().copied().unwrap_or(1.0);
    let steps = base.steps().first().copied().unwrap_or(1.0);
    let mut each = panel(format!("{scene}: each frame"), "build + trace, ms".into(), &of_frame, least);
    each.points.extend(losers(tracks).into_iter().map(|(track, frame)| {
        let (at, colour) = ((frame as f64, of_frame(track)[frame]), line(&track.entrant, entrants).colour);
        Point { at, shape: Shape::Diamond, colour, is_hollow: false, label: None, interval: None }
    }));
    [
        panel(
            format!("{scene}, {triangles} k triangles: all frames so far"),
            format!("time relative to {}", base.entrant.name()),
            &relative,
            1.0,
        ),
        each,
        panel(format!("{scene}: steps of a ray"), "steps".into(), &|track| track.steps(), steps),
    ]
}

#[cfg(test)]
mod tests {
    use super::super::compared::tests::rows;
    use super::*;

    #[test]
    fn every_contestant_has_its_line() {
        let all = [
            rows("lbvh", Update::Rebuild, &[(8.0, 10.0); 9]),
            rows("lbvh", Update::Refit, &[(1.0, 10.0); 9]),
            rows("phr-speed", Update::Refine, &[(5.0, 9.0); 9]),
        ]
        .concat();
        let svg = draw(&all).unwrap();
        assert_eq!(draw(&all), Some(svg.clone()));
        for name in
            ["lbvh, rebuild", "lbvh, refit", "phr-speed, refine", "s, 1 k triangles", "relative to lbvh"]
        {
            assert!(svg.contains(name), "{name}: {svg}");
        }
        let merged = [all, rows("phr-fast", Update::Merge, &[(5.0, 9.0); 9])].concat();
        let svg = draw(&merged).unwrap();
        for title in [">s: each frame<", ">s, its static part kept: each frame<"] {
            assert!(svg.contains(title), "{title}: {svg}");
        }
        // Two builders without a colour of their own.
        let changed = ["phr-fast[delta=7]", "phr-fast[delta=8]"]
            .map(|name| rows(name, Update::Rebuild, &[(5.0, 9.0); 9]));
        let both = draw(&changed.concat()).unwrap();
        assert!(OTHERS[..2].iter().all(|colour| both.contains(colour)), "{both}");
        assert!(!svg.contains(LOSES) && !svg.contains("<polygon"), "nobody loses: {svg}");
        assert!(draw(&rows("lbvh", Update::Refit, &[(1.0, 2.0)])).is_some(), "one frame");
        assert!(draw(&[]).is_none());
    }

    #[test]
    fn the_frame_is_marked_from_which_refitting_loses() {
        let refit: Vec<(f64, f64)> = (0..20).map(|i| (1.0, 10.0 + f64::from(i))).collect();
        let all =
            [rows("phr-fast", Update::Rebuild, &[(8.0, 10.0); 20]), rows("phr-fast", Update::Refit, &refit)]
                .concat();
        let tracks = tracks(&all, "s");
        let losers: Vec<(Update, usize)> =
            losers(&tracks).into_iter().map(|(track, frame)| (track.entrant.update, frame)).collect();
        assert_eq!(losers, [(Update::Refit, 8)]);
        let svg = draw(&all).unwrap();
        let marks: Vec<&str> = svg.lines().filter(|line| line.starts_with("<polygon")).collect();
        assert!(svg.contains("than with the same builder's rebuilding"), "{svg}");
        assert!(marks.len() == 2 && marks[1].contains("fill=\"#d55e00\""), "{marks:?}");
    }
}
