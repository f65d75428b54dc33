//! Rule of what is in force before the program says anything: whoever was there before has left it.

use super::findings::Findings;
use crate::nc::code::Code;
use crate::nc::grammar::Grammar;
use crate::nc::lines::Line;
use crate::nc::listing::Listing;
use crate::nc::run::Ran;
use crate::nc::word::Fault;

pub(super) fn check(listing: &Listing, ran: &Ran, grammar: &Grammar, findings: &mut Findings) {
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
    let depends = missing(grammar.stating.depends);
    if !depends.is_empty() {
        findings.error("power-on", fault(line, &depends));
    }
    // Where an arc comes after all, the path does depend on it.
    let plane = Code::Plane(2);
    if let Some((line, stated)) = ran.at_first_arc
        && !stated.has(plane)
    {
        let of_arcs = format!("the plane of its arcs, {}", grammar.stating.planes);
        findings.error("power-on", fault(line, &of_arcs));
    }
    let may = missing(grammar.stating.may_depend);
    if !may.is_empty() {
        findings.warning("power-on", fault(line, &may));
    }
}
