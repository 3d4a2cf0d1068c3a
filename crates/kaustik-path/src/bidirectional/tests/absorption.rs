use kaustik_mcmc::{Independent, generator};
use kaustik_pss::{Coordinates, Recording, Stream};
use kaustik_scene::description::Volume;
use kaustik_scene::{Scene, builtin};
use kaustik_spectrum::{Spectrum, WavelengthSampling, Wavelengths};

use super::traced::compile;
use crate::bidirectional::witness::{Joint, Seen, Witness};
use crate::bidirectional::workspace::Workspace;
use crate::{
    Bidirectional, BuilderSettings, Class, Contributions, Form, Heuristic, Multiplexed, Techniques,
};

/// What is left of light after a unit of length in the glass.
const LEFT: f32 = 0.3;

/// The last joint of two walks on surfaces: its length, the materials at its ends, what it brings before it
/// is known to be free and how much the way through matter takes.
#[derive(Default)]
struct LastJoint(Option<(f64, [u32; 2], Spectrum)>);

impl Witness for LastJoint {
    fn see(&mut self, seen: &Seen<'_>) {
        assert!(matches!(seen.joint, Joint::Surfaces), "another strategy");
        let [y, z] = [seen.light, seen.eye].map(|path| path[path.len() - 1].vertex);
        let length = (y.position - z.position).length();
        self.0 = Some((length, [y.material, z.material], seen.value));
    }
}

/// A rough ball of grey glass in uniform light, and which material it is.
fn ball() -> (Scene, u32) {
    let mut description = builtin::load("furnace?kind=rough").expect("a built-in scene");
    let solid = (description.materials.iter_mut().enumerate())
        .find(|(_, material)| material.transmission.is_some());
    let (index, material) = solid.expect("the ball's");
    material.volume = Some(Volume {
        thickness: 1.0,
        attenuation_distance: 1.0,
        attenuation_color: [LEFT; 3],
    });
    (compile(&description), index as u32)
}

/// Between two points in a convex ball of glass light goes through glass all the way, and where two walks are
/// joined there, the joint loses what the glass absorbs: path by path, by Beer's law.
#[test]
fn a_joint_within_glass_loses_what_the_glass_absorbs() {
    let (scene, glass) = ball();
    let paths = Bidirectional {
        settings: BuilderSettings {
            wavelengths: WavelengthSampling::Single,
            max_edges: 5,
            ..BuilderSettings::default()
        },
        form: Form::Full,
        heuristic: Heuristic::Power,
    };
    let builder = Multiplexed::new(paths, Techniques::even(1, 5, false));
    let joined = |s: u32, t: u32| s >= 2 && t >= 2;
    let mut out = Contributions::default();
    for technique in (builder.techniques().all()).filter(|known| joined(known.s, known.t)) {
        let mut source = Independent::new(generator(17, 0));
        let (mut used, mut shortest) = (0, 1.0_f64);
        for _ in 0..4_000 {
            let mut u = Recording::new(&mut source);
            let first = u.get(Stream::Wavelength, 0);
            let wavelengths = Wavelengths::sample(first, WavelengthSampling::Single);
            let mut last = LastJoint::default();
            Workspace::with(|w| builder.one(&scene, technique, &mut u, &mut out, w, &mut last));
            let (Some((length, materials, value)), [splat]) = (last.0, out.splats()) else {
                continue;
            };
            if materials != [glass; 2] {
                continue;
            }
            assert_eq!(splat.class, Class::L5);
            let left = f64::from(LEFT).powf(length);
            let expected = f64::from(wavelengths.to_xyz(value).sum()) * left;
            let found = f64::from(splat.xyz.sum());
            assert!(
                (found / expected - 1.0).abs() < 5e-3,
                "{technique:?}: {found} instead of {expected} after {length}"
            );
            shortest = shortest.min(left);
            used += 1;
        }
        assert!(used > 20 && shortest < 0.8, "{technique:?}: {used} joints");
    }
}
