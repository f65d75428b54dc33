//! Logs with an effect hidden in them: the cause is named first, with its numbers, and the gain holds on
//! runs that took no part. `truth.toml` is read by the assertions alone.

use std::path::{Path, PathBuf};

use ballbar::diagnose::Diagnosis;
use ballbar::plan::Test;

use crate::judge::{self, NOISE_MM, explained, near};

fn data(set: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(set)
}

fn diagnosed(set: &str) -> Diagnosis {
    judge::diagnosed(&Test::read(&data(set).join("test.toml")).unwrap()).2
}

/// The text that says what was hidden.
fn truth(set: &str) -> String {
    let text = std::fs::read_to_string(data(set).join("truth.toml")).unwrap();
    let table: toml::Table = text.parse().unwrap();
    table["effect"].as_str().unwrap().to_owned()
}

/// The number that stands right before a word or a sign in the truth.
fn before(text: &str, words: &str) -> f64 {
    let (head, _) = text.split_once(words).unwrap_or_else(|| panic!("`{words}` in `{text}`"));
    let number = head.trim_end().rsplit([' ', '(']).next().unwrap();
    number.parse().unwrap_or_else(|_| panic!("`{number}` before `{words}`"))
}

/// As [`explained`], and in every run and at every feed.
#[track_caller]
fn explained_everywhere(diagnosis: &Diagnosis) {
    explained(diagnosis);
    for run in &diagnosis.runs {
        assert!(run.explained.unwrap() > 0.95, "{run:?}");
    }
    // What one feed says holds at the other.
    for program in &diagnosis.programs {
        assert!(program.after_mm < 1.06 * NOISE_MM, "{program:?}");
    }
}

/// What the first finding is and acts on.
fn first(diagnosis: &Diagnosis) -> (String, String) {
    let shape = diagnosis.findings[0].element.shape().unwrap();
    (shape.cause.id.to_owned(), shape.seat.to_string())
}

#[test]
fn a_cyclic_error_of_a_screw() {
    let diagnosis = diagnosed("case-a");
    let truth = truth("case-a");
    assert_eq!(first(&diagnosis), ("cyclic".into(), "EXX".into()));
    let finding = &diagnosis.findings[0];
    near(finding, "amplitude_um", before(&truth, "um * sin"));
    near(finding, "period_mm", before(&truth, "mm + 0.7"));
    near(finding, "phase_rad", before(&truth, "rad)"));
    explained_everywhere(&diagnosis);
}

#[test]
fn following_errors_that_differ() {
    let diagnosis = diagnosed("case-b");
    let truth = truth("case-b");
    // Only the difference is seen, and the slide that differs from the other two is Y.
    assert_eq!(first(&diagnosis), ("servo".into(), "Y".into()));
    let difference = before(&truth, "ms in Y") - before(&truth, "ms in X");
    near(&diagnosis.findings[0], "delay_ms", difference);
    explained_everywhere(&diagnosis);
}

#[test]
fn a_spindle_that_grows() {
    let diagnosis = diagnosed("case-c");
    let truth = truth("case-c");
    assert_eq!(first(&diagnosis), ("drift".into(), "EZt".into()));
    let finding = &diagnosis.findings[0];
    near(finding, "amplitude_um", before(&truth, "um * (1"));
    near(finding, "time_constant_s", before(&truth, "s)"));
    explained_everywhere(&diagnosis);
}

#[test]
fn nothing_is_found_where_nothing_is() {
    for set in ["case-d", "hu40t"] {
        assert_eq!(truth(set), "none");
        let diagnosis = diagnosed(set);
        assert!(diagnosis.nothing_found(), "{set}: {:?}", diagnosis.findings);
        // No view foretells anything of another run.
        for view in &diagnosis.views {
            assert!(view.share_before < 0.02, "{set}: {} {}", view.name(), view.share_before);
        }
    }
}

#[test]
fn what_holds_structure_is_shown_first_and_gone_afterwards() {
    let diagnosis = diagnosed("case-a");
    let first = &diagnosis.views[0];
    assert_eq!(first.variable, "position of X");
    assert!(first.share_before > 0.8 && first.share_after < 0.02, "{first:?}");
    assert!(diagnosis.views.iter().all(|view| view.share_after < 0.02));
    let spectrum =
        diagnosis.views.iter().find(|view| view.variable.starts_with("spectrum over")).unwrap();
    let peak = spectrum.bins.iter().max_by(|a, b| a.before_mm.total_cmp(&b.before_mm)).unwrap();
    // One wave in 10 mm.
    assert!((peak.center - 0.1).abs() < 0.005, "{peak:?}");
    // On every arc that two runs drove nothing repeats any more but by chance: neighbours hang together in pairs.
    for arc in &diagnosis.arcs {
        let pairs = 0.5 * arc.samples as f64 / arc.runs as f64;
        assert!(arc.structure_after.unwrap().abs() < 3.0 / pairs.sqrt(), "{arc:?}");
    }
    let picture = diagnosis.pictures[0].as_ref().unwrap();
    let far = picture.points.iter().map(|p| ((p.measured - p.fitted) / p.sigma).abs());
    assert!(far.fold(0.0, f64::max) < 6.0);
}
