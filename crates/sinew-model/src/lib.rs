//! Arm, transmission, momentum observer and tendon offset.
