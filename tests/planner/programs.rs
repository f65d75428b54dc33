//! Programs that LinuxCNC's planner drove, and the machine that it was told of.

use std::fmt::Write as _;

use ballbar::machine::Machine;
use ballbar::motion::Trajectory;
use ballbar::nc::{self, Program, Reading};
use ballbar::plan::{self, Test};
use nalgebra::Vector3;

/// What LinuxCNC makes of the 500 mm/s² of its configuration.
#[derive(Clone, Copy)]
pub(crate) enum Acceleration {
    /// All of it, between corners that it rounds by an arc.
    Whole,
    /// Half of it, where it may have to blend with a neighbour: single moves, chords that are nearly
    /// tangential, the last block before a stop.
    Half,
}
use Acceleration::{Half, Whole};

/// A program, and how it is told of.
pub(crate) struct Run {
    /// Name of its recording in `tests/data/planner`.
    pub(crate) name: &'static str,
    pub(crate) what: &'static str,
    blocks: String,
    acceleration: Acceleration,
}

impl Run {
    /// The whole program.
    pub(crate) fn program(&self) -> String {
        format!("%\n{HEAD}{}M30\n%\n", self.blocks)
    }

    /// The machine with the acceleration that LinuxCNC uses here.
    pub(crate) fn machine(&self) -> Machine {
        machine(self.acceleration)
    }

    /// The program as it is read back.
    pub(crate) fn read_back(&self) -> Program {
        let mut reading = Reading::of(&self.machine());
        reading.work_offsets_mm.insert(54, Vector3::zeros());
        nc::read(&self.program(), "p.ngc".as_ref(), &reading).unwrap()
    }

    /// The program as it is estimated.
    pub(crate) fn trajectory(&self) -> Trajectory {
        Trajectory::new(&self.read_back(), &self.machine(), 1.0)
    }
}

const HEAD: &str = "G21 G17 G90 G94 G40 G49 G80 G54\nG64 P0.01\nG00 X0. Y0. Z0.\n";

/// A quarter of a circle of 150 mm, or less, in chords.
fn arc(chord_mm: f64, feed: u32, sweep_deg: f64) -> String {
    let sweep_rad = sweep_deg.to_radians();
    let count = (sweep_rad * 150.0 / chord_mm).round();
    let mut text = format!("G01 F{feed}.\n");
    for k in 1..=count as usize {
        let (sine, cosine) = (sweep_rad * k as f64 / count).sin_cos();
        writeln!(text, "X{:.3} Y{:.3}", 150.0 * sine, 150.0 - 150.0 * cosine).unwrap();
    }
    text
}

/// Sixteen straight lines at 2000 mm/min, each at this angle to the last.
fn corners(corner_deg: f64) -> String {
    let (mut x, mut y) = (0.0, 0.0);
    let mut text = "G01 F2000.\n".to_owned();
    for k in 0..16 {
        let direction_rad = if k % 2 == 0 { 0.0 } else { corner_deg.to_radians() };
        x += 30.0 * direction_rad.cos();
        y += 30.0 * direction_rad.sin();
        writeln!(text, "X{x:.3} Y{y:.3}").unwrap();
    }
    text
}

/// The program that this tool writes for one meridian.
fn meridian(machine: &Machine) -> String {
    let test = "name = \"Meridian\"\nmachine = \"m.toml\"\n[ball_bar]\nlength_mm = 150.0\n[[mounting]]\n\
        name = \"A\"\ncoincidence_mm = [0.0, 0.0, 0.0]\ntool_ball_mm = [0.0, 0.0, -200.0]\n[plan]\n\
        feed_mm_min = 2000.0\n[[plan.arc]]\nkind = \"meridian\"\nazimuth_deg = 36.0\n";
    let test = Test::parse(test, "t.toml".as_ref()).unwrap();
    let path = plan::Path::plan(&test, machine, 0).unwrap();
    let text = nc::write(&test, machine, &path).unwrap();
    // Every block between the title and M30, the stops for the bar among them.
    let blocks =
        text.lines().filter(|line| !line.starts_with(['%', 'O']) && !line.ends_with("M30"));
    blocks.fold(String::new(), |all, block| all + block + "\n")
}

pub(crate) fn runs() -> Vec<Run> {
    let run = |name, what, blocks: String, acceleration| Run { name, what, blocks, acceleration };
    vec![
        run("arc-500", "arc of 45 deg, chords of 0.5 mm, 500 mm/min", arc(0.5, 500, 45.0), Half),
        run("arc-2000", "arc of 90 deg, chords of 0.5 mm, 2000 mm/min", arc(0.5, 2000, 90.0), Half),
        run("arc-6000", "arc of 90 deg, chords of 0.5 mm, 6000 mm/min", arc(0.5, 6000, 90.0), Half),
        run(
            "chords-2000",
            "arc of 90 deg, chords of 3 mm, 2000 mm/min",
            arc(3.0, 2000, 90.0),
            Half,
        ),
        run(
            "chords-6000",
            "arc of 90 deg, chords of 3 mm, 6000 mm/min",
            arc(3.0, 6000, 90.0),
            Half,
        ),
        run(
            "half-circles",
            "two half circles by G02 and G03, 2000 mm/min",
            "G02 X150. Y-150. I0. J-150. F2000.\nG03 X0. Y0. I0. J150.\n".to_owned(),
            Half,
        ),
        run("corners-5", "16 lines of 30 mm, corners of 5 deg, 2000 mm/min", corners(5.0), Whole),
        run(
            "corners-45",
            "16 lines of 30 mm, corners of 45 deg, 2000 mm/min",
            corners(45.0),
            Whole,
        ),
        run(
            "corners-90",
            "16 lines of 30 mm, corners of 90 deg, 2000 mm/min",
            corners(90.0),
            Whole,
        ),
        run(
            "dwells",
            "lines of 50 mm with dwells of 1.5 and 0.5 s, 2000 mm/min",
            "G01 X50. F2000.\nG04 P1.5\nY50.\nG04 P0.5\nX0.\n".to_owned(),
            Half,
        ),
        run(
            "stop",
            "lines of 50 mm with an M00, 2000 mm/min",
            "G01 X50. F2000.\nM00\nY50.\nG04 P0.2\nX0.\n".to_owned(),
            Half,
        ),
        run(
            "meridian",
            "a whole meridian there and back as written here, 2000 mm/min",
            meridian(&machine(Half)),
            Half,
        ),
    ]
}

/// The limits of `machine.ini`. LinuxCNC rounds corners within 0.01 mm (G64 P0.01), with 0.866 of
/// its acceleration across the arc: as much as 8.66 um with all of it.
fn machine(acceleration: Acceleration) -> Machine {
    let path = match acceleration {
        Whole => 500.0,
        Half => 250.0,
    };
    let mut text = "name = \"Planner\"\ntopology = \"wFXYZt\"\n".to_owned();
    for axis in ["X", "Y", "Z"] {
        write!(
            text,
            "[axes.{axis}]\ntravel_mm = [-500.0, 500.0]\nrapid_mm_min = 12000.0\n\
             acceleration_mm_s2 = 500.0\nmax_feed_mm_min = 12000.0\n"
        )
        .unwrap();
    }
    write!(
        text,
        "[controller]\ndialect = \"linuxcnc\"\npath_acceleration_mm_s2 = {path:.1}\n\
         corner_stop_deg = 180.0\ncorner_tolerance_um = 8.66\n"
    )
    .unwrap();
    Machine::parse(&text, "planner.toml".as_ref()).unwrap()
}
