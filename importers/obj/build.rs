//! Geometry as written into meshes and the nodes that place them.

use std::{collections::HashMap, path::Path};

use ajar_scene::{Diagnostic, Id, Loss, Material, Mesh, Node, Scene};
use glam::{DVec3, Vec2, Vec3};

use super::geometry::{Corner, Face, Geometry, NONE, Part};
use crate::{polygon::ears, report::Report, srgb};

/// Which normal a vertex has; vertices that differ in it are not joined.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
enum Shade {
    /// The mesh has no normals.
    Flat,
    /// `vn` of this index.
    Written(u32),
    /// The mean over a smoothing group.
    Smooth(u32),
    /// Of this face.
    Face(u32),
}

/// A triangle: its face and three indices of corners.
struct Triangle {
    face: u32,
    corners: [u32; 3],
}

/// A mesh on the way, with the vertices that it has already.
#[derive(Default)]
struct Builder {
    mesh: Mesh,
    vertices: HashMap<(u32, u32, Shade), u32>,
    has_uvs: bool,
    has_normals: bool,
}

/// Adds the meshes, a node for each object and group, and a root above them.
pub(super) fn build(
    geometry: &Geometry,
    materials: &HashMap<&str, Id<Material>>,
    file: &Path,
    scene: &mut Scene,
    report: &mut Report,
) {
    let mut normals = vec![Vec3::ZERO; geometry.faces.len()];
    let triangles = triangulate(geometry, &mut normals, file, report);
    let smooth = smooth_normals(geometry, &triangles);
    let mut builders = prepare(geometry);
    for triangle in &triangles {
        let face = &geometry.faces[triangle.face as usize];
        let builder = &mut builders[face.part as usize];
        let vertices = triangle.corners.map(|corner| {
            let corner = geometry.corners[corner as usize];
            let shade =
                if builder.has_normals { shade(geometry, face, triangle.face, corner) } else { Shade::Flat };
            builder.vertex(geometry, corner, shade, || match shade {
                Shade::Written(normal) => geometry.normals[normal as usize],
                Shade::Smooth(group) => {
                    let mean = smooth.get(&(corner.position, group)).copied().unwrap_or_default();
                    mean.try_normalize().map_or(normals[triangle.face as usize], DVec3::as_vec3)
                }
                Shade::Face(_) | Shade::Flat => normals[triangle.face as usize],
            })
        });
        builder.mesh.triangles.push(vertices);
    }
    let bare = |corner: &Corner, face: &Face| corner.uv == NONE && builders[face.part as usize].has_uvs;
    let corners_of = |face: &Face| &geometry.corners[face.first..face.first + face.count];
    if let Some(face) = geometry.faces.iter().find(|face| corners_of(face).iter().any(|c| bare(c, face))) {
        let message = "corners without texture coordinate beside others that have one are taken as (0, 0)";
        let warning = Diagnostic::warning(message).losing(Loss::Approximated);
        report.add(warning.in_file(file).at(face.line as usize, 1));
    }
    let meshes = builders.into_iter().map(|builder| builder.mesh);
    place(geometry.parts.iter().map(|(part, _)| part).zip(meshes), materials, file, scene);
}

/// Splits all faces; writes their unit normals. Faces without area are dropped: no light can meet them.
fn triangulate(geometry: &Geometry, normals: &mut [Vec3], file: &Path, report: &mut Report) -> Vec<Triangle> {
    let mut triangles = Vec::with_capacity(geometry.faces.len());
    let (mut points, mut found) = (Vec::new(), Vec::new());
    for (index, face) in geometry.faces.iter().enumerate() {
        let mut lose = |loss, message| {
            report.add(Diagnostic::warning(message).losing(loss).in_file(file).at(face.line as usize, 1));
        };
        points.clear();
        let corners = &geometry.corners[face.first..face.first + face.count];
        points.extend(corners.iter().map(|corner| geometry.positions[corner.position as usize]));
        let Some(normal) = ears::vector_area(&points).try_normalize() else {
            lose(Loss::Dropped, "faces without area are dropped");
            continue;
        };
        normals[index] = normal.as_vec3();
        found.clear();
        if !ears::triangulate(&points, normal, &mut found) {
            let message = "a polygon crosses itself or is too intricate; its triangles may overlap";
            lose(Loss::Approximated, message);
        }
        triangles.extend(found.iter().map(|triangle| Triangle {
            face: index as u32,
            corners: triangle.map(|corner| face.first as u32 + corner),
        }));
    }
    triangles
}

/// Sums of triangle normals, weighted by the angle at the vertex so that the cut of a polygon does not matter
/// (G. Thürmer, C. Wüthrich, "Computing vertex normals from polygonal facets", J. Graphics Tools 3(1), 1998), by
/// position and smoothing group. Groups reach over objects and materials.
fn smooth_normals(geometry: &Geometry, triangles: &[Triangle]) -> HashMap<(u32, u32), DVec3> {
    let mut sums: HashMap<(u32, u32), DVec3> = HashMap::new();
    for triangle in triangles {
        let face = &geometry.faces[triangle.face as usize];
        if face.smoothing == 0 {
            continue;
        }
        let positions = triangle.corners.map(|corner| geometry.corners[corner as usize].position);
        let [a, b, c] = positions.map(|position| geometry.positions[position as usize].as_dvec3());
        let normal = (b - a).cross(c - a).normalize_or_zero();
        let angles =
            [(b - a).angle_between(c - a), (c - b).angle_between(a - b), (a - c).angle_between(b - c)];
        for (position, angle) in positions.into_iter().zip(angles) {
            if angle.is_finite() {
                *sums.entry((position, face.smoothing)).or_default() += angle * normal;
            }
        }
    }
    sums
}

/// One builder a part, knowing which attributes any of its faces has.
fn prepare(geometry: &Geometry) -> Vec<Builder> {
    let mut builders: Vec<Builder> = geometry.parts.iter().map(|_| Builder::default()).collect();
    for (index, face) in geometry.faces.iter().enumerate() {
        let builder = &mut builders[face.part as usize];
        for &corner in &geometry.corners[face.first..face.first + face.count] {
            builder.has_uvs |= corner.uv != NONE;
            builder.has_normals |= !matches!(shade(geometry, face, index as u32, corner), Shade::Face(_));
        }
    }
    for builder in &mut builders {
        builder.mesh.uvs.extend(builder.has_uvs.then(Vec::new));
        builder.mesh.normals = builder.has_normals.then(Vec::new);
        builder.mesh.colors = (!geometry.colors.is_empty()).then(Vec::new);
    }
    builders
}

/// A written normal wins over the smoothing group, as the format says.
fn shade(geometry: &Geometry, face: &Face, index: u32, corner: Corner) -> Shade {
    let written = geometry.normals.get(corner.normal as usize).is_some_and(|&normal| normal != Vec3::ZERO);
    match face.smoothing {
        _ if written => Shade::Written(corner.normal),
        0 => Shade::Face(index),
        group => Shade::Smooth(group),
    }
}

impl Builder {
    /// The vertex of a corner, made if there is none yet.
    fn vertex(
        &mut self,
        geometry: &Geometry,
        corner: Corner,
        shade: Shade,
        normal: impl FnOnce() -> Vec3,
    ) -> u32 {
        let mesh = &mut self.mesh;
        *self.vertices.entry((corner.position, corner.uv, shade)).or_insert_with(|| {
            let position = corner.position as usize;
            mesh.positions.push(geometry.positions[position]);
            if let Some(uvs) = mesh.uvs.first_mut() {
                let uv = geometry.uvs.get(corner.uv as usize).copied().unwrap_or_default();
                // From the bottom left to the top left.
                uvs.push(Vec2::new(uv.x, 1.0 - uv.y));
            }
            if let Some(normals) = &mut mesh.normals {
                normals.push(normal());
            }
            if let Some(colors) = &mut mesh.colors {
                let color = geometry.colors.get(position).copied().unwrap_or(Vec3::ONE);
                colors.push(Vec3::from_array(color.to_array().map(srgb::linear)).extend(1.0));
            }
            (mesh.positions.len() - 1) as u32
        })
    }
}

fn place<'a>(
    parts: impl Iterator<Item = (&'a Part, Mesh)>,
    materials: &HashMap<&str, Id<Material>>,
    file: &Path,
    scene: &mut Scene,
) {
    let stem = file.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    let root = scene.nodes.push(Node { name: stem, ..Node::default() });
    scene.roots.push(root);
    let mut nodes: HashMap<(&str, &str), Id<Node>> = HashMap::new();
    for (part, mut mesh) in parts {
        if mesh.triangles.is_empty() {
            continue;
        }
        let name = match (part.object.as_str(), part.group.as_str()) {
            ("", "") => "default".to_owned(),
            (name, "") | ("", name) => name.to_owned(),
            (object, group) => format!("{object}/{group}"),
        };
        let node = *nodes.entry((&part.object, &part.group)).or_insert_with(|| {
            let node = scene.nodes.push(Node { name: name.clone(), ..Node::default() });
            scene.nodes[root].children.push(node);
            node
        });
        mesh.material = part.material.as_deref().and_then(|name| materials.get(name)).copied();
        mesh.name = part.material.as_ref().map_or(name.clone(), |material| format!("{name}/{material}"));
        let mesh = scene.meshes.push(mesh);
        scene.nodes[node].meshes.push(mesh);
    }
}
