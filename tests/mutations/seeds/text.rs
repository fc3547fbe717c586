//! Seeds that are text.

use base64::{Engine, engine::general_purpose::STANDARD};

/// Four pixels.
const PICTURE: &str = "iVBORw0KGgoAAAANSUhEUgAAAAIAAAACCAIAAAD91JpzAAAAFklEQVR42mM4oSEnd0KDQUPuxK9fvwAhVgYZwLhWHQAAAABJRU5ErkJggg==";

/// A PNG.
pub fn picture() -> Vec<u8> {
    STANDARD.decode(PICTURE).unwrap_or_default()
}

/// A box below the picture that is examined.
pub const SKY: &str = r#"
[[import]]
file = "box.obj"

[[light]]
type = "environment"
texture = "input.picture"
"#;

/// What a box of four parts uses.
pub const LIBRARY: &str = "\
newmtl a
Ka 0 0 0
Kd 0.5 0.25 0.125
Ks 0.5 0.5 0.5
Ns 100
map_Kd -s 2 2 2 -o 0.5 0 0 map.png
map_Ks -clamp on map.png
illum 2
newmtl b
Kd 0.8 0.8 0.8
Pr 0.5
Pm 1
Pc 0.5
Pcr 0.1
aniso 0.5
anisor 0.25
map_Pr -imfchan g map.png
norm -bm 0.5 map.png
newmtl glass
Tf 0.9 1 0.9
Ni 1.5
illum 6
d 0.5
map_d map.png
newmtl lamp
Ke 10 9 8
map_Ke -mm 0 2 map.png
Tr 0.25
";

pub const OBJ: [&str; 2] = [
    "\
mtllib library.mtl
o one
v -1 -1 -1
v 1 -1 -1
v 1 1 -1
v -1 1 -1
v -1 -1 1
v 1 -1 1
v 1 1 1
v -1 1 1
vt 0 0
vt 1 0
vt 1 1
vt 0 1
vn 0 0 1
vn 0 0.6 0.8
usemtl a
s 1
f 4/1/1 3/2/1 2/3/1 1/4/1
f 5/1/1 6/2/2 7/3/1 8/4/2
usemtl b
f 1/1 2/2 6/3 5/4
s off
usemtl glass
f 2//1 3//1 7//2 6//2
g two
usemtl lamp
f -6 -5 -1 -2
f 4 1 5 8
",
    "\
# concave, with colours, and what is dropped
mtllib library.mtl
g star
v 0 0 0 1 0 0
v 2 0 0 0 1 0
v 2 2 0 0 0 1
v 1 0.5 0 1 1 1
v 0 2 0 0.5 0.5 0.5
v 1 1 1 1 1 0
s 2
usemtl a
f 1 2 3 4 5
f 1 2 6 \\
  3 4
f 1 2 2
p 1 2
l 1 2 3
usemtl nothing
s 3
f 2 3 6
f 3 5 6
vp 0.5
curv 0 1 1 2
end
",
];

pub const SCENES: [&str; 3] = [
    r#"
[[import]]
file = "box.obj"
name = "box"
up = "z"
unit = 0.5
scale = [1, 2, 1]
rotate = [0, 30, 0]
translate = [0.5, 0, 0]

[[import]]
file = "move.gltf"
frame = 3
fps = 30

[[camera]]
name = "main"
position = [3, 2, 4]
target = [0, 0, 0]
yfov = 30
lens_radius = 0.01
focus_distance = 5
shift = [0.1, 0]

[[camera]]
half_height = 2
position = [0, 0, 9]

[[light]]
type = "environment"
texture = "map.png"
radiance = 10
rotate = [0, 90, 0]

[[light]]
type = "rect"
position = [1, 2, 0]
direction = [0, -1, 0]
radiance = 40
width = 1.5
texture = { file = "map.png", wrap = "mirror", uv_set = 0 }

[[light]]
type = "spot"
inner = 10
outer = 30
target = [0, 0, 0]
position = [0, 3, 0]

[[light]]
type = "directional"
direction = [-1, -2, -1]
angle = 0.5
color = [1, 0.5, 0.25]

[material."a"]
roughness = 0.25
base_color_texture = "map.png"
normal_texture = "map.png"
transmission = 1
attenuation_color = [0.5, 1, 0.5]
attenuation_distance = 0.5

[material."*b*"]
metallic = 1
coat = 0.5
roughness_texture = { file = "map.png", channel = "g", color_space = "raw", filter = "nearest" }

[node."box/*"]
visible = true
scale = 2
rotate = [0, 10, 0]
material = "lamp"

[node."*"]
light_scale = 0.5

[render]
size = [24, 16]
time = "10m"
noise = "2%"
max_depth = 8
crop = [0, 0.5, 0, 1]
camera = "main"
mutations = { lens = 0 }

[output]
path = "out.exr"
aov = ["albedo", "normal"]
"#,
    r#"
[[import]]
file = "box.obj"

[[camera]]
name = "main"
position = [3, 2, 4]
target = [0, 0, 0]

[[light]]
name = "ball"
type = "sphere"
radius = 0.5
position = [0, 3, 0]

[[light]]
type = "cylinder"
length = 2
position = [0, -3, 0]

[[light]]
type = "disk"

[[light]]
type = "point"
intensity = 100
"#,
    r#"
extends = "base.toml"

[[camera]]
name = "main"
yfov = 25

[[camera]]
copy = "main"
name = "other"

[[light]]
name = "ball"
remove = true

[material."lamp"]
emission = [1, 2, 3]
opacity_texture = "map.png"
alpha_mode = "mask"
alpha_cutoff = 0.25
"#,
];

/// What a plug-in says.
pub const MESSAGES: &str = r#"{"level": "warning", "message": "fur dropped", "place": "/cat", "hint": "shave it"}
{"level": "note", "message": "it purrs"}
{"progress": "combing"}
{"file": "map.png"}
plainly"#;
