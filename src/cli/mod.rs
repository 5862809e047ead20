//! The command line: clap structs, and nothing else in the program sees clap.
//!
//! `-h` fits one screen; `--help` adds the expert options and examples. Exit codes: 0 done or same, 1 differs over the
//! asked threshold, 2 error.

mod commands;
mod compare;
mod diagnostic;
mod options;
mod render;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, ColorChoice, Parser, Subcommand, ValueEnum};

/// One scene, rasterized as OpenGL lights it and ray traced as Whitted did, and every difference explained.
#[derive(Debug, Parser)]
#[command(
    name = "rastray",
    version,
    max_term_width = 100,
    subcommand_required = true,
    arg_required_else_help = true,
    after_help = "Start with:  rastray compare whitted",
    after_long_help = EXAMPLES
)]
pub(crate) struct Cli {
    #[command(subcommand)]
    command: Command,
    #[command(flatten)]
    global: Global,
}

const EXAMPLES: &str = "Examples:
  rastray compare whitted                     both pictures and every difference, into whitted-compare/
  rastray render whitted -o whitted.png --mode trace
  rastray render lights -o lights.exr --mode trace --layers
  rastray inspect whitted                     what the scene contains and requires, and why
  rastray scenes whitted > mine.toml          a scene to start one's own from
  rastray compare mine.toml --set material.glass.ior=1.33

Exit codes: 0 done, 1 differs over the asked threshold, 2 error.";

#[derive(Debug, Subcommand)]
enum Command {
    /// Render one picture
    #[command(after_long_help = RENDER_EXAMPLES)]
    Render(RenderArgs),
    /// Render with both renderers and explain every difference, into a folder
    #[command(after_long_help = COMPARE_EXAMPLES)]
    Compare(CompareArgs),
    /// Say what a scene contains and which features of the model it requires
    #[command(after_long_help = INSPECT_EXAMPLES)]
    Inspect(InspectArgs),
    /// List the shipped scenes, or print one to start one's own from
    #[command(after_long_help = SCENES_EXAMPLES)]
    Scenes(ScenesArgs),
    /// Print the JSON Schema of the scene file, for editors
    #[command(after_long_help = SCHEMA_EXAMPLES)]
    Schema,
}

const RENDER_EXAMPLES: &str = "Examples:
  rastray render whitted                      whitted.png, as OpenGL draws it
  rastray render whitted --mode trace -o whitted-trace.png
  rastray render highlight --shading phong --size 320x240 -o highlight.png
  rastray render whitted --mode trace --layers --size 160x120 -o layers.exr";

const COMPARE_EXAMPLES: &str = "Examples:
  rastray compare whitted --size 320x240
  rastray compare highlight --tessellation 16 -o coarse
  rastray compare whitted --set trace.depth=1 --json --size 160x120 -o shallow";

const INSPECT_EXAMPLES: &str = "Examples:
  rastray inspect whitted
  rastray inspect lights --json";

const SCENES_EXAMPLES: &str = "Examples:
  rastray scenes
  rastray scenes whitted > mine.toml";

const SCHEMA_EXAMPLES: &str = "Examples:
  rastray schema > rastray.schema.json";

/// Options that every command has.
#[derive(Debug, Args)]
pub(crate) struct Global {
    /// Worker threads (default: one a core)
    #[arg(
        short = 'j',
        long,
        global = true,
        value_name = "N",
        help_heading = "General"
    )]
    threads: Option<usize>,
    /// Say nothing but errors
    #[arg(
        short,
        long,
        global = true,
        conflicts_with = "verbose",
        help_heading = "General"
    )]
    quiet: bool,
    /// Say more: each step as it starts
    #[arg(short, long, global = true, help_heading = "General")]
    verbose: bool,
    /// Colours in messages
    #[arg(
        long,
        global = true,
        value_name = "WHEN",
        default_value = "auto",
        hide_short_help = true,
        help_heading = "General"
    )]
    color: ColorChoice,
}

/// The scene and its overrides.
#[derive(Debug, Args)]
pub(crate) struct SceneArgs {
    /// A scene file (.toml, .scn, .obj), or the name of a shipped scene (see `rastray scenes`)
    #[arg(value_name = "SCENE")]
    scene: String,
    /// Override a key of the scene file, such as material.red.shininess=64
    #[arg(long = "set", value_name = "KEY=VALUE")]
    sets: Vec<String>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ModeArg {
    /// OpenGL's picture: local illumination
    Raster,
    /// Primary rays only, nothing blocked: the rasterizer's terms by rays
    Cast,
    /// Whitted's picture: shadows, reflection, refraction
    Trace,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum ShadingArg {
    /// One colour a triangle, from its last vertex
    Flat,
    /// Lit at the vertices, interpolated
    #[value(alias = "per-vertex")]
    Gouraud,
    /// Lit at every pixel
    #[value(alias = "per-pixel")]
    Phong,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum GeometryArg {
    /// The true shapes
    Exact,
    /// The rasterizer's own triangles
    Mesh,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum PrecisionArg {
    /// 32-bit floats
    F32,
    /// 64-bit floats, the whole path
    F64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum ModelArg {
    /// Only what the scene requires
    Required,
    /// Every feature, needed or not: the same bytes, slower
    Full,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum ClampArg {
    /// GL's clamps, as its picture has them
    Gl,
    /// No clamp until the file's own
    None,
}

/// How to render: what `render` and `compare` share.
#[derive(Debug, Args)]
pub(crate) struct QualityArgs {
    /// Size of the picture in pixels
    #[arg(long, value_name = "WxH")]
    size: Option<String>,
    /// Samples a pixel
    #[arg(long, value_name = "N")]
    samples: Option<u32>,
    /// Shading of the rasterizer: flat, gouraud (per-vertex), phong (per-pixel)
    #[arg(long, value_enum, value_name = "SHADING", hide_possible_values = true)]
    shading: Option<ShadingArg>,
    /// Generations of reflected and refracted rays
    #[arg(long, value_name = "N")]
    depth: Option<u32>,
    /// No shadow rays: every light is seen
    #[arg(long)]
    no_shadows: bool,
    /// No mirror rays
    #[arg(long)]
    no_reflection: bool,
    /// No transmitted rays
    #[arg(long)]
    no_refraction: bool,
    /// Tessellation of shapes: slices of a full turn, half as many stacks (default 64)
    #[arg(
        long,
        value_name = "N",
        hide_short_help = true,
        help_heading = "Expert"
    )]
    tessellation: Option<u32>,
    /// Precision of the whole path
    #[arg(
        long,
        value_enum,
        default_value = "f32",
        hide_short_help = true,
        help_heading = "Expert",
        value_name = "PRECISION"
    )]
    precision: PrecisionArg,
    /// Sub-pixel bits that vertices snap to before coverage: 8 or 12
    #[arg(
        long,
        value_name = "BITS",
        hide_short_help = true,
        help_heading = "Expert"
    )]
    snap: Option<String>,
    /// Evaluate only what the scene requires, or everything: the same bytes
    #[arg(
        long,
        value_enum,
        default_value = "required",
        value_name = "MODEL",
        hide_short_help = true,
        help_heading = "Expert"
    )]
    model: ModelArg,
    /// Instruction set: scalar, sse4.2, avx2, avx512, neon (default: the best there is): the same bytes
    #[arg(
        long,
        value_name = "ISA",
        hide_short_help = true,
        help_heading = "Expert"
    )]
    isa: Option<String>,
    /// Encode displayed values as sRGB (default: linear values are stored as they are, as in GL)
    #[arg(long, hide_short_help = true, help_heading = "Expert")]
    srgb: bool,
}

#[derive(Debug, Args)]
struct RenderArgs {
    #[command(flatten)]
    scene: SceneArgs,
    /// Output: .png, .exr, .pfm, .hdr, or - for PNG on standard output (default: SCENE.png)
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Renderer: raster, cast (primary rays only), trace
    #[arg(
        long,
        value_enum,
        default_value = "raster",
        hide_possible_values = true
    )]
    mode: ModeArg,
    #[command(flatten)]
    quality: QualityArgs,
    /// Keep every term of the equation as a layer of its own (.exr)
    #[arg(long)]
    layers: bool,
    /// What the tracer traces: exact shapes, or the rasterizer's triangles
    #[arg(
        long,
        value_enum,
        default_value = "exact",
        value_name = "GEOMETRY",
        hide_short_help = true,
        help_heading = "Expert"
    )]
    geometry: GeometryArg,
    /// GL's clamps (default: gl for PNG, none for float files)
    #[arg(
        long,
        value_enum,
        value_name = "CLAMP",
        hide_short_help = true,
        help_heading = "Expert"
    )]
    clamp: Option<ClampArg>,
    /// Write times and counters as JSON
    #[arg(
        long,
        value_name = "FILE",
        hide_short_help = true,
        help_heading = "Expert"
    )]
    stats: Option<PathBuf>,
    /// Print times and counters as JSON
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Args)]
struct CompareArgs {
    #[command(flatten)]
    scene: SceneArgs,
    /// Output folder (default: SCENE-compare)
    #[arg(short, long, value_name = "FOLDER")]
    output: Option<PathBuf>,
    #[command(flatten)]
    quality: QualityArgs,
    /// Print summary.json
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Args)]
struct InspectArgs {
    #[command(flatten)]
    scene: SceneArgs,
    /// Print the report as JSON
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Args)]
struct ScenesArgs {
    /// Print this scene's file
    #[arg(value_name = "NAME")]
    name: Option<String>,
    /// Print the list as JSON
    #[arg(long)]
    json: bool,
}

/// Parses the command line and runs it.
pub(crate) fn run() -> ExitCode {
    let cli = Cli::parse();
    match cli.global.color {
        ColorChoice::Always => anstream::ColorChoice::Always.write_global(),
        ColorChoice::Never => anstream::ColorChoice::Never.write_global(),
        ColorChoice::Auto => {}
    }
    let verbosity = options::Verbosity::new(cli.global.quiet, cli.global.verbose);
    let result = options::in_pool(cli.global.threads, || match &cli.command {
        Command::Render(args) => render::render(args, verbosity),
        Command::Compare(args) => compare::compare(args, verbosity),
        Command::Inspect(args) => commands::inspect(args),
        Command::Scenes(args) => commands::scenes(args),
        Command::Schema => commands::schema(),
    });
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            diagnostic::print(&error);
            ExitCode::from(2)
        }
    }
}
