//! THE lighting equation: points in, terms out. Both renderers call it, and nothing else lights anything.
//!
//! GL 2.1 section 2.14.1, in eye space, on unitless unclamped colours:
//!
//! ```text
//! c = e_cm + a_cm a_cs + SUM_i att_i spot_i ( a_cm a_li + ( [n.VP_i]+ d_cm d_li + f_i ([n.h_i]+)^s s_cm s_li ) S_i )
//! ```
//!
//! | symbol | here |
//! | - | - |
//! | e_cm, a_cm, d_cm, s_cm, s | `Material::{emission, ambient, diffuse, specular, shininess}` |
//! | a_cs | `LightModel::ambient` |
//! | a_li, d_li, s_li | [`LightColors`] |
//! | V, n | `Points::{position, normal, normal_length}` |
//! | ^(0 - V), or (0, 0, 1) for an infinite viewer | `Points::to_viewer`: the caller's affair |
//! | VP_i, \|P_i - V\|, att_i spot_i | [`Incident`] |
//! | f_i | 1 where n.VP_i > 0 strictly, else 0 |
//! | h_i; the lecture's V.R with R = 2(N.L)N - L | `SpecularModel::HalfVector`; `SpecularModel::Reflection` |
//! | S_i | [`Visibility`]: an input; 1 for the rasterizer, shadow rays for the tracer |
//!
//! To learn the equation, read [`plain`] first: the same in thirty scalar lines, one point and one number at a time, held to
//! this by a test. Here it is side by side, exact at its edges, and leaves out what cannot show.
//!
//! **Order.** Lights one by one, points side by side ([`crate::lanes`]). For each light, part one says where it is and
//! whether it faces the points; then the visibility hook is asked, once a light for all points of the call; then part
//! two evaluates. Without a hook, points are taken in chunks of 256, so that what the parts hand each other stays in
//! the nearest cache; with one, the chunk is the whole call, and so a call should hold no more than some thousand.
//!
//! **Sum.** Terms are added per component in the order emission, scene ambient, then per light ambient, diffuse,
//! specular, starting from +0, never fused: in `R`, or in f64 rounded once where `signed`. So [`Sink::Sum`] equals
//! `frame::sum_in_order` over [`Sink::Record`] bit for bit, and a term that is +0 may be left out. A point's result does not
//! depend on its neighbours, on its place in the list, or on the instruction set.
//!
//! **Undefined inputs.** Light at the point: direction 0, distance 0. Zero normal: no diffuse, no specular. Zero half
//! vector: n.h = 0. 0^0 = 1. Attenuation denominator <= 0: +infinity, and 0 times infinity is 0. Where `signed`,
//! terms are limited to the finite numbers, since sums of opposite infinities have no value. Colours that are not
//! finite count as the largest number (infinity) or 0 (NaN). No NaN comes out.
//!
//! **Accuracy.** See `tests/pictures/lighting_reference.rs`, which holds the bars.
//!
//! **Speed.** Instructions a point, one light, sums only; the caller's part, the direction to the viewer, included. 2026-11,
//! release, AVX2 (`valgrind --tool=cachegrind --cache-sim=no probe lighting-bench ROW N`, two lengths subtracted). The guide's
//! prototype, section 7, has 258 in the first row and 28 in the seventh:
//!
//! | features | f32 |
//! | - | - |
//! | all | 270 |
//! | no spot | 243 |
//! | infinite viewer | 126 |
//! | directional | 237 |
//! | no specular | 95 |
//! | specular, directional, infinite viewer | 93 |
//! | diffuse, directional only | 62 |
//! | all, f64 | 386 |
//!
//! A local viewer is 144 of the 270: it is made a point at a time, before the lanes.
//!
//! **Vertex colours.** Where a material tracks the vertex colour (GL 2.1 section 2.14.3), its terms are each point's own
//! [`Points::color`]: products become lists for that call, each rounded once from f64 as the others are. Nothing else changes,
//! and materials that track nothing pay nothing. GL has vertex colours at vertices only; a caller that lights fragments or
//! hits gives the interpolated colour.
//!
//! Left out: texture (a factor on the material, the caller's), fog, clamping (a named step of the caller's).

mod anatomy;
mod batch;
mod call;
mod cone;
mod faults;
mod light;
mod parts;
pub mod plain;
mod rig;
mod rounded;
mod scratch;
mod tracked;
mod vector;

use std::ops::AddAssign;

use serde::Serialize;

pub use anatomy::Anatomy;
pub use batch::{Batch, Batches, surface};
pub use cone::Cone;
pub use faults::{Early, Faults};
pub use light::{DirectionalLight, Incident, Light, LightColors, PointLight, Power, SpotLight};
pub use rig::Rig;
pub use rounded::Rounded;

use crate::gl;
use crate::lanes::{Isa, Real};
use crate::math::float::normalize;
use call::{Call, Entry};
use scratch::with_scratch;

/// Points to be lit side by side, eye space, structure of arrays.
///
/// ```
/// let mut points = rastray::lighting::Points::<f32>::default();
/// points.push([0.0, 0.0, -5.0], [0.0, 0.0, 1.0], [0.0, 0.0, 1.0]);
/// assert_eq!(points.len(), 1);
/// ```
#[derive(Clone, Debug, Default)]
pub struct Points<R> {
    /// x, y, z.
    pub position: [Vec<R>; 3],
    /// Unit normals (or zero), already flipped where facing asks for it.
    pub normal: [Vec<R>; 3],
    /// Length the normal enters the equation with; empty = 1.
    pub normal_length: Vec<R>,
    /// Unit vectors to the viewer: (0, 0, 1) for an infinite viewer, against the ray for secondary rays.
    pub to_viewer: [Vec<R>; 3],
    /// Vertex colours (red, green, blue), for materials that track them; empty = white, GL's current colour by default.
    pub color: [Vec<R>; 3],
}

impl<R: Real> Points<R> {
    /// The same points in another precision: exact where it is wider, rounded once where it is not.
    pub fn convert<T: Real>(&self) -> Points<T> {
        let list = |list: &Vec<R>| list.iter().map(|x| T::from_f64(x.to_f64())).collect();
        let lists = |lists: &[Vec<R>; 3]| [list(&lists[0]), list(&lists[1]), list(&lists[2])];
        Points {
            position: lists(&self.position),
            normal: lists(&self.normal),
            normal_length: list(&self.normal_length),
            to_viewer: lists(&self.to_viewer),
            color: lists(&self.color),
        }
    }
    /// How many points.
    pub fn len(&self) -> usize {
        self.position[0].len()
    }
    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
    /// Forgets the points, keeps the memory.
    pub fn clear(&mut self) {
        for list in self
            .position
            .iter_mut()
            .chain(&mut self.normal)
            .chain(&mut self.to_viewer)
            .chain(&mut self.color)
        {
            list.clear();
        }
        self.normal_length.clear();
    }
    /// Adds a point (normal of unit length or zero).
    pub fn push(&mut self, position: [R; 3], normal: [R; 3], to_viewer: [R; 3]) {
        for axis in 0..3 {
            self.position[axis].push(position[axis]);
            self.normal[axis].push(normal[axis]);
            self.to_viewer[axis].push(to_viewer[axis]);
        }
    }
    /// A list of one point of this list.
    pub fn one(&self, point: usize) -> Self {
        let part = |list: &Vec<R>| list.get(point).copied().into_iter().collect();
        let parts = |lists: &[Vec<R>; 3]| [part(&lists[0]), part(&lists[1]), part(&lists[2])];
        Self {
            position: parts(&self.position),
            normal: parts(&self.normal),
            normal_length: part(&self.normal_length),
            to_viewer: parts(&self.to_viewer),
            color: parts(&self.color),
        }
    }
    /// Adds the vertex colour of the last point: either all points of a list have one, or none.
    pub fn push_color(&mut self, color: [R; 3]) {
        for (list, c) in self.color.iter_mut().zip(color) {
            list.push(c);
        }
    }
}

/// The unit vector from a point to the viewer: to the eye for a local viewer (zero at the eye itself), else (0, 0, 1)
/// (GL 2.1 section 2.14.1).
///
/// ```
/// use rastray::lighting::to_viewer;
/// assert_eq!(to_viewer([0.0f32, -3.0, -4.0], true), [0.0, 0.6, 0.8]);
/// assert_eq!(to_viewer([0.0f32, -3.0, -4.0], false), [0.0, 0.0, 1.0]);
/// ```
pub fn to_viewer<R: Real>(position_eye: [R; 3], local_viewer: bool) -> [R; 3] {
    if local_viewer {
        normalize(position_eye.map(|x| -x)).0
    } else {
        [R::ZERO, R::ZERO, R::ONE]
    }
}

/// What the first part of the equation says of one light, for each point of a call.
///
/// ```
/// // Directional lights: the same direction everywhere, infinitely far.
/// # use rastray::{gl, lanes::Isa, lighting::*};
/// struct Seen(f32);
/// impl Visibility<f32> for Seen {
///     fn query(&mut self, _light: usize, seen: &Illumination<f32>, _out: &mut [Vec<f32>; 3]) {
///         assert!(seen.facing[0] && seen.to_light[2][0] == 1.0);
///         self.0 = seen.distance[0];
///     }
/// }
/// let rig = Rig::new(&[gl::LightSource::default()], &gl::LightModel::default());
/// let mut points = Points::default();
/// points.push([0.0; 3], [0.0, 0.0, 1.0], [0.0, 0.0, 1.0]);
/// let (mut seen, mut out) = (Seen(0.0), Default::default());
/// let material = gl::Material::default();
/// shade(Isa::Scalar, &rig, &material, &points, Some(&mut seen), false, Sink::Sum(&mut out));
/// assert_eq!(seen.0, f32::INFINITY);
/// ```
#[derive(Clone, Debug, Default)]
pub struct Illumination<R> {
    /// Unit direction to the light.
    pub to_light: [Vec<R>; 3],
    /// Distance to the light; +infinity for directional lights.
    pub distance: Vec<R>,
    /// n.l > 0, and attenuation x spot is not 0: the light matters here, so its visibility is asked.
    pub facing: Vec<bool>,
}

/// S_L: what the tracer's shadow rays answer. The rasterizer has none.
///
/// Asked at most once a light and call, for all points of the call, and only if the light has a diffuse or specular
/// colour on the material and faces some point. Answers are expected in [0, 1].
pub trait Visibility<R> {
    /// Writes S_L (one colour a point) of a light into `out` for the points that `light` faces; others are ignored.
    /// `out` comes in filled with ones.
    fn query(&mut self, light: usize, illumination: &Illumination<R>, out: &mut [Vec<R>; 3]);
}

/// Where the terms go: a colour sum, or every term. Lists are resized to the points.
///
/// ```
/// # use rastray::{gl, lanes::Isa, lighting::*};
/// let rig = Rig::new(&[gl::LightSource::default()], &gl::LightModel::default());
/// let mut points = Points::<f32>::default();
/// points.push([0.0; 3], [0.0, 0.0, 1.0], [0.0, 0.0, 1.0]);
/// let (mut layers, material) = (Vec::new(), gl::Material::default());
/// shade(Isa::detect(), &rig, &material, &points, None, false, Sink::Record(&mut layers));
/// assert_eq!(layers.len(), 5); // emission, scene ambient; the light's ambient, diffuse, specular
/// assert_eq!(layers[1][0], [0.04]); // 0.2 * 0.2
/// assert_eq!(layers[3][0], [0.8]); // n.l = 1
/// ```
pub enum Sink<'a, R> {
    /// The sum of all terms in the stated order (`frame::Layers`), one colour a point.
    Sum(&'a mut [Vec<R>; 3]),
    /// Every term: emission, scene ambient, then for each light ambient, diffuse, specular (as `frame::LayerIndex`).
    Record(&'a mut Vec<[Vec<R>; 3]>),
    /// GL's primary and secondary colour, unclamped (secondary is 0 unless specular is separate).
    Split(&'a mut [Vec<R>; 3], &'a mut [Vec<R>; 3]),
}

/// What calls did: exact counts, the same at every instruction set, so in units of points, not of vectors. A point counts
/// where its value is asked for; lanes beside it that compute the same and throw it away do not.
///
/// Each count is the points of the variant that ran, taken outside the loops over lanes. Highlights are asked for by the
/// points that the light faces (f_i = 1); everything else by all points.
///
/// ```
/// use rastray::lighting::Counters;
/// let mut total = Counters { points: 3, ..Counters::default() };
/// total += Counters { points: 2, pow_calls: 2, ..Counters::default() };
/// assert_eq!((total.points, total.pow_calls), (5, 2));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Counters {
    /// Points shaded.
    pub points: u64,
    /// Points times lights that have some term on the material.
    pub light_evaluations: u64,
    /// Points times lights whose direction was computed from a position: a square root, and a vector made unit.
    pub light_vector_roots: u64,
    /// Points times lights whose attenuation was computed: a division.
    pub attenuations: u64,
    /// Points times lights whose cone was tested.
    pub spot_tests: u64,
    /// Highlights that needed the half vector or the reflected direction (exponent not 0).
    pub half_vectors: u64,
    /// Highlights that needed a power (shininess other than 0 and 1).
    pub pow_calls: u64,
    /// Points times lights whose falloff inside the cone needed a power (exponents other than 0 and 1).
    pub spot_pow_calls: u64,
    /// Points times lights that face them, where their visibility was asked for.
    pub visibility_queries: u64,
}

impl AddAssign for Counters {
    fn add_assign(&mut self, other: Self) {
        self.points += other.points;
        self.light_evaluations += other.light_evaluations;
        self.light_vector_roots += other.light_vector_roots;
        self.attenuations += other.attenuations;
        self.spot_tests += other.spot_tests;
        self.half_vectors += other.half_vectors;
        self.pow_calls += other.pow_calls;
        self.spot_pow_calls += other.spot_pow_calls;
        self.visibility_queries += other.visibility_queries;
    }
}

/// The equation at some points of one material, with visibility as an input.
///
/// `isa`: any available instruction set; the bytes do not depend on it. `signed`: some colour of the scene is negative,
/// so sums run in f64 and round once. Nothing is allocated once a thread and its output lists are warm.
///
/// ```
/// use rastray::{gl, lanes::Isa, lighting::{Points, Rig, Sink, shade}};
/// // A light straight above a white surface, 2 away, attenuation 1/d^2: diffuse is 1/4 of 0.8.
/// let light = gl::LightSource {
///     position: [0.0, 2.0, 0.0, 1.0],
///     attenuation: [0.0, 0.0, 1.0],
///     ..gl::LightSource::default()
/// };
/// let model = gl::LightModel { ambient: [0.0; 3], ..gl::LightModel::default() };
/// let rig = Rig::<f64>::new(&[light], &model);
/// let mut points = Points::default();
/// points.push([0.0; 3], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
/// let mut out = Default::default();
/// let material = gl::Material::default();
/// let counters = shade(Isa::detect(), &rig, &material, &points, None, false, Sink::Sum(&mut out));
/// assert_eq!(out[0], [0.2]);
/// assert_eq!(counters.pow_calls, 0); // no specular colour, no power
/// ```
pub fn shade<R: Real>(
    isa: Isa,
    rig: &Rig<R>,
    material: &gl::Material,
    points: &Points<R>,
    visibility: Option<&mut dyn Visibility<R>>,
    signed: bool,
    sink: Sink<'_, R>,
) -> Counters {
    let mut material = rig.switches.material(material);
    // Without colours of their own, all points have GL's current colour.
    if material.tracked.any() && points.color[0].is_empty() {
        material = material.with_color(gl::CURRENT_COLOR);
    }
    let material = &material;
    with_scratch(|scratch| {
        let call = Call {
            rig,
            material,
            points,
            visibility,
            signed,
            sink,
            scratch,
        };
        R::enter::<Entry<'_, '_>>((isa, call))
    })
}

#[cfg(test)]
mod tests;
