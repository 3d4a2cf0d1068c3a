//! Ours against Embree 4, single rays, one thread, same process, same triangles, same rays.
//!
//! `KAUSTIK_EMBREE=/path/to/libembree4.so cargo bench -p kaustik-geometry --bench embree [-- NAME]`. Without the
//! library ours is timed alone. Times are the thread's processor time; the two take turns, and each ratio is the median
//! of the turns' ratios, so that a busy machine changes little.
#![allow(
    unsafe_code,
    clippy::print_stdout,
    reason = "calls a C library and reports to the terminal"
)]

mod support;

use std::ffi::{c_char, c_void};
use std::time::Instant;

use glam::Vec3;
use kaustik_geometry::{Mesh, Ray, World};
use libloading::{Library, Symbol};
use support::{Random, bounces, cave, cornell, primary, shadows, single, terrain};

const TURNS: usize = 9;

/// How many rays hit.
type Count<'a> = &'a dyn Fn(&[Ray]) -> usize;

#[repr(C, align(16))]
#[derive(Clone, Copy)]
struct RtcRay {
    org: [f32; 3],
    tnear: f32,
    dir: [f32; 3],
    time: f32,
    tfar: f32,
    mask: u32,
    id: u32,
    flags: u32,
}

#[repr(C, align(16))]
#[derive(Clone, Copy)]
struct RtcHit {
    normal: [f32; 3],
    uv: [f32; 2],
    primitive: u32,
    geometry: u32,
    instance: [u32; 2],
}

#[repr(C, align(16))]
#[derive(Clone, Copy)]
struct RtcRayHit {
    ray: RtcRay,
    hit: RtcHit,
}

type Pointer = *mut c_void;

struct Embree<'a> {
    scene: Pointer,
    intersect: Symbol<'a, unsafe extern "C" fn(Pointer, *mut RtcRayHit, Pointer)>,
    occluded: Symbol<'a, unsafe extern "C" fn(Pointer, *mut RtcRay, Pointer)>,
}

impl<'a> Embree<'a> {
    fn new(library: &'a Library, mesh: &Mesh) -> Option<Embree<'a>> {
        // SAFETY: the signatures are those of embree4/rtcore.h; buffers are as long as announced.
        unsafe {
            let device: Symbol<unsafe extern "C" fn(*const c_char) -> Pointer> =
                library.get(b"rtcNewDevice").ok()?;
            let scene: Symbol<unsafe extern "C" fn(Pointer) -> Pointer> =
                library.get(b"rtcNewScene").ok()?;
            let quality: Symbol<unsafe extern "C" fn(Pointer, i32)> =
                library.get(b"rtcSetSceneBuildQuality").ok()?;
            let geometry: Symbol<unsafe extern "C" fn(Pointer, i32) -> Pointer> =
                library.get(b"rtcNewGeometry").ok()?;
            let buffer: Symbol<
                unsafe extern "C" fn(Pointer, i32, u32, i32, usize, usize) -> Pointer,
            > = library.get(b"rtcSetNewGeometryBuffer").ok()?;
            let commit: Symbol<unsafe extern "C" fn(Pointer)> =
                library.get(b"rtcCommitGeometry").ok()?;
            let attach: Symbol<unsafe extern "C" fn(Pointer, Pointer) -> u32> =
                library.get(b"rtcAttachGeometry").ok()?;
            let finish: Symbol<unsafe extern "C" fn(Pointer)> =
                library.get(b"rtcCommitScene").ok()?;
            let device = device(c"threads=1".as_ptr());
            let scene = scene(device);
            quality(scene, 1);
            let geometry = geometry(device, 0);
            let indices = buffer(geometry, 0, 0, 0x5003, 12, mesh.indices.len());
            std::ptr::copy_nonoverlapping(
                mesh.indices.as_ptr().cast::<u32>(),
                indices.cast(),
                mesh.indices.len() * 3,
            );
            let vertices = buffer(geometry, 1, 0, 0x9003, 12, mesh.positions.len());
            std::ptr::copy_nonoverlapping(
                mesh.positions.as_ptr().cast::<f32>(),
                vertices.cast(),
                mesh.positions.len() * 3,
            );
            commit(geometry);
            attach(scene, geometry);
            finish(scene);
            Some(Embree {
                scene,
                intersect: library.get(b"rtcIntersect1").ok()?,
                occluded: library.get(b"rtcOccluded1").ok()?,
            })
        }
    }

    fn ray(ray: &Ray) -> RtcRay {
        RtcRay {
            org: ray.origin.to_array(),
            tnear: ray.t_min,
            dir: ray.direction.to_array(),
            time: 0.0,
            tfar: ray.t_max,
            mask: u32::MAX,
            id: 0,
            flags: 0,
        }
    }

    fn hits(&self, rays: &[Ray]) -> usize {
        let none = RtcHit {
            normal: [0.0; 3],
            uv: [0.0; 2],
            primitive: u32::MAX,
            geometry: u32::MAX,
            instance: [u32::MAX; 2],
        };
        let hit = |ray: &&Ray| {
            let mut query = RtcRayHit {
                ray: Self::ray(ray),
                hit: none,
            };
            // SAFETY: the scene is committed, the query is aligned.
            unsafe { (self.intersect)(self.scene, &mut query, std::ptr::null_mut()) };
            query.hit.geometry != u32::MAX
        };
        rays.iter().filter(hit).count()
    }

    fn blocked(&self, rays: &[Ray]) -> usize {
        let blocked = |ray: &&Ray| {
            let mut query = Self::ray(ray);
            // SAFETY: the scene is committed, the query is aligned.
            unsafe { (self.occluded)(self.scene, &mut query, std::ptr::null_mut()) };
            query.tfar < 0.0
        };
        rays.iter().filter(blocked).count()
    }
}

/// Processor seconds of this thread.
fn now() -> f64 {
    type Clock = unsafe extern "C" fn(i32, *mut [i64; 2]) -> i32;
    let library = libloading::os::unix::Library::this();
    let mut time = [0i64; 2];
    // SAFETY: `clock_gettime` with CLOCK_THREAD_CPUTIME_ID writes two words.
    unsafe {
        let clock = library.get::<Clock>(b"clock_gettime").expect("a C library");
        clock(3, &mut time);
    }
    time[0] as f64 + time[1] as f64 * 1e-9
}

fn timed(work: impl FnOnce() -> usize) -> (f64, usize) {
    let start = now();
    let count = work();
    (now() - start, count)
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn compare(name: &str, rays: &[Ray], ours: impl Fn(&[Ray]) -> usize, theirs: Option<Count<'_>>) {
    let (mut own, mut other, mut ratio) = (Vec::new(), Vec::new(), Vec::new());
    let mut counts = (0, 0);
    for _ in 0..TURNS {
        let (mut a, mut b) = (0.0, 0.0);
        counts = (0, 0);
        for chunk in rays.chunks(rays.len().div_ceil(8)) {
            let (time, count) = timed(|| ours(chunk));
            a += time;
            counts.0 += count;
            if let Some(theirs) = theirs {
                let (time, count) = timed(|| theirs(chunk));
                b += time;
                counts.1 += count;
            }
        }
        own.push(a / rays.len() as f64 * 1e9);
        other.push(b / rays.len() as f64 * 1e9);
        ratio.push(b / a);
    }
    if theirs.is_none() {
        println!(
            "  {name:9} ours {:7.1} ns/ray ({} of {} hit)",
            median(own),
            counts.0,
            rays.len()
        );
        return;
    }
    println!(
        "  {name:9} ours {:7.1} ns/ray, Embree {:7.1} ns/ray, ratio {:.2} (hits {} and {} of {})",
        median(own),
        median(other),
        median(ratio),
        counts.0,
        counts.1,
        rays.len()
    );
}

fn scene(name: &str, library: Option<&Library>, mesh: Mesh, eye: Vec3, at: Vec3) {
    let embree = library.and_then(|l| Embree::new(l, &mesh));
    let triangles = mesh.triangle_count() as f64;
    let arrays = mesh.memory();
    let start = Instant::now();
    let world: World = single(mesh);
    let bytes = (world.memory() + arrays) as f64 / triangles;
    println!(
        "{name}: {triangles} triangles, {bytes:.0} bytes each, built in {:.2} s",
        start.elapsed().as_secs_f64()
    );
    let mut random = Random(1);
    let first = primary(eye, at, 512);
    let second = bounces(&world, &first, &mut random);
    let third = bounces(&world, &second, &mut random);
    let segments = shadows(&world, &second, &mut random);
    let closest = |rays: &[Ray]| rays.iter().filter(|r| world.intersect(r).is_some()).count();
    let any = |rays: &[Ray]| rays.iter().filter(|r| world.occluded(r)).count();
    let hits = embree.as_ref().map(|e| move |rays: &[Ray]| e.hits(rays));
    let blocked = embree.as_ref().map(|e| move |rays: &[Ray]| e.blocked(rays));
    let hits = hits.as_ref().map(|f| f as Count<'_>);
    let blocked = blocked.as_ref().map(|f| f as Count<'_>);
    compare("primary", &first, closest, hits);
    compare("bounce", &third, closest, hits);
    compare("occluded", &segments, any, blocked);
}

fn main() {
    let path = std::env::var("KAUSTIK_EMBREE").unwrap_or_default();
    // SAFETY: loading runs the library's initialisers, as the caller asked.
    let library = unsafe { Library::new(&path) };
    if let Err(error) = &library {
        println!("Embree is not compared ({error}); set KAUSTIK_EMBREE to the path of libembree4");
    }
    // Never unloaded: its worker threads outlive the last scene.
    let library = library.ok().map(|l| &*Box::leak(Box::new(l)));
    let wanted = std::env::args()
        .skip(1)
        .find(|a| !a.starts_with('-'))
        .unwrap_or_default();
    let run = |name: &str, mesh: &dyn Fn() -> Mesh, eye: Vec3, at: Vec3| {
        if name.contains(&wanted) {
            scene(name, library, mesh(), eye, at);
        }
    };
    run("cornell", &cornell, Vec3::new(0.0, 0.0, 3.4), Vec3::ZERO);
    let (inside, above) = (Vec3::new(0.0, 0.0, 2.9), Vec3::new(0.0, 4.0, 4.5));
    run("cave 300k", &|| cave(300_000), inside, Vec3::ZERO);
    run("terrain 300k", &|| terrain(300_000), above, Vec3::ZERO);
    run("cave 2M", &|| cave(2_000_000), inside, Vec3::ZERO);
    run("terrain 2M", &|| terrain(2_000_000), above, Vec3::ZERO);
}
