//! A whole scene in the form of OpenGL's state: set and drawn through the library's fixed-function context, rasterized, and
//! the buffers that OpenGL would leave. Precision, shading and clamps are this adapter's.
//!
//! In: the scene's JSON (matrices column-major, numbers rounded to f32 as OpenGL was given them). Out: [`Buffers`], bottom row
//! first: colour, window depth, number of the visible triangle, count of covering triangles. Triangles count through the
//! meshes in order. Values that GL refuses are refused here, too.

use std::path::Path;

use rastray::context::{
    Array, Buffers as Clear, Capability, Context, LightModelParameter, MatrixMode, PrimitiveMode,
};
use rastray::frame::{NONE, Plane};
use rastray::gl::{ColorControl, Face, ShadeModel};
use rastray::import::{LoadOptions, load};
use rastray::math::float::normalize;
use rastray::render::{Assembled, Options, Precision, Rasterizer};
use rastray::scene::requirements::Model;
use rastray::scene::{Cull, FrontFace, Geometry, Scene, Snap};
use serde::Deserialize;

use super::Failure;
use super::gl_lights::{
    CaseLight, CaseMaterial, IDENTITY, named, rgb, rgba, set_light, set_material,
};

/// A scene; what is left out has OpenGL's default, save that the depth test is on.
#[derive(Deserialize)]
#[serde(default)]
pub(crate) struct Case {
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
pub(crate) fn draw(
    text: &str,
    folder: &Path,
    shading: ShadeModel,
    precision: Precision,
    snap: Snap,
) -> Result<Buffers, Failure> {
    let case: Case = serde_json::from_str(text)?;
    let mut scene = case.record(folder)?;
    scene.raster.snap = snap;
    case.buffers(&scene, shading, precision)
}

impl Case {
    /// The buffers of the recorded scene.
    pub(crate) fn buffers(
        &self,
        scene: &Scene,
        shading: ShadeModel,
        precision: Precision,
    ) -> Result<Buffers, Failure> {
        let assembled = Assembled::unchecked(scene, None, precision)?;
        let plan = Rasterizer::new(scene, &assembled, Model::Required);
        let options = Options::default().raster(shading, self.clamp, false);
        let picture = plan.draw(&options)?.picture;
        // Alpha is the diffuse alpha of the visible front material (GL 2.1 section 2.14.1); no scene has another for the back.
        let alpha = |primitive: u32| match primitive {
            NONE => self.clear_color[3],
            seen => {
                let material = assembled.materials()[seen as usize] as usize;
                scene.materials[material].front.alpha
            }
        };
        let limit = |x: f64| if self.clamp { x.clamp(0.0, 1.0) } else { x };
        let (color, primitive) = (picture.color_f32(), picture.primitive());
        let colors = color.data.iter().zip(&primitive.data);
        let rgba = colors.map(|(&[r, g, b], &primitive)| [r, g, b, limit(alpha(primitive)) as f32]);
        let [width, height] = picture.size();
        let rgba = Plane {
            width,
            height,
            data: rgba.collect(),
        };
        Ok(Buffers {
            rgba: bottom_up(&rgba),
            depth: bottom_up(&plan.window_depth(primitive).map(|z| *z as f32)),
            prim: bottom_up(&primitive.map(|p| if *p == NONE { -1 } else { *p as i32 })),
            count: bottom_up(&plan.coverage_counts().map(|n| (*n).min(255) as u8)),
        })
    }
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

impl Case {
    /// The scene as a fixed-function program, recorded.
    pub(crate) fn record(&self, folder: &Path) -> Result<Scene, Failure> {
        let mut gl = Context::new(self.width, self.height);
        let [r, g, b, a] = self.clear_color;
        gl.clear_color(r, g, b, a);
        gl.clear(Clear::COLOR | Clear::DEPTH);
        self.project(&mut gl);
        self.set_lighting(&mut gl);
        self.set_faces(&mut gl)?;
        if self.depth_test {
            gl.enable(Capability::DepthTest);
        }
        check(&mut gl, "the scene's state")?;
        for (i, mesh) in self.meshes.iter().enumerate() {
            gl.load_matrix(&self.modelview.map(single));
            gl.mult_matrix(&mesh.modelview.map(single));
            mesh.draw(&mut gl, folder)?;
            check(&mut gl, &format!("mesh {i}"))?;
        }
        let mut scene = gl.scene()?;
        if !self.clamp {
            // With glClampColor off the clear colour is not clamped, either (GL 3.0 section 4.2.3); the context is GL 2.1.
            scene.image.background = rgb(&self.clear_color);
        }
        Ok(scene)
    }

    /// The projection matrix; the picture's aspect where none is stated.
    fn project(&self, gl: &mut Context) {
        gl.matrix_mode(MatrixMode::Projection);
        match self.projection {
            CaseProjection::Perspective {
                fovy,
                near,
                far,
                aspect,
            } => {
                let aspect = aspect.unwrap_or(f64::from(self.width) / f64::from(self.height));
                gl.perspective(fovy, aspect, single(near), single(far));
            }
            CaseProjection::Ortho {
                left,
                right,
                bottom,
                top,
                near,
                far,
            } => gl.ortho(left, right, bottom, top, near, far),
            CaseProjection::Matrix { matrix } => gl.load_matrix(&matrix.map(single)),
        }
        gl.matrix_mode(MatrixMode::ModelView);
    }

    /// Lights under their own modelview, the light model, and what becomes of normals.
    fn set_lighting(&self, gl: &mut Context) {
        use LightModelParameter as M;
        gl.enable(Capability::Lighting);
        gl.load_matrix(&self.light_modelview.map(single));
        for (number, light) in self.lights.iter().enumerate() {
            set_light(gl, number, &light.rounded());
        }
        gl.light_model(M::Ambient(rgba(&self.scene_ambient).map(single)));
        gl.light_model(M::LocalViewer(self.local_viewer));
        gl.light_model(M::TwoSide(self.two_side));
        gl.light_model(M::ColorControl(if self.separate_specular {
            ColorControl::SeparateSpecular
        } else {
            ColorControl::Single
        }));
        for (on, capability) in [
            (self.normalize, Capability::Normalize),
            (self.rescale_normal, Capability::RescaleNormal),
        ] {
            if on {
                gl.enable(capability);
            }
        }
    }

    /// Which side is the front, and which is dropped.
    fn set_faces(&self, gl: &mut Context) -> Result<(), Failure> {
        gl.front_face(named(FrontFace::NAMES, "front_face", &self.front_face)?);
        let dropped = match named(Cull::NAMES, "cull", &self.cull)? {
            Cull::None => return Ok(()),
            Cull::Front => Face::Front,
            Cull::Back => Face::Back,
        };
        gl.cull_face(dropped);
        gl.enable(Capability::CullFace);
        Ok(())
    }
}

/// GL's error flag as a message.
fn check(gl: &mut Context, what: &str) -> Result<(), Failure> {
    match gl.get_error() {
        None => Ok(()),
        Some(error) => Err(format!("{what}: OpenGL refuses a value ({error:?})").into()),
    }
}

/// The arrays of a mesh, three numbers a vertex, and its indices.
#[derive(Default)]
struct Arrays {
    positions: Vec<f64>,
    normals: Vec<f64>,
    indices: Vec<u32>,
}

impl CaseMesh {
    /// Sets the materials and hands over the arrays.
    fn draw(&self, gl: &mut Context, folder: &Path) -> Result<(), Failure> {
        set_material(gl, Face::FrontAndBack, &self.material.rounded());
        if let Some(back) = &self.back_material {
            set_material(gl, Face::Back, &back.rounded());
        }
        let arrays = match &self.obj {
            Some(obj) => obj_arrays(&folder.join(obj))?,
            None => self.arrays()?,
        };
        // The current normal, where none is given; arrays before this one have changed it.
        gl.normal3(0.0, 0.0, 1.0);
        gl.enable_client_state(Array::Vertex);
        gl.vertex_pointer(3, &arrays.positions);
        if arrays.normals.is_empty() {
            gl.disable_client_state(Array::Normal);
        } else {
            gl.enable_client_state(Array::Normal);
            gl.normal_pointer(&arrays.normals);
        }
        gl.draw_elements(PrimitiveMode::Triangles, &arrays.indices);
        Ok(())
    }

    fn arrays(&self) -> Result<Arrays, Failure> {
        let list = |list: &[f64]| -> Vec<f64> { list.iter().copied().map(single).collect() };
        let vertices = self.positions.len() / 3;
        if let Some(bad) = self.indices.iter().find(|i| **i as usize >= vertices) {
            return Err(format!("index {bad} of {vertices} positions").into());
        }
        Ok(Arrays {
            positions: list(&self.positions),
            normals: list(&self.normals),
            indices: self.indices.clone(),
        })
    }
}

/// The meshes of an OBJ file as one, every corner a vertex; triangles without normals have their own.
fn obj_arrays(path: &Path) -> Result<Arrays, Failure> {
    let path = path.to_str().ok_or("a path that is not text")?;
    let imported = load(path, &LoadOptions::default())?;
    let mut all = Arrays::default();
    for object in &imported.scene.objects {
        let Geometry::Mesh(mesh) = &object.geometry else {
            continue;
        };
        for triangle in &mesh.triangles {
            let corners = triangle.map(|v| mesh.positions[v as usize]);
            let [a, b, c] = corners;
            let own = (b - a).cross(c - a).to_array();
            let own = normalize(own).0;
            for (v, corner) in triangle.iter().zip(corners) {
                let given = mesh.normals.get(*v as usize).map(|n| n.to_array());
                all.positions.extend(corner.to_array());
                all.normals.extend(given.unwrap_or(own));
            }
        }
    }
    all.indices = (0..all.positions.len() as u32 / 3).collect();
    Ok(all)
}
