//! What noise does to numbers is what they say it may do, also where the fit follows it.

use crate::lag::{three_planes, told_of};

/// Arcs of 15 s, and noise that hangs together for a second: the fit takes out of it more than half, and moves by that. Reversals and
/// lateral plays, which nothing but noise moves, err by what is stated.
#[test]
fn noise_that_lasts_is_stated_though_little_of_it_is_left() {
    let mut squares = Vec::new();
    for (rate, seeds) in [("10.0", 0..8), ("250.0", 8..12)] {
        for seed in seeds {
            let work = three_planes("2450.");
            work.write(
                "noisy.toml",
                format!("sample_rate_hz = {rate}\nresolution_um = 1.0\n[noise]\nwhite_um = 0.0\ncorrelated_um = 0.24\ncorrelation_s = 1.0\n"),
            );
            let seed = seed.to_string();
            work.ballbar(&["simulate", "test.toml", "--scenario", "noisy.toml", "--seed", &seed])
                .done();
            let (told, truth) = told_of(&work);
            for of in told["at_the_place"].as_array().unwrap() {
                let quantity = of["quantity"].as_str().unwrap();
                let key = format!("{}_um", quantity.replace(' ', "_"));
                let Some(truth) = truth["at_the_place"].get(&key) else { continue };
                let off = of["value"].as_f64().unwrap() - truth.as_float().unwrap();
                let sigma = of["noise"].as_f64().unwrap();
                println!("{rate} {seed} {quantity} {off:.3} {sigma:.3}");
                squares.push((off / sigma).powi(2));
            }
        }
    }
    assert_eq!(squares.len(), 12 * 9);
    // Some five numbers of a campaign are independent: 60 tell an rms to 9 %.
    let rms = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
    assert!((0.75..1.25).contains(&rms), "{rms}");
}
