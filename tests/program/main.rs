//! The program and what it reads and reports: commands, scene files, pictures in files, and the layers of the source.

mod check;
mod cli;
mod context;
mod explain;
mod extremes;
mod import;
mod layering;
mod metrics;
mod trade;

/// Helpers that several tests share.
#[path = "../common"]
mod common {
    pub(crate) mod exact;
    pub(crate) mod ladder;
    pub(crate) mod plain;
    pub(crate) mod program;
    #[allow(dead_code, reason = "rays and vectors are for other tests")]
    pub(crate) mod random;
    pub(crate) mod scenes;
}

/// The conformance adapter's own code.
#[path = "../probe"]
mod probe {
    pub(crate) mod trace;
    type Failure = Box<dyn std::error::Error>;
}
