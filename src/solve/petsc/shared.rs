//! A system of which each rank evaluates its share; every rank sees the whole.

use super::library::{Exchange, Session};
use crate::model::system::{Inadmissible, System};
use crate::solve::decorator::Decorator;

/// Evaluates residual and tangent for this rank's rows, and gathers the residuals of all.
///
/// Every rank evaluates the whole energy; where there are multipliers, residual and tangent return that of the share alone. All
/// ranks must ask for the same at the same time.
pub(super) struct Shared<'a> {
    system: &'a mut dyn System,
    exchange: &'a Exchange,
    session: &'a Session,
    /// The unknowns of this rank's rows, `[n]`.
    share: Vec<bool>,
}

impl<'a> Shared<'a> {
    pub(super) fn new(
        system: &'a mut dyn System,
        exchange: &'a Exchange,
        session: &'a Session,
    ) -> Self {
        Self { system, share: exchange.rows().share(), exchange, session }
    }

    /// What `evaluate` makes of the share, with the residuals of all ranks in `residual`.
    fn gathered(
        &mut self,
        x: &[f64],
        residual: &mut [f64],
        evaluate: impl FnOnce(&mut dyn System, &mut [f64]) -> Result<f64, Inadmissible>,
    ) -> Result<f64, Inadmissible> {
        self.system.set_share(Some(&self.share));
        let evaluated = evaluate(self.system, residual);
        self.system.set_share(None);
        // What is no number says to all ranks that the state is inadmissible.
        let own = |&unknown: &u32| match evaluated {
            Ok(_) => residual[unknown as usize],
            Err(_) => f64::NAN,
        };
        let own: Vec<f64> = self.exchange.rows().own_unknowns().iter().map(own).collect();
        let gathered = self.exchange.gather(self.session, &own, residual);
        gathered.expect("MPI ends a job of which it loses a rank");
        if residual.iter().any(|entry| entry.is_nan()) {
            return Err(evaluated.err().unwrap_or(ELSEWHERE));
        }
        // Who lowers an energy wants it whole; with multipliers nobody does.
        if self.system.multipliers().is_empty() { self.system.energy(x) } else { evaluated }
    }
}

const ELSEWHERE: Inadmissible = Inadmissible("another rank found the state inadmissible");

impl<'a> Decorator for Shared<'a> {
    type Inner = dyn System + 'a;

    fn inner(&self) -> &Self::Inner {
        self.system
    }

    fn inner_mut(&mut self) -> &mut Self::Inner {
        self.system
    }

    fn residual(&mut self, x: &[f64], residual: &mut [f64]) -> Result<f64, Inadmissible> {
        self.gathered(x, residual, |system, residual| system.residual(x, residual))
    }

    fn tangent(
        &mut self,
        x: &[f64],
        residual: &mut [f64],
        tangent: &mut [f64],
    ) -> Result<f64, Inadmissible> {
        self.gathered(x, residual, |system, residual| system.tangent(x, residual, tangent))
    }
}
