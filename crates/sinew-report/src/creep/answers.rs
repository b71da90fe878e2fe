//! The answers of creep tests, a sentence each.

use super::words::{ahead, duration, group, short};
use sinew_creep::{
    Analysis, Coverage, FitSet, Forecaster, PERCENT_PER_H, Rank, ScatterSource, scatter,
};
use sinew_figure::{Headline, Level};
use sinew_model::Bounded;

/// Specimens beyond which groups answer.
const FEW: usize = 6;

fn bracketed(b: Bounded) -> String {
    format!("{} ({} to {})", short(b.value), short(b.low), short(b.high))
}

/// How far each specimen, or of many each group, stretched, and whether it goes on.
pub(super) fn of_analyses(analyses: &[Analysis]) -> Vec<Headline> {
    if analyses.len() > FEW {
        return scatter(analyses)
            .iter()
            .take(FEW)
            .map(|g| {
                let end = short(100.0 * g.end_strain_ratio);
                let name = group(&g.group);
                Headline::from(format!(
                    "{name}: {end} % at the end, mean of {}",
                    g.specimens
                ))
            })
            .collect();
    }
    analyses.iter().map(of_analysis).collect()
}

/// How far a specimen stretched, and whether it goes on.
pub(super) fn of_analysis(a: &Analysis) -> Headline {
    let load = a
        .force_n
        .map_or(String::new(), |n| format!(" under {} N", short(n)));
    let slope = a.slope_per_s.map_or(String::new(), |s| {
        format!("; it creeps at {} %/h", bracketed(s.scaled(PERCENT_PER_H)))
    });
    let (level, settled) = match a.saturated {
        Some(true) => (Level::Good, ": it has settled"),
        Some(false) => (Level::Plain, ": it has not settled"),
        None => (Level::Plain, ""),
    };
    let end = short(100.0 * a.end_strain_ratio);
    let after = duration(a.duration_s);
    Headline::new(
        level,
        format!("{}: {end} % after {after}{load}{slope}{settled}", a.name),
    )
}

/// Which ropes stretched least, as far as that is shown.
pub(super) fn of_ranks(ranks: &[Rank]) -> Vec<Headline> {
    let first: Vec<&Rank> = ranks.iter().filter(|r| r.rank == 1).collect();
    let strain = |r: &Rank| format!("{}: {} %", r.name, bracketed(r.strain_ratio.scaled(100.0)));
    let strains: Vec<String> = first.iter().copied().map(strain).collect();
    let after = first.first().map_or(String::new(), |r| duration(r.at_s));
    let mut out: Vec<Headline> = match first.as_slice() {
        [] => return Vec::new(),
        [one] => vec![Headline::new(
            Level::Good,
            format!(
                "{} stretched least: {} % after {after} (95 % in brackets)",
                one.name,
                bracketed(one.strain_ratio.scaled(100.0))
            ),
        )],
        _ => vec![Headline::new(
            Level::Open,
            format!(
                "Which of {} ropes stretches least can't be told: {} after {after} (95 % in brackets)",
                first.len(),
                strains.join("; ")
            ),
        )],
    };
    if first
        .iter()
        .any(|r| r.scatter_source == ScatterSource::StartingGuess)
    {
        out.push(Headline::new(
            Level::Open,
            "How much specimens of a rope differ is a guess: test repeats of each",
        ));
    }
    out
}

/// Where forecasts end; without one, what was seen and which law fits best.
pub(super) fn of_fits(fits: &[FitSet], analyses: &[Analysis]) -> Vec<Headline> {
    let of = |set: &FitSet| {
        let name = &set.name;
        let forecast = set.forecast.as_ref().zip(set.forecast_conditions.as_ref());
        if let Some((f, conditions)) = forecast
            && let Some(last) = f.time_s.len().checked_sub(1)
        {
            let strain = Bounded {
                value: f.strain_ratio[last],
                low: f.reading_low_strain_ratio[last],
                high: f.reading_high_strain_ratio[last],
            };
            return Some(format!(
                "{name}: {} % after {} under {} (95 % in brackets)",
                bracketed(strain.scaled(100.0)),
                duration(f.time_s[last]),
                ahead(conditions)
            ));
        }
        let best = set.laws.first()?.law.name();
        let seen = analyses.iter().find(|a| a.name == *name);
        let seen = seen.map_or_else(|| name.clone(), |a| of_analysis(a).text);
        Some(format!("{seen}; of the laws tried, {best} fits best"))
    };
    fits.iter()
        .take(FEW)
        .filter_map(of)
        .map(Headline::from)
        .collect()
}

/// How often forecasts held what was hidden from them.
pub(super) fn of_withheld(withheld: &[Coverage]) -> Vec<Headline> {
    /// A share from here on is as promised.
    const HELD: f64 = 0.9;
    let all = withheld
        .iter()
        .find(|c| c.forecaster == Forecaster::Combined);
    let Some((c, share)) = all.and_then(|c| Some((c, c.readings_share()?))) else {
        return Vec::new();
    };
    let level = if share >= HELD {
        Level::Good
    } else {
        Level::Watch
    };
    let percent = short(100.0 * share);
    vec![Headline::new(
        level,
        format!(
            "Of the hidden readings {percent} % lie within the forecasts' 95 % intervals ({} tests)",
            c.tests
        ),
    )]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::creep::page_tables::coverage_table;
    use sinew_figure::{Block, Page};

    fn coverage(readings_inside: usize) -> Coverage {
        Coverage {
            forecaster: Forecaster::Combined,
            tests: 3,
            failed: 0,
            readings: 100,
            readings_inside,
            ends_inside: 3,
            end_error_ratio: 0.01,
            end_half_width_ratio: f64::NAN,
        }
    }

    #[test]
    fn what_forecasts_held_is_the_answer_and_no_interval_is_a_dash() {
        let answer = |inside| of_withheld(&[coverage(inside)]).remove(0);
        assert_eq!(
            answer(93).text,
            "Of the hidden readings 93.0 % lie within the forecasts' 95 % intervals (3 tests)"
        );
        assert_eq!(
            (answer(93).level, answer(60).level),
            (Level::Good, Level::Watch)
        );
        let table = Block::Table(coverage_table(&[coverage(93)]));
        let page = Page::new("").section("", vec![table]).html();
        assert!(
            page.contains("<td>–</td>") && !page.contains("NaN"),
            "{page}"
        );
    }

    #[test]
    fn ropes_that_cannot_be_told_apart_are_not_ranked_in_the_headline() {
        let rank = |name: &str, rank| Rank {
            rank,
            name: name.into(),
            specimens: 3,
            at_s: 3600.0,
            strain_ratio: Bounded {
                value: 0.005,
                low: 0.004,
                high: 0.006,
            },
            slope_per_s: None,
            scatter_share: 0.1,
            scatter_source: ScatterSource::Repeats,
        };
        let apart = of_ranks(&[rank("A", 1), rank("B", 2)]);
        assert_eq!(
            apart[0].text,
            "A stretched least: 0.500 (0.400 to 0.600) % after 60.0 min (95 % in brackets)"
        );
        let alike = of_ranks(&[rank("A", 1), rank("B", 1)]);
        assert_eq!((alike.len(), alike[0].level), (1, Level::Open));
        assert!(alike[0].text.contains("can't be told"), "{}", alike[0].text);
    }
}
