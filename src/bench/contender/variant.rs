//! Contenders with parameters of their own: one of our builders under a name that carries what differs, as
//! `phr-hq[delta=8]`.

use super::{Contender, Ours};
use crate::bench::cell::Cell;
use crate::builders::{Builder, ConfigError, Hunt, HuntConfig, Phr, PhrConfig};

/// The parameters of one of our builders.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Configuration {
    /// Of PHR.
    Phr(PhrConfig),
    /// Of Hunt's method.
    Hunt(HuntConfig),
}

/// A builder with parameters of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct Variant {
    /// Name in the records.
    pub name: String,
    /// The parameters.
    pub configuration: Configuration,
}

impl Variant {
    /// The builder `base` with other `fields`, as "delta=8".
    pub fn new(base: &str, fields: &str, configuration: Configuration) -> Self {
        Self { name: format!("{base}[{fields}]"), configuration }
    }

    /// Its cell of trees of `width`, traced by the kernels of all our trees.
    pub fn cell(&self, width: u32) -> Cell {
        Cell { builder: self.name.clone(), width, kernels: super::embree::kernels_of_ours() }
    }

    /// The builder of trees of `width`.
    ///
    /// # Errors
    /// A parameter out of range, or a width other than 4 and 8.
    pub fn contender(&self, width: u32) -> Result<Contender, String> {
        let Self { name, configuration } = self;
        let configuration = *configuration;
        make::<4>(configuration).map_err(|error| format!("{name}: {error}"))?;
        match width {
            4 => Ok(Contender::Four(Ours::new(move || made(configuration)))),
            8 => Ok(Contender::Eight(Ours::new(move || made(configuration)))),
            _ => Err(format!("{name} builds trees of width 4 and 8")),
        }
    }
}

fn make<const N: usize>(configuration: Configuration) -> Result<Box<dyn Builder<N>>, ConfigError> {
    Ok(match configuration {
        Configuration::Phr(config) => Box::new(Phr::new("phr", config)?),
        Configuration::Hunt(config) => Box::new(Hunt::new("hunt", config)?),
    })
}

fn made<const N: usize>(configuration: Configuration) -> Box<dyn Builder<N>> {
    make(configuration).expect("the parameters were checked before")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_are_checked_and_told() {
        let delta = |delta| {
            let config = PhrConfig { delta, ..PhrConfig::HQ };
            Variant::new("phr-hq", &format!("delta={delta}"), Configuration::Phr(config))
        };
        assert!(delta(8.0).contender(4).is_ok() && delta(8.0).contender(8).is_ok());
        assert_eq!(delta(8.0).cell(4).builder, "phr-hq[delta=8]");
        let error = |variant: Variant, width| variant.contender(width).err().unwrap();
        assert_eq!(error(delta(-1.0), 4), "phr-hq[delta=-1]: delta = -1.0 is out of range; give 0.0 to 64.0");
        assert!(error(delta(8.0), 5).contains("width 4 and 8"));
    }
}
