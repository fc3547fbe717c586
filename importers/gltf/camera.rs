//! Cameras (specification, section 3.10): pinholes, and parallel projection whose magnifications are half extents.

use std::f32::consts::PI;

use ajar_scene::{Camera, Id, Projection, Scene};
use gltf::json::{Root, camera::Type, validation::Checked};

use super::Context;

/// The cameras by their index in the file; `None` for those that were dropped with a warning.
pub(super) fn cameras(root: &Root, context: &mut Context, scene: &mut Scene) -> Vec<Option<Id<Camera>>> {
    let mut made = Vec::with_capacity(root.cameras.len());
    for (i, camera) in root.cameras.iter().enumerate() {
        let element = format!("cameras[{i}]");
        let name = camera.name.clone().unwrap_or_else(|| element.clone());
        let view = view(camera);
        if view.is_none() {
            context
                .report
                .warn(&element, "the camera is dropped: its angle or size is missing or impossible");
        }
        made.push(view.map(|(projection, written)| {
            let aspect = written.filter(positive);
            if aspect != written {
                let message = "its width over its height is impossible; the shape of the image is used";
                context.report.approximate(element, message);
            }
            scene.cameras.push(Camera { name, projection, aspect, exposure: 1.0 })
        }));
    }
    made
}

fn positive(value: &f32) -> bool {
    value.is_finite() && *value > 0.0
}

/// Projection, and the aspect ratio as it is written.
fn view(camera: &gltf::json::Camera) -> Option<(Projection, Option<f32>)> {
    match camera.type_ {
        Checked::Valid(Type::Perspective) => {
            let view = camera.perspective.as_ref()?;
            let yfov = Some(view.yfov).filter(positive).filter(|angle| *angle < PI)?;
            let projection =
                Projection::Perspective { yfov, lens_radius: 0.0, focus_distance: 1.0, shift: [0.0; 2] };
            Some((projection, view.aspect_ratio))
        }
        Checked::Valid(Type::Orthographic) => {
            let view = camera.orthographic.as_ref()?;
            let half_height = Some(view.ymag).filter(positive)?;
            Some((Projection::Orthographic { half_height }, Some(view.xmag / half_height)))
        }
        Checked::Invalid => None,
    }
}
