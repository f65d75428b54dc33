//! Whatever somebody begins with can be planned, and its program is safe.

use std::path::Path;

use super::reference::Reference;
use super::{Begun, TestKind, Travel, Wish, Zero};
use crate::design::PlannedProgram;
use crate::machine::{Builtin, Dialect, Topology};
use crate::plan::{Planes, Strategy};

/// All orders of X, Y and Z, with the machine frame anywhere among them.
fn topologies() -> Vec<Topology> {
    let orders = ["XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX"];
    let frames = |order: &'static str| {
        (0..=3).map(move |at| {
            let (workpiece, tool) = order.split_at(at);
            Topology::parse(&format!("w{workpiece}F{tool}St")).unwrap()
        })
    };
    orders.into_iter().flat_map(frames).collect()
}

#[track_caller]
fn begins(wish: &Wish) -> Begun {
    let what = || {
        let (topology, dialect) = (wish.topology.as_str(), wish.dialect.name());
        format!("{}, {topology}, {dialect}, {}", wish.name, wish.test.name())
    };
    let begun = Begun::new(wish, Path::new("")).unwrap_or_else(|e| unreachable!("{}: {e}", what()));
    assert_eq!(begun.machine.topology(), &wish.topology);
    assert_eq!(begun.machine.controller().dialect, wish.dialect);
    let program = PlannedProgram::new(&begun.test, &begun.machine, 0).unwrap();
    let objections = program.objections(&begun.test, &begun.machine).unwrap();
    assert!(objections.is_empty(), "{}: {objections:?}", what());
    begun
}

#[test]
fn every_machine_topology_test_and_dialect_is_planned_and_its_program_is_safe() {
    let mut count = 0;
    for machine in Builtin::ALL {
        for test in TestKind::all() {
            let wish = Wish::of(machine, test).unwrap();
            let own = [wish.topology.clone()];
            for dialect in Dialect::ALL {
                // What the order of the slides changes is the same for all strategies of a kind.
                let every = matches!(
                    test,
                    TestKind::Planes(Planes::Iso230) | TestKind::Sphere(Strategy::TwoD)
                );
                let topologies = if every { topologies() } else { own.to_vec() };
                for topology in topologies {
                    begins(&Wish { topology, dialect, ..wish.clone() });
                    count += 1;
                }
            }
        }
    }
    assert_eq!(count, 3 * 4 * (7 + 2 * 24), "a kind of test or a topology is left out");
}

#[test]
fn travels_of_a_small_machine_take_a_short_bar_and_none_too_small_is_begun_with() {
    let wish = Wish::of(Builtin::ALL[0], TestKind::Planes(Planes::Iso230)).unwrap();
    let with = |lengths: &str, zero: Zero| {
        let travel_mm = Travel::parse(lengths).unwrap().map(|travel| travel.between_mm(zero));
        Wish { travel_mm, ..wish.clone() }
    };
    for zero in Zero::ALL {
        for (lengths, bar_mm) in
            [("762,406,508", 150), ("400,330,400", 150), ("300,270,300", 100), ("200,170,250", 50)]
        {
            let begun = begins(&with(lengths, zero));
            let found_mm = begun.test.ball_bar().length_mm.round() as i64;
            assert_eq!(found_mm, bar_mm, "{lengths} {}", zero.name());
        }
    }
    let small = Begun::new(&with("100,100,100", Zero::Upper), Path::new("")).unwrap_err();
    assert!(small.what.contains("of axis"), "{small}");
    let long = Wish { bar_mm: Some(600.0), ..wish.clone() };
    let long = Begun::new(&long, Path::new("")).unwrap_err();
    assert!(long.hint.unwrap().contains("a shorter `--bar`"));
    let none = Wish { bar_mm: Some(1.0), ..wish };
    assert!(Begun::new(&none, Path::new("")).unwrap_err().what.contains("`length_mm` must lie"));
}

/// What is taken over from a built-in machine is the machine, and every key that the reference knows stands there.
#[test]
fn the_machine_file_is_the_machine_and_has_every_key_with_its_meaning() {
    for machine in Builtin::ALL {
        let wish = Wish::of(machine, TestKind::Planes(Planes::Xy)).unwrap();
        let begun = begins(&wish);
        let base = &wish.base;
        for axis in crate::machine::Axis::ALL {
            assert_eq!(begun.machine.slide(axis), base.slide(axis));
        }
        assert_eq!(begun.machine.controller(), base.controller());
        assert_eq!(begun.machine.clearance(), base.clearance());
        assert_eq!(begun.machine.plausible(), base.plausible());
        let keys = Reference::get().entries().iter().filter(|e| e.section == "Machine file");
        for key in keys.flat_map(|entry| &entry.names).filter(|name| !name.starts_with('[')) {
            if key == "cancel_blocks" && wish.dialect.usual_options().is_empty() {
                continue;
            }
            assert!(begun.machine_text.contains(&format!("{key} = ")), "{key}");
        }
        for text in [&begun.machine_text, &begun.test_text] {
            assert!(text.is_ascii() && text.lines().all(|line| line.len() <= 120), "{text}");
            for line in text.lines().filter(|line| line.contains(" = ")) {
                assert!(line[1..].contains('#') || line.len() >= 38, "no comment: {line}");
            }
        }
    }
}

/// An example that is taken at its word is right: without the mark every line is a key that can be read.
#[test]
fn the_examples_of_keys_that_may_be_left_out_can_be_read() {
    let kinds = [TestKind::Planes(Planes::Yz), TestKind::Design];
    for (machine, test) in Builtin::ALL.into_iter().zip(kinds.into_iter().cycle()) {
        let begun = begins(&Wish::of(machine, test).unwrap());
        let with_examples = |text: &str| {
            let lines = text.lines().map(|line| match line.strip_prefix("# ") {
                Some(example) if example.starts_with('[') || is_key(example) => example,
                _ => line,
            });
            lines.collect::<Vec<_>>().join("\n")
        };
        let machine = with_examples(&begun.machine_text);
        assert!(machine.matches("\nretract_mm").count() == 1, "{machine}");
        crate::machine::Machine::parse(&machine, "machine.toml".as_ref()).unwrap();
        let test = with_examples(&begun.test_text);
        assert!(test.contains("\nlog = "), "{test}");
        crate::plan::Test::parse(&test, "test.toml".as_ref()).unwrap();
    }
}

/// A word, then an equals sign.
fn is_key(line: &str) -> bool {
    line.split_once(" = ").is_some_and(|(key, _)| !key.contains(' '))
}
