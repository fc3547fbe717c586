//! What pages change, and the layer that it is saved as.

use std::{
    fs, thread,
    time::{Duration, Instant},
};

use serde_json::{Value, json};

use super::{
    Watch, is_what_render_makes,
    socket::{Message, Page},
    studio::{light, studio},
};
use crate::bench::{Bench, SCENE};

/// Saves what was changed; returns the state that tells of it.
fn save(page: &mut Page) -> Value {
    page.ask(json!({ "do": "save" }));
    page.wait_for_state(|it| it["saved"].is_string())
}

/// A triangle in two variants, and a lamp.
fn lamp() -> Bench {
    let bench = Bench::new();
    let mut asset: Value = serde_json::from_slice(&fs::read(bench.path("leaf.gltf")).unwrap()).unwrap();
    let (variants, lights) = ("KHR_materials_variants", "KHR_lights_punctual");
    asset["extensionsUsed"] = json!([variants, lights]);
    asset["extensions"] = json!({
        variants: { "variants": [{ "name": "Red" }, { "name": "Green" }] },
        lights: { "lights": [{ "type": "point", "intensity": 5 }] },
    });
    let paint = |name: &str, color: [f64; 4]| json!({ "name": name, "pbrMetallicRoughness": { "baseColorFactor": color, "metallicFactor": 0 } });
    asset["materials"] = json!([paint("red", [0.8, 0.1, 0.1, 1.0]), paint("green", [0.1, 0.8, 0.1, 1.0])]);
    let mappings = json!([{ "material": 0, "variants": [0] }, { "material": 1, "variants": [1] }]);
    asset["meshes"][0]["primitives"][0]["extensions"] = json!({ variants: { "mappings": mappings } });
    let lamp =
        json!({ "name": "Lamp", "translation": [0.3, 0.3, 1], "extensions": { lights: { "light": 0 } } });
    asset["nodes"].as_array_mut().unwrap().push(lamp);
    asset["scenes"][0]["nodes"] = json!([0, 1]);
    bench.write("lamp.gltf", asset.to_string());
    bench
}

#[test]
fn a_layer_holds_what_the_command_line_said() {
    let bench = lamp();
    let flags =
        "--variant Green --size 24x16 --spp 4 --max-depth 3 --set material.green.coat=0.5 --allow kitchen";
    let mut watch = Watch::start(&bench, &format!("lamp.gltf -o out.exr --float {flags}"));
    let mut page = Page::of(&mut watch);
    page.set("material", "green", "roughness", 0.25);
    page.set("node", "Lamp", "light_scale", 3.0);
    let saved = save(&mut page);
    assert!(saved["saved"].as_str().unwrap().ends_with("look.toml"));
    assert_eq!(saved["saved_without"], json!(["--allow"]));
    is_what_render_makes(&bench, "out.exr", "look.toml --spp 4");
    let layer = fs::read_to_string(bench.path("look.toml")).unwrap();
    for wanted in
        ["Green", "roughness = 0.25", "coat = 0.5", "light_scale = 3.0", "max_depth = 3", "size = [24, 16]"]
    {
        assert!(layer.contains(wanted), "{wanted} is not in\n{layer}");
    }
    let note = watch.wait_for(|it| it["message"] == "changes saved");
    assert!(note["hint"].as_str().unwrap().contains("--allow"), "{note}");
}

#[test]
fn two_programs_in_one_folder_save_two_layers() {
    let bench = studio();
    let mut watches = [1, 2].map(|_| Watch::start(&bench, "studio/scene.toml"));
    let mut pages = watches.each_mut().map(Page::of);
    let mut names = Vec::new();
    for (page, roughness) in pages.iter_mut().zip([0.25, 0.75]) {
        page.set("material", "clay", "roughness", roughness);
        names.push(save(page)["saved"].clone());
    }
    assert!(
        names[0].as_str().unwrap().ends_with("look.toml")
            && names[1].as_str().unwrap().ends_with("look-2.toml")
    );
    let text = |name: &str| fs::read_to_string(bench.path(name)).unwrap();
    assert!(text("studio/look.toml").contains("0.25") && text("studio/look-2.toml").contains("0.75"));
}

#[test]
fn panels_show_what_is_set() {
    let bench = lamp();
    let mut watch = Watch::start(&bench, "lamp.gltf --size 24x16 --spp 1 --tone-map neutral --exposure 1.5");
    let mut page = Page::of(&mut watch);
    let scene = page.wait_for(|it| it["type"] == "scene");
    assert_eq!(scene["view"], json!({ "tone_map": "neutral", "exposure": 1.5 }));
    assert_eq!((&scene["lights"][0]["name"], &scene["lights"][0]["scale"]), (&json!("Lamp"), &json!(1.0)));
    page.ask(json!({ "do": "set", "table": "node", "name": "Lamp", "key": "light_scale", "value": 3 }));
    page.wait_for(|it| it["type"] == "scene" && it["lights"][0]["scale"] == 3.0);
}

#[test]
fn changes_that_no_longer_fit_are_those_of_the_page() {
    let bench = studio();
    let mut watch = Watch::start(&bench, "studio/scene.toml");
    let mut page = Page::of(&mut watch);
    page.set("material", "clay", "roughness", 0.5);
    let shape = fs::read_to_string(bench.path("studio/box.obj")).unwrap();
    bench.write("studio/box.mtl", "newmtl stone\nKd 0.5 0.5 0.5\n");
    bench.write("studio/box.obj", shape.replace("clay", "stone"));
    let error = watch.wait_for_error();
    assert_eq!(
        (&error["file"], &error["place"]),
        (&json!("changes made on the page"), &Value::Null),
        "{error}"
    );
    assert!(error["hint"].as_str().unwrap().contains("Drop"), "{error}");
    page.ask(json!({ "do": "revert" }));
    page.wait_for_state(|it| it["phase"] == "done" && it["errors"] == json!([]));
}

#[test]
fn a_region_is_cut_to_the_image() {
    let bench = studio();
    let mut watch = Watch::start(&bench, "studio/scene.toml");
    let mut page = Page::of(&mut watch);
    page.wait_until_done();
    let state = page.wait_for_state(|_| true);
    let [width, height] = [0, 1].map(|i| state["size"][i].as_u64().unwrap());
    page.ask(json!({ "do": "region", "pixels": [width / 2, 1, width, height] }));
    page.wait_for_state(|it| it["phase"] == "done" && it["window"] == json!([width / 2, 1, width, height]));
    for (size, window) in [
        ([width - 2, height - 2], [width / 2, 1, width - 2, height - 2]),
        // There is nothing left of it.
        ([width / 2, height], [0, 0, width / 2, height]),
    ] {
        let before = format!("size = [{width}, {height}]");
        assert!(light(0).contains(&before));
        bench.write(
            "studio/scene.toml",
            light(0).replace(&before, &format!("size = [{}, {}]", size[0], size[1])),
        );
        let state = page.wait_for_state(|it| it["phase"] == "done" && it["size"] == json!(size));
        assert_eq!(state["window"], json!(window));
    }
    // Beside the image nothing can be drawn.
    let image = page.wait_until_done();
    page.ask(json!({ "do": "region", "pixels": [width, 0, width + 2, 2] }));
    page.set("material", "clay", "roughness", 0.5);
    assert_eq!(page.wait_for_state(|_| true)["image"], image + 1);
    assert_eq!(page.wait_for_state(|_| true)["window"], json!([0, 0, width / 2, height]));
}

#[test]
fn what_cannot_be_is_taken_back_until_something_else_is_asked_for() {
    let bench = studio();
    let mut watch = Watch::start(&bench, "studio/scene.toml");
    let mut page = Page::of(&mut watch);
    page.set("material", "clay", "ior", 1.4);
    page.ask(json!({ "do": "set", "table": "material", "name": "clay", "key": "ior", "value": -5 }));
    let state = page.wait_for_state(|it| it["errors"] != json!([]) && it["phase"] == "done");
    assert!(state["edits"].as_str().unwrap().contains("1.4"), "{state}");
    let hint = state["errors"][0]["hint"].as_str().unwrap().to_owned();
    assert!(hint.contains("taken back") && !hint.contains("Drop"), "{hint}");
    // Panels hear what the value is.
    page.wait_for(|it| it["type"] == "scene" && it["materials"][0]["ior"]["value"].as_f64().unwrap() > 1.3);
    page.ask(json!({ "do": "probe", "x": 0, "y": 0 }));
    page.wait_for(|it| it["type"] == "probe");
    assert_ne!(page.wait_for_state(|_| true)["errors"], json!([]), "nothing else was asked for");
    page.ask(json!({ "do": "revert" }));
    page.wait_for_state(|it| it["phase"] == "done" && it["errors"] == json!([]));
}

#[test]
fn a_movement_leaves_one_image() {
    let bench = studio();
    let mut watch = Watch::start(&bench, "studio/scene.toml --spp 1");
    let mut page = Page::of(&mut watch);
    page.wait_until_done();
    let (mut last, mut longest) = (Instant::now(), Duration::ZERO);
    for step in 1..=10 {
        page.set("material", "clay", "roughness", f64::from(step) / 16.0);
        longest = longest.max(last.elapsed());
        last = Instant::now();
    }
    page.set("material", "clay", "metallic", 0.5);
    let kept = page.wait_for_state(|it| it["phase"] == "done")["snapshots"].as_array().unwrap().len();
    if longest > Duration::from_millis(1400) {
        println!("skipped: the machine takes {longest:?} for an image, which is no movement");
    } else {
        assert_eq!(kept, 2, "what was before, and where it ended");
    }
}

#[test]
fn an_edit_is_coarse_at_once_and_never_black() {
    let bench = studio();
    let scene = |illuminance: u32| {
        let size = light(illuminance).replace("size = [24, 16]", "size = [512, 320]");
        size.replace("spp = 4", "spp = 8")
    };
    bench.write("studio/scene.toml", scene(0));
    let mut watch = Watch::start(&bench, "studio/scene.toml");
    let mut page = Page::of(&mut watch);
    page.wait_until_done();
    let mut first = Vec::new();
    // Who looks late misses the coarse image, which a busy machine may.
    for number in 1..=5 {
        bench.write("studio/scene.toml", scene(number));
        let mut frames = Vec::new();
        loop {
            match page.next() {
                Message::Frame(frame) => frames.push((frame.size, frame.mean())),
                Message::Document(it) if it["phase"] == "done" && it["image"] == number + 1 => break,
                Message::Document(_) => {}
            }
        }
        let (_, last) = *frames.last().unwrap();
        assert!(
            last > 0.01 && frames.iter().all(|(_, mean)| (0.7..1.4).contains(&(mean / last))),
            "{frames:?}"
        );
        first.push(frames[0].0);
        if first.last() == Some(&[128, 80]) {
            return;
        }
    }
    panic!("no edit was coarse first: {first:?}");
}

#[test]
fn a_file_that_is_written_slowly_is_no_error() {
    let (begins, ends) = SCENE.split_at(SCENE.find("[[light]]").unwrap() + 4);
    for attempt in 1..=10 {
        let bench = Bench::new();
        let mut watch = Watch::start(&bench, "kitchen/scene.toml -o out.exr --float");
        watch.wait_for_image();
        let began = Instant::now();
        bench.write("kitchen/scene.toml", begins);
        thread::sleep(Duration::from_millis(250));
        let whole = format!("{begins}{}", ends.replace("illuminance = 10", "illuminance = 20"));
        bench.write("kitchen/scene.toml", whole);
        let pause = began.elapsed();
        let mut errors = Vec::new();
        let said = std::cell::RefCell::new(&mut errors);
        watch.wait_for(|it| {
            if it["severity"] == "error" || it["errors"].as_array().is_some_and(|errors| !errors.is_empty()) {
                said.borrow_mut().push(it.clone());
            }
            it["message"] == "written"
        });
        is_what_render_makes(&bench, "out.exr", "kitchen/scene.toml");
        if pause < Duration::from_millis(300) {
            assert!(errors.is_empty(), "{errors:?}");
            return;
        }
        println!("attempt {attempt}: the machine paused for {pause:?}");
    }
}
