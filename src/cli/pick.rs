//! `pick`: the design of a run that does most of one thing among those that do enough of others.

use std::path::PathBuf;

use super::terminal::say;
use crate::study::pick::{Aim, Bound, Phrases, Quantity, Wish, pick};

/// What was asked on the command line.
#[derive(Debug, clap::Args)]
pub(super) struct Pick {
    /// The folder of a run.
    run: PathBuf,
    /// What is wished, such as "at least 20 N, most angle": `at least` and `at most` with a number, `most` or `least` of one thing.
    /// Known are angle (deg), force (N), F_c, F_bf, merit and further objectives.
    #[arg(value_parser = Phrases::parse)]
    wish: Option<Phrases>,
    /// A bound more, such as "force 20".
    #[arg(long, value_parser = |text: &str| Bound::parse(text, true))]
    at_least: Vec<Bound>,
    /// A bound more, such as "angle 90".
    #[arg(long, value_parser = |text: &str| Bound::parse(text, false))]
    at_most: Vec<Bound>,
    /// What there should be most of.
    #[arg(long, value_parser = Quantity::named)]
    most: Option<Quantity>,
    /// What there should be least of.
    #[arg(long, value_parser = Quantity::named)]
    least: Option<Quantity>,
    /// Look at every design that was evaluated, not at the front alone; only the front's designs have files.
    #[arg(long)]
    all: bool,
    /// Print the design as JSON instead of words.
    #[arg(long)]
    json: bool,
}

impl Pick {
    /// Finds the design and tells it.
    pub(super) fn run(&self) -> anyhow::Result<()> {
        let picked = pick(&self.run, &Wish::new(self.phrases())?, self.all)?;
        say(&if self.json { serde_json::to_string_pretty(&picked)? } else { picked.in_words() });
        Ok(())
    }

    /// What all arguments say together.
    fn phrases(&self) -> Phrases {
        let mut phrases = self.wish.clone().unwrap_or_default();
        phrases.bounds.extend(self.at_least.iter().chain(&self.at_most).cloned());
        for (quantity, is_most) in [(&self.most, true), (&self.least, false)] {
            phrases.aims.extend(quantity.iter().cloned().map(|quantity| Aim { quantity, is_most }));
        }
        phrases
    }
}
