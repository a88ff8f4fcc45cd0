//! Pneumatic soft actuators designed by evolution.
//!
//! The rooms, in the one direction that data moves (a room names only rooms to its left):
//! `genome -> field -> surface -> mesh -> model -> solve -> fitness -> batch -> evolve -> printing -> report`.
//! `ARCHITECTURE.md` says what each room answers and what it must never know.

pub mod math;

pub mod genome;

pub mod field;

pub mod surface;

pub mod mesh;

pub mod model;

pub mod solve;

pub mod fitness;

pub mod batch;

pub mod evolve;

pub mod printing;

pub mod io;

pub mod report;

#[cfg(feature = "monitor")]
pub mod monitor;

pub mod scene;

pub mod study;

pub mod verify;

pub mod cli;
