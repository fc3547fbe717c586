//! From a hit to a vertex: everything follows from instance, triangle and barycentrics, in f64.

use ajar_scene::Mesh;
use glam::{DVec3, Vec2, Vec4};

use super::{Instance, World};
use crate::{
    bsdf::Mode,
    bvh::{Hit, inside},
    material::{Material, Place},
    math::Frame,
    path::{Kind, Site, Vertex},
};

/// A point of a triangle, for attribute lookups.
#[derive(Clone, Copy)]
pub(super) struct Point<'a> {
    mesh: &'a Mesh,
    triangle: u32,
    weights: [f64; 3],
}

impl Point<'_> {
    /// Indices of the triangle's vertices.
    #[inline]
    fn corners(&self) -> [usize; 3] {
        let [a, b, c] = self.mesh.triangles[self.triangle as usize];
        [a as usize, b as usize, c as usize]
    }

    fn mix2(&self, values: &[Vec2]) -> Vec2 {
        let [a, b, c] = self.corners().map(|i| values[i].as_dvec2());
        (a * self.weights[0] + b * self.weights[1] + c * self.weights[2]).as_vec2()
    }

    /// Normals of the triangle's vertices, if the mesh has some.
    #[inline]
    pub(super) fn normals(&self) -> Option<[DVec3; 3]> {
        let normals = self.mesh.normals.as_ref()?;
        Some(self.corners().map(|i| normals[i].as_dvec3()))
    }

    #[inline]
    pub(super) fn mix3(&self, values: &[DVec3; 3]) -> DVec3 {
        values[0] * self.weights[0] + values[1] * self.weights[1] + values[2] * self.weights[2]
    }
}

impl Place for Point<'_> {
    fn uv(&self, set: u32) -> Vec2 {
        self.mesh.uvs.get(set as usize).map_or(Vec2::ZERO, |uvs| self.mix2(uvs))
    }

    fn color(&self) -> Vec4 {
        let Some(colors) = &self.mesh.colors else { return Vec4::ONE };
        let [a, b, c] = self.corners().map(|i| colors[i].as_dvec4());
        (a * self.weights[0] + b * self.weights[1] + c * self.weights[2]).as_vec4()
    }
}

/// How a place is oriented.
struct Shading {
    /// Around the mapped normal.
    frame: Frame,
    /// Before any normal map.
    normal: DVec3,
    /// −1 where texture coordinates run clockwise, else 1.
    turn: f64,
    /// Of the frame before normal maps; `None` without tangents.
    bitangent: Option<DVec3>,
}

impl Shading {
    /// The world's normal for one of a normal map.
    fn mapped(&self, map: Option<DVec3>, ng: DVec3) -> Option<DVec3> {
        let (map, bitangent) = (map?, self.bitangent?);
        let tangent = bitangent.cross(self.normal) * self.turn;
        let n = (tangent * map.x + bitangent * map.y + self.normal * map.z).try_normalize()?;
        Some(in_front(n, ng))
    }
}

/// `n` on the side of `ng`.
fn in_front(n: DVec3, ng: DVec3) -> DVec3 {
    if n.dot(ng) < 0.0 { -n } else { n }
}

impl World {
    #[inline]
    pub(super) fn point(&self, instance: &Instance, triangle: u32, uv: [f64; 2]) -> Point<'_> {
        let mesh = &self.scene.meshes[instance.mesh];
        Point { mesh, triangle, weights: [1.0 - uv[0] - uv[1], uv[0], uv[1]] }
    }

    /// The material of a surface vertex.
    pub fn material_of(&self, vertex: &Vertex) -> &Material {
        &self.materials[self.instances[vertex.site.instance as usize].material as usize]
    }

    /// Unit normal of a triangle's front, world space.
    pub(super) fn triangle_normal(&self, instance: u32, triangle: u32) -> DVec3 {
        let [a, b, c] = self.geometry.vertices(instance, triangle);
        let handedness = self.instances[instance as usize].handedness;
        (b - a).cross(c - a).normalize_or(DVec3::Z) * handedness
    }

    /// Coverage of the surface hit.
    pub(super) fn opacity(&self, hit: &Hit) -> f64 {
        let instance = &self.instances[hit.instance as usize];
        let material = &self.materials[instance.material as usize];
        if !material.has_alpha() {
            return 1.0;
        }
        let point = self.point(instance, hit.triangle, [f64::from(hit.u), f64::from(hit.v)]);
        material.opacity(&self.textures, &point)
    }

    /// First texture coordinates at a surface vertex.
    pub fn uv(&self, vertex: &Vertex) -> Vec2 {
        let Site { instance, triangle, uv } = vertex.site;
        self.point(&self.instances[instance as usize], triangle, uv).uv(0)
    }

    /// Coverage at a surface vertex, 1 for everything else.
    pub fn coverage(&self, vertex: &Vertex) -> f64 {
        if !self.has_alpha || vertex.kind != Kind::Surface {
            return 1.0;
        }
        let Site { instance, triangle, uv } = vertex.site;
        let instance = &self.instances[instance as usize];
        let point = self.point(instance, triangle, uv);
        self.materials[instance.material as usize].opacity(&self.textures, &point)
    }

    /// The vertex at a place of a surface, its mode smooth.
    pub fn surface(&self, site: Site) -> Vertex {
        let mut vertex = Vertex::isolated(Kind::Surface, DVec3::ZERO, Vertex::NO_EMITTER);
        self.set_surface(site, &self.geometry.vertices(site.instance, site.triangle), &mut vertex);
        vertex
    }

    /// As [`World::surface`], in place; `vertices` are those of the triangle.
    #[inline]
    pub(super) fn set_surface(&self, site: Site, vertices: &[DVec3; 3], vertex: &mut Vertex) {
        let instance = &self.instances[site.instance as usize];
        let material = &self.materials[instance.material as usize];
        vertex.rounding = self.geometry.rounding(site.instance, vertices);
        let site = Site { uv: inside(vertices, site.uv, vertex.rounding), ..site };
        let point = self.point(instance, site.triangle, site.uv);
        let [a, b, c] = *vertices;
        let ng = (b - a).cross(c - a).normalize_or(DVec3::Z) * instance.handedness;
        vertex.kind = Kind::Surface;
        vertex.p = point.mix3(vertices);
        vertex.ng = ng;
        let shading = self.shading(instance, material, &point, ng);
        vertex.frame = shading.frame;
        vertex.site = site;
        material.set_bsdf(&self.textures, &point, shading.turn, &mut vertex.bsdf);
        if material.tilts_coat() {
            let n = shading.mapped(material.mapped_coat_normal(&self.textures, &point), ng);
            vertex.bsdf.tilt_coat(shading.frame.to_local(n.unwrap_or(shading.normal)));
        }
        vertex.emitter = instance.first_emitter.map_or(Vertex::NO_EMITTER, |first| first + site.triangle);
        vertex.mode = Mode::Smooth;
    }

    /// Shading frame: interpolated normal on the front side, tangent, normal map. It depends on the place alone, never on
    /// who looks (mlt.md §1.3).
    #[inline]
    fn shading(&self, instance: &Instance, material: &Material, point: &Point<'_>, ng: DVec3) -> Shading {
        let smooth = point
            .normals()
            .and_then(|normals| (instance.normal_to_world * point.mix3(&normals)).try_normalize());
        let ns = smooth.map_or(ng, |n| in_front(n, ng));
        let Some(tangent) = self.tangent(instance, point) else {
            return Shading { frame: Frame::from_z(ns), normal: ns, turn: 1.0, bitangent: None };
        };
        let frame = Frame::from_zx(ns, instance.to_world.transform_vector3(tangent.truncate()));
        let turn = tangent.w * instance.handedness;
        let shading = Shading { frame, normal: ns, turn, bitangent: Some(frame.y * turn) };
        let mapped = shading.mapped(material.mapped_normal(&self.textures, point), ng);
        match mapped {
            Some(n) => Shading { frame: Frame::from_zx(n, frame.x), ..shading },
            None => shading,
        }
    }

    fn tangent(&self, instance: &Instance, point: &Point<'_>) -> Option<glam::DVec4> {
        let corners = match &self.tangents[instance.mesh.index()] {
            Some(generated) => generated.corners[point.triangle as usize],
            None => {
                let given = point.mesh.tangents.as_ref()?;
                point.corners().map(|i| given[i])
            }
        };
        let direction = point.mix3(&corners.map(|t| t.truncate().as_dvec3()));
        Some(direction.extend(if corners[0].w < 0.0 { -1.0 } else { 1.0 }))
    }
}
