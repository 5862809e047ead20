//! An [`Explanation`] as plain values: what `explain --json` prints and everything that the text and the figure need.
//!
//! Points and directions in world space. Colours linear and unclamped, exact: an f32 render's numbers are f32 numbers. What JSON
//! has no number for, an infinite distance or colour, is null there.

use serde::{Serialize, Serializer};

use crate::math::color::Rgb;
use crate::trace::record::Kind;

/// A point or direction, world space.
pub type Vector = [f64; 3];

/// Everything that makes up one pixel in both renderers.
#[derive(Clone, Debug, Serialize)]
pub struct Explanation {
    /// Name of the scene.
    pub scene: String,
    /// X and Y, from the top left.
    pub pixel: [u32; 2],
    /// Width and height of the picture.
    pub size: [u32; 2],
    /// `f32` or `f64`: the precision of both renderers.
    pub precision: &'static str,
    /// `half-vector` (N.H) or `reflection` (V.R): the form of the highlight.
    pub specular_model: &'static str,
    /// I_AL: the ambient light of the scene.
    pub scene_ambient: Rgb,
    /// Its lights, the enabled ones in the order of the file.
    pub lights: Vec<Light>,
    /// Where the pixel has several samples: which one is explained, and all their colours.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub samples: Option<Samples>,
    /// The rasterizer's side.
    pub raster: Raster,
    /// The tracer's side.
    pub trace: Trace,
    /// `trace.png` minus `raster.png` at this pixel, exact.
    pub difference: Rgb,
    /// The steps of the ladder, which add up to the difference exactly.
    pub causes: Vec<Cause>,
    /// The ten values of the ladder, from `raster.png` to `trace.png`.
    pub rungs: Vec<Rgb>,
    /// Some value was beyond 2^20 and limited for the ladder.
    pub limited: bool,
}

/// One step of the ladder.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Cause {
    /// Its name, as in `decompose::CAUSES`.
    pub name: &'static str,
    /// What it adds.
    pub rgb: Rgb,
}

/// A light source of the scene.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Light {
    /// Its name.
    pub name: String,
    /// Where it is; none for a directional light.
    pub position: Option<Vector>,
    /// Unit direction to a directional light; none for one with a place.
    pub to_light: Option<Vector>,
    /// Ambient part of I_L.
    pub ambient: Rgb,
    /// Diffuse part of I_L.
    pub diffuse: Rgb,
    /// Specular part of I_L.
    pub specular: Rgb,
    /// Constant, linear and quadratic attenuation.
    pub attenuation: [f64; 3],
    /// Half angle of its cone in degrees; 180 = none.
    pub spot_cutoff: f64,
    /// Exponent of the falloff inside the cone.
    pub spot_exponent: f64,
}

/// The samples of a pixel: its colour is their mean, summed in this order in f64 and rounded once.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Samples {
    /// Number of the sample that terms, hits and rays belong to: the one nearest to the centre.
    pub shown: usize,
    /// Where each lies in the pixel, from its top left corner.
    pub places: Vec<[f64; 2]>,
    /// What the rasterizer makes of each.
    pub raster: Vec<Rgb>,
    /// What the tracer makes of each.
    pub trace: Vec<Rgb>,
}

/// The rasterizer's side of a pixel.
#[derive(Clone, Debug, Serialize)]
pub struct Raster {
    /// The pixel of the float picture, unclamped.
    pub color: Rgb,
    /// The pixel of the PNG: clamped as GL does, 8 bits, no gamma.
    pub stored: [u8; 3],
    /// `flat`, `gouraud` or `phong`.
    pub shading: &'static str,
    /// The terms of the surface that is seen, as interpolated over it; of the background as emission.
    pub terms: Terms,
    /// The surface that is seen: the opaque one where transmissive surfaces are blended.
    pub hit: Option<Hit>,
    /// Gouraud: the three vertices that the colour is interpolated from. Flat: the provoking vertex.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub vertices: Vec<Vertex>,
    /// Transmissive surfaces blended over it, in this order.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub blended: Vec<Blended>,
    /// Always null: no mirror in the rasterizer.
    pub reflection: (),
    /// Always null: nothing is seen through a surface in the rasterizer.
    pub refraction: (),
}

/// A vertex and its light.
#[derive(Clone, Debug, Serialize)]
pub struct Vertex {
    /// Perspective-correct weight at the pixel.
    pub weight: f64,
    /// Sum of its terms, unclamped.
    pub color: Rgb,
    /// Where it is.
    pub point: Vector,
    /// Its unit normal, turned to the side that is lit.
    pub normal: Vector,
    /// Its terms.
    pub terms: Terms,
}

/// A transmissive surface: alpha times its colour plus 1 - alpha times what was there.
#[derive(Clone, Debug, Serialize)]
pub struct Blended {
    /// 1 - luminance(K_T).
    pub alpha: f64,
    /// Its colour.
    pub color: Rgb,
    /// Its terms.
    pub terms: Terms,
    /// Where it is.
    pub hit: Hit,
    /// As in [`Raster::vertices`].
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub vertices: Vec<Vertex>,
}

/// The terms of the equation at one point; the local colour is their sum in this order.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Terms {
    /// I_E; the background where nothing is hit.
    pub emission: Rgb,
    /// K_A I_AL.
    pub ambient: Rgb,
    /// What each light adds.
    pub lights: Vec<LightTerms>,
    /// Where the terms are interpolated or blended: what rounding leaves between their sum and the colour.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub remainder: Option<Rgb>,
    /// The material's side of the equation; none where the terms are interpolated, and on the background.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub material: Option<Coefficients>,
}

/// K_E, K_A, K_D, K_S and n of the side that is lit, vertex colours put in.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Coefficients {
    /// I_E.
    pub emission: Rgb,
    /// K_A.
    pub ambient: Rgb,
    /// K_D.
    pub diffuse: Rgb,
    /// K_S.
    pub specular: Rgb,
    /// n.
    pub shininess: f64,
}

/// What one light adds.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct LightTerms {
    /// Its name.
    pub name: String,
    /// How it reaches the point; none where terms are interpolated from vertices, which have their own.
    #[serde(flatten)]
    pub factors: Option<Factors>,
    /// K_A times its ambient part, attenuated.
    pub ambient: Rgb,
    /// K_D (N.L) S_L I_L.
    pub diffuse: Rgb,
    /// K_S (V.R)^n S_L I_L, or with N.H.
    pub specular: Rgb,
}

/// How a light reaches a point.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Factors {
    /// L: unit direction to the light.
    pub to_light: Vector,
    /// Distance to it; infinite for a directional light.
    pub distance: f64,
    /// N.L, signed: at or below 0 the light adds neither diffuse nor specular.
    pub n_dot_l: f64,
    /// N.H, signed, under the half-vector form.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub n_dot_h: Option<f64>,
    /// V.R, signed, under the reflection form.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub v_dot_r: Option<f64>,
    /// 1 / (c + l d + q d^2).
    pub attenuation: f64,
    /// The spot factor: 0 outside the cone, 1 without one.
    pub spot: f64,
    /// S_L; none where no shadow ray was needed: the light faces away or has nothing to add here.
    #[serde(serialize_with = "grey_as_number")]
    pub shadow: Option<Rgb>,
    /// The object that blocks the light: the nearest one.
    pub blocker: Option<String>,
    /// Filtered shadows: every surface that takes light, nearest first, by the names of the objects.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub filters: Vec<String>,
    /// Where the blocker stops the light.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub blocked_at: Option<Vector>,
}

/// A place on a surface.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Hit {
    /// Parameter of the ray: the point is origin + t direction.
    pub t: f64,
    /// Distance from the ray's origin.
    pub distance: f64,
    /// The point.
    pub point: Vector,
    /// Unit normal as the equation took it, on the side that is lit. Where terms are interpolated, the triangle's.
    pub normal: Vector,
    /// The ray arrives inside a transmissive solid.
    pub inside: bool,
    /// The surface is seen from its back.
    pub back: bool,
    /// Angle between the arriving ray and the normal, degrees, 0 to 90.
    pub incidence_deg: f64,
    /// Name of the object.
    pub object: String,
    /// Name of its material.
    pub material: String,
    /// Number of the triangle within the object, for the rasterizer.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub triangle: Option<u32>,
}

/// The tracer's side of a pixel. As JSON the primary ray is the object itself, and secondary rays are nested in it
/// (`explain::nested`).
#[derive(Clone, Debug)]
pub struct Trace {
    /// The pixel of the float picture, unclamped.
    pub color: Rgb,
    /// The pixel of the PNG.
    pub stored: [u8; 3],
    /// The rays, generation by generation; the first is the primary one. A ray's number is its place here.
    pub rays: Vec<Ray>,
}

/// A ray and the light that it brings back.
#[derive(Clone, Debug)]
pub struct Ray {
    /// How it came about.
    pub kind: Kind,
    /// Number of the ray whose hit it leaves.
    pub parent: Option<usize>,
    /// 0 for the primary ray.
    pub generation: u32,
    /// Where it starts.
    pub origin: Vector,
    /// Where it goes, as it was traced: of unit length but for primary rays.
    pub direction: Vector,
    /// Product of the weights from the eye on; 1 for the primary ray.
    pub weight: Rgb,
    /// It runs inside a transmissive solid.
    pub inside: bool,
    /// Index of refraction of what it runs through.
    pub ior: f64,
    /// The light that it brings: its terms, and what its hit reflects and transmits. For the primary ray, of the sample that
    /// is shown, as the picture has it.
    pub color: Rgb,
    /// What it and all that follows from it add to the pixel.
    pub contribution: Rgb,
    /// The local terms of its hit.
    pub terms: Terms,
    /// What it meets; none = the background.
    pub hit: Option<Hit>,
    /// The mirror's part.
    pub reflection: Option<Reflection>,
    /// The transmitted part.
    pub refraction: Option<Refraction>,
    /// Mirrored or transmitted rays would leave here, but the depth is reached.
    pub depth_reached: bool,
}

/// K_S I_R (or the material's own mirror weight) at a hit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reflection {
    /// Weight at this hit.
    pub weight: Rgb,
    /// I_R.
    pub color: Rgb,
    /// What it adds to the pixel: the weights from the eye on, times I_R. At the primary hit the pixel's own layer.
    pub contribution: Rgb,
    /// Number of the ray; none where it was not cast: its weight is 0 or below the cut-off, or rays of this kind are off.
    pub ray: Option<usize>,
}

/// K_T I_T at a hit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refraction {
    /// Weight at this interface: K_T, less Fresnel's share.
    pub weight: Rgb,
    /// n_i before and n_r behind the surface.
    pub eta: [f64; 2],
    /// The part of K_T that Fresnel's equations, or total reflection under `tir = "reflect"`, give to the mirror.
    pub fresnel: f64,
    /// Unit direction of the transmitted ray; none at total internal reflection.
    pub direction: Option<Vector>,
    /// Angle between it and the normal, degrees.
    pub angle_deg: Option<f64>,
    /// Total internal reflection: there is no transmitted ray.
    pub tir: bool,
    /// I_T.
    pub color: Rgb,
    /// As [`Reflection::contribution`].
    pub contribution: Rgb,
    /// As [`Reflection::ray`].
    pub ray: Option<usize>,
}

/// A grey as a number, as in scene files.
fn grey_as_number<S: Serializer>(value: &Option<Rgb>, serializer: S) -> Result<S::Ok, S::Error> {
    match value {
        Some([r, g, b]) if r == g && g == b => r.serialize(serializer),
        other => other.serialize(serializer),
    }
}
