//! The program as a user runs it, one file each: its commands, and what it answers to wrong input.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod decks;
mod evolve;
mod export;
mod extremes;
mod hostile_files;
mod interrupted;
mod keys;
mod limits;
mod loads;
mod material;
mod mesh_and_report;
#[cfg(feature = "monitor")]
mod monitor;
mod own_surfaces;
mod own_tetrahedra;
mod parts;
mod pictures;
mod regions;
mod second_opinion;
mod simulate;
mod solids;
mod verify;
mod workshop;
mod wrong_files;
mod wrong_surfaces;
mod wrong_usage;
