//! What following an animation found, in words made from its rows.

use super::compared::{Track, above_from, loses_from, ratio, rebuilt, tracks};
use super::entrant::{Entrant, Update};
use super::records::FrameRow;
use crate::bench::statistics::{Ratio, arithmetic_mean};
use crate::report::figures::interval::Interval;
use crate::report::figures::scenes_of;
use crate::report::grid::{Grid, short};

/// Rays of a frame for which it is told where refitting loses, besides those recorded; none are those recorded.
const RAYS: [(Option<f64>, &str); 3] =
    [(None, "the recorded rays"), (Some(1e6), "1 M rays"), (Some(1e7), "10 M rays")];

/// A table of every scene, and who takes the least time.
pub fn findings(rows: &[FrameRow]) -> String {
    let scenes = scenes_of(rows.iter().map(|row| &row.scene));
    let told: Vec<String> = scenes.iter().map(|scene| of_scene(rows, scene)).collect();
    format!("# animation\n\n{}", told.join("\n"))
}

fn of_scene(rows: &[FrameRow], scene: &str) -> String {
    let tracks = tracks(rows, scene);
    let failed = rows.iter().filter(|row| row.scene == scene && !row.error.is_empty());
    let failed: String = failed
        .map(|row| format!("{} failed in frame {}: {}\n\n", row.entrant().name(), row.frame, row.error))
        .collect();
    let Some(first) = tracks.first().map(|track| track.rows[0]) else { return failed };
    let mut text = format!(
        "## {scene}\n\n{} triangles, {} of which never move; {} frames of about {} rays ({} x {} pixels, {}), {}-wide trees, {} \
         threads, traces under {}, medians of {} rounds; every answer of every frame verified. Means over the frames after \
         the first, in which every tree is built; ratios are geometric means over spans of ten frames, in brackets 95 % intervals over these. loses from: the frame from which on a frame takes longer than with the same \
         builder's rebuilding, medians of five frames, in brackets all frames so far together. More rays than were recorded are taken to be as fast as those.\n\n",
        first.triangles,
        first.fixed,
        first.frames,
        short(first.rays as f64),
        first.size,
        first.size,
        if first.views == 1 { "1 view".to_owned() } else { format!("{} views", first.views) },
        first.width,
        first.threads,
        first.kernel,
        first.rounds,
    );
    text += &table(&tracks);
    text += "\n";
    text += &best(&tracks);
    text + &failed
}

/// Means over the frames after the first, and the whole.
fn table(tracks: &[Track<'_>]) -> String {
    let header = [
        "tree",
        "update, ms",
        "trace, ms",
        "steps of a ray, first frame",
        "last frame",
        "all frames, s",
        "update / its rebuild's",
        "trace / its rebuild's",
    ];
    let loses = RAYS.map(|(_, rays)| format!("loses from, {rays}"));
    let mut grid = Grid::new(header.into_iter().map(String::from).chain(loses));
    for track in tracks {
        let steps = |row: Option<&&FrameRow>| row.and_then(|row| row.steps).map_or_else(String::new, short);
        let all = track.cumulated(None).last().map_or(0.0, |ms| 1e-3 * ms);
        let mut cells = vec![
            track.entrant.name(),
            short(later(&track.builds())),
            short(later(&track.traces(None))),
            steps(track.rows.first()),
            steps(track.rows.last()),
            short(all),
        ];
        let base = rebuilt(tracks, &track.entrant).filter(|_| track.entrant.update != Update::Rebuild);
        if let Some(base) = base {
            cells.push(relative(&track.builds(), &base.builds()));
            cells.push(relative(&track.traces(None), &base.traces(None)));
            cells.extend(RAYS.map(|(rays, _)| {
                let told = |frame: Option<usize>| frame.map_or("never".to_owned(), |frame| frame.to_string());
                let together = above_from(&track.cumulated(rays), &base.cumulated(rays));
                format!("{} ({})", told(loses_from(track, base, rays)), told(together))
            }));
        }
        grid.push(cells);
    }
    grid.markdown()
}

/// A ratio with its interval.
fn relative(of: &[f64], base: &[f64]) -> String {
    let shown = |Ratio { value, low, high }| format!("{value:.2} {}", Interval { low, high }.shown(2));
    ratio(of, base).map_or_else(String::new, shown)
}

/// The mean over the frames after the first; of the first where there is no other.
fn later(values: &[f64]) -> f64 {
    arithmetic_mean(values.get(1..).filter(|rest| !rest.is_empty()).unwrap_or(values)).unwrap_or(0.0)
}

/// Who takes the least time for all frames.
fn best(tracks: &[Track<'_>]) -> String {
    let told = RAYS.map(|(rays, name)| {
        let all = |track: &Track<'_>| track.cumulated(rays).last().copied().unwrap_or(f64::INFINITY);
        let of = |is_one: &dyn Fn(&Entrant) -> bool| {
            let those = tracks.iter().filter(|track| is_one(&track.entrant));
            those.min_by(|a, b| all(a).total_cmp(&all(b)))
        };
        let is_embrees = |entrant: &Entrant| entrant.builder.starts_with("embree");
        let shown = |track: &Track<'_>| format!("{} ({} s)", track.entrant.name(), short(1e-3 * all(track)));
        let ours = of(&|entrant| !is_embrees(entrant)).map(shown);
        let theirs = of(&is_embrees).map(|track| format!("of Embree's {}", shown(track)));
        format!("with {name} {}", ours.into_iter().chain(theirs).collect::<Vec<_>>().join(", "))
    });
    format!("Least time for all frames: {}.\n\n", told.join("; "))
}

#[cfg(test)]
mod tests {
    use super::super::compared::tests::rows;
    use super::*;

    #[test]
    fn the_frame_is_told_from_which_refitting_loses() {
        let rebuild: Vec<(f64, f64)> = vec![(8.0, 10.0); 20];
        // A frame of 1 + 10 + i: more than 18 from frame 8 on; of 1000 times the rays as soon as its trace is slower.
        let refit: Vec<(f64, f64)> = (0..20).map(|i| (1.0, 10.0 + f64::from(i))).collect();
        let all = [
            rows("lbvh", Update::Rebuild, &rebuild),
            rows("lbvh", Update::Refit, &refit),
            rows("embree-sah", Update::Rebuild, &[(30.0, 9.0); 20]),
        ]
        .concat();
        let text = findings(&all);
        let refit = text.lines().find(|line| line.starts_with("| lbvh, refit")).unwrap();
        let cells: Vec<&str> = refit.split('|').map(str::trim).collect();
        assert_eq!((cells[2], &cells[9..11]), ("1.00", &["8 (15)", "0 (1)"][..]), "{text}");
        // Spans of frames 1 to 10 and 11 to 19 over ten and nine frames of ten milliseconds.
        assert_eq!(cells[7..9], ["0.13 [0.13, 0.13]", "1.97 [0.09, 41.03]"], "{text}");
        assert!(text.contains("with the recorded rays lbvh, rebuild (0.360 s)"), "{text}");
        assert!(text.contains("of Embree's embree-sah, rebuild"), "{text}");
    }

    #[test]
    fn failures_are_told() {
        let mut rows = rows("lbvh", Update::Refit, &[(1.0, 1.0)]);
        rows[0].error = "wrong hits: all".into();
        rows[0].verified = false;
        assert_eq!(findings(&rows), "# animation\n\nlbvh, refit failed in frame 0: wrong hits: all\n\n");
    }
}
