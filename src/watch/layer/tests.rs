use super::*;

fn draft() -> Draft {
    let mut draft = Draft::default();
    draft.table(Kind::Node, "Lamp").insert("light_scale".into(), 2.0.into());
    draft.table(Kind::Material, "Chrome").insert("roughness".into(), 0.5.into());
    draft
}

fn read(draft: &Draft, scene: &str, said: &Said) -> Table {
    text(draft, Path::new(scene), said).parse().unwrap()
}

#[test]
fn a_layer_names_what_it_lies_over() {
    let over = |scene: &str| read(&draft(), scene, &Said::default());
    assert_eq!(over("a/scene.toml")["extends"].as_str(), Some("scene.toml"));
    assert_eq!(over("a/chair \"b\".glb")["import"][0]["file"].as_str(), Some("chair \"b\".glb"));
    assert_eq!(over("a/scene.toml")["node"]["Lamp"]["light_scale"].as_float(), Some(2.0));
}

#[test]
fn an_asset_is_imported_once_as_the_command_line_and_the_page_say() {
    let import = |name: &str| {
        Table::from_iter([("variant".to_owned(), vec![name].into()), ("frame".to_owned(), 3.into())])
    };
    let said = Said { import: import("Green"), ..Said::default() };
    let mut draft = draft();
    let imported = |draft: &Draft| read(draft, "a/shoe.glb", &said)["import"].as_array().unwrap().clone();
    assert_eq!(imported(&draft).len(), 1);
    assert_eq!(imported(&draft)[0]["variant"][0].as_str(), Some("Green"));
    assert_eq!(imported(&draft)[0]["frame"].as_integer(), Some(3));
    draft.show_variants("shoe", vec!["Red".into()]);
    assert_eq!(imported(&draft)[0]["variant"].as_array().unwrap().len(), 1);
    assert_eq!(imported(&draft)[0]["variant"][0].as_str(), Some("Red"));
    assert!(said.not_in_layer(Path::new("a/shoe.glb")).is_empty());
    assert_eq!(said.not_in_layer(Path::new("a/scene.toml")), ["--frame", "--variant"]);
    assert!(read(&draft, "a/scene.toml", &said)["import"][0].get("frame").is_none());
}

#[test]
fn pages_go_before_the_command_line() {
    let change = |text: &str| text.parse::<Table>().unwrap();
    let mut said = Said {
        changes: vec![change("material.Chrome.metallic = 0.25"), change("material.Chrome.roughness = 0.1")],
        ..Said::default()
    };
    said.changes.extend(
        ["material.'*'.roughness = 0.9", "camera.main.yfov = 30", "light.0.radiance = 3"].map(change),
    );
    said.say("render", "camera", "main");
    said.say("output", "exposure", 1.5);
    let mut draft = draft();
    draft.table(Kind::Camera, "main").insert("yfov".into(), 20.into());
    let layer = read(&draft, "scene.toml", &said);
    assert_eq!(layer["material"]["Chrome"]["roughness"].as_float(), Some(0.5));
    assert_eq!(layer["material"]["Chrome"]["metallic"].as_float(), Some(0.25));
    assert_eq!(layer["camera"].as_array().unwrap().len(), 1);
    assert_eq!(
        (layer["camera"][0]["name"].as_str(), layer["camera"][0]["yfov"].as_integer()),
        (Some("main"), Some(20))
    );
    assert_eq!(layer["render"]["camera"].as_str(), Some("main"));
    assert_eq!(layer["output"]["exposure"].as_float(), Some(1.5));
    assert!(layer.get("light").is_none() && said.not_in_layer(Path::new("scene.toml")) == ["--set light[0]"]);
    let text = text(&draft, Path::new("scene.toml"), &said);
    assert!(
        text.find("material.\"*\"") < text.find("material.Chrome"),
        "tables act one after the other:\n{text}"
    );
    draft.look_through("top");
    assert_eq!(read(&draft, "scene.toml", &said)["render"]["camera"].as_str(), Some("top"));
}

#[test]
fn no_file_of_others_is_written_over() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("scene.toml");
    let name = |path: PathBuf| path.file_name().unwrap().to_str().unwrap().to_owned();
    let content = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    let (mut one, mut other) = (Layer::default(), Layer::default());
    assert_eq!(name(one.save(&scene, "a".into()).unwrap()), "look.toml");
    assert_eq!(name(other.save(&scene, "b".into()).unwrap()), "look-2.toml");
    assert_eq!(name(one.save(&scene, "a2".into()).unwrap()), "look.toml");
    assert_eq!((content("look.toml"), content("look-2.toml")), ("a2".into(), "b".into()));
    // Edited by hand since: it is no longer ours.
    fs::write(folder.path().join("look.toml"), "by hand").unwrap();
    assert_eq!(name(one.save(&scene, "a3".into()).unwrap()), "look-3.toml");
    assert_eq!(content("look.toml"), "by hand");
    let nowhere = folder.path().join("missing/scene.toml");
    assert!(Layer::default().save(&nowhere, "a".into()).is_err());
}
