//! The state of a run between two generations, kept so that a killed run goes on with the same bits.
//!
//! ```text
//! checkpoint-000012.json   line 1  {"format":"pneumorph checkpoint","version":1,"generation":12,"checksum":"..."}
//!                          line 2  the state, as JSON; the checksum is FNV-1a (64 bit) of its bytes
//! ```
//!
//! The two newest are kept: when the newest is damaged, the one before it is loaded and the damage told.
//! Finite floats come back with the same bits; JSON has no form for the others, and [`save`] refuses
//! a state that could not be loaded again.

use std::fs;
use std::path::{Path, PathBuf};

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::{InputError, OutputError, atomic, checksum, input};

/// A state read from a checkpoint.
#[derive(Clone, Debug, PartialEq)]
pub struct Checkpoint<T> {
    /// The generation after which it was saved.
    pub generation: u64,
    /// The state.
    pub state: T,
    /// Newer checkpoints that could not be used, and why; newest first.
    pub damaged: Vec<InputError>,
}

/// Saves `state` after `generation` into `folder` and removes all but the two newest checkpoints up to it.
///
/// # Errors
/// [`OutputError::Unwritable`] when the state would not load again (a NaN or an infinity);
/// [`OutputError::Write`] when the file system refuses.
pub fn save<T>(folder: &Path, generation: u64, state: &T) -> Result<(), OutputError>
where
    T: Serialize + DeserializeOwned,
{
    let path = file(folder, generation);
    let unwritable = |error: serde_json::Error| OutputError::unwritable(&path, &error);
    let body = serde_json::to_vec(state).map_err(unwritable)?;
    serde_json::from_slice::<T>(&body).map_err(unwritable)?;
    let header = Header {
        format: FORMAT.to_owned(),
        version: VERSION,
        generation,
        checksum: checksum::written(&body),
    };
    let mut bytes = serde_json::to_vec(&header).map_err(unwritable)?;
    bytes.push(b'\n');
    bytes.extend(body);
    bytes.push(b'\n');
    atomic::write(&path, &bytes)?;

    let older = generations(folder).map_err(|source| OutputError::write(folder, source))?;
    for old in older.into_iter().filter(|&old| old < generation).skip(KEPT - 1) {
        let old = file(folder, old);
        fs::remove_file(&old).map_err(|source| OutputError::write(&old, source))?;
    }
    Ok(())
}

/// The newest usable checkpoint in `folder`; `None` when there has never been one.
///
/// # Errors
/// [`InputError`] when the folder cannot be read, or holds checkpoints of which none is usable.
pub fn load_latest<T: DeserializeOwned>(
    folder: &Path,
) -> Result<Option<Checkpoint<T>>, InputError> {
    match load_usable(folder)? {
        Ok(checkpoint) => Ok(Some(checkpoint)),
        Err(damaged) if damaged.is_empty() => Ok(None),
        Err(damaged) => {
            let reasons: Vec<_> = damaged.iter().map(ToString::to_string).collect();
            let what = format!("no usable checkpoint: {}", reasons.join("; "));
            Err(InputError::new(folder, what))
        }
    }
}

/// The newest usable checkpoint in `folder`, or why those that are there cannot be used, newest first.
///
/// # Errors
/// [`InputError`] when the folder cannot be read.
pub fn load_usable<T: DeserializeOwned>(
    folder: &Path,
) -> Result<Result<Checkpoint<T>, Vec<InputError>>, InputError> {
    let generations = generations(folder).map_err(|e| InputError::unreadable(folder, &e))?;
    let mut damaged = Vec::new();
    for generation in generations {
        match load(&file(folder, generation)) {
            Ok(state) => return Ok(Ok(Checkpoint { generation, state, damaged })),
            Err(error) => damaged.push(error),
        }
    }
    Ok(Err(damaged))
}

fn load<T: DeserializeOwned>(path: &Path) -> Result<T, InputError> {
    let bytes = input::bytes(path, input::DATA)?;
    let invalid = |what: &str| InputError::new(path, what);
    let end = bytes.iter().position(|&byte| byte == b'\n').ok_or_else(|| invalid("no header"))?;
    let header: Header = serde_json::from_slice(&bytes[..end])
        .map_err(|error| invalid(&format!("not a checkpoint: {error}")))?;
    if header.format != FORMAT || header.version != VERSION {
        let Header { format, version, .. } = header;
        return Err(invalid(&format!("is {format} version {version}, not {FORMAT} {VERSION}")));
    }
    let body = bytes[end + 1..].strip_suffix(b"\n").ok_or_else(|| invalid("is cut off"))?;
    if header.checksum != checksum::written(body) {
        return Err(invalid("the checksum does not fit the state"));
    }
    serde_json::from_slice(body).map_err(|error| invalid(&format!("the state: {error}")))
}

const FORMAT: &str = "pneumorph checkpoint";
const VERSION: u32 = 1;
const KEPT: usize = 2;

#[derive(Serialize, Deserialize)]
struct Header {
    format: String,
    version: u32,
    generation: u64,
    checksum: String,
}

fn file(folder: &Path, generation: u64) -> PathBuf {
    folder.join(format!("checkpoint-{generation:06}.json"))
}

/// The generations of which `folder` holds a checkpoint, newest first.
fn generations(folder: &Path) -> std::io::Result<Vec<u64>> {
    let mut generations: Vec<u64> = Vec::new();
    for entry in fs::read_dir(folder)? {
        let name = entry?.file_name();
        let number = name
            .to_str()
            .and_then(|name| name.strip_prefix("checkpoint-")?.strip_suffix(".json"))
            .and_then(|number| number.parse::<u64>().ok());
        generations.extend(number);
    }
    generations.sort_unstable_by(|a, b| b.cmp(a));
    Ok(generations)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
    struct State {
        genes: Vec<f64>,
        seed: u64,
    }

    fn state(generation: u64) -> State {
        State { genes: vec![0.1 * generation as f64, -1.0 / 3.0], seed: u64::MAX - generation }
    }

    #[test]
    fn the_newest_of_the_last_two_is_loaded() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(load_latest::<State>(folder.path()).unwrap(), None);
        for generation in 8..=11 {
            save(folder.path(), generation, &state(generation)).unwrap();
        }
        assert_eq!(generations(folder.path()).unwrap(), [11, 10]);
        let loaded = load_latest::<State>(folder.path()).unwrap().unwrap();
        assert_eq!(loaded, Checkpoint { generation: 11, state: state(11), damaged: vec![] });
    }

    #[test]
    fn every_flipped_byte_and_every_cut_falls_back_to_the_one_before() {
        let folder = tempfile::tempdir().unwrap();
        save(folder.path(), 1, &state(1)).unwrap();
        save(folder.path(), 2, &state(2)).unwrap();
        let newest = file(folder.path(), 2);
        let whole = fs::read(&newest).unwrap();
        let body = whole.iter().position(|&byte| byte == b'\n').unwrap() + 1;
        let flipped = (body..whole.len()).map(|at| {
            let mut bytes = whole.clone();
            bytes[at] ^= 1;
            bytes
        });
        for bytes in flipped.chain((0..whole.len()).map(|cut| whole[..cut].to_vec())) {
            fs::write(&newest, bytes).unwrap();
            let loaded = load_latest::<State>(folder.path()).unwrap().unwrap();
            assert_eq!((loaded.generation, loaded.state), (1, state(1)));
            assert_eq!(loaded.damaged.len(), 1);
            assert_eq!(loaded.damaged[0].path, newest);
        }
        fs::write(file(folder.path(), 1), "{}\n").unwrap();
        let error = load_latest::<State>(folder.path()).unwrap_err().to_string();
        assert!(error.contains("no usable checkpoint") && !error.contains('\n'), "{error}");
    }

    #[test]
    fn going_on_from_an_older_checkpoint_replaces_the_damaged_one() {
        let folder = tempfile::tempdir().unwrap();
        for generation in 1..=3 {
            save(folder.path(), generation, &state(generation)).unwrap();
        }
        fs::write(file(folder.path(), 3), "damaged").unwrap();
        save(folder.path(), 3, &state(3)).unwrap();
        let loaded = load_latest::<State>(folder.path()).unwrap().unwrap();
        assert_eq!(loaded, Checkpoint { generation: 3, state: state(3), damaged: vec![] });
    }

    #[test]
    fn a_state_that_could_not_be_loaded_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let broken = State { genes: vec![f64::INFINITY], seed: 0 };
        let error = save(folder.path(), 1, &broken).unwrap_err();
        assert!(matches!(error, OutputError::Unwritable { .. }), "{error}");
        assert_eq!(generations(folder.path()).unwrap(), [0_u64; 0]);
    }

    proptest! {
        #[test]
        fn floats_come_back_with_the_same_bits(bits in prop::collection::vec(any::<u64>(), 64)) {
            let genes: Vec<_> = bits.into_iter().map(f64::from_bits).filter(|x| x.is_finite()).collect();
            let text = serde_json::to_vec(&genes).unwrap();
            let back: Vec<f64> = serde_json::from_slice(&text).unwrap();
            let bits = |values: &[f64]| values.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
            prop_assert_eq!(bits(&back), bits(&genes));
        }
    }
}
