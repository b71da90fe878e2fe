//! Simulated years as text of at most 80 columns.

use super::chain::{FailureSeen, JointErrors};
use super::result::{Forecaster, SessionSource, YearReport, YearSummary};
use sinew_figure::rounded;
use sinew_model::{Gaussian, Z95};
use sinew_report::text::{paragraph, plain, table};

/// The years as tables.
pub fn render_table(report: &YearReport) -> String {
    match &report.sessions {
        SessionSource::Drawn { .. } => render_summary(&report.summary),
        SessionSource::Simulated {
            errors, failures, ..
        } => {
            let mut text = render_errors(errors, failures);
            if !report.years.is_empty() {
                text.push('\n');
                text.push_str(&render_summary(&report.summary));
            }
            text
        }
    }
}

fn forecaster_name(forecaster: Forecaster) -> String {
    let name = match forecaster {
        Forecaster::Rope => "with rope",
        Forecaster::Alone => "indep. errors",
        Forecaster::Generic => "no rope",
        Forecaster::Oracle => "true law",
    };
    name.into()
}

/// Formats the summary of the years.
fn render_summary(summaries: &[YearSummary]) -> String {
    let head = [
        "forecaster",
        "robots",
        "found in 2 days",
        "false alarms per year",
        "sudden creep",
        "tracking RMS\nmrad",
        "± (95 %)\nmrad",
        "coverage\n%",
        "failed: coverage\n%",
    ];
    let rows = summaries
        .iter()
        .map(|s| {
            vec![
                forecaster_name(s.forecaster),
                s.robots.to_string(),
                format!("{} of {}", s.found_two_days, s.failures),
                rounded(s.false_alarms_per_robot_year, 2),
                s.sudden_creep.to_string(),
                rounded(1e3 * s.tracking_rms_rad, 2),
                number(s.half_width_95_rad, 1e3),
                share(s.covered_95),
                share(s.failed_covered_95),
            ]
        })
        .collect();
    let mut out = table(&head, rows, 1);
    out.push('\n');
    let head = [
        "forecast by",
        "on day",
        "forecasts",
        "median error\n% of day",
        "% of rest",
        "inside 90 %\n%",
        "inside 95 %\n%",
    ];
    let mut rows = Vec::new();
    for s in summaries {
        for f in &s.forecasts {
            rows.push(vec![
                forecaster_name(s.forecaster),
                rounded(f.made_day, 3),
                f.forecasts.to_string(),
                number(f.error_of_day_ratio, 100.0),
                number(f.error_of_rest_ratio, 100.0),
                share(Some(f.covered_90)),
                share(Some(f.covered_95)),
            ]);
        }
    }
    out.push_str(&table(&head, rows, 1));
    out.push('\n');
    out + &paragraph(
        "Coverage: every fifteenth day, share of days on which the true offset was within the trend's 95 % interval, \
         before and after the tendon's own failure. Brackets: standard errors; a tendon counts once. Indep. errors: the same trend with every error taken as independent. \
         Error: median of |forecast - true day| over the true day, and over the time remaining until it. \
         A forecast assumes no further failure and is compared with the day without one. Sudden creep: \
         alarms on days on which the rope itself elongated by 1 mrad more than on the adjacent days.",
        0,
    )
}

/// Formats a share in per cent with its standard error.
fn share(share: Option<Gaussian>) -> String {
    share.map_or("–".into(), |share| {
        let error = (100.0 * share.std).max(1.0);
        format!("{:.0} ({error:.0})", 100.0 * share.mean)
    })
}

/// Formats a value multiplied by `factor` with two digits, or a dash if it is missing.
fn number(value: Option<f64>, factor: f64) -> String {
    rounded(value.map_or(f64::NAN, |v| factor * v), 2)
}

/// Formats the errors of simulated sessions.
fn render_errors(errors: &[JointErrors], failures: &[FailureSeen]) -> String {
    let head = ["sessions' errors"]
        .into_iter()
        .map(String::from)
        .chain(errors.iter().map(|e| plain(&e.joint)))
        .collect::<Vec<_>>();
    let head: Vec<&str> = head.iter().map(String::as_str).collect();
    let row = |name: &str, value: &dyn Fn(&JointErrors) -> String| {
        let mut row = vec![name.to_string()];
        row.extend(errors.iter().map(value));
        row
    };
    let mut rows = vec![
        row("robots, sessions", &|e| {
            format!("{}, {}", e.robots, e.sessions)
        }),
        row("inconclusive, %", &|e| number(e.inconclusive_share, 100.0)),
        row("RMS, mrad", &|e| number(e.rms_rad, 1e3)),
        row("constant, mrad", &|e| number(e.bias_rad, 1e3)),
        row("drift, mrad/K", &|e| number(e.drift_rad_per_k, 1e3)),
        row("scatter, mrad", &|e| number(e.scatter_rad, 1e3)),
        row("99 % / 68 % quantile", &|e| number(e.tails_ratio, 1.0)),
    ];
    let lags = errors.first().map_or(0, |e| e.correlation.len());
    for k in 0..lags {
        let lag = errors[0].correlation[k].lag_days;
        rows.push(row(&format!("correlation, lag {lag} d"), &|e| {
            number(e.correlation.get(k).map(|c| c.correlation), 1.0)
        }));
    }
    rows.extend([
        row("reported ± (95 %), mrad", &|e| {
            number(e.reported_std_rad, 1e3 * Z95)
        }),
        row("coverage, %", &|e| {
            rounded(e.inside_95_share.map_or(f64::NAN, |v| 100.0 * v), 3)
        }),
        row("stiffness: scatter, %", &|e| {
            number(e.stiffness_scatter_ratio, 100.0)
        }),
        row("stiffness: drift, %/K", &|e| {
            number(e.stiffness_drift_ratio_per_k, 100.0)
        }),
        row("false steps, %", &|e| number(e.steps_share, 100.0)),
    ]);
    let mut out = table(&head, rows, 1);
    out.push('\n');
    out.push_str(&paragraph(
        "Estimate minus truth, before any failure. Constant and drift: RMS over robots of a straight \
         line over the measured temperature; scatter: residual.",
        0,
    ));
    if failures.is_empty() {
        return out;
    }
    out.push('\n');
    let head = [
        "failed strand",
        "seed",
        "true\nmrad",
        "estimate\nmrad",
        "lost\n%",
        "estimate\n%",
    ];
    let rows = failures
        .iter()
        .map(|f| {
            vec![
                plain(&f.joint),
                f.seed.to_string(),
                rounded(1e3 * f.size_rad, 2),
                rounded(1e3 * f.estimated_rise_rad, 2),
                rounded(100.0 * f.lost_ratio, 2),
                rounded(100.0 * f.estimated_loss_ratio, 2),
            ]
        })
        .collect();
    out.push_str(&table(&head, rows, 1));
    out.push('\n');
    out
}
