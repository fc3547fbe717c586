//! A folder with small scenes, and the program run in it.

use std::{
    fs,
    path::PathBuf,
    process::{Command, Output, Stdio},
};

use exr::prelude::*;

/// Two cameras, one light, a box.
pub const SCENE: &str = r#"
[[import]]
file = "box.obj"

[[camera]]
name = "main"
position = [3, 2, 4]
target = [0, 0, 0]

[[camera]]
name = "top"
position = [0, 5, 0.01]
target = [0, 0, 0]

[[light]]
name = "sun"
type = "directional"
direction = [-1, -2, -1]
illuminance = 10

[render]
size = [24, 16]
spp = 4
"#;

const BOX: &str = "\
v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1
f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

/// One triangle, neither camera nor light.
const TRIANGLE: &str = r#"{
  "asset": { "version": "2.0" },
  "scene": 0,
  "scenes": [{ "nodes": [0] }],
  "nodes": [{ "name": "leaf", "mesh": 0 }],
  "meshes": [{ "name": "wedge", "primitives": [{ "attributes": { "POSITION": 0 }, "material": 0 }] }],
  "materials": [{ "name": "clay", "pbrMetallicRoughness": { "roughnessFactor": 0.25, "metallicFactor": 0 } }],
  "accessors": [{ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                  "min": [0, 0, 0], "max": [1, 1, 0] }],
  "bufferViews": [{ "buffer": 0, "byteLength": 36 }],
  "buffers": [{ "byteLength": 36,
    "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA" }]
}"#;

/// A temporary folder with `kitchen/scene.toml`, `kitchen/box.obj` and `leaf.gltf`; commands run in it.
pub struct Bench(tempfile::TempDir);

impl Bench {
    pub fn new() -> Self {
        let bench = Self(tempfile::tempdir().unwrap());
        bench.write("kitchen/scene.toml", SCENE);
        bench.write("kitchen/box.obj", BOX);
        bench.write("leaf.gltf", TRIANGLE);
        bench
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn write(&self, name: &str, bytes: impl AsRef<[u8]>) {
        let path = self.path(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, bytes).unwrap();
    }

    /// `leaf.gltf` as the only chunk of a GLB.
    pub fn glb(&self) -> Vec<u8> {
        let json = fs::read(self.path("leaf.gltf")).unwrap();
        let length = json.len().next_multiple_of(4);
        let mut glb = b"glTF\x02\0\0\0".to_vec();
        glb.extend((length as u32 + 20).to_le_bytes());
        glb.extend((length as u32).to_le_bytes());
        glb.extend(b"JSON");
        glb.extend(&json);
        glb.resize(length + 20, b' ');
        glb
    }

    pub fn has(&self, name: &str) -> bool {
        self.path(name).exists()
    }

    /// Names of the files in the folder, sorted.
    pub fn files(&self) -> Vec<String> {
        let entries = fs::read_dir(self.0.path()).unwrap();
        let mut names: Vec<_> = entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    /// The program with arguments separated by blanks.
    pub fn command(&self, arguments: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_ajar"));
        command.args(arguments.split_whitespace()).current_dir(self.0.path());
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    /// Runs the program to its end with these environment variables.
    pub fn run_with(&self, arguments: &str, variables: &[(&str, &str)]) -> Run {
        Run::new(arguments, self.command(arguments).envs(variables.iter().copied()).output().unwrap())
    }

    /// Runs the program to its end.
    pub fn run(&self, arguments: &str) -> Run {
        Run::new(arguments, self.command(arguments).output().unwrap())
    }

    /// The image as its full size, its data window as x0, y0, width, height, and the mean of all RGB values.
    pub fn image(&self, name: &str) -> Picture {
        let meta = MetaData::read_from_file(self.path(name), true).unwrap();
        let header = &meta.headers[0];
        let (display, data) = (header.shared_attributes.display_window, header.own_attributes.layer_position);
        let channels = header.channels.list.iter().map(|channel| channel.name.to_string()).collect();
        let image = read_first_rgba_layer_from_file(
            self.path(name),
            |size, _| (vec![[0.0_f32; 3]; size.area()], size.width()),
            |(pixels, width), at, (r, g, b, _): (f32, f32, f32, f32)| {
                pixels[at.y() * *width + at.x()] = [r, g, b]
            },
        );
        let pixels = image.unwrap().layer_data.channel_data.pixels.0;
        let size = header.layer_size;
        Picture {
            full: [display.size.x(), display.size.y()],
            window: [data.x(), data.y(), size.x() as i32, size.y() as i32],
            channels,
            pixels,
        }
    }
}

/// What an EXR file holds.
pub struct Picture {
    pub full: [usize; 2],
    /// Left, top, width, height of what was rendered.
    pub window: [i32; 4],
    pub channels: Vec<String>,
    pub pixels: Vec<[f32; 3]>,
}

impl Picture {
    pub fn mean(&self) -> f32 {
        self.pixels.iter().flatten().sum::<f32>() / (3 * self.pixels.len()) as f32
    }
}

/// A run that came to its end.
pub struct Run {
    pub arguments: String,
    pub code: Option<i32>,
    pub out: String,
    pub err: String,
}

impl Run {
    pub fn new(arguments: &str, output: Output) -> Self {
        let text = |bytes| String::from_utf8(bytes).unwrap();
        Self {
            arguments: arguments.into(),
            code: output.status.code(),
            out: text(output.stdout),
            err: text(output.stderr),
        }
    }

    /// Fails unless the program ended with this exit code.
    #[track_caller]
    pub fn exits(self, code: i32) -> Self {
        let Self { arguments, out, err, .. } = &self;
        assert_eq!(self.code, Some(code), "ajar {arguments}\n--- out\n{out}\n--- err\n{err}");
        self
    }

    /// Fails unless standard output holds all of these.
    #[track_caller]
    pub fn prints(self, wanted: &[&str]) -> Self {
        for text in wanted {
            assert!(
                self.out.contains(text),
                "ajar {} does not print {text:?}:\n{}",
                self.arguments,
                self.out
            );
        }
        self
    }

    /// Fails unless standard error holds all of these.
    #[track_caller]
    pub fn says(self, wanted: &[&str]) -> Self {
        for text in wanted {
            assert!(self.err.contains(text), "ajar {} does not say {text:?}:\n{}", self.arguments, self.err);
        }
        self
    }
}
