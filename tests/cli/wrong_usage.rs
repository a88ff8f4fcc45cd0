//! Wrong commands, flags and folders.

use std::fs;

use super::workshop::Workshop;

#[test]
fn wrong_words_on_the_command_line_are_told_in_one_line() {
    let workshop = Workshop::new();
    for (arguments, words) in [
        (&["evolv"][..], &["'evolv'", "'evolve'", "see --help"][..]),
        (&["evolve", "run.toml", "--ot", "out"], &["'--ot'"]),
        (&["evolve", "run.toml"], &["--out <OUT>"]),
        (&["evolve", "--out", "out"], &["<RUN>"]),
        (&["evolve", "run.toml", "--out"], &["--out <OUT>"]),
        (&["evolve", "run.toml", "--out", ""], &["--out <OUT>"]),
        (&["evolve", "run.toml", "--out", "out", "--threads", "-1"], &["'-1'", "from 0 to 4096"]),
        (&["evolve", "run.toml", "--out", "out", "--threads", "99999999"], &["from 0 to 4096"]),
        (&["simulate", "scene.toml", "--out", "out", "--solver", "x"], &["'x'", "native, petsc"]),
        (&["mesh", "network.toml", "--out", "out", "--edge", "fine"], &["'fine'", "--edge"]),
        (&["report"], &["<RUN>"]),
    ] {
        workshop.refuse(arguments, 2, words);
    }
}

#[test]
fn help_and_version_are_answers() {
    let workshop = Workshop::new();
    for command in ["evolve", "simulate", "mesh", "verify", "report"] {
        assert!(workshop.succeed(&["--help"]).contains(command));
        assert!(workshop.succeed(&[command, "--help"]).contains("Usage: pneumorph"));
    }
    assert!(workshop.succeed(&["--version"]).starts_with("pneumorph "));
    let nothing = workshop.run(&[]);
    assert_eq!(nothing.code, 2);
    assert!(nothing.err.contains("Usage: pneumorph <COMMAND>"), "{nothing:?}");
}

#[test]
fn results_never_go_where_something_is() {
    let workshop = Workshop::new();
    fs::create_dir(workshop.path("taken")).unwrap();
    workshop.write("taken/thesis.txt", "years of work");
    workshop.write("scene.toml", "[part]\nnetwork = \"network.toml\"\n");
    workshop.write("run.toml", "");
    for command in [["mesh", "network.toml"], ["simulate", "scene.toml"], ["evolve", "run.toml"]] {
        for out in ["taken", "network.toml", "."] {
            let [command, file] = command;
            workshop.refuse(
                &[command, file, "--out", out],
                1,
                &["output folder", out, "exists; choose another"],
            );
        }
    }
}

#[test]
fn a_folder_that_cannot_be_made_is_named() {
    let workshop = Workshop::new();
    workshop.write("run.toml", "");
    let long = "a".repeat(260);
    for (out, words) in [
        ("network.toml/out", &["cannot write network.toml: is a file, not a folder"][..]),
        ("/proc/pneumorph", &["cannot write /proc/pneumorph: "]),
        (&long, &["cannot write aaa"]),
    ] {
        workshop.refuse(&["mesh", "network.toml", "--out", out], 1, words);
        workshop.refuse(&["evolve", "run.toml", "--out", out], 1, words);
    }
}

#[test]
fn a_folder_that_is_no_run_is_neither_reported_nor_resumed() {
    let workshop = Workshop::new();
    workshop.write("run.toml", "");
    fs::create_dir(workshop.path("empty")).unwrap();
    fs::create_dir(workshop.path("begun")).unwrap();
    workshop.write("begun/run.toml", "");
    for (folder, words) in [
        ("nowhere", "there is no folder nowhere"),
        ("network.toml", "there is no folder network.toml"),
        ("empty", "empty is not the folder of a run: it has no run.toml"),
    ] {
        workshop.refuse(&["report", folder], 1, &[words]);
        workshop.refuse(&["evolve", "run.toml", "--out", folder, "--resume"], 1, &[words]);
    }
    workshop.refuse(&["report", "begun"], 1, &["begun: no generation has been finished yet"]);
}
