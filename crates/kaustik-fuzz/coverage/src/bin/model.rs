//! Scene files: a GLB, or a text and its buffer with a zero byte between them.

#![no_main]

use kaustik_fuzz::Kind;
use kaustik_fuzz_coverage::judge;

libfuzzer_sys::fuzz_target!(|parts: &[u8]| judge(Kind::Model, &kaustik_fuzz::assembled(parts)));
