//! How fast a GLB is imported, beside a plain parse of its buffers.
//!
//! Usage: `parse FILE.glb`. A plain parse reads the file, lets the `gltf` crate read its JSON, and collects what the crate's
//! iterators give for positions, normals, texture coordinates and indices; it looks at no number. The import goes up to
//! the scene graph. They take turns and the fastest of each counts, so that the file comes from the system's cache.

use std::{
    error::Error,
    fs,
    hint::black_box,
    io::Write,
    path::Path,
    time::{Duration, Instant},
};

use ajar_scene::ImportRequest;

const TURNS: usize = 7;

/// What a primitive holds.
#[expect(dead_code, reason = "that it is made is what counts")]
struct Arrays {
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    uvs: Vec<Vec<[f32; 2]>>,
    indices: Vec<u32>,
}

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).ok_or("usage: parse FILE.glb")?;
    let path = Path::new(&path);
    let request = ImportRequest { memory_limit: u64::MAX, ..ImportRequest::new(path) };
    let (mut plain, mut import) = (Duration::MAX, Duration::MAX);
    for _ in 0..TURNS {
        plain = plain.min(timed(|| parse(path))?);
        import = import.min(timed(|| Ok(ajar_importers::import(&request).map_err(|e| e.to_string())?))?);
    }
    let megabytes = path.metadata()?.len() as f64 / 1e6;
    let mut out = std::io::stdout();
    for (name, time) in [("plain parse", plain), ("import", import)] {
        let seconds = time.as_secs_f64();
        writeln!(out, "{name:12} {seconds:.3} s, {:.0} MB/s", megabytes / seconds)?;
    }
    writeln!(
        out,
        "the import has {:.0} % of the plain parse's rate",
        100.0 * plain.div_duration_f64(import)
    )?;
    Ok(())
}

/// Time until the result is there; that it is let go again does not count.
fn timed<T>(work: impl Fn() -> Result<T, Box<dyn Error>>) -> Result<Duration, Box<dyn Error>> {
    let start = Instant::now();
    let made = black_box(work()?);
    let time = start.elapsed();
    drop(made);
    Ok(time)
}

/// The plain parse.
fn parse(path: &Path) -> Result<Vec<Arrays>, Box<dyn Error>> {
    let file = fs::read(path)?;
    let glb = gltf::Glb::from_slice(&file)?;
    let document = gltf::Document::from_json(gltf::json::deserialize::from_slice(&glb.json)?)?;
    let arrays = |primitive: gltf::Primitive| {
        let reader = primitive.reader(|_| glb.bin.as_deref());
        let uvs = (0..).map_while(|set| reader.read_tex_coords(set));
        Arrays {
            positions: reader.read_positions().map(Iterator::collect).unwrap_or_default(),
            normals: reader.read_normals().map(Iterator::collect).unwrap_or_default(),
            uvs: uvs.map(|uvs| uvs.into_f32().collect()).collect(),
            indices: reader.read_indices().map(|indices| indices.into_u32().collect()).unwrap_or_default(),
        }
    };
    Ok(document.meshes().flat_map(|mesh| mesh.primitives()).map(arrays).collect())
}
