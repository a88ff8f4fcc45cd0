//! The examples that say hello: each holds the number that it prints.

#[allow(dead_code, reason = "cargo runs its main")]
#[path = "../examples/bend.rs"]
mod bend;
#[allow(dead_code, reason = "cargo runs its main")]
#[path = "../examples/cantilever.rs"]
mod cantilever;
#[allow(dead_code, reason = "cargo runs its main")]
#[path = "../examples/front.rs"]
mod front;
#[allow(dead_code, reason = "cargo runs its main")]
#[path = "../examples/inflate.rs"]
mod inflate;
#[allow(dead_code, reason = "cargo runs its main")]
#[path = "../examples/limit_point.rs"]
mod limit_point;
#[allow(dead_code, reason = "cargo runs its main")]
#[path = "../examples/nondominated.rs"]
mod nondominated;

/// The triangles of 320 are chords of the sphere: their own radius is a little less.
#[test]
fn sphere_is_stretched_as_a_membrane() {
    let states = inflate::states().expect("the scene is walked");
    assert_eq!(states.len(), 5);
    for [stretch, pressure, exact] in states {
        assert!((pressure / exact - 1.0).abs() < 0.02, "{stretch}: {pressure} {exact}");
    }
}

#[test]
fn balloon_gives_way_at_its_limit_point() {
    let [walked, exact] = limit_point::limit_pressures().expect("the scene is walked");
    assert!((walked / exact - 1.0).abs() < 0.02, "{walked} {exact}");
}

#[test]
fn strip_is_a_beam() {
    let [strip, beam] = cantilever::deflections().expect("the scene is walked");
    assert!((strip / beam - 1.0).abs() < 0.01, "{strip} {beam}");
}

/// As near as with half the edge: 3 %, which the solid is known to.
#[test]
fn tip_of_the_network_moves_like_the_solid() {
    let [shell, solid] = bend::tips().expect("the scene is walked");
    assert!((shell - solid).norm() < 0.05 * solid.norm(), "{shell} {solid}");
}

#[test]
fn known_front_is_found() {
    let [found, whole] = nondominated::areas().expect("the settings are sound");
    assert!(found < whole && found > 0.97 * whole, "{found} {whole}");
}

#[test]
fn search_ends_with_a_front() {
    let folder = tempfile::tempdir().expect("a temporary folder can be made");
    let front = front::front(&folder.path().join("run")).expect("the search ends");
    assert!(!front.is_empty());
    for point in &front {
        let is_beaten = |other: &pneumorph::report::FrontPoint| {
            other.place().iter().zip(point.place()).all(|(other, this)| *other > this)
        };
        assert!(point.place()[0] > 0.0 && !front.iter().any(is_beaten), "{}", point.id);
    }
}
