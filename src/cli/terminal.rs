//! What a person reads in a terminal: every line of the program goes through here.
//!
//! Files give names and words, and a terminal obeys some characters instead of showing them: those are shown by their numbers, and a line
//! about something wrong has a length that is read.

use std::borrow::Cow;
use std::io::Write;

/// Prints `text` for the user; a closed pipe ends the listening, not the work.
pub(super) fn say(text: &str) {
    let _ = writeln!(std::io::stdout(), "{}", harmless(text.trim_end()));
}

/// Prints `text` for whoever watches, where the answer itself is for a program.
pub(super) fn narrate(text: &str) {
    let _ = writeln!(std::io::stderr(), "{}", harmless(text.trim_end()));
}

/// Prints one line about something wrong.
pub(super) fn warn(line: &str) {
    let _ = writeln!(std::io::stderr(), "pneumorph: {}", shortened(&one_line(line)));
}

/// A line is cut where it is longer, in characters: its beginning and its end tell most.
const LONGEST: usize = 600;
const BEGINNING: usize = 400;
const END: usize = 150;

fn shortened(line: &str) -> Cow<'_, str> {
    let count = line.chars().count();
    if count <= LONGEST {
        return line.into();
    }
    let place = |character: usize| {
        line.char_indices().nth(character).map_or(line.len(), |(place, _)| place)
    };
    let (beginning, end) = (&line[..place(BEGINNING)], &line[place(count - END)..]);
    format!("{beginning} [... {} characters ...] {end}", count - BEGINNING - END).into()
}

fn one_line(text: &str) -> String {
    let words: Vec<&str> = text.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
    harmless(&words.join("; ")).replace('\t', " ")
}

/// The text with the numbers of characters that a terminal obeys, but for ends of lines and tabs.
fn harmless(text: &str) -> Cow<'_, str> {
    if !text.contains(is_obeyed) {
        return text.into();
    }
    let mut shown = String::with_capacity(text.len());
    for character in text.chars() {
        if is_obeyed(character) {
            shown.extend(character.escape_unicode());
        } else {
            shown.push(character);
        }
    }
    shown.into()
}

/// Controls, and the marks that turn the direction of writing or end a line.
fn is_obeyed(character: char) -> bool {
    let turns = matches!(
        character,
        '\u{200e}' | '\u{200f}' | '\u{2028}' | '\u{2029}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}' | '\u{feff}'
    );
    turns || character.is_control() && character != '\n' && character != '\t'
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_terminal_would_obey_is_shown() {
        let title = "\u{1b}]0;owned\u{7}\u{9b}31m\u{202e}";
        assert_eq!(harmless(title), "\\u{1b}]0;owned\\u{7}\\u{9b}31m\\u{202e}");
        assert_eq!(harmless("Körper 1\n\tµ = 2"), "Körper 1\n\tµ = 2");
        assert_eq!(one_line("a\r\n  b\tc\n\nd"), "a; b c; d");
    }

    #[test]
    fn long_lines_keep_their_beginning_and_their_end() {
        let line = format!("unknown key `{}`; did you mean `edge`?", "ä".repeat(1_000_000));
        let shown = shortened(&line);
        assert!(shown.starts_with("unknown key `ää") && shown.ends_with("did you mean `edge`?"));
        assert!(shown.contains("[... 999486 characters ...]"), "{shown}");
        assert_eq!(shortened(&"a".repeat(LONGEST)), "a".repeat(LONGEST));
    }
}
