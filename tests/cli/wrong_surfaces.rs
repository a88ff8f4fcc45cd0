//! STL files that are no chamber, and clamps that hold nothing or everything.

use pneumorph::io::stl;
use pneumorph::surface::TriangleMesh;

use super::workshop::Workshop;

const PART: &str = "[part]\nstl = \"part.stl\"\n";

fn sphere() -> TriangleMesh {
    TriangleMesh::sphere(10.0, 2)
}

fn refuse_surface(surface: &TriangleMesh, words: &[&str]) {
    let workshop = Workshop::new();
    stl::write(&workshop.path("part.stl"), surface).unwrap();
    workshop.refuse_scene(PART, words);
}

#[test]
fn files_that_are_no_stl_are_told() {
    let workshop = Workshop::new();
    workshop.refuse_scene(PART, &["part.stl: no such file or folder"]);
    workshop.refuse_scene("[part]\nstl = \".\"\n", &[".: is a folder, not a file"]);
    let mut announced = vec![0; 84];
    announced[80..].copy_from_slice(&u32::MAX.to_le_bytes());
    for (contents, words) in [
        (&b""[..], "part.stl: is an empty file, which is not read"),
        (b"<html>404</html>", "part.stl: is a web page, which is not read"),
        (&b"dear reader, this is a letter and no part. ".repeat(9), "part.stl: not an STL"),
        (b"solid gold is nice\n", "part.stl: the STL holds no triangle"),
        (b"solid gold\nis nice\n", "part.stl:2: `is` where `facet` or `endsolid` belongs"),
        (b"solid\nendsolid\n", "part.stl: the STL holds no triangle"),
        (&[0; 84], "part.stl: the STL holds no triangle"),
        (&announced, "part.stl: not an STL: neither ASCII, nor binary"),
        (
            b"solid\nfacet normal 0 0 0\nouter loop\nvertex nan 0 0\nvertex 0 1 0\nvertex 0 0 1\nendloop\nendfacet\nendsolid\n",
            "finite",
        ),
    ] {
        workshop.write("part.stl", contents);
        workshop.refuse_scene(PART, &[words]);
    }
}

#[test]
fn surfaces_that_are_no_chamber_are_told() {
    let mut open = sphere();
    open.triangles.pop();
    refuse_surface(&open, &["part.stl: 3 edges have only one triangle: the surface has holes"]);

    let mut branching = sphere();
    branching.triangles.push(branching.triangles[0]);
    refuse_surface(&branching, &["part.stl: 3 edges have more than two triangles"]);

    let mut inward = sphere();
    inward.triangles.iter_mut().for_each(|triangle| triangle.swap(0, 1));
    refuse_surface(&inward, &["part.stl: the enclosed volume is -", "must face outward"]);

    let mut opposed = sphere();
    opposed.triangles[0].swap(0, 1);
    refuse_surface(&opposed, &["part.stl: 3 edges are passed twice in the same direction"]);

    let mut crossing = sphere();
    crossing.positions[0] *= -1.5;
    refuse_surface(&crossing, &["part.stl: ", "pairs of triangles pass through each other"]);

    let mut flat = sphere();
    flat.positions.iter_mut().for_each(|position| position.z = 0.0);
    refuse_surface(&flat, &["part.stl: "]);
}

#[test]
fn several_surfaces_are_no_chamber() {
    let mut two = sphere();
    let shift = two.positions.len() as u32;
    let second = sphere();
    two.positions.extend(second.positions.iter().map(|p| p.map(|x| x + 50.0)));
    two.triangles.extend(second.triangles.iter().map(|t| t.map(|v| v + shift)));
    refuse_surface(&two, &["part.stl: 2 separate surfaces, but one closed chamber is wanted"]);

    let mut hollow = sphere();
    hollow.positions.extend(second.positions.iter().map(|p| p * 0.5));
    hollow
        .triangles
        .extend(second.triangles.iter().map(|&[a, b, c]| [b + shift, a + shift, c + shift]));
    refuse_surface(
        &hollow,
        &["part.stl: 2 separate surfaces", "a body around a cavity", "tetrahedra"],
    );
}

#[test]
fn a_clamp_holds_something_and_not_everything() {
    let workshop = Workshop::new();
    stl::write(&workshop.path("part.stl"), &sphere()).unwrap();
    let clamped = |height: &str| {
        format!("{PART}[mesh]\nedge = \"as given\"\n[wall]\nclamp_height = {height}\n")
    };
    workshop
        .refuse_scene(&clamped("1e-9"), &["part.stl: Mesh: clamp_holds_nothing", "fewer than 3"]);
    for height in ["1000", "12.4"] {
        workshop.refuse_scene(
            &clamped(height),
            &["scene.toml: the clamp holds the tip too", "clamp_height"],
        );
    }
    workshop.refuse_scene(
        "[part]\nnetwork = \"network.toml\"\n[mesh]\nedge = 5\n[wall]\nclamp_height = 1000\n",
        &["scene.toml: the clamp holds the tip too"],
    );
    workshop.refuse(&["simulate", "scene.toml", "--out", "out"], 1, &["the tip begins at z = 59."]);
}

/// A unit mistake: the part in metres, its wall in mm.
#[test]
fn a_wall_thicker_than_its_part_is_told() {
    let mut tiny = sphere();
    tiny.positions.iter_mut().for_each(|position| *position *= 1e-3);
    refuse_surface(
        &tiny,
        &[
            "part.stl: the part is 0.020 mm long and its wall 1.600 mm thick; is the file in metres",
            "scale",
        ],
    );
}

/// Nothing is left of a path that could not begin.
#[test]
fn a_part_that_is_unstable_at_rest_leaves_no_folder() {
    let workshop = Workshop::new();
    // Two moduli of which rounding leaves no more than its own size: pivots of either sign.
    let terms = "{ mu = 1e12, alpha = 2.0 }, { mu = -999999999999.9999, alpha = -2.0 }";
    let material = format!("[material]\nlaw = \"ogden\"\nterms = [{terms}]\n");
    let scene = format!("[part]\nnetwork = \"network.toml\"\n[mesh]\nedge = 5\n{material}");
    workshop.refuse_scene(&scene, &["scene.toml: the part is not stable at rest"]);
}
