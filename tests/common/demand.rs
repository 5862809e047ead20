//! Tests that need something of the machine, a driver or a browser, and what they do where it is missing.

/// Says what is missing, and the test passes; where a variable of the environment demands it, the test fails.
pub(crate) fn skip(variable: &str, missing: &str) {
    let demanded = std::env::var_os(variable).is_some_and(|v| !v.is_empty() && v != "0");
    assert!(!demanded, "{variable} demands it: {missing}");
    println!("skipped: {missing}");
}
