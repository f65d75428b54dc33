//! What a page may load: nothing but what it brings itself.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use sha2::{Digest, Sha256};

/// A content security policy that lets a page have one style sheet and one script, both its own, and nothing else.
pub(in crate::report) fn policy(style: &str, script: &str) -> String {
    let hash = |text: &str| format!("'sha256-{}'", STANDARD.encode(Sha256::digest(text)));
    format!(
        "default-src 'none'; script-src {}; style-src {}; base-uri 'none'; form-action 'none'",
        hash(script),
        hash(style)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// From section 8.3 of the recommendation CSP Level 2.
    #[test]
    fn hashes_are_those_that_a_browser_makes() {
        let policy = policy("", "alert('Hello, world.');");
        let hash = "script-src 'sha256-qznLcsROx4GACP2dm0UCKCzCG+HiZ1guq6ZZDob/Tng=';";
        assert!(policy.contains(hash), "{policy}");
    }
}
