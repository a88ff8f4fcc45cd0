//! `mesh`, `report`, `doctor` and the manual where all is well, and the printed defaults of `evolve`.

use super::workshop::Workshop;

#[test]
fn mesh_writes_surface_picture_and_quality() {
    let workshop = Workshop::new();
    let words = workshop.succeed(&["mesh", "network.toml", "--out", "out", "--edge", "4"]);
    assert!(words.contains("genus 0") && words.contains("results in out"), "{words}");
    assert!(workshop.path("out/surface.vtu").is_file());
    let quality = workshop.json("out/quality.json");
    let triangles = quality["triangles"].as_u64().unwrap();
    // Binary STL: 84 bytes, and 50 for each triangle.
    assert_eq!(workshop.path("out/surface.stl").metadata().unwrap().len(), 84 + 50 * triangles);
    let mean = quality["edge_mean"].as_f64().unwrap();
    assert!((3.0..5.0).contains(&mean), "{mean}");

    let printed =
        workshop.succeed(&["mesh", "network.toml", "--out", "again", "--edge", "4", "--json"]);
    assert_eq!(serde_json::from_str::<serde_json::Value>(&printed).unwrap(), quality);
}

#[test]
fn report_draws_again_what_the_run_wrote() {
    let workshop = Workshop::new();
    workshop.write(
        "run.toml",
        "[evolution]\npopulation = 4\ngenerations = 1\n[mesh]\nedge = 5.0\n[load.path]\nsteps = 1\n",
    );
    workshop.succeed(&["evolve", "run.toml", "--out", "out"]);
    let written = workshop.files();
    for name in [
        "front.svg",
        "front.png",
        "history.svg",
        "history.png",
        "front.csv",
        "history.csv",
        "outcomes.png",
        "outcomes.csv",
    ] {
        std::fs::remove_file(workshop.path("out").join(name)).unwrap();
    }
    let out = workshop.succeed(&["report", "out"]);
    assert!(out.contains("out/front.svg"), "{out}");
    let mut reported = workshop.files();
    for figure in ["front", "merit", "history", "outcomes"] {
        let pdf = reported.remove(&workshop.path(&format!("out/{figure}.pdf"))).unwrap().unwrap();
        assert!(pdf.starts_with(b"%PDF-"), "{figure}");
    }
    let page = reported.remove(&workshop.path("out/report.html")).unwrap().unwrap();
    assert!(reported == written, "report does not draw what evolve drew");
    let page = String::from_utf8(page).unwrap();
    // Four figures, and the curves of what is on the front.
    let front = workshop.read("out/front.csv").lines().count() - 1;
    assert_eq!(page.matches("<svg").count(), if front > 0 { 5 } else { 4 });
    let run = workshop.read("out/run.toml").replace('"', "&quot;");
    assert!(page.contains(&run), "the page has every setting");
    for words in [
        "4 candidates in 1 generations",
        "NSGA-II had 4 individuals in 1 generations from seed 1",
        "Loop&#39;s subdivision surface",
        "rises to 0.2 MPa in 1 samples",
    ] {
        assert!(page.replace('\'', "&#39;").contains(words), "{words}");
    }
}

/// `evolve` reads its run file before it looks at the folder: the refusal of the folder is the proof.
#[test]
fn printed_defaults_are_a_run_file() {
    let workshop = Workshop::new();
    let defaults = workshop.succeed(&["evolve", "--print-defaults"]);
    for key in ["population = ", "[genes]", "w11 = ", "[load.path.newton]"] {
        assert!(defaults.contains(key), "{key}");
    }
    workshop.write("run.toml", defaults);
    std::fs::create_dir(workshop.path("taken")).unwrap();
    workshop.write("taken/thesis.txt", "years of work");
    workshop.refuse(
        &["evolve", "run.toml", "--out", "taken"],
        1,
        &["output folder taken exists", "--resume"],
    );
}

#[test]
fn the_machine_is_looked_at() {
    let workshop = Workshop::new();
    let said = workshop.run(&["doctor", "--json"]);
    let findings: serde_json::Value = serde_json::from_str(&said.out).unwrap();
    let findings = findings.as_array().unwrap();
    let missing = findings.iter().any(|finding| finding["state"] == "missing");
    assert_eq!(said.code, i32::from(missing), "{said:?}");
    for finding in findings {
        assert_eq!(finding["advice"] == "", finding["state"] == "good", "{finding}");
    }
    let cores = findings.iter().find(|finding| finding["what"] == "cores").unwrap();
    let here = std::thread::available_parallelism().unwrap().to_string();
    assert_eq!(cores["found"], here.as_str());
    // Without the programs of solids, the finding says what to do.
    let mut command = workshop.command(&["doctor"]);
    let output = command.env("PATH", workshop.path(".")).output().unwrap();
    let words = String::from_utf8(output.stdout).unwrap();
    assert!(words.contains("apt-get install tetgen"), "{words}");
    assert_eq!(output.status.code(), Some(1));
}

#[test]
fn completions_and_manual_know_every_command() {
    let workshop = Workshop::new();
    let completions = workshop.succeed(&["completions", "bash"]);
    workshop.succeed(&["manual", "--out", "manual"]);
    let manual = workshop.read("manual/pneumorph.1");
    for command in ["evolve", "simulate", "certify", "report", "doctor"] {
        assert!(completions.contains(command), "{command}");
        assert!(manual.contains(command), "{command}");
        assert!(workshop.read(&format!("manual/pneumorph-{command}.1")).contains(".TH"));
    }
    workshop.refuse(&["manual", "--out", "manual"], 1, &["manual"]);
}
