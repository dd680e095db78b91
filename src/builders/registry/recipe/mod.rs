//! A builder with some fields of its configuration changed. Its name says which: `phr-hq[delta=8]`,
//! `phr-speed[presplit=none+max_cut=4096]`, so that its figures are not taken for the preset's. The characters of
//! such a name mean nothing in CSV, Markdown and names of files.
//!
//! [`fields`] reads and writes the fields of any configuration by their names, [`error`] says what is wrong with one.

#![cfg_attr(not(test), warn(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

pub mod error;
mod fields;

use self::error::RecipeError;
use crate::builders::api::builder::{BoxBuilder, Build, Builder};
use crate::builders::phr::config::PhrConfig;
use crate::builders::registry::{self, Config, make};
use crate::bvh::WideBvh;
use crate::geometry::Mesh;
use serde_json::Value;

/// Stands between two changes.
const AND: char = '+';

/// A builder of the list with some of its fields changed, in range.
#[derive(Clone, Debug)]
pub struct Recipe {
    base: &'static str,
    config: Config,
    /// Fields in the order in which they were set, each with its value.
    changes: Vec<(String, Value)>,
}

impl Recipe {
    /// The builder called `base` as it is.
    ///
    /// # Errors
    /// No builder of that name.
    pub fn of(base: &str) -> Result<Self, RecipeError> {
        let found = registry::config(base);
        let (base, config) = found.ok_or_else(|| RecipeError::NoSuchBuilder(base.into()))?;
        Ok(Self { base, config, changes: Vec::new() })
    }

    /// The builder called `name`: `BUILDER` or `BUILDER[FIELD=VALUE+FIELD=VALUE]`.
    ///
    /// # Errors
    /// Those of [`RecipeError`].
    pub fn parse(name: &str) -> Result<Self, RecipeError> {
        let Some((base, changes)) = name.split_once('[') else { return Self::of(name) };
        let malformed = || RecipeError::Malformed(name.into());
        let mut recipe = Self::of(base)?;
        for change in changes.strip_suffix(']').ok_or_else(malformed)?.split(AND) {
            let (field, value) = change.split_once('=').ok_or_else(malformed)?;
            recipe.set(field, &fields::value_of(value))?;
        }
        Ok(recipe)
    }

    /// Changes the builder as a command line says: `FIELD=VALUE`.
    ///
    /// # Errors
    /// Those of [`RecipeError`].
    pub fn set_text(&mut self, change: &str) -> Result<(), RecipeError> {
        let malformed = || RecipeError::Malformed(format!("{}.{change}", self.base));
        let (field, value) = change.split_once('=').ok_or_else(malformed)?;
        self.set(field, &fields::value_of(value))
    }

    /// Sets a field, by its name or the end of it (`filled` for `presplit.filled`) where that is clear. `null` or
    /// `false` turns an extension off, `true` on; an object sets the fields within.
    ///
    /// # Errors
    /// No such field, a value of another kind or out of range.
    pub fn set(&mut self, field: &str, value: &Value) -> Result<(), RecipeError> {
        let template = fields::with_everything_on(&self.config);
        let path = fields::find(&template, field).ok_or_else(|| RecipeError::Field {
            builder: self.base,
            field: field.into(),
            known: fields::paths(&template).join(", "),
        })?;
        if let (Value::Object(inner), Value::Object(_)) = (value, fields::at(&template, &path)) {
            // All of them, or none.
            let mut changed = self.clone();
            inner.iter().try_for_each(|(name, value)| changed.set(&format!("{path}.{name}"), value))?;
            *self = changed;
            return Ok(());
        }
        let refused = |reason: String| RecipeError::Value {
            builder: self.base,
            change: format!("{path}={}", fields::in_words(value)),
            reason,
        };
        let config = fields::changed(&self.config, &template, &path, value).map_err(refused)?;
        // Both widths have the same ranges.
        make::over_triangles::<4>(self.base, config).map_err(|error| refused(error.to_string()))?;
        self.config = config;
        let inside = format!("{path}.");
        self.changes.retain(|(known, _)| *known != path && !known.starts_with(&inside));
        self.changes.push((path, value.clone()));
        Ok(())
    }

    /// The name of the builder that is changed.
    pub fn base(&self) -> &'static str {
        self.base
    }

    /// The name, which [`Recipe::parse`] reads.
    pub fn name(&self) -> String {
        if self.changes.is_empty() {
            return self.base.into();
        }
        let changes: Vec<String> = self
            .changes
            .iter()
            .map(|(field, value)| format!("{field}={}", fields::in_words(value)))
            .collect();
        format!("{}[{}]", self.base, changes.join(&AND.to_string()))
    }

    /// The fields that were changed, each with its value: `null` or `false` turned an extension off, `true` on.
    pub fn changes(&self) -> serde_json::Map<String, Value> {
        self.changes.iter().cloned().collect()
    }

    /// The configuration of a builder by PHR alone, for [`Phr`](crate::builders::Phr) and
    /// [`MergedPhr`](crate::builders::MergedPhr); `None` of others.
    pub fn phr(&self) -> Option<PhrConfig> {
        match self.config {
            Config::Phr(config) => Some(config),
            _ => None,
        }
    }

    /// The builder over boxes of anything, under the name that it has without changes.
    #[allow(clippy::expect_used, reason = "changes are checked when they are made")]
    pub fn builder_over_boxes<const N: usize>(&self) -> Box<BoxBuilder<N>> {
        let built = make::over_boxes(self.base, self.config);
        built.expect("changes are in range, as was seen when they were made")
    }

    /// The builder, of trees of nodes of up to `N` children, 4 or 8.
    #[allow(clippy::expect_used, reason = "changes are checked when they are made")]
    pub fn builder<const N: usize>(&self) -> Box<dyn Builder<N>> {
        let built = make::over_triangles(self.base, self.config);
        let builder = built.expect("changes are in range, as was seen when they were made");
        if self.changes.is_empty() { builder } else { Box::new(Renamed { name: self.name(), builder }) }
    }
}

/// A builder under another name.
struct Renamed<const N: usize> {
    name: String,
    builder: Box<dyn Builder<N>>,
}

impl<const N: usize> Builder<N> for Renamed<N> {
    fn name(&self) -> &str {
        &self.name
    }

    fn config(&self) -> Value {
        self.builder.config()
    }

    fn build(&mut self, mesh: &Mesh) -> Build<N> {
        self.builder.build(mesh)
    }

    fn recycle(&mut self, tree: WideBvh<N>) {
        self.builder.recycle(tree);
    }
}

#[cfg(test)]
mod tests;
