//! How a law of rubber is written in a run or scene file.

use super::incompressible_law::IncompressibleLaw;
use super::keys::{InvalidMaterial, Key, LawKeys};

/// A law as a run or scene file names it.
pub(super) trait NamedLaw: IncompressibleLaw + Sized {
    /// Its name.
    const NAME: &'static str;

    /// The keys of its own numbers; `bulk_modulus` is every rubber's.
    const KEYS: &'static [Key];

    /// What it wants, for the lines that say that something is missing or surplus.
    const WANTS: &'static str;

    /// The law with the numbers of a file.
    ///
    /// # Errors
    /// [`InvalidMaterial`] when a number is missing or can be none of this law.
    fn read(keys: &LawKeys<'_>) -> Result<Self, InvalidMaterial>;

    /// The law with the numbers of a file, and its bulk modulus, MPa, where there is one.
    ///
    /// # Errors
    /// As [`Self::read`]; and when a key is surplus, or the volume is softer than the laws are tested for.
    fn read_with_bulk_modulus(keys: &LawKeys<'_>) -> Result<(Self, Option<f64>), InvalidMaterial> {
        let own = Self::KEYS.iter().map(|key| key.name);
        keys.allow(&own.chain([BULK_MODULUS.name]).collect::<Vec<_>>())?;
        let law = Self::read(keys)?;
        let bulk_modulus = bulk_modulus(&law, keys)?;
        Ok((law, bulk_modulus))
    }
}

/// The bulk modulus that a file gives a rubber, MPa, where there is one.
///
/// # Errors
/// [`InvalidMaterial`] when the volume is softer than the laws are tested for.
pub(super) fn bulk_modulus(
    law: &impl IncompressibleLaw,
    keys: &LawKeys<'_>,
) -> Result<Option<f64>, InvalidMaterial> {
    if !keys.has(BULK_MODULUS.name) {
        return Ok(None);
    }
    let bulk_modulus = keys.positive(BULK_MODULUS.name)?;
    let least = SOFTEST_VOLUME * law.shear_modulus();
    if bulk_modulus >= least {
        return Ok(Some(bulk_modulus));
    }
    Err(InvalidMaterial::from(format!(
        "[material] bulk_modulus is {bulk_modulus:?}, but it must be at least {least:.3}, {SOFTEST_VOLUME} of the shear modulus; leave it out for an incompressible wall"
    )))
}

/// The key that makes a rubber compressible.
pub(super) const BULK_MODULUS: Key =
    Key::number("bulk_modulus", "bulk modulus at rest, MPa; incompressible where it is left out");

/// Bulk over shear modulus, a Poisson's ratio of -0.29: the softest volume for which the laws are tested.
const SOFTEST_VOLUME: f64 = 0.3;
