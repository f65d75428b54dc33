//! `check` of NC programs, with and without a test.

use ballbar::motion::Trajectory;
use ballbar::nc::{Reading, Severity, Sphere, check};

use super::{Target, program, told};
use crate::seeds::{self, RIGS};

pub const TARGET: Target = Target {
    name: "check",
    seeds: program::seeds,
    words: program::WORDS,
    made: &[
        || {
            b"%\nO1\nM98 P2 L9999\nM30\nO2\nM98 P3 L9999\nM99\nO3\nM98 P4 L9999\nM99\nO4\nM99\n%\n"
                .to_vec()
        },
        || {
            b"O1\nG90 G54 G00 X0 Y0 Z0\nG91 F100\nM98 P2 L9999\nM30\nO2\nM98 P3 L9999\nM99\nO3\nG01 X1.\nG01 X-1.\nM99\n".to_vec()
        },
        || b"G1\n".repeat(2_000_000),
        || b"M98 P1\n".repeat(300_000),
    ],
    read,
};

fn read(input: &[u8]) -> bool {
    let text = seeds::as_text(input);
    let mut clean = false;
    for rig in RIGS.iter() {
        let sphere = Sphere::of(&rig.test, 0);
        let checked =
            check(&text, "O0001.nc".as_ref(), &rig.machine, &rig.reading(0), sphere.as_ref());
        match checked {
            Ok(checked) => {
                for finding in &checked.findings {
                    assert!(!finding.to_string().is_empty(), "a finding says something");
                }
                program::holds_together(&checked.program);
                clean |= checked.count(Severity::Error) == 0;
                // What `--plot` needs.
                let _ = Trajectory::new(&checked.program, &rig.machine, 1.0).end_s();
            }
            Err(error) => told(&error),
        }
        let bare =
            check(&text, "O0001.nc".as_ref(), &rig.machine, &Reading::of(&rig.machine), None);
        if let Err(error) = bare {
            told(&error);
        }
    }
    clean
}
