//! Trajectories of the online estimate over many recordings.

use super::run::{everything, plans, study};
use super::trajectory::{JointTrajectory, SlipTrajectory, Trajectory, trajectory};
use super::{Options, RejectedRecording, ScenarioError};
use crate::journal::{Kind, Setting, checksum};
use crate::numbers::{finite, quantile_of};
use serde::{Deserialize, Serialize};
use sinew_files::JsonDocument;
use sinew_report::text::{paragraph, plain, table};

/// Format of the file of results; the version changes with simulation or estimator, because older files cannot be
/// resumed.
const TRAJECTORIES: Kind = Kind {
    format: "sinew-trajectory",
    version: 2,
    holds: "trajectories of the online estimate",
};

/// Online estimate over many recordings, assessed at every block.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TrajectoryReport {
    /// Version of the program that created the report.
    pub sinew_version: String,
    /// Seed of the first recording of each scenario.
    pub first_seed: u64,
    /// Number of requested recordings per scenario.
    pub recordings: u64,
    /// One entry per scenario, and a last one of all together.
    pub scenarios: Vec<TrajectorySummary>,
    /// Recordings rejected by the estimator and excluded from all figures.
    pub rejections: Vec<RejectedRecording>,
}

impl JsonDocument for TrajectoryReport {
    const SCHEMA: &'static str = "sinew/trajectory/2";
}

/// Trajectories of one scenario. Shares are of all blocks of all elastic joints.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TrajectorySummary {
    /// Name of the scenario.
    pub scenario: String,
    /// Number of recordings.
    pub recordings: usize,
    /// All elastic joints together, then each.
    pub joints: Vec<TrajectoryFigures>,
    /// All slips together.
    pub slips: SlipFigures,
    /// Changes reported with a probability of at least 0.9 that did not happen, an hour.
    pub false_changes_per_h: Option<f64>,
    /// Ratio of the processor time to the duration of the recordings; `None` if several recordings ran simultaneously
    /// (`--jobs`), whose times cannot be separated.
    pub processor_share: Option<f64>,
}

/// Summary figures of the trajectories.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TrajectoryFigures {
    /// Joint; "all": all of them.
    pub joint: String,
    /// First useful answer (inside, settled, ± at most 3 mrad), s from the first block: median, and of nine of ten.
    pub first_useful_s: [Option<f64>; 2],
    /// Share of the time useful.
    pub useful_share: f64,
    /// Share of the time provisional.
    pub provisional_share: f64,
    /// Share of calm time provisional: from 30 s on, not within 12 s after a slip.
    pub calm_provisional_share: Option<f64>,
    /// Share of the time inside the 95 % interval.
    pub inside_share: f64,
    /// Share outside it and settled.
    pub silent_share: f64,
    /// Share beyond three deviations and settled.
    pub far_share: f64,
    /// Median of the recordings' median half width, rad.
    pub half_width_95_rad: Option<f64>,
    /// Longest time silent without a break, s.
    pub longest_silent_s: f64,
}

/// Slips, times since them, s: median, nine of ten, longest. One that was not reached within 30 s counts as that.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SlipFigures {
    /// Number of slips.
    pub slips: usize,
    /// Time until the estimate was last silently outside, s.
    pub silent_s: [Option<f64>; 3],
    /// Time until the interval contains the truth or the estimate is provisional, s.
    pub holds_s: [Option<f64>; 3],
    /// Time until inside, settled and ± at most 2 mrad, or 1.3 times that before the slip, s.
    pub right_s: [Option<f64>; 3],
}

/// Runs all recordings; calls `progress` with the number done and the total.
///
/// # Errors
/// Returns a [`ScenarioError`] if a scenario cannot be run; recordings finished before are in the file of results.
pub fn run_trajectories(
    options: &Options,
    progress: &mut (dyn FnMut(usize, usize) + Send),
) -> Result<TrajectoryReport, ScenarioError> {
    let plans = plans(options)?;
    let settings: [Setting; 1] = [(
        "scenarios",
        checksum(&everything(&plans)),
        "another robot, or other scenarios than those of this version",
    )];
    let (trajectories, rejections) = study(
        options,
        &plans,
        &TRAJECTORIES,
        &settings,
        trajectory,
        progress,
    )?;
    let of = |name: Option<&String>| -> Vec<&Trajectory> {
        let own = trajectories.iter();
        own.filter(|c| name.is_none_or(|name| *name == c.scenario))
            .collect()
    };
    let mut scenarios: Vec<TrajectorySummary> = (plans.iter())
        .map(|plan| summarise(&plan.name, &of(Some(&plan.name))))
        .collect();
    if scenarios.len() > 1 {
        scenarios.push(summarise("all", &of(None)));
    }
    if options.jobs > 1 {
        scenarios.iter_mut().for_each(|s| s.processor_share = None);
    }
    Ok(TrajectoryReport {
        sinew_version: env!("CARGO_PKG_VERSION").into(),
        first_seed: options.first_seed,
        recordings: options.n,
        scenarios,
        rejections,
    })
}

fn summarise(scenario: &str, trajectories: &[&Trajectory]) -> TrajectorySummary {
    let joints: Vec<&JointTrajectory> = trajectories.iter().flat_map(|c| &c.joints).collect();
    let mut names: Vec<&str> = Vec::new();
    for joint in &joints {
        if !names.contains(&joint.name.as_str()) {
            names.push(&joint.name);
        }
    }
    let of = |name: &str| -> Vec<&JointTrajectory> {
        joints
            .iter()
            .copied()
            .filter(|joint| joint.name == name)
            .collect()
    };
    let exposure_s: f64 = trajectories.iter().map(|c| c.exposure_s).sum();
    let processor_s: f64 = trajectories.iter().map(|c| c.processor_s).sum();
    let false_changes: usize = trajectories.iter().map(|c| c.false_changes.len()).sum();
    TrajectorySummary {
        scenario: scenario.into(),
        recordings: trajectories.len(),
        joints: std::iter::once(figures("all", &joints))
            .chain(names.iter().map(|name| figures(name, &of(name))))
            .collect(),
        slips: slip_figures(
            &trajectories
                .iter()
                .flat_map(|c| &c.slips)
                .collect::<Vec<_>>(),
        ),
        false_changes_per_h: finite(3600.0 * false_changes as f64 / exposure_s),
        processor_share: finite(processor_s / exposure_s),
    }
}

fn figures(joint: &str, own: &[&JointTrajectory]) -> TrajectoryFigures {
    let sum = |of: fn(&JointTrajectory) -> usize| own.iter().map(|j| of(j)).sum::<usize>() as f64;
    let blocks = sum(|j| j.blocks);
    let first: Vec<f64> = (own.iter())
        .map(|j| j.first_useful_s.unwrap_or(f64::INFINITY))
        .collect();
    let widths: Vec<f64> = own.iter().map(|j| j.median_half_width_rad).collect();
    TrajectoryFigures {
        joint: joint.into(),
        first_useful_s: [0.5, 0.9].map(|share| finite(quantile_of(first.clone(), share))),
        useful_share: sum(|j| j.useful) / blocks,
        provisional_share: sum(|j| j.provisional) / blocks,
        calm_provisional_share: finite(sum(|j| j.calm_provisional) / sum(|j| j.calm)),
        inside_share: sum(|j| j.inside) / blocks,
        silent_share: sum(|j| j.silent) / blocks,
        far_share: sum(|j| j.far) / blocks,
        half_width_95_rad: finite(quantile_of(widths, 0.5)),
        longest_silent_s: own.iter().map(|j| j.longest_silent_s).fold(0.0, f64::max),
    }
}

fn slip_figures(slips: &[&SlipTrajectory]) -> SlipFigures {
    let of = |time: fn(&SlipTrajectory) -> Option<f64>| {
        let times = slips
            .iter()
            .map(|s| time(s).unwrap_or(SlipTrajectory::FOLLOWED_S));
        let times: Vec<f64> = times.collect();
        [0.5, 0.9, 1.0].map(|share| finite(quantile_of(times.clone(), share)))
    };
    SlipFigures {
        slips: slips.len(),
        silent_s: of(|s| Some(s.silent_s)),
        holds_s: of(|s| s.holds_s),
        right_s: of(|s| s.right_s),
    }
}

/// The report as text of at most 80 columns.
pub fn render_trajectories(report: &TrajectoryReport) -> String {
    let optional = |value: Option<f64>, decimals: usize| match value {
        Some(value) => format!("{value:.decimals$}"),
        None => "–".into(),
    };
    let several = |values: &[Option<f64>]| {
        let all: Vec<String> = values.iter().map(|v| optional(*v, 1)).collect();
        all.join(" / ")
    };
    let percent = |share: f64, decimals: usize| format!("{:.decimals$}", 100.0 * share);
    let (mut rows, mut slips) = (Vec::new(), Vec::new());
    for s in &report.scenarios {
        for (k, j) in s.joints.iter().enumerate() {
            let name = match k {
                0 => format!("{}, n = {}", plain(&s.scenario), s.recordings),
                _ => format!("  {}", plain(&j.joint)),
            };
            rows.push(vec![
                name,
                several(&j.first_useful_s),
                percent(j.useful_share, 1),
                percent(j.provisional_share, 1),
                j.calm_provisional_share
                    .map_or("–".into(), |share| percent(share, 1)),
                percent(j.inside_share, 1),
                percent(j.silent_share, 1),
                percent(j.far_share, 2),
                optional(j.half_width_95_rad.map(|rad| 1e3 * rad), 2),
            ]);
        }
        slips.push(vec![
            plain(&s.scenario),
            s.slips.slips.to_string(),
            several(&s.slips.silent_s),
            several(&s.slips.holds_s),
            several(&s.slips.right_s),
            optional(s.false_changes_per_h, 1),
            optional(s.processor_share.map(|share| 100.0 * share), 2),
        ]);
    }
    let mut text = String::from("Online estimate at every block of two minutes of work\n");
    let head = [
        "",
        "first\ns",
        "useful\n%",
        "prov.\n%",
        "calm\n%",
        "inside\n%",
        "silent\n%",
        "far\n%",
        "±\nmrad",
    ];
    text.push_str(&table(&head, rows, 1));
    text.push_str("\nSlips of 5 mrad\n");
    let head = [
        "",
        "slips",
        "silent, s",
        "covered, s",
        "accurate, s",
        "false\n1/h",
        "proc.\n%",
    ];
    text.push_str(&table(&head, slips, 1));
    text.push('\n');
    text.push_str(&paragraph(
        "first: time of the first useful estimate, median / 90 % quantile; useful: inside the 95 % interval, settled, ± at most 3 mrad; prov.: provisional; \
         calm: provisional from 30 s on and not within 12 s after a slip; silent: outside and settled; far: beyond three standard deviations and settled; \
         ±: median half-width. Slips, median / 90 % quantile / maximum: time until last silently outside; covered: until the interval contains the truth or is \
         provisional; accurate: until inside, settled and ± at most 2 mrad (30 s if longer); false: changes of a probability of at least 0.9 that \
         did not happen; proc.: processor time",
        0,
    ));
    for r in &report.rejections {
        let line = format!(
            "{}, seed {}: {}",
            plain(&r.scenario),
            r.seed,
            plain(&r.reason)
        );
        text.push_str(&paragraph(&line, 2));
    }
    text
}
