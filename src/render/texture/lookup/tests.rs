use super::*;

fn texture() -> ajar_scene::Texture {
    ajar_scene::Texture::new(ajar_scene::Id::new(0))
}

/// Two by two raw floats, 10 20 over 30 60.
fn read(texture: &ajar_scene::Texture) -> Texture {
    let bitmap = Bitmap::new(2, 2, 1, Texels::F32(vec![10.0, 20.0, 30.0, 60.0])).unwrap();
    Texture::new(Arc::new(bitmap), texture)
}

fn red(texture: &Texture, u: f32, v: f32) -> f32 {
    texture.sample([u, v]).x
}

#[test]
fn texel_centres_are_at_half_integers() {
    for filter in [Filter::Linear, Filter::Nearest] {
        let t = read(&ajar_scene::Texture { filter, ..texture() });
        for (u, v, value) in [(0.25, 0.25, 10.0), (0.75, 0.25, 20.0), (0.25, 0.75, 30.0), (0.75, 0.75, 60.0)]
        {
            assert_eq!(red(&t, u, v), value);
        }
    }
    let t = read(&texture());
    assert_eq!(red(&t, 0.5, 0.25), 15.0);
    assert_eq!(red(&t, 0.5, 0.5), 30.0);
    assert_eq!(red(&t, 0.375, 0.5), 0.75 * 20.0 + 0.25 * 40.0);
    let nearest = read(&ajar_scene::Texture { filter: Filter::Nearest, ..texture() });
    assert_eq!((red(&nearest, 0.499, 0.0), red(&nearest, 0.5, 0.0)), (10.0, 20.0));
}

#[test]
fn wraps_meet_at_the_edges_as_they_should() {
    let along_u = |wrap, filter| {
        let t = read(&ajar_scene::Texture { wrap_u: wrap, wrap_v: Wrap::Clamp, filter, ..texture() });
        [-1.25, -0.25, 0.0, 1.0, 1.25, 1.75, 2.25].map(|u| red(&t, u, 0.0))
    };
    use Filter::{Linear, Nearest};
    assert_eq!(along_u(Wrap::Repeat, Linear), [20.0, 20.0, 15.0, 15.0, 10.0, 20.0, 10.0]);
    assert_eq!(along_u(Wrap::Mirror, Linear), [20.0, 10.0, 10.0, 20.0, 20.0, 10.0, 10.0]);
    assert_eq!(along_u(Wrap::Clamp, Linear), [10.0, 10.0, 10.0, 20.0, 20.0, 20.0, 20.0]);
    assert_eq!(along_u(Wrap::Black, Linear), [0.0, 0.0, 5.0, 10.0, 0.0, 0.0, 0.0]);
    assert_eq!(along_u(Wrap::Repeat, Nearest), [20.0, 20.0, 10.0, 10.0, 10.0, 20.0, 10.0]);
    assert_eq!(along_u(Wrap::Mirror, Nearest), [20.0, 10.0, 10.0, 20.0, 20.0, 10.0, 10.0]);
    assert_eq!(along_u(Wrap::Black, Nearest), [0.0, 0.0, 10.0, 0.0, 0.0, 0.0, 0.0]);
    let v = read(&ajar_scene::Texture { wrap_u: Wrap::Clamp, wrap_v: Wrap::Mirror, ..texture() });
    assert_eq!((red(&v, 0.0, -0.75), red(&v, 0.0, 1.75)), (30.0, 10.0));
    let black = read(&ajar_scene::Texture { wrap_v: Wrap::Black, ..texture() });
    assert_eq!(black.sample([0.25, -3.0]), Vec4::ZERO);
}

#[test]
fn extreme_coordinates_are_safe() {
    for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp, Wrap::Black] {
        for filter in [Filter::Linear, Filter::Nearest] {
            let t = read(&ajar_scene::Texture { wrap_u: wrap, wrap_v: wrap, filter, ..texture() });
            for u in [f32::NAN, f32::INFINITY, -f32::INFINITY, f32::MAX, -1e30, -1e-30, 1.0 - 1e-7, 3.4e7] {
                for v in [u, 0.3] {
                    assert!((0.0..=60.0).contains(&red(&t, u, v)), "{wrap:?} {u} {v}");
                }
            }
        }
    }
}

#[test]
fn transform_scale_and_bias_apply() {
    // KHR_texture_transform: M = T·R·S.
    let transform = Affine2::from_scale_angle_translation(Vec2::splat(0.5), 0.0, Vec2::new(0.5, 0.25));
    let t = read(&ajar_scene::Texture {
        transform,
        scale: Vec4::new(2.0, 1.0, 1.0, 0.5),
        bias: Vec4::new(-1.0, 0.0, 7.0, 0.0),
        ..texture()
    });
    assert_eq!(t.sample([0.5, 0.0]), Vec4::new(39.0, 20.0, 27.0, 0.5));
    assert_eq!(t.average(), Vec4::new(59.0, 30.0, 37.0, 0.5));
    assert_eq!(t.texel(1, 1), Vec4::new(119.0, 60.0, 67.0, 0.5));
    assert_eq!(t.at([0.75, 0.25]), Vec4::new(39.0, 20.0, 27.0, 0.5));
    assert_eq!(t.wrapping(Wrap::Clamp, Wrap::Clamp).at([9.0, 9.0]).y, 60.0);
}

#[test]
fn srgb_is_decoded_before_filtering_and_never_in_alpha() {
    let bytes = Bitmap::new(2, 1, 4, Texels::U8(vec![0, 0, 0, 0, 255, 188, 128, 128])).unwrap();
    let read = |color_space| {
        Texture::new(
            Arc::new(bytes.clone()),
            &ajar_scene::Texture { color_space, wrap_u: Wrap::Clamp, ..texture() },
        )
    };
    let srgb = read(ColorSpace::Srgb);
    // 188 and 128 are 0.50289 and 0.21586 in linear light.
    let right = Vec4::new(1.0, 0.502_886, 0.215_861, 128.0 / 255.0);
    assert!((srgb.sample([1.0, 0.5]) - right).length() < 1e-5);
    assert!((srgb.sample([0.5, 0.5]) - right / 2.0).length() < 1e-5);
    assert_eq!(read(ColorSpace::Auto).sample([0.4, 0.5]), srgb.sample([0.4, 0.5]));
    assert!((read(ColorSpace::Raw).sample([1.0, 0.5]).y - 188.0 / 255.0).abs() < 1e-6);
}

#[test]
fn automatic_colour_space_looks_at_width_and_channels() {
    let auto = ajar_scene::Texture { color_space: ColorSpace::Auto, ..texture() };
    let middle = |channels, texels| {
        Texture::new(Arc::new(Bitmap::new(1, 1, channels, texels).unwrap()), &auto).sample([0.5, 0.5]).x
    };
    assert!((middle(3, Texels::U8(vec![128; 3])) - 0.2159).abs() < 1e-4);
    assert!((middle(1, Texels::U8(vec![128])) - 0.502).abs() < 1e-3);
    assert!((middle(2, Texels::U8(vec![128; 2])) - 0.502).abs() < 1e-3);
    assert!((middle(3, Texels::U16(vec![32768; 3])) - 0.5).abs() < 1e-4);
    assert_eq!(middle(3, Texels::F32(vec![0.5; 3])), 0.5);
}
