//! The same files give the same bits, on every run and with every number of threads.

use std::process::Command;

use crate::chain::Set;

/// Every number of two identifications, bit by bit.
fn bits() -> String {
    let set = Set::read("hu40t");
    let mut numbers: Vec<f64> = Vec::new();
    for run in 0..2 {
        let found = set.identify(vec![set.run(run)]).unwrap();
        numbers.extend(found.estimates.iter().flat_map(|e| [e.value, e.sigma, e.observed]));
        numbers.push(found.condition);
        numbers.extend(found.runs[0].records.iter().map(|record| record.residual_mm));
        let map = &found.runs[0].alignment.time_map;
        numbers.extend([map.rate, map.rate_sigma]);
        numbers.extend(map.offsets_s.iter().chain(&map.offset_sigmas_s));
        numbers.push(found.rms_mm);
    }
    // FNV-1a over the bits; a difference anywhere changes it.
    let fold = |hash: u64, number: &f64| {
        number
            .to_bits()
            .to_le_bytes()
            .iter()
            .fold(hash, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3))
    };
    format!("{} numbers {:016x}", numbers.len(), numbers.iter().fold(0xcbf2_9ce4_8422_2325, fold))
}

/// Not a test by itself: the child process of the next one.
#[test]
#[ignore = "run by the_number_of_threads_does_not_change_a_bit"]
fn bits_of_a_child() {
    println!("BITS {}", bits());
}

#[test]
fn the_number_of_threads_does_not_change_a_bit() {
    let here = bits();
    assert_eq!(here, bits(), "twice in one process");
    for threads in ["1", "2"] {
        let output = Command::new(std::env::current_exe().unwrap())
            .args(["--exact", "determinism::bits_of_a_child", "--ignored", "--nocapture"])
            .env("RAYON_NUM_THREADS", threads)
            .output()
            .unwrap();
        let text = String::from_utf8(output.stdout).unwrap();
        let there = text.split_once("BITS ").unwrap().1.lines().next().unwrap();
        println!("{threads} thread(s): {there}");
        assert_eq!(here, there, "{threads} thread(s)");
    }
}
