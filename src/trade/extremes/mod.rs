//! The extremes atlas: shipped scenes taken to the ends of what numbers can say, in f32 and in f64, and what holds there.
//!
//! Each cell is a scene with one of its inputs at an extreme ([`Change`]), drawn by the rasterizer on its triangles and by
//! the tracer on the true shapes, in f32 and in f64. The bar: every f32 value within 1e-5 x max(1, magnitude) of f64 (2e-4
//! where an exponent is above 1000), the same object in every pixel, and no NaN.
//!
//! Where a figure is over the bar, either the program is at fault or the scene is ill-conditioned there, and that is
//! measured, not argued: a third render, in f64, takes the same inputs as f32 does, rounded ([`Rounded`], and the assembly's
//! vertices): each changed by at most half an ulp of f32. What f32 and this render differ by is the arithmetic, ours, and
//! stays under the bar whatever the scene. What this render and plain f64 differ by is the scene's: the condition number is
//! the largest relative change of a value over 2^-24, and the input named is the one that makes it when rounded alone.
//!
//! One thing is not in the inputs: whether n.l is above 0, or a point inside a spot cone, is decided by f32 arithmetic that
//! is off by some ulp. A pixel over the bar counts as explained, too, where the rounded render itself changes by as much when
//! its lights move by 4 units of roundoff.
//!
//! | module | does |
//! | - | - |
//! | `change` | an input taken to an extreme |
//! | `needles` | triangles of any aspect in place of a mesh's own |
//! | `sheets` | which scenes, which values |
//! | `measure` | one cell: renders, errors, conditions |

mod change;
mod measure;
mod needles;
mod sheets;

pub use change::Change;
pub use measure::{BAR, BAR_HIGH_EXPONENT};

use rayon::prelude::*;
use serde::Serialize;

use crate::error::Error;
use crate::frame::Plane;
use crate::import::{LoadOptions, load};
use crate::lanes::Isa;
use crate::lighting::Rounded;

/// How the atlas is made.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Width of a picture in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Tessellation of the rasterizer's triangles.
    pub level: u32,
    /// Only the first scene of each sheet, and its least, middle and largest setting.
    pub quick: bool,
    /// Instruction set of the lanes.
    pub isa: Isa,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            width: 120,
            height: 90,
            level: 32,
            quick: false,
            isa: Isa::detect(),
        }
    }
}

/// Every sheet.
#[derive(Clone, Debug, Serialize)]
pub struct Atlas {
    /// Width and height of the pictures.
    pub size: [u32; 2],
    /// Tessellation of the rasterizer's triangles.
    pub level: u32,
    /// One input each.
    pub sheets: Vec<Sheet>,
}

/// One input over its range.
#[derive(Clone, Debug, Serialize)]
pub struct Sheet {
    /// Short name, for tables.
    pub name: &'static str,
    /// A heading.
    pub title: &'static str,
    /// What is done to the scenes, in a sentence or two.
    pub text: &'static str,
    /// Scene by scene, each with all settings in order.
    pub cells: Vec<Cell>,
}

/// One scene at one setting.
#[derive(Clone, Debug, Serialize)]
pub struct Cell {
    /// Shipped scene.
    pub scene: &'static str,
    /// The setting in words.
    pub setting: String,
    /// What every figure has to stay under.
    pub bar: f64,
    /// The rasterizer, per fragment, on triangles.
    pub raster: Figure,
    /// The tracer on the true shapes.
    pub trace: Figure,
    /// RMSE of the triangles against the true shapes, both f64 and without shadows and secondary rays, over pixels where
    /// both show the same object.
    pub mesh_rmse: f64,
    /// Pixels where triangles and true shapes show another object.
    pub mesh_pixels: usize,
    /// The rasterizer's picture in f32.
    #[serde(skip)]
    pub raster_picture: Plane<[f32; 3]>,
    /// The tracer's picture in f32.
    #[serde(skip)]
    pub trace_picture: Plane<[f32; 3]>,
}

/// f32 against f64 in one renderer. Errors are relative to max(1, magnitude of the f64 value).
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Figure {
    /// Largest error.
    pub error: f64,
    /// Largest error against f64 on the same rounded inputs, of pixels that the lights' roundoff does not explain.
    pub arithmetic: f64,
    /// Values that are no number, in either precision.
    pub not_numbers: usize,
    /// Pixels where f32 shows another object than f64.
    pub objects: usize,
    /// Those of them that f64 on the same rounded inputs does not show alike: wrong decisions.
    pub wrong: usize,
    /// Pixels with an error over the bar.
    pub over: usize,
    /// What the scene's conditioning is, where a figure is over the bar or an object differs.
    pub condition: Option<Condition>,
}

/// How much half an ulp of an input does.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Condition {
    /// The input whose rounding alone does most.
    pub input: &'static str,
    /// Largest change of a value when it alone is rounded to f32, relative to max(1, magnitude).
    pub change: f64,
    /// That change over 2^-24.
    pub number: f64,
    /// Pixels that show another object when it alone is rounded.
    pub objects: usize,
}

impl Figure {
    /// Under the bar, and every object the same.
    pub fn holds(&self, bar: f64) -> bool {
        self.not_numbers == 0 && self.error <= bar && self.objects == 0
    }

    /// What is not as it should be, and not the scene's doing: an error of the arithmetic over the bar, a wrong decision, a
    /// NaN.
    pub fn fault(&self, bar: f64) -> bool {
        self.not_numbers > 0 || self.wrong > 0 || self.arithmetic > bar
    }
}

impl Cell {
    /// Both renderers' figures with the renderers' names.
    pub fn figures(&self) -> [(&'static str, &Figure); 2] {
        [("raster", &self.raster), ("trace", &self.trace)]
    }
}

impl Atlas {
    /// Every cell with the sheet that it is on.
    pub fn cells(&self) -> impl Iterator<Item = (&Sheet, &Cell)> {
        self.sheets
            .iter()
            .flat_map(|sheet| sheet.cells.iter().map(move |cell| (sheet, cell)))
    }
}

/// Draws and measures the atlas; `progress` hears the name of each cell before it starts.
///
/// # Errors
/// What importing or rendering a shipped scene refuses.
pub fn atlas(options: &Options, progress: &(dyn Fn(&str) + Sync)) -> Result<Atlas, Error> {
    let plans = sheets::SHEETS.iter();
    let sheets = plans.map(|plan| sheet(plan, options, progress));
    Ok(Atlas {
        size: [options.width, options.height],
        level: options.level,
        sheets: sheets.collect::<Result<_, _>>()?,
    })
}

/// How many cells [`atlas`] will draw.
pub fn cell_count(options: &Options) -> usize {
    let plans = sheets::SHEETS.iter();
    plans.map(|plan| plan.cells(options.quick).len()).sum()
}

fn sheet(
    plan: &sheets::SheetPlan,
    options: &Options,
    progress: &(dyn Fn(&str) + Sync),
) -> Result<Sheet, Error> {
    let cells = plan.cells(options.quick);
    // Pictures are small: a thread a cell; collected in order, whatever the threads do.
    let cells = cells.into_par_iter().map(|(name, change)| {
        progress(&format!("{}: {name}, {}", plan.name, change.label()));
        let mut scene = load(name, &LoadOptions::default())?.scene;
        (scene.image.width, scene.image.height) = (options.width, options.height);
        scene.image.samples = 1;
        change.apply(&mut scene)?;
        measure::cell(name, change.label(), scene, options)
    });
    Ok(Sheet {
        name: plan.name,
        title: plan.title,
        text: plan.text,
        cells: cells.collect::<Result<_, _>>()?,
    })
}

/// The inputs of a render in f32, as groups that can be rounded alone.
const INPUTS: [(&str, Rounded); 4] = {
    let none = Rounded {
        positions: false,
        normals: false,
        viewers: false,
        lights: false,
    };
    [
        (
            "positions",
            Rounded {
                positions: true,
                ..none
            },
        ),
        (
            "normals",
            Rounded {
                normals: true,
                ..none
            },
        ),
        (
            "directions to the viewer",
            Rounded {
                viewers: true,
                ..none
            },
        ),
        (
            "lights",
            Rounded {
                lights: true,
                ..none
            },
        ),
    ]
};
