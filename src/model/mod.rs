//! What is the energy, what must vanish, and its derivative?

pub mod system;
