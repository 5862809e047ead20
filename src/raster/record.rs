//! What happened on the way to one pixel of the rasterizer: the surfaces that its sample shows, the lit points that they were
//! interpolated from, and what the equation answered there. Written down by the passes themselves, for whoever explains a
//! pixel; eye space.

use super::Plan;
use super::attribute::mix3;
use super::lit::Lit;
use super::shade::Fragment;
use crate::frame::remainder;
use crate::gl::ShadeModel;
use crate::lanes::Real;
use crate::lighting::{Batch, Points};

/// A pixel's samples, and what one of them shows.
#[derive(Clone, Debug, Default)]
pub struct Record<R> {
    /// Colour of the pixel.
    pub color: [R; 3],
    /// Colour of each sample.
    pub samples: Vec<[R; 3]>,
    /// What the kept sample shows: the opaque surface, if there is one, then what is blended over it, in order.
    pub surfaces: Vec<Seen<R>>,
    keep: usize,
    /// Primitive and surface of the triangles met, waiting for their fragments.
    met: Vec<(u32, usize)>,
    /// Lit points by their number in the tile.
    points: Vec<Option<LitPoint<R>>>,
}

/// A surface that a sample shows.
#[derive(Clone, Debug)]
pub struct Seen<R> {
    /// Number of its triangle.
    pub primitive: u32,
    /// Number of the surface that was shaded (`lighting::surface`).
    pub surface: usize,
    /// Perspective-correct weights of the triangle's corners.
    pub weights: [f64; 3],
    /// What it is blended with over what was there before; `None` for the opaque surface.
    pub alpha: Option<f64>,
    /// Its place, interpolated, eye space.
    pub position_eye: [R; 3],
    /// Its colour, before blending.
    pub color: [R; 3],
    /// Its terms, as interpolated.
    pub terms: Vec<[R; 3]>,
    /// What closes the sum of its terms to its colour (`frame::remainder`).
    pub remainder: [R; 3],
    /// Where the equation was asked: three vertices (Gouraud), the provoking one (flat), or the fragment itself.
    pub points: Vec<LitPoint<R>>,
}

/// A point at which the equation was asked.
#[derive(Clone, Debug)]
pub struct LitPoint<R> {
    /// The point as the equation took it, the only one of the list.
    pub point: Points<R>,
    /// The sum of its terms.
    pub color: [R; 3],
    /// The terms: emission, scene ambient, then for each light ambient, diffuse, specular.
    pub terms: Vec<[R; 3]>,
}

impl<R: Real> Record<R> {
    /// Listens to every sample, and keeps what one of them shows.
    pub(super) fn new(keep: u32) -> Self {
        Self {
            keep: keep as usize,
            ..Self::default()
        }
    }

    /// A triangle whose fragment is about to be listed.
    pub(super) fn meet(&mut self, primitive: u32, surface: usize) {
        self.met.push((primitive, surface));
    }

    /// Points that have been lit.
    pub(super) fn lit(&mut self, batch: &Batch<R>, lit: &Lit<R>) {
        for (slot, &tag) in batch.tags.iter().enumerate() {
            let tag = tag as usize;
            if self.points.len() <= tag {
                self.points.resize(tag + 1, None);
            }
            self.points[tag] = Some(LitPoint {
                point: batch.points.one(slot),
                color: lit.color[tag],
                terms: lit.layers.iter().map(|layer| layer[tag]).collect(),
            });
        }
    }

    /// The fragments of the triangles met: opaque ones without `alphas`.
    pub(super) fn show(
        &mut self,
        plan: &Plan<'_, R>,
        shading: ShadeModel,
        fragments: &[Fragment],
        alphas: &[f64],
        lit: &Lit<R>,
    ) {
        let met = std::mem::take(&mut self.met);
        if self.samples.len() != self.keep {
            return;
        }
        for (i, (fragment, (primitive, surface))) in fragments.iter().zip(met).enumerate() {
            let count = if shading == ShadeModel::Gouraud { 3 } else { 1 };
            let numbers = &fragment.points[..count];
            let points = numbers.iter().map(|n| self.points[*n as usize].clone());
            let corners = plan.assembly.triangles[primitive as usize];
            let place = |v: u32| plan.assembly.vertex_eye(v);
            let color = fragment.pick(shading, &lit.color);
            let terms = lit.layers.iter().map(|l| fragment.pick(shading, l));
            let terms: Vec<[R; 3]> = terms.collect();
            let signed = plan.scene.has_negative_colors();
            self.surfaces.push(Seen {
                primitive,
                surface,
                weights: fragment.weights,
                alpha: alphas.get(i).copied(),
                position_eye: mix3(fragment.weights, corners.map(place)),
                color,
                remainder: remainder(color, terms.iter().copied(), signed),
                terms,
                points: points.flatten().collect(),
            });
        }
    }

    /// The same record in f64, exact.
    pub fn to_f64(&self) -> Record<f64> {
        Record {
            color: self.color.map(Real::to_f64),
            samples: wide(&self.samples),
            surfaces: self.surfaces.iter().map(Seen::to_f64).collect(),
            keep: self.keep,
            met: Vec::new(),
            points: Vec::new(),
        }
    }

    /// What a sample came to.
    pub(super) fn end_sample(&mut self, color: [R; 3]) {
        self.samples.push(color);
    }
}

impl<R: Real> Seen<R> {
    fn to_f64(&self) -> Seen<f64> {
        Seen {
            primitive: self.primitive,
            surface: self.surface,
            weights: self.weights,
            alpha: self.alpha,
            position_eye: self.position_eye.map(Real::to_f64),
            color: self.color.map(Real::to_f64),
            terms: wide(&self.terms),
            remainder: self.remainder.map(Real::to_f64),
            points: self.points.iter().map(LitPoint::to_f64).collect(),
        }
    }
}

impl<R: Real> LitPoint<R> {
    fn to_f64(&self) -> LitPoint<f64> {
        LitPoint {
            point: self.point.convert(),
            color: self.color.map(Real::to_f64),
            terms: wide(&self.terms),
        }
    }
}

fn wide<R: Real>(colors: &[[R; 3]]) -> Vec<[f64; 3]> {
    colors.iter().map(|c| c.map(Real::to_f64)).collect()
}
