//! Which of the many views are drawn.

use crate::diagnose::{Subject, View};

/// So many views are drawn.
const DRAWN: usize = 8;
/// Of the views about the same, such as the circles, so many.
const OF_A_SUBJECT: usize = 2;

/// All views in their order; bins for those that are drawn: of each variable the one that holds most.
pub(super) fn told(views: &[View]) -> Vec<View> {
    let mut drawn: Vec<(Subject, &str)> = Vec::new();
    let each = views.iter().map(|view| {
        let alike = drawn.iter().filter(|(subject, _)| *subject == view.subject).count();
        let draw = drawn.len() < DRAWN
            && alike < OF_A_SUBJECT
            && drawn.iter().all(|(_, variable)| *variable != view.variable)
            && view.bins.len() > 3;
        if !draw {
            return View { bins: Vec::new(), ..view.clone() };
        }
        drawn.push((view.subject, &view.variable));
        view.clone()
    });
    each.collect()
}
