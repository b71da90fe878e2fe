//! Rope predictions, selections and pretension plans as text and HTML reports.

mod bench;
mod catalogue;
mod choice;
pub(crate) mod life;
pub(crate) mod messages;
mod planned;
mod predicted;
mod route_map;
mod selected;
mod series;

pub use bench::{bench_csv, bench_figure, bench_table};
pub use catalogue::{catalogue_table, rope_table};
pub use choice::figure;
pub(crate) use messages::caution_message;
pub use messages::{caution, namesake, rejection, unreadable};
pub use planned::{plan_table, planned};
pub use predicted::{predicted, prediction_table};
pub use selected::{selected, selection_table};
pub use series::{curve_times, prediction_series};

use crate::text::sentence;
use sinew_figure::{Block, Page, rounded};
use sinew_model::Bounded;
use sinew_rope::Caution;
use sinew_rope::predict::{DAY_S, HOUR_S, MONTH_S, YEAR_S};

/// Formats a duration in a suitable unit, `8 h` or `1 year`.
pub fn spoken(s: f64) -> String {
    let whole = |v: f64, unit: &str| {
        let rounded = (10.0 * v).round() / 10.0;
        // Abbreviations have no plural.
        let plural = if rounded == 1.0 || ["s", "min", "h"].contains(&unit) {
            ""
        } else {
            "s"
        };
        format!("{rounded} {unit}{plural}")
    };
    if !s.is_finite() {
        "–".into()
    } else if s < 90.0 {
        whole(s, "s")
    } else if s < 0.99 * HOUR_S {
        whole(s / 60.0, "min")
    } else if s < 0.99 * DAY_S {
        whole(s / HOUR_S, "h")
    } else if s < 0.99 * MONTH_S {
        whole(s / DAY_S, "day")
    } else if s < 0.99 * YEAR_S {
        whole(s / MONTH_S, "month")
    } else {
        whole(s / YEAR_S, "year")
    }
}

/// Formats a value with its interval, `0.42 (0.31 to 0.58)`.
pub fn bracketed(i: Bounded, digits: u8) -> String {
    format!(
        "{} ({} to {})",
        rounded(i.value, digits),
        rounded(i.low, digits),
        rounded(i.high, digits)
    )
}

/// Formats a share of draws, which is never a probability of 0 or 1.
pub(crate) fn share_of_draws(share: f64) -> String {
    match 100.0 * share {
        percent if !percent.is_finite() => "–".into(),
        percent if percent < 1.0 => "< 1 %".into(),
        percent if percent > 99.0 => "> 99 %".into(),
        percent => format!("{percent:.0} %"),
    }
}

fn notices(cautions: &[Caution]) -> impl Iterator<Item = Block> + '_ {
    let cautions = cautions.iter();
    cautions.map(|c| Block::Notice(sentence(&caution(*c))))
}

fn page(title: String, subtitle: String) -> Page {
    Page {
        subtitle,
        footer: format!("Sinew {}", env!("CARGO_PKG_VERSION")),
        ..Page::new(title)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_rope::predict::{Request, Route, TIMES_DEFAULT_S, predict};
    use sinew_rope::select::Constraints;
    use sinew_rope::{Catalogue, Duty, pretension, select};

    fn request() -> Request {
        Request {
            duty: Duty::constant(60.0, 23.0),
            route: Route::straight(0.7),
            times_s: TIMES_DEFAULT_S.to_vec(),
            read_at: None,
            draws: 20,
            seed: 1,
        }
    }

    #[test]
    fn share_of_draws_is_never_certain() {
        let shares = [0.0, 0.005, 0.12, 0.995, 1.0].map(share_of_draws);
        assert_eq!(shares, ["< 1 %", "< 1 %", "12 %", "> 99 %", "> 99 %"]);
    }

    #[test]
    fn pages_contain_values_of_tables() {
        let catalogue = Catalogue::shipped().expect("shipped");
        let rope = catalogue.find("liros-dc000-0301").expect("there");
        let p = predict(rope, &request()).expect("a prediction");
        let more = Request {
            times_s: curve_times(&TIMES_DEFAULT_S, 10.0),
            ..request()
        };
        let curve = predict(rope, &more).expect("a prediction").readings;
        // The curve is denser than the table and contains its values.
        assert!(curve.len() > 25, "{} times", curve.len());
        for r in &p.readings {
            let on = curve.iter().find(|c| c.time_s == r.time_s).expect("on it");
            let (a, b) = (on.since_tensioned_m.value, r.since_tensioned_m.value);
            assert!((a - b).abs() < 1e-9, "{a} {b}");
        }
        let text = predicted(&p, &curve).html();
        let last = p.readings.last().expect("readings").since_tensioned_m;
        for words in [
            bracketed(last.scaled(1e3), 2).as_str(),
            "after 1 year",
            "<svg",
            "parameters assumed",
        ] {
            assert!(text.contains(words), "{words}");
        }
        let limits = Constraints {
            diameter_max_mm: Some(1.9),
            ..Constraints::default()
        };
        let s = select::select(&catalogue, &request(), &limits).expect("a choice");
        let text = selected(&s, &limits).html();
        for words in [
            "maximum diameter",
            "1.9 mm",
            "diameter above the limit of 1.9 mm (2.00 mm)",
            "<svg",
        ] {
            assert!(text.contains(words), "{words}");
        }
        let requested = pretension::Request {
            tension_n: 60.0,
            temperature_c: 23.0,
            length_m: 0.7,
            mount: pretension::Mount::default(),
            horizon_s: YEAR_S,
            lowest_n: 48.0,
            remove: 0.8,
            draws: 20,
            seed: 1,
        };
        let plan = pretension::plan(rope, &requested).expect("a plan");
        let text = planned(&plan).html();
        for words in [
            "Hold 60.0 N for 1 h",
            "as delivered",
            "preconditioned",
            "<svg",
        ] {
            assert!(text.contains(words), "{words}");
        }
    }
}
