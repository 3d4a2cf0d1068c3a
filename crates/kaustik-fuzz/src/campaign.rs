//! The parent: files from a seed, a child for each, and what became of it.

use std::fs;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use crate::check::{PICTURE, REFUSED};
use crate::kind::Kind;
use crate::{model, picture, spoil};

/// Longest life of a child.
const PATIENCE: Duration = Duration::from_secs(5);

/// Address space of a child, in KiB: 2 GiB.
const ADDRESSES: u64 = 2 << 20;

/// What became of a file.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Outcome {
    Picture,
    Refused,
    Panic,
    Abort,
    Hang,
}

/// The verdict on a file.
#[derive(Clone, Debug)]
pub(crate) struct Verdict {
    pub(crate) outcome: Outcome,
    /// From the start of the work to its end, in milliseconds.
    pub(crate) milliseconds: f64,
    /// Most resident memory, in KiB.
    pub(crate) kilobytes: u64,
}

/// Many broken files of a kind.
#[derive(Clone, Debug)]
pub(crate) struct Campaign {
    pub(crate) kind: Kind,
    pub(crate) files: u64,
    pub(crate) seed: u64,
    pub(crate) jobs: u64,
    pub(crate) keep: PathBuf,
}

impl Campaign {
    /// The verdicts in the order of the files.
    pub(crate) fn run(&self) -> io::Result<Vec<Verdict>> {
        let folder = tempfile::tempdir()?;
        let bases = bases(self.kind);
        let next = AtomicU64::new(0);
        let found: Mutex<Vec<(u64, io::Result<Verdict>)>> = Mutex::new(Vec::new());
        std::thread::scope(|scope| {
            for _ in 0..self.jobs {
                scope.spawn(|| {
                    loop {
                        let file = next.fetch_add(1, Ordering::Relaxed);
                        if file >= self.files {
                            break;
                        }
                        let verdict = self.one(file, &bases, folder.path());
                        if let Ok(mut found) = found.lock() {
                            found.push((file, verdict));
                        }
                    }
                });
            }
        });
        let mut found = found
            .into_inner()
            .unwrap_or_else(|poison| poison.into_inner());
        found.sort_by_key(|(file, _)| *file);
        found.into_iter().map(|(_, verdict)| verdict).collect()
    }

    fn one(&self, file: u64, bases: &[spoil::Base], folder: &Path) -> io::Result<Verdict> {
        let bytes = spoil::file(bases, self.seed, file);
        let path = folder.join(format!("{file}.bin"));
        fs::write(&path, &bytes)?;
        let verdict = watch(self.kind, &path)?;
        if !matches!(verdict.outcome, Outcome::Picture | Outcome::Refused) {
            fs::create_dir_all(&self.keep)?;
            let name = format!("{}-{}-{file}.bin", self.kind, self.seed);
            fs::copy(&path, self.keep.join(name))?;
        }
        fs::remove_file(&path)?;
        Ok(verdict)
    }
}

fn bases(kind: Kind) -> Vec<spoil::Base> {
    match kind {
        Kind::Model => model::all().into_iter().map(spoil::Base::Model).collect(),
        _ => picture::all(kind)
            .into_iter()
            .map(spoil::Base::Bytes)
            .collect(),
    }
}

/// Starts a child under limits. The shell sets that of the addresses, since that takes a system call
/// which safe Rust has not.
fn start(kind: Kind, path: &Path) -> io::Result<Child> {
    let program = std::env::current_exe()?;
    Command::new("sh")
        .arg("-c")
        .arg(format!(
            "ulimit -c 0; ulimit -v {ADDRESSES} && exec \"$0\" check {kind} \"$1\""
        ))
        .arg(program)
        .arg(path)
        .env("RUST_BACKTRACE", "0")
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
}

/// Waits for a child, but not for ever.
pub(crate) fn watch(kind: Kind, path: &Path) -> io::Result<Verdict> {
    let begin = Instant::now();
    let mut child = start(kind, path)?;
    let status = loop {
        if let Some(status) = child.try_wait()? {
            break Some(status);
        }
        if begin.elapsed() > PATIENCE {
            child.kill()?;
            child.wait()?;
            break None;
        }
        std::thread::sleep(Duration::from_micros(500));
    };
    let mut said = String::new();
    if let Some(mut out) = child.stdout.take() {
        out.read_to_string(&mut said)?;
    }
    let elapsed = begin.elapsed().as_secs_f64() * 1e3;
    let fault = |outcome| Verdict {
        outcome,
        milliseconds: elapsed,
        kilobytes: 0,
    };
    let Some(status) = status else {
        return Ok(fault(Outcome::Hang));
    };
    Ok(match status.code() {
        Some(0) => read(&said).unwrap_or_else(|| fault(Outcome::Abort)),
        Some(101) => fault(Outcome::Panic),
        _ => fault(Outcome::Abort),
    })
}

/// `verdict|milliseconds|kilobytes|message`.
fn read(said: &str) -> Option<Verdict> {
    let mut parts = said.splitn(4, '|');
    let outcome = match parts.next()? {
        PICTURE => Outcome::Picture,
        REFUSED => Outcome::Refused,
        _ => return None,
    };
    Some(Verdict {
        outcome,
        milliseconds: parts.next()?.parse().ok()?,
        kilobytes: parts.next()?.parse().ok()?,
    })
}
