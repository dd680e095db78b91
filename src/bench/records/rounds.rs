//! `rounds.csv`: the time of each round behind a row that sums over views and kinds of rays. Rounds of a scene are
//! interleaved, so that two builders' times of one round are a pair: ratios are taken within it, and intervals drawn
//! from whole rounds. Small enough to be committed, as `samples.json` is not.

use super::files::{MEASURE, RecordsError, check_count, read_lines, without_last_line, write_csv};
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::path::Path;

/// The file in a results folder.
pub const ROUNDS: &str = "rounds.csv";

/// Times of one figure: the round, from 0, and milliseconds, by ascending round.
pub type ByRound = Vec<(u32, f64)>;

/// The times behind a row.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RowRounds {
    /// Build times.
    pub build: ByRound,
    /// Times for the recorded rays.
    pub trace: ByRound,
    /// Times for the whole frame.
    pub frame: ByRound,
}

/// The rounds that both have, with the milliseconds of each in a pair.
pub fn paired(a: &[(u32, f64)], b: &[(u32, f64)]) -> Vec<[f64; 2]> {
    let in_b = |round| b.iter().find(|other| other.0 == round).map(|other| other.1);
    a.iter().filter_map(|&(round, ms)| Some([ms, in_b(round)?])).collect()
}

/// Which row the times belong to: the columns of the same names.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct RowKey {
    /// The run.
    pub run_id: String,
    /// The scene.
    pub scene: String,
    /// The builder.
    pub builder: String,
    /// Children per node.
    pub width: u32,
    /// Threads of each side.
    pub threads: u32,
    /// Regime of the builds.
    pub regime: String,
    /// The kernel.
    pub kernel: String,
}

/// One line of the file, as it is written: lists have spaces between their entries.
#[derive(Debug, Serialize, Deserialize)]
struct Line {
    run_id: String,
    scene: String,
    builder: String,
    width: u32,
    threads: u32,
    regime: String,
    kernel: String,
    figure: String,
    rounds: String,
    ms: String,
}

const FIGURES: [&str; 3] = ["build", "trace", "frame"];

/// Writes the file in `folder`, whole or not at all; where no row has rounds, an older file is removed. Returns the
/// lines between its header and the last, which tells their number.
///
/// # Errors
/// An unwritable place.
pub fn write(folder: &Path, rows: &[(RowKey, &RowRounds)]) -> Result<usize, RecordsError> {
    let path = folder.join(ROUNDS);
    let mut lines = Vec::new();
    for (key, times) in rows {
        for (figure, of_figure) in FIGURES.into_iter().zip([&times.build, &times.trace, &times.frame]) {
            if !of_figure.is_empty() {
                lines.push(Line::of(key.clone(), figure, of_figure));
            }
        }
    }
    if lines.is_empty() {
        return match std::fs::remove_file(&path) {
            Err(source) if source.kind() != std::io::ErrorKind::NotFound => {
                Err(RecordsError::Io { path, source, remedy: "give another folder with --out" })
            }
            _ => Ok(0),
        };
    }
    write_csv(&path, &lines)?;
    Ok(lines.len())
}

/// Reads the file at `path`; nothing where there is none, as beside rows of older programs. `written` is the number of
/// its lines, where the environment of the run tells it.
///
/// # Errors
/// A file of another content or with another number of lines, or one whose number nothing tells.
pub fn read(path: &Path, written: Option<usize>) -> Result<Vec<(RowKey, RowRounds)>, RecordsError> {
    let malformed = |source| RecordsError::Malformed { path: path.to_owned(), source, remedy: MEASURE };
    if !path.exists() {
        // No file has no lines.
        return check_count(path, 0, Some(0), written).map(|()| Vec::new());
    }
    let bytes = read_lines(path, MEASURE)?;
    let (above, told) = without_last_line(&bytes);
    let mut rows: Vec<(RowKey, RowRounds)> = Vec::new();
    let mut places: HashMap<RowKey, usize> = HashMap::new();
    let mut lines = 0;
    for line in csv::Reader::from_reader(above).deserialize() {
        let line: Line = line.map_err(malformed)?;
        lines += 1;
        let unusable = || {
            let what =
                format!("{} {}/{}: unusable {} times", line.scene, line.builder, line.width, line.figure);
            malformed(std::io::Error::new(std::io::ErrorKind::InvalidData, what).into())
        };
        let times = line.times().ok_or_else(unusable)?;
        let [build, trace, frame] = FIGURES;
        let place: fn(&mut RowRounds) -> &mut ByRound = match &*line.figure {
            figure if figure == build => |of_row| &mut of_row.build,
            figure if figure == trace => |of_row| &mut of_row.trace,
            figure if figure == frame => |of_row| &mut of_row.frame,
            _ => return Err(unusable()),
        };
        let key = line.key();
        let at = *places.entry(key.clone()).or_insert(rows.len());
        if at == rows.len() {
            rows.push((key, RowRounds::default()));
        }
        if let Some((key, of_row)) = rows.get_mut(at) {
            let of_figure = place(of_row);
            if !of_figure.is_empty() {
                let what = format!("{} {}/{}: the same times twice", key.scene, key.builder, key.width);
                return Err(malformed(std::io::Error::new(std::io::ErrorKind::InvalidData, what).into()));
            }
            *of_figure = times;
        }
    }
    check_count(path, lines, told, written)?;
    Ok(rows)
}

impl Line {
    fn of(key: RowKey, figure: &str, times: &[(u32, f64)]) -> Self {
        let RowKey { run_id, scene, builder, width, threads, regime, kernel } = key;
        let list = |text: fn(&(u32, f64)) -> String| times.iter().map(text).collect::<Vec<_>>().join(" ");
        let (rounds, ms) = (list(|time| time.0.to_string()), list(|time| time.1.to_string()));
        Self { run_id, scene, builder, width, threads, regime, kernel, figure: figure.into(), rounds, ms }
    }

    fn key(self) -> RowKey {
        let Self { run_id, scene, builder, width, threads, regime, kernel, .. } = self;
        RowKey { run_id, scene, builder, width, threads, regime, kernel }
    }

    /// The times; `None` unless there is one positive time for each round.
    fn times(&self) -> Option<ByRound> {
        let rounds: Option<Vec<u32>> = self.rounds.split(' ').map(|round| round.parse().ok()).collect();
        let positive = |ms: &f64| *ms > 0.0 && *ms <= 1e15;
        let ms: Option<Vec<f64>> = self.ms.split(' ').map(|ms| ms.parse().ok().filter(positive)).collect();
        let (rounds, ms) = (rounds?, ms?);
        (rounds.len() == ms.len()).then(|| rounds.into_iter().zip(ms).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key(scene: &str, kernel: &str) -> RowKey {
        RowKey {
            run_id: "r".into(),
            scene: scene.into(),
            builder: "phr-hq".into(),
            width: 4,
            threads: 2,
            regime: "warm".into(),
            kernel: kernel.into(),
        }
    }

    #[test]
    fn rounds_survive_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let build = vec![(0, 10.5), (2, 11.25)];
        let builds = RowRounds { build: build.clone(), ..RowRounds::default() };
        let traces = RowRounds { build, trace: vec![(0, 1.5)], frame: vec![(2, 0.125)] };
        let rows = [(key("a, b", "none"), builds), (key("a, b", "phr"), traces)];
        let borrowed: Vec<_> = rows.iter().map(|(key, times)| (key.clone(), times)).collect();
        assert_eq!(write(folder.path(), &borrowed).unwrap(), 4);
        assert_eq!(read(&folder.path().join(ROUNDS), None).unwrap(), rows);
        write(folder.path(), &[]).unwrap();
        assert!(!folder.path().join(ROUNDS).exists(), "an older file is not mistaken for this run's");
        assert!(read(&folder.path().join(ROUNDS), None).unwrap().is_empty());
        assert!(read(&folder.path().join(ROUNDS), Some(4)).is_err(), "a file is missing");
    }

    #[test]
    fn other_content_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(ROUNDS);
        let header = "run_id,scene,builder,width,threads,regime,kernel,figure,rounds,ms\n";
        for line in [
            "r,s,b,4,2,warm,none,build,0 1,10",
            "r,s,b,4,2,warm,none,sah,0,1",
            "r,s,b,4,2,warm,none,build,0,-1",
        ] {
            std::fs::write(&path, format!("{header}{line}\n")).unwrap();
            let error = read(&path, None).unwrap_err().to_string();
            assert!(error.contains("s b/4") && error.contains(ROUNDS), "{error}");
        }
    }

    #[test]
    fn lines_stand_in_any_order_but_once() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(ROUNDS);
        let lines = |lines: &[&str]| {
            let header = "run_id,scene,builder,width,threads,regime,kernel,figure,rounds,ms";
            let text = format!("{header}\n{}\n# rows: {}\n", lines.join("\n"), lines.len());
            std::fs::write(&path, text).unwrap();
            read(&path, None)
        };
        let [build, trace] = ["r,s,b,4,2,warm,phr,build,0,10", "r,s,b,4,2,warm,phr,trace,0,3"];
        let other = "r,s,a,4,2,warm,phr,build,0,9";
        let rows = lines(&[build, other, trace]).unwrap();
        assert_eq!(rows.len(), 2);
        assert_eq!((&rows[0].1.build[..], &rows[0].1.trace[..]), (&[(0, 10.0)][..], &[(0, 3.0)][..]));
        assert!(lines(&[build, trace, build]).unwrap_err().to_string().contains("s b/4"));
    }

    #[test]
    fn pairs_are_of_the_same_round() {
        assert_eq!(paired(&[(0, 1.0), (1, 2.0), (3, 4.0)], &[(3, 8.0), (0, 3.0)]), [[1.0, 3.0], [4.0, 8.0]]);
        assert!(paired(&[(0, 1.0)], &[]).is_empty());
    }
}
