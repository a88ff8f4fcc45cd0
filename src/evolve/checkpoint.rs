//! A run between two generations, as a file holds it.

use serde::{Deserialize, Serialize};

use super::individual::Individual;
use super::settings::Nsga2Settings;
use super::spread::Adaptation;
use crate::genome::Representation;

/// All that a run needs to go on with the same bits.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, bound = "")]
pub struct Checkpoint<R: Representation> {
    /// The layout of this record, [`Self::FORMAT`].
    pub format: u32,
    /// The run's settings; only `generations` may be changed before the run goes on.
    pub settings: Nsga2Settings,
    /// The key of the representation; checkpoints of earlier versions have none.
    #[serde(default, rename = "representation", skip_serializing_if = "Option::is_none")]
    pub key: Option<String>,
    /// What genomes are; written by the name of what it is for real vectors.
    #[serde(rename = "bounds")]
    pub representation: R,
    /// The number of objectives.
    pub objectives: usize,
    /// The number of generations told, which is that of the next generation.
    pub generation: usize,
    /// The survivors of the last generation told, the best first; none before the first.
    pub population: Vec<Individual<R::Genome>>,
    /// What the last generation has taught.
    pub adaptation: Adaptation,
}

impl<R: Representation> Checkpoint<R> {
    /// The layout that this program writes and reads.
    pub const FORMAT: u32 = 2;

    /// Whether a run can go on from it.
    ///
    /// # Errors
    /// [`InvalidCheckpoint`] when its format is another or its parts contradict each other.
    pub(super) fn check(&self) -> Result<(), InvalidCheckpoint> {
        let Self {
            format,
            settings,
            key,
            representation,
            objectives,
            generation,
            population,
            adaptation,
        } = self;
        let check = |holds: bool, sentence: &dyn Fn() -> String| {
            if holds { Ok(()) } else { Err(InvalidCheckpoint(sentence())) }
        };
        check(*format == Self::FORMAT, &|| {
            format!("its format is {format}, but this program reads {}", Self::FORMAT)
        })?;
        let expected = representation.key();
        check(key.as_ref().is_none_or(|key| key == expected), &|| {
            let found = key.as_deref().unwrap_or_default();
            format!("its genomes are of the representation `{found}`, not `{expected}`")
        })?;
        settings.validate().map_err(|invalid| InvalidCheckpoint(invalid.to_string()))?;
        check(*objectives > 0, &|| "it has no objectives".to_owned())?;
        let expected = if *generation == 0 { 0 } else { settings.population };
        check(population.len() == expected, &|| {
            let found = population.len();
            format!("it holds {found} individuals after {generation} generations, not {expected}")
        })?;
        for Individual { id, genome, evaluation } in population {
            check(representation.contains(genome), &|| {
                format!("the genome of {id} is not in the bounds")
            })?;
            check(
                evaluation.is_of(*objectives) && *evaluation == evaluation.clone().made_finite(),
                &|| format!("the evaluation of {id} is not one of {objectives} objectives"),
            )?;
        }
        let Adaptation { step, spread } = adaptation;
        check((0.0..=1.0).contains(step) && (0.0..f64::INFINITY).contains(spread), &|| {
            format!("its step is {step}, its spread {spread}")
        })
    }
}

/// A checkpoint from which no run can go on; one sentence says why.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the checkpoint cannot be used: {0}")]
pub struct InvalidCheckpoint(String);
