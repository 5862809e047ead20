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
//! **Accuracy.** See `tests/lighting_reference.rs`, which holds the bars. **Speed.** See [`shade`].
//! Left out: texture (a factor on the material, the caller's), fog, clamping (a named step of the caller's).

mod batch;
mod cone;
mod light;
mod parts;
mod scratch;

use std::ops::AddAssign;

pub use batch::{Batch, Batches, surface};
pub use cone::Cone;
pub use light::{DirectionalLight, Incident, Light, LightColors, PointLight, Power, SpotLight};

use crate::gl;
use crate::lanes::{Isa, Kernel, Lanes, Real, dispatch};
use crate::math::color::Rgb;
use crate::math::float::normalize;
use parts::{Chunk, Has, Products, Target, Weights};
use scratch::{Scratch, with_scratch};

/// Points of a chunk where nobody asks for all of them at once.
const CHUNK: usize = 256;

/// Lights resolved for one frame, in eye space.
///
/// ```
/// use rastray::{gl, lighting::Rig};
/// let rig = Rig::<f32>::new(&[gl::LightSource::default()], &gl::LightModel::default());
/// assert_eq!(rig.light_count(), 1);
/// ```
#[derive(Clone, Debug)]
pub struct Rig<R> {
    lights: Vec<Light<R>>,
    model: gl::LightModel,
}

impl<R: Real> Rig<R> {
    /// Resolves eye-space light sources (the enabled ones, in file order) under a light model.
    pub fn new(lights_eye: &[gl::LightSource], model: &gl::LightModel) -> Self {
        Self {
            lights: lights_eye.iter().map(Light::resolve).collect(),
            model: model.clone(),
        }
    }

    /// How many lights.
    pub fn light_count(&self) -> usize {
        self.lights.len()
    }

    /// The resolved lights, in order.
    pub fn lights(&self) -> &[Light<R>] {
        &self.lights
    }
}

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
}

impl<R: Real> Points<R> {
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

    /// Some of the points.
    fn chunk(&self, range: std::ops::Range<usize>) -> Chunk<'_, R> {
        Chunk {
            position: [0, 1, 2].map(|a| &self.position[a][range.clone()]),
            normal: [0, 1, 2].map(|a| &self.normal[a][range.clone()]),
            normal_length: self.normal_length.get(range.clone()).unwrap_or(&[]),
            to_viewer: [0, 1, 2].map(|a| &self.to_viewer[a][range.clone()]),
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

/// What a call did: exact counts, the same at every instruction set.
///
/// ```
/// use rastray::lighting::Counters;
/// let mut total = Counters { points: 3, ..Counters::default() };
/// total += Counters { points: 2, pow_calls: 2, ..Counters::default() };
/// assert_eq!((total.points, total.pow_calls), (5, 2));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Points shaded.
    pub points: u64,
    /// Points times lights that have some term on the material.
    pub point_lights: u64,
    /// Points times lights whose direction was computed from a position (a square root each).
    pub light_vector_roots: u64,
    /// Points times lights whose highlight or spot falloff needed a power (exponents other than 0 and 1).
    pub pow_calls: u64,
    /// Times that visibility was asked for.
    pub visibility_queries: u64,
}

impl AddAssign for Counters {
    fn add_assign(&mut self, other: Self) {
        self.points += other.points;
        self.point_lights += other.point_lights;
        self.light_vector_roots += other.light_vector_roots;
        self.pow_calls += other.pow_calls;
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
#[expect(clippy::too_many_arguments)]
pub fn shade<R: Real>(
    isa: Isa,
    rig: &Rig<R>,
    material: &gl::Material,
    points: &Points<R>,
    visibility: Option<&mut dyn Visibility<R>>,
    signed: bool,
    sink: Sink<'_, R>,
) -> Counters {
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
        dispatch(isa, call)
    })
}

/// One call of [`shade`], entered at an instruction set.
struct Call<'a, 'v, R> {
    rig: &'a Rig<R>,
    material: &'a gl::Material,
    points: &'a Points<R>,
    visibility: Option<&'v mut dyn Visibility<R>>,
    signed: bool,
    sink: Sink<'a, R>,
    scratch: &'a mut Scratch<R>,
}

impl<R: Real> Kernel<R> for Call<'_, '_, R> {
    type Output = Counters;

    #[inline(always)]
    fn run<L: Lanes<Scalar = R>>(mut self) -> Counters {
        let n = self.points.len();
        self.prepare_sink(n);
        let mut counters = Counters {
            points: n as u64,
            ..Counters::default()
        };
        let size = if self.visibility.is_some() {
            n.max(1)
        } else {
            CHUNK
        };
        for start in (0..n).step_by(size) {
            let end = n.min(start + size);
            self.scratch.resize(end - start);
            self.chunk::<L>(start, end, &mut counters);
        }
        counters
    }
}

impl<R: Real> Call<'_, '_, R> {
    /// Gives every output list one +0 a point.
    fn prepare_sink(&mut self, n: usize) {
        let zero = |lists: &mut [Vec<R>; 3]| {
            for list in lists {
                list.clear();
                list.resize(n, R::ZERO);
            }
        };
        match &mut self.sink {
            Sink::Sum(sum) => zero(sum),
            Sink::Record(layers) => {
                layers.resize_with(2 + 3 * self.rig.lights.len(), Default::default);
                layers.iter_mut().for_each(zero);
            }
            Sink::Split(first, second) => {
                zero(first);
                zero(second);
            }
        }
    }

    /// All lights on some of the points.
    #[inline(always)]
    fn chunk<L: Lanes<Scalar = R>>(&mut self, start: usize, end: usize, counters: &mut Counters) {
        let chunk = self.points.chunk(start..end);
        let n = (end - start) as u64;
        self.constants(start, end);
        for (index, light) in self.rig.lights.iter().enumerate() {
            let products = self.products(light, !chunk.normal_length.is_empty());
            if products.has.none() {
                continue;
            }
            counters.point_lights += n;
            // Part one.
            if needs_direction(light, products.has) {
                parts::illuminate::<L>(light, &chunk, self.scratch);
                counters.light_vector_roots += n * u64::from(is_positional(light));
                counters.pow_calls += n * u64::from(spot_needs_power(light));
            } else {
                self.scratch.factor.fill(R::ONE);
                self.scratch.n_dot_l.fill(R::ZERO);
            }
            // Visibility.
            let asked = products.has.shaded() && self.query(index);
            counters.visibility_queries += u64::from(asked);
            // Part two.
            let power = products.has.specular && matches!(products.power, Power::Other(_));
            counters.pow_calls += n * u64::from(power);
            if products.has.shaded() {
                parts::weigh::<L>(&products, &chunk, self.scratch);
            } else {
                self.scratch.diffuse.fill(R::ZERO);
                self.scratch.specular.fill(R::ZERO);
            }
            for component in 0..3 {
                self.emit::<L>(&products, index, component, asked, start, end);
            }
        }
        self.finish(start, end);
    }

    /// Emission and scene ambient, the terms that no light scales.
    fn constants(&mut self, start: usize, end: usize) {
        for c in 0..3 {
            let emission = finite::<R>(self.material.emission[c]);
            let ambient = finite::<R>(self.material.ambient[c] * self.rig.model.ambient[c]);
            match &mut self.sink {
                Sink::Record(layers) => {
                    layers[0][c][start..end].fill(emission);
                    layers[1][c][start..end].fill(ambient);
                }
                Sink::Sum(first) | Sink::Split(first, _) => {
                    first[c][start..end].fill(emission + ambient);
                    if self.signed {
                        self.scratch.wide[0][c].fill(emission.to_f64() + ambient.to_f64());
                        self.scratch.wide[1][c].fill(0.0);
                    }
                }
            }
        }
    }

    fn products(&self, light: &Light<R>, has_lengths: bool) -> Products<R> {
        let colors = light.colors();
        let multiply = |a: &Rgb, b: &Rgb| [0, 1, 2].map(|c| finite::<R>(a[c] * b[c]));
        let ambient = multiply(&self.material.ambient, &colors.ambient);
        let diffuse = multiply(&self.material.diffuse, &colors.diffuse);
        let specular = multiply(&self.material.specular, &colors.specular);
        let any = |color: [R; 3]| color.into_iter().any(|x| x != R::ZERO);
        let all = [ambient, diffuse, specular];
        let largest = all
            .iter()
            .flatten()
            .fold(1.0f64, |m, x| m.max(x.to_f64().abs()));
        let power = Power::new(self.material.shininess);
        let negative_power = matches!(power, Power::Other(s) if s < R::ZERO);
        let may_overflow = largest * light.largest_factor() > R::MAX.to_f64() / 4.0;
        Products {
            ambient,
            diffuse,
            specular,
            has: Has {
                ambient: any(ambient),
                diffuse: any(diffuse),
                specular: any(specular),
            },
            careful: may_overflow || negative_power || has_lengths,
            signed: self.signed,
            power,
            model: self.rig.model.specular_model,
        }
    }

    /// Asks for the visibility of a light that faces some point; says whether it did.
    fn query(&mut self, light: usize) -> bool {
        let Some(visibility) = self.visibility.as_deref_mut() else {
            return false;
        };
        let scratch = &mut *self.scratch;
        let lit = scratch.n_dot_l.iter().zip(&scratch.factor);
        for (facing, (n_dot_l, factor)) in scratch.illumination.facing.iter_mut().zip(lit) {
            *facing = *n_dot_l > R::ZERO && *factor != R::ZERO;
        }
        if !scratch.illumination.facing.contains(&true) {
            return false;
        }
        for list in &mut scratch.visibility {
            list.fill(R::ONE);
        }
        visibility.query(light, &scratch.illumination, &mut scratch.visibility);
        true
    }

    /// The terms of one light and component, into the sink.
    #[inline(always)]
    fn emit<L: Lanes<Scalar = R>>(
        &mut self,
        products: &Products<R>,
        light: usize,
        component: usize,
        asked: bool,
        start: usize,
        end: usize,
    ) {
        let scratch = &mut *self.scratch;
        let weights = Weights {
            factor: &scratch.factor,
            diffuse: &scratch.diffuse,
            specular: &scratch.specular,
            visibility: asked.then_some(&scratch.visibility[component]),
        };
        let separate = self.rig.model.color_control == gl::ColorControl::SeparateSpecular;
        if let Sink::Record(layers) = &mut self.sink {
            if let [a, d, s] = &mut layers[2 + 3 * light..5 + 3 * light] {
                let lists = [a, d, s].map(|list| &mut list[component][start..end]);
                parts::emit::<L>(products, component, &weights, Target::Record(lists));
            }
        } else if self.signed {
            let [a, d, s] = &mut scratch.terms;
            let lists = Target::Record([a, d, s]);
            parts::emit::<L>(products, component, &weights, lists);
            let [first, second] = &mut scratch.wide;
            add_wide(&mut first[component], a);
            add_wide(&mut first[component], d);
            let split = separate && matches!(self.sink, Sink::Split(..));
            let last = if split { second } else { first };
            add_wide(&mut last[component], s);
        } else {
            match &mut self.sink {
                Sink::Split(first, second) if separate => {
                    let lists = [&mut first[component], &mut second[component]];
                    let [first, second] = lists.map(|list| &mut list[start..end]);
                    parts::emit::<L>(products, component, &weights, Target::Split(first, second));
                }
                Sink::Sum(sum) | Sink::Split(sum, _) => {
                    let sum = &mut sum[component][start..end];
                    parts::emit::<L>(products, component, &weights, Target::Sum(sum));
                }
                Sink::Record(_) => {}
            }
        }
    }

    /// Rounds the f64 sums, where there are some.
    fn finish(&mut self, start: usize, end: usize) {
        if !self.signed {
            return;
        }
        let round = |lists: &mut [Vec<R>; 3], wide: &[Vec<f64>; 3]| {
            for (list, wide) in lists.iter_mut().zip(wide) {
                for (x, w) in list[start..end].iter_mut().zip(wide) {
                    *x = R::from_f64(*w);
                }
            }
        };
        let [first_wide, second_wide] = &self.scratch.wide;
        match &mut self.sink {
            Sink::Sum(first) => round(first, first_wide),
            Sink::Split(first, second) => {
                round(first, first_wide);
                round(second, second_wide);
            }
            Sink::Record(_) => {}
        }
    }
}

impl Has {
    fn shaded(self) -> bool {
        self.diffuse || self.specular
    }
    fn none(self) -> bool {
        !self.ambient && !self.shaded()
    }
}

fn is_positional<R>(light: &Light<R>) -> bool {
    !matches!(light, Light::Directional(_))
}

fn spot_needs_power<R>(light: &Light<R>) -> bool {
    matches!(light, Light::Spot(spot) if matches!(spot.power, Power::Other(_)))
}

/// Whether part one has anything to say: not where the light has only an ambient term that nothing scales.
fn needs_direction<R>(light: &Light<R>, has: Has) -> bool {
    let scaled = match light {
        Light::Directional(_) => false,
        Light::Point(light) => light.attenuated,
        Light::Spot(_) => true,
    };
    has.shaded() || scaled
}

/// Adds terms to sums in f64.
#[inline(always)]
fn add_wide<R: Real>(sums: &mut [f64], terms: &[R]) {
    for (sum, term) in sums.iter_mut().zip(terms) {
        *sum += term.to_f64();
    }
}

/// A colour rounded once to a finite number: infinity counts as the largest, NaN and -0 as 0.
fn finite<R: Real>(x: f64) -> R {
    let most = R::MAX.to_f64();
    if x.is_nan() {
        return R::ZERO;
    }
    R::from_f64(x.clamp(-most, most)) + R::ZERO
}

#[cfg(test)]
mod tests;
