//! What can be chosen and what can be told by it: arcs that can be driven, coefficients that can be seen.

use rayon::prelude::*;

use super::candidates::{SetUpCandidate, can_drive};
use super::information::{self, Basis, SET_UP_MM};
use super::volume::Volume;
use crate::error::{Error, Kind, Place, Result};
use crate::identify::{self, Driven, SEEN_UM};
use crate::machine::{Axis, Machine};
use crate::model::{self, COMPLETE, Coefficient};
use crate::plan::{Arc, DesignRequest, Test};

/// Points an axis over the volume that the sizes of the coefficients come from.
const SIZE_STEPS: usize = 5;
/// Rank is looked at over every so many arcs: more show nothing new ...
const FEW_ARCS: usize = 7;
/// ... but over at least so many of a set-up, if it has them.
const ENOUGH_ARCS: usize = 27;

/// Which arcs can be driven in which set-ups, as pairs of indices.
pub(super) fn drivable(
    test: &Test,
    machine: &Machine,
    set_ups: &[SetUpCandidate],
    arcs: &[Arc],
    feed_in_mm: f64,
) -> Result<Vec<(usize, usize)>> {
    let looked: Vec<Vec<Result<()>>> = set_ups
        .par_iter()
        .map(|set_up| arcs.iter().map(|arc| can_drive(machine, set_up, arc, feed_in_mm)).collect())
        .collect();
    let mut pairs = Vec::new();
    let mut reason = None;
    for (index, of_set_up) in looked.into_iter().enumerate() {
        let mut first = None;
        let before = pairs.len();
        for (arc, can) in of_set_up.into_iter().enumerate() {
            match can {
                Ok(()) => pairs.push((index, arc)),
                Err(error) => first = first.or(Some(error)),
            }
        }
        reason = reason.or_else(|| first.clone());
        // A place that the user gave must be good for something.
        if let Some(mut error) = first.filter(|_| pairs.len() == before)
            && (set_ups[index].given.is_some())
        {
            error.what = format!(
                "no arc can be driven in mounting `{}`: {}",
                set_ups[index].name, error.what
            );
            return Err(error.at(Place::file(test.file())));
        }
    }
    if pairs.is_empty() {
        let mut error = reason.unwrap_or_else(|| Error::input("there are no places"));
        error.what = format!("no arc can be driven in any place: {}", error.what);
        return Err(error
            .at(Place::file(test.file()))
            .hint("check the travel and `[clearance]` in the machine file"));
    }
    Ok(pairs)
}

/// The coefficients that are named as wanted; `None` for all.
fn wanted(request: &DesignRequest) -> Result<Option<Vec<Coefficient>>> {
    if request.wanted.iter().any(|name| name == COMPLETE) {
        return Ok(None);
    }
    named(request).map(Some)
}

/// The coefficients that are named, besides `complete`.
fn named(request: &DesignRequest) -> Result<Vec<Coefficient>> {
    let names = request.wanted.iter().filter(|name| *name != COMPLETE && !name.starts_with('-'));
    let named: Vec<String> = names.cloned().collect();
    if named.is_empty() {
        return Ok(Vec::new());
    }
    let terms = model::terms(&named, &[String::new()])?;
    let names = terms.iter().flat_map(|term| term.parameters());
    Ok(names.filter_map(|parameter| parameter.id.coefficient()).collect())
}

/// The working volume that a design is for, machine coordinates, mm.
pub(super) fn volume_mm(
    test: &Test,
    request: &DesignRequest,
    machine: &Machine,
) -> Result<[[f64; 2]; 3]> {
    let travel_mm = Volume::travel_mm(machine);
    let Some(volume_mm) = request.volume_mm else { return Ok(travel_mm) };
    for axis in Axis::ALL {
        let [[low, high], [from, to]] = [volume_mm[axis.index()], travel_mm[axis.index()]];
        if low < from || high > to {
            return Err(Error::input(format!(
                "the volume goes from {low} to {high} mm in {axis}, the travel from {from} to {to} mm"
            ))
            .at(Place::file(test.file()))
            .hint("give machine coordinates within the travel, or leave `volume_mm` out"));
        }
    }
    Ok(volume_mm)
}

/// What a request leaves out by `-NAME`.
pub(super) fn excluded(request: &DesignRequest) -> Vec<String> {
    request.wanted.iter().filter(|name| name.starts_with('-')).cloned().collect()
}

/// The largest set that the candidates together can tell apart, and those of it that are wanted: for
/// `complete` what the tool of the first mounting can tell.
pub(super) fn basis(
    test: &Test,
    request: &DesignRequest,
    machine: &Machine,
    set_ups: &[SetUpCandidate],
    arcs: &[Arc],
    drivable: &[(usize, usize)],
) -> Result<(Basis, Vec<Coefficient>)> {
    // The usual order and not the wanted ones first: what acts as something else is not seen because the
    // other was left out.
    let names = identify::order_of(&excluded(request))?;
    let order: Vec<Coefficient> =
        names.iter().filter_map(|name| Coefficient::parse(name)).collect();
    let few: Vec<(&SetUpCandidate, Vec<&Arc>)> = set_ups
        .iter()
        .enumerate()
        .map(|(index, set_up)| {
            let of_set_up: Vec<&Arc> =
                drivable.iter().filter(|(s, _)| *s == index).map(|&(_, arc)| &arcs[arc]).collect();
            let step = (of_set_up.len() / ENOUGH_ARCS).clamp(1, FEW_ARCS);
            (set_up, of_set_up.into_iter().step_by(step).collect::<Vec<_>>())
        })
        .filter(|(_, arcs)| !arcs.is_empty())
        .collect();
    let choice = information::tellable(machine, &order, &few, request.most_mountings)?;
    let kept: Vec<Coefficient> = choice.kept.iter().map(|&k| order[k]).collect();
    let missing = named(request)?.into_iter().find(|c| !kept.contains(c));
    if let Some(missing) = missing {
        return Err(cannot_see(test, machine, missing, &names, &few)?);
    }
    // What a coefficient is trusted with beforehand is a matter of the machine, not of the part of its
    // volume that one cares about: in a box of a few millimetres a cubic would be trusted with anything.
    let travel_mm = Volume::travel_mm(machine);
    let volume = Volume::new(machine, &test.mountings()[0].mounting, travel_mm, SIZE_STEPS, &kept);
    let basis = information::basis(&volume, SEEN_UM * 1e-3, SET_UP_MM);
    // What only a second tool can tell is estimated with it, but nobody wants it for its own sake.
    let usual = test.mountings()[0].mounting.tool_ball_mm;
    let of_tool: Vec<(&SetUpCandidate, Vec<&Arc>)> =
        few.into_iter().filter(|(set_up, _)| set_up.mounting.tool_ball_mm == usual).collect();
    let of_tool = information::tellable(machine, &order, &of_tool, request.most_mountings)?;
    let named = named(request)?;
    let wanted = match wanted(request)? {
        Some(wanted) => wanted,
        None => order
            .iter()
            .enumerate()
            .filter(|(k, c)| of_tool.kept.contains(k) || named.contains(c))
            .map(|(_, c)| *c)
            .collect(),
    };
    let order_of_basis = basis.coefficients.iter().copied();
    let wanted = order_of_basis.filter(|c| wanted.contains(c)).collect();
    Ok((basis, wanted))
}

/// Which wanted coefficient no candidate can see, and why.
fn cannot_see(
    test: &Test,
    machine: &Machine,
    missing: Coefficient,
    order: &[String],
    set_ups: &[(&SetUpCandidate, Vec<&Arc>)],
) -> Result<Error> {
    /// Each set-up brings columns of its own, and a few show what all show.
    const FEW: usize = 4;
    let few = &set_ups[..set_ups.len().min(FEW)];
    let driven: Vec<Driven> = few
        .iter()
        .map(|(set_up, arcs)| Driven {
            mounting: set_up.mounting,
            bar_mm: set_up.bar_mm,
            arcs: arcs.iter().map(|&arc| arc.clone()).collect(),
        })
        .collect();
    let names: Vec<String> = few.iter().map(|(set_up, _)| set_up.name.clone()).collect();
    let sight = super::outlook::sight(machine, &driven, &names)?;
    let mut selection = sight.select(&sight.ordered(order))?;
    let removal = selection.removed.iter().position(|removal| removal.name == missing.to_string());
    let mut error = Error::new(
        Kind::Undetermined,
        match few.len() {
            1 => format!("no arc can see `{missing}`, which is wanted"),
            _ => format!("no choice of the candidates can see `{missing}`, which is wanted"),
        },
    )
    .at(Place::file(test.file()));
    if let Some(place) = removal {
        let removal = selection.removed.swap_remove(place);
        let group = [removal.direction];
        let remedies = identify::remedies(machine, &driven, &group, &sight);
        error.what = format!("{}: {}", error.what, removal.reason);
        error = error.hint(match remedies.concat().as_slice() {
            [] => {
                "nothing that a ball-bar can do separates them: take it out of `wanted`".to_owned()
            }
            remedies => format!("what would separate them: {}", remedies.join("; ")),
        });
    }
    Ok(error)
}
