//! How a surface point and its shading normal move together: what perturbing chains of mirrors and lenses asks for.

use glam::DVec3;

use super::World;
use crate::path::{Kind, Vertex};

/// First derivatives of a surface at a point, along two orthonormal directions of the triangle's plane.
#[derive(Clone, Copy, Debug)]
pub struct Differential {
    /// The directions.
    pub along: [DVec3; 2],
    /// How the unit shading normal turns for each metre along them.
    pub normal: [DVec3; 2],
}

impl World {
    /// The surface around a vertex; `None` where its shading normal has no derivative: off surfaces, and where a normal
    /// map bends it.
    pub fn differential(&self, vertex: &Vertex) -> Option<Differential> {
        if vertex.kind != Kind::Surface || self.material_of(vertex).source().normal_map.is_some() {
            return None;
        }
        let instance = &self.instances[vertex.site.instance as usize];
        let [a, b, c] = self.geometry.vertices(vertex.site.instance, vertex.site.triangle);
        let (du, dv) = (b - a, c - a);
        let x = du.try_normalize()?;
        let along = [x, vertex.ng.cross(x)];
        let point = self.point(instance, vertex.site.triangle, vertex.site.uv);
        let Some([na, nb, nc]) = point.normals() else {
            return Some(Differential { along, normal: [DVec3::ZERO; 2] });
        };
        let place = |n: DVec3| instance.normal_to_world * n;
        let n = place(point.mix3(&[na, nb, nc]));
        let (length, unit) = (n.length(), n.try_normalize()?);
        // The shading normal is on the front side.
        let scale = 1f64.copysign(unit.dot(vertex.frame.z)) / length;
        let turn = |dn: DVec3| (dn - unit * unit.dot(dn)) * scale;
        let (by_u, by_v) = (turn(place(nb - na)), turn(place(nc - na)));
        // Barycentric weights that move the point by one metre along each direction: du lies along the first.
        let (u_x, v_x, v_y) = (du.dot(along[0]), dv.dot(along[0]), dv.dot(along[1]));
        let to_y = [-v_x / (u_x * v_y), 1.0 / v_y];
        let normal = [by_u / u_x, by_u * to_y[0] + by_v * to_y[1]];
        (normal[0].is_finite() && normal[1].is_finite()).then_some(Differential { along, normal })
    }
}
