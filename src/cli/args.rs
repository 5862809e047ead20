//! What each command takes: clap structs, validated elsewhere.

use std::path::PathBuf;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, ColorChoice, ValueEnum};
use rastray::render::{Precision, Renderer};
use rastray::trace::Geometry;

/// Options that every command has.
#[derive(Debug, Args)]
pub(super) struct Global {
    /// Worker threads (default: one a core)
    #[arg(short = 'j', long, global = true, value_name = "N")]
    pub(super) threads: Option<usize>,
    /// Say nothing but errors
    #[arg(short, long, global = true, conflicts_with = "verbose")]
    pub(super) quiet: bool,
    /// Say more: each step as it starts
    #[arg(short, long, global = true, hide_short_help = true)]
    pub(super) verbose: bool,
    /// Colours in messages
    #[arg(
        long,
        global = true,
        value_name = "WHEN",
        default_value = "auto",
        hide_short_help = true
    )]
    pub(super) color: ColorChoice,
}

/// What `help` is asked about.
#[derive(Debug, Args)]
pub(super) struct HelpArgs {
    /// The command; without it, the whole program
    #[arg(value_name = "COMMAND")]
    pub(super) command: Option<String>,
}

/// The scene and its overrides.
#[derive(Debug, Args)]
pub(super) struct SceneArgs {
    /// A scene file (.toml, .scn, .obj), or the name of a shipped scene (see `rastray scenes`)
    #[arg(value_name = "SCENE")]
    pub(super) scene: String,
    /// Override a key of the scene file, such as material.red.shininess=64
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub(super) sets: Vec<String>,
    /// Refuse values that real OpenGL refuses, instead of noting them
    #[arg(long, hide_short_help = true)]
    pub(super) strict_gl: bool,
}

/// Who draws the picture of `render`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Who {
    /// A renderer of this program.
    Ours(Renderer),
    /// The system's real OpenGL, on the rasterizer's scene.
    Opengl,
}

impl Who {
    /// Its name, as `--mode` takes it.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Ours(renderer) => renderer.name(),
            Self::Opengl => "opengl",
        }
    }
}

/// Values by the name that the command line gives them, with a line of help each.
fn named<T: Copy + Send + Sync + 'static>(
    values: &'static [(&'static str, T, &'static str)],
) -> impl TypedValueParser<Value = T> {
    let possible =
        |(name, _, help): &(&'static str, T, &'static str)| PossibleValue::new(*name).help(*help);
    PossibleValuesParser::new(values.iter().map(possible)).map(|given| {
        let found = values.iter().find(|(name, ..)| *name == given);
        found.unwrap_or(&values[0]).1
    })
}

/// Parses `--mode` of `render`.
fn who() -> impl TypedValueParser<Value = Who> {
    named(&[
        (
            "raster",
            Who::Ours(Renderer::Raster),
            "OpenGL's picture: local illumination",
        ),
        (
            "cast",
            Who::Ours(Renderer::Cast),
            "Primary rays only, nothing blocked: the rasterizer's terms by rays",
        ),
        (
            "trace",
            Who::Ours(Renderer::Trace),
            "Whitted's picture: shadows, reflection, refraction",
        ),
        (
            "opengl",
            Who::Opengl,
            "The rasterizer's scene, drawn by the system's real OpenGL (feature opengl)",
        ),
    ])
}

/// Parses `--mode` where only this program's renderers are meant.
pub(super) fn renderer() -> impl TypedValueParser<Value = Renderer> {
    named(&[
        (
            "raster",
            Renderer::Raster,
            "Rasterized: flat, Gouraud or Phong",
        ),
        ("cast", Renderer::Cast, "Primary rays only, nothing blocked"),
        (
            "trace",
            Renderer::Trace,
            "Traced: shadows, reflection, refraction",
        ),
    ])
}

/// Parses `--precision`.
fn precision() -> impl TypedValueParser<Value = Precision> {
    named(&[
        ("f32", Precision::F32, "32-bit floats"),
        ("f64", Precision::F64, "64-bit floats, the whole path"),
    ])
}

/// Parses `--geometry`.
pub(super) fn geometry() -> impl TypedValueParser<Value = Geometry> {
    named(&[
        ("exact", Geometry::Exact, "The true shapes"),
        ("mesh", Geometry::Mesh, "The rasterizer's own triangles"),
    ])
}

/// What `compare` holds the rasterizer against.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum AgainstArg {
    /// The ray tracer: every difference split by cause
    Trace,
    /// The system's real OpenGL (feature opengl)
    Opengl,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum ShadingArg {
    /// One colour a triangle, from its last vertex
    Flat,
    /// Lit at the vertices, interpolated
    #[value(alias = "per-vertex")]
    Gouraud,
    /// Lit at every pixel
    #[value(alias = "per-pixel")]
    Phong,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(super) enum ModelArg {
    /// Only what the scene requires
    #[default]
    Required,
    /// Every feature, needed or not: the same bytes, slower
    Full,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum ClampArg {
    /// GL's clamps, as its picture has them
    Gl,
    /// No clamp until the file's own
    None,
}

/// How to render: what `render`, `compare` and `lecture` share.
#[derive(Debug, Default, Args)]
pub(super) struct QualityArgs {
    /// Size of the picture in pixels
    #[arg(long, value_name = "WxH")]
    pub(super) size: Option<String>,
    /// Samples a pixel
    #[arg(long, value_name = "N")]
    pub(super) samples: Option<u32>,
    /// Shading of the rasterizer: flat, gouraud (per-vertex), phong (per-pixel)
    #[arg(long, value_enum, value_name = "SHADING", hide_possible_values = true)]
    pub(super) shading: Option<ShadingArg>,
    /// Generations of reflected and refracted rays
    #[arg(long, value_name = "N")]
    pub(super) depth: Option<u32>,
    /// No shadow rays: every light is seen
    #[arg(long)]
    pub(super) no_shadows: bool,
    /// No mirror rays
    #[arg(long)]
    pub(super) no_reflection: bool,
    /// No transmitted rays
    #[arg(long)]
    pub(super) no_refraction: bool,
    /// Tessellation of shapes: slices of a full turn, half as many stacks (default 64)
    #[arg(
        long,
        value_name = "N",
        hide_short_help = true,
        help_heading = "Expert"
    )]
    pub(super) tessellation: Option<u32>,
    /// Precision of the whole path
    #[arg(
        long,
        value_parser = precision(),
        default_value = "f32",
        hide_short_help = true,
        help_heading = "Expert",
        value_name = "PRECISION"
    )]
    pub(super) precision: Precision,
    /// Sub-pixel bits that vertices snap to before coverage: 8, 12, or exact for none
    #[arg(
        long,
        value_name = "BITS",
        hide_short_help = true,
        help_heading = "Expert"
    )]
    pub(super) snap: Option<String>,
    /// Evaluate only what the scene requires, or everything: the same bytes
    #[arg(
        long,
        value_enum,
        default_value = "required",
        value_name = "MODEL",
        hide_short_help = true,
        help_heading = "Expert"
    )]
    pub(super) model: ModelArg,
    /// Instruction set: scalar, sse4.2, avx2, avx512, neon (default: the best there is): the same bytes
    #[arg(
        long,
        value_name = "ISA",
        hide_short_help = true,
        help_heading = "Expert"
    )]
    pub(super) isa: Option<String>,
    /// Encode displayed values as sRGB (default: linear values are stored as they are, as in GL)
    #[arg(long, hide_short_help = true, help_heading = "Expert")]
    pub(super) srgb: bool,
}

/// What happens around a run.
#[derive(Clone, Copy, Debug, Args)]
pub(super) struct FollowArgs {
    /// Show the result with the system's viewer
    #[arg(long)]
    pub(super) open: bool,
    /// Run again whenever an input file is saved, until Ctrl-C
    #[arg(long)]
    pub(super) watch: bool,
}

/// What `--error` and `--time` pick, and several frames, which would each be picked apart.
const PICKED: [&str; 12] = [
    "mode",
    "shading",
    "depth",
    "no_shadows",
    "no_reflection",
    "no_refraction",
    "tessellation",
    "precision",
    "snap",
    "geometry",
    "turntable",
    "vary",
];

#[derive(Debug, Args)]
pub(super) struct RenderArgs {
    #[command(flatten)]
    pub(super) scene: SceneArgs,
    /// Output: .png, .exr, .pfm, .hdr, .gif (several frames), - = PNG on stdout (default: SCENE.png)
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: Option<PathBuf>,
    /// Renderer: raster, cast (primary rays only), trace, opengl (this machine's, where built with it)
    #[arg(
        long,
        value_parser = who(),
        default_value = "raster",
        hide_possible_values = true
    )]
    pub(super) mode: Who,
    #[command(flatten)]
    pub(super) quality: QualityArgs,
    /// Pick the cheapest setting whose error (rmse of linear values) is at most E, such as 1/255
    #[arg(long, value_name = "E", conflicts_with_all = PICKED, allow_negative_numbers = true)]
    pub(super) error: Option<String>,
    /// Pick the most accurate setting that takes at most MS milliseconds on this machine
    #[arg(long, value_name = "MS", conflicts_with_all = PICKED, conflicts_with = "error", allow_negative_numbers = true)]
    pub(super) time: Option<f64>,
    /// Keep every term of the equation as a layer of its own (.exr)
    #[arg(long)]
    pub(super) layers: bool,
    /// N frames around the target, a full turn about the up axis: numbered files, or one .gif
    #[arg(long, value_name = "N", conflicts_with = "vary")]
    pub(super) turntable: Option<u32>,
    /// N frames with KEY (as in --set) from A to B: numbered files, or one .gif
    #[arg(long, value_name = "KEY=A..B:N")]
    pub(super) vary: Option<String>,
    /// Frames a second of a .gif
    #[arg(
        long,
        value_name = "N",
        default_value_t = 12,
        hide_short_help = true,
        help_heading = "Expert"
    )]
    pub(super) fps: u32,
    /// What the tracer traces: exact shapes, or the rasterizer's triangles
    #[arg(
        long,
        value_parser = geometry(),
        default_value = "exact",
        value_name = "GEOMETRY",
        hide_short_help = true,
        help_heading = "Expert"
    )]
    pub(super) geometry: Geometry,
    /// GL's clamps (default: gl for PNG, none for float files)
    #[arg(
        long,
        value_enum,
        value_name = "CLAMP",
        hide_short_help = true,
        help_heading = "Expert"
    )]
    pub(super) clamp: Option<ClampArg>,
    /// Write times and counters as JSON
    #[arg(
        long,
        value_name = "FILE",
        hide_short_help = true,
        help_heading = "Expert"
    )]
    pub(super) stats: Option<PathBuf>,
    #[command(flatten)]
    pub(super) follow: FollowArgs,
    /// Print times and counters as JSON
    #[arg(long)]
    pub(super) json: bool,
}

#[derive(Debug, Args)]
pub(super) struct CompareArgs {
    #[command(flatten)]
    pub(super) scene: SceneArgs,
    /// Output folder (default: SCENE-compare, or SCENE-opengl)
    #[arg(short, long, value_name = "FOLDER")]
    pub(super) output: Option<PathBuf>,
    /// What the rasterizer is held against: trace (the tracer), or opengl (this machine's, where built with it)
    #[arg(
        long,
        value_enum,
        default_value = "trace",
        value_name = "RENDERER",
        hide_possible_values = true
    )]
    pub(super) against: AgainstArg,
    /// With --against opengl: also print what the driver says of itself
    #[arg(long, hide_short_help = true, help_heading = "Expert")]
    pub(super) driver_info: bool,
    /// With --against opengl: exit 1 where a colour on the same triangle differs by more
    #[arg(
        long,
        value_name = "ERROR",
        hide_short_help = true,
        help_heading = "Expert"
    )]
    pub(super) max_error: Option<f64>,
    #[command(flatten)]
    pub(super) quality: QualityArgs,
    #[command(flatten)]
    pub(super) follow: FollowArgs,
    /// Print summary.json
    #[arg(long)]
    pub(super) json: bool,
}

#[derive(Debug, Args)]
pub(super) struct LectureArgs {
    /// Scenes of the deck, in order: files, or names of shipped scenes (default: the twenty of the lecture)
    #[arg(value_name = "SCENE")]
    pub(super) scenes: Vec<String>,
    /// Output folder
    #[arg(short, long, value_name = "FOLDER", default_value = "lecture")]
    pub(super) output: PathBuf,
    #[command(flatten)]
    pub(super) quality: QualityArgs,
    /// Show the deck in the browser
    #[arg(long)]
    pub(super) open: bool,
}

#[derive(Debug, Args)]
pub(super) struct InspectArgs {
    #[command(flatten)]
    pub(super) scene: SceneArgs,
    /// Print the report as JSON
    #[arg(long)]
    pub(super) json: bool,
}

#[derive(Debug, Args)]
pub(super) struct ScenesArgs {
    /// Print this scene's file
    #[arg(value_name = "NAME")]
    pub(super) name: Option<String>,
    /// Draw all shipped scenes, rasterized and traced, small on one .png
    #[arg(long, value_name = "FILE", conflicts_with_all = ["name", "json"])]
    pub(super) contact_sheet: Option<PathBuf>,
    /// Samples a pixel of that sheet
    #[arg(
        long,
        value_name = "N",
        default_value_t = 16,
        requires = "contact_sheet"
    )]
    pub(super) samples: u32,
    /// Print the list as JSON
    #[arg(long)]
    pub(super) json: bool,
}

#[derive(Debug, Args)]
pub(super) struct CompletionsArgs {
    /// The shell
    #[arg(value_enum, value_name = "SHELL")]
    pub(super) shell: clap_complete::Shell,
}
