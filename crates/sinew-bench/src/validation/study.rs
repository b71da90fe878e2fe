//! The studies of the page.

/// Study behind a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Study {
    /// Name in the data file.
    pub name: &'static str,
    /// Commands without number and seed, for the folder of the repository; their results are joined.
    pub commands: &'static [&'static str],
    /// Option of the number, and its value.
    pub n: Option<(&'static str, u64)>,
    /// Seed of the first draw.
    pub seed: Option<u64>,
    /// Kind of its rows in the data file.
    pub rows: &'static str,
    /// Place of its results.
    pub source: Source,
}

/// Place of a study's results.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Source {
    /// Key of the JSON documents of the commands.
    Key(&'static str),
    /// Direct calls of [`extrapolate`](crate::year::extrapolate).
    Extrapolations,
}

impl Study {
    /// Returns the complete commands for `n` draws.
    pub fn commands(&self, n: Option<u64>) -> Vec<String> {
        let number = self
            .n
            .zip(n)
            .map(|((option, _), n)| format!(" {option} {n}"));
        let seed = self.seed.map(|seed| format!(" --seed {seed}"));
        let options = number.unwrap_or_default() + &seed.unwrap_or_default();
        let commands = self.commands.iter();
        commands.map(|c| format!("{c}{options}")).collect()
    }

    const fn scenarios(
        name: &'static str,
        commands: &'static [&'static str],
        n: u64,
        seed: u64,
    ) -> Self {
        Self {
            name,
            commands,
            n: Some(("--n", n)),
            seed: Some(seed),
            rows: "scenarios",
            source: Source::Key("scenarios"),
        }
    }

    const fn years(name: &'static str, commands: &'static [&'static str], robots: u64) -> Self {
        Self {
            n: Some(("--robots", robots)),
            rows: "years",
            source: Source::Key("summary"),
            ..Self::scenarios(name, commands, 0, 9201)
        }
    }
}

/// All studies of the page.
pub const STUDIES: [Study; 11] = [
    Study::scenarios(
        "coverage",
        &["sinew-bench scenarios run --no-steps"],
        200,
        3000,
    ),
    Study::scenarios(
        "stress",
        &[
            "sinew-bench scenarios run --no-steps --scenario S8b --scenario S9 --scenario S9b --scenario S9c",
        ],
        40,
        5000,
    ),
    Study::scenarios(
        "other-arms",
        &[
            "sinew-bench scenarios run --no-steps --robot crates/sinew-bench/arms/arm4",
            "sinew-bench scenarios run --no-steps --robot crates/sinew-bench/arms/ur5",
            "sinew-bench scenarios run --no-steps --robot crates/sinew-bench/arms/panda",
            "sinew-bench scenarios run --no-steps --robot crates/sinew-bench/arms/so101",
        ],
        40,
        3000,
    ),
    Study::scenarios(
        "slips",
        &["sinew-bench scenarios run --scenario S5 --scenario S7 --scenario S8 --scenario S9"],
        80,
        3000,
    ),
    Study {
        rows: "trajectories",
        ..Study::scenarios(
            "online",
            &[
                "sinew-bench scenarios run --trajectory --scenario S5 --scenario S6 --scenario S7 --scenario S8 --scenario S9b",
            ],
            20,
            8501,
        )
    },
    Study::years(
        "years-check",
        &["sinew-bench trend-simulate --robot robots/biorob-like --chain --session check"],
        25,
    ),
    Study::years(
        "years-work",
        &["sinew-bench trend-simulate --robot robots/biorob-like --chain --session work"],
        30,
    ),
    Study {
        name: "extrapolation",
        commands: &["sinew-bench validation --only extrapolation"],
        n: Some(("--n", 400)),
        seed: None,
        rows: "extrapolations",
        source: Source::Extrapolations,
    },
    Study {
        name: "creep-fits",
        commands: &[
            "sinew creep fit ../shared/data/creep/ferrara_wittel_spruce_creep/ve_creep_all.csv --hold-out 0.33",
        ],
        n: None,
        seed: None,
        rows: "hold-outs",
        source: Source::Key("held_out"),
    },
    Study::scenarios(
        "unmodelled",
        &["sinew-bench scenarios run --unmodelled --no-steps"],
        12,
        3000,
    ),
    Study::scenarios(
        "variants",
        &["sinew-bench scenarios run --variants"],
        20,
        4000,
    ),
];
