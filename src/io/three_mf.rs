//! 3MF: one triangle mesh with its unit, name and material, as printers' programs read it.
//!
//! ```text
//! [Content_Types].xml   _rels/.rels   3D/3dmodel.model        in a ZIP archive
//! ```
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
use crate::math::Vec3;
use crate::surface::TriangleMesh;

/// What a 3MF file holds.
#[derive(Clone, Copy, Debug)]
pub struct Model<'a> {
    /// Of the part, and title of the file.
    pub name: &'a str,
    /// One sentence about the part.
    pub description: &'a str,
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
        let model = self.xml();
        for (name, text) in [
            ("[Content_Types].xml", CONTENT_TYPES),
            ("_rels/.rels", RELATIONSHIPS),
            ("3D/3dmodel.model", &model),
        ] {
            archive.start_file(name, options)?;
            archive.write_all(text.as_bytes())?;
        }
        Ok(archive.finish()?.into_inner())
    }

    fn xml(&self) -> String {
        let Self { mesh, .. } = self;
        let [name, description, material] =
            [self.name, self.description, self.material].map(escaped);
        let mut xml = format!(
            r#"<?xml version="1.0" encoding="UTF-8"?>
<model unit="millimeter" xml:lang="en-US" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">
<metadata name="Title">{name}</metadata>
<metadata name="Description">{description}</metadata>
<metadata name="Application">pneumorph {}</metadata>
<resources>
<basematerials id="1"><base name="{material}" displaycolor="{COLOUR}"/></basematerials>
<object id="2" type="model" name="{name}" pid="1" pindex="0">
<mesh>
<vertices>
"#,
            env!("CARGO_PKG_VERSION")
        );
        // Writing to a string cannot fail.
        for p in &mesh.positions {
            let [x, y, z] = [p.x, p.y, p.z].map(|x| x as f32);
            let _ = writeln!(xml, r#"<vertex x="{x}" y="{y}" z="{z}"/>"#);
        }
        xml += "</vertices>\n<triangles>\n";
        for [a, b, c] in &mesh.triangles {
            let _ = writeln!(xml, r#"<triangle v1="{a}" v2="{b}" v3="{c}"/>"#);
        }
        let [x, y, z]: [f64; 3] =
            (-mesh.bounding_box().map_or(Vec3::zeros(), |(lower, _)| lower)).into();
        let _ = write!(
            xml,
            r#"</triangles>
</mesh>
</object>
</resources>
<build><item objectid="2" transform="1 0 0 0 1 0 0 0 1 {x} {y} {z}"/></build>
</model>
"#
        );
        xml
    }
}

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

/// The blue of the project's pictures, opaque.
const COLOUR: &str = "#8CB3E6FF";

#[cfg(test)]
mod tests {
    use std::io::Read;

    use roxmltree::{Document, Node};

    use super::*;

    fn model(mesh: &TriangleMesh) -> Model<'_> {
        Model { name: "g003-017", description: "bends & \"pushes\"", material: "a<b", mesh }
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
        let text = part(model(&mesh).package().unwrap(), "3D/3dmodel.model");
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
        assert_eq!(model(&mesh).package().unwrap(), model(&mesh).package().unwrap());
        for (name, word) in
            [("[Content_Types].xml", "3dmodel+xml"), ("_rels/.rels", "/3D/3dmodel.model")]
        {
            let text = part(model(&mesh).package().unwrap(), name);
            assert!(Document::parse(&text).is_ok() && text.contains(word), "{text}");
        }
    }

    const NAMESPACE: &str = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02";
}
