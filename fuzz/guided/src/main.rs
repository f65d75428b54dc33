//! One reader of ballbar under libFuzzer: inputs that reach what none before them reached are kept and changed further.
//!
//! Half of the changes are those of `ballbar_fuzz`, which know numbers, words and lines, the others are libFuzzer's, which
//! know what the program compared an input with. `fuzz/README.md` says how to build and run it.
#![no_main]

use std::path::Path;
use std::process::abort;
use std::sync::LazyLock;

use ballbar_fuzz::choices::Choices;
use ballbar_fuzz::limits::{self, LONGEST, MOST_BYTES};
use ballbar_fuzz::mutate::mutated;
use ballbar_fuzz::targets::{ALL, Target};
use libfuzzer_sys::{fuzz_mutator, fuzz_target, fuzzer_mutate};

/// The reader that `BALLBAR_FUZZ_TARGET` names.
static TARGET: LazyLock<&Target> = LazyLock::new(|| {
    let name = std::env::var("BALLBAR_FUZZ_TARGET").unwrap_or_default();
    ALL.iter().find(|target| target.name == name).unwrap_or_else(|| {
        let names: Vec<&str> = ALL.iter().map(|target| target.name).collect();
        eprintln!("BALLBAR_FUZZ_TARGET is one of {}", names.join(", "));
        std::process::exit(2)
    })
});

/// What the project's own files are changed from.
static SEEDS: LazyLock<Vec<Vec<u8>>> = LazyLock::new(|| (TARGET.seeds)());

fuzz_target!(
    init: {
        // An empty corpus begins with the seeds.
        if let Some(corpus) = std::env::args().skip(1).find(|argument| !argument.starts_with('-')) {
            for (number, seed) in SEEDS.iter().enumerate() {
                let file = Path::new(&corpus).join(format!("seed-{number}"));
                if let Err(error) = std::fs::write(&file, seed) {
                    eprintln!("cannot write {}: {error}", file.display());
                }
            }
        }
    },
    |input: &[u8]| {
        let (_, taken) = limits::measured(TARGET.name, input, || (TARGET.read)(input));
        if taken.bytes > MOST_BYTES || taken.time > LONGEST {
            eprintln!("{} MB, {:.1} s", taken.bytes >> 20, taken.time.as_secs_f64());
            abort();
        }
    }
);

fuzz_mutator!(|data: &mut [u8], size: usize, most: usize, seed: u32| {
    if seed.is_multiple_of(2) {
        return fuzzer_mutate(data, size, most);
    }
    let one = [data[..size].to_vec()];
    let made = mutated(&mut Choices::of_seed(u64::from(seed)), &one, TARGET.words);
    let size = made.len().min(most);
    data[..size].copy_from_slice(&made[..size]);
    size
});
