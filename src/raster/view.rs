//! From eye space to the pixel frame: homogeneous vertices, the window transform, snapping, facing.
//!
//! In: eye-space positions. Out: homogeneous vertices, snapped pixel coordinates (y down), the sign of the facing.
//! GL's clip coordinates are used up to positive factors of a row: x and y stay in scene units (the frustum's half extent
//! enters with the window transform), w is the distance along -z for a perspective view and 1 for an orthographic one, and
//! GL's `z + w >= 0` and `z <= w` (GL 2.1 section 2.12) read `near <= distance <= far`. So the near test, the facing and
//! the attribute weights work on the numbers as stored, and on the very ray that the tracer casts. A camera that is a
//! projection matrix gives clip x (times the aspect) and y instead; where the matrix is neither a frustum nor
//! a box ([`Form::General`]), z + w >= 0 and z - w <= 0 take the place of the distance and its bounds.

use crate::scene::projection::{Form, Lens};
use crate::scene::{Camera, FrontFace, Projection, Snap};

/// Guard band in snapped units: beyond it x and y are clipped, so that the integers of `edges` cannot overflow.
/// 2^36 px at 8 sub-pixel bits, 2^32 px at 12.
pub(super) const GUARD_UNITS: f64 = (1u64 << 44) as f64;

/// A vertex before the division: the picture's place is (x / w, y / w), y up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Vertex {
    /// Rightwards.
    pub(super) x: f64,
    /// Upwards.
    pub(super) y: f64,
    /// Divisor: the distance (perspective) or 1 (orthographic).
    pub(super) w: f64,
    /// Distance along -z, or z + w: what the near plane bounds.
    pub(super) distance: f64,
    /// Distance along -z, or z - w: what the far plane bounds.
    pub(super) reach: f64,
}

impl Vertex {
    /// x, y, w.
    pub(super) fn homogeneous(&self) -> [f64; 3] {
        [self.x, self.y, self.w]
    }

    /// All coordinates are finite.
    pub(super) fn is_finite(&self) -> bool {
        // A sum of finite numbers may overflow, so each is asked.
        self.x.is_finite()
            && self.y.is_finite()
            && self.w.is_finite()
            && self.distance.is_finite()
            && self.reach.is_finite()
    }
}

/// How eye space becomes snapped pixels: constants of one picture.
#[derive(Clone, Debug)]
pub(super) struct View {
    /// Pixels a unit of x / w and of y / w (negative would flip).
    pub(super) scale: [f64; 2],
    /// Where x / w = 0, y / w = 0 lies in the pixel frame.
    pub(super) center: [f64; 2],
    /// Sub-pixel bits of the snap.
    pub(super) bits: u32,
    /// What a depth key is made of.
    pub(super) form: Form,
    /// The camera's matrix, where it has one.
    lens: Option<Lens>,
    /// Smallest [`Vertex::distance`] drawn.
    pub(super) near: f64,
    /// Largest [`Vertex::reach`] drawn; +infinity where there is none.
    pub(super) far: f64,
    /// +1 where counter-clockwise (y up) is the front, -1 where clockwise is.
    pub(super) front_sign: i32,
}

impl View {
    /// The view of a camera onto a picture of this size.
    pub(super) fn new(camera: &Camera, size: [u32; 2], snap: Snap, front_face: FrontFace) -> Self {
        let [width, height] = size.map(f64::from);
        let half = camera.half_extent(width / height);
        // Square pixels: the nearest place of an outline is nearest in the picture.
        let lens = camera.lens().map(|mut lens| {
            lens.rows[0] *= width / height;
            lens
        });
        let form = match camera.projection {
            Projection::Perspective { .. } => Form::Perspective,
            Projection::Orthographic { .. } => Form::Orthographic,
            Projection::Matrix { .. } => lens.map_or(Form::General, |lens| lens.form),
        };
        let [near, far] = match (form, &lens) {
            (Form::General, _) => [0.0, 0.0],
            (_, Some(lens)) => lens.bounds,
            (_, None) => [camera.near, camera.far.unwrap_or(f64::INFINITY)],
        };
        Self {
            scale: [width / 2.0 / half.x, height / 2.0 / half.y],
            center: [width / 2.0, height / 2.0],
            bits: snap.bits(),
            form,
            lens,
            near,
            far,
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
            bits: snap.bits(),
            form: Form::Perspective,
            lens: None,
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
            ..Self::pixels(snap)
        }
    }

    /// An eye-space point, homogeneous.
    pub(super) fn vertex(&self, eye: [f64; 3]) -> Vertex {
        if let Some(lens) = &self.lens {
            return self.through(lens, eye);
        }
        let distance = -eye[2];
        Vertex {
            x: eye[0],
            y: eye[1],
            w: match self.form {
                Form::Orthographic => 1.0,
                Form::Perspective | Form::General => distance,
            },
            distance,
            reach: distance,
        }
    }

    /// An eye-space point through a projection matrix.
    fn through(&self, lens: &Lens, eye: [f64; 3]) -> Vertex {
        let [x, y, z, w] = lens.clip(eye);
        let distance = -eye[2];
        let (w, distance, reach) = match self.form {
            Form::Perspective => (distance, distance, distance),
            Form::Orthographic => (1.0, distance, distance),
            Form::General => (w, z + w, z - w),
        };
        Vertex {
            x,
            y,
            w,
            distance,
            reach,
        }
    }

    /// Pixel coordinates, y down, of a vertex with w > 0; not finite where the division overflows.
    pub(super) fn pixel(&self, v: &Vertex) -> [f64; 2] {
        [
            self.center[0] + v.x / v.w * self.scale[0],
            self.center[1] - v.y / v.w * self.scale[1],
        ]
    }

    /// Pixel coordinates snapped to the sub-pixel grid, half to even; `None` beyond the guard band or where w <= 0.
    pub(super) fn snap(&self, v: &Vertex) -> Option<[i64; 2]> {
        let unit = self.unit() as f64;
        let [x, y] = self.pixel(v).map(|p| p * unit);
        let limit = GUARD_UNITS;
        // Comparisons with NaN are false, so what is not finite is refused, too.
        (v.w > 0.0 && x.abs() <= limit && y.abs() <= limit)
            .then(|| [round_half_even(x), round_half_even(y)])
    }

    /// Snapped units a pixel.
    pub(super) fn unit(&self) -> i64 {
        1 << self.bits
    }

    /// The least and the greatest distance along -z that the picture can show.
    pub(super) fn depth_bounds(&self) -> [f64; 2] {
        match self.form {
            Form::General => [f64::NEG_INFINITY, f64::INFINITY],
            Form::Perspective | Form::Orthographic => [self.near, self.far],
        }
    }

    /// Larger = closer, and affine in the picture: 1 / distance (perspective; reversed, infinite far), -distance
    /// (orthographic), or (w - z) / w.
    pub(super) fn depth_key(&self, v: &Vertex) -> f64 {
        match self.form {
            Form::Perspective => 1.0 / v.w,
            Form::Orthographic => -v.distance,
            Form::General => -v.reach / v.w,
        }
    }
}

/// Rounds to the nearest integer, ties to even; exact for |x| < 2^51.
fn round_half_even(x: f64) -> i64 {
    const MAGIC: f64 = 6_755_399_441_055_744.0; // 1.5 * 2^52: the sum has no bits below 1
    ((x + MAGIC) - MAGIC) as i64
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
    // Each of the six products passes at most 5 roundings; 8 covers them and those of the bound itself.
    if det.abs() > permanent * (8.0 * f64::EPSILON) {
        sign(det)
    } else {
        exact_orientation(h)
    }
}

fn sign(x: f64) -> i32 {
    i32::from(x > 0.0) - i32::from(x < 0.0)
}

/// The sign of a 3 x 3 determinant from its 24 exact partial products, summed as a non-overlapping expansion
/// (Shewchuk 1997). Exact unless a product leaves the range of f64.
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
