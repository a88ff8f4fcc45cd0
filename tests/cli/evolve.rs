//! `evolve`: the same bits on any number of threads, killed and resumed, and on both solvers.

use std::sync::OnceLock;
use std::thread::sleep;
use std::time::{Duration, Instant};

use super::workshop::Workshop;

/// A run of seconds: 6 coarse candidates, 3 generations, 2 load steps.
pub(crate) const RUN: &str = "
[evolution]
population = 6
generations = 3
seed = 3

[mesh]
edge = 5.0

[load]
pressure = 0.1

[load.path]
steps = 2
";

/// A workshop with the finished run `out`, made on two threads.
pub(crate) fn finished() -> &'static Workshop {
    static FINISHED: OnceLock<Workshop> = OnceLock::new();
    FINISHED.get_or_init(|| {
        let workshop = Workshop::new();
        workshop.write("run.toml", RUN);
        workshop.succeed(&["evolve", "run.toml", "--out", "out", "--threads", "2"]);
        workshop
    })
}

/// A workshop of its own with a copy of the finished run.
pub(crate) fn copy_of_finished() -> Workshop {
    finished().copy_of(&["run.toml", "out"])
}

pub(crate) const RESUME: [&str; 5] = ["evolve", "run.toml", "--out", "out", "--resume"];

/// The records of a run without their CPU seconds, and without when and where they were evaluated.
fn records(workshop: &Workshop) -> Vec<serde_json::Value> {
    let lines = workshop.read("out/candidates.jsonl");
    let record = |line: &str| {
        let mut record: serde_json::Value = serde_json::from_str(line).unwrap();
        let fields = record.as_object_mut().unwrap();
        assert!(fields.remove("cpu_seconds").is_some());
        fields.remove("place");
        // It is of those too.
        fields.remove("checksum");
        record
    };
    lines.lines().map(record).collect()
}

/// Everything that the run of `workshop` found is what the finished run found, to the bit.
pub(crate) fn assert_same_results(workshop: &Workshop) {
    for table in ["front.csv", "front_error.csv", "history.csv", "front.svg", "history.svg"] {
        let name = format!("out/{table}");
        assert_eq!(workshop.read(&name), finished().read(&name), "{table}");
    }
    assert_eq!(records(workshop), records(finished()));
    let front = |workshop: &Workshop| {
        let of_front = |(path, contents): (std::path::PathBuf, _)| {
            let path = path.strip_prefix(workshop.path("out/front")).ok()?.to_owned();
            Some((path, contents))
        };
        workshop.files().into_iter().filter_map(of_front).collect::<Vec<_>>()
    };
    assert!(front(workshop) == front(finished()), "a file of the front differs");
}

#[test]
fn a_run_writes_what_it_promises() {
    let run = finished();
    for name in
        ["run.toml", "provenance.json", "front.svg", "front.png", "history.svg", "history.png"]
    {
        assert!(run.path("out").join(name).is_file(), "{name}");
    }
    let history = run.read("out/history.csv");
    assert!(
        history.starts_with(
            "generation,evaluated,feasible,front,hypervolume,best_bending,best_blocking,spread\n"
        ),
        "{history}"
    );
    assert_eq!(history.lines().count(), 1 + 3);
    let hypervolume = run.column("out/history.csv", "hypervolume");
    assert!(hypervolume.is_sorted(), "elitism never loses: {hypervolume:?}");

    let front = run.read("out/front.csv");
    let reached = "angle_deg,bending_pressure,blocking_pressure";
    let columns = format!("id,bending,blocking,figure_of_merit,max_force,flags,{reached}\n");
    assert!(front.starts_with(&columns), "{front}");
    let members: Vec<&str> =
        front.lines().skip(1).map(|row| row.split(',').next().unwrap()).collect();
    assert!(!members.is_empty());
    let errors = run.read("out/front_error.csv");
    let rows: Vec<Vec<&str>> = errors.lines().map(|row| row.split(',').collect()).collect();
    assert_eq!(rows[0][..3], ["id", "edge_mm", "second_edge_mm"], "{errors}");
    assert_eq!(rows[1..].iter().map(|row| row[0]).collect::<Vec<_>>(), members);
    for row in &rows[1..] {
        assert_eq!(row[1], "5.0");
        let second: f64 = row[2].parse().unwrap();
        assert!([20.0 / 3.0, 3.75].iter().any(|edge| (second - edge).abs() < 1e-12), "{errors}");
        // With other edges a design is worth another number, or is none.
        assert!(
            row[5].parse::<f64>().is_ok_and(|percent| percent > 0.0) || !row[7].is_empty(),
            "{errors}"
        );
    }
    for member in members {
        for file in [
            "genome.toml",
            "surface.stl",
            "path.csv",
            "path.pvd",
            "path_002.vtu",
            "path_blocked.csv",
        ] {
            assert!(run.path("out/front").join(member).join(file).is_file(), "{member}/{file}");
        }
    }
    let records = records(run);
    assert_eq!(records.len(), 18);
    for (k, record) in records.iter().enumerate() {
        assert_eq!(record["id"], format!("g{:03}-{:03}", k / 6, k % 6));
        assert!(
            ["evaluated", "rejected"].contains(&record["status"].as_str().unwrap()),
            "{record}"
        );
    }
}

/// Further objectives, one of them of a scenario of its own, have their columns and their share of the hypervolume; the first generation is
/// that of the pair.
#[test]
fn further_objectives_are_searched_for() {
    let workshop = Workshop::new();
    let further = "[fitness]\nfurther_objectives = [\"blocking_back\", \"wall_volume\"]\n";
    workshop.write("run.toml", format!("{RUN}{further}"));
    let said = workshop.run(&["evolve", "run.toml", "--out", "out", "--json"]);
    assert!(said.code == 0 && said.err.contains("generation   3 of 3"), "{said:?}");
    let told: serde_json::Value = serde_json::from_str(&said.out).unwrap();
    let columns = workshop.read("out/front.csv");
    assert!(
        columns.starts_with(
            "id,bending,blocking,figure_of_merit,max_force,flags,wall_volume,blocking_back,angle_deg,\
             bending_pressure,blocking_pressure,blocking_back_pressure\n"
        ),
        "{columns}"
    );
    let volumes = workshop.column("out/front.csv", "wall_volume");
    let front = told["front"].as_array().unwrap();
    assert_eq!(told["candidates"], 18);
    assert_eq!(
        front.iter().map(|m| m["wall_volume"].as_f64().unwrap()).collect::<Vec<_>>(),
        volumes
    );
    // No wall of the box weighs nothing, and none fills it.
    assert!(volumes.iter().all(|volume| (1.0..100.0).contains(volume)), "{volumes:?}");
    let history = workshop.read("out/history.csv");
    assert!(
        history
            .contains(",best_bending,best_blocking,best_wall_volume,best_blocking_back,spread\n"),
        "{history}"
    );
    for line in columns.lines().skip(1) {
        let design = line.split(',').next().unwrap();
        let path = format!("out/front/{design}/path_blocked_back.csv");
        assert!(workshop.path(&path).is_file(), "{path}");
    }
    workshop.succeed(&["report", "out"]);
    let page = workshop.read("out/report.html");
    for words in
        ["blocking back", "Asked besides: a large blocking back (N/kPa), a small wall volume"]
    {
        assert!(page.contains(words), "{words}");
    }
    let pairs = finished().column("out/history.csv", "best_bending");
    assert_eq!(workshop.column("out/history.csv", "best_bending")[0], pairs[0]);
    let volume = workshop.column("out/history.csv", "hypervolume");
    assert!(volume.is_sorted(), "elitism never loses: {volume:?}");
    // The lightest of all that could be evaluated is on the front.
    let lightest = records(&workshop)
        .iter()
        .filter_map(|record| record["further"]["wall_volume"].as_f64())
        .fold(f64::INFINITY, f64::min);
    assert_eq!(volumes.iter().copied().fold(f64::INFINITY, f64::min), lightest);
}

#[test]
fn one_thread_gives_the_bits_of_two() {
    let workshop = Workshop::new();
    workshop.write("run.toml", RUN);
    workshop.succeed(&["evolve", "run.toml", "--out", "out", "--threads", "1"]);
    assert_same_results(&workshop);
}

#[test]
fn a_killed_run_goes_on_with_the_same_bits() {
    let workshop = Workshop::new();
    workshop.write("run.toml", RUN);
    let mut run = workshop
        .command(&["evolve", "run.toml", "--out", "out", "--threads", "2"])
        .spawn()
        .unwrap();
    let first = workshop.path("out/checkpoints/checkpoint-000001.json");
    let start = Instant::now();
    while !first.is_file() {
        assert!(start.elapsed() < Duration::from_secs(120), "no checkpoint was written");
        sleep(Duration::from_millis(2));
    }
    // SIGKILL on Unix.
    run.kill().unwrap();
    run.wait().unwrap();
    assert!(!workshop.path("out/front.csv").exists(), "the run ended before it was killed");

    // What a kill in the middle of a line leaves: half a record.
    let log = workshop.read("out/candidates.jsonl");
    let half = &log[..50];
    workshop.write("out/candidates.jsonl", format!("{log}{half}"));

    let out = workshop.succeed(&RESUME);
    assert!(out.starts_with("resumed after generation "), "{out}");
    assert_same_results(&workshop);
}

/// Three processes on fewer cores: the bits do not depend on who computed what, nor on a kill between two candidates.
#[cfg(feature = "petsc")]
#[test]
fn ranks_give_the_bits_of_threads() {
    let workshop = Workshop::new();
    workshop.write("run.toml", RUN);
    let run = |more: &[&str]| {
        let mut command = workshop.launched(3, &["evolve", "run.toml", "--out", "out"]);
        command.args(more).output().unwrap()
    };
    let out_of_time = run(&["--time-limit", "1ms"]);
    assert_eq!(out_of_time.status.code(), Some(3), "{out_of_time:?}");
    // The time was over before a candidate could begin.
    assert!(!workshop.path("out/running.jsonl").exists());

    let resumed = run(&["--resume"]);
    assert!(resumed.status.success(), "{resumed:?}");
    assert_same_results(&workshop);
    assert!(!workshop.path("out/running.jsonl").exists());

    let refused = run(&["--resume", "--solver", "petsc"]);
    let said = String::from_utf8_lossy(&refused.stderr);
    assert!(!refused.status.success() && said.contains("with the solver native"), "{said}");
}

/// What a killed run has finished of a generation is taken from its log: here a record that says what it cost, 4,000,000 s.
#[test]
fn what_a_killed_run_has_finished_is_not_evaluated_again() {
    let workshop = Workshop::new();
    workshop.write("run.toml", RUN);
    std::fs::create_dir(workshop.path("out")).unwrap();
    workshop.write("out/run.toml", finished().read("out/run.toml"));
    let log = finished().read("out/candidates.jsonl");
    let mut record: serde_json::Value = serde_json::from_str(log.lines().nth(1).unwrap()).unwrap();
    record["cpu_seconds"]["rest"] = 4e6.into();
    record.as_object_mut().unwrap().remove("checksum");
    workshop.write("out/running.jsonl", format!("{record}\n{}", &log[..50]));
    workshop.succeed(&RESUME);
    assert_same_results(&workshop);
    let kept = workshop.read("out/candidates.jsonl");
    let mut kept: serde_json::Value = serde_json::from_str(kept.lines().nth(1).unwrap()).unwrap();
    assert!(kept.as_object_mut().unwrap().remove("checksum").is_some());
    assert_eq!(kept, record);
}

#[test]
fn resuming_a_finished_run_changes_nothing() {
    let workshop = copy_of_finished();
    workshop.succeed(&RESUME);
    assert_same_results(&workshop);
    // A run's own copy of its settings is a run file too.
    workshop.succeed(&["evolve", "out/run.toml", "--out", "out", "--resume"]);
    assert_same_results(&workshop);
}

#[test]
fn a_run_interrupted_by_its_settings_goes_on_with_the_same_bits() {
    let workshop = Workshop::new();
    workshop.write("run.toml", RUN.replace("generations = 3", "generations = 1"));
    workshop.succeed(&["evolve", "run.toml", "--out", "out"]);
    workshop.write("run.toml", RUN);
    let out = workshop.succeed(&RESUME);
    assert!(out.starts_with("resumed after generation 1 of 3"), "{out}");
    for table in ["out/front.csv", "out/history.csv"] {
        assert_eq!(workshop.read(table), finished().read(table));
    }
    assert_eq!(records(&workshop), records(finished()));
}

/// What is flagged otherwise is rejected where flags are excluded, and nothing else changes.
#[test]
fn doubtful_designs_can_be_excluded() {
    let workshop = Workshop::new();
    let run = RUN.replace("generations = 3", "generations = 1");
    workshop.write("run.toml", format!("{run}\n[fitness]\nexclude_exploits = true\n"));
    workshop.succeed(&["evolve", "run.toml", "--out", "out", "--threads", "2"]);
    let mut flagged = 0;
    for (strict, free) in records(&workshop).into_iter().zip(records(finished())) {
        if free["exploits"].as_array().is_none_or(Vec::is_empty) {
            // Which settings it belongs to is another.
            let but_settings = |mut record: serde_json::Value| {
                record.as_object_mut().unwrap().remove("settings");
                record
            };
            assert_eq!(but_settings(strict), but_settings(free));
        } else {
            flagged += 1;
            assert_eq!([&strict["room"], &strict["reason"]], ["fitness", "exploit"], "{strict}");
            let first = free["exploits"][0].as_str().unwrap();
            assert!(strict["detail"].as_str().unwrap().starts_with(first), "{strict}");
        }
    }
    assert!(flagged > 0, "no design of the first generation is flagged");
}

#[test]
fn damaged_checkpoints_fall_back() {
    let workshop = copy_of_finished();
    let newest = "out/checkpoints/checkpoint-000003.json";
    let text = workshop.read(newest);
    workshop.write(newest, &text[..text.len() / 2]);
    let said = workshop.run(&RESUME);
    assert_eq!(said.code, 0, "{said:?}");
    assert_eq!(said.err.lines().count(), 1, "{}", said.err);
    assert!(
        said.err.contains("checkpoint-000003.json: is cut off; the checkpoint before it is used"),
        "{}",
        said.err
    );
    assert!(said.out.starts_with("resumed after generation 2 of 3"), "{}", said.out);
    assert_same_results(&workshop);

    workshop.write(newest, &text[..text.len() / 2]);
    workshop.write("out/checkpoints/checkpoint-000002.json", "{");
    workshop.refuse(&["report", "out"], 1, &["out/checkpoints", "no usable checkpoint"]);
}

/// A population of none but failures is a result, not an error.
#[test]
fn a_run_without_a_feasible_candidate_ends_well() {
    let workshop = Workshop::new();
    // Chambers everywhere: the field is below 0 in the whole box, and the wall cannot follow its corners.
    let run = RUN.replace("pressure = 0.1", "pressure = 100.0");
    workshop.write("run.toml", format!("{run}\n[genes]\nbO = [5.0, 6.0]\n"));
    let said = workshop.run(&["evolve", "run.toml", "--out", "out"]);
    let out = &said.out;
    assert!(said.code == 0 && out.contains("0 of 6 feasible"), "{said:?}");
    // A pressure typed in kPa is told before the first candidate.
    assert!(
        said.err.contains("[load] pressure is 100 MPa") && said.err.contains("(0.1 MPa)"),
        "{said:?}"
    );
    let why = "no design could be evaluated, because of 18 candidates were rejected: ";
    assert!(out.contains(why), "{out}");
    let out = workshop.succeed(&["report", "out"]);
    assert!(out.contains(why), "{out}");
    assert!(out.contains("out/front.svg"), "{out}");
}

/// Both solvers walk through the same equilibria; Newton stops at 1e-12 so that 1e-8 has a margin.
#[cfg(feature = "petsc")]
#[test]
fn petsc_gives_the_same_front() {
    let run = RUN.replace("generations = 3", "generations = 2")
        + "\n[load.path.newton]\ntolerance = 1e-12\n";
    let [native, petsc] = ["native", "petsc"].map(|solver| {
        let workshop = Workshop::new();
        workshop.write("run.toml", &run);
        workshop.succeed(&["evolve", "run.toml", "--out", "out", "--solver", solver]);
        workshop
    });
    let ids = |workshop: &Workshop| -> Vec<String> {
        workshop
            .read("out/front.csv")
            .lines()
            .map(|row| row.split(',').next().unwrap().to_owned())
            .collect()
    };
    assert_eq!(ids(&native), ids(&petsc));
    assert!(ids(&native).len() > 1);
    for column in ["bending", "blocking", "figure_of_merit", "max_force"] {
        let [a, b] = [&native, &petsc].map(|run| run.column("out/front.csv", column));
        for (a, b) in a.iter().zip(&b) {
            assert!((a - b).abs() <= 1e-8 * a.abs(), "{column}: {a} and {b}");
        }
    }
}
