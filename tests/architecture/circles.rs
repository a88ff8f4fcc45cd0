//! Files that use each other in a circle are one file in two places: what they share wants a file of its own.
//!
//! A path is followed through the re-exports of `mod.rs` files to the file that has the item. A `mod.rs` that only declares and
//! re-exports is the face of its folder, and uses nothing. Methods are not seen: they are named without their file.

use std::collections::{BTreeMap, BTreeSet};

use super::{code_only, is_word_letter, room_of, without_tests, word_positions};

/// Rooms whose files use each other in one direction.
const ROOMS: [&str; 3] = ["model", "solve", "cli"];

/// One sentence for a circle among the files of [`ROOMS`] in `sources`, each with its path and text.
pub(crate) fn circles(sources: &[(String, String)]) -> Vec<String> {
    let files = files(sources);
    let mut used: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for (module, file) in files.iter().filter(|(_, file)| !file.is_face) {
        let targets = file.paths.iter().filter_map(|path| target(&files, module, path, 0));
        let others = targets.filter(|target| !target.is_face && target.path != file.path);
        used.insert(file.path, others.map(|other| other.path).collect());
    }
    // What uses nothing that is left is in no circle.
    while let Some(free) =
        used.iter().find(|(_, targets)| targets.is_empty()).map(|(path, _)| *path)
    {
        used.remove(free);
        used.values_mut().for_each(|targets| targets.retain(|target| *target != free));
    }
    let Some(mut path) = used.keys().next().copied() else { return Vec::new() };
    let mut walk = Vec::new();
    while !walk.contains(&path) {
        walk.push(path);
        path = used[path].first().expect("what uses nothing is gone");
    }
    let start = walk.iter().position(|at| *at == path).expect("the walk has met itself");
    let circle = walk[start..].iter().chain([&path]).copied().collect::<Vec<_>>().join(" -> ");
    vec![format!(
        "{circle}: files use each other in a circle; give what they share a file of its own"
    )]
}

/// A module of its own file.
struct File<'a> {
    path: &'a str,
    is_face: bool,
    /// The paths that it names.
    paths: Vec<Vec<String>>,
}

/// The files of [`ROOMS`] by their modules, those of tests left out.
fn files(sources: &[(String, String)]) -> BTreeMap<Vec<String>, File<'_>> {
    let mut files = BTreeMap::new();
    let mut tests: Vec<Vec<String>> = Vec::new();
    let is_checked = |path: &str| room_of(path).is_some_and(|room| ROOMS.contains(&room));
    for (path, source) in sources.iter().filter(|(path, _)| is_checked(path)) {
        let inside = path.trim_start_matches("src/").trim_end_matches(".rs");
        let module = inside.trim_end_matches("/mod").split('/').map(str::to_owned);
        let module: Vec<String> = module.collect();
        let code = code_only(source);
        let code = without_tests(path, &code);
        for at in word_positions(code, "#[cfg(test)]") {
            let item = code[at..].split(';').next().unwrap_or_default();
            if let Some((_, name)) = item.rsplit_once("mod ") {
                tests.push(module.iter().cloned().chain([name.to_owned()]).collect());
            }
        }
        let defines = ["fn", "struct", "enum", "trait", "impl", "const", "static", "type"];
        let is_face = path.ends_with("/mod.rs")
            && defines.iter().all(|word| word_positions(code, word).next().is_none());
        files.insert(module, File { path, is_face, paths: paths(code) });
    }
    files.retain(|module, _| !tests.iter().any(|test| module.starts_with(test)));
    files
}

/// The file that has what `path` names in `module`; `None` where that is another crate's, or no path to a file.
fn target<'f, 'a>(
    files: &'f BTreeMap<Vec<String>, File<'a>>,
    module: &[String],
    path: &[String],
    depth: usize,
) -> Option<&'f File<'a>> {
    let mut at = module.to_vec();
    let mut rest = path;
    match rest.first()?.as_str() {
        "crate" => (at, rest) = (Vec::new(), &rest[1..]),
        "self" => rest = &rest[1..],
        "super" => {}
        name if files.contains_key(&[module, &[name.to_owned()]].concat()) => {}
        _ => return None,
    }
    while rest.first().is_some_and(|name| name == "super") {
        at.pop();
        rest = &rest[1..];
    }
    while let Some(name) = rest.first() {
        let child = [at.as_slice(), std::slice::from_ref(name)].concat();
        if files.contains_key(&child) || at.is_empty() {
            (at, rest) = (child, &rest[1..]);
            continue;
        }
        let named = |path: &&Vec<String>| path.last() == Some(name) && depth < 8;
        let exports = files.get(&at)?.paths.iter().filter(named);
        let found = exports.filter_map(|path| target(files, &at, path, depth + 1)).next();
        return found.or_else(|| files.get(&at));
    }
    files.get(&at)
}

/// The paths of two names or more in `code`, the groups of `use` opened; those of a visibility left out.
fn paths(code: &str) -> Vec<Vec<String>> {
    let mut paths = Vec::new();
    let mut at = 0;
    while let Some(skipped) = code[at..].find(is_word_letter) {
        at += skipped;
        let (is_visibility, before) = (code[..at].ends_with("(in "), paths.len());
        at += push_paths(&code[at..], &[], &mut paths);
        if is_visibility {
            paths.truncate(before);
        }
    }
    paths.retain(|path| path.len() > 1);
    paths
}

/// Appends the paths that `text` begins with, behind `prefix`; the bytes that they take.
fn push_paths(text: &str, prefix: &[String], paths: &mut Vec<Vec<String>>) -> usize {
    let length = text.find(|letter| !is_word_letter(letter)).unwrap_or(text.len());
    let (word, rest) = text.split_at(length);
    let mut path = prefix.to_vec();
    if !word.is_empty() && (word != "self" || prefix.is_empty()) {
        path.push(word.to_owned());
    }
    let Some(after) = rest.strip_prefix("::") else {
        paths.push(path);
        return length;
    };
    let Some(mut group) = after.strip_prefix('{') else {
        if after.starts_with(is_word_letter) {
            return length + 2 + push_paths(after, &path, paths);
        }
        paths.push(path);
        return length + 2;
    };
    while let Some(next) = group.find(|letter| is_word_letter(letter) || letter == '}') {
        group = &group[next..];
        if let Some(after) = group.strip_prefix('}') {
            return text.len() - after.len();
        }
        let taken = push_paths(group, &path, paths);
        group = &group[taken..];
    }
    text.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(files: &[(&str, &str)]) -> Vec<String> {
        let sources = files.iter().map(|(path, source)| ((*path).to_owned(), (*source).to_owned()));
        circles(&sources.collect::<Vec<_>>())
    }

    #[test]
    fn circles_are_found_through_faces_and_groups() {
        let face = ("src/model/mod.rs", "mod a;\nmod b;\npub use a::A;\npub use b::{self, B};");
        let uses_b = ("src/model/a.rs", "use super::{x, B};\npub struct A;");
        for uses_a in ["use crate::model::A;", "fn f() { super::a::A::new() }", "use super::a;"] {
            let circle = found(&[face, uses_b, ("src/model/b.rs", uses_a)]);
            assert!(circle[0].starts_with("src/model/a.rs -> src/model/b.rs -> "), "{circle:?}");
        }
    }

    #[test]
    fn one_direction_is_no_circle() {
        let face = ("src/model/mod.rs", "mod a;\nmod b;\n#[cfg(test)]\nmod t;\npub use a::A;");
        let uses_b = ("src/model/a.rs", "use super::b::B;\npub struct A;");
        for b in [
            "pub struct B;",
            "pub(in crate::model::a) struct B;",
            "// super::a\npub struct B;",
            "pub struct B;\n#[cfg(test)]\nmod tests {\n    use super::super::A;\n}\n",
        ] {
            let test = ("src/model/t.rs", "use super::{a, b, t2};");
            assert_eq!(found(&[face, uses_b, ("src/model/b.rs", b), test]), Vec::<String>::new());
        }
        let other_room =
            [("src/mesh/a.rs", "use super::b::B;"), ("src/mesh/b.rs", "use super::a::A;")];
        assert_eq!(found(&other_room), Vec::<String>::new());
    }
}
