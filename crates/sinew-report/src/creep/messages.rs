//! Sentences and number formats of creep tests.

use crate::format::counted;
use crate::message::Message;
use crate::text;
use sinew_creep::{
    Artefact, ConditionSource, Ending, Fit, ForecastConditions, IntervalKind, NotIdentifiable,
    NotIdentifiableReason, PERCENT_PER_H, Parameter, ScatterSource, StrainZero, Termination,
};
use sinew_model::Bounded;

/// Formats a measurement time of the standard, `3 min` or `50 h`.
pub(crate) fn measurement_time(time_s: f64) -> String {
    if time_s < 3600.0 {
        format!("{:.0} min", time_s / 60.0)
    } else {
        format!("{:.0} h", time_s / 3600.0)
    }
}

/// Formats a value with its interval, `0.42 (0.31 to 0.58)`.
pub(crate) fn bracketed(b: Bounded) -> String {
    format!("{} ({} to {})", short(b.value), short(b.low), short(b.high))
}

/// Formats a slope in %/h and its interval for two cells of a table.
pub(crate) fn slope(slope_per_s: Option<Bounded>) -> [String; 2] {
    let Some(s) = slope_per_s.map(|s| s.scaled(PERCENT_PER_H)) else {
        return ["–".into(), "–".into()];
    };
    let [value, low, high] = [s.value, s.low, s.high].map(text::short);
    [value, format!("{low} … {high}")]
}

/// Formats a duration in a suitable unit.
pub(crate) fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 120.0 => format!("{} s", short(s)),
        s if s < 7200.0 => format!("{} min", short(s / 60.0)),
        s if s < 172_800.0 => format!("{} h", short(s / 3600.0)),
        s => format!("{} d", short(s / 86_400.0)),
    }
}

/// Formats a number with three significant digits, in scientific notation if it is very small or large.
pub(crate) fn short(value: f64) -> String {
    if !value.is_finite() {
        return "–".to_owned();
    }
    let size = value.abs();
    let text = if size == 0.0 {
        "0".to_owned()
    } else if (1e-3..1e4).contains(&size) {
        let decimals = (2 - size.log10().floor() as i32).max(0) as usize;
        format!("{value:.decimals$}")
    } else {
        format!("{value:.2e}")
    };
    text.replace('-', "−")
}

/// Name of a group, or `all` for specimens without a group.
pub(crate) fn group(name: &Option<String>) -> &str {
    name.as_deref().unwrap_or("all")
}

/// Describes the zero of the strain.
pub(crate) fn zero(zero: StrainZero) -> String {
    match zero {
        StrainZero::BeforeLoad { readings } => {
            format!("mean of {readings} measurements before loading")
        }
        StrainZero::AsRecorded => "as recorded; no measurement before loading".to_owned(),
    }
}

/// Formats an artefact of a record with its code, and its treatment.
pub(crate) fn artefact(artefact: &Artefact) -> String {
    Message::of(artefact, artefact_text(artefact)).to_string()
}

fn artefact_text(artefact: &Artefact) -> String {
    let treatment = |kept: bool, removed: &'static str| if kept { "kept" } else { removed };
    match *artefact {
        Artefact::Slip {
            time_s,
            strain_ratio,
            kept,
        } => format!(
            "strain step of {:+.4} % at {time_s:.1} s interpreted as grip slip; {}",
            100.0 * strain_ratio,
            treatment(kept, "removed from all later measurements (--keep-artefacts keeps it)")
        ),
        Artefact::Outlier { time_s, kept } => format!(
            "outlier at {time_s:.1} s; {}",
            treatment(kept, "rejected")
        ),
        Artefact::LoadDrift {
            load_n,
            drift_share,
            ..
        } => format!(
            "load of {load_n:.3} N varies by up to {:.1} % (ISO 899-1 allows 1 %); fit uses the recorded load",
            100.0 * drift_share
        ),
        Artefact::NoForce => {
            "force not recorded; constant load from the first measurement assumed".into()
        }
        Artefact::NoRamp => {
            "record starts under load: zero of the strain unknown, times count from the first measurement; start recording before loading".into()
        }
        Artefact::SlowRamp { ramp_s, .. } => format!(
            "loading took {ramp_s:.1} s (ISO 899-1 requires 1 to 5 s); fit uses the recorded ramp"
        ),
        Artefact::DuplicateTimestamps { readings } => {
            format!(
                "{} with duplicate time stamps; all used",
                counted(readings as u64, "measurement")
            )
        }
        Artefact::NonMonotonicTime { readings } => {
            format!(
                "{} with non-monotonic time stamps excluded",
                counted(readings as u64, "measurement")
            )
        }
        Artefact::Gap { readings } => {
            format!(
                "{} missing or non-finite; excluded",
                counted(readings as u64, "measurement")
            )
        }
        Artefact::Interpolated {
            readings,
            recorded,
            kept,
        } => format!(
            "{} on straight lines between {recorded} others: interpolated, not measured; {}",
            counted(readings as u64, "measurement"),
            treatment(kept, "excluded (--keep-artefacts keeps them)")
        ),
        Artefact::ImplausibleStrain { strain_ratio } => format!(
            "strain of up to {:.0} % is implausible; check its unit",
            100.0 * strain_ratio
        ),
        Artefact::Shortens { strain_ratio } => format!(
            "strain under load is negative ({:.4} % shorter than before loading); check the sign of the elongation",
            -100.0 * strain_ratio
        ),
        Artefact::ImplausibleTime { duration_s } => {
            format!("record duration of {duration_s:.3} s is implausible; check the unit of the time (min, h)")
        }
    }
}

/// Names the source of the scatter between specimens.
pub(crate) fn scatter_source(source: ScatterSource) -> &'static str {
    match source {
        ScatterSource::Repeats => "repeats",
        ScatterSource::OtherRopes => "other ropes",
        ScatterSource::Stated => "specified",
        ScatterSource::Assumed => "assumed",
    }
}

/// Names the method by which an interval was computed.
pub(crate) fn interval_kind(kind: IntervalKind) -> &'static str {
    match kind {
        IntervalKind::Draws => "draws",
        IntervalKind::Profile => "profile likelihood",
        IntervalKind::Bootstrap => "parametric bootstrap",
    }
}

/// States the range of a parameter that the record does not identify.
pub(crate) fn unidentified_range(what: NotIdentifiable, unit: &str) -> String {
    let gap = if unit.is_empty() { "" } else { " " };
    match what {
        NotIdentifiable::Anything { low, high } => {
            format!("any value from {low:.2e} to {high:.2e}{gap}{unit} fits")
        }
        NotIdentifiable::Below { high } => format!("any value below {high:.3e}{gap}{unit} fits"),
        NotIdentifiable::Above { low } => format!("any value above {low:.3e}{gap}{unit} fits"),
    }
}

/// Name of a parameter, with its specimen if it has one.
pub(crate) fn parameter_name(p: &Parameter) -> String {
    match &p.specimen {
        Some(specimen) => format!("{} of {specimen}", p.name),
        None => p.name.clone(),
    }
}

/// States why a parameter was held at a fixed value.
pub(crate) fn fixed_reason(reason: NotIdentifiableReason) -> &'static str {
    match reason {
        NotIdentifiableReason::NoChangeOfLoad => "load constant over all measurements",
        NotIdentifiableReason::FewerThanThreeLoads => "fewer than three loads, none of them zero",
        NotIdentifiableReason::FewerThanFiveLoads => "fewer than five loads",
        NotIdentifiableReason::OneLoad => "one load only",
        NotIdentifiableReason::OneTemperature => "one temperature only",
        NotIdentifiableReason::FewerThanThreeTemperatures => "fewer than three temperatures",
        NotIdentifiableReason::TooLittleFlow => {
            "too little flow at these loads, times and temperatures"
        }
        NotIdentifiableReason::NoRetraction => "absent in the base rope",
        NotIdentifiableReason::NoneWarm => "no record above 35 °C",
        NotIdentifiableReason::WithRateOfFlow => "correlated with the rate of flow",
    }
}

/// Formats load and temperature of a forecast, `60 N at 23 °C, conditions of the test`.
pub(crate) fn forecast_conditions(c: &ForecastConditions) -> String {
    let load = match c.load_n {
        Some(n) => format!("{} N", short(n)),
        None => "load of the test (force not recorded)".to_owned(),
    };
    let heat = match c.temperature_c {
        Some(celsius) => format!(" at {} °C", short(celsius)),
        None => " at the temperature of the test (not recorded)".to_owned(),
    };
    let source = match c.source {
        ConditionSource::Held => "conditions of the test",
        ConditionSource::Stated => "as specified, new specimen",
    };
    format!("{load}{heat}, {source}")
}

/// States why an optimisation did not converge; `None` if it converged.
pub(crate) fn not_converged(fit: &Fit) -> Option<String> {
    let Ending { termination, steps } = fit.ending;
    (!termination.converged()).then(|| {
        let reason = match termination {
            Termination::StepLimit => "step limit reached",
            _ => "aborted",
        };
        format!("optimisation did not converge: {reason} after {steps} steps")
    })
}
