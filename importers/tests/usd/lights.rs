//! UsdLux: strengths, sizes and what is approximated.

use ajar_scene::{Light, LightKind};

use super::{Stage, can_run, warnings};

/// The only light of a stage, and its warnings.
fn light(prim: &str) -> (Light, Vec<String>) {
    let imported = Stage::new(prim).scene();
    let said = warnings(&imported);
    (imported.scene.lights.iter().next().unwrap().clone(), said)
}

fn close(found: f32, expected: f32) -> bool {
    (found / expected - 1.0).abs() < 1e-4
}

#[test]
fn exposure_normalize_and_world_area() {
    if !can_run() {
        return;
    }
    let rect = "def RectLight \"L\" { float inputs:width = 2\nfloat inputs:height = 3\nfloat inputs:intensity = 6\n\
                float inputs:exposure = 1\nbool inputs:normalize = true\nfloat3 xformOp:scale = (2, 2, 2)\n\
                uniform token[] xformOpOrder = [\"xformOp:scale\"] }";
    let LightKind::Rect { radiance, width, height, .. } = light(rect).0.kind else { panic!() };
    // 12 divided by the area that the scale makes 24.
    assert!(close(radiance, 0.5) && width == 2.0 && height == 3.0, "{radiance}");
    let sphere = "def SphereLight \"L\" { float inputs:radius = 2\nfloat inputs:intensity = 10\n\
                  bool treatAsPoint = true }";
    let LightKind::Point { intensity } = light(sphere).0.kind else { panic!() };
    assert!(close(intensity, 40.0 * std::f32::consts::PI));
    let sun = "def DistantLight \"L\" { float inputs:intensity = 5\nfloat inputs:angle = 2\n\
               bool inputs:normalize = true }";
    let LightKind::Directional { illuminance, angle } = light(sun).0.kind else { panic!() };
    assert!(illuminance == 5.0 && close(angle, 2_f32.to_radians()));
    let disk = "def DistantLight \"L\" { float inputs:intensity = 5\nfloat inputs:angle = 2 }";
    let LightKind::Directional { illuminance, .. } = light(disk).0.kind else { panic!() };
    assert!(close(illuminance, 5.0 * std::f32::consts::PI * 1_f32.to_radians().sin().powi(2)));
}

#[test]
fn colour_temperature() {
    if !can_run() {
        return;
    }
    let warm = "def DiskLight \"L\" { bool inputs:enableColorTemperature = true\n\
                float inputs:colorTemperature = 3200\ncolor3f inputs:color = (0.5, 1, 1) }";
    let color = light(warm).0.color;
    assert!(close(color.x, 0.5 * 1.680) || (color.x - 0.84).abs() < 0.001, "{color}");
    assert!((color.y - 0.866).abs() < 0.001 && (color.z - 0.326).abs() < 0.001, "{color}");
}

#[test]
fn a_cone_becomes_a_spot_and_links_are_named() {
    if !can_run() {
        return;
    }
    let cone = "def SphereLight \"L\" (prepend apiSchemas = [\"ShapingAPI\"]) { float inputs:radius = 1\n\
                float inputs:shaping:cone:angle = 40\nfloat inputs:shaping:cone:softness = 0.5\n\
                float inputs:diffuse = 0.3\nrel collection:lightLink:includes = </Other> }";
    let (light, said) = light(cone);
    let LightKind::Spot { intensity, inner, outer } = light.kind else { panic!("{light:?}") };
    assert!(close(outer, 40_f32.to_radians()) && close(inner, 20_f32.to_radians()));
    assert!(close(intensity, std::f32::consts::PI));
    let said = said.join("\n");
    for expected in ["/L: light linking is ignored", "spot without extent", "multiplier 'diffuse' is ignored"]
    {
        assert!(said.contains(expected), "{said}");
    }
}

#[test]
fn domes_and_meshes_that_shine() {
    if !can_run() {
        return;
    }
    let dome = "def DomeLight \"L\" { asset inputs:texture:file = @sky.hdr@\nfloat inputs:intensity = 3 }";
    let imported = Stage::new(dome).with("sky.hdr", "").scene();
    let light = imported.scene.lights.iter().next().unwrap();
    let LightKind::Environment { radiance, texture } = light.kind else { panic!() };
    assert!(radiance == 3.0 && texture.is_some());
    let mesh = "def Mesh \"L\" (prepend apiSchemas = [\"MeshLightAPI\"]) { int[] faceVertexCounts = [3]\n\
                int[] faceVertexIndices = [0, 1, 2]\npoint3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]\n\
                float inputs:intensity = 7 }";
    let imported = Stage::new(mesh).scene();
    let material = imported.scene.meshes.iter().next().unwrap().material.unwrap();
    assert_eq!(imported.scene.materials[material].emission.value, glam::Vec3::splat(7.0));
}

#[test]
fn lights_that_are_none_and_parts_without_a_place_are_named() {
    if !can_run() {
        return;
    }
    let prims = "def PortalLight \"Portal\" {}\ndef GeometryLight \"Geometry\" {}\ndef PluginLight \"Plugin\" {}\n\
                 def DiskLight \"Disk\" { asset inputs:texture:file = @a.png@ }\n\
                 def RectLight \"Cone\" (prepend apiSchemas = [\"ShapingAPI\"]) {\n\
                 asset inputs:texture:file = @a.png@\nfloat inputs:shaping:cone:angle = 30\n}\n\
                 def DistantLight \"Sun\" (prepend apiSchemas = [\"ShapingAPI\"]) {\n\
                 float inputs:shaping:cone:angle = 30\n}\n\
                 def SphereLight \"Ball\" (prepend apiSchemas = [\"ShadowAPI\"]) {\n\
                 color3f inputs:shadow:color = (0, 0, 1)\n}\n\
                 def CylinderLight \"Line\" { bool treatAsLine = true }\n\
                 def RectLight \"Plain\" (prepend apiSchemas = [\"ShapingAPI\", \"ShadowAPI\"]) {\n\
                 asset inputs:texture:file = @a.png@\n}\n";
    let imported = Stage::new(prims).with("a.png", "").scene();
    let said = warnings(&imported);
    for expected in [
        "/Portal: the PortalLight is dropped",
        "/Geometry: the GeometryLight is dropped",
        "/Plugin: the PluginLight is dropped",
        // Of the cone, too.
        "/Disk: the texture is ignored: only domes, and rectangles without a cone, have one (and at 1 more",
        "/Cone: a light with a shaping cone",
        "/Sun: the shaping cone is ignored",
        "/Ball: shadow:color is ignored",
        "/Line: treatAsLine is approximated",
    ] {
        assert!(said.iter().any(|line| line.starts_with(expected)), "{expected}: {said:#?}");
    }
    assert_eq!(said.len(), 8, "{said:#?}");
}
