//! Files that lie. Each must give an error or an image: no panic, no abort, bounded memory and time.

use crate::files::{encoded, layered};
use crate::random::Random;
use exr::prelude::*;
use kaustik_film::{DecodeError, Keep, Limits, Tone, decode, png};
use std::io::Cursor;
use std::time::{Duration, Instant};

const LIMITS: Limits = Limits {
    max_file_bytes: 1 << 20,
    max_side: 4096,
    max_samples: 1 << 20,
};

/// Sound files of all compressions, of scan lines, tiles and several parts.
fn corpus() -> Vec<(String, Vec<u8>)> {
    let mut corpus = vec![("ours".to_owned(), encoded(&layered(21, 37)))];
    let compressions = [
        Compression::Uncompressed,
        Compression::RLE,
        Compression::ZIP1,
        Compression::ZIP16,
        Compression::PIZ,
        Compression::PXR24,
        Compression::B44,
        Compression::B44A,
        Compression::DWAA(None),
        Compression::DWAB(None),
    ];
    for compression in compressions {
        for tiles in [false, true] {
            let blocks = if tiles {
                Blocks::Tiles(Vec2(16, 8))
            } else {
                Blocks::ScanLines
            };
            let encoding = Encoding {
                compression,
                blocks,
                line_order: LineOrder::Increasing,
            };
            corpus.push((format!("{compression:?} {tiles}"), foreign(encoding, 1)));
        }
    }
    let encoding = Encoding {
        compression: Compression::ZIP16,
        blocks: Blocks::ScanLines,
        line_order: LineOrder::Increasing,
    };
    corpus.push(("three parts".into(), foreign(encoding, 3)));
    corpus
}

/// A smooth picture with one half, three float and one integer channel, written by the library.
fn foreign(encoding: Encoding, parts: usize) -> Vec<u8> {
    let size = Vec2(40, 21);
    let smooth = |k: usize| {
        move |i: usize| {
            ((i % 40) as f32 * 0.1 + k as f32).sin() * 0.4 + 0.5 + (i / 40) as f32 * 0.01
        }
    };
    let make = |part: usize| {
        let float = |k| FlatSamples::F32((0..size.area()).map(smooth(k + part)).collect());
        let half = FlatSamples::F16((0..size.area()).map(smooth(9)).map(f16::from_f32).collect());
        let mut list = vec![
            AnyChannel::new("A", half),
            AnyChannel::new("B", float(0)),
            AnyChannel::new("G", float(1)),
            AnyChannel::new("R", float(2)),
        ];
        if !matches!(
            encoding.compression,
            Compression::DWAA(_) | Compression::DWAB(_)
        ) {
            list.push(AnyChannel::new(
                "id",
                FlatSamples::U32((0..size.area() as u32).collect()),
            ));
        }
        let attributes = LayerAttributes::named(format!("layer{part}").as_str());
        exr::prelude::Layer::new(
            size,
            attributes,
            encoding,
            AnyChannels::sort(list.into_iter().collect()),
        )
    };
    let layers: Vec<_> = (0..parts).map(make).collect();
    let image = exr::prelude::Image::from_layers(ImageAttributes::with_size(size), layers);
    let mut sink = Cursor::new(Vec::new());
    image.write().non_parallel().to_buffered(&mut sink).unwrap();
    sink.into_inner()
}

#[test]
fn sound_files_of_every_kind_are_read_as_the_library_reads_them() {
    for (name, bytes) in corpus() {
        let ours =
            decode(&bytes, &LIMITS, Keep::All).unwrap_or_else(|error| panic!("{name}: {error}"));
        let theirs = read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .first_valid_layer()
            .all_attributes()
            .non_parallel()
            .from_buffered(Cursor::new(&bytes))
            .unwrap();
        for channel in &theirs.layer_data.channel_data.list {
            let full = channel.name.to_string();
            let (layer, name_) = full.rsplit_once('.').unwrap_or(("", &full));
            let plane = ours
                .layer(layer)
                .and_then(|l| l.channel(name_))
                .unwrap_or_else(|| panic!("{name}: {full}"));
            let expected: Vec<u32> = channel
                .sample_data
                .values_as_f32()
                .map(f32::to_bits)
                .collect();
            let found: Vec<u32> = plane.iter().map(|v| v.to_bits()).collect();
            assert_eq!(found, expected, "{name}: {full}");
        }
    }
    let parts = corpus().pop().unwrap().1;
    let image = decode(&parts, &LIMITS, Keep::All).unwrap();
    assert!(image.layer("layer1").is_some() && image.layer("layer2").is_some());
    assert_eq!(
        decode(&parts, &LIMITS, Keep::Main).unwrap().layers().len(),
        1
    );
}

/// One of several ways of spoiling a file.
fn spoil(bytes: &mut Vec<u8>, random: &mut Random) {
    let head = bytes.len().min(600);
    match random.below(8) {
        0 => bytes.truncate(random.below(bytes.len())),
        1 => bytes.truncate(random.below(head)),
        2 => {
            let at = random.below(bytes.len());
            bytes[at] ^= 1 << random.below(8);
        }
        3 => {
            for _ in 0..random.below(30) + 1 {
                let at = random.below(bytes.len());
                bytes[at] = random.bits() as u8;
            }
        }
        // A number somewhere in the head becomes an extreme one.
        4 | 5 if head > 8 => {
            let extremes = [0, 1, -1, i32::MAX, i32::MIN, 65535, 65536, 1 << 24, 255];
            let at = random.below(head - 4);
            bytes[at..at + 4]
                .copy_from_slice(&extremes[random.below(extremes.len())].to_le_bytes());
        }
        // The same anywhere, with eight bytes.
        6 if bytes.len() > 8 => {
            let at = random.below(bytes.len() - 8);
            let extremes = [0, u64::MAX, i64::MAX as u64, 1 << 40, u64::from(u32::MAX)];
            bytes[at..at + 8]
                .copy_from_slice(&extremes[random.below(extremes.len())].to_le_bytes());
        }
        _ => {
            let (from, to) = (random.below(bytes.len()), random.below(bytes.len()));
            let length = random.below(64).min(bytes.len() - from.max(to));
            bytes.copy_within(from..from + length, to);
        }
    }
}

/// Peak memory of this process in MiB, where the system says.
fn peak() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM"))?;
    Some(line.split_whitespace().nth(1)?.parse::<u64>().ok()? / 1024)
}

/// Returns how many were read all the same.
fn campaign(rounds: usize, seed: u64) -> usize {
    let mut corpus = corpus();
    let mut bytes = Vec::new();
    png::encode(&mut bytes, &layered(30, 20), &Tone::default()).unwrap();
    corpus.push(("png".into(), bytes));
    let mut random = Random(seed);
    let (mut read, mut slowest) = (0, Duration::ZERO);
    for round in 0..rounds {
        let (name, sound) = &corpus[round % corpus.len()];
        let mut bytes = sound.clone();
        for _ in 0..random.below(3) + 1 {
            if !bytes.is_empty() {
                spoil(&mut bytes, &mut random);
            }
        }
        let keep = if round % 2 == 0 {
            Keep::All
        } else {
            Keep::Main
        };
        let start = Instant::now();
        match std::panic::catch_unwind(|| decode(&bytes, &LIMITS, keep)) {
            Ok(Ok(_)) => read += 1,
            Ok(Err(error)) => assert!(!error.to_string().is_empty()),
            Err(_) => panic!("{name}, round {round}: a panic reached the caller"),
        }
        slowest = slowest.max(start.elapsed());
    }
    assert!(slowest < Duration::from_secs(2), "{slowest:?}");
    println!(
        "{rounds} files, {read} read, slowest {slowest:?}, peak {:?} MiB",
        peak()
    );
    read
}

#[test]
fn mutated_files_are_errors_or_images() {
    let read = campaign(1500, 1);
    assert!(read > 0 && read < 1500);
    if let Some(peak) = peak() {
        assert!(peak < 512, "{peak} MiB");
    }
}

/// `cargo test -p kaustik-film --release -- --ignored --nocapture many_mutated`.
#[test]
#[ignore = "long"]
fn many_mutated_files_are_survived() {
    for seed in 2..12 {
        campaign(20_000, seed);
    }
}

/// A file whose `dataWindow` says another size.
fn with_window(mut bytes: Vec<u8>, corners: [i32; 4]) -> Vec<u8> {
    let name = b"dataWindow\0box2i\0";
    let at = bytes.windows(name.len()).position(|w| w == name).unwrap() + name.len() + 4;
    for (i, corner) in corners.iter().enumerate() {
        bytes[at + 4 * i..at + 4 * i + 4].copy_from_slice(&corner.to_le_bytes());
    }
    bytes
}

#[test]
fn announced_sizes_are_held_against_the_budget() {
    for (name, bytes) in corpus() {
        for corners in [
            [0, 0, 99_999, 9],
            [0, 0, i32::MAX, i32::MAX],
            [i32::MIN, i32::MIN, i32::MAX, i32::MAX],
        ] {
            let large = decode(&with_window(bytes.clone(), corners), &LIMITS, Keep::All);
            assert!(
                matches!(large, Err(DecodeError::TooLarge { .. })),
                "{name}: {large:?}"
            );
        }
        let many = decode(
            &with_window(bytes.clone(), [0, 0, 3000, 3000]),
            &LIMITS,
            Keep::All,
        );
        assert!(
            matches!(many, Err(DecodeError::TooLarge { .. })),
            "{name}: {many:?}"
        );
        // Of what is not kept nothing is counted: these have more channels than the picture's own.
        let main = decode(
            &with_window(bytes.clone(), [0, 0, 1023, 1023]),
            &Limits {
                max_samples: 4 << 20,
                ..LIMITS
            },
            Keep::Main,
        );
        assert!(
            !matches!(main, Err(DecodeError::TooLarge { .. })),
            "{name}: {main:?}"
        );
        // Within the budget, but the file is far too short for it.
        let thin = decode(
            &with_window(bytes.clone(), [0, 0, 39, 4095]),
            &LIMITS,
            Keep::All,
        );
        assert!(thin.is_err(), "{name}");
        assert!(
            decode(&with_window(bytes, [5, 5, 4, 4]), &LIMITS, Keep::All).is_err(),
            "{name}"
        );
    }
}

/// What is not kept is unpacked all the same, a block at a time: the library would believe any size of one.
#[test]
fn blocks_are_held_against_the_budget_with_all_of_their_channels() {
    let limits = Limits {
        max_samples: 250_000,
        ..LIMITS
    };
    // four times 4096 x 16 are more than that, three times less
    let bytes = with_window(encoded(&layered(21, 37)), [0, 0, 4095, 15]);
    let error = decode(&bytes, &limits, Keep::Main).unwrap_err().to_string();
    assert!(error.contains("samples in a block"), "{error}");
}

#[test]
fn messages_say_what_and_where() {
    let bytes = encoded(&layered(8, 8));
    let cut = decode(&bytes[..bytes.len() - 5], &LIMITS, Keep::All)
        .unwrap_err()
        .to_string();
    assert!(cut.contains("cut short at byte"), "{cut}");
    let other = decode(b"GIF89a", &LIMITS, Keep::All)
        .unwrap_err()
        .to_string();
    assert!(
        other.contains("expected EXR, PNG or Radiance HDR"),
        "{other}"
    );
    assert!(decode(b"", &LIMITS, Keep::All).is_err());
}

#[test]
fn counters_that_a_decompressor_would_allocate_by_are_checked() {
    let blocks = Blocks::ScanLines;
    let (compression, line_order) = (Compression::DWAA(None), LineOrder::Increasing);
    let sound = foreign(
        Encoding {
            compression,
            blocks,
            line_order,
        },
        1,
    );
    // The one block of 21 lines ends the file: its row, its length, then eleven counters.
    let start = (8..sound.len() - 8).rev().find(|&at| {
        let length =
            i32::from_le_bytes([sound[at - 4], sound[at - 3], sound[at - 2], sound[at - 1]]);
        usize::try_from(length) == Ok(sound.len() - at) && sound[at - 8..at - 4] == [0; 4]
    });
    let start = start.unwrap();
    for counter in 1..10 {
        let mut bytes = sound.clone();
        bytes[start + 8 * counter..start + 8 * counter + 8]
            .copy_from_slice(&(1u64 << 40).to_le_bytes());
        let error = decode(&bytes, &LIMITS, Keep::All).unwrap_err().to_string();
        assert!(error.contains("DWA counter"), "{counter}: {error}");
    }
}
