//! Headers, library and Rust are of one version, and the library runs.

use petsc_sys as sys;

#[test]
fn library_is_of_the_headers_version() {
    let (mut major, mut minor, mut subminor, mut release) = (0, 0, 0, 0);
    // SAFETY: needs no initialisation; the four integers outlive the call.
    let code =
        unsafe { sys::PetscGetVersionNumber(&mut major, &mut minor, &mut subminor, &mut release) };
    assert_eq!(code, 0);
    let headers = [sys::PETSC_VERSION_MAJOR, sys::PETSC_VERSION_MINOR, sys::PETSC_VERSION_SUBMINOR];
    assert_eq!([major, minor, subminor].map(i64::from), headers.map(i64::from));
}

#[test]
fn names_are_c_strings_and_the_shim_is_linked() {
    assert_eq!(sys::MATSOLVERMUMPS, c"mumps");
    // SAFETY: returns a constant.
    let serialized = unsafe { sys::petsc_sys_thread_serialized() };
    // The MPI standard orders the levels single < funneled < serialized < multiple.
    assert!(serialized > 0);
}
