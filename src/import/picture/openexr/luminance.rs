//! Luminance and chroma (Y, RY, BY) to red, green and blue, as OpenEXR's `ImfRgbaYca` defines them:
//! RY = (R - Y) / Y, BY = (B - Y) / Y, Y = yw . RGB, where yw are the luminances of the file's primaries (by default those of
//! ITU-R BT.709). Chroma of every other pixel is filled in with OpenEXR's own filter. Its reader then takes a little
//! saturation from pixels that stand out, which is not done here: it would change pictures that lost nothing.

/// Weights of red, green and blue in Y.
pub(super) type Weights = [f32; 3];

/// The weights for chromaticities of red, green, blue and white (x, y); OpenEXR's `computeYw`.
pub(super) fn weights(primaries: [[f64; 2]; 4]) -> Option<Weights> {
    let [r, g, b, w] = primaries;
    // Columns are X, Y, Z of the primaries at Y = 1; the sums that make white give their luminances.
    let column = |[x, y]: [f64; 2]| [x / y, 1.0, (1.0 - x - y) / y];
    let [r, g, b, w] = [r, g, b, w].map(column);
    let det = |a: [f64; 3], b: [f64; 3], c: [f64; 3]| {
        a[0] * (b[1] * c[2] - b[2] * c[1]) - b[0] * (a[1] * c[2] - a[2] * c[1])
            + c[0] * (a[1] * b[2] - a[2] * b[1])
    };
    let whole = det(r, g, b);
    let weights = [det(w, g, b), det(r, w, b), det(r, g, w)].map(|d| (d / whole) as f32);
    weights
        .iter()
        .all(|w| w.is_finite() && *w != 0.0)
        .then_some(weights)
}

/// Those of ITU-R BT.709, OpenEXR's default.
pub(super) fn default_weights() -> Weights {
    let bt709 = [[0.64, 0.33], [0.3, 0.6], [0.15, 0.06], [0.3127, 0.329]];
    weights(bt709).unwrap_or([0.2126, 0.7152, 0.0722])
}

/// OpenEXR's `YCAtoRGBA`.
pub(super) fn rgb(y: f32, ry: f32, by: f32, yw: Weights) -> [f32; 3] {
    if ry == 0.0 && by == 0.0 {
        // Grey stays grey exactly.
        return [y; 3];
    }
    let (r, b) = ((ry + 1.0) * y, (by + 1.0) * y);
    [r, (y - r * yw[0] - b * yw[2]) / yw[1], b]
}

/// The filter that fills in odd places: weights of the neighbours at odd distances 1, 3, ... 13 (`ImfRgbaYca.cpp`).
const FILTER: [f32; 7] = [
    0.627123, -0.186077, 0.087929, -0.043159, 0.019597, -0.007540, 0.002128,
];

/// Samples of every other place to one each: those at odd places come of 14 neighbours; the ends are repeated.
fn double(samples: &[f32], length: usize) -> Vec<f32> {
    let last = samples.len() as i64 - 1;
    let at = |i: i64| samples[i.clamp(0, last) as usize];
    let place = |x: usize| {
        let i = (x / 2) as i64;
        if x.is_multiple_of(2) {
            return at(i);
        }
        let pair = |(k, weight): (usize, &f32)| weight * (at(i - k as i64) + at(i + 1 + k as i64));
        FILTER.iter().enumerate().map(pair).sum()
    };
    (0..length).map(place).collect()
}

/// A plane of half the width and height to the full size.
pub(super) fn fill_in(half: &[f32], width: usize, height: usize) -> Vec<f32> {
    let half_width = width.div_ceil(2);
    let rows: Vec<Vec<f32>> = half
        .chunks(half_width)
        .map(|row| double(row, width))
        .collect();
    let mut full = vec![0.0; width * height];
    for x in 0..width {
        let column: Vec<f32> = rows.iter().map(|row| row[x]).collect();
        for (y, value) in double(&column, height).into_iter().enumerate() {
            full[y * width + x] = value;
        }
    }
    full
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chroma_returns_what_it_came_from() {
        let yw = default_weights();
        for (found, known) in yw.iter().zip([0.212639, 0.715169, 0.072192]) {
            assert!((found - known).abs() < 1e-5, "{yw:?}");
        }
        for [r, g, b] in [[0.25f32, 0.5, 0.75], [4.0, 0.125, 0.0], [0.5, 0.5, 0.5]] {
            let y = r * yw[0] + g * yw[1] + b * yw[2];
            let back = rgb(y, (r - y) / y, (b - y) / y, yw);
            for (found, known) in back.iter().zip([r, g, b]) {
                assert!((found - known).abs() < 1e-5, "{back:?}");
            }
        }
        assert_eq!(rgb(0.3, 0.0, 0.0, yw), [0.3; 3]);
        // A ramp stays a ramp away from its ends, and what is even stays even.
        let ramp: Vec<f32> = (0..20).map(|i| 2.0 * i as f32).collect();
        let doubled = double(&ramp, 40);
        assert!(
            (doubled[19] - 19.0).abs() < 1e-3 && doubled[20] == 20.0,
            "{doubled:?}"
        );
        // OpenEXR's weights, as it prints them, sum to 0.500001: each of two passes adds 2e-6, and f32 rounds.
        let flat = fill_in(&[0.5; 6], 5, 3);
        let most = 0.5 * 4e-6 + 8.0 * f32::EPSILON;
        assert!(flat.iter().all(|v| (v - 0.5).abs() < most), "{flat:?}");
    }
}
