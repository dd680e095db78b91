//! The parameters that are searched of a builder, the width among them. Our presets over cuts lie in one space: the
//! paper's parameters, the extensions and the rounds of reinsertion. The paper's two lie in another, as do Hunt's two,
//! AAC and PLOC. A point has one number per parameter, not a number where the parameter has no effect.

use super::scale::Scale;
use crate::builders::Recipe;
use serde_json::Value;

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

const WIDTHS: Parameter = parameter(WIDTH, Scale::OneOf(&[Some(4.0), Some(8.0)]));

/// Of our presets over cuts, which lie in one space.
const PRESETS: [&str; 3] = ["phr-quality", "phr-best", "phr-speed"];
const OF_PRESETS: [Parameter; 18] = [
    WIDTHS,
    parameter(ROUNDS, Scale::OneOf(&[None, Some(1.0), Some(2.0), Some(4.0), Some(8.0)])),
    parameter("alpha", Scale::Linear(0.3, 0.7)),
    parameter("delta", Scale::Linear(3.0, 10.0)),
    parameter("max_cut", Scale::Binary(10.0, 17.0)),
    parameter("spatial_threshold", Scale::Decimal(-5.0, 0.0)),
    parameter("max_references", Scale::Linear(1.0, 3.0)),
    parameter("cut_share", Scale::Binary(-10.0, -3.0)),
    parameter("own_threshold", Scale::Switch),
    Parameter {
        field: "own_threshold.references",
        scale: Scale::Binary(12.0, 18.0),
        needs: Some("own_threshold"),
    },
    Parameter {
        field: "own_threshold.area",
        scale: Scale::Binary(-12.0, -6.0),
        needs: Some("own_threshold"),
    },
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

/// The paper's own.
const OF_PAPER: [Parameter; 7] = [
    WIDTHS,
    parameter("alpha", Scale::Linear(0.3, 0.7)),
    parameter("delta", Scale::Linear(3.0, 10.0)),
    parameter("max_cut", Scale::Binary(10.0, 17.0)),
    parameter("spatial_threshold", Scale::Decimal(-5.0, 0.0)),
    parameter("max_references", Scale::Linear(1.0, 3.0)),
    LEAF,
];
const LEAF: Parameter = parameter("max_leaf", Scale::OneOf(&[Some(4.0), Some(8.0), Some(12.0), Some(16.0)]));
const OF_HUNT: [Parameter; 3] = [WIDTHS, parameter("cut_length", Scale::Binary(3.0, 12.0)), LEAF];
const OF_AAC: [Parameter; 3] = [
    WIDTHS,
    parameter("delta", Scale::OneOf(&[Some(4.0), Some(8.0), Some(12.0), Some(20.0), Some(32.0)])),
    parameter("epsilon", Scale::Linear(0.0, 0.5)),
];
const OF_PLOC: [Parameter; 2] = [
    WIDTHS,
    parameter("radius", Scale::OneOf(&[Some(5.0), Some(10.0), Some(25.0), Some(50.0), Some(100.0)])),
];

/// Spaces, each with the builders that lie in it.
static SPACES: [(&[&str], &[Parameter]); 5] = [
    (&PRESETS, &OF_PRESETS),
    (&["phr-hq", "phr-fast"], &OF_PAPER),
    (&["hunt-500", "hunt-50"], &OF_HUNT),
    (&["aac"], &OF_AAC),
    (&["ploc"], &OF_PLOC),
];

/// A number per parameter.
pub type Point = Vec<f64>;

/// What is searched.
#[derive(Clone, Copy, Debug)]
pub struct Space {
    /// The builder that all is relative to.
    pub anchor: &'static str,
    /// The builders that lie in the space, the anchor among them.
    pub builders: &'static [&'static str],
    /// Its parameters, the width first.
    pub parameters: &'static [Parameter],
}

/// The width of a point.
pub fn width_of(point: &Point) -> u32 {
    if point[0] < 1.0 { 4 } else { 8 }
}

impl Space {
    /// The space of the builder called `name`.
    ///
    /// # Errors
    /// A builder without parameters, in one line that names those that have some.
    pub fn of(name: &str) -> Result<Self, String> {
        let found = SPACES.iter().find_map(|&(builders, parameters)| {
            let anchor = builders.iter().find(|builder| **builder == name)?;
            Some(Self { anchor, builders, parameters })
        });
        found.ok_or_else(|| {
            let known: Vec<&str> = SPACES.iter().flat_map(|(builders, _)| builders.iter().copied()).collect();
            format!("no parameters are known of it; give {}", known.join(", "))
        })
    }

    /// The point with numbers of parameters without effect left out.
    pub fn effective(&self, mut point: Point) -> Point {
        for (i, parameter) in self.parameters.iter().enumerate() {
            let is_on = |switch: &str| {
                self.parameters
                    .iter()
                    .position(|other| other.field == switch)
                    .is_some_and(|at| point[at] >= 1.0)
            };
            if parameter.needs.is_some_and(|switch| !is_on(switch)) {
                point[i] = f64::NAN;
            }
        }
        point
    }

    /// The configuration of a point: the anchor with other parameters, and it alone where none differs. Of our presets,
    /// `phr-best` where there are rounds of reinsertion, `phr-quality` where there are none.
    pub fn recipe_of(&self, point: &Point) -> Recipe {
        let rounds = self.parameters.iter().position(|parameter| parameter.field == ROUNDS);
        let rounds = rounds.map(|at| self.parameters[at].scale.value(point[at]));
        let base = match &rounds {
            None => self.anchor,
            Some(Value::Null) => "phr-quality",
            Some(_) => "phr-best",
        };
        let has_rounds = rounds.is_some_and(|rounds| !rounds.is_null());
        let mut recipe = Recipe::of(base).expect("a name of the list");
        for (parameter, &number) in self.parameters.iter().zip(&self.effective(point.clone())) {
            let is_of_base = parameter.field != WIDTH && (parameter.field != ROUNDS || has_rounds);
            if is_of_base && !number.is_nan() {
                let mut changed = recipe.clone();
                let value = parameter.scale.value(number);
                changed.set(parameter.field, &value).unwrap_or_else(|error| unreachable!("{error}"));
                if config(&changed) != config(&recipe) {
                    recipe = changed;
                }
            }
        }
        recipe
    }

    /// The point nearest to a builder of the space; figures that the space does not have stay the builder's own.
    pub fn point_of(&self, builder: &str, width: u32) -> Point {
        let config = Recipe::of(builder).map_or(Value::Null, |recipe| config(&recipe));
        let phr = if config["phr"].is_object() { &config["phr"] } else { &config };
        let number = |parameter: &Parameter| {
            let value = match parameter.field {
                WIDTH => Value::from(width),
                ROUNDS => config["optimise"]["rounds"].clone(),
                field => field.split('.').fold(phr, |inside, name| &inside[name]).clone(),
            };
            parameter.scale.number(&value)
        };
        self.effective(self.parameters.iter().map(number).collect())
    }
}

fn config(recipe: &Recipe) -> Value {
    recipe.builder::<4>().config()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;

    fn spaces() -> impl Iterator<Item = Space> {
        let names = SPACES.iter().flat_map(|(builders, _)| builders.iter());
        names.map(|name| Space::of(name).unwrap())
    }

    #[test]
    fn every_point_is_a_configuration_in_range() {
        let mut random = SplitMix64::new(1);
        for space in spaces() {
            let point = |unit: &mut dyn FnMut() -> f64| -> Point {
                let number = |parameter: &Parameter| {
                    let (low, high) = parameter.scale.range();
                    low + (high - low) * unit()
                };
                space.parameters.iter().map(number).collect()
            };
            for _ in 0..500 {
                let recipe = space.recipe_of(&point(&mut || f64::from(random.unit())));
                assert_eq!(Recipe::parse(&recipe.name()).unwrap().name(), recipe.name());
                assert!(space.builders.contains(&recipe.base()));
            }
            for end in [0.0, 1.0] {
                space.recipe_of(&point(&mut || end));
            }
        }
        assert!(Space::of("lbvh").unwrap_err().contains("give phr-quality, phr-best"));
    }

    #[test]
    fn the_points_of_presets_give_their_parameters() {
        for (preset, same) in [
            ("phr-quality", &["max_cut", "delta", "subtree_sweep", "clip_triangles"][..]),
            ("phr-speed", &["max_cut", "auxiliary_leaf", "own_threshold", "presplit"]),
            ("phr-best", &["max_cut", "alpha", "own_threshold", "presplit"]),
            ("phr-hq", &["alpha", "delta", "max_cut", "spatial_threshold", "max_references", "max_leaf"]),
            ("hunt-500", &["max_leaf"]),
            ("aac", &["delta", "epsilon"]),
            ("ploc", &["radius"]),
        ] {
            let space = Space::of(preset).unwrap();
            let of = |recipe: Recipe| {
                let config = recipe.builder::<8>().config();
                if config["phr"].is_object() { config["phr"].clone() } else { config }
            };
            let found = of(space.recipe_of(&space.point_of(preset, 8)));
            let expected = of(Recipe::of(preset).unwrap());
            for &field in same {
                let near = |a: &Value, b: &Value| match (a.as_f64(), b.as_f64()) {
                    (Some(a), Some(b)) => (a / b - 1.0).abs() < 0.05,
                    _ => a == b,
                };
                assert!(near(&found[field], &expected[field]), "{preset} {field}: {found} {expected}");
            }
            assert_eq!(width_of(&space.point_of(preset, 4)), 4);
            // Where the space has all that a builder is, it is found as itself.
            if ["aac", "ploc", "phr-hq"].contains(&preset) {
                assert_eq!(space.recipe_of(&space.point_of(preset, 4)).name(), preset);
            }
        }
    }
}
