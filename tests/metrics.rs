//! Image metrics against independent packages, picture files of all kinds, and `rastray diff` as a user meets it.

#[path = "metrics/diff.rs"]
mod diff;
#[path = "metrics/kinds.rs"]
mod kinds;
#[path = "metrics/layers.rs"]
mod layers;
#[path = "metrics/pictures.rs"]
mod pictures;
#[path = "metrics/reference.rs"]
mod reference;
