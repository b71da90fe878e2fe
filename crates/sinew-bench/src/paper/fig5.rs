//! Fig. 5: a rope under changing force.

use super::PaperError;
use super::assessment::{claimed, laws};
use super::bending::{ROPE, ROPE_M, bench, drawn, end, runs};
use super::data::{FigureName, PaperFigure, given};
use rayon::prelude::*;
use sinew_rope::Catalogue;
use sinew_rope::bench::{Simulated, simulate};
use sinew_rope::law::Law;

/// Sampling interval, s.
const INTERVAL_S: f64 = 60.0;

/// Fig. 5: the force changes after 80 min.
///
/// # Errors
/// [`PaperError`].
pub fn fig5(catalogue: &Catalogue) -> Result<PaperFigure, PaperError> {
    let laws = laws(catalogue, ROPE)?;
    let cases = ["E", "F"]
        .into_iter()
        .map(|name| runs(&laws, name, INTERVAL_S))
        .collect::<Result<Vec<_>, _>>()?;
    let (e, f) = (&cases[0], &cases[1]);
    // Both are sampled at the same times; the change is sampled before and after.
    let after = e[0]
        .force_n
        .iter()
        .position(|n| *n != e[0].force_n[0])
        .unwrap_or(1);
    let at = |run: &Simulated, k: usize| run.strain_percent[k];
    let kept = kept(&laws)?;
    // What (E) has over (F) at the change is due to the higher force; `kept` remains of it.
    let compensated = |i: usize| 1.0 - kept[i] / (at(&e[i], after - 1) - at(&f[i], after - 1));
    let held = held_on(&laws)?;
    // Minutes from the change until 90 % of what changes has changed.
    let slow = |run: &Simulated| {
        let (from, to) = (at(run, after - 1), end(run));
        let there = |k: &usize| (at(run, *k) - from) / (to - from) >= 0.9;
        let k = (after..run.time_s.len()).find(there).unwrap_or(after);
        (run.time_s[k] - run.time_s[after]) / 60.0
    };
    let sentences = vec![
        claimed(
            "(E) 200 N, then 120 N: the elongation drops.",
            "strain falls at the change and is lower still at the end",
            |i| at(&e[i], after) < at(&e[i], after - 1) && end(&e[i]) < at(&e[i], after),
        ),
        claimed(
            "(E) A part of the elongation is irreversible.",
            "after 115 days at 120 N, when all delayed strain has recovered, it remains above that of a rope without the higher load, by at least a tenth of the decrease in the 80 min after the change",
            |i| kept[i] >= 0.1 * (at(&e[i], after - 1) - end(&e[i])),
        ),
        claimed(
            "(F) 120 N, then 200 N: the elongation rises over a longer time.",
            "it rises, and 90 % of the rise take at least twice as long as 90 % of the drop of (E), and a minute at least",
            |i| {
                let rises = end(&f[i]) > at(&f[i], after - 1);
                rises && slow(&f[i]) >= (2.0 * slow(&e[i])).max(1.0)
            },
        ),
        claimed(
            "Elongation due to higher forces is partly compensated afterwards.",
            "of the elongation that 200 N cause in excess of 120 N in 80 min, 10 to 90 % recover after the change to 120 N",
            |i| (0.1..=0.9).contains(&compensated(i)),
        ),
        claimed(
            "Pretension to the workload reduces the elongation.",
            "a rope held at 200 N for 80 min elongates in the next 80 min at 200 N by less than half of what a new one does in its first 80 min, the immediate elastic strain excluded",
            |i| {
                end(&held[i]) - at(&held[i], after)
                    < 0.5 * (at(&held[i], after - 1) - at(&held[i], 0))
            },
        ),
    ];
    let titles = ["(E) 200 N, then 120 N", "(F) 120 N, then 200 N"];
    let mut out = drawn(
        FigureName::Fig5,
        "Fig. 5: elongation under changing force",
        &titles,
        &cases,
    );
    out.sentences = sentences;
    out.given = given(&[
        "200 N for 80 min, then 120 N for 80 min; and the other way round. No elongation is given.",
    ]);
    out.about = vec![
        "Virtual bench without guiding pulleys; the force on the carriage changes after 80 min."
            .into(),
    ];
    out.assumptions
        .push("(E) and (F) have no guiding pulley, and the motor moves all the time.".into());
    Ok(out)
}

/// Every law's run of (E) without the change of the force.
fn held_on(laws: &[Law]) -> Result<Vec<Simulated>, PaperError> {
    let mut held = bench("E")?;
    let first = held.phases[0].force_n;
    for phase in &mut held.phases {
        phase.force_n = first;
    }
    laws.par_iter()
        .map(|law| simulate(law, &held, ROPE_M, INTERVAL_S).map_err(PaperError::from))
        .collect::<Vec<_>>()
        .into_iter()
        .collect()
}

/// Strain that (E) keeps over a rope that was at 120 N all the time, 115 days on, in every draw.
fn kept(laws: &[Law]) -> Result<Vec<f64>, PaperError> {
    const LONG_HOLD_S: f64 = 1e7;
    let mut high = bench("E")?;
    let last = high.phases.len() - 1;
    high.phases[last].duration_s = LONG_HOLD_S;
    let mut low = high.clone();
    for phase in &mut low.phases {
        phase.force_n = high.phases[last].force_n;
    }
    laws.par_iter()
        .map(|law| {
            let end_of = |bench| simulate(law, bench, ROPE_M, LONG_HOLD_S).map(|run| end(&run));
            Ok(end_of(&high)? - end_of(&low)?)
        })
        .collect::<Vec<_>>()
        .into_iter()
        .collect()
}
