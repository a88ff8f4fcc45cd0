//! Searches and walks that are stopped, damaged or begun twice: the same bits at the end, or one refusal with nothing lost.

use std::fs::{self, File};
use std::path::Path;
use std::process::{Child, Output};
use std::thread::sleep;
use std::time::{Duration, Instant};

use rustix::process::{Pid, Signal, kill_process};

use super::evolve::{RESUME, RUN, assert_same_results, copy_of_finished, finished};
use super::workshop::Workshop;

/// Waits for a file of a run that was just begun.
fn wait_for(file: &Path) {
    let start = Instant::now();
    while !file.is_file() {
        assert!(start.elapsed() < Duration::from_secs(120), "{} was not written", file.display());
        sleep(Duration::from_millis(2));
    }
}

fn told(child: Child, signal: Signal) -> Output {
    kill_process(Pid::from_child(&child), signal).unwrap();
    child.wait_with_output().unwrap()
}

/// The lines of `out/candidates.jsonl` in an order of their own.
fn lines(workshop: &Workshop) -> Vec<String> {
    let mut lines: Vec<String> =
        workshop.read("out/candidates.jsonl").lines().map(str::to_owned).collect();
    lines.sort();
    lines
}

/// Neither the folder's copy nor both copies of the run file can turn a search into another one.
#[test]
fn other_physics_are_named_and_refused() {
    let workshop = copy_of_finished();
    let copy = workshop.read("out/run.toml");
    for (from, to, key) in [
        ("\nseed = 3", "\nseed = 4", "[evolution] seed is 4 instead of 3"),
        ("population = 6", "population = 8", "[evolution] population is 8 instead of 6"),
        ("pressure = 0.1", "pressure = 0.15", "[load] pressure is 0.15 instead of 0.1"),
        ("edge = 5.0", "edge = 4.0", "[mesh] edge is 4.0 instead of 5.0"),
    ] {
        workshop.write("run.toml", RUN.replace(from, to));
        workshop.refuse(&RESUME, 1, &["out was made with other settings", key, "run.toml"]);
        // In both copies.
        workshop.write("out/run.toml", copy.replace(from, to));
        workshop.refuse(&RESUME, 1, &["out was made with other settings", key]);
        // And where no checkpoint tells: the records were made with other settings.
        let other = workshop.copy_of(&["run.toml", "out"]);
        fs::remove_dir_all(other.path("out/checkpoints")).unwrap();
        other.refuse(&RESUME, 1, &["out was made with other settings", "g000-000"]);
        workshop.write("out/run.toml", &copy);
    }
    // The folder's copy alone: the search is what it was, and the copy is mended.
    workshop.write("run.toml", RUN);
    workshop.write("out/run.toml", copy.replace("pressure = 0.1", "pressure = 0.15"));
    let said = workshop.run(&RESUME);
    assert_eq!((said.code, said.err.lines().count()), (0, 1), "{said:?}");
    assert!(said.err.contains("out/run.toml was changed since the run was made"), "{said:?}");
    assert_eq!(workshop.read("out/run.toml"), copy);
    assert_same_results(&workshop);
}

/// Without checkpoints, and without one that can be used, all is made again from the records: none is evaluated, none is lost.
#[test]
fn records_alone_are_enough() {
    for damage in ["none", "cut"] {
        let workshop = copy_of_finished();
        let before = lines(&workshop);
        if damage == "none" {
            fs::remove_dir_all(workshop.path("out/checkpoints")).unwrap();
        } else {
            for file in fs::read_dir(workshop.path("out/checkpoints")).unwrap() {
                fs::write(file.unwrap().path(), "{").unwrap();
            }
        }
        let said = workshop.run(&RESUME);
        assert_eq!(said.code, 0, "{said:?}");
        assert_eq!(said.err.is_empty(), damage == "none", "{said:?}");
        assert!(said.out.starts_with("resumed after generation 0 of 3"), "{said:?}");
        assert_eq!(lines(&workshop), before);
        assert_same_results(&workshop);
        assert!(!workshop.path("out/running.jsonl").exists());
    }
}

/// A newest checkpoint that is damaged costs no record of its generation.
#[test]
fn records_beyond_a_checkpoint_are_used() {
    let workshop = copy_of_finished();
    let before = lines(&workshop);
    workshop.write("out/checkpoints/checkpoint-000003.json", "{");
    assert_eq!(workshop.run(&RESUME).code, 0);
    assert_eq!(lines(&workshop), before);
    assert_same_results(&workshop);
}

/// Lost records are evaluated again, and lead to the checkpoint that is there; what was damaged is kept.
#[test]
fn lost_records_are_evaluated_again() {
    let whole = finished().read("out/candidates.jsonl");
    let line = |number: usize| whole.lines().nth(number).unwrap();
    let cut: String = whole.lines().take(10).map(|line| format!("{line}\n")).collect();
    let flipped = whole.replacen("\"genome\":[", "\"genome\":[1", 1);
    let twice = format!("{whole}{}\n{}\n", line(3), line(17));
    for (log, lost, damaged) in
        [(cut, 8, false), (String::new(), 18, false), (flipped, 1, true), (twice, 0, false)]
    {
        let workshop = copy_of_finished();
        workshop.write("out/candidates.jsonl", &log);
        let said = workshop.run(&RESUME);
        assert_eq!(said.code, 0, "{said:?}");
        let lacks = format!("candidates.jsonl lacks {lost} of the 18 candidates");
        assert_eq!(said.err.contains(&lacks), lost > 0, "{said:?}");
        let kept = workshop.path("out/candidates.jsonl.damaged");
        assert_eq!(kept.exists(), damaged, "{said:?}");
        if damaged {
            assert_eq!(fs::read_to_string(kept).unwrap(), log);
            assert!(said.err.contains("candidates.jsonl:1: the checksum does not fit"), "{said:?}");
        }
        assert_same_results(&workshop);
        assert_eq!(workshop.read("out/candidates.jsonl").lines().count(), 18);
    }
}

/// Records that contradict the checkpoint, or each other, are nobody's to choose from.
#[test]
fn contradictions_are_refused() {
    let whole = finished().read("out/candidates.jsonl");
    let checkpoint = finished().read("out/checkpoints/checkpoint-000003.json");
    // A survivor, and the same with another force: written by hand, so without a checksum.
    let line = whole
        .lines()
        .find(|line| line.contains("\"evaluated\"") && checkpoint.contains(&line[6..16]))
        .unwrap();
    let mut record: serde_json::Value = serde_json::from_str(line).unwrap();
    let id = record["id"].as_str().unwrap().to_owned();
    record["blocking"] = 7.0.into();
    record.as_object_mut().unwrap().remove("checksum");
    let plain: String = whole
        .lines()
        .map(|line| {
            let mut record: serde_json::Value = serde_json::from_str(line).unwrap();
            record.as_object_mut().unwrap().remove("checksum");
            format!("{record}\n")
        })
        .collect();
    let workshop = copy_of_finished();
    workshop.write("out/candidates.jsonl", format!("{plain}{record}\n"));
    workshop.refuse(&RESUME, 1, &["two outcomes of one genome", &id]);
    let other: String = plain
        .lines()
        .map(|line| if line.contains(&id) { format!("{record}\n") } else { format!("{line}\n") })
        .collect();
    workshop.write("out/candidates.jsonl", other);
    workshop.refuse(&RESUME, 1, &["out: candidates.jsonl and the checkpoint", &id]);
    // Logs of earlier versions have no checksums, and are as good.
    workshop.write("out/candidates.jsonl", plain);
    workshop.succeed(&RESUME);
    assert_same_results(&workshop);
}

#[test]
fn a_folder_has_one_writer() {
    let workshop = copy_of_finished();
    let lock = File::open(workshop.path("out/.lock")).unwrap();
    lock.lock().unwrap();
    workshop.refuse(&RESUME, 1, &["out is in use by another process"]);
    // Who only looks may.
    workshop.succeed(&["report", "out"]);
    drop(lock);
    workshop.succeed(&RESUME);
}

/// A first signal stops a search, candidates in the middle too; what has ended is not lost, and no candidate counts as failed.
#[test]
fn a_signal_stops_a_search_cleanly() {
    for signal in [Signal::TERM, Signal::INT] {
        let workshop = Workshop::new();
        workshop.write("run.toml", RUN);
        // What a process that was killed at once leaves.
        fs::create_dir(workshop.path("out")).unwrap();
        let arguments = ["evolve", "run.toml", "--out", "out", "--threads", "1"];
        let run = workshop.command(&arguments).spawn().unwrap();
        wait_for(&workshop.path("out/running.jsonl"));
        let output = told(run, signal);
        let said = String::from_utf8(output.stdout).unwrap();
        assert_eq!(output.status.code(), Some(3), "{said}");
        assert!(said.contains("interrupted after ") && said.contains("--resume goes on"), "{said}");
        workshop.succeed(&RESUME);
        assert_same_results(&workshop);
    }
}

/// A time limit stops a candidate that takes far longer; the second signal ends a process at once.
#[test]
fn a_time_limit_stops_a_candidate() {
    let workshop = Workshop::new();
    // Some minutes for each candidate.
    workshop.write("run.toml", RUN.replace("steps = 2", "steps = 1000\nlargest_step = 0.01"));
    let start = Instant::now();
    let said = workshop.run(&[
        "evolve",
        "run.toml",
        "--out",
        "out",
        "--time-limit",
        "2s",
        "--threads",
        "1",
    ]);
    assert_eq!(said.code, 3, "{said:?}");
    assert!(said.out.contains("the time is over after 0 of 3 generations"), "{said:?}");
    // On a busy machine too; a candidate takes longer than this by itself.
    assert!(start.elapsed() < Duration::from_secs(60));
    let recorded = fs::read_to_string(workshop.path("out/running.jsonl")).unwrap_or_default();
    assert!(!recorded.contains("interrupted") && !recorded.contains("budget"), "{recorded}");
}

/// The hours of a walk are written when it is interrupted, and its ending says so.
#[test]
fn an_interrupted_walk_writes_its_path() {
    let workshop = Workshop::new();
    workshop.write(
        "scene.toml",
        "[part]\nnetwork = \"network.toml\"\n[mesh]\nedge = 5.0\n[load]\npressure = 0.1\n\
         [load.path]\nsteps = 1000\n[solver]\nbackend = \"native\"\n",
    );
    let run = workshop.command(&["simulate", "scene.toml", "--out", "out"]).spawn().unwrap();
    // It is there while the path is walked.
    wait_for(&workshop.path("out/.lock"));
    sleep(Duration::from_millis(400));
    let output = told(run, Signal::INT);
    let said = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(3), "{said}");
    assert!(said.starts_with("interrupted"), "{said}");
    assert!(!workshop.path("out/.lock").exists());
    if said.contains("nothing is written") {
        assert!(!workshop.path("out").exists());
        return;
    }
    let summary = workshop.json("out/summary.json");
    assert_eq!(summary["ending"], "interrupted");
    let pressures = workshop.column("out/path.csv", "pressure_MPa");
    assert_eq!(pressures.last(), summary["pressure"].as_f64().as_ref());
    assert!(pressures.len() < 1001 && *pressures.last().unwrap() < 0.1, "{}", pressures.len());
}

/// A job whose processes were given different run files searches for nothing.
#[cfg(feature = "petsc")]
#[test]
fn processes_agree_before_they_begin() {
    let workshop = Workshop::new();
    workshop.write("run.toml", RUN);
    workshop.write("other.toml", RUN.replace("pressure = 0.1", "pressure = 0.15"));
    let mut job = workshop.launched(1, &["evolve", "run.toml", "--out", "out"]);
    let program = env!("CARGO_BIN_EXE_pneumorph");
    job.args([":", "-n", "1", program, "evolve", "other.toml", "--out", "out"]);
    let output = job.output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{said}");
    let told = "process 1 of the job has another run file than process 0: [load] pressure is 0.15 instead of 0.1";
    assert!(said.contains(told), "{said}");
    assert!(!workshop.path("out").exists());
}
