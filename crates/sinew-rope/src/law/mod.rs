//! Creep law of a rope, common to bench, fit, prediction and forecast.
//!
//! Strain in percent of the unloaded, new rope, `λ = T/MBL` tension over breaking load, `θ`
//! absolute temperature, `T_ref` = 296.15 K, `a_x(θ) = exp[E_x/R (1/T_ref − 1/θ)]`:
//!
//! ```text
//! ε = ε_el + b + Σ v_i + f − s + 100 α_θ (θ − T_ref)
//! elastic            ε_el = 100 λ/k + e_t (1 − exp(−λ/λ_t))                 at once, recovers
//! bedding-in         b∞ = B' (1 − exp(−λ/λ_b)),  B' = B (1 + g_N N^q)
//!                    ḃ = (a_b/τ_b) ⟨b∞ − b⟩₊ exp(−κ b/B')                   never recovers
//! delayed elasticity v̇_i = a_v (J(θ) λ − v_i)/τ_i,   τ_i = 10, 10², … 10⁵ s recovers slowly
//! fibre flow         ḟ = 100 A₀ a_f sinh(σ/σ₀),  σ = λ σ_b                  never recovers
//! heat retraction    ṡ = (S g(θ) exp(−λ/λ_s) − s)/τ_s
//! ```
//!
//! ```text
//!  ε │            ______ f: straight on, for years
//!    │       ,---'
//!    │    ,-'   b, Σv: fast, then jammed        ┐
//!    │  ,'                                      │ unloaded: ε_el at once,
//!    │ /                                        │ Σv within hours,
//!    │ε_el                                      ┘ b + f stay
//!    └────────────────── t
//! ```
//!
//! Every part is solved *exactly* over a segment of constant tension and temperature ([`Law::hold`]),
//! so the length of a step does not matter; over a segment where both are linear
//! ([`ramp()`]) the error is controlled to [`RAMP_TOLERANCE_PERCENT`].
//!
//! [`routing`] turns guiding pulleys into tensions and pass counts, [`damage`] counts bends over pulleys,
//! [`endurance`] models failure, [`strung`] lets ropes relax at constant length, [`validity`] checks the
//! validity limits, [`tested_range`] describes the tested range of a rope's data, [`entry`] reads a catalogue entry.
//!
//! Not modelled: humidity, ultraviolet light, abrasion, shock.
//!
//! # Source
//! The elements are those of the paper's discussion (section III) and of the rope literature
//! (Eyring flow of oriented polyethylene; bedding-in and delayed elasticity of braids); how they
//! are put together is our own.

pub mod bedding;
pub mod damage;
pub mod endurance;
pub mod entry;

mod error;
mod exponential;
mod factors;
mod parameters;
mod ramp;
mod rope_law;
pub mod routing;
mod state;
pub mod strung;
pub mod tested_range;
pub mod validity;

pub use error::{LoadError, ParameterError};
pub use parameters::{Parameter, Parameters, Polymer};
pub(crate) use ramp::bedded_over;
pub use ramp::{RAMP_TOLERANCE_PERCENT, ramp};
pub use rope_law::{Law, Rates, RopeLoad, retraction_share};
pub use state::{DELAY_TIMES_S, State, Strain};

/// Gas constant, J/(mol·K) (CODATA 2018, exact).
pub const GAS_CONSTANT: f64 = 8.314_462_618_153_24;
/// Temperature the rates are stated at, K: standard atmosphere 23/50 of ISO 291.
pub const REFERENCE_K: f64 = 296.15;
/// 0 °C, K.
pub const CELSIUS_ZERO_K: f64 = 273.15;
