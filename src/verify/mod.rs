//! Agreement with published numbers: textbook shells, curves beyond stability, and scenes on which solvers come to grief.

pub(crate) mod benchmarks;
pub(crate) mod cases;
#[cfg(test)]
mod curves;
mod deviations;
pub(crate) mod files;
mod observer;
pub(crate) mod stability;
mod stability_case;

pub use self::observer::Observer;
