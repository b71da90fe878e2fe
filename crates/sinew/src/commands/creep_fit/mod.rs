//! `sinew creep fit`.

mod groups;
mod rope;
mod shift;
mod tell;
mod withheld;

use super::creep_analyze::plotted;
use super::creep_files::{TestFiles, Tests, write_csv};
use super::rope::Ropes;
use crate::terminal::{Bar, Failure, Finish, answer};
use clap::{Args, ValueEnum};
use sinew_creep::{Contents, Coverage, Curve, FitOptions, IntervalKind, Law, NoiseKind, Share};
use std::path::PathBuf;

/// Fit laws of creep, say which one the record supports and what it can't tell
///
/// Laws: log-time, findley, burgers, kelvin-voigt, stretched; rope with --rope. Loads,
/// temperatures and unloading are fitted together with --joint.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    sinew creep fit rope.csv --gauge-length-mm 350 --forecast-h 8760\n  \
    sinew creep fit tests.csv --joint group --group rope\n  \
    sinew creep fit rope.csv --rope liros-dc000-0301 --law rope --write-rope ropes/mine.toml\n  \
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
    /// How intervals of parameters are made
    #[arg(long, value_enum, default_value = "draws")]
    intervals: Intervals,
    /// Catalogue rope that the rope law starts from: its breaking load, and what records can't tell
    #[arg(long, value_name = "NAME", help_heading = "Rope law")]
    rope: Option<String>,
    #[command(flatten)]
    ropes: Ropes,
    /// Write the fitted rope as a catalogue entry; its name is that of the file
    #[arg(
        long,
        value_name = "FILE.toml",
        requires = "rope",
        conflicts_with_all = ["withhold", "shift_c"],
        help_heading = "Rope law"
    )]
    write_rope: Option<PathBuf>,
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

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Intervals {
    /// Quantiles of draws from what the readings leave open
    Draws,
    /// Profile likelihood
    Profile,
    /// Parametric bootstrap with correlated errors
    Bootstrap,
}

type Fitted = (String, Vec<sinew_creep::Fit>, Vec<String>);

impl Fit {
    /// Runs the command.
    pub(crate) fn run(&self) -> Result<Finish, Failure> {
        if let Some(reference) = self.shift_c {
            return self.shift(reference);
        }
        let tests = self.files.read()?;
        let options = self.options()?;
        if let Some(share) = self.withhold {
            if !(0.01..=0.9).contains(&share) {
                return Err(Failure::Refused(format!(
                    "--withhold {share}: must lie between 0.01 and 0.9"
                )));
            }
            return self.withheld(&tests, share, &options);
        }
        let sets = self.sets(&tests);
        let fitted = self.fit_all(&sets, &options);
        let mut failures = tests.failures.clone();
        failures.extend(fitted.iter().flat_map(|f| f.2.clone()));
        let pairs: Vec<(String, Vec<sinew_creep::Fit>)> = fitted
            .into_iter()
            .filter(|f| !f.1.is_empty())
            .map(|f| (f.0, f.1))
            .collect();
        let forecasts = self.forecasts(&pairs, &sets, &options)?;
        let entry = self.entry(&pairs, &options, &tests)?;
        if let Some(path) = &self.files.csv {
            write_csv(path, &tell::csv(&pairs))?;
        }
        if let Some(path) = &self.files.report {
            let page = sinew_creep::page(self.contents(&tests, &pairs, &forecasts, &[], &failures));
            sinew_files::write_file(path, page.html().as_bytes())?;
        }
        if let (Some(path), Some(text)) = (&self.write_rope, &entry) {
            sinew_files::write_file(path, text.as_bytes())?;
        }
        if self.files.json {
            let document = tell::json(&tests, &pairs, &forecasts, &failures);
            answer(&(serde_json::to_string_pretty(&document)? + "\n"))?;
        } else {
            let groups = self.group_table(&tests, &pairs);
            answer(&(tell::told(&pairs, &forecasts, &failures) + &groups))?;
        }
        Ok(Finish::lossy(!failures.is_empty()))
    }

    fn options(&self) -> Result<FitOptions, Failure> {
        Ok(FitOptions {
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
            kind: match self.intervals {
                Intervals::Draws => IntervalKind::Draws,
                Intervals::Profile => IntervalKind::Profile,
                Intervals::Bootstrap => IntervalKind::Bootstrap,
            },
            seed: self.files.seed,
            rope: self.base()?,
        })
    }

    /// The laws asked for; all that can be where none is named.
    fn laws(&self) -> Vec<Law> {
        if !self.law.is_empty() {
            return self.law.clone();
        }
        let rope = self.rope.as_ref().map(|_| Law::Rope);
        Law::ALL.into_iter().chain(rope).collect()
    }

    fn fit_all(&self, sets: &[(String, Vec<Curve>)], options: &FitOptions) -> Vec<Fitted> {
        let laws = self.laws();
        let bar = Bar::new("fitting", self.files.quiet);
        let total = sets.len() as f64;
        sinew_creep::each(
            sets,
            |(name, curves)| {
                let mut fits = Vec::new();
                let mut failures = Vec::new();
                for law in &laws {
                    match sinew_creep::fit(*law, curves, options) {
                        Ok(fit) => fits.push(fit),
                        Err(error) => failures.push(format!("{name}: {error}")),
                    }
                }
                fits.sort_by(|a, b| a.aicc.total_cmp(&b.aicc));
                (name.clone(), fits, failures)
            },
            |done| bar.set(done as f64, total),
        )
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
            let curve = prepared.curve.clone();
            match sets
                .iter()
                .position(|s| s.0 == name && self.joint != Joint::None)
            {
                Some(place) => {
                    let factor = force.map_or(1.0, |force| force / reference[place]);
                    sets[place].1.push(curve.scaled(factor));
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
        fits: &'a [(String, Vec<sinew_creep::Fit>)],
        forecasts: &[(String, sinew_creep::Forecast)],
        withheld: &'a [Coverage],
        failures: &'a [String],
    ) -> Contents<'a> {
        let mut all = plotted(tests);
        if self.joint == Joint::None {
            for p in &mut all {
                let best = fits
                    .iter()
                    .find(|f| f.0 == p.name)
                    .and_then(|f| f.1.first());
                p.fitted = best.map(|best| best.strain(0, &p.curve.time_s));
                let ahead = forecasts.iter().find(|f| f.0 == p.name);
                p.forecast = ahead.map(|f| f.1.clone());
            }
        }
        let drawn = withheld.is_empty();
        Contents {
            title: "Creep test".to_owned(),
            sources: &tests.sources,
            conditions: self.files.conditions(),
            analyses: &tests.analyses,
            fits,
            withheld,
            failures,
            figures: if drawn {
                vec![
                    (
                        sinew_creep::figure("", &all, false),
                        "Dashed: the law of smallest AICc. Shaded: where a reading lies.".into(),
                    ),
                    (sinew_creep::figure("", &all, true), String::new()),
                ]
            } else {
                Vec::new()
            },
            ..Contents::default()
        }
    }

    fn forecasts(
        &self,
        fits: &[(String, Vec<sinew_creep::Fit>)],
        sets: &[(String, Vec<Curve>)],
        options: &FitOptions,
    ) -> Result<Vec<(String, sinew_creep::Forecast)>, Failure> {
        let Some(hours) = self.forecast_h else {
            return Ok(Vec::new());
        };
        if !(hours > 0.0 && hours.is_finite()) {
            return Err(Failure::Refused(format!(
                "--forecast-h {hours}: must be above 0"
            )));
        }
        let bar = Bar::new("forecasting", self.files.quiet);
        let total = fits.len() as f64;
        let found = sinew_creep::each(
            fits,
            |(name, fits)| {
                let (_, curves) = sets.iter().find(|s| s.0 == *name)?;
                let time = ahead(curves.first()?, hours);
                let outlook = sinew_creep::Outlook::of(fits, curves, 0, options, &time);
                Some((name.clone(), outlook.combined?))
            },
            |done| bar.set(done as f64, total),
        );
        Ok(found.into_iter().flatten().collect())
    }
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
