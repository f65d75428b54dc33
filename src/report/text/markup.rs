//! Text as it stands in a page.

/// Text as XML.
pub(in crate::report) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// Text as XML, what stands between backticks as code; a backtick without its second stays one.
pub(in crate::report) fn coded(text: &str) -> String {
    let text = escaped(text);
    let mut page = String::with_capacity(text.len());
    let mut rest = text.as_str();
    while let Some((before, code, after)) = rest
        .split_once('`')
        .and_then(|(before, rest)| rest.split_once('`').map(|(code, after)| (before, code, after)))
    {
        page.extend([before, "<code>", code, "</code>"]);
        rest = after;
    }
    page.push_str(rest);
    page
}

/// The first so many letters, and that there are more.
pub(in crate::report) fn shortened(text: &str, most: usize) -> String {
    if text.chars().count() <= most {
        return text.to_owned();
    }
    let kept: String = text.chars().take(most.saturating_sub(1)).collect();
    format!("{}\u{2026}", kept.trim_end())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_code_and_nothing_becomes_a_tag() {
        assert_eq!(
            coded("write `a = \"<b>\"` & go"),
            "write <code>a = &quot;&lt;b&gt;&quot;</code> &amp; go"
        );
        assert_eq!(
            coded("one ` alone, `two` of three `"),
            "one <code> alone, </code>two<code> of three </code>"
        );
        assert_eq!(coded("5` of arc"), "5` of arc");
    }

    #[test]
    fn what_is_too_long_says_so() {
        assert_eq!(shortened("a drawing", 9), "a drawing");
        assert_eq!(shortened("a drawing", 3), "a\u{2026}");
    }
}
