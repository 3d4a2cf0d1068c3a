use glam::{Affine3A, Quat, Vec3};

use super::*;
use crate::description::{Blades, Lens};
use crate::testing::{Rng, chi_square};

fn description(projection: Projection, lens: Option<Lens>) -> CameraDescription {
    CameraDescription {
        name: "test".to_owned(),
        transform: Affine3A::from_scale_rotation_translation(
            Vec3::new(2.0, 0.5, 3.0),
            Quat::from_xyzw(0.1, 0.7, -0.2, 0.6).normalize(),
            Vec3::new(3.0, -1.0, 7.0),
        ),
        projection,
        lens,
        shutter: None,
    }
}

fn perspective(yfov: f32, lens: Option<Lens>) -> Camera {
    let projection = Projection::Perspective {
        yfov,
        aspect_ratio: None,
    };
    Camera::new(&description(projection, lens), 320, 200).unwrap()
}

fn all() -> [Camera; 4] {
    let lens = Lens {
        aperture: 0.3,
        focus: 4.0,
        blades: None,
    };
    let bladed = Lens {
        blades: Some(Blades {
            count: 5,
            rotation: 0.3,
        }),
        ..lens
    };
    let projection = Projection::Orthographic {
        xmag: 1.0,
        ymag: 2.0,
    };
    [
        perspective(0.9, None),
        perspective(1.8, Some(lens)),
        perspective(1.8, Some(bladed)),
        Camera::new(&description(projection, None), 320, 200).unwrap(),
    ]
}

#[test]
fn looks_along_minus_z_with_y_up() {
    let mut description = description(
        Projection::Perspective {
            yfov: std::f32::consts::FRAC_PI_2,
            aspect_ratio: None,
        },
        None,
    );
    description.transform = Affine3A::IDENTITY;
    let camera = Camera::new(&description, 200, 100).unwrap();
    let direction = |x, y| camera.sample_ray(DVec2::new(x, y), [0.5; 2]).direction;
    let near = |a: DVec3, b: DVec3| a.distance(b.normalize()) < 1e-6;
    assert!(near(direction(0.5, 0.5), DVec3::NEG_Z));
    assert!(near(direction(0.5, 0.0), DVec3::new(0.0, 1.0, -1.0)));
    assert!(near(direction(1.0, 0.5), DVec3::new(2.0, 0.0, -1.0)));
}

#[test]
fn raster_of_undoes_sample_ray() {
    let mut rng = Rng::new(1);
    for camera in all() {
        for _ in 0..1000 {
            // a little beyond the image, as a wide filter would ask
            let raster = DVec2::from(rng.pair()) * 1.2 - 0.1;
            let ray = camera.sample_ray(raster, rng.pair());
            let back = camera.raster_of(ray.origin, ray.direction).unwrap();
            assert!(back.distance(raster) < 1e-9, "{raster} came back as {back}");
            assert!(camera.raster_of(ray.origin, -ray.direction).is_none());
        }
    }
}

#[test]
fn a_joined_point_lies_on_the_ray_of_its_raster() {
    let mut rng = Rng::new(2);
    for camera in all() {
        for _ in 0..1000 {
            let (raster, u) = (DVec2::from(rng.pair()), rng.pair());
            let ray = camera.sample_ray(raster, u);
            let distance = 0.1 + 10.0 * rng.uniform();
            let point = ray.origin + ray.direction * distance;
            let joined = camera.sample_lens(point, u).unwrap();
            assert!(joined.raster.distance(raster) < 1e-9);
            assert!(joined.position.distance(ray.origin) < 1e-9);
            assert!(joined.direction.distance(-ray.direction) < 1e-9);
            assert!((joined.distance - distance).abs() < 1e-9);
            let density = camera.raster_density(joined.position, point);
            assert!((joined.importance / density - 1.0).abs() < 1e-9);
            assert!((joined.pdf - camera.pdf_lens()).abs() < 1e-12);
        }
    }
}

/// Light that comes back along a camera ray meets the lens where the ray began.
#[test]
fn light_meets_the_lens_where_a_ray_leaves_it() {
    let mut rng = Rng::new(4);
    let [pinhole, round, bladed, parallel] = all();
    for i in 0..2000 {
        let camera = if i % 2 == 0 { &round } else { &bladed };
        let (raster, u) = (DVec2::from(rng.pair()), rng.pair());
        let ray = camera.sample_ray(raster, u);
        let distance = 0.1 + 10.0 * rng.uniform();
        let point = ray.origin + ray.direction * distance;
        let hit = camera.meet_lens(point, -ray.direction).unwrap();
        assert!(hit.position.distance(ray.origin) < 1e-9);
        assert!(hit.raster.distance(raster) < 1e-9);
        assert!((hit.distance - distance).abs() < 1e-9);
        let joined = camera.sample_lens(point, u).unwrap();
        assert!((hit.we / joined.we - 1.0).abs() < 1e-9);
        assert!((hit.cos - joined.cos).abs() < 1e-9);
        // away from it, from behind it, past it, from beside the window
        assert!(camera.meet_lens(point, ray.direction).is_none());
        let behind = ray.origin - ray.direction * distance;
        assert!(camera.meet_lens(behind, ray.direction).is_none());
        let across = ray.direction.any_orthonormal_vector();
        assert!(camera.meet_lens(point + across, -ray.direction).is_none());
        let beside = camera.sample_ray(DVec2::new(1.05, 0.5), u);
        let origin = beside.origin + beside.direction;
        assert!(camera.meet_lens(origin, -beside.direction).is_none());
        for other in [&pinhole, &parallel] {
            let ray = other.sample_ray(raster, u);
            let origin = ray.origin + ray.direction;
            assert!(other.meet_lens(origin, -ray.direction).is_none());
        }
    }
}

#[test]
fn importance_is_the_raster_seen_through_the_lens() {
    // d raster / d area by finite differences on a plane across the ray
    for camera in all() {
        let u = [0.3, 0.8];
        let ray = camera.sample_ray(DVec2::new(0.2, 0.9), u);
        let point = ray.origin + ray.direction * 3.0;
        let [a, b] = [
            ray.direction.any_orthonormal_vector(),
            ray.direction.cross(ray.direction.any_orthonormal_vector()),
        ];
        let step = 1e-5;
        let at = |d: DVec3| camera.sample_lens(point + d * step, u).unwrap().raster;
        let (da, db) = (
            (at(a) - at(-a)) / (2.0 * step),
            (at(b) - at(-b)) / (2.0 * step),
        );
        let jacobian = da.perp_dot(db).abs();
        let importance = camera.sample_lens(point, u).unwrap().importance;
        assert!((jacobian / importance - 1.0).abs() < 1e-6);
    }
}

#[test]
fn importance_integrates_to_one() {
    // We cos / p_lens over the directions from one lens point, drawn uniformly in a cone that
    // contains the window.
    for camera in &all()[..3] {
        let mut rng = Rng::new(7);
        let (n, u, cap) = (400_000, [0.95, 0.2], 0.15);
        let origin = camera.sample_ray(DVec2::splat(0.5), u).origin;
        let side = camera.forward().any_orthonormal_vector();
        let other = camera.forward().cross(side);
        let mut sum = 0.0;
        for _ in 0..n {
            let cos = cap + (1.0 - cap) * rng.uniform();
            let sin = (1.0 - cos * cos).sqrt();
            let phi = std::f64::consts::TAU * rng.uniform();
            let across = side * phi.cos() + other * phi.sin();
            let direction = camera.forward() * cos + across * sin;
            if let Some(sample) = camera.sample_lens(origin + direction, u) {
                sum += sample.we * sample.cos / sample.pdf;
            }
        }
        let integral = sum * std::f64::consts::TAU * (1.0 - cap) / f64::from(n);
        assert!((integral - 1.0).abs() < 0.01, "{integral}");
    }
}

/// p-value of the density of directions from one lens point, on a grid of the two field
/// angles; `fault` multiplies the density by a power of the cosine.
fn direction_p_value(camera: &Camera, samples: u32, fault: i32) -> f64 {
    const CELLS: usize = 16;
    const SUB: usize = 8;
    let forward = camera.forward();
    let (up, right) = {
        let at = |x, y| camera.sample_ray(DVec2::new(x, y), [0.5; 2]).direction;
        let up = (at(0.5, 0.2) - at(0.5, 0.8)).normalize();
        (up, forward.cross(up))
    };
    let reach = 1.35;
    let mut observed = vec![0.0; CELLS * CELLS];
    let mut rng = Rng::new(3);
    let u = [0.9, 0.4];
    let origin = camera.sample_ray(DVec2::splat(0.5), u).origin;
    for _ in 0..samples {
        let d = camera.sample_ray(DVec2::from(rng.pair()), u).direction;
        let along = d.dot(forward);
        let cell = |across: f64| {
            let t = 0.5 * (across.atan2(along) / reach + 1.0);
            ((t * CELLS as f64) as usize).min(CELLS - 1)
        };
        observed[cell(d.dot(up)) * CELLS + cell(d.dot(right))] += 1.0;
    }
    let mut expected = vec![0.0; CELLS * CELLS];
    let n = CELLS * SUB;
    let step = 2.0 * reach / n as f64;
    for i in 0..n * n {
        let [a, b] = [i % n, i / n].map(|k| (k as f64 + 0.5) * step - reach);
        let [x, y] = [a.tan(), b.tan()];
        let cos = 1.0 / (1.0 + x * x + y * y).sqrt();
        let solid_angle = cos.powi(3) / (a.cos() * b.cos()).powi(2) * step * step;
        let d = (forward + right * x + up * y).normalize();
        let raster = camera.raster_of(origin, d).unwrap();
        if raster.cmpge(DVec2::ZERO).all() && raster.cmplt(DVec2::ONE).all() {
            let cell = (i / n / SUB) * CELLS + (i % n) / SUB;
            let density = camera.pdf_direction(d) * cos.powi(fault);
            expected[cell] += density * solid_angle * f64::from(samples);
        }
    }
    // Cells that the window's edge crosses are only known as well as the quadrature.
    let edge = |i: usize| {
        let (x, y) = (i % CELLS, i / CELLS);
        let neighbours = [(0, 1), (1, 0), (2, 1), (1, 2)];
        neighbours.iter().any(|&(dx, dy)| {
            let (x, y) = ((x + dx).wrapping_sub(1), (y + dy).wrapping_sub(1));
            x < CELLS && y < CELLS && expected[y * CELLS + x] == 0.0
        })
    };
    let inner: Vec<usize> = (0..CELLS * CELLS)
        .filter(|&i| expected[i] > 0.0 && !edge(i))
        .collect();
    assert!(inner.len() > 20);
    let mut o: Vec<f64> = inner.iter().map(|&i| observed[i]).collect();
    let mut e: Vec<f64> = inner.iter().map(|&i| expected[i]).collect();
    // the rest in one cell, so that the total counts
    o.push(f64::from(samples) - o.iter().sum::<f64>());
    e.push(f64::from(samples) - e.iter().sum::<f64>());
    chi_square(&o, &e)
}

#[test]
fn directions_follow_their_density() {
    for camera in &all()[..3] {
        let p = direction_p_value(camera, 100_000, 0);
        assert!(p > 1e-4, "p = {p}");
    }
}

#[test]
#[ignore = "long"]
fn directions_follow_their_density_long() {
    for camera in &all()[..3] {
        let p = direction_p_value(camera, 1_000_000, 0);
        assert!(p > 1e-4, "p = {p}");
    }
}

#[test]
fn a_wrong_density_of_directions_is_caught() {
    for camera in &all()[..3] {
        assert!(direction_p_value(camera, 100_000, 1) < 1e-6);
    }
}

#[test]
fn points_behind_and_beside_are_not_seen() {
    for camera in all() {
        let forward = camera.forward();
        let behind = camera.position() - forward;
        assert!(camera.sample_lens(behind, [0.5; 2]).is_none());
        assert!(camera.sample_lens(camera.position(), [0.5; 2]).is_none());
        assert!(camera.sample_lens(DVec3::NAN, [0.5; 2]).is_none());
        let ray = camera.sample_ray(DVec2::new(1.05, 0.5), [0.5; 2]);
        let beside = ray.origin + ray.direction * 5.0;
        assert!(camera.sample_lens(beside, [0.5; 2]).is_none());
        let wide = camera.with_window(DVec2::splat(-0.1), DVec2::splat(1.1));
        assert!(wide.sample_lens(beside, [0.5; 2]).is_some());
    }
}

#[test]
fn bad_descriptions_are_refused() {
    let pinhole = |yfov| Projection::Perspective {
        yfov,
        aspect_ratio: None,
    };
    let refuse = |description: &CameraDescription| {
        Camera::new(description, 10, 10)
            .expect_err("out of range")
            .to_string()
    };
    for yfov in [0.0, -1.0, 3.2, f32::NAN, f32::INFINITY] {
        assert!(refuse(&description(pinhole(yfov), None)).contains("yfov"));
    }
    let lens = Lens {
        aperture: -1.0,
        focus: 1.0,
        blades: None,
    };
    assert!(refuse(&description(pinhole(1.0), Some(lens))).contains("aperture"));
    for (count, rotation, word) in [
        (2, 0.0, "blades"),
        (65, 0.0, "blades"),
        (5, f32::NAN, "rotation"),
    ] {
        let lens = Lens {
            aperture: 1.0,
            blades: Some(Blades { count, rotation }),
            ..lens
        };
        assert!(refuse(&description(pinhole(1.0), Some(lens))).contains(word));
    }
    let mut flat = description(pinhole(1.0), None);
    flat.transform = Affine3A::from_scale(Vec3::new(1.0, 1.0, 0.0));
    assert!(refuse(&flat).contains("view direction"));
    let good = description(pinhole(1.0), None);
    assert!(Camera::new(&good, 0, 10).is_err());
}
