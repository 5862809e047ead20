//! `transform`: a list of steps, applied to the object's points in the order written.

use super::Reader;
use crate::error::Error;
use crate::import::document::{Node, Value};
use crate::import::keys::{self, Range};
use crate::import::reader::Section;
use crate::math::float::normalize;
use crate::math::{DAffine3, DMat3, DVec3};

impl<'a> Reader<'a> {
    /// Object to world: the last step stands leftmost.
    pub(super) fn transform(&self, section: &Section<'a>) -> Result<DAffine3, Error> {
        let expected = "a list of steps such as [{ translate = [0, 1, 0] }]";
        let steps = section.list("transform", expected)?.unwrap_or_default();
        let mut world_from_object = DAffine3::IDENTITY;
        for (index, node) in steps.iter().enumerate() {
            let path = format!("{}.transform[{index}]", section.path);
            let span = node.span.clone();
            let step = Section::open(self.document, path, span, node, &[keys::STEPS])?;
            world_from_object = self.step(&step)? * world_from_object;
        }
        let det = world_from_object.matrix3.determinant();
        if !world_from_object.is_finite() || !det.is_finite() {
            return Err(section.error_at("transform", "the steps together leave the number range"));
        }
        if det == 0.0 {
            return Err(section.error_at("transform", "the steps together flatten the object"));
        }
        Ok(world_from_object)
    }

    fn step(&self, step: &Section<'a>) -> Result<DAffine3, Error> {
        let (key, node) = step.only()?;
        match key.name.as_str() {
            "translate" => {
                let offset = step.vector_of("translate", node)?;
                Ok(DAffine3::from_translation(offset))
            }
            "scale" => Ok(DAffine3::from_scale(scale(step, node)?)),
            "rotate" => {
                let path = format!("{}.rotate", step.path);
                let span = node.span.clone();
                let turn = Section::open(self.document, path, span, node, &[keys::ROTATE])?;
                rotation(&turn)
            }
            _ => matrix(step, node),
        }
    }
}

fn scale(step: &Section<'_>, node: &Node) -> Result<DVec3, Error> {
    let factors = match &node.value {
        Value::Integer(_) | Value::Float(_) => {
            DVec3::splat(step.number_of("scale", node, Range::Any)?)
        }
        _ => {
            let expected = "a number or three, [x, y, z]";
            DVec3::from_array(step.array("scale", node, expected)?)
        }
    };
    if factors.to_array().contains(&0.0) {
        return Err(step.error_at("scale", "expected factors other than 0"));
    }
    Ok(factors)
}

fn rotation(turn: &Section<'_>) -> Result<DAffine3, Error> {
    let missing = |key: &str| turn.error(format!("expected `{key}`"));
    let axis = turn.direction("axis")?.ok_or_else(|| missing("axis"))?;
    let degrees = turn.number("degrees")?.ok_or_else(|| missing("degrees"))?;
    let (axis, _) = normalize(axis.to_array());
    let (sin, cos) = sin_cos_degrees(degrees);
    // Rodrigues: c I + (1 - c) a a^T + s [a]x, column by column.
    let a = DVec3::from_array(axis);
    let column = |e: DVec3| e * cos + a * (a.dot(e) * (1.0 - cos)) + a.cross(e) * sin;
    let matrix = DMat3::from_cols(column(DVec3::X), column(DVec3::Y), column(DVec3::Z));
    Ok(DAffine3::from_mat3(matrix))
}

/// Sine and cosine of an angle in degrees, exact at the quarter turns.
fn sin_cos_degrees(degrees: f64) -> (f64, f64) {
    let turn = degrees.rem_euclid(360.0);
    match turn {
        0.0 => (0.0, 1.0),
        90.0 => (1.0, 0.0),
        180.0 => (0.0, -1.0),
        270.0 => (-1.0, 0.0),
        _ => (libm::sin(turn.to_radians()), libm::cos(turn.to_radians())),
    }
}

fn matrix(step: &Section<'_>, node: &Node) -> Result<DAffine3, Error> {
    let expected = "four rows of four numbers, or 16 numbers row by row";
    let m: [f64; 16] = step.rows("matrix", node, expected)?;
    if m[12..] != [0.0, 0.0, 0.0, 1.0] {
        let message = "expected the last row 0, 0, 0, 1 (no projection)";
        return Err(step
            .error_at("matrix", message)
            .with_help("numbers stand row by row; the translation is the last of each row"));
    }
    let column = |i: usize| DVec3::new(m[i], m[4 + i], m[8 + i]);
    let linear = DMat3::from_cols(column(0), column(1), column(2));
    Ok(DAffine3::from_mat3_translation(linear, column(3)))
}
