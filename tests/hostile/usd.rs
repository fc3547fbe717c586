//! Stages that want out of their folder, or more than there is. `importers/tests/usd` has more of them, without limits.

use std::{env, fs, process::Command};

use crate::jail::{
    Fate::{self, Clean, Refused, TooLarge, Warned},
    Jail,
};

/// Writes a package: its path, method of compression, name and size of its only file.
const PACK: &str = "import sys, zipfile\n\
    path, method, name, size = sys.argv[1:]\n\
    with zipfile.ZipFile(path, 'w', int(method)) as package:\n    \
    package.writestr(name, '#usda 1.0\\n'.ljust(int(size)))";

const EMPTY: &str = "#usda 1.0\n";

/// A jail, where USD can be read.
fn jail() -> Option<Jail> {
    let can = env::var_os("AJAR_USD_PYTHON").is_some_and(|python| !python.is_empty());
    if !can {
        println!("skipped: AJAR_USD_PYTHON is not set");
    }
    can.then(Jail::new)
}

/// What becomes of a stage in a folder of its own.
fn stage(jail: &mut Jail, text: &str, fate: Fate) {
    let path = jail.put("inner/a.usda", format!("{EMPTY}{text}"));
    jail.try_usd(&path, &jail.path("inner"), fate);
}

#[test]
fn ways_out_of_the_folder() {
    let Some(mut jail) = jail() else { return };
    let sphere = "#usda 1.0\ndef Sphere \"S\" {\n}\n";
    let secret = jail.put("secret.usda", sphere).to_string_lossy().into_owned();
    let paint = jail.put("secret.mtlx", "<materialx version=\"1.38\"/>").to_string_lossy().into_owned();
    let picture = jail.put("secret.png", "").to_string_lossy().into_owned();
    jail.put("inner/b.usda", sphere);
    stage(&mut jail, "def \"A\" (payload = @b.usda@</S>) {\n}\n", Clean);
    #[cfg(unix)]
    std::os::unix::fs::symlink(&secret, jail.path("inner/link.usda")).unwrap();
    for way in [
        "(\n    subLayers = [@../secret.usda@]\n)\n".into(),
        format!("(\n    subLayers = [@{secret}@]\n)\n"),
        "def \"A\" (payload = @../secret.usda@</S>) {\n}\n".into(),
        format!("def \"A\" (payload = @{secret}@</S>) {{\n}}\n"),
        format!("def \"A\" (references = @file://{secret}@</S>) {{\n}}\n"),
        format!("def \"A\" (references = @{paint}@</MaterialX>) {{\n}}\n"),
        "def \"A\" (references = @../secret.mtlx@</MaterialX>) {\n}\n".into(),
        format!("def DomeLight \"A\" {{\nasset inputs:texture:file = @{picture}@\n}}\n"),
        format!("def DomeLight \"A\" {{\nasset inputs:texture:file = @file:{picture}@\n}}\n"),
    ] {
        stage(&mut jail, &way, Refused);
    }
    #[cfg(unix)]
    stage(&mut jail, "def \"A\" (references = @link.usda@</S>) {\n}\n", Refused);
    stage(&mut jail, "def \"A\" (references = @nowhere.usda@</S>) {\n}\n", Warned);
    jail.close();
}

#[test]
fn more_than_there_is() {
    let Some(mut jail) = jail() else { return };
    let nested = |depth: usize| "def \"A\" {\n".repeat(depth) + &"}\n".repeat(depth);
    stage(&mut jail, &nested(1000), Refused);
    stage(&mut jail, &nested(30_000), Refused);
    // The parser of usd-core has no stack for it.
    stage(&mut jail, &nested(100_000), Refused);
    // Ten references to ten references to ten …: a billion prims.
    let level = |n: usize| {
        let below: String =
            (0..10).map(|i| format!("def \"C{i}\" (references = </L{n}>) {{\n}}\n")).collect();
        format!("def \"L{}\" {{\n{below}}}\n", n + 1)
    };
    stage(&mut jail, &("def \"L0\" {\n}\n".to_owned() + &(0..9).map(level).collect::<String>()), Refused);
    let prims: String = (0..100_000).map(|i| format!("def \"P{i}\" {{\n}}\n")).collect();
    stage(&mut jail, &prims, TooLarge);
    let numbers = "0,".repeat(5_000_000);
    stage(&mut jail, &format!("def \"A\" {{\nint[] a = [{numbers}]\n}}\n"), TooLarge);
    jail.close();
}

#[test]
fn packages_that_are_bombs() {
    let Some(mut jail) = jail() else { return };
    let mut pack = |method: &str, name: &str, size: usize, claimed: Option<u32>, fate| {
        let path = jail.put("inner/a.usdz", "");
        let mut command = Command::new(env::var_os("AJAR_USD_PYTHON").unwrap());
        let args = [path.to_str().unwrap(), method, name, &size.to_string()];
        assert!(command.args(["-c", PACK]).args(args).status().unwrap().success());
        if let Some(claimed) = claimed {
            let (real, lie) = ((size as u32).to_le_bytes().repeat(2), claimed.to_le_bytes().repeat(2));
            let mut bytes = fs::read(&path).unwrap();
            for at in 0..bytes.len() - 8 {
                if bytes[at..at + 8] == real {
                    bytes[at..at + 8].copy_from_slice(&lie);
                }
            }
            fs::write(&path, bytes).unwrap();
        }
        jail.try_usd(&path, &jail.path("inner"), fate);
    };
    pack("0", "a.usda", 1000, None, Clean);
    pack("0", "../a.usda", 1000, None, Refused);
    pack("0", "a.usda", 1000, Some(u32::MAX - 1), Refused);
    pack("8", "a.usda", 256 << 20, None, Refused);
    pack("0", "a.usda", 100 << 20, None, TooLarge);
    jail.close();
}
