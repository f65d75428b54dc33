//! How much memory and time an input may take, and a watch that ends what takes more.

use std::path::{Path, PathBuf};
use std::sync::{LazyLock, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use peak_alloc::PeakAlloc;

/// Counts what is allocated.
#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

/// No input may take more memory, bytes.
pub const MOST_BYTES: usize = 1 << 30;
/// No input may take longer, in time of the processor: what else runs on the machine is not its fault.
pub const LONGEST: Duration = Duration::from_secs(10);
/// So often the watch looks.
const LOOK: Duration = Duration::from_millis(20);
/// What takes so much more than it may is not waited for.
const HOPELESS: u32 = 8;

/// What is being read.
struct Running {
    target: &'static str,
    input: Vec<u8>,
    /// Time of the processor before it.
    since: Duration,
    /// Allocated before it, bytes.
    before: usize,
}

static RUNNING: LazyLock<Mutex<Option<Running>>> = LazyLock::new(|| {
    std::thread::spawn(watch);
    Mutex::new(None)
});

fn running() -> MutexGuard<'static, Option<Running>> {
    RUNNING.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Ends the process when an input takes so much that the machine would suffer; the input is kept.
fn watch() {
    loop {
        std::thread::sleep(LOOK);
        let running = running();
        let Some(now) = running.as_ref() else { continue };
        let bytes = MEMORY.current_usage().saturating_sub(now.before);
        let told = if bytes > HOPELESS as usize * MOST_BYTES {
            format!("takes more than {} MB", bytes >> 20)
        } else if processor().saturating_sub(now.since) > HOPELESS * LONGEST {
            format!("takes longer than {:.0} s", (HOPELESS * LONGEST).as_secs_f64())
        } else {
            continue;
        };
        let file = keep(now.target, "ended", &now.input);
        eprintln!("{}: an input {told}; it is kept as {}", now.target, file.display());
        std::process::exit(101);
    }
}

/// Time that the processors have spent on this process, to a hundredth of a second; elsewhere than on Linux the time of
/// day takes its place.
fn processor() -> Duration {
    static BEGIN: LazyLock<std::time::Instant> = LazyLock::new(std::time::Instant::now);
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    // Behind the name of the program, which may hold anything: ticks of a hundredth of a second, own and the kernel's.
    let behind = stat.rsplit(')').next().unwrap_or("");
    let ticks: Vec<u64> =
        behind.split_whitespace().skip(11).take(2).filter_map(|n| n.parse().ok()).collect();
    match ticks[..] {
        [own, kernel] => Duration::from_millis(10 * (own + kernel)),
        _ => BEGIN.elapsed(),
    }
}

/// What an input took.
#[derive(Debug, Clone, Copy, Default)]
pub struct Taken {
    /// Most memory at once, bytes.
    pub bytes: usize,
    /// Time.
    pub time: Duration,
}

/// Does something with an input and measures what it takes.
pub fn measured<T>(target: &'static str, input: &[u8], work: impl FnOnce() -> T) -> (T, Taken) {
    let before = MEMORY.current_usage();
    let since = processor();
    *running() = Some(Running { target, input: input.to_vec(), since, before });
    MEMORY.reset_peak_usage();
    let result = work();
    let bytes = MEMORY.peak_usage().saturating_sub(before);
    let time = processor().saturating_sub(since);
    *running() = None;
    (result, Taken { bytes, time })
}

/// Where inputs are kept.
const FOUND: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/found");

fn write(file: &Path, input: &[u8]) {
    let kept = std::fs::create_dir_all(FOUND).and_then(|()| std::fs::write(file, input));
    if let Err(error) = kept {
        eprintln!("cannot keep {}: {error}", file.display());
    }
}

/// Keeps an input before it is read, for what ends the process at once.
pub fn keep_last(target: &str, input: &[u8]) {
    write(&Path::new(FOUND).join(format!("{target}-last")), input);
}

/// Keeps an input that failed, the smallest of each kind of failure.
pub fn keep(target: &str, failure: &str, input: &[u8]) -> PathBuf {
    let name: String =
        failure.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '-' }).collect();
    let file = Path::new(FOUND).join(format!("{target}-{name}"));
    let smaller = std::fs::metadata(&file).map_or(true, |old| old.len() > input.len() as u64);
    if smaller {
        write(&file, input);
    }
    file
}
