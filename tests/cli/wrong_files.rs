//! Wrong scene, run and network files.

use super::workshop::Workshop;

const PART: &str = "[part]\nnetwork = \"network.toml\"\n";

#[test]
fn files_that_cannot_be_read_are_named() {
    let workshop = Workshop::new();
    workshop.write("binary.toml", b"\xff\xff\x00");
    for command in ["simulate", "evolve", "mesh"] {
        for (file, words) in [
            ("missing.toml", "missing.toml: no such file or folder"),
            (".", ".: is a folder, not a file"),
            ("binary.toml", "binary.toml:1: is not a text in UTF-8"),
        ] {
            workshop.refuse(&[command, file, "--out", "out"], 1, &[words]);
        }
    }
    workshop.refuse_scene(
        "[part]\nnetwork = \"missing.toml\"\n",
        &["missing.toml: no such file or folder"],
    );
    workshop.refuse_scene(
        "[part]\nnetwork = \"binary.toml\"\n",
        &["binary.toml:1: is not a text in UTF-8"],
    );
}

#[test]
fn faults_of_form_are_told_with_their_line() {
    let workshop = Workshop::new();
    for (scene, words) in [
        ("", "scene.toml:1: missing field `part`"),
        ("[part\n", "scene.toml:1: unclosed table, expected `]`"),
        ("[part]\nnetwork = \"network.toml\n", "scene.toml:2: invalid basic string"),
        (
            "[part]\nnetwork = 3\n",
            "scene.toml:2: invalid type: integer `3`, expected the name of a file, in quotes",
        ),
        ("[part]\nnetwork = \"a\"\nnetwork = \"b\"\n", "scene.toml:3: duplicate key"),
        ("[part]\nnetwrk = \"a\"\n", "scene.toml:2: unknown key `netwrk`; did you mean `network`?"),
        ("[part]\n[wal]\n", "scene.toml:2: unknown key `wal`; did you mean `wall`?"),
        (
            "[part]\n[wall]\nthickness = \"thick\"\n",
            "scene.toml:3: invalid type: string \"thick\", expected a number",
        ),
        (
            "[part]\n[load.path]\nsteps = -3\n",
            "scene.toml:3: invalid value: integer `-3`, expected a whole number",
        ),
        (
            "[part]\n[solver]\nbackend = \"umfpack\"\n",
            "scene.toml:3: unknown value `umfpack`; known: `native`, `petsc`",
        ),
        ("[part]\n[[plane]]\nnormal = [1, 0]\ndistance = 1\n", "scene.toml:3: invalid length 2"),
        ("[part]\n[[plane]]\nnormal = [1, 0, 0]\n", "scene.toml:2: missing field `distance`"),
        ("[part]\n[plane]\nnormal = [1, 0, 0]\ndistance = 1\n", "[[name]] with two brackets"),
        ("[part]\n[box]\nmin = [0, 0, 0]\n", "scene.toml:2: missing field `max`"),
        ("[part]\n[gravity]\n", "scene.toml:2: missing field `density`"),
    ] {
        workshop.refuse_scene(scene, &[words]);
    }
}

#[test]
fn values_that_cannot_be_are_told_with_what_could() {
    let workshop = Workshop::new();
    for (gravity, words) in [
        ("density = 1100", "[gravity] density is 1100.0, but it must lie between 0.001 and 30"),
        (
            "density = 1.1\nacceleration = [0, 0, nan]",
            "[gravity] acceleration is NaN, but it must lie",
        ),
    ] {
        workshop.refuse_scene(&format!("{PART}[gravity]\n{gravity}\n"), &["scene.toml: ", words]);
    }
    workshop.refuse_scene(
        &format!("{PART}[gravity]\ndensity = 1.1\n[load]\nlinear = true\n"),
        &["scene.toml: [load] linear", "[gravity]"],
    );
    for (section, key) in
        [("wall", "thickness"), ("wall", "clamp_height"), ("mesh", "edge"), ("load", "pressure")]
    {
        for (value, why) in [
            ("-1", "is -1.0, but it must be a positive number"),
            ("0", "is 0.0, but it must be a positive number"),
            ("nan", "is NaN, but it must be a positive number"),
            ("inf", "is inf, but it must be a positive number"),
            ("1e300", "is 1e300, but it must lie between"),
        ] {
            let name = format!("[{section}] {key}");
            let fault = format!("[{section}]\n{key} = {value}\n");
            // A scene may have a vacuum, or no pressure at all.
            if key != "pressure" || !["-1", "0"].contains(&value) {
                workshop.refuse_scene(&format!("{PART}{fault}"), &["scene.toml: ", &name, why]);
            }
            workshop.refuse_run(&fault, &["run.toml: ", &name, why]);
        }
    }
    for (fault, words) in [
        (
            "[wall]\ntip_fraction = 0\n",
            "[wall] tip_fraction is 0.0, but it must lie between 0.001 and 0.9",
        ),
        ("[load.path]\nsteps = 0\n", "[load.path] steps is 0, but it must lie between 1 and 1000"),
        ("[load.path]\nsteps = 1000000000000\n", "[load.path] steps is 1000000000000"),
        ("[load.path]\nhalvings = 31\n", "[load.path] halvings is 31, more than 30"),
        ("[load.path]\niteration_budget = 0\n", "[load.path] iteration_budget is 0"),
        (
            "[load.path.newton]\ntolerance = 1\n",
            "[load.path.newton] tolerance is 1.0, but it must lie between",
        ),
        ("[load.path.newton]\nmax_iterations = 0\n", "[load.path.newton] max_iterations is 0"),
        ("[mesh]\nrim_radius = 100\n", "[mesh]: rim radius 100 mm is not in [0, 10)"),
        ("[mesh]\nrim_radius = -1\n", "[mesh]: rim radius -1 mm is not in [0, 10)"),
        ("[mesh]\nrim_radius = nan\n", "[mesh]: rim radius NaN mm is not in [0, 10)"),
        (
            "[mesh]\nedge = 30\n",
            "[mesh] edge is 30.0 mm, but a box 40.0 mm wide needs one below half of that",
        ),
        ("[box]\nmin = [1, 1, 1]\nmax = [0, 0, 0]\n", "each min must be below its max"),
        (
            "[material]\npreset = \"steel\"\n",
            "no preset `steel`; it has ninjaflex-c2s, ninjaflex-c2s-compressible, ninjaflex-yap2016,",
        ),
        (
            "[material]\nlaw = \"hooke\"\n",
            "no law `hooke`; it has neo-hookean, mooney-rivlin, yeoh, ogden",
        ),
        ("[material]\n", "[material] has neither `preset` nor `law`; give one"),
        (
            "[material]\npreset = \"ninjaflex-c2s\"\nlaw = \"ogden\"\n",
            "[material] has both `preset` and `law`; give one",
        ),
        (
            "[material]\nlaw = \"ogden\"\n",
            "[material] ogden has no `terms`; it wants `terms = [{ mu, alpha }]`, with",
        ),
        (
            "[material]\nlaw = \"neo-hookean\"\n",
            "[material] neo-hookean has no `mu`; it wants `mu`, with `bulk_modulus` if",
        ),
        (
            "[material]\nlaw = \"neo-hookean\"\nmu = 1\nyoung_modulus = 3\n",
            "[material] neo-hookean takes no `young_modulus` here; it wants `mu`, with",
        ),
        (
            "[material]\nlaw = \"neo-hookean\"\nyoung_modulus = 3\n",
            "[material] neo-hookean has no `poisson_ratio`; it wants",
        ),
        (
            "[material]\nlaw = \"neo-hookean\"\nyoung_modulus = 3\npoisson_ratio = 0.51\n",
            "[material] poisson_ratio is 0.51, but it must lie between 0.0 and 0.5",
        ),
        (
            "[material]\nlaw = \"neo-hookean\"\nmu = 1\nbulk_modulus = 0.2\n",
            "[material] bulk_modulus is 0.2, but it must be at least 0.300, 0.3 of the shear modulus",
        ),
        (
            "[material]\nlaw = \"mooney-rivlin\"\nc1 = 1\n",
            "[material] mooney-rivlin has no `c2`; it wants `c1` and `c2`",
        ),
        (
            "[material]\nlaw = \"mooney-rivlin\"\nc1 = 1\nc2 = -1\n",
            "the shear modulus 2 (c1 + c2) of [material] is 0.0, but it must be a positive number",
        ),
        (
            "[material]\nlaw = \"yeoh\"\nc = [1, 2]\n",
            "invalid length 2, expected an array of length 3",
        ),
        (
            "[material]\nlaw = \"yeoh\"\nc = [1, nan, 2]\n",
            "the second of [material] c is NaN, but it must lie between",
        ),
        (
            "[material]\nlaw = \"yeoh\"\nc1 = 1\n",
            "[material] yeoh takes no `c1` here; it wants `c = [c1, c2, c3]`, with",
        ),
        (
            "[material]\nlaw = \"st-venant-kirchhoff\"\nyoung_modulus = 1\npoisson_ratio = -1\n",
            "[material] poisson_ratio is -1.0, but it must lie between -0.99 and 0.5",
        ),
        (
            "[material]\nlaw = \"st-venant-kirchhoff\"\nbulk_modulus = 1\n",
            "[material] st-venant-kirchhoff takes no `bulk_modulus` here; it wants `young_modulus`",
        ),
        (
            "[material]\nlaw = \"yeoh\"\nbulk_modulos = 1\n",
            "unknown key `bulk_modulos`; did you mean `bulk_modulus`?",
        ),
        ("[material]\nlaw = \"ogden\"\nterms = []\n", "[material] terms is empty"),
        ("[material]\nlaw = \"ogden\"\nterms = [{ mu = 1.0, alpha = 0.0 }]\n", "alpha is 0.0, but"),
        (
            "[material]\nlaw = \"ogden\"\nterms = [{ mu = 1.0, alpha = 1e9 }]\n",
            "at most 100 in size",
        ),
        ("[material]\nlaw = \"ogden\"\nterms = [{ mu = -1.0, alpha = 2.0 }]\n", "the sum of mu"),
        (
            "[material]\nlaw = \"neo-hookean\"\nmu = nan\n",
            "[material] mu is NaN, but it must be a positive number",
        ),
        (
            "[material]\npreset = \"ninjaflex-c2s\"\nmu = 1.0\n",
            "[material] takes no `mu` beside `preset`; numbers of your own go with a `law`",
        ),
    ] {
        workshop.refuse_scene(&format!("{PART}{fault}"), &["scene.toml", words]);
        workshop.refuse_run(fault, &["run.toml", words]);
    }
}

/// Neither may take long or much memory.
#[test]
fn meshes_that_would_fill_the_memory_are_refused_at_once() {
    let workshop = Workshop::new();
    for fault in [
        "[mesh]\nedge = 0.05\n",
        "[mesh]\nedge = 1e-9\n",
        "[box]\nmin = [-1e3, -1e3, 0]\nmax = [1e3, 1e3, 1e3]\n",
        "[box]\nmin = [-20, -20, 0]\nmax = [20, 20, 1e12]\n",
    ] {
        workshop.refuse_scene(
            &format!("{PART}{fault}"),
            &["scene.toml: [mesh] edge is ", "too fine", "is the finest"],
        );
        workshop.refuse_run(fault, &["run.toml: [mesh] edge is ", "too fine", "is the finest"]);
    }
    workshop.refuse(
        &["mesh", "network.toml", "--out", "out", "--edge", "0.05"],
        1,
        &["--edge", "0.05 mm, too fine for a box of 40.0 x 40.0 x 62.8 mm; 0.30 mm is the finest"],
    );
    workshop.refuse(
        &["mesh", "network.toml", "--out", "out", "--edge", "-1"],
        1,
        &["--edge", "is -1.0, but it must be a positive number"],
    );
    workshop.refuse_run(
        "[evolution]\npopulation = 1000000000\n",
        &["[evolution] population is 1000000000"],
    );
}

#[test]
fn planes_that_are_none_are_told() {
    let workshop = Workshop::new();
    for (normal, distance, words) in [
        ("[0, 0, 0]", "1", "[[plane]] normal must be a direction, not [0.0, 0.0, 0.0]"),
        ("[nan, 0, 0]", "1", "[[plane]] normal must be a direction, not [NaN, 0.0, 0.0]"),
        ("[1e300, 0, 0]", "1", "[[plane]] normal must be a direction"),
        ("[1, 0, 0]", "0", "[[plane]] distance is 0.0, but it must be a positive number"),
        (
            "[1, 0, 0]",
            "1e-7",
            "[[plane]] distance is 1e-7, but it must lie between 1e-6 and 1000000000000.0",
        ),
        ("[1, 0, 0]", "-2", "[[plane]] distance is -2.0, but it must be a positive number"),
    ] {
        let plane = format!("{PART}[[plane]]\nnormal = {normal}\ndistance = {distance}\n");
        workshop.refuse_scene(&plane, &["scene.toml: ", words]);
    }
    workshop.refuse_run(
        "[fitness]\nplane_normal = [0, 0, 0]\n",
        &["[fitness] plane_normal must be a direction"],
    );
    workshop.refuse_run(
        "[fitness]\nfurther_objectives = [\"beauty\"]\n",
        &["`beauty` is no further objective; those are wall_volume"],
    );
    workshop.refuse_run(
        "[fitness]\nfurther_objectives = [\"wall_volume\", \"wall_volume\"]\n",
        &["[fitness] further_objectives names one twice"],
    );
    workshop.refuse_run("[fitness]\nplane_distance = 0\n", &["[fitness] plane_distance is 0.0"]);
}

#[test]
fn a_part_is_one_of_two() {
    let workshop = Workshop::new();
    workshop.refuse_scene(
        "[part]\n",
        &["scene.toml: [part] has none of `network`, `stl`, `tetrahedra`, `patch`, `sphere` and `ellipsoid`; give one"],
    );
    let both = "[part]\nnetwork = \"network.toml\"\nstl = \"part.stl\"\n";
    workshop.refuse_scene(both, &["scene.toml: [part] has more than one of `network`, `stl`, `tetrahedra`, `patch`, `sphere` and `ellipsoid`; give one"]);
}

#[test]
fn run_files_are_told_their_own_faults() {
    let workshop = Workshop::new();
    for (fault, words) in [
        ("[evolutoin]\n", "run.toml:1: unknown key `evolutoin`; did you mean `evolution`?"),
        ("[evolution]\npopsize = 6\n", "run.toml:2: unknown key `popsize`"),
        (
            "[evolution]\npopulation = 3\n",
            "[evolution]: `population` is 3, but it must be at least 4",
        ),
        (
            "[evolution]\npopulation = 6.5\n",
            "run.toml:2: invalid type: floating point `6.5`, expected a whole number",
        ),
        ("[evolution]\ngenerations = 0\n", "[evolution]: `generations` is 0"),
        (
            "[evolution]\nseed = -1\n",
            "run.toml:2: invalid value: integer `-1`, expected a whole number",
        ),
        ("[evolution]\ncrossover = \"two_point\"\n", "run.toml:2: unknown value `two_point`"),
        (
            "[fitness]\nexponent = 0\n",
            "[fitness] exponent is 0.0, but it must lie between 0.1 and 100.0",
        ),
        ("[wall]\nclamp_height = 38\n", "[wall] clamp_height holds 60.80 mm of a box of 62.8 mm"),
        ("[genes]\nw99 = [0, 1]\n", "[genes]: there is no gene `w99`; the genes are w1, w2"),
        ("[genes]\nw1 = [1, 0]\n", "[genes]: gene w1: [1, 0] is not an interval"),
        ("[genes]\nw1 = [nan, 1]\n", "[genes]: gene w1: [NaN, 1] is not an interval"),
        ("[genes]\nw1 = [1]\n", "run.toml:2: invalid length 1, expected an array of length 2"),
        (PART, "run.toml:1: unknown key `part`; known: `evolution`"),
    ] {
        workshop.refuse_run(fault, &["run.toml", words]);
    }
}

#[test]
fn networks_are_told_their_faults_in_one_line() {
    let workshop = Workshop::new();
    let node = |name: &str, rest: &str| format!("[[node]]\nname = \"{name}\"\n{rest}\n");
    for (network, words) in [
        (String::new(), "network.toml: the network has no [[node]]"),
        ("[[node]\n".to_owned(), "network.toml:1: unclosed array table"),
        (
            node("a", "links = { x = 1 }\nactivation = \"cosin\""),
            "network.toml:4: unknown value `cosin`; did you mean `cosine`?",
        ),
        (
            node("a", "link = { x = 1 }"),
            "network.toml:3: unknown key `link`; did you mean `links`?",
        ),
        (
            node("a", "links = { b = 1 }") + &node("b", "links = { a = 1 }"),
            "network.toml: the links form a cycle: a -> b -> a",
        ),
        (node("a", "links = { teta = 1 }"), "network.toml: node `a` links from `teta`"),
        (node("a", "links = { x = nan }"), "network.toml: the weight `x` of node `a` is NaN"),
        (node("a", "links = { x = 0 }"), "network.toml: Surface: no_surface"),
        (node("a", "links = { x = 1 }\nbias = 1e9"), "network.toml: Surface: no_surface"),
    ] {
        workshop.write("network.toml", network);
        workshop.refuse_scene(PART, &[words]);
        workshop.refuse(&["mesh", "network.toml", "--out", "out"], 1, &[words]);
    }
}

/// A strip held at one side, with `rest` for its load and its watches.
fn strip(rest: &str) -> String {
    let patch = "s = [0, 12]\nt = [0, 1]\ncells = [4, 2]\nx = \"s\"\ny = \"t\"\nz = \"0\"\n";
    format!("[part.patch]\n{patch}[[edge]]\nside = \"s0\"\nclamped = true\n{rest}")
}

#[test]
fn patches_without_a_load_are_refused() {
    let workshop = Workshop::new();
    let nothing = "scene.toml: a [part.patch] wants a load other than zero";
    let force = |f: &str| format!("[[force]]\n{f}\n");
    for (rest, words) in [
        (String::new(), nothing),
        ("[load]\nlinear = true\n".to_owned(), nothing),
        (force("per_area = [0, 0, 0]"), nothing),
        (force("at = [12, 0]\nforce = [0, 0, -0.0]"), nothing),
        (force("per_area = [0, nan, 0]"), "[[force]] per_area is NaN, but it must lie between"),
        (
            "[[moment]]\nside = \"s1\"\nper_length = [0, 0, 0]\n".to_owned(),
            "scene.toml: [[moment]] per_length is zero",
        ),
        ("[load]\npressure = 0\n".to_owned(), nothing),
        (
            "[load]\npressure = nan\n".to_owned(),
            "[load] pressure of a [part.patch] is NaN, but it must lie between",
        ),
        (
            "[load]\npressure = -inf\n".to_owned(),
            "[load] pressure of a [part.patch] is -inf, but it must lie between",
        ),
    ] {
        workshop.refuse_scene(&strip(&rest), &[words]);
    }
    // From the other side, and a zero beside it: a load all the same. Pressure wants no free side.
    let side = |name: &str, how: &str| format!("[[edge]]\nside = \"{name}\"\n{how}\n");
    let load = [
        side("s1", "clamped = true"),
        side("t0", "symmetry = \"y\""),
        side("t1", "symmetry = \"y\""),
        force("per_area = [0, 0, 0]"),
        "[load]\npressure = -1e-6\nlinear = true\n".to_owned(),
    ];
    let load = load.concat();
    workshop.write("scene.toml", strip(&load));
    workshop.succeed(&["simulate", "scene.toml", "--out", "out"]);
}

#[test]
fn watches_have_names_of_their_own() {
    let workshop = Workshop::new();
    let watch =
        |name: &str| format!("[[watch]]\nname = \"{name}\"\nat = [12, 0]\ndirection = [0, 0, 1]\n");
    let scene = |names: [&str; 2]| {
        strip(&format!("[load]\npressure = 1e-6\n{}{}", watch(names[0]), watch(names[1])))
    };
    let twice = "scene.toml: [[watch]] lists the name \"tip\" twice";
    workshop.refuse_scene(&scene(["tip", "tip"]), &[twice]);
    workshop.refuse_scene(&scene(["tip", ""]), &["scene.toml: [[watch]] name is \"\", but"]);
    workshop.refuse_scene(&scene([" ", "tip"]), &["scene.toml: [[watch]] name is \" \", but"]);
}
