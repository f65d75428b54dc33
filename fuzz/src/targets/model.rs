//! Model files: read, taken by a test and a scenario, written again.

use ballbar::model::ModelFile;
use ballbar::simulate::Scenario;

use super::{Target, accepted, scenario};
use crate::seeds::{self, RIGS};

pub const TARGET: Target = Target {
    name: "model",
    seeds: || vec![seeds::MODEL.as_bytes().to_vec()],
    words: scenario::WORDS,
    made: &[],
    read,
};

fn read(input: &[u8]) -> bool {
    let model = ModelFile::parse(&seeds::as_text(input), "model.toml".as_ref());
    if let Ok(model) = &model {
        let numbers = model.coefficients.iter().chain(&model.set_up);
        assert!(numbers.into_iter().all(|(_, value)| value.is_finite()), "every number is finite");
        let mut scenario = Scenario::default();
        accepted(&scenario.take(model));
        let mut estimation = RIGS[0].test.estimation().clone();
        estimation.take(model);
        let names = ["A".to_owned(), "B".to_owned()];
        accepted(&ballbar::model::terms(&estimation.coefficients(), &names));
        // The last digits of numbers are rounded when they are written.
        let again = ModelFile::parse(&model.to_toml(), "model.toml".as_ref());
        assert_eq!(
            again.map(|again| again.terms).as_ref(),
            Ok(&model.terms),
            "a model file reads back"
        );
    }
    accepted(&model)
}
