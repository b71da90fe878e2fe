//! Contacts of the environment with the arm over time.

use super::plant::PointForce;
use super::scenario::{Contact, RandomContacts, normal};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

/// Contacts of a recording in order of time: those by the clock, and those by chance.
#[derive(Debug, Clone)]
pub struct Contacts {
    scheduled: Vec<Contact>,
    random: Option<RandomContacts>,
    rng: ChaCha8Rng,
    /// Present or next random contact.
    next: Option<Contact>,
    /// Everything that has begun, for the truth file.
    pub begun: Vec<Contact>,
}

impl Contacts {
    pub fn new(scheduled: &[Contact], random: Option<&RandomContacts>, rng: ChaCha8Rng) -> Self {
        let mut scheduled = scheduled.to_vec();
        scheduled.sort_by(|a, b| a.start_s.total_cmp(&b.start_s));
        let mut contacts = Self {
            begun: Vec::new(),
            scheduled,
            random: random.filter(|r| r.fraction > 0.0).cloned(),
            rng,
            next: None,
        };
        if let Some(random) = &contacts.random {
            let from = random.from_to_s.0;
            contacts.next = contacts.draw(from);
        }
        contacts
    }

    /// The next random contact after `after`, s.
    fn draw(&mut self, after: f64) -> Option<Contact> {
        let random = self.random.as_ref()?;
        let duration_s = random.duration_s.sample(&mut self.rng);
        // Free time is exponential with the mean that makes contacts take their share.
        let u: f64 = self.rng.random();
        let mean_free = duration_s * (1.0 - random.fraction) / random.fraction;
        let start_s = after - mean_free * libm::log(1.0 - u);
        let size = random.force_n.sample(&mut self.rng);
        let v: [f64; 3] = std::array::from_fn(|_| normal(&mut self.rng));
        let length = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
        let direction = if length > 0.0 {
            v.map(|x| x / length)
        } else {
            [1.0, 0.0, 0.0]
        };
        (start_s + duration_s <= random.from_to_s.1).then(|| Contact {
            start_s,
            duration_s,
            link: random.link.clone(),
            line: random.line,
            point_m: random.point_m,
            force_n: direction.map(|x| x * size),
            rise_s: random.rise_s,
        })
    }

    /// The forces at `t`, s. Times must not fall.
    pub fn at(&mut self, t: f64, forces: &mut Vec<PointForce>) {
        forces.clear();
        while let Some(contact) = self.next.take() {
            if t < contact.start_s + contact.duration_s {
                self.next = Some(contact);
                break;
            }
            self.next = self.draw(contact.start_s + contact.duration_s);
        }
        for contact in self.scheduled.iter().chain(&self.next) {
            let share = share(contact, t);
            if share == 0.0 {
                continue;
            }
            forces.push(PointForce {
                link: contact.link.clone(),
                point_m: contact.point_m,
                force_n: contact.force_n.map(|f| f * share),
            });
            if self.begun.iter().rev().take(8).all(|c| c != contact) {
                self.begun.push(contact.clone());
            }
        }
    }
}

/// Share of the force that is on at `t`.
fn share(contact: &Contact, t: f64) -> f64 {
    let since = t - contact.start_s;
    let left = contact.duration_s - since;
    if since < 0.0 || left <= 0.0 {
        return 0.0;
    }
    if contact.rise_s == 0.0 {
        return 1.0;
    }
    let edge = (since.min(left) / contact.rise_s).min(1.0);
    0.5 - 0.5 * libm::cos(std::f64::consts::PI * edge)
}
