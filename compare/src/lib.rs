//! Image metrics and difference maps on borrowed pixel views.
//!
//! In: two [`ImageView`]s of one size, or the plain differences of two pictures as `&[[f64; 3]]`. Out: numbers
//! ([`Metrics`], [`StepSummary`]) and RGB8 pictures with their scale ([`Map`]). Nothing here knows scenes, renderers or
//! files, and nothing here changes a pixel before it is measured: no resizing, no clamping, no change of encoding.
//!
//! *Error* = test - reference: the reference is trusted, the test is judged. A value is one channel of one pixel.
//!
//! | number | what it means | when it misleads |
//! | - | - | - |
//! | `mse` | mean of the squared errors of all values | one bright pixel weighs as much as a thousand faint ones; says nothing about where |
//! | `rmse` | its square root, in the unit of the values | two pictures with the same rmse can look nothing alike |
//! | `mae` | mean of the absolute errors | a small region that is entirely wrong disappears in a large picture |
//! | `max` | the largest absolute error | one value decides; antialiased edges make it useless for judging the rest |
//! | `p50`, `p95`, `p99` | the absolute error that 50, 95, 99 % of the values do not exceed (nearest rank) | where most of the picture is background, all three may be 0 |
//! | `psnr` | 10 log10(1/mse), dB against a peak of 1; none where the pictures are identical | meaningless for pictures whose values go far beyond 1; a difference of 1 dB is not visible as such |
//!
//! They are meant for values in [0, 1], as stored (linear or sRGB: the encoding changes every one of these numbers, and
//! views of different encodings refuse to be compared). Larger values, as float files hold, are measured as they are;
//! `psnr` still refers to a peak of 1. None of these numbers is a model of what people see.
//!
//! All sums run in f64 in one order: values left to right within a row, then the rows from top to bottom.
//! SSIM, FLIP and masks are not part of this crate yet.
#![forbid(unsafe_code)]

mod maps;
mod metrics;
mod scale;
mod view;

pub use maps::{Map, Reduction, magnitude_map, signed_map};
pub use metrics::{Metrics, StepSummary, differences, metrics, pixels_differing, summarize};
pub use scale::{Scale, ScaleKind, nice_maximum};
pub use view::{CompareError, Encoding, ImageView};
