//! The page of all keys of scene, run and network files, in Markdown.

use std::fmt::Write;

use crate::genome::{GENES, MATERIAL_GENES, NetworkDraft, THICKNESS_GENES};
use crate::scene::keys::{FileKey, sections, sentence};
use crate::scene::scene_file::SceneFile;
use crate::study::run_file::RunFile;

/// The page of all keys, in Markdown.
pub(super) fn page() -> String {
    let mut text = INTRODUCTION.to_owned();
    let files = [
        ("Scene files", "of `simulate`, `verify` and `deck`", sections::<SceneFile>()),
        ("Run files", "of `evolve` and `certify`", sections::<RunFile>()),
        ("Network files", "of `mesh`, `certify` and `[part] network`", sections::<NetworkDraft>()),
    ];
    for (title, of, sections) in files {
        push(&mut text, format_args!("\n## {title}, {of}"));
        for section in &sections {
            if section.keys.is_empty() && section.name.is_empty() {
                continue;
            }
            if !section.name.is_empty() {
                push(&mut text, format_args!("\n### `{}`", section.header()));
            }
            if !section.about.is_empty() {
                push(&mut text, format_args!("\n{}", sentence(&section.about)));
            }
            if section.keys.is_empty() {
                continue;
            }
            push(
                &mut text,
                format_args!("\n| key | holds | default | meaning |\n|---|---|---|---|"),
            );
            for FileKey { name, kind, meaning, default } in &section.keys {
                let default = default.as_ref().map_or_else(String::new, |text| format!("`{text}`"));
                let meaning = sentence(meaning).replace('|', "\\|");
                push(&mut text, format_args!("| `{name}` | {kind} | {default} | {meaning} |"));
            }
        }
        if title == "Run files" {
            push(&mut text, format_args!("\n### `[genes]`\n\n{GENES_TABLE}"));
            for gene in GENES.iter().chain(&THICKNESS_GENES).chain(&MATERIAL_GENES) {
                let [lower, upper] = [gene.lower, gene.upper];
                let (name, meaning) = (gene.name, gene.meaning);
                push(
                    &mut text,
                    format_args!("| `{name}` | 2 numbers | `[{lower:?}, {upper:?}]` | {meaning} |"),
                );
            }
        }
    }
    text
}

fn push(text: &mut String, line: std::fmt::Arguments<'_>) {
    writeln!(text, "{line}").expect("writing to a string does not fail");
}

const INTRODUCTION: &str = include_str!("keys_introduction.md");

const GENES_TABLE: &str = "Bounds of single genes; what is not listed keeps its own. `tx` to `tO` are there with `[pattern] thickness`, `mx` to `mO` with `[pattern] material`.

| key | holds | default | meaning |
|---|---|---|---|";

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::keys::Section;

    fn all() -> Vec<Section> {
        [sections::<SceneFile>(), sections::<RunFile>(), sections::<NetworkDraft>()].concat()
    }

    /// A key without a word is a doc comment that is missing.
    #[test]
    fn every_key_has_a_meaning() {
        for section in all() {
            assert!(section.name.is_empty() || !section.about.is_empty(), "{section:?}");
            for key in section.keys {
                let FileKey { name, kind, meaning, .. } = &key;
                assert!(!meaning.is_empty() && kind != "value", "[{}] {key:?}", section.name);
                assert!(!meaning.contains("[`"), "[{}] {name}: {meaning}", section.name);
            }
        }
    }

    /// Nested sections, lists, choices and what has no default, each from where a reader looks for it.
    #[test]
    fn sections_say_what_their_structs_say() {
        let all = all();
        let key = |section: &str, name: &str| {
            let section = all.iter().find(|it| it.name == section).unwrap();
            section
                .keys
                .iter()
                .find(|key| key.name == name)
                .unwrap_or_else(|| panic!("{name}"))
                .clone()
        };
        let thickness = key("wall", "thickness");
        assert_eq!(
            (thickness.kind.as_str(), thickness.default.as_deref()),
            ("number", Some("1.6"))
        );
        assert!(thickness.meaning.contains("mm"), "{thickness:?}");
        assert_eq!(key("part", "stl").default, None);
        assert!(key("wall", "element").meaning.contains("`mid-edge`: "));
        assert_eq!(key("part.patch", "cells").kind, "2 whole numbers");
        assert_eq!(key("load.path.newton", "tolerance").default.as_deref(), Some("1e-9"));
        assert!(key("load", "volume_mm3").meaning.contains("mm^3"));
        assert!(key("material", "bulk_modulus").meaning.contains("MPa"));
        assert!(key("material", "law").meaning.contains("ogden"));
        assert!(all.iter().any(|section| section.name == "plane" && section.is_list));
        // Former names and what only tests read are no keys.
        assert!(
            all.iter()
                .all(|it| it.name != "verify" && it.keys.iter().all(|key| key.name != "volume"))
        );
    }
}
