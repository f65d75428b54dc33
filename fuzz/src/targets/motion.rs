//! What a control recorded of its motion, laid over a program.

use std::fmt::Write as _;
use std::sync::LazyLock;

use ballbar::log::Recording;
use ballbar::motion::{Reversals, Trajectory};
use ballbar::nc::{self, Program};

use super::{Target, accepted};
use crate::seeds::RIGS;

/// Some seconds, so that a recording of it is short.
static PROGRAM: LazyLock<Program> = LazyLock::new(|| {
    let blocks = "G90 G54 G00 X0. Y0. Z0.\nX30. Z-2.\nM00\nG17 G01 X25. F3000.\nG04 P100\nG03 X25. Y0. I-25. J0.\nG04 P100\nG01 X30.\nM30\n";
    let read = nc::read(blocks, "O1.nc".as_ref(), &RIGS[0].reading(0));
    read.unwrap_or_else(|error| panic!("a seed cannot be read: {error}"))
});

pub const TARGET: Target = Target {
    name: "motion",
    seeds: || {
        let planned = Trajectory::new(&PROGRAM, &RIGS[0].machine, 1.0);
        let (mut named, mut bare) = ("time_s,x_mm,y_mm,z_mm\n".to_owned(), String::new());
        let rows = (planned.end_s() * 50.0) as u32;
        for k in 0..=rows {
            let time_s = 0.02 * f64::from(k);
            let at = planned.at(time_s).position_mm;
            let _ = writeln!(named, "{time_s:.2},{:.3},{:.3},{:.3}", at.x, at.y, at.z);
            let _ = writeln!(bare, "{} {:.6} {:.6} {:.6} 0", 20 * k, at.x, at.y, at.z);
        }
        vec![named.into_bytes(), bare.into_bytes()]
    },
    words: &[
        "time_s", "time_ms", "x_mm", "Y [um]", "z (inch)", "#", ",", ";", "\t", "1e308", "-1e-308",
        "nan", "inf", "1,5", "0",
    ],
    made: &[
        // As many rows as there may be, that creep and that stand.
        || {
            (0..3_000_000)
                .map(|k| format!("{:.6} 0 0\n", 1e-5 * f64::from(k)))
                .collect::<String>()
                .into_bytes()
        },
        || b"0 0 0\n".repeat(5_000_000),
        || b"1 2\n".repeat(10_000_000),
    ],
    read,
};

fn read(input: &[u8]) -> bool {
    let recording = Recording::read_bytes(input, "motion.csv".as_ref());
    if !accepted(&recording) {
        return false;
    }
    let Ok(recording) = recording else { return false };
    let rows = recording.rows();
    assert!(rows.windows(2).all(|two| two[0].time_s < two[1].time_s), "times increase");
    let driven = Trajectory::recorded(&PROGRAM, &RIGS[0].machine, &recording);
    if let Ok(driven) = &driven {
        assert!(driven.end_s().is_finite());
        assert!(driven.blocks().iter().all(|block| block.duration_s >= 0.0), "time goes on");
        let reversals = Reversals::of(driven);
        for k in -1..=100 {
            let at_s = driven.end_s() * f64::from(k) / 99.0;
            let state = driven.at(at_s);
            assert!(state.position_mm.iter().chain(&state.velocity_mm_s).all(|n| n.is_finite()));
            for rounded in [-1.0, 0.0, 0.7, 2.0] {
                let _ = reversals.last(at_s, &state.position_mm, rounded);
            }
        }
    }
    accepted(&driven)
}
