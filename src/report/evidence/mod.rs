//! A few builders at a glance ([`summary`]), builds by more workers ([`scaling`]), and what answers doubts: trees
//! on the front in single scenes ([`fronts`]), open beside withheld scenes ([`holdout`]), the constants chosen on
//! scenes and their neighbours ([`constants`]), and what Embree's assertions cost ([`assertions`]).

pub mod assertions;
pub mod constants;
pub mod fronts;
pub mod holdout;
pub mod scaling;
pub mod summary;
