//! Lighting batches of points, with GL's clamps at each point.

use super::shade::Pass;
use super::{Options, Plan};
use crate::frame::{LayerIndex, sum_in_order};
use crate::gl::{ColorControl, ShadeModel};
use crate::lanes::Real;
use crate::lighting::{Batch, Counters, Sink, shade};
use crate::math::color::clamp_rgb;

/// What of the options and the scene decides how points are lit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mode {
    /// Flat, Gouraud or per-fragment.
    pub(super) shading: ShadeModel,
    /// GL's clamps are on.
    pub(super) clamp: bool,
    /// Primary and secondary colour are clamped apart.
    pub(super) split: bool,
    /// How many layers the equation fills, where layers are asked for.
    layers: Option<usize>,
    /// Sums run in f64, since some colour is negative.
    pub(super) signed: bool,
}

impl Mode {
    /// The mode of a draw.
    pub(super) fn new<R: Real>(plan: &Plan<'_, R>, options: &Options) -> Self {
        let separate = plan.scene.light_model.color_control == ColorControl::SeparateSpecular;
        let lights = plan.rig.light_count();
        Self {
            shading: options.shading,
            clamp: options.clamp,
            split: options.clamp && separate,
            layers: options.layers.then(|| LayerIndex { lights }.local()),
            signed: plan.scene.has_negative_colors(),
        }
    }

    /// The unclamped picture is kept beside the clamped one, for the layers to add up to.
    pub(super) fn keeps_plain(&self) -> bool {
        self.clamp && self.layers.is_some()
    }

    /// How many layers the equation fills; 0 where none are asked for.
    pub(super) fn layer_count(&self) -> usize {
        self.layers.unwrap_or(0)
    }
}

/// Colours of lit points: vertices of a tile, or fragments.
#[derive(Debug, Default)]
pub(super) struct Lit<R> {
    /// The whole colour, or GL's primary colour where split; clamped if the mode says so.
    pub(super) color: Vec<[R; 3]>,
    /// GL's secondary colour, clamped; empty where not split.
    pub(super) secondary: Vec<[R; 3]>,
    /// The unclamped colour, where the mode keeps it.
    pub(super) plain: Vec<[R; 3]>,
    /// Layer by layer; empty where none are asked for.
    pub(super) layers: Vec<Vec<[R; 3]>>,
}

/// What the equation writes into, reused from batch to batch.
#[derive(Debug, Default)]
pub(super) struct Output<R> {
    primary: [Vec<R>; 3],
    secondary: [Vec<R>; 3],
    terms: Vec<[Vec<R>; 3]>,
}

impl<R: Real> Lit<R> {
    /// Makes room for `count` points; those already lit stay.
    pub(super) fn resize(&mut self, mode: &Mode, count: usize) {
        let black = [R::ZERO; 3];
        self.color.resize(count, black);
        self.secondary
            .resize(if mode.split { count } else { 0 }, black);
        let plain = if mode.keeps_plain() { count } else { 0 };
        self.plain.resize(plain, black);
        self.layers.resize_with(mode.layer_count(), Vec::new);
        for layer in &mut self.layers {
            layer.resize(count, black);
        }
    }

    /// Evaluates the equation at the points of a batch; each point's tag is its number here. Layers beside GL's two clamped
    /// colours take two evaluations, and both are counted.
    pub(super) fn light(
        &mut self,
        pass: &Pass<'_, '_, R>,
        batch: &Batch<R>,
        output: &mut Output<R>,
    ) -> Counters {
        let mode = pass.mode;
        let mut counters = Counters::default();
        let shown = |c: [R; 3]| if mode.clamp { clamp_rgb(c) } else { c };
        let at = |list: &[Vec<R>; 3], i: usize| [list[0][i], list[1][i], list[2][i]];
        let tags = || batch.tags.iter().map(|tag| *tag as usize).enumerate();
        if mode.layers.is_some() {
            counters += run(pass, batch, Sink::Record(&mut output.terms));
            for (i, tag) in tags() {
                let sum = sum_in_order(output.terms.iter().map(|t| at(t, i)), mode.signed);
                for (layer, t) in self.layers.iter_mut().zip(&output.terms) {
                    layer[tag] = at(t, i);
                }
                if mode.keeps_plain() {
                    self.plain[tag] = sum;
                }
                self.color[tag] = shown(sum);
            }
        }
        if mode.split {
            let sink = Sink::Split(&mut output.primary, &mut output.secondary);
            counters += run(pass, batch, sink);
            for (i, tag) in tags() {
                self.color[tag] = shown(at(&output.primary, i));
                self.secondary[tag] = shown(at(&output.secondary, i));
            }
        } else if mode.layers.is_none() {
            counters += run(pass, batch, Sink::Sum(&mut output.primary));
            for (i, tag) in tags() {
                self.color[tag] = shown(at(&output.primary, i));
            }
        }
        counters
    }
}

fn run<R: Real>(pass: &Pass<'_, '_, R>, batch: &Batch<R>, sink: Sink<'_, R>) -> Counters {
    let Pass { plan, mode, .. } = pass;
    let (isa, material) = (pass.options.isa, plan.material(batch.surface));
    shade(
        isa,
        &plan.rig,
        material,
        &batch.points,
        None,
        mode.signed,
        sink,
    )
}
