//! Part of a product: robot, observer of the paper, blocks, and messages to the host. Independent of the hardware.

use sinew_model::feeder::{Feeder, FeederOptions, RobotSample};
use sinew_model::offset::{FeatureConfig, FeatureObserver, OffsetConfig, OffsetObserver};
use sinew_model::wire::{BlockSender, RobotImage};

/// State of the estimators on the chip.
pub struct Chip {
    /// Offset observer of the paper, per sample, for a controller on the chip.
    offset: Feeder<OffsetObserver>,
    features: Feeder<FeatureObserver>,
    /// Queue of the bytes for the host.
    pub sender: BlockSender,
}

impl Chip {
    /// Creates the estimators from the image of a robot and allocates all memory; `None` if the image is invalid.
    pub fn new(image: &[u8]) -> Option<Self> {
        let robot = RobotImage::read(image).ok()?;
        let (arm, springs) = (&robot.arm, &robot.transmissions);
        let offset = OffsetObserver::new(arm, springs, OffsetConfig::default()).ok()?;
        let features = robot.features(FeatureConfig::default()).ok()?;
        Some(Self {
            sender: BlockSender::new(&features),
            offset: Feeder::new(offset, springs, FeederOptions::default()),
            features: Feeder::new(features, springs, FeederOptions::default()),
        })
    }

    /// Number of joints of the robot.
    pub fn joints(&self) -> usize {
        self.offset.observer().delta_e().len()
    }

    /// Advances the observer of the paper; returns the offset of each joint, rad, or `None` if the sample was rejected.
    #[inline(never)]
    pub fn observe(&mut self, reading: &RobotSample<'_>) -> Option<&[f64]> {
        self.offset.take(reading).output()?;
        Some(self.offset.observer().delta_e())
    }

    /// Adds a sample to the current block and queues a complete block; returns whether a block was queued.
    #[inline(never)]
    pub fn collect(&mut self, reading: &RobotSample<'_>) -> bool {
        let complete = self.features.take(reading).output() == Some(true);
        complete && self.sender.put(self.features.observer().block()) == Ok(true)
    }
}
