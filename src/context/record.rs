//! From vertices to objects of a scene: one object for each begin and end.
//!
//! State that a scene has once (lights, projection, ...) is remembered at the first polygon that it matters to, and must then
//! stay; what cannot be recorded is remembered, too, and refused when the scene is asked for.

use std::fmt;
use std::sync::Arc;

use super::batch::{Batch, Surface, Vertex};
use super::{Context, PrimitiveMode, Viewport};
use crate::error::Error;
use crate::gl::{Face, LightModel, LightSource, ShadeModel};
use crate::math::transform::normal_matrix;
use crate::math::{DAffine3, DMat3, DMat4, DVec3};
use crate::scene::{
    Camera, Cull, Geometry, ImageSettings, Light, LightSpace, Material, Mesh, Object, Projection,
    RasterSettings, Scene,
};

/// What was drawn and one scene cannot hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Unrecordable {
    /// State that a scene has once changed between two polygons of one picture.
    Changed(&'static str),
    /// One of colour and depth was cleared, with polygons drawn that use both.
    HalfCleared,
    /// The corners of one smooth triangle have materials that differ in more than one colour.
    MixedMaterials,
    /// A vertex at infinity or behind it: w as given, or as the modelview made it.
    VertexW(f64),
}

impl fmt::Display for Unrecordable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Changed(what) => {
                write!(
                    f,
                    "{what} changed between two polygons of one picture, and a scene has one"
                )
            }
            Self::HalfCleared => {
                write!(f, "clear of one buffer, where colour and depth are in use")
            }
            Self::MixedMaterials => write!(
                f,
                "the corners of one smooth triangle have materials that differ in more than one colour"
            ),
            Self::VertexW(w) => write!(f, "a vertex with w = {w}, where w > 0 was expected"),
        }
    }
}

impl Unrecordable {
    fn into_error(self) -> Error {
        let help = match self {
            Self::Changed(_) => "clear before the change, so that each picture has one",
            Self::HalfCleared => "clear both: Buffers::COLOR | Buffers::DEPTH",
            Self::MixedMaterials => "let one colour follow (color_material), or use flat shading",
            Self::VertexW(_) => "divide by w, or leave the vertex out",
        };
        Error::Unsupported {
            place: None,
            message: self.to_string(),
            help: Some(help.into()),
        }
    }
}

/// State that every polygon depends on and a scene has once.
#[derive(Clone, Debug)]
struct Picture {
    projection: DMat4,
    viewport: Viewport,
    raster: RasterSettings,
}

/// State that every lit polygon depends on and a scene has once.
#[derive(Clone, Debug)]
struct Lighting {
    /// Enabled lights by number, eye space.
    lights: Vec<(usize, LightSource)>,
    model: LightModel,
}

/// What has been drawn since the last clear.
#[derive(Clone, Debug, Default)]
pub(super) struct Recorded {
    /// What the window was cleared to.
    pub(super) background: [f64; 4],
    picture: Option<Picture>,
    lighting: Option<Lighting>,
    surfaces: Vec<Surface>,
    objects: Vec<Object>,
    /// The first thing that could not be recorded.
    pub(super) refused: Option<Unrecordable>,
}

impl Recorded {
    /// Nothing drawn on this colour.
    pub(super) fn cleared(background: [f64; 4]) -> Self {
        Self {
            background,
            ..Self::default()
        }
    }

    /// Whether something was drawn with the depth test on.
    pub(super) fn tests_depth(&self) -> bool {
        self.picture.as_ref().is_some_and(|p| p.raster.depth_test)
    }

    /// The viewport of what was drawn.
    pub(super) fn viewport(&self) -> Option<Viewport> {
        self.picture.as_ref().map(|p| p.viewport)
    }

    /// The index of a material among the last ones, or a new one.
    fn intern(&mut self, surface: Surface) -> usize {
        // Few programs take turns between more materials; the others get some of them twice.
        const LOOK_BACK: usize = 32;
        let start = self.surfaces.len().saturating_sub(LOOK_BACK);
        let known = self.surfaces[start..].iter().position(|s| *s == surface);
        known.map_or_else(
            || {
                self.surfaces.push(surface);
                self.surfaces.len() - 1
            },
            |index| start + index,
        )
    }

    /// The scene, with what it does not depend on yet taken from the context's present state.
    pub(super) fn scene(&self, context: &Context) -> Result<Scene, Error> {
        if let Some(why) = self.refused {
            return Err(why.into_error());
        }
        let picture = self.picture.clone().unwrap_or_else(|| context.picture());
        let lighting = self.lighting.clone().unwrap_or_else(|| context.lighting());
        let lights = lighting.lights.into_iter().map(|(number, source)| Light {
            name: format!("light{number}"),
            source,
            space: LightSpace::Eye,
            enabled: true,
        });
        let [red, green, blue, _] = self.background;
        Ok(Scene {
            name: "context".into(),
            image: ImageSettings {
                width: picture.viewport.width,
                height: picture.viewport.height,
                background: [red, green, blue],
                ..ImageSettings::default()
            },
            camera: Camera {
                eye: DVec3::ZERO,
                target: DVec3::NEG_Z,
                projection: Projection::Matrix {
                    clip_from_eye: picture.projection,
                },
                ..Camera::default()
            },
            light_model: lighting.model,
            raster: picture.raster,
            trace: context.trace.clone(),
            lights: lights.collect(),
            materials: self.surfaces.iter().enumerate().map(material).collect(),
            objects: self.objects.clone(),
        })
    }
}

fn material((index, surface): (usize, &Surface)) -> Material {
    let [front, back] = &surface.sides;
    Material {
        name: format!("material{index}"),
        front: front.clone(),
        back: (back != front).then(|| back.clone()),
        optics: surface.optics.clone(),
    }
}

impl Context {
    /// Adds a vertex with the current state.
    pub(super) fn push_vertex(&mut self, position: DVec3) {
        let surface = if self.enabled.lighting {
            self.surface.clone()
        } else {
            Surface::unlit(self.color, self.surface.optics.clone())
        };
        let normal = self.normal;
        self.batch.push(Vertex { position, normal }, surface);
    }

    /// What GL's state says of every polygon.
    fn picture(&self) -> Picture {
        Picture {
            projection: DMat4::from_cols_array(&self.matrix(super::MatrixMode::Projection)),
            viewport: self.viewport,
            raster: RasterSettings {
                shading: self.shade_model,
                cull: match (self.enabled.cull_face, self.cull_face) {
                    (false, _) | (true, Face::FrontAndBack) => Cull::None,
                    (true, Face::Front) => Cull::Front,
                    (true, Face::Back) => Cull::Back,
                },
                front_face: self.front_face,
                depth_range: self.depth_range,
                depth_test: self.enabled.depth_test,
                ..RasterSettings::default()
            },
        }
    }

    /// What GL's state says of every lit polygon.
    fn lighting(&self) -> Lighting {
        let lights = self.lights.iter().enumerate().zip(&self.lit);
        let enabled = lights.filter(|(_, on)| **on);
        Lighting {
            lights: enabled
                .map(|((i, source), _)| (i, source.clone()))
                .collect(),
            model: LightModel {
                normalize: self.enabled.normalize,
                rescale_normal: self.enabled.rescale_normal,
                ..self.model.clone()
            },
        }
    }

    /// Ends a batch: its polygons become an object.
    pub(super) fn record(&mut self, mode: PrimitiveMode) {
        let batch = std::mem::take(&mut self.batch);
        let triangles = mode.triangles(batch.vertices.len() as u32);
        let hidden = self.enabled.cull_face && self.cull_face == Face::FrontAndBack;
        if !triangles.is_empty() && !hidden {
            let added = self
                .hold_still()
                .and_then(|()| self.add(mode, &batch, triangles));
            if let Err(why) = added {
                self.refuse(why);
            }
            self.frame = None;
        }
        self.batch = batch;
    }

    /// Remembers the state that the scene has once, or finds out what changed in it.
    fn hold_still(&mut self) -> Result<(), Unrecordable> {
        let now = self.picture();
        let before = self.recorded.picture.get_or_insert_with(|| now.clone());
        let differences = [
            (now.projection != before.projection, "the projection matrix"),
            (now.viewport != before.viewport, "the viewport"),
            (
                now.raster.shading != before.raster.shading,
                "the shade model",
            ),
            (now.raster.cull != before.raster.cull, "culling"),
            (
                now.raster.front_face != before.raster.front_face,
                "the front face",
            ),
            (
                now.raster.depth_range != before.raster.depth_range,
                "the depth range",
            ),
            (
                now.raster.depth_test != before.raster.depth_test,
                "the depth test",
            ),
        ];
        let changed = differences.into_iter().find(|(differs, _)| *differs);
        if let Some((_, what)) = changed {
            return Err(Unrecordable::Changed(what));
        }
        if !self.enabled.lighting {
            return Ok(());
        }
        let now = self.lighting();
        let before = self.recorded.lighting.get_or_insert_with(|| now.clone());
        if now.lights != before.lights {
            return Err(Unrecordable::Changed("a light"));
        }
        if now.model != before.model {
            return Err(Unrecordable::Changed(
                "the light model or the handling of normals",
            ));
        }
        Ok(())
    }

    fn add(
        &mut self,
        mode: PrimitiveMode,
        batch: &Batch,
        triangles: Vec<[u32; 3]>,
    ) -> Result<(), Unrecordable> {
        let (world_from_object, vertices) = self.place(&batch.vertices)?;
        let mut mesh = Mesh {
            positions: vertices.iter().map(|v| v.position).collect(),
            normals: vertices.iter().map(|v| v.normal).collect(),
            ..Mesh::default()
        };
        let materials = if let Some((surface, colors)) = batch.following() {
            if surface.sides.iter().any(|side| side.tracked.any()) {
                mesh.colors = colors;
            }
            vec![self.recorded.intern(surface)]
        } else {
            let flat = self.shade_model == ShadeModel::Flat;
            let slots = batch.slots(&triangles, flat);
            mesh.slots = slots.ok_or(Unrecordable::MixedMaterials)?;
            let surfaces = batch.surfaces.iter().cloned();
            surfaces.map(|s| self.recorded.intern(s)).collect()
        };
        mesh.triangles = triangles;
        self.recorded.objects.push(Object {
            name: format!("{} {}", mode.name(), self.recorded.objects.len()),
            geometry: Geometry::Mesh(Arc::new(mesh)),
            materials,
            world_from_object,
            tessellation: None,
            priority: 0,
        });
        Ok(())
    }

    /// The modelview as an object's transform. One that is not affine is applied to the vertices instead: positions are
    /// divided by w, normals take the inverse transpose of the upper-left 3x3 (GL 2.1 section 2.11.3).
    fn place(&self, vertices: &[Vertex]) -> Result<(DAffine3, Vec<Vertex>), Unrecordable> {
        let m = self.modelview.top();
        if m.row(3).to_array() == [0.0, 0.0, 0.0, 1.0] {
            return Ok((DAffine3::from_mat4(m), vertices.to_vec()));
        }
        let linear = DAffine3 {
            matrix3: DMat3::from_mat4(m),
            translation: DVec3::ZERO,
        };
        let normals = normal_matrix(&linear);
        let applied = |v: &Vertex| {
            let eye = m * v.position.extend(1.0);
            if eye.w.is_nan() || eye.w <= 0.0 {
                return Err(Unrecordable::VertexW(eye.w));
            }
            Ok(Vertex {
                position: eye.truncate() / eye.w,
                normal: normals * v.normal,
            })
        };
        let vertices: Result<Vec<Vertex>, Unrecordable> = vertices.iter().map(applied).collect();
        Ok((DAffine3::IDENTITY, vertices?))
    }
}
