//! The same bits for any number of threads, and across a glTF file.

use kaustik::film::Filter;
use kaustik::scene::{builtin, gltf};
use kaustik::{
    Budget, Builder, Control, Direct, Method, Progress, RenderSettings, Rendered, Watch,
    render_watched,
};

use crate::support::{compile, picture, scene, settings};

pub(crate) fn bits(image: &kaustik::film::Image) -> Vec<u32> {
    image
        .rgb()
        .iter()
        .flat_map(|plane| plane.iter().map(|v| v.to_bits()))
        .collect()
}

#[test]
fn threads_do_not_show() {
    let scene = scene("glass-cube?light=0.8", 24);
    let together = Method::ALL.map(|method| settings(method, 24, 1));
    let apart = [Method::Pssmlt, Method::Mmlt, Method::Relt, Method::Mlt].map(|method| {
        let mut settings = settings(method, 24, 1);
        settings.options.direct = Direct::Apart;
        settings
    });
    for settings in together.into_iter().chain(apart) {
        let method = settings.method;
        for budget in [Budget::PerPixel(3), Budget::Total(5_001)] {
            let settings = RenderSettings {
                budget,
                ..settings.clone()
            };
            let one = bits(&picture(
                &scene,
                &RenderSettings {
                    threads: 1,
                    ..settings.clone()
                },
            ));
            assert!(one.iter().any(|&v| v != 0));
            for threads in [2, 3, 16] {
                let more = bits(&picture(
                    &scene,
                    &RenderSettings {
                        threads,
                        ..settings.clone()
                    },
                ));
                assert!(one == more, "{method} with {threads} threads, {budget:?}");
            }
        }
    }
}

/// A ladder of chains of photons has 125,000 light paths at least, one of two chains half as many: only many of them make several
/// ladders, which threads share.
#[test]
fn threads_do_not_show_in_ladders_of_photons() {
    let scene = scene("glass-cube?light=0.8", 16);
    for method in [
        Method::PhotonVisibility,
        Method::PhotonDensity,
        Method::PhotonSpatial,
        Method::PhotonImage,
    ] {
        let with = |ladders, threads| {
            let mut settings = settings(method, 16, 2);
            settings.options.photon.photons = Some(400_000);
            settings.options.ladders = ladders;
            settings.threads = threads;
            bits(&picture(&scene, &settings))
        };
        let one = with(3, 1);
        assert!(one.iter().any(|&v| v != 0));
        assert!(one != with(2, 1), "{method}: there are fewer than three");
        for threads in [2, 8] {
            assert!(one == with(3, threads), "{method} with {threads} threads");
        }
    }
}

/// Looks at a render after every round.
#[derive(Default)]
struct Onlooker {
    per_pixel: Vec<f64>,
    last: Option<kaustik::film::Image>,
}

impl Watch for Onlooker {
    fn wants_image(&mut self, _: &Progress) -> bool {
        true
    }

    fn see_image(&mut self, rendered: Rendered) {
        self.per_pixel.push(rendered.statistics.per_pixel);
        self.last = Some(rendered.image);
    }
}

/// Whoever looks at a render on its way changes nothing but rounding, and sees in the end what is kept.
#[test]
fn looks_change_nothing_but_rounding() {
    assert_looks_change_nothing(20);
}

#[test]
#[ignore = "long"]
fn looks_at_longer_renders_change_nothing_but_rounding() {
    assert_looks_change_nothing(32);
}

fn assert_looks_change_nothing(spp: u64) {
    let scene = scene("glass-cube?light=0.8", 24);
    for method in Method::ALL {
        let settings = settings(method, 24, spp);
        let alone = picture(&scene, &settings);
        let mut onlooker = Onlooker::default();
        let watched = render_watched(&scene, &settings, &mut Control::default(), &mut onlooker);
        let watched = watched.expect("a render").image;
        let looks = &onlooker.per_pixel;
        assert!(looks.len() >= 2, "{method}: {looks:?}"); // annealing: in whole rounds
        assert!(
            looks.windows(2).all(|pair| pair[0] <= pair[1]),
            "{method}: {looks:?}"
        );
        let last = onlooker.last.expect("a look");
        for ((a, b), c) in bits(&alone).iter().zip(bits(&watched)).zip(bits(&last)) {
            let [a, b, c] = [*a, b, c].map(f32::from_bits);
            assert!(
                (a - b).abs() <= 1e-5 * a.abs().max(0.1),
                "{method}: {a} and {b}"
            );
            assert!(
                (b - c).abs() <= 1e-5 * b.abs().max(0.1),
                "{method}: {b} and {c}"
            );
        }
    }
}

#[test]
fn threads_do_not_show_with_any_builder() {
    let scene = scene("glass-cube?light=0.8", 24);
    for builder in [Builder::Endpoint, Builder::Simple, Builder::Bidirectional] {
        let with = |threads| {
            let mut settings = settings(Method::Pssmlt, 24, 3);
            settings.options.builder = builder;
            settings.threads = threads;
            bits(&picture(&scene, &settings))
        };
        let one = with(1);
        assert!(one.iter().any(|&v| v != 0));
        for threads in [2, 5] {
            assert!(one == with(threads), "{builder:?} with {threads} threads");
        }
    }
}

#[test]
fn another_seed_is_another_picture() {
    let scene = scene("cornell", 16);
    for method in Method::ALL {
        let settings = settings(method, 16, 2);
        let one = bits(&picture(&scene, &settings));
        let other = bits(&picture(
            &scene,
            &RenderSettings {
                seed: 1,
                ..settings
            },
        ));
        assert!(one != other, "{method}");
    }
}

/// A share of the ladders leaves out what the others would have added, and no more.
#[test]
fn shares_of_the_ladders_add_up() {
    let scene = scene("cornell", 16);
    let whole = settings(Method::Path, 16, 4);
    let part = |from, to| {
        let settings = RenderSettings {
            ladders: Some(from..to),
            ..whole.clone()
        };
        picture(&scene, &settings)
    };
    let (a, b, all) = (part(0, 40), part(40, 64), picture(&scene, &whole));
    for c in 0..3 {
        for i in 0..all.pixels() {
            let sum = a.rgb()[c][i] + b.rgb()[c][i];
            assert!((sum - all.rgb()[c][i]).abs() <= 1e-5 * sum.abs().max(1e-3));
        }
    }
}

#[test]
fn an_exported_scene_renders_to_the_same_bits() {
    for built_in in builtin::list() {
        let description = builtin::load(built_in.name).expect("a built-in scene");
        let bytes = gltf::export_bytes(&description).expect("an export");
        let loaded = gltf::load_bytes(&bytes, "memory.glb", &gltf::LoadOptions::default())
            .expect("what was exported");
        assert!(
            loaded.warnings.is_empty(),
            "{}: {:?}",
            built_in.name,
            loaded.warnings
        );
        assert!(loaded.description == description, "{}", built_in.name);
        let settings = settings(Method::Path, 12, 2);
        let before = bits(&picture(&compile(&description, 12), &settings));
        let after = bits(&picture(&compile(&loaded.description, 12), &settings));
        assert!(before == after, "{}", built_in.name);
    }
}

/// Every filter leaves the brightness alone, up to the border and noise: samples of pixels, splats, chains, deposits and
/// photons under all filters, every other method under one that is wide and has negative lobes.
#[test]
fn filters_keep_the_brightness() {
    assert_brightness_kept([32, 40], 0.04);
}

#[test]
#[ignore = "long"]
fn filters_keep_the_brightness_to_three_percent() {
    assert_brightness_kept([48, 64], 0.03);
}

/// So many iterations of photon methods, of 2,000 light paths each, and samples a pixel of others.
fn assert_brightness_kept([iterations, samples]: [u64; 2], within: f64) {
    let scene = scene("furnace?kind=diffuse", 16);
    let kinds = [
        Method::Path,
        Method::Light,
        Method::Pssmlt,
        Method::Erpt,
        Method::Sppm,
    ];
    for method in Method::ALL {
        let spp = if method.name().contains("photon") || method == Method::Sppm {
            iterations
        } else {
            samples
        };
        for name in Filter::names() {
            if name != "mitchell" && !kinds.contains(&method) {
                continue;
            }
            let filter = Filter::new(name, None).expect("a known filter");
            let settings = RenderSettings {
                filter,
                max_depth: 64,
                ..settings(method, 16, spp)
            };
            let [r, g, b] = crate::support::means(&picture(&scene, &settings));
            for mean in [r, g, b] {
                assert!((mean - 1.0).abs() < within, "{method} {name}: {mean}");
            }
        }
    }
}
