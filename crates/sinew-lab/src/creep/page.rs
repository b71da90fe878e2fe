//! The report of a creep test, for a customer.

use super::analyze::{Analysis, Scatter};
use super::fit::Fit;
use super::picture::short;
use super::withhold::Coverage;
use crate::plot::Figure;
use crate::report::{Block, Page, Table};

/// What the file can't say, as the laboratory states it.
#[derive(Debug, Clone, Default, PartialEq, serde::Serialize)]
pub struct Conditions {
    /// Standard followed.
    pub standard: String,
    /// What was done to the specimens before.
    pub preconditioning: Option<String>,
    /// Atmosphere, conditioning time, grips, how extension was measured.
    pub conditions: Option<String>,
}

/// A raw data file.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Source {
    /// File as named.
    pub file: String,
    /// SHA-256 of its bytes.
    pub sha256: String,
    /// Columns used: quantity, header, unit.
    pub columns: Vec<[String; 3]>,
    /// Assumptions made when reading it.
    pub notes: Vec<String>,
}

/// Specimens beyond which readings are left to the table file.
const READINGS_OF: usize = 12;

/// What a report tells; empty lists leave their section out.
#[derive(Debug, Default)]
pub struct Contents<'a> {
    /// Heading.
    pub title: String,
    /// Raw data.
    pub sources: &'a [Source],
    /// What the laboratory states.
    pub conditions: Conditions,
    /// Specimens.
    pub analyses: &'a [Analysis],
    /// Repeats.
    pub groups: &'a [Scatter],
    /// Laws fitted, per specimen or group.
    pub fits: &'a [(String, Vec<Fit>)],
    /// Forecasts held against withheld readings.
    pub withheld: &'a [Coverage],
    /// What couldn't be analysed, with the reason.
    pub failures: &'a [String],
    /// Figures with the line under them.
    pub figures: Vec<(Figure, String)>,
}

/// Builds the page.
pub fn page(contents: Contents<'_>) -> Page {
    let Contents {
        title,
        sources,
        conditions,
        analyses,
        groups,
        fits,
        withheld,
        failures,
        figures,
    } = contents;
    let stated = |text: &Option<String>| text.clone().unwrap_or_else(|| "not stated".to_owned());
    let mut page = Page::new(title);
    let plural = |n: usize, word: &str| format!("{n} {word}{}", if n == 1 { "" } else { "s" });
    page.subtitle = format!(
        "{} from {}",
        plural(analyses.len(), "specimen"),
        plural(sources.len(), "file")
    );
    page.footer = format!("Sinew {}", env!("CARGO_PKG_VERSION"));
    let lengths = analyses.iter().map(|a| a.duration_s / 3600.0);
    let forces: Vec<f64> = analyses.iter().filter_map(|a| a.force_n).collect();
    let span = |values: &[f64], unit: &str| match values {
        [] => "not recorded".to_owned(),
        values => {
            let low = values.iter().copied().fold(f64::INFINITY, f64::min);
            let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            if high - low < 1e-3 * high.abs() {
                format!("{} {unit}", short(low))
            } else {
                format!("{} to {} {unit}", short(low), short(high))
            }
        }
    };
    let of =
        |pick: fn(&Analysis) -> Option<f64>| analyses.iter().filter_map(pick).collect::<Vec<_>>();
    page = page.section(
        "Test",
        vec![Block::Table(Table {
            caption: String::new(),
            head: Vec::new(),
            rows: [
                ("Standard", conditions.standard.clone()),
                ("Load", span(&forces, "N")),
                ("Preload", span(&of(|a| a.preload_n), "N")),
                ("Stress", span(&of(|a| a.stress_mpa), "MPa")),
                ("Temperature", span(&of(|a| a.temperature_c), "°C")),
                (
                    "Humidity or moisture",
                    span(&of(|a| a.humidity_percent), "%"),
                ),
                ("Time under load", span(&lengths.collect::<Vec<_>>(), "h")),
                ("Preconditioning", stated(&conditions.preconditioning)),
                ("Conditions", stated(&conditions.conditions)),
            ]
            .into_iter()
            .map(|(k, v)| vec![k.to_owned(), v])
            .collect(),
        })],
    );
    let mut blocks: Vec<Block> = figures
        .into_iter()
        .map(|(figure, caption)| Block::Figure(Box::new(figure), caption))
        .collect();
    blocks.push(Block::Table(result_table(analyses)));
    page = page.section("Creep", blocks);
    if groups.iter().any(|g| g.specimens > 1) {
        page = page.section("Groups", vec![Block::Table(group_table(groups))]);
    }
    if analyses.len() <= READINGS_OF {
        let blocks = analyses
            .iter()
            .filter(|a| !a.readings.is_empty())
            .map(|a| {
                Block::Table(Table {
                    caption: format!("{}: strain from the zero ({})", a.name, a.zero),
                    head: ["time", "strain, %", "creep modulus, MPa"]
                        .map(String::from)
                        .to_vec(),
                    rows: a
                        .readings
                        .iter()
                        .map(|r| {
                            vec![
                                duration(r.time_s),
                                format!("{:.4}", r.strain_percent),
                                r.modulus_mpa.map_or("–".into(), short),
                            ]
                        })
                        .collect(),
                })
            })
            .collect::<Vec<_>>();
        if !blocks.is_empty() {
            page = page.section("Readings", blocks);
        }
    }
    let recovered: Vec<Vec<String>> = analyses
        .iter()
        .flat_map(|a| {
            a.recovery.iter().map(|r| {
                vec![
                    a.name.clone(),
                    format!("{} → {}", short(r.force_before_n), short(r.force_after_n)),
                    format!("{:.4}", r.at_once_percent),
                    format!("{:.4}", r.delayed_percent),
                    format!("{:.4}", r.residual_percent),
                    duration(r.duration_s),
                ]
            })
        })
        .collect();
    if !recovered.is_empty() {
        page = page.section(
            "Recovery",
            vec![Block::Table(Table {
                caption: String::new(),
                head: [
                    "specimen",
                    "load, N",
                    "at once, %",
                    "later, %",
                    "left, %",
                    "watched for",
                ]
                .map(String::from)
                .to_vec(),
                rows: recovered,
            })],
        );
    }
    if analyses.len() <= READINGS_OF {
        for (name, fits) in fits {
            page = page.section(format!("Laws: {name}"), fit_blocks(fits));
        }
    }
    if !withheld.is_empty() {
        page = page.section("Forecast held against withheld readings", vec![
            Block::Paragraph("The end of every test was hidden from the fit; a share of 95 % inside would be right.".into()),
            Block::Table(coverage_table(withheld)),
        ]);
    }
    let mut odd: Vec<String> = failures.to_vec();
    for a in analyses {
        odd.extend(a.faults.iter().map(|f| format!("{}: {}", a.name, f.text)));
    }
    if !odd.is_empty() {
        /// A list nobody reads to its end is cut.
        const MOST: usize = 60;
        let more = odd.len().saturating_sub(MOST);
        odd.truncate(MOST);
        if more > 0 {
            odd.push(format!("and {more} more, in the table file"));
        }
        page = page.section("What is odd about the records", vec![Block::List(odd)]);
    }
    let mut blocks = vec![Block::Table(Table {
        caption: "A file with another checksum is another file.".into(),
        head: ["file", "SHA-256"].map(String::from).to_vec(),
        rows: sources
            .iter()
            .map(|s| vec![s.file.clone(), s.sha256.clone()])
            .collect(),
    })];
    let notes: Vec<String> = sources
        .iter()
        .flat_map(|s| {
            let used: Vec<String> = s
                .columns
                .iter()
                .map(|[q, c, u]| format!("{q} from '{c}' in {u}"))
                .collect();
            std::iter::once(format!("{}: {}", s.file, used.join(", ")))
                .chain(s.notes.iter().map(|n| format!("{}: {n}", s.file)))
                .collect::<Vec<_>>()
        })
        .collect();
    blocks.push(Block::List(notes));
    page.section("Raw data", blocks)
}

/// A duration in the unit a person would choose.
pub(super) fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 120.0 => format!("{} s", short(s)),
        s if s < 7200.0 => format!("{} min", short(s / 60.0)),
        s if s < 172_800.0 => format!("{} h", short(s / 3600.0)),
        s => format!("{} d", short(s / 86_400.0)),
    }
}

fn result_table(analyses: &[Analysis]) -> Table {
    Table {
        caption: "m_E: slope of a straight line from 20 min on unless stated otherwise, with the interval that correlated residuals leave. 95 % of creep: when less than a twentieth of the creep was still to come.".into(),
        head: ["specimen", "load, N", "end, %", "creep, %", "m_E, %/h", "95 % of creep", "saturated"]
            .map(String::from)
            .to_vec(),
        rows: analyses
            .iter()
            .map(|a| {
                vec![
                    a.name.clone(),
                    a.force_n.map_or("–".into(), short),
                    format!("{:.4}", a.end_percent),
                    format!("{:.4}", a.creep_percent),
                    a.slope_percent_per_h.map_or("–".into(), |s| {
                        format!("{} ({} to {})", short(s.value), short(s.low), short(s.high))
                    }),
                    a.saturation_s.map_or("–".into(), duration),
                    a.saturated.map_or("–", |s| if s { "yes" } else { "no" }).into(),
                ]
            })
            .collect(),
    }
}

fn group_table(groups: &[Scatter]) -> Table {
    Table {
        caption: "Mean and standard deviation between specimens.".into(),
        head: ["group", "specimens", "end, %", "m_E, %/h", "apart"]
            .map(String::from)
            .to_vec(),
        rows: groups
            .iter()
            .map(|g| {
                let with = |v: f64, d: Option<f64>| match d {
                    Some(d) => format!("{} ± {}", short(v), short(d)),
                    None => short(v),
                };
                vec![
                    g.group.clone(),
                    g.specimens.to_string(),
                    with(g.end_percent, g.end_deviation_percent),
                    g.slope_percent_per_h
                        .map_or("–".into(), |s| with(s, g.slope_deviation)),
                    g.apart.join(", "),
                ]
            })
            .collect(),
    }
}

fn fit_blocks(fits: &[Fit]) -> Vec<Block> {
    let least = fits.iter().map(|f| f.aicc).fold(f64::INFINITY, f64::min);
    let weights = super::forecast::akaike_weights(fits);
    let mut blocks = vec![Block::Table(Table {
        caption: "Smaller AICc is better; a difference above 10 leaves no doubt.".into(),
        head: ["law", "equation", "ΔAICc", "weight", "BIC", "residual, %"]
            .map(String::from)
            .to_vec(),
        rows: fits
            .iter()
            .zip(weights)
            .map(|(f, w)| {
                vec![
                    f.law.name().to_owned(),
                    f.law.equation().to_owned(),
                    format!("{:.1}", f.aicc - least),
                    format!("{w:.2}"),
                    format!("{:.1}", f.bic),
                    short(f.residual_percent),
                ]
            })
            .collect(),
    })];
    for fit in fits {
        blocks.push(Block::Table(Table {
            caption: format!(
                "{}: noise of the readings {} %, {:.0} % of its variance slow (memory {})",
                fit.law.name(),
                short(fit.residual_percent),
                100.0 * fit.noise.share,
                duration(fit.noise.memory_s)
            ),
            head: ["parameter", "value", "from", "to", "unit", "remark"]
                .map(String::from)
                .to_vec(),
            rows: fit
                .parameters
                .iter()
                .map(|p| {
                    let name = match &p.specimen {
                        Some(s) => format!("{} of {s}", p.name),
                        None => p.name.clone(),
                    };
                    vec![
                        name,
                        short(p.value),
                        short(p.low),
                        short(p.high),
                        p.unit.clone(),
                        p.not_identifiable.as_ref().map_or(String::new(), |why| {
                            format!("not identifiable from this record: {why}")
                        }),
                    ]
                })
                .collect(),
        }));
    }
    blocks
}

fn coverage_table(rows: &[Coverage]) -> Table {
    Table {
        caption: String::new(),
        head: [
            "law",
            "tests",
            "readings inside, %",
            "ends inside, %",
            "median error at the end, % of creep",
            "median half width",
        ]
        .map(String::from)
        .to_vec(),
        rows: rows
            .iter()
            .map(|c| {
                vec![
                    c.law.clone(),
                    c.tests.to_string(),
                    format!("{:.1}", c.readings_percent),
                    format!("{:.1}", c.end_percent),
                    format!("{:.1}", c.end_error_percent),
                    format!("{:.1}", c.end_half_width_percent),
                ]
            })
            .collect(),
    }
}
