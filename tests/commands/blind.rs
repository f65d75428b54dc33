//! `ballbar blind` says how far it is.

use crate::work::Work;

#[test]
fn trials_are_told_as_they_end_beside_the_json_of_all() {
    let work = Work::new();
    // Of this seed the first campaign is a plane, which takes a moment.
    let trials = "blind --grid --seed 6 --class none --trials 1 --list --json";
    let trials: Vec<&str> = trials.split(' ').collect();
    let outcome = work.ballbar(&trials).done();
    let json: serde_json::Value = serde_json::from_str(&outcome.stdout()).unwrap();
    assert_eq!(json["format"], "ballbar.blind/1");
    assert_eq!(json["trials"].as_array().unwrap().len(), 1);
    let told = outcome.stderr();
    assert!(told.contains("1 trials, some seconds each") && told.contains("none:0 "), "{told}");
}
