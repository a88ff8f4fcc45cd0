//! Keeps the house in order: reads the sources and fails with a sentence where a rule of
//! `ARCHITECTURE.md` is broken. The rules look at text, not at types: comments and literals are blanked,
//! and a path is recognized as `crate::room` (or `super::room` in a room's `mod.rs`).

mod circles;

use std::fs;
use std::path::Path;

/// The rooms in the one direction that data moves; a room may name itself and those before it.
const ORDER: [&str; 11] = [
    "genome", "field", "surface", "mesh", "model", "solve", "fitness", "batch", "evolve",
    "printing", "report",
];
/// Rooms that read and write files through `io`; each may name all of `ORDER`, and `scene`.
const ON_FILES: [&str; 4] = ["scene", "study", "verify", "calibration"];
/// Folders outside the order: `math` is the floor, `io`, `monitor` and `cli` are edges.
const OTHERS: [&str; 4] = ["math", "io", "monitor", "cli"];
/// Where `unsafe` may stand, besides `ffi/`: the file or folder that wraps one library.
const WRAPPERS: [&str; 1] = ["src/solve/petsc/library"];
/// A longer file has a noun that was missed.
const LONGEST_FILE: usize = 600;

#[test]
fn the_sources_keep_the_rules() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut sources = Vec::new();
    for folder in ["src", "ffi", "tests", "examples", "build.rs"] {
        collect_rust_files(root, folder, &mut sources);
    }
    for room in ORDER.iter().chain(&ON_FILES).chain(&OTHERS) {
        let found = sources.iter().any(|(path, _)| room_of(path) == Some(room));
        assert!(found, "src/{room} is named in tests/architecture but is not there");
    }
    let mut broken: Vec<String> =
        sources.iter().flat_map(|(path, source)| violations(path, source)).collect();
    broken.extend(circles::circles(&sources));
    assert!(broken.is_empty(), "\n{}\n", broken.join("\n"));
}

/// Appends path (relative to `root`, with `/`) and text of each Rust file at or under `path`, sorted.
fn collect_rust_files(root: &Path, path: &str, sources: &mut Vec<(String, String)>) {
    let full = root.join(path);
    if full.is_dir() {
        let entries = fs::read_dir(&full).expect("a folder of the package is readable");
        let mut names: Vec<String> = entries
            .map(|entry| entry.expect("an entry is readable").file_name())
            .map(|name| name.into_string().expect("file names are UTF-8"))
            .collect();
        names.sort();
        for name in names.iter().filter(|name| *name != "target") {
            collect_rust_files(root, &format!("{path}/{name}"), sources);
        }
    } else if path.ends_with(".rs") && full.is_file() {
        let source = fs::read_to_string(&full).expect("a source file is UTF-8");
        sources.push((path.to_owned(), source));
    }
}

/// One sentence for each rule that the file at `path` with text `source` breaks.
fn violations(path: &str, source: &str) -> Vec<String> {
    let mut broken = Vec::new();
    let lines = source.lines().count();
    if lines > LONGEST_FILE {
        broken.push(format!(
            "{path}: {lines} lines; over {LONGEST_FILE}, ask which noun was missed and split"
        ));
    }
    if !path.starts_with("tests/") {
        check_unfinished(path, source, &mut broken);
    }
    if path.starts_with("src/") {
        let code = code_only(source);
        check_foreign_code(path, &code, &mut broken);
        if let Some(room) = room_of(path) {
            let shipped = without_tests(path, &code);
            check_order(path, room, shipped, &mut broken);
            check_silence(path, room, shipped, &mut broken);
            if room == "solve" {
                check_geometry(path, &code, &mut broken);
                check_decorators(path, shipped, &mut broken);
            }
            if room == "evolve" {
                check_phenotypes(path, shipped, &mut broken);
            }
        }
    }
    broken
}

fn check_unfinished(path: &str, source: &str, broken: &mut Vec<String>) {
    for word in ["TODO", "FIXME", "todo", "unimplemented"] {
        for at in word_positions(source, word) {
            let is_macro = source[at + word.len()..].starts_with('!');
            if is_macro || word.starts_with(char::is_uppercase) {
                let line = line_of(source, at);
                broken.push(format!("{path}:{line}: `{word}`: finish it, or open an issue for it"));
            }
        }
    }
}

fn check_foreign_code(path: &str, code: &str, broken: &mut Vec<String>) {
    let wrapper = WRAPPERS.iter().any(|wrapper| path.starts_with(wrapper));
    if !wrapper {
        for at in word_positions(code, "unsafe") {
            let line = line_of(code, at);
            broken.push(format!(
                "{path}:{line}: `unsafe` belongs under ffi/ or into a wrapper ({WRAPPERS:?})"
            ));
        }
    }
    if room_of(path) != Some("solve") {
        for at in word_positions(code, "petsc_sys") {
            let line = line_of(code, at);
            broken.push(format!("{path}:{line}: only `solve` may name `petsc_sys`"));
        }
    }
}

fn check_order(path: &str, room: &str, code: &str, broken: &mut Vec<String>) {
    if !is_room(room) {
        broken.push(format!(
            "{path}: `{room}` is no known room: add it to ARCHITECTURE.md and tests/architecture"
        ));
        return;
    }
    for (at, named) in names_from_root(path, code) {
        if is_room(named) && !may_name(room, named) {
            let line = line_of(code, at);
            broken.push(format!(
                "{path}:{line}: room `{room}` names `{named}`, but data moves only {} -> scene -> study, verify, calibration (math below, io and cli at the edges)",
                ORDER.join(" -> ")
            ));
        }
    }
}

fn check_silence(path: &str, room: &str, code: &str, broken: &mut Vec<String>) {
    let printing =
        ["println!", "eprintln!", "print!", "eprint!", "dbg!", "stdout", "stderr", "indicatif"];
    let touching = ["std::fs", "fs::", "process::Command"];
    let (prints, touches) = match room {
        "report" | "io" | "cli" => return,
        on_files if ON_FILES.contains(&on_files) => (&printing[..], &[][..]),
        _ => (&printing[..], &touching[..]),
    };
    for word in prints.iter().chain(touches) {
        for at in word_positions(code, word) {
            let line = line_of(code, at);
            broken.push(format!(
                "{path}:{line}: `{word}` in room `{room}`: only cli prints, and only io, report, scene, study, verify and calibration read, write or run besides"
            ));
        }
    }
}

/// A solver knows numbers; the lower triangle of a matrix is one of its words, a triangle is not.
fn check_geometry(path: &str, code: &str, broken: &mut Vec<String>) {
    for (index, line) in code.lines().enumerate() {
        let line = line.to_lowercase().replace('_', "");
        let line = line.replace("lowertriangle", "").replace("uppertriangle", "");
        if line.contains("triangle") {
            let number = index + 1;
            broken.push(format!("{path}:{number}: `solve` has never heard of a triangle"));
        }
    }
}

/// Evolution has genomes; what they stand for is for an evaluation to ask.
fn check_phenotypes(path: &str, code: &str, broken: &mut Vec<String>) {
    for word in ["Network", "Phenotype", "express"] {
        for at in word_positions(code, word) {
            let line = line_of(code, at);
            broken.push(format!("{path}:{line}: `evolve` never asks what a genome stands for"));
        }
    }
}

/// A solver has no system of its own: it wraps those of models, and one that wraps by hand may forget a method that has a default.
fn check_decorators(path: &str, code: &str, broken: &mut Vec<String>) {
    let is_free = path == "src/solve/decorator.rs" || path.starts_with("src/solve/test_");
    for word in ["System for", "LoadedSystem for"].into_iter().filter(|_| !is_free) {
        for at in word_positions(code, word) {
            let line = line_of(code, at);
            broken.push(format!(
                "{path}:{line}: a system around another implements `Decorator`, which passes on all that it does not change"
            ));
        }
    }
}

/// The folder or file directly under `src/` in which `path` lies; `None` for the crate's roots.
fn room_of(path: &str) -> Option<&str> {
    let inside = path.strip_prefix("src/")?;
    let room = inside.split('/').next()?.trim_end_matches(".rs");
    (!matches!(room, "lib" | "main")).then_some(room)
}

fn is_room(name: &str) -> bool {
    ORDER.contains(&name) || ON_FILES.contains(&name) || OTHERS.contains(&name)
}

fn may_name(room: &str, named: &str) -> bool {
    let place = |name| ORDER.iter().position(|room| *room == name);
    room == named
        || match (room, named) {
            ("cli", _) => true,
            // What a browser is shown of a run.
            ("study", "monitor") => true,
            ("math" | "monitor", _) | (_, "monitor" | "cli") => false,
            (_, "math") => true,
            (room, "scene") => ON_FILES.contains(&room),
            (_, "study" | "verify" | "calibration") => false,
            ("scene" | "study" | "verify" | "calibration", _) => true,
            ("io", _) => named != "report",
            (_, "io") => room == "report",
            _ => place(named) < place(room),
        }
}

/// The names that follow `crate::` in `code`, each with its position; groups in braces are opened.
fn names_from_root<'a>(path: &str, code: &'a str) -> Vec<(usize, &'a str)> {
    let is_room_file = path.ends_with("/mod.rs") && path.matches('/').count() == 2;
    let prefixes: &[&str] =
        if is_room_file { &["crate::", "super::"] } else { &["crate::", "super::super::"] };
    let mut names = Vec::new();
    for prefix in prefixes {
        for at in word_positions(code, prefix) {
            let start = at + prefix.len();
            if code[start..].starts_with('{') {
                push_group_names(code, start + 1, &mut names);
            } else {
                names.push((start, first_word(&code[start..])));
            }
        }
    }
    names
}

/// Appends the first word of each item of the brace group whose inside begins at `start`.
fn push_group_names<'a>(code: &'a str, start: usize, names: &mut Vec<(usize, &'a str)>) {
    let mut depth = 0;
    let mut item = start;
    for (offset, letter) in code[start..].char_indices() {
        let end = start + offset;
        let closes_group = letter == '}' && depth == 0;
        match letter {
            '{' => depth += 1,
            '}' => depth -= 1,
            _ => {}
        }
        if closes_group || (letter == ',' && depth == 0) {
            let text = code[item..end].trim_start();
            names.push((end - text.len(), first_word(text)));
            item = end + 1;
        }
        if closes_group {
            return;
        }
    }
}

/// `code` up to the test module at its foot; a file of tests only is empty.
fn without_tests<'a>(path: &str, code: &'a str) -> &'a str {
    if path.ends_with("/tests.rs") || path.ends_with("_tests.rs") {
        return "";
    }
    code.find("\nmod tests {").map_or(code, |foot| &code[..foot])
}

/// `source` with comments, strings and characters turned into blanks; line breaks stay.
fn code_only(source: &str) -> String {
    let mut code = String::with_capacity(source.len());
    let mut rest = source;
    while let Some(first) = rest.chars().next() {
        let skipped = comment_or_literal_length(rest);
        let (taken, after) = rest.split_at(skipped.max(first.len_utf8()));
        if skipped == 0 {
            code.push(first);
        } else {
            code.extend(taken.chars().map(|c| if c == '\n' { '\n' } else { ' ' }));
        }
        rest = after;
    }
    code
}

/// The length in bytes of the comment or literal with which `text` begins, 0 when it begins with code.
fn comment_or_literal_length(text: &str) -> usize {
    let end_of = |start: usize, mark: &str| {
        text[start..].find(mark).map_or(text.len(), |at| start + at + mark.len())
    };
    if text.starts_with("//") {
        text.find('\n').unwrap_or(text.len())
    } else if text.starts_with("/*") {
        end_of(2, "*/")
    } else if text.starts_with('"') {
        string_length(text)
    } else if let Some(raw) = text.strip_prefix('r') {
        let hashes = raw.len() - raw.trim_start_matches('#').len();
        let is_string = raw[hashes..].starts_with('"');
        if is_string { end_of(hashes + 2, &format!("\"{}", "#".repeat(hashes))) } else { 0 }
    } else if text.starts_with("'\\") {
        // The escaped character may itself be a quote.
        text.char_indices().skip(3).find(|(_, c)| *c == '\'').map_or(text.len(), |(at, _)| at + 1)
    } else if let Some(after) = text.strip_prefix('\'') {
        let letter = after.chars().next().map_or(0, char::len_utf8);
        if after[letter..].starts_with('\'') { letter + 2 } else { 0 }
    } else {
        0
    }
}

fn string_length(text: &str) -> usize {
    let mut escaped = false;
    for (at, letter) in text.char_indices().skip(1) {
        match letter {
            _ if escaped => escaped = false,
            '\\' => escaped = true,
            '"' => return at + 1,
            _ => {}
        }
    }
    text.len()
}

/// Where `word` stands in `text` as a word of its own.
fn word_positions<'a>(text: &'a str, word: &'a str) -> impl Iterator<Item = usize> + 'a {
    text.match_indices(word).map(|(at, _)| at).filter(move |&at| {
        let goes_on =
            word.ends_with(is_word_letter) && text[at + word.len()..].starts_with(is_word_letter);
        let is_inside = text[..at].ends_with(is_word_letter);
        !is_inside && !goes_on
    })
}

fn first_word(text: &str) -> &str {
    text.split(|c| !is_word_letter(c)).next().unwrap_or_default()
}

fn is_word_letter(letter: char) -> bool {
    letter.is_alphanumeric() || letter == '_'
}

fn line_of(text: &str, at: usize) -> usize {
    text[..at].matches('\n').count() + 1
}

/// Asserts that the file breaks exactly one rule, with `part` in the sentence.
fn assert_broken(path: &str, source: &str, part: &str) {
    let found = violations(path, source);
    assert_eq!(found.len(), 1, "{path}: {source:?} gave {found:?}");
    assert!(found[0].contains(part), "{:?} does not say {part:?}", found[0]);
}

fn assert_kept(path: &str, source: &str) {
    assert_eq!(violations(path, source), Vec::<String>::new(), "{path}: {source:?}");
}

#[test]
fn a_room_named_from_its_left_is_reported() {
    let grid = "src/field/grid.rs";
    assert_broken(grid, "use crate::surface::TriangleMesh;\n", "grid.rs:1: room `field`");
    assert_broken(
        grid,
        "\nuse crate::{math::Vec3, solve::{A, B}};\n",
        ":2: room `field` names `solve`",
    );
    assert_broken(grid, "fn f(x: super::super::evolve::X) {}", "names `evolve`");
    assert_broken("src/field/mod.rs", "use super::mesh::X;", "names `mesh`");
    assert_broken("src/math/mod.rs", "use crate::genome::X;", "room `math`");
    assert_broken("src/evolve/mod.rs", "use crate::io::X;", "names `io`");
    assert_broken("src/evolve/mod.rs", "use crate::report::X;", "names `report`");
    assert_broken("src/io/mod.rs", "use crate::report::X;", "room `io`");
    assert_broken("src/report/mod.rs", "use crate::cli::X;", "names `cli`");
    assert_broken("src/evolve/a.rs", "use crate::scene::X;", "names `scene`");
    assert_broken("src/io/a.rs", "use crate::study::X;", "names `study`");
    assert_broken("src/scene/a.rs", "use crate::study::X;", "names `study`");
    assert_broken("src/verify/a.rs", "use crate::study::X;", "names `study`");
    assert_broken("src/study/a.rs", "use crate::verify::X;", "names `verify`");
    assert_broken("src/calibration/a.rs", "use crate::verify::X;", "names `verify`");
    assert_broken("src/scene/a.rs", "use crate::calibration::X;", "names `calibration`");
    assert_broken("src/study/a.rs", "use crate::cli::X;", "names `cli`");
    assert_broken("src/scene/a.rs", "use crate::monitor::X;", "names `monitor`");
    assert_broken("src/attic/mod.rs", "", "no known room");
}

#[test]
fn a_room_named_from_its_right_is_free() {
    assert_kept("src/surface/a.rs", "use crate::{field::ScalarField, math::Vec3, surface::B};");
    assert_kept("src/surface/a.rs", "use super::mesh::X; fn f(x: my_crate::solve::X) {}");
    assert_kept("src/report/a.rs", "use crate::io::X; use crate::evolve::Y;");
    assert_kept("src/io/a.rs", "use crate::evolve::Y;");
    assert_kept("src/cli/a.rs", "use crate::report::Y;");
    assert_kept("src/scene/a.rs", "use crate::{io::X, printing::Y, report::Z};");
    assert_kept("src/verify/a.rs", "use crate::scene::X;");
    assert_kept("src/study/a.rs", "use crate::{monitor::X, scene::Y};");
    assert_kept("src/main.rs", "use crate::report::Y;");
    assert_kept(
        "src/model/a.rs",
        "fn f() {}\n#[cfg(test)]\nmod tests {\n    use crate::solve::X;\n}\n",
    );
}

#[test]
fn text_that_is_not_code_is_ignored() {
    assert_kept("src/field/a.rs", "// crate::solve\n/* unsafe crate::mesh */ fn f<'a>() {}");
    assert_kept(
        "src/field/a.rs",
        r#"const A: &str = "\" unsafe crate::solve"; const B: char = '"';"#,
    );
    assert_kept(
        "src/field/a.rs",
        "const A: &str = r#\"\" unsafe println!\"#; const B: char = '\\'';",
    );
    assert_broken("src/field/a.rs", "const A: char = '\"'; unsafe fn f() {} // \"", "`unsafe`");
    assert_broken("src/field/a.rs", "fn f<'a>(x: &'a str) { unsafe {} }", "`unsafe`");
}

#[test]
fn unsafe_outside_a_wrapper_is_reported() {
    let calling = "fn f() { unsafe { petsc_sys::f() } }";
    assert_kept("src/solve/petsc/library/handle.rs", calling);
    assert_kept("ffi/petsc-sys/src/lib.rs", "unsafe extern \"C\" {}");
    assert_broken("src/solve/petsc/mod.rs", calling, "`unsafe`");
    assert_broken("src/solve/native.rs", calling, "`unsafe`");
    assert_broken("src/batch/mod.rs", "use petsc_sys::X;", "petsc_sys");
}

#[test]
fn a_room_that_prints_or_opens_files_is_reported() {
    assert_broken("src/model/a.rs", "fn f() { println!(); }", "`println!`");
    assert_broken("src/math/a.rs", "fn f() { eprintln!(); }", "`eprintln!`");
    assert_broken("src/batch/a.rs", "use std::fs;", "`std::fs`");
    assert_broken("src/batch/a.rs", "use std::{fs, io};\nfn f() { fs::write(); }", ":2: `fs::`");
    assert_broken("src/mesh/a.rs", "use std::process::Command;", "`process::Command`");
    assert_broken("src/study/a.rs", "use indicatif::ProgressBar;", "`indicatif`");
    assert_broken("src/scene/a.rs", "fn f() { eprintln!(); }", "`eprintln!`");
    assert_broken("src/verify/a.rs", "fn f() { std::io::stdout(); }", "`stdout`");
    assert_kept("src/study/a.rs", "use std::fs;");
    assert_kept("src/report/a.rs", "use std::fs;");
    assert_kept("src/cli/a.rs", "fn f() { println!(); }");
}

#[test]
fn a_solver_that_knows_geometry_is_reported() {
    assert_broken("src/solve/a.rs", "fn f(mesh: &TriangleMesh) {}", "never heard of a triangle");
    assert_kept("src/solve/a.rs", "/// The lower triangle.\nfn lower_triangle() {}");
    assert_kept("src/model/a.rs", "fn f(triangle: [u32; 3]) {}");
}

#[test]
fn an_evolution_that_knows_phenotypes_is_reported() {
    assert_broken("src/evolve/a.rs", "use crate::genome::Network;", "what a genome stands for");
    assert_broken("src/evolve/a.rs", "fn f() { r.express(&g) }", "what a genome stands for");
    assert_kept("src/evolve/a.rs", "use crate::genome::Representation; // Network");
    assert_kept("src/evolve/a_tests.rs", "fn f() { r.express(&g) }");
    assert_kept("src/fitness/a.rs", "fn f() { r.express(&g) }");
}

#[test]
fn a_decorator_by_hand_is_reported() {
    let by_hand = "impl System for Held<'_> {}";
    assert_broken("src/solve/a.rs", by_hand, "`Decorator`");
    assert_broken("src/solve/a.rs", "impl<S> LoadedSystem for Held<S> {}", "`Decorator`");
    assert_kept("src/solve/a.rs", "impl Decorator for Held<'_> {}");
    assert_kept("src/solve/decorator.rs", by_hand);
    assert_kept("src/solve/test_systems.rs", by_hand);
    assert_kept("src/model/a.rs", by_hand);
}

#[test]
fn unfinished_and_overlong_files_are_reported() {
    assert_broken("src/mesh/a.rs", "// TODO later", "`TODO`");
    assert_broken("build.rs", "// FIXME", "`FIXME`");
    assert_broken("ffi/a/src/lib.rs", "fn f() { todo!() }", "`todo`");
    assert_broken("src/mesh/a.rs", "fn f() { unimplemented!(\"x\") }", "`unimplemented`");
    assert_kept("src/mesh/a.rs", "fn f(todo: u32) {}");
    assert_broken("tests/a.rs", &"\n".repeat(LONGEST_FILE + 1), "601 lines");
    assert_kept("tests/a.rs", &"\n".repeat(LONGEST_FILE));
}
