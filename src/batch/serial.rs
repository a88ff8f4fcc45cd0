//! One item after the other, on the calling thread.

use super::{Executor, Next, Outcome, Stopped, guarded};

/// Evaluates on the calling thread, in the items' order.
#[derive(Clone, Copy, Debug, Default)]
pub struct Serial;

impl<Item, Output> Executor<Item, Output> for Serial {
    fn evaluate(
        &self,
        items: &[Item],
        evaluate: &(dyn Fn(&Item) -> Output + Sync),
        finished: &mut dyn FnMut(usize, &Outcome<Output>) -> Next,
    ) -> Result<Vec<Outcome<Output>>, Stopped> {
        let mut outcomes = Vec::with_capacity(items.len());
        for (index, item) in items.iter().enumerate() {
            let outcome = guarded(item, evaluate);
            if finished(index, &outcome) == Next::Stop {
                return Err(Stopped::ByObserver);
            }
            outcomes.push(outcome);
        }
        Ok(outcomes)
    }
}

#[cfg(test)]
mod tests {
    use super::super::suite;
    use super::*;

    #[test]
    fn keeps_the_contract() {
        suite::check(&Serial);
    }
}
