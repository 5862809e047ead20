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
//! | `ssim` | mean similarity of brightness, contrast and structure in windows of 11 x 11 pixels (Wang et al. 2004); 1 = the same | of luma alone: a change of hue can be free; values near black weigh much; none where the picture is smaller than a window |
//! | `flip` | the error that a viewer sees who flips between the pictures on a screen (Andersson et al. 2020, 2021), per pixel in [0, 1]; mean, median, max | takes the values for sRGB as a screen would, whatever they are; a mean hides a small error that everybody sees: look at the map |
//!
//! They are meant for values in [0, 1], as stored (linear or sRGB: the encoding changes every one of these numbers, and
//! views of different encodings refuse to be compared). Where both pictures hold whole 255ths or 65535ths, as 8-bit and
//! 16-bit files do, errors are those of the fractions, not of their nearest f32. Larger values, as float files hold, are measured as they are;
//! `psnr` and `ssim` still refer to a range of 1. FLIP alone is a model of what people see: of [`DynamicRange::Low`] it looks
//! at the 8-bit picture, of [`DynamicRange::High`] at the light under several exposures. All of them can be restricted to a
//! mask ([`Comparison::metrics_in`]).
//!
//! All sums run in f64 in one order: values left to right within a row, then the rows from top to bottom; maps pixel by
//! pixel. Any number of threads gives the same bytes.
//!
//! Features: `serde` derives its traits for [`Metrics`] and [`FlipSummary`], in the order and under the names of the fields.
//! Packages: colorous (magma), libm (the same bytes on every machine), rayon (bands of rows side by side).
#![forbid(unsafe_code)]

mod filter;
mod flip;
mod maps;
mod metrics;
mod scale;
mod ssim;
mod stats;
mod view;

pub use flip::{DEFAULT_PPD, DynamicRange, Exposures, FlipMap, FlipSummary, Viewing, flip};
pub use maps::{Map, Reduction, flip_map, magnitude_map, signed_map};
pub use metrics::{
    Comparison, Metrics, StepSummary, differences, metrics, pixels_differing, summarize,
};
pub use scale::{Scale, ScaleKind, nice_maximum};
pub use ssim::{SsimMap, ssim};
pub use stats::{mse, rmse};
pub use view::{CompareError, Encoding, ImageView};
