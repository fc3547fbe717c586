//! Vertex attributes, gathered for the vertices in use and repaired where a shading value is not what it must be.

use ajar_scene::{Diagnostic, Mesh};
use glam::{DAffine3, DVec3, Vec2, Vec3, Vec4};
use gltf::json::{
    accessor::ComponentType,
    mesh::{Primitive, Semantic},
    validation::Checked,
};
use rayon::prelude::*;

use super::{
    Asset, Context,
    accessor::{Accessor, first},
    deform::{self, Shape},
};

/// How far a length may be from 1 without a word: 8-bit normals are off by less.
const UNIT_TOLERANCE: f64 = 0.02;
/// Texture coordinate sets that a file can make out of nothing by naming a high one.
const MOST_UV_SETS: u32 = 64;

/// The vertices of a primitive that its triangles use.
pub(super) struct Vertices<'a> {
    pub asset: &'a Asset,
    pub primitive: &'a Primitive,
    /// Path of the primitive.
    pub element: &'a str,
    /// Indices into the accessors, increasing.
    pub used: &'a [u32],
    /// Elements that every attribute's accessor must have.
    pub count: u32,
    /// How they are moved.
    pub shape: &'a Shape,
}

impl Vertices<'_> {
    /// Gathers everything.
    ///
    /// # Errors
    /// An accessor is broken, a position is not finite, or memory runs out.
    pub fn mesh(
        &self,
        context: &mut Context,
        positions: &Accessor,
        triangles: Vec<[u32; 3]>,
    ) -> Result<Mesh, Diagnostic> {
        let name = self.path("POSITION");
        self.prepare(context, positions, 3, &name)?;
        let mut positions: Vec<Vec3> = positions.gather(self.used, 0.0);
        deform::morph(self, context, ("POSITION", |target| target.positions), &mut positions)?;
        let skin = deform::skin(self, context)?;
        if let Some(skin) = &skin {
            for (position, place) in positions.iter_mut().zip(skin) {
                *position = place.transform_point3(position.as_dvec3()).as_vec3();
            }
        }
        if let Some(at) = first(&positions, |position| !position.is_finite()) {
            let vertex = self.used.get(at).copied().unwrap_or_default();
            return Err(Diagnostic::error("the position is not finite").element(format!("{name}[{vertex}]")));
        }
        let skin = skin.as_deref();
        let normals = self.normals(context, &positions, &triangles, skin)?;
        let tangents = self.tangents(context, normals.is_some(), skin)?;
        let uvs = self.uvs(context)?;
        let colors = self.colors(context)?;
        Ok(Mesh { positions, triangles, normals, tangents, uvs, colors, ..Mesh::default() })
    }

    /// Whether nothing bends the mesh, so that what is wrong with its vertices is so in the file.
    fn as_written(&self) -> bool {
        self.shape.weights.is_empty() && self.shape.joints.is_none()
    }

    fn path(&self, name: &str) -> String {
        format!("{}.attributes.{name}", self.element)
    }

    /// The accessor of an attribute; `None`, with a warning, if its length does not fit.
    pub fn accessor(
        &self,
        context: &mut Context,
        semantic: Semantic,
        name: &str,
        widths: &[usize],
    ) -> Result<Option<Accessor<'_>>, Diagnostic> {
        let Some(index) = self.primitive.attributes.get(&Checked::Valid(semantic)) else { return Ok(None) };
        let accessor = Accessor::open(self.asset, context, index.value(), widths, name)?;
        if accessor.count != self.count {
            let message = "the attribute is dropped: it has not as many elements as POSITION";
            context.report.warn(name, message);
            return Ok(None);
        }
        self.prepare(context, &accessor, 4, name)?;
        Ok(Some(accessor))
    }

    /// Counts the memory of the gathered values and refuses component types that no attribute may have.
    fn prepare(
        &self,
        context: &mut Context,
        accessor: &Accessor,
        width: u64,
        name: &str,
    ) -> Result<(), Diagnostic> {
        if accessor.kind == ComponentType::U32 {
            return Err(Diagnostic::error("32-bit integers are no vertex attribute").element(name));
        }
        if accessor.is_all_zeros() {
            context.report.approximate(name, "the accessor has no data, all its elements are zero");
        }
        context.charge(self.used.len() as u64 * width * 4, name)
    }

    /// Unit normals; zero ones are replaced by the mean of the triangles around.
    fn normals(
        &self,
        context: &mut Context,
        positions: &[Vec3],
        triangles: &[[u32; 3]],
        skin: Option<&[DAffine3]>,
    ) -> Result<Option<Vec<Vec3>>, Diagnostic> {
        let name = self.path("NORMAL");
        let Some(accessor) = self.accessor(context, Semantic::Normals, &name, &[3])? else { return Ok(None) };
        let mut normals: Vec<Vec3> = accessor.gather(self.used, 0.0);
        deform::morph(self, context, ("NORMAL", |target| target.normals), &mut normals)?;
        for (normal, place) in normals.iter_mut().zip(skin.into_iter().flatten()) {
            *normal = (deform::for_normals(place) * normal.as_dvec3()).as_vec3();
        }
        let normalize = |normal: &mut Vec3| {
            let found = unit(*normal);
            *normal = found.map_or(Vec3::ZERO, |(normal, _)| normal);
            (found.is_some_and(|(_, length)| (length - 1.0).abs() > UNIT_TOLERANCE), found.is_none())
        };
        let (long, degenerate) =
            normals.par_iter_mut().map(normalize).reduce(Default::default, |a, b| (a.0 | b.0, a.1 | b.1));
        if long && self.as_written() {
            context.report.approximate(&name, "normals are not of unit length; they are normalized");
        }
        if degenerate {
            context.report.approximate(
                &name,
                "normals are zero or not finite; they are replaced by those of the triangles",
            );
            replace_missing(&mut normals, positions, triangles);
        }
        Ok(Some(normals))
    }

    /// Unit tangents with a sign. They mean nothing without normals; degenerate ones are left to be computed anew.
    fn tangents(
        &self,
        context: &mut Context,
        with_normals: bool,
        skin: Option<&[DAffine3]>,
    ) -> Result<Option<Vec<Vec4>>, Diagnostic> {
        let name = self.path("TANGENT");
        if !with_normals {
            if self.primitive.attributes.contains_key(&Checked::Valid(Semantic::Tangents)) {
                context.report.note(&name, "tangents without normals are ignored");
            }
            return Ok(None);
        }
        let Some(accessor) = self.accessor(context, Semantic::Tangents, &name, &[4])? else {
            return Ok(None);
        };
        let mut directions: Vec<Vec3> =
            self.used.par_iter().map(|&i| Vec3::from(accessor.get(i, 0.0))).collect();
        deform::morph(self, context, ("TANGENT", |target| target.tangents), &mut directions)?;
        for (direction, place) in directions.iter_mut().zip(skin.into_iter().flatten()) {
            *direction = place.transform_vector3(direction.as_dvec3()).as_vec3();
        }
        let mut sloppy = false;
        let mut tangents = Vec::with_capacity(self.used.len());
        for (&i, direction) in self.used.iter().zip(directions) {
            let [.., sign] = accessor.get::<4>(i, 0.0);
            let Some((tangent, length)) = unit(direction).filter(|_| sign.abs() > 0.0) else {
                context.report.approximate(&name, "tangents are zero or not finite; they are computed anew");
                return Ok(None);
            };
            sloppy |= (length - 1.0).abs() > UNIT_TOLERANCE || sign.abs() != 1.0;
            tangents.push(tangent.extend(sign.signum()));
        }
        if sloppy && self.as_written() {
            context
                .report
                .approximate(&name, "tangents are not of unit length with a sign of ±1; they are normalized");
        }
        Ok(Some(tangents))
    }

    /// All texture coordinate sets up to the highest; sets in between that are absent are zero.
    fn uvs(&self, context: &mut Context) -> Result<Vec<Vec<Vec2>>, Diagnostic> {
        let mut sets: Vec<Vec<Vec2>> = Vec::new();
        for semantic in self.primitive.attributes.keys() {
            let &Checked::Valid(Semantic::TexCoords(set)) = semantic else { continue };
            let name = self.path(&format!("TEXCOORD_{set}"));
            if set >= MOST_UV_SETS {
                context.report.warn(&name, format!("dropped: only {MOST_UV_SETS} sets are read"));
                continue;
            }
            let Some(accessor) = self.accessor(context, Semantic::TexCoords(set), &name, &[2])? else {
                continue;
            };
            if sets.len() < set as usize {
                context.report.approximate(&name, "sets of a lower number are missing; they are zero");
            }
            while sets.len() < set as usize {
                context.charge(self.used.len() as u64 * 8, &name)?;
                sets.push(vec![Vec2::ZERO; self.used.len()]);
            }
            let mut uvs: Vec<Vec2> = accessor.gather(self.used, 0.0);
            let broken = uvs.par_iter().any(|uv| !uv.is_finite());
            if broken {
                uvs.iter_mut().filter(|uv| !uv.is_finite()).for_each(|uv| *uv = Vec2::ZERO);
                context.report.approximate(&name, "texture coordinates that are not finite are set to zero");
            }
            sets.push(uvs);
        }
        Ok(sets)
    }

    /// Linear RGBA, clamped; RGB has alpha 1.
    fn colors(&self, context: &mut Context) -> Result<Option<Vec<Vec4>>, Diagnostic> {
        let name = self.path("COLOR_0");
        let Some(accessor) = self.accessor(context, Semantic::Colors(0), &name, &[3, 4])? else {
            return Ok(None);
        };
        let mut colors: Vec<Vec4> = accessor.gather(self.used, 1.0);
        let clamp = |color: &mut Vec4| {
            let inside = color.map(|c| if c.is_nan() { 1.0 } else { c.clamp(0.0, 1.0) });
            inside != std::mem::replace(color, inside)
        };
        let clamped = colors.par_iter_mut().map(clamp).reduce(|| false, |a, b| a | b);
        if clamped {
            context.report.note(&name, "colours are clamped to between 0 and 1");
        }
        Ok(Some(colors))
    }
}

/// The direction and length of a vector that has a direction.
fn unit(vector: Vec3) -> Option<(Vec3, f64)> {
    let exact = vector.as_dvec3();
    let length = exact.length();
    (length.is_finite() && length > 0.0).then(|| ((exact / length).as_vec3(), length))
}

/// Gives zero normals the area-weighted mean of the triangles around.
fn replace_missing(normals: &mut [Vec3], positions: &[Vec3], triangles: &[[u32; 3]]) {
    let mut sums = vec![DVec3::ZERO; normals.len()];
    for triangle in triangles {
        let [a, b, c] = triangle.map(|i| positions.get(i as usize).map_or(DVec3::ZERO, |p| p.as_dvec3()));
        for &corner in triangle {
            if let Some(sum) = sums.get_mut(corner as usize) {
                *sum += (b - a).cross(c - a);
            }
        }
    }
    for (normal, sum) in normals.iter_mut().zip(sums).filter(|(normal, _)| **normal == Vec3::ZERO) {
        *normal = sum.try_normalize().map_or(Vec3::Z, |sum| sum.as_vec3());
    }
}
