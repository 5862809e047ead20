//! Builds the hierarchy: binned surface area heuristic, in parallel from the first split, then collapsed to wide nodes.
//!
//! The result depends on the boxes alone, not on threads: bins are merged by min, max and integer sums, which do not
//! depend on order, and every subtree has its own range of primitives and nodes. Boxes come in world space as f64 and are
//! widened by 2^-20 of their own size plus 2^-40 of the scene's, far above the error of any hit inside them.
//!
//! Measured: see the module head of [`super`].

use rayon::prelude::*;

use super::bvh::{BoxSpace, Bvh, Node, round_down, round_up};
use super::split::{Choice, Extent, Reference, choose, extents};
use crate::math::DVec3;
use crate::math::Each;

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

/// Largest leaf.
const MAX_LEAF: usize = 8;
/// Subtrees and ranges below this stay on one thread.
pub(super) const PARALLEL: usize = 8 * 1024;

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
            low: low.each(|x| round_down(x).next_down()),
            high: high.each(|x| round_up(x).next_up()),
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
    let middle = match choose(references, &extent, &centers, depth, max_leaf) {
        Choice::Leaf => return,
        Choice::Halve => n / 2,
        Choice::Plane(plane) => plane.partition(references),
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
