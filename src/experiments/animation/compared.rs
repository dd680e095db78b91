//! Contestants of one animation beside each other: the time of each frame, of all frames so far, and from where on
//! one of them loses.

use super::entrant::{Entrant, Update};
use super::records::FrameRow;
use crate::bench::statistics::{Ratio, median};
use crate::bench::turns::paired::PairedMean;
use std::iter::once;

/// Frames of a span, of which ratios are taken: the noise of a machine lasts longer than a frame.
const SPAN: usize = 10;

/// Frames to either side of one whose median stands for it: single frames are noise.
const AROUND: usize = 2;

/// The frames of a contestant in one scene.
#[derive(Clone)]
pub struct Track<'a> {
    /// The contestant.
    pub entrant: Entrant,
    /// Its frames, all of them, with their figures.
    pub rows: Vec<&'a FrameRow>,
}

/// The contestants of `scene` that came to its end, in their order.
pub fn tracks<'a>(rows: &'a [FrameRow], scene: &str) -> Vec<Track<'a>> {
    let mut tracks: Vec<Track<'a>> = Vec::new();
    for row in rows.iter().filter(|row| row.scene == scene) {
        match tracks.iter_mut().find(|track| track.entrant == row.entrant()) {
            Some(track) => track.rows.push(row),
            None => tracks.push(Track { entrant: row.entrant(), rows: vec![row] }),
        }
    }
    let is_whole = |track: &Track<'_>| {
        let has_figures = |row: &&FrameRow| row.verified && row.build_ms.is_some() && row.trace_ms.is_some();
        track.rows.len() == track.rows[0].frames as usize && track.rows.iter().all(has_figures)
    };
    tracks.retain(is_whole);
    tracks
}

impl Track<'_> {
    /// Milliseconds of each update.
    pub fn builds(&self) -> Vec<f64> {
        self.rows.iter().filter_map(|row| row.build_ms).collect()
    }

    /// Milliseconds of each frame's traces: of so many rays, at the speed of those recorded, or of those recorded.
    pub fn traces(&self, rays: Option<f64>) -> Vec<f64> {
        let scale = |row: &FrameRow| rays.map_or(1.0, |rays| rays / row.rays.max(1) as f64);
        self.rows.iter().filter_map(|row| Some(row.trace_ms? * scale(row))).collect()
    }

    /// Steps of a ray in each frame, of a tree that our kernel can have.
    pub fn steps(&self) -> Vec<f64> {
        self.rows.iter().filter_map(|row| row.steps).collect()
    }

    /// Milliseconds of each frame.
    pub fn totals(&self, rays: Option<f64>) -> Vec<f64> {
        self.builds().iter().zip(self.traces(rays)).map(|(build, trace)| build + trace).collect()
    }

    /// Milliseconds of all frames up to each.
    pub fn cumulated(&self, rays: Option<f64>) -> Vec<f64> {
        let sum = |sum: &mut f64, total: f64| {
            *sum += total;
            Some(*sum)
        };
        self.totals(rays).into_iter().scan(0.0, sum).collect()
    }
}

/// The contestant of the same builder that rebuilds in each frame.
pub fn rebuilt<'a, 'b>(tracks: &'b [Track<'a>], entrant: &Entrant) -> Option<&'b Track<'a>> {
    let base = Entrant { update: Update::Rebuild, ..entrant.clone() };
    tracks.iter().find(|track| track.entrant == base)
}

/// Medians of the frames around each.
pub fn smoothed(values: &[f64]) -> Vec<f64> {
    let around = |i: usize| &values[i.saturating_sub(AROUND)..values.len().min(i + AROUND + 1)];
    (0..values.len()).filter_map(|i| median(around(i))).collect()
}

/// The first frame from which on `a` is more than `b` until the end.
pub fn above_from(a: &[f64], b: &[f64]) -> Option<usize> {
    let last = a.iter().zip(b).rposition(|(a, b)| a <= b);
    let from = last.map_or(0, |last| last + 1);
    (from < a.len().min(b.len())).then_some(from)
}

/// The frame from which on a frame takes longer than one of `base`.
pub fn loses_from(track: &Track<'_>, base: &Track<'_>, rays: Option<f64>) -> Option<usize> {
    above_from(&smoothed(&track.totals(rays)), &smoothed(&base.totals(rays)))
}

/// The geometric mean of `of` relative to `base` over spans of ten frames, the first frame left out, with Student's
/// 95 % interval over the spans; `None` for fewer than two of these.
pub fn ratio(of: &[f64], base: &[f64]) -> Option<Ratio> {
    let sums = |values: &[f64]| -> Vec<f64> {
        let spans = values.get(1..).unwrap_or(&[]).chunks(SPAN);
        // A span of few frames at the end counts for nothing.
        spans.filter(|span| 2 * span.len() >= SPAN).map(|span| span.iter().sum()).collect()
    };
    let logarithms: Vec<f64> = sums(of).iter().zip(sums(base)).map(|(of, base)| (of / base).ln()).collect();
    (logarithms.len() > 1).then(|| PairedMean::of(once(&logarithms[..])).ratio())
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Rows of a scene of as many frames as there are figures.
    pub fn rows(builder: &str, update: Update, figures: &[(f64, f64)]) -> Vec<FrameRow> {
        let row = |(frame, &(build, trace)): (usize, &(f64, f64))| FrameRow {
            schema: super::super::records::SCHEMA,
            scene: "s".into(),
            triangles: 1000,
            fixed: 400,
            threads: 2,
            width: 4,
            size: 8,
            views: 1,
            rounds: 1,
            kernel: "phr".into(),
            frames: figures.len() as u32,
            frame: frame as u32,
            builder: builder.into(),
            update,
            rays: 1000,
            build_ms: Some(build),
            trace_ms: Some(trace),
            sah: Some(trace),
            steps: Some(2.0 * trace),
            verified: true,
            ..FrameRow::default()
        };
        figures.iter().enumerate().map(row).collect()
    }

    #[test]
    fn totals_scale_with_rays_and_add_up() {
        let rows = rows("lbvh", Update::Refit, &[(2.0, 10.0), (1.0, 20.0)]);
        let tracks = tracks(&rows, "s");
        assert_eq!(tracks[0].totals(None), [12.0, 21.0]);
        assert_eq!(tracks[0].totals(Some(2000.0)), [22.0, 41.0]);
        assert_eq!(tracks[0].cumulated(None), [12.0, 33.0]);
        assert!(rebuilt(&tracks, &tracks[0].entrant).is_none());
    }

    #[test]
    fn who_fails_is_left_out() {
        let mut rows = rows("lbvh", Update::Refit, &[(2.0, 10.0), (1.0, 20.0)]);
        rows.pop();
        assert!(tracks(&rows, "s").is_empty());
    }

    #[test]
    fn ratios_leave_the_first_frame_out_and_have_intervals_over_spans() {
        let base = [2.0; 31];
        let mut of = [3.0; 31];
        of[0] = 1000.0;
        let all_alike = ratio(&of, &base).unwrap();
        assert!([all_alike.value, all_alike.low, all_alike.high].iter().all(|x| (x - 1.5).abs() < 1e-12));
        of[11..21].fill(6.0);
        // Spans of 1.5, 3 and 1.5: a mean logarithm of ln(1.5) + ln(2) / 3 and a deviation of ln(2) / sqrt(3).
        let varied = ratio(&of, &base).unwrap();
        let (mean, error) = (1.5_f64.ln() + 2.0_f64.ln() / 3.0, 4.303 * 2.0_f64.ln() / 3.0);
        assert!((varied.value.ln() - mean).abs() < 1e-12 && (varied.high.ln() - mean - error).abs() < 1e-12);
        assert_eq!((ratio(&of[..11], &base), ratio(&[], &base)), (None, None));
    }

    #[test]
    fn losing_begins_where_it_stays() {
        assert_eq!(above_from(&[1.0, 3.0, 1.0, 3.0, 3.0], &[2.0; 5]), Some(3));
        assert_eq!(above_from(&[3.0; 5], &[2.0; 5]), Some(0));
        assert_eq!(above_from(&[3.0, 3.0, 1.0], &[2.0; 3]), None);
        assert_eq!(above_from(&[], &[]), None);
        assert_eq!(smoothed(&[1.0, 9.0, 1.0, 2.0, 1.0]), [1.0, 1.5, 1.0, 1.5, 1.0]);
    }
}
