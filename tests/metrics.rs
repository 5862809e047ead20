//! Image metrics against independent packages, and `rastray diff` as a user meets it.

#[path = "metrics/reference.rs"]
mod reference;
