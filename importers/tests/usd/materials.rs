//! UsdPreviewSurface, MaterialX and their networks.

use ajar_scene::{AlphaMode, Channel, ColorSpace, Imported, Material, Wrap};
use glam::{Vec2, Vec3};

use super::{Stage, can_run, warnings};

/// A triangle with a material `M` of these shaders; `S` is its surface.
fn stage(context: &str, shaders: &str) -> Stage {
    Stage::new(&format!(
        r#"
def Mesh "Mesh" (prepend apiSchemas = ["MaterialBindingAPI"])
{{
    int[] faceVertexCounts = [3]
    int[] faceVertexIndices = [0, 1, 2]
    point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
    uniform token subdivisionScheme = "none"
    texCoord2f[] primvars:st = [(0, 0), (1, 0), (0, 1)] (interpolation = "vertex")
    texCoord2f[] primvars:other = [(0, 0), (1, 0), (0, 1)] (interpolation = "vertex")
    rel material:binding = </M>
}}
def Material "M"
{{
    token outputs:{context}surface.connect = </M/S.outputs:out>
    {shaders}
}}
"#
    ))
    .with("a.png", "")
    .with("b.png", "")
}

fn material(imported: &Imported) -> &Material {
    imported.scene.materials.iter().next().unwrap()
}

fn shader(name: &str, id: &str, inputs: &str) -> String {
    format!("def Shader \"{name}\" {{ uniform token info:id = \"{id}\"\n{inputs}\ntoken outputs:out }}\n")
}

#[test]
fn preview_surface_with_textures() {
    if !can_run() {
        return;
    }
    let shaders = [
        shader(
            "S",
            "UsdPreviewSurface",
            "color3f inputs:diffuseColor.connect = </M/T.outputs:rgb>\n\
             float inputs:roughness.connect = </M/T.outputs:g>\n\
             float inputs:opacity.connect = </M/T.outputs:a>\nfloat inputs:opacityThreshold = 0.4\n\
             normal3f inputs:normal.connect = </M/N.outputs:rgb>\nfloat inputs:clearcoat = 0.25\n\
             float inputs:ior = 1.3\nfloat inputs:metallic = 1",
        ),
        shader(
            "T",
            "UsdUVTexture",
            "asset inputs:file = @a.png@\nfloat2 inputs:st.connect = </M/X.outputs:result>\n\
             token inputs:wrapS = \"repeat\"\ntoken inputs:wrapT = \"mirror\"\n\
             float4 inputs:scale = (0.5, 0.25, 1, 1)\nfloat3 outputs:rgb\nfloat outputs:g\nfloat outputs:a",
        ),
        shader(
            "N",
            "UsdUVTexture",
            "asset inputs:file = @b.png@\ntoken inputs:sourceColorSpace = \"raw\"\n\
             float4 inputs:scale = (2, 2, 2, 1)\nfloat4 inputs:bias = (-1, -1, -1, 0)\nfloat3 outputs:rgb",
        ),
        shader(
            "X",
            "UsdTransform2d",
            "float2 inputs:in.connect = </M/R.outputs:result>\nfloat inputs:rotation = 90\n\
             float2 inputs:scale = (2, 3)\nfloat2 inputs:translation = (0.1, 0.2)\nfloat2 outputs:result",
        ),
        shader("R", "UsdPrimvarReader_float2", "string inputs:varname = \"other\"\nfloat2 outputs:result"),
    ]
    .concat();
    let imported = stage("", &shaders).scene();
    assert_eq!(warnings(&imported), Vec::<String>::new());
    let m = material(&imported);
    assert_eq!((m.name.as_str(), m.path.as_str()), ("M", "/M"));
    assert_eq!((m.ior, m.coat.value, m.metallic.value), (1.3, 0.25, 1.0));
    assert_eq!(m.alpha_mode, AlphaMode::Mask(0.4));
    let texture = |id| &imported.scene.textures[id];
    let base = texture(m.base_color.texture.unwrap().texture);
    assert_eq!((base.scale[0], base.scale[1], base.color_space), (0.5, 0.25, ColorSpace::Auto));
    assert_eq!((base.wrap_u, base.wrap_v), (Wrap::Repeat, Wrap::Mirror));
    let roughness = m.roughness.texture.unwrap();
    assert_eq!((roughness.channel, texture(roughness.texture).scale[1]), (Channel::G, 0.25));
    assert_eq!(m.opacity.texture.unwrap().channel, Channel::A);
    // (u, v) = (1, 0.5) from the bottom left: scaled to (2, 1.5), turned to (−1.5, 2), moved to (−1.4, 2.2).
    let found = base.transform.transform_point2(Vec2::new(1.0, 1.0 - 0.5));
    assert!((found - Vec2::new(-1.4, 1.0 - 2.2)).length() < 1e-5, "{found}");
    let normal = texture(m.normal_map.unwrap().texture);
    assert_eq!(
        (normal.scale, normal.color_space, normal.wrap_u),
        ([1.0; 4].into(), ColorSpace::Raw, Wrap::Black)
    );
    // "other" was met first; the mesh brings both sets in this order.
    let mesh = imported.scene.meshes.iter().next().unwrap();
    assert_eq!((mesh.uvs.len(), base.uv_set, normal.uv_set), (2, 0, 1));
}

#[test]
fn specular_workflow_and_glass() {
    if !can_run() {
        return;
    }
    let inputs = "int inputs:useSpecularWorkflow = 1\ncolor3f inputs:specularColor = (0.25, 0.125, 0.25)";
    let imported = stage("", &shader("S", "UsdPreviewSurface", inputs)).scene();
    let m = material(&imported);
    // ((3 − 1) / (3 + 1))² is 0.25.
    assert!(
        (m.ior - 3.0).abs() < 1e-5 && (m.specular_color.value - Vec3::new(1.0, 0.5, 1.0)).length() < 1e-5
    );
    let imported = stage("", &shader("S", "UsdPreviewSurface", "float inputs:opacity = 0")).scene();
    let m = material(&imported);
    assert!(m.thin_walled && m.transmission.value == 1.0 && m.base_color.value == Vec3::ONE);
}

#[test]
fn materialx_graphs_become_one_texture() {
    if !can_run() {
        return;
    }
    let shaders = [
        shader(
            "S",
            "ND_standard_surface_surfaceshader",
            "float inputs:base = 0.5\ncolor3f inputs:base_color.connect = </M/Mix.outputs:out>\n\
             float inputs:specular_roughness.connect = </M/Green.outputs:outg>\n\
             float inputs:metalness.connect = </M/Power.outputs:out>\nfloat inputs:sheen = 1\n\
             vector3f inputs:normal.connect = </M/Normal.outputs:out>",
        ),
        shader(
            "Mix",
            "ND_mix_color3",
            "color3f inputs:fg.connect = </M/Image.outputs:out>\ncolor3f inputs:bg = (1, 1, 1)\n\
             float inputs:mix = 0.25\ncolor3f outputs:out",
        )
        .replace("\ntoken outputs:out", ""),
        shader(
            "Image",
            "ND_tiledimage_color3",
            "asset inputs:file = @a.png@ (colorSpace = \"srgb_texture\")\nfloat2 inputs:uvtiling = (4, 2)\n\
             token inputs:vaddressmode = \"clamp\"\ncolor3f outputs:out",
        )
        .replace("\ntoken outputs:out", ""),
        shader("Green", "ND_separate3_color3", "color3f inputs:in.connect = </M/Image.outputs:out>\nfloat outputs:outg"),
        shader("Power", "ND_power_float", "float inputs:in1 = 0.5\nfloat inputs:in2 = 2\nfloat outputs:out")
            .replace("\ntoken outputs:out", ""),
        shader(
            "Normal",
            "ND_normalmap",
            "vector3f inputs:in.connect = </M/Bump.outputs:out>\nfloat inputs:scale = 0.5\nvector3f outputs:out",
        )
        .replace("\ntoken outputs:out", ""),
        shader("Bump", "ND_image_vector3", "asset inputs:file = @b.png@\nvector3f outputs:out")
            .replace("\ntoken outputs:out", ""),
    ]
    .concat();
    let imported = stage("mtlx:", &shaders).scene();
    assert_eq!(warnings(&imported), [""; 0]);
    let m = material(&imported);
    // Widths of sheen are squares of Ajar's roughness.
    assert_eq!(m.sheen_color.value, Vec3::ONE);
    assert!((m.sheen_roughness.value - 0.3_f32.sqrt()).abs() < 1e-6, "{m:?}");
    let texture = |id| &imported.scene.textures[id];
    let base = texture(m.base_color.texture.unwrap().texture);
    // base · (1 + 0.25 · (image − 1))
    assert!((base.scale[0] - 0.125).abs() < 1e-6 && (base.bias[0] - 0.375).abs() < 1e-6, "{base:?}");
    assert_eq!((base.color_space, base.wrap_u, base.wrap_v), (ColorSpace::Srgb, Wrap::Repeat, Wrap::Clamp));
    assert!((base.transform.matrix2.x_axis - Vec2::new(4.0, 0.0)).length() < 1e-6);
    assert_eq!(m.roughness.texture.unwrap().channel, Channel::G);
    assert_eq!(m.metallic.value, 0.25);
    let normal = texture(m.normal_map.unwrap().texture);
    // x and y are halved around 0.5.
    assert!(
        (normal.scale[0] - 0.5).abs() < 1e-6
            && (normal.bias[0] - 0.25).abs() < 1e-6
            && normal.scale[2] == 1.0
    );
}

#[test]
fn openpbr_glass() {
    if !can_run() {
        return;
    }
    let inputs = "float inputs:transmission_weight = 1\ncolor3f inputs:transmission_color = (0.5, 1, 1)\n\
                  float inputs:transmission_depth = 2\nfloat inputs:specular_ior = 1.4\n\
                  float inputs:specular_roughness = 0";
    let imported = stage("mtlx:", &shader("S", "ND_open_pbr_surface_surfaceshader", inputs)).scene();
    assert_eq!(warnings(&imported), Vec::<String>::new());
    let m = material(&imported);
    assert_eq!((m.transmission.value, m.ior, m.attenuation_distance), (1.0, 1.4, 2.0));
    assert_eq!((m.attenuation_color, m.base_color.value), (Vec3::new(0.5, 1.0, 1.0), Vec3::ONE));
}

#[test]
fn layers_of_standard_surface() {
    if !can_run() {
        return;
    }
    let shaders = [
        shader(
            "S",
            "ND_standard_surface_surfaceshader",
            "float inputs:transmission = 1\nfloat inputs:transmission_dispersion = 40\n\
             color3f inputs:transmission_scatter = (0, 0.1, 0)\n\
             float inputs:sheen = 0.5\ncolor3f inputs:sheen_color.connect = </M/Image.outputs:out>\n\
             float inputs:thin_film_thickness = 300\nfloat inputs:thin_film_IOR = 1.4\n\
             float inputs:specular_roughness = 0.5\nfloat inputs:specular_anisotropy = 0.75\n\
             float inputs:coat = 1\ncolor3f inputs:coat_color = (1, 1, 0.5)\n\
             vector3f inputs:coat_normal.connect = </M/Normal.outputs:out>",
        ),
        shader("Image", "ND_image_color3", "asset inputs:file = @a.png@\ncolor3f outputs:out")
            .replace("\ntoken outputs:out", ""),
        shader(
            "Normal",
            "ND_normalmap",
            "vector3f inputs:in.connect = </M/Bump.outputs:out>\nvector3f outputs:out",
        )
        .replace("\ntoken outputs:out", ""),
        shader("Bump", "ND_image_vector3", "asset inputs:file = @b.png@\nvector3f outputs:out")
            .replace("\ntoken outputs:out", ""),
    ]
    .concat();
    let imported = stage("mtlx:", &shaders).scene();
    let said = warnings(&imported);
    for name in ["transmission_scatter", "coat_color"] {
        assert!(said.iter().any(|line| line.contains(&format!("'{name}' is ignored"))), "{said:?}");
    }
    assert_eq!(said.len(), 2, "{said:?}");
    let m = material(&imported);
    assert_eq!((m.dispersion, m.film.value, m.film_thickness.value, m.film_ior), (0.5, 1.0, 300.0, 1.4));
    let sheen = &imported.scene.textures[m.sheen_color.texture.unwrap().texture];
    assert_eq!((sheen.scale[0], m.normal_map), (0.5, None));
    assert!(m.coat_normal_map.is_some());
    // Widths of 0.5 and 0.125 along and across: roughness² is the second, anisotropy² the way from there to 1.
    assert!((m.roughness.value.powi(2) - 0.125).abs() < 1e-6, "{m:?}");
    assert!((m.anisotropy.value.powi(2) - 0.375 / 0.875).abs() < 1e-6, "{m:?}");
    let brushed = "float inputs:specular_anisotropy = 0.5";
    let imported = stage("mtlx:", &shader("S", "ND_standard_surface_surfaceshader", brushed)).scene();
    let mesh = imported.scene.meshes.iter().next().unwrap();
    assert_eq!(mesh.uvs.len(), 1, "tangents need coordinates, without textures too");
}

#[test]
fn layers_of_openpbr() {
    if !can_run() {
        return;
    }
    let inputs = "float inputs:fuzz_weight = 0.5\ncolor3f inputs:fuzz_color = (1, 0.5, 1)\n\
                  float inputs:fuzz_roughness = 0.8\nfloat inputs:thin_film_weight = 0.25\n\
                  float inputs:thin_film_thickness = 0.3\nfloat inputs:transmission_weight = 1\n\
                  float inputs:transmission_dispersion_scale = 0.5\n\
                  float inputs:transmission_dispersion_abbe_number = 40\nfloat inputs:coat_weight = 1\n\
                  float inputs:coat_roughness = 0.5\nfloat inputs:specular_roughness = 0";
    let imported = stage("mtlx:", &shader("S", "ND_open_pbr_surface_surfaceshader", inputs)).scene();
    let said = warnings(&imported);
    assert!(said[0].contains("fuzz is approximated by sheen"), "{said:?}");
    assert!(said[1].contains("'coat_darkening' is ignored") && said.len() == 2, "{said:?}");
    let m = material(&imported);
    assert_eq!((m.sheen_color.value, m.sheen_roughness.value), (Vec3::new(0.5, 0.25, 0.5), 1.0));
    assert_eq!((m.film.value, m.film_ior, m.dispersion, m.coat_ior), (0.25, 1.4, 0.25, 1.6));
    assert!((m.film_thickness.value - 300.0).abs() < 1e-3, "{m:?}");
    // A rough coat over a mirror: 2 · 0.5⁴ is the fourth power of what is seen.
    assert!((m.roughness.value.powi(4) - 0.125).abs() < 1e-6, "{m:?}");
}

#[test]
fn a_materialx_file() {
    if !can_run() {
        return;
    }
    let mtlx = r#"<?xml version="1.0"?>
<materialx version="1.38" colorspace="lin_rec709">
  <nodegraph name="NG">
    <input name="tint" type="color3" value="0.5, 0.25, 1" />
    <image name="picture" type="color3">
      <input name="file" type="filename" value="a.png" colorspace="srgb_texture" />
    </image>
    <multiply name="tinted" type="color3">
      <input name="in1" type="color3" nodename="picture" />
      <input name="in2" type="color3" interfacename="tint" />
    </multiply>
    <output name="out" type="color3" nodename="tinted" />
  </nodegraph>
  <standard_surface name="SR" type="surfaceshader">
    <input name="base" type="float" value="1" />
    <input name="base_color" type="color3" nodegraph="NG" output="out" />
    <input name="metalness" type="float" value="0.75" />
  </standard_surface>
  <surfacematerial name="Painted" type="material">
    <input name="surfaceshader" type="surfaceshader" nodename="SR" />
  </surfacematerial>
</materialx>"#;
    let prims = r#"
def Scope "Looks" (references = @looks/paint.mtlx@</MaterialX>) {}
def Sphere "Ball" (prepend apiSchemas = ["MaterialBindingAPI"])
{
    rel material:binding = </Looks/Materials/Painted>
}
"#;
    let imported = Stage::new(prims).with("looks/paint.mtlx", mtlx).with("looks/a.png", "").scene();
    let m = material(&imported);
    assert_eq!((m.name.as_str(), m.metallic.value), ("Painted", 0.75));
    let base = &imported.scene.textures[m.base_color.texture.unwrap().texture];
    assert_eq!((base.scale[0], base.scale[1], base.color_space), (0.5, 0.25, ColorSpace::Srgb));
}

#[test]
fn what_cannot_be_read_is_named() {
    if !can_run() {
        return;
    }
    let shaders = [
        shader("S", "UsdPreviewSurface", "color3f inputs:diffuseColor.connect = </M/Noise.outputs:out>"),
        shader("Noise", "ND_noise3d_color3", ""),
    ]
    .concat();
    let imported = stage("", &shaders).scene();
    assert!(warnings(&imported)[0].contains("'diffuseColor' has its default: nodes 'noise3d' are not read"));
    let imported = stage("", &shader("S", "MyOwnSurface", "")).scene();
    assert!(warnings(&imported)[0].contains("surface shaders MyOwnSurface are not read"));
    let shaders = [
        shader("S", "UsdPreviewSurface", "color3f inputs:diffuseColor.connect = </M/T.outputs:rgb>"),
        shader("T", "UsdUVTexture", "asset inputs:file = @none.png@\nfloat3 outputs:rgb"),
    ]
    .concat();
    let imported = stage("", &shaders).scene();
    assert!(warnings(&imported)[0].contains("the file none.png is not there"), "{:?}", warnings(&imported));
    assert!(imported.files.iter().any(|file| file.ends_with("none.png")), "it is looked for");
}

#[test]
fn instances_and_variants_bring_materialx_files() {
    if !can_run() {
        return;
    }
    let paint = r#"<?xml version="1.0"?><materialx version="1.38">
        <open_pbr_surface name="S" type="surfaceshader"><input name="base_color" type="color3" value="0.5, 0.25, 0.125"/>
        </open_pbr_surface><surfacematerial name="Red" type="material">
        <input name="surfaceshader" type="surfaceshader" nodename="S"/></surfacematerial></materialx>"#;
    let prims = r#"
def Xform "Proto" {
    def "Paint" (references = @paint.mtlx@</MaterialX/Materials>) {}
    def Sphere "Ball" (prepend apiSchemas = ["MaterialBindingAPI"]) {
        rel material:binding = </Proto/Paint/Red>
    }
}
def "A" (
    instanceable = true
    references = </Proto>) {}
def "B" (
    prepend variantSets = "look"
    variants = { string look = "red" }
    references = </Proto>) {
    variantSet "look" = { "red" { over "Paint" (payload = @paint.mtlx@</MaterialX>) {} } }
}
def Sphere "Lost" (prepend apiSchemas = ["MaterialBindingAPI"]) { rel material:binding = </Nowhere> }
"#;
    let imported = Stage::new(prims).with("paint.mtlx", paint).scene();
    assert_eq!(warnings(&imported), ["/Lost: the bound material /Nowhere is not there"]);
    let red = |m: &&Material| (m.base_color.value - Vec3::new(0.5, 0.25, 0.125)).length() < 1e-6;
    assert_eq!(imported.scene.materials.iter().filter(red).count(), 3, "of the prototype, A and B");
}

#[cfg(unix)]
#[test]
fn a_folder_that_is_a_link_brings_materialx_files() {
    if !can_run() {
        return;
    }
    let paint = r#"<?xml version="1.0"?><materialx version="1.38">
        <open_pbr_surface name="S" type="surfaceshader"/><surfacematerial name="Red" type="material">
        <input name="surfaceshader" type="surfaceshader" nodename="S"/></surfacematerial></materialx>"#;
    let prims = r#"
def "Paint" (references = @paint.mtlx@</MaterialX/Materials>) {}
def Sphere "Ball" (prepend apiSchemas = ["MaterialBindingAPI"]) { rel material:binding = </Paint/Red> }
"#;
    let mut stage = Stage::new(prims).with("paint.mtlx", paint);
    let elsewhere = tempfile::tempdir().unwrap();
    let link = elsewhere.path().join("link");
    std::os::unix::fs::symlink(stage.folder.path(), &link).unwrap();
    stage.request = ajar_scene::ImportRequest::new(link.join("main.usda"));
    let imported = stage.scene();
    assert_eq!(warnings(&imported), [""; 0]);
    assert_eq!(imported.scene.materials.len(), 1);
}
