//! GL's stand-in for transparency: the transmissive triangles of a tile, blended over what its opaque ones show.
//!
//! In: a tile whose opaque samples are shaded. Out: the same tile, blended. As GL programs do it: opaque surfaces first,
//! writing depth; then the transmissive ones in the order of their primitive numbers, tested against that depth (GL_LESS:
//! equal is hidden), with depth writes off, SRC_ALPHA and ONE_MINUS_SRC_ALPHA:
//!
//! `C = alpha C_s + (1 - alpha) C_d`, alpha = 1 - luminance(K_T) (GL 2.1 sections 4.1.5 and 4.1.8)
//!
//! evaluated in f64 and rounded once. With GL's clamps the source is clamped before it is blended. Nothing is sorted by depth:
//! where transmissive triangles overlap in the wrong order the picture is wrong, and it is GL's own. Both faces of a body are
//! blended, the nearer and the farther, unless culling drops one. Without a depth test the picture is that of plain file
//! order: keys are primitive numbers there, so a later opaque triangle hides, and an earlier one does not.
//!
//! Layers and the unclamped colour that they add up to are blended with the same alpha; the remainder layer closes the sum,
//! as it does for several samples. Refraction, Fresnel's equations and the colour of K_T have no part in this.

use super::Counters;
use super::Plan;
use super::bin::{Binned, TILE};
use super::shade::{Pass, Workspace};
use super::tile::{Planes, Visibility};
use crate::lanes::Real;
use crate::math::Each;
use crate::scene::Scene;

/// Samples that are lit and blended together at most, but for those of the last triangle: bounds the memory.
const BATCH: usize = 4 * TILE * TILE;

/// The alphas of the materials, `None` for an opaque one; empty where the scene blends nothing.
pub(super) fn alphas(scene: &Scene) -> Vec<Option<f64>> {
    if !scene.blends() {
        return Vec::new();
    }
    let materials = scene.materials.iter();
    materials.map(|m| m.optics.blend_alpha()).collect()
}

/// Memory of the transmissive triangles in front of a tile.
pub(super) struct Front {
    visibility: Visibility,
    /// Columns and rows of the tile that a triangle passes.
    passed: Vec<[usize; 2]>,
    /// Alpha of each listed fragment.
    alpha: Vec<f64>,
}

impl Front {
    /// Nothing in front.
    pub(super) fn new(planes: Planes) -> Self {
        Self {
            visibility: Visibility::new(planes),
            passed: Vec::new(),
            alpha: Vec::new(),
        }
    }
}

impl<R: Real> Plan<'_, R> {
    /// Whether some material is blended.
    pub(super) fn blends(&self) -> bool {
        !self.alphas.is_empty()
    }

    /// The alpha that a primitive is blended with; `None` where it is opaque. Asked only where the plan blends.
    pub(super) fn blend_alpha(&self, primitive: u32) -> Option<f64> {
        self.alphas[self.assembly.material[primitive as usize] as usize]
    }
}

impl<R: Real> Workspace<R> {
    /// Blends the transmissive triangles of a tile over one sample a pixel.
    pub(super) fn blend(&mut self, pass: &Pass<'_, '_, R>, tile: usize, counters: &mut Counters) {
        let plan = pass.plan;
        self.front.visibility.start_from(&self.visibility);
        self.fragments.clear();
        for chunk in plan.chunks.iter().filter(|c| c.meets_tile(tile)) {
            for triangle in chunk.of_tile(tile) {
                let Binned { primitive, .. } = *triangle.0;
                let Some(alpha) = plan.blend_alpha(primitive) else {
                    continue;
                };
                let Front {
                    visibility, passed, ..
                } = &mut self.front;
                passed.clear();
                let at = (pass.area, pass.samples, plan.view.bits);
                let opaque = &self.visibility;
                visibility.probe(opaque, at, triangle, counters, |x, y| passed.push([x, y]));
                self.list(pass, primitive, alpha);
                if self.fragments.len() >= BATCH {
                    self.light_and_blend(pass, counters);
                }
            }
        }
        self.light_and_blend(pass, counters);
    }

    /// Lists the samples that a triangle passes.
    fn list(&mut self, pass: &Pass<'_, '_, R>, primitive: u32, alpha: f64) {
        if self.front.passed.is_empty() {
            return;
        }
        let seen = self.meet(pass.plan, pass.mode, primitive);
        for i in 0..self.front.passed.len() {
            let [x, y] = self.front.passed[i];
            self.push_sample(pass, &seen, x, y);
            self.front.alpha.push(alpha);
        }
    }

    /// Lights the listed samples and blends them in their order.
    fn light_and_blend(&mut self, pass: &Pass<'_, '_, R>, counters: &mut Counters) {
        self.light(pass, counters);
        let (mode, lit, shown) = (pass.mode, &self.lit, &mut self.shown);
        if let Some(record) = &mut self.record {
            record.show(
                pass.plan,
                mode.shading,
                &self.fragments,
                &self.front.alpha,
                lit,
            );
        }
        for (fragment, alpha) in self.fragments.iter().zip(&self.front.alpha) {
            let at = usize::from(fragment.at);
            shown.color[at] = over(*alpha, fragment.color(mode, lit), shown.color[at]);
            if mode.keeps_plain() {
                let plain = fragment.pick(mode.shading, &lit.plain);
                shown.plain[at] = over(*alpha, plain, shown.plain[at]);
            }
            for (shown, layer) in shown.layers.iter_mut().zip(&lit.layers) {
                shown[at] = over(*alpha, fragment.pick(mode.shading, layer), shown[at]);
            }
        }
        self.fragments.clear();
        self.front.alpha.clear();
    }
}

/// A source colour blended over a destination. Infinity times weight 0 is 0, and what has no value, infinity less infinity,
/// is the colour of larger weight.
fn over<R: Real>(alpha: f64, source: [R; 3], destination: [R; 3]) -> [R; 3] {
    let weighted = |w: f64, x: R| if w == 0.0 { 0.0 } else { w * x.to_f64() };
    [0, 1, 2].each(|c| {
        let (s, d) = (source[c], destination[c]);
        let sum = weighted(alpha, s) + weighted(1.0 - alpha, d);
        match (sum.is_nan(), alpha >= 0.5) {
            (false, _) => R::from_f64(sum),
            (true, true) => s,
            (true, false) => d,
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colors_without_a_sum_have_a_value() {
        let infinite = [f32::INFINITY, f32::NEG_INFINITY, 1.0];
        assert_eq!(over(0.0, infinite, [0.25; 3]), [0.25; 3]);
        assert_eq!(over(1.0, [0.25; 3], infinite), [0.25; 3]);
        let negative = infinite.map(|x| -x);
        assert_eq!(
            over(0.75, infinite, negative),
            [f32::INFINITY, f32::NEG_INFINITY, 0.5]
        );
        assert_eq!(
            over(0.25, infinite, negative),
            [f32::NEG_INFINITY, f32::INFINITY, -0.5]
        );
    }
}
