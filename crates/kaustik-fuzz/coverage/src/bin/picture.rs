//! Pictures, of the kind that their first bytes claim.

#![no_main]

use kaustik_fuzz::Kind;
use kaustik_fuzz_coverage::judge;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let kind = match bytes {
        [0x89, ..] => Kind::Png,
        [0xff, 0xd8, ..] => Kind::Jpeg,
        [b'R', ..] => Kind::Webp,
        [b'#', ..] => Kind::Hdr,
        _ => Kind::Exr,
    };
    judge(kind, bytes);
});
