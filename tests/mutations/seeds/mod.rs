//! Sound inputs that changes begin with. Together they use everything that a format knows.

mod ajar;
mod gltf;
mod pictures;
mod text;

use crate::laboratory::Target;

/// Between the lines of a plug-in and its output.
pub const CUT: &[u8] = b"\n--\n";

const GLB: [u8; 4] = *b"glTF";
const AJAR: [u8; 4] = *b"AJAR";

/// The seeds of a format.
pub fn of(target: Target) -> Vec<Vec<u8>> {
    match target {
        Target::Gltf => gltf::all().iter().map(|asset| asset.text()).collect(),
        Target::Glb => gltf::all().iter().map(|asset| asset.glb()).collect(),
        Target::Obj => text::OBJ.iter().map(|text| text.as_bytes().to_vec()).collect(),
        Target::Mtl => vec![text::LIBRARY.as_bytes().to_vec()],
        Target::Scene => text::SCENES.iter().map(|text| text.as_bytes().to_vec()).collect(),
        Target::Ajar => ajar::all(),
        Target::Picture => pictures::all(),
        Target::PlugIn => {
            let answer = |output: &Vec<u8>| [text::MESSAGES.as_bytes(), CUT, output].concat();
            ajar::all().iter().map(answer).collect()
        }
    }
}

/// Files that seeds refer to, by name.
pub fn companions() -> Vec<(&'static str, Vec<u8>)> {
    vec![
        ("map.png", text::picture()),
        ("library.mtl", text::LIBRARY.into()),
        ("box.obj", text::OBJ[0].into()),
        ("input.picture", text::picture()),
        ("sky.toml", text::SKY.into()),
        ("base.toml", text::SCENES[1].into()),
        ("move.gltf", gltf::moving().text()),
    ]
}

/// Magic number, JSON chunk and binary chunk of a container with the layout of GLB.
pub fn taken_apart(file: &[u8]) -> Option<([u8; 4], &[u8], &[u8])> {
    let magic = file.first_chunk().copied().filter(|magic| [GLB, AJAR].contains(magic))?;
    let length = u32::from_le_bytes(file.get(12..16)?.try_into().ok()?) as usize;
    Some((magic, file.get(20..20 + length)?, file.get(28 + length..).unwrap_or_default()))
}

/// A container with the layout of GLB.
pub fn container(magic: [u8; 4], mut json: Vec<u8>, mut binary: Vec<u8>) -> Vec<u8> {
    json.resize(json.len().next_multiple_of(4), b' ');
    binary.resize(binary.len().next_multiple_of(4), 0);
    let length = |n: usize| (n as u32).to_le_bytes();
    let version = if magic == GLB { 2 } else { 1 };
    let parts = [
        &magic[..],
        &length(version),
        &length(28 + json.len() + binary.len()),
        &length(json.len()),
        b"JSON",
        &json,
        &length(binary.len()),
        b"BIN\0",
        &binary,
    ];
    parts.concat()
}
