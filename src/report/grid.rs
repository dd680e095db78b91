//! A table of text, as Markdown that is legible on a terminal too.

/// Cells are cut to no less than this.
const LEAST: usize = 16;

fn length(text: &str) -> usize {
    text.chars().count()
}

/// Rows of cells under a header. The first column is flush left, the others flush right.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Grid {
    header: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Grid {
    /// A table without rows.
    pub fn new<T: Into<String>>(header: impl IntoIterator<Item = T>) -> Self {
        Self { header: header.into_iter().map(Into::into).collect(), rows: Vec::new() }
    }

    /// Adds a row; missing cells are empty.
    pub fn push(&mut self, mut cells: Vec<String>) {
        cells.resize(self.header.len(), String::new());
        for cell in cells.iter_mut().filter(|cell| cell.contains(['|', '\n', '\r'])) {
            // A reason may quote anything.
            *cell = cell.replace(['\n', '\r'], " ").replace('|', "\\|");
        }
        self.rows.push(cells);
    }

    /// True without rows.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// The columns with any entry, each with its width.
    fn used(&self) -> Vec<(usize, usize)> {
        let used =
            (0..self.header.len()).filter(|&column| self.rows.iter().any(|row| !row[column].is_empty()));
        let width = |column: usize| {
            let cells = self.rows.iter().map(|row| length(&row[column]));
            cells.chain([length(&self.header[column]), 3]).max().unwrap_or(3)
        };
        used.map(|column| (column, width(column))).collect()
    }

    /// The table as Markdown in lines of at most `columns`: the widest cells are cut, and told whole below.
    pub fn within(mut self, columns: usize) -> String {
        let mut whole: Vec<String> = Vec::new();
        while let Some((column, most)) = self.too_wide(columns) {
            for cell in self.rows.iter_mut().map(|row| &mut row[column]).filter(|cell| length(cell) > most) {
                let place = whole.iter().position(|known| known == cell).unwrap_or(whole.len());
                let mark = format!("…{}", place + 1);
                let shown = cell.chars().take(most - length(&mark)).chain(mark.chars()).collect();
                let name = std::mem::replace(cell, shown);
                if place == whole.len() {
                    whole.push(name);
                }
            }
        }
        let told = whole.iter().enumerate().map(|(place, name)| format!("…{}: {name}", place + 1));
        let told: String = told.map(|line| textwrap::fill(&line, columns) + "\n").collect();
        self.markdown() + if told.is_empty() { "" } else { "\n" } + &told
    }

    /// The column of the widest cell in a table of lines longer than `columns`, and how wide its cells may be; none
    /// where they are no wider than figures.
    fn too_wide(&self, columns: usize) -> Option<(usize, usize)> {
        let used = self.used();
        let line = 1 + used.iter().map(|(_, width)| width + 3).sum::<usize>();
        let widest = |column: usize| self.rows.iter().map(|row| length(&row[column])).max();
        let cells = used.iter().filter_map(|&(column, _)| Some((column, widest(column)?)));
        let (column, width) = cells.max_by_key(|(_, width)| *width)?;
        let most = width.saturating_sub(line.saturating_sub(columns)).max(LEAST);
        (most < width).then_some((column, most))
    }

    /// The table as Markdown, columns padded; those without any entry are left out.
    pub fn markdown(&self) -> String {
        let used = self.used();
        let line = |cells: &[String]| {
            let padded = used.iter().map(|&(column, width)| {
                let text = &cells[column];
                if column == 0 { format!("{text:<width$}") } else { format!("{text:>width$}") }
            });
            format!("| {} |\n", padded.collect::<Vec<_>>().join(" | "))
        };
        let rule = used.iter().map(|&(column, dashes)| {
            if column == 0 {
                format!(":{}", "-".repeat(dashes + 1))
            } else {
                format!("{}:", "-".repeat(dashes + 1))
            }
        });
        let rule = format!("|{}|\n", rule.collect::<Vec<_>>().join("|"));
        let body: String = self.rows.iter().map(|row| line(row)).collect();
        line(&self.header) + &rule + &body
    }
}

/// A figure with three significant digits, or all digits before the point.
pub fn short(value: f64) -> String {
    let magnitude = value.abs();
    let decimals = match magnitude {
        m if m >= 99.95 => 0,
        m if m >= 9.995 => 1,
        m if m >= 0.9995 || m == 0.0 => 2,
        _ => 3,
    };
    format!("{value:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_line_up_and_empty_ones_go() {
        let mut grid = Grid::new(["builder", "nothing", "ms"]);
        grid.push(vec!["lbvh".into(), String::new(), "12.5".into()]);
        grid.push(vec!["phr-hq".into(), String::new(), "1".into()]);
        let expected = "\
| builder |   ms |
|:--------|-----:|
| lbvh    | 12.5 |
| phr-hq  |    1 |
";
        assert_eq!(grid.markdown(), expected);
    }

    #[test]
    fn long_names_are_cut_and_told_below() {
        let mut grid = Grid::new(["builder", "ms", "in"]);
        let [long, longer] = [30, 50].map(|length| "phr-hq[delta=7+".repeat(4)[..length].to_owned());
        for (name, scene) in [(&long, "yard"), (&longer, &*long), (&long, "yard")] {
            grid.push(vec![name.clone(), "1".into(), scene.into()]);
        }
        for columns in [46, 60, 90] {
            let text = grid.clone().within(columns);
            assert!(text.lines().all(|line| length(line) <= columns), "{text}");
            assert_eq!(text.replace('\n', "").matches(&longer).count(), 1, "{text}");
        }
        assert!(grid.clone().within(60).contains("…1: "), "{}", grid.clone().within(60));
        assert_eq!(grid.clone().within(120), grid.markdown());
    }

    #[test]
    fn cells_stay_cells() {
        let mut grid = Grid::new(["builder", "verdict"]);
        grid.push(vec!["lbvh".into(), "a|b\nc".into()]);
        assert_eq!(grid.markdown().lines().last(), Some("| lbvh    |  a\\|b c |"));
    }

    #[test]
    fn figures_are_short() {
        let shown: Vec<String> = [1234.5, 99.96, 12.345, 1.0, 0.123_45, 0.0].into_iter().map(short).collect();
        assert_eq!(shown, ["1234", "100", "12.3", "1.00", "0.123", "0.00"]);
    }
}
