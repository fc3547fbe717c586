//! UsdSkel: meshes bent by skeletons at a moment.

use ajar_scene::Moment;
use glam::Vec3;

use super::{Stage, can_run, warnings};

/// A quad that a joint turns by a quarter about +Z within a second; `normals` says where it faces.
fn quad(normals: &str) -> Stage {
    Stage::whole(&format!(
        r#"#usda 1.0
(
    metersPerUnit = 1
    timeCodesPerSecond = 24
)
def SkelRoot "Body" {{
    def Skeleton "Bones" (prepend apiSchemas = ["SkelBindingAPI"]) {{
        uniform token[] joints = ["Hip"]
        uniform matrix4d[] bindTransforms = [((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1))]
        uniform matrix4d[] restTransforms = [((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1))]
        rel skel:animationSource = </Body/Turn>
    }}
    def SkelAnimation "Turn" {{
        uniform token[] joints = ["Hip"]
        quatf[] rotations.timeSamples = {{ 0: [(1, 0, 0, 0)], 24: [(0.70710678, 0, 0, 0.70710678)] }}
        half3[] scales = [(1, 1, 1)]
        float3[] translations = [(0, 0, 0)]
    }}
    def Mesh "Skin" (prepend apiSchemas = ["SkelBindingAPI"]) {{
        int[] faceVertexCounts = [4]
        int[] faceVertexIndices = [0, 1, 2, 3]
        point3f[] points = [(1, 0, 0), (1, 1, 0), (1, 1, 1), (1, 0, 1)]
        uniform token subdivisionScheme = "none"
        {normals}
        rel skel:skeleton = </Body/Bones>
        int[] primvars:skel:jointIndices = [0, 0, 0, 0] (elementSize = 1
            interpolation = "vertex")
        float[] primvars:skel:jointWeights = [1, 1, 1, 1] (elementSize = 1
            interpolation = "vertex")
    }}
}}
"#
    ))
}

#[test]
fn points_and_normals_follow_the_joints() {
    if !can_run() {
        return;
    }
    let attribute =
        "normal3f[] normals = [(1, 0, 0), (1, 0, 0), (1, 0, 0), (1, 0, 0)] (interpolation = \"vertex\")";
    let primvar = attribute.replace("normals", "primvars:normals");
    let indexed = "normal3f[] primvars:normals = [(1, 0, 0)] (interpolation = \"faceVarying\")\n\
                   int[] primvars:normals:indices = [0, 0, 0, 0]";
    for normals in [attribute, &primvar, indexed] {
        for (seconds, position, normal) in [(0.0, Vec3::X, Vec3::X), (1.0, Vec3::Y, Vec3::Y)] {
            let imported = quad(normals).at(Moment::Seconds(seconds)).scene();
            assert_eq!(warnings(&imported), Vec::<String>::new());
            let mesh = imported.scene.meshes.iter().next().unwrap();
            assert!(
                mesh.positions[0].abs_diff_eq(position, 1e-5),
                "{normals} {seconds}: {}",
                mesh.positions[0]
            );
            let found = mesh.normals.as_ref().unwrap()[0];
            assert!(found.abs_diff_eq(normal, 1e-5), "{normals} {seconds}: {found}");
        }
    }
}
