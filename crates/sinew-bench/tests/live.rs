//! The recursive form, as beside a running robot.

use crate::support;

use sinew_bench::scenarios::{End, EndScore, Form, Sessions, record};
use sinew_estimate::feeder::{Fed, Feeder, FeederOptions};
use sinew_estimate::live::{LiveOffsets, Stepped};
use sinew_estimate::session;
use sinew_estimate::session::{Recorder, SessionOptions, Warning};
use sinew_log::OpenOptions;
use sinew_model::offset::{FeatureConfig, FeatureObserver};
use sinew_model::{Gaussian, StepError, Z95};
use sinew_sim::protocol::plan_named;
use support::{asked_seeds, biorob_like, block_by_block, least, repository, seeds, work_session};

#[test]
fn block_by_block_gives_what_all_at_once_gives() {
    let robot = biorob_like();
    let options = SessionOptions::default();
    let (mut widths, mut inside, mut count) = ([0.0; 2], 0, 0);
    for seed in 0..seeds(3) {
        let (parts, truth) = work_session(&robot, 40 + seed, |t| t, &[60.0, 120.0]);
        let (baseline, _) =
            session::learn_recorded(&robot, &parts[0], "A", &session::Learning::default()).unwrap();
        let with = Some((&baseline, "baseline"));
        let (batch, _) =
            session::estimate_recorded(&robot, &parts[1], "B", with, &options).unwrap();
        let (filter, weights) = block_by_block(&robot, &baseline, &options, &parts[1]);
        print!(
            "seed {seed}: mean weight {:.2}",
            weights / parts[1].blocks.len() as f64
        );
        if filter.is_provisional() {
            println!(", in doubt");
            assert!(asked_seeds().is_some(), "nothing happened");
            continue;
        }
        for (joint, said) in batch.joints.iter().enumerate() {
            let Gaussian {
                mean: offset,
                deviation,
            } = filter.offset(joint);
            let (offset, interval) = (1e3 * offset, 1.96e3 * deviation);
            print!(
                ", {}: {:+.2} ± {:.2} batch, {:+.2} ± {interval:.2} recursive",
                said.name,
                1e3 * said.offset_rad.mean - truth[joint],
                1e3 * said.offset_rad.half_width_95(),
                offset - truth[joint]
            );
            let of_batch = 1e3 * said.offset_rad.half_width_95();
            inside += u32::from((offset - truth[joint]).abs() < interval.max(of_batch));
            count += 1;
            widths = [widths[0] + interval, widths[1] + of_batch];
        }
        println!();
    }
    let least = least(0.95, f64::from(count));
    assert!(f64::from(inside) >= least, "{inside} of {count}");
    let [recursive, batch] = widths;
    assert!(recursive < 2.0 * batch, "{recursive} {batch}");
}

/// What the recursive form learned goes on as what the batch learned does.
#[test]
fn what_is_saved_goes_on_in_the_next_session() {
    let robot = biorob_like();
    let options = SessionOptions::default();
    for seed in 0..seeds(2) {
        let no_slips = |text: String| text.replace("rad = 0.005", "rad = 0.0");
        let cuts = [60.0, 120.0];
        let (parts, truth) = work_session(&robot, 40 + seed, no_slips, &cuts);
        let (baseline, _) =
            session::learn_recorded(&robot, &parts[0], "A", &session::Learning::default()).unwrap();
        let mut early = session::live(&robot, (&baseline, "A"), &options).unwrap();
        early.step(&parts[1].blocks[0]).unwrap();
        let end = ("B", parts[1].end_time_ns);
        let refused = session::live_saved(&robot, &baseline, &early, end).unwrap_err();
        assert!(
            refused.to_string().contains("B: the offsets are in doubt"),
            "{refused}"
        );

        // The batch finds that nothing creeps; this one is told.
        let mut filter = session::live(&robot, (&baseline, "A"), &options).unwrap();
        filter.expect_creep(0.0).unwrap();
        for block in &parts[1].blocks {
            filter.step(block).unwrap();
        }
        if filter.is_provisional() {
            assert!(asked_seeds().is_some(), "nothing happened");
            continue;
        }
        let saved = session::live_saved(&robot, &baseline, &filter, end).unwrap();
        let with = Some((&baseline, "A"));
        let (_, batch) =
            session::estimate_recorded(&robot, &parts[1], "B", with, &options).unwrap();
        assert_eq!(saved.recordings, batch.recordings);
        assert_eq!(saved.end_time_ns, batch.end_time_ns);
        let [from_saved, from_batch] = [&saved, &batch].map(|baseline| {
            let with = Some((baseline, "B"));
            session::estimate_recorded(&robot, &parts[2], "C", with, &options)
                .unwrap()
                .0
        });
        for ((a, b), truth) in from_saved.joints.iter().zip(&from_batch.joints).zip(&truth) {
            println!(
                "seed {seed} {}: {:+.2} ± {:.2} from the recursive form, {:+.2} ± {:.2} from the batch",
                a.name,
                1e3 * a.offset_rad.mean - truth,
                1e3 * a.offset_rad.half_width_95(),
                1e3 * b.offset_rad.mean - truth,
                1e3 * b.offset_rad.half_width_95()
            );
            assert!(
                (1e3 * a.offset_rad.mean - truth).abs()
                    < (1e3 * a.offset_rad.half_width_95()).max(1e3 * b.offset_rad.half_width_95())
            );
            assert!(
                (1e3 * a.offset_rad.mean - 1e3 * b.offset_rad.mean).abs()
                    < 0.5 * 1e3 * b.offset_rad.half_width_95()
            );
            let wider = 1e3 * a.offset_rad.half_width_95() / (1e3 * b.offset_rad.half_width_95());
            assert!((0.75..1.5).contains(&wider), "{wider}");
        }
    }
}

/// Two tendons slip by 5 mrad, 20 s apart, and nobody says so.
#[test]
fn a_slip_is_doubted_and_then_followed() {
    const PITCH: usize = 1;
    const ELBOW: usize = 2;
    /// Slips of the work session: joint, when, s, and how far, mrad.
    const SLIPS: [(usize, f64, f64); 2] = [(PITCH, 130.0, 5.0), (ELBOW, 150.0, 5.0)];
    /// A slip is doubted within this time, s: 4 to 8 mostly, one of 48 after 25. None is three deviations off without doubt for as long.
    const SEEN_S: f64 = 15.0;
    let robot = biorob_like();
    let (mut all, mut ends, mut doubts) = ([0, 0], [0, 0], 0);
    let (mut slips, mut late) = (0, 0);
    // The second slip of the eleventh looked like lost stiffness: the elbow was 7 mrad off without doubt for 22 s.
    for seed in (0..seeds(3)).chain((seeds(3) <= 10).then_some(10)) {
        let (parts, truth) = work_session(&robot, 60 + seed, |t| t, &[60.0]);
        let (baseline, _) =
            session::learn_recorded(&robot, &parts[0], "A", &session::Learning::default()).unwrap();
        let options = SessionOptions::default();
        let mut filter = session::live(&robot, (&baseline, "A"), &options).unwrap();
        let (mut doubted, mut inside, mut sure) = (0, 0, 0);
        let mut seen_s = [f64::NAN; SLIPS.len()];
        let (mut sure_and_wrong_s, mut last_s) = ([0.0; SLIPS.len()], f64::NAN);
        for block in &parts[1].blocks {
            filter.step(block).unwrap();
            for ((joint, at_s, size), wrong_s) in SLIPS.iter().zip(&mut sure_and_wrong_s) {
                let Gaussian { mean, deviation } = filter.offset(*joint).scaled(1e3);
                let is_wrong = (mean - truth[*joint] - size).abs() > 3.0 * deviation;
                if block.time_s > *at_s && is_wrong && !filter.is_provisional() {
                    *wrong_s += block.time_s - last_s;
                }
            }
            last_s = block.time_s;
            for ((_, at_s, _), seen_s) in SLIPS.iter().zip(&mut seen_s) {
                if seen_s.is_nan() && block.time_s > *at_s && filter.is_provisional() {
                    *seen_s = block.time_s - at_s;
                }
            }
            // Nobody can know of a slip at once.
            let just_slipped =
                |(_, at_s, _): &(usize, f64, f64)| (*at_s..at_s + SEEN_S).contains(&block.time_s);
            if SLIPS.iter().any(just_slipped) {
                continue;
            }
            doubted += usize::from(filter.is_provisional());
            for (i, truth) in truth.iter().enumerate() {
                let slips = SLIPS
                    .iter()
                    .filter(|(joint, at_s, _)| *joint == i && *at_s < block.time_s);
                let truth = truth + slips.map(|(_, _, size)| size).sum::<f64>();
                let Gaussian {
                    mean: offset,
                    deviation,
                } = filter.offset(i).scaled(1e3);
                sure += 1;
                inside += usize::from((offset - truth).abs() < 1.96 * deviation);
            }
        }
        println!(
            "seed {seed}: {inside} of {sure} inside, {doubted} of {} blocks in doubt, slips seen after {seen_s:.1?} s, \
             three deviations off without doubt for {sure_and_wrong_s:.1?} s",
            parts[1].blocks.len()
        );
        all = [all[0] + inside, all[1] + sure];
        for (i, _, size) in SLIPS {
            let Gaussian {
                mean: offset,
                deviation,
            } = filter.offset(i).scaled(1e3);
            let error = offset - truth[i] - size;
            ends[0] += usize::from(error.abs() < 1.96 * deviation);
            ends[1] += 1;
            println!("  in the end {error:+.2} ± {:.2}", 1.96 * deviation);
        }
        doubts += u64::from(filter.is_provisional());
        let none = truth.len();
        let offset = filter.offset(none);
        assert!(offset.mean.is_nan() && offset.deviation.is_nan());
        assert!(
            sure_and_wrong_s.iter().all(|s| *s < SEEN_S),
            "{sure_and_wrong_s:?}"
        );
        slips += seen_s.len();
        late += seen_s
            .iter()
            .filter(|s| s.is_nan() || **s >= SEEN_S)
            .count();
    }
    assert!(20 * late <= slips, "{late} of {slips}");
    println!("{all:?} inside, {ends:?} in the end, {doubts} then in doubt");
    assert!(10 * all[0] > 9 * all[1], "{all:?}");
    assert!(6 * ends[0] >= 5 * ends[1], "{ends:?}");
    assert!(3 * doubts <= seeds(3), "{doubts}");
}

/// In four poses a second slip, ten to twenty seconds after the first, looks like lost stiffness: taken for that, the elbow was 31 to 46 mrad off without
/// doubt.
#[test]
fn a_second_slip_in_four_poses_is_not_taken_for_lost_stiffness() {
    let plan = plan_named("S9").unwrap();
    for seed in [5008, 5045, 10012, 10022] {
        let recording = record(&plan, seed, Sessions::Chain).unwrap();
        let at_end = |end: &&EndScore| (end.form, end.end) == (Form::Online, End::Chain);
        let end = recording.ends.iter().find(at_end).unwrap();
        for (i, error) in end.errors_rad.iter().enumerate() {
            let off = error.mean.abs() / error.deviation;
            println!("{seed}, {i}: {off:.1} deviations, {}", end.is_warned);
            assert!(off < 3.0 || end.is_warned, "{seed}, {i}: {error:?}");
        }
    }
}

/// With the work of a call bounded the offsets are those of a loop that does it at once, a block later; nothing is left out, and
/// what is saved in the middle of a block's work is what the other saves.
#[test]
fn bounded_work_says_the_same_a_block_later() {
    let robot = biorob_like();
    let options = SessionOptions::default();
    let file = repository().join("examples/01-stretched-arm/stretched-arm.mcap");
    let mut recording = sinew_log::open(&file, &OpenOptions::default()).unwrap();
    let mut recorder = Recorder::new(&robot, &FeatureConfig::default(), 0.5);
    let mut frames = Vec::new();
    while let Some(frame) = recording.next_frame().unwrap() {
        recorder.push(frame, 0.002 * frames.len() as f64);
        frames.push(frame.clone());
    }
    let learning = session::Learning::default();
    let learned = session::learn_recorded(&robot, &recorder.finish(), "A", &learning);
    let (baseline, _) = learned.unwrap();
    let mut whole = LiveOffsets::new(robot.clone(), (baseline.clone(), "A"), &options).unwrap();
    let mut bounded = LiveOffsets::new(robot.clone(), (baseline, "A"), &options).unwrap();
    for period_s in [0.0, -1e-3, f64::NAN, f64::INFINITY] {
        assert!(bounded.bound_work(period_s).is_err(), "{period_s}");
    }
    let period_s = frames
        .windows(2)
        .map(|pair| pair[1].time_ns - pair[0].time_ns);
    let period_s = period_s.max().unwrap() as f64 * 1e-9;
    let slices = bounded.bound_work(period_s).unwrap();
    assert!(slices > 1);
    let told = |live: &LiveOffsets| -> Vec<_> {
        (0..robot.arm.dof())
            .map(|i| (live.offset(i), live.stiffness_changed(i)))
            .collect()
    };
    let mut last_ns = frames[0].time_ns;
    let (mut before, mut updates) = (told(&whole), [0, 0]);
    let (mut saved, mut in_doubt) = (0, 0);
    for frame in &frames {
        let dt_s = (frame.time_ns - last_ns) as f64 * 1e-9;
        last_ns = frame.time_ns;
        let step = |live: &mut LiveOffsets| {
            let stepped = live.step(dt_s, &frame.q, &frame.theta, &frame.tau_m, f64::NAN);
            usize::from(stepped.unwrap() == Stepped::Updated)
        };
        let now = step(&mut whole);
        updates[0] += now;
        if now == 1 {
            // The last slice of a block is done before the next block is complete.
            assert_eq!(told(&bounded), before);
            assert_eq!(updates[1] + 1, updates[0]);
            before = told(&whole);
        }
        updates[1] += step(&mut bounded);
        if now == 1 && updates[0] % 10 == 0 {
            let texts = [&whole, &bounded].map(|live| live.save("run", last_ns));
            let [one, other] = texts.map(|saved| saved.map(|next| next.to_text()).ok());
            assert_eq!(one, other);
            // What is in doubt isn't handed on.
            assert_eq!(one.is_none(), whole.is_provisional());
            in_doubt += usize::from(one.is_none());
            saved += usize::from(one.is_some());
        }
    }
    assert_eq!(bounded.blocks_left_out(), 0);
    assert!(
        updates[0] > 100 && saved > 0 && in_doubt > 0,
        "{updates:?}, {saved} saved"
    );
}

/// Samples one by one are what frames of a recording are.
#[test]
fn live_offsets_are_those_of_the_feeder() {
    let robot = biorob_like();
    let options = SessionOptions::default();
    let file = repository().join("examples/01-stretched-arm/stretched-arm.mcap");
    let mut recording = sinew_log::open(&file, &OpenOptions::default()).unwrap();
    let mut recorder = Recorder::new(&robot, &FeatureConfig::default(), 0.5);
    let mut simulated = Vec::new();
    while let Some(frame) = recording.next_frame().unwrap() {
        recorder.push(frame, 0.002 * simulated.len() as f64);
        simulated.push(frame.clone());
    }
    let (baseline, _) = session::learn_recorded(
        &robot,
        &recorder.finish(),
        "A",
        &session::Learning::default(),
    )
    .unwrap();
    let mut live = LiveOffsets::new(robot.clone(), (baseline.clone(), "A"), &options).unwrap();
    let mut filter = session::live(&robot, (&baseline, "A"), &options).unwrap();
    let features = FeatureObserver::new(&robot.arm, FeatureConfig::default());
    let mut feeder = Feeder::new(features, &robot.transmissions, FeederOptions::default());
    let mut last_ns = simulated[0].time_ns;
    let mut updates = 0;
    for (i, frame) in simulated.iter().enumerate() {
        let mut frame = frame.clone();
        // A sample is lost now and then: the next step is longer for both.
        if i % 500 == 7 {
            frame.q[1] = f64::NAN;
        }
        let dt_s = (frame.time_ns - last_ns) as f64 * 1e-9;
        last_ns = frame.time_ns;
        let fed = feeder.frame(&frame);
        if fed.output() == Some(true) {
            filter.step(feeder.observer().block()).unwrap();
        }
        let (q, theta, tau_m) = (&frame.q, &frame.theta, &frame.tau_m);
        let stepped = live
            .step(dt_s, q, theta, tau_m, frame.temperature_c)
            .unwrap();
        updates += usize::from(stepped == Stepped::Updated);
        let as_fed = match fed {
            Fed::Refused(why) => Stepped::Refused(why),
            Fed::Restarted(false) => Stepped::Restarted,
            Fed::Taken(false) => Stepped::Taken,
            Fed::Taken(true) | Fed::Restarted(true) => Stepped::Updated,
        };
        assert_eq!(stepped, as_fed, "frame {i}");
    }
    assert!(updates > 100, "{updates}");
    for joint in 0..robot.arm.dof() {
        assert_eq!(live.offset(joint), filter.offset(joint));
    }
    assert_eq!(live.is_provisional(), filter.is_provisional());
    assert!(live.offset(9).mean.is_nan());
    // What can't be a sample changes nothing.
    let four = [0.1; 4];
    let before = live.offset(2);
    for (dt_s, q, tau_m) in [(0.002, &four[..3], &four[..]), (0.002, &four, &four[..2])] {
        let refused = live.step(dt_s, q, &four, tau_m, f64::NAN);
        assert_eq!(refused, Err(StepError::Length));
    }
    for dt_s in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let refused = live.step(dt_s, &four, &four, &[], f64::NAN);
        assert_eq!(refused, Err(StepError::TimeStep));
    }
    assert_eq!(live.offset(2), before);
}

/// A robot that warmed up by 15 K, whose zeros drift: without a thermometer nobody knows by how much, and what somebody
/// states counts as if it had been recorded.
#[test]
fn a_temperature_that_is_unknown_or_stated_counts_as_in_a_recording() {
    let mut robot = biorob_like();
    robot.tolerances.drift_rad_per_k = Some(0.1e-3);
    let (parts, _) = work_session(&robot, 40, |t| t, &[60.0, 120.0]);
    let (mut first, mut second) = (parts[0].clone(), parts[1].clone());
    first.blocks.iter_mut().for_each(|b| b.temperature_c = 22.0);
    let (baseline, _) =
        session::learn_recorded(&robot, &first, "A", &session::Learning::default()).unwrap();
    let stated = SessionOptions {
        temperature_c: Some(Gaussian::new(37.0, 0.5)),
        ..SessionOptions::default()
    };
    let plain = SessionOptions::default();
    let unknown = f64::NAN;
    let mut widths = Vec::new();
    for (recorded_c, options) in [(37.0, &plain), (unknown, &plain), (unknown, &stated)] {
        for block in &mut second.blocks {
            block.temperature_c = recorded_c;
        }
        let with = Some((&baseline, "A"));
        let (batch_said, _) =
            session::estimate_recorded(&robot, &second, "B", with, options).unwrap();
        let (filter, _) = block_by_block(&robot, &baseline, options, &second);
        let [batch, live] = [batch_said.joints[0].offset_rad, filter.offset(0)];
        let ratio = live.deviation / batch.deviation;
        assert!(
            (0.7..1.5).contains(&ratio),
            "{recorded_c}: {live:?} {batch:?}"
        );
        assert!(
            (live.mean - batch.mean).abs() < batch.deviation.max(0.2e-3),
            "{recorded_c}: {live:?} {batch:?}"
        );
        widths.push(live.deviation);
        // Who reads the filter can tell that it isn't known, as the batch warns.
        let warns = |w: &Warning| matches!(w, Warning::TemperatureUnknown { .. });
        let is_unknown = batch_said.warnings.iter().any(warns);
        assert_eq!(
            is_unknown,
            recorded_c.is_nan() && options.temperature_c.is_none()
        );
        for joint in 0..robot.arm.dof() {
            let added_rad = filter.unknown_temperature_rad(joint);
            assert_eq!(added_rad > 0.0, is_unknown, "{recorded_c}: {added_rad}");
            assert!(added_rad < filter.offset(joint).deviation);
        }
        if let Some(Warning::TemperatureUnknown {
            half_width_95_rad, ..
        }) = batch_said.warnings.iter().find(|w| warns(w))
        {
            let most = (0..robot.arm.dof()).map(|joint| filter.unknown_temperature_rad(joint));
            let half_width_95_rad = half_width_95_rad / Z95;
            assert!((most.fold(0.0, f64::max) - half_width_95_rad).abs() < 1e-12);
        }
    }
    // A baseline without a temperature leaves it as unknown as a robot without one.
    let mut untold = baseline.clone();
    untold.temperature_c = None;
    for block in &mut second.blocks {
        block.temperature_c = 37.0;
    }
    let (filter, _) = block_by_block(&robot, &untold, &plain, &second);
    assert!(filter.unknown_temperature_rad(0) > 0.0);
    // 15 K times 0.1 mrad/K, known and unknown alike; the room varies by a few kelvin only.
    assert!(widths[0] > 1e-3 && widths[2] > 1e-3, "{widths:?}");
}
