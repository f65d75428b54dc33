//! Slides that all follow alike, in circles that do not tell it: a radius is the scales' as well.

use std::fmt::Write as _;

use serde_json::Value;

use crate::work::{Work, project};

/// A circle both ways in a plane, fed in along its radius without a dwell before the arc.
fn circle(plane: &str, along: &str, centre: &str, feed: &str) -> String {
    let way = |sense: &str| {
        format!("G01 {along}-100.\n{sense} {along}-100. {centre}100.\nG01 {along}-102.\n")
    };
    let at = |along_mm: &str, others_mm: &str| {
        let of = |axis| format!("{axis}{}", if axis == along { along_mm } else { others_mm });
        ["X", "Y", "Z"].map(of).join(" ")
    };
    format!(
        "%\nO1\nG21 G90 G94 {plane}\nG54\nG64\nG00 {}\nG01 {} F{feed}\nM00\nG04 P2000\n{}G04 P2000\n{}M30\n%\n",
        at("-107.", "-5."),
        at("-102.", "0."),
        way("G03"),
        way("G02")
    )
}

/// A test of a circle in each plane, each in a log of its own, with a bar that reads whole micrometres.
pub(crate) fn three_planes(feed: &str) -> Work {
    let work = Work::new();
    work.write("machine.toml", std::fs::read(project().join("machines/hu40t.toml")).unwrap());
    let mut test = "name = \"Planes\"\nmachine = \"machine.toml\"\n[ball_bar]\nlength_mm = 100.0\nresolution_um = 1.0\n\
         [[mounting]]\nname = \"A\"\ncoincidence_mm = [20.0, -35.0, 40.0]\ntool_ball_mm = [0.0, 0.0, -200.0]\n"
        .to_owned();
    for (plane, along, centre) in [("G17", "X", "I"), ("G19", "Y", "J"), ("G18", "Z", "K")] {
        work.write(&format!("{plane}.nc"), circle(plane, along, centre, feed));
        let _ = write!(test, "[[run]]\nprogram = \"{plane}.nc\"\nlog = \"{plane}.csv\"\n");
    }
    work.write("test.toml", test);
    work
}

pub(crate) fn told_of(work: &Work) -> (Value, toml::Table) {
    let told = work.ballbar(&["identify", "results/test.toml", "--json"]).done().stdout();
    let truth = std::fs::read_to_string(work.path("results/truth.toml")).unwrap();
    (serde_json::from_str(&told).unwrap(), toml::from_str(&truth).unwrap())
}

/// What a radial feed-in leaves slides behind by they catch up on the arc; a reading of that is no reading of a radius. And what one
/// plane has beyond the others, whose lags nothing tells either, is no lag.
#[test]
fn no_lag_is_told_of_three_circles_that_have_it_alike() {
    for (lag_ms, feed, seed) in [("25", "900.", "2"), ("10", "3000.", "1"), ("0", "3000.", "2")] {
        let work = three_planes(feed);
        work.write(
            "late.toml",
            format!("sample_rate_hz = 250.0\nresolution_um = 1.0\n[noise]\nwhite_um = 0.05\ncorrelated_um = 0.05\n[motion]\nfollowing_ms = [{lag_ms}, {lag_ms}, {lag_ms}]\n"),
        );
        work.ballbar(&["simulate", "test.toml", "--scenario", "late.toml", "--seed", seed]).done();
        let (told, truth) = told_of(&work);
        for axis in ["X", "Y", "Z"] {
            let asked = told["at_the_place"].as_array().unwrap();
            let of = asked.iter().find(|of| of["quantity"] == format!("scale {axis}")).unwrap();
            let scale = truth["at_the_place"][&format!("scale_{axis}_um_m")].as_float().unwrap();
            let off = of["value"].as_f64().unwrap() - scale;
            assert!(off.abs() < 2.0 * of["all"].as_f64().unwrap(), "{lag_ms} ms: {off} of {of}");
        }
        for run in told["repeats"][0]["runs"].as_array().unwrap() {
            let of = |key: &str| run["control"][key].as_f64().unwrap();
            let most_ms = of("following_ms") + 2.0 * of("following_sigma_ms");
            assert!(most_ms > lag_ms.parse().unwrap(), "{lag_ms} ms: at most {most_ms}");
        }
    }
}
