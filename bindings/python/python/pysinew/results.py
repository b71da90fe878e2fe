"""What Sinew answers, as types: SI, with standard deviations.

Made by `bindings/python/generate` from the schemas in `docs/schema/`; don't edit.
"""

from __future__ import annotations

from typing import Any, Literal, Mapping, Union

from ._record import GaussianRecord, Record


class Ambiguity(Record):
    """Ambiguous topics; the user has to select one."""

    __slots__ = ()

    candidates: list[str]
    """Candidate topics of the side."""
    file: str
    """File as the user named it."""
    side: TopicUse
    """Ambiguous side of the robot."""

    _fields = {
        "candidates": "",
        "file": "",
        "side": "",
    }


class Analysis(Record):
    """Analysis of one specimen's record."""

    __slots__ = ()

    artefacts: list[Artefact]
    """Artefacts found in the record."""
    creep_strain_ratio: float
    """Strain increase from one minute (or the first measurement after it) to the end, m/m."""
    duration_s: float
    """Duration of the first stage, s."""
    end_strain_ratio: float
    """Strain at the end of the first stage, m/m."""
    force_n: float | None
    """Load of the first stage, N."""
    group: str | None
    """Group of repeats of the specimen."""
    humidity_percent: Span | None
    """Relative humidity or moisture as recorded, %."""
    name: str
    """Name of the specimen."""
    no_slope: NoSlope | None
    """Reason why there is no slope."""
    preload_n: float | None
    """Preload before the first stage, N."""
    readings: list[IsoMeasurement]
    """Measurements at the standard times of ISO 899-1 within the first stage."""
    recovery: list[Recovery]
    """Recoveries after decreases of the load."""
    saturated: bool | None
    """Whether, at this slope, another such duration would add less than 10 % of the creep so far."""
    saturation_s: float | None
    """Time after which less than 5 % of the recorded creep remains, s."""
    slope_per_s: Bounded | None
    """Slope `m_E` of the paper: straight line from `AnalyzeOptions::slope_from_s` on, 1/s; its interval accounts
    for the correlation of neighbouring residuals.
    """
    stress_pa: float | None
    """Stress of the first stage, Pa."""
    temperature_c: Span | None
    """Temperature of the record, °C."""
    zero: StrainZero
    """Reference of the strain zero."""

    _fields = {
        "artefacts": "Artefact",
        "creep_strain_ratio": "",
        "duration_s": "",
        "end_strain_ratio": "",
        "force_n": "",
        "group": "",
        "humidity_percent": "Span",
        "name": "",
        "no_slope": "NoSlope",
        "preload_n": "",
        "readings": "IsoMeasurement",
        "recovery": "Recovery",
        "saturated": "",
        "saturation_s": "",
        "slope_per_s": "Bounded",
        "stress_pa": "",
        "temperature_c": "Span",
        "zero": "StrainZero",
    }


class Arrhenius(Record):
    """Arrhenius equation `ln a_T = E/R (1/T − 1/T_ref)`."""

    __slots__ = ()

    energy_j_per_mol: float
    """Activation energy `E`, J/mol."""
    residual_rms_decades: float
    """Root mean square residual of log10 a_T, decades."""

    _fields = {
        "energy_j_per_mol": "",
        "residual_rms_decades": "",
    }


class ArtefactDuplicateTimestamps(Record):
    """Measurements with duplicate time stamps under one load; all are used."""

    __slots__ = ()

    kind: Literal["duplicate-timestamps"]
    readings: int
    """Number of such measurements."""

    _fields = {
        "kind": "",
        "readings": "",
    }


class ArtefactGap(Record):
    """Missing or non-finite measurements; rejected."""

    __slots__ = ()

    kind: Literal["gap"]
    readings: int
    """Number of such measurements."""

    _fields = {
        "kind": "",
        "readings": "",
    }


class ArtefactImplausibleStrain(Record):
    """Possible strain that suggests another unit."""

    __slots__ = ()

    kind: Literal["implausible-strain"]
    strain_ratio: float
    """Largest strain, m/m."""

    _fields = {
        "kind": "",
        "strain_ratio": "",
    }


class ArtefactImplausibleTime(Record):
    """Possible duration that suggests another unit of time."""

    __slots__ = ()

    duration_s: float
    """Duration of the record, s."""
    kind: Literal["implausible-time"]

    _fields = {
        "duration_s": "",
        "kind": "",
    }


class ArtefactInterpolated(Record):
    """Measurements on straight lines between others, to the rounding of the file: interpolated, not measured."""

    __slots__ = ()

    kept: bool
    """Whether they were kept in the measurements."""
    kind: Literal["interpolated"]
    readings: int
    """Number of such measurements."""
    recorded: int
    """Number of the other measurements."""

    _fields = {
        "kept": "",
        "kind": "",
        "readings": "",
        "recorded": "",
    }


class ArtefactLoadDrift(Record):
    """Load drift on a plateau beyond the limit of ISO 899-1 (1 %)."""

    __slots__ = ()

    drift_share: float
    """Largest deviation from the median, as a share of it."""
    kind: Literal["load-drift"]
    load_n: float
    """Median of the load, N."""
    time_s: float
    """Start of the plateau, s."""

    _fields = {
        "drift_share": "",
        "kind": "",
        "load_n": "",
        "time_s": "",
    }


class ArtefactNoForce(Record):
    """Missing force: a constant load from the first measurement on is assumed."""

    __slots__ = ()

    kind: Literal["no-force"]

    _fields = {
        "kind": "",
    }


class ArtefactNoRamp(Record):
    """Record that starts under load, without ramp and zero."""

    __slots__ = ()

    kind: Literal["no-ramp"]

    _fields = {
        "kind": "",
    }


class ArtefactNonMonotonicTime(Record):
    """Measurements older than the previous one; rejected."""

    __slots__ = ()

    kind: Literal["non-monotonic-time"]
    readings: int
    """Number of such measurements."""

    _fields = {
        "kind": "",
        "readings": "",
    }


class ArtefactOutlier(Record):
    """Single outlier of the strain."""

    __slots__ = ()

    kept: bool
    """Whether it was kept in the measurements."""
    kind: Literal["outlier"]
    time_s: float
    """Time of the outlier, s."""

    _fields = {
        "kept": "",
        "kind": "",
        "time_s": "",
    }


class ArtefactShortens(Record):
    """Rope that is shorter under load than before it."""

    __slots__ = ()

    kind: Literal["shortens"]
    strain_ratio: float
    """Strain at the end of the first stage, m/m."""

    _fields = {
        "kind": "",
        "strain_ratio": "",
    }


class ArtefactSlip(Record):
    """Strain step under constant load: grip slip."""

    __slots__ = ()

    kept: bool
    """Whether it was kept in the measurements."""
    kind: Literal["slip"]
    strain_ratio: float
    """Height of the step, m/m."""
    time_s: float
    """Time of the step, s."""

    _fields = {
        "kept": "",
        "kind": "",
        "strain_ratio": "",
        "time_s": "",
    }


class ArtefactSlowRamp(Record):
    """Load ramp slower than 5 s."""

    __slots__ = ()

    kind: Literal["slow-ramp"]
    ramp_s: float
    """Duration of the ramp, s."""
    time_s: float
    """Start of the ramp, s."""

    _fields = {
        "kind": "",
        "ramp_s": "",
        "time_s": "",
    }


class BaselineMergeResult(Record):
    """Summary of merged baselines: prior and posterior of the parameters."""

    __slots__ = ()

    nuisance: list[NuisanceChange]
    """Prior and posterior of each nuisance parameter."""
    recordings: list[str]
    """Names of all recordings that the result is based on."""
    robot: str
    """Name of the robot."""
    schema: Literal["sinew/baseline-merge/2"]
    """Name and number of this schema."""
    temperature_c: float | None
    """Reference temperature of offsets and stiffness, °C; `None` if unknown."""

    _fields = {
        "nuisance": "NuisanceChange",
        "recordings": "",
        "robot": "",
        "schema": "",
        "temperature_c": "",
    }


class BaselineResult(Record):
    """Result of a recording taken directly after tensioning, from which a baseline was estimated."""

    __slots__ = ()

    baseline: str | None
    """Name of the first recording of the baseline; `None` without a baseline (priors from data sheets only)."""
    baseline_time_utc_s: float | None
    """End of that recording, when every offset was zero, s since 1970 UTC; `None` if its clock has no date."""
    damaged: bool
    """Whether data was lost because the file is damaged."""
    duration_s: float
    """Duration of the evaluated interval, s."""
    external_force: ForceEstimate | None
    """Constant external force at the tool; `None` if none was detected. For a recording of several segments, the
    force of the segment with the highest probability.
    """
    joint_offsets: list[JointOffset] | None
    """Offsets of joints that are driven by several tendons or by strands; empty on other robots, and if a strand
    may be slack.
    """
    joints: list[TendonEstimate]
    """Results of the tendons, one entry per elastic joint."""
    motor_torque: MotorTorque
    """Source of the motor torque that was used as an independent measurement."""
    nuisance: list[NuisanceChange]
    """Prior and posterior of each nuisance parameter."""
    online: OnlineTrajectory | None
    """Online estimate of the same recording; `None` if not requested."""
    payload_changes: list[PayloadChange]
    """Payload changes within the recording."""
    payload_kg: Gaussian
    """Payload mass at the end of the recording, kg."""
    poses: int
    """Number of distinct poses, at rest or in motion; poses are distinct if a joint differs by more than 0.2
    rad.
    """
    recording: str
    """Name of the recording."""
    reference_temperature_c: float | None
    """Reference temperature of the offsets, °C; `None` if unknown."""
    rejected_intervals: list[RejectedInterval]
    """Longest intervals that were rejected as contact or disturbance, at most 20."""
    rejected_share: float
    """Share of the time that was rejected as contact or disturbance, 0 to 1."""
    robot: str
    """Name of the robot."""
    schema: Literal["sinew/baseline/2"]
    """Name and number of this schema."""
    segments: list[SegmentEstimate]
    """Offsets at the end of each segment of the recording."""
    start_time_utc_s: float | None
    """Start of the evaluated interval by the clock of the recording, or the specified date, s since 1970 UTC;
    `None` without a date.
    """
    temperature_c: float | None
    """Mean temperature, °C; `None` if neither recorded nor specified."""
    temperature_source: TemperatureSource
    """Source of the temperature."""
    tension_used: bool | None
    """Whether the tensions of tendons were used."""
    unobservable: list[UnobservableCombination] | None
    """Combinations of elongations that are not observable from the recording."""
    warnings: list[Warning]
    """Warnings about the recording and the result."""
    zero_std_rad: float | None
    """Standard deviation of the encoder zeros by robot.toml, rad, with which offsets without a baseline are
    elongations; `None` with a baseline, or if robot.toml states none.
    """

    _fields = {
        "baseline": "",
        "baseline_time_utc_s": "",
        "damaged": "",
        "duration_s": "",
        "external_force": "ForceEstimate",
        "joint_offsets": "JointOffset",
        "joints": "TendonEstimate",
        "motor_torque": "",
        "nuisance": "NuisanceChange",
        "online": "OnlineTrajectory",
        "payload_changes": "PayloadChange",
        "payload_kg": "Gaussian",
        "poses": "",
        "recording": "",
        "reference_temperature_c": "",
        "rejected_intervals": "RejectedInterval",
        "rejected_share": "",
        "robot": "",
        "schema": "",
        "segments": "SegmentEstimate",
        "start_time_utc_s": "",
        "temperature_c": "",
        "temperature_source": "",
        "tension_used": "",
        "unobservable": "UnobservableCombination",
        "warnings": "Warning",
        "zero_std_rad": "",
    }


class BaselineSourceAssumed(Record):
    """Simulated baseline of random poses directly after tensioning."""

    __slots__ = ()

    duration_s: float
    """Duration of the simulated recording, s."""
    kind: Literal["assumed"]
    poses: int
    """Number of poses."""

    _fields = {
        "duration_s": "",
        "kind": "",
        "poses": "",
    }


class BaselineSourceGiven(Record):
    """Baseline of a specified file."""

    __slots__ = ()

    file: str
    """Name of the baseline file."""
    kind: Literal["given"]
    recordings: list[str]
    """Recordings from which the baseline was estimated."""

    _fields = {
        "file": "",
        "kind": "",
        "recordings": "",
    }


class Basis(Record):
    """Origin of a quantity of an estimate."""

    __slots__ = ()

    based_on: Origin
    """Origin of the quantity."""
    quantity: Quantity2
    """Quantity of the estimate."""

    _fields = {
        "based_on": "",
        "quantity": "",
    }


class Bounded(Record):
    """A value with possibly asymmetric bounds, in the unit that its field's name states. The level of the bounds
    is 95 % unless the field states another.
    """

    __slots__ = ()

    high: float
    """Upper bound of the interval."""
    low: float
    """Lower bound of the interval."""
    value: float
    """Central value of the quantity."""

    _fields = {
        "high": "",
        "low": "",
        "value": "",
    }


class CableLimitLoad(Record):
    """Load outside those of the baseline."""

    __slots__ = ()

    load: CableLimitLoadLoad

    _fields = {
        "load": "CableLimitLoadLoad",
    }


class CableLimitLoadLoad(Record):

    __slots__ = ()

    learned_nm: list[float]
    """Lowest and highest load of the baseline, N·m."""
    load_nm: float
    """Load of the recording, N·m."""

    _fields = {
        "learned_nm": "",
        "load_nm": "",
    }


class CableLimitOneLoad(Record):
    """Baseline with loads whose ratio is below two, which do not determine the compliance, and another load."""

    __slots__ = ()

    one_load: CableLimitOneLoadOneLoad

    _fields = {
        "one_load": "CableLimitOneLoadOneLoad",
    }


class CableLimitOneLoadOneLoad(Record):

    __slots__ = ()

    learned_nm: list[float]
    """Lowest and highest load of the baseline, N·m."""
    load_nm: float
    """Load of the recording, N·m."""

    _fields = {
        "learned_nm": "",
        "load_nm": "",
    }


class CableLimitRange(Record):
    """Joint positions outside those of the baseline."""

    __slots__ = ()

    range: CableLimitRangeRange

    _fields = {
        "range": "CableLimitRangeRange",
    }


class CableLimitRangeRange(Record):

    __slots__ = ()

    learned_rad: list[float]
    """Lowest and highest position in the baseline, rad."""
    range_rad: list[float]
    """Lowest and highest position in the recording, rad."""

    _fields = {
        "learned_rad": "",
        "range_rad": "",
    }


class CableLimitReversals(Record):
    """Too few reversals to separate friction and elongation."""

    __slots__ = ()

    reversals: CableLimitReversalsReversals

    _fields = {
        "reversals": "CableLimitReversalsReversals",
    }


class CableLimitReversalsReversals(Record):

    __slots__ = ()

    reversals: int
    """Number of reversals in the recording."""

    _fields = {
        "reversals": "",
    }


class Candidate(Record):
    """Rope that violates no constraint in nearly all draws."""

    __slots__ = ()

    assumed_parameters: int
    """Number of creep law parameters that are assumed, not measured."""
    broken_share: float
    """Share of the draws in which the rope breaks within the last requested time, 0 to 1."""
    cautions: list[Caution]
    """Warnings about the prediction."""
    change_m: float
    """Magnitude of the elongation that is not exceeded in 95 % of these draws, m."""
    diameter_m: float | None
    """Published diameter of the rope, m."""
    elongation_m: Bounded
    """Elongation after pretensioning at the last requested time, m; without the draws in which the rope is
    broken. Its value is that at the catalogue values, or the median of the draws if the rope breaks at the
    catalogue values.
    """
    life_s: Bounded | None
    """Time of the break, s; `None` beyond 300 years."""
    min_share: float
    """Share of the draws in which its length changes least of all candidates, 0 to 1."""
    parameters: int
    """Number of creep law parameters."""
    pareto: bool
    """Whether no other candidate of known diameter is at most as thick, changes its length at most as much
    (`Candidate::change_m`) and lasts at least as long at the catalogue values.
    """
    possible_violations: list[PossibleViolation]
    """Constraints that are violated in some of the draws."""
    rope: str
    """Name of the rope in the catalogue."""
    safety_factor_ratio: float | None
    """Ratio of published breaking load to largest tension."""
    stiffness_n_per_m: Bounded
    """Stiffness of the strand at the duty's mean load, N/m."""
    weight_kg_per_m: float | None
    """Published weight per length, kg/m."""

    _fields = {
        "assumed_parameters": "",
        "broken_share": "",
        "cautions": "Caution",
        "change_m": "",
        "diameter_m": "",
        "elongation_m": "Bounded",
        "life_s": "Bounded",
        "min_share": "",
        "parameters": "",
        "pareto": "",
        "possible_violations": "PossibleViolation",
        "rope": "",
        "safety_factor_ratio": "",
        "stiffness_n_per_m": "Bounded",
        "weight_kg_per_m": "",
    }


class CatalogueValue(Record):
    """A value of the catalogue with its origin."""

    __slots__ = ()

    date: str | None
    """Date of the fit, for fitted values."""
    factor: float | None
    """Factor of the 95 % interval, from value/factor to value·factor, where specified."""
    origin: RopeShowOrigin
    """Origin of the value."""
    plus_minus: float | None
    """Half-width of the 95 % interval, in the unit of the value, where specified."""
    source: str
    """Key of the value's source in the rope's sources."""
    value: float
    """Value, in the unit of its key."""

    _fields = {
        "date": "",
        "factor": "",
        "origin": "",
        "plus_minus": "",
        "source": "",
        "value": "",
    }


class CauseUnknown(Record):
    """Ambiguous cause, with the reason."""

    __slots__ = ()

    unknown: UnknownCause

    _fields = {
        "unknown": "",
    }


class CautionAssumedParameters(Record):
    """Parameters that are assumed, not measured."""

    __slots__ = ()

    assumed: int
    """Number of assumed parameters."""
    kind: Literal["assumed-parameters"]
    parameters: int
    """Number of creep law parameters."""

    _fields = {
        "assumed": "",
        "kind": "",
        "parameters": "",
    }


class CautionBeyondData(Record):
    """Duty outside the tested range of the rope; intervals are widened."""

    __slots__ = ()

    duration_s: float
    """Longest requested time, s."""
    factor: float
    """Factor of the widening at that time, up and down (95 %)."""
    kind: Literal["beyond-data"]
    load_share: list[float]
    """Mean and largest tension of the duty over the breaking load."""
    temperature_c: list[float]
    """Lowest and highest temperature of the duty, °C."""
    tested_range: TestedRange
    """Tested range of the rope."""

    _fields = {
        "duration_s": "",
        "factor": "",
        "kind": "",
        "load_share": "",
        "temperature_c": "",
        "tested_range": "TestedRange",
    }


class CautionBreakingLoadAssumed(Record):
    """Breaking load that is not published."""

    __slots__ = ()

    breaking_load_n: float
    """Assumed breaking load, N."""
    kind: Literal["breaking-load-assumed"]

    _fields = {
        "breaking_load_n": "",
        "kind": "",
    }


class CautionCreepsApart(Record):
    """Creep rupture; there are no elongations after it."""

    __slots__ = ()

    kind: Literal["creeps-apart"]
    time_s: float
    """Time of the break at the catalogue values, s."""

    _fields = {
        "kind": "",
        "time_s": "",
    }


class CautionExtrapolated(Record):
    """Extrapolation of assumed parameters beyond a day."""

    __slots__ = ()

    kind: Literal["extrapolated"]
    tests_s: float
    """Duration of the longest test, s."""

    _fields = {
        "kind": "",
        "tests_s": "",
    }


class CautionHighLoad(Record):
    """Tension above the range of the creep law."""

    __slots__ = ()

    kind: Literal["high-load"]

    _fields = {
        "kind": "",
    }


class CautionHot(Record):
    """HMPE above the temperature range in which its flow was measured."""

    __slots__ = ()

    kind: Literal["hot"]

    _fields = {
        "kind": "",
    }


class CautionLoadShare(Record):
    """Load above the manufacturers' advice."""

    __slots__ = ()

    kind: Literal["load-share"]
    load_share: float
    """Ratio of largest tension to breaking load, 0 to 1."""
    max_share: float
    """Largest advised ratio, 0 to 1."""

    _fields = {
        "kind": "",
        "load_share": "",
        "max_share": "",
    }


class CautionLowLoad(Record):
    """Tension below the range of the creep law."""

    __slots__ = ()

    kind: Literal["low-load"]

    _fields = {
        "kind": "",
    }


class CautionReplace(Record):
    """Strain above the manufacturer's discard strain."""

    __slots__ = ()

    kind: Literal["replace"]
    share: float
    """Share of the draws that exceed it, or are broken, at the last requested time, 0 to 1."""
    strain_ratio: float
    """Discard strain since new, m/m."""
    time_s: float | None
    """First requested time at which the central estimate exceeds the discard strain, s; `None`: only draws do."""

    _fields = {
        "kind": "",
        "share": "",
        "strain_ratio": "",
        "time_s": "",
    }


class CautionTerminationNotSpecified(Record):
    """Termination not specified; assumed as strong as the rope."""

    __slots__ = ()

    kind: Literal["termination-not-specified"]
    knot_share: float
    """Share of the strength that a knot retains, 0 to 1."""
    splice_share: float
    """Share of the strength that a splice retains, 0 to 1."""

    _fields = {
        "kind": "",
        "knot_share": "",
        "splice_share": "",
    }


class CautionTightBend(Record):
    """Pulley diameter below the manufacturers' advice."""

    __slots__ = ()

    bend_ratio: float
    """Ratio of bend diameter to rope diameter."""
    kind: Literal["tight-bend"]
    min_ratio: float
    """Smallest advised ratio."""

    _fields = {
        "bend_ratio": "",
        "kind": "",
        "min_ratio": "",
    }


class CautionWornOut(Record):
    """Bending fatigue up to a break; there are no elongations after it."""

    __slots__ = ()

    kind: Literal["worn-out"]
    time_s: float
    """Time of the break at the catalogue values, s."""

    _fields = {
        "kind": "",
        "time_s": "",
    }


class Combination(Record):
    """Combination of elongations."""

    __slots__ = ()

    shown_by_motor_torque: bool
    """Whether the combination is observable with the torque of every motor; with tension sensors it always is."""
    weights: list[list[str | float]]
    """Names and weights of the tendons; the weights have unit norm."""

    _fields = {
        "shown_by_motor_torque": "",
        "weights": "",
    }


class Conditions(Record):
    """Test conditions stated by the laboratory, which the file does not contain."""

    __slots__ = ()

    conditions: str | None
    """Atmosphere, conditioning time, grips, and measurement of the extension."""
    preconditioning: str | None
    """Treatment of the specimens before the test."""
    standard: str
    """Standard of the test."""

    _fields = {
        "conditions": "",
        "preconditioning": "",
        "standard": "",
    }


class ContactScore(Record):
    """Comparison of detected and true contacts."""

    __slots__ = ()

    contacts: int
    """Number of true contacts (those less than 0.5 s apart count as one)."""
    delays_s: list[float]
    """Delays from the beginning of a contact to its alarm, s; one per detected contact."""
    false_alarms: int
    """Number of alarms without a contact."""
    false_s: float
    """Time of false alarms, s."""
    free_s: float
    """Time without contact, s."""
    missed: int
    """Number of contacts not detected, or hidden by an earlier alarm."""

    _fields = {
        "contacts": "",
        "delays_s": "",
        "false_alarms": "",
        "false_s": "",
        "free_s": "",
        "missed": "",
    }


class Coverage(Record):
    """Hold-out result of one forecaster over many tests."""

    __slots__ = ()

    end_error_ratio: float | None
    """Median of |forecast − measurement| at the end, over the test's creep."""
    end_half_width_ratio: float | None
    """Median half-width of the interval at the end, over the test's creep."""
    ends_inside: int
    """Number of tests whose last measurement lies within its interval."""
    failed: int
    """Number of tests that the law could not be fitted to."""
    forecaster: Forecaster
    """Law, or all laws combined."""
    readings: int
    """Number of held-out measurements."""
    readings_inside: int
    """Number of held-out measurements within their intervals."""
    tests: int
    """Number of forecast tests."""

    _fields = {
        "end_error_ratio": "",
        "end_half_width_ratio": "",
        "ends_inside": "",
        "failed": "",
        "forecaster": "",
        "readings": "",
        "readings_inside": "",
        "tests": "",
    }


class CreepAnalysisResult(Record):
    """Report of an analysis without a creep law except a straight line."""

    __slots__ = ()

    conditions: Conditions
    """Test conditions stated by the laboratory."""
    failures: list[Failure]
    """Specimens that could not be analysed."""
    groups: list[Scatter]
    """Repeats by group."""
    isochrones: list[Isochrone]
    """Strain against load at the same times."""
    schema: Literal["sinew/creep-analyze/2"]
    """Name and number of this schema."""
    sources: list[Source]
    """Raw data files of the tests."""
    specimens: list[Analysis]
    """Analysis of each specimen."""

    _fields = {
        "conditions": "Conditions",
        "failures": "Failure",
        "groups": "Scatter",
        "isochrones": "Isochrone",
        "schema": "",
        "sources": "Source",
        "specimens": "Analysis",
    }


class CreepComparisonResult(Record):
    """Ropes in the order of their strain."""

    __slots__ = ()

    failures: list[Failure]
    """Specimens that could not be analysed."""
    ranks: list[Rank]
    """Ropes by increasing strain."""
    schema: Literal["sinew/creep-compare/2"]
    """Name and number of this schema."""
    sources: list[Source]
    """Raw data files of the tests."""

    _fields = {
        "failures": "Failure",
        "ranks": "Rank",
        "schema": "",
        "sources": "Source",
    }


class CreepErrorFlat(Record):
    """Strain without any change."""

    __slots__ = ()

    kind: Literal["flat"]
    specimen: str
    """Name of the specimen."""

    _fields = {
        "kind": "",
        "specimen": "",
    }


class CreepErrorIncompleteRope(Record):
    """Missing parameters of the catalogue rope."""

    __slots__ = ()

    kind: Literal["incomplete-rope"]
    missing: str
    """Names of the missing parameters."""
    rope: str
    """Name of the rope."""

    _fields = {
        "kind": "",
        "missing": "",
        "rope": "",
    }


class CreepErrorIsotherm(Record):
    """Isotherm with too few measurements above zero."""

    __slots__ = ()

    kind: Literal["isotherm"]
    temperature_c: float
    """Temperature of the isotherm, °C."""

    _fields = {
        "kind": "",
        "temperature_c": "",
    }


class CreepErrorNoEntry(Record):
    """Fit that does not determine a catalogue entry."""

    __slots__ = ()

    kind: Literal["no-entry"]
    reason: NoEntry
    """Reason of the rejection."""

    _fields = {
        "kind": "",
        "reason": "NoEntry",
    }


class CreepErrorNoForecast(Record):
    """Forecast that the records do not support."""

    __slots__ = ()

    kind: Literal["no-forecast"]
    reason: NoForecast
    """Reason why there is no forecast."""
    specimen: str
    """Name of the specimen or group."""

    _fields = {
        "kind": "",
        "reason": "NoForecast",
        "specimen": "",
    }


class CreepErrorNoGroupColumn(Record):
    """Group column that no specimen has."""

    __slots__ = ()

    available: list[str]
    """Names of the available columns."""
    column: str
    """Requested column of the group."""
    kind: Literal["no-group-column"]

    _fields = {
        "available": "",
        "column": "",
        "kind": "",
    }


class CreepErrorNoPlan(Record):
    """Planning of a test failed."""

    __slots__ = ()

    kind: Literal["no-plan"]
    reason: str
    """Reason of the failure."""

    _fields = {
        "kind": "",
        "reason": "",
    }


class CreepErrorNoRope(Record):
    """Rope law without a base rope."""

    __slots__ = ()

    kind: Literal["no-rope"]

    _fields = {
        "kind": "",
    }


class CreepErrorNotFinite(Record):
    """Cost that is not finite at any start of the search."""

    __slots__ = ()

    kind: Literal["not-finite"]
    law: Law
    """Creep law that was fitted."""

    _fields = {
        "kind": "",
        "law": "",
    }


class CreepErrorNothingAnalysed(Record):
    """No specimen could be analysed."""

    __slots__ = ()

    failures: list[str]
    """Reason of each failure."""
    kind: Literal["nothing-analysed"]

    _fields = {
        "failures": "",
        "kind": "",
    }


class CreepErrorOneTemperature(Record):
    """Isotherms at one temperature only."""

    __slots__ = ()

    kind: Literal["one-temperature"]

    _fields = {
        "kind": "",
    }


class CreepErrorSpecimen(Record):
    """Measurements of a specimen that are not a creep test."""

    __slots__ = ()

    kind: Literal["specimen"]
    reason: Unusable
    """Reason of the rejection."""
    specimen: str
    """Name of the specimen."""

    _fields = {
        "kind": "",
        "reason": "Unusable",
        "specimen": "",
    }


class CreepErrorTooFew(Record):
    """Fewer measurements than numbers to fit."""

    __slots__ = ()

    kind: Literal["too-few"]
    law: Law
    """Creep law that was fitted."""
    needed: int
    """Minimum number of measurements."""
    readings: int
    """Number of measurements found."""

    _fields = {
        "kind": "",
        "law": "",
        "needed": "",
        "readings": "",
    }


class CreepFitResult(Record):
    """Laws fitted to creep tests."""

    __slots__ = ()

    failures: list[Failure]
    """Specimens that could not be analysed or fitted."""
    fits: list[FitSet]
    """Fits in the order of the files."""
    schema: Literal["sinew/creep-fit/2"]
    """Name and number of this schema."""
    sources: list[Source]
    """Raw data files of the tests."""

    _fields = {
        "failures": "Failure",
        "fits": "FitSet",
        "schema": "",
        "sources": "Source",
    }


class CreepHoldOutResult(Record):
    """Forecasts compared with the held-out end of each test."""

    __slots__ = ()

    failures: list[Failure]
    """Specimens that could not be analysed."""
    held_out: list[Coverage]
    """Coverage of each law, and of all laws combined."""
    held_out_share: float
    """Held-out share of the time at the end of each test."""
    level: float
    """Confidence level of the intervals."""
    schema: Literal["sinew/creep-holdout/2"]
    """Name and number of this schema."""
    sources: list[Source]
    """Raw data files of the tests."""

    _fields = {
        "failures": "Failure",
        "held_out": "Coverage",
        "held_out_share": "",
        "level": "",
        "schema": "",
        "sources": "Source",
    }


class CreepShiftResult(Record):
    """Isotherms shifted along the logarithm of time."""

    __slots__ = ()

    failures: list[Failure]
    """Specimens that are not an isotherm."""
    schema: Literal["sinew/creep-shift/2"]
    """Name and number of this schema."""
    sources: list[Source]
    """Raw data files of the tests."""
    superposition: Superposition
    """Shift factors and their temperature dependence."""

    _fields = {
        "failures": "Failure",
        "schema": "",
        "sources": "Source",
        "superposition": "Superposition",
    }


class CycleClock(Record):
    """Cycle count of a machine and its rate."""

    __slots__ = ()

    last: float
    """Cycle of the last session with a cycle count."""
    per_s: float | None
    """Recent cycle rate, 1/s; `None` with one session only."""

    _fields = {
        "last": "",
        "per_s": "",
    }


class Damage(Record):
    """Part of the file that could not be read."""

    __slots__ = ()

    after_ns: int | None
    """Time stamp of the last valid sample before the damage, ns."""
    bytes: int
    """Number of bytes lost."""
    offset: int
    """Byte offset of the start of the damage."""
    reason: str
    """Reason why the bytes could not be used."""

    _fields = {
        "after_ns": "",
        "bytes": "",
        "offset": "",
        "reason": "",
    }


class DamageSite(Record):
    """Section of the rope with its damage; it breaks at a damage of 1."""

    __slots__ = ()

    bending_damage: float
    """Damage by bending, 0 to 1."""
    creep_damage: float
    """Damage by constant load, 0 to 1."""
    from_m: float
    """Start of the section, m from the drive with the drive at rest."""
    guides: int
    """Number of guiding pulleys that pass over the section."""
    place: Place
    """Location of the section: rope or terminations."""
    to_m: float
    """End of the section, m from the drive."""

    _fields = {
        "bending_damage": "",
        "creep_damage": "",
        "from_m": "",
        "guides": "",
        "place": "",
        "to_m": "",
    }


class Difference(Record):
    """Difference of an estimate from that of a reference recording."""

    __slots__ = ()

    difference_rad: float
    """Offset minus offset in the reference recording, rad."""
    elongation_m: float | None
    """Difference as elongation of the tendon, m; `None` without tendon geometry."""
    offset_per_stiffness_error_rad: float
    """Sensitivity of the difference to a relative error of the stiffness, rad."""
    reference_rad: float
    """Offset in the reference recording, rad."""
    standard_error_rad: float | None
    """Standard error of the difference, rad; `None` if a recording is too short."""

    _fields = {
        "difference_rad": "",
        "elongation_m": "",
        "offset_per_stiffness_error_rad": "",
        "reference_rad": "",
        "standard_error_rad": "",
    }


class DriveCheck(Record):
    """Drive of a tendon, in the coordinate of one of its joints."""

    __slots__ = ()

    joint: str
    """Joint in whose coordinate the offset is given."""
    motor_inertia_kg_m2: float | None
    """Inertia of the motor, reflected to that joint, kg·m²."""
    name: str
    """Name of the tendon."""
    stiffness_nm_per_rad: float
    """Stiffness at that joint, N·m/rad."""
    tendon: TendonCheck | None
    """Rope of the tendon, if described."""

    _fields = {
        "joint": "",
        "motor_inertia_kg_m2": "",
        "name": "",
        "stiffness_nm_per_rad": "",
        "tendon": "TendonCheck",
    }


class DutySummary(Record):
    """Extremes and means of a duty over one cycle."""

    __slots__ = ()

    duration_s: float
    """Duration of one cycle, s."""
    temperature_max_c: float
    """Highest temperature, °C."""
    temperature_mean_c: float
    """Mean temperature over time, °C."""
    temperature_min_c: float
    """Lowest temperature, °C."""
    tension_max_n: float
    """Largest tension, N."""
    tension_mean_n: float
    """Mean tension over time, N."""
    tension_min_n: float
    """Smallest tension, N."""

    _fields = {
        "duration_s": "",
        "temperature_max_c": "",
        "temperature_mean_c": "",
        "temperature_min_c": "",
        "tension_max_n": "",
        "tension_mean_n": "",
        "tension_min_n": "",
    }


class Ending(Record):
    """Termination of a search."""

    __slots__ = ()

    steps: int
    """Number of steps."""
    termination: Termination
    """Reason of the termination."""

    _fields = {
        "steps": "",
        "termination": "",
    }


class Estimate(Record):
    """Estimate of one recording by the method of the paper."""

    __slots__ = ()

    basis: list[Basis]
    """Origin of each quantity."""
    damaged: bool
    """Whether data was lost because the recording is damaged (exit status 3)."""
    joints: list[JointEstimate]
    """Estimates of the joints of the robot, in their order in the URDF."""
    losses: list[Loss]
    """Numbers of frames that were not used for any joint, by reason."""
    recording: RecordingInfo
    """Properties of the recording."""
    robot: RobotInfo
    """Properties of the robot."""
    settings: Settings
    """Settings of the estimate."""
    sinew_version: str
    """Version of the program that made the estimate."""
    warnings: list[RecordingWarning]
    """Warnings about the recording and the result."""

    _fields = {
        "basis": "Basis",
        "damaged": "",
        "joints": "JointEstimate",
        "losses": "Loss",
        "recording": "RecordingInfo",
        "robot": "RobotInfo",
        "settings": "Settings",
        "sinew_version": "",
        "warnings": "RecordingWarning",
    }


class EstimateDocument(Record):
    """The estimate of one recording."""

    __slots__ = ()

    method: Method
    """Estimation method of the result."""
    reading: Estimate
    """Uncorrected estimate by the equation of the paper from the same frames. The method assumes exact stiffness
    and masses, no payload and no contact, so no verdict is derived from it.
    """
    session: SessionEstimate | None
    """Result of the absolute method, with verdicts."""

    _fields = {
        "method": "",
        "reading": "Estimate",
        "session": "SessionEstimate",
    }


class EstimateEachResult(Record):
    """Independent estimates of several recordings."""

    __slots__ = ()

    method: Method
    """Estimation method of all recordings."""
    recordings: list[RecordingOutcome]
    """One entry per recording, in the order of the command line."""
    schema: Literal["sinew/estimate-each/2"]
    """Name and number of this schema."""

    _fields = {
        "method": "",
        "recordings": "RecordingOutcome",
        "schema": "",
    }


class EstimateResult(Record):
    """The estimate of one recording."""

    __slots__ = ()

    method: Method
    """Estimation method of the result."""
    reading: Estimate
    """Uncorrected estimate by the equation of the paper from the same frames. The method assumes exact stiffness
    and masses, no payload and no contact, so no verdict is derived from it.
    """
    schema: Literal["sinew/estimate/2"]
    """Name and number of this schema."""
    session: SessionEstimate | None
    """Result of the absolute method, with verdicts."""

    _fields = {
        "method": "",
        "reading": "Estimate",
        "schema": "",
        "session": "SessionEstimate",
    }


class Event(Record):
    """Event during reading."""

    __slots__ = ()

    kind: EventKind
    """Kind of the event."""
    text: str
    """Description of the event, with numbers and units."""
    time_ns: int
    """Time of the event in the recording, ns; 0 if unknown."""

    _fields = {
        "kind": "",
        "text": "",
        "time_ns": "",
    }


class Expected(Record):
    """Expected standard deviation of one joint's offset."""

    __slots__ = ()

    elongation_std_m: float | None
    """Standard deviation of the elongation, m; none without tendon geometry."""
    identifiable: bool
    """Whether the poses make the offset identifiable."""
    name: str
    """Name of the joint."""
    offset_std_rad: float
    """Standard deviation of the offset, rad."""
    random_offset_std_rad: float
    """Standard deviation of the offset with random poses, median of the random lists, rad."""

    _fields = {
        "elongation_std_m": "",
        "identifiable": "",
        "name": "",
        "offset_std_rad": "",
        "random_offset_std_rad": "",
    }


class Extrapolation(Record):
    """Extrapolation distance of a duty from the tested range, in load and temperature."""

    __slots__ = ()

    heat_k: float
    """Distance above the highest tested temperature, K."""
    load_efolds: float
    """Natural logarithm of the ratio of the load to the nearest tested load."""
    temperature_k: float
    """Distance to the nearest tested temperature, K."""

    _fields = {
        "heat_k": "",
        "load_efolds": "",
        "temperature_k": "",
    }


class Failure(Record):
    """Specimen or group that could not be analysed or fitted."""

    __slots__ = ()

    name: str | None
    """Specimen or group that was fitted; `None` if the reason names it."""
    reason: CreepError
    """Reason of the failure."""

    _fields = {
        "name": "",
        "reason": "CreepError",
    }


class Finding(Record):
    """Implausible, missing or impossible value."""

    __slots__ = ()

    assessed: RangeCheck | None
    """Compared value and its usual range."""
    at: Location
    """Location of the value."""
    kind: FindingKind
    """Kind of the finding."""
    names: list[str]
    """Available names, most similar first."""
    severity: Severity
    """Severity of the finding."""
    slip: UnitHint | None
    """Unit in which the value may have been written."""
    text: str | None
    """Unknown name, or message of the file's parser."""
    unit: str
    """Unit of the value in the file."""
    value: float | None
    """Value in the file, in `unit`."""

    _fields = {
        "assessed": "RangeCheck",
        "at": "Location",
        "kind": "",
        "names": "",
        "severity": "",
        "slip": "UnitHint",
        "text": "",
        "unit": "",
        "value": "",
    }


class Fit(Record):
    """Law fitted to one or several curves."""

    __slots__ = ()

    aicc: float
    """Akaike's criterion with the correction for few measurements; smaller is better."""
    bic: float
    """Schwarz's criterion; smaller is better."""
    covariance: list[list[float]]
    """Covariance of `Self::parameters` from the draws, in their units; empty without draws."""
    ending: Ending
    """Termination of the best search."""
    fitted: int
    """Number of fitted numbers, including those of the noise."""
    fixed: list[FixedParameter]
    """Parameters of `Law::Rope` that are not identifiable from the record and fixed at the base rope's value."""
    law: Law
    """Creep law that was fitted."""
    log_likelihood: float
    """Natural logarithm of the maximum likelihood."""
    noise: Noise
    """Noise parameters of maximum likelihood."""
    parameters: list[Parameter]
    """Parameters with values, units and intervals."""
    readings: int
    """Number of measurements (or means of measurements) used."""
    residual_strain_ratio: float
    """Standard deviation of a measurement's strain, m/m."""
    starts: int
    """Number of starts of the search."""
    weight: float
    """Akaike weight among the laws fitted to the same measurements; 1 for a law fitted alone."""

    _fields = {
        "aicc": "",
        "bic": "",
        "covariance": "",
        "ending": "Ending",
        "fitted": "",
        "fixed": "FixedParameter",
        "law": "",
        "log_likelihood": "",
        "noise": "Noise",
        "parameters": "Parameter",
        "readings": "",
        "residual_strain_ratio": "",
        "starts": "",
        "weight": "",
    }


class FitSet(Record):
    """Laws fitted to one specimen or group."""

    __slots__ = ()

    forecast: Forecast | None
    """Forecast strain, weighted over all laws; of the first specimen of a group."""
    forecast_conditions: ForecastConditions | None
    """Load and temperature of the forecast."""
    laws: list[Fit]
    """Fitted laws by increasing AICc."""
    name: str
    """Name of the specimen or group."""

    _fields = {
        "forecast": "Forecast",
        "forecast_conditions": "ForecastConditions",
        "laws": "Fit",
        "name": "",
    }


class FixedParameter(Record):
    """Parameter fixed at the base rope's value."""

    __slots__ = ()

    name: str
    """Name as in the catalogue, with its unit."""
    reason: NotIdentifiableReason
    """Reason why it is not identifiable."""
    value: float
    """Value at which it is fixed."""

    _fields = {
        "name": "",
        "reason": "",
        "value": "",
    }


class ForceEstimate(Record):
    """A constant external force on the arm during the recording."""

    __slots__ = ()

    force_n: list[Gaussian]
    """Force along the axes of the base, N, given that it acts."""
    is_specified: bool
    """Whether the user specified the force."""
    probability: float
    """Posterior probability that the force acts; 1 if it was specified."""

    _fields = {
        "force_n": "Gaussian",
        "is_specified": "",
        "probability": "",
    }


class Forecast(Record):
    """Forecast strain at given times, m/m."""

    __slots__ = ()

    high_strain_ratio: list[float]
    """Upper end of the interval of the law's strain, m/m."""
    low_strain_ratio: list[float]
    """Lower end of the interval of the law's strain, m/m."""
    reading_high_strain_ratio: list[float]
    """Upper end of the prediction interval of a measurement, m/m."""
    reading_low_strain_ratio: list[float]
    """Lower end of the prediction interval of a measurement, m/m: law, slow part and measurement error."""
    strain_ratio: list[float]
    """Median of the law's strain, m/m."""
    time_s: list[float]
    """Times after the load, s."""

    _fields = {
        "high_strain_ratio": "",
        "low_strain_ratio": "",
        "reading_high_strain_ratio": "",
        "reading_low_strain_ratio": "",
        "strain_ratio": "",
        "time_s": "",
    }


class ForecastConditions(Record):
    """Load and temperature of a forecast."""

    __slots__ = ()

    load_n: float | None
    """Tension, N, if the record has one."""
    source: ConditionSource
    """Source of load and temperature."""
    temperature_c: float | None
    """Temperature, °C, if the record has one."""

    _fields = {
        "load_n": "",
        "source": "",
        "temperature_c": "",
    }


class ForecastPoint(Record):
    """Forecast of the offset at one time."""

    __slots__ = ()

    interval_95_rad: Interval95
    """Quantiles of 2.5 and 97.5 %, rad."""
    offset_rad: float
    """Median of the offset, rad."""
    time_utc_s: float
    """Time of the forecast, s since 1970."""

    _fields = {
        "interval_95_rad": "Interval95",
        "offset_rad": "",
        "time_utc_s": "",
    }


class Frames(Record):
    """Frames on their way into the file."""

    __slots__ = ()

    duplicated: int
    """Number of duplicate frames."""
    late: int
    """Written after their successor."""
    lost: int
    """Frames that were lost."""
    written: int
    """Written, repetitions included."""

    _fields = {
        "duplicated": "",
        "late": "",
        "lost": "",
        "written": "",
    }


class Gaussian(GaussianRecord):
    """A normally distributed quantity, in the unit that the name of its field or function states. `std` is one
    standard deviation. It is converted to the half-width of a 95 % interval only for display.
    """

    __slots__ = ()

    mean: float
    """Mean of the quantity."""
    std: float
    """Standard deviation, not negative."""

    _fields = {
        "mean": "",
        "std": "",
    }


class GroupCheck(Record):
    """Joints and tendons that are connected with each other, and with no others."""

    __slots__ = ()

    condition: float | None
    """Condition number of the moment arms; none without an equation per tendon."""
    equations: GroupEquations
    """Equations that estimate the elongations."""
    joints: list[str]
    """Names of the joints."""
    tendons: list[str]
    """Names of the tendons."""

    _fields = {
        "condition": "",
        "equations": "",
        "joints": "",
        "tendons": "",
    }


class Health(Record):
    """Content, losses and repairs of a recording, with their reasons. Complete after the last frame."""

    __slots__ = ()

    bytes_lost: int
    """Number of bytes of the file that could not be used."""
    clock_steps: int
    """Number of steps of the clock of the time stamps: back, or ahead while the recorder's clock continued."""
    damage: list[Damage]
    """Damaged parts of the file, with the reasons."""
    duplicates: int
    """Number of messages discarded, because their time stamp was a duplicate."""
    events: list[Event]
    """Events in reading order, at most `EVENT_LIMIT`."""
    events_dropped: int
    """Number of events beyond the limit."""
    frames: int
    """Number of frames returned."""
    frames_without_joint_side: int
    """Number of frames in which no joint has a joint position."""
    frames_without_motor_side: int
    """Number of frames in which no joint has a motor position."""
    gaps: int
    """Number of gaps longer than the gap limit."""
    implausible_signals: list[str]
    """Implausible signals: degrees, constant, gear ratio, all NaN."""
    late: int
    """Number of messages discarded, because they were later than the reorder window."""
    late_starts: list[LateStart]
    """Positions that are recorded from a later time on than the recording starts."""
    longest_gap_s: float
    """Duration of the longest gap, s."""
    messages: int
    """Number of messages (MCAP, of the topics used) or rows (tables) read."""
    motor_ratios: list[MotorRatio]
    """Motors whose position is a constant multiple of the joint position that is not near one."""
    non_finite: list[SignalCount]
    """Number of NaN or infinite samples per signal; they are NaN in the frames."""
    out_of_order: int
    """Number of messages reordered by time stamp."""
    ragged_rows: int
    """Number of rows with more or fewer cells than the header."""
    rows_without_time: int
    """Number of rows without a time; discarded."""
    second_publishers: list[SecondPublisher]
    """Samples of second publishers, such as a node that repeats a fixed pose; excluded."""
    short_messages: int
    """Number of messages with fewer values than names; the missing values are NaN."""
    signals: list[SignalCoverage]
    """Coverage of the recording by each position, joint by joint."""
    streams: list[StreamTiming]
    """Timing of each stream: that of the joint side or of the table's rows first."""
    undecodable: int
    """Number of messages that could not be decoded."""
    unknown_joints: list[str]
    """Joints in messages that were not there at the start of the recording; ignored."""
    unstamped: int
    """Number of messages without a time stamp in a topic with time stamps; their time follows from that of their
    receipt.
    """
    unwrapped: list[SignalCount]
    """Number of encoder wrap-arounds that were corrected, per signal."""

    _fields = {
        "bytes_lost": "",
        "clock_steps": "",
        "damage": "Damage",
        "duplicates": "",
        "events": "Event",
        "events_dropped": "",
        "frames": "",
        "frames_without_joint_side": "",
        "frames_without_motor_side": "",
        "gaps": "",
        "implausible_signals": "",
        "late": "",
        "late_starts": "LateStart",
        "longest_gap_s": "",
        "messages": "",
        "motor_ratios": "MotorRatio",
        "non_finite": "SignalCount",
        "out_of_order": "",
        "ragged_rows": "",
        "rows_without_time": "",
        "second_publishers": "SecondPublisher",
        "short_messages": "",
        "signals": "SignalCoverage",
        "streams": "StreamTiming",
        "undecodable": "",
        "unknown_joints": "",
        "unstamped": "",
        "unwrapped": "SignalCount",
    }


class HeldJoint(Record):
    """Joint with its motor held while its two ropes relax."""

    __slots__ = ()

    radius_m: float
    """Radius of the joint pulley, m."""
    slides: bool | None
    """Whether the joint is prismatic: its torque is then a force, N, and the pulley radius the rope travel per
    metre.
    """
    torque_nm: float
    """Torque of the joint meanwhile, N·m, at least 0."""

    _fields = {
        "radius_m": "",
        "slides": "",
        "torque_nm": "",
    }


class Injection(Record):
    """Offset added to a joint's motor position to test the estimate, as in the paper."""

    __slots__ = ()

    from_s: float | None
    """Start of the injection since the start of the recording, s; none: from the start."""
    joint: str
    """Name of the tendon; the offset is in the coordinate of the joint paired with it."""
    offset_rad: float
    """Added offset, rad."""

    _fields = {
        "from_s": "",
        "joint": "",
        "offset_rad": "",
    }


class Interval95(Record):
    """Bounds of a 95 % interval of a quantity, in the unit that its field's name states."""

    __slots__ = ()

    high: float
    """Upper bound of the interval."""
    low: float
    """Lower bound of the interval."""

    _fields = {
        "high": "",
        "low": "",
    }


class IsoMeasurement(Record):
    """Measurement at a standard time of ISO 899-1."""

    __slots__ = ()

    modulus_pa: float | None
    """Tensile creep modulus F/(A ε), Pa; `None` without a cross-section."""
    strain_ratio: float
    """Strain relative to the zero, m/m."""
    time_s: float
    """Time under the full load, s."""

    _fields = {
        "modulus_pa": "",
        "strain_ratio": "",
        "time_s": "",
    }


class Isochrone(Record):
    """Specimens of one group at one time under load."""

    __slots__ = ()

    exponent: Bounded
    """Exponent `p` of `ε ∝ σ^p`: 1 if strain is proportional to load."""
    group: str | None
    """Name of the group; `None` for specimens without a group."""
    points: list[IsochronePoint]
    """Specimens by increasing load."""
    quantity: LoadQuantity
    """Quantity of the loads."""
    secant: float
    """Load over strain at the middle of the loads, N or Pa: secant of the curve."""
    time_s: float
    """Time under the full load, s."""

    _fields = {
        "exponent": "Bounded",
        "group": "",
        "points": "IsochronePoint",
        "quantity": "",
        "secant": "",
        "time_s": "",
    }


class IsochronePoint(Record):
    """Specimen of an isochrone."""

    __slots__ = ()

    load: float
    """Load of the specimen, N or Pa."""
    specimen: str
    """Name of the specimen."""
    strain_ratio: float
    """Strain at that time, m/m."""

    _fields = {
        "load": "",
        "specimen": "",
        "strain_ratio": "",
    }


class JointCheck(Record):
    """Joint of the robot. For a prismatic joint, rad means m and N·m means N."""

    __slots__ = ()

    crossed_by: list[str] | None
    """Names of the tendons that cross the joint, if not every joint has its own tendon."""
    friction_specified: bool | None
    """Whether friction is specified; none for a rigid joint."""
    kind: JointMotion
    """Kind of motion: revolute or prismatic."""
    lower_rad: float | None
    """Lower limit of the joint position, rad; none for a continuous joint."""
    motor_inertia_kg_m2: float | None
    """Inertia of the motor, reflected to the joint, kg·m²."""
    name: str
    """Name of the joint."""
    spring_nm_per_rad: float | None
    """Stiffness of the joint's passive spring, N·m/rad."""
    stiffness_nm_per_rad: float | None
    """Stiffness, N·m/rad; none for a rigid joint."""
    tendon: TendonCheck | None
    """Tendon of the joint, if described."""
    upper_rad: float | None
    """Upper limit of the joint position, rad; none for a continuous joint."""

    _fields = {
        "crossed_by": "",
        "friction_specified": "",
        "kind": "",
        "lower_rad": "",
        "motor_inertia_kg_m2": "",
        "name": "",
        "spring_nm_per_rad": "",
        "stiffness_nm_per_rad": "",
        "tendon": "TendonCheck",
        "upper_rad": "",
    }


class JointErrorNoUsableFrame(Record):
    """No usable frame, with the most frequent reason."""

    __slots__ = ()

    no_usable_frame: LossReason | None

    _fields = {
        "no_usable_frame": "",
    }


class JointEstimate(Record):
    """Estimate of one joint by the method of the paper."""

    __slots__ = ()

    difference: Difference | None
    """Difference from the reference recording; `None` without one."""
    elongation_m: float | None
    """Elongation of the tendon, m; `None` without tendon geometry."""
    elongation_standard_error_m: float | None
    """Standard error of the elongation, m."""
    losses: list[Loss]
    """Frames without an estimate, by reason."""
    name: str
    """Name of the joint or tendon."""
    offset_per_stiffness_error_rad: float | None
    """Sensitivity of the offset to a relative error of the stiffness, rad: `mean(tau_el)/K`. The sensitivity to
    a relative error of the masses has the same magnitude and the opposite sign.
    """
    offset_rad: float | None
    """Mean offset of the motor position, rad; `None` without an estimate."""
    reason: JointError | None
    """Reason why there is no estimate; `None` if there is one."""
    scatter_rad: float | None
    """Standard deviation of the estimates of single frames, rad."""
    slides: bool | None
    """Whether the joint is prismatic: values in rad are then in m, and values in N·m in N."""
    standard_error_rad: float | None
    """Standard error of the mean with correlated samples (method of batch means), rad; `None` if the recording
    is too short.
    """
    stiffness_nm_per_rad: float | None
    """Stiffness used in the estimate, N·m/rad; `None` for a rigid joint."""
    strain_ratio: float | None
    """Strain of the tendon: elongation divided by length, m/m; `None` without tendon geometry."""
    tau_el_nm: TorqueStatistics | None
    """Statistics of the elastic torque, N·m; `None` without an estimate."""
    usable_frames: int
    """Number of frames with an estimate."""
    usable_share: float
    """Share of frames with an estimate, 0 to 1."""

    _fields = {
        "difference": "Difference",
        "elongation_m": "",
        "elongation_standard_error_m": "",
        "losses": "Loss",
        "name": "",
        "offset_per_stiffness_error_rad": "",
        "offset_rad": "",
        "reason": "JointError",
        "scatter_rad": "",
        "slides": "",
        "standard_error_rad": "",
        "stiffness_nm_per_rad": "",
        "strain_ratio": "",
        "tau_el_nm": "TorqueStatistics",
        "usable_frames": "",
        "usable_share": "",
    }


class JointInfo(Record):
    """Recorded quantities of a joint."""

    __slots__ = ()

    channels: list[Quantity]
    """Quantities that are recorded."""
    name: str
    """Name of the joint."""

    _fields = {
        "channels": "",
        "name": "",
    }


class JointOffset(Record):
    """Offset of a joint with coupled tendons: rotation of the joint due to their elongations at constant motor
    positions.
    """

    __slots__ = ()

    name: str
    """Name of the joint."""
    offset_rad: Gaussian
    """Offset, rad; positive if the joint lags behind its motors."""

    _fields = {
        "name": "",
        "offset_rad": "Gaussian",
    }


class JointScore(Record):
    """Control error of a joint, contacts excluded. A value without samples is NaN (null in JSON): `rest_*` if
    the arm was never at rest without contact.
    """

    __slots__ = ()

    false_torque_nm: float | None
    """Mean of the estimated external torque without contact, N·m."""
    name: str
    """Name of the joint."""
    peak_rad: float
    """Largest absolute value of `q − q_d` over the whole recording, rad."""
    rest_mean_rad: float | None
    """Mean of `q − q_d` at rest, rad."""
    rest_rms_rad: float | None
    """RMS of `q − q_d` at rest, rad."""
    rms_rad: float | None
    """RMS of `q − q_d` over the whole recording, rad."""
    threshold_nm: float | None
    """Mean threshold, N·m."""
    torque_error_rms_nm: float | None
    """RMS error of the external torque without contact, N·m."""

    _fields = {
        "false_torque_nm": "",
        "name": "",
        "peak_rad": "",
        "rest_mean_rad": "",
        "rest_rms_rad": "",
        "rms_rad": "",
        "threshold_nm": "",
        "torque_error_rms_nm": "",
    }


class JointTrend(Record):
    """Trend of one tendon."""

    __slots__ = ()

    baseline_error_rad: Gaussian
    """Common error of all sessions since the baseline, rad; its uncertainty is included in the offset's interval
    and does not decrease with the number of sessions.
    """
    basis: PriorBasis
    """Basis of the prior and of the forecast."""
    cycles: CycleClock | None
    """Machine cycles, if sessions record them."""
    drift_rad_per_k: Gaussian | None
    """Drift of the records with temperature, rad/K; `None` without temperatures."""
    elongation_m: Gaussian | None
    """Elongation since the last tensioning, m; `None` without tendon geometry."""
    events: list[TrendEvent]
    """Step changes and re-tensionings."""
    first_utc_s: float
    """Start of the first session, s since 1970."""
    forecast: list[ForecastPoint]
    """Forecast of the offset from the last session on."""
    last_utc_s: float
    """Start of the last session, s since 1970."""
    life: LifeForecast | None
    """Age-based replacement, if the strain has no limit and lifetimes of other ropes were specified."""
    limits: list[LimitForecast]
    """Limits of robot.toml, re-tensioning first."""
    name: str
    """Name of the joint."""
    offset_rad: Gaussian
    """Offset at the reference temperature since the last tensioning, rad."""
    rate_rad_per_s: Gaussian
    """Present creep rate, rad/s."""
    reference_c: float
    """Reference temperature of the offset, °C."""
    reported_width_ratio: float
    """Ratio of actual to reported width of the sessions' intervals."""
    series: list[SessionPoint]
    """Sessions in order of time."""
    sessions: int
    """Number of sessions."""
    strain_ratio: Gaussian | None
    """Strain since the first tensioning, as a fraction; `None` without tendon geometry."""
    suspected_step: SuspectedStep | None
    """Suspected step change, which the next session confirms or withdraws."""
    systematic_error_rad: float
    """Standard deviation of the slow error of neighbouring sessions, rad."""
    tensioned_specified: bool
    """Whether the start was specified by the user; otherwise it is that of the first session."""
    tensioned_utc_s: float
    """Start of the creep clock, tensioning or replacement, s since 1970."""
    verdict: TrendVerdict
    """Recommended action for the tendon."""
    without_information: int
    """Number of inconclusive sessions."""

    _fields = {
        "baseline_error_rad": "Gaussian",
        "basis": "PriorBasis",
        "cycles": "CycleClock",
        "drift_rad_per_k": "Gaussian",
        "elongation_m": "Gaussian",
        "events": "TrendEvent",
        "first_utc_s": "",
        "forecast": "ForecastPoint",
        "last_utc_s": "",
        "life": "LifeForecast",
        "limits": "LimitForecast",
        "name": "",
        "offset_rad": "Gaussian",
        "rate_rad_per_s": "Gaussian",
        "reference_c": "",
        "reported_width_ratio": "",
        "series": "SessionPoint",
        "sessions": "",
        "strain_ratio": "Gaussian",
        "suspected_step": "SuspectedStep",
        "systematic_error_rad": "",
        "tensioned_specified": "",
        "tensioned_utc_s": "",
        "verdict": "",
        "without_information": "",
    }


class LateStart(Record):
    """Position that is recorded from a later time on than the recording starts."""

    __slots__ = ()

    after_s: float
    """Time of its first sample since the start of the recording, s."""
    joint: str
    """Name of the joint or motor."""
    quantity: Quantity
    """Quantity of the signal."""

    _fields = {
        "after_s": "",
        "joint": "",
        "quantity": "",
    }


class LifeForecast(Record):
    """Age-based replacement of a rope."""

    __slots__ = ()

    after_high_s: float
    """97.5 % quantile of that time, s."""
    after_low_s: float
    """2.5 % quantile of that time, s."""
    after_s: float
    """Median time from the last session to replacement, s; negative if it was earlier."""
    age_s: float
    """Age of this rope at its last session, s."""
    broke: int
    """Number of those ropes that broke."""
    broken_by_now_ratio: float
    """Share of such ropes that have broken by that age: posterior mean."""
    broken_ratio: float
    """Share of such ropes that have broken by the age of replacement."""
    passed_probability: float
    """Probability that the age of replacement is exceeded."""
    ropes: int
    """Number of ropes the forecast is based on."""
    source: str
    """Table with their lifetimes."""

    _fields = {
        "after_high_s": "",
        "after_low_s": "",
        "after_s": "",
        "age_s": "",
        "broke": "",
        "broken_by_now_ratio": "",
        "broken_ratio": "",
        "passed_probability": "",
        "ropes": "",
        "source": "",
    }


class LimitForecastReplace(Record):
    """Replacement at this strain since the first tensioning."""

    __slots__ = ()

    after_high_s: float | None
    """97.5 % quantile of that time, s; `None` beyond the horizon, or unknown."""
    after_low_s: float | None
    """2.5 % quantile of that time, s; `None` beyond the horizon, or unknown."""
    after_s: float | None
    """Median time from the last session to the exceedance, s; `None` beyond the horizon, or unknown."""
    at_high_utc_s: float | None
    """97.5 % quantile as a date, s since 1970."""
    at_low_utc_s: float | None
    """2.5 % quantile as a date, s since 1970."""
    at_utc_s: float | None
    """Median as a date, s since 1970; `None` as above, or if sessions have no dates."""
    limit_rad: float | None
    """Limit as an offset, rad."""
    passed_probability: float | None
    """Probability that the limit is exceeded already."""
    state: TrendLimitState | None
    """State of the forecast."""
    kind: Literal["replace"]
    strain_ratio: float
    """Strain limit as a fraction."""

    _fields = {
        "after_high_s": "",
        "after_low_s": "",
        "after_s": "",
        "at_high_utc_s": "",
        "at_low_utc_s": "",
        "at_utc_s": "",
        "limit_rad": "",
        "passed_probability": "",
        "state": "",
        "kind": "",
        "strain_ratio": "",
    }


class LimitForecastRetension(Record):
    """Re-tensioning at this elongation since the last tensioning."""

    __slots__ = ()

    after_high_s: float | None
    """97.5 % quantile of that time, s; `None` beyond the horizon, or unknown."""
    after_low_s: float | None
    """2.5 % quantile of that time, s; `None` beyond the horizon, or unknown."""
    after_s: float | None
    """Median time from the last session to the exceedance, s; `None` beyond the horizon, or unknown."""
    at_high_utc_s: float | None
    """97.5 % quantile as a date, s since 1970."""
    at_low_utc_s: float | None
    """2.5 % quantile as a date, s since 1970."""
    at_utc_s: float | None
    """Median as a date, s since 1970; `None` as above, or if sessions have no dates."""
    limit_rad: float | None
    """Limit as an offset, rad."""
    passed_probability: float | None
    """Probability that the limit is exceeded already."""
    state: TrendLimitState | None
    """State of the forecast."""
    elongation_m: float
    """Elongation limit, m."""
    kind: Literal["retension"]

    _fields = {
        "after_high_s": "",
        "after_low_s": "",
        "after_s": "",
        "at_high_utc_s": "",
        "at_low_utc_s": "",
        "at_utc_s": "",
        "limit_rad": "",
        "passed_probability": "",
        "state": "",
        "elongation_m": "",
        "kind": "",
    }


class Load(Record):
    """Load carried by a link."""

    __slots__ = ()

    attach_s: float
    """Held from, s."""
    com_m: list[float]
    """Centre of mass, link frame, m."""
    link: str
    """Name of the link that carries it."""
    mass_kg: float
    """Mass of the load, kg."""
    release_s: float | None
    """Held until, s; none: to the end."""

    _fields = {
        "attach_s": "",
        "com_m": "",
        "link": "",
        "mass_kg": "",
        "release_s": "",
    }


class Location(Record):
    """Location of a value in a file."""

    __slots__ = ()

    file: str
    """Name of the file."""
    key: str
    """Key of a TOML file, or element of a URDF."""
    line: int | None
    """Line number, from 1."""

    _fields = {
        "file": "",
        "key": "",
        "line": "",
    }


class Loss(Record):
    """Frames without an estimate, for one reason."""

    __slots__ = ()

    frames: int
    """Number of frames without an estimate."""
    reason: LossReason
    """Reason for the missing estimate."""
    share: float
    """Share of all frames, 0 to 1."""

    _fields = {
        "frames": "",
        "reason": "",
        "share": "",
    }


class MotorRatio(Record):
    """Motor whose position is proportional to the position of its joint with a factor that is not near one."""

    __slots__ = ()

    joint: str
    """Name of the joint."""
    slope: float
    """Slope of the motor position over the joint position."""

    _fields = {
        "joint": "",
        "slope": "",
    }


class MotorTorqueErrorContradicts(Record):
    """Channel that does not follow the spring torque."""

    __slots__ = ()

    contradicts: MotorTorqueErrorContradictsContradicts

    _fields = {
        "contradicts": "MotorTorqueErrorContradictsContradicts",
    }


class MotorTorqueErrorContradictsContradicts(Record):

    __slots__ = ()

    slope: float
    """Regression slope of the channel on the spring torque; 1 is expected."""

    _fields = {
        "slope": "",
    }


class MotorTorqueErrorNegativeWork(Record):
    """Channel whose work is negative, though a drive with friction does positive work: wrong sign of the
    channel, or of both positions.
    """

    __slots__ = ()

    negative_work: MotorTorqueErrorNegativeWorkNegativeWork

    _fields = {
        "negative_work": "MotorTorqueErrorNegativeWorkNegativeWork",
    }


class MotorTorqueErrorNegativeWorkNegativeWork(Record):

    __slots__ = ()

    work_j: float
    """Work of the channel over the recording, J."""

    _fields = {
        "work_j": "",
    }


class NoEntryNoRopeLaw(Record):
    """Rope law not among the fits."""

    __slots__ = ()

    kind: Literal["no-rope-law"]

    _fields = {
        "kind": "",
    }


class NoEntryNotARopeFit(Record):
    """Another law, no draws, or several amplitudes."""

    __slots__ = ()

    kind: Literal["not-a-rope-fit"]

    _fields = {
        "kind": "",
    }


class NoEntrySeveralAmplitudes(Record):
    """Several amplitudes for one rope."""

    __slots__ = ()

    kind: Literal["several-amplitudes"]

    _fields = {
        "kind": "",
    }


class NoEntrySeveralRopes(Record):
    """Several ropes for one file."""

    __slots__ = ()

    fitted: int
    """Number of fitted ropes."""
    kind: Literal["several-ropes"]

    _fields = {
        "fitted": "",
        "kind": "",
    }


class NoForecastLoad(Record):
    """Load outside the range of the records."""

    __slots__ = ()

    high_n: float
    """Largest load of the supported range, N."""
    kind: Literal["load"]
    load_n: float
    """Requested load, N."""
    low_n: float
    """Smallest load of the supported range, N."""

    _fields = {
        "high_n": "",
        "kind": "",
        "load_n": "",
        "low_n": "",
    }


class NoForecastNoForce(Record):
    """Load specified, but none recorded."""

    __slots__ = ()

    kind: Literal["no-force"]

    _fields = {
        "kind": "",
    }


class NoForecastNoLoad(Record):
    """No stage under load."""

    __slots__ = ()

    kind: Literal["no-load"]

    _fields = {
        "kind": "",
    }


class NoForecastNoTemperature(Record):
    """Temperature specified, but none recorded."""

    __slots__ = ()

    kind: Literal["no-temperature"]

    _fields = {
        "kind": "",
    }


class NoForecastTemperature(Record):
    """Temperature outside the range of the records."""

    __slots__ = ()

    high_c: float
    """Highest temperature of the records, °C."""
    kind: Literal["temperature"]
    low_c: float
    """Lowest temperature of the records, °C."""
    temperature_c: float
    """Requested temperature, °C."""

    _fields = {
        "high_c": "",
        "kind": "",
        "low_c": "",
        "temperature_c": "",
    }


class NoSlopeNotFitted(Record):
    """Failed fit of the straight line."""

    __slots__ = ()

    kind: Literal["not-fitted"]
    reason: CreepError
    """Reason of the failure."""

    _fields = {
        "kind": "",
        "reason": "CreepError",
    }


class NoSlopeTooFewReadings(Record):
    """Too few measurements after the start of the straight line."""

    __slots__ = ()

    from_s: float
    """Start of the straight line, s after the load."""
    kind: Literal["too-few-readings"]
    needed: int
    """Minimum number of measurements."""
    readings: int
    """Number of such measurements."""

    _fields = {
        "from_s": "",
        "kind": "",
        "needed": "",
        "readings": "",
    }


class Noise(Record):
    """Parameters of the noise."""

    __slots__ = ()

    memory: float
    """Correlation time `τ_c` of the slow part: e-folds of the time under load; for a straight line, s."""
    share: float
    """Share of the slow part in the variance of a single measurement, 0 to `SHARE_MAX`."""

    _fields = {
        "memory": "",
        "share": "",
    }


class NotIdentifiableAbove(Record):
    """Any value above a bound."""

    __slots__ = ()

    kind: Literal["above"]
    low: float
    """Lower end of the range."""

    _fields = {
        "kind": "",
        "low": "",
    }


class NotIdentifiableAnything(Record):
    """Any value between, which is most of the searched range."""

    __slots__ = ()

    high: float
    """Upper end of the range."""
    kind: Literal["anything"]
    low: float
    """Lower end of the range."""

    _fields = {
        "high": "",
        "kind": "",
        "low": "",
    }


class NotIdentifiableBelow(Record):
    """Any value below a bound."""

    __slots__ = ()

    high: float
    """Upper end of the range."""
    kind: Literal["below"]

    _fields = {
        "high": "",
        "kind": "",
    }


class NuisanceChange(Record):
    """Prior and posterior of a nuisance parameter."""

    __slots__ = ()

    joint: str | None
    """Name of the joint, tendon or body; none for the payload."""
    moved: bool
    """Whether the data changed it: the standard deviation decreased by more than 20 %, or the mean moved by more
    than one prior standard deviation.
    """
    name: str
    """Name of the parameter."""
    posterior: Gaussian
    """Distribution after the recording."""
    prior: Gaussian
    """Distribution before the recording."""
    unit: str
    """Unit of the parameter; empty for a ratio."""

    _fields = {
        "joint": "",
        "moved": "",
        "name": "",
        "posterior": "Gaussian",
        "prior": "Gaussian",
        "unit": "",
    }


class OnlineTendon(Record):
    """Result of a tendon at the end of an `OnlineTrajectory`."""

    __slots__ = ()

    name: str
    """Name of the joint."""
    offset_rad: Gaussian
    """Offset at the end of the recording, rad."""
    stiffness_changed_probability: float | None
    """Probability of a stiffness change since the baseline, 0 to 1; `None` without a baseline."""

    _fields = {
        "name": "",
        "offset_rad": "Gaussian",
        "stiffness_changed_probability": "",
    }


class OnlineTrajectory(Record):
    """Result of the online estimator (`crate::online`) for a recording."""

    __slots__ = ()

    external_force: ForceEstimate | None
    """Constant external force at the tool at the end of the recording; `None` if it is not estimated."""
    joints: list[OnlineTendon]
    """Results of the tendons at the end of the recording, one entry per elastic joint."""
    provisional: bool
    """Whether any offset is provisional at the end."""
    provisional_intervals: list[ProvisionalInterval]
    """Intervals with a provisional offset: until the first window is solved, and after suspected steps and
    possible contacts.
    """

    _fields = {
        "external_force": "ForceEstimate",
        "joints": "OnlineTendon",
        "provisional": "",
        "provisional_intervals": "ProvisionalInterval",
    }


class Parameter(Record):
    """Fitted parameter; its numbers are in its unit, as laboratories write the laws."""

    __slots__ = ()

    high: float
    """Upper end of the interval."""
    interval: IntervalKind
    """Method of the interval."""
    low: float
    """Lower end of the interval."""
    name: str
    """Symbol of the parameter."""
    not_identifiable: NotIdentifiable | None
    """Range of values consistent with the record, if the parameter is not identifiable."""
    specimen: str | None
    """Specimen it belongs to; `None` if common to all."""
    std_error: float
    """Standard deviation of the draws; NaN without draws."""
    unit: str
    """Unit of all numbers below."""
    value: float
    """Value of maximum likelihood, in its unit."""

    _fields = {
        "high": "",
        "interval": "",
        "low": "",
        "name": "",
        "not_identifiable": "NotIdentifiable",
        "specimen": "",
        "std_error": "",
        "unit": "",
        "value": "",
    }


class PayloadChange(Record):
    """Change of the payload within a recording."""

    __slots__ = ()

    change_kg: Gaussian
    """Change of the payload mass, kg; negative for a load that was released."""
    interval_s: Interval95 | None
    """95 % interval of the time, s."""
    probability: float | None
    """Probability of the change, 0 to 1."""
    time_s: float
    """Time of the change since the start of the recording, s."""

    _fields = {
        "change_kg": "Gaussian",
        "interval_s": "Interval95",
        "probability": "",
        "time_s": "",
    }


class PerhapsNever(Record):
    """Time and its bounds as in JSON: null where it does not occur within the horizon."""

    __slots__ = ()

    high: float | None
    """Upper bound, s."""
    low: float | None
    """Lower bound, s."""
    value: float | None
    """Time at the catalogue values, s."""

    _fields = {
        "high": "",
        "low": "",
        "value": "",
    }


class Pose(Record):
    """Pose of a proposed list."""

    __slots__ = ()

    move_s: float
    """Duration of the move to the pose, s."""
    pause_s: float
    """Duration of the rest at the pose, s."""
    pose_rad: list[float]
    """Joint positions in the order of the joints, rad (m)."""

    _fields = {
        "move_s": "",
        "pause_s": "",
        "pose_rad": "",
    }


class PosesResult(Record):
    """Proposed poses and the expected intervals."""

    __slots__ = ()

    baseline: BaselineSource
    """Baseline on which the expectation is based."""
    duration_s: float
    """Duration of the recording including a rest before the first move, s."""
    expected: list[Expected]
    """Expected standard deviations, one entry per elastic joint."""
    inflation_factor: float
    """Factor by which the intervals of the nominal robot were widened."""
    joint_bits: int
    """Assumed resolution of the joint encoder, bits per revolution."""
    joints: list[str]
    """Names of the joints, in the order of a pose."""
    lists_tried: int
    """Number of pose lists evaluated."""
    payload: bool
    """Whether the gripper may hold an unknown payload."""
    poses: list[Pose]
    """Poses in the order of the visit."""
    robot: str
    """Name of the robot."""
    schema: Literal["sinew/excitation/2"]
    """Name and number of this schema."""

    _fields = {
        "baseline": "BaselineSource",
        "duration_s": "",
        "expected": "Expected",
        "inflation_factor": "",
        "joint_bits": "",
        "joints": "",
        "lists_tried": "",
        "payload": "",
        "poses": "Pose",
        "robot": "",
        "schema": "",
    }


class PossibleViolationElongation(Record):
    """Elongation or shortening above the largest permitted one."""

    __slots__ = ()

    kind: Literal["elongation"]
    limit_m: float
    """Largest permitted elongation, m."""
    share: float
    """Share of the draws that exceed it, 0 to 1."""

    _fields = {
        "kind": "",
        "limit_m": "",
        "share": "",
    }


class PossibleViolationStiffness(Record):
    """Stiffness of the strand below the smallest permitted one."""

    __slots__ = ()

    kind: Literal["stiffness"]
    limit_n_per_m: float
    """Smallest permitted stiffness, N/m."""
    share: float
    """Share of the draws that are below it, 0 to 1."""

    _fields = {
        "kind": "",
        "limit_n_per_m": "",
        "share": "",
    }


class PredictedElongation(Record):
    """Predicted elongation at one time."""

    __slots__ = ()

    broken_share: float
    """Share of the draws in which the rope is broken by then, 0 to 1; in these the elongation is that at the
    break, so that no bound falls because ropes break.
    """
    elongation_m: Bounded
    """Total elongation of the strand since new and slack, m."""
    irreversible_m: Bounded
    """Permanent (irreversible) part of the total elongation, m."""
    since_tensioned_m: Bounded
    """Elongation after pretensioning, counted from one minute after it, m."""
    strain_ratio: Bounded
    """Total strain of the strand since new and slack, m/m."""
    time_s: float
    """Time under the duty, s."""

    _fields = {
        "broken_share": "",
        "elongation_m": "Bounded",
        "irreversible_m": "Bounded",
        "since_tensioned_m": "Bounded",
        "strain_ratio": "Bounded",
        "time_s": "",
    }


class PredictionResult(Record):
    """Prediction for one rope under a duty."""

    __slots__ = ()

    assumed_parameters: int
    """Number of creep law parameters that are assumed, not measured."""
    breaks_after_s: float | None
    """Time at which the rope breaks at the catalogue values, s, if within the requested times; there are no
    elongations after it.
    """
    broken_share: float
    """Share of the draws in which the tension broke the rope, 0 to 1."""
    cautions: list[Caution]
    """Warnings, such as an extrapolation beyond the validity of the law."""
    draws: int
    """Number of draws."""
    duty: str
    """Description of the duty in words."""
    extrapolation: Extrapolation
    """Extrapolation distance of the duty from the tested range, in load and temperature; intervals are widened
    for it, and for times beyond `TestedRange::duration_s`.
    """
    length_m: float
    """Length of the strand, m."""
    lifetime: RopeLifetime
    """Predicted lifetime, with the section that fails first."""
    parameters: int
    """Number of creep law parameters."""
    pulleys: list[PulleyPlace]
    """The guiding pulleys along the rope, in order from the drive."""
    read_at_c: float
    """Temperature that the elongations refer to, °C."""
    read_at_n: float
    """Tension that the elongations refer to, N."""
    readings: list[PredictedElongation]
    """Elongations at the requested times, up to the break of the rope."""
    rope: str
    """Name of the rope in the catalogue."""
    schema: Literal["sinew/rope-predict/2"]
    """Name and number of this schema."""
    seed: int
    """Seed of the draws."""
    strength_left_share: Bounded | None
    """Remaining strength at the last elongation, as a share of the new rope; `None` without strokes or if the
    rope diameter is unknown.
    """
    summary: DutySummary
    """Means and extremes of the duty."""
    tested_range: TestedRange
    """Tested range of the rope."""

    _fields = {
        "assumed_parameters": "",
        "breaks_after_s": "",
        "broken_share": "",
        "cautions": "Caution",
        "draws": "",
        "duty": "",
        "extrapolation": "Extrapolation",
        "length_m": "",
        "lifetime": "RopeLifetime",
        "parameters": "",
        "pulleys": "PulleyPlace",
        "read_at_c": "",
        "read_at_n": "",
        "readings": "PredictedElongation",
        "rope": "",
        "schema": "",
        "seed": "",
        "strength_left_share": "Bounded",
        "summary": "DutySummary",
        "tested_range": "TestedRange",
    }


class PretensionResult(Record):
    """Plan for preconditioning and tensioning a rope."""

    __slots__ = ()

    assumed_parameters: int
    """Number of creep law parameters that are assumed, not measured."""
    broken_share: float
    """Share of the draws in which the rope breaks at the working tension within the horizon, 0 to 1."""
    cautions: list[Caution]
    """Warnings about the plan."""
    chosen: int | None
    """Index of the mildest sufficient procedure at catalogue values: lowest tension first, then shortest time."""
    horizon_s: float
    """Horizon of the plan, s."""
    joint: HeldJoint | None
    """Joint with a second rope in the opposite direction, where the tension is the mean of both."""
    length_m: float
    """Strand length, m."""
    lowest_n: float
    """Lowest tension allowed, N."""
    parameters: int
    """Number of creep law parameters."""
    procedures: list[Procedure]
    """All procedures tried, by tension, then duration."""
    remove_share: float
    """Share of the later elongation that the procedure must remove, 0 to 1."""
    rope: str
    """Name of the rope in the catalogue."""
    schedule_as_delivered: Schedule
    """Schedule of a rope that is strung as delivered."""
    schedule_preconditioned: Schedule
    """Schedule after the chosen procedure (or the most effective one)."""
    schema: Literal["sinew/rope-pretension/2"]
    """Name and number of this schema."""
    series_compliance_m_per_n: float
    """Series compliance of each strand (frame, spring, mounts), m/N."""
    temperature_c: float
    """Temperature of the plan, °C."""
    tension_n: float
    """Working tension, N."""
    without_m: Bounded
    """Largest later elongation without any procedure, m; in draws that break, up to the break."""

    _fields = {
        "assumed_parameters": "",
        "broken_share": "",
        "cautions": "Caution",
        "chosen": "",
        "horizon_s": "",
        "joint": "HeldJoint",
        "length_m": "",
        "lowest_n": "",
        "parameters": "",
        "procedures": "Procedure",
        "remove_share": "",
        "rope": "",
        "schedule_as_delivered": "Schedule",
        "schedule_preconditioned": "Schedule",
        "schema": "",
        "series_compliance_m_per_n": "",
        "temperature_c": "",
        "tension_n": "",
        "without_m": "Bounded",
    }


class PriorBasisRope(Record):
    """Law of the specified rope, and one fifth generic curves."""

    __slots__ = ()

    assumed: int
    """Number of parameters with an assumed value."""
    draws: int
    """Number of draws of the law."""
    duty: str | None
    """Specified duty; `None` for an unknown load with unknown peaks."""
    kind: Literal["rope"]
    parameters: int
    """Number of parameters of its law."""
    rope: str
    """Name of the rope."""

    _fields = {
        "assumed": "",
        "draws": "",
        "duty": "",
        "kind": "",
        "parameters": "",
        "rope": "",
    }


class PriorBasisUnknown(Record):
    """Rope or pretension not specified: the laws of all ropes of the catalogue, or its own, and one fifth
    generic curves.
    """

    __slots__ = ()

    kind: Literal["unknown"]
    missing: MissingFromRobot
    """Missing entry of the robot description."""
    ropes: int
    """Number of ropes whose laws represent it; 1 for its own rope under any pretension."""

    _fields = {
        "kind": "",
        "missing": "",
        "ropes": "",
    }


class Procedure(Record):
    """Preconditioning procedure and its effect."""

    __slots__ = ()

    duration_s: float
    """Duration of the procedure, s."""
    remaining_m: Bounded
    """Largest remaining elongation at working tension, m, counted from one minute after the return to working
    tension.
    """
    removed_share: Bounded
    """Share of the elongation without procedure that it removes."""
    tension_n: float
    """Tension of the procedure, N."""

    _fields = {
        "duration_s": "",
        "remaining_m": "Bounded",
        "removed_share": "Bounded",
        "tension_n": "",
    }


class ProvisionalInterval(Record):
    """Interval in which an offset of an `OnlineTrajectory` was provisional."""

    __slots__ = ()

    from_s: float
    """Start of the interval since the start of the recording, s."""
    to_s: float
    """End of the interval since the start of the recording, s."""

    _fields = {
        "from_s": "",
        "to_s": "",
    }


class Published(Record):
    """Published values of a rope, with origin and uncertainty."""

    __slots__ = ()

    breaking_load_n: CatalogueValue | None
    """Breaking load, N."""
    diameter_m: CatalogueValue | None
    """Diameter of the rope, m."""
    weight_kg_per_m: CatalogueValue | None
    """Weight per length, kg/m."""

    _fields = {
        "breaking_load_n": "CatalogueValue",
        "diameter_m": "CatalogueValue",
        "weight_kg_per_m": "CatalogueValue",
    }


class PulleyPlace(Record):
    """Guiding pulley along a strand, and the bend of the rope over it."""

    __slots__ = ()

    at_m: float
    """Point of first contact with the drive at rest, m from the drive."""
    bend_ratio: float | None
    """Ratio of bend diameter to rope diameter; `None` if the rope diameter is not published."""
    radius_m: float
    """Radius of the rope's path, m."""
    wrap_rad: float
    """Wrap angle, rad."""

    _fields = {
        "at_m": "",
        "bend_ratio": "",
        "radius_m": "",
        "wrap_rad": "",
    }


class RangeCheck(Record):
    """Comparison of a value with its usual range."""

    __slots__ = ()

    high: float | None
    """Upper limit of the usual range; none if unbounded."""
    low: float | None
    """Lower limit of the usual range; none if unbounded."""
    unit: str
    """Unit; empty for a ratio."""
    value: float
    """Compared value, in `unit`."""

    _fields = {
        "high": "",
        "low": "",
        "unit": "",
        "value": "",
    }


class Rank(Record):
    """Rank of one rope."""

    __slots__ = ()

    at_s: float
    """Time at which strains are compared, s: the longest that all records reach."""
    name: str
    """Name of the rope."""
    rank: int
    """One plus the number of ropes whose interval lies completely below; 1 if no rope has a significantly
    smaller strain.
    """
    scatter_share: float
    """Standard deviation between specimens on which the intervals are based, over the strain."""
    scatter_source: ScatterSource
    """Source of that scatter."""
    slope_per_s: Bounded | None
    """Slope of the strain, 1/s."""
    specimens: int
    """Number of repeats."""
    strain_ratio: Bounded
    """Strain at that time, m/m, with the interval of the rope's mean."""

    _fields = {
        "at_s": "",
        "name": "",
        "rank": "",
        "scatter_share": "",
        "scatter_source": "",
        "slope_per_s": "Bounded",
        "specimens": "",
        "strain_ratio": "Bounded",
    }


class RecordingInfo(Record):
    """Properties of a recording."""

    __slots__ = ()

    duration_s: float
    """Time from the first to the last frame, s."""
    format: Format
    """File format of the recording."""
    frames: int
    """Number of frames in the recording."""
    path: str
    """File name as specified by the user."""
    rate_hz: float | None
    """Median frame rate, Hz; `None` with fewer than two frames."""
    segments: int
    """Number of segments without a gap or clock step."""
    sources: list[SignalSource]
    """Source (topic, column or interface) of each quantity."""
    start_time_ns: int
    """Time of the first frame, ns since the epoch of the recording."""

    _fields = {
        "duration_s": "",
        "format": "",
        "frames": "",
        "path": "",
        "rate_hz": "",
        "segments": "",
        "sources": "SignalSource",
        "start_time_ns": "",
    }


class RecordingInfoResult(Record):
    """Content and condition of a recording."""

    __slots__ = ()

    ambiguous: list[Ambiguity]
    """Sides with several candidate topics; no joint is read until one is chosen."""
    duration_s: float | None
    """Duration from the first frame to the last, s."""
    file: str
    """File as the user named it."""
    format: Format
    """Format of the file."""
    frames: int
    """Number of frames."""
    health: Health
    """Losses and repairs of the recording."""
    joints: list[JointInfo]
    """Joints in the recording's order."""
    longest_step_s: float | None
    """Longest step from frame to frame within a segment, s."""
    lossy: bool
    """Whether anything was lost."""
    mean_rate_hz: float | None
    """Frames per second within segments."""
    robot_description: bool
    """Whether the recording holds the robot's URDF."""
    schema: Literal["sinew/log-info/2"]
    """Name and number of this schema."""
    segments: int
    """Parts without a gap, clock jump or damage."""
    shortest_step_s: float | None
    """Shortest step from frame to frame within a segment, s."""
    sources: list[SignalSource]
    """Source of each quantity."""
    start_time_ns: int | None
    """Time of the first frame, ns since the epoch of the recording's clock."""
    temperature: bool
    """Whether a temperature is recorded."""
    tendons: list[str] | None
    """Tendons with a recorded tension, in the order of the recording; omitted if there are none."""
    topics: list[TopicInfo]
    """Topics in the order of their names; empty for a table."""
    unused_columns: list[str]
    """Columns of a table that are not used."""

    _fields = {
        "ambiguous": "Ambiguity",
        "duration_s": "",
        "file": "",
        "format": "",
        "frames": "",
        "health": "Health",
        "joints": "JointInfo",
        "longest_step_s": "",
        "lossy": "",
        "mean_rate_hz": "",
        "robot_description": "",
        "schema": "",
        "segments": "",
        "shortest_step_s": "",
        "sources": "SignalSource",
        "start_time_ns": "",
        "temperature": "",
        "tendons": "",
        "topics": "TopicInfo",
        "unused_columns": "",
    }


class RecordingOutcome(Record):
    """Outcome of one recording."""

    __slots__ = ()

    error: str | None
    """Reason why the recording could not be estimated; none if it was."""
    estimate: EstimateDocument | None
    """Estimate of the recording as printed by `sinew estimate`."""
    recording: str
    """Recording as named on the command line."""

    _fields = {
        "error": "",
        "estimate": "EstimateDocument",
        "recording": "",
    }


class RecordingWarningClockJumps(Record):
    """Steps of the clock of the time stamps, over which the time of the recording continues."""

    __slots__ = ()

    count: int
    """Number of steps, back or ahead."""
    kind: Literal["clock-jumps"]

    _fields = {
        "count": "",
        "kind": "",
    }


class RecordingWarningDamaged(Record):
    """Damaged part of the file."""

    __slots__ = ()

    bytes: int
    """Number of bytes lost."""
    kind: Literal["damaged"]
    offset: int
    """Position in the file, bytes from the start."""
    reason: str
    """Reason of the damage."""

    _fields = {
        "bytes": "",
        "kind": "",
        "offset": "",
        "reason": "",
    }


class RecordingWarningGaps(Record):
    """Gaps in the recording."""

    __slots__ = ()

    count: int
    """Number of gaps."""
    kind: Literal["gaps"]
    longest_s: float
    """Length of the longest gap, s."""

    _fields = {
        "count": "",
        "kind": "",
        "longest_s": "",
    }


class RecordingWarningImplausibleOffset(Record):
    """Offset that is implausibly large for a rope."""

    __slots__ = ()

    joint: str
    """Name of the joint."""
    kind: Literal["implausible-offset"]
    offset_rad: float
    """Estimated offset, rad."""

    _fields = {
        "joint": "",
        "kind": "",
        "offset_rad": "",
    }


class RecordingWarningImplausibleSignal(Record):
    """Implausible signal of the recording."""

    __slots__ = ()

    kind: Literal["implausible-signal"]
    text: str
    """Text of the warning."""

    _fields = {
        "kind": "",
        "text": "",
    }


class RecordingWarningLateStart(Record):
    """Position that is recorded from a later time on than the recording starts."""

    __slots__ = ()

    after_s: float
    """Time of its first sample since the start of the recording, s."""
    joint: str
    """Name of the joint or motor."""
    kind: Literal["late-start"]
    quantity: str
    """Symbol of the quantity."""

    _fields = {
        "after_s": "",
        "joint": "",
        "kind": "",
        "quantity": "",
    }


class RecordingWarningNoTimeStamp(Record):
    """Messages without a time stamp in a topic with time stamps."""

    __slots__ = ()

    count: int
    """Number of messages."""
    kind: Literal["no-time-stamp"]

    _fields = {
        "count": "",
        "kind": "",
    }


class RecordingWarningNonFinite(Record):
    """Samples that are NaN or infinite."""

    __slots__ = ()

    count: int
    """Number of samples."""
    joint: str
    """Name of the joint."""
    kind: Literal["non-finite"]
    quantity: str
    """Symbol of the quantity."""

    _fields = {
        "count": "",
        "joint": "",
        "kind": "",
        "quantity": "",
    }


class RecordingWarningOutOfOrder(Record):
    """Messages that were reordered by time stamp."""

    __slots__ = ()

    count: int
    """Number of messages."""
    kind: Literal["out-of-order"]

    _fields = {
        "count": "",
        "kind": "",
    }


class RecordingWarningReference(Record):
    """Warning about the reference recording."""

    __slots__ = ()

    kind: Literal["reference"]
    warning: RecordingWarning
    """Warning of the reference recording."""

    _fields = {
        "kind": "",
        "warning": "RecordingWarning",
    }


class RecordingWarningRobot(Record):
    """Warning about robot.toml or the URDF."""

    __slots__ = ()

    kind: Literal["robot"]
    text: str
    """Text of the warning."""

    _fields = {
        "kind": "",
        "text": "",
    }


class RecordingWarningSamplesLost(Record):
    """Samples of a stream that are missing, or were excluded because of a duplicate time stamp."""

    __slots__ = ()

    kind: Literal["samples-lost"]
    missing: int
    """Number of missing samples, derived from the time steps of the others."""
    repeated: int
    """Number of excluded samples with a duplicate time stamp."""
    share: float
    """Share of all samples, 0 to 1."""
    stream: StreamRole
    """Role of the stream."""

    _fields = {
        "kind": "",
        "missing": "",
        "repeated": "",
        "share": "",
        "stream": "",
    }


class RecordingWarningSecondPublisher(Record):
    """Samples of a second publisher on the topic of a stream, which were excluded."""

    __slots__ = ()

    kind: Literal["second-publisher"]
    samples: int
    """Number of excluded samples."""
    stream: StreamRole
    """Role of the stream."""

    _fields = {
        "kind": "",
        "samples": "",
        "stream": "",
    }


class RecordingWarningTorqueRangeSmall(Record):
    """Torque range of a joint that is too small to separate the offset from a stiffness or mass error."""

    __slots__ = ()

    joint: str
    """Name of the joint."""
    kind: Literal["torque-range-small"]
    max_nm: float
    """Largest torque, N·m."""
    min_nm: float
    """Smallest torque, N·m."""

    _fields = {
        "joint": "",
        "kind": "",
        "max_nm": "",
        "min_nm": "",
    }


class RecordingWarningUnknownJoints(Record):
    """Joints of the recording that the robot does not have."""

    __slots__ = ()

    joints: list[str]
    """Names of the joints."""
    kind: Literal["unknown-joints"]

    _fields = {
        "joints": "",
        "kind": "",
    }


class RecordingWarningUnusedTensions(Record):
    """Tendons whose tension is recorded, though no estimate of this robot uses it."""

    __slots__ = ()

    kind: Literal["unused-tensions"]
    tendons: list[str]
    """Names of the tendons."""

    _fields = {
        "kind": "",
        "tendons": "",
    }


class RecordingWarningUnwrapped(Record):
    """Encoder wrap-arounds that were corrected."""

    __slots__ = ()

    count: int
    """Number of wrap-arounds."""
    joint: str
    """Name of the joint."""
    kind: Literal["unwrapped"]
    quantity: str
    """Symbol of the quantity."""

    _fields = {
        "count": "",
        "joint": "",
        "kind": "",
        "quantity": "",
    }


class Recovery(Record):
    """Recovery after a decrease of the load."""

    __slots__ = ()

    before_strain_ratio: float
    """Strain at the end of the stage with the higher load, m/m."""
    delayed_strain_ratio: float
    """Strain recovered later, within the record, m/m."""
    duration_s: float
    """Duration of the stage, s."""
    force_after_n: float
    """Load after the decrease, N."""
    force_before_n: float
    """Load before the decrease, N."""
    immediate_strain_ratio: float
    """Strain recovered immediately with the load, m/m."""
    residual_strain_ratio: float
    """Strain at the end of the stage, m/m: the residual strain if the load is removed."""

    _fields = {
        "before_strain_ratio": "",
        "delayed_strain_ratio": "",
        "duration_s": "",
        "force_after_n": "",
        "force_before_n": "",
        "immediate_strain_ratio": "",
        "residual_strain_ratio": "",
    }


class ReferenceMeasurement(Record):
    """Measurement at one reference (end stop or index mark) in one recording."""

    __slots__ = ()

    encoder_error_rad: Gaussian
    """Error of the encoder that measures the reference, rad: the joint encoder at a stop or joint mark, the
    motor encoder at a motor mark.
    """
    joint: str
    """Name of the joint."""
    kind: AnchorKind
    """Kind of the reference."""
    offset_rad: Gaussian | None
    """Offset of the tendon from the push alone, rad; none without a push or without motor torque."""
    position_rad: float
    """Position of the reference, rad (m for a prismatic joint)."""
    time_s: float
    """Time of the contact since the start of the recording, s."""

    _fields = {
        "encoder_error_rad": "Gaussian",
        "joint": "",
        "kind": "",
        "offset_rad": "Gaussian",
        "position_rad": "",
        "time_s": "",
    }


class ReferenceOffset(Record):
    """Correction of one tendon's estimate by references."""

    __slots__ = ()

    by_motion_rad: Gaussian
    """Offset from motion alone, rad."""
    by_push_rad: Gaussian | None
    """Offset from pushes alone, rad; none without a push."""
    correction_rad: Gaussian
    """Error of the encoders by which the offset has been corrected, rad."""
    readings: list[ReferenceMeasurement]
    """Measurements at references, in order of time."""
    since_baseline: bool
    """Whether the baseline contains the same references, so that the following values are differences."""

    _fields = {
        "by_motion_rad": "Gaussian",
        "by_push_rad": "Gaussian",
        "correction_rad": "Gaussian",
        "readings": "ReferenceMeasurement",
        "since_baseline": "",
    }


class Rejected(Record):
    """Rejected rope with its reasons."""

    __slots__ = ()

    reasons: list[Rejection]
    """Reasons of the rejection, one per violated constraint."""
    rope: str
    """Name of the rope in the catalogue."""

    _fields = {
        "reasons": "Rejection",
        "rope": "",
    }


class RejectedInterval(Record):
    """Interval that was rejected as contact or disturbance."""

    __slots__ = ()

    from_s: float
    """Start of the interval since the start of the recording, s."""
    to_s: float
    """End of the interval since the start of the recording, s."""

    _fields = {
        "from_s": "",
        "to_s": "",
    }


class RejectionBendRatio(Record):
    """Ratio of smallest pulley diameter to rope diameter below the limit."""

    __slots__ = ()

    kind: Literal["bend-ratio"]
    limit_ratio: float
    """Smallest permitted ratio of diameters."""
    ratio: float
    """Ratio of pulley diameter to rope diameter."""

    _fields = {
        "kind": "",
        "limit_ratio": "",
        "ratio": "",
    }


class RejectionBendRatioUnknown(Record):
    """Rope or pulley diameter is not known."""

    __slots__ = ()

    kind: Literal["bend-ratio-unknown"]

    _fields = {
        "kind": "",
    }


class RejectionBreakingLoadNotPublished(Record):
    """The breaking load is not published."""

    __slots__ = ()

    kind: Literal["breaking-load-not-published"]

    _fields = {
        "kind": "",
    }


class RejectionBreaks(Record):
    """Break before the last requested time in more than half of the draws."""

    __slots__ = ()

    broken_share: float
    """Share of the draws in which the rope breaks within the last requested time, 0 to 1."""
    cause: BreakCause
    """Cause of the break."""
    kind: Literal["breaks"]
    life_s: Bounded | None
    """Time of the break, s; `None` beyond 300 years at the catalogue values."""

    _fields = {
        "broken_share": "",
        "cause": "",
        "kind": "",
        "life_s": "Bounded",
    }


class RejectionDiameterNotPublished(Record):
    """The diameter is not published."""

    __slots__ = ()

    kind: Literal["diameter-not-published"]

    _fields = {
        "kind": "",
    }


class RejectionElongation(Record):
    """Elongation or shortening above the limit in more than 97.5 % of the draws."""

    __slots__ = ()

    elongation_m: Bounded
    """Elongation at the last requested time, m."""
    kind: Literal["elongation"]
    limit_m: float
    """Largest permitted elongation, m."""

    _fields = {
        "elongation_m": "Bounded",
        "kind": "",
        "limit_m": "",
    }


class RejectionHot(Record):
    """HMPE would be too hot."""

    __slots__ = ()

    kind: Literal["hot"]

    _fields = {
        "kind": "",
    }


class RejectionNotDetermined(Record):
    """Elongation or stiffness that is not finite at the catalogue values or in a draw."""

    __slots__ = ()

    kind: Literal["not-determined"]

    _fields = {
        "kind": "",
    }


class RejectionNotPredicted(Record):
    """Prediction that is not possible."""

    __slots__ = ()

    kind: Literal["not-predicted"]
    reason: str
    """Reason for the missing prediction."""

    _fields = {
        "kind": "",
        "reason": "",
    }


class RejectionSafetyFactor(Record):
    """Ratio of breaking load to largest tension below the limit."""

    __slots__ = ()

    kind: Literal["safety-factor"]
    limit_ratio: float
    """Smallest permitted safety factor."""
    ratio: float
    """Ratio of breaking load to largest tension."""

    _fields = {
        "kind": "",
        "limit_ratio": "",
        "ratio": "",
    }


class RejectionStiffness(Record):
    """Stiffness of the strand below the limit in more than 97.5 % of the draws."""

    __slots__ = ()

    kind: Literal["stiffness"]
    limit_n_per_m: float
    """Smallest permitted stiffness, N/m."""
    stiffness_n_per_m: Bounded
    """Stiffness of the strand, N/m."""

    _fields = {
        "kind": "",
        "limit_n_per_m": "",
        "stiffness_n_per_m": "Bounded",
    }


class RejectionTooHeavy(Record):
    """Weight per length above the largest permitted one."""

    __slots__ = ()

    kind: Literal["too-heavy"]
    limit_kg_per_m: float
    """Largest permitted weight per length, kg/m."""
    weight_kg_per_m: float
    """Weight per length of the rope, kg/m."""

    _fields = {
        "kind": "",
        "limit_kg_per_m": "",
        "weight_kg_per_m": "",
    }


class RejectionTooThick(Record):
    """Diameter above the largest permitted one."""

    __slots__ = ()

    diameter_m: float
    """Diameter of the rope, m."""
    kind: Literal["too-thick"]
    limit_m: float
    """Largest permitted diameter, m."""

    _fields = {
        "diameter_m": "",
        "kind": "",
        "limit_m": "",
    }


class RejectionTooThin(Record):
    """Diameter below the smallest permitted one."""

    __slots__ = ()

    diameter_m: float
    """Diameter of the rope, m."""
    kind: Literal["too-thin"]
    limit_m: float
    """Smallest permitted diameter, m."""

    _fields = {
        "diameter_m": "",
        "kind": "",
        "limit_m": "",
    }


class RejectionWeightNotPublished(Record):
    """The weight is not published."""

    __slots__ = ()

    kind: Literal["weight-not-published"]

    _fields = {
        "kind": "",
    }


class RetensionLimit(Record):
    """Re-tensioning limit of a tendon."""

    __slots__ = ()

    elongation_m: float
    """Elongation at which to re-tension, m."""
    state: LimitState
    """Result of the test whether the elongation exceeds the limit."""

    _fields = {
        "elongation_m": "",
        "state": "",
    }


class RobotCheckResult(Record):
    """Robot as interpreted from its description, and the findings of the check."""

    __slots__ = ()

    drives: list[DriveCheck] | None
    """Drives of the tendons, if not every joint has its own tendon; then stiffness, motor and tendon are listed
    here and not per joint.
    """
    file: str
    """Path of `robot.toml`."""
    findings: list[Finding]
    """Implausible, missing and impossible values, most severe first."""
    joints: list[JointCheck]
    """Joints in the order of Sinew."""
    moving_mass_kg: float
    """Mass moved by the first joint, kg."""
    name: str
    """Name of the robot."""
    routing: RoutingCheck | None
    """Routing of the tendons, where `robot.toml` has `[[tendons]]`."""
    schema: Literal["sinew/robot-check/2"]
    """Name and number of this schema."""
    urdf: str
    """Source of the URDF: its path, or the recording's `/robot_description`."""
    warnings: list[str]
    """Warnings of the URDF parser about unusual content."""

    _fields = {
        "drives": "DriveCheck",
        "file": "",
        "findings": "Finding",
        "joints": "JointCheck",
        "moving_mass_kg": "",
        "name": "",
        "routing": "RoutingCheck",
        "schema": "",
        "urdf": "",
        "warnings": "",
    }


class RobotInfo(Record):
    """Properties of the robot."""

    __slots__ = ()

    file: str
    """Path of the robot file (robot.toml)."""
    joints: list[str] | None
    """Names of the joints, if results are named by tendons rather than joints; empty otherwise."""
    name: str
    """Name of the robot in the URDF."""
    urdf: str
    """Source of the URDF: a file, or the description in the recording."""

    _fields = {
        "file": "",
        "joints": "",
        "name": "",
        "urdf": "",
    }


class RopeLifetime(Record):
    """Predicted lifetime of a rope."""

    __slots__ = ()

    abrasion_factor: float
    """Specified factor by which abrasion accelerates bending fatigue."""
    breaks_after_s: Bounded | None
    """Time of the break since first loading, s, limited to 300 years; `None` if value and lower bound exceed
    that.
    """
    broken_share: float
    """Share of the draws in which the rope breaks within the longest requested time, 0 to 1."""
    cause: BreakCause
    """Cause of the larger part of the damage."""
    spots: list[DamageSite]
    """Sections in order from the drive, then the terminations, at the longest requested time or at the break, at
    the catalogue values.
    """
    termination: RopeTermination
    """Termination of the rope."""
    termination_share: float
    """Share of the rope's strength that the termination retains, 0 to 1."""

    _fields = {
        "abrasion_factor": "",
        "breaks_after_s": "Bounded",
        "broken_share": "",
        "cause": "",
        "spots": "DamageSite",
        "termination": "",
        "termination_share": "",
    }


class RopeListResult(Record):
    """All ropes of a catalogue."""

    __slots__ = ()

    ropes: list[RopeSummary]
    """Ropes in the catalogue's order."""
    schema: Literal["sinew/rope-list/2"]
    """Name and number of this schema."""

    _fields = {
        "ropes": "RopeSummary",
        "schema": "",
    }


class RopeResult(Record):
    """Everything known about a rope."""

    __slots__ = ()

    assumed_parameters: int
    """Number of creep law parameters that are assumed, not measured."""
    breaking_load_n: float | None
    """Published breaking load, N."""
    diameter_m: float | None
    """Published diameter, m."""
    endurance: dict[str, CatalogueValue]
    """Endurance values of the rope or its fibre class by name; the names end in their units."""
    endurance_sources: dict[str, str]
    """Sources of the endurance by their keys."""
    fibre: str
    """Name of the load-bearing fibre."""
    file: str | None
    """File it came from; `None`: ships with the program."""
    law: dict[str, CatalogueValue]
    """Parameters of the law by their names in the catalogue, which end in their units."""
    manufacturer: str
    """Manufacturer of the rope."""
    material: str
    """Material of the fibre."""
    name: str
    """Name of the rope."""
    note: str | None
    """Remarks of the catalogue entry."""
    parameters: int
    """Number of parameters of the creep law."""
    plait: str | None
    """Construction of the braid."""
    product: str
    """Product name of the manufacturer."""
    published: Published
    """Published values of the rope."""
    schema: Literal["sinew/rope-show/2"]
    """Name and number of this schema."""
    sources: dict[str, str]
    """Sources by their keys."""
    tested_range: TestedRange
    """Tested range of the rope; intervals are wider outside this range."""
    weight_kg_per_m: float | None
    """Published weight per length, kg/m."""

    _fields = {
        "assumed_parameters": "",
        "breaking_load_n": "",
        "diameter_m": "",
        "endurance": "map:CatalogueValue",
        "endurance_sources": "",
        "fibre": "",
        "file": "",
        "law": "map:CatalogueValue",
        "manufacturer": "",
        "material": "",
        "name": "",
        "note": "",
        "parameters": "",
        "plait": "",
        "product": "",
        "published": "Published",
        "schema": "",
        "sources": "",
        "tested_range": "TestedRange",
        "weight_kg_per_m": "",
    }


class RopeSummary(Record):
    """Summary of a catalogue rope."""

    __slots__ = ()

    assumed_parameters: int
    """Number of creep law parameters that are assumed, not measured."""
    breaking_load_n: float | None
    """Published breaking load, N."""
    diameter_m: float | None
    """Published diameter, m."""
    fibre: str
    """Name of the load-bearing fibre."""
    file: str | None
    """File it came from; `None`: ships with the program."""
    manufacturer: str
    """Manufacturer of the rope."""
    material: str
    """Material of the fibre."""
    name: str
    """Name of the rope."""
    parameters: int
    """Number of parameters of the creep law."""
    plait: str | None
    """Construction of the braid."""
    product: str
    """Product name of the manufacturer."""
    weight_kg_per_m: float | None
    """Published weight per length, kg/m."""

    _fields = {
        "assumed_parameters": "",
        "breaking_load_n": "",
        "diameter_m": "",
        "fibre": "",
        "file": "",
        "manufacturer": "",
        "material": "",
        "name": "",
        "parameters": "",
        "plait": "",
        "product": "",
        "weight_kg_per_m": "",
    }


class RoutingCheck(Record):
    """Tendons between motors and joints, where `robot.toml` has `[[tendons]]`."""

    __slots__ = ()

    groups: list[GroupCheck]
    """Joints and tendons that are connected with each other, and with no others."""
    joints: list[str]
    """Joints in the order of the moment arms."""
    motors: list[str]
    """Motors in the order of the drums."""
    tendons: list[TendonRouting]
    """Tendons in the order of `robot.toml`, those of the shorthand first."""
    unobservable: list[Combination]
    """Combinations of elongations that are unobservable from the motion of the joints within their limits, with
    every strand taut.
    """

    _fields = {
        "groups": "GroupCheck",
        "joints": "",
        "motors": "",
        "tendons": "TendonRouting",
        "unobservable": "Combination",
    }


class Scatter(Record):
    """Mean and scatter of repeats."""

    __slots__ = ()

    apart: list[str]
    """Outlying specimens, whose end strain is more than 3.5 robust standard deviations from the median of their
    group.
    """
    end_std_ratio: float | None
    """Standard deviation of the end strain between specimens, m/m; `None` for one."""
    end_strain_ratio: float
    """Mean strain at the end, m/m."""
    group: str | None
    """Name of the group; `None` for specimens without a group."""
    slope_per_s: float | None
    """Mean slope of the strain, 1/s."""
    slope_std_per_s: float | None
    """Standard deviation of the slope between specimens, 1/s."""
    specimens: int
    """Number of specimens."""

    _fields = {
        "apart": "",
        "end_std_ratio": "",
        "end_strain_ratio": "",
        "group": "",
        "slope_per_s": "",
        "slope_std_per_s": "",
        "specimens": "",
    }


class Schedule(Record):
    """Schedule of re-tensioning at constant length."""

    __slots__ = ()

    count: Bounded
    """Number of re-tensionings within the horizon."""
    first_s: PerhapsNever
    """Time of the first re-tensioning, s; NaN (null) if a draw has none."""
    never_share: float
    """Share of the draws without any re-tensioning, 0 to 1."""
    start_n: Bounded | None
    """Initial tension with which the lowest tension is never reached within the horizon, N, limited to 40 % of
    the breaking load; `None` if that is insufficient at the catalogue values.
    """
    tension_at_end_n: Bounded
    """Tension at the end of the horizon without re-tensioning, N."""
    times_s: list[float]
    """Times of re-tensioning since stringing, s, at the catalogue values."""
    unattended: Unattended
    """Tension over time without re-tensioning."""

    _fields = {
        "count": "Bounded",
        "first_s": "PerhapsNever",
        "never_share": "",
        "start_n": "Bounded",
        "tension_at_end_n": "Bounded",
        "times_s": "",
        "unattended": "Unattended",
    }


class Score(Record):
    """Joint position and contacts of a run."""

    __slots__ = ()

    contacts: ContactScore
    """Contacts, by the detector as the scenario has it."""
    joints: list[JointScore]
    """One entry per joint."""

    _fields = {
        "contacts": "ContactScore",
        "joints": "JointScore",
    }


class SecondPublisher(Record):
    """Samples of a second publisher on the topic of a stream."""

    __slots__ = ()

    samples: int
    """Number of samples that were excluded."""
    stream: StreamRole
    """Role of the stream."""

    _fields = {
        "samples": "",
        "stream": "",
    }


class SegmentEstimate(Record):
    """Offsets at the end of a segment of some minutes."""

    __slots__ = ()

    from_s: float
    """Start of the segment since the start of the recording, s."""
    offset_rad: list[Gaussian]
    """Offset of each elastic joint at `to_s`, rad, in the order of `joints`."""
    to_s: float
    """End of the segment since the start of the recording, s."""

    _fields = {
        "from_s": "",
        "offset_rad": "Gaussian",
        "to_s": "",
    }


class SelectionResult(Record):
    """Selection of ropes for a duty."""

    __slots__ = ()

    candidates: list[Candidate]
    """Ropes that are not rejected, sorted by `Candidate::rank` and then by `Candidate::change_m`."""
    duty: str
    """The duty in words."""
    rejected: list[Rejected]
    """Rejected ropes with their reasons."""
    schema: Literal["sinew/rope-select/2"]
    """Name and number of this schema."""
    time_s: float
    """Time the elongation is for, s."""

    _fields = {
        "candidates": "Candidate",
        "duty": "",
        "rejected": "Rejected",
        "schema": "",
        "time_s": "",
    }


class SessionEstimate(Record):
    """Result of a session: offset of each tendon since the baseline, or relative to the encoder zero."""

    __slots__ = ()

    baseline: str | None
    """Name of the first recording of the baseline; `None` without a baseline (priors from data sheets only)."""
    baseline_time_utc_s: float | None
    """End of that recording, when every offset was zero, s since 1970 UTC; `None` if its clock has no date."""
    damaged: bool
    """Whether data was lost because the file is damaged."""
    duration_s: float
    """Duration of the evaluated interval, s."""
    external_force: ForceEstimate | None
    """Constant external force at the tool; `None` if none was detected. For a recording of several segments, the
    force of the segment with the highest probability.
    """
    joint_offsets: list[JointOffset] | None
    """Offsets of joints that are driven by several tendons or by strands; empty on other robots, and if a strand
    may be slack.
    """
    joints: list[TendonEstimate]
    """Results of the tendons, one entry per elastic joint."""
    motor_torque: MotorTorque
    """Source of the motor torque that was used as an independent measurement."""
    nuisance: list[NuisanceChange]
    """Prior and posterior of each nuisance parameter."""
    online: OnlineTrajectory | None
    """Online estimate of the same recording; `None` if not requested."""
    payload_changes: list[PayloadChange]
    """Payload changes within the recording."""
    payload_kg: Gaussian
    """Payload mass at the end of the recording, kg."""
    poses: int
    """Number of distinct poses, at rest or in motion; poses are distinct if a joint differs by more than 0.2
    rad.
    """
    recording: str
    """Name of the recording."""
    reference_temperature_c: float | None
    """Reference temperature of the offsets, °C; `None` if unknown."""
    rejected_intervals: list[RejectedInterval]
    """Longest intervals that were rejected as contact or disturbance, at most 20."""
    rejected_share: float
    """Share of the time that was rejected as contact or disturbance, 0 to 1."""
    robot: str
    """Name of the robot."""
    segments: list[SegmentEstimate]
    """Offsets at the end of each segment of the recording."""
    start_time_utc_s: float | None
    """Start of the evaluated interval by the clock of the recording, or the specified date, s since 1970 UTC;
    `None` without a date.
    """
    temperature_c: float | None
    """Mean temperature, °C; `None` if neither recorded nor specified."""
    temperature_source: TemperatureSource
    """Source of the temperature."""
    tension_used: bool | None
    """Whether the tensions of tendons were used."""
    unobservable: list[UnobservableCombination] | None
    """Combinations of elongations that are not observable from the recording."""
    warnings: list[Warning]
    """Warnings about the recording and the result."""
    zero_std_rad: float | None
    """Standard deviation of the encoder zeros by robot.toml, rad, with which offsets without a baseline are
    elongations; `None` with a baseline, or if robot.toml states none.
    """

    _fields = {
        "baseline": "",
        "baseline_time_utc_s": "",
        "damaged": "",
        "duration_s": "",
        "external_force": "ForceEstimate",
        "joint_offsets": "JointOffset",
        "joints": "TendonEstimate",
        "motor_torque": "",
        "nuisance": "NuisanceChange",
        "online": "OnlineTrajectory",
        "payload_changes": "PayloadChange",
        "payload_kg": "Gaussian",
        "poses": "",
        "recording": "",
        "reference_temperature_c": "",
        "rejected_intervals": "RejectedInterval",
        "rejected_share": "",
        "robot": "",
        "segments": "SegmentEstimate",
        "start_time_utc_s": "",
        "temperature_c": "",
        "temperature_source": "",
        "tension_used": "",
        "unobservable": "UnobservableCombination",
        "warnings": "Warning",
        "zero_std_rad": "",
    }


class SessionPoint(Record):
    """Session, and the state of the trend after it."""

    __slots__ = ()

    at_reference_rad: float | None
    """Offset at the reference temperature, with the final drift, rad."""
    cycle: float | None
    """Cycle of the machine."""
    is_outlier: bool
    """Whether the record was treated as an outlier."""
    offset_rad: Gaussian | None
    """Offset as recorded, rad; `None` if the session was inconclusive."""
    step_probability: float
    """Probability of an unconfirmed step change."""
    temperature_c: float | None
    """Temperature of the session, °C."""
    time_utc_s: float
    """Start of the session, s since 1970; from cycle 0 if only cycles are recorded."""
    tracked_rad: Gaussian
    """Offset estimated by the trend at that time, rad."""

    _fields = {
        "at_reference_rad": "",
        "cycle": "",
        "is_outlier": "",
        "offset_rad": "Gaussian",
        "step_probability": "",
        "temperature_c": "",
        "time_utc_s": "",
        "tracked_rad": "Gaussian",
    }


class Settings(Record):
    """Settings of an estimate."""

    __slots__ = ()

    comparison: Comparison
    """Filtering of `theta − q`: by the filters of the observed torque, or none as in the paper."""
    gain_per_s: float
    """Observer gain `K_I`, 1/s."""
    injected: list[Injection]
    """Offsets that were added to the motor positions for a test (`--inject`)."""
    reference: str | None
    """Name of the reference recording; `None` without one."""
    source: TorqueSource
    """Source of the elastic torque `tau_el`."""
    tau_ext: bool
    """Whether the recorded external torque was used."""
    velocity_filter_rad_per_s: float | None
    """Cut-off of the velocity filter, rad/s; `None` with recorded velocities and unfiltered positions."""

    _fields = {
        "comparison": "",
        "gain_per_s": "",
        "injected": "Injection",
        "reference": "",
        "source": "",
        "tau_ext": "",
        "velocity_filter_rad_per_s": "",
    }


class SharedError(Record):
    """Parts of an offset's error that other sessions have too, as standard deviations, rad."""

    __slots__ = ()

    baseline_rad: float
    """Error of the baseline, rad: the same in every session since then."""
    drift_rad: float
    """Error by the temperature dependence of zero and stiffness, rad: proportional to the temperature change
    since then.
    """

    _fields = {
        "baseline_rad": "",
        "drift_rad": "",
    }


class Shift(Record):
    """Shift of one isotherm."""

    __slots__ = ()

    log10_a_t: Gaussian
    """Decadic logarithm of a_T: time at the reference is time here divided by a_T. Its standard error follows
    from the residuals of the overlap and grows along the chain.
    """
    overlap_share: float
    """Overlap of the property's logarithm with the neighbour nearer the reference, as a share of this isotherm's
    own range; without overlap the shift is an extrapolation.
    """
    temperature_c: float
    """Temperature of the isotherm, °C."""

    _fields = {
        "log10_a_t": "Gaussian",
        "overlap_share": "",
        "temperature_c": "",
    }


class SignalCount(Record):
    """Number of affected samples of one signal."""

    __slots__ = ()

    count: int
    """Number of samples, or of turns."""
    joint: str
    """Name of the joint, motor or tendon."""
    quantity: Quantity
    """Quantity of the signal."""

    _fields = {
        "count": "",
        "joint": "",
        "quantity": "",
    }


class SignalCoverage(Record):
    """Coverage of a recording by the position of a joint or motor."""

    __slots__ = ()

    joint: str
    """Name of the joint or motor."""
    longest_interval_s: float
    """Longest interval without a value, including those before the first and after the last one, s."""
    quantity: Quantity
    """Quantity of the signal."""
    repeated_share: float
    """Share of the values that equal the one before, 0 to 1."""
    share: float
    """Share of the frames with a value, 0 to 1."""
    unwrapped: int
    """Number of encoder wrap-arounds that were corrected."""

    _fields = {
        "joint": "",
        "longest_interval_s": "",
        "quantity": "",
        "repeated_share": "",
        "share": "",
        "unwrapped": "",
    }


class SignalSource(Record):
    """Source of a quantity."""

    __slots__ = ()

    quantity: Quantity
    """Quantity that is read."""
    source: str
    """Topic and field or interface, or the columns."""
    topic: str | None
    """Topic of the quantity; `None` for a table."""

    _fields = {
        "quantity": "",
        "source": "",
        "topic": "",
    }


class SimulateComparison(Record):
    """Scores of a scenario without and with its correction."""

    __slots__ = ()

    with_: Score
    """Score with the scenario's `[correction]`."""
    without: Score
    """Neither the set-points nor the external torque corrected."""

    _fields = {
        "with_": "Score",
        "without": "Score",
    }


class SimulatedResult(Record):
    """Truth of a simulated recording, and its control score if requested."""

    __slots__ = ()

    baseline_s: list[float] | None
    """First session, s: `[from, to]`."""
    contact_fraction: float
    """Share of the time in contact."""
    contacts: list[Touch]
    """Contacts during the recording."""
    control: SimulateComparison | None
    """The scenario without and with its correction."""
    duration_s: float
    """Length of the recording, s."""
    frames: Frames
    """Frames lost, repeated and delayed on their way into the file."""
    injected: list[str] | None
    """Names of the tendons whose offsets are injected into the recording and do not act on the spring."""
    joint_coulomb_nm: dict[str, float]
    """Coulomb friction at the joint, N·m."""
    joint_viscous_nm_s_per_rad: dict[str, float]
    """Viscous friction at the joint, N·m·s/rad."""
    mass_kg: dict[str, float]
    """Mass of the body each joint carries, kg."""
    motor_coulomb_nm: dict[str, float]
    """Coulomb friction of the drive, N·m."""
    motor_inertia_kg_m2: dict[str, float]
    """Motor inertia, kg·m²."""
    offset_rad: dict[str, float]
    """Offset just before the end of the second session, or of the recording where there are no sessions, rad."""
    offset_trajectory_s_rad: dict[str, list[list[float]]]
    """Offset over time: `[time, offset]`, s and rad; straight lines between."""
    payload_kg: float
    """All loads together, kg."""
    payloads: list[Load]
    """Loads carried during the recording."""
    sample_rate_hz: float
    """Frames per second."""
    scenario: str
    """Name of the scenario."""
    schema: Literal["sinew/simulate/2"]
    """Name and number of this schema."""
    seed: int
    """Seed of the random numbers."""
    sessions_s: dict[str, list[float]] | None
    """Sessions by name, s."""
    spring_cubic_per_rad2: dict[str, float]
    """Cubic stiffening coefficient of the spring, rad⁻²."""
    start_time_ns: int
    """Time stamp of time 0, ns since 1970."""
    steps: list[Step]
    """Steps of all offsets."""
    stiffness_nm_per_rad: dict[str, float]
    """Stiffness, N·m/rad, at the reference temperature."""
    temperature_change_k: float
    """Drawn temperature change, K."""
    tendons: list[TrueTendon] | None
    """Tendons, where they cross several joints or have names of their own."""
    viscoelastic_fraction: dict[str, float]
    """Share of delayed elasticity."""

    _fields = {
        "baseline_s": "",
        "contact_fraction": "",
        "contacts": "Touch",
        "control": "SimulateComparison",
        "duration_s": "",
        "frames": "Frames",
        "injected": "",
        "joint_coulomb_nm": "",
        "joint_viscous_nm_s_per_rad": "",
        "mass_kg": "",
        "motor_coulomb_nm": "",
        "motor_inertia_kg_m2": "",
        "offset_rad": "",
        "offset_trajectory_s_rad": "",
        "payload_kg": "",
        "payloads": "Load",
        "sample_rate_hz": "",
        "scenario": "",
        "schema": "",
        "seed": "",
        "sessions_s": "",
        "spring_cubic_per_rad2": "",
        "start_time_ns": "",
        "steps": "Step",
        "stiffness_nm_per_rad": "",
        "temperature_change_k": "",
        "tendons": "TrueTendon",
        "viscoelastic_fraction": "",
    }


class Source(Record):
    """Raw data file of a test."""

    __slots__ = ()

    columns: list[SourceColumn]
    """Columns that were used."""
    file: str
    """File name as specified."""
    notes: list[str]
    """Assumptions made when reading it."""
    sha256: str
    """SHA-256 checksum of its bytes."""

    _fields = {
        "columns": "SourceColumn",
        "file": "",
        "notes": "",
        "sha256": "",
    }


class SourceColumn(Record):
    """Column of a file and its role."""

    __slots__ = ()

    column: str
    """Header of the column."""
    quantity: TestQuantity
    """Quantity of the column."""
    unit: str
    """Unit of the column in the file."""

    _fields = {
        "column": "",
        "quantity": "",
        "unit": "",
    }


class Span(Record):
    """Mean, minimum and maximum of measurements, in the unit of the field's name."""

    __slots__ = ()

    high: float
    """Maximum of the measurements."""
    low: float
    """Minimum of the measurements."""
    mean: float
    """Mean of the measurements."""

    _fields = {
        "high": "",
        "low": "",
        "mean": "",
    }


class Step(Record):
    """Step of an offset."""

    __slots__ = ()

    at_s: float
    """Time of the slip, s."""
    joint: str
    """Name of the joint or tendon."""
    size_rad: float
    """Size of the step, rad."""

    _fields = {
        "at_s": "",
        "joint": "",
        "size_rad": "",
    }


class StiffnessSinceBefore(Record):
    """Stiffness change between two recordings, under a model error that depends on pose and direction of motion
    and a drift of 2 %. Offsets are averaged over both hypotheses (change, no change).
    """

    __slots__ = ()

    change_ratio: Gaussian
    """Relative change of the stiffness if there is one; negative for a loss."""
    probability: float
    """Probability that the stiffness changed by more than 5 %, 0 to 1."""

    _fields = {
        "change_ratio": "Gaussian",
        "probability": "",
    }


class StrainZeroAsRecorded(Record):
    """Recorded value, without a measurement before the load."""

    __slots__ = ()

    kind: Literal["as-recorded"]

    _fields = {
        "kind": "",
    }


class StrainZeroBeforeLoad(Record):
    """Mean of measurements before the load."""

    __slots__ = ()

    kind: Literal["before-load"]
    readings: int
    """Number of those measurements."""

    _fields = {
        "kind": "",
        "readings": "",
    }


class StreamTiming(Record):
    """Timing of one stream of samples: a topic, or the rows of a table."""

    __slots__ = ()

    jitter_s: float | None
    """Standard deviation of the shorter intervals from the typical one, s."""
    missing: int | None
    """Number of missing samples; `None` if the intervals are too irregular."""
    repeated: int
    """Number of samples that were discarded, because their time stamp was a duplicate with other values."""
    role: StreamRole
    """Role of the stream."""
    samples: int
    """Number of samples with distinct time stamps."""
    step_s: float | None
    """Typical interval of the samples, s; `None` with too few samples."""

    _fields = {
        "jitter_s": "",
        "missing": "",
        "repeated": "",
        "role": "",
        "samples": "",
        "step_s": "",
    }


class Superposition(Record):
    """Shift factors and their temperature dependence."""

    __slots__ = ()

    arrhenius: Arrhenius | None
    """Arrhenius line through all temperatures."""
    reference_c: float
    """Reference temperature, which is not shifted, °C."""
    shifts: list[Shift]
    """Shifts by increasing temperature."""
    wlf: Wlf | None
    """Equation of Williams, Landel and Ferry over temperatures from the reference up."""

    _fields = {
        "arrhenius": "Arrhenius",
        "reference_c": "",
        "shifts": "Shift",
        "wlf": "Wlf",
    }


class SuspectedStep(Record):
    """Suspected step change."""

    __slots__ = ()

    probability: float
    """Probability of the step change."""
    time_utc_s: float
    """First session after the step change, s since 1970."""

    _fields = {
        "probability": "",
        "time_utc_s": "",
    }


class TendonChange(Record):
    """Sudden change of a tendon."""

    __slots__ = ()

    cause: Cause | None
    """Cause of a slip; `None` for other changes."""
    interval_s: Interval95 | None
    """95 % interval of the time, s; `None` for a change before the recording."""
    kind: TendonChangeKind
    """Type of the change."""
    probability: float | None
    """Probability of a permanent change, 0 to 1; a change near the end may also be a contact. `None` for a
    change before the recording.
    """
    size_rad: Gaussian | None
    """Size of the step of the offset, rad; `None` if only the stiffness changed."""
    stiffness_change_ratio: Gaussian | None
    """Simultaneous relative change of the stiffness, negative for a loss; `None` if none was detected."""
    time_s: float
    """Time of the change since the start of the recording, s."""

    _fields = {
        "cause": "Cause",
        "interval_s": "Interval95",
        "kind": "",
        "probability": "",
        "size_rad": "Gaussian",
        "stiffness_change_ratio": "Gaussian",
        "time_s": "",
    }


class TendonCheck(Record):
    """Tendon geometry and limits."""

    __slots__ = ()

    elongation_m_per_rad: float
    """Elongation per offset, m/rad."""
    joint_pulley_radius_m: float
    """Radius of the pulley at the joint, m."""
    length_m: float
    """Free length, m."""
    pretension_n: float | None
    """Pretension of the rope, N."""
    replace_at_strain_ratio: float | None
    """Strain at which to replace the rope, as a ratio."""
    retension_at_m: float | None
    """Elongation at which to re-tension, m."""
    rope: str | None
    """Catalogue name of the rope."""
    taut_up_to_nm: float | None
    """Maximum torque at which both strands of a loop are taut, `2 r f0`, N·m; none without a pretension, for an
    antagonistic pair, or for a single strand.
    """

    _fields = {
        "elongation_m_per_rad": "",
        "joint_pulley_radius_m": "",
        "length_m": "",
        "pretension_n": "",
        "replace_at_strain_ratio": "",
        "retension_at_m": "",
        "rope": "",
        "taut_up_to_nm": "",
    }


class TendonCreep(Record):
    """Drift of an offset at a constant rate, from creep or a temperature change of the rope."""

    __slots__ = ()

    drift_rad: Gaussian
    """Change of the offset from the start to the end of the recording, rad, averaged over both hypotheses
    (drift, no drift).
    """
    probability: float
    """Probability of the drift, 0 to 1; for a recording of several segments, the highest of all segments."""
    rate_rad_per_s: Gaussian
    """Mean drift rate over the recording, rad/s."""

    _fields = {
        "drift_rad": "Gaussian",
        "probability": "",
        "rate_rad_per_s": "Gaussian",
    }


class TendonEstimate(Record):
    """Result of one tendon."""

    __slots__ = ()

    anchored: ReferenceOffset | None
    """Correction by reference contacts and index marks; `None` if none was touched."""
    changes: list[TendonChange]
    """Sudden changes within the recording."""
    creep: TendonCreep | None
    """Drift of the offset during the recording; `None` if none was detected."""
    elongation_m: Gaussian | None
    """Elongation of the tendon, m; `None` without tendon geometry."""
    excess_residual_rad: float
    """Part of the residual that exceeds the sensor noise, rad; the interval includes it."""
    lower_bound_m: float | None
    """Lower bound of the elongation of a strand that was slack for most of the recording, m; `None` otherwise."""
    lower_bound_rad: float | None
    """Lower bound of the offset of a strand that was slack for most of the recording, rad; `None` otherwise."""
    name: str
    """Name of the joint."""
    noise_rad: float
    """Robust standard deviation of the residual, rad."""
    offset_rad: Gaussian
    """Offset at the end of the recording, rad; positive if the tendon is longer."""
    retension: RetensionLimit | None
    """Re-tensioning limit and its state; `None` if robot.toml specifies no limit."""
    slack_rad: Gaussian | None
    """Half-width of the dead zone (slack) of an antagonistic pair, rad; `None` for other tendons."""
    slack_share: float | None
    """Share of the recording in which the strand was slack, 0 to 1; its elongation is then not determined.
    `None` if never slack.
    """
    slides: bool | None
    """Whether the joint is prismatic: values in rad are then in m, and values in N·m in N."""
    stiffness_change: StiffnessSinceBefore | None
    """Stiffness change relative to the prior of the recording; `None` if not evaluated."""
    stiffness_change_ratio: Gaussian
    """Estimated relative deviation of the stiffness from nominal: `K/K_nominal − 1`."""
    strain_ratio: Gaussian | None
    """Strain: elongation divided by the length of the tendon, m/m; `None` without tendon geometry."""
    systematic_error: SharedError | None
    """Systematic part of the error of the offset, which other sessions share; `None` in files of earlier
    versions.
    """
    torque_nm: TorqueRange
    """Range of the torque of the tendon, N·m."""
    verdict: Verdict
    """Result of the test whether the offset differs from zero."""

    _fields = {
        "anchored": "ReferenceOffset",
        "changes": "TendonChange",
        "creep": "TendonCreep",
        "elongation_m": "Gaussian",
        "excess_residual_rad": "",
        "lower_bound_m": "",
        "lower_bound_rad": "",
        "name": "",
        "noise_rad": "",
        "offset_rad": "Gaussian",
        "retension": "RetensionLimit",
        "slack_rad": "Gaussian",
        "slack_share": "",
        "slides": "",
        "stiffness_change": "StiffnessSinceBefore",
        "stiffness_change_ratio": "Gaussian",
        "strain_ratio": "Gaussian",
        "systematic_error": "SharedError",
        "torque_nm": "TorqueRange",
        "verdict": "",
    }


class TendonRouting(Record):
    """Routing of one tendon."""

    __slots__ = ()

    drums: list[float]
    """Path that each motor takes in per rad, m/rad or rad/rad; 0 of a motor that does not drive it."""
    kind: TendonForm
    """Way in which the tendon pulls."""
    moment_arms: list[float]
    """Moment arm at each joint at `q = 0`, m/rad or rad/rad; 0 of a joint that it does not cross."""
    name: str
    """Name of the tendon."""
    path: PathUnit
    """Unit of the tendon's path."""
    stiffness: float
    """Stiffness, N/m or N·m/rad."""

    _fields = {
        "drums": "",
        "kind": "",
        "moment_arms": "",
        "name": "",
        "path": "",
        "stiffness": "",
    }


class TendonWeight(Record):
    """Weight of a tendon in a combination of elongations."""

    __slots__ = ()

    name: str
    """Name of the tendon."""
    weight: float
    """Elongation relative to the largest one: ratio of values in m if all tendons have a geometry, otherwise of
    values in rad.
    """

    _fields = {
        "name": "",
        "weight": "",
    }


class TestedRange(Record):
    """Tested range: load, temperature and duration of the data that a rope's parameters were validated with."""

    __slots__ = ()

    duration_s: float
    """Length of the longest test, s."""
    load_share: list[float]
    """Lowest and highest tension as a share of the breaking load."""
    temperature_c: list[float]
    """Lowest and highest temperature, °C."""

    _fields = {
        "duration_s": "",
        "load_share": "",
        "temperature_c": "",
    }


class TopicInfo(Record):
    """Topic of a recording."""

    __slots__ = ()

    interfaces: list[str]
    """Interfaces of its joints (`control_msgs/msg/DynamicJointState`)."""
    kind: str
    """Type of its messages, such as `sensor_msgs/msg/JointState`."""
    messages: int
    """Number of messages read."""
    name: str
    """Name of the topic."""
    rate_hz: float | None
    """Message rate by the recorder's clock, Hz; `None` with fewer than two messages."""
    role: TopicUse | None
    """Role of the topic; `None`: not used."""

    _fields = {
        "interfaces": "",
        "kind": "",
        "messages": "",
        "name": "",
        "rate_hz": "",
        "role": "",
    }


class TorqueRange(Record):
    """Minimum and maximum torque in a recording, N·m."""

    __slots__ = ()

    max: float
    """Maximum torque, N·m."""
    min: float
    """Minimum torque, N·m."""

    _fields = {
        "max": "",
        "min": "",
    }


class TorqueStatistics(Record):
    """Statistics of a torque over a recording, N·m."""

    __slots__ = ()

    max: float
    """Maximum torque, N·m."""
    mean: float
    """Mean torque, N·m."""
    min: float
    """Minimum torque, N·m."""

    _fields = {
        "max": "",
        "mean": "",
        "min": "",
    }


class Touch(Record):
    """Contact with a link."""

    __slots__ = ()

    duration_s: float
    """Duration of the contact, s."""
    force_n: list[float]
    """Force in the base frame, N."""
    link: str
    """Name of the link."""
    point_m: list[float]
    """Contact point on the link, link frame, m."""
    start_s: float
    """Start of the contact, s."""

    _fields = {
        "duration_s": "",
        "force_n": "",
        "link": "",
        "point_m": "",
        "start_s": "",
    }


class TrendEventStepChange(Record):
    """Sudden increase of the offset."""

    __slots__ = ()

    confirmed_utc_s: float | None
    """Session that confirmed the event, s since 1970."""
    probability: float | None
    """Posterior probability at confirmation."""
    sessions: int | None
    """Number of supporting sessions: 1 if beyond every modelled error; 0 for a specified event."""
    size_rad: Gaussian | None
    """Change of the offset, rad; `None` for a specified event."""
    stiffness_change_ratio: Gaussian | None
    """Simultaneous change of the stiffness as a fraction of nominal, if sessions report it."""
    time_utc_s: float | None
    """First session after the event, or specified time, s since 1970."""
    cause: StepCause
    """Cause of the increase, as far as the stiffness determines it."""
    kind: Literal["step-change"]

    _fields = {
        "confirmed_utc_s": "",
        "probability": "",
        "sessions": "",
        "size_rad": "Gaussian",
        "stiffness_change_ratio": "Gaussian",
        "time_utc_s": "",
        "cause": "",
        "kind": "",
    }


class TrendEventTensioned(Record):
    """Tensioning of the tendon."""

    __slots__ = ()

    confirmed_utc_s: float | None
    """Session that confirmed the event, s since 1970."""
    probability: float | None
    """Posterior probability at confirmation."""
    sessions: int | None
    """Number of supporting sessions: 1 if beyond every modelled error; 0 for a specified event."""
    size_rad: Gaussian | None
    """Change of the offset, rad; `None` for a specified event."""
    stiffness_change_ratio: Gaussian | None
    """Simultaneous change of the stiffness as a fraction of nominal, if sessions report it."""
    time_utc_s: float | None
    """First session after the event, or specified time, s since 1970."""
    kind: Literal["tensioned"]
    stated: bool
    """Whether it was specified by the user; otherwise the offset decreased."""

    _fields = {
        "confirmed_utc_s": "",
        "probability": "",
        "sessions": "",
        "size_rad": "Gaussian",
        "stiffness_change_ratio": "Gaussian",
        "time_utc_s": "",
        "kind": "",
        "stated": "",
    }


class TrendNoteLifeNotUsed(Record):
    """Lifetimes of such ropes were specified, but do not apply to this one."""

    __slots__ = ()

    joint: str
    """Name of the joint."""
    kind: Literal["life-not-used"]
    reason: LifeNotUsed
    """Reason why they do not apply."""

    _fields = {
        "joint": "",
        "kind": "",
        "reason": "",
    }


class TrendNoteLongBefore(Record):
    """Long gap between tensioning and first session: the date may be wrong."""

    __slots__ = ()

    days: float
    """Time from that day to the first session, days."""
    joint: str
    """Name of the joint."""
    kind: Literal["long-before"]
    time_utc_s: float
    """Specified day, s since 1970."""

    _fields = {
        "days": "",
        "joint": "",
        "kind": "",
        "time_utc_s": "",
    }


class TrendNoteOtherBaseline(Record):
    """Change of the baseline, treated as a re-tensioning."""

    __slots__ = ()

    joint: str
    """Name of the joint."""
    kind: Literal["other-baseline"]
    time_utc_s: float
    """First session with the new baseline, s since 1970."""

    _fields = {
        "joint": "",
        "kind": "",
        "time_utc_s": "",
    }


class TrendNoteOverlapping(Record):
    """Session rejected because it overlaps the previous one."""

    __slots__ = ()

    kind: Literal["overlapping"]
    more: int
    """Number of further rejected sessions."""
    source: str
    """File and location of the first rejected session."""

    _fields = {
        "kind": "",
        "more": "",
        "source": "",
    }


class TrendNoteRepeated(Record):
    """Duplicate session, counted once."""

    __slots__ = ()

    kind: Literal["repeated"]
    more: int
    """Number of further duplicates."""
    source: str
    """File and location of the first duplicate."""

    _fields = {
        "kind": "",
        "more": "",
        "source": "",
    }


class TrendNoteTensioningNotSpecified(Record):
    """Tensioning date not specified: the clock starts at the first session."""

    __slots__ = ()

    joint: str
    """Name of the joint."""
    kind: Literal["tensioning-not-specified"]

    _fields = {
        "joint": "",
        "kind": "",
    }


class TrendResult(Record):
    """Trend of a robot's tendons."""

    __slots__ = ()

    action_required: bool
    """Whether a limit is exceeded or a step change was confirmed (exit code 3)."""
    horizon_s: float
    """Forecast horizon, s from the last session."""
    joints: list[JointTrend]
    """Result of each joint with records."""
    notes: list[TrendNote]
    """Notes on dropped records and assumptions."""
    robot: str | None
    """Robot, if specified or named by a record."""
    schema: Literal["sinew/trend/2"]
    """Name and number of this schema."""
    sinew_version: str
    """Version of the program that wrote the report."""

    _fields = {
        "action_required": "",
        "horizon_s": "",
        "joints": "JointTrend",
        "notes": "TrendNote",
        "robot": "",
        "schema": "",
        "sinew_version": "",
    }


class TrueTendon(Record):
    """Tendon that crosses several joints or has its own name."""

    __slots__ = ()

    drive_ratio: float
    """Ratio of the position in the tendon's coordinate to the position of the motor shaft."""
    joint: str
    """Joint that it is paired with, in whose rad its values are."""
    moment_arms: dict[str, float]
    """Change of the tendon coordinate per rad of every joint that the tendon crosses; for variable moment arms
    at `q = 0`.
    """
    motor: str
    """Name of its motor."""
    name: str
    """Name of the tendon."""
    pretension_nm: float | None
    """Pretension torque of a unidirectional strand with motor and joints at 0, N·m in the tendon coordinate."""

    _fields = {
        "drive_ratio": "",
        "joint": "",
        "moment_arms": "",
        "motor": "",
        "name": "",
        "pretension_nm": "",
    }


class Unattended(Record):
    """Tension of a rope that is strung once and never re-tensioned, at the catalogue values."""

    __slots__ = ()

    sag_rad: list[float]
    """Rotation of the joint under its torque, rad; empty without a joint."""
    tension_n: list[float]
    """Tension, N; with a second rope, the mean of both strands."""
    time_s: list[float]
    """Time since stringing, s."""

    _fields = {
        "sag_rad": "",
        "tension_n": "",
        "time_s": "",
    }


class UnattributedChange(Record):
    """Sudden change of one of several tendons that are indistinguishable."""

    __slots__ = ()

    interval_s: Interval95 | None
    """95 % interval of the time, s."""
    probability: float | None
    """Probability of a permanent change, 0 to 1."""
    time_s: float
    """Time of the change since the start of the recording, s."""

    _fields = {
        "interval_s": "Interval95",
        "probability": "",
        "time_s": "",
    }


class UnitHint(Record):
    """Unit in which the value would be plausible."""

    __slots__ = ()

    unit: str
    """Probable unit of the value in the file."""
    value: float
    """Value converted to the expected unit."""

    _fields = {
        "unit": "",
        "value": "",
    }


class UnobservableCombination(Record):
    """Combination of elongations that is not observable from a recording, such as an equal loss of tension in
    flexor and extensor.
    """

    __slots__ = ()

    changes: list[UnattributedChange] | None
    """Sudden changes of one of the tendons; the recording does not determine which one."""
    remedies: list[Remedy]
    """Measurements that would make the combination observable."""
    std_m: float | None
    """Standard deviation of the largest elongation in the combination, m; `None` without tendon geometry."""
    std_rad: float
    """Standard deviation of the largest elongation in the combination, rad in the coordinate of that tendon."""
    tendons: list[TendonWeight]
    """Tendons of the combination, with their weights."""

    _fields = {
        "changes": "UnattributedChange",
        "remedies": "",
        "std_m": "",
        "std_rad": "",
        "tendons": "TendonWeight",
    }


class UnusableBreaks(Record):
    """Tension above the breaking load of the base rope."""

    __slots__ = ()

    breaking_load_n: float
    """Breaking load of the base rope, N."""
    kind: Literal["breaks"]
    tension_n: float
    """Largest tension, N."""

    _fields = {
        "breaking_load_n": "",
        "kind": "",
        "tension_n": "",
    }


class UnusableForceNeverPositive(Record):
    """No force above zero."""

    __slots__ = ()

    kind: Literal["force-never-positive"]

    _fields = {
        "kind": "",
    }


class UnusableGaugeLength(Record):
    """Invalid gauge length."""

    __slots__ = ()

    kind: Literal["gauge-length"]
    length_m: float
    """Gauge length found, m."""

    _fields = {
        "kind": "",
        "length_m": "",
    }


class UnusableNoGaugeLength(Record):
    """Elongation without a gauge length."""

    __slots__ = ()

    kind: Literal["no-gauge-length"]

    _fields = {
        "kind": "",
    }


class UnusableNoLevel(Record):
    """No plateau of the force."""

    __slots__ = ()

    kind: Literal["no-level"]

    _fields = {
        "kind": "",
    }


class UnusableNoReading(Record):
    """No measurement under load."""

    __slots__ = ()

    kind: Literal["no-reading"]

    _fields = {
        "kind": "",
    }


class UnusableNoStage(Record):
    """No stage under load."""

    __slots__ = ()

    kind: Literal["no-stage"]

    _fields = {
        "kind": "",
    }


class UnusableNoStrain(Record):
    """Missing column of elongation or strain."""

    __slots__ = ()

    kind: Literal["no-strain"]

    _fields = {
        "kind": "",
    }


class UnusableNoTension(Record):
    """Rope law without tensions."""

    __slots__ = ()

    kind: Literal["no-tension"]

    _fields = {
        "kind": "",
    }


class UnusableNoTime(Record):
    """Missing column of times."""

    __slots__ = ()

    kind: Literal["no-time"]

    _fields = {
        "kind": "",
    }


class UnusableNothingToShift(Record):
    """Missing temperature, or neither modulus nor strain to shift."""

    __slots__ = ()

    kind: Literal["nothing-to-shift"]

    _fields = {
        "kind": "",
    }


class UnusableStrainTooLarge(Record):
    """Implausibly large strain of a fibre, rope or plastic."""

    __slots__ = ()

    kind: Literal["strain-too-large"]
    strain_ratio: float
    """Largest strain found, m/m."""

    _fields = {
        "kind": "",
        "strain_ratio": "",
    }


class UnusableSwapped(Record):
    """Variable force with constant strain."""

    __slots__ = ()

    force_change_share: float
    """Change of the force over its last value."""
    kind: Literal["swapped"]
    strain_change_share: float
    """Change of the strain over its last value."""

    _fields = {
        "force_change_share": "",
        "kind": "",
        "strain_change_share": "",
    }


class UnusableTemperature(Record):
    """Temperature outside the range of the rope law."""

    __slots__ = ()

    kind: Literal["temperature"]
    temperature_c: float
    """Temperature of the record, °C."""

    _fields = {
        "kind": "",
        "temperature_c": "",
    }


class UnusableTooFewReadings(Record):
    """Too few measurements."""

    __slots__ = ()

    kind: Literal["too-few-readings"]
    needed: int
    """Minimum number of measurements."""
    readings: int
    """Number of usable measurements."""

    _fields = {
        "kind": "",
        "needed": "",
        "readings": "",
    }


class WarningAtRestAtEnd(Record):
    """Rest phase at the end of the recording, in which stiction can hide a slip."""

    __slots__ = ()

    from_s: float
    """Start of the rest phase since the start of the recording, s."""
    joint: str
    """Name of the joint with the largest slip that can be hidden."""
    kind: Literal["at-rest-at-end"]
    stiction_bound_rad: float
    """Largest slip that stiction can hide, rad."""

    _fields = {
        "from_s": "",
        "joint": "",
        "kind": "",
        "stiction_bound_rad": "",
    }


class WarningBeyondLimits(Record):
    """Joint positions beyond the limits of the URDF: wrong sign, zero, unit or joint."""

    __slots__ = ()

    joint: str
    """Name of the joint."""
    kind: Literal["beyond-limits"]
    lower_rad: float
    """Lower limit, rad."""
    max_rad: float
    """Largest position, rad."""
    min_rad: float
    """Smallest position, rad."""
    opposite_is_within: bool
    """Whether the positions with the opposite sign are within the limits."""
    upper_rad: float
    """Upper limit, rad."""

    _fields = {
        "joint": "",
        "kind": "",
        "lower_rad": "",
        "max_rad": "",
        "min_rad": "",
        "opposite_is_within": "",
        "upper_rad": "",
    }


class WarningBeyondPretension(Record):
    """Loop whose load exceeded twice its pretension, so that one of its strands was slack and its stiffness was
    halved.
    """

    __slots__ = ()

    joint: str
    """Name of the tendon."""
    kind: Literal["beyond-pretension"]
    limit_nm: float
    """Torque up to which both strands remain taut, `2 r f0`, N·m."""
    torque_nm: float
    """Largest magnitude of the torque of the loop, N·m."""

    _fields = {
        "joint": "",
        "kind": "",
        "limit_nm": "",
        "torque_nm": "",
    }


class WarningCableInconclusive(Record):
    """Tendon with friction along its path whose elongation the baseline does not determine under the conditions
    of this recording.
    """

    __slots__ = ()

    joint: str
    """Name of the joint."""
    kind: Literal["cable-inconclusive"]
    reason: CableLimit
    """Condition that is missing."""

    _fields = {
        "joint": "",
        "kind": "",
        "reason": "CableLimit",
    }


class WarningChangeNearEnd(Record):
    """Change so close to the end of the recording that it may be a contact that has not ended."""

    __slots__ = ()

    before_end_s: float
    """Time from the change to the end of the recording, s."""
    joint: str
    """Name of the joint."""
    kind: Literal["change-near-end"]
    time_s: float
    """Time of the change since the start of the recording, s."""

    _fields = {
        "before_end_s": "",
        "joint": "",
        "kind": "",
        "time_s": "",
    }


class WarningDateInconsistent(Record):
    """Specified date that differs by more than a day from the clock of the recording; the specified date is
    used.
    """

    __slots__ = ()

    kind: Literal["date-inconsistent"]
    recorded_utc_s: float
    """Start of the evaluated interval by the clock of the recording, s since 1970 UTC."""
    specified_utc_s: float
    """Specified date, s since 1970 UTC."""

    _fields = {
        "kind": "",
        "recorded_utc_s": "",
        "specified_utc_s": "",
    }


class WarningEncoderDelay(Record):
    """Time offset between motor and joint encoder, which is estimated jointly."""

    __slots__ = ()

    kind: Literal["encoder-delay"]
    motor_delay_s: Gaussian
    """Delay of the motor encoder relative to the joint encoder, s; negative if the motor encoder leads."""

    _fields = {
        "kind": "",
        "motor_delay_s": "Gaussian",
    }


class WarningEncoderZeroOffset(Record):
    """Encoder zero offset of a baseline that is inconsistent with robot.toml; it was estimated instead."""

    __slots__ = ()

    joint: str
    """Name of the joint."""
    kind: Literal["encoder-zero-offset"]
    zero_rad: Gaussian
    """Estimated value of `theta − q` of the unloaded spring directly after tensioning, rad."""

    _fields = {
        "joint": "",
        "kind": "",
        "zero_rad": "Gaussian",
    }


class WarningExternalForce(Record):
    """Constant external force at the tool, which is estimated jointly."""

    __slots__ = ()

    force_n: list[Gaussian]
    """Components of the force along the axes of the base frame if there is one, N."""
    kind: Literal["external-force"]
    probability: float
    """Probability of the external force, 0 to 1."""

    _fields = {
        "force_n": "Gaussian",
        "kind": "",
        "probability": "",
    }


class WarningExternalForceInconsistent(Record):
    """Specified external force that is inconsistent with the recording; the estimated force is used instead."""

    __slots__ = ()

    force_n: list[Gaussian] | None
    """Components of the estimated force along the axes of the base frame, N; `None` if no force was detected."""
    kind: Literal["external-force-inconsistent"]

    _fields = {
        "force_n": "Gaussian",
        "kind": "",
    }


class WarningFarFromPrior(Record):
    """Posterior mean of a parameter that is far from its prior: wrong value or too narrow tolerance in
    robot.toml.
    """

    __slots__ = ()

    is_motor_torque_scale: bool
    """Whether the parameter is the scale of the motor torque, which does not depend on robot.toml alone."""
    joint: str | None
    """Name of the joint or body; `None` for the payload."""
    kind: Literal["far-from-prior"]
    name: str
    """Name of the parameter."""
    stds: float
    """Distance from the prior mean, in prior standard deviations."""

    _fields = {
        "is_motor_torque_scale": "",
        "joint": "",
        "kind": "",
        "name": "",
        "stds": "",
    }


class WarningFewPoses(Record):
    """Too few distinct poses: payload, mass error and offset are not separable."""

    __slots__ = ()

    kind: Literal["few-poses"]
    poses: int
    """Number of distinct poses in the recording."""

    _fields = {
        "kind": "",
        "poses": "",
    }


class WarningFewPosesOfBaseline(Record):
    """Too few distinct poses for a baseline: every later session inherits its uncertainty."""

    __slots__ = ()

    kind: Literal["few-poses-of-baseline"]
    poses: int
    """Number of distinct poses in the recording."""

    _fields = {
        "kind": "",
        "poses": "",
    }


class WarningFramesIncomplete(Record):
    """Frames that were excluded because a position is missing."""

    __slots__ = ()

    frames: int
    """Number of excluded frames."""
    kind: Literal["frames-incomplete"]

    _fields = {
        "frames": "",
        "kind": "",
    }


class WarningJointSeized(Record):
    """Joint that hardly moved while its motor turned: the joint or its encoder is seized. A phase of a constant
    reading in which the motor travels farther than the effort limit bends the spring is excluded.
    """

    __slots__ = ()

    from_s: float
    """Start of the phase since the start of the recording, s."""
    joint: str
    """Name of the joint."""
    joint_travel_rad: float
    """Range of the joint position, rad."""
    kind: Literal["joint-seized"]
    motor_travel_rad: float
    """Range of the motor position, rad."""

    _fields = {
        "from_s": "",
        "joint": "",
        "joint_travel_rad": "",
        "kind": "",
        "motor_travel_rad": "",
    }


class WarningMotorEncoderFrozen(Record):
    """Motor position that is constant from a time on while its joint travels farther than the effort limit bends
    the spring: the motor encoder or its channel is frozen. The phase is excluded.
    """

    __slots__ = ()

    from_s: float
    """Start of the phase since the start of the recording, s."""
    joint: str
    """Name of the joint."""
    joint_travel_rad: float
    """Range of the joint position in the phase, rad."""
    kind: Literal["motor-encoder-frozen"]
    motor_rad: float
    """Constant motor position, rad."""

    _fields = {
        "from_s": "",
        "joint": "",
        "joint_travel_rad": "",
        "kind": "",
        "motor_rad": "",
    }


class WarningMotorTorqueRejected(Record):
    """Motor torque of a joint that is inconsistent with its spring torque and was rejected."""

    __slots__ = ()

    fault: MotorTorqueError
    """Reason for the rejection."""
    joint: str
    """Name of the joint."""
    kind: Literal["motor-torque-rejected"]

    _fields = {
        "fault": "MotorTorqueError",
        "joint": "",
        "kind": "",
    }


class WarningMuchRejected(Record):
    """Large share of the time that was rejected as contact or disturbance."""

    __slots__ = ()

    kind: Literal["much-rejected"]
    share: float
    """Rejected share of the time, 0 to 1."""

    _fields = {
        "kind": "",
        "share": "",
    }


class WarningNegativePayload(Record):
    """Negative payload estimate: the tool is lighter than described, or units or signs are wrong."""

    __slots__ = ()

    kind: Literal["negative-payload"]
    payload_kg: Gaussian
    """Estimated payload mass, kg."""

    _fields = {
        "kind": "",
        "payload_kg": "Gaussian",
    }


class WarningNoBaseline(Record):
    """Estimate without a baseline: offsets refer to the encoder zero, and the interval depends on data-sheet
    tolerances.
    """

    __slots__ = ()

    kind: Literal["no-baseline"]

    _fields = {
        "kind": "",
    }


class WarningNoJointEncoder(Record):
    """Joint without a recorded position: the motor position is used instead, and the tendon is not estimated."""

    __slots__ = ()

    joint: str
    """Name of the joint."""
    kind: Literal["no-joint-encoder"]

    _fields = {
        "joint": "",
        "kind": "",
    }


class WarningPayloadInconsistent(Record):
    """Specified payload that is inconsistent with the recording; the estimated payload is used instead."""

    __slots__ = ()

    kind: Literal["payload-inconsistent"]
    payload_kg: Gaussian
    """Estimated payload mass, kg."""
    probability: float
    """Probability that the specified payload is wrong, 0 to 1; prior odds of 1 to 20."""

    _fields = {
        "kind": "",
        "payload_kg": "Gaussian",
        "probability": "",
    }


class WarningReferenceInconsistent(Record):
    """Offset by contact with an end stop that is inconsistent with the offset by motion."""

    __slots__ = ()

    by_motion_rad: Gaussian
    """Offset by motion, corrected for the encoder errors, rad."""
    by_push_rad: Gaussian
    """Offset by the contact with the end stop, rad."""
    joint: str
    """Name of the joint."""
    kind: Literal["reference-inconsistent"]

    _fields = {
        "by_motion_rad": "Gaussian",
        "by_push_rad": "Gaussian",
        "joint": "",
        "kind": "",
    }


class WarningRestPhaseInconsistent(Record):
    """Mean residual of a joint in the final rest phase that exceeds what stiction explains: a slip, or a lasting
    contact.
    """

    __slots__ = ()

    from_s: float
    """Start of the rest phase since the start of the recording, s."""
    inconsistency_rad: float
    """Mean residual in the rest phase relative to the estimated offset, rad."""
    joint: str
    """Name of the joint."""
    kind: Literal["rest-phase-inconsistent"]
    stiction_bound_rad: float
    """Largest slip that stiction can hide, rad."""

    _fields = {
        "from_s": "",
        "inconsistency_rad": "",
        "joint": "",
        "kind": "",
        "stiction_bound_rad": "",
    }


class WarningRopeMemory(Record):
    """Viscoelastic rope whose load before the recording is unknown; the interval is widened for it."""

    __slots__ = ()

    half_width_95_rad: float
    """Half-width of the 95 % interval for the unknown load history, rad."""
    joint: str
    """Name of the joint."""
    kind: Literal["rope-memory"]

    _fields = {
        "half_width_95_rad": "",
        "joint": "",
        "kind": "",
    }


class WarningStiffnessChanged(Record):
    """Probable stiffness change between the baseline or previous session and this recording."""

    __slots__ = ()

    change_ratio: Gaussian
    """Relative change of the stiffness if there is one; negative for a loss."""
    joint: str
    """Name of the joint."""
    kind: Literal["stiffness-changed"]
    probability: float
    """Probability of the change, 0 to 1."""

    _fields = {
        "change_ratio": "Gaussian",
        "joint": "",
        "kind": "",
        "probability": "",
    }


class WarningTemperatureUnknown(Record):
    """Temperature that was not recorded: its change since the baseline is assumed to be within the tolerance."""

    __slots__ = ()

    half_width_95_rad: float
    """Half-width of the 95 % interval of the thermal effect, rad."""
    joint: str
    """Name of the joint whose interval is widened most."""
    kind: Literal["temperature-unknown"]
    std_k: float
    """Standard deviation of the temperature change since the baseline, K."""

    _fields = {
        "half_width_95_rad": "",
        "joint": "",
        "kind": "",
        "std_k": "",
    }


class WarningTendonCreep(Record):
    """Offset that drifted at a constant rate during the recording; the value at the end is reported."""

    __slots__ = ()

    drift_rad: Gaussian
    """Change of the offset from the start to the end of the recording, rad."""
    duration_s: float
    """Duration of the recording, s."""
    joint: str
    """Name of the joint."""
    kind: Literal["tendon-creep"]
    probability: float
    """Probability of the drift, 0 to 1."""

    _fields = {
        "drift_rad": "Gaussian",
        "duration_s": "",
        "joint": "",
        "kind": "",
        "probability": "",
    }


class WarningTensionRejected(Record):
    """Tension of a tendon that is inconsistent with its extension and was rejected."""

    __slots__ = ()

    fault: MotorTorqueError
    """Reason for the rejection."""
    joint: str
    """Name of the tendon."""
    kind: Literal["tension-rejected"]

    _fields = {
        "fault": "MotorTorqueError",
        "joint": "",
        "kind": "",
    }


class WarningThermalEffect(Record):
    """Temperature difference from the baseline whose unknown effect contributes most of the variance of an
    offset.
    """

    __slots__ = ()

    frame_is_specified: bool
    """Whether robot.toml specifies the thermal expansion of the frame."""
    half_width_95_rad: float
    """Half-width of the 95 % interval of the thermal effect, rad."""
    joint: str
    """Name of the joint with the largest unknown thermal effect."""
    kind: Literal["thermal-effect"]
    temperature_difference_k: float
    """Temperature of the recording minus that of the baseline, K."""

    _fields = {
        "frame_is_specified": "",
        "half_width_95_rad": "",
        "joint": "",
        "kind": "",
        "temperature_difference_k": "",
    }


class WarningTorqueRangeSmall(Record):
    """Torque range of a joint that is too small to separate its offset from an error of the stiffness."""

    __slots__ = ()

    joint: str
    """Name of the joint."""
    kind: Literal["torque-range-small"]
    torque_nm: TorqueRange
    """Range of the torque at the joint, N·m."""

    _fields = {
        "joint": "",
        "kind": "",
        "torque_nm": "TorqueRange",
    }


class WarningUnexplainedResidual(Record):
    """Large residual that the model does not explain; the interval is widened for it."""

    __slots__ = ()

    joint: str
    """Name of the joint."""
    kind: Literal["unexplained-residual"]
    noise_rad: float
    """Robust standard deviation of the residual, rad."""

    _fields = {
        "joint": "",
        "kind": "",
        "noise_rad": "",
    }


class WarningUnmodelledInterval(Record):
    """Long interval that is inconsistent with the model and was rejected."""

    __slots__ = ()

    from_s: float
    """Start of the interval since the start of the recording, s."""
    kind: Literal["unmodelled-interval"]
    to_s: float
    """End of the interval since the start of the recording, s."""

    _fields = {
        "from_s": "",
        "kind": "",
        "to_s": "",
    }


class Wlf(Record):
    """Williams-Landel-Ferry equation `log a_T = −C₁ ΔT/(C₂ + ΔT)`."""

    __slots__ = ()

    c1: float
    """Dimensionless coefficient C₁."""
    c2_k: float
    """Temperature coefficient C₂, K."""
    residual_rms_decades: float
    """Root mean square residual of log10 a_T, decades."""

    _fields = {
        "c1": "",
        "c2_k": "",
        "residual_rms_decades": "",
    }


AnchorKind = Literal["stop", "joint-mark", "motor-mark"]
Artefact = Union[ArtefactDuplicateTimestamps, ArtefactGap, ArtefactImplausibleStrain, ArtefactImplausibleTime, ArtefactInterpolated, ArtefactLoadDrift, ArtefactNoForce, ArtefactNoRamp, ArtefactNonMonotonicTime, ArtefactOutlier, ArtefactShortens, ArtefactSlip, ArtefactSlowRamp]
BaselineSource = Union[BaselineSourceAssumed, BaselineSourceGiven]
BreakCause = Literal["creep-rupture", "bending-fatigue"]
CableLimit = Union[Literal["no-baseline"], CableLimitLoad, CableLimitOneLoad, CableLimitRange, CableLimitReversals]
Cause = Union[Literal["motor-encoder", "joint-encoder", "rope"], CauseUnknown]
Caution = Union[CautionAssumedParameters, CautionBeyondData, CautionBreakingLoadAssumed, CautionCreepsApart, CautionExtrapolated, CautionHighLoad, CautionHot, CautionLoadShare, CautionLowLoad, CautionReplace, CautionTerminationNotSpecified, CautionTightBend, CautionWornOut]
Comparison = Literal["matched", "paper"]
ConditionSource = Literal["held", "stated"]
CreepError = Union[CreepErrorFlat, CreepErrorIncompleteRope, CreepErrorIsotherm, CreepErrorNoEntry, CreepErrorNoForecast, CreepErrorNoGroupColumn, CreepErrorNoPlan, CreepErrorNoRope, CreepErrorNotFinite, CreepErrorNothingAnalysed, CreepErrorOneTemperature, CreepErrorSpecimen, CreepErrorTooFew]
EventKind = Literal["gap", "clock-step", "late", "damage", "undecodable", "implausible-signal"]
FindingKind = Literal["gap", "unknown-joint", "contradiction", "range", "distance", "arm-mass", "heavy-link", "light-link", "density", "inertia-size", "inertia-placeholder", "inertia-not-definite", "inertia-triangle", "frequency", "sag", "too-stiff", "stiffer-than-rope", "motor-inertia", "friction", "unknown-rope", "pretension", "holding-pull", "largest-pull", "pulley-diameter", "elongation-limit", "range-width", "range-reversed", "effort-limit", "negative-limit", "speed-limit", "gravity", "gravity-up"]
Format = Literal["mcap", "csv", "parquet", "db3", "numpy", "arrays", "messages"]
GroupEquations = Literal["tendon", "joint"]
IntervalKind = Literal["draws", "profile", "bootstrap"]
JointError = Union[Literal["rigid", "no-joint-position", "no-motor-position", "no-joint-torque", "no-motor-torque", "no-motor-inertia", "joint-equations", "friction-along-path"], JointErrorNoUsableFrame]
JointMotion = Literal["revolute", "prismatic"]
Law = Literal["log-time", "findley", "burgers", "kelvin-voigt", "stretched", "line", "rope"]
LifeNotUsed = Literal["age-unknown", "strain-limit"]
LimitForecast = Union[LimitForecastReplace, LimitForecastRetension]
LimitState = Literal["passed", "not-passed", "inconclusive"]
LoadQuantity = Literal["force", "stress"]
LossReason = Literal["settling", "joint-position", "joint-velocity", "motor-position", "torque", "external-torque", "range", "duplicate", "late", "undecodable", "without-time"]
Method = Literal["absolute", "paper"]
MissingFromRobot = Literal["tendon", "rope", "pretension"]
MotorTorque = Literal["unused", "measured", "from-current"]
MotorTorqueError = Union[Literal["constant", "untested"], MotorTorqueErrorContradicts, MotorTorqueErrorNegativeWork]
NoEntry = Union[NoEntryNoRopeLaw, NoEntryNotARopeFit, NoEntrySeveralAmplitudes, NoEntrySeveralRopes]
NoForecast = Union[NoForecastLoad, NoForecastNoForce, NoForecastNoLoad, NoForecastNoTemperature, NoForecastTemperature]
NoSlope = Union[NoSlopeNotFitted, NoSlopeTooFewReadings]
NotIdentifiable = Union[NotIdentifiableAbove, NotIdentifiableAnything, NotIdentifiableBelow]
NotIdentifiableReason = Literal["no-change-of-load", "fewer-than-three-loads", "fewer-than-five-loads", "one-load", "one-temperature", "fewer-than-three-temperatures", "too-little-flow", "no-retraction", "none-warm", "with-rate-of-flow"]
Origin = Literal["measured", "observed", "motor-torque", "stated", "assumed-exact", "estimated"]
PathUnit = Literal["m", "rad"]
Place = Literal["rope", "termination"]
PossibleViolation = Union[PossibleViolationElongation, PossibleViolationStiffness]
PriorBasis = Union[PriorBasisRope, PriorBasisUnknown]
Quantity = Literal["q", "theta", "dq", "tau_el", "tau_m", "tau_ext", "temperature", "tension"]
Quantity2 = Literal["positions", "elastic-torque", "transmission", "external-torque", "offset"]
RecordingWarning = Union[RecordingWarningClockJumps, RecordingWarningDamaged, RecordingWarningGaps, RecordingWarningImplausibleOffset, RecordingWarningImplausibleSignal, RecordingWarningLateStart, RecordingWarningNoTimeStamp, RecordingWarningNonFinite, RecordingWarningOutOfOrder, RecordingWarningReference, RecordingWarningRobot, RecordingWarningSamplesLost, RecordingWarningSecondPublisher, RecordingWarningTorqueRangeSmall, RecordingWarningUnknownJoints, RecordingWarningUnusedTensions, RecordingWarningUnwrapped]
Rejection = Union[RejectionBendRatio, RejectionBendRatioUnknown, RejectionBreakingLoadNotPublished, RejectionBreaks, RejectionDiameterNotPublished, RejectionElongation, RejectionHot, RejectionNotDetermined, RejectionNotPredicted, RejectionSafetyFactor, RejectionStiffness, RejectionTooHeavy, RejectionTooThick, RejectionTooThin, RejectionWeightNotPublished]
Remedy = Literal["motor-torque", "tension-sensors"]
RopeShowOrigin = Literal["measured", "published", "fitted", "assumed"]
RopeTermination = Literal["not-specified", "spliced", "knotted"]
ScatterSource = Literal["repeats", "other-ropes", "stated", "assumed"]
Severity = Literal["implausible", "missing", "impossible"]
StepCause = Literal["strand-failure", "slip", "unknown"]
StrainZero = Union[StrainZeroAsRecorded, StrainZeroBeforeLoad]
StreamRole = Literal["both-sides", "joint-side", "motor-side", "external-torque", "tension"]
TemperatureSource = Literal["recorded", "stated", "unknown"]
TendonChangeKind = Literal["slip", "transmission-lost", "strand-failure", "slip-or-strand-failure", "stiffer", "retensioned", "stiffness-loss", "stiffness-increase"]
TendonForm = Literal["loop", "strand"]
Termination = Literal["linear", "gradient", "step", "cost", "no-progress", "step-limit", "failed"]
TestQuantity = Literal["time", "force", "stress", "elongation", "strain", "modulus", "temperature", "humidity", "area", "gauge-length"]
TopicUse = Literal["joint-side", "motor-side", "external-torque", "robot-description", "tension"]
TorqueSource = Literal["observer", "torque-sensor", "motor"]
TrendEvent = Union[TrendEventStepChange, TrendEventTensioned]
TrendLimitState = Literal["passed", "forecast", "not-before", "not-within-horizon", "too-few-sessions"]
TrendNote = Union[TrendNoteLifeNotUsed, TrendNoteLongBefore, TrendNoteOtherBaseline, TrendNoteOverlapping, TrendNoteRepeated, TrendNoteTensioningNotSpecified]
TrendVerdict = Literal["retension", "replace", "inspect", "replace-by-age", "watch", "wait", "no-limit"]
UnknownCause = Literal["missing", "noise", "rate", "both"]
Unusable = Union[UnusableBreaks, UnusableForceNeverPositive, UnusableGaugeLength, UnusableNoGaugeLength, UnusableNoLevel, UnusableNoReading, UnusableNoStage, UnusableNoStrain, UnusableNoTension, UnusableNoTime, UnusableNothingToShift, UnusableStrainTooLarge, UnusableSwapped, UnusableTemperature, UnusableTooFewReadings]
Verdict = Literal["elongated", "shortened", "no-change-detected", "offset-detected", "none-detected", "inconclusive", "transmission-lost"]
Warning = Union[WarningAtRestAtEnd, WarningBeyondLimits, WarningBeyondPretension, WarningCableInconclusive, WarningChangeNearEnd, WarningDateInconsistent, WarningEncoderDelay, WarningEncoderZeroOffset, WarningExternalForce, WarningExternalForceInconsistent, WarningFarFromPrior, WarningFewPoses, WarningFewPosesOfBaseline, WarningFramesIncomplete, WarningJointSeized, WarningMotorEncoderFrozen, WarningMotorTorqueRejected, WarningMuchRejected, WarningNegativePayload, WarningNoBaseline, WarningNoJointEncoder, WarningPayloadInconsistent, WarningReferenceInconsistent, WarningRestPhaseInconsistent, WarningRopeMemory, WarningStiffnessChanged, WarningTemperatureUnknown, WarningTendonCreep, WarningTensionRejected, WarningThermalEffect, WarningTorqueRangeSmall, WarningUnexplainedResidual, WarningUnmodelledInterval]
Forecaster = Union[Literal["combined"], Law]

_CLASSES: Mapping[str, Any] = {
    "Ambiguity": Ambiguity,
    "Analysis": Analysis,
    "Arrhenius": Arrhenius,
    "ArtefactDuplicateTimestamps": ArtefactDuplicateTimestamps,
    "ArtefactGap": ArtefactGap,
    "ArtefactImplausibleStrain": ArtefactImplausibleStrain,
    "ArtefactImplausibleTime": ArtefactImplausibleTime,
    "ArtefactInterpolated": ArtefactInterpolated,
    "ArtefactLoadDrift": ArtefactLoadDrift,
    "ArtefactNoForce": ArtefactNoForce,
    "ArtefactNoRamp": ArtefactNoRamp,
    "ArtefactNonMonotonicTime": ArtefactNonMonotonicTime,
    "ArtefactOutlier": ArtefactOutlier,
    "ArtefactShortens": ArtefactShortens,
    "ArtefactSlip": ArtefactSlip,
    "ArtefactSlowRamp": ArtefactSlowRamp,
    "BaselineMergeResult": BaselineMergeResult,
    "BaselineResult": BaselineResult,
    "BaselineSourceAssumed": BaselineSourceAssumed,
    "BaselineSourceGiven": BaselineSourceGiven,
    "Basis": Basis,
    "Bounded": Bounded,
    "CableLimitLoad": CableLimitLoad,
    "CableLimitLoadLoad": CableLimitLoadLoad,
    "CableLimitOneLoad": CableLimitOneLoad,
    "CableLimitOneLoadOneLoad": CableLimitOneLoadOneLoad,
    "CableLimitRange": CableLimitRange,
    "CableLimitRangeRange": CableLimitRangeRange,
    "CableLimitReversals": CableLimitReversals,
    "CableLimitReversalsReversals": CableLimitReversalsReversals,
    "Candidate": Candidate,
    "CatalogueValue": CatalogueValue,
    "CauseUnknown": CauseUnknown,
    "CautionAssumedParameters": CautionAssumedParameters,
    "CautionBeyondData": CautionBeyondData,
    "CautionBreakingLoadAssumed": CautionBreakingLoadAssumed,
    "CautionCreepsApart": CautionCreepsApart,
    "CautionExtrapolated": CautionExtrapolated,
    "CautionHighLoad": CautionHighLoad,
    "CautionHot": CautionHot,
    "CautionLoadShare": CautionLoadShare,
    "CautionLowLoad": CautionLowLoad,
    "CautionReplace": CautionReplace,
    "CautionTerminationNotSpecified": CautionTerminationNotSpecified,
    "CautionTightBend": CautionTightBend,
    "CautionWornOut": CautionWornOut,
    "Combination": Combination,
    "Conditions": Conditions,
    "ContactScore": ContactScore,
    "Coverage": Coverage,
    "CreepAnalysisResult": CreepAnalysisResult,
    "CreepComparisonResult": CreepComparisonResult,
    "CreepErrorFlat": CreepErrorFlat,
    "CreepErrorIncompleteRope": CreepErrorIncompleteRope,
    "CreepErrorIsotherm": CreepErrorIsotherm,
    "CreepErrorNoEntry": CreepErrorNoEntry,
    "CreepErrorNoForecast": CreepErrorNoForecast,
    "CreepErrorNoGroupColumn": CreepErrorNoGroupColumn,
    "CreepErrorNoPlan": CreepErrorNoPlan,
    "CreepErrorNoRope": CreepErrorNoRope,
    "CreepErrorNotFinite": CreepErrorNotFinite,
    "CreepErrorNothingAnalysed": CreepErrorNothingAnalysed,
    "CreepErrorOneTemperature": CreepErrorOneTemperature,
    "CreepErrorSpecimen": CreepErrorSpecimen,
    "CreepErrorTooFew": CreepErrorTooFew,
    "CreepFitResult": CreepFitResult,
    "CreepHoldOutResult": CreepHoldOutResult,
    "CreepShiftResult": CreepShiftResult,
    "CycleClock": CycleClock,
    "Damage": Damage,
    "DamageSite": DamageSite,
    "Difference": Difference,
    "DriveCheck": DriveCheck,
    "DutySummary": DutySummary,
    "Ending": Ending,
    "Estimate": Estimate,
    "EstimateDocument": EstimateDocument,
    "EstimateEachResult": EstimateEachResult,
    "EstimateResult": EstimateResult,
    "Event": Event,
    "Expected": Expected,
    "Extrapolation": Extrapolation,
    "Failure": Failure,
    "Finding": Finding,
    "Fit": Fit,
    "FitSet": FitSet,
    "FixedParameter": FixedParameter,
    "ForceEstimate": ForceEstimate,
    "Forecast": Forecast,
    "ForecastConditions": ForecastConditions,
    "ForecastPoint": ForecastPoint,
    "Frames": Frames,
    "Gaussian": Gaussian,
    "GroupCheck": GroupCheck,
    "Health": Health,
    "HeldJoint": HeldJoint,
    "Injection": Injection,
    "Interval95": Interval95,
    "IsoMeasurement": IsoMeasurement,
    "Isochrone": Isochrone,
    "IsochronePoint": IsochronePoint,
    "JointCheck": JointCheck,
    "JointErrorNoUsableFrame": JointErrorNoUsableFrame,
    "JointEstimate": JointEstimate,
    "JointInfo": JointInfo,
    "JointOffset": JointOffset,
    "JointScore": JointScore,
    "JointTrend": JointTrend,
    "LateStart": LateStart,
    "LifeForecast": LifeForecast,
    "LimitForecastReplace": LimitForecastReplace,
    "LimitForecastRetension": LimitForecastRetension,
    "Load": Load,
    "Location": Location,
    "Loss": Loss,
    "MotorRatio": MotorRatio,
    "MotorTorqueErrorContradicts": MotorTorqueErrorContradicts,
    "MotorTorqueErrorContradictsContradicts": MotorTorqueErrorContradictsContradicts,
    "MotorTorqueErrorNegativeWork": MotorTorqueErrorNegativeWork,
    "MotorTorqueErrorNegativeWorkNegativeWork": MotorTorqueErrorNegativeWorkNegativeWork,
    "NoEntryNoRopeLaw": NoEntryNoRopeLaw,
    "NoEntryNotARopeFit": NoEntryNotARopeFit,
    "NoEntrySeveralAmplitudes": NoEntrySeveralAmplitudes,
    "NoEntrySeveralRopes": NoEntrySeveralRopes,
    "NoForecastLoad": NoForecastLoad,
    "NoForecastNoForce": NoForecastNoForce,
    "NoForecastNoLoad": NoForecastNoLoad,
    "NoForecastNoTemperature": NoForecastNoTemperature,
    "NoForecastTemperature": NoForecastTemperature,
    "NoSlopeNotFitted": NoSlopeNotFitted,
    "NoSlopeTooFewReadings": NoSlopeTooFewReadings,
    "Noise": Noise,
    "NotIdentifiableAbove": NotIdentifiableAbove,
    "NotIdentifiableAnything": NotIdentifiableAnything,
    "NotIdentifiableBelow": NotIdentifiableBelow,
    "NuisanceChange": NuisanceChange,
    "OnlineTendon": OnlineTendon,
    "OnlineTrajectory": OnlineTrajectory,
    "Parameter": Parameter,
    "PayloadChange": PayloadChange,
    "PerhapsNever": PerhapsNever,
    "Pose": Pose,
    "PosesResult": PosesResult,
    "PossibleViolationElongation": PossibleViolationElongation,
    "PossibleViolationStiffness": PossibleViolationStiffness,
    "PredictedElongation": PredictedElongation,
    "PredictionResult": PredictionResult,
    "PretensionResult": PretensionResult,
    "PriorBasisRope": PriorBasisRope,
    "PriorBasisUnknown": PriorBasisUnknown,
    "Procedure": Procedure,
    "ProvisionalInterval": ProvisionalInterval,
    "Published": Published,
    "PulleyPlace": PulleyPlace,
    "RangeCheck": RangeCheck,
    "Rank": Rank,
    "RecordingInfo": RecordingInfo,
    "RecordingInfoResult": RecordingInfoResult,
    "RecordingOutcome": RecordingOutcome,
    "RecordingWarningClockJumps": RecordingWarningClockJumps,
    "RecordingWarningDamaged": RecordingWarningDamaged,
    "RecordingWarningGaps": RecordingWarningGaps,
    "RecordingWarningImplausibleOffset": RecordingWarningImplausibleOffset,
    "RecordingWarningImplausibleSignal": RecordingWarningImplausibleSignal,
    "RecordingWarningLateStart": RecordingWarningLateStart,
    "RecordingWarningNoTimeStamp": RecordingWarningNoTimeStamp,
    "RecordingWarningNonFinite": RecordingWarningNonFinite,
    "RecordingWarningOutOfOrder": RecordingWarningOutOfOrder,
    "RecordingWarningReference": RecordingWarningReference,
    "RecordingWarningRobot": RecordingWarningRobot,
    "RecordingWarningSamplesLost": RecordingWarningSamplesLost,
    "RecordingWarningSecondPublisher": RecordingWarningSecondPublisher,
    "RecordingWarningTorqueRangeSmall": RecordingWarningTorqueRangeSmall,
    "RecordingWarningUnknownJoints": RecordingWarningUnknownJoints,
    "RecordingWarningUnusedTensions": RecordingWarningUnusedTensions,
    "RecordingWarningUnwrapped": RecordingWarningUnwrapped,
    "Recovery": Recovery,
    "ReferenceMeasurement": ReferenceMeasurement,
    "ReferenceOffset": ReferenceOffset,
    "Rejected": Rejected,
    "RejectedInterval": RejectedInterval,
    "RejectionBendRatio": RejectionBendRatio,
    "RejectionBendRatioUnknown": RejectionBendRatioUnknown,
    "RejectionBreakingLoadNotPublished": RejectionBreakingLoadNotPublished,
    "RejectionBreaks": RejectionBreaks,
    "RejectionDiameterNotPublished": RejectionDiameterNotPublished,
    "RejectionElongation": RejectionElongation,
    "RejectionHot": RejectionHot,
    "RejectionNotDetermined": RejectionNotDetermined,
    "RejectionNotPredicted": RejectionNotPredicted,
    "RejectionSafetyFactor": RejectionSafetyFactor,
    "RejectionStiffness": RejectionStiffness,
    "RejectionTooHeavy": RejectionTooHeavy,
    "RejectionTooThick": RejectionTooThick,
    "RejectionTooThin": RejectionTooThin,
    "RejectionWeightNotPublished": RejectionWeightNotPublished,
    "RetensionLimit": RetensionLimit,
    "RobotCheckResult": RobotCheckResult,
    "RobotInfo": RobotInfo,
    "RopeLifetime": RopeLifetime,
    "RopeListResult": RopeListResult,
    "RopeResult": RopeResult,
    "RopeSummary": RopeSummary,
    "RoutingCheck": RoutingCheck,
    "Scatter": Scatter,
    "Schedule": Schedule,
    "Score": Score,
    "SecondPublisher": SecondPublisher,
    "SegmentEstimate": SegmentEstimate,
    "SelectionResult": SelectionResult,
    "SessionEstimate": SessionEstimate,
    "SessionPoint": SessionPoint,
    "Settings": Settings,
    "SharedError": SharedError,
    "Shift": Shift,
    "SignalCount": SignalCount,
    "SignalCoverage": SignalCoverage,
    "SignalSource": SignalSource,
    "SimulateComparison": SimulateComparison,
    "SimulatedResult": SimulatedResult,
    "Source": Source,
    "SourceColumn": SourceColumn,
    "Span": Span,
    "Step": Step,
    "StiffnessSinceBefore": StiffnessSinceBefore,
    "StrainZeroAsRecorded": StrainZeroAsRecorded,
    "StrainZeroBeforeLoad": StrainZeroBeforeLoad,
    "StreamTiming": StreamTiming,
    "Superposition": Superposition,
    "SuspectedStep": SuspectedStep,
    "TendonChange": TendonChange,
    "TendonCheck": TendonCheck,
    "TendonCreep": TendonCreep,
    "TendonEstimate": TendonEstimate,
    "TendonRouting": TendonRouting,
    "TendonWeight": TendonWeight,
    "TestedRange": TestedRange,
    "TopicInfo": TopicInfo,
    "TorqueRange": TorqueRange,
    "TorqueStatistics": TorqueStatistics,
    "Touch": Touch,
    "TrendEventStepChange": TrendEventStepChange,
    "TrendEventTensioned": TrendEventTensioned,
    "TrendNoteLifeNotUsed": TrendNoteLifeNotUsed,
    "TrendNoteLongBefore": TrendNoteLongBefore,
    "TrendNoteOtherBaseline": TrendNoteOtherBaseline,
    "TrendNoteOverlapping": TrendNoteOverlapping,
    "TrendNoteRepeated": TrendNoteRepeated,
    "TrendNoteTensioningNotSpecified": TrendNoteTensioningNotSpecified,
    "TrendResult": TrendResult,
    "TrueTendon": TrueTendon,
    "Unattended": Unattended,
    "UnattributedChange": UnattributedChange,
    "UnitHint": UnitHint,
    "UnobservableCombination": UnobservableCombination,
    "UnusableBreaks": UnusableBreaks,
    "UnusableForceNeverPositive": UnusableForceNeverPositive,
    "UnusableGaugeLength": UnusableGaugeLength,
    "UnusableNoGaugeLength": UnusableNoGaugeLength,
    "UnusableNoLevel": UnusableNoLevel,
    "UnusableNoReading": UnusableNoReading,
    "UnusableNoStage": UnusableNoStage,
    "UnusableNoStrain": UnusableNoStrain,
    "UnusableNoTension": UnusableNoTension,
    "UnusableNoTime": UnusableNoTime,
    "UnusableNothingToShift": UnusableNothingToShift,
    "UnusableStrainTooLarge": UnusableStrainTooLarge,
    "UnusableSwapped": UnusableSwapped,
    "UnusableTemperature": UnusableTemperature,
    "UnusableTooFewReadings": UnusableTooFewReadings,
    "WarningAtRestAtEnd": WarningAtRestAtEnd,
    "WarningBeyondLimits": WarningBeyondLimits,
    "WarningBeyondPretension": WarningBeyondPretension,
    "WarningCableInconclusive": WarningCableInconclusive,
    "WarningChangeNearEnd": WarningChangeNearEnd,
    "WarningDateInconsistent": WarningDateInconsistent,
    "WarningEncoderDelay": WarningEncoderDelay,
    "WarningEncoderZeroOffset": WarningEncoderZeroOffset,
    "WarningExternalForce": WarningExternalForce,
    "WarningExternalForceInconsistent": WarningExternalForceInconsistent,
    "WarningFarFromPrior": WarningFarFromPrior,
    "WarningFewPoses": WarningFewPoses,
    "WarningFewPosesOfBaseline": WarningFewPosesOfBaseline,
    "WarningFramesIncomplete": WarningFramesIncomplete,
    "WarningJointSeized": WarningJointSeized,
    "WarningMotorEncoderFrozen": WarningMotorEncoderFrozen,
    "WarningMotorTorqueRejected": WarningMotorTorqueRejected,
    "WarningMuchRejected": WarningMuchRejected,
    "WarningNegativePayload": WarningNegativePayload,
    "WarningNoBaseline": WarningNoBaseline,
    "WarningNoJointEncoder": WarningNoJointEncoder,
    "WarningPayloadInconsistent": WarningPayloadInconsistent,
    "WarningReferenceInconsistent": WarningReferenceInconsistent,
    "WarningRestPhaseInconsistent": WarningRestPhaseInconsistent,
    "WarningRopeMemory": WarningRopeMemory,
    "WarningStiffnessChanged": WarningStiffnessChanged,
    "WarningTemperatureUnknown": WarningTemperatureUnknown,
    "WarningTendonCreep": WarningTendonCreep,
    "WarningTensionRejected": WarningTensionRejected,
    "WarningThermalEffect": WarningThermalEffect,
    "WarningTorqueRangeSmall": WarningTorqueRangeSmall,
    "WarningUnexplainedResidual": WarningUnexplainedResidual,
    "WarningUnmodelledInterval": WarningUnmodelledInterval,
    "Wlf": Wlf,
    "Artefact": {"slip": ArtefactSlip, "outlier": ArtefactOutlier, "load-drift": ArtefactLoadDrift, "no-force": ArtefactNoForce, "no-ramp": ArtefactNoRamp, "slow-ramp": ArtefactSlowRamp, "duplicate-timestamps": ArtefactDuplicateTimestamps, "non-monotonic-time": ArtefactNonMonotonicTime, "gap": ArtefactGap, "interpolated": ArtefactInterpolated, "implausible-strain": ArtefactImplausibleStrain, "shortens": ArtefactShortens, "implausible-time": ArtefactImplausibleTime},
    "BaselineSource": {"given": BaselineSourceGiven, "assumed": BaselineSourceAssumed},
    "CableLimit": {"one-load": CableLimitOneLoad, "load": CableLimitLoad, "range": CableLimitRange, "reversals": CableLimitReversals},
    "Cause": {"unknown": CauseUnknown},
    "Caution": {"low-load": CautionLowLoad, "high-load": CautionHighLoad, "hot": CautionHot, "breaking-load-assumed": CautionBreakingLoadAssumed, "extrapolated": CautionExtrapolated, "creeps-apart": CautionCreepsApart, "worn-out": CautionWornOut, "replace": CautionReplace, "tight-bend": CautionTightBend, "load-share": CautionLoadShare, "termination-not-specified": CautionTerminationNotSpecified, "beyond-data": CautionBeyondData, "assumed-parameters": CautionAssumedParameters},
    "CreepError": {"too-few": CreepErrorTooFew, "no-plan": CreepErrorNoPlan, "flat": CreepErrorFlat, "not-finite": CreepErrorNotFinite, "specimen": CreepErrorSpecimen, "nothing-analysed": CreepErrorNothingAnalysed, "no-group-column": CreepErrorNoGroupColumn, "no-rope": CreepErrorNoRope, "incomplete-rope": CreepErrorIncompleteRope, "no-entry": CreepErrorNoEntry, "no-forecast": CreepErrorNoForecast, "isotherm": CreepErrorIsotherm, "one-temperature": CreepErrorOneTemperature},
    "JointError": {"no-usable-frame": JointErrorNoUsableFrame},
    "LimitForecast": {"retension": LimitForecastRetension, "replace": LimitForecastReplace},
    "MotorTorqueError": {"contradicts": MotorTorqueErrorContradicts, "negative-work": MotorTorqueErrorNegativeWork},
    "NoEntry": {"several-amplitudes": NoEntrySeveralAmplitudes, "several-ropes": NoEntrySeveralRopes, "no-rope-law": NoEntryNoRopeLaw, "not-a-rope-fit": NoEntryNotARopeFit},
    "NoForecast": {"no-load": NoForecastNoLoad, "no-force": NoForecastNoForce, "no-temperature": NoForecastNoTemperature, "load": NoForecastLoad, "temperature": NoForecastTemperature},
    "NoSlope": {"too-few-readings": NoSlopeTooFewReadings, "not-fitted": NoSlopeNotFitted},
    "NotIdentifiable": {"anything": NotIdentifiableAnything, "below": NotIdentifiableBelow, "above": NotIdentifiableAbove},
    "PossibleViolation": {"elongation": PossibleViolationElongation, "stiffness": PossibleViolationStiffness},
    "PriorBasis": {"unknown": PriorBasisUnknown, "rope": PriorBasisRope},
    "RecordingWarning": {"robot": RecordingWarningRobot, "implausible-signal": RecordingWarningImplausibleSignal, "unknown-joints": RecordingWarningUnknownJoints, "unused-tensions": RecordingWarningUnusedTensions, "implausible-offset": RecordingWarningImplausibleOffset, "torque-range-small": RecordingWarningTorqueRangeSmall, "damaged": RecordingWarningDamaged, "gaps": RecordingWarningGaps, "clock-jumps": RecordingWarningClockJumps, "out-of-order": RecordingWarningOutOfOrder, "samples-lost": RecordingWarningSamplesLost, "second-publisher": RecordingWarningSecondPublisher, "late-start": RecordingWarningLateStart, "no-time-stamp": RecordingWarningNoTimeStamp, "non-finite": RecordingWarningNonFinite, "unwrapped": RecordingWarningUnwrapped, "reference": RecordingWarningReference},
    "Rejection": {"too-thick": RejectionTooThick, "too-thin": RejectionTooThin, "too-heavy": RejectionTooHeavy, "bend-ratio": RejectionBendRatio, "safety-factor": RejectionSafetyFactor, "elongation": RejectionElongation, "stiffness": RejectionStiffness, "diameter-not-published": RejectionDiameterNotPublished, "weight-not-published": RejectionWeightNotPublished, "bend-ratio-unknown": RejectionBendRatioUnknown, "breaking-load-not-published": RejectionBreakingLoadNotPublished, "breaks": RejectionBreaks, "hot": RejectionHot, "not-determined": RejectionNotDetermined, "not-predicted": RejectionNotPredicted},
    "StrainZero": {"before-load": StrainZeroBeforeLoad, "as-recorded": StrainZeroAsRecorded},
    "TrendEvent": {"step-change": TrendEventStepChange, "tensioned": TrendEventTensioned},
    "TrendNote": {"repeated": TrendNoteRepeated, "overlapping": TrendNoteOverlapping, "tensioning-not-specified": TrendNoteTensioningNotSpecified, "life-not-used": TrendNoteLifeNotUsed, "long-before": TrendNoteLongBefore, "other-baseline": TrendNoteOtherBaseline},
    "Unusable": {"no-time": UnusableNoTime, "no-strain": UnusableNoStrain, "no-gauge-length": UnusableNoGaugeLength, "gauge-length": UnusableGaugeLength, "too-few-readings": UnusableTooFewReadings, "strain-too-large": UnusableStrainTooLarge, "force-never-positive": UnusableForceNeverPositive, "no-level": UnusableNoLevel, "swapped": UnusableSwapped, "no-stage": UnusableNoStage, "no-reading": UnusableNoReading, "no-tension": UnusableNoTension, "breaks": UnusableBreaks, "temperature": UnusableTemperature, "nothing-to-shift": UnusableNothingToShift},
    "Warning": {"few-poses": WarningFewPoses, "few-poses-of-baseline": WarningFewPosesOfBaseline, "torque-range-small": WarningTorqueRangeSmall, "change-near-end": WarningChangeNearEnd, "at-rest-at-end": WarningAtRestAtEnd, "rest-phase-inconsistent": WarningRestPhaseInconsistent, "rope-memory": WarningRopeMemory, "tendon-creep": WarningTendonCreep, "external-force": WarningExternalForce, "unexplained-residual": WarningUnexplainedResidual, "no-joint-encoder": WarningNoJointEncoder, "beyond-pretension": WarningBeyondPretension, "joint-seized": WarningJointSeized, "beyond-limits": WarningBeyondLimits, "motor-encoder-frozen": WarningMotorEncoderFrozen, "negative-payload": WarningNegativePayload, "payload-inconsistent": WarningPayloadInconsistent, "external-force-inconsistent": WarningExternalForceInconsistent, "unmodelled-interval": WarningUnmodelledInterval, "much-rejected": WarningMuchRejected, "encoder-zero-offset": WarningEncoderZeroOffset, "no-baseline": WarningNoBaseline, "temperature-unknown": WarningTemperatureUnknown, "thermal-effect": WarningThermalEffect, "reference-inconsistent": WarningReferenceInconsistent, "encoder-delay": WarningEncoderDelay, "motor-torque-rejected": WarningMotorTorqueRejected, "tension-rejected": WarningTensionRejected, "cable-inconclusive": WarningCableInconclusive, "far-from-prior": WarningFarFromPrior, "frames-incomplete": WarningFramesIncomplete, "stiffness-changed": WarningStiffnessChanged, "date-inconsistent": WarningDateInconsistent},
}
Record._classes = _CLASSES
