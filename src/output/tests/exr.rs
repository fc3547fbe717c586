//! What is written to an EXR is what an independent look at the file finds.

#![allow(clippy::unwrap_used, reason = "a failing test panics")]

use std::{
    fs,
    path::Path,
    time::{Duration, SystemTime},
};

use ajar_output::{
    BlockVariances, CameraMatrices, Channel, Layer, Metadata, OutputError, Picture, Precision, write_exr,
};
use exr::prelude::{AttributeValue, FlatImage, FlatSamples, Text, Vec2, f16, read_all_flat_layers_from_file};

const WIDTH: u32 = 5;
const HEIGHT: u32 = 3;
const PIXELS: usize = (WIDTH * HEIGHT) as usize;

fn ramp(scale: f32) -> Vec<f32> {
    (0..PIXELS).map(|i| i as f32 * scale).collect()
}

fn layer(name: &str, channels: &[&str], precision: Precision) -> Layer {
    let channel = |name: &&str| Channel { name: (*name).into(), samples: ramp(0.1) };
    Layer { name: name.into(), precision, channels: channels.iter().map(channel).collect() }
}

fn picture() -> Picture {
    Picture {
        width: WIDTH,
        height: HEIGHT,
        offset: (4, 2),
        full_size: (20, 10),
        layers: vec![
            layer("", &["R", "G", "B", "A"], Precision::Half),
            layer("albedo", &["R", "G", "B"], Precision::Half),
            layer("N", &["X", "Y", "Z"], Precision::Half),
            layer("", &["Z", "objectId"], Precision::Float),
        ],
        metadata: Metadata {
            camera: Some(CameraMatrices {
                world_to_camera: std::array::from_fn(|i| std::array::from_fn(|j| (4 * i + j) as f32)),
                world_to_ndc: [[0.5; 4]; 4],
            }),
            captured: Some(SystemTime::UNIX_EPOCH + Duration::from_secs(1_709_251_199)),
            render_seconds: 61.5,
            samples_per_pixel: 64,
            seed: u64::MAX,
            rounds: 12,
            integrator: "mlt".into(),
            scene_hash: "5ce2e".into(),
            mutations_per_sample: Some(3.5),
            noise: Some(0.25),
            complete: true,
            black: true,
            shard: Some((2, 8)),
            comment: Some("changed: box.mtl".into()),
            block_variances: vec![
                BlockVariances { side: Some(8), values: vec![0.5, 0.25, 1.0] },
                BlockVariances { side: None, values: vec![0.1, 0.2, 0.3] },
            ],
        },
    }
}

fn written(picture: &Picture) -> FlatImage {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.exr");
    assert_eq!(write_exr(&path, picture).unwrap(), []);
    read_all_flat_layers_from_file(path).unwrap()
}

fn samples<'a>(image: &'a FlatImage, name: &str) -> &'a FlatSamples {
    let channels = &image.layer_data[0].channel_data.list;
    &channels.iter().find(|channel| channel.name == *name).unwrap().sample_data
}

#[test]
fn windows_names_and_types_are_kept() {
    let image = written(&picture());
    assert_eq!(image.layer_data.len(), 1, "one part");
    let part = &image.layer_data[0];
    assert_eq!(part.size, Vec2(5, 3));
    assert_eq!(part.attributes.layer_position, Vec2(4, 2));
    assert_eq!(image.attributes.display_window.position, Vec2(0, 0));
    assert_eq!(image.attributes.display_window.size, Vec2(20, 10));
    assert_eq!(part.attributes.layer_name, None);

    let mut names: Vec<_> = part.channel_data.list.iter().map(|channel| channel.name.to_string()).collect();
    names.sort();
    let expected = "A B G N.X N.Y N.Z R Z albedo.B albedo.G albedo.R objectId";
    assert_eq!(names.join(" "), expected);

    let halves: Vec<_> = ramp(0.1).into_iter().map(f16::from_f32).collect();
    assert_eq!(samples(&image, "albedo.G"), &FlatSamples::F16(halves));
    assert_eq!(samples(&image, "Z"), &FlatSamples::F32(ramp(0.1)));
}

/// OpenEXR's `floatvector`.
fn floats(values: &[f32]) -> AttributeValue {
    let bytes = values.iter().flat_map(|value| value.to_le_bytes()).collect();
    AttributeValue::Custom { kind: "floatvector".into(), bytes }
}

#[test]
fn metadata_is_kept() {
    let image = written(&picture());
    let attributes = &image.layer_data[0].attributes;
    let text = |value: &str| Some(Text::from(value));
    assert_eq!(attributes.software_name, text("ajar 0.1.0"));
    assert_eq!(attributes.capture_date, text("2024:02:29 23:59:59"));
    assert_eq!(attributes.utc_offset, Some(0.0));
    assert_eq!(attributes.world_to_camera, Some(std::array::from_fn(|i| i as f32)));
    assert_eq!(attributes.world_to_normalized_device, Some([0.5; 16]));
    assert_eq!(attributes.owner, None);
    assert_eq!(image.attributes.chromaticities.unwrap().green, Vec2(0.3, 0.6));

    for (name, value) in [
        ("renderTime", AttributeValue::Text("00:01:01.50".into())),
        ("renderTimeSeconds", AttributeValue::F32(61.5)),
        ("samplesPerPixel", AttributeValue::I32(64)),
        ("colorInteropID", AttributeValue::Text("lin_rec709_scene".into())),
        ("ajar:seed", AttributeValue::Text("18446744073709551615".into())),
        ("ajar:rounds", AttributeValue::I32(12)),
        ("ajar:integrator", AttributeValue::Text("mlt".into())),
        ("ajar:sceneHash", AttributeValue::Text("5ce2e".into())),
        ("ajar:mutationsPerSample", AttributeValue::F32(3.5)),
        ("ajar:noise", AttributeValue::F32(0.25)),
        ("ajar:complete", AttributeValue::I32(1)),
        ("ajar:black", AttributeValue::I32(1)),
        ("ajar:shard", AttributeValue::Text("2/8".into())),
        ("ajar:blockVariance8", floats(&[0.5, 0.25, 1.0])),
        ("ajar:imageVariance", floats(&[0.1, 0.2, 0.3])),
    ] {
        assert_eq!(attributes.other.get(&Text::from(name)), Some(&value), "{name}");
    }
}

#[test]
fn what_is_unknown_is_left_out() {
    let image = written(&Picture { metadata: Metadata::default(), ..picture() });
    let attributes = &image.layer_data[0].attributes;
    assert_eq!(attributes.capture_date, None);
    assert_eq!(attributes.world_to_camera, None);
    for name in ["ajar:mutationsPerSample", "ajar:noise", "ajar:shard"] {
        assert!(!attributes.other.contains_key(&Text::from(name)), "{name}");
    }
}

#[test]
fn equal_pictures_give_equal_bytes_with_sorted_attributes() {
    let folder = tempfile::tempdir().unwrap();
    let bytes = |name: &str| {
        let path = folder.path().join(name);
        write_exr(&path, &picture()).unwrap();
        fs::read(path).unwrap()
    };
    let first = bytes("0.exr");
    for name in ["1.exr", "2.exr", "3.exr"] {
        assert!(first == bytes(name), "{name} differs");
    }
    let position =
        |name: &str| first.windows(name.len()).position(|window| window == name.as_bytes()).unwrap();
    let sorted =
        ["ajar:complete\0", "ajar:seed\0", "channels\0", "dataWindow\0", "software\0", "worldToNDC\0"];
    assert!(sorted.is_sorted_by_key(|name| position(name)));
}

#[test]
fn highlights_beyond_half_widen_their_layer() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.exr");
    let mut bright = picture();
    let mut values = ramp(0.1);
    values[7] = -70_000.0;
    bright.layers[0].channels[1].samples = values.clone();

    let notes = write_exr(&path, &bright).unwrap();
    assert_eq!(notes.len(), 1);
    assert_eq!((notes[0].layer.as_str(), notes[0].peak), ("", 70_000.0));
    assert!(notes[0].to_string().contains("the beauty layer"), "{}", notes[0]);

    let image = read_all_flat_layers_from_file(&path).unwrap();
    assert_eq!(samples(&image, "G"), &FlatSamples::F32(values));
    assert_eq!(samples(&image, "R"), &FlatSamples::F32(ramp(0.1)));
    assert!(matches!(samples(&image, "albedo.R"), FlatSamples::F16(_)));
}

/// 65519 still rounds down to half's largest number.
#[test]
fn halfs_largest_number_is_no_overflow() {
    let mut bright = picture();
    bright.layers[0].channels[0].samples = vec![65_519.0; PIXELS];
    let image = written(&bright);
    assert_eq!(samples(&image, "R"), &FlatSamples::F16(vec![f16::MAX; PIXELS]));
}

fn refused(path: &Path, picture: &Picture) -> OutputError {
    fs::write(path, "old").unwrap();
    let error = write_exr(path, picture).unwrap_err();
    assert_eq!(fs::read_to_string(path).unwrap(), "old");
    assert_eq!(fs::read_dir(path.parent().unwrap()).unwrap().count(), 1, "nothing is left behind");
    error
}

#[test]
fn broken_pictures_are_refused_and_the_old_file_stays() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.exr");

    let mut picture_with_nan = picture();
    let mut values = ramp(1.0);
    values[WIDTH as usize + 2] = f32::NAN;
    picture_with_nan.layers[1].channels[2].samples = values;
    let message = refused(&path, &picture_with_nan).to_string();
    assert_eq!(message, "channel `albedo.B` is NaN at pixel (2, 1)");

    let mut short = picture();
    short.layers[0].channels[0].samples = vec![0.0; PIXELS - 1];
    assert!(matches!(refused(&path, &short), OutputError::SampleCount { found: 14, expected: 15, .. }));

    let mut twice = picture();
    twice.layers.push(layer("albedo", &["R"], Precision::Float));
    assert!(matches!(refused(&path, &twice), OutputError::ChannelName(name) if name == "albedo.R"));

    let nul = Picture { layers: vec![layer("a\0b", &["R"], Precision::Half)], ..picture() };
    assert!(matches!(refused(&path, &nul), OutputError::ChannelName(_)));

    for full_size in [(0, 10), (u32::MAX, 10)] {
        assert!(matches!(refused(&path, &Picture { full_size, ..picture() }), OutputError::Size { .. }));
    }
}
