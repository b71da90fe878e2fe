//! What the paper says, sentence by sentence, in our words.
//!
//! Every page takes its sentences from here, so that what the paper says stands once and what Sinew adds
//! can't pass for it.

use serde::Serialize;

/// A sentence of the paper.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Claim {
    /// Eq. (4) to (6).
    OffsetEquation,
    /// Eq. (7).
    MomentumObserver,
    /// A sensor instead of the observer.
    TorqueSensor,
    /// Eq. (2) instead of the observer.
    MotorSide,
    /// What elongation does to control.
    SpoilsPosition,
    /// What elongation does to the torque that is felt.
    SpoilsTorque,
    /// Forces that nobody told the estimator of.
    ExternalForces,
    /// Table I.
    Ropes,
    /// How Fig. 1 was measured.
    TensileTest,
    /// Fig. 1.
    Saturates,
    /// Fig. 1.
    DiameterNoMeasure,
    /// Fig. 1.
    ThinRopesAlike,
    /// Fig. 1.
    CordAndClimax,
    /// Fig. 1.
    SmallestSlopes,
    /// Fig. 2.
    WarmAlike,
    /// Fig. 2.
    WarmSlopesRise,
    /// Fig. 2.
    WarmSlopesFall,
    /// Fig. 2.
    WarmHalf,
    /// Fig. 3.
    BenchMeasures,
    /// Fig. 3.
    DistinctPortions,
    /// Fig. 4.
    BendingOrder,
    /// Fig. 4.
    BendingSaturates,
    /// Fig. 4.
    RunTwice,
    /// Fig. 5, case (E).
    LessForceDrops,
    /// Fig. 5, case (E).
    LessForceIrreversible,
    /// Fig. 5, case (F).
    MoreForceRises,
    /// Fig. 6.
    InjectionRule,
    /// Fig. 6.
    NoModelError,
    /// Fig. 6.
    StiffnessTooHigh,
    /// Fig. 6.
    MassesTooLow,
    /// Fig. 6.
    DifferenceRemains,
    /// Fig. 7.
    AddedOffsetSeen,
    /// Fig. 7.
    EstimateDecreases,
    /// Fig. 7.
    DecreaseExplained,
    /// Fig. 7.
    RelaxedRopeSeen,
    /// Fig. 7.
    RetensioningRestores,
}

/// Where the paper says it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Place {
    /// Model, observer and what elongation spoils.
    Model,
    /// Table I.
    Table1,
    /// Fig. 1 and its text.
    Fig1,
    /// Fig. 2 and its text.
    Fig2,
    /// Fig. 3 and its text.
    Fig3,
    /// Fig. 4 and its text.
    Fig4,
    /// Fig. 5 and its text.
    Fig5,
    /// Fig. 6 and its text.
    Fig6,
    /// Fig. 7 and its text.
    Fig7,
}

impl Place {
    /// As a reader of the paper finds it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Model => "model",
            Self::Table1 => "Table I",
            Self::Fig1 => "Fig. 1",
            Self::Fig2 => "Fig. 2",
            Self::Fig3 => "Fig. 3",
            Self::Fig4 => "Fig. 4",
            Self::Fig5 => "Fig. 5",
            Self::Fig6 => "Fig. 6",
            Self::Fig7 => "Fig. 7",
        }
    }
}

impl Claim {
    /// In the order of the paper.
    pub const ALL: [Claim; 36] = {
        use Claim::*;
        [
            OffsetEquation,
            MomentumObserver,
            TorqueSensor,
            MotorSide,
            SpoilsPosition,
            SpoilsTorque,
            Ropes,
            TensileTest,
            Saturates,
            DiameterNoMeasure,
            ThinRopesAlike,
            CordAndClimax,
            SmallestSlopes,
            WarmAlike,
            WarmSlopesRise,
            WarmSlopesFall,
            WarmHalf,
            BenchMeasures,
            DistinctPortions,
            BendingOrder,
            BendingSaturates,
            RunTwice,
            LessForceDrops,
            LessForceIrreversible,
            MoreForceRises,
            InjectionRule,
            NoModelError,
            StiffnessTooHigh,
            MassesTooLow,
            DifferenceRemains,
            ExternalForces,
            AddedOffsetSeen,
            EstimateDecreases,
            DecreaseExplained,
            RelaxedRopeSeen,
            RetensioningRestores,
        ]
    };

    /// Where the paper says it.
    pub fn place(self) -> Place {
        use Claim::*;
        match self {
            OffsetEquation | MomentumObserver | TorqueSensor | MotorSide | SpoilsPosition
            | SpoilsTorque | ExternalForces => Place::Model,
            Ropes => Place::Table1,
            TensileTest | Saturates | DiameterNoMeasure | ThinRopesAlike | CordAndClimax
            | SmallestSlopes => Place::Fig1,
            WarmAlike | WarmSlopesRise | WarmSlopesFall | WarmHalf => Place::Fig2,
            BenchMeasures | DistinctPortions => Place::Fig3,
            BendingOrder | BendingSaturates | RunTwice => Place::Fig4,
            LessForceDrops | LessForceIrreversible | MoreForceRises => Place::Fig5,
            InjectionRule | NoModelError | StiffnessTooHigh | MassesTooLow | DifferenceRemains => {
                Place::Fig6
            }
            AddedOffsetSeen | EstimateDecreases | DecreaseExplained | RelaxedRopeSeen
            | RetensioningRestores => Place::Fig7,
        }
    }

    /// What it says.
    pub fn text(self) -> &'static str {
        use Claim::*;
        match self {
            OffsetEquation => {
                "A stretched rope shifts the measured motor position by delta_e = theta_measured − q − tau_el/K (eq. 4 to 6)."
            }
            MomentumObserver => {
                "The elastic torque follows from the generalised momentum (eq. 7), without accelerations."
            }
            TorqueSensor => "With a joint torque sensor, eq. (5) and (6) give the offset directly.",
            MotorSide => "The motor's own equation (2) would need the motor's friction.",
            SpoilsPosition => "Elongation spoils the position of the joint.",
            SpoilsTorque => "Elongation spoils the torque that the robot feels.",
            ExternalForces => {
                "If the external forces are not known, the position offset is overestimated."
            }
            Ropes => "Nine ropes, with breaking load, plait and weight as far as known.",
            TensileTest => {
                "Tensile creep after ISO 899-1: 60 N, 350 mm, 85 min, standard atmosphere 23/50."
            }
            Saturates => "Every rope saturates with a small remaining slope.",
            DiameterNoMeasure => {
                "A larger diameter or breaking load does not mean less elongation: SK99 Ultra at 2 mm is worse than thinner ropes."
            }
            ThinRopesAlike => "Ropes under 2 mm end within almost 0.2 % of each other.",
            CordAndClimax => {
                "The aramid cord and Climax Combat have almost the same slope, although the cord ends far higher."
            }
            SmallestSlopes => "Technora and Vectran have the smallest slopes.",
            WarmAlike => {
                "At 60 °C all except Liros SK99 reach an elongation similar to that at 23 °C."
            }
            WarmSlopesRise => "Technora's and Vectran's slopes rise only a little.",
            WarmSlopesFall => "SK99's and DM20's slopes fall strongly.",
            WarmHalf => "Liros SK99 ends at about half its value at 23 °C.",
            BenchMeasures => {
                "The elongation is read from the carriage, by camera on a half-millimetre scale."
            }
            DistinctPortions => "In (C) distinct portions of the rope are stressed.",
            BendingOrder => "Order of the final elongation: A < C < D < B.",
            BendingSaturates => "All of A to D saturate.",
            RunTwice => "Each case was run twice.",
            LessForceDrops => "(E) 200 N, then 120 N: the elongation drops.",
            LessForceIrreversible => "(E) A part of the elongation is irreversible.",
            MoreForceRises => "(F) 120 N, then 200 N: the elongation rises over a longer time.",
            InjectionRule => {
                "The offset is added to the motor position where that is larger than the offset, else nothing is added."
            }
            NoModelError => "Without model error the estimate shows the added offset.",
            StiffnessTooHigh => {
                "With the stiffness overestimated by 20 % the estimate departs from the added offset."
            }
            MassesTooLow => {
                "With M, C and g underestimated by 10 % the estimate departs from the added offset."
            }
            DifferenceRemains => {
                "The difference of two estimates still shows by how much the offset grew, in all three cases."
            }
            AddedOffsetSeen => "On the robot the difference of two runs shows the added 0.01 rad.",
            EstimateDecreases => "The estimate decreases while the elbow climbs.",
            DecreaseExplained => {
                "The joint torque is overestimated, the stiffness underestimated, or both."
            }
            RelaxedRopeSeen => "The rope relaxed by about 0.5 mm at the tensioner shows.",
            RetensioningRestores => "Re-tensioning restores the first estimate.",
        }
    }

    /// Why no data of ours judge it; `None` where they do.
    pub fn not_judged(self) -> Option<&'static str> {
        use Claim::*;
        Some(match self {
            OffsetEquation => {
                "A definition. Plant and estimator both rest on it, so that no simulation can fail it."
            }
            MomentumObserver => {
                "Judged by what follows from it: without model error the estimate shows the added offset (fig6)."
            }
            TensileTest => {
                "A procedure. Load, length and time are those of fig1; the law knows no humidity."
            }
            BenchMeasures => {
                "A procedure. The virtual bench reads without error; differences below 0.1 mm (0.017 % of a strand) would not be seen with the scale. `sinew bench read-camera` reads such pictures."
            }
            DistinctPortions => {
                "Geometry, not a result: fig4 tables which length passes how many pulleys."
            }
            RunTwice => "The law has no scatter from specimen to specimen.",
            InjectionRule => {
                "A procedure. It is read as: nothing is added where the motor position is not larger than the offset."
            }
            _ => return None,
        })
    }

    /// Sentences of these parts of the paper that no data judge, each with the reason.
    pub(super) fn not_judged_in(places: &[Place]) -> Vec<String> {
        Self::ALL
            .into_iter()
            .filter(|claim| places.contains(&claim.place()))
            .filter_map(|claim| Some(format!("{} {}", claim.text(), claim.not_judged()?)))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_claim_stands_once_in_the_list() {
        let mut seen = std::collections::HashSet::new();
        for claim in Claim::ALL {
            assert!(seen.insert(claim), "{claim:?} twice");
        }
        // The last variant's number is that of the others before it.
        assert_eq!(seen.len(), Claim::RetensioningRestores as usize + 1);
    }
}
