//! Sound files of every format, changed at random where it hurts, through all that happens up to the first pixels: no
//! panic, no hang, no more memory than the limit allows, and errors that name the file.
//!
//! `AJAR_RELEASE_TESTS=1` takes a hundred thousand inputs a format instead of two thousand. `AJAR_MUTATION=N`
//! takes number N alone. `tests/fuzz` feeds the same [`laboratory`] by cargo-fuzz.

#![allow(clippy::unwrap_used, reason = "a failing test panics")]

mod laboratory;
mod meter;
mod mutate;
mod seeds;

use std::{
    env, fs,
    ops::Range,
    panic::{AssertUnwindSafe, catch_unwind},
    path::PathBuf,
    sync::{Mutex, PoisonError},
    time::{Duration, Instant},
};

use laboratory::{Fate, Laboratory, Target};
use meter::Watch;
use mutate::Mutator;

#[global_allocator]
static METER: meter::Meter = meter::Meter;

/// Bytes that an input may take: what the house promises for hostile files.
const MOST_BYTES: usize = 512 << 20;

/// Processor time that an input may take, likewise.
const LONGEST: Duration = Duration::from_secs(5);

/// The meter counts all threads, so formats take turns.
static TURN: Mutex<()> = Mutex::new(());

/// Numbers of the inputs to try.
fn numbers() -> Range<u64> {
    let one = env::var("AJAR_MUTATION").ok().and_then(|number| number.parse().ok());
    let all = 0..if env::var_os("AJAR_RELEASE_TESTS").is_some() { 100_000 } else { 2_000 };
    one.map_or(all, |number: u64| number..number + 1)
}

/// What became of inputs, and the most that one took.
#[derive(Default)]
struct Tally {
    refused: u64,
    prepared: u64,
    slowest: (Duration, u64),
    largest: (usize, u64),
}

impl Tally {
    fn count(&mut self, number: u64, fate: Fate, time: Duration, bytes: usize) {
        match fate {
            Fate::Refused => self.refused += 1,
            Fate::Prepared => self.prepared += 1,
        }
        self.slowest = self.slowest.max((time, number));
        self.largest = self.largest.max((bytes, number));
    }
}

/// Tries all inputs of a format. Each is on the disk while it is tried, so that also one that ends the process is found.
fn survives(target: Target) {
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("mutations").join(target.name());
    let laboratory = Laboratory::new(&folder).unwrap();
    let seeds = seeds::of(target);
    for (number, seed) in seeds.iter().enumerate() {
        assert_eq!(
            laboratory.examine(target, seed),
            Ok(Fate::Prepared),
            "seed {number} of {}",
            target.name()
        );
    }
    let watch = Watch::start(folder.clone());
    let mut tally = Tally::default();
    for number in numbers() {
        let input = Mutator::new(number).mutate(target, &seeds);
        watch.begin(number);
        let (start, before) = (Instant::now(), meter::reset());
        let worked = meter::processor_time();
        let found = catch_unwind(AssertUnwindSafe(|| laboratory.examine(target, &input)))
            .unwrap_or_else(|_| Err("it panics".into()));
        let (time, bytes) = (start.elapsed(), meter::most() - before);
        let found = found.and_then(|fate| {
            let spent = meter::processor_time().zip(worked).map_or(Duration::ZERO, |(now, then)| now - then);
            if bytes > MOST_BYTES {
                return Err(format!("it takes {} MiB", bytes >> 20));
            }
            if spent > LONGEST { Err(format!("it takes {spent:?} of a processor")) } else { Ok(fate) }
        });
        match found {
            Ok(fate) => tally.count(number, fate, time, bytes),
            Err(why) => {
                fs::write(folder.join("offender"), &input).unwrap();
                panic!("input {number} of {}, kept as {}/offender: {why}", target.name(), folder.display());
            }
        }
    }
    let Tally { refused, prepared, slowest, largest } = tally;
    println!(
        "{}: {prepared} prepared, {refused} refused; slowest {:.0?} (number {}), most memory {} MiB (number {})",
        target.name(),
        slowest.0,
        slowest.1,
        largest.0 >> 20,
        largest.1
    );
    // Otherwise the changes are too small or too large to find anything.
    let tried = prepared + refused;
    assert!(tried == 1 || (prepared > tried / 10 && refused > 0), "{prepared} prepared, {refused} refused");
}

#[test]
fn gltf() {
    survives(Target::Gltf);
}

#[test]
fn glb() {
    survives(Target::Glb);
}

#[test]
fn obj() {
    survives(Target::Obj);
}

#[test]
fn mtl() {
    survives(Target::Mtl);
}

#[test]
fn scene() {
    survives(Target::Scene);
}

#[test]
fn ajar() {
    survives(Target::Ajar);
}

#[test]
fn picture() {
    survives(Target::Picture);
}

#[test]
fn plug_in() {
    survives(Target::PlugIn);
}
