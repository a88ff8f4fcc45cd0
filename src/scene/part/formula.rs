//! Formulas in a scene file, such as `25*sin(s*pi/180)`.
//!
//! ```text
//! sum     = product { (+ | -) product }
//! product = signed { (* | /) signed }
//! signed  = (+ | -) signed | power
//! power   = atom [ ^ signed ]                 so that -s^2 = -(s^2) and 2^3^2 = 2^9
//! atom    = number | name | function ( sum ) | ( sum )
//! ```
//!
//! # Decisions
//! No crate: exmex 0.21 takes `sqrt(a + b - c*d + e)` for another number, meval and fasteval are no longer kept up, and
//! evalexpr is under the AGPL.

use std::f64::consts::PI;

use anyhow::{anyhow, bail, ensure};

/// A number that depends on a few others.
#[derive(Clone, Debug)]
pub(crate) struct Formula(Node);

#[derive(Clone, Debug)]
enum Node {
    Number(f64),
    /// By its place among the variables.
    Variable(usize),
    Negative(Box<Node>),
    Binary(u8, Box<[Node; 2]>),
    Function(Function, Box<Node>),
}

impl Formula {
    /// The formula of `text`, which may name the `variables` and `pi`.
    ///
    /// # Errors
    /// What is wrong, with its place.
    pub(crate) fn parse(text: &str, variables: &[&str]) -> anyhow::Result<Self> {
        ensure!(text.len() <= LONGEST, "the formula has more than {LONGEST} characters");
        let mut parser = Parser { text, rest: text, variables };
        let node = parser.sum()?;
        match parser.peek() {
            None => Ok(Self(node)),
            Some(_) => Err(parser.wrong("an operator")),
        }
    }

    /// Its value at `variables`, in the order of [`Self::parse`]; not a number where it has none.
    ///
    /// # Panics
    /// When there are fewer variables than the formula names.
    pub(crate) fn value(&self, variables: &[f64]) -> f64 {
        self.0.value(variables)
    }
}

impl Node {
    fn value(&self, variables: &[f64]) -> f64 {
        match self {
            Self::Number(number) => *number,
            Self::Variable(place) => variables[*place],
            Self::Negative(node) => -node.value(variables),
            Self::Function(function, node) => function(node.value(variables)),
            Self::Binary(operator, sides) => {
                let [a, b] = [&sides[0], &sides[1]].map(|side| side.value(variables));
                match operator {
                    b'+' => a + b,
                    b'-' => a - b,
                    b'*' => a * b,
                    b'/' => a / b,
                    _ if b == 2.0 => a * a,
                    _ => a.powf(b),
                }
            }
        }
    }
}

/// Parentheses nest no deeper than a formula is long, and each takes a few frames of the stack.
const LONGEST: usize = 1000;

type Function = fn(f64) -> f64;

const FUNCTIONS: [(&str, Function); 13] = [
    ("sin", f64::sin),
    ("cos", f64::cos),
    ("tan", f64::tan),
    ("asin", f64::asin),
    ("acos", f64::acos),
    ("atan", f64::atan),
    ("sinh", f64::sinh),
    ("cosh", f64::cosh),
    ("tanh", f64::tanh),
    ("sqrt", f64::sqrt),
    ("exp", f64::exp),
    ("ln", f64::ln),
    ("abs", f64::abs),
];

struct Parser<'a> {
    text: &'a str,
    /// What has not been read yet.
    rest: &'a str,
    variables: &'a [&'a str],
}

impl<'a> Parser<'a> {
    fn sum(&mut self) -> anyhow::Result<Node> {
        self.chain(b"+-", Self::product)
    }

    fn product(&mut self) -> anyhow::Result<Node> {
        self.chain(b"*/", Self::signed)
    }

    /// Parts joined by `operators`, from the left.
    fn chain(
        &mut self,
        operators: &[u8],
        part: fn(&mut Self) -> anyhow::Result<Node>,
    ) -> anyhow::Result<Node> {
        let mut node = part(self)?;
        while let Some(operator) = self.next_of(operators) {
            node = Node::Binary(operator, Box::new([node, part(self)?]));
        }
        Ok(node)
    }

    fn signed(&mut self) -> anyhow::Result<Node> {
        match self.next_of(b"+-") {
            Some(b'-') => Ok(Node::Negative(Box::new(self.signed()?))),
            Some(_) => self.signed(),
            None => self.power(),
        }
    }

    fn power(&mut self) -> anyhow::Result<Node> {
        let base = self.atom()?;
        match self.next_of(b"^") {
            Some(operator) => Ok(Node::Binary(operator, Box::new([base, self.signed()?]))),
            None => Ok(base),
        }
    }

    fn atom(&mut self) -> anyhow::Result<Node> {
        let first = self.peek();
        if first == Some(b'(') {
            return self.parenthesis();
        }
        if first.is_some_and(|c| c.is_ascii_digit() || c == b'.') {
            return self.number();
        }
        let name = self.take_while(|c| c.is_ascii_alphanumeric() || c == b'_');
        if name.is_empty() {
            return Err(self.wrong("a number, a name or a parenthesis"));
        }
        if let Some(place) = self.variables.iter().position(|variable| *variable == name) {
            return Ok(Node::Variable(place));
        }
        if name == "pi" {
            return Ok(Node::Number(PI));
        }
        let Some((_, function)) = FUNCTIONS.iter().find(|(known, _)| *known == name) else {
            bail!(
                "`{}` names `{name}`, but a formula here knows `{}`, `pi` and the functions {}",
                self.text,
                self.variables.join("`, `"),
                FUNCTIONS.map(|(known, _)| known).join(", ")
            );
        };
        if self.peek() != Some(b'(') {
            return Err(self.wrong("an opening parenthesis"));
        }
        Ok(Node::Function(*function, Box::new(self.parenthesis()?)))
    }

    /// From an opening parenthesis to its closing one.
    fn parenthesis(&mut self) -> anyhow::Result<Node> {
        self.next_of(b"(");
        let node = self.sum()?;
        match self.next_of(b")") {
            Some(_) => Ok(node),
            None => Err(self.wrong("an operator or a closing parenthesis")),
        }
    }

    fn number(&mut self) -> anyhow::Result<Node> {
        let start = self.rest;
        self.take_while(|c| c.is_ascii_digit() || c == b'.');
        let before_exponent = self.rest;
        if self.rest.starts_with(['e', 'E']) {
            self.rest = &self.rest[1..];
            if self.rest.starts_with(['+', '-']) {
                self.rest = &self.rest[1..];
            }
            if self.take_while(|c| c.is_ascii_digit()).is_empty() {
                self.rest = before_exponent;
            }
        }
        let digits = &start[..start.len() - self.rest.len()];
        let wrong = |_| anyhow!("`{}`: `{digits}` is no number", self.text);
        digits.parse().map(Node::Number).map_err(wrong)
    }

    /// The next character that is no blank.
    fn peek(&mut self) -> Option<u8> {
        self.rest = self.rest.trim_start();
        self.rest.bytes().next()
    }

    /// Reads the next character where it is one of `wanted`.
    fn next_of(&mut self, wanted: &[u8]) -> Option<u8> {
        let found = self.peek().filter(|c| wanted.contains(c))?;
        self.rest = &self.rest[1..];
        Some(found)
    }

    fn take_while(&mut self, belongs: impl Fn(u8) -> bool) -> &'a str {
        let length = self.rest.bytes().take_while(|&c| belongs(c)).count();
        let (taken, rest) = self.rest.split_at(length);
        self.rest = rest;
        taken
    }

    fn wrong(&self, wanted: &str) -> anyhow::Error {
        let text = self.text;
        match self.rest.chars().next() {
            Some(found) => {
                let place = text[..text.len() - self.rest.len()].chars().count() + 1;
                anyhow!("`{text}` has `{found}` at place {place}, where {wanted} is wanted")
            }
            None => anyhow!("`{text}` ends where {wanted} is wanted"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(text: &str) -> f64 {
        Formula::parse(text, &["s", "t"]).unwrap().value(&[2.0, 30.0])
    }

    #[test]
    fn values_are_those_of_school() {
        for (text, exact) in [
            ("0", 0.0),
            ("s^2 - t^2", 4.0 - 900.0),
            ("-s^2 + 3*-t", -4.0 - 90.0),
            ("2^3^s", 512.0),
            ("2^-s", 0.25),
            ("2/s*t - 1 - 1", 28.0),
            ("1e-3 + 2.5E+2*t - .5", 1e-3 + 7500.0 - 0.5),
            ("(s + t)*(s - t)/ 4", -224.0),
            ("10*abs(-s)", 20.0),
        ] {
            assert_eq!(value(text), exact, "{text}");
        }
        // Sine of 30 degrees, to rounding.
        assert!((value("25*sin(t*pi/180)") - 12.5).abs() < 1e-14);
        assert!(value("sqrt(-s)").is_nan());
        // Where exmex 0.21 goes wrong.
        let nested = Formula::parse("sqrt(s^2+t^2-s^2*t^2+1e-24)", &["s", "t"]).unwrap();
        assert!((nested.value(&[0.5, 0.25]) - 0.296875_f64.sqrt()).abs() < 1e-15);
    }

    #[test]
    fn what_is_wrong_is_said_in_one_line() {
        let error = |text: &str| Formula::parse(text, &["s", "t"]).unwrap_err().to_string();
        assert!(
            error("25*sin(u)")
                .starts_with("`25*sin(u)` names `u`, but a formula here knows `s`, `t`, `pi`")
        );
        assert_eq!(error("s t"), "`s t` has `t` at place 3, where an operator is wanted");
        assert_eq!(error("s+"), "`s+` ends where a number, a name or a parenthesis is wanted");
        assert_eq!(
            error("sin s"),
            "`sin s` has `s` at place 5, where an opening parenthesis is wanted"
        );
        assert_eq!(error("1.2.3"), "`1.2.3`: `1.2.3` is no number");
        for text in ["", "25*(s", "2*)", "ß", "1e", "()", "s(t)", "s,t", "3 4", "ä+ß", "2 ß"] {
            assert_eq!(error(text).lines().count(), 1, "{text}");
        }
        assert!(error(&"(".repeat(2000)).contains("more than 1000"));
        assert!(error(&"(".repeat(1000)).contains("ends where"));
        assert!(error(&"-".repeat(1000)).contains("ends where"));
    }
}
