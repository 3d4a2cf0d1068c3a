//! Photons beside walls and behind veils: they count where they landed, and where nothing lands it is dark.

use glam::Vec3;
use kaustik::film::Image;
use kaustik::geometry::Mesh;
use kaustik::scene::Scene;
use kaustik::scene::description::{AlphaMode, MaterialDescription, Transmission};
use kaustik::{Control, Method, RenderSettings, render};

use crate::photon::{SIDE, luminance, photons, reference};
use crate::support::{compile, describe, means, picture, settings, square};

/// Diffuse, on both sides.
fn paper() -> MaterialDescription {
    MaterialDescription {
        roughness: 1.0,
        metallic: 0.0,
        base_color: [0.8, 0.8, 0.8, 1.0],
        double_sided: true,
        ..MaterialDescription::default()
    }
}

/// A square around the z axis that looks along it.
fn screen(z: f32, half: f32) -> Mesh {
    square(Vec3::Z * z, half)
}

/// What this share of rays meets.
fn veil(alpha: f32) -> MaterialDescription {
    MaterialDescription {
        base_color: [0.8, 0.8, 0.8, alpha],
        alpha_mode: AlphaMode::Blend,
        ..paper()
    }
}

/// A wall behind such veils, in the light of a lamp: each method is as bright as bidirectional paths.
fn assert_veils(veil: &MaterialDescription, veils: &[f32], methods: &[Method]) {
    let paper = paper();
    let lamp = MaterialDescription {
        emissive: [10.0; 3],
        ..paper.clone()
    };
    let ends = [(paper, screen(-1.0, 2.0)), (lamp, screen(4.0, 0.5))];
    let veils = veils.iter().map(|&z| (veil.clone(), screen(z, 2.0)));
    let things = ends.into_iter().chain(veils);
    let scene = compile(&describe(Vec3::new(0.0, 0.0, 3.0), 0.5, things), SIDE);
    let brightness = |settings: &RenderSettings| luminance(means(&picture(&scene, settings)));
    let truth = brightness(&settings(Method::Bdpt, SIDE, 256));
    for &method in methods {
        let found = brightness(&photons(method, 16, 60_000));
        assert!(
            (found / truth - 1.0).abs() < 0.06,
            "{method}: {found}, {truth}"
        );
    }
}

/// Veils a hair before a wall: the whole light lands on each of the three, and counts only where it landed. (In each other's
/// discs it would count twice and more.)
#[test]
fn light_on_close_layers_counts_where_it_landed() {
    let methods = [Method::Sppm, Method::PhotonSpatial];
    assert_veils(&veil(0.1), &[-0.998, -0.996], &methods);
}

/// Panes that scatter a part of what they do not let through, a hair before a wall: light that passes is not
/// scattered, yet it lands on all three.
#[test]
fn light_on_close_panes_counts_where_it_landed() {
    let pane = MaterialDescription {
        roughness: 0.0,
        transmission: Some(Transmission {
            factor: 0.8,
            texture: None,
        }),
        ..paper()
    };
    assert_veils(&pane, &[-0.998, -0.996], &[Method::Sppm]);
}

/// A veil that a third of all rays meet, before a wall: camera and photons meet it by chance, and it counts once. (Were it
/// counted twice, a third would be missing.)
#[test]
fn veils_are_as_bright_as_they_are() {
    let methods = Method::ALL.into_iter().filter(|m| m.traces_photons());
    assert_veils(&veil(0.3), &[0.0], &methods.collect::<Vec<_>>());
}

/// Of a surface that lets no light through it is all the same which sides of its triangles are their fronts: along an edge where
/// that changes photons count across it.
#[test]
fn fronts_of_triangles_are_no_borders() {
    let light = |turned: bool| {
        let mut floor = screen(-1.0, 2.0);
        if turned {
            floor.indices[1].swap(0, 1);
        }
        let lamp = MaterialDescription {
            emissive: [10.0; 3],
            ..paper()
        };
        let things = [(paper(), floor), (lamp, screen(4.0, 0.5))];
        let scene = compile(&describe(Vec3::new(0.0, 0.0, 3.0), 0.5, things), SIDE);
        luminance(means(&picture(&scene, &photons(Method::Sppm, 4, 60_000))))
    };
    let (plain, turned) = (light(false), light(true));
    assert!((turned / plain - 1.0).abs() < 0.002, "{plain} {turned}");
}

/// The camera looks down on a wall with a lamp on one side of it.
fn wall() -> Scene {
    let quad = |corners: [[f32; 3]; 4]| Mesh {
        positions: corners.map(Vec3::from).to_vec(),
        indices: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    };
    let wall = [[-9.0, -1.5], [9.0, -1.5], [9.0, 1.0], [-9.0, 1.0]];
    let lamp = [[1.0, -1.0], [1.0, 1.0], [2.0, 1.0], [2.0, -1.0]];
    let light = MaterialDescription {
        emissive: [10.0; 3],
        ..paper()
    };
    let black = MaterialDescription {
        base_color: [0.0, 0.0, 0.0, 1.0],
        ..paper()
    };
    let things = [
        (paper(), screen(-1.0, 2.0)),
        (black, quad(wall.map(|[y, z]| [0.0, y, z]))),
        (light, quad(lamp.map(|[x, y]| [x, y, 0.5]))),
    ];
    compile(&describe(Vec3::new(0.0, 0.0, 3.0), 0.5, things), SIDE)
}

/// What is on the left of the wall, and in two columns at its right.
fn sides(image: &Image) -> [f64; 2] {
    let [_, green, _] = image.rgb();
    let columns = |from: usize, to: usize| -> f64 {
        let rows = green.chunks(SIDE as usize);
        rows.flat_map(|row| &row[from..to])
            .map(|&v| f64::from(v))
            .sum()
    };
    let foot = SIDE as usize / 2;
    [columns(0, foot), columns(foot, foot + 2)]
}

/// On the other side of the wall it is dark, however near the wall a pixel lies, and
/// the floor at the foot of the wall is as bright as it is, but for what a disc makes even.
#[test]
fn walls_keep_photons_out() {
    let scene = wall();
    let [dark, bright] = sides(&reference(&scene, 64));
    assert!(dark.to_bits() == 0 && bright > 0.0);
    for method in [
        Method::Sppm,
        Method::PhotonVisibility,
        Method::PhotonSpatial,
    ] {
        // By seed a picture of eight iterations differs by 2 to 3 % there, in large discs of photon-spatial by 9 %. In a large one
        // what is beside the foot counts too, 10 %.
        for (radius, iterations, tolerance) in [(1.0, 32, 0.05), (4.0, 32, 0.16)] {
            let mut settings = photons(method, iterations, 60_000);
            settings.options.photon.radius = radius;
            settings.options.photon.burn_in = None;
            let [light, found] = sides(&picture(&scene, &settings));
            assert_eq!(light.to_bits(), 0, "{method} {radius}: {light}");
            assert!(
                (found / bright - 1.0).abs() < tolerance,
                "{method} {radius}: {found} {bright}"
            );
        }
    }
}

/// One in ten thousand of a bright lamp's photons lands anywhere: no pilot of a thousand says how bright it is, and yet it is not
/// too bright for the film.
#[test]
fn photons_that_seldom_land_are_shown() {
    let paper = paper();
    let lamp = MaterialDescription {
        emissive: [1e6; 3],
        ..paper.clone()
    };
    let things = [(paper, screen(-1.0, 0.1)), (lamp, screen(4.0, 10.0))];
    let scene = compile(&describe(Vec3::new(0.0, 0.0, 3.0), 0.049, things), 8);
    let shown = |settings: RenderSettings| {
        let settings = RenderSettings {
            width: 8,
            height: 8,
            ..settings
        };
        let done = render(&scene, &settings, &mut Control::default()).expect("a render");
        assert_eq!(done.statistics.film.too_large, 0);
        luminance(means(&done.image))
    };
    let truth = shown(settings(Method::Path, 8, 64));
    let found = shown(photons(Method::Sppm, 4, 1_000_000));
    assert!((found / truth - 1.0).abs() < 0.3, "{found}, {truth}");
}

/// A wall so far that its discs go beyond single precision ends no render, alone and beside what is near.
#[test]
fn walls_beyond_all_measure_end_no_render() {
    let lamp = MaterialDescription {
        emissive: [10.0; 3],
        ..paper()
    };
    for far in [1e17_f32, 1e21, 1e25] {
        let things = [
            (paper(), screen(-far, 10.0 * far)),
            (lamp.clone(), screen(5.0, 0.5)),
            (paper(), screen(-1.0, 0.2)),
        ];
        for count in [2, 3] {
            let things = things.iter().take(count).cloned();
            let scene = compile(&describe(Vec3::new(0.0, 0.0, 3.0), 0.8, things), SIDE);
            for method in [Method::Sppm, Method::PhotonSpatial] {
                let image = picture(&scene, &photons(method, 2, 5_000));
                let finite = |plane: &&[f32]| plane.iter().all(|v| v.is_finite());
                assert!(image.rgb().iter().all(finite), "{method}, {far}");
            }
        }
    }
}
