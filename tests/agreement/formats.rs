//! One model underneath: the same sphere of the same material through glTF, OBJ, UsdPreviewSurface, Standard Surface and
//! OpenPBR is the same picture.
//!
//! USD takes part where `AJAR_USD_PYTHON` names a Python that reads it.

use std::fs;

use ajar_integrators::path::PathTracer;
use serde_json::{Value, json};

use crate::{
    LIMIT,
    blocks::Blocks,
    open,
    sphere::{write_gltf, write_obj, write_picture, write_usd},
};

pub fn reads_usd() -> bool {
    std::env::var_os("AJAR_USD_PYTHON").is_some_and(|python| !python.is_empty())
}

/// A window before a dim sky, so that highlights have an edge.
const LIGHTS: &str = r#"
[[light]]
type = "rect"
position = [2, 3, 2]
target = [0, 0, 0]
width = 2
height = 2
radiance = 20
[[light]]
type = "environment"
radiance = 0.2
"#;

/// One material in the words of each format; nothing where a format cannot say it.
struct Look {
    gltf: Value,
    mtl: &'static str,
    preview: &'static str,
    standard: &'static str,
    open_pbr: &'static str,
}

/// The pictures of a look, with the formats' names; the first is that of glTF.
fn pictures(look: &Look) -> Vec<(&'static str, Blocks)> {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write_picture(folder);
    let render = |file: &str, seed| {
        let scene = folder.join("scene.toml");
        fs::write(&scene, format!("[[import]]\nfile = \"{file}\"\n{LIGHTS}")).unwrap();
        Blocks::new(&open(&scene), &PathTracer, seed, 32)
    };
    write_gltf(folder, &look.gltf);
    let mut found = vec![("glTF", render("a.gltf", 1))];
    if !look.mtl.is_empty() {
        write_obj(folder, look.mtl);
        found.push(("OBJ", render("a.obj", 2)));
    }
    if !reads_usd() {
        println!("skipped: USD, for AJAR_USD_PYTHON is not set");
        return found;
    }
    for (seed, name, output, shader, inputs) in [
        (3, "UsdPreviewSurface", "surface", "UsdPreviewSurface", look.preview),
        (4, "Standard Surface", "mtlx:surface", "ND_standard_surface_surfaceshader", look.standard),
        (5, "OpenPBR", "mtlx:surface", "ND_open_pbr_surface_surfaceshader", look.open_pbr),
    ] {
        if !inputs.is_empty() {
            write_usd(folder, output, shader, inputs);
            found.push((name, render("a.usda", seed)));
        }
    }
    found
}

fn same(look: &Look) {
    let mut all = pictures(look).into_iter();
    let (_, first) = all.next().unwrap();
    for (name, other) in all {
        let (worst, error) = first.compare(&other);
        println!("{name}: largest z {worst:.2}, typical error {:.2} %", error * 100.0);
        assert!(worst < LIMIT, "{name} is not as glTF: largest z {worst:.2}");
    }
}

fn plastic(roughness: f64) -> Value {
    let factors = json!({
        "baseColorFactor": [0.8, 0.2, 0.1, 1], "metallicFactor": 0, "roughnessFactor": roughness,
    });
    json!({"pbrMetallicRoughness": factors, "doubleSided": true})
}

const PLASTIC: Look = Look {
    gltf: Value::Null,
    mtl: "Kd .8 .2 .1\nKs .5 .5 .5\nPr .4\nPm 0\nillum 2",
    preview: "color3f inputs:diffuseColor = (0.8, 0.2, 0.1)\nfloat inputs:roughness = 0.4",
    standard: "color3f inputs:base_color = (0.8, 0.2, 0.1)\nfloat inputs:base = 1\n\
               float inputs:specular_roughness = 0.4",
    open_pbr: "color3f inputs:base_color = (0.8, 0.2, 0.1)\nfloat inputs:specular_roughness = 0.4",
};

#[test]
fn plastic_is_the_same_and_the_comparison_sees_other_plastic() {
    same(&Look { gltf: plastic(0.4), ..PLASTIC });
    let all = pictures(&Look { gltf: plastic(0.3), ..PLASTIC });
    assert!(all[0].1.compare(&all[1].1).0 > LIMIT);
}

#[test]
fn metal_is_the_same() {
    let factors = json!({"baseColorFactor": [0.9, 0.6, 0.3, 1], "roughnessFactor": 0.3});
    same(&Look {
        gltf: json!({"pbrMetallicRoughness": factors, "doubleSided": true}),
        mtl: "Kd .9 .6 .3\nKs .5 .5 .5\nPr .3\nPm 1\nillum 2",
        preview: "color3f inputs:diffuseColor = (0.9, 0.6, 0.3)\nfloat inputs:roughness = 0.3\n\
                  float inputs:metallic = 1",
        standard: "color3f inputs:base_color = (0.9, 0.6, 0.3)\nfloat inputs:base = 1\n\
                   float inputs:metalness = 1\nfloat inputs:specular_roughness = 0.3",
        open_pbr: "color3f inputs:base_color = (0.9, 0.6, 0.3)\nfloat inputs:base_metalness = 1\n\
                   float inputs:specular_roughness = 0.3",
    });
}

#[test]
fn rough_glass_is_the_same() {
    let factors = json!({"metallicFactor": 0, "roughnessFactor": 0.3});
    let glass = json!({
        "KHR_materials_transmission": {"transmissionFactor": 1},
        "KHR_materials_volume": {"thicknessFactor": 1},
    });
    same(&Look {
        gltf: json!({"pbrMetallicRoughness": factors, "doubleSided": true, "extensions": glass}),
        mtl: "Kd 1 1 1\nKs .5 .5 .5\nTf 1 1 1\nNi 1.5\nPr .3\nillum 7",
        preview: "",
        standard: "float inputs:transmission = 1\nfloat inputs:base = 1\n\
                   float inputs:specular_roughness = 0.3\nfloat inputs:specular_IOR = 1.5",
        open_pbr: "float inputs:transmission_weight = 1\nfloat inputs:specular_roughness = 0.3",
    });
}

#[test]
fn coated_plastic_is_the_same() {
    let mut gltf = plastic(0.4);
    gltf["extensions"] =
        json!({"KHR_materials_clearcoat": {"clearcoatFactor": 1, "clearcoatRoughnessFactor": 0.1}});
    same(&Look {
        gltf,
        mtl: "Kd .8 .2 .1\nKs .5 .5 .5\nPr .4\nPm 0\nPc 1\nPcr .1\nillum 2",
        preview: "color3f inputs:diffuseColor = (0.8, 0.2, 0.1)\nfloat inputs:roughness = 0.4\n\
                  float inputs:clearcoat = 1\nfloat inputs:clearcoatRoughness = 0.1",
        standard: "color3f inputs:base_color = (0.8, 0.2, 0.1)\nfloat inputs:base = 1\n\
                   float inputs:specular_roughness = 0.4\nfloat inputs:coat = 1\n\
                   float inputs:coat_roughness = 0.1\nfloat inputs:coat_IOR = 1.5",
        // Seen through this coat, it is 0.4 too: 0.3992⁴ + 2 · 0.1⁴ = 0.4⁴.
        open_pbr: "color3f inputs:base_color = (0.8, 0.2, 0.1)\nfloat inputs:specular_roughness = 0.3992\n\
                   float inputs:coat_weight = 1\nfloat inputs:coat_roughness = 0.1\n\
                   float inputs:coat_ior = 1.5\nfloat inputs:coat_darkening = 0",
    });
}

#[test]
fn emission_is_the_same() {
    let mut gltf = plastic(0.4);
    gltf["emissiveFactor"] = json!([1, 0.5, 0.25]);
    gltf["extensions"] = json!({"KHR_materials_emissive_strength": {"emissiveStrength": 2}});
    same(&Look {
        gltf,
        mtl: "Kd .8 .2 .1\nKs .5 .5 .5\nPr .4\nPm 0\nKe 2 1 .5\nillum 2",
        preview: "color3f inputs:diffuseColor = (0.8, 0.2, 0.1)\nfloat inputs:roughness = 0.4\n\
                  color3f inputs:emissiveColor = (2, 1, 0.5)",
        standard: "color3f inputs:base_color = (0.8, 0.2, 0.1)\nfloat inputs:base = 1\n\
                   float inputs:specular_roughness = 0.4\nfloat inputs:emission = 2\n\
                   color3f inputs:emission_color = (1, 0.5, 0.25)",
        open_pbr: "color3f inputs:base_color = (0.8, 0.2, 0.1)\nfloat inputs:specular_roughness = 0.4\n\
                   float inputs:emission_luminance = 2\ncolor3f inputs:emission_color = (1, 0.5, 0.25)",
    });
}

#[test]
fn textures_are_the_same() {
    let factors = json!({"baseColorTexture": {"index": 0}, "metallicFactor": 0, "roughnessFactor": 0.4});
    same(&Look {
        gltf: json!({"pbrMetallicRoughness": factors, "doubleSided": true}),
        mtl: "Kd 1 1 1\nmap_Kd map.png\nKs .5 .5 .5\nPr .4\nPm 0\nillum 2",
        preview: "color3f inputs:diffuseColor.connect = </Look/Map.outputs:rgb>\nfloat inputs:roughness = 0.4",
        standard: "color3f inputs:base_color.connect = </Look/Picture.outputs:out>\nfloat inputs:base = 1\n\
                   float inputs:specular_roughness = 0.4",
        open_pbr: "color3f inputs:base_color.connect = </Look/Picture.outputs:out>\n\
                   float inputs:specular_roughness = 0.4",
    });
}

#[test]
fn a_thin_pane_is_the_same() {
    let factors = json!({"metallicFactor": 0, "roughnessFactor": 0.3});
    let pane = json!({"KHR_materials_transmission": {"transmissionFactor": 1}});
    same(&Look {
        gltf: json!({"pbrMetallicRoughness": factors, "doubleSided": true, "extensions": pane}),
        mtl: "",
        preview: "float inputs:opacity = 0\nfloat inputs:roughness = 0.3",
        standard: "float inputs:transmission = 1\nbool inputs:thin_walled = true\n\
                   float inputs:specular_roughness = 0.3",
        open_pbr: "float inputs:transmission_weight = 1\nbool inputs:geometry_thin_walled = true\n\
                   float inputs:specular_roughness = 0.3",
    });
}

#[test]
fn dispersing_coloured_glass_is_the_same() {
    let factors = json!({"metallicFactor": 0, "roughnessFactor": 0.3});
    let glass = json!({
        "KHR_materials_transmission": {"transmissionFactor": 1},
        "KHR_materials_volume":
            {"thicknessFactor": 1, "attenuationDistance": 2, "attenuationColor": [0.3, 0.6, 0.9]},
        "KHR_materials_ior": {"ior": 1.7},
        "KHR_materials_dispersion": {"dispersion": 1},
    });
    same(&Look {
        gltf: json!({"pbrMetallicRoughness": factors, "doubleSided": true, "extensions": glass}),
        mtl: "",
        preview: "",
        standard: "float inputs:transmission = 1\nfloat inputs:specular_roughness = 0.3\n\
                   float inputs:specular_IOR = 1.7\nfloat inputs:transmission_depth = 2\n\
                   color3f inputs:transmission_color = (0.3, 0.6, 0.9)\n\
                   float inputs:transmission_dispersion = 20",
        open_pbr: "float inputs:transmission_weight = 1\nfloat inputs:specular_roughness = 0.3\n\
                   float inputs:specular_ior = 1.7\nfloat inputs:transmission_depth = 2\n\
                   color3f inputs:transmission_color = (0.3, 0.6, 0.9)\n\
                   float inputs:transmission_dispersion_scale = 1",
    });
}

#[test]
fn cloth_is_the_same() {
    let mut gltf = plastic(0.4);
    let sheen = json!({"sheenColorFactor": [0.5, 0.5, 0.5], "sheenRoughnessFactor": 0.3});
    gltf["extensions"] = json!({"KHR_materials_sheen": sheen});
    same(&Look {
        gltf,
        mtl: "Kd .8 .2 .1\nKs .5 .5 .5\nPr .4\nPm 0\nPs .5\nillum 2",
        preview: "",
        standard: "color3f inputs:base_color = (0.8, 0.2, 0.1)\nfloat inputs:specular_roughness = 0.4\n\
                   float inputs:sheen = 0.5\nfloat inputs:sheen_roughness = 0.09",
        // Its fuzz is another model.
        open_pbr: "",
    });
}

#[test]
fn a_thin_film_is_the_same() {
    let mut gltf = plastic(0.2);
    let film = json!({"iridescenceFactor": 1, "iridescenceIor": 1.8, "iridescenceThicknessMaximum": 300});
    gltf["extensions"] = json!({"KHR_materials_iridescence": film});
    same(&Look {
        gltf,
        mtl: "",
        preview: "",
        standard: "color3f inputs:base_color = (0.8, 0.2, 0.1)\nfloat inputs:specular_roughness = 0.2\n\
                   float inputs:thin_film_thickness = 300\nfloat inputs:thin_film_IOR = 1.8",
        open_pbr: "color3f inputs:base_color = (0.8, 0.2, 0.1)\nfloat inputs:specular_roughness = 0.2\n\
                   float inputs:thin_film_weight = 1\nfloat inputs:thin_film_thickness = 0.3\n\
                   float inputs:thin_film_ior = 1.8",
    });
}

/// Each format's own words for a highlight of widths 0.5 along the tangent and 0.125 across.
#[test]
fn brushed_metal_is_the_same() {
    let factors = json!({"baseColorFactor": [0.9, 0.6, 0.3, 1], "roughnessFactor": 0.125_f64.sqrt()});
    let brushed = json!({"KHR_materials_anisotropy": {"anisotropyStrength": (0.375_f64 / 0.875).sqrt()}});
    same(&Look {
        gltf: json!({"pbrMetallicRoughness": factors, "doubleSided": true, "extensions": brushed}),
        mtl: "Kd .9 .6 .3\nKs .5 .5 .5\nPr .353553\nPm 1\naniso .654654\nillum 2",
        preview: "",
        standard: "color3f inputs:base_color = (0.9, 0.6, 0.3)\nfloat inputs:metalness = 1\n\
                   float inputs:specular_roughness = 0.5\nfloat inputs:specular_anisotropy = 0.75",
        open_pbr: "color3f inputs:base_color = (0.9, 0.6, 0.3)\nfloat inputs:base_metalness = 1\n\
                   float inputs:specular_roughness = 0.603683\n\
                   float inputs:specular_roughness_anisotropy = 0.75",
    });
}
