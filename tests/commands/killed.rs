//! Commands that are killed, at any moment: what they leave is of one command, or told by what lies beside it.
#![cfg(unix)]

use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use rand::RngExt;
use rand_pcg::Pcg64Mcg;

use crate::work::{Work, data, unpacked};

/// Names and contents of results.
type Set = BTreeMap<String, Vec<u8>>;

/// How a command ends that is not let finish.
#[derive(Clone, Copy)]
enum End {
    /// `kill -9`: nothing of it runs any more.
    Killed,
    /// Ctrl-C.
    Interrupted,
}

/// A command with two tests, so that what it leaves tells of which.
struct Case {
    name: &'static str,
    arguments: [Vec<&'static str>; 2],
    /// What each writes, and in what time.
    sets: [Set; 2],
    lasts: Duration,
}

/// What trials have met.
#[derive(Default, Debug)]
struct Met {
    /// Complete sets of the one before and of the one that was ended, and directories with nothing.
    before: usize,
    after: usize,
    nothing: usize,
    /// Sets that were taking their place.
    underway: usize,
    /// Files that were not complete yet.
    staged: usize,
}

#[test]
fn what_a_killed_command_leaves_is_set_right() {
    trials(6);
}

/// More of them: `BALLBAR_KILLS=500 cargo test --release --test commands -- --ignored killed` takes a quarter of an hour;
/// `BALLBAR_KILLS_OF=analyse` ends that command alone.
#[test]
#[ignore = "long: `cargo test --release -- --ignored` runs it, and .ci/run does"]
fn what_many_killed_commands_leave_is_set_right() {
    let asked = std::env::var("BALLBAR_KILLS").ok().and_then(|count| count.parse().ok());
    trials(asked.unwrap_or(30));
}

/// Ends each command so often, half of them by each end.
fn trials(count: usize) {
    let work = Work::new();
    let mut random = Pcg64Mcg::new(0x5eed);
    let of = std::env::var("BALLBAR_KILLS_OF").ok();
    for case in cases(&work).into_iter().filter(|case| of.as_ref().is_none_or(|of| of == case.name))
    {
        let mut met = Met::default();
        let _ = std::fs::remove_dir_all(work.path("results"));
        for trial in 0..count {
            let end = if trial % 2 == 0 { End::Killed } else { End::Interrupted };
            case.trial(&work, end, &mut random, &mut met);
        }
        println!("{} ended {count} times: {met:?}", case.name);
        assert!(met.before + met.after + met.nothing + met.underway == count, "{met:?}");
    }
}

fn cases(work: &Work) -> Vec<Case> {
    const PLAN: &str = "[plan]\nstrategy = \"2d\"\nfeed_mm_min = 500.0\n";
    // One plane and few readings: what is tried is the end of the command, not its work.
    let of = |file: &str| unpacked(&data("planar").join(file));
    let log: String = of("xy.csv.gz").split_inclusive('\n').step_by(8).collect();
    work.machine("name", "name").write("O1001.nc", of("O1001.nc.gz"));
    work.write("run.csv", &log).write("other.csv", &log);
    let run = |log: &str| format!("[[run]]\nprogram = \"O1001.nc\"\nlog = \"{log}\"\n");
    for (file, rest) in [
        ("first.toml", PLAN.to_owned()),
        ("second.toml", PLAN.replace("500.0", "600.0")),
        ("first-run.toml", run("run.csv")),
        ("second-run.toml", run("other.csv")),
    ] {
        work.test(&rest);
        std::fs::rename(work.path("test.toml"), work.path(file)).unwrap();
    }
    [
        ("program", vec!["program", "first.toml"], vec!["program", "second.toml"]),
        ("simulate", vec!["simulate", "first.toml"], vec!["simulate", "second.toml"]),
        ("analyse", vec!["analyse", "first-run.toml"], vec!["analyse", "second-run.toml"]),
    ]
    .map(|(name, first, second)| {
        let began = Instant::now();
        let sets = [&first, &second].map(|arguments| {
            let _ = std::fs::remove_dir_all(work.path("results"));
            work.ballbar(arguments).done();
            set_in(&work.path("results"))
        });
        assert_ne!(sets[0], sets[1], "{name}");
        Case { name, lasts: began.elapsed() / 2, arguments: [first, second], sets }
    })
    .into()
}

impl Case {
    /// Ends the second command over what the first has written, or over nothing, and lets the first go on.
    fn trial(&self, work: &Work, end: End, random: &mut Pcg64Mcg, met: &mut Met) {
        let results = work.path("results");
        if random.random_bool(0.2) {
            let _ = std::fs::remove_dir_all(&results);
        } else {
            work.ballbar(&self.arguments[0]).done();
        }
        let mut child = Command::new(assert_cmd::cargo::cargo_bin!("ballbar"))
            .current_dir(work.path("."))
            .args(&self.arguments[1])
            .args(["-o", "results"])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let staged = results.join(".ballbar/staged");
        let latest = Instant::now() + self.lasts.mul_f64(random.random_range(0.0..1.2));
        if random.random_bool(0.7) {
            // Where it matters: while files are written.
            while !staged.exists() && child.try_wait().unwrap().is_none() {
                std::hint::spin_loop();
            }
            std::thread::sleep(Duration::from_micros(random.random_range(0..8000)));
        } else {
            std::thread::sleep(latest.saturating_duration_since(Instant::now()));
        }
        match end {
            End::Killed => child.kill().unwrap(),
            End::Interrupted => {
                Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
            }
        }
        child.wait().unwrap();
        self.look(&results, end, met);
        work.ballbar(&self.arguments[0]).done();
        assert!(
            set_in(&results) == self.sets[0],
            "{}: the next one writes all of its own",
            self.name
        );
        let mut beside: Vec<_> = std::fs::read_dir(results.join(".ballbar"))
            .unwrap()
            .map(|entry| entry.unwrap().file_name())
            .collect();
        beside.sort();
        assert_eq!(beside, ["lock", "written"], "{}: nothing is left over", self.name);
    }

    /// What is there is one set, or lies beside one that is taking its place.
    fn look(&self, results: &Path, end: End, met: &mut Met) {
        let there = set_in(results);
        let interrupted = matches!(end, End::Interrupted);
        if results.join(".ballbar/staged").exists() {
            met.staged += 1;
            assert!(!interrupted, "{}: Ctrl-C leaves nothing", self.name);
        }
        if results.join(".ballbar/next").exists() {
            met.underway += 1;
            assert!(!interrupted, "{}: Ctrl-C leaves nothing", self.name);
        } else if there == self.sets[1] {
            met.after += 1;
        } else if there == self.sets[0] {
            met.before += 1;
        } else {
            assert!(there.is_empty(), "{}: a mixed set: {:?}", self.name, there.keys());
            met.nothing += 1;
        }
    }
}

/// The results in a directory.
fn set_in(results: &Path) -> Set {
    let Ok(entries) = std::fs::read_dir(results) else { return Set::new() };
    let files = entries.map(|entry| entry.unwrap()).filter(|entry| entry.path().is_file());
    files
        .map(|file| (file.file_name().into_string().unwrap(), std::fs::read(file.path()).unwrap()))
        .collect()
}
