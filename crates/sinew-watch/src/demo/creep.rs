//! How the demonstration's ropes creep: the rope law, under what they carry.

use sinew_model::transmission::Tendon;
use sinew_rope::Catalogue;
use sinew_rope::law::{Law, RopeLoad, State};

/// What the ropes carry on average, over their pretension.
const WORK: f64 = 2.0;
/// Temperature of the ropes beside the motors, °C.
const CELSIUS: f64 = 28.0;
/// Creep is looked up in a table with so many points to a decade of time.
const PER_DECADE: usize = 24;
/// From an hour on: what is younger has crept before the baseline.
const FIRST_S: f64 = 3600.0;
/// Up to some thirty years.
const DECADES: usize = 6;

/// Offset of a tendon over time since it was tensioned.
#[derive(Debug, Clone)]
pub struct Creep {
    /// At times that rise by a constant factor, rad.
    table: Vec<f64>,
}

impl Creep {
    /// Of a tendon; `None`: its rope isn't in the catalogue.
    pub fn of(tendon: &Tendon, catalogue: &Catalogue) -> Option<Self> {
        let rope = catalogue.find(tendon.rope.as_deref()?).ok()?;
        let law = Law::new(rope.entry.parameters().ok()?).ok()?;
        let load = RopeLoad::celsius(WORK * tendon.pretension_n?, CELSIUS);
        let mut state = State::default();
        let mut table = Vec::with_capacity(DECADES * PER_DECADE + 1);
        let (mut time_s, mut first) = (0.0, None);
        for i in 0..=DECADES * PER_DECADE {
            let next_s = FIRST_S * 10_f64.powf(i as f64 / PER_DECADE as f64);
            law.hold(&mut state, load, next_s - time_s).ok()?;
            time_s = next_s;
            let percent = law.strain(&state, load).ok()?.total_percent();
            let since = percent - *first.get_or_insert(percent);
            table.push(0.01 * since * tendon.length_m / tendon.joint_pulley_radius_m);
        }
        Some(Self { table })
    }

    /// Offset so long after the tensioning, rad.
    pub fn offset_rad(&self, since_s: f64) -> f64 {
        let at = PER_DECADE as f64 * (since_s / FIRST_S).max(1.0).log10();
        let below = (at.floor() as usize).min(self.table.len().saturating_sub(2));
        let [a, b] = [below, below + 1].map(|i| self.table.get(i).copied().unwrap_or(0.0));
        a + (b - a) * (at - below as f64).clamp(0.0, 1.0)
    }
}
