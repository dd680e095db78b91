//! The benchmark driver: what is run ([`plan`]), how it is timed ([`measure`]) and what is written
//! ([`records`], [`environment`]).

pub mod environment;
pub mod load;
pub mod random;
pub mod records;
pub mod statistics;
pub mod warnings;
