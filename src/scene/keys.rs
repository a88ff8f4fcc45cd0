//! The keys of the files that are read: what each means, from the doc comments of the structs behind them.
//!
//! `--print-defaults` and the page `docs/keys.md` (written by `pneumorph manual`) are made from the same [`sections`].

use std::fmt::Write;

use schemars::{JsonSchema, SchemaGenerator};
use serde_json::Value;

use crate::genome::{GENES, MATERIAL_GENES, THICKNESS_GENES};

/// A section of a file.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Section {
    /// Its name between the brackets, empty for what stands above all.
    pub name: String,
    /// Whether there may be many, written with two brackets.
    pub is_list: bool,
    pub about: String,
    pub keys: Vec<FileKey>,
}

/// A key and what it means.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FileKey {
    pub name: String,
    /// What it holds, in words.
    pub kind: String,
    pub meaning: String,
    /// As a file would say it; none where it may be left out or must be given.
    pub default: Option<String>,
}

impl Section {
    /// The line that opens it in a file.
    pub(crate) fn header(&self) -> String {
        if self.is_list { format!("[[{}]]", self.name) } else { format!("[{}]", self.name) }
    }
}

/// The sections of the file that is read as a `T`, in the order of its fields.
pub(crate) fn sections<T: JsonSchema>() -> Vec<Section> {
    let schema = SchemaGenerator::default().into_root_schema_for::<T>();
    let root = schema.as_value();
    let mut sections = Vec::new();
    add_section(
        root,
        root,
        Place { name: String::new(), is_list: false, about: String::new(), defaults: None },
        &mut sections,
    );
    sections
}

/// Where a section stands in a file.
struct Place<'a> {
    name: String,
    is_list: bool,
    about: String,
    /// What stands in it where the file leaves it out.
    defaults: Option<&'a Value>,
}

fn add_section(root: &Value, object: &Value, place: Place<'_>, sections: &mut Vec<Section>) {
    let Place { name, is_list, about, defaults } = place;
    let own = sections.len();
    let inner = |key: &str| if name.is_empty() { key.to_owned() } else { format!("{name}.{key}") };
    sections.push(Section { name: name.clone(), is_list, about, keys: Vec::new() });
    for (key, value) in object["properties"].as_object().into_iter().flatten() {
        let target = resolved(root, value);
        let own_default = value.get("default").filter(|default| !default.is_null());
        let default = own_default.or_else(|| defaults?.get(key));
        let items = target.get("items").map(|items| resolved(root, items));
        let is_object = |schema: &Value| schema.get("properties").is_some();
        let meaning = description(value).or_else(|| description(target)).unwrap_or_default();
        let section = [(Some(target), false), (items, true)];
        let section = section.into_iter().find_map(|(schema, is_list)| {
            schema.filter(|schema| is_object(schema)).map(|schema| (schema, is_list))
        });
        if let Some((schema, is_list)) = section {
            let about = description(value).or_else(|| description(schema)).unwrap_or_default();
            let place = Place { name: inner(key), is_list, about, defaults: default };
            add_section(root, schema, place, sections);
            continue;
        }
        sections[own].keys.push(FileKey {
            name: key.clone(),
            kind: kind(root, target),
            meaning: with_words(root, target, meaning),
            default: default.filter(|default| !default.is_null()).map(in_toml),
        });
    }
}

/// The schema behind references and what may be left out.
fn resolved<'a>(root: &'a Value, schema: &'a Value) -> &'a Value {
    if let Some(reference) = schema["$ref"].as_str() {
        let name = reference.rsplit('/').next().unwrap_or_default();
        return resolved(root, &root["$defs"][name]);
    }
    let choices = schema["anyOf"].as_array().map(Vec::as_slice).unwrap_or_default();
    let mut given = choices.iter().filter(|choice| choice["type"] != "null");
    match (given.next(), given.next()) {
        (Some(only), None) => resolved(root, only),
        _ => schema,
    }
}

/// The first paragraph of a doc comment in one line.
fn description(schema: &Value) -> Option<String> {
    let text = schema["description"].as_str()?;
    let paragraph = text.split("\n\n").next()?;
    let line = paragraph.split_whitespace().collect::<Vec<_>>().join(" ");
    Some(line.replace("[`", "`").replace("`]", "`"))
}

/// What a value looks like.
fn kind(root: &Value, schema: &Value) -> String {
    if schema.get("oneOf").is_some() || schema.get("enum").is_some() {
        return "word".to_owned();
    }
    if let Some(choices) = schema["anyOf"].as_array() {
        let kinds = choices.iter().map(|choice| kind(root, resolved(root, choice)));
        return kinds.collect::<Vec<_>>().join(" or ");
    }
    let types: Vec<&str> = match &schema["type"] {
        Value::String(one) => vec![one],
        Value::Array(many) => many.iter().filter_map(Value::as_str).collect(),
        _ => Vec::new(),
    };
    match types.iter().find(|kind| **kind != "null") {
        Some(&"number") => "number".to_owned(),
        Some(&"integer") => "whole number".to_owned(),
        Some(&"boolean") => "true or false".to_owned(),
        Some(&"string") => "text".to_owned(),
        Some(&"object") => "names with values".to_owned(),
        Some(&"array") => {
            let of = schema.get("items").map(|items| kind(root, resolved(root, items)));
            let of = of.map_or_else(|| "list".to_owned(), |of| format!("list of {of}s"));
            match schema["maxItems"].as_u64() {
                Some(many) => of.replacen("list of", &format!("{many}"), 1),
                None => of,
            }
        }
        _ => "value".to_owned(),
    }
}

/// A meaning with the words that may stand there, and what they mean.
fn with_words(root: &Value, schema: &Value, meaning: String) -> String {
    let schema = match schema.get("items") {
        Some(items) => resolved(root, items),
        None => schema,
    };
    let mut words: Vec<String> = Vec::new();
    let names = |choice: &Value| -> Vec<String> {
        let list = choice["enum"].as_array().cloned().unwrap_or_default();
        let all = list.into_iter().chain(choice.get("const").cloned());
        all.filter_map(|word| word.as_str().map(ToOwned::to_owned)).collect()
    };
    for choice in schema["oneOf"].as_array().into_iter().flatten().chain([schema]) {
        let about = choice.get("const").and_then(|_| description(choice));
        for word in names(choice) {
            words.push(match &about {
                Some(about) => format!("`{word}`: {}", about.trim_end_matches('.')),
                None => format!("`{word}`"),
            });
        }
    }
    if words.is_empty() {
        return meaning;
    }
    format!("{} One of {}.", sentence(&meaning), words.join("; "))
}

/// The `text` with a full stop, if it has none.
pub(crate) fn sentence(text: &str) -> String {
    let text = text.trim_end();
    if text.ends_with('.') || text.is_empty() { text.to_owned() } else { format!("{text}.") }
}

fn in_toml(value: &Value) -> String {
    match value {
        Value::String(text) => format!("{text:?}"),
        Value::Array(items) => {
            format!("[{}]", items.iter().map(in_toml).collect::<Vec<_>>().join(", "))
        }
        other => other.to_string(),
    }
}

/// The TOML text of a file's `defaults` with the meaning of every key of its `sections` beside it: those without a default
/// and whole sections that may be left out stand as comments.
pub(crate) fn annotated(defaults: &str, sections: &[Section]) -> String {
    let mut text = String::new();
    let mut told: Vec<&str> = Vec::new();
    let mut open = "";
    let named = |name: &str| sections.iter().find(|section| section.name == name);
    let mut lines = defaults.lines().peekable();
    while let Some(line) = lines.next() {
        let header = line.strip_prefix('[').and_then(|rest| rest.strip_suffix(']'));
        if let Some(name) = header {
            open = name;
            told.push(name);
            if let Some(section) = named(name) {
                push(&mut text, format_args!("# {}", section.about));
            }
            push(&mut text, format_args!("{line}"));
        } else if let Some((key, _)) = line.split_once(" = ") {
            let key = named(open).and_then(|section| section.keys.iter().find(|it| it.name == key));
            let meaning = key.map_or_else(|| gene(open, line), |key| Some(key.meaning.clone()));
            match meaning {
                Some(meaning) => push(&mut text, format_args!("{line}  # {meaning}")),
                None => push(&mut text, format_args!("{line}")),
            }
        }
        let ends = lines.peek().is_none_or(|next| next.is_empty() || next.starts_with('['));
        if ends && !line.is_empty() {
            let without = named(open).map(|section| section.keys.as_slice()).unwrap_or_default();
            let block = defaults_of(defaults, open);
            for key in without.iter().filter(|key| !block.contains(&key.name.as_str())) {
                push(&mut text, format_args!("# {} = ..  # {}", key.name, key.meaning));
            }
            text.push('\n');
        }
    }
    for section in sections.iter().filter(|it| !it.name.is_empty() && !told.contains(&&*it.name)) {
        push(&mut text, format_args!("# {} may be left out: {}", section.header(), section.about));
        for FileKey { name, meaning, default, .. } in &section.keys {
            let default = default.as_ref().map_or("..", |default| default);
            push(&mut text, format_args!("#     {name} = {default}  # {meaning}"));
        }
    }
    text
}

/// The keys that the TOML text `defaults` gives in the section `name`.
fn defaults_of<'a>(defaults: &'a str, name: &str) -> Vec<&'a str> {
    let header = format!("[{name}]");
    let lines = defaults.lines().skip_while(|line| !name.is_empty() && *line != header);
    let lines = lines.skip(usize::from(!name.is_empty())).take_while(|line| !line.starts_with('['));
    lines.filter_map(|line| line.split_once(" = ").map(|(key, _)| key)).collect()
}

/// What the gene of a line of `[genes]` is.
fn gene(section: &str, line: &str) -> Option<String> {
    let name = line.split_once(" = ").filter(|_| section == "genes")?.0;
    let of_wall = THICKNESS_GENES.iter().chain(&MATERIAL_GENES);
    GENES.iter().chain(of_wall).find(|gene| gene.name == name).map(|gene| gene.meaning.to_owned())
}

fn push(text: &mut String, line: std::fmt::Arguments<'_>) {
    writeln!(text, "{line}").expect("writing to a string does not fail");
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::scene_file::SceneFile;

    #[test]
    fn defaults_stay_as_they_are_between_their_meanings() {
        let scene = sections::<SceneFile>();
        let plain = "[part]\nnetwork = \"n.toml\"\n\n[wall]\nthickness = 1.6\n";
        let text = annotated(plain, &scene);
        let bare: String = text
            .lines()
            .filter(|line| !line.starts_with('#'))
            .map(|line| line.split("  # ").next().unwrap_or_default().to_owned() + "\n")
            .collect();
        assert_eq!(bare, format!("{plain}\n"));
        assert!(text.contains("\n# stl = ..  # "), "{text}");
        assert!(text.contains("\nthickness = 1.6  # Wall thickness, mm"), "{text}");
        assert!(text.contains("\n# [[plane]] may be left out: "), "{text}");
    }
}
