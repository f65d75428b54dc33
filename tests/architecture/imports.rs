//! What a source file imports: its `use` trees and the paths that it writes out, each with its line.
//!
//! The words come from `proc_macro2`, so comments, strings and the form of a line do not matter. What is
//! marked `#[cfg(test)]` is left out. A method that another file gives to a type is not seen: it has no path.

use proc_macro2::{Delimiter, Ident, TokenStream, TokenTree};

/// How a path came to stand in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// `use`.
    Use,
    /// `pub use`, at any visibility.
    ReExport,
    /// Written out where it is needed.
    Inline,
}

/// One path.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Import {
    pub(crate) kind: Kind,
    /// `["super", "a", "B"]`; a glob ends with `"*"`.
    pub(crate) path: Vec<String>,
    /// The name that it has here: the last of the path, or what stands after `as`.
    pub(crate) name: String,
    pub(crate) line: usize,
}

/// What matters of a file.
#[derive(Debug, Default)]
pub(crate) struct Source {
    pub(crate) imports: Vec<Import>,
    /// Modules that it declares, `mod x;`.
    pub(crate) modules: Vec<String>,
    /// Lines that call a macro that prints.
    pub(crate) prints: Vec<usize>,
}

impl Source {
    /// Reads a text.
    pub(crate) fn read(text: &str) -> Self {
        let mut source = Self::default();
        let tokens: TokenStream = text.parse().expect("a source file is made of words");
        source.walk(&tokens.into_iter().collect::<Vec<_>>());
        source
    }

    fn walk(&mut self, tokens: &[TokenTree]) {
        let mut k = 0;
        while k < tokens.len() {
            match &tokens[k] {
                TokenTree::Punct(punct) if punct.as_char() == '#' && only_for_tests(tokens, k) => {
                    k += tokens[k..].iter().position(ends_item).unwrap_or(tokens.len() - k);
                }
                TokenTree::Group(group) => {
                    self.walk(&group.stream().into_iter().collect::<Vec<_>>());
                }
                TokenTree::Ident(word) if word == "use" && !is(tokens.get(k + 1), '<') => {
                    let end = tokens[k..].iter().position(|t| is(Some(t), ';'));
                    let end = k + end.unwrap_or(tokens.len() - k);
                    let kind = if is_public(&tokens[..k]) { Kind::ReExport } else { Kind::Use };
                    self.tree(kind, &[], &tokens[k + 1..end]);
                    k = end;
                }
                TokenTree::Ident(word) if word == "mod" => {
                    if let (Some(TokenTree::Ident(name)), true) =
                        (tokens.get(k + 1), is(tokens.get(k + 2), ';'))
                    {
                        self.modules.push(name.to_string());
                    }
                }
                TokenTree::Ident(word) if is(tokens.get(k + 1), '!') => {
                    let printing = ["print", "println", "eprint", "eprintln", "dbg"];
                    if printing.iter().any(|name| word == name) {
                        self.prints.push(line(word));
                    }
                }
                TokenTree::Ident(word) if is_separator(tokens, k + 1) => {
                    let mut path = vec![word.to_string()];
                    while is_separator(tokens, k + 1) {
                        let Some(TokenTree::Ident(next)) = tokens.get(k + 3) else { break };
                        path.push(next.to_string());
                        k += 3;
                    }
                    self.push(Kind::Inline, path, line(word));
                }
                _ => {}
            }
            k += 1;
        }
    }

    /// One tree of a `use`, or several with commas between them.
    fn tree(&mut self, kind: Kind, before: &[String], tokens: &[TokenTree]) {
        for tree in tokens.split(|token| is(Some(token), ',')) {
            let mut path = before.to_vec();
            let mut at = None;
            let mut alias = None;
            let mut words = tree.iter();
            while let Some(token) = words.next() {
                match token {
                    TokenTree::Ident(word) if word == "as" => {
                        alias = words.next().map(ToString::to_string);
                    }
                    TokenTree::Ident(word) => {
                        at = at.or(Some(line(word)));
                        // `{self, ..}` is the path so far.
                        if word != "self" || path.is_empty() {
                            path.push(word.to_string());
                        }
                    }
                    TokenTree::Punct(punct) if punct.as_char() == '*' => {
                        at = at.or(Some(punct.span().start().line));
                        path.push("*".to_owned());
                    }
                    TokenTree::Group(group) => {
                        at = None;
                        let inner: Vec<TokenTree> = group.stream().into_iter().collect();
                        self.tree(kind, &path, &inner);
                    }
                    _ => {}
                }
            }
            if let Some(line) = at {
                self.push(kind, path, line);
                if let (Some(alias), Some(import)) = (alias, self.imports.last_mut()) {
                    import.name = alias;
                }
            }
        }
    }

    fn push(&mut self, kind: Kind, path: Vec<String>, line: usize) {
        let name = path.last().cloned().unwrap_or_default();
        self.imports.push(Import { kind, path, name, line });
    }
}

fn line(word: &Ident) -> usize {
    word.span().start().line
}

fn is(token: Option<&TokenTree>, sign: char) -> bool {
    matches!(token, Some(TokenTree::Punct(punct)) if punct.as_char() == sign)
}

fn is_separator(tokens: &[TokenTree], k: usize) -> bool {
    is(tokens.get(k), ':') && is(tokens.get(k + 1), ':')
}

/// Whether `pub` or `pub(..)` stands last.
fn is_public(before: &[TokenTree]) -> bool {
    let word = match before {
        [.., word, TokenTree::Group(group)] if group.delimiter() == Delimiter::Parenthesis => word,
        [.., word] => word,
        [] => return false,
    };
    matches!(word, TokenTree::Ident(word) if word == "pub")
}

/// Whether `#[cfg(test)]` stands here.
fn only_for_tests(tokens: &[TokenTree], k: usize) -> bool {
    let Some(TokenTree::Group(group)) = tokens.get(k + 1) else { return false };
    group.stream().to_string().replace(' ', "") == "cfg(test)"
}

/// An item ends with `;` or with its braces.
fn ends_item(token: &TokenTree) -> bool {
    match token {
        TokenTree::Group(group) => group.delimiter() == Delimiter::Brace,
        _ => is(Some(token), ';'),
    }
}

#[test]
fn all_forms_of_a_path_are_read_with_their_lines() {
    let text = "//! use crate::comment::No;\n\
                use super::{\n    a::B,\n    c,\n    d::{self, E as F},\n};\n\
                pub(super) use crate::x::*;\n\
                /// [`G`](crate::doc::G)\n\
                fn f() -> impl Sized + use<> { let s = \"crate::text::H\"; super::i::J::k::<u8>(s) }\n\
                #[cfg(test)]\n#[allow(x)]\nmod tests { use super::l::M; }\n\
                mod n;\nfn g() { println!(\"{}\", crate::o::P) }\n";
    let source = Source::read(text);
    let told: Vec<String> = source
        .imports
        .iter()
        .map(|i| format!("{} {:?} {} {}", i.line, i.kind, i.path.join("::"), i.name))
        .collect();
    assert_eq!(
        told,
        [
            "3 Use super::a::B B",
            "4 Use super::c c",
            "5 Use super::d d",
            "5 Use super::d::E F",
            "7 ReExport crate::x::* *",
            "9 Inline super::i::J::k k",
            "14 Inline crate::o::P P",
        ]
    );
    assert_eq!((source.modules, source.prints), (vec!["n".to_owned()], vec![14]));
}
