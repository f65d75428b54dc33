//! How long the paper's test takes here, and what would make it as long as the paper says.

use std::fmt::Write as _;

use crate::error::{Error, Result};
use crate::machine::Machine;
use crate::motion::{BlockKind, Trajectory};
use crate::nc::{self, Reading};
use crate::plan::{Path, Test};

/// One test of the paper took this long, s, set-up not counted.
pub const PAPER_TEST_S: f64 = 37.0 * 60.0;

/// So many readings the paper has of one test.
pub const PAPER_READINGS: f64 = 5990.0;

/// One way to drive the circles of 3D6 at the paper's feed of 500 mm/min.
#[derive(Debug, Clone, PartialEq)]
pub struct PaperTime {
    /// What is driven.
    pub what: &'static str,
    /// On the arcs, s.
    pub arcs_s: f64,
    /// From one arc to the next along the sphere, s.
    pub transits_s: f64,
    /// Feed-in and feed-out, s.
    pub feed_in_s: f64,
    /// In dwells between arcs and at both ends, s.
    pub dwells_s: f64,
    /// How many dwells stand between arcs, with those before the first and after the last.
    pub pauses: usize,
    /// How many arcs are driven, each direction counted.
    pub legs: usize,
    /// One whole circle, s.
    pub turn_s: f64,
}

impl PaperTime {
    /// All that is known, s.
    pub fn total_s(&self) -> f64 {
        self.arcs_s + self.transits_s + self.feed_in_s + self.dwells_s
    }

    /// Overshoot at both ends of every arc that would make it as long as the paper's test, degrees.
    pub fn overshoot_deg(&self) -> f64 {
        (PAPER_TEST_S - self.total_s()) / (2 * self.legs) as f64 / self.turn_s * 360.0
    }

    /// By how much every pause would be longer instead, s.
    pub fn longer_pauses_s(&self) -> f64 {
        (PAPER_TEST_S - self.total_s()) / self.pauses as f64
    }

    /// The paper's readings over the time on the arcs alone, 1/s.
    pub fn readings_on_arcs_per_s(&self) -> f64 {
        PAPER_READINGS / self.arcs_s
    }
}

/// Half meridians as they are written here, and whole circles.
pub(super) fn times(machine: &Machine) -> Result<Vec<PaperTime>> {
    let mut circles = String::from("[[plan.arc]]\nkind = \"equator\"\n");
    for azimuth in [0, 36, 72, 108, 144] {
        let _ = writeln!(
            circles,
            "[[plan.arc]]\nkind = \"meridian\"\nazimuth_deg = {azimuth}.0\nsweep_deg = 360.0"
        );
    }
    Ok(vec![
        time(
            machine,
            "equator and half meridians, as 3D6 is written here",
            "strategy = \"3d6\"\n",
        )?,
        time(machine, "equator and meridians as whole circles", &circles)?,
    ])
}

fn time(machine: &Machine, what: &'static str, arcs: &str) -> Result<PaperTime> {
    let text = format!(
        "name = \"Paper\"\nmachine = \"hu40t.toml\"\n[ball_bar]\nlength_mm = 150.0\n[[mounting]]\n\
         name = \"A\"\ncoincidence_mm = [20.0, -35.0, 40.0]\ntool_ball_mm = [0.0, 0.0, -200.0]\n\
         [plan]\nfeed_mm_min = 500.0\n{arcs}"
    );
    let test = Test::parse(&text, "paper.toml".as_ref())?;
    let path = Path::plan(&test, machine, 0)?;
    let program = nc::write(&test, machine, &path)?;
    let mut reading = Reading::of(machine);
    let mounting =
        test.mountings().first().ok_or_else(|| Error::input("the test has no mounting"))?;
    reading.work_offsets_mm.insert(mounting.work_offset, mounting.mounting.coincidence_mm);
    let program = nc::read(&program, "paper.nc".as_ref(), &reading)?;
    let trajectory = Trajectory::new(&program, machine, 1.0);
    let mut times = PaperTime {
        what,
        arcs_s: 0.0,
        transits_s: 0.0,
        feed_in_s: 0.0,
        dwells_s: 0.0,
        pauses: 0,
        legs: path.legs.iter().filter(|leg| !leg.transit).count(),
        turn_s: std::f64::consts::TAU * test.ball_bar().length_mm / test.plan()?.slowest_mm_s(),
    };
    for block in trajectory.blocks() {
        let on = match (block.kind, trajectory.label(block)) {
            (BlockKind::Stop, _) => continue,
            (BlockKind::Dwell, _) => {
                times.pauses += 1;
                &mut times.dwells_s
            }
            (_, "TRANSIT") => &mut times.transits_s,
            (_, "APPROACH" | "ENGAGE" | "RELEASE" | "FIT BALL-BAR") => &mut times.feed_in_s,
            _ => &mut times.arcs_s,
        };
        *on += block.duration_s;
    }
    // The first and the last dwell belong to the feed-in and the feed-out.
    times.pauses -= 2;
    Ok(times)
}
