use super::*;
use crate::description::UvTransform;

/// 2 x 2: black, white / red, half-transparent grey 128.
fn checker(wrap: Wrap, filtering: Filtering) -> Texture {
    let pixels = [
        [0, 0, 0, 255],
        [255, 255, 255, 255],
        [255, 0, 0, 255],
        [128, 128, 128, 128],
    ];
    let image = ImageData {
        name: "checker".to_owned(),
        width: 2,
        height: 2,
        pixels: Pixels::Rgba8(pixels.concat()),
        encoded: Vec::new(),
    };
    let description = TextureDescription {
        image: 0,
        wrap_s: wrap,
        wrap_t: wrap,
        filtering,
    };
    Texture::new(&description, Arc::new(image)).unwrap()
}

fn near(a: [f32; 4], b: [f32; 4]) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-5)
}

#[test]
fn texel_centres_are_exact_and_decoded() {
    for filtering in [Filtering::Linear, Filtering::Nearest] {
        let texture = checker(Wrap::Repeat, filtering);
        let at = |x, y| texture.sample(Vec2::new(x, y), Coding::Srgb);
        assert!(near(at(0.25, 0.25), [0.0, 0.0, 0.0, 1.0]));
        assert!(near(at(0.75, 0.25), [1.0, 1.0, 1.0, 1.0]));
        assert!(near(at(0.25, 0.75), [1.0, 0.0, 0.0, 1.0]));
        // sRGB 128 is 0.2158605 linear; alpha is linear
        let grey = 0.215_860_5;
        assert!(near(at(0.75, 0.75), [grey, grey, grey, 128.0 / 255.0]));
        let linear = texture.sample(Vec2::splat(0.75), Coding::Linear);
        assert!(near(linear, [128.0 / 255.0; 4]));
    }
}

#[test]
fn bilinear_is_linear_in_light_and_wraps() {
    let middle =
        |wrap, x| checker(wrap, Filtering::Linear).sample(Vec2::new(x, 0.25), Coding::Srgb)[0];
    for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
        assert!((middle(wrap, 0.5) - 0.5).abs() < 1e-6);
    }
    // at the left edge a repeated image mixes with its right column
    assert!((middle(Wrap::Repeat, 0.0) - 0.5).abs() < 1e-6);
    assert!(middle(Wrap::Mirror, 0.0).abs() < 1e-6);
    assert!(middle(Wrap::Clamp, -3.0).abs() < 1e-6);
    assert!((middle(Wrap::Clamp, 3.0) - 1.0).abs() < 1e-6);
    // one copy further: the same, or mirrored
    assert!(middle(Wrap::Repeat, 1.25).abs() < 1e-6);
    assert!((middle(Wrap::Mirror, 1.25) - 1.0).abs() < 1e-6);
    assert!((middle(Wrap::Mirror, -0.75) - 1.0).abs() < 1e-6);
}

#[test]
fn any_coordinate_gives_a_finite_colour() {
    let odd = [
        f32::NAN,
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::MAX,
        -1e-45,
        1.0,
        -0.0,
    ];
    for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
        for filtering in [Filtering::Linear, Filtering::Nearest] {
            let texture = checker(wrap, filtering);
            for u in odd {
                for v in odd {
                    let colour = texture.sample(Vec2::new(u, v), Coding::Srgb);
                    assert!(colour.iter().all(|c| (0.0..=1.0).contains(c)));
                }
            }
        }
    }
}

#[test]
fn the_mean_is_that_of_linear_texels_alpha_included() {
    let texture = checker(Wrap::Repeat, Filtering::Linear);
    let [red, green, _, alpha] = texture.mean(Coding::Linear);
    let grey = 128.0 / 255.0;
    assert!((red - (2.0 + grey) / 4.0).abs() < 1e-6);
    assert!((green - (1.0 + grey) / 4.0).abs() < 1e-6);
    assert!((alpha - (3.0 + grey) / 4.0).abs() < 1e-6);
}

/// Steps between the 256 values of a byte are there, and the values of bytes mean the same.
#[test]
fn sixteen_bits_are_finer_than_eight() {
    let description = TextureDescription {
        image: 0,
        wrap_s: Wrap::Repeat,
        wrap_t: Wrap::Repeat,
        filtering: Filtering::Linear,
    };
    let texture = |pixels| {
        let image = ImageData {
            name: "one texel".to_owned(),
            width: 1,
            height: 1,
            pixels,
            encoded: Vec::new(),
        };
        Texture::new(&description, Arc::new(image)).unwrap()
    };
    let bytes = texture(Pixels::Rgba8(vec![3, 128, 255, 254]));
    let same = texture(Pixels::Rgba16([3, 128, 255, 254].map(|v| 257 * v).to_vec()));
    let finer = texture(Pixels::Rgba16(vec![
        3 * 257 + 1,
        128 * 257 + 1,
        65_535,
        65_534,
    ]));
    for coding in [Coding::Srgb, Coding::Linear] {
        let [eight, same, finer] = [&bytes, &same, &finer].map(|t| t.sample(Vec2::ZERO, coding));
        assert!(near(eight, same), "{eight:?} {same:?}");
        assert!(finer[0] > eight[0] && finer[1] > eight[1] && finer[3] < 1.0);
        assert!(finer[0] - eight[0] < 2e-5 && finer[1] - eight[1] < 2e-5);
        let exact = (128.0 * 257.0 + 1.0) / 65_535.0;
        let exact = match coding {
            Coding::Srgb => srgb_to_linear(exact),
            Coding::Linear => exact,
        };
        assert_eq!(finer[1].to_bits(), exact.to_bits());
    }
}

#[test]
fn sizes_are_checked() {
    let description = TextureDescription {
        image: 0,
        wrap_s: Wrap::Repeat,
        wrap_t: Wrap::Repeat,
        filtering: Filtering::Linear,
    };
    let refuse = |width, height, pixels| {
        let image = ImageData {
            name: "bad".to_owned(),
            width,
            height,
            pixels,
            encoded: Vec::new(),
        };
        let error = Texture::new(&description, Arc::new(image)).expect_err("bad size");
        error.to_string()
    };
    assert!(refuse(0, 2, Pixels::Rgba8(vec![])).contains("empty"));
    assert!(refuse(2, 2, Pixels::Rgba8(vec![0; 15])).contains("expected 16"));
    assert!(refuse(2, 1, Pixels::Rgba16(vec![0; 4])).contains("expected 8"));
    assert!(refuse(1, 1, Pixels::RgbF32(vec![0.0; 4])).contains("expected 3"));
    assert!(refuse(u32::MAX, u32::MAX, Pixels::Rgba8(vec![])).contains("holds 0"));
}

#[test]
fn uv_transform_follows_the_extension() {
    let map = |offset, rotation, scale| {
        UvMap::new(&UvTransform {
            offset,
            rotation,
            scale,
        })
    };
    let uv = Vec2::new(0.3, 0.6);
    assert_eq!(UvMap::new(&UvTransform::IDENTITY).apply(uv), uv);
    let scaled = map([0.5, 0.25], 0.0, [2.0, 3.0]).apply(uv);
    assert!(scaled.distance(Vec2::new(1.1, 2.05)) < 1e-6);
    // a quarter turn: the extension's matrix sends (u, v) to (v, -u)
    let turned = map([0.0; 2], std::f32::consts::FRAC_PI_2, [1.0; 2]).apply(uv);
    assert!(turned.distance(Vec2::new(0.6, -0.3)) < 1e-6);
}
