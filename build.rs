//! Tells the program where it came from, as `env!("PNEUMORPH_COMMIT")` and its siblings.

use std::path::Path;
use std::process::Command;

fn main() {
    let rustc = std::env::var("RUSTC").unwrap_or_default();
    let petsc = if std::env::var_os("CARGO_FEATURE_PETSC").is_some() {
        output("pkg-config", &["--modversion", "PETSc"]).unwrap_or_else(unknown)
    } else {
        "none".to_owned()
    };
    set("COMMIT", &commit().unwrap_or_else(unknown));
    set("RUSTC", &output(&rustc, &["--version"]).unwrap_or_else(unknown));
    set("TARGET", &std::env::var("TARGET").unwrap_or_else(|_| unknown()));
    set("PROFILE", &std::env::var("PROFILE").unwrap_or_else(|_| unknown()));
    set("PETSC", &petsc);
}

/// The short commit, with `-dirty` when tracked files differ from it; `None` outside our own repository.
fn commit() -> Option<String> {
    // Naming any path turns off cargo's watch on the whole package, so the sources are named too.
    for path in ["build.rs", "Cargo.toml", "src", "ffi", "web/dist"] {
        rerun_if_changed(path);
    }
    if !Path::new(".git").exists() {
        return None;
    }
    let branch = output("git", &["symbolic-ref", "-q", "HEAD"]);
    for name in ["HEAD", "packed-refs"].into_iter().chain(branch.as_deref()) {
        if let Some(path) = output("git", &["rev-parse", "--git-path", name]) {
            rerun_if_changed(&path);
        }
    }
    output("git", &["describe", "--always", "--dirty", "--exclude=*", "--abbrev=10"])
}

/// What `program` printed, trimmed; `None` when it is absent or failed.
fn output(program: &str, arguments: &[&str]) -> Option<String> {
    let done = Command::new(program).args(arguments).output().ok()?;
    done.status.success().then(|| String::from_utf8_lossy(&done.stdout).trim().to_owned())
}

fn unknown() -> String {
    "unknown".to_owned()
}

fn set(name: &str, value: &str) {
    println!("cargo:rustc-env=PNEUMORPH_{name}={value}");
}

/// Watches `path` where it exists: a path that does not exist would rebuild the crate every time.
fn rerun_if_changed(path: &str) {
    if Path::new(path).exists() {
        println!("cargo:rerun-if-changed={path}");
    }
}
