//! Groups, sections and counts as programs write them, and as nobody should.

use super::*;

/// Three tetrahedra about a hole would be more than these sections need: one, and one of its faces.
const TET_41: &str = "$Nodes\n1 4 1 4\n3 1 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n$EndNodes\n\
                      $Elements\n2 2 1 2\n2 7 2 1\n1 1 2 3\n3 1 4 1\n2 1 2 3 4\n$EndElements\n";
const HEAD_41: &str = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n";
const NAMES: &str =
    "$PhysicalNames\n3\n1 5 \"curve\"\n2 5 \"chamber\"\n3 5 \"wall of it\"\n$EndPhysicalNames\n";

/// Name or number of each group of triangles, and of tetrahedra, with how many it has.
fn groups(bytes: &[u8]) -> [Vec<(String, usize)>; 2] {
    let raw = parse(bytes).unwrap();
    [&raw.surfaces, &raw.volumes].map(|marks| {
        let named = |group: crate::io::marks::Group| (group.in_words(), group.elements);
        marks.groups().into_iter().map(named).collect()
    })
}

fn of(words: &[(&str, usize)]) -> Vec<(String, usize)> {
    words.iter().map(|(name, count)| ((*name).to_owned(), *count)).collect()
}

/// Gmsh 4 lists a surface of several groups with all of them, turned round with a sign, and names groups of each dimension by themselves.
#[test]
fn entities_have_several_groups() {
    let entities = "$Entities\n1 0 1 1\n1 0 0 0 1 5\n7 0 0 0 1 1 0 2 -5 6 0\n1 0 0 0 1 1 1 1 5 1 7\n$EndEntities\n";
    let text = format!("{HEAD_41}{NAMES}{entities}{TET_41}");
    let [surfaces, volumes] = groups(text.as_bytes());
    assert_eq!(surfaces, of(&[("\"chamber\" (5)", 1), ("6", 1)]));
    assert_eq!(volumes, of(&[("\"wall of it\" (5)", 1)]));
}

/// In a mesh that was divided, elements belong to pieces of the entities, which have groups of their own.
#[test]
fn pieces_of_entities_have_groups() {
    let entities = "$Entities\n0 0 1 1\n70 0 0 0 1 1 0 1 5 0\n10 0 0 0 1 1 1 1 5 1 70\n$EndEntities\n\
                    $PartitionedEntities\n2\n1\n9 1\n1 0 1 1\n3 0 1 2 1 2 0 0 0 1 4\n\
                    7 2 70 1 2 0 0 0 1 1 0 1 5 1 3\n1 3 10 1 1 0 0 0 1 1 1 1 5 1 7\n$EndPartitionedEntities\n";
    let text = format!("{HEAD_41}{NAMES}{entities}{TET_41}");
    let [surfaces, volumes] = groups(text.as_bytes());
    assert_eq!(surfaces, of(&[("\"chamber\" (5)", 1)]));
    assert_eq!(volumes, of(&[("\"wall of it\" (5)", 1)]));
}

/// Version 2.2 lists a triangle once for each of its groups, and 0 is none.
#[test]
fn a_triangle_is_listed_for_each_group() {
    let text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n2  -5   \"cavity  wall\"\n$EndPhysicalNames\n\
                $Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n$Elements\n5\n\
                1 2 2 5 1 1 2 3\n2 2 2 6 1 1 2 3\n3 2 2 0 1 1 2 4\n4 2 0 1 3 4\n5 4 4 3 1 1 1 1 2 3 4\n$EndElements\n";
    let [surfaces, volumes] = groups(text.as_bytes());
    assert_eq!(surfaces, of(&[("\"cavity  wall\" (5)", 1), ("6", 1)]));
    assert_eq!(volumes, of(&[("3", 1)]));
}

/// Nodes with their entity and their places on it, of which curves have one and surfaces two; as text and as bytes.
#[test]
fn nodes_may_have_parameters() {
    let tail = "$EndParametricNodes\n$Elements\n1\n1 4 2 1 1 1 2 3 4\n$EndElements\n";
    let text = format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$ParametricNodes\n4\n1 0 0 0 0 1\n2 1 0 0 1 4 0.5\n3 0 1 0 2 3 0.5 0.25\n4 0 0 1 3 1\n{tail}"
    );
    let expected = parse(text.as_bytes()).unwrap();
    assert_eq!(expected.positions[3], crate::math::Vec3::z());

    let mut bytes =
        b"$MeshFormat\n2.2 1 8\n\x01\0\0\0\n$EndMeshFormat\n$ParametricNodes\n4\n".to_vec();
    let places = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]];
    let entities: [(i32, &[f64]); 4] = [(0, &[]), (1, &[0.5]), (2, &[0.5, 0.25]), (3, &[])];
    for ((number, place), (dimension, on)) in (1i32..).zip(places).zip(entities) {
        bytes.extend(number.to_le_bytes());
        bytes.extend(place.iter().flat_map(|x: &f64| x.to_le_bytes()));
        bytes.extend([dimension, 1].iter().flat_map(|n| n.to_le_bytes()));
        bytes.extend(on.iter().flat_map(|x| x.to_le_bytes()));
    }
    bytes.extend(b"\n$EndParametricNodes\n$Elements\n1\n");
    bytes.extend([4i32, 1, 2, 1, 1, 1, 1, 2, 3, 4].iter().flat_map(|n| n.to_le_bytes()));
    // No line ends here, nor in the section that is passed over, whose numbers hold a dollar sign.
    bytes.extend(b"$EndElements\n$ElementData\n1\n\"color\"\n0\n3\n0\n1\n1\n\x01\0\0\0$\n$\0\0\0\0\0$EndElementData\n");
    bytes.extend(b"$Comments\nlast$EndComments");
    assert_eq!(parse(&bytes).unwrap(), expected);
}

/// 20,000 triangles of a surface with 20,000 groups share one list of them.
#[test]
fn groups_take_linear_memory() {
    let n = 20_000;
    let numbers: Vec<String> = (1..=n).map(|number| number.to_string()).collect();
    let entities =
        format!("$Entities\n0 0 1 0\n7 0 0 0 1 1 0 {n} {} 0\n$EndEntities\n", numbers.join(" "));
    let triangles: String = (1..=n).map(|number| format!("{number} 1 2 3\n")).collect();
    let elements = format!("2 {} 1 {}\n2 7 2 {n}\n{triangles}3 1 4 1\n0 1 2 3 4", n + 1, n + 1);
    let text = format!("{HEAD_41}{entities}{TET_41}")
        .replace("2 2 1 2\n2 7 2 1\n1 1 2 3\n3 1 4 1\n2 1 2 3 4", &elements);
    let raw = parse(text.as_bytes()).unwrap();
    assert_eq!(raw.triangles.len(), n);
    assert!(raw.triangles.iter().all(|(_, set)| *set == raw.triangles[0].1));
    assert_eq!(raw.surfaces.groups().len(), n);
}

/// Each count of a file in turn is far more than the file can hold: told at once, and nothing is asked of the machine.
#[test]
fn counts_are_bounded_by_the_file() {
    let huge = "4000000000000000000";
    let entities = "$Entities\n0 0 1 1\n7 0 0 0 1 1 0 1 5 0\n1 0 0 0 1 1 1 1 5 1 7\n$EndEntities\n";
    let text = format!("{HEAD_41}{NAMES}{entities}{TET_41}");
    parse(text.as_bytes()).unwrap();
    let changes = [
        ("$PhysicalNames\n3", "PhysicalNames"),
        ("0 0 1 1 0 1", "Entities"),
        ("1 1 1 1 5 1", "Entities"),
        ("3 1 0 4", "Nodes"),
        ("1 4 1 4", "Nodes"),
        ("2 7 2 1", "Elements"),
        ("2 2 1 2", "Elements"),
    ];
    for (from, section) in changes {
        let (kept, _) = from.rsplit_once([' ', '\n']).unwrap();
        // The number of blocks is the first of its line.
        let to = match from {
            "1 4 1 4" => format!("{huge} 4 1 4"),
            "2 2 1 2" => format!("{huge} 2 1 2"),
            _ => format!("{}{huge}", &from[..=kept.len()]),
        };
        let found = parse(text.replacen(from, &to, 1).as_bytes()).map(|_| ());
        assert_eq!(
            found,
            Err(format!("the section ${section} cannot be read to its end")),
            "{from} {to}"
        );
    }
    let twice = text.replacen("1\n2\n3\n4\n", "1\n2\n3\n3\n", 1);
    assert_eq!(parse(twice.as_bytes()).map(|_| ()), Err("the node 3 is listed twice".to_owned()));
}
