//! Backlash that grows along an axis, of a test that is far from the zero of the machine.

use serde_json::Value;

use crate::work::{Work, project};

const SLOPE_UM_M: f64 = 100.0;
const MIDDLE_MM: f64 = -140.0;
const BAR_MM: f64 = 100.0;

/// Wherever the growth is told from, the step at either end of the circle is what the bar read there.
#[test]
fn what_grows_along_an_axis_is_told_where_the_test_was() {
    let work = Work::new();
    work.write("machine.toml", std::fs::read(project().join("machines/vertical.toml")).unwrap())
        .write("perfect.toml", "[coefficients]\n")
        .write(
            "test.toml",
            format!(
                "name = \"Growing\"\nmachine = \"machine.toml\"\n[ball_bar]\nlength_mm = {BAR_MM:?}\n\
                 [[mounting]]\nname = \"A\"\ncoincidence_mm = [100.0, {MIDDLE_MM:?}, -260.0]\n\
                 tool_ball_mm = [0.0, 0.0, -120.0]\n[plan]\nstrategy = \"xy\"\nfeed_mm_min = 1350.0\n"
            ),
        );
    let hidden = format!("growing-backlash:on=EXY,slope_um_m={SLOPE_UM_M}");
    work.ballbar(&["simulate", "test.toml", "--scenario", "perfect.toml", "--hide", &hidden])
        .done();
    let told = work.ballbar(&["analyse", "results/test.toml", "--json"]).done().stdout();
    let told: Value = serde_json::from_str(&told).unwrap();
    let features = told["ranking"]["tests"][0]["features"].as_array().unwrap();
    let play = features.iter().find(|of| of["feature"] == "lateral play Y in X").unwrap();
    for (end, at_mm) in [("positive_end", MIDDLE_MM + BAR_MM), ("negative_end", MIDDLE_MM - BAR_MM)]
    {
        let step_um = (2e-3 * SLOPE_UM_M * at_mm).abs();
        let told_um = play[end].as_f64().unwrap().abs();
        assert!((told_um - step_um).abs() < 0.02 * step_um, "{end}: {told_um}, {step_um} is true");
    }
}
