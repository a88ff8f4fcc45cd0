//! The `[material]` of a law as a file says it.

use crate::model::material::{KeyValue, OgdenTerm, Rubber};

/// Figures of the numbers in the file: more than any test gives, and enough that the law keeps its answers to 1e-6.
const FIGURES: usize = 7;

/// The section `[material]` of `law`, with its line breaks.
pub(super) fn section(law: &Rubber) -> String {
    let mut text = format!("[material]\nlaw = \"{}\"\n", law.name());
    for (key, value) in law.values() {
        text += &format!("{key} = {}\n", in_toml(&value));
    }
    text
}

/// The numbers of `law` in a line.
pub(super) fn in_words(law: &Rubber) -> String {
    let values = law.values();
    let word = |(key, value): &(&str, KeyValue)| match value {
        KeyValue::Terms(terms) => {
            let term = |t: &OgdenTerm| format!("mu {:.4e}, alpha {:.4}", t.mu, t.alpha);
            terms.iter().map(term).collect::<Vec<_>>().join("; ")
        }
        KeyValue::Number(number) => format!("{key} {number:.4e}"),
        KeyValue::Triple(triple) => {
            let [a, b, c] = triple;
            format!("{key} {a:.4e}, {b:.4e}, {c:.4e}")
        }
    };
    values.iter().map(word).collect::<Vec<_>>().join(", ")
}

fn in_toml(value: &KeyValue) -> String {
    match value {
        KeyValue::Number(number) => rounded(*number),
        KeyValue::Triple(triple) => format!("[{}]", triple.map(rounded).join(", ")),
        KeyValue::Terms(terms) => {
            let term = |OgdenTerm { mu, alpha }: &OgdenTerm| {
                format!("{{ mu = {}, alpha = {} }}", rounded(*mu), rounded(*alpha))
            };
            format!("[{}]", terms.iter().map(term).collect::<Vec<_>>().join(", "))
        }
    }
}

/// A number with [`FIGURES`], written as short as that allows.
fn rounded(number: f64) -> String {
    let short: f64 = format!("{number:.*e}", FIGURES - 1).parse().expect("it was a number");
    format!("{short:?}")
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use serde::Deserialize;

    use super::*;
    use crate::io::toml_file;
    use crate::model::material::{Ogden, Yeoh};
    use crate::scene::material::MaterialSection;

    #[derive(Deserialize)]
    struct File {
        material: MaterialSection,
    }

    /// The program reads what it wrote, to the figures that were written.
    #[test]
    fn a_section_is_read_as_the_same_law() {
        let terms =
            [OgdenTerm { mu: 0.412_345_678_9, alpha: 1.3 }, OgdenTerm { mu: 3e-7, alpha: -8.0 }];
        let ogden = section(&Ogden::new(&terms).into());
        assert_eq!(
            ogden,
            "[material]\nlaw = \"ogden\"\nterms = [{ mu = 0.4123457, alpha = 1.3 }, { mu = 3e-7, alpha = -8.0 }]\n"
        );
        let yeoh = Rubber::from(Yeoh { c: [0.11, 0.02, -1e-5] });
        for (text, law) in [
            (section(&yeoh), yeoh),
            (ogden, Ogden::new(&[OgdenTerm { mu: 0.412_345_7, ..terms[0] }, terms[1]]).into()),
        ] {
            let file: File = toml_file::parse(&text, Path::new("material.toml")).unwrap();
            assert_eq!(file.material.material().unwrap(), law.into(), "{text}");
        }
    }
}
