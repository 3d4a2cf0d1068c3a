//! After warm-up a mutation allocates nothing. (A binary of its own: it owns the allocator.)

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use glam::{DAffine3, DVec2};
use kaustik_mcmc::{
    Deposit, Draws, Ignore, Metropolis, Mixture, Redistribution, Redistributor, generator,
};
use kaustik_mutate::{
    BidirectionalMutation, CausticPerturbation, EveryPerturbation, LensMutation, LensPerturbation,
    Path, PathSpace, Radii, Run, Seeds, TimeMutation, Tracer, WavelengthMutation,
};
use kaustik_path::{BuilderSettings, ScalarTarget};
use kaustik_scene::description::{Carried, Channel, Interpolation, Joint, Load, Rest, Shutter};
use kaustik_scene::{Scene, SceneOptions, builtin};

/// The system's allocator, counting what each thread asks for.
struct Counting;

thread_local! {
    static COUNT: Cell<u64> = const { Cell::new(0) };
}

#[expect(
    unsafe_code,
    reason = "an allocator can only be written so; it forwards to System"
)]
// SAFETY: every call is passed on to `System` unchanged; the counter neither allocates nor
// unwinds (a const-initialised Cell without a destructor).
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        COUNT.with(|count| count.set(count.get() + 1));
        // SAFETY: the caller's promise is passed on
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        // SAFETY: the caller's promise is passed on
        unsafe { System.dealloc(memory, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn allocations() -> u64 {
    COUNT.with(Cell::get)
}

fn scene() -> Scene {
    let description = builtin::load("ring-and-sphere").expect("a built-in scene");
    let options = SceneOptions {
        width: 32,
        height: 32,
        ..SceneOptions::default()
    };
    Scene::new(&description, &options).expect("a sound scene")
}

fn space(scene: &Scene) -> PathSpace<'_> {
    PathSpace {
        scene,
        settings: BuilderSettings {
            max_edges: 11,
            ..BuilderSettings::default()
        },
        target: ScalarTarget::Xyz,
        pixels: DVec2::splat(32.0),
    }
}

/// The same with a shutter that is open while something solid goes aside.
fn moving_scene() -> Scene {
    let mut description = builtin::load("ring-and-sphere").expect("a built-in scene");
    let still = Rest {
        translation: [0.0; 3],
        rotation: [0.0, 0.0, 0.0, 1.0],
        scale: [1.0; 3],
    };
    for instance in 0..description.instances.len() {
        let joint = description.animation.joints.len();
        description.animation.carried.push(Carried {
            load: Load::Instance(instance),
            joint,
            offset: DAffine3::IDENTITY,
        });
        description.animation.joints.push(Joint {
            name: String::new(),
            parent: None,
            to_parent: DAffine3::IDENTITY,
            rest: still,
            translation: Some(Channel {
                interpolation: Interpolation::Linear,
                times: vec![0.0, 1.0],
                values: vec![[0.0; 3], [0.02 * instance as f32, 0.0, 0.0]],
            }),
            rotation: None,
            scale: None,
        });
    }
    let (open, close) = (0.0, 1.0);
    description.cameras[0].shutter = Some(Shutter { open, close });
    let options = SceneOptions {
        width: 32,
        height: 32,
        ..SceneOptions::default()
    };
    Scene::new(&description, &options).expect("a sound scene")
}

#[test]
fn a_mutation_allocates_nothing_after_warm_up() {
    mutations_allocate_nothing(&scene());
}

#[test]
fn a_mutation_of_what_moves_allocates_nothing_after_warm_up() {
    let scene = moving_scene();
    assert!(scene.moves());
    mutations_allocate_nothing(&scene);
}

fn mutations_allocate_nothing(scene: &Scene) {
    let space = &space(scene);
    let radii = Radii::raster(space.pixels);
    let lens = |run| LensPerturbation {
        space,
        radii,
        angles: Radii::angles(),
        run,
    };
    let kernels = (
        BidirectionalMutation { space },
        lens(Run::Single),
        lens(Run::Multiple),
        CausticPerturbation { space, radii },
        LensMutation { space },
        WavelengthMutation { space },
        TimeMutation { space },
    );
    let kernel = Mixture::<_, _, 7>::new(kernels, [1.0; 7]);
    let density = |path: &Path| [path.density()];
    let (mut rng, mut seeds) = (generator(1, 0), Seeds::new(space));
    let mut path = Path::default();
    while seeds.sample(&mut path, &mut rng) <= 0.0 {}
    let mut chain = Metropolis::at((), path, &density, 0);
    for _ in 0..20_000 {
        chain.step(&kernel, &density, &mut rng, &mut Ignore);
    }
    let before = allocations();
    for _ in 0..20_000 {
        chain.step(&kernel, &density, &mut rng, &mut Ignore);
    }
    assert_eq!(allocations(), before);
    let moves = chain.statistics().moves;
    let kinds = if scene.moves() { 7 } else { 6 };
    let all = moves[..kinds].iter().all(|kind| kind.accepted > 0);
    assert!(all, "{moves:?}");
}

#[test]
fn moving_all_variables_allocates_nothing_after_warm_up() {
    for scene in [scene(), moving_scene()] {
        let space = &space(&scene);
        let fraction = 0.02;
        let kernels = (
            BidirectionalMutation { space },
            EveryPerturbation { space, fraction },
        );
        let kernel = Mixture::<_, _, 2>::new(kernels, [1.0; 2]);
        let density = |path: &Path| [path.density()];
        let (mut rng, mut seeds) = (generator(1, 0), Seeds::new(space));
        let mut path = Path::default();
        while seeds.sample(&mut path, &mut rng) <= 0.0 {}
        let mut chain = Metropolis::at((), path, &density, 0);
        let mut run = || {
            for _ in 0..20_000 {
                chain.step(&kernel, &density, &mut rng, &mut Ignore);
            }
            chain.statistics().moves
        };
        run();
        let before = allocations();
        let moves = run();
        assert_eq!(allocations(), before);
        assert!(moves[1].accepted > 0, "{moves:?}");
    }
}

/// Samples between mutations, of which the running normaliser is made.
#[test]
fn a_sample_from_both_sides_allocates_nothing_after_warm_up() {
    for scene in [scene(), moving_scene()] {
        let space = &space(&scene);
        let (mut rng, mut seeds) = (generator(1, 0), Seeds::new(space));
        let mut path = Path::default();
        let mut run = || -> usize {
            let lit = (0..10_000).filter(|_| seeds.sample(&mut path, &mut rng) > 0.0);
            lit.count()
        };
        run();
        let before = allocations();
        let lit = run();
        assert_eq!(allocations(), before);
        assert!(lit > 1_000, "{lit}");
    }
}

/// A path tracer's samples with all their chains.
#[test]
fn a_start_and_its_chains_allocate_nothing_after_warm_up() {
    let scene = scene();
    let space = &space(&scene);
    let radii = Radii::raster(space.pixels);
    let lens = |run| LensPerturbation {
        space,
        radii,
        angles: Radii::angles(),
        run,
    };
    let kernels = (
        lens(Run::Single),
        lens(Run::Multiple),
        CausticPerturbation { space, radii },
        WavelengthMutation { space },
    );
    let suits = |path: &Path| {
        let (single, multiple, caustic, _) = &kernels;
        let weight = |suits: bool| f64::from(u8::from(suits));
        [
            weight(single.suits(path)),
            weight(multiple.suits(path)),
            weight(caustic.suits(path)),
            0.25,
        ]
    };
    let kernel = Mixture::<_, _, 4>::new(kernels, suits);
    let density = |path: &Path| [path.density()];
    let plan = Redistribution::new(20, 0.01).expect("a plan");
    let (mut rng, mut tracer, mut chains) = (generator(1, 0), Tracer::new(), Redistributor::new());
    let (mut draws, mut light) = (generator(1, 1), 0.0);
    let mut samples = |count: usize| {
        for _ in 0..count {
            let start = (DVec2::new(rng.uniform(), rng.uniform()), rng.uniform());
            tracer.sample(space, start, true, &mut rng, &mut |path, weight| {
                let mut deposit = |deposit: Deposit<'_, Path>| light += deposit.weight();
                let start = (&(), path, weight);
                chains.run(&plan, start, &kernel, &density, &mut draws, &mut deposit);
            });
        }
        chains.statistics().chain.moves
    };
    samples(2_000);
    let before = allocations();
    let moves = samples(2_000);
    assert_eq!(allocations(), before);
    assert!(moves[..4].iter().all(|kind| kind.accepted > 0), "{moves:?}");
    assert!(light > 0.0);
}
