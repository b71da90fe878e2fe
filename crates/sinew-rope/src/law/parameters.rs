//! Parameters of the rope law, one by one and by name.

use super::ParameterError;

/// Material of the load-bearing fibres or wires.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Polymer {
    /// High-modulus polyethylene (Dyneema, Spectra).
    Hmpe,
    /// Aramid (Technora, Twaron, Kevlar).
    Aramid,
    /// Liquid-crystal polymer (Vectran).
    Lcp,
    /// Steel wires. Of the law elastic strain, permanent stretch of the construction, friction and bending
    /// apply; delayed elasticity, flow and heat retraction are none.
    Steel,
    /// Tungsten wires; as steel.
    Tungsten,
    /// Any other material.
    Other,
}

impl Polymer {
    /// Name as a catalogue writes it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Polymer::Hmpe => "HMPE",
            Polymer::Aramid => "aramid",
            Polymer::Lcp => "LCP",
            Polymer::Steel => "steel",
            Polymer::Tungsten => "tungsten",
            Polymer::Other => "other",
        }
    }
}

macro_rules! parameters {
    ($($(#[doc = $doc:literal])* $field:ident $variant:ident $low:expr, $high:expr, $must:literal;)*) => {
        /// Parameters of the rope law; symbols as in [`crate::law`].
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub struct Parameters {
            /// Material of the fibre; selects the validity limits.
            pub polymer: Polymer,
            $($(#[doc = $doc])* pub $field: f64,)*
        }

        /// Parameter of the creep law by name, for catalogues, draws and fits.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[non_exhaustive]
        pub enum Parameter {
            $($(#[doc = $doc])* $variant,)*
        }

        impl Parameter {
            /// All of them, in the order of [`Parameters`].
            pub const ALL: &'static [Parameter] = &[$(Parameter::$variant,)*];

            /// Name with its unit, as in the catalogue.
            #[must_use]
            pub fn name(self) -> &'static str {
                match self { $(Parameter::$variant => stringify!($field),)* }
            }

            /// Symbol and meaning, in the Markdown of its documentation.
            #[must_use]
            pub fn meaning(self) -> &'static str {
                match self { $(Parameter::$variant => concat!($($doc),*).trim_ascii(),)* }
            }

            /// Smallest and largest value taken.
            #[must_use]
            pub fn range(self) -> (f64, f64) {
                match self { $(Parameter::$variant => ($low, $high),)* }
            }

            /// Permitted values, for messages and the manual.
            #[must_use]
            pub fn must(self) -> &'static str {
                match self { $(Parameter::$variant => $must,)* }
            }
        }

        impl Parameters {
            /// All zero: no rope, but something to set parameters of.
            pub(super) fn zero(polymer: Polymer) -> Self {
                Self { polymer, $($field: 0.0,)* }
            }

            /// Value of a parameter.
            #[must_use]
            pub fn get(&self, parameter: Parameter) -> f64 {
                match parameter { $(Parameter::$variant => self.$field,)* }
            }

            /// Sets a parameter without a check; [`Parameters::check`] validates it.
            pub fn set(&mut self, parameter: Parameter, value: f64) {
                match parameter { $(Parameter::$variant => self.$field = value,)* }
            }
        }
    };
}

/// Above this, an exponential of finite inputs could overflow; far beyond any rope.
const HUGE: f64 = 1e12;
/// Smallest value of a parameter that must be above 0.
const TINY: f64 = 1e-12;

parameters! {
    /// `MBL`: breaking load, to which the load ratio `λ = T/MBL` refers, N.
    breaking_load_n BreakingLoad TINY, HUGE, "above 0";
    /// `k`: elastic strain is `100 λ/k` %.
    elastic_k ElasticK TINY, HUGE, "above 0";
    /// `e_t`: strain of the elastic toe, %.
    toe_percent Toe 0.0, 100.0, "0 to 100";
    /// `λ_t`: load ratio of the toe.
    toe_load_ratio ToeLoadRatio 1e-6, HUGE, "at least 1e-6";
    /// `B`: full bedding-in without guiding pulleys, %.
    bedding_percent Bedding 0.0, 100.0, "0 to 100";
    /// `λ_b`: load ratio of the bedding-in.
    bedding_load_ratio BeddingLoadRatio 1e-6, HUGE, "at least 1e-6";
    /// `τ_b`: time of the bedding-in before it jams, s.
    bedding_time_s BeddingTime 1e-3, HUGE, "at least 1e-3";
    /// `κ`: jamming of the bedding-in.
    jamming Jamming 0.0, super::bedding::JAMMING_MAX, "0 to 30";
    /// `E_b`: activation energy of the bedding-in, J/mol.
    bedding_energy_j_per_mol BeddingEnergy 0.0, 1e6, "0 to 1e6";
    /// `g_N`: how much one guiding pulley adds to the bedding-in.
    pass_gain PassGain 0.0, 1e3, "0 to 1000";
    /// `q`: exponent of the effect of several guiding pulleys on one section.
    pass_exponent PassExponent 0.0, 5.0, "0 to 5";
    /// `J`: delayed strain per decade of time, % per unit of `λ`.
    delayed_percent Delayed 0.0, 1e3, "0 to 1000";
    /// `E_v`: activation energy of the delayed elasticity, J/mol.
    delayed_energy_j_per_mol DelayedEnergy 0.0, 1e6, "0 to 1e6";
    /// `j`: growth of `J` with temperature, 1/K: `J(θ) = J (1 + j (θ − T_ref))`, at least 0.
    delayed_per_k DelayedPerK -0.1, 0.1, "−0.1 to 0.1";
    /// `A₀`: rate of fibre flow at `T_ref`, 1/s.
    flow_rate_per_s FlowRate 0.0, 1.0, "0 to 1";
    /// `E_f`: activation energy of fibre flow, J/mol.
    flow_energy_j_per_mol FlowEnergy 0.0, 1e6, "0 to 1e6";
    /// `σ₀`: activation stress of fibre flow, MPa.
    flow_stress_mpa FlowStress 10.0, 1e6, "10 to 1e6";
    /// `σ_b`: stress of the fibres at the breaking load, MPa.
    breaking_stress_mpa BreakingStress 0.0, 4e3, "0 to 4000";
    /// `S`: full heat retraction, %.
    retraction_percent Retraction 0.0, 100.0, "0 to 100";
    /// `τ_s`: time of the heat retraction, s.
    retraction_time_s RetractionTime 1e-3, HUGE, "at least 1e-3";
    /// `λ_s`: load ratio at which the heat retraction falls to 1/e.
    retraction_load_ratio RetractionLoadRatio 1e-6, HUGE, "at least 1e-6";
    /// `α_θ`: thermal expansion along the rope, 1/K.
    expansion_per_k Expansion -1e-3, 1e-3, "−1e-3 to 1e-3";
    /// `μ`: friction of the rope on a guiding pulley.
    friction Friction 0.0, 2.0, "0 to 2";
    /// `N_ref`: passes over a pulley of 20 rope diameters at a tenth of the breaking load that the rope
    /// survives.
    bend_life_passes BendLife 1.0, HUGE, "at least 1";
    /// `m_D`: power of pulley diameter over rope diameter in the number of passes survived.
    bend_ratio_exponent BendRatioExponent 0.0, 10.0, "0 to 10";
    /// `m_λ`: power of one over the load ratio in the number of passes survived.
    bend_load_exponent BendLoadExponent 0.0, 10.0, "0 to 10";
    /// `n`: power of `λ d/D` in the bedding-in of one pass over a pulley ([`super::damage::pass_cost`]).
    pass_pressure_exponent PassPressureExponent 0.0, 5.0, "0 to 5";
}

impl Parameters {
    /// Whether the law can be built of these.
    ///
    /// # Errors
    /// [`ParameterError`] with the first value out of its range.
    pub fn check(&self) -> Result<(), ParameterError> {
        for &parameter in Parameter::ALL {
            let value = self.get(parameter);
            let (low, high) = parameter.range();
            if !(low..=high).contains(&value) {
                return Err(ParameterError {
                    name: parameter.name(),
                    value,
                    must: parameter.must(),
                });
            }
        }
        Ok(())
    }
}
