//! `ajar diff` where its Python cannot be had: never a verdict. What it finds is tested in tools/tests.

use super::bench::{Bench, Run};

/// Runs it where nothing but `variables` says which Python to take.
fn run(bench: &Bench, variables: &[(&str, &str)]) -> Run {
    let arguments = "diff new.exr reference.exr";
    let mut command = bench.command(arguments);
    for name in ["HOME", "USERPROFILE", "XDG_CACHE_HOME", "AJAR_DIFF_PYTHON"] {
        command.env_remove(name);
    }
    Run::new(arguments, command.envs(variables.iter().copied()).output().unwrap())
}

#[test]
fn a_python_that_is_not_there_is_named() {
    let bench = Bench::new();
    run(&bench, &[("AJAR_DIFF_PYTHON", "/nowhere/python")])
        .exits(2)
        .says(&["AJAR_DIFF_PYTHON names /nowhere/python, which is not there"]);
}

#[test]
fn without_a_home_the_variable_is_named() {
    run(&Bench::new(), &[]).exits(2).says(&["HOME is not set", "AJAR_DIFF_PYTHON", "OpenImageIO"]);
}

#[test]
fn an_environment_that_cannot_be_made_leaves_nothing_and_says_how_to_make_it() {
    let bench = Bench::new();
    let cache = bench.path("cache");
    let variables = [("XDG_CACHE_HOME", cache.to_str().unwrap()), ("PATH", "/nowhere")];
    run(&bench, &variables).exits(2).says(&["cannot be made", "python3 -m venv", "AJAR_DIFF_PYTHON"]);
    assert!(!cache.join("ajar").exists());
}

#[cfg(unix)]
#[test]
fn a_program_that_is_no_python_gives_no_verdict() {
    for program in ["/bin/true", "/bin/false"] {
        run(&Bench::new(), &[("AJAR_DIFF_PYTHON", program)]).exits(2).says(&["without a verdict"]);
    }
}
