//! `ballbar init`: a machine file and a test file to begin with.

use std::io::IsTerminal;
use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::json;

use super::ask::Ask;
use super::common::Common;
use super::init_from::{Found, Stated};
use super::output::{self, Talk};
use super::results::Files;
use crate::error::{Error, Result};
use crate::log::LengthUnit;
use crate::machine::{Axis, Builtin, Dialect, Topology};
use crate::plan::{ARCS_DEG, FEEDS_MM_MIN, LENGTHS_MM};
use crate::start::{Begun, TestKind, Travel, Wish, Zero};

/// Begin: write a machine file and a test file that can be planned at once
///
/// On a terminal it asks for what is not given, with a default for everything; elsewhere it takes the defaults and says
/// which. Every key in the files has a comment. The balls are put where the test fits into the travel. Nothing that is
/// there already is replaced.
///
/// With `--from` a .b5r that Ballbar 20 saved says plane, arc, bar, feed and machine; the test file names it, and a
/// program that drives the same is written beside.
#[derive(Args)]
#[command(after_help = "Examples:
  ballbar init                                      asks, and writes to this directory
  ballbar init vmc --machine vertical --test xy
  ballbar init vmc --topology wXYFZSt --travel=-762..0,-406..0,-508..0 --test iso230-4
  ballbar init hmc --machine horizontal --travel 560,560,600 --zero middle --test 3d6
  ballbar init monday --machine vertical --from monday.b5r && ballbar analyse monday/test.toml

Machines: `ballbar machines` lists those that are built in.
Tests: xy, yz, zx (a plane), iso230-4 (three planes), 2d, 3d5, 3d6, 3d10 (the sphere), design (let `ballbar design` choose).")]
pub(super) struct Arguments {
    /// Directory for the two files; made if it is not there. Without it, that of `-o`, or this one
    #[arg(value_name = "FOLDER")]
    folder: Option<PathBuf>,
    /// The built-in machine that yours is most like
    #[arg(long, value_name = "NAME", value_parser = told(Builtin::named))]
    machine: Option<Builtin>,
    /// What your machine is called
    #[arg(long, value_name = "TEXT", value_parser = told(name_of))]
    name: Option<String>,
    /// The order of its slides from the workpiece over the frame F to the tool
    #[arg(long, value_name = "wXYFZSt", value_parser = told(Topology::parse))]
    topology: Option<Topology>,
    /// Machine coordinates of X, Y and Z, mm: `-762..0,-406..0,-508..0`; or three lengths, with `--zero`
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = told(Travels::parse))]
    travel: Option<Travels>,
    /// Where the zero is in travels that are lengths: upper, middle or lower
    #[arg(long, value_name = "END", value_parser = told(Zero::parse))]
    zero: Option<Zero>,
    /// The control: how programs are written
    #[arg(long, visible_alias = "dialect", value_name = "DIALECT", value_parser = told(dialect_of))]
    control: Option<Dialect>,
    /// Length of the bar, mm; without it the longest of 150, 100 and 50 that fits
    #[arg(long, value_name = "MM", allow_hyphen_values = true, value_parser = told(bar_mm))]
    bar: Option<f64>,
    /// From the spindle nose to the centre of the tool ball, mm
    #[arg(long, value_name = "MM", allow_hyphen_values = true, value_parser = told(tool_mm))]
    tool: Option<f64>,
    /// What is driven
    #[arg(long, value_name = "TEST", value_parser = told(TestKind::parse))]
    test: Option<TestKind>,
    /// Feed, mm/min
    #[arg(long, value_name = "MM_MIN", allow_hyphen_values = true, value_parser = told(feed_mm_min))]
    feed: Option<f64>,
    /// A .b5r that was measured already
    #[arg(long, value_name = "FILE")]
    from: Option<PathBuf>,
    /// How much of each arc its readings stand on, degrees, where neither its name nor that of its test says it
    #[arg(long, value_name = "DEG", requires = "from", allow_hyphen_values = true, value_parser = told(arc_deg))]
    arc: Option<f64>,
    /// The unit of its readings, mm or um, where their size and circularity do not tell
    #[arg(long, value_name = "UNIT", requires = "from", value_parser = told(unit_of))]
    unit: Option<LengthUnit>,
    /// Do not ask, also on a terminal
    #[arg(long)]
    defaults: bool,
}

/// Three travels as one value of the command line.
#[derive(Clone)]
struct Travels([Travel; 3]);

impl Travels {
    fn parse(text: &str) -> Result<Self> {
        Travel::parse(text).map(Self)
    }
}

/// A parser of this program as one of the command line.
fn told<T: Clone + Send + Sync + 'static>(
    parse: impl Fn(&str) -> Result<T> + Clone + Send + Sync + 'static,
) -> impl Fn(&str) -> std::result::Result<T, String> + Clone + Send + Sync + 'static {
    move |text| {
        parse(text).map_err(|error| match error.hint {
            Some(hint) => format!("{}; {hint}", error.what),
            None => error.what,
        })
    }
}

fn dialect_of(name: &str) -> Result<Dialect> {
    Dialect::ALL.into_iter().find(|dialect| dialect.name().eq_ignore_ascii_case(name)).ok_or_else(
        || {
            Error::input(format!("unknown control `{name}`"))
                .hint(format!("write one of `{}`", Dialect::ALL.map(Dialect::name).join("`, `")))
        },
    )
}

fn name_of(text: &str) -> Result<String> {
    let text = text.trim();
    if text.is_empty() || text.contains(char::is_control) {
        return Err(Error::input("the name is empty, or no text").hint("write what people call it"));
    }
    Ok(text.to_owned())
}

/// No tool sticks out farther, mm; nearer than the lowest there is no room for a ball.
const TOOLS_MM: [f64; 2] = [1.0, 2000.0];

fn bar_mm(text: &str) -> Result<f64> {
    within(text, LENGTHS_MM, "the length between the balls in mm, such as 150")
}

fn tool_mm(text: &str) -> Result<f64> {
    within(
        text,
        TOOLS_MM,
        "how far the centre of the ball sticks out of the spindle nose in mm, such as 120",
    )
}

fn arc_deg(text: &str) -> Result<f64> {
    within(text, ARCS_DEG, "the degrees of the arc without its overshoot, such as 220")
}

fn unit_of(text: &str) -> Result<LengthUnit> {
    let known = LengthUnit::parse(text.trim());
    known.ok_or_else(|| {
        Error::input(format!("unknown unit `{text}`"))
            .hint(format!("write one of `{}`", LengthUnit::NAMES.join("`, `")))
    })
}

fn feed_mm_min(text: &str) -> Result<f64> {
    within(text, FEEDS_MM_MIN, "the feed in mm/min, such as 1000")
}

/// A number of an option, which says what it is.
fn within(text: &str, [low, high]: [f64; 2], is: &str) -> Result<f64> {
    let value = text.trim().parse().ok().filter(|value| (low..=high).contains(value));
    value.ok_or_else(|| {
        Error::input(format!("`{text}` is no number from {low} to {high}"))
            .hint(format!("write {is}"))
    })
}

/// What was not given, and what is taken for it.
#[derive(Default)]
struct Taken(Vec<(&'static str, String)>);

/// Where answers come from: the options, then a person, then the defaults.
struct Answers<'a> {
    ask: Option<Ask<'a>>,
    taken: Taken,
}

impl Answers<'_> {
    fn get<T: Clone>(
        &mut self,
        (option, given): (&'static str, &Option<T>),
        question: &str,
        default: &str,
        parse: impl Fn(&str) -> Result<T>,
    ) -> Result<T> {
        if let Some(given) = given {
            return Ok(given.clone());
        }
        if let Some(ask) = &mut self.ask {
            return ask.ask(question, default, parse);
        }
        self.taken.0.push((option, default.to_owned()));
        parse(default)
    }
}

/// The word for the longest usual bar that fits.
const FITTING: &str = "longest that fits";

impl Arguments {
    pub(super) fn run(&self, common: &Common, talk: &Talk) -> Result<()> {
        let folder = self.folder.as_deref().or(common.output.as_deref()).unwrap_or(Path::new("."));
        let (mut input, mut shown) = (std::io::stdin().lock(), std::io::stderr());
        let person = input.is_terminal() && shown.is_terminal() && !self.defaults && !common.json;
        let ask = person.then_some(Ask { input: &mut input, output: &mut shown });
        let mut answers = Answers { ask, taken: Taken::default() };
        let found = self.found(folder)?;
        let wish = self.wish(found.as_ref(), &mut answers)?;
        let taken = answers.taken;
        let begun = Begun::new(&wish, folder)?;
        let mut files = Files::kept(folder);
        files.add(Begun::MACHINE, begun.machine_text.clone());
        files.add(Begun::TEST, begun.test_text.clone());
        if let Some((file, text)) = &begun.program {
            files.add(file, text.clone());
        }
        let written = files.write()?;
        if common.json {
            let names: Vec<_> =
                written.files.iter().map(|file| file.display().to_string()).collect();
            let taken: serde_json::Map<_, _> = taken
                .0
                .into_iter()
                .map(|(option, value)| (option.to_owned(), value.into()))
                .collect();
            let said = found.as_ref().map(|found| {
                json!({ "words": found.words(), "notes": found.notes, "log": found.measured.log })
            });
            let told = json!({ "files": names, "defaults": taken, "from": said });
            return output::print_json("init", told);
        }
        for file in &written.files {
            output::print(&format!("{}\n", file.display()))?;
        }
        if let Some(found) = &found {
            talk.say(&format!("the file says: {}", found.words()));
            for note in &found.notes {
                talk.say(&format!("caution: {note}"));
            }
        }
        if !taken.0.is_empty() {
            let list: Vec<_> =
                taken.0.iter().map(|(option, value)| format!("  --{option:9}{value}")).collect();
            talk.say(&format!("not given, so taken:\n{}", list.join("\n")));
        }
        let mounting = &begun.test.mountings()[0];
        let place = mounting.mounting.coincidence_mm;
        talk.say(&format!(
            "the test fits with a bar of {} mm and the balls at X {} Y {} Z {}; the comment on `coincidence_mm` says how to find your place",
            mounting.bar_length_mm, place.x, place.y, place.z
        ));
        let test = folder.join(Begun::TEST);
        let next = match wish.test {
            _ if found.is_some() => "analyse",
            TestKind::Design => "design",
            TestKind::Planes(_) | TestKind::Sphere(_) => "plan",
        };
        talk.say(&format!("next: ballbar {next} {}", output::typed(&test)));
        Ok(())
    }

    /// What the measured file says.
    fn found(&self, folder: &Path) -> Result<Option<Found>> {
        let stated = Stated { test: self.test, arc_deg: self.arc, unit: self.unit };
        self.from.as_deref().map(|file| Found::read(file, folder, &stated)).transpose()
    }

    fn wish(&self, found: Option<&Found>, answers: &mut Answers<'_>) -> Result<Wish> {
        // What a file says, within bounds, counts like an option; an option counts more.
        let among = |value: Option<f64>, [low, high]: [f64; 2]| {
            value.filter(|value| (low..=high).contains(value))
        };
        let name = found.and_then(|found| name_of(found.machine.as_deref()?).ok());
        let name = self.name.clone().or(name);
        let length_mm = self.bar.or_else(|| among(found?.bar_mm, LENGTHS_MM));
        let feed = self.feed.or_else(|| among(found?.feed_mm_min, FEEDS_MM_MIN));
        let test = self.test.or(found.map(|found| found.test));
        let names = |names: &[&str]| names.join(", ");
        let question = format!("Machine like ({})", names(&Builtin::ALL.map(|b| b.name)));
        let machine = answers.get(
            ("machine", &self.machine),
            &question,
            Builtin::ALL[0].name,
            Builtin::named,
        )?;
        let mut wish = Wish::of(machine, TestKind::Design)?;
        wish.name = answers.get(("name", &name), "Its name", &wish.name, name_of)?;
        let question = "Its slides from the workpiece w over the frame F to the tool t";
        let default = wish.topology.as_str().to_owned();
        wish.topology =
            answers.get(("topology", &self.topology), question, &default, Topology::parse)?;
        wish.travel_mm = self.travel_mm(&wish, answers)?;
        let question = format!("Control ({})", names(&Dialect::ALL.map(Dialect::name)));
        let default = wish.dialect.name();
        wish.dialect = answers.get(("control", &self.control), &question, default, dialect_of)?;
        let question = "From the spindle nose to the centre of the tool ball, mm";
        wish.tool_mm =
            answers.get(("tool", &self.tool), question, &wish.tool_mm.to_string(), tool_mm)?;
        if let Some(ask) = &mut answers.ask.as_mut().filter(|_| test.is_none()) {
            for kind in TestKind::all() {
                // A terminal that has gone away is told by the question.
                let _ = writeln!(ask.output, "  {:9} {}", kind.name(), kind.words());
            }
        }
        wish.test = answers.get(("test", &test), "Test", "xy", TestKind::parse)?;
        let bar = |text: &str| if text == FITTING { Ok(None) } else { bar_mm(text).map(Some) };
        wish.bar_mm =
            answers.get(("bar", &length_mm.map(Some)), "Length of the bar, mm", FITTING, bar)?;
        let default = wish.test.usual_feed_mm_min().to_string();
        wish.feed_mm_min = answers.get(("feed", &feed), "Feed, mm/min", &default, feed_mm_min)?;
        wish.measured = found.map(|found| found.measured.clone());
        Ok(wish)
    }

    fn travel_mm(&self, wish: &Wish, answers: &mut Answers<'_>) -> Result<[[f64; 2]; 3]> {
        let lengths =
            |wish: &Wish| wish.travel_mm.map(|[low, high]| (high - low).to_string()).join(",");
        // A zero alone moves the travels of the built-in machine.
        let default =
            if self.zero.is_some() { lengths(wish) } else { Travel::text(&wish.travel_mm) };
        let question = "Machine coordinates of X, Y, Z, mm, as LOWEST..HIGHEST or as lengths";
        let Travels(travels) =
            answers.get(("travel", &self.travel), question, &default, Travels::parse)?;
        let zero = if travels.iter().any(|travel| travel.asks_for_zero()) {
            let question = "Zero of the machine coordinates (upper, middle, lower end)";
            answers.get(("zero", &self.zero), question, Zero::ALL[0].name(), Zero::parse)?
        } else if self.zero.is_some() {
            return Err(Error::input("`--zero` is for travels that are lengths")
                .hint("write `--travel 762,406,508 --zero upper`, or leave `--zero` out"));
        } else {
            Zero::Upper
        };
        Ok(Axis::ALL.map(|axis| travels[axis.index()].between_mm(zero)))
    }
}
