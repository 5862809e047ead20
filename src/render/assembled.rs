//! A scene's triangles in one of the precisions.

use std::ops::Range;

use super::{Precision, each};
use crate::error::Error;
use crate::lanes::Real;
use crate::lighting::Rounded;
use crate::scene::Scene;
use crate::scene::assembly::Assembly;

/// The triangles of a scene ([`Assembly`]), in f32 or f64; numbers come out in f64, in which both are exact.
#[derive(Clone, Debug)]
pub enum Assembled {
    /// 32 bits.
    F32(Assembly<f32>),
    /// 64 bits.
    F64(Assembly<f64>),
}

impl Assembled {
    /// Assembles the triangles at a tessellation level (64 where `None`).
    ///
    /// # Errors
    /// [`Error::Limit`] for too many triangles, and for vertices beyond the range of the precision.
    pub fn new(scene: &Scene, level: Option<u32>, precision: Precision) -> Result<Self, Error> {
        let assembled = Self::unchecked(scene, level, precision)?;
        each!(&assembled, a => a.check_range(scene))?;
        Ok(assembled)
    }

    /// [`Self::new`] that keeps vertices beyond the range of the precision: the renderers leave their triangles out, as GL
    /// does.
    ///
    /// # Errors
    /// [`Error::Limit`] for too many triangles.
    pub fn unchecked(
        scene: &Scene,
        level: Option<u32>,
        precision: Precision,
    ) -> Result<Self, Error> {
        Ok(match precision {
            Precision::F32 => Self::F32(Assembly::new(scene, level)?),
            Precision::F64 => Self::F64(Assembly::new(scene, level)?),
        })
    }

    /// In which precision they are.
    pub fn precision(&self) -> Precision {
        match self {
            Self::F32(_) => Precision::F32,
            Self::F64(_) => Precision::F64,
        }
    }

    /// Vertex numbers of each triangle; the last is the provoking vertex.
    pub fn triangles(&self) -> &[[u32; 3]] {
        each!(self, a => &a.triangles)
    }

    /// Index into the scene's materials of each triangle.
    pub fn materials(&self) -> &[u32] {
        each!(self, a => &a.material)
    }

    /// Index into the scene's objects of each triangle.
    pub fn objects(&self) -> &[u32] {
        each!(self, a => &a.object)
    }

    /// The triangles of each object.
    pub fn ranges(&self) -> &[Range<u32>] {
        each!(self, a => &a.triangle_range)
    }

    /// How many vertices there are.
    pub fn vertices(&self) -> usize {
        each!(self, a => a.position_from_eye.len())
    }

    /// Eye-space position of a vertex.
    pub fn vertex_eye(&self, vertex: u32) -> [f64; 3] {
        each!(self, a => wide(a.vertex_eye(vertex)))
    }

    /// Position of a vertex less the eye, world directions.
    pub fn vertex_from_eye(&self, vertex: u32) -> [f64; 3] {
        each!(self, a => wide(a.position_from_eye[vertex as usize]))
    }

    /// Eye-space unit normal of a vertex; zero where there is none.
    pub fn vertex_normal(&self, vertex: u32) -> [f64; 3] {
        each!(self, a => wide(a.vertex_normal(vertex)))
    }

    /// The length that the normal of a vertex enters per-vertex lighting with.
    pub fn normal_length(&self, vertex: u32) -> f64 {
        each!(self, a => a.normal_length.get(vertex as usize).map_or(1.0, |l| l.to_f64()))
    }

    /// Colour of a vertex; `None` where no material follows vertex colours.
    pub fn vertex_color(&self, vertex: u32) -> Option<[f64; 3]> {
        each!(self, a => a.vertex_color(vertex).map(wide))
    }

    /// The same triangles with the last corner first: another one provokes.
    #[must_use]
    pub fn with_turned_corners(mut self) -> Self {
        let triangles = each!(&mut self, a => &mut a.triangles);
        triangles.iter_mut().for_each(|t| t.rotate_left(1));
        self
    }

    /// Replaces the eye-space normal of a vertex.
    pub fn set_normal(&mut self, vertex: u32, normal: [f64; 3]) {
        each!(self, a => {
            for (list, n) in a.normal_eye.iter_mut().zip(normal) {
                list[vertex as usize] = Real::from_f64(n);
            }
        });
    }

    /// Rounds what is asked for of the vertices as an assembly in f32 has them.
    pub fn round(&mut self, rounded: Rounded) {
        each!(self, a => round(a, rounded));
    }
}

fn wide<R: Real>(v: [R; 3]) -> [f64; 3] {
    v.map(Real::to_f64)
}

fn round<R: Real>(assembly: &mut Assembly<R>, rounded: Rounded) {
    let round = |x: &mut R| *x = R::from_f64(f64::from(x.to_f64() as f32));
    if rounded.positions {
        let from_eye = assembly.position_from_eye.iter_mut().flatten();
        let eye = assembly.position_eye.iter_mut().flatten();
        from_eye.chain(eye).for_each(round);
    }
    if rounded.normals {
        let normals = assembly.normal_eye.iter_mut().flatten();
        normals.chain(&mut assembly.normal_length).for_each(round);
    }
}
