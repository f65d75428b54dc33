//! A log that is in no file: times and readings as another program holds them.

use std::path::Path;

use super::bounds::{LARGEST_DEVIATION_MM, LATEST_S, MOST_READINGS};
use super::reading::{Log, Reading};
use crate::error::{Error, Result};
use crate::plan::log_format::LengthUnit;

impl Log {
    /// A log of times on the instrument's clock and of deviations, NaN where the bar was out of range. The name stands
    /// for a file in messages, and a reading is counted from 1 like a line.
    ///
    /// # Errors
    /// Where the two are not of equal length, or there are fewer than two; where a time is no number or does not come
    /// after the one before; where a deviation is more than any bar reads, or none is a number.
    pub fn of_columns(name: &Path, time_s: &[f64], deviation_um: &[f64]) -> Result<Self> {
        if time_s.len() != deviation_um.len() {
            return Err(Error::input(format!(
                "{} times and {} deviations",
                time_s.len(),
                deviation_um.len()
            ))
            .hint(
                "every reading has a time; where the bar was out of range, its deviation is NaN",
            ));
        }
        if !(2..=MOST_READINGS).contains(&time_s.len()) {
            return Err(Error::input(format!("a log of {} readings", time_s.len()))
                .hint(format!("a log has 2 to {MOST_READINGS}")));
        }
        let mut readings = Vec::with_capacity(time_s.len());
        let mut before_s = f64::NEG_INFINITY;
        for (index, (&time_s, &um)) in time_s.iter().zip(deviation_um).enumerate() {
            let line = index + 1;
            if time_s.is_nan() || time_s.abs() > LATEST_S {
                return Err(Error::input(format!("time {line} is {time_s} s")).hint(format!(
                    "times are numbers from -{LATEST_S} to {LATEST_S}, in seconds"
                )));
            }
            if time_s <= before_s {
                return Err(Error::input(format!(
                    "time {line} is {time_s} s and does not come after the one before, {before_s} s"
                ))
                .hint("times increase; several runs are several logs"));
            }
            before_s = time_s;
            let deviation_mm = (!um.is_nan()).then(|| LengthUnit::Micrometre.to_mm(um));
            if let Some(mm) = deviation_mm.filter(|mm| mm.abs() > LARGEST_DEVIATION_MM) {
                return Err(Error::input(format!(
                    "deviation {line} is {um} um, {mm} mm, which no ball-bar reaches"
                ))
                .hint("deviations are length minus nominal length, in micrometres"));
            }
            readings.push(Reading { time_s, deviation_mm, line });
        }
        if readings.iter().all(|reading| reading.deviation_mm.is_none()) {
            return Err(Error::input("no deviation is a number").hint("was the bar engaged?"));
        }
        Ok(Self::new(name, readings, Vec::new()))
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Format, read_bytes};
    use super::*;

    #[test]
    fn the_log_of_columns_is_that_of_the_file_with_them() {
        let text = "time_s,deviation_um\n0.1,\n0.2,1.3\n0.4,-7.1\n";
        let file = read_bytes(text.as_bytes(), "a.csv".as_ref(), &Format::default()).unwrap();
        let columns =
            Log::of_columns("a".as_ref(), &[0.1, 0.2, 0.4], &[f64::NAN, 1.3, -7.1]).unwrap();
        let bare = |log: &Log| -> Vec<(u64, Option<u64>)> {
            let readings = log.readings().iter();
            readings.map(|r| (r.time_s.to_bits(), r.deviation_mm.map(f64::to_bits))).collect()
        };
        assert_eq!(bare(&columns), bare(&file));
        assert_eq!(columns.sample_period_s().to_bits(), file.sample_period_s().to_bits());
    }

    #[test]
    fn what_is_no_log_is_told_by_the_number_of_the_reading() {
        let told = |time_s: &[f64], um: &[f64]| {
            Log::of_columns("a".as_ref(), time_s, um).unwrap_err().what
        };
        assert_eq!(told(&[0.0, 1.0], &[0.0]), "2 times and 1 deviations");
        assert_eq!(told(&[0.0], &[0.0]), "a log of 1 readings");
        assert_eq!(told(&[], &[]), "a log of 0 readings");
        assert!(told(&[0.0, f64::NAN], &[0.0; 2]).starts_with("time 2 is NaN"));
        assert!(told(&[0.0, f64::INFINITY], &[0.0; 2]).starts_with("time 2 is inf"));
        assert!(told(&[0.0, 1.0, 1.0], &[0.0; 3]).starts_with("time 3 is 1 s and does not"));
        assert!(told(&[0.0, 1.0], &[0.0, 2e4]).starts_with("deviation 2 is 20000 um, 20 mm"));
        assert!(told(&[0.0, 1.0], &[0.0, f64::INFINITY]).starts_with("deviation 2"));
        assert_eq!(told(&[0.0, 1.0], &[f64::NAN; 2]), "no deviation is a number");
    }
}
