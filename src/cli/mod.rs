//! The command line: clap structs, and nothing else in the program sees clap.
//!
//! `-h` fits one screen; `--help` adds the expert options and examples. Exit codes: 0 done or same, 1 differs over the
//! asked threshold, 2 error.

mod args;
mod check;
mod commands;
mod compare;
mod diagnostic;
mod diff;
mod explain;
mod explain_line;
mod extremes;
mod inspect;
mod lecture;
#[cfg(feature = "opengl")]
mod opengl;
#[cfg(not(feature = "opengl"))]
#[path = "opengl_absent.rs"]
mod opengl;
mod options;
mod pick;
mod progress;
mod render;
mod series;
mod sheet;
mod show;
mod trade;
mod verify;
mod watch;

use std::process::ExitCode;

use clap::{ColorChoice, CommandFactory, Parser, Subcommand};

use args::{
    CompareArgs, CompletionsArgs, Global, HelpArgs, InspectArgs, LectureArgs, RenderArgs,
    ScenesArgs,
};

/// One scene, rasterized as OpenGL lights it and ray traced as Whitted did, every difference explained.
#[derive(Debug, Parser)]
#[command(
    name = "rastray",
    version,
    max_term_width = 100,
    subcommand_required = true,
    arg_required_else_help = true,
    disable_help_subcommand = true,
    after_help = "Start with:  rastray compare whitted",
    after_long_help = EXAMPLES
)]
struct Cli {
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
    /// Explain one pixel: the equation with its numbers, and the ray tree
    #[command(after_long_help = explain::EXAMPLES)]
    Explain(explain::ExplainArgs),
    /// Compare two picture files, whoever made them
    #[command(after_long_help = diff::EXAMPLES)]
    Diff(diff::DiffArgs),
    /// Check one's own picture of a scene: right, or explained by which mistake?
    #[command(after_long_help = check::EXAMPLES)]
    Check(check::CheckArgs),
    /// Measure speed against accuracy: what each knob costs and buys on a scene
    #[command(after_long_help = trade::EXAMPLES)]
    Trade(trade::TradeArgs),
    /// Say what a scene contains and which features of the model it requires
    #[command(after_long_help = INSPECT_EXAMPLES)]
    Inspect(InspectArgs),
    /// List the shipped scenes, or print one to start one's own from
    #[command(after_long_help = SCENES_EXAMPLES)]
    Scenes(ScenesArgs),
    /// Make the deck of a lecture: pictures for slides, captions, and a page to present from
    #[command(after_long_help = LECTURE_EXAMPLES)]
    Lecture(LectureArgs),
    /// Print the JSON Schema of the scene file, for editors
    #[command(after_long_help = SCHEMA_EXAMPLES)]
    Schema,
    /// Print the completions of a shell: bash, zsh, fish, powershell, elvish
    #[command(after_long_help = COMPLETIONS_EXAMPLES)]
    Completions(CompletionsArgs),
    /// Print the help of the given command
    // Our own instead of clap's: hidden, since `-h` has one screen, yet there for who types it.
    #[command(hide = true)]
    Help(HelpArgs),
}

const RENDER_EXAMPLES: &str = "Examples:
  rastray render whitted                      whitted.png, as OpenGL draws it
  rastray render whitted --mode trace -o whitted-trace.png
  rastray render highlight --shading phong --size 320x240 -o highlight.png
  rastray render whitted --mode trace --layers --size 160x120 -o layers.exr
  rastray render whitted --turntable 36 -o turn.gif --mode trace --size 320x240
  rastray render highlight --vary material.plastic.shininess=1..128:24 -o shininess.gif
  rastray render lights --vary 'light.candle.position=[-2,1,2]..[2,1,2]:12'   lights-0001.png to -0012
  rastray render whitted --error 1/255        the cheapest setting whose rmse is at most a step of 8 bits
  rastray render mine.toml --watch --open     shown once, drawn again whenever the file is saved";

const COMPARE_EXAMPLES: &str = "Examples:
  rastray compare whitted --size 320x240
  rastray compare highlight --tessellation 16 -o coarse
  rastray compare whitted --set trace.depth=1 --json --size 160x120 -o shallow
  rastray compare mine.toml --open --watch    the page in the browser, made again whenever the file is saved";

const INSPECT_EXAMPLES: &str = "Examples:
  rastray inspect whitted
  rastray inspect lights --json";

const SCENES_EXAMPLES: &str = "Examples:
  rastray scenes
  rastray scenes whitted > mine.toml
  rastray scenes --contact-sheet scenes.png   all of them, small, on one picture";

const LECTURE_EXAMPLES: &str = "Examples:
  rastray lecture --open                      the whole lecture, 1920x1080, into lecture/
  rastray lecture 14-shadow 15-mirror whitted -o mirrors
  rastray lecture mine.toml -o mine           one's own scenes

The comment at the head of a .toml scene is shown: its first paragraph is the question and its answer,
further ones are notes, and the line `# term: diffuse` says what is lit in the equation: emission, ambient,
diffuse, specular, shadow, reflection, refraction, shininess, sum, point light, directional light,
attenuation, spot cutoff, spot exponent; several with commas.

Keys in index.html: arrows, space, Page Up and Down, Home, End; 0 side by side, 1 raster, 2 trace,
3 difference, W wipe; N notes, L light or dark, F full screen.";

const SCHEMA_EXAMPLES: &str = "Examples:
  rastray schema > rastray.schema.json";

const COMPLETIONS_EXAMPLES: &str = "Examples:
  rastray completions bash > ~/.local/share/bash-completion/completions/rastray
  rastray completions zsh > ~/.zfunc/_rastray          with ~/.zfunc in fpath
  rastray completions fish > ~/.config/fish/completions/rastray.fish";

/// Parses the command line and runs it.
pub(crate) fn run() -> ExitCode {
    let cli = Cli::parse();
    match cli.global.color {
        ColorChoice::Always => anstream::ColorChoice::Always.write_global(),
        ColorChoice::Never => anstream::ColorChoice::Never.write_global(),
        ColorChoice::Auto => {}
    }
    let verbosity = options::Verbosity::new(cli.global.quiet, cli.global.verbose);
    let done = |()| ExitCode::SUCCESS;
    let result = options::in_pool(cli.global.threads, || match &cli.command {
        Command::Render(args) => render::render(args, verbosity).map(done),
        Command::Compare(args) => compare::compare(args, verbosity),
        Command::Explain(args) => explain::explain(args, verbosity).map(done),
        Command::Diff(args) => diff::diff(args, verbosity),
        Command::Check(args) => check::check(args, verbosity),
        Command::Trade(args) if args.extremes => extremes::extremes(args, verbosity),
        Command::Trade(args) => trade::trade(args, verbosity),
        Command::Inspect(args) => inspect::inspect(args).map(done),
        Command::Scenes(args) => match &args.contact_sheet {
            Some(path) => sheet::contact_sheet(path, args.samples, verbosity).map(done),
            None => commands::scenes(args).map(done),
        },
        Command::Lecture(args) => lecture::lecture(args, verbosity).map(done),
        Command::Schema => commands::schema().map(done),
        Command::Completions(args) => commands::completions(args, Cli::command()).map(done),
        Command::Help(args) => help(args),
    });
    match result {
        Ok(code) => code,
        Err(error) => {
            diagnostic::print(&error);
            ExitCode::from(2)
        }
    }
}

/// `rastray help NAME` is `rastray NAME --help`.
fn help(args: &HelpArgs) -> ! {
    let words = std::iter::once("rastray").chain(args.command.as_deref());
    Cli::parse_from(words.chain(std::iter::once("--help")));
    unreachable!("--help ends the program");
}
