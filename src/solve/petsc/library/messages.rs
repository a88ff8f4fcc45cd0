//! Bytes from one rank to another.

use std::ffi::c_int;

use petsc_sys as sys;

use super::session::{Session, check, failure};
use crate::solve::{Message, SolverFailure};

impl Session {
    /// Sends `message.bytes` to the rank `message.rank`; long ones wait until it receives them.
    pub(in crate::solve) fn send(&self, message: &Message) -> Result<(), SolverFailure> {
        let length = c_int::try_from(message.bytes.len())
            .map_err(|_| failure("a message of more than 2 GiB".to_owned()))?;
        let to = message.rank as c_int;
        // SAFETY: the lock is held, MPI is running, and the bytes are there.
        check(unsafe {
            let bytes = message.bytes.as_ptr().cast();
            sys::petsc_sys_send(sys::petsc_sys_comm_world(), bytes, length, to, message.kind)
        })
    }

    /// The next message to this rank, if one waits.
    pub(in crate::solve) fn receive(&self) -> Result<Option<Message>, SolverFailure> {
        let (mut from, mut kind, mut length) = (0, 0, 0);
        // SAFETY: the lock is held, MPI is running; the bytes are as many as the message has.
        unsafe {
            let world = sys::petsc_sys_comm_world();
            if sys::petsc_sys_probe(world, &mut from, &mut kind, &mut length) == 0 {
                return Ok(None);
            }
            let mut bytes = vec![0_u8; length as usize];
            check(sys::petsc_sys_receive(world, bytes.as_mut_ptr().cast(), length, from, kind))?;
            Ok(Some(Message { rank: from as usize, kind, bytes }))
        }
    }
}
