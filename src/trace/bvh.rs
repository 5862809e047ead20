//! Bounding volume hierarchy, `W` children a node, traversed without recursion.
//!
//! Boxes are f32, relative to the scene's centre and scaled by a power of two so that they lie near 1; they are rounded
//! outwards after [`build`](super::build) widened them by the primitives' own error. They only decide what need not be
//! looked at: hits come from the primitives' f64 routines, so a query through the hierarchy equals a query of every
//! primitive, bit for bit (tested, axis-parallel rays and rays in box faces included).
//!
//! Box test (Ize 2013): the ray's origin is rounded to both sides, the far end widened by 1 + 2 gamma(n); a ray parallel to
//! a slab gets a finite, huge inverse, so that it skips the axis when inside and misses outside, and 0 * infinity never
//! occurs. Child boxes lie side by side in arrays of `W`, so that the compiler, or packets later, test them in lanes.
//! A leaf may hold a hierarchy of its own (`instance`): the walker's stack serves both. Leaves out: packets.

use super::ray::Ray;
use crate::math::DVec3;
use crate::math::Each;

/// Children a node in the renderer.
pub const WIDTH: usize = 8;

/// Depth at which the builder stops believing the heuristic and halves by count, so that a stack stays small.
pub(super) const HEURISTIC_DEPTH: usize = 64;

/// Up to `W` children: boxes side by side, and what is in them.
#[derive(Clone, Debug)]
pub(super) struct Node<const W: usize> {
    /// Lower corners, axis by axis; +infinity where there is no child.
    pub(super) low: [[f32; W]; 3],
    /// Upper corners; -infinity where there is no child.
    pub(super) high: [[f32; W]; 3],
    /// Inner child: its node. Leaf: its first slot.
    pub(super) child: [u32; W],
    /// 0 = inner child, else the number of primitives of a leaf.
    pub(super) count: [u16; W],
}

impl<const W: usize> Node<W> {
    pub(super) const EMPTY: Self = Self {
        low: [[f32::INFINITY; W]; 3],
        high: [[f32::NEG_INFINITY; W]; 3],
        child: [0; W],
        count: [0; W],
    };
}

/// How box coordinates follow from world coordinates: (x - centre) * scale.
#[derive(Clone, Copy, Debug)]
pub(super) struct BoxSpace {
    pub(super) center: DVec3,
    /// A power of two.
    pub(super) scale: f64,
}

/// What a traversal did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Inner nodes entered.
    pub node_visits: u64,
    /// Child boxes tested.
    pub box_tests: u64,
    /// Primitives tested.
    pub primitive_tests: u64,
}

/// Scratch of a traversal, kept between rays, and its work so far.
#[derive(Debug, Default)]
pub struct Walker {
    /// Work since the walker was made.
    pub work: Work,
    stack: Vec<Entry>,
}

#[derive(Clone, Copy, Debug)]
struct Entry {
    near: f32,
    child: u32,
    count: u16,
}

/// The hierarchy over numbered slots.
#[derive(Clone, Debug)]
pub struct Bvh<const W: usize = WIDTH> {
    pub(super) nodes: Vec<Node<W>>,
    pub(super) space: BoxSpace,
    pub(super) leaves: usize,
}

/// A ray as the boxes see it.
struct BoxRay {
    /// Origin rounded down and up, axis by axis.
    origin_low: [f32; 3],
    origin_high: [f32; 3],
    inverse: [f32; 3],
    /// Box units of t a unit of the ray's t.
    unit: f64,
    t_min: f32,
}

/// Widens t against the rounding of a box test: 1 + 2 gamma(6) (three roundings, two conversions, one in hand).
const WIDEN: f32 = 1.0 + 8.0 * f32::EPSILON;

impl BoxRay {
    fn new(ray: &Ray, space: &BoxSpace) -> Option<Self> {
        use crate::lanes::Real;
        let largest = ray.direction.abs().max_element();
        if !(largest > 0.0 && ray.direction.is_finite() && ray.origin.is_finite()) {
            return None;
        }
        let (down, up) = largest.power_of_two_scale();
        let d = (ray.direction * down).to_array();
        let o = ((ray.origin - space.center) * space.scale).to_array();
        // Beyond f32 the box test has no numbers: from there, 10^38 times the scene away, nothing is met.
        if !o.iter().all(|x| (*x as f32).is_finite()) {
            return None;
        }
        let unit = space.scale * up;
        Some(Self {
            origin_low: o.each(|x| (x as f32).next_down()),
            origin_high: o.each(|x| (x as f32).next_up()),
            inverse: d.each(finite_inverse),
            unit,
            t_min: round_down(ray.t_min * unit) * (2.0 - WIDEN),
        })
    }

    /// A bound of t in box units, widened.
    fn bound(&self, t: f64) -> f32 {
        round_up(t * self.unit) * WIDEN
    }
}

/// 1 / x as a finite number of the same sign (+ for 0).
fn finite_inverse(x: f64) -> f32 {
    let inverse = if x == 0.0 { f64::MAX } else { 1.0 / x };
    (inverse as f32).clamp(-f32::MAX, f32::MAX)
}

pub(super) fn round_down(x: f64) -> f32 {
    let y = x as f32;
    if f64::from(y) > x { y.next_down() } else { y }
}

pub(super) fn round_up(x: f64) -> f32 {
    let y = x as f32;
    if f64::from(y) < x { y.next_up() } else { y }
}

impl<const W: usize> Bvh<W> {
    /// How many inner nodes.
    pub fn node_count(&self) -> usize {
        self.nodes.len()
    }

    /// How many leaves.
    pub fn leaf_count(&self) -> usize {
        self.leaves
    }

    /// Shows `leaf` every slot whose box the ray may meet between t_min and the bound, nearest boxes first.
    ///
    /// `leaf` gets a slot, the bound on t, which it may lower, and the walker, which it may lend to a hierarchy inside;
    /// it returns true to stop. Returns whether it did.
    pub fn traverse(
        &self,
        ray: &Ray,
        walker: &mut Walker,
        mut leaf: impl FnMut(usize, &mut f64, &mut Walker) -> bool,
    ) -> bool {
        let boxed = match BoxRay::new(ray, &self.space) {
            Some(boxed) if !self.nodes.is_empty() => boxed,
            _ => return false,
        };
        let mut t_max = ray.t_max;
        let mut bound = boxed.bound(t_max);
        // What lies below belongs to the hierarchy that this one is inside of.
        let base = walker.stack.len();
        walker.stack.push(Entry {
            near: 0.0,
            child: 0,
            count: 0,
        });
        while walker.stack.len() > base {
            let Some(entry) = walker.stack.pop() else {
                break;
            };
            if entry.near > bound {
                continue;
            }
            if entry.count == 0 {
                walker.work.node_visits += 1;
                walker.work.box_tests += W as u64;
                let node = &self.nodes[entry.child as usize];
                push_children(node, &boxed, bound, &mut walker.stack);
                continue;
            }
            let first = entry.child as usize;
            walker.work.primitive_tests += u64::from(entry.count);
            for slot in first..first + usize::from(entry.count) {
                if leaf(slot, &mut t_max, walker) {
                    walker.stack.truncate(base);
                    return true;
                }
            }
            bound = boxed.bound(t_max);
        }
        false
    }
}

/// Pushes the children that the ray may meet, the nearest on top.
#[inline]
fn push_children<const W: usize>(node: &Node<W>, ray: &BoxRay, bound: f32, stack: &mut Vec<Entry>) {
    // Intersect the slabs of all children.
    let mut near = [ray.t_min; W];
    let mut far = [bound; W];
    for axis in 0..3 {
        let inverse = ray.inverse[axis];
        let (first, last, from, to) = if inverse < 0.0 {
            let o = (ray.origin_low[axis], ray.origin_high[axis]);
            (&node.high[axis], &node.low[axis], o.0, o.1)
        } else {
            let o = (ray.origin_high[axis], ray.origin_low[axis]);
            (&node.low[axis], &node.high[axis], o.0, o.1)
        };
        for i in 0..W {
            let enter = (first[i] - from) * inverse;
            let leave = (last[i] - to) * inverse * WIDEN;
            near[i] = if enter > near[i] { enter } else { near[i] };
            far[i] = if leave < far[i] { leave } else { far[i] };
        }
    }
    // Keep those met, sorted by distance, farthest first.
    let base = stack.len();
    for i in 0..W {
        if near[i] <= far[i] {
            let (child, count) = (node.child[i], node.count[i]);
            let near = near[i];
            let entry = Entry { near, child, count };
            let mut at = stack.len();
            stack.push(entry);
            while at > base && stack[at - 1].near < near {
                stack[at] = stack[at - 1];
                at -= 1;
            }
            stack[at] = entry;
        }
    }
}
