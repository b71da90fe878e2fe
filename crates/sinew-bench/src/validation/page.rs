//! The tables of the page as Markdown.

use super::rows::{
    EndOffsets, Forecasts, Joint, JointTrajectory, Rows, Scenario, Share, Slips, Trajectory, Year,
};
use super::{Measurement, Validation};
use crate::numbers::weighted_mean;
use crate::scenarios::{End, Form};
use crate::year::{Extrapolation, Forecaster};
use sinew_creep::Coverage;
use sinew_model::Z95;

/// Error of a page.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PageError {
    /// The end mark of a table is missing.
    #[error("table '{0}' has no end mark '{END}'")]
    Unclosed(String),
    /// The table does not exist.
    #[error("there is no table '{0}'")]
    Unknown(String),
    /// A study of a table has no results.
    #[error("the data lack study '{0}'; measure it with `sinew-bench validation --only {0}`")]
    Missing(String),
}

const BEGIN: &str = "<!-- generated table: ";
const END: &str = "<!-- end of generated -->";

/// Returns the page with the tables of the data.
///
/// # Errors
/// Returns a [`PageError`] for a table without data.
pub fn render(page: &str, data: &Validation) -> Result<String, PageError> {
    let (mut out, mut rest) = (String::new(), page);
    while let Some((before, after)) = rest.split_once(BEGIN) {
        let (name, after) = after.split_once(" -->").unwrap_or((after, ""));
        let unclosed = || PageError::Unclosed(name.into());
        let (_, after) = after.split_once(END).ok_or_else(unclosed)?;
        out += &format!("{before}{BEGIN}{name} -->\n\n{}\n{END}", block(name, data)?);
        rest = after;
    }
    Ok(out + rest)
}

/// Formats a table with the commits and the commands of its studies.
fn block(name: &str, data: &Validation) -> Result<String, PageError> {
    let studies: &[&str] = match name {
        "years" => &["years-check", "years-work"],
        other => &[other],
    };
    let measured = studies.iter().map(|study| {
        let found = data.0.get(*study);
        found.ok_or_else(|| PageError::Missing((*study).into()))
    });
    let measured: Vec<&Measurement> = measured.collect::<Result<_, _>>()?;
    let text = match (name, &measured[0].rows) {
        ("coverage", Rows::Scenarios(rows)) => coverage(rows),
        ("stress", Rows::Scenarios(rows)) => stress(rows),
        ("other-arms", Rows::Scenarios(rows)) => other_arms(rows),
        ("slips", Rows::Scenarios(rows)) => slips(rows),
        ("unmodelled", Rows::Scenarios(rows)) => unmodelled(rows),
        ("variants", Rows::Scenarios(rows)) => variants(rows),
        ("online", rows) => online(rows),
        ("years", Rows::Years(_)) => years(&measured),
        ("extrapolation", Rows::Extrapolations(rows)) => extrapolation(rows),
        ("creep-fits", Rows::HoldOuts(rows)) => creep_fits(rows),
        _ => return Err(PageError::Unknown(name.into())),
    };
    let mut commits: Vec<&str> = measured.iter().map(|m| m.commit.as_str()).collect();
    commits.dedup();
    let commands = measured.iter().flat_map(|m| &m.commands);
    let commands: String = commands.map(|c| format!("{c}\n")).collect();
    let commits = commits.join(" and ");
    Ok(format!(
        "{text}\nMeasured at commit {commits}:\n\n```sh\n{commands}```\n"
    ))
}

/// Heading of a column and its cell in a row.
type Column<'a, T> = (String, Box<dyn Fn(&T) -> String + 'a>);

fn column<'a, T>(heading: impl Into<String>, cell: impl Fn(&T) -> String + 'a) -> Column<'a, T> {
    (heading.into(), Box::new(cell))
}

fn table<'a, T: 'a>(rows: impl IntoIterator<Item = &'a T>, columns: &[Column<'_, T>]) -> String {
    let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
    let mut text = line(columns.iter().map(|(heading, _)| heading.clone()).collect());
    text += &format!("|{}\n", "---|".repeat(columns.len()));
    for row in rows {
        text += &line(columns.iter().map(|(_, cell)| cell(row)).collect());
    }
    text
}

/// Formats a number with `decimals`, or a dash.
fn fixed(value: impl Into<Option<f64>>, factor: f64, decimals: usize) -> String {
    let value: Option<f64> = value.into();
    value.map_or("–".into(), |v| format!("{:.decimals$}", factor * v))
}

/// Formats mrad with two decimals, from 10 mrad on with none.
fn mrad(rad: impl Into<Option<f64>>) -> String {
    let rad: Option<f64> = rad.into();
    let decimals = if rad.is_some_and(|v| v >= 9.995e-3) {
        0
    } else {
        2
    };
    fixed(rad, 1e3, decimals)
}

/// Formats mrad with two digits and at most two decimals.
fn two_digits(rad: impl Into<Option<f64>>) -> String {
    let rad: Option<f64> = rad.into();
    let decimals = match rad.map_or(0.0, |v| 1e3 * v) {
        mrad if mrad < 0.995 => 2,
        mrad if mrad < 9.95 => 1,
        _ => 0,
    };
    fixed(rad, 1e3, decimals)
}

/// Formats per cent with a decimal; 100 % has none.
fn percent(share: impl Into<Option<f64>>) -> String {
    fixed(share, 100.0, 1).replace("100.0", "100")
}

fn whole_percent(share: impl Into<Option<f64>>) -> String {
    fixed(share, 100.0, 0)
}

/// Joins the texts of the items.
fn list<T>(items: impl IntoIterator<Item = T>, of: impl Fn(T) -> String) -> String {
    items.into_iter().map(of).collect::<Vec<_>>().join(", ")
}

fn half_width(joint: &Joint) -> Option<f64> {
    joint.reported_std_rad.map(|std| Z95 * std)
}

/// Formats a value of shoulder pitch and elbow.
fn loaded<'a>(heading: &str, of: impl Fn(&Joint) -> String + 'a) -> Column<'a, Scenario> {
    column(heading, move |s: &Scenario| {
        let named = |name| s.joints.iter().find(|j| j.name == name);
        list(
            ["shoulder_pitch", "elbow"].into_iter().filter_map(named),
            &of,
        )
    })
}

fn scenario<'a>() -> Column<'a, Scenario> {
    column("scenario", |s: &Scenario| s.scenario.clone())
}

/// Returns the offsets that the recordings have at an end.
fn offsets(s: &Scenario, end: End) -> Option<&EndOffsets> {
    s.ends
        .iter()
        .find(|e| (e.end, e.form) == (end, Form::Batch))
}

fn covered(s: &Scenario) -> Option<f64> {
    offsets(s, End::B).and_then(|e| e.coverage_share)
}

fn coverage(rows: &[Scenario]) -> String {
    let columns = [
        scenario(),
        loaded("RMSE (mrad)", |j| mrad(j.rmse_rad)),
        loaded("95 % CI (±, mrad)", |j| mrad(half_width(j))),
        loaded("coverage (%)", |j| percent(j.coverage_share)),
        column("coverage, all joints (%)", |s: &Scenario| {
            percent(covered(s))
        }),
        loaded("Cramér–Rao bound (mrad)", |j| mrad(j.bound_rad)),
        loaded("paper minus A (mrad)", |j| {
            fixed(j.paper_minus_baseline_rmse_rad, 1e3, 1)
        }),
    ];
    table(rows, &columns)
}

fn stress(rows: &[Scenario]) -> String {
    let one_decimal = |j: &Joint| {
        let half = half_width(j);
        fixed(half, 1e3, usize::from(half.is_some_and(|v| v < 9.95e-3)))
    };
    let columns = [
        scenario(),
        column("recordings", |s: &Scenario| s.recordings.to_string()),
        column("RMSE (mrad)", |s: &Scenario| {
            list(&s.joints, |j| two_digits(j.rmse_rad))
        }),
        column("95 % CI (±, mrad)", |s: &Scenario| {
            list(&s.joints, one_decimal)
        }),
        column("coverage (%)", |s: &Scenario| {
            list(&s.joints, |j| whole_percent(j.coverage_share))
        }),
    ];
    table(rows, &columns)
}

fn other_arms(rows: &[Scenario]) -> String {
    const ARMS: [(&str, &str); 4] = [
        ("arm4", "arm4, 2.9 kg"),
        ("ur5", "UR5, 17 kg"),
        ("panda", "Panda, 17 kg"),
        ("so101_new_calib", "SO-101, 0.5 kg"),
    ];
    let cell = |s: &Scenario| {
        let most =
            |of: fn(&Joint) -> Option<f64>| s.joints.iter().filter_map(of).fold(0.0, f64::max);
        let [rmse, half] = [most(|j| Some(j.rmse_rad)), most(half_width)].map(mrad);
        format!("{} %; {rmse} ± {half} mrad", fixed(covered(s), 100.0, 1))
    };
    let of = |name: &'static str| {
        column(name, move |(robot, _): &(&str, &str)| {
            let found = rows
                .iter()
                .find(|s| (s.robot.as_str(), s.scenario.as_str()) == (*robot, name));
            found.map_or("–".into(), cell)
        })
    };
    let label = column("arm", |(_, label): &(&str, &str)| (*label).into());
    table(&ARMS, &[label, of("S5"), of("S7"), of("S8")])
}

fn slips(rows: &[Scenario]) -> String {
    let of = |heading, cell: fn(&Slips) -> String| {
        column(heading, move |s: &Scenario| list(&s.slips, cell))
    };
    let alarms = |s: &Scenario| {
        let hours = s.exposure_s.map(|time_s| time_s / 3600.0);
        let alarms = s.false_alarms_per_hour.zip(hours).map(|(rate, h)| rate * h);
        format!("{} in {} h", fixed(alarms, 1.0, 0), fixed(hours, 1.0, 1))
    };
    let columns = [
        scenario(),
        of("detected (%)", |j| whole_percent(j.found_share)),
        of("RMSE (mrad)", |j| mrad(j.found_rmse_rad)),
        of("coverage of the time (%)", |j| {
            whole_percent(j.time_coverage_share)
        }),
        of("delay, median (s)", |j| fixed(j.delay_s, 1.0, 0)),
        of("delay, 90 % (s)", |j| fixed(j.delay_90_s, 1.0, 0)),
        column("false alarms", alarms),
    ];
    table(rows, &columns)
}

fn unmodelled(rows: &[Scenario]) -> String {
    const ERRORS: [(&str, &str); 7] = [
        ("U1", "viscoelastic rope, 4 %"),
        ("U3", "stiffness 8 % lower since the baseline"),
        ("U3b", "stiffness drops 8 %"),
        ("U4", "elbow axis misaligned by 1°"),
        ("U5", "motor encoder delayed by 50 ms"),
        ("U6", "gear ratio 2 % wrong"),
        ("U8", "elbow seized"),
    ];
    let label = |s: &Scenario| ERRORS.into_iter().find(|(name, _)| *name == s.scenario);
    let columns = [
        column("error", |s: &Scenario| {
            label(s).map_or(String::new(), |(name, error)| format!("{name}: {error}"))
        }),
        loaded("RMSE (mrad)", |j| mrad(j.rmse_rad)),
        loaded("coverage (%)", |j| whole_percent(j.coverage_share)),
        column("warned (%)", |s: &Scenario| {
            whole_percent(offsets(s, End::B).and_then(|e| e.warned_share))
        }),
    ];
    table(rows.iter().filter(|s| label(s).is_some()), &columns)
}

fn variants(rows: &[Scenario]) -> String {
    const VARIANTS: [(&str, &str); 9] = [
        ("no-torque", ""),
        ("force-lateral", ", 1 N"),
        ("creep-3", ", 3 mrad/min"),
        ("payload-heavy", ", 1 kg"),
        ("mass-25", ""),
        ("friction-3", ""),
        ("warmer-25", ", temperature not recorded"),
        ("bits-11", ""),
        ("standing", ""),
    ];
    let mut lines: Vec<(String, EndOffsets)> = Vec::new();
    for (name, more) in VARIANTS {
        let own = rows.iter().find(|s| s.scenario == name);
        let end = own.and_then(|s| offsets(s, End::B));
        lines.extend(end.map(|e| (format!("{name}{more}"), *e)));
    }
    for (end, more) in [(End::B, ""), (End::Chain, ", chained session")] {
        let name = format!("all {}{more}", rows.len());
        lines.extend(together(rows, end).map(|all| (name, all)));
    }
    type Line = (String, EndOffsets);
    let columns = [
        column("variant", |(name, _): &Line| name.clone()),
        column("coverage (%)", |(_, e): &Line| percent(e.coverage_share)),
        column("RMSE (mrad)", |(_, e): &Line| mrad(e.rmse_rad)),
        column("warned (%)", |(_, e): &Line| whole_percent(e.warned_share)),
        column("outside without a warning (%)", |(_, e): &Line| {
            percent(e.silent_share)
        }),
    ];
    table(&lines, &columns)
}

/// Pools all scenarios, with equal weight of each offset and each recording.
fn together(rows: &[Scenario], end: End) -> Option<EndOffsets> {
    let ends = rows
        .iter()
        .filter_map(|s| Some((offsets(s, end)?, s.recordings as f64)));
    let ends: Vec<(&EndOffsets, f64)> = ends.collect();
    let each = |of: fn(&EndOffsets) -> Option<f64>| {
        let pairs = ends.iter().map(|(e, _)| Some((e.offsets as f64, of(e)?)));
        pairs
            .collect::<Option<Vec<_>>>()
            .map(|pairs| weighted_mean(&pairs))
    };
    let warned = ends.iter().map(|(e, n)| Some((*n, e.warned_share?)));
    let warned = warned.collect::<Option<Vec<_>>>();
    Some(EndOffsets {
        offsets: ends.iter().map(|(e, _)| e.offsets).sum(),
        coverage_share: each(|e| e.coverage_share),
        rmse_rad: each(|e| e.rmse_rad.map(|v| v.powi(2))).map(f64::sqrt),
        warned_share: warned.map(|pairs| weighted_mean(&pairs)),
        silent_share: each(|e| e.silent_share),
        ..*ends.first()?.0
    })
}

/// Formats a table of quantities, with a column per item.
fn quantities<T>(heads: &[String], items: &[&T], lines: &[Column<'_, T>]) -> String {
    let value = |k: usize| {
        let item = items[k];
        column(heads[k].clone(), move |(_, cell): &Column<'_, T>| {
            cell(item)
        })
    };
    let name = column("quantity", |(name, _): &Column<'_, T>| name.clone());
    let columns: Vec<_> = std::iter::once(name)
        .chain((0..items.len()).map(value))
        .collect();
    table(lines, &columns)
}

/// All scenarios together, and all joints.
type Online<'a> = (&'a Trajectory, &'a JointTrajectory);

fn online(rows: &Rows) -> String {
    let Rows::Trajectories(rows) = rows else {
        return String::new();
    };
    // The last entry is that of all scenarios together.
    let all = rows.last().and_then(|all| Some((all, all.joints.first()?)));
    let seconds = |times: &[Option<f64>]| list(times, |t| format!("{} s", fixed(*t, 1.0, 1)));
    let lines = [
        column(
            "first useful answer, median and 90 %",
            |(_, j): &Online<'_>| seconds(&j.first_useful_s),
        ),
        column(
            "useful (covered, not provisional, ± at most 3 mrad)",
            |(_, j): &Online<'_>| format!("{} % of the time", percent(j.useful_share)),
        ),
        column("provisional without disturbance", |(_, j): &Online<'_>| {
            format!("{} %", percent(j.calm_provisional_share))
        }),
        column(
            "outside the interval and not provisional; beyond 3 σ",
            |(_, j): &Online<'_>| {
                format!(
                    "{} %; {} %",
                    percent(j.silent_share),
                    fixed(j.far_share, 100.0, 2)
                )
            },
        ),
        column(
            "unflagged time after a slip, median, 90 %, maximum",
            |(all, _): &Online<'_>| seconds(&all.slips.silent_s),
        ),
        column(
            "correct to 2 mrad after a slip, median and 90 %",
            |(all, _): &Online<'_>| seconds(&all.slips.right_s[..2]),
        ),
        column(
            "false changes (probability at least 0.9)",
            |(all, _): &Online<'_>| format!("{} per hour", fixed(all.false_changes_per_h, 1.0, 1)),
        ),
    ];
    let all: Vec<_> = all.iter().collect();
    quantities(&["value".into()], &all, &lines)
}

/// Forecasts with and without the rope.
type Years<'a> = (&'a Year, &'a Year);

fn years(measured: &[&Measurement]) -> String {
    let both: Vec<Years<'_>> = (measured.iter())
        .filter_map(|measurement| match &measurement.rows {
            Rows::Years(rows) => Some(rows),
            _ => None,
        })
        .filter_map(|rows| {
            let of = |who| rows.iter().find(|row| row.forecaster == who);
            of(Forecaster::Rope).zip(of(Forecaster::Generic))
        })
        .collect();
    let share = |share: Option<Share>| match share {
        Some(Share {
            mean,
            std: Some(std),
        }) if std >= 0.005 => {
            format!("{} ± {}", whole_percent(mean), whole_percent(std))
        }
        share => whole_percent(share.map(|s| s.mean)),
    };
    let each = |year: &Year, of: fn(&Forecasts) -> Option<f64>| {
        format!("{} %", list(&year.forecasts, |f| whole_percent(of(f))))
    };
    let days = both.first().map_or(String::new(), |(year, _)| {
        list(&year.forecasts, |f| fixed(f.made_day, 1.0, 0))
    });
    let lines = [
        column("failures detected within two days", |(y, _): &Years<'_>| {
            format!("{} of {}", y.found_two_days, y.failures)
        }),
        column("false alarms per robot and year", |(y, _): &Years<'_>| {
            format!("{}", y.false_alarms_per_robot_year)
        }),
        column(
            "RMS error of the trend; mean 95 % CI (±)",
            |(y, _): &Years<'_>| {
                let half = two_digits(y.half_width_95_rad);
                format!("{}; {half} mrad", two_digits(y.tracking_rms_rad))
            },
        ),
        column("coverage before a failure; after", |(y, _): &Years<'_>| {
            format!("{}; {} %", share(y.covered_95), share(y.failed_covered_95))
        }),
        column(
            format!("median error of the day of the limit, on day {days}"),
            |(y, _): &Years<'_>| each(y, |f| f.error_of_day_ratio),
        ),
        column(
            "coverage of the 90 % interval of that day",
            |(y, _): &Years<'_>| each(y, |f| Some(f.covered_90.mean)),
        ),
        column(
            "the same, rope not named in robot.toml",
            |(_, y): &Years<'_>| each(y, |f| Some(f.covered_90.mean)),
        ),
    ];
    let heads: Vec<String> = (["check", "work"].iter().zip(&both))
        .map(|(kind, (y, _))| format!("`{kind}`, {} robots", y.robots))
        .collect();
    quantities(&heads, &both.iter().collect::<Vec<_>>(), &lines)
}

fn extrapolation(rows: &[Extrapolation]) -> String {
    let day = |k: usize, day: f64| {
        column(
            format!("day {day}: coverage, median error, CI"),
            move |e: &Extrapolation| {
                e.days.get(k).map_or("–".into(), |d| {
                    let [error, half] = [d.median_error_rad, d.half_width_95_rad].map(two_digits);
                    format!(
                        "{} %, {error} ± {half} mrad",
                        whole_percent(d.coverage_share)
                    )
                })
            },
        )
    };
    let days = rows.first().map_or(&[][..], |e| &e.days);
    let mut columns = vec![column("prior", |e: &Extrapolation| e.prior.label().into())];
    columns.extend(days.iter().enumerate().map(|(k, d)| day(k, d.day)));
    table(rows, &columns)
}

fn creep_fits(rows: &[Coverage]) -> String {
    let law = |c: &Coverage| match c.forecaster {
        sinew_creep::Forecaster::Combined => "all, AICc weights".into(),
        law => law.name().into(),
    };
    let columns = [
        column("law", law),
        column("tests", |c: &Coverage| c.tests.to_string()),
        column("measurements covered (%)", |c: &Coverage| {
            percent(c.readings_share())
        }),
        column("last measurement covered (%)", |c: &Coverage| {
            percent(c.ends_share())
        }),
        column("median error at the end (% of creep)", |c: &Coverage| {
            fixed(c.end_error_ratio, 100.0, 1)
        }),
        column("CI (±)", |c: &Coverage| {
            fixed(c.end_half_width_ratio, 100.0, 1)
        }),
    ];
    table(rows, &columns)
}
