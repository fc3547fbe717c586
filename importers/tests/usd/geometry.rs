//! Shapes: meshes with their attributes, subdivision, implicit shapes, curves, points.

use glam::Vec3;

use super::{
    Stage, can_run,
    composition::{bounds, near},
    warnings,
};

/// Area of all meshes, not placed.
fn area(imported: &ajar_scene::Imported) -> f32 {
    let of = |mesh: &ajar_scene::Mesh| -> f32 {
        let corner = |i: u32| mesh.positions[i as usize];
        let cross = |[a, b, c]: [u32; 3]| (corner(b) - corner(a)).cross(corner(c) - corner(a)).length() / 2.0;
        mesh.triangles.iter().map(|&triangle| cross(triangle)).sum()
    };
    imported.scene.meshes.iter().map(of).sum()
}

#[test]
fn subsets_and_primvars_of_all_interpolations() {
    if !can_run() {
        return;
    }
    let prims = r#"
def Mesh "M" (prepend apiSchemas = ["MaterialBindingAPI"])
{
    int[] faceVertexCounts = [4, 4]
    int[] faceVertexIndices = [0, 1, 2, 3, 1, 4, 5, 2]
    point3f[] points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (2, 0, 0), (2, 1, 0)]
    uniform token subdivisionScheme = "none"
    uniform token orientation = "leftHanded"
    texCoord2f[] primvars:st = [(0, 0), (1, 0), (1, 0.25), (0, 0.25)] (interpolation = "faceVarying")
    int[] primvars:st:indices = [0, 1, 2, 3, 0, 1, 2, 3]
    color3f[] primvars:displayColor = [(1, 0, 0), (0, 1, 0)] (interpolation = "uniform")
    rel material:binding = </Looks/Textured>
    def GeomSubset "S" (prepend apiSchemas = ["MaterialBindingAPI"]) {
        uniform token elementType = "face"
        uniform token familyName = "materialBind"
        int[] indices = [1]
        rel material:binding = </Looks/Plain>
    }
}
def Mesh "Colored"
{
    int[] faceVertexCounts = [3]
    int[] faceVertexIndices = [0, 1, 2]
    point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
    uniform token subdivisionScheme = "none"
    color3f[] primvars:displayColor = [(1, 0, 0), (0, 1, 0), (0, 0, 1)] (interpolation = "vertex")
    float[] primvars:displayOpacity = [0.5] (interpolation = "constant")
    texCoord2f[] primvars:st = [(0, 0)] (interpolation = "vertex")
}
def Scope "Looks"
{
    def Material "Plain" { token outputs:surface.connect = </Looks/Plain/S.outputs:surface>
        def Shader "S" { uniform token info:id = "UsdPreviewSurface"
            token outputs:surface } }
    def Material "Textured" { token outputs:surface.connect = </Looks/Textured/S.outputs:surface>
        def Shader "S" { uniform token info:id = "UsdPreviewSurface"
            color3f inputs:diffuseColor.connect = </Looks/Textured/T.outputs:rgb>
            token outputs:surface }
        def Shader "T" { uniform token info:id = "UsdUVTexture"
            asset inputs:file = @a.png@
            float3 outputs:rgb } }
}
"#;
    let imported = Stage::new(prims).with("a.png", "no image, but there").scene();
    assert_eq!(warnings(&imported), Vec::<String>::new());
    let scene = &imported.scene;
    let name = |mesh: &ajar_scene::Mesh| scene.materials[mesh.material.unwrap()].name.clone();
    let names: Vec<_> = scene.meshes.iter().map(name).collect();
    assert_eq!(names, ["Textured", "Plain", "displayColor"]);
    let textured = scene.meshes.iter().next().unwrap();
    for [a, b, c] in textured.triangles.iter().map(|t| t.map(|i| textured.positions[i as usize])) {
        assert!((b - a).cross(c - a).z < 0.0, "left-handed faces are seen from behind");
    }
    for (position, uv) in textured.positions.iter().zip(&textured.uvs[0]) {
        // The origin moves from the bottom left to the top left.
        assert!((uv.x - position.x).abs() < 1e-6 && (uv.y - (1.0 - position.y / 4.0)).abs() < 1e-6);
    }
    let colored = scene.meshes.iter().last().unwrap();
    assert_eq!(colored.colors.as_ref().unwrap()[1].to_array(), [0.0, 1.0, 0.0, 1.0]);
    let shown = &scene.materials[colored.material.unwrap()];
    assert_eq!((shown.opacity.value, shown.alpha_mode), (0.5, ajar_scene::AlphaMode::Blend));
}

#[test]
fn what_does_not_fit_is_dropped_and_named() {
    if !can_run() {
        return;
    }
    let prims = r#"
def Mesh "Beyond"
{
    int[] faceVertexCounts = [3]
    int[] faceVertexIndices = [0, 1, 9]
    point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
}
def Mesh "Kept"
{
    int[] faceVertexCounts = [3]
    int[] faceVertexIndices = [0, 1, 2]
    point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
    uniform token subdivisionScheme = "none"
    normal3f[] normals = [(0, 0, 1)]
}
def NurbsPatch "Patch" {}
"#;
    let imported = Stage::new(prims).scene();
    assert_eq!(imported.scene.meshes.len(), 1);
    let said = warnings(&imported).join("\n");
    for expected in [
        "/Beyond: the mesh is dropped: a corner is beyond its 3 points",
        "/Kept: primvar 'normals' is dropped: it has 1 entries, 3 are needed",
        "/Patch: NurbsPatch geometry is dropped",
    ] {
        assert!(said.contains(expected), "{said}");
    }
}

#[test]
fn subdivision_with_creases() {
    if !can_run() {
        return;
    }
    let cube = |sharpness: &str| {
        let prims = format!(
            r#"
def Mesh "Cube"
{{
    int[] faceVertexCounts = [4, 4, 4, 4, 4, 4]
    int[] faceVertexIndices = [0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5]
    point3f[] points = [(-1, -1, -1), (1, -1, -1), (-1, 1, -1), (1, 1, -1), (-1, -1, 1), (1, -1, 1), (-1, 1, 1), (1, 1, 1)]
    {sharpness}
}}
"#
        );
        let imported = Stage::new(&prims).scene();
        assert_eq!(warnings(&imported), Vec::<String>::new());
        area(&imported)
    };
    let creases = "int[] creaseLengths = [5, 5, 2, 2, 2, 2]\n\
                   int[] creaseIndices = [0, 1, 3, 2, 0, 4, 5, 7, 6, 4, 0, 4, 1, 5, 2, 6, 3, 7]\n\
                   float[] creaseSharpnesses = [10, 10, 10, 10, 10, 10]";
    assert!((cube(creases) - 24.0).abs() < 0.01, "a cube that is sharp all over stays one");
    let smooth = cube("");
    assert!(smooth > 8.0 && smooth < 16.0, "{smooth}");
    assert_eq!(cube("uniform token subdivisionScheme = \"none\""), 24.0);
}

#[test]
fn implicit_shapes_have_their_area() {
    if !can_run() {
        return;
    }
    let pi = std::f32::consts::PI;
    for (shape, expected, high) in [
        ("Cube \"S\" { double size = 2 }", 24.0, Vec3::ONE),
        ("Sphere \"S\" { double radius = 2 }", 16.0 * pi, Vec3::splat(2.0)),
        (
            "Cylinder \"S\" { double radius = 1\ndouble height = 3\nuniform token axis = \"X\" }",
            8.0 * pi,
            Vec3::new(1.5, 1.0, 1.0),
        ),
        ("Cone \"S\" { double radius = 3\ndouble height = 4 }", 24.0 * pi, Vec3::new(3.0, 3.0, 2.0)),
        (
            "Capsule \"S\" { double radius = 1\ndouble height = 2\nuniform token axis = \"Y\" }",
            8.0 * pi,
            Vec3::new(1.0, 2.0, 1.0),
        ),
        (
            "Plane \"S\" { double width = 2\ndouble length = 4\nuniform token axis = \"Z\" }",
            8.0,
            Vec3::new(1.0, 2.0, 0.0),
        ),
    ] {
        let imported = Stage::new(&format!("def {shape}")).scene();
        assert_eq!(warnings(&imported), Vec::<String>::new());
        let found = area(&imported);
        assert!((found / expected - 1.0).abs() < 0.003, "{shape}: {found}, not {expected}");
        let top = bounds(&imported.scene).1;
        assert!((top - high).abs().max_element() < 0.003, "{shape}: {top}, not {high}");
        let mesh = imported.scene.meshes.iter().next().unwrap();
        let center = |t: &[u32; 3]| t.iter().map(|&i| mesh.positions[i as usize]).sum::<Vec3>() / 3.0;
        for t in &mesh.triangles {
            let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
            let outward = (b - a).cross(c - a);
            assert!(shape.starts_with("Plane") || outward.dot(center(t)) > 0.0, "{shape} is inside out");
            for normal in mesh.normals.iter().flat_map(|n| t.map(|i| n[i as usize])) {
                assert!(normal.dot(outward) > 0.0, "{shape}: a normal points inwards");
            }
        }
    }
}

#[test]
fn curves_are_tubes_and_points_balls() {
    if !can_run() {
        return;
    }
    let pi = std::f32::consts::PI;
    let line = "def BasisCurves \"C\" { uniform token type = \"linear\"\nint[] curveVertexCounts = [2]\n\
                point3f[] points = [(0, 0, 0), (0, 4, 0)]\nfloat[] widths = [0.5] (interpolation = \"constant\") }";
    let found = area(&Stage::new(line).scene());
    assert!((found / (2.0 * pi) - 1.0).abs() < 0.02, "{found}");
    // A Bézier curve with control points in line; widths grow from 0 to 1: a cone's mantle.
    let curve = "def BasisCurves \"C\" { uniform token type = \"cubic\"\nuniform token basis = \"bezier\"\n\
                 int[] curveVertexCounts = [4]\npoint3f[] points = [(0, 0, 0), (1, 0, 0), (2, 0, 0), (3, 0, 0)]\n\
                 float[] widths = [0, 1] (interpolation = \"varying\") }";
    let imported = Stage::new(curve).scene();
    assert_eq!(warnings(&imported), Vec::<String>::new());
    let (found, expected) = (area(&imported), pi * 0.5 * 9.25_f32.sqrt());
    assert!((found / expected - 1.0).abs() < 0.03, "{found}, not {expected}");
    assert!(near(bounds(&imported.scene).0 * Vec3::X, Vec3::ZERO));

    let points = "def Points \"P\" { point3f[] points = [(0, 0, 0), (9, 0, 0)]\nfloat[] widths = [2, 4]\n\
                  color3f[] primvars:displayColor = [(1, 0, 0), (0, 0, 1)] (interpolation = \"vertex\") }";
    let imported = Stage::new(points).scene();
    assert!((area(&imported) / (20.0 * pi) - 1.0).abs() < 0.01);
    let mesh = imported.scene.meshes.iter().next().unwrap();
    for (position, color) in mesh.positions.iter().zip(mesh.colors.as_ref().unwrap()) {
        assert_eq!(color.x, if position.x < 4.0 { 1.0 } else { 0.0 });
    }
}
