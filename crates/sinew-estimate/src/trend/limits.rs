//! When a limit is passed, in numbers and words.

use super::result::{JointTrend, LimitSaid};
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, StandardNormal};
use sinew_figure::rounded;
use sinew_files::date::day_of;
use sinew_model::statistics::quantile;
use sinew_model::transmission::Tendon;
use sinew_model::trend::{Paths, Trend, first_passage};

const DAY_S: f64 = 86_400.0;
/// Paths drawn: the 2.5 % quantile rests on fifty.
const PATHS: usize = 2000;
/// Times looked at until the horizon.
const STEPS: usize = 150;
/// Sessions below which a trend without a rope says nothing on the future.
const FEW: u64 = 3;

/// Ways the tendon may go.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Ahead {
    pub(super) paths: Paths,
}

impl Ahead {
    pub(super) fn draw(trend: &Trend, horizon_s: f64, seed: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let start = trend.time_s().max(3600.0);
        let ratio = ((start + horizon_s) / start).powf(1.0 / STEPS as f64);
        let times: Vec<f64> = (0..=STEPS)
            .map(|i| trend.time_s() + start * (ratio.powi(i as i32) - 1.0))
            .collect();
        Self {
            paths: Paths::draw(trend, &times, PATHS, &mut || {
                StandardNormal.sample(&mut rng)
            }),
        }
    }

    /// Quantiles of 2.5, 50 and 97.5 % of the offset at every time, mrad.
    pub(super) fn quantiles_mrad(&self) -> Vec<[f64; 3]> {
        (0..self.paths.times_s.len())
            .map(|i| {
                let mut column: Vec<f64> = self.paths.offset_rad.iter().map(|p| p[i]).collect();
                column.sort_unstable_by(f64::total_cmp);
                [0.025, 0.5, 0.975].map(|q| 1e3 * quantile(&column, q))
            })
            .collect()
    }
}

/// The limits of a tendon.
pub(super) fn limits(
    tendon: Option<&Tendon>,
    trend: &Trend,
    ahead: &Ahead,
    last_utc_s: f64,
    rope_known: bool,
) -> Vec<LimitSaid> {
    let Some(tendon) = tendon else {
        return Vec::new();
    };
    let mut out = Vec::new();
    let mut say = |kind: &str, limit_rad: f64, stated: String, paths: &[Vec<f64>]| {
        let found = first_passage(&ahead.paths.times_s, paths, limit_rad);
        let poor = trend.records() < if rope_known { 1 } else { FEW };
        out.push(said(
            kind,
            limit_rad,
            stated,
            found,
            trend.time_s(),
            last_utc_s,
            poor,
        ));
    };
    if let Some(limit_m) = tendon.retension_at_m {
        let stated = format!("{} mm", rounded(1e3 * limit_m, 3));
        let limit_rad = limit_m / tendon.joint_pulley_radius_m;
        say("re-tension", limit_rad, stated, &ahead.paths.offset_rad);
    }
    if let Some(strain) = tendon.replace_at_strain {
        let stated = format!("{} % strain", rounded(100.0 * strain, 3));
        let limit_rad = strain * tendon.length_m / tendon.joint_pulley_radius_m;
        say("replace", limit_rad, stated, &ahead.paths.whole_rad);
    }
    out
}

fn said(
    kind: &str,
    limit_rad: f64,
    stated: String,
    mut found_s: Vec<f64>,
    now_s: f64,
    last_utc_s: f64,
    poor: bool,
) -> LimitSaid {
    found_s.sort_unstable_by(f64::total_cmp);
    let count = found_s.len().max(1) as f64;
    let passed_probability = found_s.iter().filter(|t| **t <= now_s).count() as f64 / count;
    let at = |share: f64| {
        let t = quantile(&found_s, share);
        t.is_finite().then_some(((t - now_s) / DAY_S).max(0.0))
    };
    let (low, median, high) = (at(0.025), at(0.5), at(0.975));
    let whole = |d: f64| format!("{:.0}", d.round());
    let (state, said) = if poor {
        ("unknown", "unknown: too few sessions".into())
    } else if passed_probability > 0.5 {
        let percent = 100.0 * passed_probability;
        let sure = if percent > 99.0 {
            "over 99".into()
        } else {
            format!("{percent:.0}")
        };
        ("passed", format!("passed ({sure} % sure)"))
    } else {
        match (low, median, high) {
            (_, Some(m), Some(h)) => (
                "forecast",
                format!(
                    "in {} days ({} to {})",
                    whole(m),
                    whole(low.unwrap_or(0.0)),
                    whole(h)
                ),
            ),
            (_, Some(m), None) => (
                "forecast",
                format!(
                    "in {} days or later, not before {}, perhaps never",
                    whole(m),
                    whole(low.unwrap_or(0.0))
                ),
            ),
            (Some(l), None, _) => (
                "unknown",
                format!("unknown: not before {} days, perhaps never", whole(l)),
            ),
            (None, None, _) => ("unknown", "not within the horizon".into()),
        }
    };
    let known = state != "unknown";
    LimitSaid {
        kind: kind.into(),
        limit_mrad: 1e3 * limit_rad,
        stated,
        passed_probability,
        state: state.into(),
        days: median.filter(|_| known),
        interval_95_days: if poor { [None, None] } else { [low, high] },
        day: median
            .filter(|_| known)
            .map(|d| day_of(last_utc_s + d * DAY_S)),
        said,
    }
}

/// The tendon in one sentence.
pub(super) fn verdict(joint: &JointTrend) -> String {
    if let Some(limit) = joint.limits.iter().find(|l| l.state == "passed") {
        let what = if limit.kind == "replace" {
            "replace the rope"
        } else {
            "tension it again"
        };
        return format!("{what}: the limit of {} is {}", limit.stated, limit.said);
    }
    let jump = joint.events.iter().rev().find(|e| e.kind == "jump");
    if let Some(jump) = jump {
        let size = jump.size_mrad.map_or(String::new(), |[m, h]| {
            format!(" by {} ± {} mrad", rounded(m, 2), rounded(h, 2))
        });
        return format!("look at it: jumped{size} by {}; {}", jump.day, jump.meaning);
    }
    if let Some(s) = &joint.suspicion {
        return format!(
            "watch it: a jump by {} is {:.0} % likely, the next session will tell",
            s.day,
            100.0 * s.probability
        );
    }
    match joint.limits.first() {
        Some(limit) => format!("{} {}", limit.kind, limit.said),
        None => "no limit in robot.toml".into(),
    }
}
