//! THE lighting equation: one point in, terms out (GL 2.1 section 2.14.1 and the lecture's (V.R)^n).
mod batch;

pub use batch::{Batch, Batches, surface};

use crate::gl;
use crate::lanes::{Isa, Real};

/// Lights resolved for one frame, in eye space.
#[derive(Clone, Debug)]
pub struct Rig<R> {
    lights: Vec<gl::LightSource>,
    model: gl::LightModel,
    _r: std::marker::PhantomData<R>,
}

impl<R: Real> Rig<R> {
    /// Resolves eye-space light sources (the enabled ones, in file order) under a light model.
    pub fn new(lights_eye: &[gl::LightSource], model: &gl::LightModel) -> Self {
        Self {
            lights: lights_eye.to_vec(),
            model: model.clone(),
            _r: std::marker::PhantomData,
        }
    }
    /// How many lights.
    pub fn light_count(&self) -> usize {
        self.lights.len()
    }
}

/// Points to be lit side by side, eye space, structure of arrays.
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

/// What the first part of the equation says of one light, for each point.
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
pub trait Visibility<R> {
    /// Writes S_L (one colour a point) of a light into `out` for the points that `light` faces; others are ignored.
    /// `out` comes in filled with ones.
    fn query(&mut self, light: usize, illumination: &Illumination<R>, out: &mut [Vec<R>; 3]);
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
}

/// Where the terms go: a colour sum, or every term.
pub enum Sink<'a, R> {
    /// The sum of all terms in the stated order (`frame::Layers`), one colour a point.
    Sum(&'a mut [Vec<R>; 3]),
    /// Every term: emission, scene ambient, then for each light ambient, diffuse, specular (as `frame::LayerIndex`).
    Record(&'a mut Vec<[Vec<R>; 3]>),
    /// GL's primary and secondary colour, unclamped (secondary is 0 unless specular is separate).
    Split(&'a mut [Vec<R>; 3], &'a mut [Vec<R>; 3]),
}

/// The equation at some points of one material, with visibility as an input. Output lists are resized to the points.
/// `signed`: some colour of the scene is negative, sums run in f64 and round once.
#[expect(clippy::too_many_arguments)]
pub fn shade<R: Real>(
    _isa: Isa,
    rig: &Rig<R>,
    material: &gl::Material,
    points: &Points<R>,
    mut visibility: Option<&mut dyn Visibility<R>>,
    signed: bool,
    sink: Sink<'_, R>,
) {
    let n = points.len();
    let mut terms =
        vec![[vec![R::ZERO; n], vec![R::ZERO; n], vec![R::ZERO; n]]; 2 + 3 * rig.lights.len()];
    for c in 0..3 {
        terms[0][c].fill(R::from_f64(material.emission[c]));
        terms[1][c].fill(R::from_f64(material.ambient[c] * rig.model.ambient[c]));
    }
    for (k, light) in rig.lights.iter().enumerate() {
        let mut il = Illumination::<R>::default();
        let mut nl = vec![];
        let mut att = vec![];
        for i in 0..n {
            let p = [0, 1, 2].map(|a| points.position[a][i].to_f64());
            let nn = [0, 1, 2].map(|a| points.normal[a][i].to_f64());
            let w = light.position[3];
            let raw = [0, 1, 2].map(|a| {
                if w == 0.0 {
                    light.position[a]
                } else {
                    light.position[a] / w - p[a]
                }
            });
            let (l, d) = crate::math::float::normalize(raw);
            let [a0, a1, a2] = light.attenuation;
            let mut f = if w == 0.0 {
                1.0
            } else {
                1.0 / (a0 + d * (a1 + d * a2))
            };
            if light.spot_cutoff_deg != 180.0 {
                let (s, _) = crate::math::float::normalize(light.spot_direction);
                let q = -crate::math::float::dot(l, s);
                f = if q < libm::cos(light.spot_cutoff_deg.to_radians()) {
                    0.0
                } else {
                    f * libm::pow(q, light.spot_exponent)
                };
            }
            let d = if w == 0.0 { f64::INFINITY } else { d };
            let ndl = crate::math::float::dot(nn, l);
            for a in 0..3 {
                il.to_light[a].push(R::from_f64(l[a]));
            }
            il.distance.push(R::from_f64(d));
            il.facing.push(ndl > 0.0 && f != 0.0);
            nl.push(ndl);
            att.push(f);
        }
        let mut vis = [vec![R::ONE; n], vec![R::ONE; n], vec![R::ONE; n]];
        if let Some(v) = visibility.as_deref_mut() {
            v.query(k, &il, &mut vis);
        }
        for i in 0..n {
            for c in 0..3 {
                let f = att[i];
                terms[2 + 3 * k][c][i] = R::from_f64(material.ambient[c] * light.ambient[c] * f);
                if !il.facing[i] {
                    continue;
                }
                let s = vis[c][i].to_f64();
                let l = [0, 1, 2].map(|a| il.to_light[a][i].to_f64());
                let v = [0, 1, 2].map(|a| points.to_viewer[a][i].to_f64());
                let nn = [0, 1, 2].map(|a| points.normal[a][i].to_f64());
                let (h, _) = crate::math::float::normalize([l[0] + v[0], l[1] + v[1], l[2] + v[2]]);
                let cosine = match rig.model.specular_model {
                    gl::SpecularModel::HalfVector => crate::math::float::dot(nn, h),
                    gl::SpecularModel::Reflection => {
                        2.0 * nl[i] * crate::math::float::dot(nn, v) - crate::math::float::dot(l, v)
                    }
                };
                terms[3 + 3 * k][c][i] =
                    R::from_f64(material.diffuse[c] * light.diffuse[c] * nl[i] * f * s);
                terms[4 + 3 * k][c][i] = R::from_f64(
                    material.specular[c]
                        * light.specular[c]
                        * libm::pow(cosine.max(0.0), material.shininess)
                        * f
                        * s,
                );
            }
        }
    }
    match sink {
        Sink::Record(out) => *out = terms,
        Sink::Split(..) => unimplemented!(),
        Sink::Sum(out) => {
            for c in 0..3 {
                out[c].clear();
            }
            for i in 0..n {
                let rgb = crate::frame::sum_in_order(
                    terms.iter().map(|t| [0, 1, 2].map(|c| t[c][i])),
                    signed,
                );
                for c in 0..3 {
                    out[c].push(rgb[c]);
                }
            }
        }
    }
}
