//! How a parameter's values become numbers, which the search proposes, and back.

use serde_json::Value;

/// How a number stands for a value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scale {
    /// As it is, to two decimals.
    Linear(f64, f64),
    /// By its decimal logarithm, to two digits.
    Decimal(f64, f64),
    /// By its binary logarithm, a whole number or its inverse.
    Binary(f64, f64),
    /// One of a list by its index; `None` turns the extension off.
    OneOf(&'static [Option<f64>]),
    /// Off or on.
    Switch,
}

impl Scale {
    /// Least and greatest number; the greatest of a list is its length.
    pub fn range(self) -> (f64, f64) {
        match self {
            Self::Linear(low, high) | Self::Decimal(low, high) | Self::Binary(low, high) => (low, high),
            Self::OneOf(values) => (0.0, values.len() as f64),
            Self::Switch => (0.0, 2.0),
        }
    }

    /// Whether numbers are indices.
    pub fn is_list(self) -> bool {
        matches!(self, Self::OneOf(_) | Self::Switch)
    }

    /// The value of a number.
    pub fn value(self, number: f64) -> Value {
        let digits = |value: f64| format!("{value:.1e}").parse::<f64>().unwrap_or(value);
        let whole = |value: f64| {
            if value.fract() == 0.0 { Value::from(value as u64) } else { Value::from(value) }
        };
        match self {
            Self::Linear(..) => whole((100.0 * number).round() / 100.0),
            Self::Decimal(..) => whole(digits(10f64.powf(number))),
            Self::Binary(..) => whole(number.round().exp2()),
            Self::OneOf(values) => {
                let index = (number.max(0.0) as usize).min(values.len() - 1);
                values[index].map_or(Value::Null, whole)
            }
            Self::Switch => Value::Bool(number >= 1.0),
        }
    }

    /// The number of a value, or of the nearest that there is.
    pub fn number(self, value: &Value) -> f64 {
        let (low, high) = self.range();
        // The greatest number is beyond the last index.
        let within = |number: f64| number.clamp(low, high - 1e-9 * (high - low));
        let number = value.as_f64();
        match self {
            Self::Linear(..) => within(number.unwrap_or(low)),
            Self::Decimal(..) => within(number.map_or(high, f64::log10)),
            Self::Binary(..) => within(number.map_or(low, f64::log2)),
            Self::OneOf(values) => {
                let distance = |known: &Option<f64>| (known.unwrap_or(0.0) - number.unwrap_or(0.0)).abs();
                let nearest =
                    (0..values.len()).min_by(|&a, &b| distance(&values[a]).total_cmp(&distance(&values[b])));
                nearest.unwrap_or_default() as f64 + 0.5
            }
            Self::Switch => {
                if value.is_null() || *value == Value::Bool(false) {
                    0.5
                } else {
                    1.5
                }
            }
        }
    }
}
