//! One pixel explained, for people: as text, as a figure of its rays, as ray paths for a modelling program.
//!
//! In: a scene and an [`Explanation`](crate::explain::Explanation). Out: a string each. Nothing is computed here but layout and
//! what a reader's eye adds up: numbers are shown rounded, and `explain --json` has them exact.
//!
//! - [`text()`]: the equation with its numbers, the weighted ray tree, the causes; for a terminal or a file.
//! - [`figure()`]: an SVG, the rays in a side view of the scene and the ray tree beside it.
//! - [`paths()`]: a Wavefront OBJ of polylines.

mod branches;
mod diagram;
mod figure;
mod outline;
mod paths;
mod pick;
mod sheet;
mod svg;
mod terms;
mod text;
mod view;

pub use figure::figure;
pub use paths::paths;
pub use text::{Layout, text};

use crate::explain::Hit;
use crate::math::color::Rgb;

/// A number in few characters: four decimals at most, no trailing zeros.
fn short(x: f64) -> String {
    if !x.is_finite() {
        return if x > 0.0 {
            "∞".into()
        } else {
            "−∞".into()
        };
    }
    if x != 0.0 && x.abs() < 1e-6 {
        // Not 0, and nothing to see.
        return "0.0000".into();
    }
    if x != 0.0 && !(1e-4..1e6).contains(&x.abs()) {
        return format!("{x:.2e}");
    }
    let text = format!("{x:.4}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" {
        "0".into()
    } else {
        text.into()
    }
}

/// A colour, weight or vector in few characters; a grey as one number.
fn triple(v: Rgb) -> String {
    if v[0] == v[1] && v[1] == v[2] {
        short(v[0])
    } else {
        vector(v)
    }
}

/// A place or direction; what is nothing beside its other components is 0.
fn vector(v: [f64; 3]) -> String {
    let largest = v.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    let [x, y, z] = v.map(|x| if x.abs() < 1e-6 * largest { 0.0 } else { x });
    format!("({} {} {})", short(x), short(y), short(z))
}

/// The ray arrives at a surface from the inside of its solid.
fn from_inside(hit: &Hit) -> bool {
    hit.inside && hit.back
}

/// A colour in three decimals, for a figure.
fn brief(color: Rgb) -> String {
    if color != [0.0; 3] && color.iter().all(|x| x.abs() < 5e-4) {
        return "< 0.001".into();
    }
    let round = |x: f64| {
        if x.is_finite() {
            (x * 1e3).round() / 1e3
        } else {
            x
        }
    };
    triple(color.map(round))
}

/// Degrees with one decimal.
fn degrees(x: f64) -> String {
    format!("{x:.1}°")
}

/// The colour as the PNG holds it.
fn bytes(color: Rgb) -> [u8; 3] {
    color.map(crate::math::color::quantize8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        assert_eq!(short(0.25), "0.25");
        assert_eq!(short(-0.00001), "-1.00e-5");
        assert_eq!(short(1e-20), "0.0000");
        assert_eq!(vector([0.0, 1.0, -8e-9]), "(0 1 0)");
        assert_eq!(brief([0.12345, 0.0, 1.0]), "(0.123 0 1)");
        assert_eq!(brief([1e-5; 3]), "< 0.001");
        assert_eq!(short(0.0), "0");
        assert_eq!(short(f64::INFINITY), "∞");
        assert_eq!(triple([0.5; 3]), "0.5");
        assert_eq!(triple([1.0, 0.0, 0.12345]), "(1 0 0.1235)");
    }
}
