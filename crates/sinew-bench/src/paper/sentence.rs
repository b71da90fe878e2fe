//! Sentences held against data: the paper's, and what Sinew adds.

use serde::Serialize;

/// A sentence, judged from data by a stated criterion.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Sentence {
    /// Who says it.
    pub said_by: SaidBy,
    /// What is said.
    pub text: String,
    /// What must be so for it to hold, with the threshold and its unit.
    pub criterion: String,
    /// What the data gave, in `unit`.
    pub value: f64,
    /// Unit of the value.
    pub unit: Unit,
    /// Whether the criterion is met; of ropes, with the catalogue's own values.
    pub holds: bool,
    /// What that says.
    pub verdict: Verdict,
}

/// Who says a sentence.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum SaidBy {
    /// The paper, in our words.
    Paper,
    /// Sinew, of what the paper doesn't say.
    Sinew,
}

/// What is found of a sentence.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// It holds; of ropes, in at least 95 % of the draws too.
    Holds,
    /// It holds in some draws of what the catalogue leaves open, and in others not.
    Open,
    /// It does not hold; of ropes, in at most 5 % of the draws.
    Fails,
}

impl Verdict {
    fn of(holds: bool, value: f64, unit: Unit) -> Self {
        const SURE: f64 = 0.95;
        match (holds, unit) {
            (true, Unit::ShareOfDraws) if value < SURE => Self::Open,
            (false, Unit::ShareOfDraws) if value > 1.0 - SURE => Self::Open,
            (true, _) => Self::Holds,
            (false, _) => Self::Fails,
        }
    }
}

/// SI unit of a sentence's value, or what it counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Unit {
    /// rad; shown in mrad.
    Rad,
    /// N·m.
    Nm,
    /// s; shown in ms.
    S,
    /// Share of the draws in which the sentence holds; shown in %.
    ShareOfDraws,
    /// Share of the time without contact; shown in %.
    ShareOfFreeTime,
    /// Share of the contacts; shown in %.
    ShareOfContacts,
    /// Share of the cases looked at; shown in %.
    ShareOfCases,
    /// Ropes.
    Ropes,
    /// Factor on the threshold.
    TimesTheThreshold,
}

impl Unit {
    /// How many of the units that are shown make one, and what those are called.
    fn shown(self) -> (f64, &'static str) {
        match self {
            Self::Rad => (1e3, "mrad"),
            Self::Nm => (1.0, "N·m"),
            Self::S => (1e3, "ms"),
            Self::ShareOfDraws => (1e2, "% of 400 draws"),
            Self::ShareOfFreeTime => (1e2, "% of the free time"),
            Self::ShareOfContacts => (1e2, "% of the contacts"),
            Self::ShareOfCases => (1e2, "% of the cases"),
            Self::Ropes => (1.0, "ropes"),
            Self::TimesTheThreshold => (1.0, "times the threshold"),
        }
    }
}

impl Sentence {
    /// What Sinew adds, with its verdict; `value` as it is shown.
    pub(super) fn added(
        text: impl Into<String>,
        criterion: impl Into<String>,
        value: f64,
        unit: Unit,
        holds: bool,
    ) -> Self {
        let value = value / unit.shown().0;
        Self {
            said_by: SaidBy::Sinew,
            text: text.into(),
            criterion: criterion.into(),
            value,
            unit,
            holds,
            verdict: Verdict::of(holds, value, unit),
        }
    }

    /// As a sentence of the paper, in our words.
    #[must_use]
    pub(super) fn of_paper(mut self) -> Self {
        self.said_by = SaidBy::Paper;
        self
    }

    /// The value and its unit as people read them.
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
    fn a_coin_toss_among_the_draws_is_open() {
        let judged = |percent, holds| Sentence::added("", "", percent, Unit::ShareOfDraws, holds);
        for (percent, holds, verdict) in [
            (99.0, true, Verdict::Holds),
            (47.5, true, Verdict::Open),
            (30.0, false, Verdict::Open),
            (2.0, false, Verdict::Fails),
        ] {
            assert_eq!(judged(percent, holds).verdict, verdict, "{percent}");
        }
        assert_eq!(
            Sentence::added("", "", 15.0, Unit::Rad, true).verdict,
            Verdict::Holds
        );
    }

    #[test]
    fn what_sinew_adds_is_no_sentence_of_the_paper() {
        let own = Sentence::added("own", "", 1.0, Unit::Rad, true);
        assert_eq!(own.said_by, SaidBy::Sinew);
        assert_eq!(own.of_paper().said_by, SaidBy::Paper);
    }
}
