//! Simulated bench records of creep tests with their artefacts.

use crate::support::laws::times;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use sinew_creep::{Curve, Law};
use sinew_creep::{Specimen, TestQuantity as Q};

/// Loads with start times, N.
struct Bench {
    name: &'static str,
    colour: &'static str,
    celsius: f64,
    loads: &'static [(f64, f64)],
    ramp_s: f64,
    every_s: f64,
    last_s: f64,
}

const BENCHES: [Bench; 4] = [
    Bench {
        name: "A",
        colour: "red",
        celsius: 23.0,
        loads: &[(0.0, 2.0), (40.0, 60.0), (3000.0, 2.0)],
        ramp_s: 3.0,
        every_s: 4.0,
        last_s: 4000.0,
    },
    Bench {
        name: "B",
        colour: "red",
        celsius: 23.4,
        loads: &[(0.0, 2.2), (60.0, 60.6), (2500.0, 2.2)],
        ramp_s: 0.0,
        every_s: 7.0,
        last_s: 3500.0,
    },
    Bench {
        name: "C",
        colour: "blue",
        celsius: 22.0,
        loads: &[(0.0, 3.0), (50.0, 120.0), (1500.0, 180.0)],
        ramp_s: 12.0,
        every_s: 5.0,
        last_s: 3200.0,
    },
    Bench {
        name: "D",
        colour: "blue",
        celsius: 22.0,
        loads: &[(0.0, 1.0), (30.0, 90.0)],
        ramp_s: 1.0,
        every_s: 6.0,
        last_s: 3300.0,
    },
];

impl Bench {
    fn load(&self, t: f64) -> f64 {
        let mut now = self.loads[0].1;
        for &(from, to) in &self.loads[1..] {
            let share = ((t - from) / self.ramp_s.max(1e-6)).clamp(0.0, 1.0);
            now += share * (to - now);
        }
        now
    }

    /// Elastic strain, and a power of the time since every change of the load.
    fn strain(&self, t: f64) -> f64 {
        let mut before = self.loads[0].1;
        let mut strain = 4e-5 * (self.load(t) - before);
        for &(from, to) in &self.loads[1..] {
            let since = (t - from - 0.5 * self.ramp_s).max(0.0);
            strain += 3e-6 * (to - before) * since.powf(0.15);
            before = to;
        }
        strain
    }
}

/// Seven tests, one of them in millimetres, and two invalid ones.
pub(crate) fn specimens() -> Vec<Specimen> {
    let mut all: Vec<Specimen> = BENCHES.iter().map(specimen).collect();
    let mut without_force = Specimen::default();
    without_force.name = "without force".into();
    without_force.attributes.clone_from(&all[1].attributes);
    without_force.lines.clone_from(&all[1].lines);
    for quantity in [Q::Time, Q::Strain, Q::Temperature] {
        let column = all[1].column(quantity).unwrap().to_vec();
        without_force.set_column(quantity, column);
    }
    all.push(without_force);
    let mut under_load = all[3].clone();
    for quantity in [Q::Time, Q::Force, Q::Strain] {
        let column = under_load.column(quantity).unwrap()[40..].to_vec();
        under_load.set_column(quantity, column);
    }
    under_load.name = "under load".into();
    all.push(under_load);
    let mut swapped = all[3].clone();
    let force = all[3].column(Q::Force).unwrap();
    let force = force.iter().map(|n| 1e-3 * n).collect();
    swapped.set_column(Q::Force, all[3].column(Q::Strain).unwrap().to_vec());
    swapped.set_column(Q::Strain, force);
    swapped.name = "swapped".into();
    all.push(swapped);
    let mut millimetres = all[3].clone();
    let strain = millimetres.column(Q::Strain).unwrap();
    let strain = strain.iter().map(|e| 350.0 * e).collect();
    millimetres.set_column(Q::Strain, strain);
    millimetres.name = "millimetres".into();
    all.push(millimetres);
    let mut short = Specimen::default();
    short.name = "short".into();
    short.attributes = vec![("colour".into(), "blue".into())];
    short.lines = vec![1, 2];
    short.set_column(Q::Time, vec![0.0, 1.0]);
    short.set_column(Q::Strain, vec![0.0, 1e-3]);
    all.push(short);
    all
}

fn specimen(bench: &Bench) -> Specimen {
    let mut random = ChaCha8Rng::seed_from_u64(bench.last_s as u64);
    let mut noise = |size: f64| -> f64 {
        let z: f64 = StandardNormal.sample(&mut random);
        size * z
    };
    let count = (bench.last_s / bench.every_s) as usize;
    let mut time: Vec<f64> = (0..count).map(|i| bench.every_s * i as f64).collect();
    let mut force: Vec<f64> = time
        .iter()
        .map(|t| bench.load(*t) * (1.0 + noise(5e-4)))
        .collect();
    let mut strain: Vec<f64> = time
        .iter()
        .map(|t| bench.strain(*t) + 5e-4 + noise(4e-6))
        .collect();
    let warm: Vec<f64> = time
        .iter()
        .map(|t| bench.celsius + 0.2 * (t / 900.0).sin())
        .collect();
    let humid: Vec<f64> = time.iter().map(|t| 48.0 + t / 1000.0).collect();
    match bench.name {
        // A grip slips, and there is one outlier.
        "A" => {
            strain[200..].iter_mut().for_each(|e| *e += 2e-4);
            strain[450] += 4e-4;
        }
        // One duplicate time stamp, one older one, one missing measurement.
        "B" => {
            time[100] = time[99];
            time[150] = time[140];
            strain[180] = f64::NAN;
        }
        // The load drifts.
        "C" => force[320..]
            .iter_mut()
            .enumerate()
            .for_each(|(i, n)| *n -= 0.012 * i as f64),
        _ => {}
    }
    let mut specimen = Specimen::default();
    specimen.name = bench.name.into();
    specimen.attributes = vec![("colour".into(), bench.colour.into())];
    specimen.lines = (0..count as u64).collect();
    specimen.set_column(Q::Time, time);
    specimen.set_column(Q::Force, force);
    match bench.name {
        "A" => {
            let elongation = strain.iter().map(|e| 0.35 * e).collect();
            specimen.set_column(Q::Elongation, elongation);
        }
        _ => specimen.set_column(Q::Strain, strain),
    }
    // The temperature of D is specified.
    if bench.name != "D" {
        specimen.set_column(Q::Temperature, warm);
        specimen.set_column(Q::Humidity, humid);
    }
    specimen
}

/// Moduli of a material that flows faster at higher temperature, with noise.
pub(crate) fn isotherms() -> Vec<Specimen> {
    let mut random = ChaCha8Rng::seed_from_u64(11);
    [10.0, 17.0, 25.0, 34.0, 45.0]
        .map(|celsius: f64| {
            let a_t = (9e3 * (1.0 / (celsius + 273.15) - 1.0 / 298.15)).exp();
            let time: Vec<f64> = (0..24)
                .map(|i| 2.0 * 10f64.powf(f64::from(i) / 6.0))
                .collect();
            let modulus = time.iter().map(|t| {
                let z: f64 = StandardNormal.sample(&mut random);
                1e9 / (1.0 + 0.2 * (1.0 + t / a_t / 50.0).ln()) * (1.0 + 2e-3 * z)
            });
            let mut specimen = Specimen::default();
            specimen.name = format!("{celsius} °C");
            specimen.lines = (0..24).collect();
            specimen.set_column(Q::Modulus, modulus.collect());
            specimen.set_column(Q::Temperature, vec![celsius; 24]);
            specimen.set_column(Q::Time, time);
            specimen
        })
        .into()
}

/// Records generated by each law: an hour under load, and half an hour without.
pub(crate) fn laws() -> Vec<(Law, Curve)> {
    let gone = |t: f64, tau: f64| 1.0 - (-t / tau).exp();
    let laws: [(Law, &dyn Fn(f64) -> f64); 6] = [
        (Law::LogTime, &|t| 3e-4 * (1.0 + t / 60.0).ln()),
        (Law::Findley, &|t| 1e-3 * (t / 3600.0).powf(0.2)),
        (Law::Burgers, &|t| 3e-4 * t / 3600.0 + 8e-4 * gone(t, 300.0)),
        (Law::KelvinVoigt, &|t| {
            4e-4 * gone(t, 40.0) + 7e-4 * gone(t, 1500.0)
        }),
        (Law::Stretched, &|t| 1e-3 * gone((t / 500.0).powf(0.6), 1.0)),
        (Law::Line, &|t| 5e-4 * t / 3600.0),
    ];
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let mut made = |(law, creep): (Law, &dyn Fn(f64) -> f64)| {
        let time: Vec<f64> = times(90, 3590.0)
            .into_iter()
            .chain(times(50, 1800.0).into_iter().map(|t| 3600.0 + t))
            .collect();
        let strain = time
            .iter()
            .map(|t| {
                let z: f64 = StandardNormal.sample(&mut random);
                let after = match *t > 3600.0 {
                    true => -1.5e-3 - creep(t - 3600.0),
                    false => 0.0,
                };
                1.5e-3 + creep(*t) + after + 1e-6 * z
            })
            .collect();
        let mut curve = Curve::constant_load(law.name(), time, strain);
        curve.steps.push((3600.0, 0.0));
        (law, curve)
    };
    laws.into_iter().map(&mut made).collect()
}
