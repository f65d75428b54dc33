//! The programs of a campaign of the grid.

use std::path::Path;
use std::sync::Arc;

use super::factors::{Driven, Factors, Make};
use crate::design::PlannedProgram;
use crate::error::Result;
use crate::machine::Machine;
use crate::nc::{self, Reading, Source};
use crate::plan::Test;
use crate::trial::chance::Chance;
use crate::trial::course::{Course, CourseProgram, CourseRun};

/// A vertical machine whose zero lies at the end of travel.
const VERTICAL: &str = r#"name = "Vertical machine"
topology = "wXYFZSt"
[axes.X]
travel_mm = [0.0, 800.0]
rapid_mm_min = 15000.0
acceleration_mm_s2 = 500.0
[axes.Y]
travel_mm = [0.0, 560.0]
rapid_mm_min = 15000.0
acceleration_mm_s2 = 500.0
[axes.Z]
travel_mm = [-510.0, 0.0]
rapid_mm_min = 15000.0
acceleration_mm_s2 = 500.0
"#;

/// Where the balls meet: machine coordinates, how far a second place is from there, and the tool ball, mm.
fn place(make: Make) -> [[f64; 3]; 3] {
    match make {
        Make::Hu40t => [[20.0, -35.0, 40.0], [80.0, 60.0, 90.0], [0.0, 0.0, -200.0]],
        Make::Vertical => [[410.0, 270.0, -260.0], [150.0, 90.0, 60.0], [0.0, 0.0, -150.0]],
    }
}

/// The machine file.
pub(super) fn machine_toml(make: Make) -> &'static str {
    match make {
        Make::Hu40t => include_str!("../../../machines/hu40t.toml"),
        Make::Vertical => VERTICAL,
    }
}

/// The test file of a feed.
fn test_toml(factors: &Factors, feed_mm_min: f64, second_mm: [f64; 3]) -> String {
    let [ball_mm, _, tool_mm] = place(factors.make);
    let mounting = |name: &str, at_mm: [f64; 3]| {
        format!(
            "[[mounting]]\nname = \"{name}\"\ncoincidence_mm = {at_mm:?}\ntool_ball_mm = {tool_mm:?}\n"
        )
    };
    let mut text = format!(
        "name = \"Grid\"\nmachine = \"machine.toml\"\n[ball_bar]\nlength_mm = {:?}\nrange_mm = 1.2\n\
         resolution_um = {:?}\nclock_ppm = 100.0\n{}",
        factors.bar_mm,
        1e3 * factors.resolution_mm,
        mounting("A", ball_mm)
    );
    if factors.driven == Driven::TwoPlaces {
        text.push_str(&mounting("B", std::array::from_fn(|k| ball_mm[k] + second_mm[k])));
    }
    let strategy = match factors.driven {
        Driven::Plane => "xy",
        Driven::Planes => "iso230-4",
        Driven::Sphere | Driven::TwoPlaces => "3d6",
    };
    text + &format!("[plan]\nstrategy = \"{strategy}\"\nfeed_mm_min = {feed_mm_min:?}\n")
}

/// A plane as it is tested every day: G03 and G02 all round, the bar engaged along the first axis.
fn plane(number: u32, [plane, a, b, c]: [&str; 4], centre: &str, r_mm: f64, feed: f64) -> String {
    let (far, near) = (r_mm + 7.0, r_mm + 2.0);
    let arc = |g: &str| format!("{g} {a}-{r_mm:.3} {b}0. {centre}{r_mm:.3}\n");
    let engaged = format!("G04 P2000\nG01 {a}-{r_mm:.3}\n");
    let apart = format!("G01 {a}-{near:.3}\n");
    format!(
        "%\nO{number} (BALL-BAR {a}{b})\nG21 {plane} G90 G94 G40 G49 G80\nG54\nG64\n\
         G00 {a}-{far:.3} {b}-5. {c}-5.\nG01 {a}-{near:.3} {b}0. {c}0. F{feed:.1}\nM00 (FIT BALL-BAR)\n\
         {engaged}{}{apart}{engaged}{}{apart}M30\n%\n",
        arc("G03"),
        arc("G02")
    )
}

/// The course of these factors with its test file; the sides to which a second place lies are drawn.
pub(super) fn course(factors: &Factors, chance: &mut Chance) -> Result<(Course, String)> {
    let second_mm = place(factors.make)[1].map(|mm| mm * chance.sign());
    let machine = Machine::parse(machine_toml(factors.make), Path::new("machine.toml"))?;
    let feeds = factors.feeds_mm_min;
    let text = test_toml(factors, feeds[0], second_mm);
    let test_of_first = Test::parse(&text, Path::new("grid.toml"))?;
    let alike = feeds[0].total_cmp(&feeds[1]).is_eq() || factors.repeats == 1;
    let feeds = if alike { &feeds[..1] } else { &feeds[..] };
    let (mut programs, mut of_feed) = (Vec::new(), Vec::new());
    for &feed_mm_min in feeds {
        let of_feed_toml = test_toml(factors, feed_mm_min, second_mm);
        let test = Test::parse(&of_feed_toml, Path::new("grid.toml"))?;
        let first = programs.len();
        let planes: &[([&str; 4], &str)] = &[
            (["G17", "X", "Y", "Z"], "I"),
            (["G19", "Y", "Z", "X"], "J"),
            (["G18", "Z", "X", "Y"], "K"),
        ];
        let planes = match factors.driven {
            Driven::Plane => &planes[..1],
            Driven::Planes => planes,
            Driven::Sphere | Driven::TwoPlaces => &[],
        };
        for (k, (letters, centre)) in planes.iter().enumerate() {
            let number = 5001 + (10 * first + k) as u32;
            let text = plane(number, *letters, centre, factors.bar_mm, feed_mm_min);
            let mut reading = Reading::of(&machine);
            let mounting = &test.mountings()[0];
            reading.work_offsets_mm.insert(mounting.work_offset, mounting.mounting.coincidence_mm);
            let file = Path::new("grid.nc").with_file_name(format!("O{number}.nc"));
            let program = nc::read(&text, &file, &reading)?;
            programs.push((0, CourseProgram { source: Arc::new(Source { file, text }), program }));
        }
        if planes.is_empty() {
            for mounting in 0..test.mountings().len() {
                let planned = PlannedProgram::new(&test, &machine, mounting)?;
                programs.push((mounting, CourseProgram::from(planned)));
            }
        }
        of_feed.push(first..programs.len());
    }
    let mut runs = Vec::new();
    for repeat in 0..factors.repeats {
        runs.extend(of_feed[repeat % of_feed.len()].clone().map(|program| CourseRun {
            name: format!("run{}-{}", repeat + 1, program + 1),
            program,
            mounting: programs[program].0,
            repeat: repeat as u32 + 1,
            sample_rate_hz: Some(factors.rate_hz),
            feed_override: 1.0,
        }));
    }
    let programs = programs.into_iter().map(|(_, program)| program).collect();
    Ok((Course { test: test_of_first, machine, programs, runs, texts: None }, text))
}
