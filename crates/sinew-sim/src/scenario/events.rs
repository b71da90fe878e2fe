//! Keys of the events in a scenario: payloads, contacts, offsets, seized joints, transmission errors.

use super::draw::{Draw, Keys as _};
use super::*;
use sinew_files::{Bound, Fields as _, Located, Section};

fn link(s: &Section<'_>) -> Result<String, Located> {
    s.text("link")?
        .ok_or_else(|| s.missing("link", "a link of the URDF, such as \"tool\""))
}

pub(super) fn payload(s: &Section<'_>) -> Result<Payload, Located> {
    let attach_s = s.number("attach_s", Bound::NotNegative)?.unwrap_or(0.0);
    let release_s = s
        .number("release_s", Bound::NotNegative)?
        .unwrap_or(f64::INFINITY);
    if release_s <= attach_s {
        return Err(s.invalid("release_s", "later than attach_s"));
    }
    let com_spread_m = s.vec3("com_spread_m")?.unwrap_or([0.0; 3]);
    if com_spread_m.iter().any(|x| *x < 0.0) {
        return Err(s.invalid("com_spread_m", "0 or more in every direction"));
    }
    Ok(Payload {
        link: link(s)?,
        line: s.line(),
        mass_kg: s
            .draw("mass_kg", Bound::NotNegative)?
            .ok_or_else(|| s.missing("mass_kg", "mass of the payload"))?,
        com_m: s.vec3("com_m")?.unwrap_or([0.0; 3]),
        com_spread_m,
        attach_s,
        release_s,
    })
}

pub(super) fn contact(s: &Section<'_>) -> Result<Contact, Located> {
    Ok(Contact {
        start_s: s.need("start_s", Bound::NotNegative, "start time")?,
        duration_s: s.need("duration_s", Bound::Positive, "duration")?,
        link: link(s)?,
        line: s.line(),
        point_m: s.vec3("point_m")?.unwrap_or([0.0; 3]),
        force_n: s
            .vec3("force_n")?
            .ok_or_else(|| s.missing("force_n", "force [x, y, z] in the base frame"))?,
        rise_s: s.number("rise_s", Bound::NotNegative)?.unwrap_or(0.0),
    })
}

pub(super) fn random_contacts(s: &Section<'_>) -> Result<RandomContacts, Located> {
    let from = s.number("from_s", Bound::NotNegative)?.unwrap_or(0.0);
    let to = s
        .number("to_s", Bound::NotNegative)?
        .unwrap_or(f64::INFINITY);
    if to <= from {
        return Err(s.invalid("to_s", "later than from_s"));
    }
    Ok(RandomContacts {
        fraction: s.need("fraction", Bound::Within(0.0, 0.95), "share of the time")?,
        link: link(s)?,
        line: s.line(),
        point_m: s.vec3("point_m")?.unwrap_or([0.0; 3]),
        force_n: s
            .draw("force_n", Bound::NotNegative)?
            .ok_or_else(|| s.missing("force_n", "size, { min = …, max = … }"))?,
        duration_s: s
            .draw("duration_s", Bound::Positive)?
            .ok_or_else(|| s.missing("duration_s", "duration, { min = …, max = … }"))?,
        rise_s: s.number("rise_s", Bound::NotNegative)?.unwrap_or(0.0),
        from_to_s: (from, to),
    })
}

pub(super) fn offset(s: &Section<'_>) -> Result<Offset, Located> {
    let kind = match s.text("kind")?.as_deref() {
        Some("injected") => OffsetKind::Injected,
        Some("physical") => OffsetKind::Physical,
        Some("motor-encoder") => OffsetKind::MotorEncoder,
        Some("joint-encoder") => OffsetKind::JointEncoder,
        _ => {
            let must = "\"injected\" (added to the recording, as the paper does), \"physical\" (the rope is longer), \"motor-encoder\" or \"joint-encoder\" (encoder slip)";
            return Err(s.invalid("kind", must));
        }
    };
    let time = |key, reason| s.need(key, Bound::NotNegative, reason);
    let mut later_s = Draw::Fixed(0.0);
    let mut size = s.draw("rad", Bound::Within(-1.0, 1.0))?;
    let shapes = "\"constant\", \"step\", \"ramp\", \"exponential\" or \"table\"";
    let shape = match s.text("shape")?.as_deref() {
        None | Some("constant") => Shape::Constant,
        Some("step") => {
            let at = s.draw("at_s", Bound::NotNegative)?;
            match at.ok_or_else(|| s.missing("at_s", "time of the step"))? {
                Draw::Fixed(at_s) => Shape::Step { at_s },
                drawn => {
                    later_s = drawn;
                    Shape::Step { at_s: 0.0 }
                }
            }
        }
        Some("ramp") => {
            let from_s = time("from_s", "start time")?;
            let to_s = time("to_s", "end time")?;
            if to_s <= from_s {
                return Err(s.invalid("to_s", "later than from_s"));
            }
            Shape::Ramp { from_s, to_s }
        }
        Some("exponential") => Shape::Exponential {
            from_s: s.number("from_s", Bound::NotNegative)?.unwrap_or(0.0),
            time_constant_s: s.need("time_constant_s", Bound::Positive, "time constant")?,
        },
        Some("table") => {
            size = Some(size.unwrap_or(Draw::Fixed(1.0)));
            Shape::Table(
                s.pairs("table_s_rad", Bound::Within(-1.0, 1.0))?
                    .ok_or_else(|| s.missing("table_s_rad", "pairs [time, offset]"))?,
            )
        }
        Some(_) => return Err(s.invalid("shape", shapes)),
    };
    let (joint, tendon) = (s.text("joint")?, s.text("tendon")?);
    if tendon.is_some() {
        if joint.is_some() {
            return Err(s.invalid("tendon", "omitted if joint is given"));
        }
        if kind == OffsetKind::JointEncoder {
            return Err(s.invalid("tendon", "joint of the slipped encoder"));
        }
    }
    Ok(Offset {
        joint: tendon
            .or(joint)
            .ok_or_else(|| s.missing("joint", "joint of the elongated tendon, or tendon"))?,
        line: s.line(),
        kind,
        size_rad: size.ok_or_else(|| s.missing("rad", "size of the offset"))?,
        shape,
        later_s,
    })
}

pub(super) fn jam(s: &Section<'_>) -> Result<Jam, Located> {
    let from_s = s.number("from_s", Bound::NotNegative)?.unwrap_or(0.0);
    let to_s = s
        .number("to_s", Bound::NotNegative)?
        .unwrap_or(f64::INFINITY);
    if to_s <= from_s {
        return Err(s.invalid("to_s", "later than from_s"));
    }
    Ok(Jam {
        joint: s
            .text("joint")?
            .ok_or_else(|| s.missing("joint", "joint that is seized"))?,
        line: s.line(),
        torque_nm: s.need("torque_nm", Bound::NotNegative, "torque that moves it")?,
        from_s,
        to_s,
    })
}

pub(super) fn stop(s: &Section<'_>) -> Result<Stop, Located> {
    let upper = s.number("upper_rad", Bound::Any)?;
    let lower = s.number("lower_rad", Bound::Any)?;
    let (at_rad, is_upper) = match (upper, lower) {
        (Some(at), None) => (at, true),
        (None, Some(at)) => (at, false),
        (None, None) => return Err(s.missing("upper_rad", "position of the stop, or lower_rad")),
        (Some(_), Some(_)) => {
            return Err(s.invalid(
                "upper_rad",
                "omitted if lower_rad is given; use one table per stop",
            ));
        }
    };
    Ok(Stop {
        joint: s
            .text("joint")?
            .ok_or_else(|| s.missing("joint", "joint that it limits"))?,
        line: s.line(),
        at_rad,
        is_upper,
        stiffness_nm_per_rad: s.number("stiffness_nm_per_rad", Bound::Positive)?,
    })
}

pub(super) fn session(s: &Section<'_>) -> Result<Session, Located> {
    let from_s = s.need("from_s", Bound::NotNegative, "start time")?;
    let to_s = s.need("to_s", Bound::Positive, "end time")?;
    if to_s <= from_s {
        return Err(s.invalid("to_s", "later than from_s"));
    }
    Ok(Session {
        name: s
            .text("name")?
            .ok_or_else(|| s.missing("name", "name of the session"))?,
        from_s,
        to_s,
    })
}

pub(super) fn record(s: &Section<'_>) -> Result<Record, Located> {
    Ok(Record {
        dq: s.flag("dq")?,
        tau_el: s.flag("tau_el")?,
        tau_m: s.flag("tau_m")?,
        tau_ext: s.flag("tau_ext")?,
        tension: s.flag("tension")?,
        temperature: s.flag("temperature")?,
    })
}

pub(super) fn faults(s: &Section<'_>) -> Result<Faults, Located> {
    let share = |key| -> Result<f64, Located> {
        Ok(s.number(key, Bound::Within(0.0, 0.9))?.unwrap_or(0.0))
    };
    Ok(Faults {
        dropout_fraction: share("dropout_fraction")?,
        duplicate_fraction: share("duplicate_fraction")?,
        late_fraction: share("late_fraction")?,
        gaps_s: s.each("gaps", |gap| {
            Ok((
                gap.need("start_s", Bound::NotNegative, "start time")?,
                gap.need("duration_s", Bound::Positive, "duration")?,
            ))
        })?,
    })
}
