//! Programs to put faults in: planned ones, in chords and in arcs, on several machines, in all dialects.

use std::path::Path as FilePath;

use ballbar::design::PlannedProgram;
use ballbar::machine::{Dialect, Machine};
use ballbar::nc::{self, Checked, Reading, Severity, Sphere};
use ballbar::plan::Test;

use crate::setting::Setting;

/// A program with all that belongs to it.
pub(crate) struct Program {
    pub(crate) name: String,
    pub(crate) text: String,
    pub(crate) setting: Setting,
    machine: Machine,
    reading: Reading,
    sphere: Option<Sphere>,
}

impl Program {
    /// The program of a mounting with nothing against it; otherwise what speaks against it.
    pub(crate) fn written(test: &Test, machine: &Machine, mounting: usize) -> Result<Self, String> {
        let planned =
            PlannedProgram::new(test, machine, mounting).map_err(|error| error.what.clone())?;
        let objections = planned.objections(test, machine).map_err(|error| error.what.clone())?;
        if let Some(objection) = objections.first() {
            return Err(objection.what.clone());
        }
        let named = &test.mountings()[mounting];
        let mut reading = Reading::of(machine);
        reading.work_offsets_mm.insert(named.work_offset, named.mounting.coincidence_mm);
        Ok(Self {
            name: format!("{} {}", machine.name(), planned.file_name),
            text: planned.text,
            setting: Setting::of(test, machine, mounting),
            machine: machine.clone(),
            reading,
            sphere: Sphere::of(test, mounting),
        })
    }

    /// What `ballbar check` says of a text in place of this program.
    pub(crate) fn check(&self, text: &str) -> Result<Checked, String> {
        let file = FilePath::new("O1001.nc");
        nc::check(text, file, &self.machine, &self.reading, self.sphere.as_ref())
            .map_err(|error| error.what.clone())
    }
}

/// The rules of the errors in what `check` says.
pub(crate) fn errors(checked: &Result<Checked, String>) -> Vec<&'static str> {
    let Ok(checked) = checked else { return vec!["empty"] };
    let errors = checked.findings.iter().filter(|finding| finding.severity == Severity::Error);
    errors.map(|finding| finding.rule).collect()
}

/// A machine file of the project, in a dialect, with keys of the controller in place of its own.
pub(crate) fn machine(name: &str, dialect: &str, keys: &str) -> Machine {
    let file = FilePath::new(env!("CARGO_MANIFEST_DIR")).join("machines").join(name);
    let source = std::fs::read_to_string(&file).unwrap();
    let taken = |line: &&str| {
        let key = line.split('=').next().unwrap_or("").trim();
        key != "dialect"
            && !keys.lines().any(|own| own.split('=').next().unwrap_or("").trim() == key)
    };
    let kept: Vec<&str> = source.lines().filter(taken).collect();
    let controller = format!("[controller]\ndialect = \"{dialect}\"\n{keys}");
    let source = kept.join("\n").replacen("[controller]", &controller, 1);
    Machine::parse(&source, &file).unwrap_or_else(|error| panic!("{error}"))
}

/// A test of a bar at a place.
pub(crate) fn test(place: &str, length_mm: f64, plan: &str) -> Test {
    let source = format!(
        "name = \"T\"\nmachine = \"m.toml\"\n[ball_bar]\nlength_mm = {length_mm:.1}\n\
         [[mounting]]\nname = \"A\"\ncoincidence_mm = {place}\ntool_ball_mm = [0.0, 0.0, -200.0]\n\
         [plan]\nfeed_mm_min = 500.0\n{plan}\n"
    );
    Test::parse(&source, "t.toml".as_ref()).unwrap_or_else(|error| panic!("{error}"))
}

/// The programs that faults are put in.
pub(crate) fn programs() -> Vec<Program> {
    let plans = [
        "strategy = \"2d\"\nchord_sag_um = 40.0",
        "strategy = \"3d5\"\nchord_sag_um = 80.0",
        "strategy = \"3d6\"\nchord_sag_um = 80.0\nboth_directions = false",
        "strategy = \"3d10\"\nchord_sag_um = 100.0\nboth_directions = false",
        "chord_sag_um = 50.0\nstop_between_arcs = true\n[[plan.arc]]\nkind = \"equator\"\nazimuth_deg = 30.0",
        "chord_sag_um = 50.0\n[[plan.arc]]\nkind = \"meridian\"\nstart_deg = 20.0\nsweep_deg = 120.0",
        "chord_sag_um = 50.0\n[[plan.arc]]\nkind = \"meridian\"\nazimuth_deg = 90.0",
        "strategy = \"xy\"",
        "strategy = \"iso230-4\"\nchord_sag_um = 80.0",
        "strategy = \"zx\"\ninterpolation = \"chords\"\nchord_sag_um = 40.0\nsweep_deg = 180.0",
    ];
    let mut programs = Vec::new();
    for (file, place) in
        [("hu40t.toml", "[20.0, -35.0, 40.0]"), ("vertical.toml", "[20.0, -35.0, -300.0]")]
    {
        for (dialect, keys) in [
            ("fanuc", "sequence_step = 10"),
            ("linuxcnc", "sequence_step = 0"),
            ("fanuc", "sequence_step = 0\nmemory_kb = 6.0"),
            ("siemens", "sequence_step = 0"),
            ("heidenhain", "decimals = 3"),
        ] {
            let machine = machine(file, dialect, keys);
            for (index, plan) in plans.iter().enumerate() {
                let test = test(place, if index % 2 == 0 { 150.0 } else { 100.0 }, plan);
                let written = Program::written(&test, &machine, 0);
                let mut program = written.unwrap_or_else(|told| panic!("{plan}: {told}"));
                program.name = format!("{file} {dialect} {keys:?} plan {index}");
                if (4..7).contains(&index) && keys.ends_with('0') && !keys.contains("memory") {
                    let by_radius = index % 2 == 0;
                    let text = in_arcs(&program.text, &program.setting, by_radius);
                    // The plane that the first blocks state is not stated again, if nothing else was.
                    let changes = text.contains("\nG18 ") || text.contains("\nG19 ");
                    let text = if changes { text } else { text.replace("\nG17 ", "\n") };
                    programs.push(Program {
                        name: format!("{} in arcs", program.name),
                        text,
                        setting: program.setting.clone(),
                        machine: program.machine.clone(),
                        reading: program.reading.clone(),
                        sphere: program.sphere.clone(),
                    });
                }
                programs.push(program);
            }
        }
    }
    programs
}

/// The same program with arcs in the place of chords. Every run of chords must be an arc in a coordinate plane about the
/// zero; a whole turn, and what has no radius, is written by its centre.
fn in_arcs(text: &str, setting: &Setting, by_radius: bool) -> String {
    let length_mm = setting.length_mm;
    let mut lines: Vec<String> = Vec::new();
    let mut at = [0.0_f64; 3];
    let mut chords: Vec<[f64; 3]> = Vec::new();
    for line in text.lines() {
        let chord = ["X", "G01 X", "G1 X"].iter().any(|words| line.starts_with(words));
        let point = point_of(line);
        match point {
            Some(point) if chord && on_sphere(&point, length_mm) && on_sphere(&at, length_mm) => {
                if chords.is_empty() {
                    chords.push(at);
                }
                chords.push(point);
            }
            _ => {
                if !chords.is_empty() {
                    lines.push(arc_of(&chords, setting, by_radius));
                    chords.clear();
                }
                lines.push(line.to_owned());
            }
        }
        at = point.unwrap_or(at);
    }
    lines.join("\n") + "\n"
}

fn on_sphere(point: &[f64; 3], length_mm: f64) -> bool {
    (point.iter().map(|mm| mm * mm).sum::<f64>().sqrt() - length_mm).abs() < 0.01
}

/// The three coordinates of a line that names all of them.
fn point_of(line: &str) -> Option<[f64; 3]> {
    let of = |letter: char| {
        let word = line.split('(').next()?.split(' ').find(|word| word.starts_with(letter))?;
        word[1..].parse().ok()
    };
    Some([of('X')?, of('Y')?, of('Z')?])
}

fn arc_of(chords: &[[f64; 3]], setting: &Setting, by_radius: bool) -> String {
    let (first, last) = (chords[0], chords[chords.len() - 1]);
    let flat = |k: &usize| chords.iter().all(|point| point[*k].abs() < 1e-9);
    let normal = (0..3).find(flat).expect("an arc in a coordinate plane");
    let (u, v) = ((normal + 1) % 3, (normal + 2) % 3);
    let sense = first[u] * chords[1][v] - first[v] * chords[1][u];
    let siemens = setting.dialect == Dialect::Siemens;
    let senses = if siemens { ["G2", "G3"] } else { ["G02", "G03"] };
    let motion = senses[usize::from(sense > 0.0)];
    let plane = ["G19", "G18", "G17"][normal];
    let end = format!("X{:.3} Y{:.3} Z{:.3}", last[0], last[1], last[2]);
    let closed = first.iter().zip(&last).all(|(a, b)| (a - b).abs() < 1e-9);
    if by_radius && !closed {
        // Half a turn and less; a little more than the chord asks for.
        let letter = if siemens { "CR=" } else { "R" };
        return format!("{plane} {motion} {end} {letter}{:.3}", setting.length_mm);
    }
    let letters = ["I", "J", "K"];
    let (a, b) = (letters[u.min(v)], letters[u.max(v)]);
    let (i, j) = (-first[u.min(v)], -first[u.max(v)]);
    format!("{plane} {motion} {end} {a}{i:.3} {b}{j:.3}")
}
