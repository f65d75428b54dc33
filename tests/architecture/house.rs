//! The files of a crate, where their imports lead, and what is wrong with that.

use std::collections::{BTreeMap, BTreeSet};

use crate::imports::{Import, Kind, Source};

/// Under all rooms, for all of them.
const GROUND: [&str; 5] = ["error", "file_name", "input", "toml_text", "written"];

/// A file, and what it imports.
struct File {
    /// Such as `src/design/search.rs`.
    path: String,
    source: Source,
}

/// All files of a crate, by module: `design::search`; the root is the empty name.
pub(crate) struct House {
    files: BTreeMap<String, File>,
    /// Rooms in the order of the table in the crate's documentation.
    order: Vec<String>,
}

/// An import within a crate.
struct Arrow<'a> {
    import: &'a Import,
    /// Module of the file that defines what is imported.
    to: String,
    /// Modules whose files only pass it on.
    through: Vec<String>,
}

impl House {
    /// Takes paths, such as `src/design/search.rs`, with texts.
    pub(crate) fn new(files: impl IntoIterator<Item = (String, String)>) -> Self {
        let mut house = Self { files: BTreeMap::new(), order: Vec::new() };
        for (path, text) in files {
            let module = path.trim_start_matches("src/").trim_end_matches(".rs");
            let module = module.strip_suffix("/mod").unwrap_or(module).replace('/', "::");
            let module = if module == "lib" { String::new() } else { module };
            if module.is_empty() {
                let rows = text.lines().filter_map(|line| line.strip_prefix("//! | [`"));
                let rooms = rows.filter_map(|row| row.split('`').next());
                house.order = rooms.map(str::to_owned).collect();
            }
            house.files.insert(module, File { path, source: Source::read(&text) });
        }
        // A parent that declares a module for tests only does not declare it here.
        loop {
            let declared = |module: &&String| {
                let of = house.files.get(parent(module));
                let name = module.rsplit("::").next().unwrap_or(module);
                of.is_some_and(|of| of.source.modules.iter().any(|declared| declared == name))
            };
            let roots = |module: &&String| module.is_empty() || *module == "main";
            let for_tests = house.files.keys().find(|m| !roots(m) && !declared(m)).cloned();
            let Some(module) = for_tests else { return house };
            house.files.remove(&module);
        }
    }

    /// Modules of the crate that the table does not have, and rows that are no module.
    pub(crate) fn table_faults(&self) -> Vec<String> {
        let Some(root) = self.files.get("") else { return vec!["there is no lib.rs".to_owned()] };
        let rooms = || root.source.modules.iter().filter(|m| !GROUND.contains(&m.as_str()));
        let missing = rooms().filter(|room| !self.order.contains(room));
        let extra = self.order.iter().filter(|room| !root.source.modules.contains(room));
        missing
            .map(|room| format!("src/lib.rs: the room `{room}` is not in the table of rooms"))
            .chain(extra.map(|room| format!("src/lib.rs: the table has no such room: `{room}`")))
            .collect()
    }

    /// Imports from a room that stands later in the order.
    pub(crate) fn upward(&self) -> Vec<String> {
        let place = |module: &str| {
            let room = room(module);
            self.order.iter().position(|name| name == room)
        };
        let mut faults = Vec::new();
        for (from, file) in self.files.iter().filter(|(from, _)| !from.is_empty()) {
            for arrow in self.arrows(from) {
                let (here, there) = (room(from), room(&arrow.to));
                let up = match (place(from), place(&arrow.to)) {
                    (Some(here), Some(there)) => there > here,
                    // The ground stands on nothing; nothing below the root knows the root.
                    (None, Some(_)) => here != "main",
                    (_, None) => there.is_empty(),
                };
                if up {
                    let there = if there.is_empty() { "lib.rs" } else { there };
                    faults.push(format!(
                        "{}: `{here}` imports from `{there}`, which stands after it",
                        told(file, arrow.import)
                    ));
                }
            }
        }
        faults
    }

    /// Circles between the files of a room, each with the imports that close it.
    pub(crate) fn circles(&self) -> Vec<String> {
        let modules: Vec<&String> = self.files.keys().filter(|module| !module.is_empty()).collect();
        let edges: BTreeMap<&str, Vec<Arrow>> = modules
            .iter()
            .map(|from| {
                let mut arrows = self.arrows(from);
                arrows.retain(|arrow| {
                    arrow.import.kind != Kind::ReExport
                        && arrow.to != **from
                        && room(&arrow.to) == room(from)
                });
                (from.as_str(), arrows)
            })
            .collect();
        let reached: BTreeMap<&str, BTreeSet<&str>> =
            edges.keys().map(|&from| (from, reached(&edges, from))).collect();
        let mut circles = Vec::new();
        let mut seen = BTreeSet::new();
        for &from in edges.keys() {
            if !reached[from].contains(from) || !seen.insert(from) {
                continue;
            }
            let mut members: Vec<&str> = reached[from].iter().copied().collect();
            members.retain(|member| reached[member].contains(from));
            seen.extend(&members);
            let closing = members.iter().flat_map(|member| {
                let within = edges[member].iter().filter(|a| members.contains(&a.to.as_str()));
                within.map(|a| {
                    format!(
                        "\n  {} -> {}",
                        told(&self.files[*member], a.import),
                        self.files[&a.to].path
                    )
                })
            });
            circles.push(format!("{}:{}", members.join(" <-> "), closing.collect::<String>()));
        }
        circles
    }

    /// Imports of a child that the file of one of its own parents only passes on.
    pub(crate) fn roundabout(&self) -> Vec<String> {
        let mut faults = Vec::new();
        for (from, file) in &self.files {
            for arrow in self.arrows(from) {
                let own = |parent: &&String| {
                    !parent.is_empty() && from.starts_with(&format!("{parent}::"))
                };
                if let Some(parent) = arrow.through.iter().find(own) {
                    faults.push(format!(
                        "{}: `{}` only passes on what {} defines",
                        told(file, arrow.import),
                        self.files[parent].path,
                        self.files[&arrow.to].path
                    ));
                }
            }
        }
        faults
    }

    /// Files outside of one room that name a crate or a word of the standard library.
    pub(crate) fn naming(&self, words: &[&str], room_of_it: &str) -> Vec<String> {
        let others = self.files.iter().filter(|(module, _)| room(module) != room_of_it);
        let named = others.flat_map(|(_, file)| {
            let imports = file.source.imports.iter();
            imports
                .filter(|i| i.path.iter().any(|p| words.contains(&p.as_str())))
                .map(|i| told(file, i))
        });
        named.collect()
    }

    /// Files outside of one room that print.
    pub(crate) fn printing(&self, room_of_it: &str) -> Vec<String> {
        let others = self.files.iter().filter(|(module, _)| room(module) != room_of_it);
        let lines =
            others.flat_map(|(_, f)| f.source.prints.iter().map(|l| format!("{}:{l}", f.path)));
        lines.chain(self.naming(&["stdout", "stderr"], room_of_it)).collect()
    }

    fn arrows(&self, from: &str) -> Vec<Arrow<'_>> {
        let imports = self.files[from].source.imports.iter();
        let arrows = imports.filter_map(|import| {
            let mut through = Vec::new();
            let to = self.resolve(from, &import.path, &mut through)?;
            Some(Arrow { import, to, through })
        });
        arrows.collect()
    }

    /// The module that defines what a path of a file names; `None` where it leads out of the crate.
    fn resolve(&self, from: &str, path: &[String], through: &mut Vec<String>) -> Option<String> {
        let (first, mut rest) = path.split_first()?;
        let mut at = match first.as_str() {
            "crate" => String::new(),
            // The binary knows the library by its name.
            "ballbar" if from == "main" => String::new(),
            "self" => from.to_owned(),
            "super" => parent(from).to_owned(),
            child if self.files[from].source.modules.iter().any(|m| m == child) => {
                join(from, child)
            }
            _ => return None,
        };
        while let Some((next, after)) = rest.split_first() {
            let child = join(&at, next);
            if next == "super" {
                at.truncate(parent(&at).len());
            } else if self.files.contains_key(&child) {
                at = child;
            } else {
                let imports = &self.files[&at].source.imports;
                let passed_on = imports.iter().find(|i| i.kind != Kind::Inline && i.name == *next);
                let Some(passed_on) = passed_on.filter(|_| through.len() < 9) else { break };
                let whole: Vec<String> = passed_on.path.iter().chain(after).cloned().collect();
                through.push(at.clone());
                let to = self.resolve(&at, &whole, through);
                if to.is_none() {
                    through.pop();
                }
                return to;
            }
            rest = after;
        }
        self.files.contains_key(&at).then_some(at)
    }
}

fn told(file: &File, import: &Import) -> String {
    format!("{}:{}: {}", file.path, import.line, import.path.join("::"))
}

fn room(module: &str) -> &str {
    module.split("::").next().unwrap_or(module)
}

fn parent(module: &str) -> &str {
    module.rsplit_once("::").map_or("", |(parent, _)| parent)
}

fn join(module: &str, child: &str) -> String {
    if module.is_empty() { child.to_owned() } else { format!("{module}::{child}") }
}

/// All modules that can be reached from one; itself only over another.
fn reached<'a>(edges: &'a BTreeMap<&str, Vec<Arrow>>, from: &str) -> BTreeSet<&'a str> {
    let mut reached = BTreeSet::new();
    let mut open = vec![from];
    while let Some(module) = open.pop() {
        for arrow in edges.get(module).into_iter().flatten() {
            if reached.insert(arrow.to.as_str()) {
                open.push(&arrow.to);
            }
        }
    }
    reached
}
