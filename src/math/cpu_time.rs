//! Processor time of the calling thread: what a stage cost, however busy the machine was.
//!
//! Work that the thread hands to others (a `rayon` pool) is not in it.

use rustix::time::{ClockId, clock_gettime};

/// CPU time used by the calling thread since it started, s; only differences mean something.
#[must_use]
pub fn cpu_seconds() -> f64 {
    let time = clock_gettime(ClockId::ThreadCPUTime);
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}

#[cfg(test)]
mod tests {
    use std::time::{Duration, Instant};

    use super::*;

    #[test]
    fn sleeping_costs_nothing_and_working_costs_its_time() {
        let start = cpu_seconds();
        std::thread::sleep(Duration::from_millis(50));
        let slept = cpu_seconds() - start;
        // Waking up takes microseconds; a wall clock would say 50 ms.
        assert!(slept < 0.02, "{slept}");

        let (wall, start) = (Instant::now(), cpu_seconds());
        let mut value = 1.0_f64;
        while cpu_seconds() - start < 0.01 {
            value = std::hint::black_box(value).sqrt();
        }
        // A thread cannot use more CPU than wall time; 1 ms for the clocks' grain.
        assert!(wall.elapsed().as_secs_f64() > 0.009);
    }
}
