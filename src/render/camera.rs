//! Cameras: raster positions to rays, and points to raster positions.
//!
//! Measures (mlt.md §1.2 of the design; Veach 1997, §8.3.2 for importance): the lens vertex is described by a uniform
//! point `lens` in [0, 1)², so its density is 1, and importance is normalized such that uniform raster positions have
//! throughput 1. Then *one* number describes the edge to the camera: [`Connection::importance`], the density of the
//! visible point per unit area perpendicular to the edge. It is both `We·cos/r²` and the density of an eye subpath.

use ajar_scene as scene;
use glam::{DAffine3, DVec2, DVec3};

use crate::{math::Frame, warp};

/// A camera with its film.
#[derive(Clone, Debug)]
pub struct Camera {
    /// Film width in pixels.
    pub width: u32,
    /// Film height in pixels.
    pub height: u32,
    /// Multiplies what the film receives.
    pub exposure: f64,
    origin: DVec3,
    frame: Frame,
    /// Half extents of the image: at distance 1 (perspective) or in metres (orthographic).
    half: DVec2,
    centre: DVec2,
    lens: Lens,
}

#[derive(Clone, Copy, Debug)]
enum Lens {
    Pinhole,
    Thin { radius: f64, focus: f64 },
    Parallel,
}

/// A ray into the scene.
#[derive(Clone, Copy, Debug)]
pub struct CameraRay {
    /// Start: on the lens, or on the film plane of an orthographic camera.
    pub origin: DVec3,
    /// Unit direction into the scene.
    pub direction: DVec3,
}

/// How a point sees the camera through a given lens point.
#[derive(Clone, Copy, Debug)]
pub struct Connection {
    /// The point on the lens.
    pub lens: DVec3,
    /// Unit direction from the point to the lens.
    pub direction: DVec3,
    /// Distance between them.
    pub distance: f64,
    /// Raster position in pixels.
    pub raster: DVec2,
    /// Density of the point per unit area perpendicular to the edge, 1/m².
    pub importance: f64,
}

impl Camera {
    /// Places `camera` by `to_world` (its scale is ignored) before a film of `width` × `height` pixels. The vertical
    /// extent of the view is kept, but where the film is narrower than the view was composed for: there it grows until
    /// the composed width is seen.
    pub fn new(camera: &scene::Camera, to_world: &DAffine3, width: u32, height: u32) -> Self {
        let z = to_world.transform_vector3(DVec3::Z).normalize_or(DVec3::Z);
        let y = to_world.transform_vector3(DVec3::Y);
        let x = y.cross(z).try_normalize().unwrap_or_else(|| Frame::from_z(z).x);
        let aspect = f64::from(width) / f64::from(height);
        let (half_height, shift, lens) = match camera.projection {
            scene::Projection::Perspective { yfov, lens_radius, focus_distance, shift } => {
                let lens = if lens_radius > 0.0 {
                    Lens::Thin { radius: lens_radius.into(), focus: focus_distance.into() }
                } else {
                    Lens::Pinhole
                };
                ((f64::from(yfov) / 2.0).tan(), shift, lens)
            }
            scene::Projection::Orthographic { half_height } => {
                (f64::from(half_height), [0.0; 2], Lens::Parallel)
            }
        };
        let narrow = camera.aspect.map_or(1.0, |composed| (f64::from(composed) / aspect).max(1.0));
        let (visible, centre) = (half_height * narrow, shift.map(|it| f64::from(it) * half_height));
        Self {
            width,
            height,
            exposure: camera.exposure.into(),
            origin: to_world.translation,
            frame: Frame { x, y: z.cross(x), z },
            half: DVec2::new(visible * aspect, visible),
            centre: DVec2::from(centre),
            lens,
        }
    }

    /// Number of pixels.
    pub fn pixels(&self) -> usize {
        self.width as usize * self.height as usize
    }

    /// Point of the image plane (at distance 1, or in metres) for a raster position.
    fn image_point(&self, raster: DVec2) -> DVec2 {
        let ndc = DVec2::new(
            2.0 * raster.x / f64::from(self.width) - 1.0,
            1.0 - 2.0 * raster.y / f64::from(self.height),
        );
        ndc * self.half + self.centre
    }

    /// Raster position of a point of the image plane, if it is on the film.
    fn raster(&self, image: DVec2) -> Option<DVec2> {
        let ndc = (image - self.centre) / self.half;
        let size = DVec2::new(self.width.into(), self.height.into());
        let raster = DVec2::new(ndc.x + 1.0, 1.0 - ndc.y) * 0.5 * size;
        let on_film = raster.x >= 0.0 && raster.y >= 0.0 && raster.x < size.x && raster.y < size.y;
        on_film.then_some(raster)
    }

    fn lens_offset(&self, radius: f64, lens: [f64; 2]) -> DVec2 {
        warp::square_to_disc(lens) * radius
    }

    /// The ray of a raster position (pixels) through the lens point `lens` ∈ [0, 1)².
    #[inline]
    pub fn ray(&self, raster: DVec2, lens: [f64; 2]) -> CameraRay {
        let image = self.image_point(raster);
        let (from, to) = match self.lens {
            Lens::Pinhole => (DVec2::ZERO, image.extend(-1.0)),
            Lens::Thin { radius, focus } => {
                let from = self.lens_offset(radius, lens);
                (from, (image * focus - from).extend(-focus))
            }
            Lens::Parallel => (image, DVec3::NEG_Z),
        };
        CameraRay {
            origin: self.origin + self.frame.to_world(from.extend(0.0)),
            direction: self.frame.to_world(to).normalize(),
        }
    }

    /// How `p` sees the camera through the lens point `lens` ∈ [0, 1)²; `None` behind the camera or off the film.
    pub fn connect(&self, p: DVec3, lens: [f64; 2]) -> Option<Connection> {
        let local = self.frame.to_local(p - self.origin);
        let depth = -local.z;
        if depth <= 0.0 || depth.is_nan() {
            return None;
        }
        let (from, image) = match self.lens {
            Lens::Pinhole => (DVec2::ZERO, local.truncate() / depth),
            Lens::Thin { radius, focus } => {
                let from = self.lens_offset(radius, lens);
                let in_focus = from + (local.truncate() - from) * (focus / depth);
                (from, in_focus / focus)
            }
            Lens::Parallel => (local.truncate(), local.truncate()),
        };
        let raster = self.raster(image)?;
        let to_lens = from.extend(0.0) - local;
        let distance = to_lens.length();
        let area = 4.0 * self.half.x * self.half.y;
        let importance = match self.lens {
            Lens::Parallel => 1.0 / area,
            Lens::Pinhole | Lens::Thin { .. } => {
                let cos = depth / distance;
                1.0 / (area * cos * cos * cos * distance * distance)
            }
        };
        Some(Connection {
            lens: self.origin + self.frame.to_world(from.extend(0.0)),
            direction: self.frame.to_world(to_lens / distance),
            distance,
            raster,
            importance,
        })
    }

    /// Whether all rays are parallel.
    pub fn is_orthographic(&self) -> bool {
        matches!(self.lens, Lens::Parallel)
    }

    /// Native density of a ray with unit `direction`: per solid angle, or per area of the film plane where all rays are
    /// parallel.
    pub fn direction_density(&self, direction: DVec3) -> f64 {
        let area = 4.0 * self.half.x * self.half.y;
        match self.lens {
            Lens::Parallel => 1.0 / area,
            Lens::Pinhole | Lens::Thin { .. } => 1.0 / (area * (-self.frame.z.dot(direction)).powi(3)),
        }
    }

    /// Depth of `p` along the optical axis, metres.
    pub fn depth(&self, p: DVec3) -> f64 {
        -self.frame.to_local(p - self.origin).z
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        chi2::{DISC_CELLS, disc_cell, p_value_of_even},
        rng::{Purpose, Rng},
    };

    fn camera(projection: scene::Projection) -> Camera {
        let camera = scene::Camera { name: String::new(), projection, aspect: None, exposure: 1.0 };
        let place = DAffine3::from_translation(DVec3::new(1.0, 2.0, 3.0)) * DAffine3::from_rotation_y(0.4);
        Camera::new(&camera, &place, 64, 48)
    }

    fn all() -> Vec<Camera> {
        let perspective = |lens_radius, shift| {
            camera(scene::Projection::Perspective { yfov: 0.9, lens_radius, focus_distance: 3.0, shift })
        };
        vec![
            perspective(0.0, [0.0; 2]),
            perspective(0.0, [0.4, -0.2]),
            perspective(0.1, [0.0; 2]),
            camera(scene::Projection::Orthographic { half_height: 2.0 }),
        ]
    }

    #[test]
    fn points_on_rays_connect_back_to_their_raster_position() {
        let mut rng = Rng::new(1, Purpose::Test, 0, 0);
        for camera in all() {
            for _ in 0..1000 {
                let raster = DVec2::new(rng.f64() * 64.0, rng.f64() * 48.0);
                let lens = rng.pair();
                let ray = camera.ray(raster, lens);
                let p = ray.origin + ray.direction * (0.5 + 5.0 * rng.f64());
                let back = camera.connect(p, lens).expect("on film");
                assert!((back.raster - raster).length() < 1e-9);
                assert!((back.direction + ray.direction).length() < 1e-12);
            }
        }
    }

    /// Rays of one raster position fill the lens evenly and meet in the plane in focus.
    #[test]
    fn rays_start_evenly_over_the_lens() {
        const SAMPLES: u32 = 100_000;
        let (radius, focus) = (0.25, 3.0);
        let camera = camera(scene::Projection::Perspective {
            yfov: 0.9,
            lens_radius: radius as f32,
            focus_distance: focus as f32,
            shift: [0.0; 2],
        });
        let (mut rng, raster) = (Rng::new(2, Purpose::Test, 0, 0), DVec2::new(11.0, 37.0));
        let in_focus = camera.image_point(raster).extend(-1.0) * focus;
        let mut on_lens = || {
            let ray = camera.ray(raster, rng.pair());
            let from = camera.frame.to_local(ray.origin - camera.origin);
            let direction = camera.frame.to_local(ray.direction);
            assert!((from - direction * (focus / direction.z) - in_focus).length() < 1e-12);
            assert!(from.z.abs() < 1e-12 && from.length() < radius + 1e-12);
            from.truncate() / radius
        };
        let p = p_value_of_even(DISC_CELLS, SAMPLES, || disc_cell(on_lens()));
        assert!(p > 1e-4, "{p}");
        // Teeth: a little too much of the middle of the lens.
        let p = p_value_of_even(DISC_CELLS, SAMPLES, || {
            let p = on_lens();
            disc_cell(p * p.length().powf(0.05))
        });
        assert!(p < 1e-4, "{p}");
    }

    #[test]
    fn a_film_of_another_shape_shows_all_that_was_composed() {
        let projection = scene::Projection::Perspective {
            yfov: 0.9,
            lens_radius: 0.0,
            focus_distance: 1.0,
            shift: [0.0; 2],
        };
        let camera = scene::Camera { name: String::new(), projection, aspect: Some(2.0), exposure: 1.0 };
        let shown = |width, height| {
            let camera = Camera::new(&camera, &DAffine3::IDENTITY, width, height);
            let corner = camera.ray(DVec2::ZERO, [0.5; 2]).direction;
            (corner / -corner.z).truncate().abs()
        };
        let composed = DVec2::new(2.0, 1.0) * 0.45_f64.tan();
        assert!((shown(64, 32) - composed).length() < 1e-7);
        assert!((shown(32, 32) - composed.x).length() < 1e-7, "a narrow film shows the width");
        assert!((shown(96, 32) - DVec2::new(1.5 * composed.x, composed.y)).length() < 1e-7);
    }

    #[test]
    fn importance_is_the_density_of_visible_points() {
        // A raster square of side e maps to an area e²/(W·H)/importance perpendicular to the ray.
        for camera in all() {
            let (raster, lens, e) = (DVec2::new(11.0, 37.0), [0.3, 0.8], 1e-4);
            let normal = camera.ray(raster, lens).direction;
            let start = camera.ray(raster, lens).origin + normal * 4.0;
            let meet = |r: DVec2| {
                let ray = camera.ray(r, lens);
                ray.origin + ray.direction * ((start - ray.origin).dot(normal) / ray.direction.dot(normal))
            };
            let (dx, dy) = (meet(raster + DVec2::X * e) - start, meet(raster + DVec2::Y * e) - start);
            let area = dx.cross(dy).length();
            let found = camera.connect(start, lens).expect("on film").importance;
            assert!((found * area * 64.0 * 48.0 / (e * e) - 1.0).abs() < 1e-3);
        }
    }
}
