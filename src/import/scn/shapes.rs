//! The shapes: triangles, boxes, spheres, cylinders, cones, circles; and lines, which nothing draws.

use std::sync::Arc;

use super::command::Command;
use super::{File, Reader};
use crate::error::Error;
use crate::import::keys::MAX_MESH_TRIANGLES;
use crate::math::{DAffine3, DVec3};
use crate::scene::fit::Bounds;
use crate::scene::{Geometry, Mesh, Shape};

impl Reader<'_> {
    /// A triangle joins the mesh of the one before it where nothing but comments stands between them.
    pub(super) fn triangle(
        &mut self,
        file: &File,
        command: &mut Command<'_, '_>,
    ) -> Result<(), Error> {
        let material = self.material(file, command)?;
        let corner = "a corner";
        let corners = [
            command.vector(corner)?,
            command.vector(corner)?,
            command.vector(corner)?,
        ];
        self.mesh_triangles += 1;
        if self.mesh_triangles > MAX_MESH_TRIANGLES {
            let message = format!("the meshes have more than {MAX_MESH_TRIANGLES} triangles");
            return Err(command.error(&command.token, message));
        }
        let open = self
            .open_triangles
            .and_then(|i| self.contents.objects.get_mut(i));
        if let Some(object) = open
            && object.materials == [material]
            && let Geometry::Mesh(mesh) = &mut object.geometry
            && let Some(mesh) = Arc::get_mut(mesh)
        {
            append(mesh, corners);
            return Ok(());
        }
        let mut mesh = Mesh::default();
        append(&mut mesh, corners);
        self.open_triangles = Some(self.contents.objects.len());
        self.push(file, command, Geometry::Mesh(Arc::new(mesh)), material)
    }

    pub(super) fn sphere(
        &mut self,
        file: &File,
        command: &mut Command<'_, '_>,
    ) -> Result<(), Error> {
        let material = self.material(file, command)?;
        let center = command.vector("the centre")?;
        let radius = command.positive("the radius")?;
        let shape = Shape::Sphere { center, radius };
        self.push(file, command, Geometry::Shape(shape), material)
    }

    /// Two opposite corners in any order; without thickness along one axis it is a patch.
    pub(super) fn cuboid(
        &mut self,
        file: &File,
        command: &mut Command<'_, '_>,
    ) -> Result<(), Error> {
        let material = self.material(file, command)?;
        let (a, [first, ..]) = command.numbers::<3>("a corner")?;
        let (a, b) = (DVec3::from_array(a), command.vector("the opposite corner")?);
        let (min, max) = (a.min(b), a.max(b));
        let size = (max - min).to_array();
        let flat: Vec<usize> = (0..3).filter(|i| size[*i] == 0.0).collect();
        let shape = match flat[..] {
            [] => Shape::Box { min, max },
            [axis] => {
                self.flat_boxes.push(self.contents.objects.len());
                let edge = |i: usize| DVec3::AXES[i % 3] * size[i % 3];
                Shape::Patch {
                    corner: min,
                    edge_u: edge(axis + 1),
                    edge_v: edge(axis + 2),
                    tiles: [1, 1],
                }
            }
            _ => {
                let message = "the corners span neither a box nor a rectangle";
                return Err(command.error(&first, message));
            }
        };
        self.push(file, command, Geometry::Shape(shape), material)
    }

    /// A closed cylinder about +y.
    pub(super) fn cylinder(
        &mut self,
        file: &File,
        command: &mut Command<'_, '_>,
    ) -> Result<(), Error> {
        let (material, [base, top], radius) = self.upright(file, command)?;
        let shape = Shape::Cylinder {
            base,
            top,
            radius,
            caps: true,
        };
        self.push(file, command, Geometry::Shape(shape), material)
    }

    /// A closed cone, its tip toward +y.
    pub(super) fn cone(&mut self, file: &File, command: &mut Command<'_, '_>) -> Result<(), Error> {
        let (material, [base, apex], radius) = self.upright(file, command)?;
        let shape = Shape::Cone {
            base,
            apex,
            radius,
            cap: true,
        };
        self.push(file, command, Geometry::Shape(shape), material)
    }

    /// Material, lower and upper end of the axis, radius: `m  cx cy cz  r h`.
    fn upright(
        &mut self,
        file: &File,
        command: &mut Command<'_, '_>,
    ) -> Result<(usize, [DVec3; 2], f64), Error> {
        let material = self.material(file, command)?;
        let center = command.vector("the centre")?;
        let radius = command.positive("the radius")?;
        let half = DVec3::Y * (command.positive("the height")? / 2.0);
        let ends = [center - half, center + half];
        if ends[0] == ends[1] {
            let message = "the height vanishes beside the coordinates of the centre";
            return Err(command.error(&command.token, message));
        }
        Ok((material, ends, radius))
    }

    pub(super) fn circle(
        &mut self,
        file: &File,
        command: &mut Command<'_, '_>,
    ) -> Result<(), Error> {
        let material = self.material(file, command)?;
        let shape = Shape::Disk {
            center: command.vector("the centre")?,
            normal: command.direction("the normal")?.0,
            radius: command.positive("the radius")?,
        };
        self.push(file, command, Geometry::Shape(shape), material)
    }

    /// A line is checked and takes part in the bounds, as in the course's viewer, and that is all.
    pub(super) fn line(&mut self, file: &File, command: &mut Command<'_, '_>) -> Result<(), Error> {
        self.stated_material(file, command)?;
        let ends = [command.vector("an end")?, command.vector("an end")?];
        let world = file
            .group()
            .map_or(DAffine3::IDENTITY, |g| g.world_from_group);
        for point in ends.map(|p| world.transform_point3(p)) {
            let bounds = Bounds {
                min: point,
                max: point,
            };
            let all = self.line_bounds.map_or(bounds, |b| b.union(&bounds));
            self.line_bounds = Some(all);
        }
        self.count("line");
        if self.first_line.is_none() {
            self.first_line = Some(command.lexer.place(&command.token));
        }
        Ok(())
    }

    /// Turns patches that stand for boxes toward the eye: the nearer side of such a box is the one to see.
    pub(super) fn face_the_eye(&mut self, eye_world: DVec3) {
        for index in &self.flat_boxes {
            let Some(object) = self.contents.objects.get_mut(*index) else {
                continue;
            };
            let eye = object
                .world_from_object
                .inverse()
                .transform_point3(eye_world);
            if let Geometry::Shape(Shape::Patch {
                corner,
                edge_u,
                edge_v,
                ..
            }) = &mut object.geometry
                && edge_u.cross(*edge_v).dot(eye - *corner) < 0.0
            {
                std::mem::swap(edge_u, edge_v);
            }
        }
    }
}

fn append(mesh: &mut Mesh, corners: [DVec3; 3]) {
    let first = mesh.positions.len() as u32;
    mesh.positions.extend(corners);
    mesh.triangles.push([first, first + 1, first + 2]);
}
