use std::path::Path;

use super::*;
use crate::machine::Machine;
use crate::nc;

/// Corners with and without a stop, arcs from rest to rest, a helix, chords, a dwell and an operator's pause.
const PROGRAM: &str = "%\nO1\nG21 G17 G90 G94 G64\nG54\nG00 X-107. Y0. Z0.\nG01 X-102. F1500.\nM00\n\
    G04 P500\nG01 X-100.\nG03 X0. Y-100. I100.\nG03 X-100. Y0. Z3. J100.\nG01 X-102.\nY0.5\nX-101.5 Y0.8\nX-101. Y1.\nX-100.4 Y1.05\n\
    G04 P300\nG02 X-100.4 Y1.05 I50.\nG00 X-90.\nM30\n%\n";

fn trajectory(bell_ms: Option<f64>) -> Trajectory {
    let text = std::fs::read_to_string("machines/hu40t.toml").unwrap();
    let text = match bell_ms {
        Some(ms) => {
            text.replace("[controller]", &format!("[controller]\nacceleration_change_ms = {ms}"))
        }
        None => text,
    };
    let machine = Machine::parse(&text, Path::new("hu40t.toml")).unwrap();
    let mut reading = nc::Reading::of(&machine);
    reading.work_offsets_mm.insert(54, Vector3::new(20.0, -35.0, 40.0));
    let program = nc::read(PROGRAM, Path::new("O1.nc"), &reading).unwrap();
    Trajectory::new(&program, &machine, 1.0)
}

/// The lag integrated in steps of 20 us, in which the command is taken to be straight, looked at every `every` of them.
fn integrated(
    trajectory: &Trajectory,
    constants_s: &Vector3<f64>,
    every: usize,
) -> Vec<(f64, Vector3<f64>)> {
    let step_s = 2e-5;
    let steps = ((trajectory.end_s() + 0.3) / step_s) as usize;
    let mut place_mm = trajectory.position_near_mm(0.0, 0);
    let mut before_mm = place_mm;
    let mut found = Vec::new();
    for step in 1..=steps {
        let time_s = step as f64 * step_s;
        let now_mm = trajectory.at(time_s).position_mm;
        for k in 0..3 {
            let steady_mm = constants_s[k] * (now_mm[k] - before_mm[k]) / step_s;
            let left = (-step_s / constants_s[k]).exp();
            place_mm[k] = now_mm[k] - steady_mm + left * (place_mm[k] - before_mm[k] + steady_mm);
        }
        before_mm = now_mm;
        if step % every == 0 {
            found.push((time_s, place_mm));
        }
    }
    found
}

#[test]
fn a_lag_is_that_of_its_equation_on_every_kind_of_path() {
    for bell_ms in [None, Some(60.0)] {
        let trajectory = trajectory(bell_ms);
        for constants_s in [Vector3::repeat(0.02), Vector3::new(0.031, 0.028, 0.005)] {
            let followed = Followed::new(&trajectory, constants_s).unwrap();
            let mut most_mm = 0.0_f64;
            for (time_s, place_mm) in integrated(&trajectory, &constants_s, 130) {
                let near = trajectory.block_at(time_s - 0.02);
                let [here_mm, _] = followed.at(&trajectory, time_s, near);
                most_mm = most_mm.max((here_mm - place_mm).amax());
            }
            assert!(most_mm < 1e-6, "{bell_ms:?} {constants_s:?}: {most_mm:.2e} mm");
        }
    }
}

#[test]
fn its_slope_is_that_of_differences() {
    for bell_ms in [None, Some(60.0)] {
        let trajectory = trajectory(bell_ms);
        let constants_s = Vector3::new(0.031, 0.028, 0.005);
        let with =
            |more_s: f64| Followed::new(&trajectory, constants_s.add_scalar(more_s)).unwrap();
        let (less, here, more) = (with(-1e-5), with(0.0), with(1e-5));
        for step in 0..2000 {
            let time_s = trajectory.end_s() * f64::from(step) / 1990.0;
            let near = trajectory.block_at(time_s);
            let at = |followed: &Followed| followed.at(&trajectory, time_s, near);
            let slope = (at(&more)[0] - at(&less)[0]) / 2e-5;
            let off = (at(&here)[1] - slope).amax();
            assert!(off < 1e-4 * (1.0 + slope.amax()), "{time_s} s: {off:.2e} mm/s of {slope:?}");
        }
    }
}
