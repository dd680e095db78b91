//! Round values along an axis.

/// Round values within the range of a logarithmic axis, at most `room` of them, with their texts: of the finest
/// series that is not too fine.
pub fn ticks((least, most): (f64, f64), room: usize) -> Vec<(f64, String)> {
    let decades = |steps: &[f64]| -> Vec<f64> {
        (-6..7).flat_map(|power| steps.iter().map(move |step| step * 10f64.powi(power))).collect()
    };
    let even = |step: f64| -> Vec<f64> { (1..400).map(|i| step * f64::from(i)).collect() };
    let series = [
        even(0.02),
        even(0.05),
        even(0.1),
        even(0.2),
        decades(&[1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0]),
        decades(&[1.0, 1.5, 2.0, 3.0, 5.0, 7.0]),
        decades(&[1.0, 2.0, 5.0]),
        decades(&[1.0]),
    ];
    let within = |values: &[f64]| -> Vec<f64> {
        values.iter().copied().filter(|&v| v >= least * 0.999 && v <= most * 1.001).collect()
    };
    let length = (most / least).ln();
    let fits = |ticks: &Vec<f64>| {
        // Even steps crowd at the upper end of a logarithmic axis.
        let closest = ticks.windows(2).map(|pair| (pair[1] / pair[0]).ln()).fold(f64::INFINITY, f64::min);
        ticks.len() >= 2 && ticks.len() <= room && closest * room as f64 >= 0.8 * length
    };
    // They are also far apart at its lower end, where values would have none to be read by.
    let begin_low =
        |ticks: &Vec<f64>| ticks.first().is_some_and(|first| (first / least).ln() <= 0.2 * length);
    let all = || series.iter().map(|values| within(values)).filter(fits);
    let fitting = all().find(begin_low).or_else(|| all().next());
    let ticks = fitting.unwrap_or_else(|| within(&[least, most]));
    ticks
        .into_iter()
        .map(|tick| {
            // Three digits behind the point, of values below a tenth three that count.
            let digits = (2.0 - tick.log10().floor()).clamp(3.0, 12.0) as usize;
            let text = format!("{tick:.digits$}");
            let text = text.trim_end_matches('0').trim_end_matches('.').to_owned();
            (text.parse().unwrap_or(tick), text)
        })
        .collect()
}

/// Whole numbers within the range of a linear axis, at most `room` of them, with their texts.
pub fn linear_ticks((least, most): (f64, f64), room: usize) -> Vec<(f64, String)> {
    let steps = (0..7).flat_map(|power| [1.0, 2.0, 5.0].map(|step| step * 10f64.powi(power)));
    let fits = |step: &f64| ((most - least) / step) < room.max(2) as f64;
    let step = steps.into_iter().find(fits).unwrap_or(most - least);
    let first = (least / step).ceil() as i64;
    let last = (most / step).floor() as i64;
    (first..=last).map(|i| i as f64 * step).map(|tick| (tick, format!("{tick}"))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_few() {
        let texts = |range, room| ticks(range, room).into_iter().map(|tick| tick.1).collect::<Vec<_>>();
        assert_eq!(texts((0.45, 4.0), 10), ["0.5", "0.6", "0.8", "1", "1.2", "1.5", "2", "2.5", "3", "4"]);
        assert_eq!(texts((0.9, 1.45), 7), ["0.9", "1", "1.1", "1.2", "1.3", "1.4"]);
        assert_eq!(texts((0.02, 300.0), 5), ["0.1", "1", "10", "100"]);
        assert_eq!(texts((0.26, 1.1), 10), ["0.3", "0.4", "0.5", "0.6", "0.8", "1"]);
        assert_eq!(texts((0.0001, 0.0012), 5), ["0.0001", "0.0002", "0.0005", "0.001"]);
    }

    #[test]
    fn levels_are_whole_numbers() {
        let texts =
            |range, room| linear_ticks(range, room).into_iter().map(|tick| tick.1).collect::<Vec<_>>();
        assert_eq!(texts((0.0, 31.0), 10), ["0", "5", "10", "15", "20", "25", "30"]);
        assert_eq!(texts((0.0, 3.0), 10), ["0", "1", "2", "3"]);
    }
}
