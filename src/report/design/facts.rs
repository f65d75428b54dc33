//! A designed test as JSON.

use serde_json::{Value, json};

use crate::design::{Outlook, Proposal};
use crate::plan::{Criterion, Test};

/// Wanted coefficients that the designed test does not determine.
pub fn unseen_of(proposal: &Proposal, outlook: &Outlook) -> Vec<String> {
    let names = proposal.wanted.iter().map(ToString::to_string);
    names.filter(|name| outlook.prediction.sigma(name).is_none()).collect()
}

/// What was chosen, for other programs.
pub fn proposal_json(request: &Test, proposal: &Proposal, outlook: &Outlook) -> Value {
    let time = outlook.time();
    let (coefficients, set_ups) = outlook.term_counts();
    let of = request.design().map_or(Criterion::A, |design| design.criterion);
    json!({
        "format": "ballbar.design/1",
        "test": request.name(),
        "criterion": of,
        "before": proposal.value[0],
        "after": proposal.value[1],
        "candidate_set_ups": proposal.candidates[0],
        "candidate_arcs": proposal.candidates[1],
        "total_s": time.total_s(),
        "machine_s": time.machine_s(),
        "operator_s": time.operator_s,
        "coefficients": coefficients,
        "set_up_errors": set_ups,
        "volume_noise_rms_um": outlook.volume_noise.rms_mm * 1e3,
        "volume_noise_worst_um": outlook.volume_noise.worst.sigma_mm * 1e3,
        "volume_unseen_rms_um": outlook.volume_unseen.rms_mm * 1e3,
        "set_ups": proposal.set_ups.iter().map(|proposed| json!({
            "name": proposed.set_up.name,
            "coincidence_mm": proposed.set_up.mounting.coincidence_mm.as_slice(),
            "tool_ball_mm": proposed.set_up.mounting.tool_ball_mm.as_slice(),
            "bar_length_mm": proposed.set_up.bar_mm,
            "arcs": proposed.arcs.iter().map(|arc| arc.name.clone()).collect::<Vec<_>>(),
        })).collect::<Vec<_>>(),
        "next": proposal.next.iter().map(|next| json!({
            "mounting": next.set_up,
            "arc": next.arc,
            "seconds": next.seconds,
            "after": next.value,
        })).collect::<Vec<_>>(),
    })
}
