//! The camera's matrices as other programs expect them in an EXR.
//!
//! OpenEXR "Standard Attributes": camera space is left-handed, x right, y up, z *into* the view (Ajar's cameras look
//! along −Z); normalized device coordinates run from (0, 0) at the upper left to (1, 1) at the lower right corner of the
//! display window. Imath multiplies rows from the left, p′ = p·M, so the translation is in the last row: the layout of
//! `glam`'s columns.

use ajar_scene::{Camera, Projection};
use glam::{DAffine3, DMat4, DVec3, DVec4};

/// Where the camera stood. Each matrix is `[row][column]` for row vectors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraMatrices {
    /// World to the left-handed camera space, metres.
    pub world_to_camera: [[f32; 4]; 4],
    /// World to the display window; divide by w. z grows with the distance.
    pub world_to_ndc: [[f32; 4]; 4],
}

impl CameraMatrices {
    /// The matrices of `camera`, placed by `to_world` (its scale is ignored), for a full frame of `width` × `height`
    /// pixels. The vertical extent of the view is kept, whatever shape the frame has. A lens counts as a pinhole.
    pub fn new(camera: &Camera, to_world: &DAffine3, width: u32, height: u32) -> Self {
        let world_to_camera = world_to_camera(to_world);
        let aspect = f64::from(width) / f64::from(height);
        let camera_to_ndc = match camera.projection {
            Projection::Perspective { yfov, shift, .. } => {
                let half = (f64::from(yfov) / 2.0).tan();
                perspective(half * aspect, half, shift.map(|s| f64::from(s) * half))
            }
            Projection::Orthographic { half_height } => {
                let half = f64::from(half_height);
                orthographic(half * aspect, half)
            }
        };
        let rows = |matrix: DMat4| matrix.as_mat4().to_cols_array_2d();
        Self { world_to_camera: rows(world_to_camera), world_to_ndc: rows(camera_to_ndc * world_to_camera) }
    }
}

fn world_to_camera(to_world: &DAffine3) -> DMat4 {
    let into = to_world.transform_vector3(DVec3::NEG_Z).normalize_or(DVec3::NEG_Z);
    let up = to_world.transform_vector3(DVec3::Y);
    let right = into.cross(up).try_normalize().unwrap_or_else(|| into.any_orthonormal_vector());
    let up = right.cross(into);
    let from_camera = |axis: DVec3| axis.extend(0.0);
    let origin = to_world.translation.extend(1.0);
    DMat4::from_cols(from_camera(right), from_camera(up), from_camera(into), origin).inverse()
}

/// x/z and y/z of the image plane at distance 1 to [0, 1]; z becomes −1/z, which needs no near or far plane.
fn perspective(half_width: f64, half_height: f64, centre: [f64; 2]) -> DMat4 {
    DMat4::from_cols(
        DVec4::new(0.5 / half_width, 0.0, 0.0, 0.0),
        DVec4::new(0.0, -0.5 / half_height, 0.0, 0.0),
        DVec4::new(0.5 - 0.5 * centre[0] / half_width, 0.5 + 0.5 * centre[1] / half_height, 0.0, 1.0),
        DVec4::new(0.0, 0.0, -1.0, 0.0),
    )
}

fn orthographic(half_width: f64, half_height: f64) -> DMat4 {
    DMat4::from_cols(
        DVec4::new(0.5 / half_width, 0.0, 0.0, 0.0),
        DVec4::new(0.0, -0.5 / half_height, 0.0, 0.0),
        DVec4::new(0.0, 0.0, 1.0, 0.0),
        DVec4::new(0.5, 0.5, 0.0, 1.0),
    )
}

#[cfg(test)]
mod tests {
    use glam::DQuat;

    use super::*;

    /// Row vector times matrix, divided by w, as Imath's `multVecMatrix` does.
    fn times(p: DVec3, m: [[f32; 4]; 4]) -> DVec3 {
        let p = [p.x, p.y, p.z, 1.0];
        let column = |j: usize| (0..4).map(|i| p[i] * f64::from(m[i][j])).sum::<f64>();
        DVec3::new(column(0), column(1), column(2)) / column(3)
    }

    fn camera(projection: Projection) -> Camera {
        Camera { name: String::new(), projection, aspect: None, exposure: 1.0 }
    }

    fn placed() -> DAffine3 {
        let turn = DQuat::from_euler(glam::EulerRot::YXZ, 0.7, -0.4, 0.2);
        DAffine3::from_scale_rotation_translation(DVec3::splat(3.0), turn, DVec3::new(4.0, -2.0, 9.0))
    }

    #[test]
    fn camera_space_is_left_handed() {
        let lens = Projection::Orthographic { half_height: 1.0 };
        let matrices = CameraMatrices::new(&camera(lens), &placed(), 10, 10);
        let rigid = DAffine3::from_rotation_translation(
            DQuat::from_euler(glam::EulerRot::YXZ, 0.7, -0.4, 0.2),
            placed().translation,
        );
        for p in [DVec3::new(1.0, 2.0, -5.0), DVec3::ZERO, DVec3::new(-0.5, 0.3, 2.0)] {
            let seen = times(rigid.transform_point3(p), matrices.world_to_camera);
            assert!(seen.distance(p * DVec3::new(1.0, 1.0, -1.0)) < 1e-5, "{seen} for {p}");
        }
    }

    #[test]
    fn corners_of_the_view_are_corners_of_the_display_window() {
        let (width, height) = (200, 100);
        let yfov = 0.8_f32;
        let half = (f64::from(yfov) / 2.0).tan();
        let lens =
            Projection::Perspective { yfov, lens_radius: 0.0, focus_distance: 1.0, shift: [0.5, -0.25] };
        let matrices = CameraMatrices::new(&camera(lens), &placed(), width, height);
        let rigid = DAffine3::from_rotation_translation(
            DQuat::from_euler(glam::EulerRot::YXZ, 0.7, -0.4, 0.2),
            placed().translation,
        );
        // The view's centre lies half a half height to the right and a quarter down.
        for (x, y, ndc) in [(-2.0, 1.0, [0.0, 0.0]), (2.0, -1.0, [1.0, 1.0]), (0.0, 0.0, [0.5, 0.5])] {
            let direction = DVec3::new((x + 0.5) * half, (y - 0.25) * half, -1.0);
            for distance in [0.5, 7.0] {
                let seen = times(rigid.transform_point3(direction * distance), matrices.world_to_ndc);
                assert!(seen.truncate().distance(ndc.into()) < 1e-4, "{seen} for {x} {y}");
            }
        }
    }

    #[test]
    fn parallel_views_do_not_shrink() {
        let lens = Projection::Orthographic { half_height: 2.0 };
        let matrices = CameraMatrices::new(&camera(lens), &DAffine3::IDENTITY, 300, 100);
        for z in [-1.0, -50.0] {
            let seen = times(DVec3::new(-6.0, 2.0, z), matrices.world_to_ndc);
            assert!(seen.truncate().length() < 1e-6, "{seen}");
        }
    }
}
