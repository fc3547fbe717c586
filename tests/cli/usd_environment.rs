//! The Python that USD files are read with: made in the cache folder on first use. The tools that make it are stand-ins.

use std::{fs, os::unix::fs::PermissionsExt, process::Stdio};

use super::bench::{Bench, Run};

/// Makes folders like `python3 -m venv`. What it puts there answers like the importer, and notes what it is asked.
const VENV: &str = r#"#!/bin/sh
[ "$1" = --version ] && exit
eval folder=\${$#}
mkdir -p "$folder/bin"
cat > "$folder/bin/python" << 'END'
#!/bin/sh
if [ "$2" = pip ]; then echo "pip $*" >> asked; test -e offline && { echo no network >&2; exit 1; }; exit 0; fi
cat > /dev/null
echo '{"ajar": 1, "roots": [0], "nodes": [{"name": "stand-in"}]}'
END
chmod +x "$folder/bin/python"
"#;
const UV: &str =
    "#!/bin/sh\necho \"uv $*\" >> asked\nif [ \"$1\" = venv ]; then exec ./bin/python3 \"$@\"; fi\n";
const FOLDER: &str = "cache/ajar/usd-26.11-materialx-1.39.5";

fn bench(tools: &[(&str, &str)]) -> Bench {
    let bench = Bench::new();
    bench.write("a.usda", "#usda 1.0\n");
    for (name, text) in tools {
        bench.write(&format!("bin/{name}"), text);
        fs::set_permissions(bench.path(&format!("bin/{name}")), fs::Permissions::from_mode(0o755)).unwrap();
    }
    bench
}

fn variables(bench: &Bench) -> [(&'static str, String); 3] {
    let path = format!("{}:/usr/bin:/bin", bench.path("bin").display());
    let cache = bench.path("cache").display().to_string();
    [("PATH", path), ("XDG_CACHE_HOME", cache), ("AJAR_USD_PYTHON", String::new())]
}

fn inspect(bench: &Bench) -> Run {
    let variables = variables(bench);
    bench.run_with("inspect a.usda", &variables.each_ref().map(|(name, value)| (*name, value.as_str())))
}

#[test]
fn it_is_made_once_and_says_where() {
    let bench = bench(&[("python3", VENV), ("uv", "#!/bin/sh\nexit 1\n")]);
    let said = inspect(&bench).exits(0).prints(&["stand-in"]);
    said.says(&["ajar: installing Python packages for USD files into", FOLDER]);
    assert!(fs::read_to_string(bench.path("asked")).unwrap().contains("usd-core==26.11 materialx"));
    let again = inspect(&bench).exits(0).prints(&["stand-in"]);
    assert!(!again.err.contains("installing"), "{}", again.err);
}

#[test]
fn uv_makes_it_where_it_is_there() {
    let bench = bench(&[("python3", VENV), ("uv", UV)]);
    inspect(&bench).exits(0).prints(&["stand-in"]);
    let asked = fs::read_to_string(bench.path("asked")).unwrap();
    assert!(asked.contains("uv venv") && asked.contains("uv pip install"), "{asked}");
}

#[test]
fn without_a_network_it_names_the_command() {
    let bench = bench(&[("python3", VENV), ("uv", "#!/bin/sh\nexit 1\n")]);
    bench.write("offline", "");
    let python = format!("{FOLDER}/bin/python -m pip install");
    inspect(&bench).exits(1).says(&[
        "no network",
        "run: python3 -m venv",
        &python,
        "AJAR_USD_PYTHON may name",
    ]);
    assert!(!bench.has(FOLDER), "what is there is complete");
}

#[test]
fn what_is_broken_is_made_again() {
    let bench = bench(&[("python3", VENV), ("uv", "#!/bin/sh\nexit 1\n")]);
    bench.write(&format!("{FOLDER}/lib/half"), "");
    inspect(&bench).exits(0).prints(&["stand-in"]);
    assert!(!bench.has(&format!("{FOLDER}/lib/half")));
}

#[test]
fn two_that_make_it_at_once_do_not_disturb_each_other() {
    let bench = bench(&[("python3", VENV), ("uv", "#!/bin/sh\nexit 1\n")]);
    let started: Vec<_> = (0..4)
        .map(|_| {
            let mut command = bench.command("inspect a.usda");
            command.envs(variables(&bench)).stdout(Stdio::piped()).spawn().unwrap()
        })
        .collect();
    for child in started {
        let end = child.wait_with_output().unwrap();
        assert!(end.status.success(), "{}", String::from_utf8_lossy(&end.stderr));
    }
    assert_eq!(fs::read_dir(bench.path("cache/ajar")).unwrap().count(), 1, "nothing is left over");
}

#[test]
fn a_python_that_is_not_there_is_named() {
    let bench = bench(&[]);
    let run = bench.run_with("inspect a.usda", &[("AJAR_USD_PYTHON", "/nowhere/python")]);
    run.exits(1).says(&["AJAR_USD_PYTHON names /nowhere/python, which is not there"]);
}
