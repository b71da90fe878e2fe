//! `sinew creep analyze`.

use super::creep_files::{TestFiles, Tests, csv_line, short, write_csv};
use crate::terminal::{Failure, Finish, answer};
use crate::text::{paragraph, plain, table};
use clap::Args;
use sinew_creep::{Contents, Plotted};

/// Readings, moduli, slope m_E, saturation, recovery and faults of creep tests
///
/// Columns are told by their headers, such as time_s, Force (N), Strain [%]. Exit code 3 when a
/// specimen could not be analysed.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    sinew creep analyze rope.csv --gauge-length-mm 350 --report rope.html\n  \
    sinew creep analyze tests.xlsx --column force=Kraft:N --group rope")]
pub(crate) struct Analyze {
    #[command(flatten)]
    files: TestFiles,
}

/// Specimens beyond which the terminal shows groups only.
const SHOWN: usize = 24;
/// Specimens beyond which the terminal leaves readings to the table file.
const READINGS_OF: usize = 3;

impl Analyze {
    /// Runs the command.
    pub(crate) fn run(&self) -> Result<Finish, Failure> {
        let tests = self.files.read()?;
        let named: Vec<(String, &sinew_creep::Analysis)> =
            tests.groups.iter().cloned().zip(&tests.analyses).collect();
        let scatter = sinew_creep::scatter(&named);
        let isochrones = sinew_creep::isochrones(&named, self.files.level);
        if let Some(path) = &self.files.csv {
            write_csv(path, &csv(&tests))?;
        }
        if let Some(path) = &self.files.report {
            let plotted = plotted(&tests);
            let mut figures = vec![
                (sinew_creep::figure("", &plotted, false), String::new()),
                (sinew_creep::figure("", &plotted, true), String::new()),
            ];
            if let Some(figure) = sinew_creep::isochronous_figure(&isochrones) {
                let caption = "Isochronous curves: load over strain after the same time under load; one point per specimen.";
                figures.push((figure, caption.into()));
            }
            let page = sinew_creep::page(Contents {
                title: "Creep test".to_owned(),
                sources: &tests.sources,
                conditions: self.files.conditions(),
                analyses: &tests.analyses,
                groups: &scatter,
                isochrones: &isochrones,
                failures: &tests.failures,
                figures,
                ..Contents::default()
            });
            sinew_files::write_file(path, page.html().as_bytes())?;
        }
        if self.files.json {
            let document = serde_json::json!({
                "sources": tests.sources,
                "conditions": self.files.conditions(),
                "specimens": tests.analyses,
                "groups": scatter,
                "isochrones": isochrones,
                "failures": tests.failures,
            });
            answer(&(serde_json::to_string_pretty(&document)? + "\n"))?;
        } else {
            answer(&(told(&tests, &scatter) + &isochrones_told(&isochrones)))?;
        }
        Ok(Finish::lossy(!tests.failures.is_empty()))
    }
}

/// Curves with their analyses.
pub(crate) fn plotted(tests: &Tests) -> Vec<Plotted<'_>> {
    tests
        .prepared
        .iter()
        .zip(&tests.analyses)
        .map(|(prepared, analysis)| Plotted {
            name: prepared.name.clone(),
            curve: &prepared.curve,
            analysis,
            fitted: None,
            forecast: None,
        })
        .collect()
}

fn told(tests: &Tests, scatter: &[sinew_creep::Scatter]) -> String {
    let mut out = String::new();
    if tests.analyses.len() <= SHOWN {
        let rows = tests
            .analyses
            .iter()
            .map(|a| {
                let slope = a.slope_percent_per_h.map_or(["–".into(), "–".into()], |s| {
                    [
                        short(s.value),
                        format!("{} … {}", short(s.low), short(s.high)),
                    ]
                });
                let [slope, range] = slope;
                vec![
                    plain(&a.name),
                    a.force_n.map_or("–".into(), short),
                    short(a.end_percent),
                    short(a.creep_percent),
                    slope,
                    range,
                    a.saturated
                        .map_or("–", |s| if s { "yes" } else { "no" })
                        .into(),
                ]
            })
            .collect();
        let head = [
            "specimen",
            "load, N",
            "end, %",
            "creep, %",
            "m_E, %/h",
            "interval",
            "saturated",
        ];
        out.push_str(&table(&head, rows, 1));
    }
    if scatter.len() > 1 || tests.analyses.len() > SHOWN {
        let rows = scatter
            .iter()
            .map(|g| {
                vec![
                    plain(&g.group),
                    g.specimens.to_string(),
                    short(g.end_percent),
                    g.end_deviation_percent.map_or("–".into(), short),
                    g.slope_percent_per_h.map_or("–".into(), short),
                    g.slope_deviation.map_or("–".into(), short),
                    g.apart.len().to_string(),
                ]
            })
            .collect();
        let head = [
            "group",
            "specimens",
            "end, %",
            "scatter, %",
            "m_E, %/h",
            "scatter",
            "apart",
        ];
        out.push('\n');
        out.push_str(&table(&head, rows, 1));
    }
    if tests.analyses.len() <= READINGS_OF {
        for a in &tests.analyses {
            out.push_str(&format!(
                "\n{}",
                paragraph(&plain(&format!("{}, strain from: {}", a.name, a.zero)), 0)
            ));
            let rows = a
                .readings
                .iter()
                .map(|r| {
                    vec![
                        sinew_creep::reading_time(r.time_s),
                        format!("{:.4}", r.strain_percent),
                        r.modulus_mpa.map_or("–".into(), short),
                    ]
                })
                .collect();
            out.push_str(&table(
                &["time", "strain, %", "creep modulus, MPa"],
                rows,
                1,
            ));
            for r in &a.recovery {
                out.push_str(&paragraph(
                    &format!(
                        "from {} N to {} N: {:.4} % at once, {:.4} % within {} min, {:.4} % left",
                        short(r.force_before_n),
                        short(r.force_after_n),
                        r.at_once_percent,
                        r.delayed_percent,
                        short(r.duration_s / 60.0),
                        r.residual_percent
                    ),
                    2,
                ));
            }
        }
    }
    let faults: usize = tests.analyses.iter().map(|a| a.faults.len()).sum();
    if faults > 0 {
        out.push('\n');
        // A fault that every record has is said once.
        let mut said: Vec<(String, usize)> = Vec::new();
        for a in &tests.analyses {
            for f in &a.faults {
                let text = match f.time_s {
                    None => f.text.clone(),
                    Some(_) => format!("{}: {}", a.name, f.text),
                };
                match said.iter_mut().find(|(t, _)| *t == text) {
                    Some((_, count)) => *count += 1,
                    None => said.push((text, 1)),
                }
            }
        }
        for (text, count) in said.iter().take(20) {
            let times = if *count > 1 {
                format!(" ({count} specimens)")
            } else {
                String::new()
            };
            out.push_str(&paragraph(&plain(&format!("- {text}{times}")), 2));
        }
        if said.len() > 20 {
            out.push_str(&format!("- and {} more (--csv, --json)\n", said.len() - 20));
        }
    }
    out
}

/// One line per group and time, the times of a decade each.
fn isochrones_told(isochrones: &[sinew_creep::Isochrone]) -> String {
    /// Readings of every group that the terminal shows.
    const TIMES: [f64; 5] = [60.0, 720.0, 3600.0, 36_000.0, 360_000.0];
    let rows: Vec<Vec<String>> = isochrones
        .iter()
        .filter(|i| TIMES.contains(&i.time_s))
        .map(|i| {
            let unit = if i.stress { "MPa" } else { "N" };
            vec![
                plain(&i.group),
                sinew_creep::reading_time(i.time_s),
                i.points.len().to_string(),
                format!("{} {unit}", short(i.secant)),
                short(i.exponent.value),
                format!("{} … {}", short(i.exponent.low), short(i.exponent.high)),
            ]
        })
        .collect();
    if rows.is_empty() {
        return String::new();
    }
    let head = ["group", "after", "n", "load per %", "p", "interval"];
    format!(
        "\nisochronous: strain against load at the same time, strain ∝ load^p\n\n{}",
        table(&head, rows, 1)
    )
}

fn csv(tests: &Tests) -> String {
    let mut out = csv_line(&[
        "specimen",
        "group",
        "force_n",
        "stress_mpa",
        "temperature_c",
        "humidity_percent",
        "duration_s",
        "end_percent",
        "creep_percent",
        "slope_percent_per_h",
        "slope_low",
        "slope_high",
        "saturation_s",
        "saturated",
        "faults",
    ]);
    let number = |v: Option<f64>| v.map_or(String::new(), |v| format!("{v}"));
    for (a, group) in tests.analyses.iter().zip(&tests.groups) {
        let slope = a.slope_percent_per_h;
        out.push_str(&csv_line(&[
            a.name.clone(),
            group.clone(),
            number(a.force_n),
            number(a.stress_mpa),
            number(a.temperature_c),
            number(a.humidity_percent),
            format!("{}", a.duration_s),
            format!("{}", a.end_percent),
            format!("{}", a.creep_percent),
            number(slope.map(|s| s.value)),
            number(slope.map(|s| s.low)),
            number(slope.map(|s| s.high)),
            number(a.saturation_s),
            a.saturated.map_or(String::new(), |s| s.to_string()),
            a.faults
                .iter()
                .map(|f| f.text.as_str())
                .collect::<Vec<_>>()
                .join("; "),
        ]));
    }
    out
}
