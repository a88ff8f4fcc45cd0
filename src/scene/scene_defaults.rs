//! A scene file with every default, and examples of what is a list.

use super::keys::{annotated, sections};
use super::material::MaterialSection;
use super::mesh_section::{Edge, MeshSection};
use super::part::Part;
use super::scene_file::{LoadSection, SceneFile, default_solver};
use crate::field::DesignBox;
use crate::fitness::LoadSettings;
use crate::mesh::{MeshSettings, ShellSettings};

/// A list has no default to print.
const LIST_EXAMPLES: &str = "
# Folds of the wall keep each other off, instead of passing through each other.
# [self_contact]
# activation = 0.2  # gap at which they begin to push, in thicknesses
# pressure = 0.2  # about how hard they press, MPa; the largest pressure where it is left out

# Your own surface, the middle of the wall: [part] stl = \"part.stl\", with axis = \"x\" where it lies along x and scale = 1000 where it is in
# metres. [mesh] edge is 1.5 wall thicknesses where it is left out; edge = \"as given\" keeps the file's triangles.

# The wall in tetrahedra (a network or an STL file), instead of a shell. Or your own: [part] tetrahedra = \"wall.msh\",
# with chamber = \"name\" (or number) of the physical group of its triangles, and close_inlet = true where that is open at a flat inlet
# [solid]
# edge = 2.0  # mm, on the wall's faces
# layers = 1  # through the wall; as many as make tetrahedra as high as wide where it is left out
# mesher = \"tetgen\"  # or gmsh; the one and then the other where it is left out

# What the material may bear, at the faces of the wall; the path ends there.
# [limits]
# stretch = 1.5  # largest principal stretch; that of the preset where the section is empty
# nominal_stress = 4.0  # with it or instead: largest principal nominal stress, MPa

# A part of the wall that is thicker, thinner or of another material; as many as needed, of which the last counts where they overlap.
# [[region]]
# where = \"-8 - x\"  # a formula of x, y, z at rest (mm; of a patch of s, t), positive in the region
# thickness = 2.4  # or a formula, as \"1.6 + 0.01*z\"; as [wall] says where it is left out
# material = { law = \"neo-hookean\", mu = 5.0 }
# limits = { stretch = 1.2 }  # of this material, where it may bear less or more than [limits] says

# A rigid plane on the -x side; as many as needed.
# [[plane]]
# normal = [1.0, 0.0, 0.0]
# distance = 5.0
# friction = 0.4  # Coulomb's coefficient; 0 computes none

# A number followed along the path, in watches.csv: tip with a direction, chord-angle, volume-growth, stored-energy.
# [[watch]]
# name = \"chord\"
# measure = \"chord-angle\"

# Instead of [part] network: [part.sphere], [part.ellipsoid] (verify/shells has both), or an open surface of formulas
# with dead loads, of which examples/scenes/plate.toml explains every key:
# [part.patch]
# s = [0, 40]
# t = [0, 25]
# cells = [8, 8]
# x = \"25*sin(s*pi/180)\"
# y = \"t\"
# z = \"25*cos(s*pi/180)\"
# [[edge]]
# side = \"t0\"  # or s0, s1, t1
# clamped = true  # or symmetry = \"y\", or hold = [\"x\", \"z\"]
# [[force]]
# per_area = [0, 0, -1e-4]  # MPa; or at with force, or side with per_length, which `follower = true` turns with the wall
";

/// A scene file with every default, as TOML.
pub(crate) fn defaults() -> String {
    let scene = SceneFile {
        part: Part { network: Some("network.toml".into()), ..Part::default() },
        design_box: DesignBox::default(),
        mesh: MeshSection {
            edge: Some(Edge::Length(MeshSettings::default().edge)),
            ..MeshSection::default()
        },
        wall: ShellSettings::default(),
        material: MaterialSection::default(),
        load: LoadSection {
            pressure: Some(LoadSettings::default().pressure),
            ..LoadSection::default()
        },
        solver: default_solver(),
        self_contact: None,
        limits: None,
        pattern: None,
        regions: Vec::new(),
        gravity: None,
        solid: None,
        planes: Vec::new(),
        edges: Vec::new(),
        pins: Vec::new(),
        forces: Vec::new(),
        moments: Vec::new(),
        watches: Vec::new(),
        verify: None,
    };
    let defaults = toml::to_string(&scene).expect("the defaults are plain numbers and words");
    annotated(&defaults, &sections::<SceneFile>()) + LIST_EXAMPLES
}
