//! Vertex colours in place of material terms (GL 2.1 section 2.14.3): what of the equation's products then differs from
//! point to point. Everything else, and every point of a material that tracks nothing, takes the usual way.

use std::ops::Range;

use super::call::Call;
use super::parts::Has;
use super::vector::finite;
use super::{LightColors, Sink};
use crate::lanes::Real;

impl<R: Real> Call<'_, '_, R> {
    /// Emission and scene ambient of each point.
    pub(super) fn tracked_constants(&mut self, range: Range<usize>) {
        let tracked = self.material.tracked;
        for c in 0..3 {
            for (i, point) in range.clone().enumerate() {
                let color = self.points.color[c][point].to_f64();
                let pick = |follows: bool, own: f64| if follows { color } else { own };
                let early = self.rig.faults.early;
                let emission = pick(tracked.emission, self.material.emission[c]);
                let emission = early.constant(finite::<R>(emission));
                let ambient = pick(tracked.ambient, self.material.ambient[c]);
                let ambient = early.constant(finite::<R>(ambient * self.rig.model.ambient[c]));
                match &mut self.sink {
                    Sink::Record(layers) => {
                        layers[0][c][point] = emission;
                        layers[1][c][point] = ambient;
                    }
                    Sink::Sum(first) | Sink::Split(first, _) => {
                        first[c][point] = emission + ambient;
                        if self.signed {
                            let [wide, second] = &mut self.scratch.wide;
                            wide[c][i] = emission.to_f64() + ambient.to_f64();
                            second[c][i] = 0.0;
                        }
                    }
                }
            }
        }
    }

    /// Fills the scratch lists with each point's products, `own` where a term does not follow the colour; corrects
    /// `has`, and returns the largest magnitude of those that follow.
    pub(super) fn tracked_products(
        &mut self,
        light: &LightColors,
        own: &[[R; 3]; 3],
        has: &mut Has,
        range: Range<usize>,
    ) -> f64 {
        let tracked = self.material.tracked;
        let terms = [
            (tracked.ambient, &light.ambient, &mut has.ambient),
            (tracked.diffuse, &light.diffuse, &mut has.diffuse),
            (tracked.specular, &light.specular, &mut has.specular),
        ];
        let mut largest = 0.0f64;
        for (term, (follows, light, has)) in terms.into_iter().enumerate() {
            if follows {
                // Asked of the light alone, so that counters do not depend on the points of a call.
                *has = light.iter().any(|x| *x != 0.0);
            }
            for c in 0..3 {
                let list = &mut self.scratch.products[term][c];
                list.clear();
                if !follows {
                    list.resize(range.len(), own[term][c]);
                    continue;
                }
                let colors = &self.points.color[c][range.clone()];
                list.extend(colors.iter().map(|x| finite::<R>(x.to_f64() * light[c])));
                largest = list.iter().fold(largest, |m, x| m.max(x.to_f64().abs()));
            }
        }
        largest
    }
}
