//! `analysis.json`, as `design --given` reads it.

use std::path::PathBuf;
use std::sync::LazyLock;

use ballbar::design::Measured;
use ballbar::plan::Test;

use super::{Target, accepted};
use crate::seeds;

/// A directory with the test file that the analyses name.
static BESIDE: LazyLock<PathBuf> = LazyLock::new(|| {
    let directory = std::env::temp_dir().join(format!("ballbar-fuzz-{}", std::process::id()));
    let made = std::fs::create_dir_all(&directory)
        .and_then(|()| std::fs::write(directory.join("test.toml"), seeds::SHORT_TEST));
    assert!(made.is_ok(), "a directory for files can be made");
    directory
});

pub const TARGET: Target = Target {
    name: "analysis",
    seeds: || {
        let hash = Test::parse(seeds::SHORT_TEST, "test.toml".as_ref())
            .map_or(String::new(), |test| test.hash().to_owned());
        vec![include_str!("../seeds/analysis.json").replace("HASH", &hash).into_bytes()]
    },
    words: &[
        "format",
        "test",
        "file",
        "sha256",
        "repeats",
        "noise",
        "innovation_um",
        "autoregressive",
        "null",
        "true",
        "[",
        "]",
        "{",
        "}",
        "ballbar.analysis/1",
        "1e400",
        "/dev/zero",
        "/dev/stdin/x",
        "..",
        "test.toml",
    ],
    made: &[|| b"[".repeat(1_000_000), || b"{\"a\":".repeat(200_000)],
    read,
};

fn read(input: &[u8]) -> bool {
    let file = BESIDE.join("analysis.json");
    if std::fs::write(&file, input).is_err() {
        return false;
    }
    let measured = Measured::read(&file);
    if let Ok(measured) = &measured {
        assert!(
            measured.variance_mm2() > 0.0 && measured.variance_mm2().is_finite(),
            "noise is a number"
        );
        let _ = measured.mounted();
    }
    accepted(&measured)
}
