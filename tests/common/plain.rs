//! A second opinion: a small tracer of balls over a floor and a small Gouraud rasterizer, written for the tests of `check`
//! from the equation sheets alone, with switches for mistakes. Plain loops in f64; nothing of the crate but its vectors.

use rastray::math::DVec3;

/// Red, green, blue.
pub(crate) type Rgb = [f64; 3];

/// What a surface is made of.
#[derive(Clone, Copy)]
pub(crate) struct Matter {
    pub(crate) color: Rgb,
    pub(crate) specular: f64,
    pub(crate) shininess: f64,
    pub(crate) reflection: f64,
    pub(crate) transmission: f64,
    pub(crate) ior: f64,
}

/// A light: towards it or where it stands, and its colour.
#[derive(Clone, Copy)]
pub(crate) struct Lamp {
    pub(crate) place: DVec3,
    pub(crate) directional: bool,
    pub(crate) color: Rgb,
}

/// Balls (centre, radius, matter) over a horizontal floor (half its side, matter) at y = 0.
pub(crate) struct World {
    pub(crate) eye: DVec3,
    pub(crate) target: DVec3,
    pub(crate) fovy_deg: f64,
    pub(crate) ambient: f64,
    pub(crate) background: Rgb,
    pub(crate) depth: u32,
    pub(crate) lamps: Vec<Lamp>,
    pub(crate) balls: Vec<(DVec3, f64, Matter)>,
    pub(crate) floor: (f64, Matter),
}

/// What is done wrong.
#[derive(Clone, Copy, Default)]
pub(crate) struct Wrong {
    pub(crate) no_offset: bool,
    pub(crate) offset: Option<f64>,
    pub(crate) endless: bool,
    pub(crate) sun_unblocked: bool,
    pub(crate) no_shadows: bool,
    pub(crate) eta_inverted: bool,
    pub(crate) normal_kept: bool,
    pub(crate) ratio_kept: bool,
    pub(crate) far_root: bool,
    pub(crate) first_hit: bool,
    pub(crate) normal_length: bool,
    pub(crate) clamp_light: bool,
    pub(crate) clamp_term: bool,
    pub(crate) unlit_specular: bool,
    pub(crate) once_a_body: bool,
    pub(crate) corner: bool,
    pub(crate) no_aspect: bool,
    pub(crate) fov_across: bool,
    pub(crate) affine: bool,
    pub(crate) clamp_late: bool,
}

/// Where a ray meets something.
struct Meeting {
    point: DVec3,
    /// Outwards; not always of unit length if that is the mistake.
    normal: DVec3,
    matter: Matter,
}

impl World {
    /// The picture, unclamped, top row first.
    pub(crate) fn picture(&self, width: usize, height: usize, wrong: Wrong) -> Vec<[f32; 3]> {
        let forward = (self.target - self.eye).normalize();
        let right = forward.cross(DVec3::Y).normalize();
        let up = right.cross(forward);
        let aspect = width as f64 / height as f64;
        let mut half_height = (self.fovy_deg.to_radians() / 2.0).tan();
        let mut half_width = half_height * aspect;
        if wrong.no_aspect {
            half_width = half_height;
        }
        if wrong.fov_across {
            (half_width, half_height) = (half_height, half_height / aspect);
        }
        let centre = if wrong.corner { 0.0 } else { 0.5 };
        let mut pixels = Vec::new();
        for y in 0..height {
            for x in 0..width {
                let u = (2.0 * (x as f64 + centre) / width as f64 - 1.0) * half_width;
                let v = (1.0 - 2.0 * (y as f64 + centre) / height as f64) * half_height;
                let ray = (forward + right * u + up * v).normalize();
                pixels.push(self.light_along(self.eye, ray, 0, wrong).map(|c| c as f32));
            }
        }
        pixels
    }

    fn light_along(&self, origin: DVec3, ray: DVec3, generation: u32, wrong: Wrong) -> Rgb {
        let Some(m) = self.meet(origin, ray, f64::INFINITY, wrong) else {
            return self.background;
        };
        let outward = m.normal.normalize();
        let inside = ray.dot(outward) > 0.0 && m.matter.transmission > 0.0;
        let facing = if inside && !wrong.normal_kept {
            -m.normal
        } else {
            m.normal
        };
        let mut color = self.direct(&m, facing, -ray, wrong);
        if generation == self.depth {
            return color;
        }
        let normal = if ray.dot(outward) > 0.0 {
            -outward
        } else {
            outward
        };
        if m.matter.reflection > 0.0 {
            let mirrored = ray - normal * (2.0 * ray.dot(normal));
            let from = self.start(m.point, normal, wrong);
            let light = self.light_along(from, mirrored, generation + 1, wrong);
            color = [0, 1, 2].map(|k| color[k] + m.matter.reflection * light[k]);
        }
        if m.matter.transmission > 0.0
            && let Some(refracted) = refracted(ray, outward, inside, m.matter.ior, wrong)
        {
            let side = if refracted.dot(outward) > 0.0 {
                outward
            } else {
                -outward
            };
            let from = self.start(m.point, side, wrong);
            let light = self.light_along(from, refracted, generation + 1, wrong);
            let weight = if wrong.once_a_body && inside {
                1.0
            } else {
                m.matter.transmission
            };
            color = [0, 1, 2].map(|k| color[k] + weight * light[k]);
        }
        color
    }

    /// Where a secondary ray starts.
    fn start(&self, point: DVec3, side: DVec3, wrong: Wrong) -> DVec3 {
        match wrong.offset {
            _ if wrong.no_offset => point.as_vec3().as_dvec3(),
            Some(offset) => point + side * offset,
            None => point + side * 1e-7,
        }
    }

    /// Ambient, and diffuse and specular of every lamp that is seen.
    fn direct(&self, m: &Meeting, normal: DVec3, viewer: DVec3, wrong: Wrong) -> Rgb {
        let mut color = m.matter.color.map(|c| c * self.ambient);
        for lamp in &self.lamps {
            let (to_light, distance) = if lamp.directional {
                (lamp.place.normalize(), f64::INFINITY)
            } else {
                let offset = lamp.place - m.point;
                (offset.normalize(), offset.length())
            };
            if normal.dot(to_light) <= 0.0 || self.blocked(m, to_light, distance, lamp, wrong) {
                continue;
            }
            let term = local(&m.matter, lamp.color, normal, to_light, viewer, wrong);
            color = [0, 1, 2].map(|k| color[k] + term[k]);
        }
        color
    }

    fn blocked(
        &self,
        m: &Meeting,
        to_light: DVec3,
        distance: f64,
        lamp: &Lamp,
        wrong: Wrong,
    ) -> bool {
        if wrong.no_shadows || (wrong.sun_unblocked && lamp.directional) {
            return false;
        }
        let outward = m.normal.normalize();
        let side = if to_light.dot(outward) > 0.0 {
            outward
        } else {
            -outward
        };
        let from = self.start(m.point, side, wrong);
        let (ray, end) = if lamp.directional || wrong.endless {
            (to_light, f64::INFINITY)
        } else {
            ((lamp.place - from).normalize(), distance)
        };
        self.meet(
            from,
            ray,
            end,
            Wrong {
                first_hit: true,
                ..wrong
            },
        )
        .is_some()
    }

    /// The nearest thing on a ray, before `end`.
    fn meet(&self, origin: DVec3, ray: DVec3, end: f64, wrong: Wrong) -> Option<Meeting> {
        let mut nearest = end;
        let mut found = None;
        let (half, matter) = self.floor;
        let t = -origin.y / ray.y;
        let place = origin + ray * t;
        if t > 1e-12 && t < nearest && place.x.abs() <= half && place.z.abs() <= half {
            nearest = t;
            found = Some(Meeting {
                point: place,
                normal: DVec3::Y,
                matter,
            });
        }
        for (centre, radius, matter) in &self.balls {
            if wrong.first_hit && found.is_some() {
                break;
            }
            let offset = origin - *centre;
            let b = offset.dot(ray);
            let root = b * b - (offset.length_squared() - radius * radius);
            if root < 0.0 {
                continue;
            }
            let (t0, t1) = (-b - root.sqrt(), -b + root.sqrt());
            let t = if t0 > 1e-12 && !wrong.far_root {
                t0
            } else {
                t1
            };
            if t > 1e-12 && t < nearest {
                nearest = t;
                let point = origin + ray * t;
                let length = if wrong.normal_length { 1.0 } else { *radius };
                let normal = (point - *centre) / length;
                found = Some(Meeting {
                    point,
                    normal,
                    matter: *matter,
                });
            }
        }
        found
    }
}

/// The refracted direction (whitted.md section 2); none at total internal reflection.
fn refracted(ray: DVec3, outward: DVec3, inside: bool, ior: f64, wrong: Wrong) -> Option<DVec3> {
    let normal = if inside && !wrong.normal_kept {
        -outward
    } else {
        outward
    };
    let mut eta = if inside && !wrong.ratio_kept {
        ior
    } else {
        1.0 / ior
    };
    if wrong.eta_inverted {
        eta = 1.0 / eta;
    }
    let cosine = -ray.dot(normal);
    let square = 1.0 - eta * eta * (1.0 - cosine * cosine);
    (square >= 0.0).then(|| ray * eta + normal * (eta * cosine - square.sqrt()))
}

/// Diffuse and specular of one light, seen and facing (GL's half vector).
fn local(
    m: &Matter,
    light: Rgb,
    normal: DVec3,
    to_light: DVec3,
    viewer: DVec3,
    wrong: Wrong,
) -> Rgb {
    let diffuse = normal.dot(to_light).max(0.0);
    let half = (to_light + viewer).normalize();
    let lit = diffuse > 0.0 || wrong.unlit_specular;
    let highlight = if lit {
        normal.dot(half).max(0.0).powf(m.shininess)
    } else {
        0.0
    };
    let clamped = |yes: bool, x: f64| if yes { x.min(1.0) } else { x };
    [0, 1, 2].map(|k| {
        let diffuse = clamped(wrong.clamp_term, m.color[k] * diffuse * light[k]);
        let specular = clamped(wrong.clamp_term, m.specular * highlight * light[k]);
        clamped(wrong.clamp_light, diffuse + specular)
    })
}

/// Triangles lit at their corners: positions and normals in the world, three numbers a triangle.
pub(crate) struct Mesh {
    pub(crate) positions: Vec<DVec3>,
    pub(crate) normals: Vec<DVec3>,
    pub(crate) triangles: Vec<[usize; 3]>,
    pub(crate) matter: Matter,
}

/// Draws a mesh with Gouraud shading as the world's camera sees it, without clipping: all of it must lie before the eye.
pub(crate) fn gouraud(
    world: &World,
    mesh: &Mesh,
    width: usize,
    height: usize,
    wrong: Wrong,
) -> Vec<[f32; 3]> {
    let forward = (world.target - world.eye).normalize();
    let right = forward.cross(DVec3::Y).normalize();
    let up = right.cross(forward);
    let scale = height as f64 / 2.0 / (world.fovy_deg.to_radians() / 2.0).tan();
    // Pixel x, y (down) and distance of each corner, and its colour.
    let corner = |i: usize| {
        let p = mesh.positions[i];
        let q = p - world.eye;
        let w = q.dot(forward);
        let x = width as f64 / 2.0 + q.dot(right) / w * scale;
        let y = height as f64 / 2.0 - q.dot(up) / w * scale;
        let mut color = mesh.matter.color.map(|c| c * world.ambient);
        for lamp in &world.lamps {
            let to_light = if lamp.directional {
                lamp.place
            } else {
                lamp.place - p
            }
            .normalize();
            let (n, v) = (mesh.normals[i], -q.normalize());
            let term = local(&mesh.matter, lamp.color, n, to_light, v, wrong);
            color = [0, 1, 2].map(|k| color[k] + term[k]);
        }
        let color = color.map(|c| {
            if wrong.clamp_late {
                c
            } else {
                c.clamp(0.0, 1.0)
            }
        });
        (x, y, w, color)
    };
    let corners: Vec<_> = (0..mesh.positions.len()).map(corner).collect();
    let background = world.background.map(|c| c as f32);
    let mut pixels = vec![background; width * height];
    let mut depth = vec![f64::INFINITY; width * height];
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|i| corners[i]);
        let area = (b.0 - a.0) * (c.1 - a.1) - (b.1 - a.1) * (c.0 - a.0);
        for i in 0..width * height {
            let (x, y) = ((i % width) as f64 + 0.5, (i / width) as f64 + 0.5);
            let edge = |p: (f64, f64), q: (f64, f64)| {
                ((q.0 - p.0) * (y - p.1) - (q.1 - p.1) * (x - p.0)) / area
            };
            let (la, lb, lc) = (
                edge((b.0, b.1), (c.0, c.1)),
                edge((c.0, c.1), (a.0, a.1)),
                edge((a.0, a.1), (b.0, b.1)),
            );
            if la < 0.0 || lb < 0.0 || lc < 0.0 {
                continue;
            }
            let inverse = la / a.2 + lb / b.2 + lc / c.2;
            let weights = if wrong.affine {
                [la, lb, lc]
            } else {
                [la / a.2 / inverse, lb / b.2 / inverse, lc / c.2 / inverse]
            };
            if 1.0 / inverse < depth[i] {
                depth[i] = 1.0 / inverse;
                let mixed = [0, 1, 2]
                    .map(|k| weights[0] * a.3[k] + weights[1] * b.3[k] + weights[2] * c.3[k]);
                pixels[i] = mixed.map(|c| c as f32);
            }
        }
    }
    pixels
}
