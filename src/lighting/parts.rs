//! The two parts of the equation, one light at a time, over the lanes (GL 2.1 section 2.14.1).
//!
//! Part one: where is the light, does it face the point, how much arrives ([`illuminate`]). Part two: what the surface
//! makes of it, as two weights a point ([`weigh`]), and the terms themselves, times S_L, into the sink ([`emit`]).
//! Everything that is the same for all points of a light (its kind, its powers, the specular form) is decided outside
//! the lanes or by a branch that always goes the same way.

use super::light::{DirectionalLight, Incident, Light, PointLight, Power, SpotLight};
use super::scratch::Scratch;
use super::vector::{cross_squared, dot3, ln_cosine, zero_to};
use super::{Early, Faults};
use crate::gl::SpecularModel;
use crate::lanes::elementary::{exp, ln};
use crate::lanes::{Lanes, Mask, Real};

/// Some points of a batch.
#[derive(Clone, Copy)]
pub(super) struct Chunk<'a, R> {
    pub(super) position: [&'a [R]; 3],
    pub(super) normal: [&'a [R]; 3],
    /// Empty = 1.
    pub(super) normal_length: &'a [R],
    pub(super) to_viewer: [&'a [R]; 3],
}

impl<R: Real> Chunk<'_, R> {
    pub(super) fn len(&self) -> usize {
        self.position[0].len()
    }
}

/// What one light and one material have to do with each other.
#[derive(Clone, Copy, Debug)]
pub(super) struct Products<R> {
    /// Material times light, rounded once.
    pub(super) ambient: [R; 3],
    pub(super) diffuse: [R; 3],
    pub(super) specular: [R; 3],
    /// Some component is not 0.
    pub(super) has: Has,
    /// A factor may be infinite or a product may overflow: 0 times infinity is looked after.
    pub(super) careful: bool,
    /// Some colour of the scene is negative: terms are finite and never -0, sums run in f64.
    pub(super) signed: bool,
    /// Terms go out as they come: neither signed nor touched by a mistake.
    pub(super) as_is: bool,
    pub(super) faults: Faults,
    pub(super) power: Power<R>,
    pub(super) model: SpecularModel,
}

/// Which terms a light has on a material.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Has {
    pub(super) ambient: bool,
    pub(super) diffuse: bool,
    pub(super) specular: bool,
}

#[inline(always)]
fn load3<L: Lanes>(lists: &[&[L::Scalar]; 3], i: usize) -> [L; 3] {
    [
        L::load(&lists[0][i..]),
        L::load(&lists[1][i..]),
        L::load(&lists[2][i..]),
    ]
}

/// One kind of light, for the loop that is compiled once for each.
trait Source<R> {
    fn incident<L: Lanes<Scalar = R>>(&self, position: &[L; 3]) -> Incident<L>;
}
impl<R: Real> Source<R> for DirectionalLight<R> {
    #[inline(always)]
    fn incident<L: Lanes<Scalar = R>>(&self, _position: &[L; 3]) -> Incident<L> {
        self.illuminate()
    }
}
impl<R: Real> Source<R> for PointLight<R> {
    #[inline(always)]
    fn incident<L: Lanes<Scalar = R>>(&self, position: &[L; 3]) -> Incident<L> {
        self.illuminate(position)
    }
}
impl<R: Real> Source<R> for SpotLight<R> {
    #[inline(always)]
    fn incident<L: Lanes<Scalar = R>>(&self, position: &[L; 3]) -> Incident<L> {
        self.illuminate(position)
    }
}

/// Part one: fills direction, distance, factor and [n.l]+.
#[inline(always)]
pub(super) fn illuminate<L: Lanes>(
    light: &Light<L::Scalar>,
    chunk: &Chunk<'_, L::Scalar>,
    scratch: &mut Scratch<L::Scalar>,
) {
    match light {
        Light::Directional(light) => illuminate_from::<L, _>(light, chunk, scratch),
        Light::Point(light) => illuminate_from::<L, _>(light, chunk, scratch),
        Light::Spot(light) => illuminate_from::<L, _>(light, chunk, scratch),
    }
}

#[inline(always)]
fn illuminate_from<L: Lanes, S: Source<L::Scalar>>(
    source: &S,
    chunk: &Chunk<'_, L::Scalar>,
    scratch: &mut Scratch<L::Scalar>,
) {
    let zero = L::splat(L::Scalar::ZERO);
    for i in (0..chunk.len()).step_by(L::WIDTH) {
        let incident = source.incident(&load3::<L>(&chunk.position, i));
        let n_dot_l = dot3(load3::<L>(&chunk.normal, i), incident.to_light);
        // NaN, too, is not above 0.
        let n_dot_l = L::select(n_dot_l.gt(zero), n_dot_l, zero);
        for axis in 0..3 {
            incident.to_light[axis].store(&mut scratch.illumination.to_light[axis][i..]);
        }
        incident
            .distance
            .store(&mut scratch.illumination.distance[i..]);
        incident.factor.store(&mut scratch.factor[i..]);
        n_dot_l.store(&mut scratch.n_dot_l[i..]);
    }
}

/// The product, 0 where a factor is 0 (where `careful` asks).
#[inline(always)]
fn product<L: Lanes>(a: L, b: L, careful: bool) -> L {
    let plain = a * b;
    if !careful {
        return plain;
    }
    let zero = L::splat(L::Scalar::ZERO);
    L::select(a.same(zero) | b.same(zero), zero, plain)
}

/// Part two, what the surface makes of the light: [n.l]+ and f_i (n.h)^s, times what arrives.
#[inline(always)]
pub(super) fn weigh<L: Lanes>(
    products: &Products<L::Scalar>,
    chunk: &Chunk<'_, L::Scalar>,
    scratch: &mut Scratch<L::Scalar>,
) {
    let zero = L::splat(L::Scalar::ZERO);
    let one = L::splat(L::Scalar::ONE);
    for i in (0..chunk.len()).step_by(L::WIDTH) {
        let n_dot_l = L::load(&scratch.n_dot_l[i..]);
        let factor = L::load(&scratch.factor[i..]);
        let length = if chunk.normal_length.is_empty() {
            one
        } else {
            L::load(&chunk.normal_length[i..])
        };
        let lit = product(n_dot_l * length, factor, products.careful);
        lit.store(&mut scratch.diffuse[i..]);
        // The gate f_i: no highlight where the light is at or below the horizon.
        let mut faces = n_dot_l.gt(zero);
        if products.faults.ungated_specular {
            faces = faces | n_dot_l.le(zero);
        }
        let mut highlight = zero;
        if products.has.specular && faces.any() {
            let to_light = [
                L::load(&scratch.illumination.to_light[0][i..]),
                L::load(&scratch.illumination.to_light[1][i..]),
                L::load(&scratch.illumination.to_light[2][i..]),
            ];
            let normal = load3::<L>(&chunk.normal, i);
            let to_viewer = load3::<L>(&chunk.to_viewer, i);
            let power = match products.model {
                SpecularModel::HalfVector => {
                    half_vector(products.power, normal, length, to_light, to_viewer)
                }
                SpecularModel::Reflection => {
                    let n_dot_l = if products.faults.ungated_specular {
                        dot3(normal, to_light)
                    } else {
                        n_dot_l
                    };
                    reflection(products.power, normal, n_dot_l, to_light, to_viewer)
                }
            };
            highlight = L::select(faces, product(power, factor, products.careful), zero);
        }
        highlight.store(&mut scratch.specular[i..]);
    }
}

/// ([n.h]+)^s. The half vector is not normalised: sine and cosine are those of n and l + v over |l + v|^2, which costs
/// one root less than normalising and keeps the angle near the peak, as |n - h|^2/2 does.
#[inline(always)]
fn half_vector<L: Lanes>(
    power: Power<L::Scalar>,
    normal: [L; 3],
    normal_length: L,
    to_light: [L; 3],
    to_viewer: [L; 3],
) -> L {
    let (zero, one) = (L::splat(L::Scalar::ZERO), L::splat(L::Scalar::ONE));
    let half = [
        to_light[0] + to_viewer[0],
        to_light[1] + to_viewer[1],
        to_light[2] + to_viewer[2],
    ];
    match power {
        Power::Zero => one,
        Power::One => {
            let cosine = n_dot_h(normal, normal_length, half);
            L::select(dot3(normal, half).gt(zero), cosine, zero)
        }
        Power::Other(exponent) => {
            let n_dot_half = dot3(normal, half);
            let inverse = one / dot3(half, half);
            let sin_squared = cross_squared(normal, half) * inverse;
            let cos_squared = n_dot_half * n_dot_half * inverse;
            let log = ln_cosine(sin_squared, cos_squared) + ln_length(normal_length, one);
            let value = exp(L::splat(exponent) * log);
            L::select(n_dot_half.gt(zero), value, L::splat(zero_to(exponent)))
        }
    }
}

/// n.h for h = `half` made unit length; not a number where it is zero.
#[inline(always)]
pub(super) fn n_dot_h<L: Lanes>(normal: [L; 3], normal_length: L, half: [L; 3]) -> L {
    dot3(normal, half) * normal_length / dot3(half, half).sqrt()
}

/// R = 2(N.L)N - L.
#[inline(always)]
pub(super) fn mirrored<L: Lanes>(normal: [L; 3], n_dot_l: L, to_light: [L; 3]) -> [L; 3] {
    let twice = n_dot_l + n_dot_l;
    [
        twice.mul_add(normal[0], -to_light[0]),
        twice.mul_add(normal[1], -to_light[1]),
        twice.mul_add(normal[2], -to_light[2]),
    ]
}

/// ln of the length that a normal enters with: nothing to compute where all are 1.
#[inline(always)]
fn ln_length<L: Lanes>(length: L, one: L) -> L {
    if length.same(one).all() {
        L::splat(L::Scalar::ZERO)
    } else {
        ln(length)
    }
}

/// ([V.R]+)^n, R = 2(N.L)N - L, the lecture's form. N is the unit normal here, whatever its length in the other terms.
#[inline(always)]
fn reflection<L: Lanes>(
    power: Power<L::Scalar>,
    normal: [L; 3],
    n_dot_l: L,
    to_light: [L; 3],
    to_viewer: [L; 3],
) -> L {
    let (zero, one) = (L::splat(L::Scalar::ZERO), L::splat(L::Scalar::ONE));
    let reflected = mirrored(normal, n_dot_l, to_light);
    let v_dot_r = dot3(to_viewer, reflected);
    match power {
        Power::Zero => one,
        Power::One => v_dot_r.max(zero),
        Power::Other(exponent) => {
            let sin_squared = cross_squared(to_viewer, reflected);
            let log = ln_cosine(sin_squared, v_dot_r * v_dot_r);
            let value = exp(L::splat(exponent) * log);
            L::select(v_dot_r.gt(zero), value, L::splat(zero_to(exponent)))
        }
    }
}

/// Where the three terms of a light go, three lists a colour.
pub(super) enum Target<'a, R> {
    /// Added to a sum, in the order ambient, diffuse, specular.
    Sum([&'a mut [R]; 3]),
    /// Ambient and diffuse added to the first, specular to the second.
    Split([&'a mut [R]; 3], [&'a mut [R]; 3]),
    /// Each to its own lists.
    Record([[&'a mut [R]; 3]; 3]),
}

/// What [`emit`] reads.
pub(super) struct Weights<'a, R> {
    pub(super) factor: &'a [R],
    pub(super) diffuse: &'a [R],
    pub(super) specular: &'a [R],
    /// S_L; `None` = 1.
    pub(super) visibility: Option<&'a [Vec<R>; 3]>,
    /// Products of each point instead of [`Products`]' own; `None` = the same for all.
    pub(super) products: Option<&'a [[Vec<R>; 3]; 3]>,
}

/// Part two, the terms: colour times weight times S_L (ambient is never shadowed).
#[inline(always)]
pub(super) fn emit<L: Lanes>(
    products: &Products<L::Scalar>,
    weights: &Weights<'_, L::Scalar>,
    target: Target<'_, L::Scalar>,
) {
    let n = weights.factor.len();
    match target {
        Target::Sum(mut sum) => {
            for i in (0..n).step_by(L::WIDTH) {
                let weight = load_weights::<L>(weights, i);
                for (c, sum) in sum.iter_mut().enumerate() {
                    let [ambient, diffuse, specular] = terms(products, &weight, weights, c, i);
                    let total = L::load(&sum[i..]) + ambient + diffuse + specular;
                    total.store(&mut sum[i..]);
                }
            }
        }
        Target::Split(mut first, mut second) => {
            for i in (0..n).step_by(L::WIDTH) {
                let weight = load_weights::<L>(weights, i);
                for (c, (first, second)) in first.iter_mut().zip(&mut second).enumerate() {
                    let [ambient, diffuse, specular] = terms(products, &weight, weights, c, i);
                    (L::load(&first[i..]) + ambient + diffuse).store(&mut first[i..]);
                    (L::load(&second[i..]) + specular).store(&mut second[i..]);
                }
            }
        }
        Target::Record([a, d, s]) => {
            for i in (0..n).step_by(L::WIDTH) {
                let weight = load_weights::<L>(weights, i);
                for c in 0..3 {
                    let [ambient, diffuse, specular] = terms(products, &weight, weights, c, i);
                    ambient.store(&mut a[c][i..]);
                    diffuse.store(&mut d[c][i..]);
                    specular.store(&mut s[c][i..]);
                }
            }
        }
    }
}

/// Weights of ambient, diffuse and specular of some points.
#[inline(always)]
fn load_weights<L: Lanes>(weights: &Weights<'_, L::Scalar>, i: usize) -> [L; 3] {
    load3(&[weights.factor, weights.diffuse, weights.specular], i)
}

/// Ambient, diffuse and specular of some points, one colour component.
#[inline(always)]
fn terms<L: Lanes>(
    products: &Products<L::Scalar>,
    weight: &[L; 3],
    weights: &Weights<'_, L::Scalar>,
    component: usize,
    i: usize,
) -> [L; 3] {
    let careful = products.careful;
    let [a, d, s] = match weights.products {
        None => [
            L::splat(products.ambient[component]),
            L::splat(products.diffuse[component]),
            L::splat(products.specular[component]),
        ],
        Some([a, d, s]) => load3(&[&a[component], &d[component], &s[component]], i),
    };
    let ambient = product(a, weight[0], careful);
    let mut diffuse = product(d, weight[1], careful);
    let mut specular = product(s, weight[2], careful);
    if let Some(visibility) = weights.visibility {
        let s = L::load(&visibility[component][i..]);
        diffuse = product(diffuse, s, careful);
        specular = product(specular, s, careful);
    }
    if products.as_is {
        return [ambient, diffuse, specular];
    }
    let mut terms = [ambient, diffuse, specular];
    if products.faults.early != Early::Nothing {
        terms = products.faults.early.terms(terms);
    }
    let [ambient, diffuse, specular] = terms;
    if !products.signed {
        return [ambient, diffuse, specular];
    }
    // Finite, so that no sum meets two infinities; and +0, so that a term that is left out changes no bit.
    [bounded(ambient), bounded(diffuse), bounded(specular)]
}

/// Limited to the finite numbers; -0 becomes +0.
#[inline(always)]
fn bounded<L: Lanes>(x: L) -> L {
    let most = L::splat(L::Scalar::MAX);
    x.min(most).max(-most) + L::splat(L::Scalar::ZERO)
}
