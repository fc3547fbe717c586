//! Meshes: triangles as they are, or polygons that become triangles.

use std::borrow::Cow;

use ajar_scene::{Arena, Diagnostic, Id, Loss, Material, Mesh, Node};
use bytemuck::Pod;
use glam::{Vec2, Vec3, Vec4};
use rayon::prelude::*;
use serde::{Deserialize, de::DeserializeOwned};
use serde_json::Value;

use super::{array::Binary, form::read};
use crate::polygon::{Attribute, Boundary, Linear, Per, Polygons, Subdivision, within};

/// Most refinements: each makes four times as many faces.
const MOST_LEVELS: u32 = 6;

/// The meshes of the file.
#[derive(Default)]
pub(super) struct Meshes {
    /// As the scene has them.
    pub scene: Arena<Mesh>,
    /// Those that each mesh of the file became: polygons make one for each material.
    became: Vec<std::ops::Range<usize>>,
}

impl Meshes {
    /// Makes the nodes name the meshes of the scene.
    ///
    /// # Errors
    /// A mesh that is not there.
    pub fn rename(&self, nodes: &mut Arena<Node>) -> Result<(), Diagnostic> {
        for (index, node) in nodes.iter_mut().enumerate() {
            let mut meshes = Vec::with_capacity(node.meshes.len());
            for mesh in &node.meshes {
                let became = self.became.get(mesh.index()).ok_or_else(|| {
                    let message = format!("mesh {} is not there, only {}", mesh.index(), self.became.len());
                    Diagnostic::error(message).element(format!("nodes[{index}].meshes"))
                })?;
                meshes.extend(became.clone().map(Id::new));
            }
            node.meshes = meshes;
        }
        Ok(())
    }
}

/// Triangles with their arrays where they are.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Triangles {
    #[serde(default)]
    name: String,
    positions: Value,
    triangles: Value,
    normals: Option<Value>,
    tangents: Option<Value>,
    #[serde(default)]
    uvs: Vec<Value>,
    colors: Option<Value>,
    material: Option<Id<Material>>,
}

/// Polygons with their arrays where they are.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Faces {
    #[serde(default)]
    name: String,
    positions: Value,
    faces: Value,
    corners: Value,
    holes: Option<Value>,
    #[serde(default)]
    parts: Vec<Part>,
    normals: Option<AttributeForm>,
    #[serde(default)]
    uvs: Vec<AttributeForm>,
    colors: Option<AttributeForm>,
    subdivision: Option<SubdivisionForm>,
    material: Option<Id<Material>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Part {
    material: Option<Id<Material>>,
    faces: Value,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct AttributeForm {
    values: Value,
    indices: Option<Value>,
    #[serde(default)]
    per: Per,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, default)]
struct SubdivisionForm {
    levels: u32,
    boundary: Boundary,
    linear: Linear,
    creases: Option<Value>,
    crease_sharpness: Option<Value>,
    sharp_positions: Option<Value>,
    position_sharpness: Option<Value>,
}

impl Default for SubdivisionForm {
    fn default() -> Self {
        Self {
            levels: 2,
            boundary: Boundary::default(),
            linear: Linear::default(),
            creases: None,
            crease_sharpness: None,
            sharp_positions: None,
            position_sharpness: None,
        }
    }
}

/// Reads the list of meshes, on all cores; what is dropped goes to `diagnostics`.
pub(super) fn meshes(
    forms: Vec<Value>,
    binary: &Binary,
    diagnostics: &mut Vec<Diagnostic>,
) -> Result<Meshes, Diagnostic> {
    let mesh = |(index, form): (usize, Value)| {
        let element = format!("meshes[{index}]");
        Reader { binary, element }.mesh(form)
    };
    let all: Vec<_> = forms.into_par_iter().enumerate().map(mesh).collect();
    let mut meshes = Meshes::default();
    for made in all {
        let (made, dropped) = made?;
        let first = meshes.scene.len();
        for mesh in made {
            meshes.scene.push(mesh);
        }
        diagnostics.extend(dropped);
        meshes.became.push(first..meshes.scene.len());
    }
    Ok(meshes)
}

/// The meshes that one of the file becomes, and what was dropped.
type Made = (Vec<Mesh>, Option<Diagnostic>);

/// Reads one mesh.
struct Reader<'a> {
    binary: &'a Binary<'a>,
    element: String,
}

impl<'a> Reader<'a> {
    fn mesh(&self, form: Value) -> Result<Made, Diagnostic> {
        if form.get("faces").is_some() { self.faces(form) } else { Ok((vec![self.triangles(form)?], None)) }
    }

    fn array<T: Pod + DeserializeOwned>(&self, given: Value, key: &str) -> Result<Cow<'a, [T]>, Diagnostic> {
        self.binary.array(given, &format!("{}.{key}", self.element))
    }

    fn optional<T: Pod + DeserializeOwned>(
        &self,
        given: Option<Value>,
        key: &str,
    ) -> Result<Option<Cow<'a, [T]>>, Diagnostic> {
        given.map(|given| self.array(given, key)).transpose()
    }

    /// An array that is kept; none is an empty one.
    fn owned<T: Pod + DeserializeOwned>(
        &self,
        given: Option<Value>,
        key: &str,
    ) -> Result<Vec<T>, Diagnostic> {
        Ok(self.optional(given, key)?.map(Cow::into_owned).unwrap_or_default())
    }

    fn triangles(&self, form: Value) -> Result<Mesh, Diagnostic> {
        let form: Triangles = read(form, &self.element)?;
        let mut uvs = Vec::with_capacity(form.uvs.len());
        for (set, given) in form.uvs.into_iter().enumerate() {
            uvs.push(self.array(given, &format!("uvs[{set}]"))?.into_owned());
        }
        Ok(Mesh {
            name: form.name,
            positions: self.array(form.positions, "positions")?.into_owned(),
            triangles: self.array(form.triangles, "triangles")?.into_owned(),
            normals: self.optional(form.normals, "normals")?.map(Cow::into_owned),
            tangents: self.optional(form.tangents, "tangents")?.map(Cow::into_owned),
            uvs,
            colors: self.optional(form.colors, "colors")?.map(Cow::into_owned),
            material: form.material,
        })
    }

    fn faces(&self, form: Value) -> Result<Made, Diagnostic> {
        let form: Faces = read(form, &self.element)?;
        let faces = self.array(form.faces, "faces")?;
        let mut polygons = Polygons {
            positions: self.array(form.positions, "positions")?,
            corners: self.array(form.corners, "corners")?,
            part_of: vec![0; faces.len()],
            is_hole: vec![false; faces.len()],
            materials: vec![form.material],
            name: form.name,
            faces,
            ..Polygons::default()
        };
        polygons.check().map_err(|error| error.element(&self.element))?;
        let holes = self.optional(form.holes, "holes")?.unwrap_or_default();
        self.each_face(&holes, &mut polygons.is_hole, "holes", true)?;
        for (index, part) in form.parts.into_iter().enumerate() {
            let key = format!("parts[{index}].faces");
            let faces = self.array(part.faces, &key)?;
            self.each_face(&faces, &mut polygons.part_of, &key, index as u32 + 1)?;
            polygons.materials.push(part.material);
        }
        polygons.colors =
            form.colors.map(|it| self.attribute::<Vec4>(it, &polygons, "colors")).transpose()?;
        for (set, given) in form.uvs.into_iter().enumerate() {
            let uvs = self.attribute::<Vec2>(given, &polygons, &format!("uvs[{set}]"))?;
            polygons.uvs.push(uvs);
        }
        polygons.subdivision = form.subdivision.map(|it| self.subdivision(it, &polygons)).transpose()?;
        if polygons.subdivision.is_none() {
            polygons.normals =
                form.normals.map(|it| self.attribute::<Vec3>(it, &polygons, "normals")).transpose()?;
        }
        let polygons = polygons.refined(&self.binary.budget).map_err(|error| error.element(&self.element))?;
        let done = polygons.triangulated();
        Ok((done.meshes, dropped(done.degenerate, done.crossing, &self.element)))
    }

    /// Sets what belongs to the faces listed.
    fn each_face<T: Copy>(&self, faces: &[u32], of: &mut [T], key: &str, value: T) -> Result<(), Diagnostic> {
        within(faces, of.len(), "faces").map_err(|e| e.element(format!("{}.{key}", self.element)))?;
        faces.iter().for_each(|&face| of[face as usize] = value);
        Ok(())
    }

    fn attribute<T: Pod + DeserializeOwned>(
        &self,
        form: AttributeForm,
        polygons: &Polygons,
        key: &str,
    ) -> Result<Attribute<'a, T>, Diagnostic> {
        let values = self.array(form.values, &format!("{key}.values"))?;
        let indices = self.optional(form.indices, &format!("{key}.indices"))?;
        polygons
            .attribute(values, indices, form.per)
            .map_err(|error| error.element(format!("{}.{key}", self.element)))
    }

    fn subdivision(&self, form: SubdivisionForm, polygons: &Polygons) -> Result<Subdivision, Diagnostic> {
        let place = format!("{}.subdivision", self.element);
        let wrong = |message: String| Diagnostic::error(message).element(&place);
        if form.levels > MOST_LEVELS {
            return Err(wrong(format!("{} levels are more than {MOST_LEVELS}", form.levels)));
        }
        let given = |given, key: &str| self.owned(given, &format!("subdivision.{key}"));
        let crease_sharpness = given(form.crease_sharpness, "crease_sharpness")?;
        let position_sharpness = given(form.position_sharpness, "position_sharpness")?;
        let creases: Vec<[u32; 2]> = self.owned(form.creases, "subdivision.creases")?;
        let sharp_positions: Vec<u32> = self.owned(form.sharp_positions, "subdivision.sharp_positions")?;
        for (what, things, sharpness) in [
            ("creases", creases.len(), crease_sharpness.len()),
            ("sharp positions", sharp_positions.len(), position_sharpness.len()),
        ] {
            if things != sharpness {
                return Err(wrong(format!("{things} {what} have {sharpness} values of sharpness")));
            }
        }
        for indices in [creases.as_flattened(), &sharp_positions] {
            within(indices, polygons.positions.len(), "positions").map_err(|e| e.element(&place))?;
        }
        let (levels, boundary, linear) = (form.levels, form.boundary, form.linear);
        Ok(Subdivision {
            levels,
            boundary,
            linear,
            creases,
            crease_sharpness,
            sharp_positions,
            position_sharpness,
        })
    }
}

/// What was wrong with faces, as one message.
fn dropped(degenerate: usize, crossing: usize, element: &str) -> Option<Diagnostic> {
    let count = |count: usize| format!("{count} {}", if count == 1 { "face" } else { "faces" });
    let message = match (degenerate, crossing) {
        (0, 0) => return None,
        (_, 0) => format!("{} without area dropped", count(degenerate)),
        (0, _) => format!("{} crossing themselves, their triangles may overlap", count(crossing)),
        _ => format!(
            "{} without area dropped, {} crossing themselves, their triangles may overlap",
            count(degenerate),
            count(crossing)
        ),
    };
    let loss = if degenerate > 0 { Loss::Dropped } else { Loss::Approximated };
    Some(Diagnostic::warning(message).losing(loss).element(element))
}
