//! A designed test in words.

use std::fmt::Write as _;

use crate::design::{Outlook, Proposal};
use crate::plan::{Criterion, Test};
use crate::report::text::numbers::{decimals, fixed, many};

/// A length in micrometres with three digits that say something, however small it is.
fn um(mm: f64) -> String {
    let um = mm * 1e3;
    fixed(um, decimals(um, 3))
}

/// What one more arc leaves of the criterion, in words.
fn left(criterion: Criterion, before: f64, after: f64) -> String {
    match criterion {
        Criterion::A | Criterion::G => format!("then {} um", um(after)),
        Criterion::D => format!("then known {} times better", fixed((before - after).exp(), 2)),
    }
}

/// The criterion in words, before and after.
fn criterion(request: &Test, proposal: &Proposal) -> String {
    let of = request.design().map_or(Criterion::A, |design| design.criterion);
    let [before, after] = proposal.value;
    match of {
        Criterion::A => format!(
            "volumetric error, rms: {} um known beforehand, {} um after",
            um(before),
            um(after)
        ),
        Criterion::G => format!(
            "volumetric error, worst as the root of the mean fourth power over the volume: {} um known beforehand, {} um after",
            um(before),
            um(after)
        ),
        Criterion::D => format!(
            "a coefficient is known {} times better than beforehand, in the geometric mean",
            fixed((before - after).exp(), 0)
        ),
    }
}

/// What was chosen, in the order in which it is done.
pub fn proposal_text(request: &Test, proposal: &Proposal, outlook: &Outlook) -> String {
    let mut text = String::new();
    let _ = writeln!(text, "{}, designed", request.name());
    let _ = writeln!(
        text,
        "chosen from {} and {} in them\n",
        many(proposal.candidates[0], "set-up"),
        many(proposal.candidates[1], "arc")
    );
    let time = outlook.time();
    let _ = writeln!(
        text,
        "{} min: {} min for the machine, {} min assumed for the operator",
        fixed(time.total_s() / 60.0, 1),
        fixed(time.machine_s() / 60.0, 1),
        fixed(time.operator_s / 60.0, 1)
    );
    let _ = writeln!(text, "{}", criterion(request, proposal));
    let (coefficients, set_ups) = outlook.term_counts();
    let _ = writeln!(
        text,
        "{coefficients} of 90 coefficients and {} identifiable",
        many(set_ups, "set-up error")
    );
    let _ = writeln!(
        text,
        "over the travel the noise leaves {} um rms, {} um at the worst",
        fixed(outlook.volume_noise.rms_mm * 1e3, 2),
        fixed(outlook.volume_noise.worst.sigma_mm * 1e3, 2)
    );
    text.push_str("\nWhat to do\n");
    text.push_str(&steps(proposal, outlook));
    if !proposal.next.is_empty() {
        text.push_str("\nWhat would determine most next\n");
        text.push_str(&next(request, proposal));
    }
    text
}

/// The mountings in the order in which they are set up, each with its arcs.
fn steps(proposal: &Proposal, outlook: &Outlook) -> String {
    let mut text = String::new();
    for (index, proposed) in proposal.set_ups.iter().enumerate() {
        let set_up = &proposed.set_up;
        let at = set_up.mounting.coincidence_mm.map(|c| fixed(c, 0));
        let tool = set_up.mounting.tool_ball_mm.map(|c| fixed(c, 0));
        let minutes = outlook.mountings.get(index).map_or(0.0, |m| m.time.machine_s() / 60.0);
        let _ = writeln!(
            text,
            "  {}. mounting {}: balls meet at X {} Y {} Z {}, tool ball at ({}, {}, {}), bar {} mm, {} min",
            index + 1,
            set_up.name,
            at.x,
            at.y,
            at.z,
            tool.x,
            tool.y,
            tool.z,
            fixed(set_up.bar_mm, 0),
            fixed(minutes, 1)
        );
        let names: Vec<&str> = proposed.arcs.iter().map(|arc| arc.name.as_str()).collect();
        for line in names.chunks(5) {
            let _ = writeln!(text, "       {}", line.join(", "));
        }
    }
    text
}

/// The arcs that would be worth most beside those that were chosen.
fn next(request: &Test, proposal: &Proposal) -> String {
    let mut text = String::new();
    let of = request.design().map_or(Criterion::A, |design| design.criterion);
    for next in &proposal.next {
        let _ = writeln!(
            text,
            "  {} in {}: {} min, {}",
            next.arc,
            next.set_up,
            fixed(next.seconds / 60.0, 1),
            left(of, proposal.value[0], next.value)
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_values_keep_their_digits_and_d_has_no_micrometres() {
        assert_eq!(um(2.1e-6), "0.00210");
        assert_eq!(um(0.6432e-3), "0.643");
        assert_eq!(um(0.268), "268");
        assert_eq!(left(Criterion::A, 0.1, 0.0867), "then 86.7 um");
        assert_eq!(left(Criterion::D, -5.0, -5.5), "then known 1.65 times better");
    }
}
