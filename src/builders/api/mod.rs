//! What builders have in common: [`builder`], the trait and what a build is, and [`config_error`], refused parameters.

pub(crate) mod builder;
pub(crate) mod config_error;
