//! The plan as one self-contained HTML page in the style of the report.

use askama::Template;

use super::facts::{PlanReport, TestOutlook, UnseenTerm};
use super::figures::sphere::Circle;
use super::figures::{bars, sphere, volume_map};
use super::planned::Planned;
use super::{rows, unseen, verdict, words};
use crate::error::{Error, Kind, Result};
use crate::report::text::filters;
use crate::report::text::numbers::typeset;
use crate::report::text::words::fine;

/// What the test leaves unknown is mapped where it is at least this share of what the noise makes.
const MATTERS: f64 = 0.1;

#[derive(Template)]
#[template(path = "plan.html")]
struct Page<'a> {
    plan: &'a PlanReport,
    title: String,
    several: bool,
    side_by_side: Table,
    tests: Vec<TestPage<'a>>,
    kinds: [(&'static str, &'static str); 6],
}

struct TestPage<'a> {
    test: &'a TestOutlook,
    facts: Vec<(&'static str, String)>,
    verdict: Vec<String>,
    mountings: Table,
    spheres: Vec<SpherePicture>,
    travel_bars: String,
    travel: Table,
    clearances: Vec<String>,
    time_bars: String,
    time: Table,
    assumed: String,
    place: Option<Table>,
    both: &'static str,
    looks_like: Vec<String>,
    errors: Table,
    step: &'static str,
    parameters: [Table; 2],
    noise_maps: Vec<String>,
    unseen_maps: Vec<String>,
    unseen: Vec<UnseenGroup<'a>>,
}

struct SpherePicture {
    name: String,
    svg: String,
    circles: Vec<Circle>,
}

struct UnseenGroup<'a> {
    heading: String,
    terms: Vec<&'a UnseenTerm>,
}

/// A table: cells with whether they are numbers.
struct Table {
    head: Vec<(String, bool)>,
    body: Vec<Vec<(String, bool)>>,
}

impl Table {
    /// The first row is the head; `r` for columns of numbers.
    fn new(all: &[rows::Row], sides: &str) -> Self {
        let cells = |row: &rows::Row, is_head: bool| -> Vec<(String, bool)> {
            let row = row.iter().zip(sides.chars());
            row.map(|(cell, side)| {
                let number = side == 'r';
                let words = if cell.starts_with("um") || cell.starts_with("urad") {
                    cell.replacen('u', "µ", 1)
                } else {
                    fine(cell)
                };
                (if number && !is_head { typeset(&words) } else { words }, number)
            })
            .collect()
        };
        Self {
            head: all.first().map_or_else(Vec::new, |row| cells(row, true)),
            body: all.iter().skip(1).map(|row| cells(row, false)).collect(),
        }
    }

    /// The lower half of the rows as a second table.
    fn halves(mut self) -> [Self; 2] {
        let rest = self.body.split_off(self.body.len().div_ceil(2));
        let second = Self { head: self.head.clone(), body: rest };
        [self, second]
    }
}

/// Renders the page; `planned` is what the plan was made of, in the same order. The same input gives the
/// same bytes.
pub fn plan_page(plan: &PlanReport, planned: &[Planned]) -> Result<String> {
    let several = plan.tests.len() > 1;
    let title = match plan.tests.as_slice() {
        [only] => only.name.clone(),
        all => format!("{} tests side by side", all.len()),
    };
    let sides = format!("l{}", "r".repeat(plan.tests.len()));
    let tests = plan.tests.iter().zip(planned);
    let page = Page {
        title,
        several,
        side_by_side: Table::new(&rows::side_by_side(plan), &sides),
        tests: tests.map(|(test, planned)| test_page(plan, test, planned)).collect(),
        kinds: bars::KINDS,
        plan,
    };
    page.render()
        .map_err(|error| Error::new(Kind::Output, format!("the plan cannot be rendered: {error}")))
}

fn test_page<'a>(plan: &PlanReport, test: &'a TestOutlook, planned: &Planned) -> TestPage<'a> {
    let repeats = plan.repeats;
    let several = repeats > 1;
    let spheres = planned.outlook.mountings.iter().map(|mounting| {
        let (svg, circles) = sphere::sphere(mounting);
        SpherePicture { name: mounting.named.name.clone(), svg, circles }
    });
    let rms = |of: &super::facts::VolumeFacts| of.rms_um.of_one.unwrap_or(0.0);
    let matters = rms(&test.volume_unseen) >= MATTERS * rms(&test.volume_noise);
    let unseen_maps = if matters {
        volume_map::maps(&test.volume_unseen, "Unknown volumetric error")
    } else {
        Vec::new()
    };
    let of_errors = rows::machine_errors(test, repeats);
    let of_parameters = rows::parameters(test, repeats, true);
    TestPage {
        facts: facts(test, repeats),
        verdict: verdict::of(test, repeats).iter().map(|line| fine(line)).collect(),
        mountings: Table::new(&rows::mountings(test), "lllrrrrrr"),
        spheres: spheres.collect(),
        travel_bars: bars::travel(test),
        travel: Table::new(&rows::travel(test), "lrrrrrr"),
        clearances: words::clearances(test),
        time_bars: bars::time(test),
        time: Table::new(&rows::time(test, repeats), "lrrrrrrrrr"),
        assumed: words::assumed(test, repeats),
        place: (!test.at_the_place.is_empty()).then(|| {
            let rows = rows::at_the_place(test, repeats);
            Table::new(&rows, if several { "lrrrl" } else { "lrrl" })
        }),
        both: words::BOTH,
        looks_like: words::looks_like(test),
        errors: Table::new(&of_errors, if several { "llrrl" } else { "llrl" }),
        step: words::STEP,
        parameters: Table::new(&of_parameters, if several { "lrrl" } else { "lrl" }).halves(),
        noise_maps: volume_map::maps(&test.volume_noise, "Standard deviation by noise"),
        unseen_maps,
        unseen: unseen::groups(&test.unseen)
            .into_iter()
            .map(|group| UnseenGroup { heading: words::heading(&group.what), terms: group.terms })
            .collect(),
        test,
    }
}

fn facts(test: &TestOutlook, repeats: u32) -> Vec<(&'static str, String)> {
    let (machine, bar) = (&test.machine, &test.ball_bar);
    let pivots = machine.pivots;
    let correlated = if test.correlated_um > 0.0 {
        format!(", {} µm of it correlated over {} s", test.correlated_um, test.correlation_s)
    } else {
        String::new()
    };
    vec![
        ("What", words::under_title(test)),
        ("Run", if repeats == 1 { "once".into() } else { format!("{repeats} times") }),
        ("Pivots", format!("X {}, Y {}, Z {}", pivots.x, pivots.y, pivots.z)),
        (
            "Ball-bar",
            format!(
                "range ± {} mm, resolution {} µm, noise {} µm{correlated}, read at {} Hz",
                bar.range_mm, bar.resolution_um, bar.noise_um, bar.sample_rate_hz
            ),
        ),
        ("Test file", test.file.clone()),
    ]
}
