//! A quantity over the days.

use jiff::civil::Date;

use crate::monitor::{Judged, Series};
use crate::report::draw::chart::{Axis, Chart};
use crate::report::draw::svg::text_width;
use crate::report::draw::ticks::enclosing;

const WIDTH: f64 = 520.0;
const HEIGHT: f64 = 210.0;

/// Values with their noise, the band of all that is not known about them, and the trend.
pub(super) fn over_time(series: &Series, first: Date, last: Date) -> String {
    let day = |date: Date| f64::from((date - first).get_days());
    let span = day(last).max(1.0);
    let noise = |noise: Option<f64>| noise.unwrap_or(0.0);
    let ends = series.points.iter().flat_map(|point| {
        let half = 2.0 * noise(point.noise);
        [point.value - half, point.value + half]
    });
    let drift = series.trend.filter(|trend| trend.judged == Judged::Changed);
    let line = drift.into_iter().flat_map(|trend| trend.line);
    let y = Axis::new(&series.unit.replace('u', "µ"), enclosing(ends.chain(line), 5));
    // A little air on both sides: a year of days is a chart of so many categories.
    let air = 0.04 * span;
    let width_days = (span + 2.0 * air).ceil();
    let mut chart = Chart::of_categories(WIDTH, HEIGHT, width_days as usize, y);
    let at = |date: Date| day(date) + air;
    let band = |sign: f64| {
        let ends = series.points.iter().filter_map(move |point| Some((point, point.all?)));
        ends.map(|(point, all)| (at(point.day), point.value + sign * all)).collect::<Vec<_>>()
    };
    chart.band(&band(-1.0), &band(1.0), "band grey");
    if let (Some(trend), [one, .., other]) = (drift, &series.points[..]) {
        let ends = [(at(one.day), trend.line[0]), (at(other.day), trend.line[1])];
        chart.line(&ends, "after");
    }
    let room = text_width("2026-11-23") + 12.0;
    let mut free = f64::NEG_INFINITY;
    for point in &series.points {
        let x = at(point.day);
        chart.error_bar(x, point.value, noise(point.noise));
        let place = chart.x_at(x);
        if place >= free && place + 0.5 * room < WIDTH {
            chart.below(x, &point.day.to_string());
            free = place + room;
        }
    }
    let dots: Vec<(f64, f64)> =
        series.points.iter().map(|point| (at(point.day), point.value)).collect();
    chart.dots(&dots, "reading");
    chart.title(&series.name);
    chart.finish(&format!("{} over time", series.name))
}
