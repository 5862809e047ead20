//! Speed for accuracy: what each knob of the renderers costs and buys on a scene, measured.
//!
//! In: a scene and a budget in seconds. Out: for each setting its error against the truth ([`truth`], [`accuracy`]), its
//! exact operation counts and its time with an interval ([`cost`], [`timing`]); the Pareto front, slopes beside those that
//! theory predicts, and the cheapest setting for an accuracy. Nothing here writes pages: see [`crate::report`].
//!
//! | module | does |
//! | - | - |
//! | `setting` | one way to draw a scene, and the flags that ask for it |
//! | `draw` | a setting drawn |
//! | `truth` | what settings are measured against |
//! | `accuracy` | how far a picture is from it |
//! | `cost` | operation counts, and one number made of them |
//! | `timing` | times in pairs, with an interval or none |
//! | `measure` | a setting judged by its truths |
//! | `axis` | the knobs one at a time, and the grid of all |
//! | `run` `journal` | everything within a budget; what is known so far, on disk |
//! | `fit` `front` | slopes; the Pareto front |
//! | `extremes` | the atlas: shipped scenes at the ends of every input |
//! | `finding` | rows, curves, answers |
//! | `choose` `verify` | the setting for an accuracy or a time; whether a promise holds at other places |
//! | `power` | forms of the power, on a scene's exponents |
//!
//! Numerics guide, section 6.

pub mod accuracy;
pub mod axis;
pub mod choose;
pub mod cost;
pub mod draw;
pub mod extremes;
pub mod finding;
pub mod fit;
pub mod front;
pub mod journal;
pub mod measure;
pub mod power;
pub mod run;
pub mod setting;
pub mod timing;
pub mod truth;
pub mod verify;
