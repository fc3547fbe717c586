//! Hostile Ajar scenes.

use serde_json::{Value, json};

use crate::jail::{
    Fate::{self, Clean, Either, Refused, TooLarge, Warned},
    Jail,
};

const MANY: usize = 100_000;

/// A scene with one triangle, changed.
fn scene(change: impl FnOnce(&mut Value)) -> String {
    let mut scene = json!({
        "ajar": 1,
        "roots": [0],
        "nodes": [{"meshes": [0]}],
        "meshes": [{"positions": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "triangles": [[0, 1, 2]]}],
    });
    change(&mut scene);
    scene.to_string()
}

/// The same with its positions in a chunk, which may be told to be elsewhere.
fn contained(positions: Value, numbers: [f32; 9]) -> Vec<u8> {
    let json = scene(|it| it["meshes"][0]["positions"] = positions).into_bytes();
    let json = [json.as_slice(), &vec![b' '; json.len().next_multiple_of(4) - json.len()]].concat();
    let binary: Vec<u8> = numbers.into_iter().flat_map(f32::to_le_bytes).collect();
    let length = |n: usize| (n as u32).to_le_bytes();
    let file = [
        &b"AJAR\x01\0\0\0"[..],
        &length(28 + json.len() + binary.len()),
        &length(json.len()),
        b"JSON",
        &json,
        &length(binary.len()),
        b"BIN\0",
        &binary,
    ];
    file.concat()
}

const SOUND: [f32; 9] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];

#[test]
fn counts_and_offsets_that_promise_too_much() {
    let mut jail = Jail::new();
    jail.try_file("sound.ajar", scene(|_| ()), Clean);
    jail.try_file("sound.ajar", contained(json!({"offset": 0, "count": 3}), SOUND), Clean);
    for number in
        [json!(u64::MAX), json!(u64::MAX / 12), json!(1_u64 << 32), json!(4), json!(-1), json!(1e18)]
    {
        jail.try_file("count.ajar", contained(json!({"offset": 0, "count": number}), SOUND), Refused);
        jail.try_file("offset.ajar", contained(json!({"offset": number, "count": 3}), SOUND), Refused);
    }
    jail.try_file("none.ajar", contained(json!({"offset": 0, "count": 0}), SOUND), Refused);
    jail.try_file("crooked.ajar", contained(json!({"offset": 1, "count": 2}), SOUND), Refused);
    for at in [4, 8, 12, 16] {
        for byte in [0, 0x7f, 0xff] {
            let mut file = contained(json!({"offset": 0, "count": 3}), SOUND);
            file[at..at + 4].fill(byte);
            jail.try_file("length.ajar", file, Refused);
        }
    }
    let mut shared = json!({"positions": {"offset": 0, "count": 3}, "triangles": [[0, 1, 2]]});
    shared["uvs"] = json!(vec![json!({"offset": 0, "count": 3}); MANY]);
    let many = scene(|it| it["meshes"] = json!(vec![shared; 20]));
    jail.try_file("same.ajar", many, Either);
    jail.close();
}

#[test]
fn numbers_that_are_none() {
    let mut jail = Jail::new();
    let count = json!({"offset": 0, "count": 3});
    for number in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let mut numbers = SOUND;
        numbers[4] = number;
        jail.try_file("number.ajar", contained(count.clone(), numbers), Refused);
    }
    for number in [f32::MAX, 1e30, 1e-45, f32::MIN_POSITIVE] {
        jail.try_file("number.ajar", contained(count.clone(), SOUND.map(|x| x * number)), Either);
    }
    for number in ["1e999", "1e39", "-1e39", "NaN", "null", "\"1\"", "[]"] {
        let text = scene(|_| ()).replacen("[0,0,0]", &format!("[0,{number},0]"), 1);
        jail.try_file("text.ajar", text, Refused);
    }
    for transform in [json!([0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]), json!([1e308]), json!(vec![1e200; 12])] {
        jail.try_file("place.ajar", scene(|it| it["nodes"][0]["transform"] = transform), Either);
    }
    for light in [
        json!({"sphere": {"radiance": -1, "radius": 1}}),
        json!({"sphere": {"radiance": 1, "radius": 0}}),
        json!({"rect": {"radiance": 1, "width": 1e39, "height": 1, "texture": null}}),
        json!({"spot": {"intensity": 1, "inner": 2, "outer": 1}}),
        json!({"environment": {"radiance": 1, "texture": 7}}),
        json!({"laser": {}}),
    ] {
        let lit =
            |it: &mut Value| (it["lights"], it["nodes"][0]["light"]) = (json!([{"kind": light}]), json!(0));
        jail.try_file("light.ajar", scene(lit), Refused);
    }
    for camera in [
        json!({"perspective": {"yfov": 0, "lens_radius": 0, "focus_distance": 1, "shift": [0, 0]}}),
        json!({"perspective": {"yfov": 1, "lens_radius": 0, "focus_distance": 0, "shift": [0, 0]}}),
        json!({"orthographic": {"half_height": -1}}),
    ] {
        let seen = |it: &mut Value| {
            (it["cameras"], it["nodes"][0]["camera"]) = (json!([{"projection": camera}]), json!(0))
        };
        jail.try_file("camera.ajar", scene(seen), Refused);
    }
    jail.close();
}

#[test]
fn deep_and_long_structures() {
    let mut jail = Jail::new();
    let nest = |open: &str, close: &str| format!("{}{}", open.repeat(MANY), close.repeat(MANY));
    jail.try_file("arrays.ajar", format!("{{\"ajar\":1,\"a\":{}}}", nest("[", "]")), Refused);
    jail.try_file("objects.ajar", nest("{\"a\":", "}"), Refused);
    let children = |count: usize, below: &dyn Fn(usize) -> Value| {
        scene(|it| it["nodes"] = (0..count).map(|i| json!({"children": below(i), "meshes": [0]})).collect())
    };
    jail.try_file("own.ajar", children(1, &|_| json!([0])), Refused);
    jail.try_file("round.ajar", children(3, &|i| json!([(i + 1) % 3])), Refused);
    jail.try_file(
        "double.ajar",
        children(40, &|i| if i < 39 { json!([i + 1, i + 1]) } else { json!([]) }),
        Refused,
    );
    jail.try_file("beyond.ajar", children(1, &|_| json!([7])), Refused);
    jail.try_file(
        "chain.ajar",
        children(MANY, &|i| if i + 1 < MANY { json!([i + 1]) } else { json!([]) }),
        Either,
    );
    jail.try_file(
        "wide.ajar",
        children(MANY, &|i| if i == 0 { (1..MANY).collect() } else { json!([]) }),
        Either,
    );
    jail.try_file("roots.ajar", scene(|it| it["roots"] = json!(vec![0; MANY])), Either);
    jail.try_file("roots.ajar", scene(|it| it["roots"] = json!([0, 7])), Refused);
    jail.try_file("meshes.ajar", scene(|it| it["nodes"][0]["meshes"] = json!(vec![0; MANY])), Either);
    jail.try_file(
        "materials.ajar",
        scene(|it| it["materials"] = json!(vec![json!({"ior": 0.5}); MANY])),
        Either,
    );
    let images = json!(vec![json!({"file": "gone.png"}); MANY]);
    jail.try_file("images.ajar", scene(|it| it["images"] = images), Refused);
    jail.close();
}

#[test]
fn polygons_that_promise_too_much() {
    let mut jail = Jail::new();
    let polygons = |members: Value| {
        scene(|it| {
            let mut mesh = json!({"positions": [[0,0,0], [1,0,0], [1,1,0], [0,1,0]], "faces": [4], "corners": [0,1,2,3]});
            members.as_object().unwrap().iter().for_each(|(key, value)| mesh[key] = value.clone());
            it["meshes"] = json!([mesh]);
        })
    };
    let (squares, corners) = (vec![4; 50_000], [0, 1, 2, 3].repeat(50_000));
    let cases: [(Value, Fate); 21] = [
        (json!({}), Clean),
        (json!({"faces": [u32::MAX]}), Refused),
        (json!({"faces": [u32::MAX, 5]}), Refused),
        (json!({"faces": [1_u64 << 32]}), Refused),
        (json!({"faces": [0, 0, 4, 0]}), Either),
        (json!({"faces": [2, 2]}), Warned),
        (json!({"faces": []}), Refused),
        (json!({"corners": [0, 1, 2, 4]}), Refused),
        (json!({"corners": [0, 0, 0, 0]}), Either),
        (json!({"holes": [1]}), Refused),
        (json!({"holes": [0, 0, 0]}), Either),
        (json!({"parts": [{"material": 7, "faces": [0]}]}), Refused),
        (json!({"parts": vec![json!({"faces": [0]}); MANY]}), Either),
        (json!({"uvs": [{"values": [[0, 0]], "indices": [0, 0, 0, 1]}]}), Refused),
        (json!({"uvs": [{"values": []}]}), Refused),
        (json!({"subdivision": {"levels": u32::MAX}}), Refused),
        (json!({"subdivision": {"creases": [[0, 9]], "crease_sharpness": [1]}}), Refused),
        (json!({"subdivision": {"creases": [[0, 0]], "crease_sharpness": [1e38]}}), Either),
        (json!({"subdivision": {"creases": [[0, 1]], "crease_sharpness": []}}), Refused),
        (json!({"subdivision": {"sharp_positions": [0], "position_sharpness": [-1]}}), Either),
        (json!({"subdivision": {"levels": 6}, "faces": squares, "corners": corners}), TooLarge),
    ];
    for (members, fate) in cases {
        jail.try_file("polygons.ajar", polygons(members), fate);
    }
    // All faces around one position, and all on one edge.
    let fan: Vec<usize> = (1..MANY).flat_map(|i| [0, i, i + 1]).collect();
    let book: Vec<usize> = (2..MANY).flat_map(|i| [0, 1, i]).collect();
    let circle = |i: usize| {
        let (sin, cos) = (i as f64 / MANY as f64 * std::f64::consts::TAU).sin_cos();
        json!([cos, sin, 0.1 * i as f64])
    };
    let positions: Value = (0..=MANY).map(circle).collect();
    for (name, corners) in [("fan", fan), ("book", book)] {
        for levels in [0, 1] {
            let faces = json!(vec![3; corners.len() / 3]);
            let mesh = json!({"positions": positions, "faces": faces, "corners": corners, "subdivision": {"levels": levels}});
            jail.try_file(&format!("{name}.ajar"), polygons(mesh), Either);
        }
    }
    jail.close();
}

#[test]
fn images_stay_in_the_folder() {
    let mut jail = Jail::new();
    jail.put("secret.png", crate::images::png(1, 1, crate::images::ONE_PIXEL));
    for file in [
        "../secret.png",
        "..\\secret.png",
        "/etc/passwd",
        "/dev/zero",
        "file:///etc/passwd",
        "http://localhost/a.png",
        "",
        ".",
        "a\0b",
    ] {
        jail.try_file("inner/image.ajar", scene(|it| it["images"] = json!([{"file": file}])), Refused);
    }
    jail.close();
}
