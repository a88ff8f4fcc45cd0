//! A scene in the hands of a program: read or written by it, walked, and nothing written.

use std::path::{Path, PathBuf};

use anyhow::Context;

use super::actuator::Actuator;
use super::observer::Observer;
use super::part::PartSource;
use super::part::on_disk::OnDisk;
use super::results::walk_summary::check_left_rest;
use super::scene_file::SceneFile;
use super::shape::{Measured, Shape, watches_of_tip};
use super::watch_curve::WatchCurve;
use crate::fitness::{Observation, observations};
use crate::io::toml_file;
use crate::math::cpu_seconds;
use crate::model::PartModel;
use crate::solve::{self, Backend, Stop};

/// A scene file, read and checked: one part, its wall, its load, what holds it, and the planes that
/// it may touch.
#[derive(Clone, Debug)]
pub struct Scene {
    file: SceneFile,
    /// The files that it names lie beside it.
    path: PathBuf,
}

/// A scene whose path was walked.
pub struct Walk {
    /// The part. It reads displacements, forces and stresses off the unknowns of a point of the
    /// path.
    pub model: PartModel,
    /// The equilibria in the order in which they were reached, and how the path ended; no points if
    /// it was interrupted at rest, or if the part is not stable there.
    pub path: solve::Path,
    /// A row for each point of the path, if the part has a clamp and a tip; else none.
    pub observations: Vec<Observation>,
    /// The name of each `[[watch]]`, with its value at each point of the path.
    pub watches: Vec<(String, Vec<f64>)>,
    /// For how long programs of others made tetrahedra, s.
    pub mesher_seconds: f64,
}

impl Scene {
    /// Reads the scene file at `path`; `solver` is taken instead of its own.
    ///
    /// # Errors
    /// One line that names the file when it cannot be read, or says what no scene can.
    pub fn read(path: &Path, solver: Option<Backend>) -> anyhow::Result<Self> {
        Ok(Self { file: SceneFile::read(path, solver)?, path: path.to_owned() })
    }

    /// Reads the `text` of a scene file as if it stood at `path`.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn parse(text: &str, path: &Path, solver: Option<Backend>) -> anyhow::Result<Self> {
        let mut file: SceneFile = toml_file::parse(text, path)?;
        file.solver.backend = solver.unwrap_or(file.solver.backend);
        file.check().with_context(|| path.display().to_string())?;
        Ok(Self { file, path: path.to_owned() })
    }

    /// Makes the part, and walks its path until `stop` wants the end.
    ///
    /// # Errors
    /// When the part cannot be made, its path stalls at rest, or a library fails.
    pub fn walk(&self, stop: Stop<'_>, observer: &dyn Observer) -> anyhow::Result<Walk> {
        let source = self.file.part.source(&self.path, &OnDisk)?;
        if source.is_actuator() {
            self.walk_actuator(&source, stop, observer)
        } else {
            self.walk_shape(&source, stop, observer)
        }
    }

    fn walk_actuator(
        &self,
        source: &PartSource<'_>,
        stop: Stop<'_>,
        observer: &dyn Observer,
    ) -> anyhow::Result<Walk> {
        let mut actuator = Actuator::new(&self.file, source, &self.path, observer)?;
        let (path, _) = actuator.walk(&self.file, stop, observer)?;
        let Actuator { mesh, model, solid, .. } = actuator;
        let largest = self.file.load_settings().pressure;
        let watches = watches_of_tip(&self.file, &mesh.ends)?;
        let curves: Vec<_> =
            watches.iter().map(|watch| watch.curve(&model, &path.points, largest)).collect();
        let attempts = solid.iter().flat_map(|solid| &solid.report.attempts);
        Ok(Walk {
            observations: observations(&mesh, &model, &path.points),
            watches: self.named(&curves),
            mesher_seconds: attempts.map(|attempt| attempt.seconds).sum(),
            model,
            path,
        })
    }

    fn walk_shape(
        &self,
        source: &PartSource<'_>,
        stop: Stop<'_>,
        observer: &dyn Observer,
    ) -> anyhow::Result<Walk> {
        let start = cpu_seconds();
        let mut shape = Shape::new(&self.file, source, observer)?;
        shape.warnings.iter().for_each(|warning| observer.warning(warning));
        let backend = self.file.solver.backend;
        let Measured { walked: path, curves, .. } =
            shape.measure(&self.file, backend, start, stop, observer)?;
        check_left_rest(&path)?;
        let observations = shape
            .watched()
            .map_or_else(Vec::new, |watched| observations(watched, &shape.model, &path.points));
        let watches = self.named(&curves);
        Ok(Walk { model: shape.model, path, observations, watches, mesher_seconds: 0.0 })
    }

    /// The values of all watches, by name.
    fn named(&self, curves: &[WatchCurve]) -> Vec<(String, Vec<f64>)> {
        let values = |curve: &WatchCurve| curve.points.iter().map(|point| point.value).collect();
        let names = self.file.watches.iter().map(|watch| watch.name.clone());
        names.zip(curves.iter().map(values)).collect()
    }
}
