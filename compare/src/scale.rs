//! False-colour scales: which value gets which colour.
//!
//! Signed scales run from blue (negative) over white (0) to orange (positive), symmetric about 0: told apart by all
//! common kinds of colour vision, and of equal lightness at equal distance from 0 (steps of OKLab lightness 0.93, 0.86,
//! 0.78, 0.69, 0.60, 0.50, the most saturated colour of hue 252 or 55 degrees within a cap). Magnitude scales run from
//! black (0) through magma to pale yellow. Never red against green.

/// Steps of the orange half from 0 to the end of the scale, sRGB.
const ORANGE: [[u8; 3]; 7] = [
    [0xff, 0xff, 0xff],
    [0xfe, 0xe2, 0xcf],
    [0xff, 0xc2, 0x9a],
    [0xfa, 0x9e, 0x5d],
    [0xe9, 0x79, 0x04],
    [0xc1, 0x63, 0x02],
    [0x96, 0x4c, 0x04],
];

/// Steps of the blue half.
const BLUE: [[u8; 3]; 7] = [
    [0xff, 0xff, 0xff],
    [0xd8, 0xea, 0xff],
    [0xb0, 0xd5, 0xfe],
    [0x80, 0xbc, 0xfe],
    [0x41, 0x9e, 0xfe],
    [0x05, 0x81, 0xe6],
    [0x03, 0x64, 0xb4],
];

/// Which colours a scale uses and whether it has two sides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ScaleKind {
    /// -max blue, 0 white, +max orange.
    Signed,
    /// 0 black to max pale yellow (magma).
    Magnitude,
}

/// A linear scale from values to colours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// The colours.
    pub kind: ScaleKind,
    /// The value at the end of the scale, above 0; a signed scale begins at `-max`.
    pub max: f64,
}

impl Scale {
    /// The scale whose end is the next 1-2-5 number at or above the largest value: nothing lies beyond it.
    pub fn fitting(kind: ScaleKind, largest: f64) -> Self {
        Self {
            kind,
            max: nice_maximum(largest),
        }
    }

    /// The value at the low end.
    pub fn min(&self) -> f64 {
        match self.kind {
            ScaleKind::Signed => -self.max,
            ScaleKind::Magnitude => 0.0,
        }
    }

    /// The sRGB colour of a value; values beyond the ends take the colour of the end, and values other than 0 take at
    /// least the colour of 1/128 of the scale, so that exactly the zeros have the colour of 0.
    ///
    /// ```
    /// use rastray_compare::{Scale, ScaleKind};
    /// let scale = Scale { kind: ScaleKind::Signed, max: 0.5 };
    /// assert_eq!(scale.color(0.0), [255, 255, 255]);
    /// assert_eq!(scale.color(-7.0), scale.color(-0.5));
    /// ```
    pub fn color(&self, value: f64) -> [u8; 3] {
        let t = match value.abs() / self.max {
            _ if value == 0.0 => 0.0,
            t if t > 1.0 / 128.0 => t.min(1.0),
            _ => 1.0 / 128.0,
        };
        match self.kind {
            ScaleKind::Signed if value < 0.0 => ramp(&BLUE, t),
            ScaleKind::Signed => ramp(&ORANGE, t),
            ScaleKind::Magnitude => {
                let color = colorous::MAGMA.eval_continuous(t);
                [color.r, color.g, color.b]
            }
        }
    }

    /// Values worth a tick, ascending: the ends, the middle, 0, and halfway.
    pub fn ticks(&self) -> Vec<f64> {
        let steps: &[f64] = match self.kind {
            ScaleKind::Signed => &[-1.0, -0.5, 0.0, 0.5, 1.0],
            ScaleKind::Magnitude => &[0.0, 0.25, 0.5, 0.75, 1.0],
        };
        steps.iter().map(|s| s * self.max).collect()
    }
}

/// A colour of evenly spaced steps, straight lines between them; `t` in [0, 1].
fn ramp(steps: &[[u8; 3]], t: f64) -> [u8; 3] {
    let at = t * (steps.len() - 1) as f64;
    let low = (at as usize).min(steps.len() - 2);
    let part = at - low as f64;
    std::array::from_fn(|c| {
        let (a, b) = (f64::from(steps[low][c]), f64::from(steps[low + 1][c]));
        (a + (b - a) * part).round() as u8
    })
}

/// The smallest of 1, 2, 5 times a power of ten that is not below `largest`; 1 where nothing is above 0.
///
/// ```
/// use rastray_compare::nice_maximum;
/// assert_eq!(nice_maximum(0.61), 1.0);
/// assert_eq!(nice_maximum(0.5), 0.5);
/// assert_eq!(nice_maximum(0.0021), 0.005);
/// assert_eq!(nice_maximum(0.0), 1.0);
/// ```
pub fn nice_maximum(largest: f64) -> f64 {
    if largest.is_nan() || largest <= 0.0 {
        return 1.0;
    }
    let decades = (-30..=40).flat_map(|decade| [1, 2, 5].map(|m| format!("{m}e{decade}")));
    // Parsing gives the double nearest to the decimal number, so that 0.2 is 0.2 and not 2 * 0.1 rounded twice.
    decades
        .filter_map(|text| text.parse().ok())
        .find(|&nice: &f64| nice >= largest)
        .unwrap_or(largest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nice_numbers_are_the_next_1_2_5() {
        for (largest, nice) in [
            (1.0, 1.0),
            (1.0001, 2.0),
            (2.1, 5.0),
            (5.1, 10.0),
            (0.2, 0.2),
            (1.0 / 510.0, 0.002),
        ] {
            assert_eq!(nice_maximum(largest), nice);
        }
        assert_eq!(nice_maximum(f64::NAN), 1.0);
        assert_eq!(nice_maximum(3e-12), 5e-12);
    }

    #[test]
    fn signed_colours_lean_to_their_side() {
        let scale = Scale {
            kind: ScaleKind::Signed,
            max: 1.0,
        };
        for i in 1..=100 {
            let v = f64::from(i) / 100.0;
            let (warm, cold) = (scale.color(v), scale.color(-v));
            assert!(
                warm[0] > warm[2] && cold[2] > cold[0],
                "{v}: {warm:?} {cold:?}"
            );
        }
        assert_eq!(scale.color(1.0), ORANGE[6]);
        assert_eq!(scale.color(-1.0), BLUE[6]);
        // Between the steps 3 (0.5) and 4: a quarter of the way.
        assert_eq!(
            scale.color(3.25 / 6.0)[0],
            (250.0f64 + (233.0 - 250.0) * 0.25).round() as u8
        );
    }

    #[test]
    fn magma_grows_lighter() {
        let scale = Scale {
            kind: ScaleKind::Magnitude,
            max: 2.0,
        };
        let sum = |v: f64| scale.color(v).iter().map(|&c| u32::from(c)).sum::<u32>();
        assert!((1..=20).all(|i| sum(0.1 * f64::from(i)) > sum(0.1 * f64::from(i - 1))));
        assert_eq!(scale.color(0.0), [0, 0, 4]); // the published first entry of magma: 0.0015, 0.0005, 0.0139
    }
}
