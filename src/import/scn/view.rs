//! `camera`, and the end of a reading: defaults, notes, and the document that holds all but materials and objects.

use std::f64::consts::FRAC_PI_2;

use super::command::Command;
use super::{File, Loaded, Reader};
use crate::error::{Error, Place};
use crate::math::{DAffine3, DVec3};
use crate::scene::fit::Bounds;

/// Sine of the smallest angle between view and up that still says which way is up.
const LEAST_SINE: f64 = 1e-9;

/// An eye at so many times the length of the viewing direction would cost the sum of both 20 of its 53 bits.
const FAR_EYE: f64 = (1 << 20) as f64;

/// A camera.
#[derive(Clone, Copy, Debug)]
pub(super) struct View {
    eye: DVec3,
    towards: DVec3,
    up: DVec3,
    /// Half of the horizontal angle, radians.
    xfov: f64,
    near: Option<f64>,
    far: Option<f64>,
}

impl View {
    /// A point in the viewing direction, far enough for the sum with distant eyes to keep the direction's digits.
    fn target(&self) -> DVec3 {
        let (eye, towards) = (
            self.eye.abs().max_element(),
            self.towards.abs().max_element(),
        );
        if eye > FAR_EYE * towards {
            self.eye + self.towards * (eye / towards)
        } else {
            self.eye + self.towards
        }
    }
}

/// Numbers as a TOML list, every digit kept.
pub(super) fn list(numbers: &[f64]) -> String {
    format!("{numbers:?}")
}

impl Reader<'_> {
    /// `camera`; the last one counts.
    pub(super) fn camera(
        &mut self,
        file: &File,
        command: &mut Command<'_, '_>,
    ) -> Result<(), Error> {
        let eye = command.vector("the eye")?;
        let (towards, _) = command.direction("the viewing direction")?;
        let (up, up_token) = command.direction("up")?;
        let sine = towards.normalize().cross(up.normalize()).length();
        if sine.is_nan() || sine < LEAST_SINE {
            let message = "up is parallel to the viewing direction";
            return Err(command.error(&up_token, message));
        }
        let (xfov, token) = command.number("xfov")?;
        if !(xfov > 0.0 && xfov < FRAC_PI_2) {
            let message = format!("expected xfov between 0 and pi/2, found {xfov}");
            let help = "xfov is half of the horizontal angle of view, in radians";
            return Err(command.error(&token, message).with_help(help));
        }
        let (near, far) = (command.number("near")?.0, command.number("far")?.0);
        let view = View {
            eye,
            towards,
            up,
            xfov,
            near: (near > 0.0).then_some(near),
            far: (far > near.max(0.0)).then_some(far),
        };
        if view.near.is_none() {
            let message =
                format!("camera: near {near} cannot be used: fitted to the scene instead");
            self.note_at(command, "(near)", message);
        }
        if view.far.is_none() {
            let message = format!("camera: far {far} cannot be used: there is no far plane");
            self.note_at(command, "(far)", message);
        }
        if self.view.replace(view).is_some() {
            self.note_at(
                command,
                "(camera)",
                "camera: replaces the one before it".into(),
            );
        }
        let group = file.group();
        if group.is_some_and(|g| g.begin.is_some() && g.world_from_group != DAffine3::IDENTITY) {
            let message = "camera: it is not moved by the group it stands in".into();
            self.note_at(command, "(moved camera)", message);
        }
        Ok(())
    }

    /// Defaults and notes.
    pub(super) fn finish(mut self, file: &str) -> Result<Loaded, Error> {
        let lines = self.counts.get("line").copied().unwrap_or(0);
        if self.contents.objects.is_empty() {
            let place = self
                .first_line
                .unwrap_or_else(|| Place::file(self.home.name(file)));
            let message = match lines {
                0 => "the scene has no surface to draw",
                _ => "the scene holds only lines, which are not drawn",
            };
            let help = "add a tri, box, sphere, cylinder, cone or mesh";
            return Err(Error::input(place, message).with_help(help));
        }
        if let Some(place) = self.first_line.take() {
            let message = match lines {
                1 => "a line is not drawn: only the course's viewer shows it".into(),
                n => format!("{n} lines are not drawn: only the course's viewer shows them"),
            };
            self.note(Some(place), message);
        }
        let view = match self.view {
            Some(view) => view,
            None => self.default_view(),
        };
        self.face_the_eye(view.eye);
        if self.light_count == 0 {
            self.note(
                None,
                "the file has no lights: the format's two, light.dir1 and light.dir2, are used",
            );
            self.lights = DEFAULT_LIGHTS.into();
        }
        self.note(None, CONVENTIONS);
        self.contents.half_width = Some(libm::tan(view.xfov));
        let document = self.document(&view);
        Ok(Loaded {
            contents: self.contents,
            document,
            notes: self.notes,
        })
    }

    /// Toward -z from three half diagonals off the middle.
    fn default_view(&mut self) -> View {
        let objects = Bounds::of_objects(&self.contents.objects);
        let bounds = match (objects, self.line_bounds) {
            (Some(a), Some(b)) => Some(a.union(&b)),
            (a, b) => a.or(b),
        };
        let center = bounds.map_or(DVec3::ZERO, |b| b.center());
        let radius = bounds.map_or(1.0, |b| b.diagonal() / 2.0);
        let usable = center.is_finite() && radius.is_normal();
        let (center, radius) = if usable {
            (center, radius)
        } else {
            (DVec3::ZERO, 1.0)
        };
        let eye = center + DVec3::Z * (3.0 * radius);
        let [x, y, z] = eye.to_array();
        let message = format!(
            "the file has no camera: the format's looks toward -z from [{x:.4}, {y:.4}, {z:.4}]"
        );
        self.note(None, message);
        View {
            eye,
            towards: DVec3::NEG_Z * radius,
            up: DVec3::Y,
            xfov: 0.25,
            near: Some(0.01 * radius),
            far: Some(100.0 * radius),
        }
    }

    fn document(&self, view: &View) -> String {
        let color = |c: Option<[f64; 3]>| list(&c.unwrap_or_default());
        let [eye, target, up] = [view.eye, view.target(), view.up].map(|v| list(&v.to_array()));
        let mut text = format!(
            "[image]\nbackground = {}\n[light_model]\nambient = {}\nspecular_model = \"reflection\"\n\
             [camera]\neye = {eye}\ntarget = {target}\nup = {up}\n",
            color(self.background),
            color(self.ambient),
        );
        for (key, value) in [("near", view.near), ("far", view.far)] {
            if let Some(value) = value {
                text += &format!("{key} = {value:?}\n");
            }
        }
        text + &self.lights
    }
}

/// The lights of a file that has none.
const DEFAULT_LIGHTS: &str = "\
[light.dir1]
direction = [-3.0, -4.0, -5.0]
[light.dir2]
direction = [3.0, 2.0, 3.0]
diffuse = 0.5
";

/// What a reader of the picture should know.
const CONVENTIONS: &str = "highlights are the course tracer's, (V.R)^n, and mirrors weigh ks; the course's OpenGL viewer \
    has the half vector's: --set light_model.specular_model=half-vector";
