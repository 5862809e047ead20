//! One call of [`super::shade`]: the loop over chunks and lights, around the two parts of the equation.

use std::marker::PhantomData;
use std::ops::Range;

use super::parts::{self, Chunk, Has, Products, Target, Weights};
use super::scratch::Scratch;
use super::vector::finite;
use super::{Counters, Early, Light, Points, Power, Rig, Sink, Visibility};
use crate::gl;
use crate::lanes::{Family, Isa, Kernel, Lanes, Real, dispatch};
use crate::math::Each;
use crate::math::color::Rgb;

/// Points of a chunk where nobody asks for all of them at once.
const CHUNK: usize = 256;

/// One call of [`shade`], entered at an instruction set.
pub(super) struct Call<'a, 'v, R> {
    pub(super) rig: &'a Rig<R>,
    pub(super) material: &'a gl::Material,
    pub(super) points: &'a Points<R>,
    pub(super) visibility: Option<&'v mut dyn Visibility<R>>,
    pub(super) signed: bool,
    pub(super) sink: Sink<'a, R>,
    pub(super) scratch: &'a mut Scratch<R>,
}

/// The calls at both precisions, compiled here and nowhere else.
pub(super) struct Entry<'a, 'v>(PhantomData<(&'a (), &'v ())>);

impl<'a, 'v> Family for Entry<'a, 'v> {
    type Of<R: Real> = (Isa, Call<'a, 'v, R>);
    type Output = Counters;

    #[inline(never)]
    fn at_f32((isa, call): (Isa, Call<'a, 'v, f32>)) -> Counters {
        dispatch(isa, call)
    }

    #[inline(never)]
    fn at_f64((isa, call): (Isa, Call<'a, 'v, f64>)) -> Counters {
        dispatch(isa, call)
    }
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
        let chunk = chunk_of(self.points, &(start..end));
        let n = (end - start) as u64;
        self.constants(start, end);
        let rig = self.rig;
        for (index, (light, live)) in rig.lights.iter().zip(&rig.live).enumerate() {
            if !live {
                continue;
            }
            let products = self.products(light, !chunk.normal_length.is_empty(), start..end);
            if products.has.none() {
                continue;
            }
            counters.light_evaluations += n;
            // Part one.
            let reachable = rig.switches.light_vector || !is_positional(light);
            if reachable && needs_direction(light, products.has) {
                parts::illuminate::<L>(light, &chunk, self.scratch);
                counters.count_light(light, n);
            } else {
                self.scratch.factor.fill(R::ONE);
                self.scratch.n_dot_l.fill(R::ZERO);
            }
            // Visibility.
            let facing = if products.has.shaded() {
                self.query(index)
            } else {
                0
            };
            counters.visibility_queries += facing;
            let asked = facing > 0;
            // Part two.
            self.count_highlights(&products, counters);
            if products.has.shaded() {
                parts::weigh::<L>(&products, &chunk, self.scratch);
            } else {
                self.scratch.diffuse.fill(R::ZERO);
                self.scratch.specular.fill(R::ZERO);
            }
            self.emit::<L>(&products, index, asked, start..end);
        }
        self.finish(start, end);
    }

    /// Emission and scene ambient, the terms that no light scales.
    fn constants(&mut self, start: usize, end: usize) {
        if self.material.tracked.any() {
            return self.tracked_constants(start..end);
        }
        for c in 0..3 {
            let early = self.rig.faults.early;
            let emission = early.constant(finite::<R>(self.material.emission[c]));
            let ambient = self.material.ambient[c] * self.rig.model.ambient[c];
            let ambient = early.constant(finite::<R>(ambient));
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

    /// Material times light; with vertex colours, the scratch lists hold each point's own.
    fn products(
        &mut self,
        light: &Light<R>,
        has_lengths: bool,
        range: Range<usize>,
    ) -> Products<R> {
        let colors = light.colors();
        let multiply = |a: &Rgb, b: &Rgb| [0, 1, 2].each(|c| finite::<R>(a[c] * b[c]));
        let ambient = multiply(&self.material.ambient, &colors.ambient);
        let diffuse = multiply(&self.material.diffuse, &colors.diffuse);
        let specular = multiply(&self.material.specular, &colors.specular);
        let any = |color: [R; 3]| color.into_iter().any(|x| x != R::ZERO);
        let all = [ambient, diffuse, specular];
        let mut has = Has {
            ambient: any(ambient),
            diffuse: any(diffuse),
            specular: any(specular),
        };
        let mut largest = all
            .iter()
            .flatten()
            .fold(1.0f64, |m, x| m.max(x.to_f64().abs()));
        if self.material.tracked.any() {
            largest = largest.max(self.tracked_products(colors, &all, &mut has, range));
        }
        let power = self.rig.switches.power(self.material.shininess);
        let negative_power = matches!(power, Power::Other(s) if s < R::ZERO);
        let may_overflow = largest * light.largest_factor() > R::MAX.to_f64() / 4.0;
        Products {
            ambient,
            diffuse,
            specular,
            has: self.rig.switches.terms(has),
            careful: may_overflow || negative_power || has_lengths,
            signed: self.signed,
            as_is: !self.signed && self.rig.faults.early == Early::Nothing,
            faults: self.rig.faults,
            power,
            model: self.rig.model.specular_model,
        }
    }

    /// Counts the highlights that the points facing a light ask for. Facing is known from part one, so this is one pass
    /// over a list in the nearest cache, made only where there are highlights.
    #[inline(always)]
    fn count_highlights(&self, products: &Products<R>, counters: &mut Counters) {
        if !products.has.specular || products.power == Power::Zero {
            return;
        }
        let n_dot_l = self.scratch.n_dot_l.iter();
        let facing: u32 = n_dot_l.map(|x| u32::from(*x > R::ZERO)).sum();
        counters.half_vectors += u64::from(facing);
        if products.power != Power::One {
            counters.pow_calls += u64::from(facing);
        }
    }

    /// Asks for the visibility of a light where it faces points; says for how many.
    fn query(&mut self, light: usize) -> u64 {
        let Some(visibility) = self.visibility.as_deref_mut() else {
            return 0;
        };
        let scratch = &mut *self.scratch;
        let lit = scratch.n_dot_l.iter().zip(&scratch.factor);
        let ungated = self.rig.faults.ungated_specular;
        for (facing, (n_dot_l, factor)) in scratch.illumination.facing.iter_mut().zip(lit) {
            *facing = (*n_dot_l > R::ZERO || ungated) && *factor != R::ZERO;
        }
        let facing = scratch.illumination.facing.iter().filter(|f| **f).count();
        if facing == 0 {
            return 0;
        }
        for list in &mut scratch.visibility {
            list.fill(R::ONE);
        }
        visibility.query(light, &scratch.illumination, &mut scratch.visibility);
        facing as u64
    }

    /// The terms of one light, into the sink.
    #[inline(always)]
    fn emit<L: Lanes<Scalar = R>>(
        &mut self,
        products: &Products<R>,
        light: usize,
        asked: bool,
        range: Range<usize>,
    ) {
        let Scratch {
            terms,
            wide,
            factor,
            diffuse,
            specular,
            visibility,
            products: of_points,
            ..
        } = &mut *self.scratch;
        let weights = Weights {
            factor,
            diffuse,
            specular,
            visibility: asked.then_some(visibility),
            products: self.material.tracked.any().then_some(of_points),
        };
        let separate = self.rig.model.color_control == gl::ColorControl::SeparateSpecular;
        match &mut self.sink {
            Sink::Record(layers) => {
                if let [a, d, s] = &mut layers[2 + 3 * light..5 + 3 * light] {
                    let lists = [a, d, s].each(|lists| part_mut(lists, &range));
                    parts::emit::<L>(products, &weights, Target::Record(lists));
                }
            }
            sink if self.signed => {
                let all = 0..range.len();
                let [a, d, s] = terms;
                let lists = [&mut *a, &mut *d, &mut *s].each(|lists| part_mut(lists, &all));
                parts::emit::<L>(products, &weights, Target::Record(lists));
                let [first, second] = wide;
                add_wide(first, a);
                add_wide(first, d);
                let split = separate && matches!(sink, Sink::Split(..));
                add_wide(if split { second } else { first }, s);
            }
            Sink::Split(first, second) if separate => {
                let target = Target::Split(part_mut(first, &range), part_mut(second, &range));
                parts::emit::<L>(products, &weights, target);
            }
            Sink::Sum(sum) | Sink::Split(sum, _) => {
                parts::emit::<L>(products, &weights, Target::Sum(part_mut(sum, &range)));
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

impl Counters {
    /// Part one ran for a light and `n` points.
    fn count_light<R>(&mut self, light: &Light<R>, n: u64) {
        let (point, spot) = match light {
            Light::Directional(_) => return,
            Light::Point(point) => (point, None),
            Light::Spot(spot) => (&spot.point, Some(&spot.power)),
        };
        self.light_vector_roots += n;
        self.attenuations += n * u64::from(point.attenuated);
        self.spot_tests += n * u64::from(spot.is_some());
        self.spot_pow_calls += n * u64::from(matches!(spot, Some(Power::Other(_))));
    }
}

fn is_positional<R>(light: &Light<R>) -> bool {
    !matches!(light, Light::Directional(_))
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
fn add_wide<R: Real>(sums: &mut [Vec<f64>; 3], terms: &[Vec<R>; 3]) {
    for (sums, terms) in sums.iter_mut().zip(terms) {
        for (sum, term) in sums.iter_mut().zip(terms) {
            *sum += term.to_f64();
        }
    }
}

/// Some of the points.
fn chunk_of<'a, R: Real>(points: &'a Points<R>, range: &Range<usize>) -> Chunk<'a, R> {
    Chunk {
        position: part(&points.position, range),
        normal: part(&points.normal, range),
        normal_length: points.normal_length.get(range.clone()).unwrap_or(&[]),
        to_viewer: part(&points.to_viewer, range),
    }
}

/// The same range of three lists.
fn part<'a, R>(lists: &'a [Vec<R>; 3], range: &Range<usize>) -> [&'a [R]; 3] {
    let [x, y, z] = lists;
    [&x[range.clone()], &y[range.clone()], &z[range.clone()]]
}

/// [`part`], to be written.
fn part_mut<'a, R>(lists: &'a mut [Vec<R>; 3], range: &Range<usize>) -> [&'a mut [R]; 3] {
    let [x, y, z] = lists;
    [
        &mut x[range.clone()],
        &mut y[range.clone()],
        &mut z[range.clone()],
    ]
}
