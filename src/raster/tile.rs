//! Visibility in one screen tile: which primitive each sample sees.
//!
//! In: triangles in primitive order, the sample of each pixel. Out: primitive number and depth key of each pixel's sample.
//! Nothing is shaded here, so that each visible sample is shaded once. A nearer key wins, equal keys leave the lower
//! primitive number. Edge functions run in 32 bits where the triangle is small enough (divided by 256, rounded
//! down: exact, since samples are whole pixels apart), else in 64. Jittered samples always take 64 bits.
//! [`Visibility::probe`] asks the same of one triangle against depths that stay, for blending.
//!
//! Triangles that lie in one plane and overlap ([`crate::scene::contact`]) do not ask for depth, which rounding would decide:
//! of two the lower primitive number is seen ([`Planes`]). Only triangles of such a set pay for the question.

use super::Counters;
use super::bin::{Binned, Form, TILE, TileArea};
use super::edges::{Edges, SAMPLE_BITS};
use super::setup::pixels;
use super::sides::{ALL, Sample, Sides};
use crate::frame::NONE;

/// The one sample of each pixel that a pass looks at.
pub(super) enum Samples<'a> {
    /// The same place in every pixel.
    Shared {
        /// From the pixel's corner, in 1/256 px.
        offset: [i64; 2],
        /// Ray X of each column of the tile.
        x: &'a [f64],
        /// Ray Y of each row of the tile.
        y: &'a [f64],
    },
    /// A place of its own in each pixel, row-major with stride [`TILE`].
    Each {
        /// From the pixel's corner, in 1/256 px.
        offset: &'a [[i64; 2]],
        /// Ray (X, Y).
        ray: &'a [[f64; 2]],
    },
}

impl Samples<'_> {
    /// The ray (X, Y) of a pixel of the tile.
    pub(super) fn ray(&self, x: usize, y: usize) -> [f64; 2] {
        match self {
            Self::Shared { x: xs, y: ys, .. } => [xs[x], ys[y]],
            Self::Each { ray, .. } => ray[y * TILE + x],
        }
    }

    /// The sample of a pixel of the tile, in both frames.
    #[inline]
    fn sample(&self, area: &TileArea, x: usize, y: usize) -> Sample {
        let offset = match self {
            Self::Shared { offset, .. } => *offset,
            Self::Each { offset, .. } => offset[y * TILE + x],
        };
        let unit = f64::from(1u32 << SAMPLE_BITS);
        let place = |axis: usize, n: usize| {
            (area.place[axis] + n as i64) as f64 + offset[axis] as f64 / unit
        };
        Sample {
            pixel: [place(0, x), place(1, y)],
            ray: self.ray(x, y),
        }
    }
}

/// Which triangles lie in one plane: the number of its set for each primitive, [`NONE`] or missing for most.
pub(super) type Planes = std::sync::Arc<[u32]>;

/// The visibility buffer of a tile, row-major with stride [`TILE`].
pub(super) struct Visibility {
    planes: Planes,
    /// What another tile shows, where this one started from it and triangles lie in one plane; else empty.
    behind: Vec<u32>,
    /// Depth key; -infinity where nothing is.
    key: Vec<f64>,
    /// Primitive number, or [`NONE`].
    pub(super) primitive: Vec<u32>,
}

impl Visibility {
    /// Sees nothing.
    pub(super) fn new(planes: Planes) -> Self {
        Self {
            planes,
            behind: Vec::new(),
            key: vec![f64::NEG_INFINITY; TILE * TILE],
            primitive: vec![NONE; TILE * TILE],
        }
    }

    /// Forgets everything.
    pub(super) fn clear(&mut self) {
        self.key.fill(f64::NEG_INFINITY);
        self.primitive.fill(NONE);
    }

    /// Takes over the depths of another tile, and sees nothing nearer yet.
    pub(super) fn start_from(&mut self, other: &Self) {
        self.key.copy_from_slice(&other.key);
        self.primitive.fill(NONE);
        if !self.planes.is_empty() {
            self.behind.clone_from(&other.primitive);
        }
    }

    /// The set of a triangle, if it is in one.
    fn set_of(&self, primitive: u32) -> Option<u32> {
        let set = self.planes.get(primitive as usize)?;
        (*set != NONE).then_some(*set)
    }

    /// Whether a triangle of a set is seen at a place where it has this key.
    fn shows(&self, at: usize, key: f64, primitive: u32, set: u32) -> bool {
        let seen = match self.primitive[at] {
            NONE => self.behind.get(at).copied().unwrap_or(NONE),
            seen => seen,
        };
        if seen != NONE && self.set_of(seen) == Some(set) {
            primitive < seen
        } else {
            key > self.key[at]
        }
    }

    /// The samples of one triangle that are nearer than `other` shows, in rows from the top; their depths are not kept.
    /// `self` has been started from `other`.
    pub(super) fn probe(
        &mut self,
        other: &Self,
        (area, samples, bits): (&TileArea, &Samples<'_>, u32),
        triangle: (&Binned, Form<'_>),
        counters: &mut Counters,
        mut found: impl FnMut(usize, usize),
    ) {
        let Some(Window { first, count }) = self.draw(area, samples, bits, triangle, counters)
        else {
            return;
        };
        for y in first[1]..first[1] + count[1] {
            for x in first[0]..first[0] + count[0] {
                let at = y * TILE + x;
                if self.primitive[at] != NONE {
                    self.primitive[at] = NONE;
                    self.key[at] = other.key[at];
                    found(x, y);
                }
            }
        }
    }

    /// Draws one triangle; the pixels that were looked at, if any.
    pub(super) fn draw(
        &mut self,
        area: &TileArea,
        samples: &Samples<'_>,
        bits: u32,
        (triangle, form): (&Binned, Form<'_>),
        counters: &mut Counters,
    ) -> Option<Window> {
        match form {
            Form::Snapped(v) => self.draw_snapped(area, samples, bits, triangle, v, counters),
            Form::Sides { sides, first, last } => {
                let mut window = Window {
                    first: [0; 2],
                    count: [0; 2],
                };
                for axis in 0..2 {
                    let least = (first[axis] as usize).max(area.corner[axis]);
                    let end = (last[axis] as usize + 1).min(area.corner[axis] + area.size[axis]);
                    if least >= end {
                        return None;
                    }
                    window.first[axis] = least - area.corner[axis];
                    window.count[axis] = end - least;
                }
                self.by_sides(area, samples, &window, triangle, sides, counters);
                Some(window)
            }
        }
    }

    fn draw_snapped(
        &mut self,
        area: &TileArea,
        samples: &Samples<'_>,
        bits: u32,
        triangle: &Binned,
        v: [[i64; 2]; 3],
        counters: &mut Counters,
    ) -> Option<Window> {
        let offsets = match samples {
            Samples::Shared { offset, .. } => [*offset, *offset],
            Samples::Each { .. } => [[0; 2], [(1 << SAMPLE_BITS) - 1; 2]],
        };
        // The pixels of the tile whose sample may lie in the box around the triangle.
        let mut first = [0usize; 2];
        let mut count = [0usize; 2];
        for axis in 0..2 {
            let places = [v[0][axis], v[1][axis], v[2][axis]];
            let [least, most] = pixels(places, [offsets[0][axis], offsets[1][axis]], bits);
            let least = (least - area.place[axis]).max(0);
            let most = (most - area.place[axis]).min(area.size[axis] as i64 - 1);
            if least > most {
                return None;
            }
            first[axis] = least as usize;
            count[axis] = (most - least + 1) as usize;
        }
        // Edge functions at the first of them.
        let (mut place, mut extent) = ([0i64; 2], [0i64; 2]);
        for axis in 0..2 {
            let pixel = area.place[axis] + first[axis] as i64;
            place[axis] = (pixel << SAMPLE_BITS) + offsets[0][axis];
            let steps = (count[axis] as i64 - 1) << SAMPLE_BITS;
            extent[axis] = steps + offsets[1][axis] - offsets[0][axis];
        }
        let mut edges = Edges::new(v, bits, place);
        if edges.misses(extent) {
            return None;
        }
        for i in 0..3 {
            if edges.contains(i, extent) {
                (edges.e[i], edges.a[i], edges.b[i]) = (0, 0, 0);
            }
        }
        counters.fragments_tested += (count[0] * count[1]) as u64;
        let window = Window { first, count };
        match samples {
            Samples::Shared { x, y, .. } => {
                let Edges { mut e, a, b } = edges;
                for e in &mut e {
                    *e >>= SAMPLE_BITS;
                }
                let largest = |i: usize| a[i].abs() + b[i].abs();
                if largest(0).max(largest(1)).max(largest(2)) < 1 << 24 {
                    let narrow = |v: [i64; 3]| [v[0] as i32, v[1] as i32, v[2] as i32];
                    let edges = [narrow(e), narrow(a), narrow(b)];
                    self.rows::<i32>(&window, edges, triangle, x, y, counters);
                } else {
                    self.rows::<i64>(&window, [e, a, b], triangle, x, y, counters);
                }
            }
            Samples::Each { offset, ray } => {
                self.scattered(&window, &edges, triangle, offset, ray, counters);
            }
        }
        Some(window)
    }

    /// The kernel for triangles that their sides decide.
    fn by_sides(
        &mut self,
        area: &TileArea,
        samples: &Samples<'_>,
        window: &Window,
        triangle: &Binned,
        sides: &Sides,
        counters: &mut Counters,
    ) {
        let ([left, top], [width, height]) = (window.first, window.count);
        let [k0, kx, ky] = triangle.key;
        let range = [f64::from(triangle.range[0]), f64::from(triangle.range[1])];
        let set = self.set_of(triangle.primitive);
        counters.fragments_tested += (width * height) as u64;
        for y in top..top + height {
            // Samples at one place in every pixel lie on a line: what both ends say holds between them.
            let needed = match samples {
                Samples::Shared { .. } => {
                    let end = |x: usize| samples.sample(area, x, y);
                    match sides.between(&end(left), &end(left + width - 1)) {
                        Some(needed) => needed,
                        None => continue,
                    }
                }
                Samples::Each { .. } => ALL,
            };
            for x in left..left + width {
                let sample = samples.sample(area, x, y);
                if !sides.contains(&sample, needed) {
                    continue;
                }
                counters.fragments_covered += 1;
                let at = y * TILE + x;
                let key = limit(k0 + ky * sample.ray[1] + kx * sample.ray[0], range);
                let passes = match set {
                    None => key > self.key[at],
                    Some(set) => self.shows(at, key, triangle.primitive, set),
                };
                if passes {
                    self.key[at] = key;
                    self.primitive[at] = triangle.primitive;
                    counters.fragments_passed += 1;
                }
            }
        }
    }

    /// The kernel for samples at one place in every pixel: `e` = values at the first, steps rightwards, steps downwards.
    fn rows<T: Step>(
        &mut self,
        window: &Window,
        [mut e, a, b]: [[T; 3]; 3],
        triangle: &Binned,
        x: &[f64],
        y: &[f64],
        counters: &mut Counters,
    ) {
        let ([left, top], [width, height]) = (window.first, window.count);
        let [k0, kx, ky] = triangle.key;
        let range = [f64::from(triangle.range[0]), f64::from(triangle.range[1])];
        let xs = &x[left..left + width];
        let set = self.set_of(triangle.primitive);
        // What each edge gains at most on the way to the end of a row.
        let steps = width - 1;
        let gain = [
            a[0].most_of(steps),
            a[1].most_of(steps),
            a[2].most_of(steps),
        ];
        for (row, y) in y.iter().enumerate().skip(top).take(height) {
            let start = e;
            for i in 0..3 {
                e[i] = e[i].plus(b[i]);
            }
            // Skip rows that one edge excludes altogether.
            if (0..3).any(|i| start[i].plus(gain[i]).is_negative()) {
                continue;
            }
            let place = row * TILE + left;
            if let Some(set) = set {
                let row_key = k0 + ky * y;
                let [mut e0, mut e1, mut e2] = start;
                for (i, x) in xs.iter().enumerate() {
                    let (at, key) = (place + i, limit(row_key + kx * x, range));
                    if !e0.or(e1).or(e2).is_negative() {
                        counters.fragments_covered += 1;
                        if self.shows(at, key, triangle.primitive, set) {
                            self.key[at] = key;
                            self.primitive[at] = triangle.primitive;
                            counters.fragments_passed += 1;
                        }
                    }
                    (e0, e1, e2) = (e0.plus(a[0]), e1.plus(a[1]), e2.plus(a[2]));
                }
                continue;
            }
            let keys = &mut self.key[place..place + width];
            let primitives = &mut self.primitive[place..place + width];
            let row_key = k0 + ky * y;
            let [mut e0, mut e1, mut e2] = start;
            let (mut covered, mut passed) = (0u32, 0u32);
            for ((seen, primitive), x) in keys.iter_mut().zip(primitives).zip(xs) {
                // Inside, and nearer than what is seen so far?
                let inside = !e0.or(e1).or(e2).is_negative();
                let key = limit(row_key + kx * x, range);
                let passes = inside & (key > *seen);
                *seen = if passes { key } else { *seen };
                *primitive = if passes {
                    triangle.primitive
                } else {
                    *primitive
                };
                covered += u32::from(inside);
                passed += u32::from(passes);
                // Step one pixel rightwards.
                (e0, e1, e2) = (e0.plus(a[0]), e1.plus(a[1]), e2.plus(a[2]));
            }
            counters.fragments_covered += u64::from(covered);
            counters.fragments_passed += u64::from(passed);
        }
    }

    /// The kernel for samples at places of their own.
    fn scattered(
        &mut self,
        window: &Window,
        edges: &Edges,
        triangle: &Binned,
        offset: &[[i64; 2]],
        ray: &[[f64; 2]],
        counters: &mut Counters,
    ) {
        let ([left, top], [width, height]) = (window.first, window.count);
        let [k0, kx, ky] = triangle.key;
        let range = [f64::from(triangle.range[0]), f64::from(triangle.range[1])];
        let set = self.set_of(triangle.primitive);
        for row in 0..height {
            for column in 0..width {
                let at = (top + row) * TILE + left + column;
                let dx = ((column as i64) << SAMPLE_BITS) + offset[at][0];
                let dy = ((row as i64) << SAMPLE_BITS) + offset[at][1];
                let e = |i: usize| edges.e[i] + edges.a[i] * dx + edges.b[i] * dy;
                if (e(0) | e(1) | e(2)) < 0 {
                    continue;
                }
                counters.fragments_covered += 1;
                let key = limit(k0 + ky * ray[at][1] + kx * ray[at][0], range);
                let passes = match set {
                    None => key > self.key[at],
                    Some(set) => self.shows(at, key, triangle.primitive, set),
                };
                if passes {
                    self.key[at] = key;
                    self.primitive[at] = triangle.primitive;
                    counters.fragments_passed += 1;
                }
            }
        }
    }
}

/// The key held within the triangle's own; NaN becomes the farthest.
#[inline(always)]
fn limit(key: f64, [least, most]: [f64; 2]) -> f64 {
    let key = if key >= least { key } else { least };
    if key <= most { key } else { most }
}

/// Pixels of a tile.
pub(super) struct Window {
    first: [usize; 2],
    count: [usize; 2],
}

/// The integers that edge functions step in.
trait Step: Copy {
    fn plus(self, other: Self) -> Self;
    fn or(self, other: Self) -> Self;
    fn is_negative(self) -> bool;
    /// The most that `steps` or fewer steps of this size can gain.
    fn most_of(self, steps: usize) -> Self;
}

macro_rules! step {
    ($t:ident) => {
        impl Step for $t {
            #[inline(always)]
            fn plus(self, other: Self) -> Self {
                // The last step of a loop leaves the tile by one and cannot overflow; wrapping keeps the loop simple.
                self.wrapping_add(other)
            }
            #[inline(always)]
            fn or(self, other: Self) -> Self {
                self | other
            }
            #[inline(always)]
            fn is_negative(self) -> bool {
                self < 0
            }
            #[inline(always)]
            fn most_of(self, steps: usize) -> Self {
                self.max(0) * steps as $t
            }
        }
    };
}
step!(i32);
step!(i64);
