//! Hostile glTF.

use base64::{Engine, engine::general_purpose::STANDARD};

use crate::jail::{
    Fate::{self, Clean, Either, Refused, TooLarge},
    Jail,
};

/// Levels of a deep nesting, items of a long list.
const MANY: usize = 100_000;

/// A triangle as parts of a glTF, each of which a test can replace.
pub struct Asset {
    pub accessors: String,
    pub views: String,
    pub buffers: String,
    pub nodes: String,
    pub roots: String,
    /// Further members of the document, each with a comma before it.
    pub more: String,
}

impl Asset {
    pub fn new() -> Self {
        let numbers: [f32; 9] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
        let bytes: Vec<u8> = numbers.into_iter().flat_map(f32::to_le_bytes).collect();
        let data = STANDARD.encode(bytes);
        Self {
            accessors: r#"{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}"#.into(),
            views: r#"{"buffer":0,"byteLength":36}"#.into(),
            buffers: format!(r#"{{"byteLength":36,"uri":"data:application/octet-stream;base64,{data}"}}"#),
            nodes: r#"{"mesh":0}"#.into(),
            roots: "0".into(),
            more: String::new(),
        }
    }

    pub fn text(&self) -> String {
        let Self { accessors, views, buffers, nodes, roots, more } = self;
        format!(
            r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[{roots}]}}],"nodes":[{nodes}],
"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],
"accessors":[{accessors}],"bufferViews":[{views}],"buffers":[{buffers}]{more}}}"#
        )
    }
}

fn asset(change: impl FnOnce(&mut Asset)) -> String {
    let mut asset = Asset::new();
    change(&mut asset);
    asset.text()
}

fn with_buffer(uri: &str) -> String {
    asset(|it| it.buffers = format!(r#"{{"byteLength":36,"uri":"{uri}"}}"#))
}

fn with_accessor(accessor: &str) -> String {
    asset(|it| it.accessors = accessor.into())
}

fn with_more(more: &str) -> String {
    asset(|it| it.more = format!(",{more}"))
}

#[test]
fn the_asset_that_all_others_change_is_sound() {
    let mut jail = Jail::new();
    jail.try_file("sound.gltf", Asset::new().text(), Clean);
    jail.try_file("sound.gltf", with_accessor("{}"), Refused);
    jail.close();
}

#[test]
fn numbers_that_promise_too_much() {
    let mut jail = Jail::new();
    let counts = ["4294967295", "18446744073709551615", "1e18", "-1", "0", "100000000", "null", "\"3\""];
    for (index, count) in counts.into_iter().enumerate() {
        let viewed = format!(r#"{{"bufferView":0,"componentType":5126,"count":{count},"type":"VEC3"}}"#);
        jail.try_file(&format!("count{index}.gltf"), with_accessor(&viewed), Refused);
        // Without a view all is zero, which needs no bytes in the file.
        let zeros = format!(r#"{{"componentType":5126,"count":{count},"type":"VEC3"}}"#);
        let fate = if count == "100000000" { TooLarge } else { Refused };
        jail.try_file(&format!("zeros{index}.gltf"), with_accessor(&zeros), fate);
        let sparse = format!(
            r#"{{"componentType":5126,"count":3,"type":"VEC3","sparse":{{"count":{count},
            "indices":{{"bufferView":0,"componentType":5125}},"values":{{"bufferView":0}}}}}}"#
        );
        jail.try_file(&format!("sparse{index}.gltf"), with_accessor(&sparse), Refused);
    }
    for (index, number) in ["18446744073709551615", "9223372036854775807", "-4", "37"].into_iter().enumerate()
    {
        let offset = format!(
            r#"{{"bufferView":0,"byteOffset":{number},"componentType":5126,"count":3,"type":"VEC3"}}"#
        );
        jail.try_file(&format!("offset{index}.gltf"), with_accessor(&offset), Refused);
        for view in [
            format!(r#"{{"buffer":0,"byteOffset":{number},"byteLength":36}}"#),
            format!(r#"{{"buffer":0,"byteLength":{number}}}"#),
            format!(r#"{{"buffer":0,"byteLength":36,"byteStride":{number}}}"#),
            format!(r#"{{"buffer":{number},"byteLength":36}}"#),
        ] {
            jail.try_file("view.gltf", asset(|it| it.views = view), Refused);
        }
    }
    jail.close();
}

#[test]
fn deep_and_long_structures() {
    let mut jail = Jail::new();
    let nest = |open: &str, close: &str| format!("{}{}", open.repeat(MANY), close.repeat(MANY));
    jail.try_file("arrays.gltf", nest("[", "]"), Refused);
    jail.try_file("open.gltf", "[".repeat(MANY), Refused);
    jail.try_file("objects.gltf", nest("{\"a\":", "}"), Refused);
    jail.try_file("extras.gltf", with_more(&format!("\"extras\":{}", nest("[", "]"))), Refused);
    let chain: Vec<_> = (1..MANY).map(|i| format!(r#"{{"children":[{i}]}}"#)).collect();
    let chain = format!("{},{{\"mesh\":0}}", chain.join(","));
    jail.try_file("chain.gltf", asset(|it| it.nodes = chain), Either);
    let own = format!(r#"{{"mesh":0,"children":[{}]}}"#, vec!["0"; MANY].join(","));
    jail.try_file("own.gltf", asset(|it| it.nodes = own), Refused);
    let double = (1..40).map(|i| format!(r#"{{"children":[{i},{i}]}}"#)).collect::<Vec<_>>().join(",");
    jail.try_file("double.gltf", asset(|it| it.nodes = format!("{double},{{\"mesh\":0}}")), Refused);
    jail.try_file("roots.gltf", asset(|it| it.roots = vec!["0"; MANY].join(",")), Either);
    let same = format!(r#"{{"mesh":0,"name":"{}"}}"#, "n".repeat(20));
    let nodes = vec![same; MANY].join(",");
    let roots = (0..MANY).map(|i| i.to_string()).collect::<Vec<_>>().join(",");
    let wide = asset(|it| (it.nodes, it.roots) = (nodes, roots));
    jail.try_file("wide.gltf", wide, Either);
    let materials = vec![r#"{"name":"m","extensions":{"ACME_paint":{}}}"#; MANY].join(",");
    jail.try_file("materials.gltf", with_more(&format!("\"materials\":[{materials}]")), Either);
    let used: Vec<_> = (0..MANY).map(|i| format!("\"ACME_{i}\"")).collect();
    jail.try_file("used.gltf", with_more(&format!("\"extensionsUsed\":[{}]", used.join(","))), Either);
    jail.try_file(
        "required.gltf",
        with_more(&format!("\"extensionsRequired\":[{}]", used.join(","))),
        Refused,
    );
    jail.close();
}

#[test]
fn references_stay_in_the_folder_and_off_the_network() {
    let mut jail = Jail::new();
    jail.put("secret.bin", [0; 36]);
    for (index, uri) in [
        "../../../../../../../../etc/passwd",
        "../secret.bin",
        "..\\\\secret.bin",
        "%2e%2e/secret.bin",
        "%2e%2e%2fsecret.bin",
        "x/../../secret.bin",
        "/etc/passwd",
        "//host/share/a.bin",
        "file:///etc/passwd",
        "http://localhost/a.bin",
        "https://localhost/a.bin",
        "/dev/zero",
        "/proc/self/mem",
        ".",
        "..",
        "",
        "a.bin%00.png",
        "\\u0000",
        "%ff%fe",
        "CON",
    ]
    .into_iter()
    .enumerate()
    {
        jail.try_file(&format!("inner/buffer{index}.gltf"), with_buffer(uri), Refused);
        let image = format!(
            r#""images":[{{"uri":"{uri}"}}],"textures":[{{"source":0}}],
            "materials":[{{"pbrMetallicRoughness":{{"baseColorTexture":{{"index":0}}}}}}]"#
        );
        jail.try_file(&format!("inner/image{index}.gltf"), with_more(&image), Either);
    }
    jail.close();
}

#[cfg(unix)]
#[test]
fn links_and_pipes_are_no_way_out() {
    let mut jail = Jail::new();
    let secret = jail.put("secret.bin", [0; 36]);
    jail.put("inner/there.bin", [0; 36]);
    std::os::unix::fs::symlink(secret, jail.path("inner/link.bin")).unwrap();
    jail.try_file("inner/link.gltf", with_buffer("link.bin"), Refused);
    let made = std::process::Command::new("mkfifo").arg(jail.path("inner/pipe.bin")).status();
    if made.is_ok_and(|status| status.success()) {
        jail.try_file("inner/pipe.gltf", with_buffer("pipe.bin"), Refused);
    }
    jail.try_file("inner/there.gltf", with_buffer("there.bin"), Clean);
    jail.close();
}

#[test]
fn data_uris() {
    let mut jail = Jail::new();
    let base64 = "data:application/octet-stream;base64,";
    for uri in [
        "data:",
        "data:,",
        base64,
        "data:;base64,====",
        "data:;base64,A",
        "data:;base64,\u{e9}",
        "data:text/plain,abc",
    ] {
        jail.try_file("uri.gltf", with_buffer(uri), Refused);
    }
    let large = format!("{base64}{}", "AAAA".repeat(6 << 20));
    jail.try_file("large.gltf", with_buffer(&large), Either);
    let lie = asset(|it| it.buffers = format!(r#"{{"byteLength":1000000000000,"uri":"{base64}AAAA"}}"#));
    jail.try_file("lie.gltf", lie, Refused);
    let one = format!(r#"{{"byteLength":65536,"uri":"{base64}{}"}}"#, "AAAA".repeat(1 << 14));
    jail.try_file("short.gltf", asset(|it| it.buffers = one), Refused);
    jail.close();
}

#[test]
fn numbers_that_are_none() {
    let mut jail = Jail::new();
    for (node, fate) in [
        (r#"{"mesh":0,"scale":[0,0,0]}"#, Either),
        (r#"{"mesh":0,"scale":[1e300,1,1]}"#, Either),
        (r#"{"mesh":0,"translation":[1e999,0,0]}"#, Refused),
        (r#"{"mesh":0,"translation":[3e38,3e38,3e38]}"#, Either),
        (r#"{"mesh":0,"rotation":[0,0,0,0]}"#, Either),
        (r#"{"mesh":0,"matrix":[1,0,0,0]}"#, Refused),
        (r#"{"mesh":0,"matrix":[0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0]}"#, Either),
        (r#"{"mesh":7}"#, Refused),
        (r#"{"mesh":-1}"#, Refused),
        (r#"{"camera":0,"skin":9}"#, Refused),
    ] {
        jail.try_file("node.gltf", asset(|it| it.nodes = node.into()), fate);
    }
    let lamp = |light: &str| {
        with_more(&format!(
            r#""extensionsUsed":["KHR_lights_punctual"],
            "extensions":{{"KHR_lights_punctual":{{"lights":[{light}]}}}}"#
        ))
    };
    for light in [
        r#"{"type":"point","intensity":-1}"#,
        r#"{"type":"point","intensity":1e300}"#,
        r#"{"type":"laser"}"#,
        r#"{"type":"spot","spot":{"innerConeAngle":3,"outerConeAngle":-1}}"#,
        "7",
    ] {
        jail.try_file("light.gltf", lamp(light), Either);
    }
    for camera in [
        r#"{"type":"perspective","perspective":{"yfov":0,"znear":1}}"#,
        r#"{"type":"perspective","perspective":{"yfov":100,"znear":-1}}"#,
        r#"{"type":"orthographic","orthographic":{"xmag":0,"ymag":0,"znear":0,"zfar":0}}"#,
        r#"{"type":"fisheye"}"#,
    ] {
        let text = with_more(&format!("\"cameras\":[{camera}]"));
        let text = text.replace(r#"{"mesh":0}"#, r#"{"mesh":0,"camera":0}"#);
        jail.try_file("camera.gltf", text, Either);
    }
    jail.close();
}

#[test]
fn documents_that_are_none() {
    let mut jail = Jail::new();
    let cases: [(&[u8], Fate); 9] = [
        (b"", Refused),
        (b"null", Refused),
        (b"{}", Refused),
        (b"[]", Refused),
        (b"\xff\xfe{\0}\0", Refused),
        (b"\xef\xbb\xbf{\"asset\":{\"version\":\"2.0\"}}", Either),
        (b"{\"asset\":{\"version\":\"3.0\",\"minVersion\":\"3.0\"}}", Refused),
        (b"{\"asset\":{\"version\":\"2.0\"},\"asset\":{\"version\":\"2.0\"}}", Either),
        (b"glTF\x02\0\0\0\xff\xff\xff\xff\xff\xff\xff\xffJSON", Refused),
    ];
    for (bytes, fate) in cases {
        jail.try_file("document.gltf", bytes, fate);
        jail.try_file("document.glb", bytes, fate);
    }
    jail.close();
}
