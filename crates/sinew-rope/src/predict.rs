//! Prediction of the elongation of a rope after an hour, a day, a month and a year of a duty.

use super::CatalogueRope;
use super::drawn::drawn;
pub use super::predict_error::PredictError;
pub use super::prediction::{PredictedElongation, Prediction, PulleyPlace};
pub use super::route::{Guide, Request, Route};
pub use super::times::{DAY_S, HOUR_S, MONTH_S, TENSIONED_AFTER_S, TIMES_DEFAULT_S, YEAR_S};

/// Predicts the elongation of a strand of one rope.
///
/// The strand is divided into sections by its guiding pulleys; each is subject to the duty with its own number of
/// passes and its own tension ratio. Draws in which the rope breaks are counted, and the intervals contain their
/// elongation at the break.
///
/// # Errors
/// Returns [`PredictError`] if the rope has no complete law, or cannot carry the duty.
pub fn predict(rope: &CatalogueRope, request: &Request) -> Result<Prediction, PredictError> {
    predict_with_progress(rope, request, &|_| {})
}

/// [`predict`] with a call of `done` after each draw, with how many are done; not in order, from several threads.
///
/// # Errors
/// [`PredictError`].
pub fn predict_with_progress(
    rope: &CatalogueRope,
    request: &Request,
    done: &(dyn Fn(usize) + Sync),
) -> Result<Prediction, PredictError> {
    Ok(drawn(rope, request, done)?.prediction(rope, request))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::caution::Caution;
    use crate::draws::Draws;
    use crate::law::routing::Pulley;
    use crate::law::tested_range::Extrapolation;
    use crate::law::{RopeLoad, State};
    use crate::{Catalogue, Duty};

    fn request(duty: Duty, route: Route) -> Request {
        Request {
            duty,
            route,
            times_s: TIMES_DEFAULT_S.to_vec(),
            read_at: None,
            draws: 200,
            seed: 1,
        }
    }

    #[test]
    fn constant_duty_matches_creep_law() {
        let catalogue = Catalogue::shipped().expect("shipped");
        let rope = catalogue.find("liros-dc000-0301").expect("there");
        let asked = request(Duty::constant(60.0, 23.0), Route::straight(0.7));
        let found = predict(rope, &asked).expect("a prediction");
        let law = Draws::new(rope, 0, 1).expect("complete").nominal;
        for reading in &found.readings {
            let mut s = State::default();
            let load = RopeLoad::at_reference(60.0);
            law.hold(&mut s, load, reading.time_s).expect("load");
            let strain = law.strain(&s, load).expect("load");
            let i = reading.strain_ratio.scaled(100.0);
            assert!((i.value - strain.total_percent()).abs() < 1e-9);
            assert!(i.low < i.value && i.value < i.high, "{i:?}");
            assert!((1e3 * reading.elongation_m.value - 7.0 * i.value).abs() < 1e-12);
        }
        // The bench's tests, not those of the paper.
        let tests_s = 4.0 * 3600.0;
        assert!(found.cautions.contains(&Caution::Extrapolated { tests_s }));
    }

    #[test]
    fn prediction_of_broken_or_melted_rope_is_error() {
        let catalogue = Catalogue::shipped().expect("shipped");
        let rope = catalogue.find("liros-dc000-0301").expect("there");
        let error = |n: f64, celsius: f64, stroke_m: f64| {
            let mut asked = request(Duty::constant(n, celsius), Route::straight(0.7));
            asked.route.stroke_m = stroke_m;
            predict(rope, &asked)
                .expect_err("no rope is left")
                .to_string()
        };
        let broken = error(4449.0, 23.0, 0.0);
        assert!(
            broken.contains("4449 N") && broken.contains("breaks"),
            "{broken}"
        );
        assert!(error(60.0, 200.0, 0.0).contains("melts at 144 °C"));
        let out = error(60.0, 23.0, 0.7);
        assert!(
            out.contains("700 mm is not shorter than the strand"),
            "{out}"
        );
        let aramid = catalogue.find("tu-chemnitz-technora-black").expect("there");
        let hot = request(Duty::constant(60.0, 160.0), Route::straight(0.7));
        let hot = predict(aramid, &hot).expect("aramid does not melt there");
        // The assumed flow takes it beyond 10 % within a year.
        let apart = |c: &Caution| matches!(c, Caution::CreepsApart { time_s } if (MONTH_S..YEAR_S).contains(time_s));
        assert_eq!(
            (hot.readings.len(), hot.cautions.iter().any(apart)),
            (3, true)
        );
    }

    #[test]
    fn intervals_widen_beyond_the_data_in_time_load_and_temperature() {
        let catalogue = Catalogue::shipped().expect("shipped");
        let rope = catalogue.find("ockert-climax-combat").expect("there");
        let found = |n: f64, celsius: f64| {
            let asked = request(Duty::constant(n, celsius), Route::straight(0.7));
            predict(rope, &asked).expect("a prediction")
        };
        // How many times the lower bound the upper one is.
        let width = |p: &Prediction, i: usize| {
            let growth = p.readings[i].since_tensioned_m;
            growth.high / growth.low
        };
        let tested = found(60.0, 23.0);
        assert_eq!(tested.extrapolation, Extrapolation::default());
        // An hour lies within the 85 min of the data; a month and a year are 2.7 and 3.8 decades more.
        let [hour, month, year] = [0, 2, 3].map(|i| width(&tested, i));
        assert!(
            month > 1.5 * hour && year > 1.1 * month,
            "{hour} {month} {year}"
        );
        let data = |c: &Caution| matches!(c, Caution::BeyondData { .. });
        assert!(tested.cautions.iter().any(data));
        let loaded = found(600.0, 23.0);
        assert!(
            width(&loaded, 0) > 1.5 * hour,
            "{} {hour}",
            width(&loaded, 0)
        );
        let warm = found(60.0, 43.0);
        assert!(width(&warm, 0) > 1.5 * hour, "{} {hour}", width(&warm, 0));
        // The middle is the law's own answer, as it was.
        let law = Draws::new(rope, 0, 1).expect("complete").nominal;
        let mut state = State::default();
        let load = RopeLoad::at_reference(600.0);
        law.hold(&mut state, load, YEAR_S).expect("load");
        let own = law.strain(&state, load).expect("load").total_percent();
        assert!((100.0 * loaded.readings[3].strain_ratio.value - own).abs() < 1e-9);
    }

    #[test]
    fn guiding_pulleys_stretch_what_passes_them() {
        let catalogue = Catalogue::shipped().expect("shipped");
        let rope = catalogue.find("liros-dc000-0301").expect("there");
        let pulley = |at_m| Pulley {
            at_m,
            radius_m: 0.008,
            wrap_rad: 1.0,
            friction: None,
        };
        let duty = Duty::constant(100.0, 23.0);
        let bare = predict(rope, &request(duty.clone(), Route::straight(0.7))).expect("bare");
        let mut route = Route::straight(0.7);
        route.stroke_m = 0.1;
        route.pulleys = vec![pulley(0.2), pulley(0.5)];
        // 1e5 passes a year, of 2.6e5 survived.
        route.strokes_per_hour = 6.0;
        let led = predict(rope, &request(duty, route)).expect("led");
        let growth = |p: &Prediction| 100.0 * p.readings[3].strain_ratio.value;
        assert!(growth(&led) > growth(&bare) + 0.01);
        let strength = led.strength_left_share.expect("bending was asked for");
        assert!(strength.low <= strength.value && strength.value <= strength.high);
        assert!(bare.strength_left_share.is_none());
    }

    #[test]
    fn overload_is_error_and_possible_break_is_counted() {
        let catalogue = Catalogue::shipped().expect("shipped");
        let technora = catalogue.find("tu-chemnitz-technora-black").expect("there");
        let ask = |n: f64| {
            predict(
                technora,
                &request(Duty::constant(n, 23.0), Route::straight(0.7)),
            )
        };
        let error = ask(5000.0)
            .expect_err("above the breaking load")
            .to_string();
        assert!(
            error.contains("exceeds the breaking load of 4500 N"),
            "{error}"
        );
        let close = ask(4300.0).expect("below");
        assert!(
            close.broken_share > 0.05 && close.broken_share < 0.6,
            "{}",
            close.broken_share
        );
        let assumed = |c: &Caution| matches!(c, Caution::BreakingLoadAssumed { .. });
        assert!(close.cautions.iter().any(assumed));
    }
}
