//! Working memory of [`super::shade`]: kept per thread, so that a call allocates nothing once it is warm.

use std::any::Any;
use std::cell::RefCell;

use super::Illumination;
use crate::lanes::Real;

/// What part one hands to part two, for the points of one chunk.
#[derive(Debug, Default)]
pub(super) struct Scratch<R> {
    /// Direction, distance and facing: what the visibility hook sees.
    pub(super) illumination: Illumination<R>,
    /// [n.l]+.
    pub(super) n_dot_l: Vec<R>,
    /// Attenuation times spot factor.
    pub(super) factor: Vec<R>,
    /// What diffuse is weighted with: factor [n.l]+.
    pub(super) diffuse: Vec<R>,
    /// What specular is weighted with: factor f_i (n.h)^s.
    pub(super) specular: Vec<R>,
    /// S_L.
    pub(super) visibility: [Vec<R>; 3],
    /// Material times light of each point: ambient, diffuse, specular. Used where the material tracks vertex colours.
    pub(super) products: [[Vec<R>; 3]; 3],
    /// Terms of one light on their way to a sum in f64.
    pub(super) terms: [[Vec<R>; 3]; 3],
    /// Sums in f64, of the first and of the second colour.
    pub(super) wide: [[Vec<f64>; 3]; 2],
}

impl<R: Real> Scratch<R> {
    /// Makes room for a chunk of `n` points.
    pub(super) fn resize(&mut self, n: usize) {
        let illumination = &mut self.illumination;
        let lists = illumination.to_light.iter_mut().chain([
            &mut illumination.distance,
            &mut self.n_dot_l,
            &mut self.factor,
            &mut self.diffuse,
            &mut self.specular,
        ]);
        let terms = self.terms.iter_mut().flatten();
        for list in lists.chain(&mut self.visibility).chain(terms) {
            list.resize(n, R::ZERO);
        }
        illumination.facing.resize(n, false);
        for list in self.wide.iter_mut().flatten() {
            list.resize(n, 0.0);
        }
    }
}

thread_local! {
    static POOL: RefCell<Vec<Box<dyn Any>>> = const { RefCell::new(Vec::new()) };
}

/// Runs `work` with this thread's memory of a precision; a call inside a call gets its own.
pub(super) fn with_scratch<R: Real, T>(work: impl FnOnce(&mut Scratch<R>) -> T) -> T {
    let kept = POOL.with_borrow_mut(|pool| {
        let found = pool.iter().position(|entry| entry.is::<Scratch<R>>());
        found.map(|index| pool.swap_remove(index))
    });
    let mut scratch: Box<Scratch<R>> = kept
        .and_then(|entry| entry.downcast().ok())
        .unwrap_or_default();
    let answer = work(&mut scratch);
    POOL.with_borrow_mut(|pool| pool.push(scratch));
    answer
}
