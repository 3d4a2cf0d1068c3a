use std::collections::HashMap;

use glam::Vec3;
use kaustik_geometry::Mesh;
use kaustik_spectrum::{Illuminant, Rgb, Tabulated, Xyz, integrate_xyz};

use super::*;
use crate::camera::Camera;

/// Every scene with every parameter that changes its shape.
const ALL: &[&str] = &[
    "cornell",
    "cornell-direct",
    "cornell-indirect",
    "glass-cube",
    "glass-cube?light=0.8",
    "water-cornell",
    "water-cornell?light=0.8",
    "ring-and-sphere",
    "ring-and-sphere?light=0.8",
    "glossy-cornell",
    "disco",
    "mirror-statue",
    "dinner-hall",
    "villa",
    "underwater",
    "canyon",
    "mirror-balls",
    "tea-time",
    "prism",
    "prism?light=0.2",
    "material-ball",
    "material-ball?material=colored-glass",
    "furnace",
    "furnace?kind=diffuse",
    "furnace?kind=glass",
    "furnace?kind=rough",
    "furnace?kind=plate",
];

fn corners(mesh: &Mesh) -> impl Iterator<Item = [Vec3; 3]> + '_ {
    let corner = |i: u32| mesh.positions[i as usize];
    mesh.indices.iter().map(move |t| t.map(corner))
}

/// Edges by the bits of their ends; each must appear once in each direction.
fn is_closed(mesh: &Mesh) -> bool {
    let key = |p: Vec3| p.to_array().map(|c| (c + 0.0).to_bits());
    let mut edges: HashMap<_, i32> = HashMap::new();
    for [a, b, c] in corners(mesh) {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            *edges.entry((key(from), key(to))).or_default() += 1;
        }
    }
    edges
        .iter()
        .all(|(&(a, b), &count)| count == 1 && edges.get(&(b, a)) == Some(&1))
}

/// Signed volume: positive if the front is outside.
fn volume(mesh: &Mesh) -> f32 {
    corners(mesh).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
}

#[test]
fn every_scene_is_tested() {
    for scene in list() {
        let tested = |words: &&str| words.split('?').next() == Some(scene.name);
        assert!(ALL.iter().any(tested), "{}", scene.name);
        assert!(!scene.summary.is_empty() && scene.summary.len() < 150);
    }
}

#[test]
fn scenes_are_well_formed() {
    for words in ALL {
        let scene = load(words).unwrap();
        assert_eq!(&scene.name, words);
        assert!(!scene.instances.is_empty());
        for instance in &scene.instances {
            assert!(instance.mesh < scene.meshes.len(), "{words}");
            assert!(
                instance.material.is_some_and(|m| m < scene.materials.len()),
                "{words}"
            );
            assert!(instance.transform.is_finite());
        }
        for material in 0..scene.materials.len() {
            let used = scene.instances.iter().any(|i| i.material == Some(material));
            assert!(used, "{words}: material {material} is not used");
        }
        let count: usize = scene.meshes.iter().map(|mesh| mesh.indices.len()).sum();
        let detailed = matches!(
            *words,
            "dinner-hall" | "villa" | "underwater" | "canyon" | "mirror-balls" | "tea-time"
        );
        let range = match *words {
            "mirror-statue" => 290_000..320_000,
            _ if detailed => 10_000..150_000,
            _ => 1..25_000,
        };
        assert!(range.contains(&count), "{words}: {count} triangles");
        assert!(!detailed || !scene.textures.is_empty(), "{words} is bare");
        assert_eq!(scene.cameras.len(), 1);
        assert!(Camera::new(&scene.cameras[0], 64, 64).is_ok());
        let lit = scene.materials.iter().any(|m| m.emissive[0] > 0.0);
        assert!(lit || scene.environment.is_some(), "{words} is dark");
    }
}

#[test]
fn meshes_are_well_formed() {
    for words in ALL {
        let scene = load(words).unwrap();
        for (mesh, instance) in scene.meshes.iter().zip(&scene.instances) {
            let place = format!("{words}: {}", instance.name);
            let vertices = mesh.positions.len();
            assert!(
                mesh.indices
                    .iter()
                    .flatten()
                    .all(|&i| (i as usize) < vertices),
                "{place}"
            );
            assert!(mesh.positions.iter().all(|p| p.is_finite()), "{place}");
            assert!(
                mesh.normals.is_empty() || mesh.normals.len() == vertices,
                "{place}"
            );
            assert!(mesh.normals.iter().all(|n| n.is_normalized()), "{place}");
            for (triangle, [a, b, c]) in mesh.indices.iter().zip(corners(mesh)) {
                let normal = (b - a).cross(c - a);
                assert!(normal.length() > 1e-7, "{place}: a triangle without area");
                for &i in triangle {
                    let agrees = mesh
                        .normals
                        .get(i as usize)
                        .is_none_or(|n| n.dot(normal) > 0.0);
                    assert!(agrees, "{place}: a normal points to the back");
                }
            }
        }
    }
}

#[test]
fn solids_are_closed_and_face_outward() {
    let mut solids = 0;
    for words in ALL {
        let scene = load(words).unwrap();
        for instance in &scene.instances {
            let material = &scene.materials[instance.material.unwrap()];
            let mesh = &scene.meshes[instance.mesh];
            if material.volume.is_some()
                || instance.name == "ring"
                || instance.name == "prism"
                || instance.name == "ball"
                || instance.name == "statue"
                || instance.name.contains("block")
            {
                solids += 1;
                assert!(is_closed(mesh), "{words}: {} is open", instance.name);
                assert!(
                    volume(mesh) > 0.0,
                    "{words}: {} is inside out",
                    instance.name
                );
            }
        }
    }
    assert!(solids > 10);
    let furnace = load("furnace").unwrap();
    assert!(is_closed(&furnace.meshes[0]) && volume(&furnace.meshes[0]) < 0.0);
    // the check itself sees a hole
    let mut open = (*load("furnace?kind=glass").unwrap().meshes[0]).clone();
    assert!((volume(&open) / (4.0 / 3.0 * std::f32::consts::PI) - 1.0).abs() < 0.002);
    open.indices.pop();
    assert!(!is_closed(&open));
}

#[test]
fn lamps_face_the_room_and_keep_their_flux() {
    let strength = |words: &str| {
        let scene = load(words).unwrap();
        let lamp = scene.instances.iter().find(|i| i.name == "lamp").unwrap();
        let material = &scene.materials[lamp.material.unwrap()];
        assert!(!material.double_sided);
        let mut normal = Vec3::ZERO;
        for [a, b, c] in corners(&scene.meshes[lamp.mesh]) {
            normal += (b - a).cross(c - a) * 0.5;
        }
        let up = words == "cornell-indirect";
        assert!(if up { normal.y > 0.0 } else { normal.y < 0.0 }, "{words}");
        normal.length() * material.emissive[0]
    };
    for name in ["glass-cube", "water-cornell", "ring-and-sphere"] {
        let at = |light: &str| strength(&format!("{name}?light={light}"));
        assert!((at("0.8") / at("0.2") - 1.0).abs() < 1e-4);
        assert!((at("0.2") / strength(name) - 1.0).abs() < 1e-6);
    }
    for name in ["cornell", "cornell-direct", "cornell-indirect"] {
        assert!(strength(name) > 10.0);
    }
}

#[test]
fn the_figures_of_kelemens_scenes() {
    let disco = load("disco").unwrap();
    let lamps = disco
        .instances
        .iter()
        .filter(|i| i.name.starts_with("lamp"));
    assert_eq!(lamps.count(), 8);
    let ball = disco.instances.iter().find(|i| i.name == "ball").unwrap();
    assert_eq!(disco.meshes[ball.mesh].indices.len(), 80);
    assert!(
        disco.meshes[ball.mesh].normals.is_empty(),
        "facets are flat"
    );
    for lamp in disco
        .instances
        .iter()
        .filter(|i| i.name.starts_with("lamp"))
    {
        let [a, b, c] = corners(&disco.meshes[lamp.mesh]).next().unwrap();
        let towards = Vec3::new(2.764, 2.5, 2.8) - a;
        let cosine = (b - a).cross(c - a).normalize().dot(towards.normalize());
        assert!(cosine > 0.99, "{} looks elsewhere: {cosine}", lamp.name);
    }
    let statue = load("mirror-statue").unwrap();
    let mesh = |name: &str| {
        let instance = statue.instances.iter().find(|i| i.name == name).unwrap();
        &statue.meshes[instance.mesh]
    };
    assert!((290_000..310_000).contains(&mesh("statue").indices.len()));
    assert!(mesh("mirror").normals.is_empty(), "panes are flat");
    let gold = statue.materials.iter().find(|m| m.name == "gold").unwrap();
    assert!((gold.roughness * gold.roughness - 0.05).abs() < 1e-6);
    // it stands on the floor, within the room and before the mirror
    let low = mesh("statue")
        .positions
        .iter()
        .copied()
        .reduce(Vec3::min)
        .unwrap();
    let high = mesh("statue")
        .positions
        .iter()
        .copied()
        .reduce(Vec3::max)
        .unwrap();
    let nearest = mesh("mirror")
        .positions
        .iter()
        .map(|p| p.z)
        .fold(f32::MAX, f32::min);
    assert!(low.y > 0.0 && low.y < 0.05 && low.x > 0.0 && low.z > 0.0);
    assert!(high.y < room::SIZE.y && high.x < room::SIZE.x && high.z < nearest);
    let glossy = load("glossy-cornell").unwrap();
    let wall = glossy.instances.iter().find(|i| i.name == "back").unwrap();
    let wall = &glossy.materials[wall.material.unwrap()];
    assert_eq!(
        wall.model,
        Some(crate::description::Model::Phong { exponent: 50.0 })
    );
    assert_eq!(wall.metallic.to_bits(), 1.0_f32.to_bits());
}

#[test]
fn water_reaches_into_the_walls() {
    let scene = load("water-cornell").unwrap();
    let water = scene.instances.iter().find(|i| i.name == "water").unwrap();
    let mesh = &scene.meshes[water.mesh];
    let min = mesh.positions.iter().copied().reduce(Vec3::min).unwrap();
    let max = mesh.positions.iter().copied().reduce(Vec3::max).unwrap();
    assert!(min.x < 0.0 && min.y < 0.0 && max.x > room::SIZE.x && max.z > room::SIZE.z);
    assert!(max.y < 0.4 * room::SIZE.y && min.z >= 0.0);
    // no ray of the camera reaches the rim outside the walls: the walls' front edges hide it
    let camera = Camera::new(&scene.cameras[0], 64, 64).unwrap();
    let eye = camera.position().as_vec3();
    for corner in [min, Vec3::new(max.x, min.y, min.z)] {
        let at_lip = corner.lerp(eye, 0.05 / (0.05 - eye.z));
        assert!(at_lip.y > 0.0 && at_lip.x > 0.0 && at_lip.x < room::SIZE.x);
    }
}

#[test]
fn paints_have_the_colours_of_their_tables() {
    for material in [materials::white(), materials::red(), materials::green()] {
        let Some(crate::description::SpectralInput::Named(name)) = &material.reflectance else {
            panic!("{} is measured", material.name);
        };
        let table = Tabulated::named(name).unwrap();
        let light = |nm: f32| f64::from(table.at(nm) * Illuminant::D65.at(nm));
        let xyz = integrate_xyz(|nm| light(nm as f32)).map(|c| c as f32);
        let Rgb(rgb) = Xyz(xyz).into();
        for (seen, stated) in rgb.iter().zip(material.base_color) {
            assert!((seen - stated).abs() < 0.001, "{name}: {rgb:?}");
        }
    }
}

#[test]
fn every_ball_is_made_and_comes_back_from_a_file() {
    let names = material_ball::names();
    assert_eq!(names.len(), 22);
    let mut seen: Vec<String> = Vec::new();
    for name in names {
        let scene = load(&format!("material-ball?material={name}")).unwrap();
        assert_eq!(scene.materials[0].name, name);
        let mut unnamed = scene.materials[0].clone();
        unnamed.name.clear();
        let words = format!("{unnamed:?}");
        assert!(!seen.contains(&words), "{name} is like another");
        seen.push(words);
        let bytes = crate::gltf::export_bytes(&scene).unwrap();
        let options = crate::gltf::LoadOptions::default();
        let back = crate::gltf::load_bytes(&bytes, "ball.glb", &options).unwrap();
        assert!(
            back.warnings.is_empty() && back.description == scene,
            "{name}"
        );
    }
    let wrong = load("material-ball?material=cheese").unwrap_err();
    assert!(wrong.to_string().contains("rough-glass"), "{wrong}");
}

/// A ray of yellow light through the slit comes to the middle of the screen, other colours beside it, whatever glass it is
/// that lets light out at all.
#[test]
fn the_prism_bends_light_onto_the_screen() {
    let mut shown = Vec::new();
    for name in kaustik_spectrum::Glass::names() {
        let loaded = load(&format!("prism?glass={name}"));
        let glass = kaustik_spectrum::Glass::named(name).unwrap();
        if glass.at(587.6) > 1.88 {
            assert!(loaded.unwrap_err().to_string().contains("up to 1.88"));
            continue;
        }
        assert!(loaded.is_ok(), "{name}");
        shown.push((name, spread_on_screen(&glass)));
    }
    for (name, spread) in &shown {
        assert!(*spread < 1.5, "{name}: {spread}");
    }
    let flint = shown.iter().find(|(name, _)| *name == "sf11");
    assert!(
        flint.is_some_and(|(_, spread)| *spread > 0.3) && shown.len() > 6,
        "{shown:?}"
    );
}

/// How far violet and red light come apart on a screen 3.2 away, whose half width is 1.6.
fn spread_on_screen(glass: &kaustik_spectrum::Glass) -> f64 {
    let deviation = |nm: f32| {
        // symmetric at 587.6 nm; others by Snell's law at both faces
        let apex = 60.0_f64.to_radians();
        let first = (0.5 * f64::from(glass.at(587.6))).asin();
        let n = f64::from(glass.at(nm));
        let inside = (first.sin() / n).asin();
        let last = (n * (apex - inside).sin()).asin();
        first + last - apex
    };
    let half = super::prism::half_deviation(glass.at(587.6));
    assert!((0.5 * deviation(587.6) - half).abs() < 1e-9);
    3.2 * (deviation(420.0) - deviation(680.0))
}

#[test]
fn the_mirror_balls_do_not_touch() {
    // all stand on the floor
    let balls =
        super::mirror_balls::BALLS.map(|([x, z], radius)| (glam::Vec3::new(x, radius, z), radius));
    for (i, (a, r)) in balls.iter().enumerate() {
        for (b, s) in &balls[..i] {
            assert!(a.distance(*b) > r + s, "{a} {r}, {b} {s}");
        }
    }
}

#[test]
fn errors_say_what_there_is() {
    let message = |words: &str| load(words).unwrap_err().to_string();
    let unknown = message("cornel");
    assert!(unknown.contains("'cornel'"), "{unknown}");
    for scene in list() {
        assert!(unknown.contains(scene.name));
    }
    assert!(message("").contains("cornell"));
    assert!(message("cornell?light=1").contains("it has none"));
    assert!(message("glass-cube?size=1").contains("there are light"));
    assert!(message("glass-cube?light").contains("key=value"));
    assert!(message("glass-cube?light=1&light=2").contains("twice"));
    for value in ["big", "0", "-1", "nan", "inf", "5", ""] {
        let message = message(&format!("glass-cube?light={value}"));
        assert!(message.contains("from 0.01 to 4"), "{message}");
    }
    assert!(message("furnace?kind=cold").contains("rough"));
    assert!(load("furnace?").is_ok());
}
