//! USD, through a program in Python on Pixar's usd-core that speaks the protocol of plug-ins.
//!
//! Ajar carries the program (`ajar_import_usd`) with it; [`crate::python`] runs it.

mod program;

use std::fs::File;

use ajar_scene::{Diagnostic, Feature, ImportRequest, Imported, Importer};

use self::program::PROGRAM;
use crate::plugin;

/// The importer of `.usd`, `.usda`, `.usdc` and `.usdz` files.
pub struct Usd;

/// What [`Usd`] supports.
const FEATURES: &[Feature] = &[
    Feature {
        name: "composition",
        support: "by usd-core: layers, references, payloads, variants, inherits, instances",
    },
    Feature { name: "metersPerUnit, upAxis", support: "those of the root layer" },
    Feature { name: "time", support: "transforms, shapes, lights and cameras at one time" },
    Feature {
        name: "visibility, purpose",
        support: "yes; purposes default and render, or those of RenderSettings",
    },
    Feature {
        name: "Mesh",
        support: "primvars of all interpolations, normals, GeomSubsets, left-handed orientation",
    },
    Feature {
        name: "subdivision",
        support: "Catmull-Clark with creases, corners, holes and boundaries; Loop approximated",
    },
    Feature {
        name: "Cube, Sphere, Cylinder, Cone, Capsule, Plane",
        support: "as polygons, without texture coordinates",
    },
    Feature { name: "BasisCurves", support: "linear, Bézier, B-spline, Catmull-Rom, as round tubes" },
    Feature { name: "Points", support: "as balls" },
    Feature { name: "PointInstancer", support: "with hidden instances, nested" },
    Feature { name: "UsdSkel", support: "skinning and blend shapes at one time" },
    Feature {
        name: "UsdPreviewSurface",
        support: "both workflows, UsdUVTexture, UsdTransform2d, primvar readers",
    },
    Feature {
        name: "MaterialX",
        support: "standard_surface, open_pbr_surface, UsdPreviewSurface; images, transforms, arithmetic, channels",
    },
    Feature {
        name: "UsdLux",
        support: "Distant, Sphere, Rect, Disk, Cylinder, Dome, mesh lights; exposure, normalize, temperature; \
                  cones as spots",
    },
    Feature { name: "Camera", support: "perspective with lens and shift, orthographic, exposure" },
    Feature { name: "UsdRender", support: "camera and resolution of settings and the first product" },
    Feature { name: "light linking, IES, volumes, NURBS, displacement", support: "no, named in warnings" },
];

impl Importer for Usd {
    fn name(&self) -> &'static str {
        "usd"
    }

    fn extensions(&self) -> &'static [&'static str] {
        &["usd", "usda", "usdc", "usdz"]
    }

    fn sniff(&self, head: &[u8]) -> bool {
        head.starts_with(b"#usda") || head.starts_with(b"PXR-USDC")
    }

    fn features(&self) -> &'static [Feature] {
        FEATURES
    }

    fn import(&self, request: &ImportRequest) -> Result<Imported, Diagnostic> {
        // The file is looked at before an environment is made for it.
        let unreadable = |e| Diagnostic::error(format!("cannot be read: {e}")).in_file(&request.path);
        File::open(&request.path).map_err(unreadable)?;
        let (command, input) = PROGRAM.command()?;
        plugin::run(PROGRAM.name, command, input, request)
    }
}
