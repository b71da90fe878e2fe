//! Words for what creep tests showed.

use crate::text;
use sinew_creep::{
    ConditionSource, Ending, Fault, Fit, ForecastConditions, IntervalKind, NotIdentifiable,
    PERCENT_PER_H, Parameter, ScatterSource, StrainZero, Termination, WhyFixed,
};
use sinew_model::Bounded;

/// A time of the standard's readings: `3 min`, `50 h`.
pub(super) fn reading_time(time_s: f64) -> String {
    if time_s < 3600.0 {
        format!("{:.0} min", time_s / 60.0)
    } else {
        format!("{:.0} h", time_s / 3600.0)
    }
}

/// `0.42 (0.31 to 0.58)`
pub(super) fn bracketed(b: Bounded) -> String {
    format!("{} ({} to {})", short(b.value), short(b.low), short(b.high))
}

/// A slope in %/h and its interval, for two cells of a table.
pub(super) fn slope(slope_per_s: Option<Bounded>) -> [String; 2] {
    let Some(s) = slope_per_s.map(|s| s.scaled(PERCENT_PER_H)) else {
        return ["–".into(), "–".into()];
    };
    let [value, low, high] = [s.value, s.low, s.high].map(text::short);
    [value, format!("{low} … {high}")]
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

/// Three significant digits, with a power of ten where decimals would hide them.
pub(super) fn short(value: f64) -> String {
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

/// A group's name; specimens without a group are all of them.
pub(super) fn group(name: &Option<String>) -> &str {
    name.as_deref().unwrap_or("all")
}

pub(super) fn zero(zero: StrainZero) -> String {
    match zero {
        StrainZero::BeforeLoad { readings } => {
            format!("mean of {readings} readings before the load")
        }
        StrainZero::AsRecorded => "as recorded; no reading before the load".to_owned(),
    }
}

/// What is odd, and what was done about it.
pub(super) fn fault(fault: &Fault) -> String {
    let done = |kept: bool, taken: &'static str| if kept { "kept" } else { taken };
    match *fault {
        Fault::Slip {
            time_s,
            strain_ratio,
            kept,
        } => format!(
            "strain jumps by {:+.4} % at {time_s:.1} s: a grip slip, not creep; {}",
            100.0 * strain_ratio,
            done(kept, "taken out of all later readings")
        ),
        Fault::Outlier { time_s, kept } => format!(
            "the reading at {time_s:.1} s stands apart; {}",
            done(kept, "left out")
        ),
        Fault::LoadDrift {
            load_n,
            drift_share,
            ..
        } => format!(
            "the load of {load_n:.3} N varies by up to {:.1} %; ISO 899-1 allows 1 %; the fit uses the load as recorded",
            100.0 * drift_share
        ),
        Fault::NoForce => {
            "no force is recorded: a constant load from the first reading on is assumed".into()
        }
        Fault::NoRamp => {
            "the record starts under its load: times count from the first reading".into()
        }
        Fault::SlowRamp { ramp_s, .. } => format!(
            "the load came on within {ramp_s:.1} s; ISO 899-1 asks for 1 s to 5 s; the fit uses the ramp as recorded"
        ),
        Fault::RepeatedStamps { readings } => {
            format!("{readings} readings repeat the stamp before; all are used")
        }
        Fault::ClockGoesBack { readings } => {
            format!("{readings} readings are older than the one before; left out")
        }
        Fault::Gap { readings } => {
            format!("{readings} readings are missing or no numbers; left out")
        }
        Fault::DoubtfulStrain { strain_ratio } => format!(
            "strain reaches {:.0} %: is its unit right?",
            100.0 * strain_ratio
        ),
        Fault::Shortens { strain_ratio } => format!(
            "under load it is shorter than before, by {:.4} %: is the sign of the elongation inverted?",
            -100.0 * strain_ratio
        ),
        Fault::DoubtfulTime { duration_s } => {
            format!("the record lasts {duration_s:.3} s: is the time in minutes or hours?")
        }
    }
}

pub(super) fn scatter_source(source: ScatterSource) -> &'static str {
    match source {
        ScatterSource::Repeats => "repeats",
        ScatterSource::OtherRopes => "other ropes",
        ScatterSource::Stated => "stated",
        ScatterSource::StartingGuess => "guess",
    }
}

pub(super) fn interval_kind(kind: IntervalKind) -> &'static str {
    match kind {
        IntervalKind::Draws => "draws",
        IntervalKind::Profile => "profile likelihood",
        IntervalKind::Bootstrap => "parametric bootstrap",
    }
}

/// What the record leaves open of a parameter.
pub(super) fn open(what: NotIdentifiable, unit: &str) -> String {
    let gap = if unit.is_empty() { "" } else { " " };
    match what {
        NotIdentifiable::Anything { low, high } => {
            format!("anything from {low:.2e} to {high:.2e}{gap}{unit} fits")
        }
        NotIdentifiable::Below { high } => format!("anything below {high:.3e}{gap}{unit} fits"),
        NotIdentifiable::Above { low } => format!("anything above {low:.3e}{gap}{unit} fits"),
    }
}

/// A parameter's name, with its specimen where it has one.
pub(super) fn parameter_name(p: &Parameter) -> String {
    match &p.specimen {
        Some(specimen) => format!("{} of {specimen}", p.name),
        None => p.name.clone(),
    }
}

pub(super) fn why_fixed(why: WhyFixed) -> &'static str {
    match why {
        WhyFixed::NoChangeOfLoad => "no change of load between readings",
        WhyFixed::FewerThanThreeLoads => "fewer than three loads, none among them",
        WhyFixed::FewerThanFiveLoads => "fewer than five loads",
        WhyFixed::OneLoad => "one load only",
        WhyFixed::OneTemperature => "one temperature only",
        WhyFixed::FewerThanThreeTemperatures => "fewer than three temperatures",
        WhyFixed::TooLittleFlow => "too little flow at these loads, times and temperatures",
        WhyFixed::NoRetraction => "the base rope has none",
        WhyFixed::NoneWarm => "no record above 35 °C",
        WhyFixed::WithRateOfFlow => "taken with the rate of flow",
    }
}

/// Load and temperature of a forecast: `60 N at 23 °C, as the test was held`.
pub(super) fn ahead(c: &ForecastConditions) -> String {
    let load = match c.load_n {
        Some(n) => format!("{} N", short(n)),
        None => "the test's load (no force is recorded)".to_owned(),
    };
    let heat = match c.temperature_c {
        Some(celsius) => format!(" at {} °C", short(celsius)),
        None => " at the test's temperature (not recorded)".to_owned(),
    };
    let source = match c.source {
        ConditionSource::Held => "as the test was held",
        ConditionSource::Stated => "as stated, for a new specimen",
    };
    format!("{load}{heat}, {source}")
}

/// How a search ended that did not converge; `None` for one that did.
pub(super) fn not_converged(fit: &Fit) -> Option<String> {
    let Ending { termination, steps } = fit.ending;
    (!termination.converged()).then(|| {
        let why = match termination {
            Termination::StepLimit => "the limit of steps was reached",
            _ => "it broke off",
        };
        format!("the search did not converge: {why} after {steps} steps")
    })
}
