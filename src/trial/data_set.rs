//! The description of a data set of campaigns: what is in it, how it was made, how it is cited.

use std::fmt::Write as _;

/// How a data set was made.
#[derive(Debug)]
pub struct Made {
    /// Where everything random began.
    pub seed: u64,
    /// Whether every campaign is drawn anew.
    pub grid: bool,
    /// Size of every hidden effect, mm rms outside of the model, where it is not that of its class.
    pub size_mm: Option<f64>,
    /// The command that makes it again.
    pub command: String,
    /// How many campaigns there are of each class, by its name.
    pub counts: Vec<(&'static str, usize)>,
    /// Campaigns that were asked for and are not there, with the reason.
    pub missing: Vec<(String, String)>,
}

impl Made {
    /// The description that lies beside the campaigns.
    pub fn readme(&self) -> String {
        let version = env!("CARGO_PKG_VERSION");
        let Self { seed, command, .. } = self;
        let what = if self.grid {
            "Every campaign is drawn anew: what is driven (an XY plane, three planes, a 3D6, a 3D6 at two places), machine, readings a second, how the control drives, runs, noise, resolution and feed."
        } else {
            "Every campaign is three runs of 3D6 at 500 mm/min and two at 1500 mm/min in one place of the machine HU40-T, noise 0.15 um a reading; coefficients, set-up, clock and pauses differ from run to run."
        };
        let size = self
            .size_mm
            .map_or(String::new(), |mm| format!(" All hidden effects are of {} um rms.", 1e3 * mm));
        let mut classes = String::new();
        for (class, count) in &self.counts {
            let _ = writeln!(classes, "| {class} | {} | {count} |", self.told(class));
        }
        let mut missing = String::new();
        if !self.missing.is_empty() {
            missing.push_str("\nAsked for and not here:\n\n");
            for (campaign, why) in &self.missing {
                let _ = writeln!(missing, "- {campaign}: {why}");
            }
        }
        format!(
            "# Simulated ball-bar campaigns with hidden effects, seed {seed}\n\n\
Raw logs of a telescoping ball-bar on simulated three-axis machine tools, the programs that ran, and what is true: for whoever compares ways to \
identify and diagnose machine errors. Truth is known, and nobody tuned the data to a method. {what}{size}\n\n\
| class | hidden | campaigns |\n| --- | --- | --- |\n{classes}{missing}\n\
## How it was made\n\n\
By `ballbar` {version}, with `{command}`, which makes the same bytes again. A campaign is its seed, class and index: asking for more adds campaigns and changes none. \
The machine moves by its exact kinematic chain; the linear model that the fit uses has no part in it. Sizes are what an effect leaves after \
the fit of the polynomial model of the slides with hysteresis, rms over all readings.\n\n\
## What is in it\n\n\
| file | holds |\n| --- | --- |\n\
| `campaigns.csv` | a row for each campaign: zip, class, index, what is hidden, its size, and of a grid the value of every factor |\n\
| `CLASS-INDEX.zip` | one campaign |\n\
| in it `machine.toml` | order of the slides, travel, rapid feed (mm/min), acceleration (mm/s²), control |\n\
| `test.toml` | the ball-bar, where its balls are (mm), the runs: program, log, repeat |\n\
| `program*.nc` | the programs that ran; mm, mm/min |\n\
| `run*.csv` | the logs |\n\
| `truth.toml` | what was put in; never needed to read the rest |\n\n\
Columns of a log: `time_s`, s by the clock of the instrument, which begins when it likes and goes up to 50 ppm wrong; `deviation_um`, um, the length of the bar less \
its nominal length, positive outward, empty where the bar is out of range. A line that begins with `#` is a comment.\n\n\
Columns of `campaigns.csv`: `hidden`, effects joined by ` + `, each a cause with its place and its numbers, units in their names; empty where nothing is hidden; \
`size_um`, um rms that each effect leaves outside of the model; `share_seen`, the share of its rms that lies there, 0 to 1, for each effect.\n\n\
`truth.toml`: `effect`, what is hidden; for each run its start and pauses (s), the error of the clock (ppm), the noise (um), and coefficients and set-up errors \
in mm and rad. Coordinates are those of ISO 841: +X, +Y, +Z move the tool that way relative to the workpiece.\n\n\
`ballbar analyse test.toml` in an unpacked campaign reads it; `ballbar diagnose test.toml` says what it finds.\n\n\
## To be careful about\n\n\
The data are simulated: thermal drift, friction and controls are as simple as their models, and a method that does well here may do worse on a shop floor. \
Whoever looks at the truth of a seed while he makes a method states its rates on another seed.\n\n\
## Licence and citation\n\n\
CC0 1.0: whoever makes this data set claims no rights to it. Cite it as: *Simulated ball-bar campaigns with hidden effects*, made by ballbar {version}, seed {seed}, \
with the command above, which tells which campaigns. `CITATION.cff` says the same for programs.\n"
        )
    }

    fn told(&self, class: &str) -> &'static str {
        match (class, self.grid) {
            ("single", false) => "one effect, 1 um rms",
            ("single", true) => "one effect, 1 um rms or 5 times the noise",
            ("small", _) => "one effect as large as the noise",
            ("sizes", _) => "one effect, 0.3, 0.5 and 2 times the noise in turn",
            ("two", false) => "two effects, 1 um rms each",
            ("two", true) => "two effects, 1 um rms or 5 times the noise each",
            ("outside", _) => "one effect that the library of causes does not have",
            _ => "nothing",
        }
    }

    /// The same for programs that keep references.
    pub fn citation(&self) -> String {
        format!(
            "cff-version: 1.2.0\nmessage: Please cite this data set with its seed.\ntype: dataset\n\
             title: Simulated ball-bar campaigns with hidden effects, seed {}\n\
             authors:\n  - name: The maintainers of ballbar\nversion: \"{}\"\nlicense: CC0-1.0\n\
             abstract: \"Made by: {}\"\n",
            self.seed,
            env!("CARGO_PKG_VERSION"),
            self.command
        )
    }
}
