//! The parameters that are searched: the paper's, the extensions, the rounds of reinsertion and the width. A point
//! has one number per parameter, not a number where the parameter has no effect.

use crate::builders::Recipe;
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

/// A parameter.
#[derive(Clone, Copy, Debug)]
pub struct Parameter {
    /// The field of the configuration.
    pub field: &'static str,
    /// Its values.
    pub scale: Scale,
    /// The switch that must be on for it.
    pub needs: Option<&'static str>,
}

const fn parameter(field: &'static str, scale: Scale) -> Parameter {
    Parameter { field, scale, needs: None }
}

/// Children per node.
pub const WIDTH: &str = "width";
/// Rounds of reinsertion: a field of `phr-best` alone.
const ROUNDS: &str = "rounds";

/// All parameters.
pub const PARAMETERS: [Parameter; 18] = [
    parameter(WIDTH, Scale::OneOf(&[Some(4.0), Some(8.0)])),
    parameter(ROUNDS, Scale::OneOf(&[None, Some(1.0), Some(2.0), Some(4.0), Some(8.0)])),
    parameter("alpha", Scale::Linear(0.3, 0.7)),
    parameter("delta", Scale::Linear(3.0, 10.0)),
    parameter("max_cut", Scale::Binary(10.0, 17.0)),
    parameter("spatial_threshold", Scale::Decimal(-5.0, 0.0)),
    parameter("max_references", Scale::Linear(1.0, 3.0)),
    parameter("cut_share", Scale::Binary(-10.0, -3.0)),
    parameter("own_threshold.references", Scale::Binary(12.0, 18.0)),
    parameter("own_threshold.area", Scale::Binary(-12.0, -6.0)),
    parameter("spatial_bias", Scale::Linear(1.0, 1.2)),
    parameter("clip_triangles", Scale::Switch),
    parameter(
        "subtree_sweep",
        Scale::OneOf(&[None, Some(16.0), Some(32.0), Some(64.0), Some(128.0), Some(256.0)]),
    ),
    parameter("presplit", Scale::Switch),
    parameter("auxiliary_leaf", Scale::OneOf(&[None, Some(2.0), Some(4.0)])),
    parameter("clusters", Scale::Switch),
    Parameter { field: "clusters.area", scale: Scale::Decimal(-5.0, -2.0), needs: Some("clusters") },
    parameter("calibration", Scale::Decimal(1.5, 4.5)),
];

/// A number per parameter.
pub type Point = [f64; PARAMETERS.len()];

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
    fn value(self, number: f64) -> Value {
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
    fn number(self, value: &Value) -> f64 {
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

/// The width of a point.
pub fn width_of(point: &Point) -> u32 {
    if point[0] < 1.0 { 4 } else { 8 }
}

/// The point with numbers of parameters without effect left out.
pub fn effective(mut point: Point) -> Point {
    for (i, parameter) in PARAMETERS.iter().enumerate() {
        let is_on = |switch: &str| {
            PARAMETERS.iter().position(|other| other.field == switch).is_some_and(|at| point[at] >= 1.0)
        };
        if parameter.needs.is_some_and(|switch| !is_on(switch)) {
            point[i] = f64::NAN;
        }
    }
    point
}

/// The configuration of a point: `phr-quality` with other parameters, or `phr-best` where there are rounds of
/// reinsertion.
pub fn recipe_of(point: &Point) -> Recipe {
    let rounds = PARAMETERS[1].scale.value(point[1]);
    let base = if rounds.is_null() { "phr-quality" } else { "phr-best" };
    let mut recipe = Recipe::of(base).expect("a name of the list");
    for (parameter, &number) in PARAMETERS.iter().zip(&effective(*point)) {
        let is_of_base = parameter.field != WIDTH && (parameter.field != ROUNDS || !rounds.is_null());
        if is_of_base && !number.is_nan() {
            let value = parameter.scale.value(number);
            recipe.set(parameter.field, &value).unwrap_or_else(|error| unreachable!("{error}"));
        }
    }
    recipe
}

/// The point nearest to a preset; figures that the space does not have stay the preset's own.
pub fn point_of(preset: &str, width: u32) -> Point {
    let config = Recipe::of(preset).map_or(Value::Null, |recipe| recipe.builder::<4>().config());
    let phr = if config["phr"].is_object() { &config["phr"] } else { &config };
    let mut point = [0.0; PARAMETERS.len()];
    for (number, parameter) in point.iter_mut().zip(PARAMETERS) {
        let value = match parameter.field {
            WIDTH => Value::from(width),
            ROUNDS => config["optimise"]["rounds"].clone(),
            field => field.split('.').fold(phr, |inside, name| &inside[name]).clone(),
        };
        *number = parameter.scale.number(&value);
    }
    effective(point)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;

    #[test]
    fn every_point_is_a_configuration_in_range() {
        let mut random = SplitMix64::new(1);
        for _ in 0..2000 {
            let point = PARAMETERS.map(|parameter| {
                let (low, high) = parameter.scale.range();
                low + (high - low) * f64::from(random.unit())
            });
            let recipe = recipe_of(&point);
            assert_eq!(Recipe::parse(&recipe.name()).unwrap().name(), recipe.name());
        }
        for ends in [|range: (f64, f64)| range.0, |range: (f64, f64)| range.1] {
            recipe_of(&PARAMETERS.map(|parameter| ends(parameter.scale.range())));
        }
    }

    #[test]
    fn the_points_of_presets_give_their_parameters() {
        for (preset, same) in [
            ("phr-quality", ["max_cut", "delta", "subtree_sweep", "clip_triangles"]),
            ("phr-speed", ["max_cut", "auxiliary_leaf", "own_threshold", "spatial_bias"]),
            ("phr-turbo", ["delta", "clusters", "spatial_threshold", "cut_share"]),
            ("phr-best", ["max_cut", "alpha", "own_threshold", "presplit"]),
        ] {
            let of = |recipe: Recipe| {
                let config = recipe.builder::<8>().config();
                if config["phr"].is_object() { config["phr"].clone() } else { config }
            };
            let found = of(recipe_of(&point_of(preset, 8)));
            let expected = of(Recipe::of(preset).unwrap());
            for field in same {
                let near = |a: &Value, b: &Value| match (a.as_f64(), b.as_f64()) {
                    (Some(a), Some(b)) => (a / b - 1.0).abs() < 0.05,
                    _ => a == b,
                };
                assert!(near(&found[field], &expected[field]), "{preset} {field}: {found} {expected}");
            }
            assert_eq!(width_of(&point_of(preset, 4)), 4);
        }
    }
}
