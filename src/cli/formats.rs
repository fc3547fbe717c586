//! `ajar formats`.

use serde_json::json;

use super::{Exit, print};

/// A format with its extensions and what of it is supported.
type Format = (&'static str, Vec<String>, Vec<(&'static str, &'static str)>);

/// The tables of a scene file.
const SCENE: [(&str, &str); 8] = [
    ("extends", "a scene file that this one lies over"),
    ("[[import]]", "any file listed here, placed, turned, scaled, with its unit and up axis"),
    ("[[camera]]", "perspective with thin lens and shift, or orthographic"),
    ("[[light]]", "point, spot, directional, rect, disk, sphere, cylinder, environment"),
    ("[material.NAME]", "changes parameters of imported materials, by name or path, which may hold * and ?"),
    ("[node.NAME]", "hides, moves and relights imported nodes, likewise"),
    ("[render]", "integrator, camera, size, stop rules, seed, path length, crop"),
    ("[output]", "paths, tone map, exposure, layers, precision"),
];

/// What textures may be; the bytes of a file decide, not its name.
const IMAGES: [(&str, &str); 8] = [
    ("PNG", "8 and 16 bits a channel"),
    ("JPEG", "baseline and progressive"),
    ("WebP", "lossy and lossless"),
    ("TIFF", "8 and 16 bits, 32-bit floats"),
    ("TGA, BMP", "8 bits a channel"),
    ("Radiance HDR", "RGBE"),
    ("OpenEXR", "half, float; flat images"),
    ("KTX2", "Basis Universal (ETC1S, UASTC, ASTC), or a byte a channel; the first level"),
];

#[derive(Debug, clap::Args)]
#[command(after_help = super::EXIT_CODES)]
pub(super) struct Args {
    /// Print as JSON
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &Args) -> Exit {
    print(&if args.json { as_json() } else { as_text() });
    Exit::Ok
}

fn formats() -> Vec<Format> {
    let imported = ajar_importers::importers().iter().map(|importer| {
        let extensions = importer.extensions().iter().map(|e| format!(".{e}")).collect();
        let features = importer.features().iter().map(|f| (f.name, f.support)).collect();
        (importer.name(), extensions, features)
    });
    let native = ("scene", vec![".toml".to_owned()], SCENE.to_vec());
    std::iter::once(native).chain(imported).collect()
}

fn as_json() -> String {
    let rows = |rows: &[(&str, &str)]| -> Vec<_> {
        rows.iter().map(|(name, support)| json!({ "name": name, "support": support })).collect()
    };
    let formats: Vec<_> = formats()
        .iter()
        .map(|(name, extensions, features)| {
            json!({ "name": name, "extensions": extensions, "features": rows(features) })
        })
        .collect();
    format!("{:#}", json!({ "formats": formats, "images": rows(&IMAGES) }))
}

fn as_text() -> String {
    let mut sections: Vec<_> = formats()
        .into_iter()
        .map(|(name, extensions, features)| (format!("{name}  {}", extensions.join(" ")), features))
        .collect();
    sections.push(("textures".to_owned(), IMAGES.to_vec()));
    let names = sections.iter().flat_map(|(_, rows)| rows);
    let width = names.map(|(name, _)| name.chars().count()).max().unwrap_or(0);
    let section = |(title, rows): &(String, Vec<(&str, &str)>)| {
        let lines = rows.iter().map(|(name, support)| format!("\n  {name:width$}  {support}"));
        format!("{title}{}", lines.collect::<String>())
    };
    sections.iter().map(section).collect::<Vec<_>>().join("\n\n")
}
