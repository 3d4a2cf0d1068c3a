use kaustik_mcmc::{Independent, generator, sample_generator};
use kaustik_pss::Recording;
use kaustik_scene::{Scene, builtin};

use super::traced::compile;
use crate::bidirectional::witness::{Joint, Seen, Witness};
use crate::bidirectional::workspace::Workspace;
use crate::{
    Bidirectional, BuilderSettings, Contributions, Form, Heuristic, Multiplexed, PathBuilder,
    RayCounts, Techniques, Unidirectional,
};

const POINTS: u64 = 2_000;

fn room() -> Scene {
    compile(&builtin::load("cornell").expect("a built-in scene"))
}

fn paths(form: Form, heuristic: Heuristic) -> Bidirectional {
    let settings = BuilderSettings {
        max_edges: 6,
        ..BuilderSettings::default()
    };
    Bidirectional {
        settings,
        form,
        heuristic,
    }
}

/// The paths whose visibility is asked for.
#[derive(Default)]
struct Joints(u64);

impl Witness for Joints {
    fn see(&mut self, seen: &Seen<'_>) {
        let asks = matches!(
            seen.joint,
            Joint::Direct(_) | Joint::Lens(_) | Joint::Surfaces
        );
        self.0 += u64::from(asks);
    }
}

/// Every joint that is not black takes a shadow ray and nothing else does, in all forms; and a multiplexed path
/// takes no more rays than its strategy has edges.
#[test]
fn shadow_rays_are_joints() {
    let scene = room();
    let mut out = Contributions::default();
    for form in [Form::Full, Form::Simple] {
        let builder = paths(form, Heuristic::Power);
        let mut shadows = 0;
        for point in 0..POINTS {
            let mut u = Independent::new(sample_generator(31, 0, point));
            let mut joints = Joints::default();
            Workspace::with(|w| builder.evaluate(&scene, &mut u, &mut out, w, &mut joints));
            assert_eq!(out.rays().any, joints.0, "{form:?}, point {point}");
            shadows += joints.0;
        }
        assert!(shadows > POINTS / 4, "{form:?}: {shadows}");
    }
    let builder = Multiplexed::new(
        paths(Form::Full, Heuristic::Power),
        Techniques::even(1, 6, false),
    );
    for technique in builder.techniques().all() {
        let (mut source, mut most) = (Independent::new(generator(32, 0)), 0);
        for _ in 0..POINTS / 10 {
            let mut u = Recording::new(&mut source);
            let mut joints = Joints::default();
            Workspace::with(|w| builder.one(&scene, technique, &mut u, &mut out, w, &mut joints));
            let RayCounts { closest, any } = out.rays();
            assert_eq!(any, joints.0, "{technique:?}");
            most = most.max(closest + any);
        }
        assert_eq!(
            most,
            u64::from(technique.s + technique.t - 1),
            "{technique:?}"
        );
    }
}

/// What the maximum heuristic is for (Kelemen sec. 2): one strategy alone has a path, so that many joints are
/// black before a ray is traced. The walks stay the same.
#[test]
fn the_maximum_heuristic_saves_shadow_rays() {
    let scene = room();
    let [power, maximum] = [Heuristic::Power, Heuristic::Maximum].map(|heuristic| {
        let (builder, mut out) = (paths(Form::Full, heuristic), Contributions::default());
        let mut sum = RayCounts::default();
        for point in 0..POINTS {
            let mut u = Independent::new(sample_generator(33, 0, point));
            builder.build(&scene, &mut u, &mut out);
            sum += out.rays();
        }
        sum
    });
    assert_eq!(power.closest, maximum.closest);
    assert!(3 * maximum.any < 2 * power.any, "{maximum:?}, {power:?}");
}

/// A walk of the path tracer by hand: an edge a ray, and a shadow ray at most for each vertex that is not the last.
#[test]
fn a_path_tracer_counts_edges() {
    let scene = room();
    let mut out = Contributions::default();
    for most in 1..4 {
        let settings = BuilderSettings {
            max_edges: most,
            ..BuilderSettings::default()
        };
        let (mut seen, most) = (RayCounts::default(), u64::from(most));
        for next_event in [false, true] {
            let builder = Unidirectional {
                settings,
                next_event,
            };
            for point in 0..POINTS {
                let mut u = Independent::new(sample_generator(34, 0, point));
                builder.build(&scene, &mut u, &mut out);
                let RayCounts { closest, any } = out.rays();
                assert!((1..=most).contains(&closest) && any < closest.max(most));
                assert!(next_event || any == 0);
                seen.closest = seen.closest.max(closest);
                seen.any = seen.any.max(any);
            }
        }
        assert_eq!((seen.closest, seen.any), (most, most - 1));
    }
}
