//! A whole scene in the form of OpenGL's state, drawn by the rasterizer, and the buffers that OpenGL would leave.
//!
//! In: the scene's JSON (matrices column-major, numbers rounded to f32 as OpenGL was given them). Out: [`Buffers`], bottom row
//! first: colour, window depth, number of the visible triangle, count of covering triangles. World space is OpenGL's eye
//! space here: the camera stands at the origin and looks along -z, and each mesh has its whole modelview.

use std::path::Path;
use std::sync::Arc;

use rastray::frame::{NONE, Plane};
use rastray::gl::{ColorControl, LightModel, ShadeModel};
use rastray::import::{LoadOptions, load};
use rastray::lanes::{Isa, Real};
use rastray::math::{DAffine3, DMat4, DVec3, DVec4};
use rastray::raster::{Options, Plan};
use rastray::scene::assembly::Assembly;
use rastray::scene::requirements::Model;
use rastray::scene::{
    Camera, Cull, FrontFace, Geometry, ImageSettings, Light, LightSpace, Material, Mesh, Object,
    Optics, Projection, RasterSettings, Scene, Snap,
};
use serde::Deserialize;

use super::Failure;
use super::gl_lights::{CaseLight, CaseMaterial, IDENTITY, rgb, to_eye};

/// A scene; what is left out has OpenGL's default, save that the depth test is on.
#[derive(Deserialize)]
#[serde(default)]
struct Case {
    name: String,
    width: u32,
    height: u32,
    projection: CaseProjection,
    modelview: [f64; 16],
    light_modelview: [f64; 16],
    lights: Vec<CaseLight>,
    scene_ambient: Vec<f64>,
    local_viewer: bool,
    two_side: bool,
    separate_specular: bool,
    normalize: bool,
    rescale_normal: bool,
    clamp: bool,
    cull: String,
    front_face: String,
    depth_test: bool,
    clear_color: [f64; 4],
    meshes: Vec<CaseMesh>,
}

#[derive(Deserialize)]
#[serde(tag = "type", rename_all = "lowercase")]
enum CaseProjection {
    Perspective {
        fovy: f64,
        near: f64,
        far: f64,
        aspect: Option<f64>,
    },
    Ortho {
        left: f64,
        right: f64,
        bottom: f64,
        top: f64,
        near: f64,
        far: f64,
    },
    Matrix {
        matrix: [f64; 16],
    },
}

#[derive(Deserialize)]
#[serde(default)]
struct CaseMesh {
    positions: Vec<f64>,
    normals: Vec<f64>,
    indices: Vec<u32>,
    obj: Option<String>,
    material: CaseMaterial,
    back_material: Option<CaseMaterial>,
    modelview: [f64; 16],
}

impl Default for Case {
    fn default() -> Self {
        Self {
            name: "scene".into(),
            width: 0,
            height: 0,
            projection: CaseProjection::Matrix { matrix: IDENTITY },
            modelview: IDENTITY,
            light_modelview: IDENTITY,
            lights: Vec::new(),
            scene_ambient: vec![0.2, 0.2, 0.2, 1.0],
            local_viewer: false,
            two_side: false,
            separate_specular: false,
            normalize: false,
            rescale_normal: false,
            clamp: true,
            cull: "none".into(),
            front_face: "ccw".into(),
            depth_test: true,
            clear_color: [0.0; 4],
            meshes: Vec::new(),
        }
    }
}

impl Default for CaseMesh {
    fn default() -> Self {
        Self {
            positions: Vec::new(),
            normals: Vec::new(),
            indices: Vec::new(),
            obj: None,
            material: CaseMaterial::default(),
            back_material: None,
            modelview: IDENTITY,
        }
    }
}

/// OpenGL's buffers of one picture, row-major, bottom row first.
pub(crate) struct Buffers {
    /// Red, green, blue, alpha.
    pub(crate) rgba: Vec<[f32; 4]>,
    /// Window depth.
    pub(crate) depth: Vec<f32>,
    /// Number of the visible triangle, -1 where none is.
    pub(crate) prim: Vec<i32>,
    /// How many triangles cover the pixel, at most 255.
    pub(crate) count: Vec<u8>,
}

impl Buffers {
    /// Writes PREFIX.rgba.f32, .depth.f32, .prim.i32 and .count.u8.
    pub(crate) fn write(&self, prefix: &str) -> Result<(), Failure> {
        let file = |suffix: &str, bytes: Vec<u8>| -> Result<(), Failure> {
            let path = format!("{prefix}.{suffix}");
            std::fs::write(&path, bytes).map_err(|e| format!("{path}: {e}").into())
        };
        let floats = |list: &[f32]| list.iter().flat_map(|x| x.to_le_bytes()).collect();
        file("rgba.f32", floats(self.rgba.as_flattened()))?;
        file("depth.f32", floats(&self.depth))?;
        file(
            "prim.i32",
            self.prim.iter().flat_map(|x| x.to_le_bytes()).collect(),
        )?;
        file("count.u8", self.count.clone())
    }
}

/// The shading of a name: the command's, or the data's (`smooth` is OpenGL's word for Gouraud).
pub(crate) fn shading(name: &str) -> Result<ShadeModel, Failure> {
    match name {
        "flat" => Ok(ShadeModel::Flat),
        "gouraud" | "smooth" => Ok(ShadeModel::Gouraud),
        "phong" => Ok(ShadeModel::Phong),
        other => Err(format!("--shading: expected flat, gouraud or phong, found {other:?}").into()),
    }
}

/// Draws a scene's JSON; `folder` is where the paths of its OBJ files start.
pub(crate) fn draw<R: Real>(
    text: &str,
    folder: &Path,
    shading: ShadeModel,
    snap: Snap,
) -> Result<Buffers, Failure> {
    let case: Case = serde_json::from_str(text)?;
    let mut scene = scene(&case, folder)?;
    scene.raster.snap = snap;
    let assembly = Assembly::<R>::new(&scene, None)?;
    let plan = Plan::new(&scene, &assembly, Model::Required);
    let options = Options {
        shading,
        clamp: case.clamp,
        layers: false,
        isa: Isa::detect(),
    };
    let (frame, _) = plan.draw(&options)?;
    // Alpha is the diffuse alpha of the visible front material (GL 2.1 section 2.14.1); no scene has another for the back.
    let alpha = |primitive: u32| match primitive {
        NONE => case.clear_color[3],
        seen => {
            let material = assembly.material[seen as usize] as usize;
            scene.materials[material].front.alpha
        }
    };
    let limit = |x: f64| if case.clamp { x.clamp(0.0, 1.0) } else { x };
    let colors = frame.color.data.iter().zip(&frame.primitive.data);
    let rgba = colors.map(|(c, &primitive)| {
        let [r, g, b] = c.map(Real::to_f32);
        [r, g, b, limit(alpha(primitive)) as f32]
    });
    let (width, height) = (frame.color.width, frame.color.height);
    let rgba = Plane {
        width,
        height,
        data: rgba.collect(),
    };
    Ok(Buffers {
        rgba: bottom_up(&rgba),
        depth: bottom_up(&plan.window_depth(&frame).map(|z| *z as f32)),
        prim: bottom_up(
            &frame
                .primitive
                .map(|p| if *p == NONE { -1 } else { *p as i32 }),
        ),
        count: bottom_up(&plan.coverage_counts().map(|n| (*n).min(255) as u8)),
    })
}

/// The values with OpenGL's row 0, the bottom one, first.
fn bottom_up<T: Clone>(plane: &Plane<T>) -> Vec<T> {
    let rows = plane.data.chunks(plane.width.max(1)).rev();
    rows.flatten().cloned().collect()
}

/// A number as OpenGL was given it.
fn single(x: f64) -> f64 {
    f64::from(x as f32)
}

fn matrix(m: &[f64; 16]) -> DMat4 {
    DMat4::from_cols_array(&m.map(single))
}

fn scene(case: &Case, folder: &Path) -> Result<Scene, Failure> {
    let eye_from_light = matrix(&case.light_modelview);
    let mut scene = Scene {
        name: case.name.clone(),
        image: ImageSettings {
            width: case.width,
            height: case.height,
            background: rgb(&case.clear_color),
            ..ImageSettings::default()
        },
        camera: Camera {
            eye: DVec3::ZERO,
            target: DVec3::NEG_Z,
            up: DVec3::Y,
            ..camera(case)
        },
        light_model: LightModel {
            ambient: rgb(&case.scene_ambient).map(single),
            local_viewer: case.local_viewer,
            two_sided: case.two_side,
            color_control: if case.separate_specular {
                ColorControl::SeparateSpecular
            } else {
                ColorControl::Single
            },
            normalize: case.normalize,
            rescale_normal: case.rescale_normal,
            ..LightModel::default()
        },
        raster: RasterSettings {
            cull: named("cull", Cull::NAMES, &case.cull)?,
            front_face: named("front_face", FrontFace::NAMES, &case.front_face)?,
            depth_test: case.depth_test,
            ..RasterSettings::default()
        },
        ..Scene::default()
    };
    for (i, light) in case.lights.iter().enumerate() {
        scene.lights.push(Light {
            name: format!("light{i}"),
            source: to_eye(&light.rounded(), &eye_from_light),
            space: LightSpace::Eye,
            enabled: true,
        });
    }
    for (i, mesh) in case.meshes.iter().enumerate() {
        scene.materials.push(Material {
            name: format!("material{i}"),
            front: mesh.material.rounded().material(),
            back: mesh.back_material.as_ref().map(|m| m.rounded().material()),
            optics: Optics::default(),
        });
        let eye_from_object = matrix(&case.modelview) * matrix(&mesh.modelview);
        if eye_from_object.row(3) != DVec4::W {
            return Err(format!(
                "mesh {i}: expected a modelview whose last row is 0 0 0 1, found {}",
                eye_from_object.row(3)
            )
            .into());
        }
        scene.objects.push(Object {
            name: format!("mesh{i}"),
            geometry: Geometry::Mesh(Arc::new(mesh.mesh(folder)?)),
            materials: vec![i],
            world_from_object: DAffine3::from_mat4(eye_from_object),
            tessellation: None,
        });
    }
    Ok(scene)
}

/// The value of a name in one of the library's tables.
fn named<T: Copy>(key: &str, names: &[(&'static str, T)], name: &str) -> Result<T, Failure> {
    let found = names
        .iter()
        .find(|(n, _)| *n == name)
        .map(|(_, value)| *value);
    found.ok_or_else(|| format!("{key}: unknown value {name:?}").into())
}

/// The projection; near and far where it does not hold them itself.
fn camera(case: &Case) -> Camera {
    let mut camera = Camera::default();
    match case.projection {
        CaseProjection::Perspective {
            fovy,
            near,
            far,
            aspect,
        } => {
            let fovy_deg = fovy;
            camera.projection = Projection::Perspective { fovy_deg };
            (camera.near, camera.far) = (single(near), Some(single(far)));
            if let Some(aspect) = aspect {
                let clip_from_eye = camera.clip_from_eye(aspect);
                camera.projection = Projection::Matrix { clip_from_eye };
            }
        }
        CaseProjection::Ortho {
            left,
            right,
            bottom,
            top,
            near,
            far,
        } => {
            // glOrtho (GL 2.1 section 2.11.2).
            let row = |low: f64, high: f64| (2.0 / (high - low), -(high + low) / (high - low));
            let (x, y, z) = (row(left, right), row(bottom, top), row(near, far));
            let clip_from_eye = DMat4::from_cols(
                DVec4::X * x.0,
                DVec4::Y * y.0,
                DVec4::Z * -z.0,
                DVec4::new(x.1, y.1, z.1, 1.0),
            );
            camera.projection = Projection::Matrix { clip_from_eye };
        }
        CaseProjection::Matrix { matrix: m } => {
            let clip_from_eye = matrix(&m);
            camera.projection = Projection::Matrix { clip_from_eye };
        }
    }
    camera
}

impl CaseMesh {
    fn mesh(&self, folder: &Path) -> Result<Mesh, Failure> {
        if let Some(obj) = &self.obj {
            return obj_mesh(&folder.join(obj));
        }
        let points = |list: &[f64]| -> Vec<DVec3> {
            let triples = list.chunks_exact(3);
            triples
                .map(|p| DVec3::new(single(p[0]), single(p[1]), single(p[2])))
                .collect()
        };
        let positions = points(&self.positions);
        let mut normals = points(&self.normals);
        // The current normal, where none is given.
        normals.resize(positions.len(), DVec3::Z);
        if let Some(bad) = self
            .indices
            .iter()
            .find(|i| **i as usize >= positions.len())
        {
            return Err(format!("index {bad} of {} positions", positions.len()).into());
        }
        let triangles = self.indices.chunks_exact(3);
        Ok(Mesh {
            positions,
            normals,
            triangles: triangles.map(|t| [t[0], t[1], t[2]]).collect(),
            ..Mesh::default()
        })
    }
}

/// The meshes of an OBJ file as one.
fn obj_mesh(path: &Path) -> Result<Mesh, Failure> {
    let path = path.to_str().ok_or("a path that is not text")?;
    let imported = load(path, &LoadOptions::default())?;
    let mut all = Mesh::default();
    for object in &imported.scene.objects {
        if let Geometry::Mesh(mesh) = &object.geometry {
            let base = all.positions.len() as u32;
            all.positions.extend(&mesh.positions);
            all.normals.extend(&mesh.normals);
            let moved = mesh.triangles.iter().map(|t| t.map(|v| v + base));
            all.triangles.extend(moved);
        }
    }
    Ok(all)
}
