//! The five kinds of light source, as `[light.NAME]` sections.

use std::f64::consts::PI;

use super::command::Command;
use super::view::list;
use super::{File, MAX_LIGHTS, Reader};
use crate::error::Error;
use crate::math::{DAffine3, DVec3};

impl Reader<'_> {
    pub(super) fn light(
        &mut self,
        file: &File,
        command: &mut Command<'_, '_>,
    ) -> Result<(), Error> {
        let color = command.color("the colour")?;
        let body = match command.word {
            "dir_light" => {
                let (direction, _) = command.direction("the direction")?;
                format!("direction = {}\n", list(&direction.to_array()))
            }
            "point_light" => positional(command, "the position", |_| Ok(()))?,
            "spot_light" => spot(command)?,
            "area_light" => positional(command, "the centre", |command| {
                command.direction("the direction")?;
                command.positive("the radius").map(drop)
            })?,
            _ => positional(command, "the centre", |command| {
                command.direction("the first axis")?;
                command.direction("the second axis")?;
                command.positive("the first length")?;
                command.positive("the second length").map(drop)
            })?,
        };
        if self.light_count >= MAX_LIGHTS {
            let message = format!("the scene has more than {MAX_LIGHTS} lights");
            return Err(command.error(&command.token, message));
        }
        self.light_count += 1;
        let count = self.count(command.word);
        let kind = command.word.trim_end_matches("_light");
        let name = format!("{kind}{count}");
        self.lights += &format!("[light.{name}]\n{body}diffuse = {}\n", list(&color));
        if matches!(kind, "area" | "rect") {
            let message = format!(
                "light {name}: a light with an area becomes a point light at its centre: it shines all round, \
                 and its shadows are sharp"
            );
            self.note_at(command, "(area)", message);
        }
        let group = file.group();
        if group.is_some_and(|g| g.begin.is_some() && g.world_from_group != DAffine3::IDENTITY) {
            let message = format!("light {name}: lights are not moved by the group they stand in");
            self.note_at(command, "(moved light)", message);
        }
        if body.contains("attenuation = [0.0, 0.0, 0.0]") {
            let message = format!(
                "light {name}: with attenuation 0 0 0 it is infinitely bright wherever it shines; \
                 1 0 0 is no attenuation"
            );
            self.note_at(command, "(unbounded)", message);
        }
        Ok(())
    }
}

/// Position, what else the light has, attenuation.
fn positional(
    command: &mut Command<'_, '_>,
    what: &str,
    rest: impl Fn(&mut Command<'_, '_>) -> Result<(), Error>,
) -> Result<String, Error> {
    let position = command.vector(what)?;
    rest(command)?;
    let attenuation = command.vector("the attenuation")?;
    Ok(text(position, attenuation))
}

fn text(position: DVec3, attenuation: DVec3) -> String {
    let [position, attenuation] = [position, attenuation].map(|v| list(&v.to_array()));
    format!("position = {position}\nattenuation = {attenuation}\n")
}

fn spot(command: &mut Command<'_, '_>) -> Result<String, Error> {
    let position = command.vector("the position")?;
    let (direction, _) = command.direction("the direction")?;
    let attenuation = command.vector("the attenuation")?;
    let mut least_zero = |name: &str| {
        let (x, token) = command.number(name)?;
        if x >= 0.0 {
            return Ok(x);
        }
        Err(command.error(
            &token,
            format!("expected {name} to be 0 or more, found {x}"),
        ))
    };
    let cutoff = least_zero("the cutoff sc")?;
    let exponent = least_zero("the exponent sd")?;
    // No angle is beyond pi: GL's word for it is 180, no cone.
    let degrees = if cutoff >= PI {
        180.0
    } else {
        cutoff.to_degrees()
    };
    let direction = list(&direction.to_array());
    Ok(text(position, attenuation)
        + &format!(
            "spot_direction = {direction}\nspot_cutoff = {degrees:?}\nspot_exponent = {exponent:?}\n"
        ))
}
