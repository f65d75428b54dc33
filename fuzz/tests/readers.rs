//! Every reader on its corpus and on mutated inputs, one test for each: see `fuzz/README.md`.

use ballbar_fuzz::targets::{ALL, Target};

fn target(name: &str) -> &'static Target {
    ALL.iter()
        .find(|target| target.name == name)
        .unwrap_or_else(|| panic!("there is no target {name}"))
}

macro_rules! readers {
    ($($name:ident),* $(,)?) => {
        $(
            #[test]
            fn $name() {
                ballbar_fuzz::campaign::run(target(stringify!($name)));
            }
        )*

        #[test]
        fn every_reader_has_a_test() {
            let tested = [$(stringify!($name)),*];
            assert!(ALL.iter().all(|target| tested.contains(&target.name)));
        }
    };
}

readers! {
    machine, test, scenario, model, effect, log, motion, workbook, b5r, program, check, plan, simulate, align, analysis, past, tables, files,
}
