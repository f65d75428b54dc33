//! What a designer makes of requests: the figures that it promises, and what it refuses.

use super::Designer;
use crate::error::Result;
use crate::plan::Test;

/// A request for the HU40-T, beginning with keys of `[design]`.
fn source(design: &str) -> String {
    let machine = std::fs::canonicalize("machines/hu40t.toml").unwrap();
    format!(
        "name = 'T'\nmachine = '{}'\n[ball_bar]\nlength_mm = 150.0\n[[mounting]]\n\
         name = 'A'\ncoincidence_mm = [20.0, -35.0, 40.0]\ntool_ball_mm = [0.0, 0.0, -200.0]\n[plan]\n\
         feed_mm_min = 500.0\n[design]\nbudget_min = 60.0\n{design}\n",
        machine.display()
    )
}

fn request(design: &str) -> Test {
    Test::parse(&source(design), "t.toml".as_ref()).unwrap()
}

fn designer<T>(design: &str, then: impl FnOnce(Result<Designer<'_>>) -> T) -> T {
    let test = request(design);
    let machine = test.machine().unwrap();
    then(Designer::new(&test, &machine, None))
}

fn refusal(design: &str) -> String {
    designer(design, |made| made.map(|_| ()).unwrap_err().to_string())
}

#[test]
fn few_candidate_arcs_are_all_looked_at_for_what_they_tell() {
    let basis = designer("step_deg = 90", |made| made.unwrap().told_apart());
    assert_eq!(basis, 53);
}

#[test]
fn what_is_wanted_and_unseen_is_refused_beside_complete_too() {
    let told = refusal("wanted = ['complete', 'EXX0']");
    assert!(told.contains("can see `EXX0`") && told.contains("hint:"), "{told}");
}

#[test]
fn a_volume_beyond_the_travel_is_refused_with_figures() {
    let told = refusal("volume_mm = [[-250, 250], [-250, 250], [0, 900]]");
    assert!(told.contains("from 0 to 900 mm in Z, the travel from -200 to 400 mm"), "{told}");
}

#[test]
fn a_bar_that_drives_no_arc_is_refused_with_the_reason() {
    let told = refusal("bar_lengths_mm = [5.0]\nplaces = 'corners'");
    assert!(told.contains("no arc can be driven in any place: the bodies"), "{told}");
    assert!(told.contains("mm of each other"), "{told}");
}

/// In a box of some millimetres a cubic does next to nothing; that is no reason to stop after one arc.
#[test]
fn a_small_volume_uses_the_time_that_there_is() {
    let volume = "volume_mm = [[-5, 5], [-5, 5], [-5, 5]]";
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("wish.toml");
    std::fs::write(&file, source(volume)).unwrap();
    let test = Test::read(&file).unwrap();
    let machine = test.machine().unwrap();
    let proposal = Designer::new(&test, &machine, None).unwrap().propose(&|| ()).unwrap();
    assert!(proposal.total_s > 55.0 * 60.0, "{} s", proposal.total_s);
    assert!(proposal.value[1] < 0.01 * proposal.value[0], "{:?}", proposal.value);
}

#[test]
fn arcs_that_tell_nothing_are_not_too_long() {
    let test = request("places = 'mountings'\nstep_deg = 45");
    let machine = test.machine().unwrap();
    let designer = Designer::new(&test, &machine, None).unwrap();
    let told = designer.nothing_fits(f64::INFINITY).to_string();
    assert!(told.contains("within 60.0 min no arc tells anything"), "{told}");
    let told = designer.nothing_fits(3630.0).to_string();
    assert!(told.contains("60.0 min is shorter than the shortest test of 60.5 min"), "{told}");
}
