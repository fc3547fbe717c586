//! What the program opens, as the system sees it: nothing that a hostile file names outside its folder.

use std::{
    collections::BTreeSet,
    env, fs,
    os::unix::fs::symlink,
    path::{Path, PathBuf},
    process::{Command, Stdio},
};

use crate::{
    images::{ONE_PIXEL, png},
    jail::Jail,
};

/// A file of this system that absolute paths name.
const OF_THE_SYSTEM: &str = "/etc/services";

/// How a file names `FILE`, and how that file ends.
struct Way {
    opened: &'static str,
    text: String,
    ending: &'static str,
    content: Vec<u8>,
}

fn way(
    opened: &'static str,
    text: impl Into<String>,
    ending: &'static str,
    content: impl Into<Vec<u8>>,
) -> Way {
    Way { opened, text: text.into(), ending, content: content.into() }
}

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

fn ways() -> Vec<Way> {
    let gltf = |members: &str| {
        let mut asset = crate::gltf::Asset::new();
        asset.more = format!(",{members}");
        asset.text()
    };
    let textured = gltf(
        r#""images":[{"uri":"FILE"}],"textures":[{"source":0}],
        "materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}]"#,
    );
    let mut buffered = crate::gltf::Asset::new();
    buffered.buffers = r#"{"byteLength":36,"uri":"FILE"}"#.into();
    let picture = || png(1, 1, ONE_PIXEL);
    let mapped = format!("mtllib FILE\nusemtl a\n{TRIANGLE}");
    let shown = r#"{"ajar": 1, "images": [{"file": "FILE"}]}"#;
    vec![
        way("a.gltf", buffered.text(), "bin", [0; 36]),
        way("a.gltf", textured, "png", picture()),
        way("a.obj", mapped, "mtl", "newmtl a\n"),
        way("a.toml", "[[import]]\nfile = \"FILE\"\n", "obj", TRIANGLE),
        way("a.toml", "extends = \"FILE\"\n", "toml", ""),
        way("a.toml", "[[light]]\ntype = \"environment\"\ntexture = \"FILE\"\n", "png", picture()),
        way("a.ajar", shown, "png", picture()),
    ]
}

fn usd_ways() -> Vec<Way> {
    let stage = |prim: &str| format!("#usda 1.0\n{prim}\n");
    let paint = "<?xml version=\"1.0\"?><materialx version=\"1.38\"></materialx>";
    vec![
        way("a.usda", stage("(\n    subLayers = [@FILE@]\n)"), "usda", stage("def \"A\" {\n}")),
        way("a.usda", stage("def \"A\" (payload = @FILE@) {\n}"), "usda", stage("def \"A\" {\n}")),
        way("a.usda", stage("def \"A\" (references = @FILE@</MaterialX>) {\n}"), "mtlx", paint),
        way("a.usda", stage("def \"A\" (references = @FILE@) {\n}"), "usda", stage("def \"A\" {\n}")),
        way(
            "a.usda",
            stage("def DomeLight \"A\" {\nasset inputs:texture:file = @FILE@\n}"),
            "png",
            png(1, 1, ONE_PIXEL),
        ),
    ]
}

/// The files that `ajar validate` opens, links resolved; `None`, with a word why, where it cannot be watched.
fn opened(jail: &Jail, path: &Path) -> Option<BTreeSet<PathBuf>> {
    let log = jail.path("trace.log");
    let mut command = Command::new("strace");
    command.args(["-f", "-qq", "-y", "-s", "4096", "-e", "trace=open,openat,openat2,creat", "-o"]).arg(&log);
    command.args([env!("CARGO_BIN_EXE_ajar"), "validate"]).arg(path);
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    // An exit code of validate's own says that it ran.
    if !command.status().is_ok_and(|status| matches!(status.code(), Some(0 | 3))) {
        println!("skipped: there is no strace, or it may not trace");
        return None;
    }
    let log = String::from_utf8_lossy(&fs::read(log).unwrap()).into_owned();
    // `openat(…) = 3</where/it/is>`.
    let of =
        |line: &str| Some(PathBuf::from(line.rsplit_once(" = ")?.1.split_once('<')?.1.strip_suffix('>')?));
    Some(log.lines().filter_map(of).filter(|path| !path.starts_with("/proc")).collect())
}

/// Tries at most `most` names that lead out. What lies outside may be opened only if `known` says so of it.
fn stays_inside(ways: Vec<Way>, most: usize, known: impl Fn(&Path, &BTreeSet<PathBuf>) -> bool) {
    let jail = Jail::new();
    fs::create_dir(jail.path("scene")).unwrap();
    let inside = jail.path("scene").canonicalize().unwrap();
    symlink(jail.path("outside"), inside.join("folder")).unwrap();
    for (number, Way { opened: file, text, ending, content }) in ways.into_iter().enumerate() {
        let name = format!("{number}.{ending}");
        let secret = jail.put(&format!("outside/{name}"), &content).to_string_lossy().into_owned();
        jail.put(&format!("scene/{name}"), content);
        symlink(&secret, inside.join(format!("link{name}"))).unwrap();
        let opens =
            |target: &str| opened(&jail, &jail.put(&format!("scene/{file}"), text.replace("FILE", target)));
        let Some(harmless) = opens(&name) else { return };
        assert!(harmless.contains(&inside.join(&name)), "{text} does not open {name}: {harmless:?}");
        let targets = [
            format!("../outside/{name}"),
            format!("link{name}"),
            format!("file://{secret}"),
            OF_THE_SYSTEM.into(),
            format!("./x/../../outside/{name}"),
            format!("%2e%2e/outside/{name}"),
            format!("folder/{name}"),
            format!("file:../outside/{name}"),
            secret,
            format!("file://{OF_THE_SYSTEM}"),
        ];
        for target in targets.into_iter().take(most) {
            let Some(opened) = opens(&target) else { return };
            let stray: Vec<_> =
                opened.iter().filter(|path| !path.starts_with(&inside) && !known(path, &harmless)).collect();
            assert!(stray.is_empty(), "{file} that names {target} opens {stray:?}");
        }
    }
}

#[test]
fn nothing_outside_the_folder_is_opened() {
    stays_inside(ways(), usize::MAX, |path, harmless| harmless.contains(path));
}

/// Few names, for each takes a second. A Python opens more of its modules where there is something to complain about.
#[test]
fn nothing_outside_the_folder_is_opened_by_the_bridge_to_usd() {
    if env::var_os("AJAR_USD_PYTHON").is_none() {
        println!("skipped: AJAR_USD_PYTHON is not set");
        return;
    }
    let outside =
        |path: &Path| path.to_string_lossy().contains("/outside/") || path == Path::new(OF_THE_SYSTEM);
    stays_inside(usd_ways(), 4, |path, _| !outside(path));
}
