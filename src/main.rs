//! The `rastray` program: parse, run, print what went wrong. Exit 0 done, 1 over threshold, 2 error.

mod cli;

fn main() -> std::process::ExitCode {
    cli::run()
}
