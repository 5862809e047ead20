//! Single routines of the rasterizer on bare numbers: coverage, interpolation weights and depth order, for tests and for
//! anybody who wants to check them. They call what [`super::Plan`] calls.

use super::attribute::Weights;
use super::bin::{SampleBox, TILE, TileGrid};
use super::setup::{Builder, DepthOrder};
use super::tile::{Planes, Samples, Visibility};
use super::view::{Vertex, View};
use super::{Counters, edges};
use crate::frame::NONE;
use crate::sampling::SUBPIXEL;
use crate::scene::{Cull, Snap};

/// Covered pixels of one row: from `x0` to `x1`, both included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Run {
    /// Row.
    pub y: i64,
    /// First covered column.
    pub x0: i64,
    /// Last covered column.
    pub x1: i64,
}

/// The pixels whose centres a triangle owns, within the rectangle of `size` pixels from `origin`.
///
/// The triangle is given in pixel coordinates, y down, and is filled whichever way it winds. Vertices snap first, half to
/// even. Rows from top to bottom.
///
/// ```
/// use rastray::raster::{Run, coverage};
/// use rastray::scene::Snap;
/// let runs = coverage([[0.5, 0.5], [2.5, 0.5], [0.5, 2.5]], [0, 0], [8, 8], Snap::Bits8);
/// assert_eq!(runs, [Run { y: 0, x0: 0, x1: 1 }, Run { y: 1, x0: 0, x1: 0 }]);
/// ```
pub fn coverage(
    triangle_px: [[f64; 2]; 3],
    origin: [i64; 2],
    size: [u32; 2],
    snap: Snap,
) -> Vec<Run> {
    let corners = triangle_px.map(|[x, y]| Vertex {
        x,
        y,
        w: 1.0,
        distance: 1.0,
    });
    covered(&View::pixels(snap), corners, origin, size)
}

/// The pixels that a triangle in clip space (x, y, z, w) owns in a picture of `size`, clipped at the near plane z + w = 0.
pub fn coverage_clip_space(triangle: [[f64; 4]; 3], size: [u32; 2], snap: Snap) -> Vec<Run> {
    let corners = triangle.map(|[x, y, z, w]| Vertex {
        x,
        y,
        w,
        distance: z + w,
    });
    covered(&View::clip_space(size, snap), corners, [0, 0], size)
}

/// Perspective-correct weights of a triangle's corners (clip x, y, w) on its plane at a place of the picture (ndc x, y).
/// The interpolated w is the weighted sum of the corners' w. `None` where the plane is seen edge-on.
pub fn perspective_weights(corners: [[f64; 3]; 3], place_ndc: [f64; 2]) -> Option<[f64; 3]> {
    Weights::new(corners).on_plane(place_ndc)
}

/// The depth key of a perspective view at a distance along -z: larger = closer.
pub fn depth_key(distance: f64) -> f64 {
    View::pixels(Snap::Bits8).depth_key(&Vertex {
        w: distance,
        distance,
        ..Vertex::default()
    })
}

fn covered(view: &View, corners: [Vertex; 3], origin: [i64; 2], size: [u32; 2]) -> Vec<Run> {
    let grid = TileGrid {
        size: size.map(|n| n as usize),
        origin,
    };
    let center = [i64::from(SUBPIXEL) / 2; 2];
    let samples = SampleBox {
        min: center,
        max: center,
    };
    let mut builder = Builder::new(view, grid, samples, (Cull::None, DepthOrder::Nearest));
    // The way that a picture's triangles take.
    let small = |v: &Vertex| view.snap(v).and_then(edges::small);
    match [0, 1, 2].map(|i| small(&corners[i]).filter(|_| view.holds(&corners[i]))) {
        [Some(a), Some(b), Some(c)] => builder.inside(0, [a, b, c], || corners),
        _ => builder.general(0, corners),
    }
    let chunk = builder.finish();
    let mut runs = Vec::new();
    let mut visibility = Visibility::new(Planes::default());
    for index in 0..grid.count() {
        let area = grid.tile(index);
        let ray = |x: usize, y: usize| {
            let at = |axis: usize, n: usize| (area.place[axis] + n as i64) as f64 + 0.5;
            view.ray([at(0, x), at(1, y)])
        };
        let x: Vec<f64> = (0..area.size[0]).map(|x| ray(x, 0)[0]).collect();
        let y: Vec<f64> = (0..area.size[1]).map(|y| ray(0, y)[1]).collect();
        let samples = Samples::Shared {
            offset: center,
            x: &x,
            y: &y,
        };
        visibility.clear();
        for triangle in chunk.of_tile(index) {
            let counters = &mut Counters::default();
            visibility.draw(&area, &samples, view.bits, triangle, counters);
        }
        for y in 0..area.size[1] {
            let row = &visibility.primitive[y * TILE..y * TILE + area.size[0]];
            add_runs(&mut runs, row, area.place, y);
        }
    }
    join(runs)
}

/// Appends the runs of one row of a tile.
fn add_runs(runs: &mut Vec<Run>, row: &[u32], place: [i64; 2], y: usize) {
    let y = place[1] + y as i64;
    let mut open = false;
    for (x, primitive) in row.iter().enumerate() {
        let x = place[0] + x as i64;
        match (*primitive != NONE, open) {
            (true, false) => runs.push(Run { y, x0: x, x1: x }),
            (true, true) => {
                if let Some(last) = runs.last_mut() {
                    last.x1 = x;
                }
            }
            _ => {}
        }
        open = *primitive != NONE;
    }
}

/// Puts the runs of neighbouring tiles in order and joins those that touch.
fn join(mut runs: Vec<Run>) -> Vec<Run> {
    runs.sort_by_key(|run| (run.y, run.x0));
    let mut joined: Vec<Run> = Vec::with_capacity(runs.len());
    for run in runs {
        match joined.last_mut() {
            Some(last) if last.y == run.y && last.x1 + 1 == run.x0 => last.x1 = run.x1,
            _ => joined.push(run),
        }
    }
    joined
}
