//! Constitutive laws of a hyperelastic wall in plane stress.
//!
//! The two in-plane principal stretches `l1, l2` enter through two smooth invariants of the in-plane metrics
//! `G` (reference) and `g` (current); the third stretch is the one at which the normal stress vanishes,
//! `1 / (l1 l2)` where the wall is incompressible.
//!
//! ```text
//! T = tr(G^-1 g) = l1^2 + l2^2          J = det g / det G = (l1 l2)^2
//! ```

#[macro_use]
mod list;

// The laws of rubber: each a file beside this one, and a line here.
rubbers! {
    neo_hookean: NeoHookean,
    mooney_rivlin: MooneyRivlin,
    yeoh: Yeoh,
    ogden: Ogden,
}

mod compressible;
mod file_laws;
mod fit_form;
mod homogeneous;
mod incompressible_law;
mod keys;
#[expect(clippy::module_inception, reason = "the noun that the folder is about")]
mod material;
mod named_law;
mod of_invariants;
mod ogden_term;
mod rubber;
mod solid;
mod st_venant_kirchhoff;
mod stability;
#[cfg(test)]
mod test_laws;

pub use compressible::Compressible;
pub use file_laws::{keys, laws_in_words};
pub use fit_form::{FitForm, fit_forms};
pub use homogeneous::Loading;
pub use keys::{InvalidMaterial, Key, KeyKind, KeyValue, positive, within};
pub use material::Material;
pub use of_invariants::OfInvariants;
pub use ogden_term::OgdenTerm;
pub use rubber::Rubber;
pub use solid::{SolidLaw, SolidResponse};
pub use st_venant_kirchhoff::StVenantKirchhoff;
#[cfg(test)]
pub(crate) use test_laws::example_rubbers;
