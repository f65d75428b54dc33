//! The report in a browser: it fits, nothing lies over anything else, it needs no network, it prints.
//!
//! Needs Chromium. Without it the test says that it was skipped; in CI it must run.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::print_stderr)]

use std::path::{Path, PathBuf};
use std::process::Command;

/// What the page says about itself, as JSON in its own text.
const INSPECTION: &str = include_str!("browser/inspection.html");

/// What plots answer when they are asked and changed, as JSON in the page's own text.
const PROBE: &str = include_str!("browser/probe.html");

fn chromium() -> Option<PathBuf> {
    let found = ["chromium", "chromium-browser", "google-chrome"]
        .into_iter()
        .flat_map(|name| {
            let path = std::env::var_os("PATH").unwrap_or_default();
            std::env::split_paths(&path).map(|p| p.join(name)).collect::<Vec<_>>()
        })
        .find(|file| file.is_file());
    assert!(found.is_some() || std::env::var_os("CI").is_none(), "CI has to have Chromium");
    if found.is_none() {
        eprintln!("skipped: Chromium is not installed, so nobody looked at the page");
    }
    found
}

fn browse(chromium: &Path, arguments: &[&str], page: &Path) -> Vec<u8> {
    let profile = tempfile::tempdir().unwrap();
    let output = Command::new(chromium)
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run"])
        .args(["--disable-background-networking", "--disable-component-update", "--disable-sync"])
        .arg(format!("--user-data-dir={}", profile.path().display()))
        .args(arguments)
        .arg(format!("file://{}", page.display()))
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    output.stdout
}

fn inspected(chromium: &Path, report: &Path, window: &str, script: &str) -> serde_json::Value {
    let source = std::fs::read_to_string(report).unwrap();
    let page = report.with_file_name(format!("inspected-{window}.html"));
    // The policy would not let another script run; without it, requests would really be made.
    let (before, after) = source.split_once("</body>").unwrap();
    let before = without_policy(before);
    std::fs::write(&page, format!("{before}{script}</body>{after}")).unwrap();
    let size = format!("--window-size={window},2000");
    let dom = browse(chromium, &["--dump-dom", "--virtual-time-budget=20000", &size], &page);
    let dom = String::from_utf8(dom).unwrap();
    let (_, rest) = dom.split_once("<pre id=\"inspection\">").expect("the page was inspected");
    let text = rest.split_once("</pre>").unwrap().0;
    let text = text.replace("&gt;", ">").replace("&lt;", "<").replace("&amp;", "&");
    serde_json::from_str(&text).unwrap()
}

/// The page without its content security policy.
fn without_policy(page: &str) -> String {
    let policies = |line: &&str| !line.starts_with("<meta http-equiv=\"Content-Security-Policy\"");
    page.split_inclusive('\n').filter(policies).collect()
}

/// How many sheets a page prints on.
fn sheets(chromium: &Path, page: &Path) -> usize {
    let pdf = page.with_extension("pdf");
    let print = format!("--print-to-pdf={}", pdf.display());
    browse(chromium, &[&print, "--no-pdf-header-footer"], page);
    let pages = std::fs::read(&pdf).unwrap();
    // A file has one `/Type /Pages`, the list of them.
    let is_sheet = |window: &&[u8]| window.starts_with(b"/Type /Page") && window[11] != b's';
    pages.windows(12).filter(is_sheet).count()
}

/// Page one of a report is one sheet, and the rest begins on the next.
///
/// Not by counting the sheets of the rest alone: Chromium shrinks a document to its widest table, so that
/// the rest without page one breaks elsewhere.
fn check_page_one(chromium: &Path, report: &Path) {
    let source = std::fs::read_to_string(report).unwrap();
    let (head, rest) = source.split_once("<section id=\"page-one\">").unwrap();
    let (front, _) = rest.split_once("</section>").unwrap();
    // Alone, and with something behind it: behind as much as there is, and behind a word.
    let some = "<p>Some.</p>";
    for (front, rest, expected) in [(front, "", 1), (front, some, 2), (some, some, 2)] {
        let page = report.with_file_name("page-one.html");
        let text = format!("{head}<section id=\"page-one\">{front}</section>{rest}</body></html>");
        std::fs::write(&page, text).unwrap();
        assert_eq!(sheets(chromium, &page), expected, "page one of {}", report.display());
    }
}

/// Plots tell what is under the pointer, and can be changed; whether `causes` were named.
fn check_script(chromium: &Path, report: &Path, causes: bool) {
    let answer = inspected(chromium, report, "1280", PROBE);
    let name = report.display();
    for fact in [
        "rings_halved",
        "magnified",
        "as_printed",
        "one_way",
        "fewer_runs",
        "others_follow",
        "opened",
    ] {
        assert_eq!(answer[fact], true, "{name}: {fact}: {answer:#}");
    }
    assert_ne!(answer["turned"], false, "{name}: {answer:#}");
    let told = answer["told"].as_str().unwrap();
    assert!(told.contains("°: X ") && told.contains("read "), "{told}");
    // The residual charts tell a point as their axes have it.
    let told = answer["of_chart"].as_str().unwrap().replace('\u{2212}', "-");
    for (line, expected) in told.lines().zip(answer["on_axes"].as_array().unwrap()) {
        // Such as `velocity of X, along X -16.4 mm/s`.
        let value: f64 = line.rsplit(' ').nth(1).unwrap().parse().unwrap();
        let expected = expected.as_f64().unwrap();
        assert!((value - expected).abs() <= 0.01 * expected.abs().max(1.0), "{told}: {expected}");
    }
    assert_eq!(answer["causes"].as_u64().unwrap() > 0, causes, "{answer:#}");
    if causes {
        let repaired = answer["repaired"].as_str().unwrap();
        let (_, numbers) = repaired.split_once("as it was: ").unwrap();
        let (before, rest) = numbers.split_once(" → ").unwrap();
        let after = rest.split_once(" µm").unwrap().0;
        let [before, after]: [f64; 2] = [before, after].map(|um| um.parse().unwrap());
        assert!(0.0 < after && after < before, "{repaired}");
        assert_eq!(answer["moved"], true, "{answer:#}");
    }
}

/// The page as it is, under its own policy: its script ran, and the policy found nothing to complain of.
fn check_live(chromium: &Path, report: &Path) {
    let log = ["--dump-dom", "--enable-logging=stderr", "--v=0", "--virtual-time-budget=20000"];
    let profile = tempfile::tempdir().unwrap();
    let output = Command::new(chromium)
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--no-first-run"])
        .arg(format!("--user-data-dir={}", profile.path().display()))
        .args(log)
        .arg(format!("file://{}", report.display()))
        .output()
        .unwrap();
    let (dom, said) =
        (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(dom.contains("<html lang=\"en\" class=\"live\">"), "the script did not run: {said}");
    let complaints: Vec<&str> = said.lines().filter(|line| line.contains("CONSOLE")).collect();
    assert!(complaints.is_empty(), "{complaints:#?}");
}

/// Runs the binary; results go to the directory.
fn ballbar(arguments: &[&str], results: &Path) {
    let status = Command::new(env!("CARGO_BIN_EXE_ballbar"))
        .args(arguments)
        .args(["--quiet", "-o"])
        .arg(results)
        .stdout(std::process::Stdio::null())
        .status()
        .unwrap();
    assert!(status.success());
}

/// The page fits at some widths, shows so many drawings and tables at the least, and prints on so many
/// pages at the most.
fn check(
    chromium: &Path,
    page: &Path,
    windows: &[&str],
    drawings: u64,
    tables: u64,
    most_pages: usize,
) {
    let name = page.display();
    for window in windows {
        let found = inspected(chromium, page, window, INSPECTION);
        let findings = found["findings"].as_array().unwrap();
        assert!(findings.is_empty(), "{name} at {window}: {findings:#?}");
        assert!(found["resources"].as_array().unwrap().is_empty(), "no network: {found}");
        assert!(found["drawings"].as_u64().unwrap() >= drawings, "{found}");
        assert!(found["tables"].as_u64().unwrap() >= tables, "{found}");
    }
    let pages = sheets(chromium, page);
    assert!((3..most_pages).contains(&pages), "{name}: {pages} pages");
}

/// The report of a set fits a screen and prints; whether `causes` are named in it.
fn check_report(set: &str, circles: u64, causes: bool) {
    let Some(chromium) = chromium() else { return };
    let work = tempfile::tempdir().unwrap();
    let test = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(set);
    ballbar(&["analyse", test.join("test.toml").to_str().unwrap()], work.path());
    // A polar plot for each circle, two alignment pictures a run, and the residuals.
    let report = work.path().join("report.html");
    check(&chromium, &report, &["1280", "900", "400"], circles + 6, 3, 60);
    check_page_one(&chromium, &report);
    check_live(&chromium, &report);
    check_script(&chromium, &report, causes);
}

#[test]
fn the_report_of_a_sphere_fits_a_screen_and_prints() {
    check_report("hu40t", 6, false);
}

/// With the chords that it was driven in.
#[test]
fn the_report_of_three_planes_fits_a_screen_and_prints() {
    check_report("planar", 3, true);
}

/// With a finding and its picture.
#[test]
fn the_report_of_a_cause_fits_a_screen_and_prints() {
    check_report("case-a", 6 + 10, true);
}

/// What a test file may say on page one is bounded there, and not everything is kept.
#[test]
fn page_one_is_one_sheet_whatever_it_tells() {
    let Some(chromium) = chromium() else { return };
    let work = tempfile::tempdir().unwrap();
    let set = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/planar");
    for file in std::fs::read_dir(&set).unwrap() {
        let file = file.unwrap().path();
        std::fs::copy(&file, work.path().join(file.file_name().unwrap())).unwrap();
    }
    let words = "a word of many that somebody may write here, ".repeat(3);
    let text = std::fs::read_to_string(set.join("test.toml")).unwrap();
    let machines = Path::new(env!("CARGO_MANIFEST_DIR")).join("machines");
    let text = text
        .replacen("name = \"Three planes\"", &format!("name = \"{words}\""), 1)
        .replace("../../../machines", machines.to_str().unwrap());
    let people = ["customer", "operator", "machine_serial", "bar_serial", "compensation", "note"];
    let people = people.map(|key| format!("{key} = \"{words}\"\n")).concat();
    let limits = [
        "circular_deviation_um",
        "bidirectional_circular_deviation_um",
        "squareness_um_m",
        "radial_deviation_um",
        "reversal_um",
        "scale_um_m",
    ];
    let limits = limits.map(|key| format!("{key} = 0.5\n")).concat();
    let text = format!(
        "{text}\n[record]\ndate = 2026-11-23\nbar_calibrated = 2026-03-01\n{people}\n[tolerance]\n{limits}"
    );
    std::fs::write(work.path().join("test.toml"), text).unwrap();
    let results = work.path().join("results");
    ballbar(&["analyse", work.path().join("test.toml").to_str().unwrap()], &results);
    let report = results.join("report.html");
    let page = std::fs::read_to_string(&report).unwrap();
    let front = page.split_once("</section>").unwrap().0;
    assert!(front.contains("<div class=\"verdict fail\">"), "tolerances of 0.5 are not kept");
    assert!(front.matches('\u{2026}').count() >= 5, "what is too long says so");
    check_page_one(&chromium, &report);
    check_live(&chromium, &report);
}

/// Two tests: one with many arcs, some of them below the equator, and one with mountings whose bars,
/// arcs and names differ.
#[test]
fn the_plans_fit_a_screen_and_print() {
    let Some(chromium) = chromium() else { return };
    let work = tempfile::tempdir().unwrap();
    let machine = Path::new(env!("CARGO_MANIFEST_DIR")).join("machines/hu40t.toml");
    let head = |name: &str| {
        format!(
            "name = \"{name}\"\nmachine = \"{}\"\n[ball_bar]\nlength_mm = 150.0\n\
             [identify]\nterms = [\"complete\"]\n",
            machine.display()
        )
    };
    let mounting = |name: &str, at: &str, rest: &str| {
        format!(
            "[[mounting]]\nname = \"{name}\"\ncoincidence_mm = {at}\n\
             tool_ball_mm = [0.0, 0.0, -200.0]\n{rest}\n"
        )
    };
    let many = head("Many arcs")
        + &mounting("A", "[20.0, -35.0, 40.0]", "")
        + "[plan]\nstrategy = \"3d10\"\nfeed_mm_min = 2000.0\n\
           [[plan.arc]]\nkind = \"parallel\"\npolar_deg = 50.0\n\
           [[plan.arc]]\nkind = \"circle\"\nstart = [1.0, 0.0, 0.2]\nnormal = [0.0, 0.5, 1.0]\n";
    let places = head("Three places & <two> bars")
        + &mounting("A", "[-100.0, -100.0, 0.0]", "")
        + &mounting("left, behind the pallet", "[100.0, -60.0, 60.0]", "bar_length_mm = 100.0")
        + &mounting("C", "[0.0, 100.0, 120.0]", "")
        + "[plan]\nstrategy = \"2d\"\nfeed_mm_min = 2000.0\n\
           [[plan.arc]]\nkind = \"meridian\"\nazimuth_deg = 45.0\nmountings = [\"C\"]\n";
    std::fs::write(work.path().join("many.toml"), many).unwrap();
    std::fs::write(work.path().join("places.toml"), places).unwrap();
    let [many, places] = ["many.toml", "places.toml"].map(|name| work.path().join(name));
    let (many, places) = (many.to_str().unwrap(), places.to_str().unwrap());
    ballbar(&["plan", many, places, "--repeats", "3"], work.path());
    // Of each: spheres, travel, time, at least one set of maps with its scale.
    check(&chromium, &work.path().join("plan.html"), &["1200", "900"], 4 + 2 * (2 + 4), 15, 30);
}
