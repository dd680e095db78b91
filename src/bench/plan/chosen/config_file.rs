//! A builder's configuration in a file: a name, the builder that is changed, and the fields that differ. `phr tune -o`
//! writes such files.

use crate::bench::cell::ORDER;
use crate::bench::error::PlanError;
use crate::bench::files::text;
use crate::builders::{Recipe, on_request};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use std::path::{Path, PathBuf};

/// A named configuration.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ConfigFile {
    /// Name in records.
    pub name: String,
    /// The builder that is changed.
    pub base: String,
    /// Children per node, where the configuration is for one width.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub width: Option<u32>,
    /// The fields that differ, by name.
    #[serde(default)]
    pub fields: Map<String, Value>,
    /// Where it comes from; for readers.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub about: Option<String>,
    #[serde(skip)]
    path: PathBuf,
}

impl ConfigFile {
    /// A configuration to be written.
    pub fn new(name: &str, recipe: &Recipe, width: u32, about: String) -> Self {
        Self {
            name: name.into(),
            base: recipe.base().into(),
            width: Some(width),
            fields: recipe.changes(),
            about: Some(about),
            path: PathBuf::new(),
        }
    }

    /// Reads a file.
    ///
    /// # Errors
    /// A file that is missing or has another content, in one line.
    pub fn read(path: &Path) -> Result<Self, PlanError> {
        let refused = |reason: String| PlanError::Config { path: path.into(), reason };
        let text = text(path).map_err(|error| refused(error.to_string()))?;
        let read = serde_json::from_str(&text).map_err(|error| refused(error.to_string()))?;
        let file = Self { path: path.into(), ..read };
        file.check().map_err(refused)?;
        Ok(file)
    }

    fn check(&self) -> Result<(), String> {
        Self::check_name(&self.name)?;
        match self.width {
            None | Some(4 | 8) => Ok(()),
            Some(width) => Err(format!("width {width}: give 4 or 8")),
        }
    }

    /// Refuses a name that is a builder's or means something in files and tables.
    ///
    /// # Errors
    /// What is wrong with it, in one line.
    pub fn check_name(name: &str) -> Result<(), String> {
        let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
        let is_taken = ORDER.contains(&name) || on_request().any(|known| known == name);
        if name.is_empty() || name.len() > 60 || !name.chars().all(is_plain) {
            return Err(format!("name {name:?}: give up to 60 letters, digits, -, _ and ."));
        }
        if is_taken || name.starts_with("embree") {
            return Err(format!("name {name:?}: is that of a builder; give another"));
        }
        Ok(())
    }

    /// The builder that it describes.
    ///
    /// # Errors
    /// No such builder or field, or a value that cannot be.
    pub fn recipe(&self) -> Result<Recipe, PlanError> {
        let made = || {
            let mut recipe = Recipe::of(&self.base)?;
            self.fields.iter().try_for_each(|(field, value)| recipe.set(field, value))?;
            Ok(recipe)
        };
        made().map_err(|error: crate::builders::RecipeError| PlanError::Config {
            path: self.path.clone(),
            reason: error.to_string(),
        })
    }
}
