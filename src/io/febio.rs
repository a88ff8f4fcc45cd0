//! FEBio: the input file of a load case, in its format 4.0.
//!
//! ```text
//! tet10        corners 1 2 3 4, midpoints 1-2 2-3 3-1 1-4 2-4 3-4: our order
//! tri6         corners 1 2 3, midpoints 1-2 2-3 3-1; the normal leaves the body
//! pressure     positive against that normal, per deformed area
//! psi          Mooney-Rivlin: c1 (I1 - 3) + c2 (I2 - 3)     Yeoh: sum_i c_i (I1 - 3)^i     Ogden: sum_i c_i / m_i^2 (l1^m_i + ... - 3)
//! U(J)         k/2 (J - 1)^2 by `pressure_model` 2; its default is k/2 (ln J)^2
//! ```
//!
//! The two energies of the volume differ by about the share `J - 1`: by 1 % where the volume changes by 1 %.
//!
//! Source: Maas et al. (2012); FEBio user manual 4, "Uncoupled Materials", "Pressure Load", "Node_Data".

use std::fmt::Write;

use super::solid_case::{LawWithCard, SolidCase, list, number};

/// Where the solver writes the tip, beside the file.
pub const TIP_FILE: &str = "solid_febio_tip.txt";

/// The input file of `case`, for `febio4`.
#[must_use]
pub fn deck(case: &SolidCase<'_>) -> String {
    let SolidCase { title, mesh, clamp, tip, pressure, samples, .. } = *case;
    let mut text = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!-- {} -->\n<febio_spec version=\"4.0\">\n",
        title.replace("--", "-")
    );
    let mut line = |words: String| writeln!(text, "{words}").expect("a text grows");
    let step = number(1.0 / samples as f64);
    line(format!(
        "<Module type=\"solid\"/>\n<Control>\n<analysis>STATIC</analysis>\n<time_steps>{samples}</time_steps>\n\
         <step_size>{step}</step_size>\n<time_stepper type=\"default\">\n<dtmin>{LEAST_STEP:e}</dtmin>\n\
         <dtmax>{step}</dtmax>\n<max_retries>20</max_retries>\n</time_stepper>\n</Control>"
    ));
    line(material(case.law, case.bulk_modulus));
    line("<Mesh>\n<Nodes name=\"nodes\">".to_owned());
    for (x, node) in mesh.positions.iter().zip(1..) {
        let place = [x.x, x.y, x.z].map(number).join(",");
        line(format!("<node id=\"{node}\">{place}</node>"));
    }
    line("</Nodes>\n<Elements type=\"tet10\" name=\"WALL\">".to_owned());
    for (nodes, cell) in mesh.tetrahedra.iter().zip(1..) {
        line(format!("<elem id=\"{cell}\">{}</elem>", list(nodes)));
    }
    line("</Elements>".to_owned());
    for (name, nodes) in [("CLAMP", clamp), ("TIP", tip)] {
        line(format!("<NodeSet name=\"{name}\">{}</NodeSet>", list(nodes)));
    }
    line("<Surface name=\"CHAMBER\">".to_owned());
    for (&[a, b, c, bc, ca, ab], face) in mesh.chamber.iter().zip(1..) {
        // Ours looks out of the chamber, into the body.
        line(format!("<tri6 id=\"{face}\">{}</tri6>", list(&[a, c, b, ca, bc, ab])));
    }
    line(format!(
        "</Surface>\n</Mesh>\n<MeshDomains>\n<SolidDomain name=\"WALL\" mat=\"RUBBER\"/>\n</MeshDomains>\n\
         <Boundary>\n<bc name=\"clamp\" node_set=\"CLAMP\" type=\"zero displacement\">\n\
         <x_dof>1</x_dof>\n<y_dof>1</y_dof>\n<z_dof>1</z_dof>\n</bc>\n</Boundary>\n\
         <Loads>\n<surface_load name=\"pressure\" surface=\"CHAMBER\" type=\"pressure\">\n\
         <pressure lc=\"1\">{}</pressure>\n<linear>0</linear>\n<symmetric_stiffness>1</symmetric_stiffness>\n\
         </surface_load>\n</Loads>",
        number(pressure)
    ));
    line(format!(
        "<LoadData>\n<load_controller id=\"1\" type=\"loadcurve\">\n<interpolate>LINEAR</interpolate>\n\
         <points>\n<pt>0,0</pt>\n<pt>1,1</pt>\n</points>\n</load_controller>\n</LoadData>\n\
         <Output>\n<logfile>\n<node_data data=\"ux;uy;uz\" delim=\" \" file=\"{TIP_FILE}\">{}</node_data>\n\
         </logfile>\n<plotfile type=\"febio\">\n<var type=\"displacement\"/>\n</plotfile>\n</Output>\n</febio_spec>",
        list(tip)
    ));
    text
}

/// As a share of the whole pressure.
const LEAST_STEP: f64 = 1e-6;

fn material(law: &LawWithCard, bulk_modulus: f64) -> String {
    let named = |name: &str, values: Vec<f64>| -> Vec<(String, f64)> {
        (1..).zip(values).map(|(k, value)| (format!("{name}{k}"), value)).collect()
    };
    let (kind, numbers) = match law {
        LawWithCard::NeoHookean(law) => ("Mooney-Rivlin", named("c", vec![0.5 * law.mu, 0.0])),
        LawWithCard::MooneyRivlin(law) => ("Mooney-Rivlin", named("c", vec![law.c1, law.c2])),
        LawWithCard::Yeoh(law) => ("Yeoh", named("c", law.c.to_vec())),
        LawWithCard::Ogden(law) => {
            let factors = named("c", law.terms().map(|term| 2.0 * term.mu).collect());
            let exponents = named("m", law.terms().map(|term| term.alpha).collect());
            ("Ogden", [factors, exponents].concat())
        }
    };
    let mut text = format!("<Material>\n<material id=\"1\" name=\"RUBBER\" type=\"{kind}\">\n");
    for (name, value) in numbers {
        writeln!(text, "<{name}>{}</{name}>", number(value)).expect("a text grows");
    }
    text + &format!(
        "<k>{}</k>\n<pressure_model>2</pressure_model>\n</material>\n</Material>",
        number(bulk_modulus)
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::material::{Ogden, OgdenTerm};

    /// FEBio's factors are twice Abaqus' moduli.
    #[test]
    fn ogden_has_twice_the_moduli() {
        let terms = [OgdenTerm { mu: 1.5, alpha: -2.0 }, OgdenTerm { mu: -0.25, alpha: 4.0 }];
        let text = material(&LawWithCard::Ogden(Ogden::new(&terms)), 8.0);
        let material = roxmltree::Document::parse(&text).unwrap();
        let value = |name: &str| -> f64 {
            let node = material.descendants().find(|node| node.has_tag_name(name)).unwrap();
            node.text().unwrap().parse().unwrap()
        };
        let found = ["c1", "c2", "m1", "m2", "k", "pressure_model"].map(value);
        assert_eq!(found, [3.0, -0.5, -2.0, 4.0, 8.0, 2.0]);
    }
}
