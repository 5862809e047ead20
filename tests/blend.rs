//! `raster.transparency = "blend"` against answers derived by hand: C = alpha C_s + (1 - alpha) C_d, alpha = 1 - luminance(K_T).

use rastray::decompose::{CAUSES, decompose};
use rastray::frame::{Frame, LayerIndex, NONE};
use rastray::gl::ShadeModel;
use rastray::import::{LoadOptions, load, load_text};
use rastray::lanes::{Isa, Real};
use rastray::math::color::luma;
use rastray::raster::{Counters, Options, Plan};
use rastray::scene::assembly::Assembly;
use rastray::scene::requirements::Model;
use rastray::scene::{Scene, Snap, Transparency};
