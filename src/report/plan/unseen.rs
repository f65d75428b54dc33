//! What a test cannot tell, grouped by what would separate it.

use super::facts::UnseenTerm;

/// Terms that the same things separate.
#[derive(Debug)]
pub(super) struct Group<'a> {
    /// What separates them, in words; empty where nothing that was tried does.
    pub(super) what: String,
    pub(super) terms: Vec<&'a UnseenTerm>,
}

/// The groups from little trouble to much, the largest first where the least trouble is the same, the
/// terms of each by name; what nothing separates comes last.
pub(super) fn groups(unseen: &[UnseenTerm]) -> Vec<Group<'_>> {
    let mut groups: Vec<Group<'_>> = Vec::new();
    for term in unseen {
        let what = any_of(&term.remedies);
        match groups.iter_mut().find(|group| group.what == what) {
            Some(group) => group.terms.push(term),
            None => groups.push(Group { what, terms: vec![term] }),
        }
    }
    for group in &mut groups {
        group.terms.sort_by(|a, b| a.name.cmp(&b.name));
    }
    let order = by_trouble(unseen);
    let trouble = |group: &Group<'_>| {
        let first = group.terms.first().and_then(|term| term.remedies.first());
        first.map_or(order.len(), |first| order.iter().position(|o| o == first).unwrap_or(0))
    };
    groups.sort_by_cached_key(|group| (trouble(group), std::cmp::Reverse(group.terms.len())));
    groups
}

/// All remedies in one order: those of every term stand from little trouble to much.
fn by_trouble(unseen: &[UnseenTerm]) -> Vec<&str> {
    let mut order: Vec<&str> = Vec::new();
    for term in unseen {
        let mut at = 0;
        for remedy in &term.remedies {
            at = 1 + order.iter().position(|known| known == remedy).unwrap_or_else(|| {
                order.insert(at, remedy);
                at
            });
        }
    }
    order
}

/// `a second place 100 mm along X or Z, or a longer tool`: neighbours that differ in their last word share
/// the others.
fn any_of(remedies: &[String]) -> String {
    let mut merged: Vec<(&str, Vec<&str>)> = Vec::new();
    for remedy in remedies {
        let (begin, end) = remedy.rsplit_once(' ').unwrap_or(("", remedy));
        match merged.last_mut() {
            Some((before, ends)) if *before == begin && !begin.is_empty() => ends.push(end),
            _ => merged.push((begin, vec![end])),
        }
    }
    let told: Vec<String> = merged
        .into_iter()
        .map(|(begin, ends)| format!("{begin} {}", joined(&ends, " or ")).trim().to_owned())
        .collect();
    joined(&told.iter().map(String::as_str).collect::<Vec<_>>(), ", or ")
}

fn joined(words: &[&str], last: &str) -> String {
    match words {
        [] => String::new(),
        [only] => (*only).to_owned(),
        [before @ .., end] => format!("{}{last}{end}", before.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn term(name: &str, remedies: &[&str]) -> UnseenTerm {
        let remedies = remedies.iter().map(|&remedy| remedy.to_owned()).collect();
        UnseenTerm { name: name.into(), reason: format!("{name} acts as EXX1"), remedies }
    }

    #[test]
    fn what_the_same_things_separate_is_one_group_and_what_nothing_does_comes_last() {
        let (along_x, along_z) = ("a second place 100 mm along X", "a second place 100 mm along Z");
        let all = [
            term("EXX0", &[]),
            term("EBXb", &[along_x, along_z]),
            term("EAXb", &[along_z, "a longer tool"]),
            term("EZX3", &["more arcs", along_z]),
            term("EBX3", &[along_x, along_z]),
        ];
        let groups = groups(&all);
        let told: Vec<(&str, usize)> =
            groups.iter().map(|group| (group.what.as_str(), group.terms.len())).collect();
        let expected = [
            ("more arcs, or a second place 100 mm along Z", 1),
            ("a second place 100 mm along X or Z", 2),
            ("a second place 100 mm along Z, or a longer tool", 1),
            ("", 1),
        ];
        assert_eq!(told, expected);
    }
}
