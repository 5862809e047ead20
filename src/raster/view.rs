//! From eye space to the pixel frame: homogeneous vertices, the window transform, snapping, facing.
//!
//! In: eye-space positions. Out: homogeneous vertices, snapped pixel coordinates (y down), the sign of the facing.
//! GL's clip coordinates are used up to positive factors of a row: x and y stay in scene units (the frustum's half extent
//! enters with the window transform), w is the distance along -z for a perspective view and 1 for an orthographic one, and
//! GL's `z + w >= 0` and `z <= w` (GL 2.1 section 2.12) read `near <= distance <= far`. So the near test, the facing and
//! the attribute weights work on the numbers as stored, and on the very ray that the tracer casts.

use super::edges::SAMPLE_BITS;
use crate::lanes::Real;
use crate::math::{DVec2, DVec4};
use crate::scene::{Camera, FrontFace, Projection, Snap};

/// Largest snapped coordinate, in units: 2^36 px at 8 sub-pixel bits, 2^32 px at 12. Vertices beyond stay as they are.
const GUARD_UNITS: f64 = (1u64 << 44) as f64;

/// A vertex before the division: the picture's place is (x / w, y / w), y up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Vertex {
    /// Rightwards.
    pub(super) x: f64,
    /// Upwards.
    pub(super) y: f64,
    /// Divisor: the distance (perspective) or 1 (orthographic).
    pub(super) w: f64,
    /// Distance along -z, which the near and far planes bound; z + w of clip space under [`Projection::Matrix`].
    pub(super) distance: f64,
}

/// Where the sample at a place of the picture looks.
#[derive(Clone, Debug)]
enum Lens {
    /// Through the camera's own ray.
    Camera(Box<Camera>),
    /// At normalized device coordinates.
    Ndc,
    /// At the place itself.
    Pixels,
}

impl Vertex {
    /// x, y, w.
    pub(super) fn homogeneous(&self) -> [f64; 3] {
        [self.x, self.y, self.w]
    }

    /// All coordinates are finite.
    pub(super) fn is_finite(&self) -> bool {
        // A sum of finite numbers may overflow, so each is asked.
        self.x.is_finite() && self.y.is_finite() && self.w.is_finite() && self.distance.is_finite()
    }
}

/// How eye space becomes snapped pixels: constants of one picture.
#[derive(Clone, Debug)]
pub(super) struct View {
    /// Pixels a unit of x / w and of y / w (negative would flip).
    pub(super) scale: [f64; 2],
    /// Where x / w = 0, y / w = 0 lies in the pixel frame.
    pub(super) center: [f64; 2],
    /// Sub-pixel bits of the snap; those of samples where there is none.
    pub(super) bits: u32,
    /// Vertices snap.
    pub(super) snaps: bool,
    /// Size of the picture in pixels.
    size: [u32; 2],
    lens: Lens,
    /// The divisor is the distance.
    pub(super) perspective: bool,
    /// The far plane is w - z >= 0 of clip space, whatever `far` says.
    clips_far: bool,
    /// Smallest distance drawn.
    pub(super) near: f64,
    /// Largest distance drawn; +infinity where there is none.
    pub(super) far: f64,
    /// +1 where counter-clockwise (y up) is the front, -1 where clockwise is.
    pub(super) front_sign: i32,
}

impl View {
    /// The view of a camera onto a picture of this size.
    pub(super) fn new(camera: &Camera, size: [u32; 2], snap: Snap, front_face: FrontFace) -> Self {
        let [width, height] = size.map(f64::from);
        let half = camera.half_extent(width / height);
        let matrix = matches!(camera.projection, Projection::Matrix { .. });
        Self {
            scale: [width / 2.0 / half.x, height / 2.0 / half.y],
            center: [width / 2.0, height / 2.0],
            bits: snap.bits().unwrap_or(SAMPLE_BITS),
            snaps: snap.bits().is_some(),
            size,
            lens: Lens::Camera(Box::new(*camera)),
            perspective: matches!(camera.projection, Projection::Perspective { .. }),
            clips_far: matrix,
            near: if matrix { 0.0 } else { camera.near },
            far: camera.far.filter(|_| !matrix).unwrap_or(f64::INFINITY),
            front_sign: match front_face {
                FrontFace::Ccw => 1,
                FrontFace::Cw => -1,
            },
        }
    }

    /// The view whose vertices are pixel coordinates (y down) times w, without depth: for coverage on its own.
    pub(super) fn pixels(snap: Snap) -> Self {
        Self {
            scale: [1.0, -1.0],
            center: [0.0; 2],
            bits: snap.bits().unwrap_or(SAMPLE_BITS),
            snaps: snap.bits().is_some(),
            size: [0; 2],
            lens: Lens::Pixels,
            perspective: true,
            clips_far: false,
            near: 0.0,
            far: f64::INFINITY,
            front_sign: 1,
        }
    }

    /// The view of normalized device coordinates onto a picture: for clip-space triangles on their own.
    pub(super) fn clip_space(size: [u32; 2], snap: Snap) -> Self {
        let half = size.map(|n| f64::from(n) / 2.0);
        Self {
            scale: half,
            center: half,
            size,
            lens: Lens::Ndc,
            ..Self::pixels(snap)
        }
    }

    /// An eye-space point, homogeneous.
    pub(super) fn vertex(&self, eye: [f64; 3]) -> Vertex {
        if self.clips_far
            && let Some(clip) = self.clip_coordinates(eye)
        {
            return Vertex {
                x: clip.x,
                y: clip.y,
                w: clip.w,
                distance: clip.z + clip.w,
            };
        }
        let distance = -eye[2];
        Vertex {
            x: eye[0],
            y: eye[1],
            w: if self.perspective { distance } else { 1.0 },
            distance,
        }
    }

    /// Clip coordinates, where the projection is a matrix of its own.
    fn clip_coordinates(&self, [x, y, z]: [f64; 3]) -> Option<DVec4> {
        let Lens::Camera(camera) = &self.lens else {
            return None;
        };
        match camera.projection {
            Projection::Matrix { clip_from_eye } => Some(clip_from_eye * DVec4::new(x, y, z, 1.0)),
            _ => None,
        }
    }

    /// X and Y of the ray through a place of the pixel frame: what weights and depth keys are evaluated at. A vertex lies
    /// on the ray of (x / w, y / w).
    pub(super) fn ray(&self, place: [f64; 2]) -> [f64; 2] {
        let [x, y] = place;
        let [width, height] = self.size.map(f64::from);
        let ndc = || [2.0 * x / width - 1.0, 1.0 - 2.0 * y / height];
        let Lens::Camera(camera) = &self.lens else {
            return match self.lens {
                Lens::Pixels => place,
                _ => ndc(),
            };
        };
        let (origin, direction) = camera.primary_ray(DVec2::new(x, y), self.size[0], self.size[1]);
        match camera.projection {
            Projection::Perspective { .. } => [direction.x, direction.y],
            Projection::Orthographic { .. } => [origin.x, origin.y],
            Projection::Matrix { .. } => ndc(),
        }
    }

    /// Rays are parallel and the key is affine in eye space.
    pub(super) fn is_parallel(&self) -> bool {
        !self.perspective && !self.clips_far
    }

    /// Least and greatest distance along -z of what is drawn; unbounded where a matrix has its own planes.
    pub(super) fn distances(&self) -> [f64; 2] {
        if self.clips_far {
            [f64::NEG_INFINITY, f64::INFINITY]
        } else {
            [self.near, self.far]
        }
    }

    /// Rays count y upwards, against the pixel frame.
    pub(super) fn y_up(&self) -> bool {
        self.scale[1] > 0.0
    }

    /// Whether a vertex lies between near and far.
    pub(super) fn holds(&self, v: &Vertex) -> bool {
        self.inside_near(v) >= 0.0 && self.inside_far(v) >= 0.0
    }

    /// How far before the near plane a vertex lies, in some positive unit; negative = clipped (GL 2.1 section 2.12).
    pub(super) fn inside_near(&self, v: &Vertex) -> f64 {
        v.distance - self.near
    }

    /// How far before the far plane a vertex lies, in some positive unit; negative = clipped; +infinity where there is none.
    pub(super) fn inside_far(&self, v: &Vertex) -> f64 {
        if self.clips_far {
            2.0 * v.w - v.distance
        } else {
            self.far - v.distance
        }
    }

    /// Pixel coordinates, y down, of a vertex with w > 0; not finite where the division overflows.
    pub(super) fn pixel(&self, v: &Vertex) -> [f64; 2] {
        [
            self.center[0] + v.x / v.w * self.scale[0],
            self.center[1] - v.y / v.w * self.scale[1],
        ]
    }

    /// Pixel coordinates snapped to the sub-pixel grid, half to even; `None` without a grid, beyond +-2^44 units, or where
    /// w <= 0.
    pub(super) fn snap(&self, v: &Vertex) -> Option<[i64; 2]> {
        let unit = self.unit() as f64;
        let [x, y] = self.pixel(v).map(|p| p * unit);
        let limit = GUARD_UNITS;
        // Comparisons with NaN are false, so what is not finite is refused, too.
        (self.snaps && v.w > 0.0 && x.abs() <= limit && y.abs() <= limit)
            .then(|| [round_half_even(x), round_half_even(y)])
    }

    /// Snapped units a pixel.
    pub(super) fn unit(&self) -> i64 {
        1 << self.bits
    }

    /// Larger = closer, and affine in the picture: 1 / distance (perspective; reversed, infinite far) or -distance;
    /// -(z / w + 1) of clip space under a matrix.
    pub(super) fn depth_key(&self, v: &Vertex) -> f64 {
        if self.perspective {
            1.0 / v.w
        } else {
            -v.distance / v.w
        }
    }

    /// The key's numerator: the key is this over w.
    pub(super) fn depth_numerator(&self, v: &Vertex) -> f64 {
        if self.perspective { 1.0 } else { -v.distance }
    }
}

/// Rounds to the nearest integer, ties to even; exact for |x| < 2^51.
fn round_half_even(x: f64) -> i64 {
    const MAGIC: f64 = 6_755_399_441_055_744.0; // 1.5 * 2^52: the sum has no bits below 1
    ((x + MAGIC) - MAGIC) as i64
}

/// A positive multiple with largest component about 1: signs stay, products keep within range.
pub(super) fn scaled(h: [f64; 3]) -> [f64; 3] {
    let largest = h[0].abs().max(h[1].abs()).max(h[2].abs());
    let (down, _) = largest.power_of_two_scale();
    h.map(|x| x * down)
}

/// Sign of the window-space area of a triangle seen from its visible side, y up: +1 counter-clockwise, -1 clockwise,
/// 0 edge-on. Exact on the numbers given.
///
/// It is the sign of det(x, y, w) (GL 2.1 section 3.5.1 asks the area of the projected triangle; the determinant is that area
/// times w0 w1 w2, and stays right where some w <= 0 is about to be clipped away: Olano and Greer 1997).
pub(super) fn orientation(h: [[f64; 3]; 3]) -> i32 {
    let [a, b, c] = h;
    let mut det = 0.0;
    let mut permanent = 0.0;
    for (i, j, k) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
        let (p, q) = (b[j] * c[k], b[k] * c[j]);
        det += a[i] * (p - q);
        permanent += a[i].abs() * (p.abs() + q.abs());
    }
    // Each of the six products passes at most 5 roundings; 8 covers them and those of the bound itself. What leaves the
    // range of f64 is decided on positive multiples.
    if det.abs() > permanent * (8.0 * f64::EPSILON) && permanent > f64::MIN_POSITIVE / f64::EPSILON
    {
        sign(det)
    } else {
        exact_orientation([scaled(a), scaled(b), scaled(c)])
    }
}

fn sign(x: f64) -> i32 {
    i32::from(x > 0.0) - i32::from(x < 0.0)
}

/// The sign of a 3 x 3 determinant from its 24 exact partial products, summed as a non-overlapping expansion
/// (Shewchuk 1997). Exact unless a product leaves the range of f64: rows are [`scaled`], so only components that are 1e-100
/// of their row's largest can do that.
fn exact_orientation(h: [[f64; 3]; 3]) -> i32 {
    let [a, b, c] = h;
    let mut expansion: Vec<f64> = Vec::with_capacity(24);
    let mut add = |term: f64| {
        let mut carry = term;
        for part in &mut expansion {
            let (sum, error) = two_sum(carry, *part);
            *part = error;
            carry = sum;
        }
        expansion.push(carry);
    };
    for (i, j, k) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
        for (p, q, s) in [(j, k, 1.0), (k, j, -1.0)] {
            let (high, low) = two_prod(a[i] * s, b[p]);
            for factor in [low, high] {
                let (high, low) = two_prod(factor, c[q]);
                add(low);
                add(high);
            }
        }
    }
    let largest = expansion.iter().rev().find(|x| **x != 0.0);
    largest.map_or(0, |x| sign(*x))
}

fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let s = a + b;
    let bb = s - a;
    (s, (a - (s - bb)) + (b - bb))
}

fn two_prod(a: f64, b: f64) -> (f64, f64) {
    let p = a * b;
    (p, a.mul_add(b, -p))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_is_half_to_even() {
        for (x, n) in [
            (0.5, 0),
            (1.5, 2),
            (2.5, 2),
            (-0.5, 0),
            (-1.5, -2),
            (3.49, 3),
        ] {
            assert_eq!(round_half_even(x), n, "{x}");
        }
        assert_eq!(round_half_even(17_592_186_044_415.5), 17_592_186_044_416);
    }

    #[test]
    fn orientation_is_exact_where_rounding_is_not() {
        // Collinear points on a line that f64 holds exactly, one of them moved by the smallest step.
        let line = |t: f64| [1.0 + t * 3.0, 2.0 + t * 5.0, 1.0];
        let (a, b) = (line(0.0), line(1e6));
        assert_eq!(orientation([a, b, line(12345.0)]), 0);
        let mut c = line(12345.0);
        c[1] = c[1].next_up();
        assert_eq!(orientation([a, b, c]), 1);
        c[1] = line(12345.0)[1].next_down();
        assert_eq!(orientation([a, b, c]), -1);
        assert_eq!(orientation([b, a, c]), 1);
    }

    #[test]
    fn facing_survives_vertices_behind_the_eye() {
        // The plane y = -1 seen from above: the part in front is counter-clockwise whichever corner lies behind.
        let front = [[-1.0, -1.0, 2.0], [1.0, -1.0, 2.0], [0.0, -1.0, 9.0]];
        let behind = [[-1.0, -1.0, -2.0], [1.0, -1.0, -2.0], [0.0, -1.0, 9.0]];
        assert_eq!(orientation(front), 1);
        assert_eq!(orientation(behind), 1);
    }
}
