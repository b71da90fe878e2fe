//! Estimate over time as a table.

use crate::data::Data;
use sinew_estimate::EstimateDocument;
use sinew_estimate::replay::{Estimate, JointEstimate, Series};
use sinew_estimate::session::TendonEstimate;
use sinew_log::Table;
use sinew_model::Gaussian;

/// Earliest time stamp that is accepted as a date: the year 2000, ns since 1970.
const MIN_DATE_NS: i64 = 946_684_800_000_000_000;

/// Name of the absolute method in tables.
pub(crate) const ABSOLUTE: &str = "absolute";
/// Name of the uncorrected (paper) method in tables.
pub(crate) const PAPER: &str = "paper";

/// Time in the clock of the recording, ns.
pub(crate) fn time_ns(reading: &Estimate, time_s: f64) -> i64 {
    reading.recording.start_time_ns + (1e9 * time_s).round() as i64
}

/// Time since 1970 UTC, ns; `None` if the clock of the recording has no date.
fn time_utc_ns(reading: &Estimate, time_s: f64) -> Option<i64> {
    Some(time_ns(reading, time_s)).filter(|ns| *ns > MIN_DATE_NS)
}

/// Value of another quantity of the same tendon per rad of offset.
pub(crate) fn per_rad(of: Option<Gaussian>, offset_rad: Gaussian) -> Option<f64> {
    of.map(|of| of.std / offset_rad.std)
}

/// Tabulates the estimate over time, one row per method, joint and time.
///
/// `method` is `absolute` (every 0.2 s), `online` (online estimate, with `--online`), or `paper` (uncorrected, at most
/// [`Series::POINTS`](sinew_estimate::replay::Series::POINTS) intervals). `time_s` counts from the start of the recording.
/// The uncorrected estimate has no standard deviation; that of a provisional online estimate is large.
pub fn estimate_series(document: &EstimateDocument) -> Table {
    let reading = &document.reading;
    Data::of(rows(document))
        .text("method", |r| r.method)
        .text("joint", |r| r.joint)
        .number("time_s", |r| r.time_s)
        .integer("time_utc_ns", |r| time_utc_ns(reading, r.time_s))
        .number("offset_rad", |r| r.offset_rad.mean)
        .number("offset_std_rad", |r| r.std(Some(1.0)))
        .number("elongation_m", |r| {
            r.m_per_rad.map(|factor| factor * r.offset_rad.mean)
        })
        .number("elongation_std_m", |r| r.std(r.m_per_rad))
        .number("strain_ratio", |r| {
            r.strain_per_rad.map(|factor| factor * r.offset_rad.mean)
        })
        .number("block_offset_rad", |r| r.block_rad)
        .number("block_weight", |r| r.weight)
        .number("offset_min_rad", |r| r.of_series(|s| &s.offset_min_rad))
        .number("offset_max_rad", |r| r.of_series(|s| &s.offset_max_rad))
        .number("tau_el_nm", |r| r.of_series(|s| &s.tau_el_nm))
        .number("usable_share", |r| r.of_series(|s| &s.usable_share))
        .table()
}

/// Iterates over the estimates of all methods, joints and times.
pub(crate) fn rows(document: &EstimateDocument) -> impl Iterator<Item = Row<'_>> {
    let reading = &document.reading;
    let session = document.session.as_ref();
    let absolute = session.into_iter().flat_map(|session| {
        let joints = session.joints.iter().enumerate();
        joints.flat_map(move |(at, joint)| {
            session.blocks.iter().map(move |block| Row {
                block_rad: Some(block.block_rad[at]),
                ..Row::with_interval(
                    ABSOLUTE,
                    joint,
                    block.time_s,
                    block.offset_rad[at],
                    block.weight,
                )
            })
        })
    });
    let online = session.into_iter().flat_map(|session| {
        // Tendons with friction along their path have no online estimate.
        let names = session.online.iter().flat_map(|online| &online.joints);
        let joints = names.enumerate().filter_map(move |(at, now)| {
            let mut all = session.joints.iter();
            Some((at, all.find(|joint| joint.name == now.name)?))
        });
        joints.flat_map(move |(at, joint)| {
            let blocks = session.online.iter().flat_map(|online| &online.blocks);
            blocks.map(move |block| {
                Row::with_interval(
                    "online",
                    joint,
                    block.time_s,
                    block.offset_rad[at],
                    block.weight,
                )
            })
        })
    });
    let paper = reading.joints.iter().flat_map(|joint| {
        let times = 0..joint.series.time_s.len();
        times.map(move |k| Row::paper(joint, k))
    });
    absolute.chain(online).chain(paper)
}

/// Estimate of a joint at one time by one method.
pub(crate) struct Row<'a> {
    pub(crate) method: &'static str,
    pub(crate) joint: &'a str,
    pub(crate) time_s: f64,
    /// Offset; the standard deviation of an uncorrected estimate is NaN.
    pub(crate) offset_rad: Gaussian,
    pub(crate) m_per_rad: Option<f64>,
    pub(crate) strain_per_rad: Option<f64>,
    block_rad: Option<f64>,
    weight: Option<f64>,
    /// Series of the uncorrected estimate and the index in it.
    series: Option<(&'a Series, usize)>,
}

impl<'a> Row<'a> {
    /// Makes a row with an interval.
    fn with_interval(
        method: &'static str,
        joint: &'a TendonEstimate,
        time_s: f64,
        offset_rad: Gaussian,
        weight: f64,
    ) -> Self {
        Self {
            method,
            joint: &joint.name,
            time_s,
            offset_rad,
            m_per_rad: per_rad(joint.elongation_m, joint.offset_rad),
            strain_per_rad: per_rad(joint.strain_ratio, joint.offset_rad),
            block_rad: None,
            weight: Some(weight),
            series: None,
        }
    }

    fn paper(joint: &'a JointEstimate, k: usize) -> Self {
        let factor = |of: Option<f64>| Some(of? / joint.offset_rad.filter(|x| *x != 0.0)?);
        let series = &joint.series;
        Self {
            method: PAPER,
            joint: &joint.name,
            time_s: series.time_s[k],
            offset_rad: Gaussian::new(series.offset_rad[k], f64::NAN),
            m_per_rad: factor(joint.elongation_m),
            strain_per_rad: factor(joint.strain_ratio),
            block_rad: None,
            weight: None,
            series: Some((series, k)),
        }
    }

    /// Standard deviation of the offset, scaled by `factor`.
    fn std(&self, factor: Option<f64>) -> Option<f64> {
        let scaled = self.offset_rad.scaled(factor?);
        self.series.is_none().then_some(scaled.std)
    }

    fn of_series(&self, of: fn(&Series) -> &Vec<f64>) -> Option<f64> {
        self.series.map(|(series, k)| of(series)[k])
    }
}
