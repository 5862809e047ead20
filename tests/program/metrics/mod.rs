//! Image metrics against independent packages, picture files of all kinds, and `rastray diff` as a user meets it.

mod diff;
mod kinds;
mod layers;
mod pictures;
mod reference;
