//! Rule of what is in force before the program says anything: whoever was there before has left it.

use super::findings::Findings;
use crate::machine::Dialect;
use crate::nc::code::Code;
use crate::nc::listing::{Line, Listing};
use crate::nc::run::Ran;
use crate::nc::word::Fault;

/// What every path depends on, each group by the word that our programs write.
const DEPENDS: [(Code, &str); 7] = [
    (Code::Inch(false), "G21"),
    (Code::Incremental(false), "G90"),
    (Code::WorkOffset(54), "G54"),
    (Code::Default(94), "G94"),
    (Code::Default(40), "G40"),
    (Code::Default(49), "G49"),
    (Code::Default(80), "G80"),
];
/// What a path may depend on: the plane of arcs, stops at the ends of blocks.
const MAY_DEPEND: [(Code, &str); 2] =
    [(Code::Plane(2), "G17"), (Code::ExactStopMode(false), "G64")];
/// What it depends on where a Fanuc has these options.
const OPTIONS: [(Code, &str); 3] =
    [(Code::Default(69), "G69"), (Code::Default(15), "G15"), (Code::Default(50), "G50")];

pub(super) fn check(listing: &Listing, ran: &Ran, dialect: Dialect, findings: &mut Findings) {
    let Some((line, stated)) = ran.at_first_motion else { return };
    let missing = |words: &[(Code, &'static str)]| {
        let of = words.iter().filter(|(code, _)| !stated.has(*code));
        of.map(|(_, name)| *name).collect::<Vec<_>>().join(", ")
    };
    let fault = |line: Line, names: &str| {
        let what = format!("the machine moves before the program has stated {names}");
        let hint = "what somebody left in force holds, and the path may be another: state it in the first blocks";
        listing.locate(line, Fault::line(what).hint(hint))
    };
    let depends = missing(&DEPENDS);
    if !depends.is_empty() {
        findings.error("power-on", fault(line, &depends));
    }
    // Where an arc comes after all, the path does depend on it.
    let plane = Code::Plane(2);
    if let Some((line, stated)) = ran.at_first_arc
        && !stated.has(plane)
    {
        findings.error("power-on", fault(line, "the plane of its arcs, G17, G18 or G19"));
    }
    let mut may = missing(&MAY_DEPEND);
    if dialect == Dialect::Fanuc {
        let options = missing(&OPTIONS);
        may = [may, options]
            .into_iter()
            .filter(|names| !names.is_empty())
            .collect::<Vec<_>>()
            .join(", ");
    }
    if !may.is_empty() {
        findings.warning("power-on", fault(line, &may));
    }
}
