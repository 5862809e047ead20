//! What the conformance adapter's own code (`tests/probe`) asks of the program around it.

use serde_json::Value;

/// Anything that stops an answer, as one sentence.
pub(crate) type Failure = Box<dyn std::error::Error>;

/// The adapter's way to write a number: numbers that are not finite are words, and never pass unnoticed.
pub(crate) fn number(x: f64) -> Value {
    if x.is_finite() {
        x.into()
    } else {
        x.to_string().to_lowercase().into()
    }
}
