//! What usd-core composes: references, variants, instances, time; and where it is put.

use ajar_scene::{Moment, Scene};
use glam::{DAffine3, Vec3};

use super::{Stage, can_run, warnings};

/// A square of one unit that faces +Z.
const SQUARE: &str = r#"#usda 1.0
(
    defaultPrim = "Square"
    metersPerUnit = 1
)
def Mesh "Square" (
    variants = { string size = "small" }
    prepend variantSets = "size"
)
{
    int[] faceVertexCounts = [4]
    int[] faceVertexIndices = [0, 1, 2, 3]
    uniform token subdivisionScheme = "none"
    variantSet "size" = {
        "small" {
 point3f[] points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
 }
        "large" {
 point3f[] points = [(0, 0, 0), (5, 0, 0), (5, 5, 0), (0, 5, 0)]
 }
    }
}
"#;

/// The corners of all placed meshes in the world, smallest and largest.
pub(super) fn bounds(scene: &Scene) -> (Vec3, Vec3) {
    let mut open: Vec<_> = scene.roots.iter().map(|&root| (root, DAffine3::IDENTITY)).collect();
    let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    while let Some((id, parent)) = open.pop() {
        let node = &scene.nodes[id];
        let world = parent * node.transform;
        for mesh in &node.meshes {
            for &position in &scene.meshes[*mesh].positions {
                let point = world.transform_point3(position.as_dvec3()).as_vec3();
                (low, high) = (low.min(point), high.max(point));
            }
        }
        open.extend(node.children.iter().map(|&child| (child, world)));
    }
    (low, high)
}

/// Whether two points are the same but for rounding.
pub(super) fn near(a: Vec3, b: Vec3) -> bool {
    (a - b).length() < 1e-4
}

#[test]
fn references_variants_and_instances() {
    if !can_run() {
        return;
    }
    let prims = r#"
def Xform "World"
{
    def "A" (references = @parts/square.usda@
    instanceable = true) { double3 xformOp:translate = (10, 0, 0)
        uniform token[] xformOpOrder = ["xformOp:translate"] }
    def "B" (references = @parts/square.usda@) {}
    def "Hidden" (references = @parts/square.usda@) { token visibility = "invisible"
        double3 xformOp:translate = (99, 0, 0)
        uniform token[] xformOpOrder = ["xformOp:translate"] }
    def "Proxy" (references = @parts/square.usda@) { uniform token purpose = "proxy" }
}
"#;
    let stage = Stage::new(prims).with("parts/square.usda", SQUARE);
    let imported = stage.scene();
    assert_eq!(warnings(&imported), Vec::<String>::new());
    let (low, high) = bounds(&imported.scene);
    assert!(near(low, Vec3::ZERO) && near(high, Vec3::new(11.0, 1.0, 0.0)), "{low} {high}");
    assert!(imported.files.iter().any(|file| file.ends_with("parts/square.usda")));

    let chosen = stage.variant("/World/B:size=large").scene();
    assert!(near(bounds(&chosen.scene).1, Vec3::new(11.0, 5.0, 0.0)));
    for unknown in ["/World/B:size=huge", "/World/None:size=large", "large"] {
        let error =
            Stage::new(prims).with("parts/square.usda", SQUARE).variant(unknown).import().unwrap_err();
        assert_eq!(error.cause, ajar_scene::Cause::Usage, "{unknown}: {error}");
        assert!(error.hint.is_some_and(|hint| hint.contains("/World/B:size={large, small}")), "{unknown}");
    }
}

#[test]
fn units_and_axes_are_those_of_the_root_layer() {
    if !can_run() {
        return;
    }
    let text = "#usda 1.0\n(\n    metersPerUnit = 0.5\n    upAxis = \"Z\"\n)\n\
                def \"A\" (references = @square.usda@) { double3 xformOp:translate = (0, 0, 4)\n\
                uniform token[] xformOpOrder = [\"xformOp:translate\"] }";
    let imported = Stage::whole(text).with("square.usda", SQUARE).scene();
    let (low, high) = bounds(&imported.scene);
    // 4 units along the stage's Z are 2 m up; what was along its Y goes to −Z.
    assert!(near(low, Vec3::new(0.0, 2.0, -0.5)) && near(high, Vec3::new(0.5, 2.0, 0.0)), "{low} {high}");
    assert!(warnings(&imported)[0].contains("square.usda: made in units of 1 m"));
}

#[test]
fn prototypes_are_shared_and_hidden_instances_left_out() {
    if !can_run() {
        return;
    }
    let prims = r#"
def PointInstancer "Many"
{
    rel prototypes = [</Many/P>]
    int[] protoIndices = [0, 0, 0]
    point3f[] positions = [(0, 0, 0), (3, 0, 0), (50, 0, 0)]
    float3[] scales = [(1, 1, 1), (2, 2, 2), (1, 1, 1)]
    int64[] invisibleIds = [2]
    def "P" (references = @square.usda@) { double3 xformOp:translate = (0, 1, 0)
        uniform token[] xformOpOrder = ["xformOp:translate"] }
}
"#;
    let imported = Stage::new(prims).with("square.usda", SQUARE).scene();
    assert_eq!(imported.scene.meshes.len(), 1);
    let placed = imported.scene.nodes.iter().filter(|node| !node.meshes.is_empty()).count();
    assert_eq!(placed, 2);
    // The second is moved by 3 and doubled, with its prototype's own translation.
    let (low, high) = bounds(&imported.scene);
    assert!(near(low, Vec3::new(0.0, 1.0, 0.0)) && near(high, Vec3::new(5.0, 4.0, 0.0)), "{low} {high}");
}

#[test]
fn time_is_a_frame_or_seconds() {
    if !can_run() {
        return;
    }
    let text = "#usda 1.0\n(\n    metersPerUnit = 1\n    timeCodesPerSecond = 48\n    framesPerSecond = 24\n    \
                startTimeCode = 48\n    endTimeCode = 96\n)\n\
                def \"A\" (references = @square.usda@) {\n\
                double3 xformOp:translate.timeSamples = { 0: (0, 0, 0), 96: (96, 0, 0) }\n\
                uniform token[] xformOpOrder = [\"xformOp:translate\"] }";
    let at = |moment: Option<Moment>| {
        let stage = Stage::whole(text).with("square.usda", SQUARE);
        let stage = if let Some(moment) = moment { stage.at(moment) } else { stage };
        bounds(&stage.scene().scene).0.x
    };
    assert_eq!(at(None), 48.0);
    assert_eq!(at(Some(Moment::Frame(12.0))), 24.0);
    assert_eq!(at(Some(Moment::Seconds(0.25))), 12.0);
}

#[test]
fn settings_name_camera_and_size() {
    if !can_run() {
        return;
    }
    let prims = r#"
def Camera "Other" {}
def Camera "Main"
{
    float focalLength = 50
    float horizontalAperture = 36
    float verticalAperture = 24
    float fStop = 2
    float focusDistance = 3
    float horizontalApertureOffset = 1.2
}
def RenderSettings "Settings" { uniform int2 resolution = (640, 480)
    rel products = </Product> }
def RenderProduct "Product" { rel camera = </Main> }
"#;
    let imported = Stage::new(prims).scene();
    assert_eq!(imported.render.camera.as_deref(), Some("Main"));
    assert_eq!(imported.render.size, Some([640, 480]));
    let camera = imported.scene.cameras.iter().find(|camera| camera.name == "Main").unwrap();
    let ajar_scene::Projection::Perspective { yfov, lens_radius, focus_distance, shift } = camera.projection
    else {
        panic!("{camera:?}")
    };
    // Lengths of the lens are tenths of a unit: 5 units with stop 2.
    assert!((yfov - 2.0 * (2.4_f32 / 10.0).atan()).abs() < 1e-5);
    assert!((lens_radius - 1.25).abs() < 1e-5 && focus_distance == 3.0);
    assert!((shift[0] - 0.1).abs() < 1e-5 && camera.aspect == Some(1.5));
}

#[test]
fn settings_say_which_purposes_are_drawn() {
    if !can_run() {
        return;
    }
    let squares = r#"
def "Plain" (references = @parts/square.usda@) {}
def "Fine" (references = @parts/square.usda@) { uniform token purpose = "render" }
def "Coarse" (references = @parts/square.usda@) { uniform token purpose = "proxy" }
"#;
    let drawn = |settings: &str| {
        let imported = Stage::new(&format!("{squares}{settings}")).with("parts/square.usda", SQUARE).scene();
        assert_eq!(warnings(&imported), Vec::<String>::new());
        let nodes = imported.scene.nodes.iter();
        let names =
            nodes.map(|node| node.name.clone()).filter(|name| "PlainFineCoarse".contains(name.as_str()));
        names.collect::<Vec<_>>()
    };
    assert_eq!(drawn(""), ["Plain", "Fine"]);
    assert_eq!(
        drawn("def RenderSettings \"S\" { uniform token[] includedPurposes = [\"default\"] }"),
        ["Plain"]
    );
    let both = "def RenderSettings \"S\" { uniform token[] includedPurposes = [\"default\", \"proxy\"] }";
    assert_eq!(drawn(both), ["Plain", "Coarse"]);
    let number = Stage::new(
        "def RenderSettings \"S\" { int includedPurposes = 3\nint resolution = 5 }\ndef Cube \"C\" {}",
    )
    .scene();
    let said = [
        "/S: includedPurposes is ignored: it is no list of tokens",
        "/S: resolution is ignored: 5 is no pair of integers",
    ];
    assert_eq!(warnings(&number), said);
}

#[test]
fn values_of_another_type_have_a_place() {
    if !can_run() {
        return;
    }
    for (prim, value) in [
        ("SphereLight", "string inputs:intensity = \"x\""),
        ("Camera", "string focalLength = \"z\""),
        ("Cube", "token size = \"big\""),
        ("Mesh", "string points = \"a\"\nint[] faceVertexCounts = [3]"),
    ] {
        let error = Stage::new(&format!("def {prim} \"Odd\" {{ {value} }}")).import().unwrap_err();
        assert_eq!(error.element.as_deref(), Some("/Odd"), "{prim}: {error}");
        assert!(error.message.starts_with("holds a value that cannot be used: "), "{prim}: {error}");
    }
}

#[test]
fn settings_that_are_ignored_are_named() {
    if !can_run() {
        return;
    }
    let prims = r#"
def Camera "Main" { float fStop = 2
    float focusDistance = 3
    double shutter:close = 0.5 }
def RenderSettings "Settings" { rel products = </Product>
    rel camera = </Main>
    uniform bool disableDepthOfField = true
    uniform token aspectRatioConformPolicy = "cropAperture"
    float pixelAspectRatio = 2
    uniform token[] materialBindingPurposes = ["full", "allPurpose"] }
def RenderProduct "Product" { token productName = "a.exr"
    uniform token productType = "deepRaster"
    rel orderedVars = </Beauty> }
def RenderVar "Beauty" {}
"#;
    let imported = Stage::new(prims).scene();
    let said = warnings(&imported);
    for expected in [
        "/Main: the shutter is ignored",
        "/Settings: aspectRatioConformPolicy is ignored: it is cropAperture",
        "/Settings: pixelAspectRatio is ignored: it is 2",
        "/Product: productType is ignored: it is deepRaster",
        "/Product: productName is ignored",
        "/Product: orderedVars is ignored",
    ] {
        assert!(said.iter().any(|line| line.starts_with(expected)), "{expected}: {said:#?}");
    }
    assert_eq!(said.len(), 6, "materialBindingPurposes is what is done: {said:#?}");
    let camera = imported.scene.cameras.iter().next().unwrap();
    let ajar_scene::Projection::Perspective { lens_radius, .. } = camera.projection else { panic!() };
    assert_eq!(lens_radius, 0.0, "without depth of field");
}
