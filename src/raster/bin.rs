//! Triangles that are ready to be filled, listed tile by tile, and the tiles themselves.
//!
//! In: what `setup` made of consecutive primitives. Out: for each tile its triangles in primitive order, with what decides
//! their coverage.

use super::Counters;
use super::sides::Sides;

/// Side of a screen tile in pixels.
pub(super) const TILE: usize = 64;

/// The picture cut into tiles.
#[derive(Clone, Copy, Debug)]
pub(super) struct TileGrid {
    /// Picture width and height in pixels.
    pub(super) size: [usize; 2],
    /// First pixel of the picture in the pixel frame of the vertices.
    pub(super) origin: [i64; 2],
}

impl TileGrid {
    /// Columns of tiles.
    pub(super) fn columns(&self) -> usize {
        self.size[0].div_ceil(TILE)
    }

    /// Rows of tiles.
    pub(super) fn rows(&self) -> usize {
        self.size[1].div_ceil(TILE)
    }

    /// Number of tiles.
    pub(super) fn count(&self) -> usize {
        self.columns() * self.rows()
    }

    /// First pixel and size of a tile.
    pub(super) fn tile(&self, index: usize) -> TileArea {
        let corner = [index % self.columns() * TILE, index / self.columns() * TILE];
        let size = [0, 1].map(|axis| TILE.min(self.size[axis] - corner[axis]));
        TileArea {
            corner,
            place: [0, 1].map(|axis| self.origin[axis] + corner[axis] as i64),
            size,
        }
    }
}

/// One tile.
#[derive(Clone, Copy, Debug)]
pub(super) struct TileArea {
    /// First pixel in the picture.
    pub(super) corner: [usize; 2],
    /// First pixel in the pixel frame of the vertices.
    pub(super) place: [i64; 2],
    /// Width and height in pixels, at most [`TILE`].
    pub(super) size: [usize; 2],
}

/// Where samples lie within any pixel, in 1/256 px: the box around them all.
#[derive(Clone, Copy, Debug)]
pub(super) struct SampleBox {
    /// Least offset in x and y.
    pub(super) min: [i64; 2],
    /// Greatest offset in x and y.
    pub(super) max: [i64; 2],
}

/// A triangle ready to be filled: 64 bytes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Binned {
    /// Snapped x; or `BY_SIDES`, and the first and last column of the picture that it may meet.
    pub(super) x: [i32; 3],
    /// Snapped y; or an index into `Chunk::sides`, and the first and last row.
    pub(super) y: [i32; 3],
    /// k0, kx, ky of the depth key.
    pub(super) key: [f64; 3],
    /// Least and greatest key.
    pub(super) range: [f32; 2],
    /// Primitive number.
    pub(super) primitive: u32,
}

/// Marks a triangle whose coverage its sides decide.
pub(super) const BY_SIDES: i32 = i32::MIN;

/// How the coverage of a triangle is decided.
#[derive(Clone, Copy, Debug)]
pub(super) enum Form<'a> {
    /// By the integers of its snapped vertices.
    Snapped([[i64; 2]; 3]),
    /// By its sides.
    Sides {
        /// The sides.
        sides: &'a Sides,
        /// First column and row of the picture that it may meet.
        first: [i32; 2],
        /// Last column and row.
        last: [i32; 2],
    },
}

/// Consecutive primitives, set up and binned.
#[derive(Clone, Debug, Default)]
pub(super) struct Chunk {
    /// The triangles that may be seen.
    pub(super) triangles: Vec<Binned>,
    /// Sides of those that need them.
    pub(super) sides: Vec<Sides>,
    /// Per tile, where its part of `items` starts; one more at the end.
    pub(super) offsets: Vec<u32>,
    /// Numbers of triangles, tile by tile, each tile in primitive order.
    pub(super) items: Vec<u32>,
    /// What happened to the primitives.
    pub(super) counters: Counters,
}

impl Chunk {
    /// Whether a tile has triangles.
    pub(super) fn meets_tile(&self, tile: usize) -> bool {
        self.offsets[tile] < self.offsets[tile + 1]
    }

    /// The triangles of a tile in primitive order, with what decides their coverage.
    pub(super) fn of_tile(&self, tile: usize) -> impl Iterator<Item = (&Binned, Form<'_>)> {
        let range = self.offsets[tile] as usize..self.offsets[tile + 1] as usize;
        self.items[range].iter().map(|&i| {
            let triangle = &self.triangles[i as usize];
            (triangle, self.form(triangle))
        })
    }

    #[inline]
    fn form(&self, triangle: &Binned) -> Form<'_> {
        // Written out: closures given to array::map are not inlined here.
        let ([x0, x1, x2], [y0, y1, y2]) = (triangle.x, triangle.y);
        if x0 == BY_SIDES {
            return Form::Sides {
                sides: &self.sides[y0 as usize],
                first: [x1, y1],
                last: [x2, y2],
            };
        }
        Form::Snapped([
            [i64::from(x0), i64::from(y0)],
            [i64::from(x1), i64::from(y1)],
            [i64::from(x2), i64::from(y2)],
        ])
    }
}
