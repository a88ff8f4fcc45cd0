//! What the program says of the keys of its files.

use super::workshop::Workshop;

/// `backend` has another default where PETSc is not built in.
#[cfg(feature = "petsc")]
#[test]
fn the_page_of_keys_is_current() {
    let workshop = Workshop::new();
    workshop.succeed(&["manual", "--out", "manual"]);
    let wanted = include_str!("../../docs/keys.md");
    let made = workshop.read("manual/keys.md");
    let differs = made.lines().zip(wanted.lines()).find(|(made, wanted)| made != wanted);
    assert_eq!(differs, None, "copy keys.md of `pneumorph manual --out DIR` to docs");
    assert_eq!(made.len(), wanted.len());
}

/// Sections that may be left out stand in what `certify` prints, and `evolve` takes it for a run file of the same search.
#[test]
fn printed_defaults_of_certificates_are_a_run() {
    let workshop = Workshop::new();
    let [run, certified] =
        ["evolve", "certify"].map(|command| workshop.succeed(&[command, "--print-defaults"]));
    assert!(!run.lines().any(|line| line == "[solid]"), "{run}");
    assert!(certified.lines().any(|line| line == "[solid]"), "{certified}");
    for (text, key) in [(&run, "w1 = [0.7, 1.6]  # scale of x"), (&certified, "trust = 0.1  # ")] {
        assert!(text.lines().any(|line| line.starts_with(key)), "{key}: {text}");
    }
    let little = certified.replace("population = 60", "population = -1");
    assert_ne!(little, certified);
    workshop.write("run.toml", little);
    workshop.refuse(&["evolve", "run.toml", "--out", "out"], 1, &["integer `-1`"]);
    let unknown = certified.replace("trust = 0.1", "trusst = 0.1");
    workshop.write("run.toml", unknown);
    workshop.refuse(&["evolve", "run.toml", "--out", "out"], 1, &["did you mean `trust`?"]);
}
