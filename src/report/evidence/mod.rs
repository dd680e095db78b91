//! A few builders at a glance ([`summary`]), builds on several threads ([`speedups`]) and by more workers than there
//! are ([`scaling`]), and what answers doubts: trees on the front in single scenes ([`fronts`]), open beside withheld
//! scenes ([`holdout`]), the constants chosen on scenes and their neighbours ([`constants`]), and what Embree's
//! assertions cost ([`assertions`]).

pub mod assertions;
pub mod constants;
pub mod fronts;
pub mod holdout;
pub mod scaling;
pub mod speedups;
pub mod summary;
