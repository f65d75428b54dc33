//! An analysis that was written, read back and checked.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use jiff::civil::Date;

use super::bounds::{Checked, MOST, deviation, few, name, number};
use super::quantity::{Kind, Quantity, mean};
use super::raw::{RawAnalysis, RawCircle, RawHead, RawPlace, RawTest, RawValue};
use super::thresholds::SET_UP_MM;
use crate::error::{Error, Place, Result};
use crate::input;

/// Formats of `analysis.json` that can be read, the newest last.
pub const FORMATS: [&str; 2] = ["ballbar.analysis/1", "ballbar.analysis/2"];

/// An analysis of a hundred runs has some 20 MB.
const LARGEST_BYTES: usize = 64 << 20;
/// Who was tested, when and how, and what came out.
#[derive(Debug, Clone, PartialEq)]
pub struct Past {
    /// The file.
    pub file: PathBuf,
    /// Version of the program that wrote it; empty where it does not say.
    pub program_version: String,
    /// The day of the test.
    pub day: Option<Date>,
    /// Name of the test.
    pub test: String,
    /// SHA-256 of its readings.
    pub readings_sha256: Option<String>,
    /// Name of the machine.
    pub machine: String,
    /// Its topology, and where its slides turn.
    pub kinematics: String,
    /// Its serial number.
    pub machine_serial: Option<String>,
    /// Serial number of the bar.
    pub bar_serial: Option<String>,
    /// What compensation was active.
    pub compensation: Option<String>,
    /// Strategy of the test.
    pub strategy: Option<String>,
    /// The terms that were asked for.
    pub terms: Vec<String>,
    /// Where the balls were.
    pub mountings: Vec<MountingThen>,
    /// Every arc that was driven: mounting, circle, direction, angle and feed.
    pub arcs: BTreeSet<String>,
    /// Repeats.
    pub repeats: usize,
    /// What can be followed.
    pub quantities: Vec<Quantity>,
    /// What was found; `None` where nobody looked.
    pub findings: Option<Vec<FoundThen>>,
    /// What is smaller than this would not have been named, um rms; `None` where nobody looked.
    pub smallest_um: Option<f64>,
}

/// A mounting.
#[derive(Debug, Clone, PartialEq)]
pub struct MountingThen {
    /// Its name.
    pub name: String,
    /// Machine coordinates at which both balls coincided, mm.
    pub coincidence_mm: [f64; 3],
    /// The tool ball, mm.
    pub tool_ball_mm: [f64; 3],
    /// Nominal length of the bar, mm.
    pub bar_length_mm: f64,
}

/// A finding.
#[derive(Debug, Clone, PartialEq)]
pub struct FoundThen {
    /// Cause and what it acts on, or its title where no cause explains it: what tells it from others.
    pub key: String,
    /// What it is, in words.
    pub title: String,
    /// What it leaves in the residual, um rms.
    pub rms_um: f64,
    /// Its numbers.
    pub numbers: Vec<NumberThen>,
}

/// A number of a finding.
#[derive(Debug, Clone, PartialEq)]
pub struct NumberThen {
    /// Name with its unit, such as `amplitude_um`.
    pub name: String,
    /// The value.
    pub value: f64,
    /// Its standard deviation.
    pub sigma: Option<f64>,
}

impl Past {
    /// Reads an `analysis.json`, packed or not.
    ///
    /// # Errors
    /// When it is none, of a format that is not known, or holds what cannot be.
    pub fn read(file: &Path) -> Result<Self> {
        Self::parse(&input::read(file, "analysis")?, file)
    }

    /// Reads the text of one; `file` is named in messages.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn parse(text: &[u8], file: &Path) -> Result<Self> {
        let refused = |what: String, hint: &str| {
            Error::input(what).at(Place::file(file)).hint(hint.to_owned())
        };
        if text.len() > LARGEST_BYTES {
            return Err(refused("the analysis has more than 64 MiB".into(), GIVE));
        }
        let broken = |error: serde_json::Error| {
            let at = match error.line() {
                0 => Place::file(file),
                line => Place::line(file, line, ""),
            };
            Error::input(format!("this is not an analysis: {error}")).at(at).hint(GIVE)
        };
        let head: RawHead = serde_json::from_slice(text).map_err(broken)?;
        let Some(format) = head.format else {
            return Err(refused("this JSON does not say its `format`".into(), GIVE));
        };
        let writer = head.program_version.unwrap_or_default();
        if !FORMATS.contains(&format.as_str()) {
            let by = if writer.is_empty() { String::new() } else { format!(" (ballbar {writer})") };
            return Err(match format.strip_prefix("ballbar.analysis/") {
                Some(_) => refused(
                    format!(
                        "this analysis has the format `{format}`{by}, and this program reads {}",
                        FORMATS.join(" and ")
                    ),
                    "use the program that wrote it or a later one, or analyse the test again with this one",
                ),
                None => refused(format!("this is a `{format}`, and not an analysis"), GIVE),
            });
        }
        let raw: RawAnalysis = serde_json::from_slice(text).map_err(broken)?;
        checked(raw, writer, file).map_err(|what| refused(what, "analyse the test again"))
    }

    /// What tells one machine from another.
    pub fn machine_key(&self) -> String {
        let serial = self.machine_serial.as_deref().unwrap_or_default();
        format!("{} {} {serial}", self.machine, self.kinematics)
    }

    /// The quantity of a name.
    pub fn quantity(&self, name: &str) -> Option<&Quantity> {
        self.quantities.iter().find(|quantity| quantity.name == name)
    }
}

const GIVE: &str = "give the analysis.json that `ballbar analyse` wrote, or the folder it is in";

fn checked(raw: RawAnalysis, program_version: String, file: &Path) -> Checked<Past> {
    let (arcs, repeats) = (arcs_of(&raw)?, raw.repeats.len());
    let pivots = &raw.machine.pivots;
    let kinematics =
        format!("{}, pivots {} {} {}", raw.machine.topology, pivots.x, pivots.y, pivots.z);
    let lengths = raw.test.mountings.iter().map(|of| of.bar_length_mm).filter(|mm| *mm >= 1.0);
    // Standard deviation of what a ball beside the plane takes off a radius, mm; none where no bar is stated.
    let set_up = lengths.reduce(f64::min).map(|mm| SetUp { radius_mm: mm });
    let mut quantities = Vec::new();
    for place in few(raw.at_the_place, "answers")? {
        quantities.push(asked(place, repeats, set_up)?);
    }
    quantities.extend(circular(few(raw.circular.tests, "circular tests")?, set_up)?);
    let (findings, smallest_um) = match raw.diagnosis {
        Some(diagnosis) => {
            let found = few(diagnosis.findings, "findings")?.into_iter().map(|of| {
                let numbers = few(of.numbers, "numbers of a finding")?.into_iter().map(|n| {
                    Ok(NumberThen {
                        value: number(n.value, &n.name)?,
                        sigma: n.sigma.map(|sigma| deviation(sigma, &n.name)).transpose()?,
                        name: name(n.name, "the name of a number")?,
                    })
                });
                let title = name(of.title, "the title of a finding")?;
                Ok(FoundThen {
                    key: of
                        .cause
                        .map_or_else(|| title.clone(), |cause| format!("{cause} {}", of.on)),
                    rms_um: deviation(of.rms_um, &title)?,
                    numbers: numbers.collect::<Checked<_>>()?,
                    title,
                })
            });
            let smallest = diagnosis.smallest_um.map(|um| deviation(um, "the smallest effect"));
            (Some(found.collect::<Checked<_>>()?), smallest.transpose()?)
        }
        None => (None, None),
    };
    let mountings = few(raw.test.mountings.iter().collect(), "mountings")?;
    let mountings = mountings.into_iter().map(|of| {
        let place =
            |at: [f64; 3], what| at.into_iter().try_for_each(|mm| number(mm, what).map(drop));
        place(of.coincidence_mm, "`coincidence_mm`")?;
        place(of.tool_ball_mm, "`tool_ball_mm`")?;
        Ok(MountingThen {
            name: name(of.name.clone(), "the name of a mounting")?,
            coincidence_mm: of.coincidence_mm,
            tool_ball_mm: of.tool_ball_mm,
            bar_length_mm: deviation(of.bar_length_mm, "`bar_length_mm`")?,
        })
    });
    let record = raw.test.record.as_ref();
    Ok(Past {
        file: file.to_path_buf(),
        program_version,
        day: day_of(&raw.test)?,
        mountings: mountings.collect::<Checked<_>>()?,
        machine_serial: record.and_then(|record| record.machine_serial.clone()),
        bar_serial: record.and_then(|record| record.bar_serial.clone()),
        compensation: record.and_then(|record| record.compensation.clone()),
        test: name(raw.test.name, "the name of the test")?,
        readings_sha256: raw.test.readings_sha256,
        machine: name(raw.machine.name, "the name of the machine")?,
        kinematics: name(kinematics, "the topology")?,
        strategy: raw.strategy,
        terms: raw.terms,
        arcs,
        repeats,
        quantities,
        findings,
        smallest_um,
    })
}

fn day_of(test: &RawTest) -> Checked<Option<Date>> {
    let stated =
        test.date.as_ref().or(test.record.as_ref().and_then(|record| record.date.as_ref()));
    let day = stated.map(|stated| {
        stated
            .parse::<Date>()
            .map_err(|_| format!("`{stated}` is no day; a day is written 2026-11-23"))
    });
    day.transpose()
}

fn arcs_of(raw: &RawAnalysis) -> Checked<BTreeSet<String>> {
    let mut arcs = BTreeSet::new();
    for run in raw.repeats.iter().flat_map(|repeat| &repeat.runs) {
        for arc in &run.arcs {
            let (sweep, feed) =
                (number(arc.sweep_deg, "`sweep_deg`")?, number(arc.feed_mm_min, "`feed_mm_min`")?);
            arcs.insert(format!(
                "{} {} {} {sweep:.1} deg F{feed:.0}",
                run.mounting, arc.circle, arc.direction
            ));
            if arcs.len() > MOST {
                return Err(format!("there are more than {MOST} arcs"));
            }
        }
    }
    Ok(arcs)
}

/// A bar that is set up anew for every test.
#[derive(Clone, Copy)]
struct SetUp {
    radius_mm: f64,
}

impl SetUp {
    /// Standard deviation of `z² / 2 R` over set-ups, mm.
    fn shorter_mm(self) -> f64 {
        SET_UP_MM * SET_UP_MM / (std::f64::consts::SQRT_2 * self.radius_mm)
    }
}

fn asked(raw: RawPlace, repeats: usize, set_up: Option<SetUp>) -> Checked<Quantity> {
    let what = name(raw.quantity, "the name of a quantity")?;
    let sigma = |of: Option<f64>| of.map(|of| deviation(of, &what)).transpose();
    let of_machine =
        ["scale", "squareness", "lateral play"].iter().any(|word| what.starts_with(word))
            || (what.starts_with("reversal") && !what.starts_with("reversal E"));
    // The scatter of repeats counts where it is larger than what the noise makes.
    let scatter = sigma(raw.deviation)?.map(|deviation| deviation / (repeats.max(1) as f64).sqrt());
    let (noise, all) = (sigma(raw.noise)?, sigma(raw.all)?);
    let set_up = set_up.filter(|_| what.starts_with("scale"));
    let set_up = set_up.map_or(0.0, |of| 1e6 * of.shorter_mm() / of.radius_mm);
    Ok(Quantity {
        kind: if of_machine { Kind::Machine } else { Kind::Range },
        unit: name(raw.unit, "a unit")?,
        value: number(raw.value, &what)?,
        noise: noise.map(|noise| noise.max(scatter.unwrap_or(0.0)).hypot(set_up)),
        all: all.map(|all| all.max(scatter.unwrap_or(0.0)).hypot(set_up)),
        plausible: sigma(raw.plausible)?,
        widened: 0.0,
        looks_like: few(raw.looks_like, "faults")?,
        name: what,
    })
}

/// The values of circular tests, each over the repeats, in the order of the tests.
fn circular(tests: Vec<RawCircle>, set_up: Option<SetUp>) -> Checked<Vec<Quantity>> {
    let mut order: Vec<(String, [f64; 3], bool)> = Vec::new();
    let mut values: BTreeMap<String, Vec<RawValue>> = BTreeMap::new();
    let mut enter = |name: String, centre_mm, with_bar, value: RawValue| {
        for um in [value.value_um, value.widened_um] {
            number(um, &name)?;
        }
        for um in std::iter::once(value.noise_um).chain(value.sigma_um) {
            deviation(um, &name)?;
        }
        if !values.contains_key(&name) {
            order.push((name.clone(), centre_mm, with_bar));
        }
        values.entry(name).or_default().push(value);
        Ok::<(), String>(())
    };
    for test in tests {
        for mm in
            test.centre_mm.into_iter().chain([test.diameter_mm, test.sweep_deg, test.feed_mm_min])
        {
            number(mm, &test.circle)?;
        }
        let arc = if test.sweep_deg < 359.95 {
            format!(" {:.0} deg", test.sweep_deg)
        } else {
            String::new()
        };
        // Where a test has several mountings, the circle is named with its own.
        let of = name(
            format!("{} d{:.0}{arc} F{:.0}", test.circle, test.diameter_mm, test.feed_mm_min),
            "the name of a circle",
        )?;
        for way in few(test.ways, "ways")? {
            enter(
                format!("G {} {of}", way.direction),
                test.centre_mm,
                false,
                way.circular_deviation,
            )?;
        }
        for (symbol, value) in [
            ("G(b)", test.bidirectional_circular_deviation),
            ("H", test.circular_hysteresis),
            ("D", test.mean_bidirectional_radial_deviation),
        ] {
            if let Some(value) = value {
                enter(format!("{symbol} {of}"), test.centre_mm, symbol == "D", value)?;
            }
        }
    }
    let quantity = |(name, centre_mm, with_bar): (String, [f64; 3], bool)| {
        let of = values.get(&name).map_or(&[][..], Vec::as_slice);
        let count = of.len().max(1) as f64;
        let pairs: Vec<(f64, f64)> = of.iter().map(|v| (v.value_um, v.noise_um)).collect();
        let (value, noise) = mean(&pairs);
        let set_up = set_up.filter(|_| with_bar).map_or(0.0, |of| 1e3 * of.shorter_mm());
        let noise = noise.hypot(set_up);
        // What is not known of the bar is the same in every repeat.
        let stated: Option<Vec<f64>> = of.iter().map(|v| v.sigma_um).collect();
        let all = stated.map(|all| (all.iter().map(|s| s * s).sum::<f64>() / count).sqrt());
        Quantity {
            kind: Kind::Circular(centre_mm, with_bar),
            unit: "um".into(),
            value,
            noise: Some(noise),
            all: if with_bar { all } else { Some(noise) },
            plausible: None,
            widened: of.iter().map(|v| v.widened_um).sum::<f64>() / count,
            looks_like: Vec::new(),
            name,
        }
    };
    Ok(order.into_iter().map(quantity).collect())
}
