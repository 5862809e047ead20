//! From visible samples to colours: gather what a tile sees, light it in batches, put the colours back.
//!
//! In: the visibility of a tile. Out: its colours and layers. Per-vertex shading (flat, Gouraud)
//! lights each vertex that a tile sees once a tile; per-fragment shading lights each visible sample. Both go through
//! [`Batches`], so the equation always meets many points of one material.
//!
//! Keeping the current triangle in place instead of moving it in and out of an Option for each pixel, and writing hot
//! closures out (array::map does not inline here), are why the loops look as they do.
//!
//! GL's clamps stand where the GL has them (GL 2.1 sections 2.14.6 and 3.9): each lit point's colour (primary and secondary
//! apart under separate specular), then the sum at the fragment.

use super::attribute::{Weights, mix, mix_colors, mix3};
use super::bin::{TILE, TileArea};
use super::blend::Front;
use super::lit::{Lit, Mode, Output};
use super::record::Record;
use super::slots::SlotMap;
use super::tile::{Samples, Visibility};
use super::view::orientation;
use super::{Counters, Options, Plan};
use crate::frame::{LayerIndex, NONE};
use crate::gl::ShadeModel;
use crate::lanes::Real;
use crate::lighting::{Batches, surface, to_viewer};
use crate::math::Each;
use crate::math::color::clamp_rgb;
use crate::math::float::normalize;

/// A visible sample.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fragment {
    /// Place in the tile, row-major with stride [`TILE`].
    pub(super) at: u16,
    /// Numbers of its lit points: three vertices (Gouraud), or one point three times.
    pub(super) points: [u32; 3],
    pub(super) weights: [f64; 3],
}

/// What one sample of each pixel of a tile shows, row-major with stride [`TILE`].
#[derive(Clone, Debug)]
pub(super) struct Shown<R> {
    /// Colour of the picture.
    pub(super) color: Vec<[R; 3]>,
    /// Unclamped colour, where the mode keeps it; else empty.
    pub(super) plain: Vec<[R; 3]>,
    /// The layers, where asked for.
    pub(super) layers: Vec<Vec<[R; 3]>>,
    /// Distance along -z at the first sample.
    pub(super) depth: Vec<R>,
    /// Primitive at the first sample.
    pub(super) primitive: Vec<u32>,
}

impl<R: Real> Shown<R> {
    fn new(mode: &Mode) -> Self {
        let black = || vec![[R::ZERO; 3]; TILE * TILE];
        Self {
            color: black(),
            plain: if mode.keeps_plain() {
                black()
            } else {
                Vec::new()
            },
            layers: (0..mode.layer_count()).map(|_| black()).collect(),
            depth: vec![R::INFINITY; TILE * TILE],
            primitive: vec![NONE; TILE * TILE],
        }
    }
}

/// The triangle that the last sample showed.
pub(super) struct Current {
    primitive: u32,
    weights: Weights,
    distance: [f64; 3],
    corners: [u32; 3],
    surface: usize,
    points: [u32; 3],
}

/// One sample of each pixel of a tile, about to be shaded.
#[derive(Clone, Copy)]
pub(super) struct Pass<'a, 's, R> {
    /// The scene.
    pub(super) plan: &'a Plan<'s, R>,
    /// How points are lit.
    pub(super) mode: &'a Mode,
    /// The draw's options.
    pub(super) options: &'a Options,
    /// The tile.
    pub(super) area: &'a TileArea,
    /// Its samples.
    pub(super) samples: &'a Samples<'a>,
    /// The frame keeps this sample's depth and primitive.
    pub(super) first: bool,
}

/// Memory of one worker, reused from tile to tile.
pub(super) struct Workspace<R> {
    /// What the tile sees.
    pub(super) visibility: Visibility,
    /// What its samples show.
    pub(super) shown: Shown<R>,
    /// Samples about to be lit.
    pub(super) fragments: Vec<Fragment>,
    /// Their lit points.
    pub(super) lit: Lit<R>,
    /// What blending needs.
    pub(super) front: Front,
    /// Who listens, if anybody does: then the tile is one pixel.
    pub(super) record: Option<Box<Record<R>>>,
    slots: SlotMap,
    batches: Batches<R>,
    output: Output<R>,
}

impl<R: Real> Workspace<R> {
    /// Empty, for a plan.
    pub(super) fn new(mode: &Mode, plan: &Plan<'_, R>) -> Self {
        Self {
            visibility: Visibility::new(plan.planes.clone()),
            shown: Shown::new(mode),
            fragments: Vec::new(),
            lit: Lit::default(),
            front: Front::new(plan.planes.clone()),
            record: None,
            slots: SlotMap::new(),
            output: Output::default(),
            batches: Batches::new(plan.scene.materials.len()).rounding(plan.rounded),
        }
    }

    /// Forgets the vertices lit for the last tile.
    pub(super) fn start_tile(&mut self) {
        self.slots.clear();
    }

    /// Shades what the visibility buffer shows of one sample a pixel.
    pub(super) fn sample(&mut self, pass: &Pass<'_, '_, R>, counters: &mut Counters) {
        self.gather(pass);
        self.light(pass, counters);
        if pass.first {
            self.keep_depth(pass.plan);
        }
        self.show_background(pass);
        self.show_colors(pass.mode);
        if let Some(record) = &mut self.record {
            record.show(
                pass.plan,
                pass.mode.shading,
                &self.fragments,
                &[],
                &self.lit,
            );
        }
    }

    /// Lists the visible samples, and the points to be lit for them.
    fn gather(&mut self, pass: &Pass<'_, '_, R>) {
        self.fragments.clear();
        let mut current: Option<Current> = None;
        for y in 0..pass.area.size[1] {
            for x in 0..pass.area.size[0] {
                let at = y * TILE + x;
                let primitive = self.visibility.primitive[at];
                if primitive == NONE {
                    continue;
                }
                if current.as_ref().is_none_or(|c| c.primitive != primitive) {
                    current = Some(self.meet(pass.plan, pass.mode, primitive));
                }
                let Some(seen) = &current else { continue };
                self.push_sample(pass, seen, x, y);
            }
        }
    }

    /// Lists a sample that shows a triangle, and its place among the points to be lit where shading is per fragment.
    #[inline]
    pub(super) fn push_sample(
        &mut self,
        pass: &Pass<'_, '_, R>,
        seen: &Current,
        x: usize,
        y: usize,
    ) {
        let range = [pass.plan.view.near, pass.plan.view.far];
        let ray = pass.samples.ray(x, y);
        let mut weights = seen.weights.between(ray, seen.distance, range);
        if pass.plan.faults.affine {
            weights = seen.weights.affine(weights);
        }
        let mut points = seen.points;
        if pass.mode.shading == ShadeModel::Phong {
            let tag = self.fragments.len() as u32;
            self.push_fragment(pass.plan, seen, weights, tag);
            points = [tag; 3];
        }
        self.fragments.push(Fragment {
            at: (y * TILE + x) as u16,
            points,
            weights,
        });
    }

    /// Prepares a triangle that comes into sight, and its vertices where shading is per vertex.
    pub(super) fn meet(&mut self, plan: &Plan<'_, R>, mode: &Mode, primitive: u32) -> Current {
        let corners = plan.assembly.triangles[primitive as usize];
        let vertices = plan.corners(primitive);
        let homogeneous = vertices.each(|v| v.homogeneous());
        // Facing: GL 2.1 section 2.14.1, two-sided lighting; edge-on counts as back, but draws nothing.
        let back = plan.two_sided && orientation(homogeneous) * plan.view.front_sign <= 0;
        let material = plan.assembly.material[primitive as usize] as usize;
        let surface = surface(material, back);
        if let Some(record) = &mut self.record {
            record.meet(primitive, surface);
        }
        let points = match mode.shading {
            ShadeModel::Phong => [0; 3],
            // The provoking vertex is the last (GL 2.1 section 2.14.7).
            ShadeModel::Flat => [self.push_vertex(plan, corners[2], surface); 3],
            ShadeModel::Gouraud => {
                let mut push = |v| self.push_vertex(plan, v, surface);
                [push(corners[0]), push(corners[1]), push(corners[2])]
            }
        };
        Current {
            primitive,
            weights: Weights::new(homogeneous),
            distance: vertices.each(|v| v.distance),
            corners,
            surface,
            points,
        }
    }

    /// The number of a lit vertex; it joins the batches when first met.
    fn push_vertex(&mut self, plan: &Plan<'_, R>, vertex: u32, surface: usize) -> u32 {
        let (slot, new) = self.slots.number(vertex, surface as u32);
        if new {
            let position = plan.assembly.vertex_eye(vertex);
            let mut normal = [R::ZERO; 3];
            if plan.normals {
                normal = turned(plan.assembly.vertex_normal(vertex), surface);
            }
            let viewer = to_viewer(position, plan.viewers);
            self.batches.push(surface, slot, position, normal, viewer);
            if let Some(color) = plan.assembly.vertex_color(vertex) {
                self.push_color(plan, surface, color);
            }
            if let Some(length) = plan.assembly.normal_length.get(vertex as usize) {
                let points = &mut self.batches.batch(surface).points;
                points.normal_length.push(*length);
            }
        }
        slot
    }

    /// Puts an interpolated place into the batches; its normal is renormalised.
    fn push_fragment(&mut self, plan: &Plan<'_, R>, seen: &Current, weights: [f64; 3], tag: u32) {
        let (assembly, [a, b, c]) = (plan.assembly, seen.corners);
        let place = |v| assembly.vertex_eye(v);
        let position = mix3(weights, [place(a), place(b), place(c)]);
        let mut normal = [R::ZERO; 3];
        let mut length = 0.0;
        if plan.normals {
            let at = |v| assembly.vertex_normal_weighted(v);
            let [p, q, r] = [at(a), at(b), at(c)];
            let raw = [
                mix(weights, [p[0], q[0], r[0]]),
                mix(weights, [p[1], q[1], r[1]]),
                mix(weights, [p[2], q[2], r[2]]),
            ];
            let unit;
            (unit, length) = normalize(raw);
            normal = turned(unit.each(R::from_f64), seen.surface);
        }
        let viewer = to_viewer(position, plan.viewers);
        self.batches
            .push(seen.surface, tag, position, normal, viewer);
        if plan.faults.normals_unnormalized {
            let points = &mut self.batches.batch(seen.surface).points;
            points.normal_length.push(R::from_f64(length));
        }
        if !assembly.color[0].is_empty() {
            let color = |v: u32| [0, 1, 2].each(|k: usize| assembly.color[k][v as usize]);
            let color = mix3(weights, [color(a), color(b), color(c)]);
            self.push_color(plan, seen.surface, color);
        }
    }

    /// The colour of the point just pushed, where its material follows vertex colours.
    fn push_color(&mut self, plan: &Plan<'_, R>, surface: usize, color: [R; 3]) {
        if plan.material(surface).tracked.any() {
            self.batches.batch(surface).points.push_color(color);
        }
    }

    /// Evaluates the equation for all batches.
    pub(super) fn light(&mut self, pass: &Pass<'_, '_, R>, counters: &mut Counters) {
        let mode = pass.mode;
        let per_vertex = mode.shading != ShadeModel::Phong;
        let count = if per_vertex {
            self.slots.len()
        } else {
            self.fragments.len()
        };
        self.lit.resize(mode, count);
        for batch in self.batches.iter() {
            counters.lighting += self.lit.light(pass, batch, &mut self.output);
            if let Some(record) = &mut self.record {
                record.lit(batch, &self.lit);
            }
            let points = batch.points.len() as u64;
            counters.points_shaded += points;
            let normals = pass.plan.normals && !per_vertex;
            counters.normalizations += points * (u64::from(normals) + u64::from(pass.plan.viewers));
            if per_vertex {
                counters.vertices_shaded += points;
            }
        }
        self.batches.clear();
    }

    fn keep_depth(&mut self, plan: &Plan<'_, R>) {
        let shown = &mut self.shown;
        shown.primitive.copy_from_slice(&self.visibility.primitive);
        shown.depth.fill(R::INFINITY);
        let [near, far] = plan.view.distances();
        let z = &plan.assembly.position_eye[2];
        for fragment in &self.fragments {
            let at = usize::from(fragment.at);
            let [a, b, c] = plan.assembly.triangles[shown.primitive[at] as usize];
            let z = [z[a as usize], z[b as usize], z[c as usize]];
            let distance = -mix(fragment.weights, z);
            shown.depth[at] = R::from_f64(distance.max(near).min(far));
        }
    }

    /// Fills the tile with the background.
    fn show_background(&mut self, pass: &Pass<'_, '_, R>) {
        let mode = pass.mode;
        let background = pass.plan.scene.background().each(R::from_f64);
        let shown = if mode.clamp {
            clamp_rgb(background)
        } else {
            background
        };
        self.shown.color.fill(shown);
        self.shown.plain.fill(background);
        for (index, layer) in self.shown.layers.iter_mut().enumerate() {
            let emission = index == LayerIndex::EMISSION;
            layer.fill(if emission { background } else { [R::ZERO; 3] });
        }
    }

    fn show_colors(&mut self, mode: &Mode) {
        let lit = &self.lit;
        for fragment in &self.fragments {
            let at = usize::from(fragment.at);
            self.shown.color[at] = fragment.color(mode, lit);
            if mode.keeps_plain() {
                self.shown.plain[at] = fragment.pick(mode.shading, &lit.plain);
            }
            for (shown, layer) in self.shown.layers.iter_mut().zip(&lit.layers) {
                shown[at] = fragment.pick(mode.shading, layer);
            }
        }
    }
}

impl Fragment {
    /// The fragment's colour: interpolated, GL's secondary colour added, then clamped if the mode says so.
    #[inline]
    pub(super) fn color<R: Real>(&self, mode: &Mode, lit: &Lit<R>) -> [R; 3] {
        let mut color = self.pick(mode.shading, &lit.color);
        if mode.split {
            let secondary = self.pick(mode.shading, &lit.secondary);
            for (c, s) in color.iter_mut().zip(secondary) {
                *c += s;
            }
        }
        if mode.clamp { clamp_rgb(color) } else { color }
    }

    /// The fragment's value of what its points have.
    #[inline]
    pub(super) fn pick<R: Real>(&self, shading: ShadeModel, values: &[[R; 3]]) -> [R; 3] {
        let [a, b, c] = self.points;
        let (a, b, c) = (a as usize, b as usize, c as usize);
        match shading {
            ShadeModel::Gouraud => mix_colors(self.weights, [values[a], values[b], values[c]]),
            ShadeModel::Flat | ShadeModel::Phong => values[a],
        }
    }
}

/// The normal of the side that a surface number names: back surfaces turn it round.
fn turned<R: Real>(normal: [R; 3], surface: usize) -> [R; 3] {
    if surface % 2 == 1 {
        [-normal[0], -normal[1], -normal[2]]
    } else {
        normal
    }
}
