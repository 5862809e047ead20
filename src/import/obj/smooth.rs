//! Normals of smoothing groups: the normalised sum of the area vectors of the faces that share position and group.

use super::build::for_each_face;
use super::scan::{Attributes, NONE, Scan};
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

/// Normals of smoothing groups: a chain of (group, sum) for each position.
pub(super) struct Smoothed {
    heads: Vec<u32>,
    links: Vec<(u32, u32, DVec3)>,
}

impl Smoothed {
    pub(super) fn new(scan: &Scan, smooth: Option<bool>) -> Self {
        let any = match smooth {
            Some(on) => on,
            None => scan.runs.iter().any(|run| run.attributes.smoothing != 0),
        };
        let mut smoothed = Self {
            heads: Vec::new(),
            links: Vec::new(),
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
            link.2 = DVec3::from_array(normalize(link.2.to_array()).0);
        }
        smoothed
    }

    fn find(&self, position: u32, group: u32) -> Option<usize> {
        let mut at = self.heads[position as usize];
        while at != NONE {
            let (g, next, _) = self.links[at as usize];
            if g == group {
                return Some(at as usize);
            }
            at = next;
        }
        None
    }

    fn add(&mut self, position: u32, group: u32, area: DVec3) {
        match self.find(position, group) {
            Some(link) => self.links[link].2 += area,
            None => {
                let head = &mut self.heads[position as usize];
                self.links.push((group, *head, area));
                *head = self.links.len() as u32 - 1;
            }
        }
    }

    pub(super) fn normal(&self, position: u32, group: u32) -> DVec3 {
        self.find(position, group)
            .map_or(DVec3::ZERO, |link| self.links[link].2)
    }
}
