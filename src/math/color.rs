//! Colours: unclamped linear numbers until the end. GL's clamp and the rounding to 8 bits are named steps here.

use super::Each;
use crate::lanes::Real;

/// Red, green, blue; linear, unclamped, unitless as GL's colours are.
pub type Rgb = [f64; 3];

/// GL's clamp of one component to [0, 1] (GL 2.1 section 2.14.6). NaN cannot occur; -0 becomes 0.
pub fn clamp01<R: Real>(x: R) -> R {
    if x > R::ZERO {
        if x < R::ONE { x } else { R::ONE }
    } else {
        R::ZERO
    }
}

/// [`clamp01`] on each component.
pub fn clamp_rgb<R: Real>(c: [R; 3]) -> [R; 3] {
    c.each(clamp01)
}

/// The 8-bit value of a component: round(255 clamp(x)) (GL 2.1 section 2.14.9: 0 -> 0, 1 -> all ones).
pub fn quantize8<R: Real>(x: R) -> u8 {
    (clamp01(x).to_f64() * 255.0).round() as u8
}

/// sRGB encoding of a linear component in [0, 1] (IEC 61966-2-1).
pub fn srgb_from_linear(x: f64) -> f64 {
    if x <= 0.003_130_8 {
        12.92 * x
    } else {
        1.055 * libm::pow(x, 1.0 / 2.4) - 0.055
    }
}

/// Linear value of an sRGB component in [0, 1] (IEC 61966-2-1).
pub fn linear_from_srgb(x: f64) -> f64 {
    if x <= 0.040_45 {
        x / 12.92
    } else {
        libm::pow((x + 0.055) / 1.055, 2.4)
    }
}

/// Luma of Rec. 709 weights on the stored values: .2126 R + .7152 G + .0722 B.
pub fn luma(c: Rgb) -> f64 {
    0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantization_is_gls() {
        assert_eq!(quantize8(0.0f32), 0);
        assert_eq!(quantize8(1.0f32), 255);
        assert_eq!(quantize8(-3.0f32), 0);
        assert_eq!(quantize8(7.0f64), 255);
        assert_eq!(quantize8(0.5f64), 128); // 127.5 rounds away from zero
        assert_eq!(quantize8(127.4f64 / 255.0), 127);
    }

    #[test]
    fn srgb_round_trips() {
        for i in 0..=255 {
            let x = f64::from(i) / 255.0;
            assert!((srgb_from_linear(linear_from_srgb(x)) - x).abs() < 1e-9);
        }
    }
}
