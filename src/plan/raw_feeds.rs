//! One feed or a list of them, as a test file writes it.

use std::fmt;

use serde::de::{self, Deserialize, Deserializer, SeqAccess, Visitor};
use toml::Spanned;

use crate::error::{Error, Result};
use crate::toml_text::Text;

/// Feeds of a test, mm/min: from where a bar barely moves to where none follows.
pub(crate) const FEEDS_MM_MIN: [f64; 2] = [1.0, 60_000.0];
/// At more feeds than these nobody drives a test.
const MOST: usize = 8;

/// `feed_mm_min`, a number or a list of numbers.
pub(super) struct RawFeeds(Vec<f64>);

impl<'de> Deserialize<'de> for RawFeeds {
    fn deserialize<D: Deserializer<'de>>(from: D) -> std::result::Result<Self, D::Error> {
        from.deserialize_any(OneOrMore)
    }
}

struct OneOrMore;

impl<'de> Visitor<'de> for OneOrMore {
    type Value = RawFeeds;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number or a list of numbers")
    }

    fn visit_f64<E: de::Error>(self, feed: f64) -> std::result::Result<RawFeeds, E> {
        Ok(RawFeeds(vec![feed]))
    }

    fn visit_i64<E: de::Error>(self, feed: i64) -> std::result::Result<RawFeeds, E> {
        Ok(RawFeeds(vec![feed as f64]))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> std::result::Result<RawFeeds, A::Error> {
        let mut feeds = Vec::new();
        while let Some(feed) = list.next_element::<f64>()? {
            feeds.push(feed);
        }
        Ok(RawFeeds(feeds))
    }
}

/// Feeds in mm/s, at least one and no two alike.
pub(super) fn check(feeds: &Spanned<RawFeeds>, text: &Text<'_>) -> Result<Vec<f64>> {
    let wrong = |what: String, hint: &str| {
        Err(Error::input(what).at(text.place(feeds.span())).hint(hint.to_owned()))
    };
    let given = &feeds.get_ref().0;
    if given.is_empty() || given.len() > MOST {
        return wrong(
            format!("`feed_mm_min` has {} feeds", given.len()),
            "give one feed, or a list of 2 to 8: every arc is driven at each",
        );
    }
    for (index, &feed) in given.iter().enumerate() {
        let spanned = Spanned::new(feeds.span(), feed);
        text.within(&spanned, "feed_mm_min", FEEDS_MM_MIN[0], FEEDS_MM_MIN[1])?;
        // F has three decimals.
        if given[..index].iter().any(|before| (before - feed).abs() < 1e-3) {
            return wrong(
                format!("`feed_mm_min` has {feed} twice"),
                "every arc is driven at each feed of the list: give each once",
            );
        }
    }
    Ok(given.iter().map(|feed| feed / 60.0).collect())
}
