//! Where a range of primitives is cut: the surface area heuristic over bins of their centres.
//!
//! A cut costs area x count of both sides, a leaf area x count, entering a node [`NODE_COST`] x area. Of equal costs the first
//! one wins (x before y before z, low bins first). Bins are merged by min, max and integer sums, so threads change nothing.

use crate::math::Each;
use rayon::prelude::*;

use super::build::PARALLEL;
use super::bvh::HEURISTIC_DEPTH;

const BINS: usize = 16;
/// Cost of entering a node, in primitive tests.
const NODE_COST: f32 = 1.0;

/// A primitive during the build, box space.
#[derive(Clone, Copy)]
pub(super) struct Reference {
    pub(super) low: [f32; 3],
    pub(super) high: [f32; 3],
    pub(super) index: u32,
}

/// A box in box space, for min, max and area.
#[derive(Clone, Copy)]
pub(super) struct Extent {
    pub(super) low: [f32; 3],
    pub(super) high: [f32; 3],
}

impl Extent {
    pub(super) const EMPTY: Self = Self {
        low: [f32::INFINITY; 3],
        high: [f32::NEG_INFINITY; 3],
    };

    fn add(&mut self, low: &[f32; 3], high: &[f32; 3]) {
        for k in 0..3 {
            self.low[k] = if low[k] < self.low[k] {
                low[k]
            } else {
                self.low[k]
            };
            self.high[k] = if high[k] > self.high[k] {
                high[k]
            } else {
                self.high[k]
            };
        }
    }

    fn joined(mut self, other: &Self) -> Self {
        self.add(&other.low, &other.high);
        self
    }

    /// Half the surface area; 0 where empty.
    pub(super) fn area(&self) -> f32 {
        let d = [0, 1, 2].each(|k| (self.high[k] - self.low[k]).max(0.0));
        d[0] * d[1] + d[1] * d[2] + d[2] * d[0]
    }
}

impl Reference {
    fn doubled_center(&self, axis: usize) -> f32 {
        self.low[axis] + self.high[axis]
    }
}

/// Box of the primitives, and of their centres (doubled).
pub(super) fn extents(references: &[Reference]) -> (Extent, Extent) {
    let gather = |part: &[Reference]| {
        let mut boxes = Extent::EMPTY;
        let mut centers = Extent::EMPTY;
        for r in part {
            boxes.add(&r.low, &r.high);
            let c = [0, 1, 2].each(|k| r.doubled_center(k));
            centers.add(&c, &c);
        }
        (boxes, centers)
    };
    if references.len() < PARALLEL {
        return gather(references);
    }
    let join = |a: (Extent, Extent), b: (Extent, Extent)| (a.0.joined(&b.0), a.1.joined(&b.1));
    let empty = || (Extent::EMPTY, Extent::EMPTY);
    references
        .par_chunks(PARALLEL)
        .map(gather)
        .reduce(empty, join)
}

/// What becomes of a range of primitives.
pub(super) enum Choice {
    Leaf,
    Halve,
    Plane(Plane),
}

/// References in bins up to `bin` go left.
#[derive(Clone, Copy)]
pub(super) struct Plane {
    axis: usize,
    bin: usize,
    origin: f32,
    factor: f32,
}

impl Plane {
    /// Bins over the range of centres along an axis; factor 0 where the range is empty.
    fn over(axis: usize, centers: &Extent) -> Self {
        let width = centers.high[axis] - centers.low[axis];
        let factor = BINS as f32 * (1.0 - 4.0 * f32::EPSILON) / width;
        Self {
            axis,
            bin: 0,
            origin: centers.low[axis],
            factor: if factor.is_finite() { factor } else { 0.0 },
        }
    }

    fn bin_of(&self, r: &Reference) -> usize {
        (((r.doubled_center(self.axis) - self.origin) * self.factor) as usize).min(BINS - 1)
    }

    /// Moves the references of the left bins to the front; returns how many they are (neither none nor all).
    pub(super) fn partition(&self, references: &mut [Reference]) -> usize {
        let (mut left, mut right) = (0, references.len());
        while left < right {
            if self.bin_of(&references[left]) <= self.bin {
                left += 1;
            } else {
                right -= 1;
                references.swap(left, right);
            }
        }
        left
    }
}

#[derive(Clone, Copy)]
struct Bin {
    extent: Extent,
    count: u32,
}

type Bins = [[Bin; BINS]; 3];

const NO_BINS: Bins = [[Bin {
    extent: Extent::EMPTY,
    count: 0,
}; BINS]; 3];

/// Cuts a range, or makes it a leaf.
pub(super) fn choose(
    references: &[Reference],
    extent: &Extent,
    centers: &Extent,
    depth: usize,
    max_leaf: usize,
) -> Choice {
    let n = references.len();
    if n == 1 {
        return Choice::Leaf;
    }
    if depth >= HEURISTIC_DEPTH {
        return if n <= max_leaf {
            Choice::Leaf
        } else {
            Choice::Halve
        };
    }
    let planes = [0, 1, 2].each(|axis| Plane::over(axis, centers));
    let (cost, plane) = cheapest(&fill_bins(references, &planes), planes);
    if n <= max_leaf && extent.area() * n as f32 <= cost + NODE_COST * extent.area() {
        return Choice::Leaf;
    }
    plane.map_or(Choice::Halve, Choice::Plane)
}

/// The cheapest plane and its cost; no plane and infinity where all centres are one.
fn cheapest(bins: &Bins, planes: [Plane; 3]) -> (f32, Option<Plane>) {
    let mut best = (f32::INFINITY, None);
    for (plane, bins) in planes.into_iter().zip(bins) {
        if plane.factor == 0.0 {
            continue;
        }
        for (bin, cost) in plane_costs(bins).into_iter().enumerate() {
            if cost < best.0 {
                best = (cost, Some(Plane { bin, ..plane }));
            }
        }
    }
    best
}

fn fill_bins(references: &[Reference], planes: &[Plane; 3]) -> Bins {
    let fill = |part: &[Reference]| {
        let mut bins = NO_BINS;
        for r in part {
            for (plane, bins) in planes.iter().zip(&mut bins) {
                let bin = &mut bins[plane.bin_of(r)];
                bin.extent.add(&r.low, &r.high);
                bin.count += 1;
            }
        }
        bins
    };
    if references.len() < PARALLEL {
        return fill(references);
    }
    let join = |mut a: Bins, b: Bins| {
        for (x, y) in a.iter_mut().flatten().zip(b.iter().flatten()) {
            x.extent = x.extent.joined(&y.extent);
            x.count += y.count;
        }
        a
    };
    references
        .par_chunks(PARALLEL)
        .map(fill)
        .reduce(|| NO_BINS, join)
}

/// Cost of splitting behind each bin but the last; infinite where one side would be empty.
fn plane_costs(bins: &[Bin; BINS]) -> [f32; BINS - 1] {
    let mut costs = [f32::INFINITY; BINS - 1];
    let mut right = [(0.0f32, 0u32); BINS];
    let mut sum = (Extent::EMPTY, 0);
    for i in (1..BINS).rev() {
        sum = (sum.0.joined(&bins[i].extent), sum.1 + bins[i].count);
        right[i] = (sum.0.area(), sum.1);
    }
    let mut sum = (Extent::EMPTY, 0);
    for i in 0..BINS - 1 {
        sum = (sum.0.joined(&bins[i].extent), sum.1 + bins[i].count);
        let (area, count) = right[i + 1];
        if sum.1 > 0 && count > 0 {
            costs[i] = sum.0.area() * sum.1 as f32 + area * count as f32;
        }
    }
    costs
}
