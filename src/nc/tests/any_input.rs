//! No text makes the reader panic, and what it reads holds together.

use nalgebra::Vector3;
use proptest::prelude::*;

use super::super::read::read_at_most;
use super::super::{Action, Path, Program, Reading};
use super::try_text;
use crate::machine::Dialect;

const VALID: &str = "%\nO1 (A)\nN10 G21 G17 G90 G94 G40 G49 G80 G54 G64\nG00 X10. Y-5. Z0.\n\
    G01 X151.5 Y0. F500.\nG04 P2000\nM00 (FIT)\nG03 X-150. Y0. R151.\nG02 I150. Z1.\n\
    M98 P1000 L2\nG53 G00 X0. Y0.\nM30\nO1000\nG91 G01 X1. Y.5\nG90\nM99\n%\n";

/// What every program keeps to.
fn check(program: &Program) {
    let moves: Vec<_> = program
        .steps
        .iter()
        .filter_map(|step| match step.action {
            Action::Move(motion) => Some(motion),
            _ => None,
        })
        .collect();
    for pair in moves.windows(2) {
        assert_eq!(pair[0].end_mm, pair[1].start_mm, "the path has no gap");
    }
    for motion in moves {
        assert!(motion.start_mm.iter().chain(&motion.end_mm).all(|x| x.is_finite()));
        assert!(motion.rapid || motion.feed_mm_s > 0.0);
        match motion.path {
            Path::Line => assert!(motion.end_mm != motion.start_mm),
            Path::Arc { sweep_rad, .. } => {
                assert!(sweep_rad != 0.0 && sweep_rad.abs() <= std::f64::consts::TAU);
            }
        }
    }
    let ends = |action| matches!(action, Action::End);
    assert!(ends(program.steps.last().unwrap().action));
    assert!(program.steps.iter().all(|step| step.label < program.labels.len()));
}

#[test]
fn the_valid_program_is_valid() {
    check(&try_text(VALID).unwrap());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_text_of_the_alphabet_is_read_or_refused(
        source in "([GMXYZIJKRFPNOLQUST][-+]?[0-9]{0,3}\\.?[0-9]?|[ ;%/()#\r]|\n|é|G0[0-3]|G9[01]|M30\n){0,60}"
    ) {
        if let Ok(program) = try_text(&source) {
            check(&program);
        }
    }

    #[test]
    fn any_text_of_a_siemens_or_a_tnc_is_read_or_refused(
        siemens in "(G0|G1|G2|G3|G4|G9[01]|G710|SUPA|D0|CR=|[XYZIJKRFNO]=?[-+]?[0-9]{0,3}\\.?[0-9]?|[ ;%/()=\r]|\n|é|MCALL|AC\\(|M30\n){0,60}",
        klartext in "([0-9]{1,2} |\n|L |C |CC |DR[-+] ?|R0 |FMAX ?|M91 ?|[XYZFMI][-+]?[0-9]{0,3}[.,]?[0-9]? ?|STOP|TOOL CALL [ZY5] ?|CYCL DEF [0-9]{1,2}\\.[0-3] |DWELL ?|[;~é]|M30\n){0,60}",
    ) {
        for (dialect, source) in [
            (Dialect::Siemens, siemens),
            (Dialect::Heidenhain, klartext.clone()),
            (Dialect::Heidenhain, format!("0 BEGIN PGM A MM\n{klartext}\nM30\nEND PGM A MM\n")),
        ] {
            let mut reading = Reading { dialect, ..Reading::default() };
            reading.work_offsets_mm.insert(54, Vector3::zeros());
            if let Ok(program) = read_at_most(&source, "P".as_ref(), &reading, 10_000) {
                check(&program);
            }
        }
    }

    #[test]
    fn blocks_of_motion_are_read_or_refused(
        blocks in proptest::collection::vec(
            ("(G0[0-3]|G9[01]|G1[789]|G2[01]|G5[345])?", "(X-?[0-3]\\.?)?(Y[0-3]\\.)?(Z-?[0-2]\\.)?",
             "(I-?[0-3]\\.)?(J-?[0-3]\\.)?(K[0-2]\\.)?(R-?[0-3]\\.)?"), 0..6)
    ) {
        let mut source = "G90 G00 X0. Y0. Z0. F100\n".to_owned();
        for (code, coordinates, arc) in &blocks {
            source.extend([code, coordinates, arc, "\n"]);
        }
        source.push_str("M30\n");
        if let Ok(program) = try_text(&source) {
            check(&program);
        }
    }

    #[test]
    fn a_damaged_program_is_read_or_refused(
        damage in proptest::collection::vec((0..VALID.len(), any::<u8>(), 0_u8..4), 1..6)
    ) {
        let mut bytes = VALID.as_bytes().to_vec();
        for (at, byte, kind) in damage {
            let at = at.min(bytes.len().saturating_sub(1));
            match kind {
                0 if !bytes.is_empty() => bytes[at] = byte,
                1 => bytes.insert(at, byte),
                2 if !bytes.is_empty() => { bytes.remove(at); }
                _ => bytes.truncate(at + 1),
            }
        }
        if let Ok(program) = try_text(&String::from_utf8_lossy(&bytes)) {
            check(&program);
        }
    }
}
