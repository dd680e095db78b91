//! The fields of a configuration by name, as its JSON has them: `delta`, `presplit.filled`, `optimise.costs.leaf`.

use crate::builders::phr::config::PhrConfig;
use crate::builders::phr::extensions::clustered::ClusteredPhrConfig;
use crate::builders::registry::Config;
use serde_json::Value;

/// The fields of a configuration.
#[allow(clippy::expect_used, reason = "whatever the command line says, it became a configuration first")]
pub fn fields(config: &Config) -> Value {
    serde_json::to_value(config).expect("configurations are plain data")
}

/// The fields of a configuration with every extension on, which has all names that there are; what is off in the
/// configuration has the value of `phr-quality`, or of `phr-turbo` in one over clusters.
pub fn with_everything_on(config: &Config) -> Value {
    let mut on = fields(config);
    let (phr, standard) = match config {
        Config::Phr(_) => (Some(&mut on), Config::Phr(PhrConfig::QUALITY)),
        Config::OptimisedPhr(_) => (on.get_mut("phr"), Config::Phr(PhrConfig::QUALITY)),
        Config::ClusteredPhr(_) => (Some(&mut on), Config::ClusteredPhr(ClusteredPhrConfig::TURBO)),
        Config::Lbvh | Config::Aac(_) | Config::Ploc(_) | Config::Hunt(_) => return on,
    };
    if let Some(phr) = phr {
        fill(phr, &fields(&standard));
    }
    on
}

/// Gives what is null the value that `from` has there.
fn fill(value: &mut Value, from: &Value) {
    match value {
        Value::Null => *value = from.clone(),
        Value::Object(fields) => fields.iter_mut().for_each(|(name, value)| fill(value, at(from, name))),
        _ => {}
    }
}

/// All names, those of fields that hold others among them.
pub fn paths(template: &Value) -> Vec<String> {
    let mut found = Vec::new();
    for (name, value) in template.as_object().into_iter().flatten() {
        found.push(name.clone());
        found.extend(paths(value).into_iter().map(|inner| format!("{name}.{inner}")));
    }
    found
}

/// The full name of `field`: it, or the only one that ends so. One field has another name in Rust.
pub fn find(template: &Value, field: &str) -> Option<String> {
    let (all, field) = (paths(template), &field.replace("local_threshold", "own_threshold")[..]);
    if all.iter().any(|path| path == field) {
        return Some(field.into());
    }
    let end = format!(".{field}");
    let mut ending = all.into_iter().filter(|path| path.ends_with(&end));
    ending.next().filter(|_| ending.next().is_none())
}

/// The value of the field of a full name.
pub fn at<'a>(fields: &'a Value, path: &str) -> &'a Value {
    path.split('.').fold(fields, |inside, name| inside.get(name).unwrap_or(&Value::Null))
}

/// The configuration with another value in the field of a full name. `false` turns off what may be off: an
/// extension, and spatial splits by an infinite `spatial_threshold`. Fields beside it in an extension that was off
/// are those of `template`.
///
/// # Errors
/// A value of another kind.
pub fn changed(config: &Config, template: &Value, path: &str, value: &Value) -> Result<Config, String> {
    let mut all = fields(config);
    let (mut place, mut standard) = (&mut all, template);
    for name in path.split('.') {
        if place.is_null() {
            *place = standard.clone();
        }
        let fields = place.as_object_mut().ok_or_else(|| format!("no field {path}"))?;
        place = fields.entry(name).or_insert(Value::Null);
        standard = standard.get(name).unwrap_or(&Value::Null);
    }
    *place = match (value, standard) {
        (Value::Bool(true), Value::Object(_)) => standard.clone(),
        (Value::Bool(false), Value::Object(_) | Value::Number(_) | Value::Null) => Value::Null,
        _ => value.clone(),
    };
    let of =
        |error: serde_json::Error| format!("{error}; give a number, on or off, and + between two changes");
    Ok(match config {
        Config::Lbvh => Config::Lbvh,
        Config::Aac(_) => Config::Aac(serde_json::from_value(all).map_err(of)?),
        Config::Ploc(_) => Config::Ploc(serde_json::from_value(all).map_err(of)?),
        Config::Hunt(_) => Config::Hunt(serde_json::from_value(all).map_err(of)?),
        Config::Phr(_) => Config::Phr(serde_json::from_value(all).map_err(of)?),
        Config::ClusteredPhr(_) => Config::ClusteredPhr(serde_json::from_value(all).map_err(of)?),
        Config::OptimisedPhr(_) => Config::OptimisedPhr(serde_json::from_value(all).map_err(of)?),
    })
}

/// The value of a text: a number, `on`, `off` or `none`; any other text is itself, and no field's value.
pub fn value_of(text: &str) -> Value {
    match text.trim() {
        "none" | "null" => Value::Null,
        "on" | "true" => Value::Bool(true),
        "off" | "false" => Value::Bool(false),
        text => match text.parse::<f64>() {
            // Whole numbers may be those of counts.
            Ok(number) if number.fract() == 0.0 && (0.0..9e15).contains(&number) => {
                Value::from(number as u64)
            }
            Ok(number) if number.is_finite() => Value::from(number),
            _ => Value::String(text.into()),
        },
    }
}

/// A value as [`value_of`] reads it, numbers in their shortest form.
pub fn in_words(value: &Value) -> String {
    match value {
        Value::Null => "none".into(),
        Value::Bool(true) => "on".into(),
        Value::Bool(false) => "off".into(),
        Value::Number(number) => {
            let number = number.as_f64().unwrap_or(f64::NAN);
            let (plain, powers) = (format!("{number}"), format!("{number:e}"));
            if plain.len() <= powers.len() { plain } else { powers }
        }
        Value::String(text) => text.clone(),
        other => other.to_string(),
    }
}
