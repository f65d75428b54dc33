//! Machines and tests drawn at random, as files: kinds, travels, dialects, decimals, feeds, bars, mountings, arcs.

use std::fmt::Write as _;

use ballbar::machine::Dialect;
use rand::RngExt;
use rand::seq::IndexedRandom;
use rand_pcg::Pcg64Mcg;

/// A number between two others, rounded to a decimal as people write it.
fn between(random: &mut Pcg64Mcg, low: f64, high: f64) -> f64 {
    (random.random_range(low..high) * 10.0).round() / 10.0
}

fn one_of<T: Copy>(random: &mut Pcg64Mcg, of: &[T]) -> T {
    *of.choose(random).expect("something to choose from")
}

/// A machine file, and the travel of its three axes.
pub(crate) fn machine(random: &mut Pcg64Mcg) -> (String, [[f64; 2]; 3]) {
    let topology = one_of(
        random,
        &["wCBXFZYSt", "wXYFZSt", "wYXFZSt", "wXFYZSt", "wFXYZSt", "wYFXZSt", "wAXFYZSt"],
    );
    let mut source = format!("name = \"Drawn\"\ntopology = \"{topology}\"\n");
    let mut travel_mm = [[0.0; 2]; 3];
    for (axis, travel_mm) in ["X", "Y", "Z"].into_iter().zip(&mut travel_mm) {
        let length_mm = between(random, 250.0, 1200.0);
        // The zero at one end, at the other, or somewhere.
        let from_mm = match random.random_range(0..4) {
            0 => 0.0,
            1 => -length_mm,
            _ => between(random, -length_mm, 0.0),
        };
        *travel_mm = [from_mm, from_mm + length_mm];
        let _ = write!(
            source,
            "[axes.{axis}]\ntravel_mm = [{from_mm:.3}, {:.3}]\nrapid_mm_min = {:.1}\nacceleration_mm_s2 = 1000.0\n",
            travel_mm[1],
            between(random, 3000.0, 50_000.0),
        );
        if axis == "Z" && random.random_bool(0.3) {
            let retract_mm = travel_mm[1] - between(random, 0.0, 0.3 * length_mm);
            let _ = writeln!(source, "retract_mm = {retract_mm:.3}");
        }
    }
    let dialect = one_of(
        random,
        &[
            Dialect::Fanuc,
            Dialect::Fanuc,
            Dialect::LinuxCnc,
            Dialect::Siemens,
            Dialect::Siemens,
            Dialect::Heidenhain,
            Dialect::Heidenhain,
        ],
    );
    let tnc = dialect == Dialect::Heidenhain;
    let _ = write!(
        source,
        "[controller]\ndialect = \"{}\"\ndecimals = {}\nsequence_step = {}\n",
        dialect.name(),
        random.random_range(2..if tnc { 5_usize } else { 7 }),
        one_of(random, &[0, 1, 10, 1000]),
    );
    let looks: &[[&str; 2]] = match dialect {
        Dialect::Fanuc => {
            &[["G05.1 Q1", "G05.1 Q0"], ["G08 P1", "G08 P0"], ["G05 P10000", "G05 P0"]]
        }
        Dialect::Siemens => &[["FFWON SOFT", "FFWOF BRISK"], ["FFWON", "FFWOF"]],
        Dialect::LinuxCnc | Dialect::Heidenhain => &[],
    };
    if !looks.is_empty() && random.random_bool(0.4) {
        let [on, off] = one_of(random, looks);
        let _ = write!(source, "look_ahead_on = \"{on}\"\nlook_ahead_off = \"{off}\"\n");
    }
    if matches!(dialect, Dialect::Fanuc | Dialect::LinuxCnc) && random.random_bool(0.3) {
        let _ = writeln!(source, "memory_kb = {:.1}", between(random, 3.0, 30.0));
    }
    if random.random_bool(0.5) {
        source.push_str(
            "[clearance.tool]\ndiameter_mm = 20.0\nlength_mm = 120.0\n\
             [clearance.spindle_nose]\ndiameter_mm = 110.0\nlength_mm = 150.0\n\
             [clearance.support]\ndiameter_mm = 25.0\nlength_mm = 70.0\n",
        );
    }
    (source, travel_mm)
}

/// A test file for a machine of this travel.
pub(crate) fn test(random: &mut Pcg64Mcg, travel_mm: &[[f64; 2]; 3], dialect: Dialect) -> String {
    // Those that the control has, and now and then another.
    let offsets = match dialect {
        Dialect::Fanuc | Dialect::LinuxCnc => 54..60_u8,
        Dialect::Siemens => 54..58 + u8::from(random.random_bool(0.05)),
        Dialect::Heidenhain => 54..55 + u8::from(random.random_bool(0.02)),
    };
    let range_mm = one_of(random, &[1.2, 1.2, 0.5, 2.0]);
    let length_mm = one_of(random, &[50.0, 100.0, 150.0, 150.0, 250.0, 87.3]);
    let mut source = format!(
        "name = \"Drawn\"\nmachine = \"m.toml\"\n[ball_bar]\nlength_mm = {length_mm:.3}\nrange_mm = {range_mm:.3}\n"
    );
    let names = ["A", "B", "C"];
    let mountings = random.random_range(1..=3_usize);
    for name in &names[..mountings] {
        // Where the sphere has a chance to fit, or anywhere.
        let anywhere = random.random_bool(0.1);
        let mut place = |axis: usize, below_mm: f64| {
            let [low, high] = travel_mm[axis];
            let (low, high) = (low + below_mm, high - length_mm - 25.0);
            if anywhere || low >= high {
                between(random, travel_mm[axis][0], travel_mm[axis][1])
            } else {
                between(random, low, high)
            }
        };
        let at = [place(0, length_mm + 25.0), place(1, length_mm + 25.0), place(2, 30.0)];
        let _ = write!(
            source,
            "[[mounting]]\nname = \"{name}\"\ncoincidence_mm = [{:.3}, {:.3}, {:.3}]\ntool_ball_mm = [0.0, 0.0, -180.0]\n",
            at[0], at[1], at[2]
        );
        let _ = writeln!(source, "work_offset = \"G{}\"", random.random_range(offsets.clone()));
        if random.random_bool(0.3) {
            let _ = writeln!(source, "bar_length_mm = {:.1}", between(random, 40.0, length_mm));
        }
    }
    source.push_str("[plan]\n");
    let _ = write!(
        source,
        "feed_mm_min = {}\nchord_sag_um = {:.1}\ndwell_s = {:.1}\nsettle_s = {:.1}\nboth_directions = {}\nstop_between_arcs = {}\nprogram_number = {}\n",
        feeds(random),
        between(random, 10.0, 100.0),
        between(random, 0.1, 6.0),
        between(random, 0.1, 6.0),
        random.random_bool(0.6),
        random.random_bool(0.2),
        random.random_range(1..7000_u32),
    );
    if random.random_bool(0.5) {
        let more_mm = one_of(random, &[0.001, 0.02, 0.1, 1.0, 3.0, 10.0]);
        let _ = writeln!(source, "feed_in_mm = {:.3}", range_mm + more_mm);
    }
    if random.random_bool(0.3) {
        let release = random.random_bool(0.5);
        let _ = writeln!(source, "release_between_arcs = {release}");
    }
    if random.random_bool(0.3) {
        let _ = writeln!(source, "interpolation = \"{}\"", one_of(random, &["arcs", "chords"]));
    }
    let strategy = random.random_bool(0.7);
    if strategy && random.random_bool(0.6) {
        planes(random, &mut source);
    } else if strategy {
        let name = one_of(random, &["2d", "3d5", "3d6", "3d10"]);
        let _ = writeln!(source, "strategy = \"{name}\"");
    }
    let arcs =
        if strategy { usize::from(random.random_bool(0.2)) } else { random.random_range(1..4) };
    for _ in 0..arcs {
        arc(random, &mut source);
    }
    source
}

/// One feed, or two.
fn feeds(random: &mut Pcg64Mcg) -> String {
    let slow = one_of(random, &[1.0, 50.0, 500.0, 500.0, 1000.0, 2000.0, 7000.0, 20_000.0]);
    if random.random_bool(0.7) {
        return format!("{slow:.1}");
    }
    let other = slow + between(random, -0.5 * slow, 2000.0).max(0.1);
    let [first, second] = if random.random_bool(0.5) { [slow, other] } else { [other, slow] };
    format!("[{first:.1}, {second:.1}]")
}

/// Circles in planes: what everybody drives, and what nobody has thought of.
fn planes(random: &mut Pcg64Mcg, source: &mut String) {
    let name = one_of(random, &["xy", "yz", "zx", "iso230-4"]);
    let _ = writeln!(source, "strategy = \"{name}\"");
    if random.random_bool(0.6) {
        let any_deg = between(random, 1.0, 360.0);
        let sweep_deg = one_of(random, &[360.0, 220.0, 180.0, 90.0, 1.0, 359.9, any_deg]);
        let _ = writeln!(source, "sweep_deg = {sweep_deg:.1}");
    }
    if random.random_bool(0.4) {
        let any_deg = between(random, -360.0, 360.0);
        let start_deg = one_of(random, &[0.0, 45.0, 90.0, 180.0, -90.0, any_deg]);
        let _ = writeln!(source, "start_deg = {start_deg:.1}");
    }
    if random.random_bool(0.5) {
        let any_deg = between(random, 0.0, 720.0);
        let overshoot_deg = one_of(random, &[0.0, 0.1, 2.0, 45.0, 180.0, 360.0, any_deg]);
        let _ = writeln!(source, "overshoot_deg = {overshoot_deg:.1}");
    }
}

fn arc(random: &mut Pcg64Mcg, source: &mut String) {
    let azimuth_deg = between(random, -180.0, 180.0);
    let _ = match random.random_range(0..5) {
        0 => write!(
            source,
            "[[plan.arc]]\nkind = \"equator\"\nazimuth_deg = {azimuth_deg:.1}\nsweep_deg = {:.1}\n",
            one_of(random, &[360.0, -360.0, 90.0, -200.0])
        ),
        1 => write!(
            source,
            "[[plan.arc]]\nkind = \"parallel\"\npolar_deg = {:.1}\nazimuth_deg = {azimuth_deg:.1}\n",
            between(random, 5.0, 100.0)
        ),
        2 => write!(
            source,
            "[[plan.arc]]\nkind = \"circle\"\nstart = [1.0, 0.0, 0.2]\nnormal = [-0.2, {:.1}, 1.0]\nsweep_deg = {:.1}\n",
            between(random, -0.5, 0.5),
            between(random, 20.0, 300.0)
        ),
        _ => write!(
            source,
            "[[plan.arc]]\nkind = \"meridian\"\nazimuth_deg = {azimuth_deg:.1}\nstart_deg = {:.1}\nsweep_deg = {:.1}\n",
            between(random, -20.0, 60.0),
            between(random, 10.0, 120.0)
        ),
    };
}
