//! The statements of an OBJ file that are geometry, as written: vertices, faces and what they belong to.

use std::{collections::HashMap, path::Path};

use ajar_scene::{Cause, Diagnostic};
use glam::{Vec2, Vec3};

use super::lines::{Line, Lines, quote};
use crate::report::Report;

/// An index that a face leaves out.
pub(super) const NONE: u32 = u32::MAX;

/// A corner of a face: indices from 0 into positions, texture coordinates and normals.
#[derive(Clone, Copy)]
pub(super) struct Corner {
    pub position: u32,
    pub uv: u32,
    pub normal: u32,
}

/// A face of three or more corners.
pub(super) struct Face {
    pub first: usize,
    pub count: usize,
    /// 0: none.
    pub smoothing: u32,
    pub part: u32,
    pub line: u32,
}

/// What becomes one mesh.
#[derive(Clone, Default, PartialEq, Eq, Hash)]
pub(super) struct Part {
    pub object: String,
    pub group: String,
    pub material: Option<String>,
}

/// All geometry of a file.
#[derive(Default)]
pub(super) struct Geometry {
    pub positions: Vec<Vec3>,
    /// Empty, or one a position, as written.
    pub colors: Vec<Vec3>,
    /// Origin at the bottom left, as written.
    pub uvs: Vec<Vec2>,
    /// Unit length, or zero where the file's has no direction.
    pub normals: Vec<Vec3>,
    pub corners: Vec<Corner>,
    pub faces: Vec<Face>,
    /// Each with the line of its first face.
    pub parts: Vec<(Part, usize)>,
    /// Arguments of `mtllib` and their lines.
    pub libraries: Vec<(String, usize)>,
}

/// Bytes that a corner may come to hold, here, in the maps that join equal corners, and as a vertex of a mesh.
const CORNER_BYTES: u64 = 160;

struct Parser<'a> {
    file: &'a Path,
    memory_limit: u64,
    report: &'a mut Report,
    geometry: Geometry,
    part_of: HashMap<Part, u32>,
    part: Part,
    smoothing: u32,
}

/// Reads the geometry.
///
/// # Errors
/// The first statement that is malformed, names a vertex that is not there, or needs more than `memory_limit`.
pub(super) fn parse(
    text: &str,
    file: &Path,
    memory_limit: u64,
    report: &mut Report,
) -> Result<Geometry, Diagnostic> {
    let geometry = Geometry::default();
    let (part_of, part) = Default::default();
    // The text itself, its vertices, and corners that an index of 32 bits reaches.
    let memory_limit =
        memory_limit.saturating_sub(4 * text.len() as u64).min(u64::from(u32::MAX) * CORNER_BYTES);
    let mut parser = Parser { file, memory_limit, report, geometry, part_of, part, smoothing: 0 };
    let mut understood = 0;
    for line in Lines::new(text) {
        let known = parser.statement(&line).map_err(|e| e.in_file(file))?;
        understood += usize::from(known);
    }
    parser.check_indices().map_err(|e| e.in_file(file))?;
    if understood == 0 {
        return Err(Diagnostic::error("holds no OBJ statement").in_file(file));
    }
    if parser.geometry.faces.is_empty() {
        parser.report.add(Diagnostic::warning("holds no faces").in_file(file));
    }
    Ok(parser.geometry)
}

impl Parser<'_> {
    /// Whether the statement is one of this format.
    fn statement(&mut self, line: &Line<'_>) -> Result<bool, Diagnostic> {
        match line.keyword() {
            "v" => self.vertex(line)?,
            "vt" => {
                let [u, v, _] = numbers(line, 1)?.0;
                self.geometry.uvs.push(Vec2::new(u, v));
            }
            "vn" => {
                let normal = Vec3::from_array(numbers(line, 3)?.0);
                // In f64, where the squares of all f32 fit.
                self.geometry.normals.push(normal.as_dvec3().normalize_or_zero().as_vec3());
            }
            "f" | "fo" => self.face(line)?,
            "o" => {
                self.part =
                    Part { object: name(line), material: self.part.material.take(), ..Part::default() }
            }
            "g" => self.part.group = name(line),
            "usemtl" => self.part.material = Some(line.rest().to_owned()).filter(|name| !name.is_empty()),
            "s" => self.smoothing = self.smoothing_group(line),
            "mtllib" => self.geometry.libraries.push((line.rest().to_owned(), line.number)),
            "p" => self.warn(line, "points are dropped (`p`)".to_owned()),
            "l" => self.warn(line, "lines are dropped (`l`)".to_owned()),
            other => {
                self.warn(line, format!("statement {} is not supported and dropped", quote(other)));
                return Ok(false);
            }
        }
        Ok(true)
    }

    fn warn(&mut self, line: &Line<'_>, message: String) {
        self.report.add(Diagnostic::warning(message).in_file(self.file).at(line.number, 1));
    }

    /// `v x y z [w]` or `v x y z r g b`. The weight is for rational curves only; faces ignore it.
    fn vertex(&mut self, line: &Line<'_>) -> Result<(), Diagnostic> {
        let (values, count): ([f32; 6], usize) = numbers(line, 3)?;
        let [x, y, z, r, g, b] = values;
        let geometry = &mut self.geometry;
        if count == 6 {
            // Vertices before the first coloured one are white.
            geometry.colors.resize(geometry.positions.len(), Vec3::ONE);
            geometry.colors.push(Vec3::new(r, g, b));
        } else if !geometry.colors.is_empty() {
            geometry.colors.push(Vec3::ONE);
        }
        geometry.positions.push(Vec3::new(x, y, z));
        if count == 5 || (count == 4 && r != 1.0) {
            self.warn(
                line,
                "numbers after the coordinates of a vertex are neither w = 1 nor r g b; dropped".to_owned(),
            );
        }
        Ok(())
    }

    fn face(&mut self, line: &Line<'_>) -> Result<(), Diagnostic> {
        // A corner takes two bytes of text or more: checked before they are stored.
        let asked = (self.geometry.corners.len() + line.text.len() / 2) as u64 * CORNER_BYTES;
        if asked > self.memory_limit {
            let error = line.error(&line.text, "the faces up to here need more than the memory limit");
            return Err(error.because(Cause::Resource));
        }
        let first = self.geometry.corners.len();
        for word in line.words() {
            let corner = self.corner(line, word)?;
            self.geometry.corners.push(corner);
        }
        let count = self.geometry.corners.len() - first;
        if count < 3 {
            self.geometry.corners.truncate(first);
            self.warn(line, "faces with fewer than three corners are dropped".to_owned());
            return Ok(());
        }
        let part = match self.part_of.get(&self.part) {
            Some(&part) => part,
            None => {
                let new = self.geometry.parts.len() as u32;
                self.geometry.parts.push((self.part.clone(), line.number));
                self.part_of.insert(self.part.clone(), new);
                new
            }
        };
        let (smoothing, line) = (self.smoothing, line.number as u32);
        self.geometry.faces.push(Face { first, count, smoothing, part, line });
        Ok(())
    }

    /// `v`, `v/vt`, `v//vn` or `v/vt/vn`.
    fn corner(&self, line: &Line<'_>, word: &str) -> Result<Corner, Diagnostic> {
        let mut indices = word.split('/');
        let sizes = [self.geometry.positions.len(), self.geometry.uvs.len(), self.geometry.normals.len()];
        let mut next = |size| match indices.next() {
            None | Some("") => Ok(NONE),
            Some(index) => {
                absolute(index, size).map_err(|why| line.error(index, format!("{} {why}", quote(index))))
            }
        };
        let corner = Corner { position: next(sizes[0])?, uv: next(sizes[1])?, normal: next(sizes[2])? };
        if corner.position == NONE || indices.next().is_some() {
            return Err(line.error(word, format!("{} is not a corner v/vt/vn", quote(word))));
        }
        Ok(corner)
    }

    fn smoothing_group(&mut self, line: &Line<'_>) -> u32 {
        match line.rest() {
            "off" | "" => 0,
            "on" => 1,
            group => group.parse().unwrap_or_else(|_| {
                self.warn(line, "smoothing group is not a number; taken as off".to_owned());
                0
            }),
        }
    }

    /// Faces may come before the vertices that they count from the file's beginning.
    fn check_indices(&self) -> Result<(), Diagnostic> {
        let geometry = &self.geometry;
        let out_of = |index: u32, size: usize| index != NONE && index as usize >= size;
        for face in &geometry.faces {
            for corner in &geometry.corners[face.first..face.first + face.count] {
                let kinds = [
                    ("vertex", corner.position, geometry.positions.len()),
                    ("texture coordinate", corner.uv, geometry.uvs.len()),
                    ("normal", corner.normal, geometry.normals.len()),
                ];
                for (kind, index, size) in kinds {
                    if out_of(index, size) {
                        let message =
                            format!("face names {kind} {}, the file has {size}", u64::from(index) + 1);
                        return Err(Diagnostic::error(message).at(face.line as usize, 1));
                    }
                }
            }
        }
        Ok(())
    }
}

/// An index from 1, or from −1 backwards from the last of `size`, as an index from 0.
fn absolute(index: &str, size: usize) -> Result<u32, &'static str> {
    let index: i64 = index.parse().map_err(|_| "is not an index")?;
    match index {
        0 => Err("is no index: they count from 1, or backwards from -1"),
        1.. => u32::try_from(index - 1).ok().filter(|&i| i != NONE).ok_or("is larger than any index can be"),
        _ => u32::try_from(size as i64 + index).map_err(|_| "reaches before the first element"),
    }
}

/// Reads at least `least` and at most `N` finite numbers; the others are zero.
fn numbers<const N: usize>(line: &Line<'_>, least: usize) -> Result<([f32; N], usize), Diagnostic> {
    let mut values = [0.0; N];
    let mut count = 0;
    for (value, word) in values.iter_mut().zip(line.words()) {
        *value = line.number(word)?;
        count += 1;
    }
    if count < least {
        return Err(line.error(&line.text, format!("needs {least} numbers, has {count}")));
    }
    Ok((values, count))
}

/// Group names with white space between are one name here.
fn name(line: &Line<'_>) -> String {
    line.rest().split_ascii_whitespace().collect::<Vec<_>>().join(" ")
}
