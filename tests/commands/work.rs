//! A directory to work in, and the binary.

use std::path::{Path, PathBuf};
use std::process::Output;

/// The project's directory.
pub(crate) fn project() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The measured data.
pub(crate) fn data(set: &str) -> PathBuf {
    project().join("tests/data").join(set)
}

/// The text of a gzipped file.
pub(crate) fn unpacked(file: &Path) -> String {
    let mut text = String::new();
    let file = std::fs::File::open(file).unwrap();
    std::io::Read::read_to_string(&mut flate2::read::GzDecoder::new(file), &mut text).unwrap();
    text
}

/// A temporary directory with files in it.
pub(crate) struct Work {
    directory: tempfile::TempDir,
}

impl Work {
    pub(crate) fn new() -> Self {
        Self { directory: tempfile::tempdir().unwrap() }
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.directory.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, content: impl AsRef<[u8]>) -> &Self {
        std::fs::write(self.path(name), content).unwrap();
        self
    }

    /// The machine file, changed.
    pub(crate) fn machine(&self, from: &str, to: &str) -> &Self {
        let source = std::fs::read_to_string(project().join("machines/hu40t.toml")).unwrap();
        assert!(source.contains(from), "{from}");
        self.write("machine.toml", source.replacen(from, to, 1))
    }

    /// A test file with a plan and the given rest.
    pub(crate) fn test(&self, rest: &str) -> &Self {
        self.write(
            "test.toml",
            format!(
                "name = \"Test\"\nmachine = \"machine.toml\"\n\n[ball_bar]\nlength_mm = 150.0\n\n\
                 [[mounting]]\nname = \"A\"\ncoincidence_mm = [20.0, -35.0, 40.0]\n\
                 tool_ball_mm = [0.0, 0.0, -200.0]\n\n{rest}"
            ),
        )
    }

    /// A run of the measured 3D6 program with a log of this text.
    pub(crate) fn run_of(&self, log: impl AsRef<[u8]>) -> &Self {
        let program = unpacked(&data("hu40t").join("O1005.nc.gz"));
        self.machine("name", "name")
            .write("O1005.nc", program)
            .write("run.csv", log)
            .test("[[run]]\nprogram = \"O1005.nc\"\nlog = \"run.csv\"\n")
    }

    /// Runs the binary here; results go to `results`.
    pub(crate) fn ballbar(&self, arguments: &[&str]) -> Outcome {
        self.ballbar_on("2", arguments)
    }

    /// The same without a directory for results.
    pub(crate) fn plain(&self, arguments: &[&str]) -> Outcome {
        let output = std::process::Command::new(assert_cmd::cargo::cargo_bin!("ballbar"))
            .env("RAYON_NUM_THREADS", "2")
            .current_dir(self.directory.path())
            .args(arguments)
            .output()
            .unwrap();
        Outcome { output, results: self.path("results") }
    }

    /// The same on a number of threads.
    pub(crate) fn ballbar_on(&self, threads: &str, arguments: &[&str]) -> Outcome {
        let output = std::process::Command::new(assert_cmd::cargo::cargo_bin!("ballbar"))
            .env("RAYON_NUM_THREADS", threads)
            .current_dir(self.directory.path())
            .args(arguments)
            .args(["-o", "results"])
            .output()
            .unwrap();
        Outcome { output, results: self.path("results") }
    }
}

/// What a run of the binary left behind.
pub(crate) struct Outcome {
    output: Output,
    results: PathBuf,
}

impl Outcome {
    pub(crate) fn stdout(&self) -> String {
        String::from_utf8(self.output.stdout.clone()).unwrap()
    }

    pub(crate) fn stderr(&self) -> String {
        String::from_utf8(self.output.stderr.clone()).unwrap()
    }

    pub(crate) fn code(&self) -> i32 {
        self.output.status.code().expect("no signal, no panic")
    }

    /// Names of the files in the directory of results, sorted.
    pub(crate) fn files(&self) -> Vec<String> {
        let Ok(entries) = std::fs::read_dir(&self.results) else { return Vec::new() };
        let mut names: Vec<String> =
            entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        // Beside them lies what was written, with hashes.
        names.retain(|name| name != ".ballbar");
        names.sort();
        names
    }

    /// It did what it was asked to.
    #[track_caller]
    pub(crate) fn done(self) -> Self {
        assert_eq!(self.code(), 0, "{}", self.stderr());
        self
    }

    /// It refused with this exit code, a hint, and nothing written; the message follows.
    #[track_caller]
    pub(crate) fn refused(&self, code: i32) -> String {
        let message = self.stderr();
        assert_eq!(self.code(), code, "{message}");
        assert_eq!(self.stdout(), "", "no data with an error");
        assert_eq!(self.files(), Vec::<String>::new(), "nothing half-written");
        assert!(!self.results.join(".ballbar/staged").exists(), "nothing left over");
        assert!(message.starts_with("error: "), "{message}");
        assert!(message.lines().any(|line| line.starts_with("hint: ")), "{message}");
        assert!(!message.contains("panicked"), "{message}");
        message
    }
}
