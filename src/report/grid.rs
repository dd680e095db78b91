//! A table of text, as Markdown that is legible on a terminal too.

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

    /// The table as Markdown, columns padded; those without any entry are left out.
    pub fn markdown(&self) -> String {
        let used: Vec<usize> = (0..self.header.len())
            .filter(|&column| self.rows.iter().any(|row| !row[column].is_empty()))
            .collect();
        let length = |text: &str| text.chars().count();
        let width = |column: usize| {
            let cells = self.rows.iter().map(|row| length(&row[column]));
            cells.chain([length(&self.header[column]), 3]).max().unwrap_or(3)
        };
        let line = |cells: &[String]| {
            let padded = used.iter().map(|&column| {
                let (text, width) = (&cells[column], width(column));
                if column == 0 { format!("{text:<width$}") } else { format!("{text:>width$}") }
            });
            format!("| {} |\n", padded.collect::<Vec<_>>().join(" | "))
        };
        let rule = used.iter().map(|&column| {
            let dashes = width(column);
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
    fn cells_stay_cells() {
        let mut grid = Grid::new(["builder", "verdict"]);
        grid.push(vec!["lbvh".into(), "a|b\nc".into()]);
        assert_eq!(grid.markdown().lines().last(), Some("| lbvh    | a\\|b c |"));
    }

    #[test]
    fn figures_are_short() {
        let shown: Vec<String> = [1234.5, 99.96, 12.345, 1.0, 0.123_45, 0.0].into_iter().map(short).collect();
        assert_eq!(shown, ["1234", "100", "12.3", "1.00", "0.123", "0.00"]);
    }
}
