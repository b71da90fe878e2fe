//! Relaxation of twenty strung tendons against SciPy; written by `benches/peers/relaxation.py --fixture`.

use serde_json::Value;
use sinew_rope::Catalogue;
use sinew_rope::law::routing::Pulley;
use sinew_rope::predict::YEAR_S;
use sinew_rope::pretension::{HeldJoint, Mount, Request, plan};

/// Relative tolerance: SciPy integrates at 1e-9 per step and interpolates each re-tensioning; both errors
/// together stay below this.
const MAX_REL_ERROR: f64 = 1e-4;

fn close(what: &str, found: f64, expected: f64) {
    let off = (found / expected - 1.0).abs();
    assert!(off < MAX_REL_ERROR, "{what}: {found}, SciPy {expected}");
}

#[test]
fn strung_tendons_relax_as_scipy_reference() {
    let cases: Vec<Value> = serde_json::from_str(include_str!("relaxation.json")).expect("JSON");
    let catalogue = Catalogue::shipped().expect("shipped");
    for case in &cases {
        let number = |key: &str| case[key].as_f64().expect("a number");
        let name = case["rope"].as_str().expect("a name");
        let guide = |g: &Value| Pulley {
            wrap_rad: g[0].as_f64().expect("degrees").to_radians(),
            radius_m: g[1].as_f64().expect("m"),
            at_m: g[2].as_f64().expect("m"),
            friction: None,
        };
        let guides = case["guides"].as_array().expect("a list");
        let joint = case["joint"].as_object().map(|j| HeldJoint {
            slides: false,
            radius_m: j["radius_m"].as_f64().expect("m"),
            torque_nm: j["torque_nm"].as_f64().expect("N·m"),
        });
        let request = Request {
            tension_n: number("tension_n"),
            temperature_c: number("celsius"),
            length_m: number("length_m"),
            mount: Mount {
                series_compliance_m_per_n: number("series_compliance_m_per_n"),
                pulleys: guides.iter().map(guide).collect(),
                joint,
            },
            horizon_s: YEAR_S,
            lowest_n: number("lowest_n"),
            remove: 0.8,
            draws: 0,
            seed: 1,
        };
        let plan = plan(catalogue.find(name).expect("there"), &request).expect("a plan");
        let (found, expected) = (plan.schedule_as_delivered, &case["expected"]);
        let end = expected["tension_at_end_n"].as_f64().expect("N");
        close(name, found.tension_at_end_n.value, end);
        let events = expected["events_s"].as_array().expect("a list");
        assert_eq!(found.times_s.len(), events.len(), "{name}");
        for (found, expected) in found.times_s.iter().zip(events) {
            close(name, *found, expected.as_f64().expect("s"));
        }
        if let (Some(sag), Some(joint)) = (expected["sag_m"].as_f64(), joint) {
            let found = found.unattended.sag_rad.last().expect("a sag");
            close(name, found * joint.radius_m, sag);
        }
    }
}
