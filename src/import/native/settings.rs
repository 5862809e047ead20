//! `[image]`, `[camera]`, `[light_model]`, `[raster]` and `[trace]`.

use super::colors::color_material;
use super::{Reader, vertical_angle};
use crate::error::Error;
use crate::gl::{ColorControl, ShadeModel, SpecularModel};
use crate::import::Fitted;
use crate::import::document::{Key, Node, Value};
use crate::import::keys::{self, MAX_PIXELS};
use crate::import::reader::Section;
use crate::math::float::normalize;
use crate::math::{DVec2, DVec3};
use crate::sampling::Pattern;
use crate::scene::fit::{self, Bounds};
use crate::scene::{Camera, Cull, FrontFace, Projection, Shadow, Snap, Tir, Transparency};

/// From where an unplaced camera looks: a little from the right and above.
const TOWARD: DVec3 = DVec3::new(0.45, 0.4, 1.0);

/// Sine of the smallest angle between view and up that still says which way is up.
const LEAST_SINE: f64 = 1e-9;

type Entry<'a> = Option<&'a (Key, Node)>;

impl<'a> Reader<'a> {
    fn section(
        &self,
        entry: Entry<'a>,
        keys: &'static [keys::KeyInfo],
    ) -> Result<Option<Section<'a>>, Error> {
        let Some((key, node)) = entry else {
            return Ok(None);
        };
        let span = key.span.clone();
        Section::open(self.document, &key.name, span, node, &[keys]).map(Some)
    }

    pub(super) fn image(&mut self, entry: Entry<'a>) -> Result<(), Error> {
        let Some(section) = self.section(entry, keys::IMAGE)? else {
            return Ok(());
        };
        let image = &mut self.scene.image;
        if let Some(width) = section.integer("width")? {
            image.width = width;
        }
        if let Some(height) = section.integer("height")? {
            image.height = height;
        }
        if let Some(background) = section.color("background")? {
            image.background = background;
        }
        if let Some(samples) = section.integer("samples")? {
            image.samples = samples;
        }
        if let Some(pattern) = section.choice("pattern", Pattern::NAMES)? {
            image.pattern = pattern;
        }
        if let Some(seed) = section.integer("seed")? {
            image.seed = seed;
        }
        let pixels = u64::from(image.width) * u64::from(image.height);
        if pixels > MAX_PIXELS {
            let message = format!(
                "{} x {} is {pixels} pixels, more than {MAX_PIXELS}",
                image.width, image.height
            );
            return Err(section.error(message));
        }
        Ok(())
    }

    pub(super) fn light_model(&mut self, entry: Entry<'a>) -> Result<(), Error> {
        if self.lecture {
            self.scene.light_model.specular_model = SpecularModel::Reflection;
        }
        let Some(section) = self.section(entry, keys::LIGHT_MODEL)? else {
            return Ok(());
        };
        self.color_material = color_material(&section)?.unwrap_or_default();
        let model = &mut self.scene.light_model;
        if let Some(ambient) = section.color("ambient")? {
            model.ambient = ambient;
        }
        if let Some(local_viewer) = section.bool("local_viewer")? {
            model.local_viewer = local_viewer;
        }
        if let Some(two_sided) = section.bool("two_sided")? {
            model.two_sided = two_sided;
        }
        if let Some(control) = section.choice("color_control", ColorControl::NAMES)? {
            model.color_control = control;
        }
        if let Some(specular) = section.choice("specular_model", SpecularModel::NAMES)? {
            model.specular_model = specular;
        }
        if let Some(normalize) = section.bool("normalize")? {
            model.normalize = normalize;
        }
        if let Some(rescale) = section.bool("rescale_normal")? {
            model.rescale_normal = rescale;
        }
        Ok(())
    }

    pub(super) fn raster(&mut self, entry: Entry<'a>) -> Result<(), Error> {
        let Some(section) = self.section(entry, keys::RASTER)? else {
            return Ok(());
        };
        let raster = &mut self.scene.raster;
        if let Some(shading) = section.choice("shading", ShadeModel::NAMES)? {
            raster.shading = shading;
        }
        if let Some(cull) = section.choice("cull", Cull::NAMES)? {
            raster.cull = cull;
        }
        if let Some(front_face) = section.choice("front_face", FrontFace::NAMES)? {
            raster.front_face = front_face;
        }
        if let Some(range) = depth_range(&section)? {
            raster.depth_range = range;
        }
        if let Some(depth_test) = section.bool("depth_test")? {
            raster.depth_test = depth_test;
        }
        if let Some(snap) = snap(&section)? {
            raster.snap = snap;
        }
        if let Some(transparency) = section.choice("transparency", Transparency::NAMES)? {
            raster.transparency = transparency;
        }
        Ok(())
    }

    pub(super) fn trace(&mut self, entry: Entry<'a>) -> Result<(), Error> {
        let Some(section) = self.section(entry, keys::TRACE)? else {
            return Ok(());
        };
        let trace = &mut self.scene.trace;
        if let Some(depth) = section.integer("depth")? {
            trace.depth = depth;
        }
        if let Some(shadow) = section.choice("shadow", Shadow::NAMES)? {
            trace.shadow = shadow;
        }
        if let Some(tir) = section.choice("tir", Tir::NAMES)? {
            trace.tir = tir;
        }
        if let Some(cutoff) = section.number("weight_cutoff")? {
            trace.weight_cutoff = cutoff;
        }
        Ok(())
    }

    /// Reads or fits the camera; the objects are there already.
    pub(super) fn camera(&mut self, entry: Entry<'a>) -> Result<Fitted, Error> {
        let section = self.section(entry, keys::CAMERA)?;
        let image = &self.scene.image;
        let aspect = f64::from(image.width) / f64::from(image.height);
        let stated = section.as_ref().map_or(Ok(View::default()), view)?;
        let mut camera = stated.camera;
        let states_angle = |s: &Section<'a>| s.has("fovy") || s.has("orthographic");
        if section.as_ref().is_some_and(states_angle) {
            self.half_width = None;
        }
        if let Some(half_width) = self.half_width {
            let fovy_deg = vertical_angle(half_width, image);
            camera.projection = Projection::Perspective { fovy_deg };
        }
        let bounds = Bounds::of_objects(&self.scene.objects).unwrap_or(Bounds {
            min: DVec3::NEG_ONE,
            max: DVec3::ONE,
        });
        camera.target = stated.target.unwrap_or_else(|| bounds.center());
        camera.eye = stated.eye.unwrap_or_else(|| {
            let (up, projection) = (camera.up, camera.projection);
            fit::eye(&bounds, camera.target, TOWARD, up, projection, aspect)
        });
        self.check_view(section.as_ref(), &camera)?;
        camera.near = match stated.near {
            Some(near) => near,
            None => fit::near(&camera, &self.scene.objects, aspect),
        };
        if let (Some(section), Some(far)) = (&section, camera.far)
            && far <= camera.near
        {
            let message = format!("expected more than near = {}, found {far}", camera.near);
            return Err(section.error_at("far", message));
        }
        self.scene.camera = camera;
        let fitted = Fitted {
            eye: stated.eye.is_none(),
            target: stated.target.is_none(),
            near: stated.near.is_none(),
        };
        self.note_fit(&fitted);
        Ok(fitted)
    }

    /// Refuses views that have no direction or no upright.
    fn check_view(&self, section: Option<&Section<'a>>, camera: &Camera) -> Result<(), Error> {
        let refuse = |key: &str, message: String| {
            Err(match section {
                Some(section) if section.has(key) => section.error_at(key, message),
                Some(section) => section.error(format!("{key}: {message}")),
                None => Error::input(self.document.whole(), format!("camera: {key}: {message}")),
            })
        };
        let view = camera.target - camera.eye;
        let (forward, distance) = normalize(view.to_array());
        if camera.target == camera.eye {
            let [x, y, z] = camera.eye.to_array();
            return refuse("target", format!("the same point as eye, [{x}, {y}, {z}]"));
        }
        if !view.length_squared().is_normal() {
            let message = format!("the distance {distance:e} from the eye is out of range");
            return refuse("target", message);
        }
        if !camera.up.length_squared().is_normal() {
            return refuse("up", "its length is out of range".into());
        }
        let (up, _) = normalize(camera.up.to_array());
        let sine = DVec3::from_array(forward)
            .cross(DVec3::from_array(up))
            .length();
        if sine.is_nan() || sine < LEAST_SINE {
            let [x, y, z] = camera.up.to_array();
            let message = format!("[{x}, {y}, {z}] is parallel to the view from eye to target");
            return refuse("up", message);
        }
        Ok(())
    }

    fn note_fit(&mut self, fitted: &Fitted) {
        let [x, y, z] = self.scene.camera.eye.to_array();
        let message = match (fitted.eye, fitted.target) {
            (true, _) => format!("camera: eye fitted to the scene at [{x:.4}, {y:.4}, {z:.4}]"),
            (false, true) => "camera: target set to the middle of the scene".into(),
            (false, false) => return,
        };
        self.note(None, message);
    }
}

/// What `[camera]` says; `camera` has the rest.
#[derive(Default)]
struct View {
    eye: Option<DVec3>,
    target: Option<DVec3>,
    near: Option<f64>,
    camera: Camera,
}

fn view(section: &Section<'_>) -> Result<View, Error> {
    let camera = Camera {
        up: section.direction("up")?.unwrap_or(DVec3::Y),
        far: section.number("far")?,
        projection: projection(section)?,
        ..Camera::default()
    };
    Ok(View {
        eye: section.vector("eye")?,
        target: section.vector("target")?,
        near: section.number("near")?,
        camera,
    })
}

fn projection(section: &Section<'_>) -> Result<Projection, Error> {
    let fovy = section.number("fovy")?;
    match (fovy, section.number("orthographic")?) {
        (Some(_), Some(_)) => Err(section
            .error_at("fovy", "a parallel view has no angle")
            .with_help("remove fovy or orthographic")),
        (None, Some(height)) => Ok(Projection::Orthographic { height }),
        (fovy_deg, None) => Ok(Projection::Perspective {
            fovy_deg: fovy_deg.unwrap_or(45.0),
        }),
    }
}

fn depth_range(section: &Section<'_>) -> Result<Option<[f64; 2]>, Error> {
    let Some(node) = section.get("depth_range") else {
        return Ok(None);
    };
    let expected = "[near, far], each from 0 to 1";
    let range: [f64; 2] = section.array("depth_range", node, expected)?;
    let within = |x: f64| DVec2::new(x, 1.0 - x).min_element() >= 0.0;
    if range.into_iter().all(within) {
        Ok(Some(range))
    } else {
        let [near, far] = range;
        let message = format!("expected {expected}, found [{near}, {far}]");
        Err(section.error_at("depth_range", message))
    }
}

fn snap(section: &Section<'_>) -> Result<Option<Snap>, Error> {
    let Some(node) = section.get("snap") else {
        return Ok(None);
    };
    match &node.value {
        Value::Integer(8) => Ok(Some(Snap::Bits8)),
        Value::Integer(12) => Ok(Some(Snap::Bits12)),
        Value::Text(text) if text == "exact" => Ok(Some(Snap::Exact)),
        _ => Err(section.mismatch("snap", node, "8, 12 or \"exact\"")),
    }
}
