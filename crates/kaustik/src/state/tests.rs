use kaustik_film::{Film, Filter, Quantum, Window};
use kaustik_scene::Scene;
use kaustik_spectrum::Xyz;

use super::*;
use crate::{Budget, Method, Options, RenderSettings, small};

fn scene() -> Scene {
    small::scene("furnace", [8, 6])
}

fn film(quantum: i32) -> Film {
    Film::new(3, 2, Quantum::from_exponent(quantum)).expect("a film")
}

/// The bytes of what `write` writes, between what every state begins and ends with.
fn written(write: impl Fn(&mut Writer<'_>)) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut writer = Writer::new(&mut bytes).expect("memory");
    write(&mut writer);
    writer.finish().expect("memory");
    bytes.truncate(bytes.len() - CHECKSUM);
    bytes.drain(..PREFIX);
    bytes
}

fn reader(bytes: &[u8], first: bool) -> Reader<'_> {
    Reader::new(bytes, 0..1, first)
}

#[test]
fn films_are_replaced_by_the_first_and_added_by_the_others() {
    let kept = film(-30);
    kept.splat(0.5, 0.5, Xyz([1.0, 2.0, 3.0]));
    kept.splat(2.5, 1.5, Xyz([f32::NAN, 2.0, 3.0]));
    let bytes = written(|out| out.film(&kept).expect("memory"));
    let mut other = film(-30);
    other.splat(0.5, 0.5, Xyz([9.0; 3]));
    for (first, times) in [(true, 1), (false, 2), (false, 3)] {
        let mut reader = reader(&bytes, first);
        reader.film(&mut other).expect("a film");
        reader.end().expect("nothing is left");
        let wanted: Vec<i64> = kept.sums().map(|sum| sum * times).collect();
        assert_eq!(other.sums().collect::<Vec<_>>(), wanted);
        assert_eq!(other.counters().non_finite, times as u64);
    }
    let passed = reader(&bytes, true).film_instead(&mut other, false);
    assert!(passed.is_ok() && other.counters().non_finite == 3);
    let mut finer = film(-31);
    let unit = reader(&bytes, true).film(&mut finer);
    let message = unit.expect_err("another unit").to_string();
    assert!(
        message.contains("2^-30 in the state, 2^-31 here"),
        "{message}"
    );
    let mut larger = Film::new(3, 3, Quantum::from_exponent(-30)).expect("a film");
    assert!(reader(&bytes, true).film(&mut larger).is_err());
    assert!(larger.sums().all(|sum| sum == 0), "nothing of it is taken");
}

/// A length that lies is found before memory is taken for it.
#[test]
fn lengths_that_lie_are_refused() {
    let value = vec![7_u64; 5];
    let sound = written(|out| out.value(&value).expect("memory"));
    assert_eq!(reader(&sound, true).value(), Ok(value));
    let too_long = |bytes: &[u8]| {
        let fault = reader(bytes, true).value::<Vec<u64>>();
        fault.expect_err("a fault").to_string()
    };
    for length in [7, 1 << 20, u64::MAX / 8, u64::MAX] {
        let mut bytes = sound.clone();
        bytes[1..9].copy_from_slice(&u64::to_le_bytes(length));
        assert!(
            too_long(&bytes).contains("longer than what is left"),
            "{length}"
        );
    }
    let mut bytes = sound.clone();
    bytes[1] -= 1;
    assert!(too_long(&bytes).contains("makes no sense"));
    bytes[9] -= 2; // the list's own length
    assert!(too_long(&bytes).contains("ends before"));
    bytes[0] = FILM;
    assert!(too_long(&bytes).contains("not in order"));
    assert!(too_long(&sound[..4]).contains("longer than what is left"));
    assert!(reader(&sound, true).end().is_err());
    // A list that says it has more numbers than there are bytes in the world.
    let mut bytes = vec![VALUE, 10, 0, 0, 0, 0, 0, 0, 0];
    bytes.extend([0xff; 9]);
    bytes.push(1);
    assert!(too_long(&bytes).contains("makes no sense"));
}

/// Whoever has only the file renders what was rendered.
#[test]
fn a_header_gives_its_settings_back() {
    let scene = scene();
    for method in Method::ALL {
        let mut options = Options::default();
        for key in method.keys() {
            // Any value but the default, where the range lists some.
            let value = key.range.split(['|', ',']).map(str::trim).next_back();
            let setting = format!("{}={}", key.name, value.unwrap_or_default());
            let _ = options.set(method, &setting);
        }
        let settings = RenderSettings {
            method,
            options,
            width: 8,
            height: 6,
            crop: Some(Window {
                x0: 1,
                y0: 0,
                x1: 7,
                y1: 5,
            }),
            filter: Filter::new("mitchell", Some(1.7)).expect("a filter"),
            budget: Budget::Total(0),
            seed: u64::MAX,
            threads: 0,
            max_depth: 17,
            ladders: Some(1..3),
            features: true,
        };
        let header = Header::new(&scene, &settings, 1.5);
        let bytes = written(|out| out.value(&header).expect("memory"));
        let again: Header = reader(&bytes, true).value().expect("a header");
        assert_eq!(again, header);
        let read = again.settings().expect("settings");
        // What other methods read is not kept.
        let entries = |settings: &RenderSettings| settings.options.entries(method);
        assert_eq!(entries(&read), entries(&settings), "{method}");
        let options = settings.options;
        assert_eq!(RenderSettings { options, ..read }, settings);
        assert!(again.same_share(&header).is_ok());
    }
}

#[test]
fn a_header_larger_than_its_file_is_refused() {
    let scene = scene();
    let settings = RenderSettings {
        width: 60_000,
        height: 60_000,
        ..RenderSettings::default()
    };
    let header = Header::new(&scene, &settings, 0.0);
    assert!(header.fits(1 << 27).is_err() && header.fits(1 << 40).is_ok());
    for seconds in [f64::NAN, -1.0, f64::INFINITY] {
        let header = Header::new(&scene, &RenderSettings::default(), seconds);
        assert!(header.fits(1 << 40).is_err(), "{seconds}");
    }
}
