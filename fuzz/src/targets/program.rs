//! NC programs: read, and timed.

use ballbar::motion::Trajectory;
use ballbar::nc::{Action, Path, Program, read as read_program};

use super::{Target, accepted};
use crate::seeds::{self, RIGS};

pub const TARGET: Target = Target { name: "program", seeds, words: WORDS, made: MADE, read };

pub const WORDS: &[&str] = &[
    "G00",
    "G01",
    "G02",
    "G03",
    "G04",
    "G05.1",
    "G05",
    "G08",
    "G09",
    "G15",
    "G17",
    "G18",
    "G19",
    "G20",
    "G21",
    "G40",
    "G49",
    "G50",
    "G53",
    "G54",
    "G55",
    "G59",
    "G61",
    "G64",
    "G69",
    "G80",
    "G90",
    "G91",
    "G94",
    "M00",
    "M01",
    "M02",
    "M03",
    "M05",
    "M08",
    "M30",
    "M98",
    "M99",
    "P1000",
    "L9999",
    "P2000",
    "Q1",
    "X",
    "Y",
    "Z",
    "I",
    "J",
    "K",
    "R",
    "F",
    "S",
    "T",
    "U",
    "N",
    "O",
    "X-",
    "Z1.",
    "R1.",
    "F500.",
    "(MSG,A)",
    ";",
    "%",
    "/",
    "G710",
    "G4 F1",
    "SUPA",
    "D0",
    "TRANS",
    "MCALL",
    "CR=",
    "X=1",
    "X=AC(1)",
    "%_N_A_MPF",
    "0 BEGIN PGM A MM",
    "L",
    "C",
    "CC",
    "DR+",
    "DR-",
    "R0",
    "FMAX",
    "M91",
    "IX+1",
    "STOP",
    "TOOL CALL Z",
    "CYCL DEF 9.0",
    "CYCL DEF 9.1 DWELL 1",
    "CYCL DEF 7.1 X+0",
    "CYCL DEF 10.1 ROT+0",
    "END PGM A MM",
    "X+1,5",
    "~",
];

/// What runs long, and what nests deep.
const MADE: &[fn() -> Vec<u8>] = &[
    || {
        b"%\nO1\nM98 P2 L9999\nM30\nO2\nM98 P3 L9999\nM99\nO3\nM98 P4 L9999\nM99\nO4\nM99\n%\n"
            .to_vec()
    },
    || b"%\nO1\nM98 P1 L9999\nM30\n%\n".to_vec(),
    || {
        b"O1\nG90 G54 G00 X0 Y0 Z0\nG91 F100\nM98 P2 L9999\nM30\nO2\nM98 P3 L9999\nM99\nO3\nG01 X1.\nG01 X-1.\nM99\n"
            .to_vec()
    },
    || b"G1\n".repeat(2_000_000),
    || [b"G01 ".to_vec(), b"X1.".repeat(1_000_000)].concat(),
    || vec![b'('; 3_000_000],
];

pub fn seeds() -> Vec<Vec<u8>> {
    let mut seeds = vec![
        include_bytes!("../seeds/siemens.mpf").to_vec(),
        include_bytes!("../seeds/klartext.h").to_vec(),
        include_bytes!("../seeds/words.nc").to_vec(),
        include_bytes!("../seeds/linuxcnc.nc").to_vec(),
    ];
    let written = RIGS.iter().flat_map(|rig| &rig.programs);
    seeds.extend(written.map(|program| program.text.clone().into_bytes()));
    seeds
}

/// What every program keeps to.
pub fn holds_together(program: &Program) {
    let moves: Vec<_> = program
        .steps
        .iter()
        .filter_map(|step| match step.action {
            Action::Move(motion) => Some(motion),
            _ => None,
        })
        .collect();
    for motion in moves {
        assert!(motion.start_mm.iter().chain(&motion.end_mm).all(|x| x.is_finite()), "{motion:?}");
        assert!(motion.rapid || motion.feed_mm_s > 0.0, "{motion:?}");
        if let Path::Arc { sweep_rad, .. } = motion.path {
            assert!(sweep_rad != 0.0 && sweep_rad.abs() <= std::f64::consts::TAU, "{motion:?}");
        }
    }
    assert!(program.steps.iter().all(|step| step.label < program.labels.len()));
}

fn read(input: &[u8]) -> bool {
    let text = seeds::as_text(input);
    let mut taken = false;
    for rig in RIGS.iter() {
        let program = read_program(&text, "O0001.nc".as_ref(), &rig.reading(0));
        if let Ok(program) = &program {
            holds_together(program);
            let trajectory = Trajectory::new(program, &rig.machine, 1.0);
            let time = trajectory.duration();
            assert!(
                time.known_s().is_finite() && time.known_s() >= 0.0,
                "a program takes a time: {time:?}"
            );
            let _ = trajectory.at(0.3 * trajectory.end_s());
        }
        taken |= accepted(&program);
    }
    taken
}
