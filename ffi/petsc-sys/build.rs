//! Finds PETSc and MPI, generates the bindings, compiles the shim.

use std::path::{Path, PathBuf};
use std::{env, error};

fn main() {
    println!("cargo::rerun-if-env-changed=PETSC_DIR");
    println!("cargo::rerun-if-env-changed=PETSC_ARCH");
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=src/shim.h");
    println!("cargo::rerun-if-changed=src/shim.c");
    if let Err(message) = build() {
        for line in message.to_string().lines() {
            println!("cargo::error={line}");
        }
    }
}

fn build() -> Result<(), Box<dyn error::Error>> {
    let petsc = probe(&petsc_candidates(), "PETSc")?;
    // PETSc's macros expand to MPI's symbols, so the shim and the caller link MPI themselves.
    let mpi = probe(&MPI_NAMES.map(String::from), "MPI")?;
    println!("cargo::metadata=version={}", petsc.version);

    let mut include_paths = petsc.include_paths;
    include_paths.extend(mpi.include_paths);
    compile_shim(&include_paths);
    generate_bindings(&include_paths)
}

/// The pkg-config packages or `.pc` files to try, those under `PETSC_DIR` first.
fn petsc_candidates() -> Vec<String> {
    let mut candidates = Vec::new();
    if let Some(directory) = env::var_os("PETSC_DIR").map(PathBuf::from) {
        let built = env::var_os("PETSC_ARCH").map(|arch| directory.join(arch));
        for prefix in built.into_iter().chain([directory]) {
            for name in PETSC_NAMES {
                let file = prefix.join("lib/pkgconfig").join(name).with_extension("pc");
                if file.is_file() {
                    candidates.push(file.display().to_string());
                }
            }
        }
    }
    candidates.extend(PETSC_NAMES.map(String::from));
    candidates
}

fn probe(candidates: &[String], what: &str) -> Result<pkg_config::Library, String> {
    let mut reasons = Vec::new();
    for name in candidates {
        match pkg_config::Config::new().probe(name) {
            Ok(library) => return Ok(library),
            Err(pkg_config::Error::Failure { .. } | pkg_config::Error::ProbeFailure { .. }) => {
                reasons.push(format!("pkg-config has no `{name}`"))
            }
            Err(other) => reasons.push(other.to_string().lines().collect::<Vec<_>>().join(" ")),
        }
    }
    Err(format!(
        "{what} was not found ({}).\n\
         Debian, Ubuntu: apt install libpetsc-real-dev libopenmpi-dev libclang-dev pkg-config \
         (in pneumorph's repository: scripts/setup).\n\
         A PETSc of your own: set PETSC_DIR and PETSC_ARCH.\n\
         pneumorph without PETSc: build with --no-default-features --features cli.",
        reasons.join("; ")
    ))
}

fn compile_shim(include_paths: &[PathBuf]) {
    cc::Build::new()
        .file("src/shim.c")
        .includes(include_paths)
        .warnings(false)
        .compile("petsc_shim");
}

fn generate_bindings(include_paths: &[PathBuf]) -> Result<(), Box<dyn error::Error>> {
    let mut builder = bindgen::Builder::default()
        .header("src/shim.h")
        .clang_args(include_paths.iter().map(|path| format!("-I{}", path.display())))
        .prepend_enum_name(false)
        .generate_cstr(true)
        .generate_comments(false)
        .layout_tests(false)
        .merge_extern_blocks(true);
    for name in FUNCTIONS {
        builder = builder.allowlist_function(name);
    }
    for name in CONSTANTS {
        builder = builder.allowlist_var(name);
    }
    let out = env::var("OUT_DIR")?;
    builder.generate()?.write_to_file(Path::new(&out).join("bindings.rs"))?;
    Ok(())
}

const PETSC_NAMES: [&str; 2] = ["PETSc", "petsc"];
const MPI_NAMES: [&str; 4] = ["mpi-c", "ompi-c", "mpich", "mpi"];

/// Every function that may be called; add a name here to use another.
#[rustfmt::skip]
const FUNCTIONS: &[&str] = &[
    "petsc_sys_.*",
    "PetscInitialize", "PetscInitialized", "PetscFinalize",
    "PetscGetVersionNumber", "PetscPushErrorHandler",
    "PetscOptionsHasName", "PetscOptionsSetValue", "PetscObjectCompose",
    "MPI_Query_thread", "MPI_Finalized", "MPI_Comm_size", "MPI_Comm_rank", "MPI_Abort",
    "PetscLogDefaultBegin", "PetscLogEventGetId", "PetscLogEventGetPerfInfo",
    "VecCreateSeq", "VecCreateMPI", "VecSetBlockSize", "VecGetLocalSize", "VecGetArray", "VecRestoreArray", "VecGetArrayRead", "VecRestoreArrayRead", "VecDestroy",
    "VecScatterCreateToAll", "VecScatterBegin", "VecScatterEnd", "VecScatterDestroy",
    "ISCreateStride", "ISSetBlockSize", "ISDestroy",
    "MatCreate", "MatSetSizes", "MatSetType", "MatSeqSBAIJSetPreallocationCSR",
    "MatMPIAIJSetPreallocationCSR", "MatUpdateMPIAIJWithArray", "MatSetOption", "MatCreateConstantDiagonal", "MatSetUp", "MatGetOwnershipRange",
    "MatNullSpaceCreateRigidBody", "MatNullSpaceDestroy",
    "MatSeqSBAIJGetArray", "MatSeqSBAIJRestoreArray", "MatAssemblyBegin", "MatAssemblyEnd", "MatDestroy",
    "MatGetFactor", "MatFactorInfoInitialize", "MatCholeskyFactorSymbolic", "MatCholeskyFactorNumeric",
    "MatFactorGetError", "MatGetInertia", "MatSolve", "MatMumpsSetIcntl",
    "KSPCreate", "KSPSetOptionsPrefix", "KSPSetFromOptions", "KSPSetOperators", "KSPSetTolerances", "KSPSetType", "KSPSetPCSide",
    "KSPGMRESSetRestart", "KSPGetPC", "KSPSolve", "KSPGetConvergedReason", "KSPGetIterationNumber", "KSPDestroy",
    "PCSetType", "PCFieldSplitSetIS", "PCFieldSplitSetType", "PCFieldSplitSetSchurFactType", "PCFieldSplitSetSchurPre",
    "PCShellSetApply", "PCShellSetContext", "PCShellGetContext", "PCSetFailedReason",
    "SNESCreate", "SNESSetType", "SNESSetFunction", "SNESSetJacobian", "SNESSetConvergenceTest", "SNESSetTolerances",
    "SNESGetKSP", "SNESGetLineSearch", "SNESSolve", "SNESGetConvergedReason",
    "SNESSetFunctionDomainError", "SNESDestroy",
    "SNESLineSearchSetType", "SNESLineSearchGetVecs", "SNESLineSearchComputeNorms", "SNESLineSearchSetReason",
];

/// Types and enumerations follow from the functions' signatures.
const CONSTANTS: &[&str] = &[
    "PETSC_VERSION_(MAJOR|MINOR|SUBMINOR)",
    "PETSC_MPI_THREAD_REQUIRED",
    "MATSEQSBAIJ",
    "MATMPIAIJ",
    "MATSOLVERMUMPS",
    "KSPPREONLY",
    "KSPGMRES",
    "PCSHELL",
    "PCFIELDSPLIT",
    "SNESNEWTONLS",
    "SNESLINESEARCHSHELL",
];
