//! Small glTF files, put together in memory.

use std::fs;

use ajar_scene::{Choice, Diagnostic, ImportRequest, Imported};
use base64::{Engine, engine::general_purpose::STANDARD};
use serde_json::{Value, json};

pub const FLOAT: u32 = 5126;
pub const BYTE: u32 = 5120;
pub const UNSIGNED_BYTE: u32 = 5121;
pub const SHORT: u32 = 5122;
pub const UNSIGNED_SHORT: u32 = 5123;
pub const UNSIGNED_INT: u32 = 5125;

/// The first bytes of a PNG: images are recognized but not decoded.
pub const PNG: &[u8] = b"\x89PNG\r\n\x1a\n1234567890";

pub fn data_uri(bytes: &[u8]) -> String {
    format!("data:application/octet-stream;base64,{}", STANDARD.encode(bytes))
}

pub fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

/// Imports the first of these files from a folder with all of them.
pub fn import_files(files: &[(&str, &[u8])]) -> Result<Imported, Diagnostic> {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in files {
        fs::write(folder.path().join(name), bytes).unwrap();
    }
    ajar_importers::import(&ImportRequest::new(folder.path().join(files[0].0)))
}

/// A document and the bytes of its only buffer.
#[derive(Clone)]
pub struct Asset {
    pub json: Value,
    pub data: Vec<u8>,
}

impl Asset {
    /// A document with nothing in it.
    pub fn new() -> Self {
        Self { json: json!({"asset": {"version": "2.0"}}), data: Vec::new() }
    }

    /// One node with one triangle, whose primitive has these members besides `POSITION`.
    pub fn triangle(members: Value) -> Self {
        let mut asset = Self::new();
        asset.positions(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        asset.primitive(members);
        asset
    }

    /// One node with one triangle of this material.
    pub fn with_material(material: Value) -> Self {
        let mut asset = Self::triangle(json!({"material": 0}));
        asset.json["materials"] = json!([material]);
        asset.json["images"] = json!([{"uri": data_uri(PNG)}, {"uri": data_uri(PNG)}]);
        asset.json["textures"] = json!([{"source": 0}, {"source": 1}]);
        asset
    }

    pub fn push(&mut self, list: &str, item: Value) -> usize {
        if self.json[list].is_null() {
            self.json[list] = json!([]);
        }
        let items = self.json[list].as_array_mut().unwrap();
        items.push(item);
        items.len() - 1
    }

    /// A buffer view of these bytes with these further members.
    pub fn view(&mut self, bytes: &[u8], members: Value) -> usize {
        let offset = self.data.len();
        self.data.extend(bytes);
        self.data.resize(self.data.len().next_multiple_of(4), 0);
        let view = json!({"buffer": 0, "byteOffset": offset, "byteLength": bytes.len()});
        self.push("bufferViews", merged(view, members))
    }

    pub fn accessor(
        &mut self,
        component: u32,
        kind: &str,
        count: usize,
        bytes: &[u8],
        members: Value,
    ) -> usize {
        let view = self.view(bytes, json!({}));
        let accessor = json!({"bufferView": view, "componentType": component, "type": kind, "count": count});
        self.push("accessors", merged(accessor, members))
    }

    pub fn float_accessor(&mut self, kind: &str, width: usize, values: &[f32]) -> usize {
        self.accessor(FLOAT, kind, values.len() / width, &floats(values), json!({}))
    }

    /// Accessor 0 of most files here.
    pub fn positions(&mut self, positions: &[[f32; 3]]) -> usize {
        self.float_accessor("VEC3", 3, positions.as_flattened())
    }

    /// A mesh of one primitive at a node of its own; `POSITION` is accessor 0.
    pub fn primitive(&mut self, members: Value) {
        let mesh = self
            .push("meshes", json!({"primitives": [merged(json!({"attributes": {"POSITION": 0}}), members)]}));
        self.push("nodes", json!({"mesh": mesh}));
    }

    /// Adds an attribute to the first primitive.
    pub fn attribute(&mut self, name: &str, accessor: usize) {
        self.json["meshes"][0]["primitives"][0]["attributes"][name] = json!(accessor);
    }

    /// The document with its buffer as a data URI.
    pub fn text(&self) -> Vec<u8> {
        let mut document = self.json.clone();
        if !self.data.is_empty() {
            document["buffers"] = json!([{"byteLength": self.data.len(), "uri": data_uri(&self.data)}]);
        }
        serde_json::to_vec(&document).unwrap()
    }

    /// The document with its buffer as a GLB.
    pub fn glb(&self) -> Vec<u8> {
        let mut document = self.json.clone();
        document["buffers"] = json!([{"byteLength": self.data.len()}]);
        let mut json = serde_json::to_vec(&document).unwrap();
        json.resize(json.len().next_multiple_of(4), b' ');
        let length = 12 + 8 + json.len() + 8 + self.data.len();
        let mut file = b"glTF\x02\0\0\0".to_vec();
        file.extend((length as u32).to_le_bytes());
        for (kind, chunk) in [(b"JSON", &json), (b"BIN\0", &self.data)] {
            file.extend((chunk.len() as u32).to_le_bytes());
            file.extend(kind);
            file.extend(chunk);
        }
        file
    }

    pub fn import(&self) -> Result<Imported, Diagnostic> {
        import_files(&[("main.gltf", &self.text())])
    }

    /// Imports what a choice shows.
    pub fn import_as(&self, choice: &Choice) -> Result<Imported, Diagnostic> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("main.gltf");
        fs::write(&path, self.text()).unwrap();
        ajar_importers::import(&ImportRequest { choice: choice.clone(), ..ImportRequest::new(path) })
    }
}

fn merged(mut base: Value, members: Value) -> Value {
    for (key, value) in members.as_object().unwrap() {
        match (base[key].as_object_mut(), value.as_object()) {
            (Some(inner), Some(more)) => inner.extend(more.clone()),
            _ => base[key] = value.clone(),
        }
    }
    base
}
