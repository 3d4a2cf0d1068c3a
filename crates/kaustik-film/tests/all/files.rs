//! Round trips, reproducible bytes, files whole or not at all.

use crate::random::Random;
use kaustik_film::{
    Image, Keep, Layer, Limits, Tone, ToneCurve, WriteError, check_writable, decode, exr, png,
    read, write_file,
};
use std::io::{self, Cursor};
use std::path::Path;

pub(crate) fn planes(width: u32, height: u32, seed: u64) -> [Vec<f32>; 3] {
    let mut random = Random(seed);
    let count = (width * height) as usize;
    [0; 3].map(|_| (0..count).map(|_| (random.normal() * 3.0) as f32).collect())
}

pub(crate) fn layered(width: u32, height: u32) -> Image {
    let [x, y, z] = planes(width, height, 2);
    let [depth, ..] = planes(width, height, 3);
    let mut image = Image::from_rgb(width, height, planes(width, height, 1)).unwrap();
    image
        .push_layer(Layer::new("normal", vec![("X", x), ("Y", y), ("Z", z)]))
        .unwrap();
    image
        .push_layer(Layer::new("depth", vec![("Z", depth)]))
        .unwrap();
    let [r, g, b] = planes(width, height, 4);
    image
        .push_layer(Layer::new("replica.2", vec![("R", r), ("G", g), ("B", b)]))
        .unwrap();
    image.with_metadata(serde_json::json!({
        "method": "relt", "seed": 7, "normalisation": [1.5, 0.01], "scene": "Küche \u{1f600}", "z": null, "a": true,
    }))
}

pub(crate) fn encoded(image: &Image) -> Vec<u8> {
    let mut sink = Cursor::new(Vec::new());
    exr::encode(&mut sink, image).unwrap();
    sink.into_inner()
}

/// Layers sorted by name, as a file gives them back.
fn sorted(image: &Image) -> Vec<(String, String, Vec<u32>)> {
    let mut all = Vec::new();
    for layer in image.layers() {
        for channel in &layer.channels {
            let bits = channel.samples.iter().map(|v| v.to_bits()).collect();
            all.push((layer.name.clone(), channel.name.clone(), bits));
        }
    }
    all.sort();
    all
}

#[test]
fn exr_keeps_every_bit() {
    for (width, height) in [(1, 1), (5, 3), (33, 47)] {
        let mut image = layered(width, height).placed([11, 7], [100, 90]);
        let odd = [f32::NAN, f32::INFINITY, -0.0, f32::MIN_POSITIVE, 1e-42];
        let samples = odd
            .iter()
            .copied()
            .cycle()
            .take((width * height) as usize)
            .collect();
        image
            .push_layer(Layer::new("odd", vec![("V", samples)]))
            .unwrap();
        let back = decode(&encoded(&image), &Limits::default(), Keep::All).unwrap();
        assert_eq!(sorted(&back), sorted(&image));
        assert_eq!(back.metadata(), image.metadata());
        assert_eq!((back.origin(), back.full_size()), ([11, 7], [100, 90]));
        assert_eq!(back.rgb(), image.rgb());
        let main = decode(&encoded(&image), &Limits::default(), Keep::Main).unwrap();
        assert_eq!((main.layers().len(), main.rgb()), (1, image.rgb()));
    }
}

#[test]
fn exr_bytes_are_reproducible() {
    let first = encoded(&layered(40, 30));
    for _ in 0..20 {
        assert_eq!(first, encoded(&layered(40, 30)));
    }
}

#[test]
fn exr_is_read_by_the_library_alone() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.exr");
    let image = layered(20, 10);
    exr::write(&path, &image).unwrap();
    let other = ::exr::prelude::read_all_data_from_file(&path).unwrap();
    assert_eq!(other.layer_data.len(), 1);
    let names: Vec<String> = other.layer_data[0]
        .channel_data
        .list
        .iter()
        .map(|channel| channel.name.to_string())
        .collect();
    let expected = ["B", "G", "R", "depth.Z", "normal.X", "normal.Y", "normal.Z"];
    assert_eq!(names[..7], expected);
    assert_eq!(other.layer_data[0].attributes.other.len(), 1);
}

#[test]
fn png_round_trips_through_the_curve() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.png");
    let ramp: Vec<f32> = (0..256).map(|i| i as f32 / 255.0).collect();
    let image = Image::from_rgb(256, 1, [ramp.clone(), ramp.clone(), ramp]).unwrap();
    png::write(&path, &image, &Tone::default()).unwrap();
    let back = read(&path, &Limits::default(), Keep::All).unwrap();
    for (a, b) in image.rgb()[1].iter().zip(back.rgb()[1]) {
        // Half a code, whose width is largest at white.
        assert!((a - b).abs() < 0.5 * 2.3 / 255.0, "{a} {b}");
    }
    let mut again = Vec::new();
    png::encode(&mut again, &back, &Tone::default()).unwrap();
    assert_eq!(again, std::fs::read(&path).unwrap());
    let mut filmic = Vec::new();
    png::encode(
        &mut filmic,
        &back,
        &Tone {
            exposure: 1.5,
            curve: ToneCurve::Filmic,
        },
    )
    .unwrap();
    assert_ne!(filmic, again);
}

#[test]
fn radiance_files_are_read() {
    let pixels: Vec<image::Rgb<f32>> = vec![image::Rgb([1.0, 0.5, 0.25]); 12];
    let mut bytes = Vec::new();
    image::codecs::hdr::HdrEncoder::new(&mut bytes)
        .encode(&pixels, 4, 3)
        .unwrap();
    let back = decode(&bytes, &Limits::default(), Keep::All).unwrap();
    assert_eq!((back.width(), back.height()), (4, 3));
    assert!((back.rgb()[2][5] - 0.25).abs() < 0.01);
}

fn entries(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(folder)
        .unwrap()
        .map(|e| e.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

#[test]
fn a_failed_write_leaves_the_old_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.bin");
    write_file(&path, |sink| sink.write_all(b"old")).unwrap();
    let failed = write_file(&path, |sink| {
        sink.write_all(&[0; 100_000])?;
        Err(io::Error::other("disk full"))
    });
    assert!(
        failed
            .unwrap_err()
            .to_string()
            .contains("out.bin: writing failed: disk full")
    );
    assert_eq!(std::fs::read(&path).unwrap(), b"old");
    assert_eq!(entries(folder.path()), ["out.bin"]);
    write_file(&path, |sink| sink.write_all(b"new")).unwrap();
    assert_eq!(std::fs::read(&path).unwrap(), b"new");
}

#[test]
fn what_cannot_be_written_is_known_before() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    check_writable(&at("new.exr")).unwrap();
    assert!(entries(folder.path()).is_empty());
    assert!(matches!(
        check_writable(&at("no/out.exr")),
        Err(WriteError::NoFolder { .. })
    ));
    assert!(matches!(
        check_writable(folder.path()),
        Err(WriteError::NotAFile(_))
    ));
    assert!(matches!(
        check_writable(&at("out.exr/")),
        Err(WriteError::NotAFile(_))
    ));
    assert!(matches!(
        check_writable(Path::new("")),
        Err(WriteError::NotAFile(_))
    ));
    assert!(check_writable(&at(&"x".repeat(300))).is_err());
    std::fs::write(at("file"), b"").unwrap();
    assert!(matches!(
        check_writable(&at("file/out.exr")),
        Err(WriteError::NoFolder { .. })
    ));
    let message = check_writable(&at("no/out.exr")).unwrap_err().to_string();
    assert!(
        message.contains("out.exr") && message.contains("expected an existing folder"),
        "{message}"
    );
    let mut permissions = std::fs::metadata(at("file")).unwrap().permissions();
    permissions.set_readonly(true);
    std::fs::set_permissions(at("file"), permissions).unwrap();
    assert!(matches!(
        check_writable(&at("file")),
        Err(WriteError::NotWritable { .. })
    ));
    assert!(write_file(&at("file"), |_| Ok(())).is_err());
}

#[cfg(unix)]
#[test]
fn links_permissions_and_devices_are_respected() {
    use std::os::unix::fs::{PermissionsExt as _, symlink};
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let mode = |name: &str| std::fs::metadata(at(name)).unwrap().permissions().mode() & 0o777;
    write_file(&at("fresh"), |sink| sink.write_all(b"1")).unwrap();
    std::fs::write(at("usual"), b"1").unwrap();
    assert_eq!(mode("fresh"), mode("usual"));
    std::fs::set_permissions(at("fresh"), std::fs::Permissions::from_mode(0o600)).unwrap();
    write_file(&at("fresh"), |sink| sink.write_all(b"2")).unwrap();
    assert_eq!(mode("fresh"), 0o600);

    symlink("fresh", at("link")).unwrap();
    write_file(&at("link"), |sink| sink.write_all(b"3")).unwrap();
    assert!(std::fs::symlink_metadata(at("link")).unwrap().is_symlink());
    assert_eq!(std::fs::read(at("fresh")).unwrap(), b"3");
    symlink("nowhere", at("dangling")).unwrap();
    write_file(&at("dangling"), |sink| sink.write_all(b"4")).unwrap();
    assert_eq!(std::fs::read(at("nowhere")).unwrap(), b"4");
    symlink("loop", at("loop")).unwrap();
    assert!(check_writable(&at("loop")).is_err());

    // what the caller has open is added to, not replaced
    let open = std::fs::OpenOptions::new()
        .append(true)
        .open(at("fresh"))
        .unwrap();
    let descriptor = format!("/dev/fd/{}", std::os::fd::AsRawFd::as_raw_fd(&open));
    check_writable(Path::new(&descriptor)).unwrap();
    write_file(Path::new(&descriptor), |sink| sink.write_all(b"+")).unwrap();
    assert_eq!(std::fs::read(at("fresh")).unwrap(), b"3+");
    let (mut reader, writer) = std::io::pipe().unwrap();
    let descriptor = format!("/dev/fd/{}", std::os::fd::AsRawFd::as_raw_fd(&writer));
    check_writable(Path::new(&descriptor)).unwrap();
    write_file(Path::new(&descriptor), |sink| sink.write_all(b"piped")).unwrap();
    drop(writer);
    let mut piped = String::new();
    std::io::Read::read_to_string(&mut reader, &mut piped).unwrap();
    assert_eq!(piped, "piped");

    check_writable(Path::new("/dev/null")).unwrap();
    write_file(Path::new("/dev/null"), |sink| sink.write_all(b"5")).unwrap();
    assert!(!std::fs::metadata("/dev/null").unwrap().is_file());
    if Path::new("/dev/full").exists() {
        assert!(write_file(Path::new("/dev/full"), |sink| sink.write_all(b"6")).is_err());
    }
    assert!(read(Path::new("/dev/zero"), &Limits::default(), Keep::All).is_err());
}

#[test]
fn names_that_would_not_survive_a_file_are_refused() {
    let mut image = Image::from_rgb(1, 1, [vec![0.0], vec![0.0], vec![0.0]]).unwrap();
    for (layer, channel) in [("", "A"), ("a", "x.y"), ("a", ""), ("é", "R"), ("a", "\n")] {
        assert!(
            image
                .push_layer(Layer::new(layer, vec![(channel, vec![0.0])]))
                .is_err(),
            "{layer}.{channel}"
        );
    }
    image
        .push_layer(Layer::new("a", vec![("V", vec![0.0])]))
        .unwrap();
    assert!(
        image
            .push_layer(Layer::new("a", vec![("W", vec![0.0])]))
            .is_err()
    );
    assert!(
        image
            .push_layer(Layer::new("b", vec![("V", vec![0.0, 1.0])]))
            .is_err()
    );
    assert!(Image::from_rgb(0, 1, [vec![], vec![], vec![]]).is_err());
}
