//! Statements assessed with data: those of the paper, and those that Sinew adds.

use serde::Serialize;

/// Statement, assessed with data by a stated criterion.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Sentence {
    /// Origin of the statement.
    pub claimed_by: ClaimedBy,
    /// Text of the statement.
    pub text: String,
    /// Criterion for the statement to hold, with the threshold and its unit.
    pub criterion: String,
    /// Value computed from the data, in `unit`.
    pub value: f64,
    /// Unit of the value.
    pub unit: Unit,
    /// Whether the criterion is met; of ropes, with the catalogue's own values.
    pub holds: bool,
    /// Verdict on the statement.
    pub verdict: Verdict,
    /// Basis of the assessment.
    pub basis: Basis,
}

/// Basis of an assessment: what would have to be wrong for the verdict to change.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Basis {
    /// Closed form of an equation with a stated value.
    ClosedForm,
    /// Values that the paper prints.
    Printed,
    /// Assumption of the model, which makes the statement true by construction.
    Construction,
    /// Creep law with assumed parameters, in draws of their intervals.
    AssumedParameters,
    /// One simulation of the robot with perfect sensors.
    IdealSimulation,
    /// Simulations of the robot with assumed friction, sensor noise and model errors.
    NoisySimulation,
}

impl Basis {
    /// Returns the basis in words, for pages and tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::ClosedForm => "closed form",
            Self::Printed => "printed values",
            Self::Construction => "true by construction of the creep law",
            Self::AssumedParameters => "creep law with assumed parameters, in draws",
            Self::IdealSimulation => "simulation with perfect sensors",
            Self::NoisySimulation => {
                "simulation with friction, noise and model errors, one seed per run"
            }
        }
    }

    /// Returns the basis of most statements with a value of this unit.
    fn of(unit: Unit) -> Self {
        match unit {
            Unit::ShareOfDraws => Self::AssumedParameters,
            Unit::Ropes => Self::Printed,
            Unit::N => Self::ClosedForm,
            Unit::ShareOfFreeTime | Unit::ShareOfContacts | Unit::S | Unit::TimesTheThreshold => {
                Self::NoisySimulation
            }
            Unit::Rad | Unit::Nm | Unit::ShareOfCases => Self::IdealSimulation,
        }
    }
}

/// Origin of a statement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum ClaimedBy {
    /// The paper, in our words.
    Paper,
    /// Sinew, on a subject that the paper does not treat.
    Sinew,
}

/// Verdict on a statement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// The statement holds; for ropes, in at least 95 % of the draws too.
    Holds,
    /// The statement holds in some draws of the uncertain catalogue values, and in others not.
    Open,
    /// The statement is not confirmed; for ropes, it holds in at most 5 % of the draws.
    Fails,
}

impl Verdict {
    fn of(holds: bool, value: f64, unit: Unit) -> Self {
        const MIN_SHARE: f64 = 0.95;
        match (holds, unit) {
            (true, Unit::ShareOfDraws) if value < MIN_SHARE => Self::Open,
            (false, Unit::ShareOfDraws) if value > 1.0 - MIN_SHARE => Self::Open,
            (true, _) => Self::Holds,
            (false, _) => Self::Fails,
        }
    }
}

/// Unit of the value of a statement: an SI unit, or the counted objects.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Unit {
    /// rad; shown in mrad.
    Rad,
    /// Force in N.
    N,
    /// Torque in N·m.
    Nm,
    /// s; shown in ms.
    S,
    /// Share of the draws in which the statement holds; shown in %.
    ShareOfDraws,
    /// Share of the time without contact; shown in %.
    ShareOfFreeTime,
    /// Share of the contacts; shown in %.
    ShareOfContacts,
    /// Share of the evaluated cases; displayed in %.
    ShareOfCases,
    /// Number of ropes.
    Ropes,
    /// Factor on the threshold.
    TimesTheThreshold,
}

impl Unit {
    /// Returns the number of displayed units per unit, and their name.
    fn shown(self) -> (f64, &'static str) {
        match self {
            Self::Rad => (1e3, "mrad"),
            Self::N => (1.0, "N"),
            Self::Nm => (1.0, "N·m"),
            Self::S => (1e3, "ms"),
            Self::ShareOfDraws => (1e2, "% of 400 draws"),
            Self::ShareOfFreeTime => (1e2, "% of the contact-free time"),
            Self::ShareOfContacts => (1e2, "% of the contacts"),
            Self::ShareOfCases => (1e2, "% of the cases"),
            Self::Ropes => (1.0, "ropes"),
            Self::TimesTheThreshold => (1.0, "times the threshold"),
        }
    }
}

impl Sentence {
    /// Returns a statement of Sinew with its verdict; `value` as it is displayed.
    pub(super) fn added(
        text: impl Into<String>,
        criterion: impl Into<String>,
        value: f64,
        unit: Unit,
        holds: bool,
    ) -> Self {
        let value = value / unit.shown().0;
        Self {
            claimed_by: ClaimedBy::Sinew,
            text: text.into(),
            criterion: criterion.into(),
            value,
            unit,
            holds,
            verdict: Verdict::of(holds, value, unit),
            basis: Basis::of(unit),
        }
    }

    /// Sets the basis of the assessment.
    #[must_use]
    pub(super) fn based_on(mut self, basis: Basis) -> Self {
        self.basis = basis;
        self
    }

    /// Marks it as a statement of the paper, paraphrased.
    #[must_use]
    pub(super) fn of_paper(mut self) -> Self {
        self.claimed_by = ClaimedBy::Paper;
        self
    }

    /// Returns the displayed value and its unit.
    pub fn shown(&self) -> (f64, &'static str) {
        let (factor, unit) = self.unit.shown();
        (factor * self.value, unit)
    }
}

/// Holds when `value` is within `share` of `expected`, both as they are shown.
pub(super) fn near(
    text: impl Into<String>,
    derivation: &str,
    value: f64,
    expected: f64,
    share: f64,
    unit: Unit,
) -> Sentence {
    let criterion = format!(
        "within {:.0} % of {} {}; {derivation}",
        100.0 * share,
        sinew_figure::rounded(expected, 3),
        unit.shown().1
    );
    let holds = (value - expected).abs() <= share * expected.abs();
    Sentence::added(text, criterion, value, unit, holds)
}

/// Holds when `value` is at most `limit` in size, both as they are shown.
pub(super) fn below(
    text: impl Into<String>,
    derivation: &str,
    value: f64,
    limit: f64,
    unit: Unit,
) -> Sentence {
    let criterion = format!(
        "at most {} {}; {derivation}",
        sinew_figure::rounded(limit, 3),
        unit.shown().1
    );
    Sentence::added(text, criterion, value, unit, value.abs() <= limit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn verdict_half_of_draws_returns_open() {
        let assessed = |percent, holds| Sentence::added("", "", percent, Unit::ShareOfDraws, holds);
        for (percent, holds, verdict) in [
            (99.0, true, Verdict::Holds),
            (47.5, true, Verdict::Open),
            (30.0, false, Verdict::Open),
            (2.0, false, Verdict::Fails),
        ] {
            assert_eq!(assessed(percent, holds).verdict, verdict, "{percent}");
        }
        assert_eq!(
            Sentence::added("", "", 15.0, Unit::Rad, true).verdict,
            Verdict::Holds
        );
    }

    #[test]
    fn basis_follows_unit_unless_specified() {
        let draws = Sentence::added("", "", 50.0, Unit::ShareOfDraws, true);
        assert_eq!(draws.basis, Basis::AssumedParameters);
        let built = draws.based_on(Basis::Construction);
        assert_eq!(built.basis, Basis::Construction);
        let force = Sentence::added("", "", 50.0, Unit::N, true);
        assert_eq!(force.basis, Basis::ClosedForm);
    }

    #[test]
    fn added_sentence_is_claimed_by_sinew() {
        let own = Sentence::added("own", "", 1.0, Unit::Rad, true);
        assert_eq!(own.claimed_by, ClaimedBy::Sinew);
        assert_eq!(own.of_paper().claimed_by, ClaimedBy::Paper);
    }
}
