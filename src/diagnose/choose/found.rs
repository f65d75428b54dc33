//! What a search has chosen, and what else it could be.

use serde::{Serialize, Serializer};

use crate::residual::{self, Beside, Element, Fitted};

/// Another explanation of the same.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Rival {
    /// What else it could be.
    #[serde(rename = "name", serialize_with = "name")]
    pub element: Element,
    /// What it explains of what the named one does.
    pub share: f64,
    /// How far these runs tell them apart.
    #[serde(rename = "told")]
    pub separation: Separation,
}

impl Rival {
    /// What it is called, such as `cyclic EBX 10 mm`.
    pub fn name(&self) -> String {
        self.element.form.name()
    }
}

fn name<S: Serializer>(element: &Element, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(&element.form.name())
}

/// Whether two explanations can be told apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Separation {
    /// They are the same in these runs, whatever the noise.
    Same,
    /// They differ by less than the noise does.
    Undecided,
    /// The other one explains less.
    Apart,
}

/// What was found.
#[derive(Debug, Clone)]
pub(crate) struct Chosen {
    pub(crate) fitted: Fitted,
    /// Other explanations of each element.
    pub(crate) rivals: Vec<Vec<Rival>>,
    /// All effects with causes in the place of a curve, which explain as much as it but for what is not linear, each with its own
    /// rivals.
    pub(crate) nearly: Vec<Self>,
}

impl Chosen {
    /// Without one of the effects, the others fitted anew; `None` where nothing is left of them.
    pub(crate) fn without(&self, effect: usize, alone: &Beside) -> Option<Self> {
        let others = |index: &usize| *index != effect;
        let kept: Vec<usize> = (0..self.fitted.elements.len()).filter(others).collect();
        let elements = kept.iter().map(|&k| self.fitted.elements[k].clone()).collect();
        let fitted = if kept.is_empty() { None } else { residual::fit(alone, elements) }?;
        let rivals = kept.iter().map(|&k| self.rivals[k].clone()).collect();
        Some(Self { fitted, rivals, nearly: Vec::new() })
    }

    /// With a rival in the place of one of the effects, the effect among its rivals; `None` where they cannot be fitted.
    pub(crate) fn instead(&self, effect: usize, rival: usize, alone: &Beside) -> Option<Self> {
        let mut elements = self.fitted.elements.clone();
        let mut rivals = self.rivals.clone();
        let Rival { element, share, separation } = rivals[effect][rival].clone();
        let own = std::mem::replace(&mut elements[effect], element);
        let fitted = residual::fit(alone, elements)?;
        rivals[effect].iter_mut().for_each(|other| other.share /= share);
        rivals[effect][rival] = Rival { element: own, share: share.recip(), separation };
        Some(Self { fitted, rivals, nearly: Vec::new() })
    }
}
