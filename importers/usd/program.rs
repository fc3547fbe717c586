//! The program that Ajar carries with it: a Python package on usd-core, file by file.

use crate::{
    package_files,
    python::{Environment, Program},
};

/// The package and what it runs on.
pub(super) const PROGRAM: Program = Program {
    name: "the USD importer",
    package: "ajar_import_usd",
    start: "main",
    codes: 0,
    files: package_files![
        "ajar_import_usd":
        "__init__.py",
        "blocks.py",
        "camera.py",
        "curves.py",
        "document.py",
        "instancer.py",
        "layers.py",
        "lights.py",
        "lobes.py",
        "main.py",
        "material.py",
        "mesh.py",
        "mtlx.py",
        "network.py",
        "nodes.py",
        "points.py",
        "primvars.py",
        "report.py",
        "settings.py",
        "shapes.py",
        "stage.py",
        "surface.py",
        "surfaces.py",
        "terms.py",
        "tubes.py",
        "uv.py",
        "walk.py",
    ],
    environment: Environment {
        purpose: "USD files",
        variable: "AJAR_USD_PYTHON",
        packages: &["usd-core==26.11", "materialx==1.39.5", "numpy==2.4.6"],
        versions: "3.11 to 3.14",
        name: "usd-26.11-materialx-1.39.5",
    },
};
