//! Broken files and exactly what is said about them.

use super::wrong;
use crate::{ImportRequest, Overrides};

#[test]
fn messages() {
    const CASES: &[(&str, &[&str])] = &[
        // Syntax.
        ("[render]\nspp = = 3\n", &["2:7: error: extra `=`, expected nothing"]),
        ("[render]\nspp = 1\nspp = 2\n", &["3:1: error: duplicate key"]),
        // Unknown keys, all of them, each with its place.
        (
            "[render]\nsppp = 1\nintegator = \"path\"\n",
            &[
                "2:1: error: render.sppp: unknown key\n  hint: did you mean \"spp\"?",
                "3:1: error: render.integator: unknown key\n  hint: did you mean \"integrator\"?",
            ],
        ),
        (
            "[sky]\n",
            &[
                "1:2: error: sky: unknown key\n  hint: one of extends, import, camera, light, material, node, render, output",
            ],
        ),
        (
            "[[camera]]\n[[camera]]\n  fov = 3\n",
            &["3:3: error: camera[1].fov: unknown key\n  hint: did you mean \"yfov\"?"],
        ),
        (
            "[[light]]\ntype = \"sphere\"\nwidth = 1\n",
            &[
                "3:1: error: light[0].width: unknown key\n  hint: one of remove, name, color, type, position, radiance, radius",
            ],
        ),
        // Wrong types.
        ("[render]\nspp = \"many\"\n", &["2:7: error: render.spp: expected a whole number, found string"]),
        ("[render]\nspp = 1.5\n", &["2:7: error: render.spp: expected a whole number, found float"]),
        ("[render]\nsize = [512]\n", &["2:8: error: render.size: expected a list of 2 numbers, found 1"]),
        ("[output]\nfloat = 1\n", &["2:9: error: output.float: expected true or false, found integer"]),
        (
            "[output]\naov = \"depth\"\n",
            &["2:7: error: output.aov: expected a list of strings, found string"],
        ),
        ("render = 3\n", &["1:10: error: render: expected a table, found integer\n  hint: write [render]"]),
        (
            "[camera]\n",
            &["1:1: error: camera: expected a list of tables, found table\n  hint: write [[camera]]"],
        ),
        (
            "light = [1]\n",
            &["1:10: error: light[0]: expected a table, found integer\n  hint: write [[light]]"],
        ),
        // Values out of range.
        ("[render]\nspp = 0\n", &["2:7: error: render.spp: must be at least 1 and at most 4294967295, is 0"]),
        (
            "[render]\nspp = 99999999999999999999\n",
            &["2:7: error: render.spp: 99999999999999999999 is too large"],
        ),
        (
            "[render]\nsize = [0, 5]\n",
            &["2:8: error: render.size: must be at least 1 and at most 65535, is 0"],
        ),
        ("[render]\nsize = [1.5, 5]\n", &["2:8: error: render.size: must be whole numbers of pixels"]),
        (
            "[render]\ntime = \"soon\"\n",
            &["2:8: error: render.time: \"soon\" is not a time, expected something like 90s, 10m or 1h30m"],
        ),
        (
            "[render]\nnoise = 2\n",
            &["2:9: error: render.noise: \"2\" is not a share, expected something like 2% or 0.02"],
        ),
        ("[render]\nnoise = \"0%\"\n", &["2:9: error: render.noise: must be greater than 0, is 0"]),
        (
            "[render]\ncrop = [0.5, 0.5, 0, 1]\n",
            &[
                "2:8: error: render.crop: must be left < right and top < bottom, in the order [left, right, top, bottom]",
            ],
        ),
        (
            "[[camera]]\nyfov = 180\n",
            &["2:8: error: camera[0].yfov: must be greater than 0 and less than 180, is 180"],
        ),
        (
            "[[camera]]\nposition = [0, nan, 0]\n",
            &["2:12: error: camera[0].position: must be finite, is NaN"],
        ),
        ("[[camera]]\nexposure = 1e39\n", &["2:12: error: camera[0].exposure: is too large: 1e39"]),
        (
            "[[camera]]\nposition = [1, 2, 3]\ntarget = [1, 2, 3]\n",
            &["3:10: error: camera[0].target: must differ from the position"],
        ),
        (
            "[[camera]]\ntarget = [0, 5, 0]\nup = [0, 1, 0]\n",
            &["3:6: error: camera[0].up: must not lie along the line of sight"],
        ),
        (
            "[[camera]]\nhalf_height = 1\nyfov = 40\n",
            &["3:8: error: camera[0].yfov: belongs to a perspective camera, cannot go with \"half_height\""],
        ),
        (
            "[render]\ncamera = \"mian\"\n[[camera]]\nname = \"main\"\n",
            &["2:10: error: render.camera: no camera has this name\n  hint: did you mean \"main\"?"],
        ),
        // Lights.
        ("[[light]]\n", &["1:1: error: light[0].type: is missing"]),
        (
            "[[light]]\ntype = \"rectangle\"\n",
            &[
                "2:8: error: light[0].type: \"rectangle\" is not known here\n  hint: one of point, spot, directional, rect, disk, sphere, cylinder, environment",
            ],
        ),
        (
            "[[light]]\ntype = \"disc\"\n",
            &["2:8: error: light[0].type: \"disc\" is not known here\n  hint: did you mean \"disk\"?"],
        ),
        (
            "[[light]]\ntype = \"point\"\nintensity = -1\n",
            &["3:13: error: light[0].intensity: must be at least 0, is -1"],
        ),
        (
            "[[light]]\ntype = \"spot\"\ninner = 40\n",
            &["3:9: error: light[0].inner: the inner angle must not exceed the outer"],
        ),
        (
            "[[light]]\ntype = \"rect\"\ntarget = [0, 0, -1]\nrotate = [0, 0, 0]\n",
            &["4:10: error: light[0].rotate: cannot go with \"target\""],
        ),
        (
            "[[light]]\ntype = \"rect\"\ndirection = [0, 0, 0]\n",
            &["3:13: error: light[0].direction: must not be zero"],
        ),
        // Imports.
        ("[[import]]\n", &["1:1: error: import[0].file: is missing"]),
        (
            "[[import]]\nfile = \"a.glb\"\nscale = 0\n",
            &["3:9: error: import[0].scale: must not be zero", "warning: something was dropped"],
        ),
        ("[[import]]\nfile = \"bad.glb\"\n", &["bad.glb: error: is no asset"]),
        (
            "[[import]]\nfile = \"none.glb\"\n[material.Crome]\n[render]\ncamera = \"x\"\n",
            &[
                "2:8: error: import[0].file: \"none.glb\" cannot be read: No such file or directory (os error 2)",
            ],
        ),
        (
            "[[import]]\nfile = \"https://example.org/a.glb\"\n",
            &[
                "2:8: error: import[0].file: \"https://example.org/a.glb\" is a URL; only files beside the scene are read",
            ],
        ),
        (
            "[[import]]\nfile = \"..\"\n",
            &[
                "2:8: error: import[0].file: \"..\" lies outside the scene's folder\n  hint: move it there, or allow its folder with --allow",
            ],
        ),
        // Materials.
        (
            "[[import]]\nfile = \"a.glb\"\n[material.Crome]\n",
            &[
                "3:1: error: material.\"Crome\": no import has a material of this name\n  hint: did you mean \"Chrome\"?",
                "warning: something was dropped",
            ],
        ),
        ("[material.Wood]\n", &["1:1: error: material.\"Wood\": no import has a material of this name"]),
        (
            "[[import]]\nfile = \"a.glb\"\n[material.\"*\"]\nroughness = 1.5\nroughnes = 1\nbase_color = [1, 0]\n",
            &[
                "4:13: error: material.\"*\".roughness: must be at least 0 and at most 1, is 1.5",
                "5:1: error: material.\"*\".roughnes: unknown key\n  hint: did you mean \"roughness\"?",
                "6:14: error: material.\"*\".base_color: expected a list of 3 numbers, found 2",
                "warning: something was dropped",
            ],
        ),
        (
            "[[import]]\nfile = \"a.glb\"\n[material.\"*\"]\nalpha_cutoff = 0.2\n",
            &[
                "4:16: error: material.\"*\".alpha_cutoff: needs alpha_mode = \"mask\" beside it",
                "warning: something was dropped",
            ],
        ),
        (
            "[[import]]\nfile = \"a.glb\"\n[material.\"*\"]\nroughness_texture = { chanel = \"g\" }\n",
            &[
                "4:21: error: material.\"*\".roughness_texture.file: is missing",
                "4:23: error: material.\"*\".roughness_texture.chanel: unknown key\n  hint: did you mean \"channel\"?",
                "warning: something was dropped",
            ],
        ),
    ];
    let mut failed = 0;
    for (toml, expected) in CASES {
        let said = wrong(toml, &["a.glb", "bad.glb"]);
        if said != *expected {
            println!("{toml}\n  said     {said:#?}\n  expected {expected:#?}");
            failed += 1;
        }
    }
    assert_eq!(failed, 0, "of {} cases", CASES.len());
}

#[test]
fn not_text() {
    let folder = super::folder("", &[]);
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, b"[render]\n# \xff\n").unwrap();
    let errors = super::load(&ImportRequest::new(&path), &Overrides::default(), &super::import).unwrap_err();
    assert_eq!(errors[0].to_string(), format!("{}:2:3: error: is not text in UTF-8", path.display()));
    let errors = super::load(
        &ImportRequest::new(folder.path().join("none.toml")),
        &Overrides::default(),
        &super::import,
    )
    .unwrap_err();
    assert!(errors[0].to_string().contains("none.toml: error: cannot be read"), "{}", errors[0]);
}

/// Deep nesting, lone brackets, control characters: an error each, never a crash.
#[test]
fn hostile() {
    for toml in [
        &"[".repeat(100_000),
        &format!("a = {}", "[".repeat(100_000)),
        &"a.".repeat(50_000),
        "\0",
        "\u{feff}[[camera]",
        "[[camera]]\nposition = [1979-05-27, 1, 2]",
        "[material]\nx = 1",
        "import = [[]]",
        "\"\\u0000\" = 1",
    ] {
        assert!(!wrong(toml, &[]).is_empty());
    }
}
