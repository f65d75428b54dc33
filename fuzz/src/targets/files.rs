//! Files as bytes on a disk: packed, not text, of the wrong kind. Every reader gets every input.

use ballbar::log::{Format, Recording};
use ballbar::machine::Machine;
use ballbar::model::ModelFile;
use ballbar::nc::{Source, text_of};
use ballbar::plan::Test;
use ballbar::simulate::Scenario;

use super::{Target, accepted, analysis, log, machine, model, program, scenario, test};
use crate::mutate::gzipped;

pub const TARGET: Target = Target {
    name: "files",
    seeds: || {
        let all = [
            machine::TARGET,
            test::TARGET,
            scenario::TARGET,
            model::TARGET,
            log::TARGET,
            program::TARGET,
            analysis::TARGET,
        ];
        let firsts = all.iter().filter_map(|target| (target.seeds)().into_iter().last());
        let firsts: Vec<Vec<u8>> = firsts.collect();
        let packed = firsts.iter().map(|plain| gzipped(plain));
        packed.chain(firsts.clone()).collect()
    },
    words: &["\x1f\u{8b}", "name", "terms", "G01", "time_s"],
    made: &[
        || gzipped(&vec![0; 400_000_000]),
        || gzipped(&b"G1\n".repeat(30_000_000)),
        || gzipped(&b"a = 1\n".repeat(20_000_000)),
        || b"x = [".repeat(200_000),
        || b"a.".repeat(500_000),
        || vec![0xff; 10_000_000],
    ],
    read,
};

fn read(input: &[u8]) -> bool {
    let Ok(file) = tempfile::NamedTempFile::new() else { return false };
    let path = file.path();
    if std::fs::write(path, input).is_err() {
        return false;
    }
    let program = Source::read(path);
    let taken = [
        accepted(&Machine::read(path)),
        accepted(&Test::read(path)),
        accepted(&Scenario::read(path)),
        accepted(&ModelFile::read(path)),
        accepted(&text_of(path)),
        accepted(&program),
        accepted(&Recording::read(path)),
        accepted(&ballbar::log::read(path, &Format::default())),
    ];
    taken.iter().any(|taken| *taken)
}
