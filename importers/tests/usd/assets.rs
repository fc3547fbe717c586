//! Real files, skipped where they are absent.

use std::path::{Path, PathBuf};

use ajar_importers::usd::Usd;
use ajar_scene::{Diagnostic, ImportRequest, Imported, Importer};

use super::{can_run, composition::bounds, warnings};

/// The folder of shared test assets, if there is one on this machine.
fn shared() -> Option<PathBuf> {
    let root = std::env::var_os("AJAR_SHARED").map(PathBuf::from);
    let root = root.unwrap_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared"));
    let assets = root.join("assets");
    if !assets.is_dir() {
        println!("skipped: no shared assets");
        return None;
    }
    can_run().then_some(assets)
}

/// Reads a file; what lies in its asset's folder may be read.
fn load(folder: &Path, file: &str) -> Result<Imported, Diagnostic> {
    let mut request = ImportRequest::new(folder.join(file));
    request.allowed.push(folder.into());
    let imported = Usd.import(&request)?;
    assert_eq!(imported.scene.validate(), [], "{file}");
    Ok(imported)
}

#[test]
fn real_files() {
    let Some(assets) = shared() else { return };
    let load = |name: &str, file: &str| {
        let imported = load(&assets.join("usd").join(name), file).unwrap();
        let triangles: usize = imported.scene.meshes.iter().map(|m| m.triangles.len()).sum();
        println!("{name}: {triangles} triangles, {:?}", warnings(&imported));
        imported
    };
    let teapot = load("Teapot", "Teapot.usd");
    assert!(teapot.scene.meshes.len() == 1 && warnings(&teapot).is_empty());
    let pyramids = load("SubdivisionSurfaces", "Creases_SpinningPyramids.usda");
    assert_eq!((pyramids.scene.cameras.len(), pyramids.scene.meshes.len()), (1, 3));
    let skinned = load("RiggedSimple", "RiggedSimple.usdz");
    assert_eq!(skinned.scene.meshes.len(), 1);
    let roughness = load("RoughnessTest", "RoughnessTest.usdz");
    assert!(!roughness.scene.images.is_empty());
    let transform = load("TextureTransformTest", "TextureTransformTest.usd");
    assert_eq!(transform.scene.images.len(), 5);
    let plastic = load("MaterialXTest", "basic.usda");
    let color = plastic.scene.materials.iter().next().unwrap().base_color.value;
    assert!((color.z - 0.818).abs() < 1e-5 && warnings(&plastic).is_empty());
    let files = load("TextureFileFormatTests", "all_files.usda");
    assert_eq!(files.scene.images.len(), 8);
    let moved = load("usdGeom_transforms", "schemaTests/usdGeom/transforms/complex_transform.usda");
    assert!(bounds(&moved.scene).0.is_finite());
    let mixed =
        load("metersPerUnit_10", "foundation/stage_configuration/metersPerUnit/metersPerUnit_mix.usda");
    assert!(warnings(&mixed).iter().any(|said| said.contains("USD does not rescale")));
    let invalid = load("comp_references", "foundation/stage_composition/references/reference_invalid.usda");
    assert!(warnings(&invalid).iter().any(|said| said.contains("Could not open asset")));
    let subsets = load("arnold_0035", "data/scene.usda");
    assert!(subsets.scene.materials.len() >= 2 && subsets.scene.meshes.len() >= 2);
    let hidden = load("arnold_0202", "data/test.usda");
    assert_eq!(hidden.scene.lights.len(), 2);
}

#[test]
fn malformed_real_files() {
    let Some(assets) = shared() else { return };
    let load = |folder: &str, file: &str| load(&assets.join("malformed").join(folder), file);
    assert!(load("made_flip_usdz", "flip_usdz.usdz").is_err_and(|e| e.file.is_some()));
    assert!(load("made_trunc_usdc", "trunc_usdc.usd").is_err_and(|e| e.file.is_some()));
    for (folder, file, expected) in [
        ("usd_upAxis_invalid", "foundation/stage_configuration/upAxis/upAxis_invalid.usda", "upAxis is"),
        (
            "usd_timeCodesPerSecond_-1",
            "foundation/stage_configuration/timeCodesPerSecond/timeCodesPerSecond_-1.usda",
            "timeCodesPerSecond is -1",
        ),
        (
            "usd_start_end_timeCodes_swapped",
            "foundation/stage_configuration/start_end_timeCode/start_end_timeCodes_swapped.usda",
            "is before startTimeCode",
        ),
    ] {
        let said = warnings(&load(folder, file).unwrap()).join("\n");
        assert!(said.contains(expected), "{folder}: {said}");
    }
}
