//! From identified runs to [`CircularFacts`].

use super::conformity;
use super::facts::{CircularFacts, CircularResult, CircularValue, WayResult};
use crate::circular::{CircularTest, Driven, Filter, Found};
use crate::error::Result;
use crate::plan::Test;
use crate::report::analysis::place::PlaceResult;
use crate::report::text::numbers::{finite, fixed};

impl CircularFacts {
    /// Gathers the circular tests of repeats, each with its number.
    pub(in crate::report) fn new(
        test: &Test,
        repeats: &[(u32, Result<Driven>)],
        at_the_place: &[PlaceResult],
    ) -> Self {
        let mut tests = Vec::new();
        let mut untold: Vec<String> = Vec::new();
        for (repeat, driven) in repeats {
            match driven {
                Ok(Driven { tests: of_repeat, untold: without }) => {
                    tests.extend(of_repeat.iter().map(|of| result(test, *repeat, of)));
                    untold.extend(without.iter().map(|arc| format!("{} {}.", arc.arc, arc.why)));
                }
                Err(error) => untold.push(format!("Repeat {repeat}: {}.", error.what)),
            }
        }
        let conformity = conformity::of(
            test.tolerance(),
            &tests,
            at_the_place,
            test.ball_bar().length_sigma_mm.is_some(),
        );
        Self { tests, untold, conformity }
    }
}

/// A circular test in plain numbers.
pub(in crate::report) fn result(test: &Test, repeat: u32, of: &CircularTest) -> CircularResult {
    let mounting = test.mountings().get(of.mounting);
    let length_um = test.ball_bar().length_sigma_mm.map(|sigma_mm| sigma_mm * 1e3);
    let scale = test.ball_bar().scale_sigma;
    // A range does not know the length of the bar.
    let range = |found: Found| value(found, scale, Some(0.0));
    let length = |found: Found| value(found, scale, length_um);
    let ways = of.ways.iter().map(|way| WayResult {
        direction: way.direction,
        run: way.run.clone(),
        arc: way.arc.clone(),
        start_deg: way.start_rad.to_degrees(),
        points: way.points,
        rejected: way.rejected,
        largest_gap_deg: way.gap_rad.to_degrees(),
        circular_deviation: range(way.circular),
        circular_deviation_least_squares: range(way.circular_by_squares),
        radial_deviation_max: way.radial.map(|[max, _]| length(max)),
        radial_deviation_min: way.radial.map(|[_, min]| length(min)),
    });
    CircularResult {
        repeat,
        mounting: mounting.map_or_else(String::new, |mounting| mounting.name.clone()),
        circle: match mounting {
            Some(mounting) if test.mountings().len() > 1 => {
                format!("{}, {}", of.circle.name(), mounting.name)
            }
            _ => of.circle.name(),
        },
        diameter_mm: 2.0 * of.radius_mm,
        feed_mm_min: of.feed_mm_s * 60.0,
        centre_mm: mounting.map_or([0.0; 3], |m| m.mounting.coincidence_mm.into()),
        sweep_deg: of.sweep_rad.to_degrees(),
        whole: of.whole,
        centre_condition: finite(of.centre_condition),
        filter: filter(of.filter, of.feed_mm_s),
        ways: ways.collect(),
        bidirectional_circular_deviation: of.bidirectional.map(|[zone, _]| range(zone)),
        bidirectional_circular_deviation_least_squares: of.bidirectional.map(|[_, by]| range(by)),
        mean_bidirectional_radial_deviation: of.mean_radial.map(length),
        circular_hysteresis: of.hysteresis.map(range),
    }
}

/// With a wrong scale of the transducer every deviation from a circle is larger by the same share, and so are these values.
fn value(found: Found, scale: f64, length_um: Option<f64>) -> CircularValue {
    let noise_um = found.noise_mm * 1e3;
    CircularValue {
        value_um: found.value_mm * 1e3 + 0.0,
        noise_um,
        widened_um: found.widened_mm * 1e3 + 0.0,
        sigma_um: length_um
            .map(|length_um| noise_um.hypot(length_um).hypot(scale * found.value_mm * 1e3)),
    }
}

fn filter(of: Filter, feed_mm_s: f64) -> String {
    let hz = of.readings as f64 / of.period_s;
    if of.readings <= 1 {
        return format!("none, single readings at {} Hz", fixed(hz, 0));
    }
    format!(
        "mean of {} readings of {} Hz, {} ms or {} mm of the path",
        of.readings,
        fixed(hz, 0),
        fixed(of.period_s * 1e3, 0),
        fixed(of.period_s * feed_mm_s, 2)
    )
}
