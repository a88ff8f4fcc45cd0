//! How long a command goes on: to its end, to its time limit, or to the first signal that asks it to stop.
//!
//! A first SIGINT (Ctrl-C) or SIGTERM asks: what has ended is written, and the exit code is 3. A second one ends the process
//! at once, with the exit codes of a shell, 130 and 143.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use anyhow::Context;
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

use crate::study::Limits;

/// Who may ask a command to stop.
#[derive(Clone, Debug)]
pub(super) struct Patience {
    told: Arc<AtomicBool>,
    deadline: Option<Instant>,
}

impl Patience {
    /// Listens to signals, and to the clock for the time limit.
    pub(super) fn new(time_limit: Option<Duration>) -> anyhow::Result<Self> {
        let told = Arc::new(AtomicBool::new(false));
        for (signal, code) in [(SIGINT, 130), (SIGTERM, 143)] {
            let listen = || -> std::io::Result<()> {
                // In this order: the second signal finds what the first has set.
                flag::register_conditional_shutdown(signal, code, told.clone())?;
                flag::register(signal, told.clone())?;
                Ok(())
            };
            listen().context("cannot listen to signals")?;
        }
        let deadline = time_limit.and_then(|limit| Instant::now().checked_add(limit));
        Ok(Self { told, deadline })
    }
}

impl Limits for Patience {
    fn is_over(&self) -> bool {
        self.is_interrupted() || self.deadline.is_some_and(|deadline| Instant::now() >= deadline)
    }

    fn is_interrupted(&self) -> bool {
        self.told.load(Ordering::Relaxed)
    }
}

/// Parses a span of time as people (`55m`, `1h30m`) and Slurm write it: `minutes`, `minutes:seconds`, `hours:minutes:seconds`,
/// `days-hours`, `days-hours:minutes`, `days-hours:minutes:seconds`.
pub(super) fn time_limit(text: &str) -> Result<Duration, String> {
    let wrong = || {
        "a time is 55m or 1h30m, or as Slurm has it: minutes, MM:SS, HH:MM:SS, D-HH, D-HH:MM, D-HH:MM:SS"
            .to_owned()
    };
    if !text.chars().all(|c| c.is_ascii_digit() || c == ':' || c == '-') {
        return humantime::parse_duration(text).map_err(|_| wrong());
    }
    let number = |text: &str| text.parse::<u64>().ok();
    let numbers = |text: &str| text.split(':').map(number).collect::<Option<Vec<_>>>();
    let (days, clock) = match text.split_once('-') {
        Some((days, clock)) => (Some(number(days).ok_or_else(wrong)?), clock),
        None => (None, text),
    };
    let clock = numbers(clock).ok_or_else(wrong)?;
    let parts = match (days, &clock[..]) {
        (None, &[minutes]) => [0, 0, minutes, 0],
        (None, &[minutes, seconds]) => [0, 0, minutes, seconds],
        (None, &[hours, minutes, seconds]) => [0, hours, minutes, seconds],
        (Some(days), &[hours]) => [days, hours, 0, 0],
        (Some(days), &[hours, minutes]) => [days, hours, minutes, 0],
        (Some(days), &[hours, minutes, seconds]) => [days, hours, minutes, seconds],
        _ => return Err(wrong()),
    };
    let seconds = parts
        .iter()
        .zip([86_400, 3600, 60, 1])
        .try_fold(0_u64, |sum, (part, unit)| sum.checked_add(part.checked_mul(unit)?));
    seconds.map(Duration::from_secs).ok_or_else(wrong)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The formats of sbatch(1), option --time, and those of people.
    #[test]
    fn times_are_read_as_slurm_and_people_write_them() {
        let minute = 60;
        let hour = 60 * minute;
        for (text, seconds) in [
            ("55m", 55 * minute),
            ("1h30m", 90 * minute),
            ("1h 30m", 90 * minute),
            ("90", 90 * minute),
            ("5:30", 5 * minute + 30),
            ("1:02:03", hour + 2 * minute + 3),
            ("24:00:00", 24 * hour),
            ("2-3", 51 * hour),
            ("1-00:30", 24 * hour + 30 * minute),
            ("1-01:01:01", 25 * hour + minute + 1),
        ] {
            assert_eq!(time_limit(text), Ok(Duration::from_secs(seconds)), "{text}");
        }
        assert_eq!(time_limit("1ms"), Ok(Duration::from_millis(1)));
        for wrong in [
            "",
            "-",
            ":",
            "1-",
            "-1",
            "1:",
            "1:2:3:4",
            "1-2:3:4:5",
            "1-2-3",
            "soon",
            "5 parsecs",
            "99999999999999999999",
            "999999999999999999-0",
        ] {
            assert!(time_limit(wrong).unwrap_err().contains("HH:MM:SS"), "{wrong}");
        }
    }
}
