//! Files that want out of their folder, or more than there is.

use std::{
    fs,
    time::{Duration, Instant},
};

use ajar_importers::usd::Usd;
use ajar_scene::{Cause, Diagnostic, ImportRequest, Importer};

use super::{Stage, can_run};

/// What a stage with a secret beside its folder fails with.
fn failure(prims: &str) -> Diagnostic {
    let stage = Stage::new(prims);
    let started = Instant::now();
    let error = stage.import().unwrap_err();
    assert!(started.elapsed() < Duration::from_secs(5), "{error}");
    assert_eq!(error.cause, Cause::Asset, "{error}");
    error
}

#[test]
fn nothing_outside_the_folder_is_opened() {
    if !can_run() {
        return;
    }
    let outside = tempfile::tempdir().unwrap();
    fs::write(outside.path().join("secret.usda"), "#usda 1.0\ndef Sphere \"S\" {}\n").unwrap();
    let absolute = outside.path().join("secret.usda").to_string_lossy().into_owned();
    let wanted = "lies outside the scene's folder";
    for (prims, place, message) in [
        (format!("def \"A\" (references = @{absolute}@</S>) {{}}"), Some("/A"), wanted),
        ("def \"A\" (payload = @../../secret.usda@) {}".into(), Some("/A"), wanted),
        ("def \"A\" (references = @http://a.example/b.usd@) {}".into(), Some("/A"), "is a URL"),
        (
            format!(
                "def \"A\" (variants = {{ string v = \"x\" }}\nprepend variantSets = \"v\") {{\nvariantSet \"v\" = {{ \"x\" {{}} \"y\" (references = @{absolute}@) {{}} }} }}"
            ),
            Some("/A{v=y}"),
            wanted,
        ),
        (
            format!(
                "def \"A\" (clips = {{ dictionary default = {{ asset[] assetPaths = [@{absolute}@] }} }}) {{}}"
            ),
            Some("/A"),
            wanted,
        ),
        ("def \"A\" (references = @`\"/x/\" + \"y.usd\"`@) {}".into(), Some("/A"), "is computed"),
        (format!("def \"A\" (references = @{absolute}.mtlx@</MaterialX>) {{}}"), Some("/A"), wanted),
        ("def DomeLight \"A\" { asset inputs:texture:file = @../sky.hdr@ }".into(), Some("/A"), wanted),
    ] {
        let error = failure(&prims);
        assert_eq!(error.element.as_deref(), place, "{error}");
        assert!(error.message.contains(message), "{prims}: {error}");
    }
    let mut stage = Stage::new(&format!("def \"A\" (references = @{absolute}@</S>) {{}}"));
    stage.request.allowed.push(outside.path().into());
    assert_eq!(stage.scene().scene.meshes.len(), 1, "an allowed folder may be read");
}

#[cfg(unix)]
#[test]
fn a_link_out_of_the_folder_is_not_followed() {
    if !can_run() {
        return;
    }
    let outside = tempfile::NamedTempFile::new().unwrap();
    let stage = Stage::new("def \"A\" (references = @link.usda@) {}");
    std::os::unix::fs::symlink(outside.path(), stage.folder.path().join("link.usda")).unwrap();
    assert!(stage.import().unwrap_err().message.contains("lies outside"));
}

#[test]
fn references_that_multiply_are_counted_before_they_are_made() {
    if !can_run() {
        return;
    }
    // 10 levels with 10 references each: 10¹⁰ prims.
    let mut prims = String::from("def \"L0\" {}\n");
    for level in 1..=10 {
        let children: String =
            (0..10).map(|i| format!("def \"C{i}\" (references = </L{}>) {{}}\n", level - 1)).collect();
        prims += &format!("def \"L{level}\" {{\n{children}}}\n");
    }
    let stage = Stage::new(&prims);
    let started = Instant::now();
    let error = stage.import().unwrap_err();
    assert!(started.elapsed() < Duration::from_secs(5));
    assert!(error.message.contains("references make") && error.element.is_some(), "{error}");
    assert_eq!(error.cause, Cause::Asset);
    let cycle = "def \"A\" { def \"B\" (references = </A>) {} }";
    assert!(Stage::new(cycle).import().is_ok(), "a cycle is a warning of usd-core");
}

#[test]
fn packages_hold_files_as_they_are() {
    if !can_run() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    for (name, method, message) in [
        ("scene.usda", 8_u16, "compressed"),
        ("../scene.usda", 0, "leaves it"),
        ("/scene.usda", 0, "leaves it"),
    ] {
        let path = folder.path().join("main.usdz");
        fs::write(&path, package(name, method)).unwrap();
        let error = Usd.import(&ImportRequest::new(&path)).unwrap_err();
        assert!(error.message.contains(message) && error.cause == Cause::Asset, "{name}: {error}");
    }
    let path = folder.path().join("good.usdz");
    fs::write(&path, package("scene.usda", 0)).unwrap();
    assert_eq!(Usd.import(&ImportRequest::new(&path)).unwrap().scene.meshes.len(), 1);
}

/// A ZIP archive with one file, which says of itself that it is compressed by `method`.
fn package(name: &str, method: u16) -> Vec<u8> {
    let text = b"#usda 1.0\ndef Cube \"C\" {}\n";
    let mut common = Vec::new();
    common.extend([20_u16, 0, method, 0, 0x21].iter().flat_map(|n| n.to_le_bytes()));
    let size = text.len() as u32;
    common.extend([crc(text), size, size].iter().flat_map(|n| n.to_le_bytes()));
    let mut file = [b"PK\x03\x04".as_slice(), &common].concat();
    // Files in a package begin at multiples of 64 bytes; the extra field fills up.
    let fill = 64 - (30 + name.len()) % 64;
    file.extend([name.len() as u16, fill as u16].iter().flat_map(|n| n.to_le_bytes()));
    file.extend(name.as_bytes());
    file.extend([0x86_u16, fill as u16 - 4].iter().flat_map(|n| n.to_le_bytes()));
    file.resize(file.len() + fill - 4, 0);
    file.extend(text);
    let central = file.len() as u32;
    file.extend(b"PK\x01\x02\x14\x00");
    file.extend(&common);
    file.extend([name.len() as u16, 0, 0, 0, 0].iter().flat_map(|n| n.to_le_bytes()));
    file.extend([0_u32, 0].iter().flat_map(|n| n.to_le_bytes()));
    file.extend(name.as_bytes());
    let length = file.len() as u32 - central;
    file.extend(b"PK\x05\x06\0\0\0\0\x01\0\x01\0");
    file.extend([length, central].iter().flat_map(|n| n.to_le_bytes()));
    file.extend([0, 0]);
    file
}

/// CRC-32 of ZIP archives.
fn crc(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0_u32, |crc, &byte| {
        (0..8).fold(crc ^ u32::from(byte), |crc, _| (crc >> 1) ^ (0xEDB8_8320 * (crc & 1)))
    })
}

#[test]
fn broken_text_is_an_error_with_its_place() {
    if !can_run() {
        return;
    }
    let error =
        Stage::whole("#usda 1.0\ndef Sphere \"S\" {\n  double radius = = 3\n}\n").import().unwrap_err();
    assert!(error.message.contains("is no USD that can be read"), "{error}");
    assert!(error.message.contains('3'), "the line is named: {error}");
    let deep = "def \"A\" {".repeat(2000) + &"}".repeat(2000);
    let error = Stage::new(&deep).import().unwrap_err();
    assert_eq!(error.cause, Cause::Asset, "{error}");
}
