//! What processes of a job tell each other.

/// Bytes that one process tells another.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Message {
    /// To whom it goes, or from whom it came.
    pub rank: usize,
    /// What the bytes are; not negative.
    pub kind: i32,
    /// As they were sent.
    pub bytes: Vec<u8>,
}
