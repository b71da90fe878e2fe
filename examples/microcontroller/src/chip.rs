//! What a product has: a robot, the paper's observer, blocks, and a line to the host. No hardware here.

use sinew_model::feeder::{Feeder, FeederOptions, Reading};
use sinew_model::offset::{FeatureConfig, FeatureObserver, OffsetConfig, OffsetObserver};
use sinew_model::wire::{BlockSender, RobotImage};

/// Everything that runs on the chip.
pub struct Chip {
    /// The paper's offset, sample by sample: what a controller on the chip may use at once.
    offset: Feeder<OffsetObserver>,
    features: Feeder<FeatureObserver>,
    /// Bytes on their way to the host.
    pub sender: BlockSender,
}

impl Chip {
    /// From the image of a robot. All memory is taken here; `None` where the image is none.
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

    /// Joints of the robot.
    pub fn joints(&self) -> usize {
        self.offset.observer().delta_e().len()
    }

    /// The paper's observer takes a sample; what it reads now, rad, or `None` where the sample was refused.
    #[inline(never)]
    pub fn observe(&mut self, reading: &Reading<'_>) -> Option<&[f64]> {
        self.offset.take(reading).output()?;
        Some(self.offset.observer().delta_e())
    }

    /// The block being made takes a sample; a complete one goes to the sender. Whether one did.
    #[inline(never)]
    pub fn collect(&mut self, reading: &Reading<'_>) -> bool {
        let complete = self.features.take(reading).output() == Some(true);
        complete && self.sender.put(self.features.observer().block()) == Ok(true)
    }
}
