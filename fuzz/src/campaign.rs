//! Replays the corpus, runs mutated inputs, keeps what fails.

use std::collections::BTreeMap;
use std::io::Write as _;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, Once, PoisonError};
use std::time::{Duration, Instant};

use crate::choices::Choices;
use crate::limits::{self, Taken};
use crate::mutate::mutated;
use crate::targets::Target;

/// Time for the mutated inputs of a target where `BALLBAR_FUZZ_SECONDS` does not say another.
const SECONDS: f64 = 2.0;
/// Where the random numbers begin where `BALLBAR_FUZZ_SEED` does not say it.
const SEED: u64 = 1;

/// An input of the corpus that takes longer is replayed and not changed.
const QUICK: Duration = Duration::from_millis(20);

/// Where the last panic was.
static PANIC: Mutex<String> = Mutex::new(String::new());
static HOOK: Once = Once::new();
/// Targets run one after the other: memory is that of the process.
static ALONE: Mutex<()> = Mutex::new(());

/// What came of the inputs of a target.
#[derive(Debug, Default)]
pub struct Outcome {
    inputs: u64,
    accepted: u64,
    most: Taken,
    /// Failures with their number.
    failures: BTreeMap<String, u64>,
}

fn number<T: std::str::FromStr>(name: &str) -> Option<T> {
    std::env::var(name).ok().and_then(|text| text.parse().ok())
}

/// Replays the corpus of a target, then runs mutated inputs for its time.
///
/// # Panics
/// When an input makes a reader panic or takes too much.
pub fn run(target: &Target) {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    hear_panics();
    let mut outcome = Outcome::default();
    let mut seeds = (target.seeds)();
    for seed in &seeds {
        outcome.one(target, seed);
    }
    let refused = outcome.inputs - outcome.accepted;
    // Some seeds are wrong on purpose; where all are, mutated inputs end at the first check of the reader.
    assert!(refused < outcome.inputs, "{} refuses all that inputs are changed from", target.name);
    for (file, input) in corpus(target.name) {
        let before = Instant::now();
        if !outcome.one(target, &input) {
            eprintln!("{}: fails on {}", target.name, file.display());
        }
        // What takes long would take all the time.
        if before.elapsed() < QUICK {
            seeds.push(input);
        }
    }
    for input in target.made.iter().map(|make| make()) {
        outcome.one(target, &input);
    }
    let replayed = outcome.inputs;
    let (seconds, most) = (number("BALLBAR_FUZZ_SECONDS"), number::<u64>("BALLBAR_FUZZ_INPUTS"));
    // A number alone takes whatever time it takes.
    let seconds = seconds.unwrap_or(if most.is_some() { f64::MAX } else { SECONDS });
    let limit = Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX);
    let most = most.unwrap_or(u64::MAX);
    let mut random = Choices::of_seed(number("BALLBAR_FUZZ_SEED").unwrap_or(SEED));
    // Long inputs are slow, and a failure in them hard to read.
    seeds.retain(|seed| seed.len() < 20_000);
    let started = Instant::now();
    while outcome.inputs - replayed < most && started.elapsed() < limit {
        let input = mutated(&mut random, &seeds, target.words);
        outcome.one(target, &input);
    }
    outcome.tell(target.name, replayed, refused, started.elapsed());
    let failures: Vec<String> =
        outcome.failures.iter().map(|(failure, times)| format!("{times} x {failure}")).collect();
    assert!(
        failures.is_empty(),
        "{} fails, inputs in fuzz/found:\n{}",
        target.name,
        failures.join("\n")
    );
}

impl Outcome {
    /// Reads one input; says whether that went well.
    fn one(&mut self, target: &Target, input: &[u8]) -> bool {
        if std::env::var_os("BALLBAR_FUZZ_KEEP").is_some() {
            limits::keep_last(target.name, input);
        }
        self.inputs += 1;
        let (result, taken) = limits::measured(target.name, input, || {
            catch_unwind(AssertUnwindSafe(|| (target.read)(input)))
        });
        self.most.bytes = self.most.bytes.max(taken.bytes);
        self.most.time = self.most.time.max(taken.time);
        let failure = match result {
            Err(_) => PANIC.lock().unwrap_or_else(PoisonError::into_inner).clone(),
            Ok(_) if taken.bytes > limits::MOST_BYTES => "more than 1 GB".to_owned(),
            Ok(_) if taken.time > limits::LONGEST => "longer than 10 s".to_owned(),
            Ok(accepted) => {
                self.accepted += u64::from(accepted);
                return true;
            }
        };
        limits::keep(target.name, &failure, input);
        *self.failures.entry(failure).or_default() += 1;
        false
    }

    fn tell(&self, name: &str, replayed: u64, refused: u64, took: Duration) {
        let told = format!(
            "{name:<10} {replayed:>4} replayed ({refused} seeds refused), {:>8} mutated, {:>7} accepted, {:>4} MB, {:>6.2} s the longest, {:>5.0} s in all, {} failures\n",
            self.inputs - replayed,
            self.accepted,
            self.most.bytes >> 20,
            self.most.time.as_secs_f64(),
            took.as_secs_f64(),
            self.failures.values().sum::<u64>(),
        );
        // Past the harness, which shows what a test prints only where it fails.
        let shown = std::io::stderr().write_all(told.as_bytes());
        debug_assert!(shown.is_ok(), "standard error is open");
    }
}

/// Notes where a panic is instead of printing it: thousands may come.
fn hear_panics() {
    HOOK.call_once(|| {
        let before = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |info| {
            let place =
                info.location().map_or(String::new(), |at| format!("{}:{}", at.file(), at.line()));
            if place.starts_with("src/campaign.rs") {
                return before(info);
            }
            let what = info.payload_as_str().unwrap_or("").chars().take(60).collect::<String>();
            *PANIC.lock().unwrap_or_else(PoisonError::into_inner) = format!("{place} {what}");
        }));
    });
}

/// The inputs that are kept for a target.
fn corpus(name: &str) -> Vec<(PathBuf, Vec<u8>)> {
    let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus").join(name);
    let mut files: Vec<PathBuf> = std::fs::read_dir(directory)
        .into_iter()
        .flatten()
        .filter_map(|entry| entry.ok().map(|entry| entry.path()))
        .collect();
    files.sort();
    files
        .into_iter()
        .filter_map(|file| std::fs::read(&file).ok().map(|input| (file, input)))
        .collect()
}
