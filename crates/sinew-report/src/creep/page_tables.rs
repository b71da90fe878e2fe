//! Tables of the report of a creep test.

use super::terminal::{coverage, secant};
use super::words::{
    ahead, duration, fault, group, interval_kind, not_converged, open, parameter_name,
    reading_time, scatter_source, short, why_fixed, zero,
};
use sinew_creep::{
    Analysis, Conditions, Coverage, Failure, Fit, FitSet, FixedParameter, Isochrone, PERCENT_PER_H,
    Rank, Scatter, Source, Span,
};
use sinew_figure::{Block, Table};
use sinew_model::Bounded;

/// Load, temperature and what the laboratory states.
pub(super) fn test_table(conditions: &Conditions, analyses: &[Analysis]) -> Table {
    let stated = |text: &Option<String>| text.clone().unwrap_or_else(|| "not stated".to_owned());
    let of =
        |pick: fn(&Analysis) -> Option<f64>| analyses.iter().filter_map(pick).collect::<Vec<_>>();
    let humidity = |pick: fn(&Span) -> f64| {
        analyses
            .iter()
            .filter_map(|a| a.humidity_percent.as_ref().map(pick))
            .collect::<Vec<_>>()
    };
    let moist = [humidity(|h| h.low), humidity(|h| h.high)].concat();
    let lengths: Vec<f64> = analyses.iter().map(|a| a.duration_s / 3600.0).collect();
    let rows = [
        ("Standard", conditions.standard.clone()),
        ("Load", span(&of(|a| a.force_n), "N")),
        ("Preload", span(&of(|a| a.preload_n), "N")),
        (
            "Stress",
            span(&of(|a| a.stress_pa.map(|s| s * 1e-6)), "MPa"),
        ),
        (
            "Temperature",
            span(&of(|a| a.temperature_c.map(|t| t.mean)), "°C"),
        ),
        ("Humidity or moisture", span(&moist, "%")),
        ("Time under load", span(&lengths, "h")),
        ("Preconditioning", stated(&conditions.preconditioning)),
        ("Conditions", stated(&conditions.conditions)),
    ];
    Table::facts(rows)
}

fn bracketed(b: Bounded) -> String {
    format!("{} ({} to {})", short(b.value), short(b.low), short(b.high))
}

fn span(values: &[f64], unit: &str) -> String {
    if values.is_empty() {
        return "not recorded".to_owned();
    }
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if high - low < 1e-3 * high.abs() {
        format!("{} {unit}", short(low))
    } else {
        format!("{} to {} {unit}", short(low), short(high))
    }
}

/// Readings of every specimen at the times of the standard.
pub(super) fn reading_blocks(analyses: &[Analysis]) -> Vec<Block> {
    analyses
        .iter()
        .filter(|a| !a.readings.is_empty())
        .map(|a| {
            Block::Table(
                Table::new(
                    &["time", "strain, %", "creep modulus, MPa"],
                    a.readings.iter().map(|r| {
                        vec![
                            reading_time(r.time_s),
                            format!("{:.4}", 100.0 * r.strain_ratio),
                            r.modulus_pa.map_or("–".into(), |m| short(m * 1e-6)),
                        ]
                    }),
                )
                .captioned(format!(
                    "{}: strain from the zero ({})",
                    a.name,
                    zero(a.zero)
                )),
            )
        })
        .collect()
}

/// Falls of the load; `None` without any.
pub(super) fn recovery_table(analyses: &[Analysis]) -> Option<Table> {
    let rows: Vec<Vec<String>> = analyses
        .iter()
        .flat_map(|a| {
            a.recovery.iter().map(|r| {
                vec![
                    a.name.clone(),
                    format!("{} → {}", short(r.force_before_n), short(r.force_after_n)),
                    format!("{:.4}", 100.0 * r.at_once_strain_ratio),
                    format!("{:.4}", 100.0 * r.delayed_strain_ratio),
                    format!("{:.4}", 100.0 * r.residual_strain_ratio),
                    duration(r.duration_s),
                ]
            })
        })
        .collect();
    (!rows.is_empty()).then(|| {
        Table::new(
            &[
                "specimen",
                "load, N",
                "at once, %",
                "later, %",
                "left, %",
                "watched for",
            ],
            rows,
        )
    })
}

/// Exponent and secant of every group and time.
pub(super) fn isochrone_table(isochrones: &[Isochrone]) -> Table {
    Table::new(&["group", "after", "specimens", "load per %", "p", "from", "to"], isochrones
            .iter()
            .map(|i| {
                vec![
                    group(&i.group).to_owned(),
                    reading_time(i.time_s),
                    i.points.len().to_string(),
                    secant(i, short),
                    short(i.exponent.value),
                    short(i.exponent.low),
                    short(i.exponent.high),
                ]
            })).captioned("Strain of a group's specimens after the same time under different loads, ε ∝ σ^p; p = 1: strain is proportional to load. Load per %: secant at the middle of the loads.")
}

/// Failures and oddities, each a line.
pub(super) fn odd_blocks(failures: &[Failure], analyses: &[Analysis]) -> Vec<Block> {
    let mut odd: Vec<String> = failures.iter().map(ToString::to_string).collect();
    for a in analyses {
        odd.extend(a.faults.iter().map(|f| format!("{}: {}", a.name, fault(f))));
    }
    if !odd.is_empty() {
        /// A list nobody reads to its end is cut.
        const MOST: usize = 60;
        let more = odd.len().saturating_sub(MOST);
        odd.truncate(MOST);
        if more > 0 {
            odd.push(format!("and {more} more, in the table file"));
        }
        return vec![Block::List(odd)];
    }
    Vec::new()
}

/// Files with their checksums, and what was understood of them.
pub(super) fn source_blocks(sources: &[Source]) -> Vec<Block> {
    let mut blocks = vec![Block::Table(
        Table::new(
            &["file", "SHA-256"],
            sources
                .iter()
                .map(|s| vec![s.file.clone(), s.sha256.clone()]),
        )
        .captioned("A file with another checksum is another file."),
    )];
    let notes: Vec<String> = sources
        .iter()
        .flat_map(|s| {
            let used: Vec<String> = s
                .columns
                .iter()
                .map(|c| format!("{} from '{}' in {}", c.quantity.name(), c.column, c.unit))
                .collect();
            std::iter::once(format!("{}: {}", s.file, used.join(", ")))
                .chain(s.notes.iter().map(|n| format!("{}: {n}", s.file)))
                .collect::<Vec<_>>()
        })
        .collect();
    blocks.push(Block::List(notes));
    blocks
}

pub(super) fn result_table(analyses: &[Analysis]) -> Table {
    Table::new(&["specimen", "load, N", "end, %", "creep, %", "m_E, %/h", "95 % of creep", "saturated"], analyses
            .iter()
            .map(|a| {
                vec![
                    a.name.clone(),
                    a.force_n.map_or("–".into(), short),
                    format!("{:.4}", 100.0 * a.end_strain_ratio),
                    format!("{:.4}", 100.0 * a.creep_strain_ratio),
                    a.slope_per_s
                        .map_or("–".into(), |s| bracketed(s.scaled(PERCENT_PER_H))),
                    a.saturation_s.map_or("–".into(), duration),
                    a.saturated.map_or("–", |s| if s { "yes" } else { "no" }).into(),
                ]
            })).captioned("m_E: slope of a straight line from 20 min on unless stated otherwise, with the interval that correlated residuals leave. 95 % of creep: when less than a twentieth of the creep was still to come.")
}

/// Ropes in the order of their strain.
pub(super) fn rank_table(ranks: &[Rank]) -> Table {
    let after = ranks.first().map_or(0.0, |r| r.at_s) / 60.0;
    Table::new(
        &[
            "rank",
            "rope",
            "specimens",
            "strain, %",
            "m_E, %/h",
            "between specimens",
        ],
        ranks.iter().map(|r| {
            vec![
                r.rank.to_string(),
                r.name.clone(),
                r.specimens.to_string(),
                bracketed(r.strain_ratio.scaled(100.0)),
                r.slope_per_s
                    .map_or("–".into(), |s| bracketed(s.scaled(PERCENT_PER_H))),
                format!(
                    "{} %, {}",
                    short(100.0 * r.scatter_share),
                    scatter_source(r.scatter_source)
                ),
            ]
        }),
    )
    .captioned(format!(
        "Strain after {} min; brackets are 95 % intervals of a rope's mean. A rank is one \
             more than the ropes whose whole interval lies below.",
        short(after)
    ))
}

pub(super) fn group_table(groups: &[Scatter]) -> Table {
    Table::new(
        &["group", "specimens", "end, %", "m_E, %/h", "apart"],
        groups.iter().map(|g| {
            let with = |unit: f64, v: f64, d: Option<f64>| match d {
                Some(d) => format!("{} (σ {})", short(unit * v), short(unit * d)),
                None => short(unit * v),
            };
            vec![
                group(&g.group).to_owned(),
                g.specimens.to_string(),
                with(100.0, g.end_strain_ratio, g.end_deviation_ratio),
                g.slope_per_s.map_or("–".into(), |s| {
                    with(PERCENT_PER_H, s, g.slope_deviation_per_s)
                }),
                g.apart.join(", "),
            ]
        }),
    )
    .captioned("Mean; σ: standard deviation between specimens.")
}

pub(super) fn fit_blocks(fits: &[Fit]) -> Vec<Block> {
    let least = fits.iter().map(|f| f.aicc).fold(f64::INFINITY, f64::min);
    let mut blocks = vec![Block::Table(
        Table::new(
            &["law", "equation", "ΔAICc", "weight", "BIC", "residual, %"],
            fits.iter().map(|f| {
                vec![
                    f.law.name().to_owned(),
                    f.law.equation().to_owned(),
                    format!("{:.1}", f.aicc - least),
                    format!("{:.2}", f.weight),
                    format!("{:.1}", f.bic).replace('-', "−"),
                    short(100.0 * f.residual_strain_ratio),
                ]
            }),
        )
        .worded(&["equation"])
        .captioned("Smaller AICc is better; a difference above 10 leaves no doubt."),
    )];
    for fit in fits {
        let kind = fit
            .parameters
            .first()
            .map_or("", |p| interval_kind(p.interval));
        blocks.push(Block::from(Table::new(&["parameter", "value", "std. error", "from", "to", "unit", "remark"], fit
                .parameters
                .iter()
                .map(|p| {
                    vec![
                        parameter_name(p),
                        short(p.value),
                        short(p.std_error),
                        short(p.low),
                        short(p.high),
                        p.unit.clone(),
                        p.not_identifiable.map_or(String::new(), |what| {
                            let why = open(what, &p.unit);
                            format!("not identifiable from this record: {why}")
                        }),
                    ]
                })).worded(&["unit", "remark"]).captioned(format!(
                "{}: std. errors from the covariance, intervals by {kind}; noise of the readings {} %, {:.0} % of its variance slow (memory: time times {})",
                fit.law.name(),
                short(100.0 * fit.residual_strain_ratio),
                100.0 * fit.noise.share,
                short(fit.noise.memory.exp())
            ))));
        if let Some(how) = not_converged(fit) {
            blocks.push(Block::Notice(format!("{}: {how}.", fit.law.name())));
        }
        if !fit.fixed.is_empty() {
            let fixed = |h: &FixedParameter| {
                vec![h.name.clone(), short(h.value), why_fixed(h.why).to_owned()]
            };
            blocks.push(Block::Table(
                Table::new(&["parameter", "value", "why"], fit.fixed.iter().map(fixed))
                    .worded(&["why"])
                    .captioned("Held at the base rope's values: the records can't tell them."),
            ));
        }
    }
    blocks
}

/// Where forecasts end, and under what; `None` without any.
pub(super) fn forecast_table(fits: &[FitSet]) -> Option<Table> {
    let rows: Vec<Vec<String>> = fits
        .iter()
        .filter_map(|set| {
            let (f, conditions) = (set.forecast.as_ref()?, set.forecast_conditions.as_ref()?);
            let last = f.time_s.len().checked_sub(1)?;
            Some(vec![
                set.name.clone(),
                ahead(conditions),
                format!("{} h", short(f.time_s[last] / 3600.0)),
                short(100.0 * f.strain_ratio[last]),
                short(100.0 * f.reading_low_strain_ratio[last]),
                short(100.0 * f.reading_high_strain_ratio[last]),
            ])
        })
        .collect();
    let head = ["specimen", "under", "after", "strain, %", "from", "to"];
    (!rows.is_empty()).then(|| {
        Table::new(&head, rows).captioned(
            "All laws weighed; the interval of a reading, widened by how far the laws missed the record's own end. Beyond three times its length it grows by what every decade of the record brought.",
        )
    })
}

pub(super) fn coverage_table(rows: &[Coverage]) -> Table {
    Table::new(
        &[
            "law",
            "tests",
            "readings inside, %",
            "ends inside, %",
            "median error at the end, % of creep",
            "median half width",
        ],
        rows.iter().map(|c| {
            let [readings, ends, error, width] = coverage(c, "");
            let name = c.forecaster.name().to_owned();
            vec![name, c.tests.to_string(), readings, ends, error, width]
        }),
    )
}
