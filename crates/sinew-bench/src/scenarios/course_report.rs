//! Courses of many recordings together.

use super::course::{Course, JointCourse, SlipCourse, course};
use super::run::{everything, plans, study};
use super::{Options, Refusal, ScenarioError};
use crate::journal::{Kind, Setting, checksum};
use crate::numbers::{finite, quantile_of};
use serde::{Deserialize, Serialize};
use sinew_files::JsonDocument;
use sinew_report::text::{paragraph, plain, table};

/// Another simulation or estimator: what older files hold can't go on.
const COURSES: Kind = Kind {
    format: "sinew-course",
    version: 2,
    holds: "courses of the online estimate",
};

/// The online estimate over many recordings, judged at every block.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CourseReport {
    /// Version of the program that made it.
    pub sinew_version: String,
    /// Seed of the first recording of each scenario.
    pub first_seed: u64,
    /// Recordings asked for per scenario.
    pub recordings: u64,
    /// One entry per scenario, and a last one of all together.
    pub scenarios: Vec<CourseSummary>,
    /// Recordings that the estimate refused; they are in no figure.
    pub refusals: Vec<Refusal>,
}

impl JsonDocument for CourseReport {
    const SCHEMA: &'static str = "sinew/course/1";
}

/// Courses of one scenario. Shares are of all blocks of all elastic joints.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CourseSummary {
    /// Its name.
    pub scenario: String,
    /// Recordings.
    pub recordings: usize,
    /// All elastic joints together, then each.
    pub joints: Vec<CourseFigures>,
    /// All slips together.
    pub slips: SlipFigures,
    /// Changes reported with a probability of at least 0.9 that did not happen, an hour.
    pub false_changes_per_h: Option<f64>,
    /// Processor time over the recordings' length; `None` where several recordings ran at once (`--jobs`), whose times are one.
    pub processor_share: Option<f64>,
}

/// What a course comes to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CourseFigures {
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
    /// How many.
    pub slips: usize,
    /// Until the answer was last silently outside.
    pub silent_s: [Option<f64>; 3],
    /// Until the interval holds the truth, or the answer is provisional.
    pub holds_s: [Option<f64>; 3],
    /// Until inside, settled and ± at most 2 mrad, or 1.3 times that before the slip.
    pub right_s: [Option<f64>; 3],
}

/// Runs all recordings; `progress` is told how many of how many are done.
///
/// # Errors
/// [`ScenarioError`]; what was finished before is in the file of results.
pub fn run_courses(
    options: &Options,
    progress: &mut (dyn FnMut(usize, usize) + Send),
) -> Result<CourseReport, ScenarioError> {
    let plans = plans(options)?;
    let settings: [Setting; 1] = [(
        "scenarios",
        checksum(&everything(&plans)),
        "of another robot, or of other scenarios than this program's",
    )];
    let (courses, refusals) = study(options, &plans, &COURSES, &settings, course, progress)?;
    let of = |name: Option<&String>| -> Vec<&Course> {
        let own = courses.iter();
        own.filter(|c| name.is_none_or(|name| *name == c.scenario))
            .collect()
    };
    let mut scenarios: Vec<CourseSummary> = (plans.iter())
        .map(|plan| summarise(&plan.name, &of(Some(&plan.name))))
        .collect();
    if scenarios.len() > 1 {
        scenarios.push(summarise("all", &of(None)));
    }
    if options.jobs > 1 {
        scenarios.iter_mut().for_each(|s| s.processor_share = None);
    }
    Ok(CourseReport {
        sinew_version: env!("CARGO_PKG_VERSION").into(),
        first_seed: options.first_seed,
        recordings: options.n,
        scenarios,
        refusals,
    })
}

fn summarise(scenario: &str, courses: &[&Course]) -> CourseSummary {
    let joints: Vec<&JointCourse> = courses.iter().flat_map(|c| &c.joints).collect();
    let mut names: Vec<&str> = Vec::new();
    for joint in &joints {
        if !names.contains(&joint.name.as_str()) {
            names.push(&joint.name);
        }
    }
    let of = |name: &str| -> Vec<&JointCourse> {
        joints
            .iter()
            .copied()
            .filter(|joint| joint.name == name)
            .collect()
    };
    let watched_s: f64 = courses.iter().map(|c| c.watched_s).sum();
    let processor_s: f64 = courses.iter().map(|c| c.processor_s).sum();
    let false_changes: usize = courses.iter().map(|c| c.false_changes.len()).sum();
    CourseSummary {
        scenario: scenario.into(),
        recordings: courses.len(),
        joints: std::iter::once(figures("all", &joints))
            .chain(names.iter().map(|name| figures(name, &of(name))))
            .collect(),
        slips: slip_figures(&courses.iter().flat_map(|c| &c.slips).collect::<Vec<_>>()),
        false_changes_per_h: finite(3600.0 * false_changes as f64 / watched_s),
        processor_share: finite(processor_s / watched_s),
    }
}

fn figures(joint: &str, own: &[&JointCourse]) -> CourseFigures {
    let sum = |of: fn(&JointCourse) -> usize| own.iter().map(|j| of(j)).sum::<usize>() as f64;
    let blocks = sum(|j| j.blocks);
    let first: Vec<f64> = (own.iter())
        .map(|j| j.first_useful_s.unwrap_or(f64::INFINITY))
        .collect();
    let widths: Vec<f64> = own.iter().map(|j| j.median_half_width_rad).collect();
    CourseFigures {
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

fn slip_figures(slips: &[&SlipCourse]) -> SlipFigures {
    let of = |time: fn(&SlipCourse) -> Option<f64>| {
        let times = slips
            .iter()
            .map(|s| time(s).unwrap_or(SlipCourse::FOLLOWED_S));
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
pub fn render_courses(report: &CourseReport) -> String {
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
        "holds, s",
        "right, s",
        "false\n1/h",
        "proc.\n%",
    ];
    text.push_str(&table(&head, slips, 1));
    text.push('\n');
    text.push_str(&paragraph(
        "first: first useful answer, median / nine of ten; useful: inside the 95 % interval, settled, ± at most 3 mrad; prov.: provisional; \
         calm: provisional from 30 s on and not within 12 s after a slip; silent: outside and settled; far: beyond three deviations and settled; \
         ±: median half width. Slips, median / nine of ten / longest: until last silently outside; until the interval holds the truth or is \
         provisional; until inside, settled and ± at most 2 mrad, 30 where that took longer; false: changes of a probability of at least 0.9 that \
         did not happen; proc.: processor time",
        0,
    ));
    for r in &report.refusals {
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
