//! Formulas in a scene file, such as `25*sin(s*pi/180)`.

use std::f64::consts::PI;

use anyhow::{anyhow, ensure};
use exmex::{Express, FlatEx};

/// A number that depends on a few others.
#[derive(Clone, Debug)]
pub(super) struct Formula {
    expression: FlatEx<f64>,
    /// For each name that occurs: its place among the variables; `pi` is after the last.
    places: Vec<usize>,
}

impl Formula {
    /// The formula of `text`, which may name the `variables` and `pi`.
    ///
    /// # Errors
    /// What the parser says, or the name that is not known.
    pub(super) fn parse(text: &str, variables: &[&str]) -> anyhow::Result<Self> {
        let wrong = |said: &str| anyhow!("`{text}` is no formula: {}", said.replace('\n', " "));
        ensure!(!text.trim().is_empty(), "the formula is empty");
        let expression = FlatEx::<f64>::parse(text).map_err(|error| wrong(error.msg()))?;
        let known = || variables.iter().copied().chain(["pi"]);
        let place = |name: &String| {
            known().position(|known| known == name).ok_or_else(|| {
                let names = known().collect::<Vec<_>>().join("`, `");
                anyhow!("`{text}` names `{name}`, but a formula here knows `{names}`")
            })
        };
        let places = expression.var_names().iter().map(place).collect::<Result<_, _>>()?;
        Ok(Self { expression, places })
    }

    /// Its value at `variables`, in the order of [`Self::parse`]; not a number where it has none.
    pub(super) fn value(&self, variables: &[f64]) -> f64 {
        let values: Vec<f64> =
            self.places.iter().map(|&i| variables.get(i).copied().unwrap_or(PI)).collect();
        self.expression.eval(&values).unwrap_or(f64::NAN)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_those_of_school() {
        let value = |text: &str| Formula::parse(text, &["s", "t"]).unwrap().value(&[2.0, 30.0]);
        assert_eq!(value("0"), 0.0);
        assert_eq!(value("s^2 - t^2"), 4.0 - 900.0);
        assert_eq!(value("-s^2 + 3*-t"), 4.0 - 90.0, "a sign binds tighter than a power here");
        assert_eq!(value("2/s*t"), 30.0);
        // Sine of 30 degrees, to rounding.
        assert!((value("25*sin(t*pi/180)") - 12.5).abs() < 1e-14);
        assert!(value("sqrt(-s)").is_nan());
    }

    #[test]
    fn what_is_wrong_is_said_in_one_line() {
        let error = |text: &str| Formula::parse(text, &["s", "t"]).unwrap_err().to_string();
        assert_eq!(
            error("25*sin(u)"),
            "`25*sin(u)` names `u`, but a formula here knows `s`, `t`, `pi`"
        );
        for text in ["", "25*(s", "s+", "s t", "sin", "2*)", "ß"] {
            let said = error(text);
            assert!(!said.is_empty() && said.lines().count() == 1, "{text}: {said}");
        }
    }
}
