//! `[[camera]]`.

use std::ops::Bound;

use super::{
    keys::Keys,
    placement,
    report::Complaint,
    value::{POSITIVE, number, text},
};
use crate::{Camera, Node, Projection, Scene};

/// Reads a camera and adds its node. `index` counts from 0.
pub(super) fn read(mut keys: Keys<'_>, index: usize, scene: &mut Scene) {
    let name = keys.optional("name", text).unwrap_or_else(|| format!("camera {}", index + 1));
    let (transform, distance) = placement::camera(&mut keys);
    let exposure = keys.optional("exposure", number(0.0..)).unwrap_or(1.0) as f32;
    let projection = if keys.has("half_height") {
        for key in ["yfov", "lens_radius", "focus_distance", "shift"].into_iter().filter(|key| keys.has(key))
        {
            keys.complain(
                key,
                Complaint::new("belongs to a perspective camera, cannot go with \"half_height\""),
            );
        }
        orthographic(&mut keys)
    } else {
        perspective(&mut keys, distance.unwrap_or(1.0))
    };
    keys.finish();
    let camera = scene.cameras.push(Camera { name: name.clone(), projection, aspect: None, exposure });
    scene.add_root(Node { name, transform, camera: Some(camera), ..Node::default() });
}

fn orthographic(keys: &mut Keys<'_>) -> Projection {
    let half_height = keys.optional("half_height", number(POSITIVE)).unwrap_or(1.0) as f32;
    // Already complained about: they are known keys, in the wrong company.
    for key in ["yfov", "lens_radius", "focus_distance", "shift"] {
        keys.optional(key, |_| Ok(()));
    }
    Projection::Orthographic { half_height }
}

fn perspective(keys: &mut Keys<'_>, target: f64) -> Projection {
    let angles = (Bound::Excluded(0.0), Bound::Excluded(180.0));
    let yfov = keys.optional("yfov", number(angles)).unwrap_or(40.0).to_radians() as f32;
    let lens_radius = keys.optional("lens_radius", number(0.0..)).unwrap_or(0.0) as f32;
    let focus_distance = keys.optional("focus_distance", number(POSITIVE)).unwrap_or(target) as f32;
    let shift = keys.optional("shift", placement::pair).unwrap_or([0.0, 0.0]);
    keys.optional("half_height", |_| Ok(()));
    Projection::Perspective { yfov, lens_radius, focus_distance, shift }
}
