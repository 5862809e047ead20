//! Begin, vertices, end; vertex arrays; and how GL's polygons become triangles (GL 2.1 sections 2.6, 2.8 and 2.14.7).
//!
//! A mesh here takes the last corner of a triangle as the provoking vertex, so each polygon is cut such that the provoking
//! vertex that GL names comes last in all of its triangles:
//!
//! | mode | polygon i from 0 | provoking vertex | triangles |
//! | - | - | - | - |
//! | triangles | 3i, 3i+1, 3i+2 | 3i+2 | as it is |
//! | strip | i, i+1, i+2; odd ones i+1, i, i+2 | i+2 | as it is |
//! | fan | 0, i+1, i+2 | i+2 | as it is |
//! | quads | a b c d = 4i .. 4i+3 | d | a b d, b c d |
//! | quad strip | a b c d = 2i, 2i+1, 2i+3, 2i+2 | c | a b c, d a c |
//! | polygon | all | 0 | i, i+1, 0 |
//!
//! GL decides facing by the area of the whole polygon; here each triangle decides for itself, which is the same for planar
//! convex polygons, the only ones that GL promises to draw right. Vertices left over are ignored.

use super::{Context, GlError, Unrecordable};
use crate::math::DVec3;

/// What begin draws. GL's points and lines are left out: the program draws polygons.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PrimitiveMode {
    /// GL_TRIANGLES.
    Triangles,
    /// GL_TRIANGLE_STRIP.
    TriangleStrip,
    /// GL_TRIANGLE_FAN.
    TriangleFan,
    /// GL_QUADS.
    Quads,
    /// GL_QUAD_STRIP.
    QuadStrip,
    /// GL_POLYGON.
    Polygon,
}

impl PrimitiveMode {
    /// The name in reports.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Triangles => "triangles",
            Self::TriangleStrip => "triangle strip",
            Self::TriangleFan => "triangle fan",
            Self::Quads => "quads",
            Self::QuadStrip => "quad strip",
            Self::Polygon => "polygon",
        }
    }

    /// The triangles of `count` vertices, provoking vertex last.
    pub(super) fn triangles(self, count: u32) -> Vec<[u32; 3]> {
        let beyond_two = count.saturating_sub(2);
        match self {
            Self::Triangles => (0..count / 3)
                .map(|i| [3 * i, 3 * i + 1, 3 * i + 2])
                .collect(),
            Self::TriangleStrip => (0..beyond_two)
                .map(|i| {
                    if i % 2 == 0 {
                        [i, i + 1, i + 2]
                    } else {
                        [i + 1, i, i + 2]
                    }
                })
                .collect(),
            Self::TriangleFan => (0..beyond_two).map(|i| [0, i + 1, i + 2]).collect(),
            Self::Quads => (0..count / 4)
                .map(|i| [4 * i, 4 * i + 1, 4 * i + 2, 4 * i + 3])
                .flat_map(|[a, b, c, d]| [[a, b, d], [b, c, d]])
                .collect(),
            Self::QuadStrip => (0..beyond_two / 2)
                .map(|i| [2 * i, 2 * i + 1, 2 * i + 3, 2 * i + 2])
                .flat_map(|[a, b, c, d]| [[a, b, c], [d, a, c]])
                .collect(),
            Self::Polygon => (0..beyond_two).map(|i| [i + 1, i + 2, 0]).collect(),
        }
    }
}

/// A vertex array (glEnableClientState).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Array {
    /// GL_VERTEX_ARRAY.
    Vertex,
    /// GL_NORMAL_ARRAY.
    Normal,
    /// GL_COLOR_ARRAY.
    Color,
}

/// One vertex array: its numbers, so many a vertex.
#[derive(Clone, Debug, Default)]
pub(super) struct Pointer {
    size: usize,
    data: Vec<f64>,
    enabled: bool,
}

impl Pointer {
    /// The components of an element, missing ones from `rest`; `None` where the array ends before it.
    fn element(&self, index: usize, rest: [f64; 4]) -> Option<[f64; 4]> {
        let start = index.checked_mul(self.size)?;
        let given = self.data.get(start..start.checked_add(self.size)?)?;
        let mut element = rest;
        element[..self.size].copy_from_slice(given);
        (self.size > 0).then_some(element)
    }
}

impl Context {
    /// glBegin. Error `InvalidOperation` between begin and end.
    pub fn begin(&mut self, mode: PrimitiveMode) {
        if self.outside() {
            self.open = Some(mode);
            self.batch.clear();
        }
    }

    /// glEnd: the polygons join the picture. Error `InvalidOperation` without begin.
    pub fn end(&mut self) {
        match self.open.take() {
            Some(mode) => self.record(mode),
            None => self.error(GlError::InvalidOperation),
        }
    }

    /// glVertex2: z = 0, w = 1.
    pub fn vertex2(&mut self, x: f64, y: f64) {
        self.vertex4(x, y, 0.0, 1.0);
    }

    /// glVertex3: w = 1.
    pub fn vertex3(&mut self, x: f64, y: f64, z: f64) {
        self.vertex4(x, y, z, 1.0);
    }

    /// glVertex4: a vertex with the current normal, colour and material. Outside of begin and end it does nothing (GL leaves
    /// that undefined). w must be above 0.
    pub fn vertex4(&mut self, x: f64, y: f64, z: f64, w: f64) {
        if self.open.is_none() {
            return;
        }
        if w.is_nan() || w <= 0.0 {
            return self.refuse(Unrecordable::VertexW(w));
        }
        self.push_vertex(DVec3::new(x / w, y / w, z / w));
    }

    /// glNormal3: the current normal.
    pub fn normal3(&mut self, x: f64, y: f64, z: f64) {
        self.normal = DVec3::new(x, y, z);
    }

    /// glColor3: the current colour, alpha 1.
    pub fn color3(&mut self, red: f64, green: f64, blue: f64) {
        self.color4(red, green, blue, 1.0);
    }

    /// glColor4: the current colour; material terms that follow it change at once.
    pub fn color4(&mut self, red: f64, green: f64, blue: f64, alpha: f64) {
        self.color = [red, green, blue, alpha];
        self.follow_color();
    }

    /// The current colour (GL_CURRENT_COLOR).
    pub fn current_color(&self) -> [f64; 4] {
        self.color
    }

    /// The current normal (GL_CURRENT_NORMAL).
    pub fn current_normal(&self) -> [f64; 3] {
        self.normal.to_array()
    }

    /// glEnableClientState.
    pub fn enable_client_state(&mut self, array: Array) {
        self.pointer(array).enabled = true;
    }

    /// glDisableClientState.
    pub fn disable_client_state(&mut self, array: Array) {
        self.pointer(array).enabled = false;
    }

    /// glVertexPointer with 2, 3 or 4 numbers a vertex (else `InvalidValue`), tightly packed. The numbers are copied here,
    /// where GL reads them when it draws.
    pub fn vertex_pointer<T: Copy + Into<f64>>(&mut self, size: usize, data: &[T]) {
        self.set_pointer(Array::Vertex, 2..=4, size, data);
    }

    /// glNormalPointer: three numbers a vertex.
    pub fn normal_pointer<T: Copy + Into<f64>>(&mut self, data: &[T]) {
        self.set_pointer(Array::Normal, 3..=3, 3, data);
    }

    /// glColorPointer with 3 or 4 numbers a vertex (else `InvalidValue`), 1 = full.
    pub fn color_pointer<T: Copy + Into<f64>>(&mut self, size: usize, data: &[T]) {
        self.set_pointer(Array::Color, 3..=4, size, data);
    }

    /// glDrawArrays: `count` vertices from number `first`. Error `InvalidValue` where an array is shorter; nothing is drawn.
    pub fn draw_arrays(&mut self, mode: PrimitiveMode, first: u32, count: u32) {
        match first.checked_add(count) {
            Some(end) => self.draw_vertices(mode, first..end),
            None => self.error(GlError::InvalidValue),
        }
    }

    /// glDrawElements. Error `InvalidValue` where an array ends before an index; nothing is drawn.
    pub fn draw_elements(&mut self, mode: PrimitiveMode, indices: &[u32]) {
        self.draw_vertices(mode, indices.iter().copied());
    }

    /// Begin, each element's colour, normal and vertex, end (section 2.8).
    fn draw_vertices(&mut self, mode: PrimitiveMode, indices: impl Iterator<Item = u32> + Clone) {
        if !self.outside() || !self.vertex_array.enabled {
            return;
        }
        let arrays = [&self.vertex_array, &self.normal_array, &self.color_array];
        let complete = |i: u32| {
            let mut enabled = arrays.iter().filter(|array| array.enabled);
            enabled.all(|array| array.element(i as usize, [0.0; 4]).is_some())
        };
        if !indices.clone().all(complete) {
            return self.error(GlError::InvalidValue);
        }
        self.begin(mode);
        for index in indices {
            self.array_element(index as usize);
        }
        self.end();
    }

    fn array_element(&mut self, index: usize) {
        if self.color_array.enabled
            && let Some([r, g, b, a]) = self.color_array.element(index, [0.0, 0.0, 0.0, 1.0])
        {
            self.color4(r, g, b, a);
        }
        if self.normal_array.enabled
            && let Some([x, y, z, _]) = self.normal_array.element(index, [0.0; 4])
        {
            self.normal3(x, y, z);
        }
        if let Some([x, y, z, w]) = self.vertex_array.element(index, [0.0, 0.0, 0.0, 1.0]) {
            self.vertex4(x, y, z, w);
        }
    }

    fn pointer(&mut self, array: Array) -> &mut Pointer {
        match array {
            Array::Vertex => &mut self.vertex_array,
            Array::Normal => &mut self.normal_array,
            Array::Color => &mut self.color_array,
        }
    }

    fn set_pointer<T: Copy + Into<f64>>(
        &mut self,
        array: Array,
        legal: std::ops::RangeInclusive<usize>,
        size: usize,
        data: &[T],
    ) {
        if !legal.contains(&size) {
            return self.error(GlError::InvalidValue);
        }
        let pointer = self.pointer(array);
        pointer.size = size;
        pointer.data = data.iter().map(|x| (*x).into()).collect();
    }
}
