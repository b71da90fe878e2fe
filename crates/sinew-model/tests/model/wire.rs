//! Blocks and robots as bytes: what comes out is what went in, or it is refused.

use proptest::prelude::*;
use sinew_model::StepError;
use sinew_model::arm::Arm;
use sinew_model::offset::{Block, FeatureConfig, FeatureObserver};
use sinew_model::robot::{Robot, RobotFile};
use sinew_model::wire::{BlockReceiver, BlockSender, Received, RobotImage, WireError};

fn robot() -> Robot {
    let toml = include_str!("../../robots/biorob-like/robot.toml");
    let urdf = include_str!("../../robots/biorob-like/biorob-like.urdf");
    let file = RobotFile::parse(toml, "robot.toml").unwrap();
    file.build(urdf).unwrap()
}

/// Blocks of a motion; the motor torque is recorded of the first joint only, the temperature not at all.
fn blocks(arm: &Arm, count: usize) -> Vec<Block> {
    blocks_of(FeatureObserver::new(arm, FeatureConfig::default()), count)
}

fn blocks_of(mut features: FeatureObserver, count: usize) -> Vec<Block> {
    let n = features.block().q.len();
    let mut torque = vec![f64::NAN; n];
    torque[0] = 0.3;
    let mut blocks = Vec::new();
    let mut t = 0.0;
    while blocks.len() < count {
        let q: Vec<f64> = (0..n).map(|i| (t * (1.0 + 0.3 * i as f64)).sin()).collect();
        let theta: Vec<f64> = q.iter().map(|q| q + 0.01 * q.cos()).collect();
        if features.step(4e-3, &q, &theta, &torque, f64::NAN).unwrap() {
            blocks.push(features.block().clone());
        }
        t += 4e-3;
    }
    blocks
}

fn sender_of(arm: &Arm) -> BlockSender {
    BlockSender::new(&FeatureObserver::new(arm, FeatureConfig::default()))
}

/// The line of a sender: every block at once.
fn sent(sender: &mut BlockSender, blocks: &[Block]) -> Vec<u8> {
    let mut line = Vec::new();
    for block in blocks {
        assert!(sender.put(block).unwrap());
        line.extend_from_slice(sender.pending());
        sender.sent(usize::MAX);
    }
    line
}

/// Returns the blocks received from a line, and the errors of the rejected frames.
fn received(receiver: &mut BlockReceiver, line: &[u8]) -> (Vec<Received>, Vec<WireError>) {
    let (mut blocks, mut refused) = (Vec::new(), Vec::new());
    for byte in line {
        match receiver.push(*byte) {
            Ok(None) => {}
            Ok(Some(block)) => blocks.push(block),
            Err(reason) => refused.push(reason),
        }
    }
    (blocks, refused)
}

/// Whether two blocks are bitwise identical, with NaN equal to NaN.
fn same(a: &Block, b: &Block) -> bool {
    let bits = |block: &Block| format!("{block:?}");
    bits(a) == bits(b)
        && a.phi
            .iter()
            .zip(&b.phi)
            .all(|(a, b)| a.to_bits() == b.to_bits())
}

#[test]
fn block_round_trip_is_bitwise_identical() {
    let arm = robot().arm;
    let config = FeatureConfig::default();
    let made = blocks(&arm, 30);
    let mut sender = sender_of(&arm);
    let line = sent(&mut sender, &made);
    let mut receiver = BlockReceiver::new(&arm, &config);
    let (back, refused) = received(&mut receiver, &line);
    assert_eq!(refused, []);
    assert_eq!(back.len(), made.len());
    for (k, (back, made)) in back.iter().zip(&made).enumerate() {
        assert!(same(&back.block, made), "block {k}");
        assert_eq!((back.sequence, back.lost_before), (k as u32, 0));
    }
    let longest = line.split(|b| *b == 0).map(|f| f.len() + 1).max().unwrap();
    assert!(longest <= sender.frame_bytes_max());
    assert!(
        longest + 16 > sender.frame_bytes_max(),
        "the bound is tight"
    );
}

#[test]
fn slow_line_skips_blocks_and_host_counts_them() {
    let arm = robot().arm;
    let config = FeatureConfig::default();
    let made = blocks(&arm, 4);
    let mut sender = sender_of(&arm);
    let mut line = Vec::new();
    assert!(sender.put(&made[0]).unwrap());
    let part = sender.pending().len() / 2;
    line.extend_from_slice(&sender.pending()[..part]);
    sender.sent(part);
    // Half of it is out when the next two come.
    assert!(!sender.put(&made[1]).unwrap());
    assert!(!sender.put(&made[2]).unwrap());
    assert_eq!(sender.skipped(), 2);
    line.extend_from_slice(sender.pending());
    sender.sent(usize::MAX);
    line.extend(sent(&mut sender, &made[3..]));
    let mut receiver = BlockReceiver::new(&arm, &config);
    let (back, refused) = received(&mut receiver, &line);
    assert_eq!(refused, []);
    assert!(same(&back[0].block, &made[0]) && same(&back[1].block, &made[3]));
    assert_eq!(back[1].lost_before, 2);
    assert_eq!(receiver.counts().lost, 2);
}

#[test]
fn late_host_and_chip_restart_are_detected() {
    let arm = robot().arm;
    let config = FeatureConfig::default();
    let made = blocks(&arm, 6);
    let line = sent(&mut sender_of(&arm), &made);
    let mut receiver = BlockReceiver::new(&arm, &config);
    // From the middle of a frame.
    let (back, refused) = received(&mut receiver, &line[100..]);
    assert_eq!(refused, [WireError::Damaged]);
    assert_eq!(back.len(), 5);
    assert_eq!(back[0].sequence, 1);
    // The chip lost power: its first block is missing.
    let anew = sent(&mut sender_of(&arm), &made);
    let first = anew.iter().position(|b| *b == 0).unwrap();
    let (back, _) = received(&mut receiver, &anew[first + 1..]);
    assert!(back[0].restarted && back[0].lost_before == 1);
    assert!(!back[1].restarted);
    assert_eq!(receiver.counts().restarts, 1);
}

#[test]
fn blocks_of_other_robot_or_config_are_rejected() {
    let arm = robot().arm;
    let config = FeatureConfig::default();
    let made = blocks(&arm, 1);
    let line = sent(&mut sender_of(&arm), &made);
    let slower = FeatureConfig {
        gain_per_s: 2.0,
        ..config
    };
    let mut other = BlockReceiver::new(&arm, &slower);
    let (back, refused) = received(&mut other, &line);
    assert!(back.is_empty());
    assert!(matches!(refused[..], [WireError::Robot { .. }]));

    let mut short = made[0].clone();
    short.phi.pop();
    let mut sender = sender_of(&arm);
    assert_eq!(sender.put(&short), Err(StepError::Length));
    // It took no number: nothing is lost.
    let line = sent(&mut sender, &made);
    let (back, _) = received(&mut BlockReceiver::new(&arm, &config), &line);
    assert_eq!(back[0].sequence, 0);

    let mut endless = made[0].clone();
    endless.y[2] = f64::INFINITY;
    let line = sent(&mut sender_of(&arm), &[endless]);
    let (back, refused) = received(&mut BlockReceiver::new(&arm, &config), &line);
    assert!(back.is_empty());
    assert_eq!(refused, [WireError::Content]);
}

#[test]
fn robot_image_round_trip_and_damage_detection() {
    let robot = robot();
    let image = RobotImage::new(&robot.arm, &robot.transmissions).write();
    let back = RobotImage::read(&image).unwrap();
    assert_eq!(back.arm, robot.arm);
    assert_eq!(back.transmissions, robot.transmissions);
    for at in 0..image.len() {
        let mut damaged = image.clone();
        damaged[at] ^= 0x10;
        assert_eq!(
            RobotImage::read(&damaged),
            Err(WireError::Damaged),
            "byte {at}"
        );
        assert_eq!(RobotImage::read(&image[..at]), Err(WireError::Damaged));
    }
    // A robot whose springs are those of another one.
    let image = RobotImage::new(&robot.arm, &robot.transmissions[1..]).write();
    assert_eq!(RobotImage::read(&image), Err(WireError::Content));
}

#[test]
fn image_base_parameters_give_identical_blocks() {
    let robot = robot();
    let config = FeatureConfig::default();
    let image = RobotImage::new(&robot.arm, &robot.transmissions).write();
    let told = RobotImage::read(&image).unwrap().features(config).unwrap();
    let sent_by = |features: FeatureObserver| {
        let mut sender = BlockSender::new(&features);
        sent(&mut sender, &blocks_of(features, 10))
    };
    assert_eq!(
        sent_by(told),
        sent_by(FeatureObserver::new(&robot.arm, config))
    );
    let n = robot.arm.dof();
    for none in [&[3, 2][..], &[10 * n], &[1, 1]] {
        let refused = FeatureObserver::with_base_columns(&robot.arm, config, none);
        assert_eq!(refused.err(), Some(StepError::Length), "{none:?}");
    }
}

#[test]
fn later_version_error_names_version() {
    let robot = robot();
    let mut image = RobotImage::new(&robot.arm, &robot.transmissions).write();
    let end = image.len() - 4;
    image[0] = 9;
    let crc = crc32_of(&image[..end]);
    image[end..].copy_from_slice(&crc.to_le_bytes());
    assert_eq!(
        RobotImage::read(&image),
        Err(WireError::Version { found: 9 })
    );
}

/// CRC-32 bit by bit, as IEEE 802.3 has it: another hand than the one under test.
fn crc32_of(bytes: &[u8]) -> u32 {
    let mut crc = u32::MAX;
    for byte in bytes {
        crc ^= u32::from(*byte);
        for _ in 0..8 {
            crc = (crc >> 1) ^ (0xEDB8_8320 * (crc & 1));
        }
    }
    !crc
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]
    /// Bytes are changed, lost and inserted anywhere: only sent blocks are received, and all undamaged
    /// ones are.
    #[test]
    fn corrupt_line_loses_blocks_and_creates_none(
        faults in prop::collection::vec((0.0..1.0f64, 0u8..3, any::<u8>()), 0..6),
    ) {
        let arm = robot().arm;
        let config = FeatureConfig::default();
        let made = blocks(&arm, 8);
        let mut line = sent(&mut sender_of(&arm), &made);
        for (at, kind, byte) in &faults {
            let at = (at * line.len() as f64) as usize;
            match kind {
                0 => line[at] = *byte,
                1 => drop(line.remove(at)),
                _ => line.insert(at, *byte),
            }
        }
        let mut receiver = BlockReceiver::new(&arm, &config);
        let (back, _) = received(&mut receiver, &line);
        for back in &back {
            prop_assert!(same(&back.block, &made[back.sequence as usize]));
        }
        // A fault damages its frame, and the next one if it removes the zero between them.
        prop_assert!(back.len() + 2 * faults.len() >= made.len());
    }
}
