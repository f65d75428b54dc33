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
                let target = target(stringify!($name));
                ballbar_fuzz::campaign::run(target);
                // Guided by coverage, where `cargo bolero` has built it.
                #[cfg(fuzzing)]
                {
                    let seeds = (target.seeds)();
                    bolero::check!().for_each(|bytes: &[u8]| {
                        ballbar_fuzz::campaign::one_of_engine(target, &seeds, bytes);
                    });
                }
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
    machine, test, scenario, model, effect, log, program, check, plan, simulate, align, analysis, files,
}
