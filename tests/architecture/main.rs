//! The plan of the house: which room may use which, and no file that two others lean on in a circle.
//!
//! The order of the rooms stands once, in the table of the crate's documentation in `src/lib.rs`.

#![allow(clippy::unwrap_used, clippy::expect_used)]

mod house;
mod imports;

use std::path::Path;

use house::House;

fn house() -> House {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut open = vec![root.join("src")];
    let mut files = Vec::new();
    while let Some(folder) = open.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let name = path.strip_prefix(root).unwrap().to_str().unwrap().replace('\\', "/");
            if path.is_dir() {
                open.push(path);
            } else if path.extension().is_some_and(|e| e == "rs") {
                files.push((name, std::fs::read_to_string(path).unwrap()));
            }
        }
    }
    House::new(files)
}

fn small(files: &[(&str, &str)]) -> House {
    House::new(files.iter().map(|(path, text)| ((*path).to_owned(), (*text).to_owned())))
}

#[track_caller]
fn assert_none(what: &str, faults: &[String]) {
    assert!(faults.is_empty(), "{what}:\n{}", faults.join("\n"));
}

#[test]
fn every_room_stands_in_the_table() {
    assert_none("table of rooms", &house().table_faults());
}

#[test]
fn no_room_imports_from_a_later_one() {
    assert_none("upward", &house().upward());
}

#[test]
fn no_files_of_a_room_import_each_other() {
    assert_none("circles", &house().circles());
}

#[test]
fn a_child_imports_from_the_file_that_defines_a_thing() {
    assert_none("through their own mod.rs", &house().roundabout());
}

#[test]
fn only_one_room_knows_the_linear_algebra_and_only_one_prints() {
    let house = house();
    assert_none("faer outside of `solve`", &house.naming(&["faer"], "solve"));
    assert_none("printing outside of `cli`", &house.printing("cli"));
}

const LIB: &str = "//! | [`low`] | x |\n//! | [`high`] | x |\nmod error;\nmod low;\nmod high;\n";

#[test]
fn an_upward_import_is_told_with_its_line() {
    let files = [
        ("src/lib.rs", LIB),
        ("src/error.rs", ""),
        ("src/low.rs", "\nuse crate::{error, high::{Thing as T}};\n"),
        ("src/high.rs", "use crate::low::Base;"),
    ];
    let house = small(&files);
    assert!(house.circles().is_empty() && house.table_faults().is_empty());
    assert_eq!(
        house.upward(),
        ["src/low.rs:2: crate::high::Thing: `low` imports from `high`, which stands after it"]
    );
    let on_the_ground =
        small(&[files[0], ("src/error.rs", "use crate::low::A;"), ("src/low.rs", "")]);
    assert_eq!(on_the_ground.upward().len(), 1);
}

#[test]
fn a_room_that_is_not_in_the_table_is_told() {
    let house = small(&[("src/lib.rs", "//! | [`low`] | x |\npub mod low;\npub mod attic;\n")]);
    assert_eq!(house.table_faults(), ["src/lib.rs: the room `attic` is not in the table of rooms"]);
}

/// Over a name that `mod.rs` only passes on, over a path that is written out, and over a folder.
#[test]
fn a_circle_is_told_with_what_closes_it() {
    let house = small(&[
        ("src/lib.rs", LIB),
        ("src/low/mod.rs", "mod a;\nmod b;\nmod c;\nmod d;\npub use a::A;\n#[cfg(test)]\nmod e;\n"),
        ("src/low/e.rs", "use super::e::f::G;\nuse crate::high::H;\nmod f;\n"),
        ("src/low/e/f.rs", "use super::I;\n"),
        ("src/low/a.rs", "use super::b::{self, B};\n"),
        ("src/low/b.rs", "fn f() { super::c::inner::C::new() }\n"),
        ("src/low/c/mod.rs", "mod inner;\n"),
        ("src/low/c/inner.rs", "use crate::low::{\n    A,\n};\n"),
        ("src/low/d.rs", "use super::a::A;\n#[cfg(test)]\nmod tests { use super::super::a; }\n"),
    ]);
    assert_eq!(
        house.circles(),
        ["low::a <-> low::b <-> low::c::inner:\
          \n  src/low/a.rs:1: super::b -> src/low/b.rs\
          \n  src/low/a.rs:1: super::b::B -> src/low/b.rs\
          \n  src/low/b.rs:1: super::c::inner::C::new -> src/low/c/inner.rs\
          \n  src/low/c/inner.rs:2: crate::low::A -> src/low/a.rs"]
    );
    assert!(house.upward().is_empty(), "what is for tests only is left out");
    assert_eq!(
        house.roundabout(),
        [
            "src/low/c/inner.rs:2: crate::low::A: `src/low/mod.rs` only passes on what src/low/a.rs defines"
        ]
    );
}

/// What is defined in `mod.rs` and used by a child that `mod.rs` calls.
#[test]
fn a_circle_through_a_parent_is_one() {
    let house = small(&[
        ("src/lib.rs", LIB),
        ("src/high/mod.rs", "mod child;\npub struct Common;\nfn f() { child::run(Common) }\n"),
        ("src/high/child.rs", "use super::Common;\n"),
    ]);
    assert_eq!(house.circles().len(), 1);
    assert!(house.roundabout().is_empty());
}

#[test]
fn a_room_that_prints_is_told() {
    let house = small(&[
        ("src/lib.rs", LIB),
        ("src/low.rs", "\nfn f() { println!(); }\nuse faer::Mat;"),
        ("src/high.rs", "fn f() { std::io::stdout(); println!() }"),
    ]);
    assert_eq!(house.printing("high"), ["src/low.rs:2"]);
    assert_eq!(house.printing("low").len(), 2);
    assert_eq!(house.naming(&["faer"], "high"), ["src/low.rs:3: faer::Mat"]);
}
