//! The equation at one point: terms with the factors that made them, in world space.

use super::value::{Coefficients, Factors, Hit, Light, LightTerms, Terms, Vector};
use crate::frame::LayerIndex;
use crate::gl::{self, SpecularModel};
use crate::lighting::Points;
use crate::math::color::Rgb;
use crate::math::{DMat3, DVec3};
use crate::render::{Precision, Tracer};
use crate::scene::Scene;
use crate::trace::Lamp;
use crate::trace::record::ShadowRecord;

/// What is common to all points of a scene.
pub(super) struct Local<'p> {
    pub(super) scene: &'p Scene,
    pub(super) precision: Precision,
    pub(super) tracer: &'p Tracer<'p>,
    pub(super) world_from_eye: DMat3,
    /// The tracer casts shadow rays.
    pub(super) shadows: bool,
}

/// Where S_L comes from.
pub(super) enum Shadows<'r> {
    /// The rasterizer: 1.
    None,
    /// Shadow rays of one hit with the number of their light.
    Cast(&'r [(usize, ShadowRecord)]),
}

impl Local<'_> {
    /// The background as the renderers hold it.
    pub(super) fn background(&self) -> Rgb {
        self.scene.background().map(|x| self.precision.round(x))
    }

    /// The enabled lights.
    pub(super) fn sources(&self) -> Vec<Light> {
        let pairs = self.scene.enabled_lights().zip(self.tracer.lamps());
        pairs
            .map(|(light, lamp)| Light {
                name: light.name.clone(),
                position: match lamp {
                    Lamp::Point(p) => Some(p.to_array()),
                    Lamp::Direction(_) => None,
                },
                to_light: match lamp {
                    Lamp::Point(_) => None,
                    Lamp::Direction(d) => Some(d.normalize_or_zero().to_array()),
                },
                ambient: light.source.ambient,
                diffuse: light.source.diffuse,
                specular: light.source.specular,
                attenuation: light.source.attenuation,
                spot_cutoff: light.source.spot_cutoff_deg,
                spot_exponent: light.source.spot_exponent,
            })
            .collect()
    }

    /// The terms of values in the order of the layers, without factors.
    pub(super) fn sums(&self, values: &[[f64; 3]]) -> Terms {
        let lights = self.scene.enabled_lights();
        let index = LayerIndex {
            lights: self.tracer.lamps().len(),
        };
        let at = |i: usize| values.get(i).copied().unwrap_or_default();
        Terms {
            emission: at(LayerIndex::EMISSION),
            ambient: at(LayerIndex::AMBIENT),
            lights: lights
                .enumerate()
                .map(|(i, light)| LightTerms {
                    name: light.name.clone(),
                    factors: None,
                    ambient: at(index.light(i)),
                    diffuse: at(index.light(i) + 1),
                    specular: at(index.light(i) + 2),
                })
                .collect(),
            remainder: None,
            material: None,
        }
    }

    /// The terms at a point that the equation was asked for.
    pub(super) fn terms(
        &self,
        material: &gl::Material,
        point: &Points<f64>,
        values: &[[f64; 3]],
        shadows: &Shadows<'_>,
    ) -> Terms {
        let mut terms = self.sums(values);
        let color = |k: usize| point.color[k].first().copied().unwrap_or(1.0);
        let material = material.with_color([color(0), color(1), color(2), 1.0]);
        terms.material = Some(Coefficients {
            emission: material.emission,
            ambient: material.ambient,
            diffuse: material.diffuse,
            specular: material.specular,
            shininess: material.shininess,
        });
        for (light, of_light) in terms.lights.iter_mut().enumerate() {
            of_light.factors = Some(self.factors(light, point, shadows));
        }
        terms
    }

    fn factors(&self, light: usize, point: &Points<f64>, shadows: &Shadows<'_>) -> Factors {
        let seen = self.tracer.anatomy(light, point);
        let highlight = seen.highlight;
        let half = self.scene.light_model.specular_model == SpecularModel::HalfVector;
        let mut factors = Factors {
            to_light: self.direction(seen.to_light),
            distance: seen.distance,
            n_dot_l: seen.n_dot_l,
            n_dot_h: half.then_some(highlight),
            v_dot_r: (!half).then_some(highlight),
            attenuation: seen.attenuation,
            spot: seen.spot,
            ..Factors::default()
        };
        match shadows {
            Shadows::Cast(list) if self.shadows => {
                let found = list.iter().find(|(of, _)| *of == light);
                if let Some((_, record)) = found {
                    self.shadow(record, &mut factors);
                }
            }
            _ => factors.shadow = Some([1.0; 3]),
        }
        factors
    }

    fn shadow(&self, record: &ShadowRecord, factors: &mut Factors) {
        let name = |object: u32| self.scene.objects[object as usize].name.clone();
        factors.shadow = Some(record.lit);
        // The one that blocks is the last to be crossed; those before it let some light through.
        let (blocker, filters) = if record.lit == [0.0; 3] {
            (record.crossed.last(), &record.crossed[..])
        } else {
            (None, &record.crossed[..])
        };
        if let Some((object, t)) = blocker {
            factors.blocker = Some(name(*object));
            let at = record.ray.origin + *t * record.ray.direction;
            factors.blocked_at = Some(at.to_array());
        }
        if self.scene.trace.shadow == crate::scene::Shadow::Filtered {
            factors.filters = filters.iter().map(|(object, _)| name(*object)).collect();
        }
    }

    /// An eye-space direction in world space.
    pub(super) fn direction(&self, v: Vector) -> Vector {
        (self.world_from_eye * DVec3::from_array(v)).to_array()
    }

    /// An eye-space point in world space.
    pub(super) fn place(&self, p: Vector) -> Vector {
        (self.scene.camera.eye + self.world_from_eye * DVec3::from_array(p)).to_array()
    }

    /// The normal of a lit point, world space.
    pub(super) fn normal(&self, point: &Points<f64>) -> Vector {
        self.direction(first(&point.normal))
    }

    /// What is at a place that a ray meets.
    pub(super) fn hit(&self, place: &Place) -> Hit {
        let arriving = place.direction.normalize_or_zero();
        let normal = DVec3::from_array(place.normal);
        Hit {
            t: place.t,
            distance: place.t * place.direction.length(),
            point: place.point,
            normal: place.normal,
            inside: place.inside,
            back: place.back,
            incidence_deg: angle_deg(arriving, normal),
            object: self.scene.objects[place.object as usize].name.clone(),
            material: self.scene.materials[place.material as usize].name.clone(),
            triangle: place.triangle,
        }
    }
}

/// A hit in numbers.
pub(super) struct Place {
    pub(super) t: f64,
    pub(super) direction: DVec3,
    pub(super) point: Vector,
    pub(super) normal: Vector,
    pub(super) inside: bool,
    pub(super) back: bool,
    pub(super) object: u32,
    pub(super) material: u32,
    pub(super) triangle: Option<u32>,
}

/// Angle between a line and a normal, 0 to 90 degrees; good near both ends.
pub(super) fn angle_deg(direction: DVec3, normal: DVec3) -> f64 {
    let (sine, cosine) = (direction.cross(normal).length(), direction.dot(normal));
    libm::atan2(sine, cosine.abs()).to_degrees()
}

/// The only point of three lists.
pub(super) fn first(lists: &[Vec<f64>; 3]) -> Vector {
    [0, 1, 2].map(|k: usize| lists[k].first().copied().unwrap_or(0.0))
}

/// The sum of local terms as far as f64 goes; for rays whose own colour no picture holds.
pub(super) fn local_sum(terms: &Terms) -> Rgb {
    let mut sum = [0.0; 3];
    let lights = terms.lights.iter();
    let of_lights = lights.flat_map(|l| [l.ambient, l.diffuse, l.specular]);
    for term in [terms.emission, terms.ambient].into_iter().chain(of_lights) {
        for (sum, x) in sum.iter_mut().zip(term) {
            *sum += x;
        }
    }
    sum
}
