//! Normals of smoothing groups: the normalised sum of the area vectors of the faces that share position and group.
//!
//! Where these cancel, as on a face that is modelled from both sides, there is no such normal: the faces keep their own.

use super::build::for_each_face;
use super::scan::{Attributes, NONE, Scan};
use crate::error::Note;
use crate::import::polygon;
use crate::math::DVec3;
use crate::math::float::normalize;

/// The group of a face; 0 = flat.
pub(super) fn group(attributes: Attributes, smooth: Option<bool>) -> u32 {
    match smooth {
        Some(true) => 1,
        Some(false) => 0,
        None => attributes.smoothing,
    }
}

/// What is left of a sum whose parts cancel is rounding: below this part of what they are together.
const CANCELS: f64 = 1.0 / (1u64 << 40) as f64;

/// Normals of smoothing groups: a chain of sums for each position.
pub(super) struct Smoothed {
    heads: Vec<u32>,
    links: Vec<Link>,
    /// Sums that cancel.
    cancelled: usize,
}

struct Link {
    group: u32,
    next: u32,
    /// Of the area vectors, later the normal; zero where they cancel.
    sum: DVec3,
    /// Of their lengths.
    total: f64,
}

impl Smoothed {
    pub(super) fn new(scan: &Scan, smooth: Option<bool>, notes: &mut Vec<Note>) -> Self {
        let any = match smooth {
            Some(on) => on,
            None => scan.runs.iter().any(|run| run.attributes.smoothing != 0),
        };
        let mut smoothed = Self {
            heads: Vec::new(),
            links: Vec::new(),
            cancelled: 0,
        };
        if !any {
            return smoothed;
        }
        smoothed.heads = vec![NONE; scan.positions.len()];
        for_each_face(scan, |_, attributes, corners| {
            let group = group(attributes, smooth);
            if group == 0 {
                return;
            }
            let face = &scan.corners[corners];
            let area = polygon::area_vector(face.iter().map(|v| scan.positions[*v as usize]));
            for v in face {
                smoothed.add(*v, group, area);
            }
        });
        for link in &mut smoothed.links {
            if link.sum.length() <= CANCELS * link.total {
                link.sum = DVec3::ZERO;
                smoothed.cancelled += 1;
            } else {
                link.sum = DVec3::from_array(normalize(link.sum.to_array()).0);
            }
        }
        let without = smoothed
            .links
            .iter()
            .filter(|l| l.sum == DVec3::ZERO && l.total > 0.0);
        let corners = match without.count() {
            0 => return smoothed,
            1 => "a vertex".to_owned(),
            n => format!("{n} vertices"),
        };
        let message = format!(
            "at {corners} the normals of a smoothing group cancel, as where a face is modelled from both sides: \
             the faces keep their own normals there"
        );
        notes.push(Note {
            place: None,
            message,
        });
        smoothed
    }

    fn find(&self, position: u32, group: u32) -> Option<usize> {
        let mut at = self.heads[position as usize];
        while at != NONE {
            let link = &self.links[at as usize];
            if link.group == group {
                return Some(at as usize);
            }
            at = link.next;
        }
        None
    }

    fn add(&mut self, position: u32, group: u32, area: DVec3) {
        match self.find(position, group) {
            Some(link) => {
                self.links[link].sum += area;
                self.links[link].total += area.length();
            }
            None => {
                let head = &mut self.heads[position as usize];
                self.links.push(Link {
                    group,
                    next: *head,
                    sum: area,
                    total: area.length(),
                });
                *head = self.links.len() as u32 - 1;
            }
        }
    }

    /// Whether a group has no normal at a position.
    pub(super) fn cancels(&self, position: u32, group: u32) -> bool {
        self.cancelled > 0 && self.normal(position, group) == DVec3::ZERO
    }

    pub(super) fn normal(&self, position: u32, group: u32) -> DVec3 {
        self.find(position, group)
            .map_or(DVec3::ZERO, |link| self.links[link].sum)
    }
}
