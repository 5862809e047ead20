//! The pixels that show a mistake best: where mistaken and right picture are farthest apart, and the given one is mistaken.

use super::measure::Values;

/// A pixel that shows the mistake.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Telling {
    /// Column, from the left.
    pub x: usize,
    /// Row, from the top.
    pub y: usize,
    /// Stored values of the given picture.
    pub given: [f32; 3],
    /// With the mistake.
    pub mistaken: [f32; 3],
    /// Right.
    pub right: [f32; 3],
}

/// How many are told.
const TOLD: usize = 3;

/// The given value counts as the mistaken one if it lies this near: a part of what the mistake changes, and two steps of 8
/// bits.
const NEAR: f32 = 0.15;
const STEPS: f32 = 2.5 / 255.0;

/// Up to three pixels, the most telling first, at least an eighth of the picture from each other. Pixels whose neighbours
/// tell as much come before those at an edge, where half a pixel decides.
pub(super) fn telling(given: &Values, mistaken: &Values, right: &Values) -> Vec<Telling> {
    let (width, height) = (given.width, given.height);
    let apart = |i: usize| distance(&mistaken.data[i], &right.data[i]);
    let tells = |i: usize| {
        let change = apart(i);
        let near = distance(&given.data[i], &mistaken.data[i]) <= NEAR * change + STEPS;
        if near && change > STEPS { change } else { 0.0 }
    };
    let strength: Vec<f32> = (0..given.data.len()).map(tells).collect();
    // The least of a pixel and its four neighbours, those beyond the rim left out.
    let calm = |i: usize| {
        let (x, y) = (i % width, i / width);
        let around = [
            (x > 0).then(|| i - 1),
            (x + 1 < width).then_some(i + 1),
            (y > 0).then(|| i - width),
            (y + 1 < height).then_some(i + width),
        ];
        around
            .into_iter()
            .flatten()
            .fold(strength[i], |least, j| least.min(strength[j]))
    };
    let mut order: Vec<(f32, usize)> = (0..strength.len())
        .filter(|i| strength[*i] > 0.0)
        .map(|i| (calm(i) + strength[i] / 1e3, i))
        .collect();
    order.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let room = (width.max(height) / 8).max(1);
    let mut told: Vec<Telling> = Vec::new();
    for (_, i) in order {
        let (x, y) = (i % width, i / width);
        let far = |t: &Telling| t.x.abs_diff(x).max(t.y.abs_diff(y)) >= room;
        if told.iter().all(far) {
            told.push(Telling {
                x,
                y,
                given: given.data[i],
                mistaken: mistaken.data[i],
                right: right.data[i],
            });
        }
        if told.len() == TOLD {
            break;
        }
    }
    told
}

fn distance(a: &[f32; 3], b: &[f32; 3]) -> f32 {
    (0..3).fold(0.0, |most, c| f32::max(most, (a[c] - b[c]).abs()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn calm_pixels_that_match_the_mistake_come_first() {
        let flat = |value: f32| Values::filled(40, 40, [value; 3]);
        let (mut given, mut mistaken, right) = (flat(0.5), flat(0.5), flat(0.5));
        let mut put = |x: usize, y: usize, wrong: f32, own: f32| {
            mistaken.data[y * 40 + x] = [wrong; 3];
            given.data[y * 40 + x] = [own; 3];
        };
        // A lone pixel that tells much, a calm place that tells less, and one where the given picture is right.
        put(35, 35, 1.0, 1.0);
        put(2, 30, 0.0, 0.5);
        for (x, y) in [(10, 10), (9, 10), (11, 10), (10, 9), (10, 11)] {
            put(x, y, 0.8, 0.8);
        }
        let told = telling(&given, &mistaken, &right);
        let places: Vec<(usize, usize)> = told.iter().map(|t| (t.x, t.y)).collect();
        assert_eq!(places, [(10, 10), (35, 35)]);
    }
}
