//! What people and programs read: picture files, figures, `summary.json` and the page.
//!
//! In: plain data (planes of linear colours, names, numbers). Out: bytes and files. Nothing here renders but
//! the pixels that `page` has explained, by `explain`, and nothing here decides what a number is: the ladder and the metrics do. Row 0 is the top row throughout.
//!
//! - [`files`]: which format a path asks for, atomic writes; [`formats`] and [`layered`]: PNG, PFM, HDR and EXR bytes.
//! - [`picture`]: 8-bit pictures as they are shown. [`text`]: type as outlines. [`figures`]: strips, maps with legends,
//!   the equation growing. [`equation`]: the equation as pieces, for figures and page alike.
//! - [`comparison`]: a climbed ladder becomes a [`Report`]; [`layers`]: the layers of its `layers.exr`; [`folder`]: its files,
//!   by name; [`difference`]: maps of differences.
//! - [`checked`]: a check of somebody's own picture: pictures, text, JSON.
//! - [`origin`]: command lines to type again, settings; [`lines`]: running text in a terminal.
//! - [`deck`]: the slides of a lecture; [`topic`]: what a scene is about and how that is lit in the equation; [`prose`]:
//!   sentences with symbols in them.
//! - [`pixel`]: one pixel explained, as text, figure and ray paths.
//! - [`animation`]: animated GIF; [`palette`]: its colours.
//! - `peer` (feature `opengl`): the rasterizer against the system's OpenGL, as a folder of its own.
//! - [`atlas`]: the extremes atlas.
//! - [`trade`]: speed against accuracy, as a folder of its own.
//! - [`diff`]: two picture files against each other.
//! - [`summary`]: `summary.json`. [`causes`]: what each cause means, in sentences. [`page`]: `index.html`.
//! - `document`: the shell of every page, and its style sheets.

pub mod animation;
pub mod atlas;
pub mod causes;
pub mod checked;
pub mod comparison;
pub mod deck;
pub mod diff;
pub mod difference;
mod document;
pub mod equation;
pub mod figures;
pub mod files;
pub mod folder;
pub mod formats;
pub mod layered;
pub mod layers;
mod layout;
pub mod lines;
pub mod numbers;
pub mod origin;
pub mod page;
pub mod palette;
#[cfg(feature = "opengl")]
pub mod peer;
pub mod picture;
pub mod pixel;
pub mod prose;
pub mod summary;
pub mod text;
pub mod topic;
pub mod trade;

pub use page::{Live, NamedPlane, Report};
