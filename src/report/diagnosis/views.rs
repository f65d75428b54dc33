//! Which of the many views are drawn.

use crate::diagnose::View;

/// So many views are drawn.
const DRAWN: usize = 8;
/// Of the views of one kind, such as the circles, so many.
const OF_A_KIND: usize = 2;

/// All views in their order; bins for those that are drawn: of each variable the one that holds most.
pub(super) fn told(views: &[View]) -> Vec<View> {
    let mut drawn: Vec<&str> = Vec::new();
    views
        .iter()
        .map(|view| {
            let kind = |variable: &str| variable.split(" of ").next().unwrap_or("").to_owned();
            let kind = |variable: &str| {
                if variable.starts_with("angle on") { "angle on".into() } else { kind(variable) }
            };
            let own = kind(&view.variable);
            let alike = drawn.iter().filter(|variable| kind(variable) == own).count();
            let draw = drawn.len() < DRAWN
                && alike < OF_A_KIND
                && !drawn.contains(&view.variable.as_str())
                && view.bins.len() > 3;
            if draw {
                drawn.push(&view.variable);
                return view.clone();
            }
            View { bins: Vec::new(), ..view.clone() }
        })
        .collect()
}
