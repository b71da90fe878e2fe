//! Simulated years as text of at most 80 columns.

use crate::text::{paragraph, plain, table};
use sinew_eval::year::Summary;
use sinew_eval::year::chain::{FailureSeen, JointErrors};
use sinew_figure::rounded;

/// What the years came to.
pub(super) fn told(summaries: &[Summary]) -> String {
    let head = [
        "forecaster",
        "robots",
        "found in 2 days",
        "false alarms per year",
        "sudden creep",
        "tracking RMS\nmrad",
    ];
    let rows = summaries
        .iter()
        .map(|s| {
            vec![
                s.forecaster.name().into(),
                s.robots.to_string(),
                format!("{} of {}", s.found_two_days, s.failures),
                rounded(s.false_alarms_per_robot_year, 2),
                s.sudden_creep.to_string(),
                rounded(s.tracking_rms_mrad, 2),
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
                s.forecaster.name().into(),
                rounded(f.made_day, 3),
                f.forecasts.to_string(),
                rounded(f.error_of_day_percent, 2),
                rounded(f.error_of_rest_percent, 2),
                rounded(f.covered_90_percent, 2),
                rounded(f.covered_95_percent, 2),
            ]);
        }
    }
    out.push_str(&table(&head, rows, 1));
    out.push('\n');
    out + &paragraph(
        "Error: median of |forecast - true day| over the true day, and over what was left until it. \
         A forecast supposes no further failure and is held against the day without one. Sudden creep: \
         alarms on days on which the rope itself grew by a millirad more than on the days around.",
        0,
    )
}

/// How wrong simulated sessions were.
pub(super) fn errors_told(errors: &[JointErrors], failures: &[FailureSeen]) -> String {
    let number = |v: f64| rounded(v, 2);
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
        row("couldn't tell, %", &|e| number(e.refused_percent)),
        row("RMS, mrad", &|e| number(e.rms_mrad)),
        row("constant, mrad", &|e| number(e.bias_mrad)),
        row("drift, mrad/K", &|e| number(e.drift_mrad_per_k)),
        row("scatter, mrad", &|e| number(e.scatter_mrad)),
        row("99 % over 68 % of it", &|e| number(e.tails)),
    ];
    let lags = errors.first().map_or(0, |e| e.correlation.len());
    for k in 0..lags {
        let lag = errors[0].correlation[k].0;
        rows.push(row(&format!("correlation, {lag} d apart"), &|e| {
            e.correlation.get(k).map_or("–".into(), |c| number(c.1))
        }));
    }
    rows.extend([
        row("stated ± (95 %), mrad", &|e| number(e.stated_95_mrad)),
        row("inside it, %", &|e| rounded(e.inside_95_percent, 3)),
        row("stiffness: scatter, %", &|e| {
            number(e.stiffness_scatter_percent)
        }),
        row("stiffness: drift, %/K", &|e| {
            number(e.stiffness_drift_percent_per_k)
        }),
        row("jumps within, %", &|e| number(e.steps_percent)),
    ]);
    let mut out = table(&head, rows, 1);
    out.push('\n');
    out.push_str(&paragraph(
        "Estimate less truth, before anything failed. Constant and drift: RMS over robots of a straight \
         line over the temperature read; scatter: what is left.",
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
        "read\nmrad",
        "lost\n%",
        "read\n%",
    ];
    let rows = failures
        .iter()
        .map(|f| {
            vec![
                plain(&f.joint),
                f.seed.to_string(),
                number(f.size_mrad),
                number(f.seen_mrad),
                number(f.lost_percent),
                number(f.seen_lost_percent),
            ]
        })
        .collect();
    out.push_str(&table(&head, rows, 1));
    out.push('\n');
    out
}
