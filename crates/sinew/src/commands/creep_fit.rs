//! `sinew creep fit`.

use super::creep_analyze::plotted;
use super::creep_files::{TestFiles, Tests, csv_line, short, write_csv};
use crate::terminal::{Bar, Failure, Finish, answer, complain};
use crate::text::{paragraph, plain, table};
use clap::{Args, ValueEnum};
use sinew_lab::creep::{
    self, Contents, Coverage, Curve, FitOptions, Isotherm, Law, NoiseKind, Share, Superposition,
};
use sinew_lab::output;
use sinew_log::TestQuantity;

/// Fit laws of creep, say which one the record supports and what it can't tell
///
/// Laws: log-time, findley, burgers, kelvin-voigt, stretched. Loads, temperatures and unloading
/// are fitted together with --joint.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    sinew creep fit rope.csv --gauge-length-mm 350 --forecast-h 8760\n  \
    sinew creep fit tests.csv --joint group --group rope\n  \
    sinew creep fit tests.csv --withhold 0.33")]
pub(crate) struct Fit {
    #[command(flatten)]
    files: TestFiles,
    /// Law to fit (may be repeated) [default: all]
    #[arg(long, value_name = "LAW")]
    law: Vec<Law>,
    /// What is fitted together
    #[arg(long, value_enum, default_value = "none")]
    joint: Joint,
    /// What is assumed of the readings' errors
    #[arg(long, value_enum, default_value = "correlated")]
    noise: Noise,
    /// Forecast to this time after the load, h
    #[arg(long, value_name = "H")]
    forecast_h: Option<f64>,
    /// Hide this last share of every test and count how often the forecast's interval holds it
    #[arg(long, value_name = "SHARE", conflicts_with_all = ["forecast_h", "shift_c"])]
    withhold: Option<f64>,
    /// Shift factors of isotherms (strain or modulus) to this temperature, °C, instead of laws
    #[arg(long, value_name = "C", allow_negative_numbers = true)]
    shift_c: Option<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq, ValueEnum)]
enum Joint {
    /// Every specimen alone
    None,
    /// Specimens of a group share the law's shape, not its amplitude
    Shape,
    /// Specimens of a group share all but their strain zero
    Group,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Noise {
    /// Independent plus slow errors, both fitted
    Correlated,
    /// Independent errors
    White,
}

/// Fits beyond which parameters go to the table file only.
const SHOWN: usize = 3;

type Fitted = (String, Vec<creep::Fit>, Vec<String>);

impl Fit {
    /// Runs the command.
    pub(crate) fn run(&self) -> Result<Finish, Failure> {
        if let Some(reference) = self.shift_c {
            return self.shift(reference);
        }
        let tests = self.files.read()?;
        let options = FitOptions {
            share: match self.joint {
                Joint::Shape => Share::Shape,
                _ => Share::All,
            },
            noise: match self.noise {
                Noise::Correlated => NoiseKind::Correlated,
                Noise::White => NoiseKind::White,
            },
            level: self.files.level,
            intervals: true,
            seed: self.files.seed,
        };
        if let Some(share) = self.withhold {
            if !(0.01..=0.9).contains(&share) {
                return Err(Failure::Refused(format!(
                    "--withhold {share}: must lie between 0.01 and 0.9"
                )));
            }
            return self.withheld(&tests, share, &options);
        }
        let laws = if self.law.is_empty() {
            Law::ALL.to_vec()
        } else {
            self.law.clone()
        };
        let sets = self.sets(&tests);
        let bar = Bar::new("fitting", self.files.quiet);
        let total = sets.len() as f64;
        let fitted: Vec<Fitted> = creep::each(
            &sets,
            |(name, curves)| {
                let mut fits = Vec::new();
                let mut failures = Vec::new();
                for law in &laws {
                    match creep::fit(*law, curves, &options) {
                        Ok(fit) => fits.push(fit),
                        Err(error) => failures.push(format!("{name}: {error}")),
                    }
                }
                fits.sort_by(|a, b| a.aicc.total_cmp(&b.aicc));
                (name.clone(), fits, failures)
            },
            |done| bar.set(done as f64, total),
        );
        drop(bar);
        let mut failures = tests.failures.clone();
        failures.extend(fitted.iter().flat_map(|f| f.2.clone()));
        let pairs: Vec<(String, Vec<creep::Fit>)> = fitted
            .into_iter()
            .filter(|f| !f.1.is_empty())
            .map(|f| (f.0, f.1))
            .collect();
        let forecasts = self.forecasts(&pairs, &sets)?;
        if let Some(path) = &self.files.csv {
            write_csv(path, &csv(&pairs))?;
        }
        if let Some(path) = &self.files.report {
            let page = creep::page(self.contents(&tests, &pairs, &[], &failures, true));
            output::write_file(path, page.html().as_bytes())?;
        }
        if self.files.json {
            answer(
                &(serde_json::to_string_pretty(&json(&tests, &pairs, &forecasts, &failures))?
                    + "\n"),
            )?;
        } else {
            answer(&told(&pairs, &forecasts, &failures))?;
        }
        Ok(Finish::lossy(!failures.is_empty()))
    }

    /// What is fitted together, by name.
    fn sets(&self, tests: &Tests) -> Vec<(String, Vec<Curve>)> {
        let mut sets: Vec<(String, Vec<Curve>)> = Vec::new();
        // Loads of a set are multiples of the first specimen's.
        let mut reference: Vec<f64> = Vec::new();
        for (prepared, group) in tests.prepared.iter().zip(&tests.groups) {
            let name = match self.joint {
                Joint::None => prepared.name.clone(),
                _ => group.clone(),
            };
            let force = prepared.stress_pa.or(prepared.force_n);
            let mut curve = prepared.curve.clone();
            match sets
                .iter()
                .position(|s| s.0 == name && self.joint != Joint::None)
            {
                Some(place) => {
                    if let Some(force) = force {
                        let factor = force / reference[place];
                        curve.steps.iter_mut().for_each(|s| s.1 *= factor);
                    }
                    sets[place].1.push(curve);
                }
                None => {
                    reference.push(force.unwrap_or(1.0));
                    sets.push((name, vec![curve]));
                }
            }
        }
        sets
    }

    fn contents<'a>(
        &self,
        tests: &'a Tests,
        fits: &'a [(String, Vec<creep::Fit>)],
        withheld: &'a [Coverage],
        failures: &'a [String],
        curves: bool,
    ) -> Contents<'a> {
        let mut all = plotted(tests);
        if self.joint == Joint::None {
            for p in &mut all {
                if let Some((_, fits)) = fits.iter().find(|f| f.0 == p.name)
                    && let Some(best) = fits.first()
                {
                    p.fitted = Some(best.strain(0, &p.curve.time_s));
                    if let Some(hours) = self.forecast_h {
                        p.forecast =
                            Some(creep::combined_forecast(fits, 0, &ahead(p.curve, hours)));
                    }
                }
            }
        }
        Contents {
            title: "Creep test".to_owned(),
            sources: &tests.sources,
            conditions: self.files.conditions(),
            analyses: &tests.analyses,
            fits,
            withheld,
            failures,
            figures: if curves {
                vec![
                    (
                        creep::figure("", &all, false),
                        "Dashed: the law of smallest AICc. Shaded: where a reading lies.".into(),
                    ),
                    (creep::figure("", &all, true), String::new()),
                ]
            } else {
                Vec::new()
            },
            ..Contents::default()
        }
    }

    fn forecasts(
        &self,
        fits: &[(String, Vec<creep::Fit>)],
        sets: &[(String, Vec<Curve>)],
    ) -> Result<Vec<(String, creep::Forecast)>, Failure> {
        let Some(hours) = self.forecast_h else {
            return Ok(Vec::new());
        };
        if !(hours > 0.0 && hours.is_finite()) {
            return Err(Failure::Refused(format!(
                "--forecast-h {hours}: must be above 0"
            )));
        }
        Ok(fits
            .iter()
            .filter_map(|(name, fits)| {
                let (_, curves) = sets.iter().find(|s| s.0 == *name)?;
                let time = ahead(curves.first()?, hours);
                Some((name.clone(), creep::combined_forecast(fits, 0, &time)))
            })
            .collect())
    }

    fn withheld(&self, tests: &Tests, share: f64, options: &FitOptions) -> Result<Finish, Failure> {
        let curves: Vec<Curve> = tests.prepared.iter().map(|p| p.curve.clone()).collect();
        let bar = Bar::new("forecasting", self.files.quiet);
        let total = curves.len() as f64;
        let rows = creep::withhold_all(&curves, share, options, |done| bar.set(done as f64, total));
        drop(bar);
        if let Some(path) = &self.files.report {
            let page = creep::page(self.contents(tests, &[], &rows, &tests.failures, false));
            output::write_file(path, page.html().as_bytes())?;
        }
        if let Some(path) = &self.files.csv {
            let mut text = csv_line(&[
                "law",
                "tests",
                "failed",
                "readings_percent",
                "end_percent",
                "end_error_percent",
                "end_half_width_percent",
            ]);
            for r in &rows {
                text.push_str(&csv_line(&[
                    r.law.clone(),
                    r.tests.to_string(),
                    r.failed.to_string(),
                    r.readings_percent.to_string(),
                    r.end_percent.to_string(),
                    r.end_error_percent.to_string(),
                    r.end_half_width_percent.to_string(),
                ]));
            }
            write_csv(path, &text)?;
        }
        if self.files.json {
            let document = serde_json::json!({ "sources": tests.sources, "withheld": rows, "failures": tests.failures });
            answer(&(serde_json::to_string_pretty(&document)? + "\n"))?;
        } else {
            let head = [
                "law",
                "tests",
                "too few",
                "readings inside",
                "ends inside",
                "error",
                "half width",
            ];
            let lines = rows
                .iter()
                .map(|r| {
                    vec![
                        r.law.clone(),
                        r.tests.to_string(),
                        r.failed.to_string(),
                        format!("{:.1} %", r.readings_percent),
                        format!("{:.1} %", r.end_percent),
                        format!("{:.1} %", r.end_error_percent),
                        format!("{:.1} %", r.end_half_width_percent),
                    ]
                })
                .collect();
            answer(&format!(
                "{}\n{}",
                paragraph(
                    &format!(
                        "Last {:.0} % of the time hidden; {:.0} % intervals for readings. Error and half width: median at the end, in % of the test's creep.",
                        100.0 * share,
                        100.0 * options.level
                    ),
                    0
                ),
                table(&head, lines, 1)
            ))?;
        }
        Ok(Finish::lossy(!tests.failures.is_empty()))
    }

    fn shift(&self, reference: f64) -> Result<Finish, Failure> {
        let (sources, specimens) = self.files.specimens()?;
        let mut isotherms = Vec::new();
        let mut failures = Vec::new();
        for s in &specimens {
            let warm = s.column(TestQuantity::Temperature).map(|t| {
                let finite: Vec<f64> = t.iter().copied().filter(|t| t.is_finite()).collect();
                finite.iter().sum::<f64>() / finite.len() as f64
            });
            let value = s
                .column(TestQuantity::Modulus)
                .or_else(|| s.column(TestQuantity::Strain));
            match (warm, s.column(TestQuantity::Time), value) {
                (Some(temperature_c), Some(time), Some(value)) => {
                    let (time_s, value) = time
                        .iter()
                        .zip(value)
                        .filter(|(t, v)| **t > 0.0 && **v > 0.0)
                        .unzip();
                    isotherms.push(Isotherm {
                        temperature_c,
                        time_s,
                        value,
                    });
                }
                _ => failures.push(format!(
                    "{}: no temperature, or neither modulus nor strain",
                    s.name
                )),
            }
        }
        let found = creep::superpose(&isotherms, reference)?;
        if !self.files.quiet {
            for failure in &failures {
                complain("warning", &plain(failure));
            }
        }
        if let Some(path) = &self.files.csv {
            let mut text = csv_line(&["temperature_c", "log10_a_t", "std_error", "overlap"]);
            for s in &found.shifts {
                text.push_str(&csv_line(&[
                    s.temperature_c.to_string(),
                    s.log10_a_t.to_string(),
                    s.std_error.to_string(),
                    s.overlap.to_string(),
                ]));
            }
            write_csv(path, &text)?;
        }
        if self.files.json {
            let document = serde_json::json!({ "sources": sources, "superposition": found, "failures": failures });
            answer(&(serde_json::to_string_pretty(&document)? + "\n"))?;
        } else {
            answer(&shifts_told(&found))?;
        }
        Ok(Finish::lossy(!failures.is_empty()))
    }
}

fn shifts_told(found: &Superposition) -> String {
    let rows = found
        .shifts
        .iter()
        .map(|s| {
            vec![
                format!("{:.1}", s.temperature_c),
                format!("{:.3}", s.log10_a_t),
                format!("{:.3}", s.std_error),
                format!("{:.0} %", 100.0 * s.overlap),
            ]
        })
        .collect();
    let mut out = table(&["°C", "log10 a_T", "std. error", "overlap"], rows, 0);
    if let Some((energy, rms)) = found.arrhenius {
        out.push_str(&format!(
            "\nArrhenius: {} kJ/mol, misfit {rms:.2} decades\n",
            short(energy)
        ));
    }
    if let Some((c1, c2, rms)) = found.wlf {
        out.push_str(&format!(
            "WLF from {:.1} °C up: C1 {}, C2 {} K, misfit {rms:.2} decades\n",
            found.reference_c,
            short(c1),
            short(c2)
        ));
    }
    out
}

/// Times after a curve's end, even in the logarithm.
fn ahead(curve: &Curve, hours: f64) -> Vec<f64> {
    const COUNT: i32 = 40;
    let end = curve.time_s.last().copied().unwrap_or(1.0).max(1e-3);
    let last = (3600.0 * hours).max(1.01 * end);
    (1..=COUNT)
        .map(|i| end * (last / end).powf(f64::from(i) / f64::from(COUNT)))
        .collect()
}

fn told(
    fits: &[(String, Vec<creep::Fit>)],
    forecasts: &[(String, creep::Forecast)],
    failures: &[String],
) -> String {
    let mut out = String::new();
    if fits.len() > SHOWN {
        let mut rows = Vec::new();
        for law in Law::ALL {
            let own: Vec<&creep::Fit> = fits
                .iter()
                .filter_map(|f| f.1.iter().find(|fit| fit.law == law))
                .collect();
            if own.is_empty() {
                continue;
            }
            let best = fits.iter().filter(|f| f.1[0].law == law).count();
            let mut residuals: Vec<f64> = own.iter().map(|f| f.residual_percent).collect();
            residuals.sort_by(f64::total_cmp);
            let untold = own
                .iter()
                .filter(|f| f.parameters.iter().any(|p| p.not_identifiable.is_some()))
                .count();
            rows.push(vec![
                law.name().to_owned(),
                own.len().to_string(),
                best.to_string(),
                short(residuals[residuals.len() / 2]),
                untold.to_string(),
            ]);
        }
        let head = [
            "law",
            "fitted",
            "smallest AICc",
            "median residual, %",
            "with untold parameters",
        ];
        out.push_str(&table(&head, rows, 1));
    } else {
        for (name, fits) in fits {
            let weights = creep::akaike_weights(fits);
            let least = fits[0].aicc;
            let rows = fits
                .iter()
                .zip(weights)
                .map(|(f, w)| {
                    vec![
                        f.law.name().to_owned(),
                        f.law.equation().to_owned(),
                        format!("{:.1}", f.aicc - least),
                        format!("{w:.2}"),
                        short(f.residual_percent),
                    ]
                })
                .collect();
            out.push_str(&format!("{}\n", paragraph(&plain(name), 0)));
            out.push_str(&table(
                &["law", "strain", "ΔAICc", "weight", "residual, %"],
                rows,
                2,
            ));
            let best = &fits[0];
            out.push_str(&format!("\n{}:\n", best.law.name()));
            let rows = best
                .parameters
                .iter()
                .map(|p| {
                    let name = match &p.specimen {
                        Some(s) => plain(&format!("{} of {s}", p.name)),
                        None => p.name.clone(),
                    };
                    vec![
                        name,
                        short(p.value),
                        format!("{} … {}", short(p.low), short(p.high)),
                        p.unit.clone(),
                    ]
                })
                .collect();
            out.push_str(&table(&["parameter", "value", "interval", "unit"], rows, 1));
            for p in &best.parameters {
                if let Some(why) = &p.not_identifiable {
                    out.push_str(&paragraph(
                        &format!("- {} is not identifiable from this record: {why}", p.name),
                        2,
                    ));
                }
            }
            out.push('\n');
        }
    }
    for (name, f) in forecasts.iter().take(SHOWN) {
        if let Some(last) = f.time_s.len().checked_sub(1) {
            out.push_str(&paragraph(
                &plain(&format!(
                    "{name}: after {} h {} % ({} to {} %) under the record's last load, all laws weighed",
                    short(f.time_s[last] / 3600.0),
                    short(100.0 * f.strain[last]),
                    short(100.0 * f.reading_low[last]),
                    short(100.0 * f.reading_high[last])
                )),
                2,
            ));
        }
    }
    for failure in failures.iter().take(20) {
        out.push_str(&paragraph(&plain(&format!("- not fitted: {failure}")), 2));
    }
    if failures.len() > 20 {
        out.push_str(&format!("- and {} more (--json)\n", failures.len() - 20));
    }
    out
}

fn json(
    tests: &Tests,
    fits: &[(String, Vec<creep::Fit>)],
    forecasts: &[(String, creep::Forecast)],
    failures: &[String],
) -> serde_json::Value {
    let sets: Vec<serde_json::Value> = fits
        .iter()
        .map(|(name, fits)| {
            let weights = creep::akaike_weights(fits);
            let laws: Vec<serde_json::Value> = fits
                .iter()
                .zip(weights)
                .map(|(f, weight)| {
                    serde_json::json!({
                        "law": f.law.name(),
                        "equation": f.law.equation(),
                        "readings": f.readings,
                        "aicc": f.aicc,
                        "bic": f.bic,
                        "weight": weight,
                        "log_likelihood": f.log_likelihood,
                        "residual_percent": f.residual_percent,
                        "noise_slow_share": f.noise.share,
                        "noise_memory_s": f.noise.memory_s,
                        "converged": f.converged,
                        "parameters": f.parameters,
                        "covariance": f.covariance,
                    })
                })
                .collect();
            serde_json::json!({ "name": name, "laws": laws })
        })
        .collect();
    serde_json::json!({
        "sources": tests.sources,
        "fits": sets,
        "forecasts": forecasts,
        "failures": failures,
    })
}

fn csv(fits: &[(String, Vec<creep::Fit>)]) -> String {
    let mut out = csv_line(&[
        "name",
        "law",
        "aicc",
        "bic",
        "parameter",
        "specimen",
        "unit",
        "value",
        "low",
        "high",
        "not_identifiable",
    ]);
    for (name, fits) in fits {
        for f in fits {
            for p in &f.parameters {
                out.push_str(&csv_line(&[
                    name.clone(),
                    f.law.name().to_owned(),
                    f.aicc.to_string(),
                    f.bic.to_string(),
                    p.name.clone(),
                    p.specimen.clone().unwrap_or_default(),
                    p.unit.clone(),
                    p.value.to_string(),
                    p.low.to_string(),
                    p.high.to_string(),
                    p.not_identifiable.clone().unwrap_or_default(),
                ]));
            }
        }
    }
    out
}
