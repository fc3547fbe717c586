//! `--log-format json`: what programs read.

use serde_json::Value;

use crate::bench::Bench;

#[test]
fn messages_and_results_as_json() {
    let bench = Bench::new();
    let lines = |text: &str| -> Vec<Value> {
        text.lines()
            .map(|line| serde_json::from_str(line).unwrap_or_else(|e| panic!("{e}: {line}")))
            .collect()
    };
    let run =
        bench.run("render leaf.gltf --size 8x8 --rounds 3 --integrator path --log-format json -v").exits(0);
    let said = lines(&run.err);
    assert!(
        said.len() >= 2 && said.iter().all(|it| it["type"] == "message" && it["severity"] == "note"),
        "{said:?}"
    );
    let result = &lines(&run.out)[0];
    assert_eq!((&result["type"], &result["stats"]["rounds"]), (&"result".into(), &3.into()));
    assert!(result["exr"].as_str().unwrap().ends_with("leaf.exr"));

    let run = bench.run("--log-format json validate kitchen/scene.toml --set render.spp=0").exits(2);
    let said = lines(&run.err);
    assert_eq!((&said[0]["severity"], &said[0]["cause"]), (&"error".into(), &"usage".into()), "{said:?}");
    assert_eq!(said[0]["element"], "--set render.spp");
}
