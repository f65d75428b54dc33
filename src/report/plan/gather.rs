//! From outlooks to a [`PlanReport`].

use super::cautions;
use super::facts::{
    ClearanceFacts, ComparedSquareness, Comparison, ForeseenErrors, ForeseenHysteresis,
    ForeseenPlace, ForeseenReversal, ForeseenScale, ForeseenSquareness, MountingOutlook,
    OperatorFacts, ParameterOutlook, PlanReport, SightFacts, Spread, TestOutlook, TimeFacts,
    TravelFacts, UnseenTerm, VolumeFacts,
};
use super::planned::Planned;
use crate::design::{self, Outlook, TimeByKind, VolumeSigma};
use crate::identify::{self, Answer, Asked};
use crate::machine::{Axis, Machine};
use crate::report::analysis::cautions::DETERMINED;
use crate::report::analysis::gather::{ball_bar_facts, machine_facts};
use crate::report::analysis::machine_errors::{ARCSEC_PER_RAD, MachineErrors};
use crate::report::analysis::means::MeanResult;
use crate::report::analysis::place;
use crate::report::text::numbers::finite;

/// Name and version of the format.
const FORMAT: &str = "ballbar.plan/1";

/// Makes a spread of the standard deviation of one test.
#[derive(Clone, Copy)]
struct Repeated {
    repeats: u32,
}

impl Repeated {
    fn spread(self, of_one: Option<f64>) -> Spread {
        let of_one = of_one.and_then(finite);
        let of_mean = of_one.map(|sigma| sigma / f64::from(self.repeats).sqrt());
        Spread { of_one, of_mean }
    }

    /// All repeats: the balls are set up once a mounting, the bar is fitted each time.
    fn time(self, time: &TimeByKind, set_up_s: f64) -> TimeByKind {
        let times = f64::from(self.repeats);
        TimeByKind {
            arcs_s: time.arcs_s * times,
            transits_s: time.transits_s * times,
            other_feed_s: time.other_feed_s * times,
            dwell_s: time.dwell_s * times,
            rapid_s: time.rapid_s * times,
            operator_s: set_up_s + (time.operator_s - set_up_s) * times,
            stops: time.stops * self.repeats as usize,
        }
    }
}

impl PlanReport {
    /// Gathers what is told of tests that are run so many times each, at least once.
    pub fn new(planned: &[Planned], repeats: u32) -> Self {
        let repeated = Repeated { repeats: repeats.max(1) };
        let tests: Vec<TestOutlook> =
            planned.iter().map(|planned| test_outlook(planned, repeated)).collect();
        Self {
            format: FORMAT,
            program_version: env!("CARGO_PKG_VERSION"),
            repeats: repeated.repeats,
            side_by_side: tests.iter().map(|test| comparison(test, repeated)).collect(),
            tests,
        }
    }
}

fn test_outlook(planned: &Planned, repeated: Repeated) -> TestOutlook {
    let Planned { test, machine, outlook } = planned;
    let parameters = parameters(outlook, repeated);
    let time = outlook.time();
    let set_up_s = outlook.operator.set_up_s * outlook.mountings.len() as f64;
    let unseen = outlook.unseen.iter().map(|unseen| UnseenTerm {
        name: unseen.name.clone(),
        reason: unseen.reason.clone(),
        remedies: unseen.remedies.clone(),
    });
    let bar_um_m = place::bar_um_m(test);
    let places = outlook.at_the_place.iter().map(|a| at_the_place(a, repeated, bar_um_m));
    let mut told = TestOutlook {
        name: outlook.name.clone(),
        file: test.file().display().to_string(),
        sha256: test.hash().to_owned(),
        machine: machine_facts(machine),
        ball_bar: ball_bar_facts(&outlook.bar),
        correlated_um: outlook.bar.correlated_mm * 1e3,
        correlation_s: outlook.bar.correlation_s,
        strategy: outlook.strategy,
        feed_mm_min: outlook.feeds_mm_s.first().map_or(0.0, |feed| feed * 60.0),
        feeds_mm_min: outlook.feeds_mm_s.iter().map(|feed| feed * 60.0).collect(),
        operator: OperatorFacts {
            set_up_min: outlook.operator.set_up_s / 60.0,
            fit_bar_min: outlook.operator.fit_bar_s / 60.0,
            stop_s: outlook.operator.stop_s,
        },
        mountings: outlook.mountings.iter().map(|m| mounting(m, machine)).collect(),
        time: time_facts(&time),
        time_of_repeats: time_facts(&repeated.time(&time, set_up_s)),
        samples: outlook.mountings.iter().map(|mounting| mounting.samples).sum(),
        sight: sight(outlook, &test.estimation().terms, &parameters),
        at_the_place: places.collect(),
        machine_errors: machine_errors(machine, &parameters, repeated),
        parameters,
        volume_noise: volume(&outlook.volume_noise, repeated),
        // More of the same test tells no more of what it does not see.
        volume_unseen: volume(&outlook.volume_unseen, Repeated { repeats: 1 }),
        unknown_um: outlook.unknown_mm * 1e3,
        unseen: unseen.collect(),
        cautions: Vec::new(),
    };
    told.cautions = cautions::of(&told, test.estimation().minimum_norm);
    told
}

fn mounting(outlook: &design::MountingOutlook, machine: &Machine) -> MountingOutlook {
    let path = &outlook.program.path;
    let transits = path.legs.iter().filter(|leg| leg.transit).count();
    let travel = Axis::ALL.map(|axis| {
        let [low, high] = outlook.used_mm[axis.index()];
        let limits_mm = machine.slide(axis).travel_mm;
        let margin_mm = (low - limits_mm[0]).min(limits_mm[1] - high);
        TravelFacts { axis: axis.letter(), used_mm: [low, high], limits_mm, margin_mm }
    });
    let clearance = outlook.clearance.as_ref().map(|least| ClearanceFacts {
        clearance_mm: least.clearance_mm,
        part: least.part.to_string(),
        section: least.section.clone(),
        ball_mm: least.ball_mm.map(|mm| mm + 0.0).into(),
    });
    MountingOutlook {
        name: outlook.named.name.clone(),
        program: outlook.program.file_name.clone(),
        coincidence_mm: outlook.named.mounting.coincidence_mm.into(),
        tool_ball_mm: outlook.named.mounting.tool_ball_mm.into(),
        bar_length_mm: outlook.named.bar_length_mm,
        arcs: path.legs.len() - transits,
        transits,
        arcs_mm: outlook.arcs_mm,
        transits_mm: outlook.transits_mm,
        samples: outlook.samples,
        time: time_facts(&outlook.time),
        travel: travel.to_vec(),
        clearance,
    }
}

fn time_facts(time: &TimeByKind) -> TimeFacts {
    TimeFacts {
        arcs_s: time.arcs_s,
        transits_s: time.transits_s,
        other_feed_s: time.other_feed_s,
        dwell_s: time.dwell_s,
        rapid_s: time.rapid_s,
        machine_s: time.machine_s(),
        operator_s: time.operator_s,
        total_s: time.total_s(),
        stops: time.stops,
    }
}

fn parameters(outlook: &Outlook, repeated: Repeated) -> Vec<ParameterOutlook> {
    let prediction = &outlook.prediction;
    let numbers = prediction.sigmas.iter().zip(&prediction.observed);
    let parameters = prediction.parameters.iter().zip(numbers);
    parameters
        .map(|(parameter, (sigma, observed))| ParameterOutlook {
            name: parameter.name.clone(),
            unit: parameter.unit,
            sigma: repeated.spread(Some(*sigma)),
            observed: observed.clamp(0.0, 1.0),
        })
        .collect()
}

fn sight(outlook: &Outlook, asked: &[String], parameters: &[ParameterOutlook]) -> SightFacts {
    let determined = parameters.iter().filter(|p| p.observed >= DETERMINED);
    let names: Vec<String> = determined.map(|p| p.name.clone()).collect();
    let (coefficients, set_up_errors) = identify::count(&names);
    SightFacts {
        asked: asked.to_vec(),
        chosen: outlook.chosen,
        coefficients,
        set_up_errors,
        parameter_count: parameters.len(),
        ideal_rank: outlook.ideal_rank,
        rank: outlook.prediction.rank,
        condition: finite(outlook.prediction.condition),
        worst_time_sigma_ms: outlook.prediction.worst_time_sigma_s * 1e3,
    }
}

/// What is asked is known to the mean of the repeats by the noise; what a test leaves open, repeats leave open.
fn at_the_place(answer: &Answer, repeated: Repeated, bar_um_m: Option<f64>) -> ForeseenPlace {
    let (unit, factor) = answer.asked.unit();
    let open = |all: f64| (all.powi(2) - answer.noise.powi(2)).max(0.0).sqrt();
    let of_mean = answer.noise / f64::from(repeated.repeats).sqrt();
    let all = answer.all.and_then(|all| finite(of_mean.hypot(open(all)) * factor));
    let of_scale = bar_um_m.filter(|_| matches!(answer.asked, Asked::Scale(_)));
    let (all, looks_like) =
        place::beside_bar(of_scale, of_mean * factor, all, place::looks_like(answer));
    ForeseenPlace {
        quantity: answer.asked.name(),
        unit,
        noise: repeated.spread(finite(answer.noise * factor)),
        all,
        looks_like,
    }
}

/// The words and conventions are those of an analysis, with nothing measured yet.
fn machine_errors(
    machine: &Machine,
    parameters: &[ParameterOutlook],
    repeated: Repeated,
) -> ForeseenErrors {
    let means: Vec<MeanResult> = parameters
        .iter()
        .map(|parameter| MeanResult {
            name: parameter.name.clone(),
            unit: parameter.unit,
            mean: 0.0,
            deviation: None,
            sigma: parameter.sigma.of_one,
            observed: parameter.observed,
        })
        .collect();
    let errors = MachineErrors::new(machine, &means);
    let times = |sigma: Option<f64>, factor: f64| repeated.spread(sigma.map(|s| s * factor));
    let squareness = errors.squareness.into_iter().map(|s| ForeseenSquareness {
        name: s.name,
        symbol: s.symbol,
        axes: s.axes,
        sigma_um_m: times(s.sigma_um_m, 1.0),
        sigma_arcsec: times(s.sigma_um_m, 1e-6 * ARCSEC_PER_RAD),
        observed: s.observed,
    });
    let scale = errors.scale.into_iter().map(|s| ForeseenScale {
        name: s.name,
        sigma_um_m: times(s.sigma_um_m, 1.0),
        observed: s.observed,
    });
    let reversal = errors.reversal.into_iter().map(|r| ForeseenReversal {
        name: r.name,
        kind: r.kind,
        step_sigma_um: times(r.sigma_um, 2.0),
        observed: r.observed,
    });
    let angular = errors.angular_hysteresis.into_iter().map(|h| ForeseenHysteresis {
        name: h.name,
        step_sigma_urad: times(h.sigma_urad, 2.0),
        observed: h.observed,
    });
    ForeseenErrors {
        squareness: squareness.collect(),
        scale: scale.collect(),
        reversal: reversal.collect(),
        angular_hysteresis: angular.collect(),
    }
}

fn volume(sigma: &VolumeSigma, repeated: Repeated) -> VolumeFacts {
    let grid_mm = [0, 1, 2].map(|axis| {
        let mut along: Vec<f64> = sigma.points.iter().map(|p| p.position_mm[axis]).collect();
        along.sort_by(f64::total_cmp);
        along.dedup();
        along
    });
    VolumeFacts {
        grid_mm,
        sigma_um: sigma.points.iter().map(|point| point.sigma_mm * 1e3).collect(),
        rms_um: repeated.spread(Some(sigma.rms_mm * 1e3)),
        worst_at_mm: sigma.worst.position_mm.into(),
        worst_um: repeated.spread(Some(sigma.worst.sigma_mm * 1e3)),
    }
}

fn comparison(test: &TestOutlook, repeated: Repeated) -> Comparison {
    let errors = &test.machine_errors;
    let known = |observed: f64, sigma: Spread| {
        if observed < DETERMINED { repeated.spread(None) } else { sigma }
    };
    let backlash = errors.reversal.iter().filter(|r| r.kind == "backlash");
    let worst = backlash.filter_map(|r| known(r.observed, r.step_sigma_um).of_one);
    Comparison {
        test: test.name.clone(),
        strategy: test.strategy,
        mountings: test.mountings.len(),
        total_s: test.time_of_repeats.total_s,
        machine_s: test.time_of_repeats.machine_s,
        samples: test.samples,
        coefficients: test.sight.coefficients,
        condition: test.sight.condition,
        squareness: errors
            .squareness
            .iter()
            .map(|s| ComparedSquareness {
                axes: s.axes,
                sigma_um_m: known(s.observed, s.sigma_um_m),
            })
            .collect(),
        worst_backlash_um: repeated.spread(worst.reduce(f64::max)),
        volume_rms_um: test.volume_noise.rms_um,
        volume_worst_um: test.volume_noise.worst_um,
        unseen_rms_um: test.volume_unseen.rms_um.of_one,
    }
}
