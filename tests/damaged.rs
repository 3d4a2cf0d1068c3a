//! States that are damaged: each is refused with a reason, none makes anything panic.

use kaustik::film::Filter;
use kaustik::{
    Budget, Control, Method, RenderError, RenderSettings, State, StateError, merged_settings,
    resume,
};

use crate::state::{Keeper, cases, last_state, resumed};
use crate::support::{scene, settings};

/// A generator of one's own is enough to damage files with.
struct Dice(u64);

impl Dice {
    fn below(&mut self, n: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % n as u64) as usize
    }

    /// One of many ways to be damaged.
    fn damage(&mut self, bytes: &mut Vec<u8>) {
        match self.below(8) {
            0 => bytes.truncate(self.below(bytes.len())),
            1 => bytes.extend((0..=self.below(64)).map(|i| i as u8)),
            2 => {
                let from = self.below(bytes.len());
                let to = (from + 1 + self.below(100)).min(bytes.len());
                bytes.drain(from..to);
            }
            3 => {
                let at = self.below(bytes.len());
                let to = (at + 8).min(bytes.len());
                bytes[at..to].fill([0x00, 0x7f, 0x80, 0xff][self.below(4)]);
            }
            4 => {
                // Where lengths, names and settings are.
                let at = self.below(400.min(bytes.len()));
                bytes[at] = self.below(256) as u8;
            }
            _ => {
                let at = self.below(bytes.len());
                bytes[at] ^= 1 << self.below(8);
            }
        }
    }
}

fn seal(bytes: &mut Vec<u8>) {
    let end = bytes.len().saturating_sub(32);
    bytes.truncate(end);
    let checksum = blake3::hash(bytes);
    bytes.extend(checksum.as_bytes());
}

/// Damages states of every kind: none is taken up, none makes anything panic. With a checksum that agrees the
/// damage gets further in, where all that counts is that nothing panics: a bit of a film's sum is anybody's.
fn damaged_states(name: &str, each: usize) {
    let scene = scene(name, 8);
    for (what, mut settings) in cases() {
        settings.filter = Filter::default();
        (settings.width, settings.height) = (8, 8);
        settings.budget = Budget::PerPixel(2);
        settings.options.ladders = settings.options.ladders.min(5);
        settings.options.pilot = 200;
        settings.options.particles = 1_000;
        settings.threads = 1;
        let sound = last_state(&scene, &settings);
        assert!(resumed(&scene, &settings, &sound).is_ok());
        let (mut dice, mut deep) = (Dice(0x9e37_79b9_7f4a_7c15), 0);
        for index in 0..each {
            let mut bytes = sound.clone();
            dice.damage(&mut bytes);
            if bytes == sound {
                continue;
            }
            let refused = State::from_bytes(bytes.clone());
            let message = refused.expect_err("a damaged state").to_string();
            assert!(message.len() > 20, "{what} {index}: {message}");
            seal(&mut bytes);
            let Ok(state) = State::from_bytes(bytes) else {
                continue;
            };
            let more = RenderSettings {
                budget: Budget::PerPixel(3),
                ..settings.clone()
            };
            let nobody = &mut Keeper::default();
            let done = resume(
                &scene,
                &more,
                state.clone(),
                &mut Control::default(),
                nobody,
            );
            deep += usize::from(!matches!(
                done,
                Err(RenderError::State(StateError::Other(_)))
            ));
            if let Ok(settings) = merged_settings(std::slice::from_ref(&state)) {
                // Only what the file has room for.
                assert!(u64::from(settings.width) * u64::from(settings.height) < 1 << 32);
            }
        }
        assert!(deep > each / 10, "{what}: {deep} of {each} got further in");
    }
}

#[test]
fn damaged_states_are_refused() {
    damaged_states("cornell", 5);
    damaged_states("glass-cube?light=0.8", 5);
}

#[test]
#[ignore = "ten thousand states"]
fn ten_thousand_damaged_states_are_refused() {
    damaged_states("cornell", 400);
    damaged_states("glass-cube?light=0.8", 400);
}

#[test]
fn each_fault_has_its_reason() {
    let scene = scene("cornell", 8);
    let sound = last_state(&scene, &settings(Method::Path, 8, 1));
    let reason = |change: &dyn Fn(&mut Vec<u8>)| {
        let mut bytes = sound.clone();
        change(&mut bytes);
        State::from_bytes(bytes).expect_err("a fault")
    };
    assert_eq!(reason(&|b| b[0] = b'K'), StateError::Foreign);
    assert_eq!(reason(&|b| b.truncate(5)), StateError::Foreign);
    let expected = u32::from(sound[8]);
    let version = StateError::Version {
        found: expected + 1,
        expected,
    };
    assert_eq!(reason(&|b| b[8] += 1), version);
    assert_eq!(reason(&|b| b[12..16].reverse()), StateError::ByteOrder);
    type Change<'a> = &'a dyn Fn(&mut Vec<u8>);
    let faults: [(Change<'_>, &str); 3] = [
        (&|b| b.truncate(20), "too early"),
        (&|b| b.truncate(b.len() - 1), "checksum"),
        (&|b| b[200] ^= 4, "checksum"),
    ];
    for (change, word) in faults {
        let reason = reason(change).to_string();
        assert!(reason.contains(word), "{reason}");
    }
}
