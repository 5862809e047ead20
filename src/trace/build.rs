//! Builds the hierarchy: binned surface area heuristic, in parallel from the first split, then collapsed to wide nodes.
//!
//! The result depends on the boxes alone, not on threads: bins are merged by min, max and integer sums, which do not
//! depend on order, and every subtree has its own range of primitives and nodes. Boxes come in world space as f64 and are
//! widened by 2^-20 of their own size plus 2^-40 of the scene's, far above the error of any hit inside them.
//!
//! Measured: see the module head of [`super`].

use rayon::prelude::*;

use super::bvh::{BoxSpace, Bvh, HEURISTIC_DEPTH, Node, round_down, round_up};
use crate::math::DVec3;

/// A box in world space, corners included. An empty one (low > high), or one that is not finite, holds nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Lowest corner.
    pub low: DVec3,
    /// Highest corner.
    pub high: DVec3,
}

impl Bounds {
    /// The box of some points.
    pub fn of(points: impl IntoIterator<Item = DVec3>) -> Self {
        let mut bounds = Self {
            low: DVec3::INFINITY,
            high: DVec3::NEG_INFINITY,
        };
        for p in points {
            if !p.is_finite() {
                // Poison the box: min and max alone would skip NaN.
                bounds.low = DVec3::NAN;
                return bounds;
            }
            bounds.low = bounds.low.min(p);
            bounds.high = bounds.high.max(p);
        }
        bounds
    }

    fn is_solid(&self) -> bool {
        self.low.is_finite() && self.high.is_finite() && self.low.cmple(self.high).all()
    }
}

const BINS: usize = 16;
const MAX_LEAF: usize = 8;
/// Cost of entering a node, in primitive tests.
const NODE_COST: f32 = 1.0;
/// Subtrees and ranges below this stay on one thread.
const PARALLEL: usize = 8 * 1024;

/// A primitive during the build, box space.
#[derive(Clone, Copy)]
struct Reference {
    low: [f32; 3],
    high: [f32; 3],
    index: u32,
}

/// A box in box space, for min, max and area.
#[derive(Clone, Copy)]
struct Extent {
    low: [f32; 3],
    high: [f32; 3],
}

impl Extent {
    const EMPTY: Self = Self {
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
    fn area(&self) -> f32 {
        let d = [0, 1, 2].map(|k| (self.high[k] - self.low[k]).max(0.0));
        d[0] * d[1] + d[1] * d[2] + d[2] * d[0]
    }
}

impl Reference {
    fn doubled_center(&self, axis: usize) -> f32 {
        self.low[axis] + self.high[axis]
    }
}

/// A node of the binary tree that is collapsed later. Its subtree of n primitives owns 2n - 1 node places.
#[derive(Clone, Copy)]
struct Binary {
    extent: Extent,
    /// First reference.
    first: u32,
    /// References; in an inner node, too.
    count: u32,
    /// Distance from this node to its second child; 0 = leaf. The first child follows at once.
    second: u32,
}

impl<const W: usize> Bvh<W> {
    /// Builds over boxes, and says which box is in which slot. Boxes that hold nothing get no slot.
    pub fn build(bounds: &[Bounds]) -> (Self, Vec<u32>) {
        Self::build_with(bounds, MAX_LEAF)
    }

    /// [`Self::build`] with another largest leaf.
    pub fn build_with(bounds: &[Bounds], max_leaf: usize) -> (Self, Vec<u32>) {
        let space = box_space(bounds);
        let mut references = references(bounds, &space);
        let mut bvh = Self {
            nodes: Vec::new(),
            space,
            leaves: 0,
        };
        let n = references.len();
        if n == 0 {
            return (bvh, Vec::new());
        }
        let nothing = Binary {
            extent: Extent::EMPTY,
            first: 0,
            count: 0,
            second: 0,
        };
        let mut binary = vec![nothing; 2 * n - 1];
        let max_leaf = max_leaf.clamp(1, usize::from(u16::MAX));
        split(&mut references, &mut binary, 0, 0, max_leaf);
        bvh.collapse(&binary);
        let order = references.iter().map(|r| r.index).collect();
        (bvh, order)
    }

    /// Collapses the binary tree: a wide node takes the children of its largest inner child until it is full.
    fn collapse(&mut self, binary: &[Binary]) {
        self.nodes.push(Node::EMPTY);
        let mut open = vec![(0usize, 0usize)];
        while let Some((wide, root)) = open.pop() {
            let children = gather::<W>(binary, root);
            let mut node = Node::EMPTY;
            for (i, &at) in children.iter().enumerate() {
                let b = &binary[at];
                for k in 0..3 {
                    node.low[k][i] = b.extent.low[k];
                    node.high[k][i] = b.extent.high[k];
                }
                if b.second == 0 {
                    (node.child[i], node.count[i]) = (b.first, b.count as u16);
                    self.leaves += 1;
                } else {
                    node.child[i] = self.nodes.len() as u32;
                    open.push((self.nodes.len(), at));
                    self.nodes.push(Node::EMPTY);
                }
            }
            self.nodes[wide] = node;
        }
    }
}

/// The children of a wide node, in the order of their first primitive.
fn gather<const W: usize>(binary: &[Binary], root: usize) -> Vec<usize> {
    let mut children = vec![root];
    while children.len() < W {
        let largest = (0..children.len())
            .filter(|&i| binary[children[i]].second != 0)
            .max_by(|&i, &j| {
                let area = |i: usize| binary[children[i]].extent.area();
                area(i).total_cmp(&area(j)).then(j.cmp(&i))
            });
        let Some(i) = largest else { break };
        let at = children[i];
        children[i] = at + 1;
        children.insert(i + 1, at + binary[at].second as usize);
    }
    children
}

/// Centre and scale of the scene: box coordinates come out between about -1 and 1.
fn box_space(bounds: &[Bounds]) -> BoxSpace {
    use crate::lanes::Real;
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for b in bounds.iter().filter(|b| b.is_solid()) {
        low = low.min(b.low);
        high = high.max(b.high);
    }
    let center = low / 2.0 + high / 2.0;
    let half = (high / 2.0 - low / 2.0).max_element();
    if !center.is_finite() {
        return BoxSpace {
            center: DVec3::ZERO,
            scale: 1.0,
        };
    }
    // A scene that is one point takes the size of its coordinates.
    let size = if half > 0.0 {
        half
    } else {
        center.abs().max_element()
    };
    let scale = if size > 0.0 {
        size.power_of_two_scale().0
    } else {
        1.0
    };
    BoxSpace { center, scale }
}

fn references(bounds: &[Bounds], space: &BoxSpace) -> Vec<Reference> {
    let make = |(i, b): (usize, &Bounds)| {
        if !b.is_solid() {
            return None;
        }
        let pad = (b.high - b.low).max_element() / f64::from(1 << 20)
            + 1.0 / (1u64 << 40) as f64 / space.scale;
        let low = (b.low - DVec3::splat(pad) - space.center) * space.scale;
        let high = (b.high + DVec3::splat(pad) - space.center) * space.scale;
        let (low, high) = (low.to_array(), high.to_array());
        Some(Reference {
            low: low.map(|x| round_down(x).next_down()),
            high: high.map(|x| round_up(x).next_up()),
            index: i as u32,
        })
    };
    bounds.par_iter().enumerate().filter_map(make).collect()
}

/// Splits `references` into the subtree at `nodes[0]`; `first` is the number of its first reference.
fn split(
    references: &mut [Reference],
    nodes: &mut [Binary],
    first: u32,
    depth: usize,
    max_leaf: usize,
) {
    let n = references.len();
    let (extent, centers) = extents(references);
    nodes[0] = Binary {
        extent,
        first,
        count: n as u32,
        second: 0,
    };
    let middle = match best_split(references, &extent, &centers, depth, max_leaf) {
        Choice::Leaf => return,
        Choice::Halve => n / 2,
        Choice::Plane(plane) => partition(references, &plane),
    };
    let (left, right) = references.split_at_mut(middle);
    let (own, rest) = nodes.split_at_mut(1);
    let (left_nodes, right_nodes) = rest.split_at_mut(2 * middle - 1);
    own[0].second = 2 * middle as u32;
    let second = first + middle as u32;
    if n < PARALLEL {
        split(left, left_nodes, first, depth + 1, max_leaf);
        split(right, right_nodes, second, depth + 1, max_leaf);
    } else {
        rayon::join(
            || split(left, left_nodes, first, depth + 1, max_leaf),
            || split(right, right_nodes, second, depth + 1, max_leaf),
        );
    }
}

/// Box of the primitives, and of their centres (doubled).
fn extents(references: &[Reference]) -> (Extent, Extent) {
    let gather = |part: &[Reference]| {
        let mut boxes = Extent::EMPTY;
        let mut centers = Extent::EMPTY;
        for r in part {
            boxes.add(&r.low, &r.high);
            let c = [0, 1, 2].map(|k| r.doubled_center(k));
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

enum Choice {
    Leaf,
    Halve,
    Plane(Plane),
}

/// References in bins up to `bin` go left.
struct Plane {
    axis: usize,
    bin: usize,
    origin: f32,
    factor: f32,
}

impl Plane {
    fn bin_of(&self, r: &Reference) -> usize {
        (((r.doubled_center(self.axis) - self.origin) * self.factor) as usize).min(BINS - 1)
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

fn best_split(
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
    let planes = [0, 1, 2].map(|axis| {
        let width = centers.high[axis] - centers.low[axis];
        let factor = BINS as f32 * (1.0 - 4.0 * f32::EPSILON) / width;
        let factor = if factor.is_finite() { factor } else { 0.0 };
        let (bin, origin) = (0, centers.low[axis]);
        Plane {
            axis,
            bin,
            origin,
            factor,
        }
    });
    let bins = fill_bins(references, &planes);
    // Cheapest plane: area times count of both sides; the first one where several cost the same.
    let mut best = (f32::INFINITY, 0, 0);
    for (axis, bins) in bins.iter().enumerate() {
        if planes[axis].factor == 0.0 {
            continue;
        }
        let costs = plane_costs(bins);
        for (bin, cost) in costs.into_iter().enumerate() {
            if cost < best.0 {
                best = (cost, axis, bin);
            }
        }
    }
    let leaf_cost = extent.area() * n as f32;
    let split_cost = best.0 + NODE_COST * extent.area();
    if n <= max_leaf && leaf_cost <= split_cost {
        return Choice::Leaf;
    }
    if best.0 == f32::INFINITY {
        return Choice::Halve;
    }
    let [x, y, z] = planes;
    let plane = [x, y, z].into_iter().nth(best.1);
    plane.map_or(Choice::Halve, |p| Choice::Plane(Plane { bin: best.2, ..p }))
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

/// Moves the references of the left bins to the front; returns how many they are (neither none nor all).
fn partition(references: &mut [Reference], plane: &Plane) -> usize {
    let (mut left, mut right) = (0, references.len());
    while left < right {
        if plane.bin_of(&references[left]) <= plane.bin {
            left += 1;
        } else {
            right -= 1;
            references.swap(left, right);
        }
    }
    left
}
