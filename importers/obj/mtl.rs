//! Material libraries into `tobj` materials.
//!
//! `tobj` gives up on a whole library for one bad statement, panics on `Kd 0.5` and takes NaN, so every statement that
//! it reads as numbers is checked and written out plainly before, and materials are handed over one by one.

use std::{
    collections::HashMap,
    path::{Path, PathBuf},
};

use ajar_scene::Diagnostic;

use super::lines::{Line, Lines, quote};
use crate::report::Report;

/// A material as written.
pub(super) struct Definition {
    pub source: tobj::Material,
    /// The library, as resolved.
    pub file: PathBuf,
    /// The folder of the library as the OBJ file names it; textures are looked for there first.
    pub folder: String,
    /// Line of `newmtl`.
    pub line: usize,
    /// Lines of its statements, by the names that `tobj` knows.
    pub lines: HashMap<String, usize>,
}

/// A material on the way: its statements as `tobj` reads them, and where they are.
struct Block {
    text: String,
    line: usize,
    lines: HashMap<String, usize>,
}

/// Statements that are colours; one number means grey.
const COLORS: [&str; 5] = ["Ka", "Kd", "Ks", "Ke", "Tf"];
/// Statements that are one number.
const NUMBERS: [&str; 11] = ["Ns", "Ni", "d", "Tr", "Pr", "Pm", "Ps", "Pc", "Pcr", "aniso", "anisor"];
/// Statements that name an image.
const MAPS: [&str; 17] = [
    "map_Ka", "map_Kd", "map_Ks", "map_Ke", "map_Ns", "map_d", "map_Bump", "bump", "norm", "map_Pr",
    "map_Pm", "map_Pc", "map_Pcr", "map_Ps", "disp", "decal", "refl",
];

/// Reads all materials of a library; what cannot be read of it is reported.
pub(super) fn parse(text: &str, file: &Path, folder: &str, report: &mut Report) -> Vec<Definition> {
    let mut definitions = Vec::new();
    let mut open: Option<Block> = None;
    let mut close = |open: Option<Block>, report: &mut Report| {
        let Some(Block { text, line, lines }) = open else { return };
        match tobj::load_mtl_buf(&mut text.as_bytes()) {
            Ok((sources, _)) => definitions.extend(sources.into_iter().map(|source| Definition {
                source,
                file: file.to_owned(),
                folder: folder.to_owned(),
                line,
                lines: lines.clone(),
            })),
            Err(e) => report.add(
                Diagnostic::warning(format!("the material cannot be read: {e}")).in_file(file).at(line, 1),
            ),
        }
    };
    for line in Lines::new(text) {
        if line.keyword().eq_ignore_ascii_case("newmtl") {
            close(open.take(), report);
            if line.rest().is_empty() {
                report.add(Diagnostic::warning("a material has no name").in_file(file).at(line.number, 1));
            } else {
                let text = format!("newmtl {}\n", line.rest());
                open = Some(Block { text, line: line.number, lines: HashMap::new() });
            }
            continue;
        }
        match (plain(&line), &mut open) {
            (Ok(statement), Some(block)) => {
                let name = statement.split_ascii_whitespace().next().unwrap_or_default();
                block.lines.insert(name.to_owned(), line.number);
                block.text.push_str(&statement);
                block.text.push('\n');
            }
            (Ok(_), None) => report.add(
                Diagnostic::warning("a statement belongs to no material").in_file(file).at(line.number, 1),
            ),
            (Err(mut e), _) => {
                e.severity = ajar_scene::Severity::Warning;
                e.message.push_str("; statement dropped");
                report.add(e.in_file(file));
            }
        }
    }
    close(open, report);
    definitions
}

/// The statement in the spelling and with the numbers that `tobj` reads.
fn plain(line: &Line<'_>) -> Result<String, Diagnostic> {
    let written = line.keyword();
    let find = |list: &[&'static str]| list.iter().find(|name| name.eq_ignore_ascii_case(written)).copied();
    let words: Vec<_> = line.words().collect();
    if let Some(name) = find(&COLORS) {
        if let ["spectral" | "xyz", ..] = words.as_slice() {
            return Err(line.error(written, format!("{name} is not given as red, green and blue")));
        }
        let values = words.iter().take(3).map(|word| line.number(word)).collect::<Result<Vec<_>, _>>()?;
        return match *values.as_slice() {
            [grey] => Ok(format!("{name} {grey} {grey} {grey}")),
            [r, g, b] => Ok(format!("{name} {r} {g} {b}")),
            _ => Err(line.error(written, format!("{name} needs one or three numbers"))),
        };
    }
    let needs = |what: &str| line.error(written, format!("{} needs {what}", quote(written)));
    if let Some(name) = find(&NUMBERS) {
        // `d -halo 0.5` depends on the view; what is left of it is the number.
        let word = words.last().ok_or_else(|| needs("a number"))?;
        return Ok(format!("{name} {}", line.number(word)?));
    }
    if written.eq_ignore_ascii_case("illum") {
        let model = words.first().and_then(|word| word.parse::<u8>().ok());
        return Ok(format!("illum {}", model.ok_or_else(|| needs("a number from 0 to 10"))?));
    }
    if line.rest().is_empty() && find(&MAPS).is_some() {
        return Err(needs("a file"));
    }
    let name = match find(&MAPS) {
        // Two names of one statement.
        Some("bump") => "map_Bump",
        Some(name) => name,
        None => written,
    };
    Ok(format!("{name} {}", line.rest()))
}
