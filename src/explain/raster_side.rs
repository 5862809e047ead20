//! The rasterizer's side of a pixel: the surface that is seen, its vertices, and what is blended over it.

use super::Explainer;
use super::local::{Place, Shadows};
use super::value::{Blended, Hit, Raster, Terms, Vertex};
use crate::error::Error;
use crate::gl::ShadeModel;
use crate::math::{DVec2, DVec3};
use crate::raster::record::{LitPoint, Record, Seen};

impl Explainer<'_> {
    /// What the rasterizer does for a pixel of its unclamped picture.
    pub(super) fn raster_record(&self, pixel: [u32; 2], keep: u32) -> Result<Record<f64>, Error> {
        let options = self.options.raster(self.scene.raster.shading, false, true);
        self.raster.record_pixel(&options, pixel, keep)
    }

    /// The same with names.
    pub(super) fn raster_side(
        &self,
        record: &Record<f64>,
        place: [f64; 2],
        stored: [u8; 3],
    ) -> Raster {
        let mut side = Raster {
            color: record.color,
            stored,
            shading: match self.scene.raster.shading {
                ShadeModel::Flat => "flat",
                ShadeModel::Gouraud => "gouraud",
                ShadeModel::Phong => "phong",
            },
            terms: self.background(),
            hit: None,
            vertices: Vec::new(),
            blended: Vec::new(),
            reflection: (),
            refraction: (),
        };
        for seen in &record.surfaces {
            let (terms, hit, vertices) = self.surface(seen, place);
            match seen.alpha {
                None => (side.terms, side.hit, side.vertices) = (terms, Some(hit), vertices),
                Some(alpha) => side.blended.push(Blended {
                    alpha,
                    color: seen.color,
                    terms,
                    hit,
                    vertices,
                }),
            }
        }
        side
    }

    /// The background as terms.
    fn background(&self) -> Terms {
        let local = self.local();
        let mut terms = local.sums(&[]);
        terms.emission = local.background();
        terms
    }

    fn surface(&self, seen: &Seen<f64>, place: [f64; 2]) -> (Terms, Hit, Vec<Vertex>) {
        let local = self.local();
        let material = self.raster.material(seen.surface);
        let terms_at =
            |p: &LitPoint<f64>| local.terms(material, &p.point, &p.terms, &Shadows::None);
        let hit = self.raster_hit(seen, place);
        let shading = self.scene.raster.shading;
        if shading == ShadeModel::Phong {
            let terms = seen.points.first().map(terms_at).unwrap_or_default();
            return (terms, hit, Vec::new());
        }
        let mut terms = local.sums(&seen.terms);
        terms.remainder = (seen.remainder != [0.0; 3]).then_some(seen.remainder);
        let weights = match shading {
            ShadeModel::Gouraud => seen.weights.to_vec(),
            _ => vec![1.0],
        };
        let vertices = seen.points.iter().zip(weights).map(|(p, weight)| Vertex {
            weight,
            color: p.color,
            point: local.place(super::local::first(&p.point.position)),
            normal: local.normal(&p.point),
            terms: terms_at(p),
        });
        (terms, hit, vertices.collect())
    }

    /// Where the ray through a place of the pixel frame meets the surface.
    fn raster_hit(&self, seen: &Seen<f64>, [x, y]: [f64; 2]) -> Hit {
        let local = self.local();
        let (assembled, image) = (self.assembled, &self.scene.image);
        let primitive = seen.primitive as usize;
        let corners = assembled.triangles()[primitive];
        let corner = |v: u32| DVec3::from_array(assembled.vertex_from_eye(v));
        let [a, b, c] = corners.map(corner);
        // The eye's side of the triangle; the fragment's own normal where it is lit by itself.
        let plane = (b - a).cross(c - a).normalize_or_zero();
        let plane = if plane.dot(a) > 0.0 { -plane } else { plane };
        let per_fragment = self.scene.raster.shading == ShadeModel::Phong;
        let own = seen.points.first().filter(|_| per_fragment);
        let normal = own.map_or(plane.to_array(), |p| local.normal(&p.point));
        let camera = &self.scene.camera;
        let (origin, ray) = camera.primary_ray(DVec2::new(x, y), image.width, image.height);
        let offset = DVec3::from_array(seen.position_eye) - origin;
        let t = offset.dot(ray) / ray.length_squared();
        let object = assembled.objects()[primitive];
        let first = assembled.ranges()[object as usize].start;
        local.hit(&Place {
            t: if t.is_finite() { t } else { 0.0 },
            direction: local.world_from_eye * ray,
            point: local.place(seen.position_eye),
            normal,
            inside: false,
            back: seen.surface % 2 == 1,
            object,
            material: assembled.materials()[primitive],
            triangle: Some(seen.primitive - first),
        })
    }
}
