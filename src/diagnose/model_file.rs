//! The extended model as a file.

use super::result::Diagnosis;
use crate::identify::Campaign;
use crate::model::{Coefficient, Form, ModelFile, SetUp};

impl Diagnosis {
    /// The model with what was found; `campaign` is what was diagnosed.
    ///
    /// Coefficients are means over the repeats. Causes are terms, whose amplitudes are estimated anew where
    /// the file is used; curves, and what all slides' following has in common, are held.
    pub fn model_file(&self, campaign: &Campaign) -> ModelFile {
        let extended = self.extended.as_ref().map_or(campaign, |now| &now.campaign);
        let count = extended.repeats.len().max(1) as f64;
        let mut model = ModelFile { terms: extended.terms.clone(), ..ModelFile::default() };
        let first = extended.repeats.first().map_or(&[][..], |repeat| repeat.estimates.as_slice());
        for (index, estimate) in first.iter().enumerate() {
            let mean =
                extended.repeats.iter().map(|r| r.estimates[index].value).sum::<f64>() / count;
            let name = estimate.parameter.name.clone();
            if Coefficient::parse(&name).is_some() {
                model.coefficients.push((name, mean));
            } else if SetUp::parse(&name).is_some() {
                model.set_up.push((name, mean));
            }
        }
        for finding in &self.findings {
            model.effects.extend(finding.effects.clone());
            match &finding.element.form {
                Form::Cause(shape) if !finding.element.is_common_delay() => {
                    model.terms.push(shape.term_name());
                }
                Form::Cause(_) => {}
                Form::Empirical(curve) => {
                    model.curves.push((curve.clone(), finding.amplitudes.clone()));
                }
            }
        }
        model
    }
}
