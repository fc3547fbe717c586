//! The texts of the Python package, a module a row.

/// Module and text.
type Module = (&'static str, &'static str);

macro_rules! modules {
    ($($name:literal),* $(,)?) => {
        [$(($name, include_str!(concat!("ajar_import_usd/", $name, ".py")))),*]
    };
}

/// Runs the package that it finds on standard input.
pub(super) const LOADER: &str = include_str!("loader.py");

/// All of the package but `__main__`.
pub(super) const MODULES: [Module; 25] = modules![
    "__init__",
    "camera",
    "curves",
    "document",
    "instancer",
    "layers",
    "lights",
    "main",
    "material",
    "mesh",
    "mtlx",
    "network",
    "nodes",
    "points",
    "primvars",
    "report",
    "settings",
    "shapes",
    "stage",
    "surface",
    "surfaces",
    "terms",
    "tubes",
    "uv",
    "walk",
];
