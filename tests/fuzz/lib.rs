//! What the fuzz targets share with `tests/mutations`.

#[path = "../mutations/laboratory.rs"]
mod laboratory;
#[path = "../mutations/seeds/mod.rs"]
pub mod seeds;

use std::{env, process, sync::LazyLock};

pub use laboratory::Target;
use laboratory::Laboratory;

/// All targets.
pub const TARGETS: [Target; 8] = [
    Target::Gltf,
    Target::Glb,
    Target::Obj,
    Target::Mtl,
    Target::Scene,
    Target::Ajar,
    Target::Picture,
    Target::PlugIn,
];

/// Tries an input; a panic is what the fuzzer looks for.
pub fn examine(target: Target, input: &[u8]) {
    static LABORATORY: LazyLock<Laboratory> = LazyLock::new(|| {
        let folder = env::temp_dir().join(format!("ajar-fuzz-{}", process::id()));
        Laboratory::new(&folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()))
    });
    if let Err(why) = LABORATORY.examine(target, input) {
        panic!("{why}");
    }
}
