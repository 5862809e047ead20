//! Colour spaces of FLIP: linear RGB, the opponent space YCxCz, L*a*b*; and the distance of two colours.
//!
//! FLIP-2020 = Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström, Fairchild: "FLIP: A Difference Evaluator for
//! Alternating Images", Proc. ACM Comput. Graph. Interact. Tech. 3(2), 2020.
//!
//! The matrix between RGB and XYZ is derived from the chromaticities of sRGB (IEC 61966-2-1), so that white is exactly
//! RGB (1, 1, 1).

/// Chromaticities x, y of sRGB's red, green, blue and white (D65), IEC 61966-2-1.
const PRIMARIES: [[f64; 2]; 3] = [[0.64, 0.33], [0.30, 0.60], [0.15, 0.06]];
const WHITE: [f64; 2] = [0.3127, 0.3290];

/// Exponent of the colour distance (FLIP-2020, section 4.1.2).
const Q_C: f64 = 0.7;
/// The fraction of the largest distance that is mapped to [`P_T`] (same place).
const P_C: f64 = 0.4;
/// Where it is mapped to: larger distances share the rest of [0, 1].
const P_T: f64 = 0.95;

type Matrix = [[f64; 3]; 3];

fn times(m: &Matrix, v: [f64; 3]) -> [f64; 3] {
    m.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

/// By cofactors; the matrices here are far from singular.
fn inverse(m: &Matrix) -> Matrix {
    let minor = |r: usize, c: usize| {
        let (r1, r2, c1, c2) = ((r + 1) % 3, (r + 2) % 3, (c + 1) % 3, (c + 2) % 3);
        m[r1][c1] * m[r2][c2] - m[r1][c2] * m[r2][c1]
    };
    let determinant = (0..3).fold(0.0, |sum, c| sum + m[0][c] * minor(0, c));
    std::array::from_fn(|r| std::array::from_fn(|c| minor(c, r) / determinant))
}

/// The conversions and what follows from them.
pub(super) struct Colors {
    /// XYZ divided by the white's, from linear RGB.
    relative_xyz_from_rgb: Matrix,
    rgb_from_relative_xyz: Matrix,
    /// The largest colour distance, of green and blue, to the power of [`Q_C`].
    c_max: f64,
}

impl Colors {
    pub(super) fn new() -> Self {
        // XYZ of a chromaticity at Y = 1.
        let xyz = |[x, y]: [f64; 2]| [x / y, 1.0, (1.0 - x - y) / y];
        let columns = PRIMARIES.map(xyz);
        let primaries: Matrix = std::array::from_fn(|r| columns.map(|column| column[r]));
        let white = xyz(WHITE);
        let strength = times(&inverse(&primaries), white);
        let relative_xyz_from_rgb = std::array::from_fn(|r| {
            std::array::from_fn(|c| primaries[r][c] * strength[c] / white[r])
        });
        let mut colors = Self {
            rgb_from_relative_xyz: inverse(&relative_xyz_from_rgb),
            relative_xyz_from_rgb,
            c_max: 0.0,
        };
        let [green, blue] = [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|c| colors.hunt_lab(c));
        colors.c_max = libm::pow(hyab(green, blue), Q_C);
        colors
    }

    /// YCxCz, the linearised L*a*b* in which contrast sensitivity is known (FLIP-2020, section 4.1.1).
    pub(super) fn opponent(&self, rgb: [f64; 3]) -> [f64; 3] {
        let [x, y, z] = times(&self.relative_xyz_from_rgb, rgb);
        [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
    }

    /// L*a*b* with Hunt's effect, from filtered YCxCz clamped to what a display can show.
    pub(super) fn seen(&self, [y, cx, cz]: [f64; 3]) -> [f64; 3] {
        let y = (y + 16.0) / 116.0;
        let rgb = times(
            &self.rgb_from_relative_xyz,
            [y + cx / 500.0, y, y - cz / 200.0],
        );
        self.hunt_lab(rgb.map(|v| v.clamp(0.0, 1.0)))
    }

    /// L*a*b* (CIE 15) whose a* and b* are scaled by 0.01 L*: less light, less colour (FLIP-2020, section 4.1.2).
    fn hunt_lab(&self, rgb: [f64; 3]) -> [f64; 3] {
        const DELTA: f64 = 6.0 / 29.0;
        let f = |t: f64| match t > DELTA * DELTA * DELTA {
            true => libm::cbrt(t),
            false => t / (3.0 * DELTA * DELTA) + 4.0 / 29.0,
        };
        let [x, y, z] = times(&self.relative_xyz_from_rgb, rgb).map(f);
        let lightness = 116.0 * y - 16.0;
        let hunt = 0.01 * lightness;
        [lightness, hunt * 500.0 * (x - y), hunt * 200.0 * (y - z)]
    }

    /// The distance of two seen colours, compressed and mapped to [0, 1] (FLIP-2020, section 4.1.2).
    pub(super) fn difference(&self, a: [f64; 3], b: [f64; 3]) -> f64 {
        if a == b {
            return 0.0;
        }
        let distance = libm::pow(hyab(a, b), Q_C);
        let knee = P_C * self.c_max;
        if distance < knee {
            P_T / knee * distance
        } else {
            let rest = (distance - knee) / (self.c_max - knee) * (1.0 - P_T);
            (P_T + rest).min(1.0)
        }
    }
}

/// HyAB: city blocks in lightness, Euclid in chroma (Abasi et al. 2020, as FLIP-2020 takes it).
fn hyab(a: [f64; 3], b: [f64; 3]) -> f64 {
    let d: [f64; 3] = std::array::from_fn(|i| a[i] - b[i]);
    d[0].abs() + (d[1] * d[1] + d[2] * d[2]).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_is_white_and_the_matrix_is_the_published_one() {
        let colors = Colors::new();
        let white = times(&colors.relative_xyz_from_rgb, [1.0; 3]);
        assert!(white.iter().all(|v| (v - 1.0).abs() < 1e-15), "{white:?}");
        // IEC 61966-2-1 rounds the row of Y to .2126, .7152, .0722.
        let y = colors.relative_xyz_from_rgb[1];
        for (found, published) in y.iter().zip([0.2126, 0.7152, 0.0722]) {
            assert!((found - published).abs() < 5e-5, "{found} {published}");
        }
        let lab = colors.seen(colors.opponent([1.0; 3]));
        assert!((lab[0] - 100.0).abs() < 1e-12 && lab[1].abs() < 1e-11 && lab[2].abs() < 1e-11);
    }

    #[test]
    fn the_opponent_space_turns_back() {
        let colors = Colors::new();
        for rgb in [[0.2, 0.5, 0.9], [1.0, 0.0, 0.0], [0.0; 3]] {
            let (there, back) = (colors.hunt_lab(rgb), colors.seen(colors.opponent(rgb)));
            assert!(hyab(there, back) < 1e-6, "{rgb:?}: {there:?} {back:?}");
        }
    }

    #[test]
    fn green_and_blue_differ_most() {
        let colors = Colors::new();
        let seen = |rgb| colors.hunt_lab(rgb);
        let (green, blue) = (seen([0.0, 1.0, 0.0]), seen([0.0, 0.0, 1.0]));
        assert_eq!(colors.difference(green, blue), 1.0);
        assert_eq!(colors.difference(green, green), 0.0);
        // Black and white: 100 in lightness, nothing in chroma.
        let found = colors.difference(seen([0.0; 3]), seen([1.0; 3]));
        let (d, knee) = (100f64.powf(0.7), 0.4 * colors.c_max);
        let expected = 0.95 + (d - knee) / (colors.c_max - knee) * 0.05;
        assert!((found - expected).abs() < 1e-12, "{found} {expected}");
    }
}
