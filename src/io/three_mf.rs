//! 3MF: bodies as triangle meshes with their unit, name and materials, as printers' programs read them.
//!
//! ```text
//! [Content_Types].xml   _rels/.rels   3D/3dmodel.model                        in a ZIP archive
//! Metadata/Slic3r_PE_model.config     which body is of which extruder         where there are more bodies than one
//! ```
//! PrusaSlicer (2.5.0) leaves the format's own materials aside; it reads which triangles of an object are a volume, and of which
//! extruder, from a file of its own. Programs that read neither take the bodies' STL files as the parts of one object.
//!
//! The same model has the same bytes: no time is written. The build moves the part to where all coordinates are positive, as the
//! format wants the bed's corner to be its origin.
//!
//! Source: 3MF Consortium (2021), 3D Manufacturing Format, Core Specification 1.3.0; ECMA-376 part 2 for the package.

use std::fmt::Write as _;
use std::io::{Cursor, Write as _};
use std::path::Path;

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

use super::xml::escaped;
use super::{OutputError, atomic};
use crate::surface::TriangleMesh;

/// What a 3MF file holds.
#[derive(Clone, Copy, Debug)]
pub struct Model<'a> {
    /// Of the part, and title of the file.
    pub name: &'a str,
    /// One sentence about the part.
    pub description: &'a str,
    /// Its bodies, each of an extruder of its own, in their order.
    pub bodies: &'a [PrintBody<'a>],
}

/// What one extruder prints.
#[derive(Clone, Copy, Debug)]
pub struct PrintBody<'a> {
    /// What it is made of.
    pub material: &'a str,
    /// Closed, mm; positions are rounded to 32 bits, as in an STL.
    pub mesh: &'a TriangleMesh,
}

impl Model<'_> {
    /// Writes the file `path`, whole or not at all.
    ///
    /// # Errors
    /// [`OutputError::Write`] when the file system refuses.
    pub fn write(&self, path: &Path) -> Result<(), OutputError> {
        let bytes = self.package().map_err(|source| OutputError::write(path, source))?;
        atomic::write(path, &bytes)
    }

    fn package(&self) -> Result<Vec<u8>, std::io::Error> {
        let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Deflated)
            .last_modified_time(DateTime::default());
        let (model, volumes) = (self.xml(), self.volumes());
        let mut files = vec![
            ("[Content_Types].xml", CONTENT_TYPES),
            ("_rels/.rels", RELATIONSHIPS),
            ("3D/3dmodel.model", &model),
        ];
        if self.bodies.len() > 1 {
            files.push(("Metadata/Slic3r_PE_model.config", &volumes));
        }
        for (name, text) in files {
            archive.start_file(name, options)?;
            archive.write_all(text.as_bytes())?;
        }
        Ok(archive.finish()?.into_inner())
    }

    fn xml(&self) -> String {
        let [name, description] = [self.name, self.description].map(escaped);
        let bases: String = (self.bodies.iter().zip(COLOURS.iter().cycle()))
            .map(|(body, colour)| {
                let material = escaped(body.material);
                format!(r#"<base name="{material}" displaycolor="{colour}"/>"#)
            })
            .collect();
        let mut xml = format!(
            r#"<?xml version="1.0" encoding="UTF-8"?>
<model unit="millimeter" xml:lang="en-US" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">
<metadata name="Title">{name}</metadata>
<metadata name="Description">{description}</metadata>
<metadata name="Application">pneumorph {}</metadata>
<resources>
<basematerials id="1">{bases}</basematerials>
<object id="{OBJECT}" type="model" name="{name}" pid="1" pindex="0">
<mesh>
<vertices>
"#,
            env!("CARGO_PKG_VERSION")
        );
        // Writing to a string cannot fail.
        for p in self.bodies.iter().flat_map(|body| &body.mesh.positions) {
            let [x, y, z] = [p.x, p.y, p.z].map(|x| x as f32);
            let _ = writeln!(xml, r#"<vertex x="{x}" y="{y}" z="{z}"/>"#);
        }
        xml += "</vertices>\n<triangles>\n";
        let mut first = 0;
        for (place, body) in self.bodies.iter().enumerate() {
            // The object is of the first material where a triangle does not say another.
            let material =
                if place > 0 { format!(r#" pid="1" p1="{place}""#) } else { String::new() };
            for [a, b, c] in body.mesh.triangles.iter().map(|t| t.map(|v| v + first)) {
                let _ = writeln!(xml, r#"<triangle v1="{a}" v2="{b}" v3="{c}"{material}/>"#);
            }
            first += body.mesh.positions.len() as u32;
        }
        let boxes = self.bodies.iter().filter_map(|body| body.mesh.bounding_box());
        let lower = boxes.map(|(lower, _)| lower).reduce(|a, b| a.inf(&b));
        let [x, y, z]: [f64; 3] = (-lower.unwrap_or_default()).into();
        let _ = write!(
            xml,
            r#"</triangles>
</mesh>
</object>
</resources>
<build><item objectid="{OBJECT}" transform="1 0 0 0 1 0 0 0 1 {x} {y} {z}"/></build>
</model>
"#
        );
        xml
    }

    /// Which triangles are the volume of which extruder, as PrusaSlicer has it.
    fn volumes(&self) -> String {
        let mut xml = format!(
            r#"<?xml version="1.0" encoding="UTF-8"?>
<config>
<object id="{OBJECT}" instances_count="1">
<metadata type="object" key="name" value="{}"/>
"#,
            escaped(self.name)
        );
        let mut first = 0;
        for (body, extruder) in self.bodies.iter().zip(1..) {
            let next = first + body.mesh.triangles.len();
            let (last, material) = (next - 1, escaped(body.material));
            // Writing to a string cannot fail.
            let _ = write!(
                xml,
                r#"<volume firstid="{first}" lastid="{last}">
<metadata type="volume" key="name" value="{material}"/>
<metadata type="volume" key="volume_type" value="ModelPart"/>
<metadata type="volume" key="extruder" value="{extruder}"/>
</volume>
"#
            );
            first = next;
        }
        xml + "</object>\n</config>\n"
    }
}

/// The object that holds the bodies.
const OBJECT: u32 = 2;

const CONTENT_TYPES: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">
<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>
<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/>
</Types>
"#;

const RELATIONSHIPS: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">
<Relationship Id="rel0" Target="/3D/3dmodel.model" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/>
</Relationships>
"#;

/// Of the bodies, in turn: the blue of the project's pictures and others, opaque.
const COLOURS: [&str; 4] = ["#8CB3E6FF", "#E69A5CFF", "#7FBF7BFF", "#B39DDBFF"];

#[cfg(test)]
mod tests {
    use std::io::Read;

    use roxmltree::{Document, Node};

    use super::*;
    use crate::math::Vec3;

    fn model<'a>(bodies: &'a [PrintBody<'a>]) -> Model<'a> {
        Model { name: "g003-017", description: "bends & \"pushes\"", bodies }
    }

    fn body(mesh: &TriangleMesh) -> [PrintBody<'_>; 1] {
        [PrintBody { material: "a<b", mesh }]
    }

    fn part(bytes: Vec<u8>, name: &str) -> String {
        let mut archive = zip::ZipArchive::new(Cursor::new(bytes)).unwrap();
        let mut text = String::new();
        archive.by_name(name).unwrap().read_to_string(&mut text).unwrap();
        text
    }

    /// What is written is XML of the format's elements, with the vertices and triangles in their order.
    #[test]
    fn the_mesh_comes_back() {
        let mesh = TriangleMesh::sphere(7.0, 2);
        let text = part(model(&body(&mesh)).package().unwrap(), "3D/3dmodel.model");
        let document = Document::parse(&text).unwrap();
        assert_eq!(document.root_element().attribute("unit"), Some("millimeter"));
        let all = |name: &'static str| {
            document.descendants().filter(move |node| node.has_tag_name((NAMESPACE, name)))
        };
        let number =
            |node: &Node, name: &str| node.attribute(name).unwrap().parse::<f64>().unwrap();
        let vertices: Vec<Vec3> = all("vertex")
            .map(|node| Vec3::new(number(&node, "x"), number(&node, "y"), number(&node, "z")))
            .collect();
        assert_eq!(vertices.len(), mesh.positions.len());
        for (found, wanted) in vertices.iter().zip(&mesh.positions) {
            // 7 mm in 32 bits.
            assert!((found - wanted).amax() < 5e-7, "{found} {wanted}");
        }
        let triangles: Vec<[u32; 3]> = all("triangle")
            .map(|node| ["v1", "v2", "v3"].map(|name| number(&node, name) as u32))
            .collect();
        assert_eq!(triangles, mesh.triangles);
        assert_eq!(all("base").next().unwrap().attribute("name"), Some("a<b"));
        let words: Vec<_> = all("metadata").filter_map(|node| node.text()).collect();
        assert_eq!(words[..2], ["g003-017", "bends & \"pushes\""]);
        let moved = all("item").next().unwrap().attribute("transform").unwrap();
        let moved: Vec<f64> = moved.split(' ').map(|x| x.parse().unwrap()).collect();
        let (lower, _) = mesh.bounding_box().unwrap();
        assert_eq!(moved[9..], [-lower.x, -lower.y, -lower.z]);
    }

    #[test]
    fn the_same_model_has_the_same_bytes() {
        let mesh = TriangleMesh::sphere(7.0, 1);
        assert_eq!(model(&body(&mesh)).package().unwrap(), model(&body(&mesh)).package().unwrap());
        for (name, word) in
            [("[Content_Types].xml", "3dmodel+xml"), ("_rels/.rels", "/3D/3dmodel.model")]
        {
            let text = part(model(&body(&mesh)).package().unwrap(), name);
            assert!(Document::parse(&text).is_ok() && text.contains(word), "{text}");
        }
    }

    /// Triangles of the second body say its material, and to PrusaSlicer their range says its extruder; each body has vertices of its own.
    #[test]
    fn each_body_has_its_extruder() {
        let [mesh, other] = [1, 2].map(|n| TriangleMesh::sphere(7.0, n));
        let bodies = [
            PrintBody { material: "soft", mesh: &mesh },
            PrintBody { material: "x\"y", mesh: &other },
        ];
        let bytes = model(&bodies).package().unwrap();
        let text = part(bytes.clone(), "3D/3dmodel.model");
        let document = Document::parse(&text).unwrap();
        let all = |name: &'static str| {
            document.descendants().filter(move |node| node.has_tag_name((NAMESPACE, name)))
        };
        let count = mesh.triangles.len();
        for (t, triangle) in all("triangle").enumerate() {
            assert_eq!(triangle.attribute("p1"), (t >= count).then_some("1"));
            let least = if t < count { 0 } else { mesh.positions.len() };
            assert!(triangle.attribute("v1").unwrap().parse::<usize>().unwrap() >= least);
        }
        assert_eq!(all("triangle").count(), count + other.triangles.len());
        assert_eq!(all("base").count(), 2);
        let text = part(bytes, "Metadata/Slic3r_PE_model.config");
        let document = Document::parse(&text).unwrap();
        let ranges: Vec<[usize; 2]> = document
            .descendants()
            .filter(|node| node.has_tag_name("volume"))
            .map(|node| ["firstid", "lastid"].map(|n| node.attribute(n).unwrap().parse().unwrap()))
            .collect();
        assert_eq!(ranges, [[0, count - 1], [count, count + other.triangles.len() - 1]]);
        let values =
            document.descendants().filter(|node| node.attribute("key") == Some("extruder"));
        assert_eq!(
            values.filter_map(|node| node.attribute("value")).collect::<Vec<_>>(),
            ["1", "2"]
        );
    }

    const NAMESPACE: &str = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02";
}
