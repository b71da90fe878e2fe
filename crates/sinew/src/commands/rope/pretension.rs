//! `sinew rope pretension`.

use super::values::{celsius, duration, millimetres, newtons_above_zero, share};
use super::{Ropes, find};
use crate::files::check_outputs;
use crate::terminal::{Failure, Finish, answer};
use crate::text::{indented, paragraph, plain, table};
use clap::Args;
use sinew_figure::rounded;
use sinew_files::{JsonDocument, write_file};
use sinew_report::rope::{bracketed, caution, planned, spoken};
use sinew_rope::pretension::{self, Plan, Request, Schedule};
use std::path::PathBuf;

/// How much pretension, how to bed a rope in, and when to tension it again
///
/// Two pictures of the same rope: under constant tension it grows, and a bedding-in procedure
/// takes most of that away beforehand; at constant length its tension falls, and the schedule
/// says when it is below --lowest.
#[derive(Debug, Args)]
#[command(
    after_help = "Example:\n  sinew rope pretension liros-dc000-0301 --tension 60 --length 700"
)]
pub(crate) struct Pretension {
    /// Rope
    name: String,
    /// Working tension, N
    #[arg(long, value_name = "N", value_parser = newtons_above_zero)]
    tension: f64,
    /// Tension below which it is tensioned again, N [default: 80 % of the working tension]
    #[arg(long, value_name = "N", value_parser = newtons_above_zero)]
    lowest: Option<f64>,
    /// Temperature, °C
    #[arg(long, value_name = "C", default_value = "23", value_parser = celsius, allow_negative_numbers = true)]
    temperature: f64,
    /// Length of the strand, mm
    #[arg(long, value_name = "MM", default_value = "1000", value_parser = millimetres)]
    length: f64,
    /// How long it must hold
    #[arg(long, value_name = "TIME", default_value = "1year", value_parser = duration)]
    horizon: f64,
    /// Share of the later elongation that the procedure must take away
    #[arg(long, value_name = "SHARE", default_value = "0.8", value_parser = share)]
    remove: f64,
    /// Draws of the rope's parameters for the intervals
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = clap::value_parser!(u32).range(20..=100_000))]
    draws: u32,
    /// Seed of the draws
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// HTML page
    #[arg(long, value_name = "FILE")]
    report: Option<PathBuf>,
    #[command(flatten)]
    ropes: Ropes,
    /// Print one JSON document instead of the tables
    #[arg(long)]
    json: bool,
}

impl Pretension {
    pub(super) fn run(&self) -> Result<Finish, Failure> {
        if let Some(path) = &self.report {
            check_outputs(&[("--report", path)], &[])?;
        }
        let catalogue = self.ropes.catalogue()?;
        let rope = find(&catalogue, &self.name)?;
        let lowest_n = self.lowest.unwrap_or(0.8 * self.tension);
        if lowest_n >= self.tension {
            return Err(Failure::Refused(format!(
                "--lowest {lowest_n} N must be below --tension {} N",
                self.tension
            )));
        }
        let plan = pretension::plan(
            rope,
            &Request {
                tension_n: self.tension,
                temperature_c: self.temperature,
                length_m: 1e-3 * self.length,
                horizon_s: self.horizon,
                lowest_n,
                remove: self.remove,
                draws: self.draws as usize,
                seed: self.seed,
            },
        )?;
        if let Some(path) = &self.report {
            write_file(path, planned(&plan).html().as_bytes())?;
        }
        if self.json {
            answer(&plan.to_json()?)?;
        } else {
            answer(&text(&plan))?;
        }
        Ok(Finish::Complete)
    }
}

fn text(p: &Plan) -> String {
    let mut out = paragraph(
        &plain(&format!(
            "{}: {} N at {} °C, strand of {} mm, for {}",
            p.rope,
            rounded(p.tension_n, 3),
            rounded(p.temperature_c, 3),
            rounded(1e3 * p.length_m, 4),
            spoken(p.horizon_s)
        )),
        2,
    );
    out.push_str(&paragraph(
        &format!(
            "at constant tension it grows by {} mm from a minute after tensioning",
            bracketed(p.without_m.scaled(1e3), 2)
        ),
        2,
    ));
    out.push_str("\nbedding-in: hold the rope at a tension for a time, then go back\n");
    let head = [
        "",
        "for",
        "hold at\nN",
        "still to come\nmm",
        "taken away\n%",
    ];
    let rows = p
        .procedures
        .iter()
        .enumerate()
        .map(|(i, q)| {
            let mark = if p.chosen == Some(i) { "*" } else { "" };
            vec![
                mark.into(),
                spoken(q.duration_s),
                rounded(q.tension_n, 3),
                bracketed(q.still_to_come_m.scaled(1e3), 2),
                bracketed(q.removed_share.scaled(100.0), 2),
            ]
        })
        .collect();
    out.push_str(&table(&head, rows, 2));
    let percent = rounded(100.0 * p.remove_share, 2);
    out.push_str(&paragraph(
        &match p.chosen {
            Some(i) => format!(
                "* the gentlest that does: {} N for {} takes {percent} % or more away",
                rounded(p.procedures[i].tension_n, 3),
                spoken(p.procedures[i].duration_s)
            ),
            None => format!("none of these takes {percent} % away; the best one is used below"),
        },
        2,
    ));
    out.push_str(&format!(
        "\nstrung at working tension, a minute to settle, then at constant length (nothing\nelse in the machine gives); tensioned again at {} N\n",
        rounded(p.lowest_n, 3)
    ));
    for (word, s) in [
        ("as it comes", &p.schedule_new),
        ("bedded in", &p.schedule_bedded),
    ] {
        out.push_str(&indented(&schedule(word, s, p), 2, 4));
    }
    out.push('\n');
    let text = format!(
        "{} of {} parameters are starting guesses; brackets are 95 % intervals",
        p.starting_guesses, p.parameters
    );
    out.push_str(&paragraph(&text, 2));
    for what in &p.cautions {
        out.push_str(&paragraph(&format!("warning: {}", caution(*what)), 2));
    }
    out
}

fn schedule(word: &str, s: &Schedule, p: &Plan) -> String {
    const SHOWN: usize = 8;
    let mut text = if s.times_s.is_empty() {
        format!("{word}: no re-tensioning needed")
    } else {
        let times: Vec<String> = s.times_s.iter().take(SHOWN).map(|t| spoken(*t)).collect();
        let more = s.times_s.len().saturating_sub(SHOWN);
        let more = if more > 0 {
            format!(" and {more} more")
        } else {
            String::new()
        };
        format!("{word}: re-tension after {}{more}", times.join(", "))
    };
    text += &format!(
        "; {} times (95 %: {} to {}), none in {:.0} % of the draws; left alone it ends at {} N",
        s.count.value,
        rounded(s.count.low, 2),
        rounded(s.count.high, 2),
        100.0 * s.never_share,
        bracketed(s.tension_at_end_n, 2),
    );
    match s.start_n {
        Some(start) => {
            text += &format!(
                "; strung at {} N it never falls below {} N",
                bracketed(start, 3),
                rounded(p.lowest_n, 3)
            );
        }
        None => text += "; no pretension up to 40 % of the breaking load would hold it",
    }
    text
}
