//! The exact shapes of `[object.NAME]`.

use std::sync::Arc;

use super::Reader;
use crate::error::Error;
use crate::import::document::{Node, Value};
use crate::import::keys::{MAX_TESSELLATED, MAX_TILES, Range};
use crate::import::reader::Section;
use crate::math::DVec3;
use crate::scene::profile::{MAX_POINTS, Profile};
use crate::scene::tessellate::{DEFAULT_LEVEL, triangle_count};
use crate::scene::{Curve, Geometry, Shape};

/// Shapes whose level counts slices of a full turn.
const ROUND: &[&str] = &[
    "sphere",
    "disk",
    "cylinder",
    "cone",
    "torus",
    "revolution",
    "bezier",
    "teapot",
];

impl<'a> Reader<'a> {
    pub(super) fn shape(
        &mut self,
        section: &Section<'a>,
        tessellation: Option<u32>,
    ) -> Result<Geometry, Error> {
        let name = section.text("shape")?.unwrap_or_default();
        if let (Some(level), true) = (tessellation, ROUND.contains(&name))
            && level < 3
        {
            let message = format!("expected a whole number from 3 to 4096, found {level}");
            return Err(section.error_at("tessellation", message));
        }
        let shape = match name {
            "sphere" => Shape::Sphere {
                center: section.vector("center")?.unwrap_or_default(),
                radius: section.number("radius")?.unwrap_or(1.0),
            },
            "plane" => plane(section)?,
            "quad" if section.has("points") => {
                for key in ["corner", "edge_u", "edge_v", "tessellation"] {
                    if section.has(key) {
                        let message = "does not go with `points`";
                        return Err(section.error_at(key, message));
                    }
                }
                return Ok(Geometry::Mesh(Arc::new(self.corner_quad(section)?)));
            }
            "quad" => quad(section)?,
            "box" => cuboid(section)?,
            "disk" => disk(section)?,
            "cylinder" => cylinder(section)?,
            "cone" => cone(section)?,
            "torus" => torus(section)?,
            "revolution" => revolution(section)?,
            "bezier" => self.bezier(section)?,
            "teapot" => super::bezier::teapot(section)?,
            _ => floor(section)?,
        };
        self.count_triangles(section, &shape, tessellation)?;
        Ok(Geometry::Shape(shape))
    }

    /// Refuses levels and tiles that together ask for more triangles than a file may.
    pub(super) fn count_triangles(
        &mut self,
        section: &Section<'_>,
        shape: &Shape,
        tessellation: Option<u32>,
    ) -> Result<(), Error> {
        let level = tessellation.unwrap_or(DEFAULT_LEVEL);
        let triangles = triangle_count(shape, level, tessellation.unwrap_or(1));
        self.tessellated += triangles;
        if self.tessellated > MAX_TESSELLATED {
            let message = format!(
                "the scene's shapes ask for {} triangles, more than {MAX_TESSELLATED}",
                self.tessellated
            );
            return Err(section
                .error(message)
                .with_help("lower tessellation or tiles"));
        }
        Ok(())
    }
}

/// A patch through `center`, u to the right as seen from the front with y up.
fn plane(section: &Section<'_>) -> Result<Shape, Error> {
    let center = section.vector("center")?.unwrap_or_default();
    let normal = section.direction("normal")?.unwrap_or(DVec3::Y);
    let [width, depth] = size(section)?;
    let n = DVec3::from_array(crate::math::float::normalize(normal.to_array()).0);
    let sideways = n.x == 0.0 && n.z == 0.0;
    let u = if sideways {
        DVec3::X
    } else {
        DVec3::Y.cross(n).normalize()
    };
    let v = n.cross(u);
    let (edge_u, edge_v) = (u * width, v * depth);
    let corner = center - edge_u / 2.0 - edge_v / 2.0;
    // Adding 0 turns the -0 of a cross product into +0.
    let [corner, edge_u, edge_v] = [corner, edge_u, edge_v].map(|x| x + DVec3::ZERO);
    checked_patch(section, corner, edge_u, edge_v, [1, 1])
}

fn quad(section: &Section<'_>) -> Result<Shape, Error> {
    let part = |key: &str| {
        let found = section.vector(key)?;
        found.ok_or_else(|| {
            section.error(format!(
                "expected `points`, or `corner`, `edge_u` and `edge_v`; `{key}` is missing"
            ))
        })
    };
    let (corner, edge_u, edge_v) = (part("corner")?, part("edge_u")?, part("edge_v")?);
    checked_patch(section, corner, edge_u, edge_v, [1, 1])
}

fn checked_patch(
    section: &Section<'_>,
    corner: DVec3,
    edge_u: DVec3,
    edge_v: DVec3,
    tiles: [u32; 2],
) -> Result<Shape, Error> {
    let normal = edge_u.cross(edge_v);
    if !(normal.length_squared().is_normal() && (corner + edge_u + edge_v).is_finite()) {
        return Err(section.error("its sides span no area that can be computed with"));
    }
    Ok(Shape::Patch {
        corner,
        edge_u,
        edge_v,
        tiles,
    })
}

fn disk(section: &Section<'_>) -> Result<Shape, Error> {
    Ok(Shape::Disk {
        center: section.vector("center")?.unwrap_or_default(),
        normal: section.direction("normal")?.unwrap_or(DVec3::Y),
        radius: section.number("radius")?.unwrap_or(1.0),
    })
}

fn cylinder(section: &Section<'_>) -> Result<Shape, Error> {
    let [base, top] = ends(section, "base", "top")?;
    Ok(Shape::Cylinder {
        base,
        top,
        radius: section.number("radius")?.unwrap_or(1.0),
        caps: section.bool("caps")?.unwrap_or(true),
    })
}

fn cone(section: &Section<'_>) -> Result<Shape, Error> {
    let [base, apex] = ends(section, "base", "apex")?;
    Ok(Shape::Cone {
        base,
        apex,
        radius: section.number("radius")?.unwrap_or(1.0),
        cap: section.bool("cap")?.unwrap_or(true),
    })
}

/// Two different points; the second is 1 above the origin where it is omitted.
fn ends(section: &Section<'_>, from: &str, to: &str) -> Result<[DVec3; 2], Error> {
    let base = section.vector(from)?.unwrap_or_default();
    let top = section.vector(to)?.unwrap_or(DVec3::Y);
    if base == top {
        let key = if section.has(to) { to } else { from };
        let message = format!("expected `{from}` and `{to}` to be different points");
        return Err(section.error_at(key, message));
    }
    Ok([base, top])
}

fn torus(section: &Section<'_>) -> Result<Shape, Error> {
    let major = section.number("major_radius")?.unwrap_or(1.0);
    let minor = section.number("minor_radius")?.unwrap_or(0.25);
    if minor >= major {
        let key = ["minor_radius", "major_radius"]
            .into_iter()
            .find(|key| section.has(key))
            .unwrap_or("minor_radius");
        let message =
            format!("expected minor_radius below major_radius, found {minor} and {major}");
        return Err(section.error_at(key, message));
    }
    Ok(Shape::Torus {
        center: section.vector("center")?.unwrap_or_default(),
        axis: section.direction("axis")?.unwrap_or(DVec3::Y),
        major,
        minor,
    })
}

fn revolution(section: &Section<'_>) -> Result<Shape, Error> {
    let expected = "points [radius, height]";
    let Some(items) = section.list("profile", expected)? else {
        return Err(section.error(format!("expected a `profile`: {expected}")));
    };
    if items.len() > MAX_POINTS {
        let message = format!(
            "expected at most {MAX_POINTS} points, found {}",
            items.len()
        );
        return Err(section.error_at("profile", message));
    }
    let point = |node: &Node| section.array::<2>("profile", node, "a point [radius, height]");
    let points: Vec<[f64; 2]> = items.iter().map(point).collect::<Result<_, _>>()?;
    let curve = section.choice("curve", Curve::NAMES)?.unwrap_or_default();
    let profile = Profile::new(curve, &points).map_err(|flaw| match flaw.point {
        Some(i) => {
            let message = format!("profile: point {}: {}", i + 1, flaw.message);
            section.document.error(&items[i].span, message)
        }
        None => section.error_at("profile", flaw.message),
    })?;
    Ok(Shape::Revolution {
        base: section.vector("base")?.unwrap_or_default(),
        axis: section.direction("axis")?.unwrap_or(DVec3::Y),
        profile: Arc::new(profile),
    })
}

fn cuboid(section: &Section<'_>) -> Result<Shape, Error> {
    let (min, max) = match (section.vector("min")?, section.vector("max")?) {
        (Some(min), Some(max)) => {
            for key in ["center", "size"] {
                if section.has(key) {
                    return Err(section.error_at(key, "does not go with `min` and `max`"));
                }
            }
            (min, max)
        }
        (None, None) => {
            let center = section.vector("center")?.unwrap_or_default();
            let half = box_size(section)? / 2.0;
            (center - half, center + half)
        }
        _ => return Err(section.error("`min` and `max` go together")),
    };
    if !(min.cmplt(max).all() && (max - min).is_finite()) {
        let message = "expected each coordinate of `min` below that of `max`";
        return Err(section.error_at("max", message));
    }
    Ok(Shape::Box { min, max })
}

fn box_size(section: &Section<'_>) -> Result<DVec3, Error> {
    let above = Range::Above(0.0);
    match section.get("size") {
        None => Ok(DVec3::ONE),
        Some(node) => match &node.value {
            Value::List(items) if items.len() == 3 => {
                let mut size = [0.0; 3];
                for (x, item) in size.iter_mut().zip(items) {
                    *x = section.number_of("size", item, above)?;
                }
                Ok(DVec3::from_array(size))
            }
            Value::List(_) => Err(section.mismatch("size", node, "a number or [x, y, z]")),
            _ => section.number_of("size", node, above).map(DVec3::splat),
        },
    }
}

/// A floor that faces +y: u runs along +x, v along -z (so that u x v = +y).
fn floor(section: &Section<'_>) -> Result<Shape, Error> {
    let center = section.vector("center")?.unwrap_or_default();
    let [width, depth] = size(section)?;
    let corner = center + DVec3::new(-width / 2.0, 0.0, depth / 2.0);
    let (edge_u, edge_v) = (DVec3::X * width, DVec3::new(0.0, 0.0, -depth));
    checked_patch(section, corner, edge_u, edge_v, tiles(section)?)
}

fn size(section: &Section<'_>) -> Result<[f64; 2], Error> {
    let above = Range::Above(0.0);
    match section.get("size") {
        None => Ok([10.0; 2]),
        Some(node) => match &node.value {
            Value::List(items) if items.len() == 2 => Ok([
                section.number_of("size", &items[0], above)?,
                section.number_of("size", &items[1], above)?,
            ]),
            Value::List(_) => Err(section.mismatch("size", node, "a number or [width, depth]")),
            _ => section.number_of("size", node, above).map(|x| [x; 2]),
        },
    }
}

fn tiles(section: &Section<'_>) -> Result<[u32; 2], Error> {
    let one = |node: &Node| section.integer_of("tiles", node, 1, MAX_TILES);
    match section.get("tiles") {
        None => Ok([10; 2]),
        Some(node) => match &node.value {
            Value::List(items) if items.len() == 2 => Ok([one(&items[0])?, one(&items[1])?]),
            Value::List(_) => Err(section.mismatch("tiles", node, "a whole number or two")),
            _ => one(node).map(|x| [x; 2]),
        },
    }
}
