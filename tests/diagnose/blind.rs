//! A short standing trial; the long one's table is in `docs/blind.md`.
#![allow(clippy::unwrap_used)]

use ballbar::trial::{Class, Course, Outcome, Request, Session, Verdict};

#[test]
fn most_of_what_is_hidden_is_named_and_nothing_else() {
    let session = Session::new(Course::built_in().unwrap(), 1, None).unwrap();
    let wanted =
        [(Class::Single, 0..6), (Class::None, 0..4), (Class::Two, 0..3), (Class::Outside, 0..4)];
    let requests: Vec<Request> = wanted
        .into_iter()
        .flat_map(|(class, indices)| indices.map(move |index| Request { class, index }))
        .collect();
    let outcomes = session.run(&requests, &|_| ()).unwrap();
    let count = |class: Class, so: fn(&Outcome) -> bool| {
        outcomes.iter().filter(|o| o.class == class && so(o)).count()
    };
    let right = |o: &Outcome| o.judgement.verdict == Verdict::Right;
    let told = ballbar::trial::table(&outcomes, session.noise_mm());
    assert!(count(Class::Single, right) >= 5, "{told}");
    assert_eq!(count(Class::None, right), 4, "{told}");
    assert!(count(Class::Two, right) >= 2, "{told}");
    assert!(count(Class::Outside, right) >= 3, "{told}");
}

#[test]
fn a_trial_is_its_seed_class_and_index() {
    let trial = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let session = Session::new(Course::built_in().unwrap(), 5, Some(2e-4)).unwrap();
            let requests = [3, 4].map(|index| Request { class: Class::Single, index });
            let outcomes = session.run(&requests, &|_| ()).unwrap();
            outcomes.into_iter().map(|o| (o.hidden, o.judgement)).collect::<Vec<_>>()
        })
    };
    assert_eq!(trial(1), trial(2));
}
