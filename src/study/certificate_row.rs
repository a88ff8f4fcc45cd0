//! A row of `certificates.csv` and of `front_solid.csv`: a design as shell and as solid, and how far they agree.

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::front_rows::column;
use crate::fitness::{
    Certificate, Evaluation, FidelitySettings, OBJECTIVES, Objective, Verdict, flags,
};
use crate::io::csv::{self, Cell, Cells};
use crate::math::Rejected;
use crate::report::FrontPoint;
use crate::scene::part::solid_part::SolidReport;

/// How a design's shell and solid compare; what failed has no numbers behind its reason.
#[derive(Clone, Debug, Deserialize)]
pub(crate) struct Row {
    pub design: String,
    /// A [`Verdict`], or the room and reason of a rejection.
    pub verdict: String,
    /// The objectives that were asked, in the order of [`OBJECTIVES`].
    #[serde(flatten, deserialize_with = "objectives")]
    pub objectives: Vec<OfBoth>,
    pub figure_of_merit_solid: Option<f64>,
    pub max_force_solid: Option<f64>,
    /// Reasons to doubt the solid's objectives, by name.
    pub flags: String,
    /// Deviations as in [`Certificate`].
    pub angle: Option<f64>,
    pub force: Option<f64>,
    pub work: Option<f64>,
    pub growth: Option<f64>,
    #[serde(rename = "common_pressure_MPa", alias = "common_pressure")]
    pub common_pressure: Option<f64>,
    /// The largest deviation of a coarser solid.
    pub coarser_solid: Option<f64>,
    pub mesher: Option<String>,
    pub tetrahedra: Option<usize>,
    pub unknowns: Option<usize>,
    /// CPU seconds of one thread's clock; meshers run as other processes.
    pub seconds_shell: Option<f64>,
    pub seconds_solid: Option<f64>,
}

/// An objective of the shell and of the solid, where they have it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct OfBoth {
    pub objective: &'static Objective,
    pub shell: Option<f64>,
    pub solid: Option<f64>,
}

/// The objectives of which there are columns.
fn objectives<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<OfBoth>, D::Error> {
    let numbers = csv::numbers(deserializer)?;
    let of_both = |objective: &'static Objective| {
        let of = |stage: &str| numbers.get(&format!("{}_{stage}", objective.name)).copied();
        Some(OfBoth { objective, shell: of("shell")?, solid: of("solid")? })
    };
    Ok(OBJECTIVES.iter().filter_map(of_both).collect())
}

impl Cells for Row {
    fn cells(&self) -> Vec<(String, Cell<'_>)> {
        let number = |value: Option<f64>| value.map_or(Cell::Nothing, Cell::Number);
        let count = |value: Option<usize>| value.map_or(Cell::Nothing, Cell::Count);
        let objectives = self.objectives.iter().flat_map(|OfBoth { objective, shell, solid }| {
            [("shell", shell), ("solid", solid)]
                .map(|(stage, value)| (format!("{}_{stage}", objective.name), number(*value)))
        });
        let begin = [("design", Cell::Word(&self.design)), ("verdict", Cell::Word(&self.verdict))];
        let end = [
            ("figure_of_merit_solid", number(self.figure_of_merit_solid)),
            ("max_force_solid", number(self.max_force_solid)),
            ("flags", Cell::Word(&self.flags)),
            ("angle", number(self.angle)),
            ("force", number(self.force)),
            ("work", number(self.work)),
            ("growth", number(self.growth)),
            ("common_pressure_MPa", number(self.common_pressure)),
            ("coarser_solid", number(self.coarser_solid)),
            ("mesher", self.mesher.as_deref().map_or(Cell::Nothing, Cell::Word)),
            ("tetrahedra", count(self.tetrahedra)),
            ("unknowns", count(self.unknowns)),
            ("seconds_shell", number(self.seconds_shell)),
            ("seconds_solid", number(self.seconds_solid)),
        ];
        let named = |(name, cell): (&str, _)| (name.to_owned(), cell);
        begin.into_iter().map(named).chain(objectives).chain(end.into_iter().map(named)).collect()
    }
}

impl Serialize for Row {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        csv::as_map(self, serializer)
    }
}

impl Row {
    /// A row without numbers of a `design` that is judged by `objectives`.
    pub(super) fn new<'a>(design: &str, objectives: impl Iterator<Item = &'a Objective>) -> Self {
        let asked: Vec<&Objective> = objectives.collect();
        let of_both = |objective| OfBoth { objective, shell: None, solid: None };
        Self {
            design: design.to_owned(),
            verdict: String::new(),
            objectives: OBJECTIVES.iter().filter(|one| asked.contains(one)).map(of_both).collect(),
            figure_of_merit_solid: None,
            max_force_solid: None,
            flags: String::new(),
            angle: None,
            force: None,
            work: None,
            growth: None,
            common_pressure: None,
            coarser_solid: None,
            mesher: None,
            tetrahedra: None,
            unknowns: None,
            seconds_shell: None,
            seconds_solid: None,
        }
    }

    /// With the objectives of the shell.
    pub(super) fn with_shell(mut self, evaluation: &Evaluation) -> Self {
        for of_both in &mut self.objectives {
            of_both.shell = evaluation.value(of_both.objective);
        }
        self
    }

    /// With the reason of a rejection in place of a verdict.
    pub(super) fn rejected(self, rejected: &Rejected) -> Self {
        Self { verdict: format!("{:?}/{}", rejected.room, rejected.reason).to_lowercase(), ..self }
    }

    /// With what its solid, meshed as the `report` says, makes of it.
    pub(super) fn certified(
        mut self,
        evaluation: &Evaluation,
        report: &SolidReport,
        certificate: &Certificate,
        coarser: Option<&Certificate>,
    ) -> Self {
        for of_both in &mut self.objectives {
            of_both.solid = evaluation.value(of_both.objective);
        }
        Self {
            verdict: word(certificate.verdict).to_owned(),
            figure_of_merit_solid: Some(evaluation.figure_of_merit),
            max_force_solid: Some(evaluation.max_force),
            flags: flags(&evaluation.exploits),
            angle: Some(certificate.angle),
            force: Some(certificate.force),
            work: Some(certificate.work),
            growth: Some(certificate.growth),
            common_pressure: Some(certificate.common_pressure),
            coarser_solid: coarser.map(Certificate::largest),
            mesher: Some(report.mesher.clone()),
            tetrahedra: Some(report.quality.tetrahedra),
            unknowns: Some(evaluation.unknowns),
            ..self
        }
    }

    /// `objective` of the shell and of the solid.
    fn of_both(&self, objective: &Objective) -> [Option<f64>; 2] {
        let found = self.objectives.iter().find(|of_both| of_both.objective == objective);
        found.map_or([None; 2], |of_both| [of_both.shell, of_both.solid])
    }

    /// The objectives of the solid with their values, as the row has them; `None` if there are none, or one is missing.
    pub(super) fn solid_objectives(&self) -> Option<Vec<(&'static Objective, f64)>> {
        let solid = |of_both: &OfBoth| Some((of_both.objective, of_both.solid?));
        let solids: Option<Vec<_>> = self.objectives.iter().map(solid).collect();
        solids.filter(|solids| !solids.is_empty())
    }

    /// The solid as figures show it, where it has objectives.
    pub(super) fn front_point(&self) -> Option<FrontPoint> {
        let objectives = self.solid_objectives()?;
        Some(FrontPoint {
            id: self.design.clone(),
            objectives: objectives.into_iter().map(column).collect(),
            figure_of_merit: self.figure_of_merit_solid?,
            max_force: self.max_force_solid?,
            flags: self.flags.clone(),
            reached: None,
            rated: None,
            mesh_errors: Vec::new(),
        })
    }
}

fn word(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Trust => "trust",
        Verdict::Check => "check",
        Verdict::Misleads => "misleads",
    }
}

/// The rows for a terminal.
pub(crate) fn table(rows: &[Row]) -> String {
    let percent = |share: Option<f64>| {
        share.map_or_else(|| "-".to_owned(), |share| format!("{:.1}", 100.0 * share))
    };
    let number = |value: Option<f64>, digits: usize| {
        value.map_or_else(|| "-".to_owned(), |value| format!("{value:.digits$}"))
    };
    let asked = rows.iter().flat_map(|row| &row.objectives).map(|of_both| of_both.objective);
    let asked: Vec<&Objective> =
        OBJECTIVES.iter().filter(|one| asked.clone().any(|a| a == *one)).collect();
    let widths: Vec<usize> = asked.iter().map(|one| one.title().len().max(8)).collect();
    let head = asked
        .iter()
        .zip(&widths)
        .map(|(one, width)| format!("{:>width$} {:>8}", one.title(), "solid"));
    let mut lines = vec![format!(
        "{:<12} {} {:>7} {:>7} {:>7} {:>7} {:>8} {:>8} {:>8}  verdict",
        "design",
        head.collect::<Vec<_>>().join(" "),
        "angle%",
        "force%",
        "work%",
        "grow%",
        "coarse%",
        "tets",
        "CPU s"
    )];
    for row in rows {
        let objectives = asked.iter().zip(&widths).map(|(one, width)| {
            let [shell, solid] = row.of_both(one).map(|value| number(value, one.decimals));
            format!("{shell:>width$} {solid:>8}")
        });
        lines.push(format!(
            "{:<12} {} {:>7} {:>7} {:>7} {:>7} {:>8} {:>8} {:>8}  {}",
            row.design,
            objectives.collect::<Vec<_>>().join(" "),
            percent(row.angle),
            percent(row.force),
            percent(row.work),
            percent(row.growth),
            percent(row.coarser_solid),
            row.tetrahedra.map_or_else(|| "-".to_owned(), |count| count.to_string()),
            number(row.seconds_solid, 1),
            row.verdict
        ));
    }
    lines.join("\n")
}

/// What of a run's certificates is told to a person who wants one line.
pub(crate) fn summary(rows: &[Row], settings: &FidelitySettings) -> String {
    let count = |verdict: Verdict| rows.iter().filter(|row| row.verdict == word(verdict)).count();
    let [trust, check, misleads] = [Verdict::Trust, Verdict::Check, Verdict::Misleads].map(count);
    format!(
        "of {} designs the shell is right within {:.0} % for {trust}, within {:.0} % for {check}, misleads for {misleads}; {} have no solid",
        rows.len(),
        100.0 * settings.trust,
        100.0 * settings.check,
        rows.len() - trust - check - misleads
    )
}
