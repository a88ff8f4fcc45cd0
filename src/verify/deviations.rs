//! What was measured on a benchmark against its references.

use crate::scene::scene_file::SceneFile;
use crate::scene::shape::Measured;
use crate::scene::verify_section::VerifySection;
use crate::scene::watch_curve::Deviation;

/// One watch of a run against its reference.
pub(crate) struct Compared {
    pub watch: String,
    pub deviation: Deviation,
    /// Why there is no number.
    pub remark: Option<String>,
}

/// Nothing measured where there is a `reference` at `load`, as far as can be; the remark says why.
pub(crate) fn missed(watch: &str, load: f64, reference: f64, remark: String) -> Compared {
    let nothing = f64::NAN;
    let deviation = Deviation {
        error: f64::INFINITY,
        load,
        measured: nothing,
        reference,
        pointwise_error: f64::INFINITY,
    };
    Compared { watch: watch.to_owned(), deviation, remark: Some(remark) }
}

/// Every reference of `verify` against what was measured on its `scene`.
pub(crate) fn deviations(
    scene: &SceneFile,
    verify: &VerifySection,
    measured: &Measured,
) -> Vec<Compared> {
    let VerifySection { reference, limit_load, .. } = verify;
    let mut compared: Vec<Compared> = reference
        .iter()
        .map(|reference| {
            let mut watches = scene.watches.iter();
            let watch = watches.position(|watch| watch.name == reference.watch);
            let watch = watch.expect("the case was checked: every reference has its watch");
            match measured.curves[watch].deviation(reference) {
                Ok(deviation) => {
                    Compared { watch: reference.watch.clone(), deviation, remark: None }
                }
                Err(load) => {
                    let ending = measured.walked.ending.name().replace('_', " ");
                    let remark = format!("{ending} before load {load}");
                    missed(&reference.watch, load, f64::NAN, remark)
                }
            }
        })
        .collect();
    if let &Some(limit) = limit_load {
        compared.push(limit_deviation(limit, measured));
    }
    compared
}

fn limit_deviation(limit: f64, measured: &Measured) -> Compared {
    let watch = "limit";
    let Some(load) = measured.limit_load else {
        let ending = measured.walked.ending.name().replace('_', " ");
        return missed(watch, limit, limit, format!("no instability was met: {ending}"));
    };
    let error = 100.0 * (load - limit).abs() / limit;
    let deviation =
        Deviation { error, load: limit, measured: load, reference: limit, pointwise_error: error };
    Compared { watch: watch.to_owned(), deviation, remark: None }
}
