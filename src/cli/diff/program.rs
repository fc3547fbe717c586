//! The comparison that Ajar carries with it: a Python package on OpenImageIO, file by file.

use ajar_importers::{
    package_files,
    python::{Environment, Program},
};

/// What an exit code begins at that is a verdict.
pub(super) const SPOKEN: u8 = 64;

/// The package, without what only pytest needs, and what it runs on.
pub(super) const PROGRAM: Program = Program {
    name: "ajar diff",
    package: "ajar_tools",
    start: "cli",
    codes: SPOKEN,
    files: package_files![
        "../../../tools/ajar_tools":
        "__init__.py",
        "cli.py",
        "comparison.py",
        "flip.py",
        "gates/__init__.py",
        "gates/exact.py",
        "gates/finite.py",
        "gates/flip.py",
        "gates/layers.py",
        "gates/noise.py",
        "gates/numbers.py",
        "gates/statistical.py",
        "gates/structure.py",
        "gates/variance.py",
        "junit.py",
        "picture.py",
        "report/__init__.py",
        "report/encode.py",
        "report/page.css",
        "report/page.html",
        "report/page.js",
        "report/planes.js",
        "report/strip.py",
        "settings.py",
        "statistics.py",
        "student.py",
        "verdict.py",
    ],
    environment: Environment {
        purpose: "image comparisons",
        variable: "AJAR_DIFF_PYTHON",
        packages: &[
            "OpenImageIO==3.2.2.0",
            "numpy==2.4.6; python_version >= '3.11'",
            "numpy==2.2.6; python_version < '3.11'",
            "tomli==2.5.0; python_version < '3.11'",
        ],
        versions: "3.10 to 3.14",
        name: "diff-openimageio-3.2.2",
    },
};

#[cfg(test)]
mod tests {
    use super::PROGRAM;

    #[test]
    fn it_runs_on_what_the_package_asks_for() {
        let project = include_str!("../../../tools/pyproject.toml");
        for package in PROGRAM.environment.packages {
            assert!(project.contains(&format!("\"{package}\"")), "{package}");
        }
    }
}
