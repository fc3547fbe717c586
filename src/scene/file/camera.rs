//! `[[camera]]`.

use std::{collections::BTreeSet, ops::Bound};

use glam::DAffine3;

use super::{
    keys::Keys,
    placement,
    report::{Complaint, advice},
    value::{POSITIVE, number, text},
};
use crate::{Camera, Node, Projection, Scene};

/// Vertical angle where nothing says another, degrees.
const YFOV: f32 = 40.0;

/// The keys that only a perspective camera has.
const PERSPECTIVE: [&str; 4] = ["yfov", "lens_radius", "focus_distance", "shift"];

/// Reads a camera and adds its node. `index` counts from 0; `names` are those of the cameras before it. `complete` says
/// that all imports were read, so that a camera to copy that is not there is the file's mistake.
pub(super) fn read(
    mut keys: Keys<'_>,
    index: usize,
    scene: &mut Scene,
    names: &mut BTreeSet<String>,
    complete: bool,
) {
    let name = keys.optional("name", text).unwrap_or_else(|| format!("camera {}", index + 1));
    if !names.insert(name.clone()) {
        keys.complain("name", Complaint::new("another camera has this name"));
    }
    let (base, place) = copied(&mut keys, scene, complete).unwrap_or_else(|| (default(), DAffine3::IDENTITY));
    let (transform, distance) = placement::camera(&mut keys, place);
    let exposure = keys.optional("exposure", number(0.0..)).map_or(base.exposure, |exposure| exposure as f32);
    let said = PERSPECTIVE.into_iter().filter(|key| keys.has(key)).collect::<Vec<_>>();
    let half_height = keys.optional("half_height", number(POSITIVE)).map(|half| half as f32);
    if half_height.is_some() {
        for key in &said {
            let why = "belongs to a perspective camera, cannot go with \"half_height\"";
            keys.complain(key, Complaint::new(why));
        }
    }
    let perspective = perspective(&mut keys, &base, distance);
    keys.finish();
    let projection = match (half_height, base.projection) {
        (Some(half_height), _) => Projection::Orthographic { half_height },
        (None, kept @ Projection::Orthographic { .. }) if said.is_empty() => kept,
        (None, _) => perspective,
    };
    let camera = scene.cameras.push(Camera { name: name.clone(), projection, aspect: base.aspect, exposure });
    scene.add_root(Node { name, transform, camera: Some(camera), ..Node::default() });
}

/// The camera that `copy` names, with its place in the world.
fn copied(keys: &mut Keys<'_>, scene: &Scene, complete: bool) -> Option<(Camera, DAffine3)> {
    let name = keys.optional("copy", text)?;
    let placed = scene.placed();
    let cameras =
        || placed.iter().filter_map(|placed| Some((scene.cameras.get(placed.node.camera?)?, placed)));
    let found = cameras().find(|(camera, placed)| camera.name == name || placed.node.name == name);
    if found.is_none() && complete {
        let names = cameras().map(|(camera, _)| camera.name.as_str());
        keys.complain("copy", Complaint::new("no camera has this name").hint(advice(&name, names)));
    }
    found.map(|(camera, placed)| (camera.clone(), placed.world))
}

fn default() -> Camera {
    let projection = Projection::Perspective {
        yfov: YFOV.to_radians(),
        lens_radius: 0.0,
        focus_distance: 1.0,
        shift: [0.0, 0.0],
    };
    Camera { name: String::new(), projection, aspect: None, exposure: 1.0 }
}

/// A perspective projection; what is not said is as in `base`. The lens focuses on the target where there is one.
fn perspective(keys: &mut Keys<'_>, base: &Camera, target: Option<f64>) -> Projection {
    let (mut yfov, mut lens_radius, mut focus_distance, mut shift) = match base.projection {
        Projection::Perspective { yfov, lens_radius, focus_distance, shift } => {
            (yfov, lens_radius, focus_distance, shift)
        }
        Projection::Orthographic { .. } => (YFOV.to_radians(), 0.0, 1.0, [0.0, 0.0]),
    };
    let angles = (Bound::Excluded(0.0), Bound::Excluded(180.0));
    yfov = keys.optional("yfov", number(angles)).map_or(yfov, |degrees| degrees.to_radians() as f32);
    lens_radius = keys.optional("lens_radius", number(0.0..)).map_or(lens_radius, |radius| radius as f32);
    focus_distance = target.map_or(focus_distance, |distance| distance as f32);
    focus_distance =
        keys.optional("focus_distance", number(POSITIVE)).map_or(focus_distance, |distance| distance as f32);
    shift = keys.optional("shift", placement::pair).unwrap_or(shift);
    Projection::Perspective { yfov, lens_radius, focus_distance, shift }
}
