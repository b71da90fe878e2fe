"""What Sinew answers, as types: SI, with standard deviations.

Made by `bindings/python/generate` from the schemas in `docs/schema/`; don't edit.
"""

from __future__ import annotations

from typing import Any, Literal, Mapping, Union

from ._record import GaussianRecord, Record


class Ambiguity(Record):
    """Topics of which one must be chosen."""

    __slots__ = ()

    candidates: list[str]
    """Topics that could be it."""
    file: str
    """File as the user named it."""
    side: TopicUse
    """The side asked for."""

    _fields = {
        "candidates": "",
        "file": "",
        "side": "",
    }


class Analysis(Record):
    """What one specimen's record says."""

    __slots__ = ()

    creep_strain_ratio: float
    """Rise from one minute (or the first reading after it) to the end, m/m."""
    duration_s: float
    """Length of the first stage, s."""
    end_strain_ratio: float
    """Strain at the end of the first stage, m/m."""
    faults: list[Fault]
    """Oddities."""
    force_n: float | None
    """Load of the first stage, N."""
    group: str | None
    """Group of repeats it belongs to."""
    humidity_percent: Span | None
    """Relative humidity or moisture as recorded, %."""
    name: str
    """Specimen."""
    no_slope: NoSlope | None
    """Why there is no slope."""
    preload_n: float | None
    """Load before, N."""
    readings: list[CreepAnalyzeReading]
    """Readings at the times of ISO 899-1 that the first stage reaches."""
    recovery: list[Recovery]
    """Falls of the load."""
    saturated: bool | None
    """Whether, at the slope found, another such duration would add less than a tenth of the creep so far."""
    saturation_s: float | None
    """Time after which less than a twentieth of the creep is still to come within the record, s."""
    slope_per_s: Bounded | None
    """The paper's `m_E`: slope of a straight line from `AnalyzeOptions::slope_from_s` on, 1/s; its interval
    knows that neighbouring residuals are alike.
    """
    stress_pa: float | None
    """Stress of the first stage, Pa."""
    temperature_c: Span | None
    """Temperature, °C."""
    zero: StrainZero
    """What was taken for strain zero."""

    _fields = {
        "creep_strain_ratio": "",
        "duration_s": "",
        "end_strain_ratio": "",
        "faults": "Fault",
        "force_n": "",
        "group": "",
        "humidity_percent": "Span",
        "name": "",
        "no_slope": "NoSlope",
        "preload_n": "",
        "readings": "CreepAnalyzeReading",
        "recovery": "Recovery",
        "saturated": "",
        "saturation_s": "",
        "slope_per_s": "Bounded",
        "stress_pa": "",
        "temperature_c": "Span",
        "zero": "StrainZero",
    }


class AnchorReading(Record):
    """What one anchor said in one recording."""

    __slots__ = ()

    encoder_error_rad: Gaussian
    """Error of the encoder it is read by: the joint's at a stop or joint mark, the motor's at a motor mark, rad."""
    joint: str
    """Joint."""
    kind: AnchorKind
    """What it is."""
    offset_rad: Gaussian | None
    """Offset of the tendon by the push alone, rad; `None` without a push or without the motor's torque."""
    position_rad: float
    """Where it is, rad (m for a joint that slides)."""
    time_s: float
    """When it was touched, s since the recording began."""

    _fields = {
        "encoder_error_rad": "Gaussian",
        "joint": "",
        "kind": "",
        "offset_rad": "Gaussian",
        "position_rad": "",
        "time_s": "",
    }


class AnchoredOffset(Record):
    """What anchors did to one tendon's estimate."""

    __slots__ = ()

    by_motion_rad: Gaussian
    """Offset as motion alone shows it, rad."""
    by_push_rad: Gaussian | None
    """Offset as pushes alone show it, rad."""
    correction_rad: Gaussian
    """What the encoders were off by, and the offset has been corrected for, rad."""
    readings: list[AnchorReading]
    """What was touched, in the order of time."""
    since_baseline: bool
    """Whether the baseline had touched the same, so that what follows is a difference."""

    _fields = {
        "by_motion_rad": "Gaussian",
        "by_push_rad": "Gaussian",
        "correction_rad": "Gaussian",
        "readings": "AnchorReading",
        "since_baseline": "",
    }


class Arrhenius(Record):
    """`ln a_T = E/R (1/T − 1/T_ref)`."""

    __slots__ = ()

    energy_j_per_mol: float
    """Activation energy `E`, J/mol."""
    misfit_decades: float
    """Root mean square misfit of log10 a_T, decades."""

    _fields = {
        "energy_j_per_mol": "",
        "misfit_decades": "",
    }


class At(Record):
    """Where a value stands."""

    __slots__ = ()

    file: str
    """File."""
    key: str
    """Key of a TOML file, element of a URDF."""
    line: int | None
    """Line, from 1."""

    _fields = {
        "file": "",
        "key": "",
        "line": "",
    }


class BaselineMergeResult(Record):
    """What became surer."""

    __slots__ = ()

    nuisance: list[NuisanceChange]
    """Everything that is estimated along: believed at the start, and now."""
    recordings: list[str]
    """All recordings it rests on."""
    robot: str
    """The robot."""
    schema: Literal["sinew/baseline-merge/1"]
    """Name and number of this schema."""
    temperature_c: float | None
    """Temperature that offsets and stiffness refer to, °C."""

    _fields = {
        "nuisance": "NuisanceChange",
        "recordings": "",
        "robot": "",
        "schema": "",
        "temperature_c": "",
    }


class BaselineResult(Record):
    """What a recording right after tensioning taught."""

    __slots__ = ()

    baseline: str | None
    """First recording of the baseline; `None`: data-sheet priors only."""
    baseline_time_utc_s: float | None
    """When that ended, s since 1970 UTC: every offset was zero then. `None` where its clock doesn't say."""
    damaged: bool
    """Whether part of the file was lost."""
    duration_s: float
    """Length of the part used, s."""
    external_force: ForceEstimate | None
    """A constant force from outside at the tool; `None`: there was none to be seen. Of a long recording, in the
    stretch where it is likeliest.
    """
    joints: list[TendonEstimate]
    """One entry per elastic joint."""
    left_out: list[LeftOut]
    """The longest such times."""
    left_out_share: float
    """Share of the time left out as contact or disturbance."""
    live: LiveCourse | None
    """What the online estimate says of the same recording; `None` where nobody asked."""
    motor_torque: MotorTorque
    """Which torque of the motors was used as a second witness."""
    nuisance: list[NuisanceChange]
    """Everything estimated along: what was believed before and after."""
    payload_changes: list[PayloadChange]
    """Loads picked up or put down within the recording."""
    payload_kg: Gaussian
    """Payload at the end, kg."""
    poses: int
    """Distinct poses the arm stood or passed at, as far as gravity tells them apart."""
    recording: str
    """The recording."""
    reference_temperature_c: float | None
    """Temperature the offsets refer to, °C, where it was recorded."""
    robot: str
    """The robot."""
    schema: Literal["sinew/baseline/1"]
    """Name and number of this schema."""
    segments: list[SegmentEstimate]
    """Offsets at the end of every segment the recording was estimated in."""
    start_time_utc_s: float | None
    """When the part used began, s since 1970 UTC; `None` where the recording's clock doesn't say."""
    temperature_c: float | None
    """Mean temperature, °C, where it was recorded or stated."""
    temperature_source: TemperatureSource
    """Where that comes from."""
    warnings: list[Warning]
    """What the reader should know."""

    _fields = {
        "baseline": "",
        "baseline_time_utc_s": "",
        "damaged": "",
        "duration_s": "",
        "external_force": "ForceEstimate",
        "joints": "TendonEstimate",
        "left_out": "LeftOut",
        "left_out_share": "",
        "live": "LiveCourse",
        "motor_torque": "",
        "nuisance": "NuisanceChange",
        "payload_changes": "PayloadChange",
        "payload_kg": "Gaussian",
        "poses": "",
        "recording": "",
        "reference_temperature_c": "",
        "robot": "",
        "schema": "",
        "segments": "SegmentEstimate",
        "start_time_utc_s": "",
        "temperature_c": "",
        "temperature_source": "",
        "warnings": "Warning",
    }


class BaselineSourceAssumed(Record):
    """What random poses right after tensioning would teach."""

    __slots__ = ()

    duration_s: float
    """Length of their recording, s."""
    kind: Literal["assumed"]
    poses: int
    """How many."""

    _fields = {
        "duration_s": "",
        "kind": "",
        "poses": "",
    }


class BaselineSourceGiven(Record):
    """One that was given."""

    __slots__ = ()

    file: str
    """Its file."""
    kind: Literal["given"]
    recordings: list[str]
    """Recordings it was learned from."""

    _fields = {
        "file": "",
        "kind": "",
        "recordings": "",
    }


class Basis(Record):
    """What a quantity rests on."""

    __slots__ = ()

    quantity: Quantity2
    """Quantity."""
    rests_on: Origin
    """Where it comes from."""

    _fields = {
        "quantity": "",
        "rests_on": "",
    }


class Beyond(Record):
    """How far a duty lies beyond the data in load and temperature."""

    __slots__ = ()

    load_efolds: float
    """Logarithm of the load over the nearest one of the data."""
    temperature_k: float
    """Kelvin to the nearest temperature of the data."""

    _fields = {
        "load_efolds": "",
        "temperature_k": "",
    }


class Bounded(Record):
    """A value with bounds that need not be even about it, in the unit that its field's name says. Who makes it
    says at which level; 95 % where nothing else is said.
    """

    __slots__ = ()

    high: float
    """Upper bound."""
    low: float
    """Lower bound."""
    value: float
    """Value."""

    _fields = {
        "high": "",
        "low": "",
        "value": "",
    }


class Candidate(Record):
    """A rope that meets every constraint."""

    __slots__ = ()

    broken_share: float
    """Share of the draws in which it breaks within the last time asked for, 0 to 1."""
    cautions: list[Caution]
    """Cautions."""
    diameter_m: float | None
    """Diameter, m, where it is published."""
    elongation_m: Bounded
    """Elongation since tensioned at the last time asked for, m."""
    least_share: float
    """In how many of the draws it stretches least of all candidates, 0 to 1."""
    life_s: Bounded | None
    """When it breaks, s; `None` beyond 300 years."""
    parameters: int
    """All parameters of the law."""
    pareto: bool
    """Whether no other candidate of known diameter is as thin or thinner, stretches as little or less and lasts
    as long or longer, at the catalogue's values.
    """
    rope: str
    """Rope."""
    safety_factor_ratio: float | None
    """Published breaking load over largest tension."""
    starting_guesses: int
    """Parameters of the law that are starting guesses."""
    stiffness_n_per_m: Bounded
    """Stiffness of the strand at the duty's mean load, N/m."""
    weight_kg_per_m: float | None
    """Weight, kg/m, where it is published."""

    _fields = {
        "broken_share": "",
        "cautions": "Caution",
        "diameter_m": "",
        "elongation_m": "Bounded",
        "least_share": "",
        "life_s": "Bounded",
        "parameters": "",
        "pareto": "",
        "rope": "",
        "safety_factor_ratio": "",
        "starting_guesses": "",
        "stiffness_n_per_m": "Bounded",
        "weight_kg_per_m": "",
    }


class CatalogueValue(Record):
    """A value of the catalogue with its origin."""

    __slots__ = ()

    date: str | None
    """Day of a fit."""
    factor: float | None
    """With 95 % probability between value/factor and value·factor, where stated so."""
    origin: RopeShowOrigin
    """Where it comes from."""
    plus_minus: float | None
    """With 95 % probability within so much of the value, where stated so."""
    source: str
    """Key of the rope's sources."""
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
    """The recording doesn't tell, and why not."""

    __slots__ = ()

    unknown: UnknownCause

    _fields = {
        "unknown": "",
    }


class CautionBeyondData(Record):
    """The duty goes beyond the data behind the rope's values; intervals are widened."""

    __slots__ = ()

    duration_s: float
    """Longest time asked for, s."""
    factor: float
    """Factor up and down that 95 % of the widening reaches at that time."""
    holds: Holds
    """The data."""
    kind: Literal["beyond-data"]
    load_share: list[float]
    """Mean and largest tension of the duty over the breaking load."""
    temperature_c: list[float]
    """Lowest and highest temperature, °C."""

    _fields = {
        "duration_s": "",
        "factor": "",
        "holds": "Holds",
        "kind": "",
        "load_share": "",
        "temperature_c": "",
    }


class CautionBreakingLoadGuessed(Record):
    """The breaking load is not published."""

    __slots__ = ()

    breaking_load_n: float
    """Starting guess taken, N."""
    kind: Literal["breaking-load-guessed"]

    _fields = {
        "breaking_load_n": "",
        "kind": "",
    }


class CautionCreepsApart(Record):
    """The rope creeps until it breaks; there is no reading from then on."""

    __slots__ = ()

    kind: Literal["creeps-apart"]
    time_s: float
    """When, at the catalogue's values, s."""

    _fields = {
        "kind": "",
        "time_s": "",
    }


class CautionEndsNotStated(Record):
    """The ends are taken to be as strong as the rope."""

    __slots__ = ()

    kind: Literal["ends-not-stated"]
    knot_share: float
    """Share of the strength that a knot keeps."""
    splice_share: float
    """Share of the strength that a splice keeps."""

    _fields = {
        "kind": "",
        "knot_share": "",
        "splice_share": "",
    }


class CautionExtrapolated(Record):
    """Starting guesses, held against short tests, asked for more than a day."""

    __slots__ = ()

    kind: Literal["extrapolated"]
    tests_s: float
    """Length of the longest of those tests, s."""

    _fields = {
        "kind": "",
        "tests_s": "",
    }


class CautionHighLoad(Record):
    """Tension above it."""

    __slots__ = ()

    kind: Literal["high-load"]

    _fields = {
        "kind": "",
    }


class CautionHot(Record):
    """HMPE hotter than its flow was measured."""

    __slots__ = ()

    kind: Literal["hot"]

    _fields = {
        "kind": "",
    }


class CautionLoadShare(Record):
    """More load than makers advise."""

    __slots__ = ()

    kind: Literal["load-share"]
    load_share: float
    """Largest tension over the breaking load."""
    most_share: float
    """Advised at most."""

    _fields = {
        "kind": "",
        "load_share": "",
        "most_share": "",
    }


class CautionLowLoad(Record):
    """Tension below the range the law was made for."""

    __slots__ = ()

    kind: Literal["low-load"]

    _fields = {
        "kind": "",
    }


class CautionReplace(Record):
    """The rope stretches beyond the strain at which its maker says to replace it."""

    __slots__ = ()

    kind: Literal["replace"]
    share: float
    """Share of the draws that lie beyond it, or are broken, at the last time asked for, 0 to 1."""
    strain_ratio: float
    """That strain since it was new, m/m."""
    time_s: float | None
    """The first time asked for at which the middle lies beyond it, s; `None`: only draws do."""

    _fields = {
        "kind": "",
        "share": "",
        "strain_ratio": "",
        "time_s": "",
    }


class CautionStartingGuesses(Record):
    """Parameters are starting guesses."""

    __slots__ = ()

    guesses: int
    """How many."""
    kind: Literal["starting-guesses"]
    parameters: int
    """Of all."""

    _fields = {
        "guesses": "",
        "kind": "",
        "parameters": "",
    }


class CautionTightBend(Record):
    """A pulley bends the rope closer than makers advise."""

    __slots__ = ()

    bend_ratio: float
    """Diameter that the rope is bent to, over its own."""
    kind: Literal["tight-bend"]
    least_ratio: float
    """Advised at least."""

    _fields = {
        "bend_ratio": "",
        "kind": "",
        "least_ratio": "",
    }


class CautionWornOut(Record):
    """Bending wears the rope out; there is no reading from then on."""

    __slots__ = ()

    kind: Literal["worn-out"]
    time_s: float
    """When, at the catalogue's values, s."""

    _fields = {
        "kind": "",
        "time_s": "",
    }


class Combination(Record):
    """Elongations that go together."""

    __slots__ = ()

    weights: list[list[str | float]]
    """Names of the tendons with their weights, of unit norm together."""

    _fields = {
        "weights": "",
    }


class Conditions(Record):
    """What the file can't say, as the laboratory states it."""

    __slots__ = ()

    conditions: str | None
    """Atmosphere, conditioning time, grips, how extension was measured."""
    preconditioning: str | None
    """What was done to the specimens before."""
    standard: str
    """Standard followed."""

    _fields = {
        "conditions": "",
        "preconditioning": "",
        "standard": "",
    }


class ContactScore(Record):
    """Contacts detected against contacts there were."""

    __slots__ = ()

    contacts: int
    """Contacts there were (those less than 0.5 s apart count as one)."""
    delays_s: list[float]
    """From the beginning of a contact to its alarm, s; one per contact detected."""
    false_alarms: int
    """Alarms without a contact."""
    false_s: float
    """How long of that there seemed to be one, s."""
    free_s: float
    """How long there was no contact, s."""
    missed: int
    """Not detected, or hidden by an alarm that was on before."""

    _fields = {
        "contacts": "",
        "delays_s": "",
        "false_alarms": "",
        "false_s": "",
        "free_s": "",
        "missed": "",
    }


class Coverage(Record):
    """One forecaster over many tests."""

    __slots__ = ()

    end_error_ratio: float | None
    """Median of |forecast − truth| at the end, over the test's creep."""
    end_half_width_ratio: float | None
    """Median half width of the interval at the end, over the test's creep."""
    ends_inside: int
    """Tests whose last reading lies within."""
    failed: int
    """Tests the law couldn't be fitted to."""
    forecaster: Forecaster
    """Law, or all laws combined."""
    readings: int
    """Hidden readings."""
    readings_inside: int
    """Hidden readings within their intervals."""
    tests: int
    """Tests forecast."""

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
    """What creep tests say without any law but a straight line."""

    __slots__ = ()

    conditions: Conditions
    """What the laboratory states."""
    failures: list[Failure]
    """What couldn't be analysed."""
    groups: list[Scatter]
    """Repeats, by group."""
    isochrones: list[Isochrone]
    """Strain against load at the same times."""
    schema: Literal["sinew/creep-analyze/1"]
    """Name and number of this schema."""
    sources: list[Source]
    """Raw data."""
    specimens: list[Analysis]
    """Specimens."""

    _fields = {
        "conditions": "Conditions",
        "failures": "Failure",
        "groups": "Scatter",
        "isochrones": "Isochrone",
        "schema": "",
        "sources": "Source",
        "specimens": "Analysis",
    }


class CreepAnalyzeReading(Record):
    """One reading of ISO 899-1."""

    __slots__ = ()

    modulus_pa: float | None
    """Tensile creep modulus F/(A ε), Pa; `None` without a cross-section."""
    strain_ratio: float
    """Strain from the zero, m/m."""
    time_s: float
    """Time under the whole load, s."""

    _fields = {
        "modulus_pa": "",
        "strain_ratio": "",
        "time_s": "",
    }


class CreepComparisonResult(Record):
    """Ropes in the order of their strain."""

    __slots__ = ()

    failures: list[Failure]
    """What couldn't be analysed."""
    ranks: list[Rank]
    """Ropes, least strain first."""
    schema: Literal["sinew/creep-compare/1"]
    """Name and number of this schema."""
    sources: list[Source]
    """Raw data."""

    _fields = {
        "failures": "Failure",
        "ranks": "Rank",
        "schema": "",
        "sources": "Source",
    }


class CreepErrorFlat(Record):
    """The strain doesn't change."""

    __slots__ = ()

    kind: Literal["flat"]
    specimen: str
    """Name of the specimen."""

    _fields = {
        "kind": "",
        "specimen": "",
    }


class CreepErrorIncompleteRope(Record):
    """The catalogue rope lacks parameters."""

    __slots__ = ()

    kind: Literal["incomplete-rope"]
    missing: str
    """Parameters that are missing."""
    rope: str
    """Rope."""

    _fields = {
        "kind": "",
        "missing": "",
        "rope": "",
    }


class CreepErrorIsotherm(Record):
    """An isotherm with too few readings above zero."""

    __slots__ = ()

    kind: Literal["isotherm"]
    temperature_c: float
    """Its temperature, °C."""

    _fields = {
        "kind": "",
        "temperature_c": "",
    }


class CreepErrorNoEntry(Record):
    """A fit that no catalogue entry can be made of."""

    __slots__ = ()

    kind: Literal["no-entry"]
    reason: NoEntry
    """Why."""

    _fields = {
        "kind": "",
        "reason": "NoEntry",
    }


class CreepErrorNoForecast(Record):
    """A forecast that the records can't tell."""

    __slots__ = ()

    kind: Literal["no-forecast"]
    reason: NoForecast
    """Why."""
    specimen: str
    """Specimen or group."""

    _fields = {
        "kind": "",
        "reason": "NoForecast",
        "specimen": "",
    }


class CreepErrorNoGroupColumn(Record):
    """No specimen has such a column or head line."""

    __slots__ = ()

    column: str
    """Column asked for."""
    kind: Literal["no-group-column"]
    known: list[str]
    """Columns there are."""

    _fields = {
        "column": "",
        "kind": "",
        "known": "",
    }


class CreepErrorNoPlan(Record):
    """No test can be planned."""

    __slots__ = ()

    kind: Literal["no-plan"]
    reason: str
    """Why."""

    _fields = {
        "kind": "",
        "reason": "",
    }


class CreepErrorNoRope(Record):
    """The rope law without a rope to start from."""

    __slots__ = ()

    kind: Literal["no-rope"]

    _fields = {
        "kind": "",
    }


class CreepErrorNotFinite(Record):
    """No start of the search had a finite cost."""

    __slots__ = ()

    kind: Literal["not-finite"]
    law: Law
    """The law."""

    _fields = {
        "kind": "",
        "law": "",
    }


class CreepErrorNothingAnalysed(Record):
    """No specimen could be analysed."""

    __slots__ = ()

    failures: list[str]
    """Why not, one of each."""
    kind: Literal["nothing-analysed"]

    _fields = {
        "failures": "",
        "kind": "",
    }


class CreepErrorOneTemperature(Record):
    """Isotherms at one temperature."""

    __slots__ = ()

    kind: Literal["one-temperature"]

    _fields = {
        "kind": "",
    }


class CreepErrorSpecimen(Record):
    """A specimen's readings don't make a creep test."""

    __slots__ = ()

    kind: Literal["specimen"]
    reason: Unusable
    """What was found."""
    specimen: str
    """Name of the specimen."""

    _fields = {
        "kind": "",
        "reason": "Unusable",
        "specimen": "",
    }


class CreepErrorTooFew(Record):
    """Fewer readings than numbers to fit."""

    __slots__ = ()

    kind: Literal["too-few"]
    law: Law
    """The law."""
    needed: int
    """Readings needed."""
    readings: int
    """Readings there are."""

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
    """What couldn't be analysed or fitted."""
    fits: list[FitSet]
    """Fits, in the order of the files."""
    schema: Literal["sinew/creep-fit/1"]
    """Name and number of this schema."""
    sources: list[Source]
    """Raw data."""

    _fields = {
        "failures": "Failure",
        "fits": "FitSet",
        "schema": "",
        "sources": "Source",
    }


class CreepShiftResult(Record):
    """Isotherms shifted along the logarithm of time."""

    __slots__ = ()

    failures: list[Failure]
    """Specimens that are no isotherm."""
    schema: Literal["sinew/creep-shift/1"]
    """Name and number of this schema."""
    sources: list[Source]
    """Raw data."""
    superposition: Superposition
    """Shift factors and what they follow."""

    _fields = {
        "failures": "Failure",
        "schema": "",
        "sources": "Source",
        "superposition": "Superposition",
    }


class CreepWithheldResult(Record):
    """Forecasts held against the hidden end of each test."""

    __slots__ = ()

    failures: list[Failure]
    """What couldn't be analysed."""
    hidden_share: float
    """Last share of the time hidden."""
    level: float
    """Level of the intervals."""
    schema: Literal["sinew/creep-withhold/1"]
    """Name and number of this schema."""
    sources: list[Source]
    """Raw data."""
    withheld: list[Coverage]
    """Laws, and all of them combined."""

    _fields = {
        "failures": "Failure",
        "hidden_share": "",
        "level": "",
        "schema": "",
        "sources": "Source",
        "withheld": "Coverage",
    }


class CycleClock(Record):
    """Cycles of a machine beside its time."""

    __slots__ = ()

    last: float
    """Cycle of the last session that counts them."""
    per_s: float | None
    """Cycles a second of late; `None`: one session alone doesn't say."""

    _fields = {
        "last": "",
        "per_s": "",
    }


class Damage(Record):
    """A part of the file that could not be read."""

    __slots__ = ()

    after_ns: int | None
    """Last time known good before the damage, ns."""
    bytes: int
    """How many bytes were lost."""
    offset: int
    """Byte offset where the damage starts."""
    reason: str
    """Why the bytes could not be used."""

    _fields = {
        "after_ns": "",
        "bytes": "",
        "offset": "",
        "reason": "",
    }


class Difference(Record):
    """Change since a reference recording."""

    __slots__ = ()

    difference_rad: float
    """Offset now minus offset then, rad."""
    elongation_m: float | None
    """The difference as elongation, m."""
    offset_per_stiffness_error_rad: float
    """What an error of the stiffness adds to the difference, rad per relative error."""
    reference_rad: float
    """Offset of the reference, rad."""
    standard_error_rad: float | None
    """Standard error of the difference, rad; `None` when a recording is too short for one."""

    _fields = {
        "difference_rad": "",
        "elongation_m": "",
        "offset_per_stiffness_error_rad": "",
        "reference_rad": "",
        "standard_error_rad": "",
    }


class Doubt(Record):
    """A time in which the offsets of a `LiveCourse` were in doubt."""

    __slots__ = ()

    from_s: float
    """From here, s."""
    to_s: float
    """To here, s."""

    _fields = {
        "from_s": "",
        "to_s": "",
    }


class DutySummary(Record):
    """Sums over a duty."""

    __slots__ = ()

    duration_s: float
    """Length of one cycle, s."""
    temperature_max_c: float
    """Largest, °C."""
    temperature_mean_c: float
    """Mean over time, °C."""
    temperature_min_c: float
    """Smallest, °C."""
    tension_max_n: float
    """Largest, N."""
    tension_mean_n: float
    """Mean over time, N."""
    tension_min_n: float
    """Smallest, N."""

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
    """How a search ended."""

    __slots__ = ()

    steps: int
    """Steps taken."""
    termination: Termination
    """Why."""

    _fields = {
        "steps": "",
        "termination": "",
    }


class Estimate(Record):
    """The estimate of one recording."""

    __slots__ = ()

    basis: list[Basis]
    """What the numbers rest on."""
    damaged: bool
    """Whether data was lost to damage (exit code 3)."""
    joints: list[JointEstimate]
    """One entry per joint of the robot, in its order."""
    losses: list[Loss]
    """Frames of the recording that could not be used for any joint, by reason."""
    recording: RecordingInfo
    """The recording."""
    robot: RobotInfo
    """The robot."""
    settings: Settings
    """How it was made."""
    sinew_version: str
    """Version of the program that made it."""
    warnings: list[RecordingWarning]
    """What the reader should know."""

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
    """Which estimate answers."""
    reading: Estimate
    """What the paper's equation reads of the same frames. It takes stiffness, masses, payload and contact as
    known, so it is no verdict.
    """
    session: SessionEstimate | None
    """The answer of the absolute method, with verdicts."""

    _fields = {
        "method": "",
        "reading": "Estimate",
        "session": "SessionEstimate",
    }


class EstimateEachResult(Record):
    """Many recordings, each on its own."""

    __slots__ = ()

    method: Method
    """Which estimate answers."""
    recordings: list[RecordingOutcome]
    """One entry per recording, in the order they were named."""
    schema: Literal["sinew/estimate-each/1"]
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
    """Which estimate answers."""
    reading: Estimate
    """What the paper's equation reads of the same frames. It takes stiffness, masses, payload and contact as
    known, so it is no verdict.
    """
    schema: Literal["sinew/estimate/1"]
    """Name and number of this schema."""
    session: SessionEstimate | None
    """The answer of the absolute method, with verdicts."""

    _fields = {
        "method": "",
        "reading": "Estimate",
        "schema": "",
        "session": "SessionEstimate",
    }


class Event(Record):
    """Something that happened while reading."""

    __slots__ = ()

    kind: EventKind
    """What kind of event it is."""
    text: str
    """What happened, with numbers and units."""
    time_ns: int
    """Time of the recording at which it happened, ns; 0 where unknown."""

    _fields = {
        "kind": "",
        "text": "",
        "time_ns": "",
    }


class Expected(Record):
    """What to expect of one joint."""

    __slots__ = ()

    elongation_deviation_m: float | None
    """The same as elongation, m; `None` without tendon geometry."""
    identifiable: bool
    """Whether the poses show the offset."""
    name: str
    """Joint."""
    offset_deviation_rad: float
    """Standard deviation of its offset, rad."""
    random_offset_deviation_rad: float
    """The same for random poses, median of the random lists, rad."""

    _fields = {
        "elongation_deviation_m": "",
        "identifiable": "",
        "name": "",
        "offset_deviation_rad": "",
        "random_offset_deviation_rad": "",
    }


class Failure(Record):
    """What couldn't be analysed or fitted, and why."""

    __slots__ = ()

    name: str | None
    """Specimen or group that was fitted; `None` where the reason names it."""
    reason: CreepError
    """Why."""

    _fields = {
        "name": "",
        "reason": "CreepError",
    }


class FaultClockGoesBack(Record):
    """Readings that are older than the one before; left out."""

    __slots__ = ()

    kind: Literal["clock-goes-back"]
    readings: int
    """How many."""

    _fields = {
        "kind": "",
        "readings": "",
    }


class FaultDoubtfulStrain(Record):
    """A strain that is possible, but looks like another unit."""

    __slots__ = ()

    kind: Literal["doubtful-strain"]
    strain_ratio: float
    """Largest strain, m/m."""

    _fields = {
        "kind": "",
        "strain_ratio": "",
    }


class FaultDoubtfulTime(Record):
    """A length of the record that is possible, but looks like another unit."""

    __slots__ = ()

    duration_s: float
    """Length, s."""
    kind: Literal["doubtful-time"]

    _fields = {
        "duration_s": "",
        "kind": "",
    }


class FaultGap(Record):
    """Readings that are missing or no numbers; left out."""

    __slots__ = ()

    kind: Literal["gap"]
    readings: int
    """How many."""

    _fields = {
        "kind": "",
        "readings": "",
    }


class FaultLoadDrift(Record):
    """The load on a plateau changes by more than ISO 899-1 allows (1 %)."""

    __slots__ = ()

    drift_share: float
    """Largest distance from there, as a share of it."""
    kind: Literal["load-drift"]
    load_n: float
    """Median of the load, N."""
    time_s: float
    """Start of the plateau."""

    _fields = {
        "drift_share": "",
        "kind": "",
        "load_n": "",
        "time_s": "",
    }


class FaultNoForce(Record):
    """No force is recorded: a constant load from the first reading on is assumed."""

    __slots__ = ()

    kind: Literal["no-force"]

    _fields = {
        "kind": "",
    }


class FaultNoRamp(Record):
    """The record starts under load: neither ramp nor zero are in it."""

    __slots__ = ()

    kind: Literal["no-ramp"]

    _fields = {
        "kind": "",
    }


class FaultOutlier(Record):
    """One reading stands apart."""

    __slots__ = ()

    kept: bool
    """Whether it was left in the readings."""
    kind: Literal["outlier"]
    time_s: float
    """When."""

    _fields = {
        "kept": "",
        "kind": "",
        "time_s": "",
    }


class FaultRepeatedStamps(Record):
    """Readings that repeat the stamp before; all are used."""

    __slots__ = ()

    kind: Literal["repeated-stamps"]
    readings: int
    """How many."""

    _fields = {
        "kind": "",
        "readings": "",
    }


class FaultShortens(Record):
    """The rope is shorter under load than before it."""

    __slots__ = ()

    kind: Literal["shortens"]
    strain_ratio: float
    """Strain at the end of the first stage, m/m."""

    _fields = {
        "kind": "",
        "strain_ratio": "",
    }


class FaultSlip(Record):
    """The strain jumps under constant load: a grip slips."""

    __slots__ = ()

    kept: bool
    """Whether it was left in the readings."""
    kind: Literal["slip"]
    strain_ratio: float
    """Height of the jump, m/m."""
    time_s: float
    """When."""

    _fields = {
        "kept": "",
        "kind": "",
        "strain_ratio": "",
        "time_s": "",
    }


class FaultSlowRamp(Record):
    """The load came on slower than within 5 s."""

    __slots__ = ()

    kind: Literal["slow-ramp"]
    ramp_s: float
    """How long it took, s."""
    time_s: float
    """When."""

    _fields = {
        "kind": "",
        "ramp_s": "",
        "time_s": "",
    }


class Finding(Record):
    """One odd value."""

    __slots__ = ()

    at: At
    """Where it stands."""
    judged: Judged | None
    """What was compared, and what is usual."""
    kind: FindingKind
    """What looks odd."""
    names: list[str]
    """Names that may have been meant, the nearest first."""
    severity: Severity
    """How bad it is."""
    slip: UnitSlip | None
    """The unit it may have been written in."""
    text: str | None
    """A name that isn't there, or what a reader of the file says."""
    unit: str
    """Unit of the file's value."""
    value: float | None
    """The value as the file has it, in `unit`."""

    _fields = {
        "at": "At",
        "judged": "Judged",
        "kind": "",
        "names": "",
        "severity": "",
        "slip": "UnitSlip",
        "text": "",
        "unit": "",
        "value": "",
    }


class Fit(Record):
    """A law fitted to one or several curves."""

    __slots__ = ()

    aicc: float
    """Akaike's criterion with the correction for few readings; smaller is better."""
    bic: float
    """Schwarz's criterion; smaller is better."""
    covariance: list[list[float]]
    """Covariance of `Self::parameters` from the draws, in their units; empty without draws."""
    ending: Ending
    """How the best search ended."""
    fitted: int
    """Numbers fitted, those of the noise among them."""
    fixed: list[FixedParameter]
    """Parameters of `Law::Rope` that the record can't tell, taken from the base rope."""
    law: Law
    """The law."""
    log_likelihood: float
    """Natural logarithm of the largest likelihood."""
    noise: Noise
    """Noise of largest likelihood."""
    parameters: list[Parameter]
    """Parameters, each with its own unit."""
    readings: int
    """Readings (or means of readings) used."""
    residual_strain_ratio: float
    """Standard deviation of a reading's strain, m/m."""
    starts: int
    """Starts searched from."""
    weight: float
    """Akaike weight among the laws fitted to the same readings; 1 for a law fitted alone."""

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
    """Strain ahead, all laws weighed; of a group's first specimen."""
    forecast_conditions: ForecastConditions | None
    """Load and temperature that it is for."""
    laws: list[Fit]
    """Laws by rising AICc."""
    name: str
    """Specimen or group."""

    _fields = {
        "forecast": "Forecast",
        "forecast_conditions": "ForecastConditions",
        "laws": "Fit",
        "name": "",
    }


class FixedParameter(Record):
    """A parameter that a fit takes from the base rope."""

    __slots__ = ()

    name: str
    """Name as the catalogue writes it, unit included."""
    value: float
    """Value it is kept at."""
    why: WhyFixed
    """Why the record can't tell it."""

    _fields = {
        "name": "",
        "value": "",
        "why": "",
    }


class ForceEstimate(Record):
    """A constant force from outside that may act on the arm while the recording goes on."""

    __slots__ = ()

    force_n: list[Gaussian]
    """Along the axes of the base, N, if it does."""
    is_stated: bool
    """Whether somebody stated it."""
    probability: float
    """Posterior probability that it does; 1 where it was stated."""

    _fields = {
        "force_n": "Gaussian",
        "is_stated": "",
        "probability": "",
    }


class Forecast(Record):
    """Strain at given times, m/m."""

    __slots__ = ()

    high_strain_ratio: list[float]
    """Upper end."""
    low_strain_ratio: list[float]
    """Lower end of the interval of the law's strain."""
    reading_high_strain_ratio: list[float]
    """Upper end."""
    reading_low_strain_ratio: list[float]
    """Lower end of the interval in which a reading lies: law, slow part and reading error."""
    strain_ratio: list[float]
    """Median of the law's strain."""
    time_s: list[float]
    """Times, s."""

    _fields = {
        "high_strain_ratio": "",
        "low_strain_ratio": "",
        "reading_high_strain_ratio": "",
        "reading_low_strain_ratio": "",
        "strain_ratio": "",
        "time_s": "",
    }


class ForecastConditions(Record):
    """Load and temperature that a forecast is for."""

    __slots__ = ()

    load_n: float | None
    """Tension, N, where the record has one."""
    source: ConditionSource
    """Where they come from."""
    temperature_c: float | None
    """Temperature, °C, where the record has one."""

    _fields = {
        "load_n": "",
        "source": "",
        "temperature_c": "",
    }


class ForecastPoint(Record):
    """Offset at a time to come."""

    __slots__ = ()

    interval_95_rad: Interval95
    """Quantiles of 2.5 and 97.5 %."""
    offset_rad: float
    """Median."""
    time_utc_s: float
    """When, s since 1970."""

    _fields = {
        "interval_95_rad": "Interval95",
        "offset_rad": "",
        "time_utc_s": "",
    }


class Frames(Record):
    """Frames on their way into the file."""

    __slots__ = ()

    duplicated: int
    """Written twice."""
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
    """A normally distributed quantity, in the unit that the name of its field or function says. `deviation` is
    one standard deviation. Only where a number is shown to a person does it become a half width of 95 %.
    """

    __slots__ = ()

    deviation: float
    """Standard deviation, not negative."""
    mean: float
    """Mean."""

    _fields = {
        "deviation": "",
        "mean": "",
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
    """What was read, what was lost and why. Complete after the last frame."""

    __slots__ = ()

    bytes_lost: int
    """Bytes of the file that could not be used."""
    clock_jumps: int
    """How often the clock went back for good."""
    damage: list[Damage]
    """Where and why bytes were lost."""
    duplicates: int
    """Messages dropped because their stamp had been seen already."""
    events: list[Event]
    """What happened, in reading order, at most `EVENT_LIMIT`."""
    events_dropped: int
    """Events beyond the limit."""
    frames: int
    """Frames handed out."""
    frames_without_joint_side: int
    """Frames in which no joint has a joint position."""
    frames_without_motor_side: int
    """Frames in which no joint has a motor position."""
    gaps: int
    """Pauses longer than the gap limit."""
    late: int
    """Messages dropped because they came later than the reorder window."""
    longest_gap_s: float
    """The longest such pause, s."""
    messages: int
    """Messages (MCAP, of the topics used) or rows (tables) read."""
    non_finite: list[SignalCount]
    """Recorded samples that were NaN or infinite, per signal; they are NaN in the frames."""
    out_of_order: int
    """Messages that came out of order and were sorted in."""
    ragged_rows: int
    """Rows with more or fewer cells than the header."""
    rows_without_time: int
    """Rows without a time: dropped."""
    short_messages: int
    """Messages with fewer values than names: the missing values are NaN."""
    streams: list[StreamTiming]
    """When the samples came, stream by stream: the joint side's or the table's rows first."""
    suspicions: list[str]
    """Signals that look wrong: degrees, constant, gear ratio, all NaN."""
    undecodable: int
    """Messages that could not be decoded."""
    unknown_joints: list[str]
    """Joints found in messages but not at the start of the recording: ignored."""
    unwrapped: list[SignalCount]
    """Encoder wrap-arounds removed, per signal."""

    _fields = {
        "bytes_lost": "",
        "clock_jumps": "",
        "damage": "Damage",
        "duplicates": "",
        "events": "Event",
        "events_dropped": "",
        "frames": "",
        "frames_without_joint_side": "",
        "frames_without_motor_side": "",
        "gaps": "",
        "late": "",
        "longest_gap_s": "",
        "messages": "",
        "non_finite": "SignalCount",
        "out_of_order": "",
        "ragged_rows": "",
        "rows_without_time": "",
        "short_messages": "",
        "streams": "StreamTiming",
        "suspicions": "",
        "undecodable": "",
        "unknown_joints": "",
        "unwrapped": "SignalCount",
    }


class HeldJoint(Record):
    """A joint whose motor is held while its two ropes relax."""

    __slots__ = ()

    radius_m: float
    """Radius of the pulley at the joint, m."""
    slides: bool | None
    """Whether it slides: its torque is a force then, N, and its pulley's radius the rope's travel per metre."""
    torque_nm: float
    """Torque that the joint holds, N·m, at least 0."""

    _fields = {
        "radius_m": "",
        "slides": "",
        "torque_nm": "",
    }


class Holds(Record):
    """Load, temperature and time of the data that a rope's values were held against."""

    __slots__ = ()

    duration_s: float
    """Length of the longest test, s."""
    load_share: list[float]
    """Least and largest tension over breaking load."""
    temperature_c: list[float]
    """Lowest and highest temperature, °C."""

    _fields = {
        "duration_s": "",
        "load_share": "",
        "temperature_c": "",
    }


class Injection(Record):
    """An offset added to a joint's motor position, as the paper does to see it found again."""

    __slots__ = ()

    from_s: float | None
    """From this time of the recording on, s; `None` from the start."""
    joint: str
    """Tendon it is added to, in the coordinate of the joint it is paired with."""
    offset_rad: float
    """Offset, rad."""

    _fields = {
        "from_s": "",
        "joint": "",
        "offset_rad": "",
    }


class Interval95(Record):
    """Bounds that hold a quantity with 95 % probability, in the unit that its field's name says."""

    __slots__ = ()

    high: float
    """Upper bound."""
    low: float
    """Lower bound."""

    _fields = {
        "high": "",
        "low": "",
    }


class Isochrone(Record):
    """Specimens of one group at one time under load."""

    __slots__ = ()

    exponent: Bounded
    """`p` of `ε ∝ σ^p`: 1 where strain is proportional to load."""
    group: str | None
    """Group; `None`: specimens without a group."""
    points: list[IsochronePoint]
    """Specimens by rising load."""
    quantity: LoadQuantity
    """What the loads are."""
    secant: float
    """Load over strain at the middle of the loads, N or Pa: the curve's secant."""
    time_s: float
    """Time under the whole load, s."""

    _fields = {
        "exponent": "Bounded",
        "group": "",
        "points": "IsochronePoint",
        "quantity": "",
        "secant": "",
        "time_s": "",
    }


class IsochronePoint(Record):
    """One specimen of an isochrone."""

    __slots__ = ()

    load: float
    """Load, N or Pa."""
    specimen: str
    """Specimen."""
    strain_ratio: float
    """Strain, m/m."""

    _fields = {
        "load": "",
        "specimen": "",
        "strain_ratio": "",
    }


class JointCheck(Record):
    """One joint. Of a prismatic one, rad is m and N·m is N."""

    __slots__ = ()

    friction_stated: bool | None
    """Whether friction is stated; none where the joint is rigid."""
    kind: JointMotion
    """Whether it turns or slides."""
    lower_rad: float | None
    """Lower end of its range, rad; none where it turns without end."""
    motor_inertia_kg_m2: float | None
    """Inertia of the motor, reflected to the joint, kg·m²."""
    name: str
    """Joint."""
    stiffness_nm_per_rad: float | None
    """Stiffness, N·m/rad; none where the joint is rigid."""
    tendon: TendonCheck | None
    """Its tendon, where one is described."""
    upper_rad: float | None
    """Upper end of its range, rad; none where it turns without end."""

    _fields = {
        "friction_stated": "",
        "kind": "",
        "lower_rad": "",
        "motor_inertia_kg_m2": "",
        "name": "",
        "stiffness_nm_per_rad": "",
        "tendon": "TendonCheck",
        "upper_rad": "",
    }


class JointEstimate(Record):
    """The estimate of one joint."""

    __slots__ = ()

    difference: Difference | None
    """Against the reference recording."""
    elongation_m: float | None
    """Elongation of the tendon, m; `None` without tendon geometry."""
    elongation_standard_error_m: float | None
    """Standard error of the elongation, m."""
    losses: list[Loss]
    """Why the rest didn't."""
    name: str
    """Joint."""
    offset_per_stiffness_error_rad: float | None
    """What an error of the stiffness adds to the offset, rad per relative error: `mean(tau_el)/K`. An error of
    the masses has the same size and the opposite sign.
    """
    offset_rad: float | None
    """Mean offset of the motor position, rad; `None` where refused."""
    refused: JointRefusal | None
    """`None` where there is an estimate; else why there is none."""
    scatter_rad: float | None
    """Standard deviation of the single estimates, rad."""
    series: Series
    """The estimate over time."""
    slides: bool | None
    """Whether it slides: rad is then m, and N·m is N."""
    standard_error_rad: float | None
    """Standard error of the mean that respects their correlation (batch means), rad; `None` when the recording
    is too short for one.
    """
    stiffness_nm_per_rad: float | None
    """Stiffness used, N·m/rad; `None` where rigid."""
    strain_ratio: float | None
    """Strain of the tendon."""
    tau_el_nm: TorqueStatistics | None
    """Elastic torque, N·m; `None` without an estimate."""
    usable_frames: int
    """Frames that gave an estimate."""
    usable_share: float
    """Their share of all frames, 0 to 1."""

    _fields = {
        "difference": "Difference",
        "elongation_m": "",
        "elongation_standard_error_m": "",
        "losses": "Loss",
        "name": "",
        "offset_per_stiffness_error_rad": "",
        "offset_rad": "",
        "refused": "JointRefusal",
        "scatter_rad": "",
        "series": "Series",
        "slides": "",
        "standard_error_rad": "",
        "stiffness_nm_per_rad": "",
        "strain_ratio": "",
        "tau_el_nm": "TorqueStatistics",
        "usable_frames": "",
        "usable_share": "",
    }


class JointInfo(Record):
    """What is recorded of a joint."""

    __slots__ = ()

    channels: list[Quantity]
    """Quantities recorded."""
    name: str
    """Its name."""

    _fields = {
        "channels": "",
        "name": "",
    }


class JointRefusalNoUsableFrame(Record):
    """No frame could be used, mostly for this reason."""

    __slots__ = ()

    no_usable_frame: LossReason | None

    _fields = {
        "no_usable_frame": "",
    }


class JointScore(Record):
    """How far a joint is from where it was asked to be, contacts left out. A number that needs samples is NaN,
    and null in JSON, where there were none: `rest_*` when the arm never stood still untouched.
    """

    __slots__ = ()

    false_torque_nm: float | None
    """Mean of the estimated external torque while nothing touches, N·m."""
    name: str
    """Joint."""
    peak_rad: float
    """Largest size of `q − q_d` over the whole recording, rad."""
    rest_mean_rad: float | None
    """Mean of `q − q_d` at rest, rad."""
    rest_rms_rad: float | None
    """RMS of `q − q_d` at rest, rad."""
    rms_rad: float | None
    """RMS of `q − q_d` over the whole recording, rad."""
    threshold_nm: float | None
    """Mean threshold, N·m."""
    torque_error_rms_nm: float | None
    """RMS of the external torque's error while nothing touches, N·m."""

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
    """One tendon."""

    __slots__ = ()

    baseline_error_rad: Gaussian
    """Error that all sessions since the baseline share: the offset's interval holds what is left unknown of it,
    however many sessions there are.
    """
    basis: PriorBasis
    """What the forecast rests on."""
    cycles: CycleClock | None
    """Cycles of the machine, where sessions count them."""
    drift_rad_per_k: Gaussian | None
    """Drift of the records with temperature; `None` without temperatures."""
    elongation_m: Gaussian | None
    """The same as elongation; `None` without tendon geometry."""
    events: list[TrendEvent]
    """Sudden changes and re-tensionings."""
    first_utc_s: float
    """Start of the first session, s since 1970."""
    forecast: list[ForecastPoint]
    """Offset from the last session on."""
    last_utc_s: float
    """Start of the last session, s since 1970."""
    life: LifeForecast | None
    """When to replace the rope by its age, where its strain has no limit and lives of other ropes were given."""
    limits: list[LimitForecast]
    """Limits of robot.toml, re-tensioning first."""
    name: str
    """Joint."""
    offset_rad: Gaussian
    """Offset at the reference temperature since the last tensioning."""
    rate_rad_per_s: Gaussian
    """Creep now."""
    reference_c: float
    """Reference temperature, °C."""
    series: list[SessionPoint]
    """Sessions in the order of time."""
    sessions: int
    """Sessions."""
    shared_error_rad: float
    """Standard deviation of the error that neighbouring sessions share, rad."""
    stated_width_ratio: float
    """True over stated width of the sessions' intervals."""
    strain_ratio: Gaussian | None
    """Strain since the first tensioning, as a fraction; `None` without tendon geometry."""
    suspicion: Suspicion | None
    """A sudden change that waits for another session."""
    tensioned_stated: bool
    """Whether somebody stated that; else it is the first session's."""
    tensioned_utc_s: float
    """Start of the creep's clock, tensioning or replacement, s since 1970."""
    verdict: TrendVerdict
    """What to do."""
    without_information: int
    """Sessions that couldn't tell."""

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
        "series": "SessionPoint",
        "sessions": "",
        "shared_error_rad": "",
        "stated_width_ratio": "",
        "strain_ratio": "Gaussian",
        "suspicion": "Suspicion",
        "tensioned_stated": "",
        "tensioned_utc_s": "",
        "verdict": "",
        "without_information": "",
    }


class Judged(Record):
    """What was compared with what is usual."""

    __slots__ = ()

    high: float | None
    """Most that is usual."""
    low: float | None
    """Least that is usual."""
    unit: str
    """Unit; empty for a ratio."""
    value: float
    """Value, in `unit`."""

    _fields = {
        "high": "",
        "low": "",
        "unit": "",
        "value": "",
    }


class LeftAlone(Record):
    """Tension of a rope that is strung once and left alone, at the catalogue's own values."""

    __slots__ = ()

    sag_rad: list[float]
    """How far the joint has sagged under its torque, rad; empty without a joint."""
    tension_n: list[float]
    """Tension, N; with a partner, the mean of both strands."""
    time_s: list[float]
    """Time since stringing, s."""

    _fields = {
        "sag_rad": "",
        "tension_n": "",
        "time_s": "",
    }


class LeftOut(Record):
    """A time that was left out."""

    __slots__ = ()

    from_s: float
    """From, s."""
    to_s: float
    """To, s."""

    _fields = {
        "from_s": "",
        "to_s": "",
    }


class Life(Record):
    """How long a rope lasts."""

    __slots__ = ()

    abrasion_factor: float
    """Factor by which abrasion speeds up the wear of bending, as stated."""
    breaks_after_s: Bounded | None
    """When it breaks, s since it was first loaded; `None` beyond 300 years. The interval ends there."""
    broken_share: float
    """Share of the draws in which it breaks within the longest time asked for, 0 to 1."""
    cause: BreakCause
    """What takes most of its life."""
    end_share: float
    """Share of the rope's strength that they keep."""
    ends: Ends
    """How its ends are held."""
    spots: list[Spot]
    """Portions in order from the drive, then the ends, at the longest time asked for or when it breaks, at the
    catalogue's values.
    """

    _fields = {
        "abrasion_factor": "",
        "breaks_after_s": "Bounded",
        "broken_share": "",
        "cause": "",
        "end_share": "",
        "ends": "",
        "spots": "Spot",
    }


class LifeForecast(Record):
    """When a rope should be replaced, from its age."""

    __slots__ = ()

    after_high_s: float
    """97.5 % quantile of it, s."""
    after_low_s: float
    """2.5 % quantile of it, s."""
    after_s: float
    """Median of the time from the last session until it is, s; below 0: it was passed before."""
    age_s: float
    """Age of this one at its last session, s."""
    broke: int
    """Those of them that broke."""
    broken_by_now_ratio: float
    """Share of such ropes that have broken by that age: mean over what the lives leave open."""
    broken_ratio: float
    """Share of such ropes that have broken by the age at which to replace."""
    passed_probability: float
    """Probability that the age at which to replace is passed."""
    ropes: int
    """Ropes it rests on."""
    source: str
    """Table they stand in."""

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
    """Replace at this strain since the first tensioning."""

    __slots__ = ()

    after_high_s: float | None
    """97.5 % quantile of that time, s; `None`: beyond the horizon, or unknown."""
    after_low_s: float | None
    """2.5 % quantile of that time, s; `None`: beyond the horizon, or unknown."""
    after_s: float | None
    """Median of the time from the last session until it is passed, s; `None`: beyond the horizon, or unknown."""
    at_high_utc_s: float | None
    """The 97.5 % quantile as a date."""
    at_low_utc_s: float | None
    """The 2.5 % quantile as a date."""
    at_utc_s: float | None
    """The median as a date, s since 1970; `None`: as above, or sessions have no dates."""
    limit_rad: float | None
    """The limit as an offset, rad."""
    passed_probability: float | None
    """Probability that it is passed already."""
    state: TrendLimitState | None
    """What is known."""
    kind: Literal["replace"]
    strain_ratio: float
    """As a fraction."""

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
    """Tension again at this elongation since the last tensioning."""

    __slots__ = ()

    after_high_s: float | None
    """97.5 % quantile of that time, s; `None`: beyond the horizon, or unknown."""
    after_low_s: float | None
    """2.5 % quantile of that time, s; `None`: beyond the horizon, or unknown."""
    after_s: float | None
    """Median of the time from the last session until it is passed, s; `None`: beyond the horizon, or unknown."""
    at_high_utc_s: float | None
    """The 97.5 % quantile as a date."""
    at_low_utc_s: float | None
    """The 2.5 % quantile as a date."""
    at_utc_s: float | None
    """The median as a date, s since 1970; `None`: as above, or sessions have no dates."""
    limit_rad: float | None
    """The limit as an offset, rad."""
    passed_probability: float | None
    """Probability that it is passed already."""
    state: TrendLimitState | None
    """What is known."""
    elongation_m: float
    """m."""
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


class LiveCourse(Record):
    """What the online estimate (`crate::online`) says of a recording, block by block."""

    __slots__ = ()

    doubts: list[Doubt]
    """When any was: until the first window is solved, and after steps that are suspected or may end."""
    external_force: ForceEstimate | None
    """A constant force from outside at the tool, as far as it is known at the end; `None`: none is looked for."""
    in_doubt: bool
    """Whether any offset is provisional at the end."""
    joints: list[LiveTendon]
    """One entry per elastic joint, at the end of the recording."""

    _fields = {
        "doubts": "Doubt",
        "external_force": "ForceEstimate",
        "in_doubt": "",
        "joints": "LiveTendon",
    }


class LiveTendon(Record):
    """A tendon at the end of a `LiveCourse`."""

    __slots__ = ()

    name: str
    """Joint."""
    offset_rad: Gaussian
    """Offset as it is then, rad."""
    stiffness_changed_probability: float | None
    """Probability that its stiffness has changed since the baseline; `None` without one."""

    _fields = {
        "name": "",
        "offset_rad": "Gaussian",
        "stiffness_changed_probability": "",
    }


class Load(Record):
    """A load."""

    __slots__ = ()

    attach_s: float
    """Held from, s."""
    com_m: list[float]
    """Its centre of mass, link frame, m."""
    link: str
    """Link that holds it."""
    mass_kg: float
    """Its mass, kg."""
    release_s: float | None
    """Held until, s; none: to the end."""

    _fields = {
        "attach_s": "",
        "com_m": "",
        "link": "",
        "mass_kg": "",
        "release_s": "",
    }


class Loss(Record):
    """Frames that gave no estimate, and why."""

    __slots__ = ()

    frames: int
    """How many frames."""
    reason: LossReason
    """Why."""
    share: float
    """Share of all frames, 0 to 1."""

    _fields = {
        "frames": "",
        "reason": "",
        "share": "",
    }


class NoEntryNoRopeLaw(Record):
    """The rope law is not among the fits."""

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
    """Ropes fitted."""
    kind: Literal["several-ropes"]

    _fields = {
        "fitted": "",
        "kind": "",
    }


class NoForecastLoad(Record):
    """A load beyond those of the records."""

    __slots__ = ()

    high_n: float
    """Largest, N."""
    kind: Literal["load"]
    load_n: float
    """Asked for, N."""
    low_n: float
    """Least load that can be told, N."""

    _fields = {
        "high_n": "",
        "kind": "",
        "load_n": "",
        "low_n": "",
    }


class NoForecastNoForce(Record):
    """A load is stated, and none is recorded."""

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
    """A temperature is stated, and none is recorded."""

    __slots__ = ()

    kind: Literal["no-temperature"]

    _fields = {
        "kind": "",
    }


class NoForecastTemperature(Record):
    """A temperature beyond those of the records."""

    __slots__ = ()

    high_c: float
    """Highest, °C."""
    kind: Literal["temperature"]
    low_c: float
    """Lowest of the records, °C."""
    temperature_c: float
    """Asked for, °C."""

    _fields = {
        "high_c": "",
        "kind": "",
        "low_c": "",
        "temperature_c": "",
    }


class NoSlopeNotFitted(Record):
    """The straight line couldn't be fitted."""

    __slots__ = ()

    kind: Literal["not-fitted"]
    reason: CreepError
    """Why."""

    _fields = {
        "kind": "",
        "reason": "CreepError",
    }


class NoSlopeTooFewReadings(Record):
    """Too few readings late enough."""

    __slots__ = ()

    from_s: float
    """From when on, s after the load."""
    kind: Literal["too-few-readings"]
    needed: int
    """Readings needed."""
    readings: int
    """Readings there are."""

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
    """Correlation time `τ_c` of the slow part: e-foldings of the time under load; of a straight line, s."""
    share: float
    """Share of the slow part in the variance of a single reading, 0 to `SHARE_MAX`."""

    _fields = {
        "memory": "",
        "share": "",
    }


class NotIdentifiableAbove(Record):
    """Anything above."""

    __slots__ = ()

    kind: Literal["above"]
    low: float
    """Lower end."""

    _fields = {
        "kind": "",
        "low": "",
    }


class NotIdentifiableAnything(Record):
    """Anything between, which is most of what was searched."""

    __slots__ = ()

    high: float
    """Upper end."""
    kind: Literal["anything"]
    low: float
    """Lower end."""

    _fields = {
        "high": "",
        "kind": "",
        "low": "",
    }


class NotIdentifiableBelow(Record):
    """Anything below."""

    __slots__ = ()

    high: float
    """Upper end."""
    kind: Literal["below"]

    _fields = {
        "high": "",
        "kind": "",
    }


class NuisanceChange(Record):
    """A nuisance parameter before and after."""

    __slots__ = ()

    joint: str | None
    """Joint or body; `None` for the payload."""
    moved: bool
    """Whether the data moved it: surer by a fifth, or by more than a standard deviation off."""
    name: str
    """What it is."""
    posterior: Gaussian
    """Believed after."""
    prior: Gaussian
    """Believed before the recording."""
    unit: str
    """Its unit; empty for a ratio."""

    _fields = {
        "joint": "",
        "moved": "",
        "name": "",
        "posterior": "Gaussian",
        "prior": "Gaussian",
        "unit": "",
    }


class Parameter(Record):
    """A fitted parameter. Its numbers are in the unit beside them, as laboratories write the laws."""

    __slots__ = ()

    high: float
    """Upper end of the interval."""
    interval: IntervalKind
    """How the interval was made."""
    low: float
    """Lower end of the interval."""
    name: str
    """Symbol."""
    not_identifiable: NotIdentifiable | None
    """What the record leaves open, where it doesn't tell this parameter."""
    specimen: str | None
    """Specimen it belongs to; `None`: common to all."""
    std_error: float
    """Standard deviation of the draws; NaN without them."""
    unit: str
    """Unit of the numbers below."""
    value: float
    """Value of largest likelihood."""

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
    """A load picked up or put down."""

    __slots__ = ()

    change_kg: Gaussian
    """By how much, kg."""
    interval_s: Interval95 | None
    """It happened between these with 95 %, s."""
    probability: float | None
    """Probability that it happened."""
    time_s: float
    """When, s from the start of the recording."""

    _fields = {
        "change_kg": "Gaussian",
        "interval_s": "Interval95",
        "probability": "",
        "time_s": "",
    }


class PerhapsNever(Record):
    """A time and its bounds as JSON has them: null where it never comes."""

    __slots__ = ()

    high: float | None
    """Upper bound, s."""
    low: float | None
    """Lower bound, s."""
    value: float | None
    """With the catalogue's own values, s."""

    _fields = {
        "high": "",
        "low": "",
        "value": "",
    }


class Pose(Record):
    """One pose of a list."""

    __slots__ = ()

    move_s: float
    """Length of the move to it, s."""
    pause_s: float
    """Rest there, s."""
    pose_rad: list[float]
    """Positions in the order of the joints, rad (m)."""

    _fields = {
        "move_s": "",
        "pause_s": "",
        "pose_rad": "",
    }


class PosesResult(Record):
    """Poses to visit, and what to expect from it."""

    __slots__ = ()

    baseline: BaselineSource
    """What the expectation rests on."""
    duration_s: float
    """Length of the recording, s, with a rest before the first move."""
    expected: list[Expected]
    """What to expect, per elastic joint."""
    inflation_factor: float
    """What the intervals of a robot exactly as described were multiplied by."""
    joint_bits: int
    """Bits of the joint encoder assumed."""
    joints: list[str]
    """Its joints, in the order of a pose."""
    lists_tried: int
    """Lists of poses that were looked at."""
    payload: bool
    """Whether the gripper may hold something unknown."""
    poses: list[Pose]
    """The poses, in order."""
    robot: str
    """The robot."""
    schema: Literal["sinew/excitation/1"]
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


class PredictionResult(Record):
    """The prediction for one rope."""

    __slots__ = ()

    beyond: Beyond
    """How far the duty lies beyond it in load and temperature; intervals are widened for that, and for times
    beyond `Holds::duration_s`.
    """
    breaks_after_s: float | None
    """When the rope breaks, s, at the catalogue's values, where that is within the times asked for; there is no
    reading from then on.
    """
    broken_share: float
    """Share of draws in which the tension broke the rope, 0 to 1."""
    cautions: list[Caution]
    """Where the duty leaves what the law was made for, and other cautions."""
    draws: int
    """Draws made."""
    duty: str
    """The duty in words."""
    holds: Holds
    """Data behind the rope's values."""
    length_m: float
    """Strand length, m."""
    life: Life
    """How long it lasts, and which portion wears out first."""
    parameters: int
    """All parameters of the law."""
    pulleys: list[PulleyPlace]
    """The guiding pulleys along the rope, in order from the drive."""
    read_at_c: float
    """Temperature the readings refer to, °C."""
    read_at_n: float
    """Tension the readings refer to, N."""
    readings: list[Reading]
    """Readings, up to the time at which the rope breaks."""
    rope: str
    """Rope."""
    schema: Literal["sinew/rope-predict/1"]
    """Name and number of this schema."""
    seed: int
    """Their seed."""
    starting_guesses: int
    """Parameters of the law that are starting guesses."""
    strength_left_share: Bounded | None
    """Strength left at the last reading, share of new; `None` where bending was not asked for or the rope's
    diameter is unknown.
    """
    summary: DutySummary
    """Its sums."""

    _fields = {
        "beyond": "Beyond",
        "breaks_after_s": "",
        "broken_share": "",
        "cautions": "Caution",
        "draws": "",
        "duty": "",
        "holds": "Holds",
        "length_m": "",
        "life": "Life",
        "parameters": "",
        "pulleys": "PulleyPlace",
        "read_at_c": "",
        "read_at_n": "",
        "readings": "Reading",
        "rope": "",
        "schema": "",
        "seed": "",
        "starting_guesses": "",
        "strength_left_share": "Bounded",
        "summary": "DutySummary",
    }


class PretensionResult(Record):
    """The plan."""

    __slots__ = ()

    cautions: list[Caution]
    """Cautions."""
    chosen: int | None
    """Index of the gentlest one that takes away what is asked, at catalogue values: least tension first, then
    least time.
    """
    give_m_per_n: float
    """What gives in series with each strand, m/N."""
    horizon_s: float
    """How long it must hold, s."""
    joint: HeldJoint | None
    """The joint, where a second rope pulls it the other way and tension is the mean of both."""
    length_m: float
    """Strand length, m."""
    lowest_n: float
    """Lowest tension allowed, N."""
    parameters: int
    """All parameters of the law."""
    procedures: list[Procedure]
    """All procedures tried, by tension, then duration."""
    remove_share: float
    """Share of the later elongation that the procedure is to take away."""
    rope: str
    """Rope."""
    schedule_bedded: Schedule
    """Schedule after the chosen procedure (or the most effective one)."""
    schedule_new: Schedule
    """Schedule of a rope strung as it comes."""
    schema: Literal["sinew/rope-pretension/1"]
    """Name and number of this schema."""
    starting_guesses: int
    """Parameters of the law that are starting guesses."""
    temperature_c: float
    """Temperature, °C."""
    tension_n: float
    """Working tension, N."""
    without_m: Bounded
    """Largest later elongation without any procedure, m."""

    _fields = {
        "cautions": "Caution",
        "chosen": "",
        "give_m_per_n": "",
        "horizon_s": "",
        "joint": "HeldJoint",
        "length_m": "",
        "lowest_n": "",
        "parameters": "",
        "procedures": "Procedure",
        "remove_share": "",
        "rope": "",
        "schedule_bedded": "Schedule",
        "schedule_new": "Schedule",
        "schema": "",
        "starting_guesses": "",
        "temperature_c": "",
        "tension_n": "",
        "without_m": "Bounded",
    }


class PriorBasisRope(Record):
    """The law of a rope, and a fifth generic curves."""

    __slots__ = ()

    draws: int
    """Laws drawn."""
    duty: str | None
    """The duty, where it is known; else work with peaks nobody recorded."""
    guesses: int
    """Parameters that are starting guesses."""
    kind: Literal["rope"]
    parameters: int
    """Parameters of its law."""
    rope: str
    """Rope."""

    _fields = {
        "draws": "",
        "duty": "",
        "guesses": "",
        "kind": "",
        "parameters": "",
        "rope": "",
    }


class PriorBasisUnknown(Record):
    """Nobody knows the rope or its pretension: the laws of all ropes of the catalogue, or its own, and a fifth
    generic curves.
    """

    __slots__ = ()

    kind: Literal["unknown"]
    missing: MissingFromRobot
    """What the robot file lacks."""
    ropes: int
    """Ropes whose laws stand for it; one: its own, under any pretension."""

    _fields = {
        "kind": "",
        "missing": "",
        "ropes": "",
    }


class Procedure(Record):
    """A bedding-in procedure and what it does."""

    __slots__ = ()

    duration_s: float
    """For this long, s."""
    removed_share: Bounded
    """Share of the elongation without procedure that it takes away."""
    still_to_come_m: Bounded
    """Largest elongation at working tension that is still to come, m, counted from a minute after the rope is
    back at working tension.
    """
    tension_n: float
    """Held at this tension, N."""

    _fields = {
        "duration_s": "",
        "removed_share": "Bounded",
        "still_to_come_m": "Bounded",
        "tension_n": "",
    }


class Published(Record):
    """What a maker publishes, with origin and uncertainty."""

    __slots__ = ()

    breaking_load_n: CatalogueValue | None
    """Breaking load, N."""
    diameter_m: CatalogueValue | None
    """Diameter, m."""
    weight_kg_per_m: CatalogueValue | None
    """Weight, kg/m."""

    _fields = {
        "breaking_load_n": "CatalogueValue",
        "diameter_m": "CatalogueValue",
        "weight_kg_per_m": "CatalogueValue",
    }


class PulleyPlace(Record):
    """A guiding pulley along a strand, and how it bends the rope."""

    __slots__ = ()

    at_m: float
    """Where the rope first touches it with the drive at rest, m from the drive."""
    bend_ratio: float | None
    """Diameter that the rope is bent to, over its own; `None` where that isn't published."""
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


class Rank(Record):
    """One rope's rank."""

    __slots__ = ()

    at_s: float
    """Time at which strains are compared, s: the longest that all reach."""
    name: str
    """Rope."""
    rank: int
    """One more than the ropes whose intervals lie wholly below: 1 where none is shown to stretch less."""
    scatter_share: float
    """Standard deviation between specimens that the intervals rest on, over the strain."""
    scatter_source: ScatterSource
    """Where that comes from."""
    slope_per_s: Bounded | None
    """Slope, 1/s."""
    specimens: int
    """Repeats."""
    strain_ratio: Bounded
    """Strain then, m/m, with the interval of the rope's mean."""

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


class Reading(Record):
    """Elongation at one time."""

    __slots__ = ()

    broken_share: float
    """Share of the draws in which the rope is broken by then, 0 to 1: they are left out."""
    elongation_m: Bounded
    """Elongation of the strand from new and slack, m."""
    irreversible_m: Bounded
    """Part of it that unloading would not bring back, m."""
    since_tensioned_m: Bounded
    """Elongation since a minute after tensioning, m."""
    strain_ratio: Bounded
    """Strain of the strand from new and slack, m/m."""
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


class RecordingInfo(Record):
    """What was read."""

    __slots__ = ()

    duration_s: float
    """From first to last frame, s."""
    format: Format
    """Its format."""
    frames: int
    """Frames read."""
    path: str
    """File name as given."""
    rate_hz: float | None
    """Median frame rate, Hz; `None` with fewer than two frames."""
    segments: int
    """Segments without a gap or clock jump."""
    sources: list[SignalSource]
    """Where each quantity is read from."""
    start_time_ns: int
    """Time of the first frame, ns since the recording's epoch."""

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
    """What a recording holds, and how well it could be read."""

    __slots__ = ()

    ambiguous: list[Ambiguity]
    """Sides that several topics could be; nothing is read of joints until one is chosen."""
    duration_s: float | None
    """From the first frame to the last, s."""
    file: str
    """File as the user named it."""
    format: Format
    """Its format."""
    frames: int
    """Number of frames."""
    health: Health
    """What was lost or repaired."""
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
    schema: Literal["sinew/log-info/1"]
    """Name and number of this schema."""
    segments: int
    """Parts without a gap, clock jump or damage."""
    shortest_step_s: float | None
    """Shortest step from frame to frame within a segment, s."""
    sources: list[SignalSource]
    """Where each quantity is read from."""
    start_time_ns: int | None
    """Time of the first frame, ns since the epoch of the recording's clock."""
    temperature: bool
    """Whether a temperature is recorded."""
    topics: list[TopicInfo]
    """Topics in the order of their names; none of a table."""
    unused_columns: list[str]
    """Columns of a table that nothing is read from."""

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
        "topics": "TopicInfo",
        "unused_columns": "",
    }


class RecordingOutcome(Record):
    """One recording of many."""

    __slots__ = ()

    error: str | None
    """Why it couldn't be estimated; `None`: it was."""
    estimate: EstimateDocument | None
    """Its estimate, as `sinew estimate` has it, without the series over time."""
    recording: str
    """The recording as it was named."""

    _fields = {
        "error": "",
        "estimate": "EstimateDocument",
        "recording": "",
    }


class RecordingWarningClockJumps(Record):
    """The clock went back."""

    __slots__ = ()

    count: int
    """How often."""
    kind: Literal["clock-jumps"]

    _fields = {
        "count": "",
        "kind": "",
    }


class RecordingWarningDamaged(Record):
    """A part of the file is damaged."""

    __slots__ = ()

    bytes: int
    """Bytes lost."""
    kind: Literal["damaged"]
    offset: int
    """Where, bytes from the start."""
    reason: str
    """Why."""

    _fields = {
        "bytes": "",
        "kind": "",
        "offset": "",
        "reason": "",
    }


class RecordingWarningGaps(Record):
    """Pauses in the recording."""

    __slots__ = ()

    count: int
    """How many."""
    kind: Literal["gaps"]
    longest_s: float
    """The longest, s."""

    _fields = {
        "count": "",
        "kind": "",
        "longest_s": "",
    }


class RecordingWarningImplausibleOffset(Record):
    """An offset no rope stretches by."""

    __slots__ = ()

    joint: str
    """Joint."""
    kind: Literal["implausible-offset"]
    offset_rad: float
    """Offset, rad."""

    _fields = {
        "joint": "",
        "kind": "",
        "offset_rad": "",
    }


class RecordingWarningNonFinite(Record):
    """Samples that are NaN or infinite."""

    __slots__ = ()

    count: int
    """How many."""
    joint: str
    """Joint."""
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
    """Messages that came out of order."""

    __slots__ = ()

    count: int
    """How many."""
    kind: Literal["out-of-order"]

    _fields = {
        "count": "",
        "kind": "",
    }


class RecordingWarningReference(Record):
    """One of the reference recording."""

    __slots__ = ()

    kind: Literal["reference"]
    warning: RecordingWarning
    """Which."""

    _fields = {
        "kind": "",
        "warning": "RecordingWarning",
    }


class RecordingWarningRobot(Record):
    """What robot.toml or the URDF are warned of."""

    __slots__ = ()

    kind: Literal["robot"]
    text: str
    """In words."""

    _fields = {
        "kind": "",
        "text": "",
    }


class RecordingWarningSamplesLost(Record):
    """Samples of a stream that are missing, or were dropped because their stamp was there already."""

    __slots__ = ()

    kind: Literal["samples-lost"]
    missing: int
    """Missing, as far as the steps between the others tell."""
    repeated: int
    """Dropped."""
    share: float
    """Part of all samples, 0 to 1."""
    stream: StreamRole
    """What the stream brings."""

    _fields = {
        "kind": "",
        "missing": "",
        "repeated": "",
        "share": "",
        "stream": "",
    }


class RecordingWarningSuspicion(Record):
    """What looks wrong in the recording's signals."""

    __slots__ = ()

    kind: Literal["suspicion"]
    text: str
    """In words."""

    _fields = {
        "kind": "",
        "text": "",
    }


class RecordingWarningTorqueHardlyChanges(Record):
    """A joint's torque hardly changes: a wrong stiffness can't be told from stretch."""

    __slots__ = ()

    joint: str
    """Joint."""
    kind: Literal["torque-hardly-changes"]
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
    """Joints of the recording that the robot doesn't have."""

    __slots__ = ()

    joints: list[str]
    """Their names."""
    kind: Literal["unknown-joints"]

    _fields = {
        "joints": "",
        "kind": "",
    }


class RecordingWarningUnwrapped(Record):
    """Encoder wrap-arounds that were removed."""

    __slots__ = ()

    count: int
    """How many."""
    joint: str
    """Joint."""
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
    """After the load fell."""

    __slots__ = ()

    at_once_strain_ratio: float
    """Strain that went with the load, m/m."""
    before_strain_ratio: float
    """Strain at the end under the higher load, m/m."""
    delayed_strain_ratio: float
    """Strain that went later, within the record, m/m."""
    duration_s: float
    """Length of the stage, s."""
    force_after_n: float
    """Load after, N."""
    force_before_n: float
    """Load before, N."""
    residual_strain_ratio: float
    """Strain at the end of the stage, m/m: what is left, residual where the load is gone."""

    _fields = {
        "at_once_strain_ratio": "",
        "before_strain_ratio": "",
        "delayed_strain_ratio": "",
        "duration_s": "",
        "force_after_n": "",
        "force_before_n": "",
        "residual_strain_ratio": "",
    }


class Rejected(Record):
    """A rope that fell out."""

    __slots__ = ()

    reasons: list[Rejection]
    """Every constraint it fails."""
    rope: str
    """Rope."""

    _fields = {
        "reasons": "Rejection",
        "rope": "",
    }


class RejectionBendRatio(Record):
    """Smallest pulley diameter over rope diameter."""

    __slots__ = ()

    kind: Literal["bend-ratio"]
    limit_ratio: float
    """Limit."""
    ratio: float
    """Found."""

    _fields = {
        "kind": "",
        "limit_ratio": "",
        "ratio": "",
    }


class RejectionBendRatioNotKnown(Record):
    """Rope or pulley diameter is not known."""

    __slots__ = ()

    kind: Literal["bend-ratio-not-known"]

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
    """It breaks before the last time asked for."""

    __slots__ = ()

    after_s: float
    """When, at the catalogue's values, s."""
    cause: BreakCause
    """Of what."""
    kind: Literal["breaks"]

    _fields = {
        "after_s": "",
        "cause": "",
        "kind": "",
    }


class RejectionDiameterNotPublished(Record):
    """The diameter is not published."""

    __slots__ = ()

    kind: Literal["diameter-not-published"]

    _fields = {
        "kind": "",
    }


class RejectionElongation(Record):
    """Upper end of the elongation's interval, m."""

    __slots__ = ()

    high_m: float
    """Found."""
    kind: Literal["elongation"]
    limit_m: float
    """Limit."""

    _fields = {
        "high_m": "",
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


class RejectionNotPredicted(Record):
    """The law gives no prediction."""

    __slots__ = ()

    kind: Literal["not-predicted"]
    reason: str
    """Why."""

    _fields = {
        "kind": "",
        "reason": "",
    }


class RejectionSafetyFactor(Record):
    """Breaking load over largest tension."""

    __slots__ = ()

    kind: Literal["safety-factor"]
    limit_ratio: float
    """Limit."""
    ratio: float
    """Found."""

    _fields = {
        "kind": "",
        "limit_ratio": "",
        "ratio": "",
    }


class RejectionStiffness(Record):
    """Stiffness of the strand, N/m."""

    __slots__ = ()

    kind: Literal["stiffness"]
    limit_n_per_m: float
    """Limit."""
    stiffness_n_per_m: float
    """Found."""

    _fields = {
        "kind": "",
        "limit_n_per_m": "",
        "stiffness_n_per_m": "",
    }


class RejectionTooHeavy(Record):
    """Weight above the largest, kg/m."""

    __slots__ = ()

    kind: Literal["too-heavy"]
    limit_kg_per_m: float
    """Limit."""
    weight_kg_per_m: float
    """Found."""

    _fields = {
        "kind": "",
        "limit_kg_per_m": "",
        "weight_kg_per_m": "",
    }


class RejectionTooThick(Record):
    """Diameter above the largest, m."""

    __slots__ = ()

    diameter_m: float
    """Found."""
    kind: Literal["too-thick"]
    limit_m: float
    """Limit."""

    _fields = {
        "diameter_m": "",
        "kind": "",
        "limit_m": "",
    }


class RejectionTooThin(Record):
    """Diameter below the smallest, m."""

    __slots__ = ()

    diameter_m: float
    """Found."""
    kind: Literal["too-thin"]
    limit_m: float
    """Limit."""

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
    """A limit of elongation."""

    __slots__ = ()

    elongation_m: float
    """Elongation at which to tension again, m."""
    state: LimitState
    """Whether it is passed."""

    _fields = {
        "elongation_m": "",
        "state": "",
    }


class RobotCheckResult(Record):
    """A robot as Sinew has understood its description."""

    __slots__ = ()

    file: str
    """`robot.toml` as opened."""
    findings: list[Finding]
    """What looks odd, is missing or can't be, the worst first."""
    joints: list[JointCheck]
    """Joints in Sinew's order."""
    moving_mass_kg: float
    """Mass that moves with the first joint, kg."""
    name: str
    """Its name."""
    routing: RoutingCheck | None
    """Routing of the tendons, where `robot.toml` has `[[tendons]]`."""
    schema: Literal["sinew/robot-check/1"]
    """Name and number of this schema."""
    urdf: str
    """Where the URDF came from, in words."""
    warnings: list[str]
    """What a reader of the URDF does with what is unusual in it."""

    _fields = {
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
    """What it was held against."""

    __slots__ = ()

    file: str
    """Where the robot's file is."""
    name: str
    """Name in the URDF."""
    urdf: str
    """Where the URDF comes from: a file, or the recording's own description."""

    _fields = {
        "file": "",
        "name": "",
        "urdf": "",
    }


class RopeListResult(Record):
    """All ropes of a catalogue."""

    __slots__ = ()

    ropes: list[RopeSummary]
    """Ropes in the catalogue's order."""
    schema: Literal["sinew/rope-list/1"]
    """Name and number of this schema."""

    _fields = {
        "ropes": "RopeSummary",
        "schema": "",
    }


class RopeResult(Record):
    """Everything known about a rope."""

    __slots__ = ()

    breaking_load_n: float | None
    """Breaking load, N, where it is published."""
    diameter_m: float | None
    """Diameter, m, where it is published."""
    endurance: dict[str, CatalogueValue]
    """What breaks the rope, its own values or its fibre's, by their names, which end in their units."""
    endurance_sources: dict[str, str]
    """Sources of the endurance by their keys."""
    fibre: str
    """Load-bearing fibre."""
    file: str | None
    """File it came from; `None`: ships with the program."""
    holds: Holds
    """Data behind the values of the law; beyond it predictions widen."""
    law: dict[str, CatalogueValue]
    """Parameters of the law by their names in the catalogue, which end in their units."""
    manufacturer: str
    """Who makes it."""
    material: str
    """What the fibre is made of."""
    name: str
    """Name."""
    note: str | None
    """Remarks."""
    parameters: int
    """Parameters of the law."""
    plait: str | None
    """How it is plaited."""
    product: str
    """What they call it."""
    published: Published
    """What is published."""
    schema: Literal["sinew/rope-show/1"]
    """Name and number of this schema."""
    sources: dict[str, str]
    """Sources by their keys."""
    starting_guesses: int
    """Parameters of the law that are starting guesses."""
    weight_kg_per_m: float | None
    """Weight, kg/m, where it is published."""

    _fields = {
        "breaking_load_n": "",
        "diameter_m": "",
        "endurance": "map:CatalogueValue",
        "endurance_sources": "",
        "fibre": "",
        "file": "",
        "holds": "Holds",
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
        "starting_guesses": "",
        "weight_kg_per_m": "",
    }


class RopeSummary(Record):
    """A rope in short."""

    __slots__ = ()

    breaking_load_n: float | None
    """Breaking load, N, where it is published."""
    diameter_m: float | None
    """Diameter, m, where it is published."""
    fibre: str
    """Load-bearing fibre."""
    file: str | None
    """File it came from; `None`: ships with the program."""
    manufacturer: str
    """Who makes it."""
    material: str
    """What the fibre is made of."""
    name: str
    """Name."""
    parameters: int
    """Parameters of the law."""
    plait: str | None
    """How it is plaited."""
    product: str
    """What they call it."""
    starting_guesses: int
    """Parameters of the law that are starting guesses."""
    weight_kg_per_m: float | None
    """Weight, kg/m, where it is published."""

    _fields = {
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
        "starting_guesses": "",
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
    """Combinations of elongations that the motion of the joints does not show at `q = 0`."""

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
    """Specimens whose end stands more than 3.5 robust deviations apart from their group."""
    end_deviation_ratio: float | None
    """Standard deviation of it between specimens, m/m; `None` for one."""
    end_strain_ratio: float
    """Mean strain at the end, m/m."""
    group: str | None
    """Group; `None`: specimens without a group."""
    slope_deviation_per_s: float | None
    """Standard deviation of the slope between specimens, 1/s."""
    slope_per_s: float | None
    """Mean slope, 1/s."""
    specimens: int
    """Specimens."""

    _fields = {
        "apart": "",
        "end_deviation_ratio": "",
        "end_strain_ratio": "",
        "group": "",
        "slope_deviation_per_s": "",
        "slope_per_s": "",
        "specimens": "",
    }


class Schedule(Record):
    """When to tension again at constant length."""

    __slots__ = ()

    count: Bounded
    """How many within the horizon."""
    first_s: PerhapsNever
    """First of them; NaN (null) where a draw has none."""
    left_alone: LeftAlone
    """Its tension when it is left alone."""
    never_share: float
    """Share of draws that need no re-tensioning at all."""
    start_n: Bounded | None
    """Tension to string the rope with so that it never falls below the lowest within the horizon, N; `None`
    where even 40 % of the breaking load does not do.
    """
    tension_at_end_n: Bounded
    """Tension at the horizon's end without any re-tensioning, N."""
    times_s: list[float]
    """Times since stringing, s, with the catalogue's own values."""

    _fields = {
        "count": "Bounded",
        "first_s": "PerhapsNever",
        "left_alone": "LeftAlone",
        "never_share": "",
        "start_n": "Bounded",
        "tension_at_end_n": "Bounded",
        "times_s": "",
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


class SegmentEstimate(Record):
    """Offsets at the end of a segment of some minutes."""

    __slots__ = ()

    from_s: float
    """From, s of the recording."""
    offset_rad: list[Gaussian]
    """Offset of every elastic joint at `to_s`, rad, in the order of `joints`."""
    to_s: float
    """Up to here, s of the recording."""

    _fields = {
        "from_s": "",
        "offset_rad": "Gaussian",
        "to_s": "",
    }


class SelectionResult(Record):
    """The choice."""

    __slots__ = ()

    candidates: list[Candidate]
    """Ropes that meet everything, by `Candidate::rank` and then by least elongation."""
    duty: str
    """The duty in words."""
    rejected: list[Rejected]
    """The others."""
    schema: Literal["sinew/rope-select/1"]
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


class Series(Record):
    """A joint's estimate over time, averaged into at most `Series::POINTS` intervals. All columns have the same
    length; intervals without an estimate hold NaN (null in JSON).
    """

    __slots__ = ()

    offset_max_rad: list[float | None]
    """Largest offset in the interval, rad."""
    offset_min_rad: list[float | None]
    """Smallest offset in the interval, rad."""
    offset_rad: list[float | None]
    """Mean offset, rad."""
    q_rad: list[float | None]
    """Mean joint position, rad."""
    tau_el_nm: list[float | None]
    """Mean elastic torque from the source chosen, N·m."""
    tau_spring_nm: list[float | None]
    """Mean torque of the spring as the encoders show it, `K (theta_measured − q)`, N·m."""
    time_s: list[float]
    """Middle of each interval, s from the start of the recording."""
    usable_share: list[float | None]
    """Share of the interval's frames that could be used, 0 to 1."""

    _fields = {
        "offset_max_rad": "",
        "offset_min_rad": "",
        "offset_rad": "",
        "q_rad": "",
        "tau_el_nm": "",
        "tau_spring_nm": "",
        "time_s": "",
        "usable_share": "",
    }


class SessionEstimate(Record):
    """Offsets since the baseline."""

    __slots__ = ()

    baseline: str | None
    """First recording of the baseline; `None`: data-sheet priors only."""
    baseline_time_utc_s: float | None
    """When that ended, s since 1970 UTC: every offset was zero then. `None` where its clock doesn't say."""
    damaged: bool
    """Whether part of the file was lost."""
    duration_s: float
    """Length of the part used, s."""
    external_force: ForceEstimate | None
    """A constant force from outside at the tool; `None`: there was none to be seen. Of a long recording, in the
    stretch where it is likeliest.
    """
    joints: list[TendonEstimate]
    """One entry per elastic joint."""
    left_out: list[LeftOut]
    """The longest such times."""
    left_out_share: float
    """Share of the time left out as contact or disturbance."""
    live: LiveCourse | None
    """What the online estimate says of the same recording; `None` where nobody asked."""
    motor_torque: MotorTorque
    """Which torque of the motors was used as a second witness."""
    nuisance: list[NuisanceChange]
    """Everything estimated along: what was believed before and after."""
    payload_changes: list[PayloadChange]
    """Loads picked up or put down within the recording."""
    payload_kg: Gaussian
    """Payload at the end, kg."""
    poses: int
    """Distinct poses the arm stood or passed at, as far as gravity tells them apart."""
    recording: str
    """The recording."""
    reference_temperature_c: float | None
    """Temperature the offsets refer to, °C, where it was recorded."""
    robot: str
    """The robot."""
    segments: list[SegmentEstimate]
    """Offsets at the end of every segment the recording was estimated in."""
    start_time_utc_s: float | None
    """When the part used began, s since 1970 UTC; `None` where the recording's clock doesn't say."""
    temperature_c: float | None
    """Mean temperature, °C, where it was recorded or stated."""
    temperature_source: TemperatureSource
    """Where that comes from."""
    warnings: list[Warning]
    """What the reader should know."""

    _fields = {
        "baseline": "",
        "baseline_time_utc_s": "",
        "damaged": "",
        "duration_s": "",
        "external_force": "ForceEstimate",
        "joints": "TendonEstimate",
        "left_out": "LeftOut",
        "left_out_share": "",
        "live": "LiveCourse",
        "motor_torque": "",
        "nuisance": "NuisanceChange",
        "payload_changes": "PayloadChange",
        "payload_kg": "Gaussian",
        "poses": "",
        "recording": "",
        "reference_temperature_c": "",
        "robot": "",
        "segments": "SegmentEstimate",
        "start_time_utc_s": "",
        "temperature_c": "",
        "temperature_source": "",
        "warnings": "Warning",
    }


class SessionPoint(Record):
    """A session, and what the trend knew after it."""

    __slots__ = ()

    at_reference_rad: float | None
    """At the reference temperature, with the drift found in the end."""
    cycle: float | None
    """Cycle of the machine."""
    is_off: bool
    """Whether the record looked off by itself."""
    jump_probability: float
    """Probability of an unconfirmed jump."""
    offset_rad: Gaussian | None
    """As recorded; `None` where it couldn't tell."""
    temperature_c: float | None
    """Temperature, °C."""
    time_utc_s: float
    """Its start, s since 1970; from cycle 0 where only cycles are known."""
    tracked_rad: Gaussian
    """Offset as the trend knew it then."""

    _fields = {
        "at_reference_rad": "",
        "cycle": "",
        "is_off": "",
        "jump_probability": "",
        "offset_rad": "Gaussian",
        "temperature_c": "",
        "time_utc_s": "",
        "tracked_rad": "Gaussian",
    }


class Settings(Record):
    """How the estimate was made."""

    __slots__ = ()

    comparison: Comparison
    """Whether `theta − q` lags like the observed torque."""
    gain_per_s: float
    """Observer gain `K_I`, 1/s."""
    injected: list[Injection]
    """Offsets added by hand."""
    reference: str | None
    """Recording the estimate is compared with."""
    source: TorqueSource
    """Where `tau_el` comes from."""
    tau_ext: bool
    """Whether the recording's known external torque was used."""
    velocity_filter_rad_per_s: float | None
    """Cut-off of the velocity filter, rad/s; `None`: recorded velocities, unfiltered positions."""

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
    """What comes with the baseline: the same in every session since then."""
    drift_rad: float
    """What zero and stiffness do with temperature: proportional to its change since then."""

    _fields = {
        "baseline_rad": "",
        "drift_rad": "",
    }


class Shift(Record):
    """The shift of one isotherm."""

    __slots__ = ()

    log10_a_t: Gaussian
    """Decadic logarithm of a_T: time at the reference is time here divided by a_T. Its standard error follows
    from the mismatch of the overlap and grows along the chain.
    """
    overlap_share: float
    """Decades of the property's logarithm in common with the neighbour nearer the reference, as a share of this
    isotherm's own range; without overlap the shift is a guess.
    """
    temperature_c: float
    """Temperature, °C."""

    _fields = {
        "log10_a_t": "Gaussian",
        "overlap_share": "",
        "temperature_c": "",
    }


class SignalCount(Record):
    """Bad samples of one signal."""

    __slots__ = ()

    count: int
    """How many samples, or turns."""
    joint: str
    """The joint's name."""
    quantity: Quantity
    """The quantity."""

    _fields = {
        "count": "",
        "joint": "",
        "quantity": "",
    }


class SignalSource(Record):
    """Where a quantity is read from."""

    __slots__ = ()

    quantity: Quantity
    """The quantity."""
    source: str
    """Topic and field or interface, or the columns."""
    topic: str | None
    """Topic it is in; `None` in a table."""

    _fields = {
        "quantity": "",
        "source": "",
        "topic": "",
    }


class SimulateComparison(Record):
    """A scenario without and with its correction."""

    __slots__ = ()

    with_: Score
    """As the scenario's `[correction]` says."""
    without: Score
    """Neither the set-points nor the external torque corrected."""

    _fields = {
        "with_": "Score",
        "without": "Score",
    }


class SimulatedResult(Record):
    """A simulated recording's truth, and its control where that was asked for."""

    __slots__ = ()

    baseline_s: list[float] | None
    """First session, s: `[from, to]`."""
    contact_fraction: float
    """Share of the time in contact."""
    contacts: list[Touch]
    """Each contact."""
    control: SimulateComparison | None
    """The scenario without and with its correction."""
    duration_s: float
    """Length, s."""
    frames: Frames
    """Frames lost, repeated and delayed on their way into the file."""
    injected: list[str] | None
    """Which tendons' offsets are injected into the recording instead of felt by the spring."""
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
    offset_course_s_rad: dict[str, list[list[float]]]
    """Offset over time: `[time, offset]`, s and rad; straight lines between."""
    offset_rad: dict[str, float]
    """Offset just before the end of the second session, or of the recording where there are no sessions, rad."""
    payload_kg: float
    """All loads together, kg."""
    payloads: list[Load]
    """Each load."""
    sample_rate_hz: float
    """Frames per second."""
    scenario: str
    """Name of the scenario."""
    schema: Literal["sinew/simulate/1"]
    """Name and number of this schema."""
    seed: int
    """Its seed."""
    sessions_s: dict[str, list[float]] | None
    """Sessions by name, s."""
    spring_cubic_per_rad2: dict[str, float]
    """Stiffening, rad⁻²."""
    start_time_ns: int
    """Time stamp of time 0, ns since 1970."""
    steps: list[Step]
    """Every jump of an offset."""
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
        "offset_course_s_rad": "",
        "offset_rad": "",
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
    """A raw data file."""

    __slots__ = ()

    columns: list[SourceColumn]
    """Columns used."""
    file: str
    """File as named."""
    notes: list[str]
    """Assumptions made when reading it."""
    sha256: str
    """SHA-256 of its bytes."""

    _fields = {
        "columns": "SourceColumn",
        "file": "",
        "notes": "",
        "sha256": "",
    }


class SourceColumn(Record):
    """A column of a file and what it was taken for."""

    __slots__ = ()

    column: str
    """Its header."""
    quantity: TestQuantity
    """What it measures."""
    unit: str
    """Unit the file writes it in."""

    _fields = {
        "column": "",
        "quantity": "",
        "unit": "",
    }


class Span(Record):
    """Mean, lowest and highest of readings, in the unit that the field's name says."""

    __slots__ = ()

    high: float
    """Highest."""
    low: float
    """Lowest."""
    mean: float
    """Mean."""

    _fields = {
        "high": "",
        "low": "",
        "mean": "",
    }


class Spot(Record):
    """A portion of the rope and what it has lost of its life; 1 is all of it."""

    __slots__ = ()

    bending_damage: float
    """Lost to bending."""
    creep_damage: float
    """Lost to constant load."""
    from_m: float
    """From here, m from the drive with the drive at rest."""
    guides: int
    """Guiding pulleys that pass over it."""
    place: Place
    """Rope or ends."""
    to_m: float
    """To here, m."""

    _fields = {
        "bending_damage": "",
        "creep_damage": "",
        "from_m": "",
        "guides": "",
        "place": "",
        "to_m": "",
    }


class Step(Record):
    """A jump of an offset."""

    __slots__ = ()

    at_s: float
    """When, s."""
    joint: str
    """Which joint, or which tendon."""
    size_rad: float
    """By how much, rad."""

    _fields = {
        "at_s": "",
        "joint": "",
        "size_rad": "",
    }


class StiffnessSinceBefore(Record):
    """Stiffness that may have changed between two recordings. Offsets are averaged over whether it has."""

    __slots__ = ()

    change_ratio: Gaussian
    """By how much if it has; lost stiffness is negative."""
    probability: float
    """Probability that it has."""

    _fields = {
        "change_ratio": "Gaussian",
        "probability": "",
    }


class StrainZeroAsRecorded(Record):
    """As recorded; no reading before the load."""

    __slots__ = ()

    kind: Literal["as-recorded"]

    _fields = {
        "kind": "",
    }


class StrainZeroBeforeLoad(Record):
    """Mean of readings before the load."""

    __slots__ = ()

    kind: Literal["before-load"]
    readings: int
    """How many."""

    _fields = {
        "kind": "",
        "readings": "",
    }


class StreamTiming(Record):
    """When the samples of one stream came: a topic, or the rows of a table."""

    __slots__ = ()

    jitter_s: float | None
    """How much shorter a step is than usual, one standard deviation, s."""
    missing: int | None
    """Samples that the steps between the others leave out; `None` where steps are too uneven to tell."""
    repeated: int
    """Samples dropped because another one with their stamp was there already, and said something else."""
    role: StreamRole
    """What it brings."""
    samples: int
    """Samples with a stamp of their own."""
    step_s: float | None
    """Usual step from one to the next, s; `None` with too few."""

    _fields = {
        "jitter_s": "",
        "missing": "",
        "repeated": "",
        "role": "",
        "samples": "",
        "step_s": "",
    }


class Superposition(Record):
    """Shift factors and what they follow."""

    __slots__ = ()

    arrhenius: Arrhenius | None
    """Arrhenius line through all temperatures."""
    reference_c: float
    """Temperature that isn't shifted, °C."""
    shifts: list[Shift]
    """Shifts by rising temperature."""
    wlf: Wlf | None
    """Equation of Williams, Landel and Ferry over temperatures from the reference up."""

    _fields = {
        "arrhenius": "Arrhenius",
        "reference_c": "",
        "shifts": "Shift",
        "wlf": "Wlf",
    }


class Suspicion(Record):
    """A sudden change that isn't confirmed."""

    __slots__ = ()

    probability: float
    """Its probability."""
    time_utc_s: float
    """First session after it, s since 1970."""

    _fields = {
        "probability": "",
        "time_utc_s": "",
    }


class TendonChange(Record):
    """A sudden change of a tendon."""

    __slots__ = ()

    cause: Cause | None
    """Of a slip: what slipped."""
    interval_s: Interval95 | None
    """It happened between these with 95 %, s; `None` for what happened before the recording."""
    kind: TendonChangeKind
    """What it is."""
    probability: float | None
    """Probability that it happened and lasts: one that comes late may be a contact as well. `None` for what
    happened before the recording.
    """
    size_rad: Gaussian | None
    """By how much the offset changed, rad; `None`: only the stiffness did."""
    stiffness_change_ratio: Gaussian | None
    """Stiffness lost or gained with it, relative; `None`: no change seen."""
    time_s: float
    """When, s from the start of the recording."""

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
    """A tendon."""

    __slots__ = ()

    elongation_m_per_rad: float
    """Elongation per offset, m/rad."""
    joint_pulley_radius_m: float
    """Radius of the pulley at the joint, m."""
    length_m: float
    """Free length, m."""
    pretension_n: float | None
    """Pretension, N."""
    replace_at_strain_ratio: float | None
    """Strain at which to replace the rope."""
    retension_at_m: float | None
    """Elongation at which to tension again, m."""
    rope: str | None
    """Catalogue name of the rope."""
    taut_up_to_nm: float | None
    """Torque up to which both strands of a loop stay taut, `2 r f0`, N·m; none without a pretension, or of an
    antagonistic pair.
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
    """An offset that moved evenly while it was looked at: a rope that creeps, or one that warms."""

    __slots__ = ()

    moved_rad: Gaussian
    """By how much from start to end, rad: averaged over whether it did."""
    probability: float
    """Probability that it did; of a long recording, in the stretch where that is likeliest."""
    rate_rad_per_s: Gaussian
    """How fast, rad/s: that over the recording's length."""

    _fields = {
        "moved_rad": "Gaussian",
        "probability": "",
        "rate_rad_per_s": "Gaussian",
    }


class TendonEstimate(Record):
    """One tendon since its baseline."""

    __slots__ = ()

    anchored: AnchoredOffset | None
    """What an end stop or a mark said, where one was touched."""
    changes: list[TendonChange]
    """Sudden changes within the recording."""
    creep: TendonCreep | None
    """How its offset moved while it was looked at; `None`: it was not seen to move."""
    elongation_m: Gaussian | None
    """Elongation, m; `None` without tendon geometry."""
    misfit_rad: float
    """What of that is more than sensors leave, rad: it is in the interval."""
    name: str
    """Joint."""
    noise_rad: float
    """What no parameter explains, robust standard deviation, rad."""
    offset_rad: Gaussian
    """Offset at the end of the recording, rad."""
    retension: RetensionLimit | None
    """The elongation at which the owner wants to tension again, where robot.toml says."""
    shared_error: SharedError | None
    """What of its error other sessions have too; `None` in files of programs that didn't say."""
    slack_rad: Gaussian | None
    """Half the dead zone of an antagonistic pair, rad."""
    slides: bool | None
    """Whether it slides: rad is then m, and N·m is N."""
    stiffness_change_ratio: Gaussian
    """Stiffness as the recording sees it over nominal, less one."""
    stiffness_since_before: StiffnessSinceBefore | None
    """Whether it has changed since what was known before the recording; `None`: not sought."""
    strain_ratio: Gaussian | None
    """Elongation over the tendon's length; `None` without tendon geometry."""
    torque_nm: TorqueRange
    """Least and greatest torque the joint carried, N·m."""
    verdict: Verdict
    """What that comes to."""

    _fields = {
        "anchored": "AnchoredOffset",
        "changes": "TendonChange",
        "creep": "TendonCreep",
        "elongation_m": "Gaussian",
        "misfit_rad": "",
        "name": "",
        "noise_rad": "",
        "offset_rad": "Gaussian",
        "retension": "RetensionLimit",
        "shared_error": "SharedError",
        "slack_rad": "Gaussian",
        "slides": "",
        "stiffness_change_ratio": "Gaussian",
        "stiffness_since_before": "StiffnessSinceBefore",
        "strain_ratio": "Gaussian",
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


class TopicInfo(Record):
    """A topic of a recording."""

    __slots__ = ()

    interfaces: list[str]
    """Interfaces its joints have (`control_msgs/msg/DynamicJointState`)."""
    kind: str
    """Type of its messages, such as `sensor_msgs/msg/JointState`."""
    messages: int
    """Messages read."""
    name: str
    """Its name."""
    rate_hz: float | None
    """Messages per second of the recorder's clock; `None` with fewer than two."""
    taken_for: TopicUse | None
    """What it is taken for; `None`: not used."""

    _fields = {
        "interfaces": "",
        "kind": "",
        "messages": "",
        "name": "",
        "rate_hz": "",
        "taken_for": "",
    }


class TorqueRange(Record):
    """Smallest and largest torque, N·m."""

    __slots__ = ()

    max: float
    """Largest."""
    min: float
    """Smallest."""

    _fields = {
        "max": "",
        "min": "",
    }


class TorqueStatistics(Record):
    """Torque over a recording, N·m."""

    __slots__ = ()

    max: float
    """Largest."""
    mean: float
    """Mean."""
    min: float
    """Smallest."""

    _fields = {
        "max": "",
        "mean": "",
        "min": "",
    }


class Touch(Record):
    """A contact."""

    __slots__ = ()

    duration_s: float
    """For, s."""
    force_n: list[float]
    """Force in the base frame, N."""
    link: str
    """On which link."""
    point_m: list[float]
    """Where on it, link frame, m."""
    start_s: float
    """From, s."""

    _fields = {
        "duration_s": "",
        "force_n": "",
        "link": "",
        "point_m": "",
        "start_s": "",
    }


class TrendEventJump(Record):
    """The offset grew suddenly."""

    __slots__ = ()

    confirmed_utc_s: float | None
    """Session that confirmed it, s since 1970."""
    probability: float | None
    """Posterior probability when it was confirmed."""
    sessions: int | None
    """Sessions that speak for it: one where it is beyond every error; 0 for a stated one."""
    size_rad: Gaussian | None
    """Change of the offset; `None` for a stated one."""
    stiffness_change_ratio: Gaussian | None
    """Change of the stiffness over it, as a fraction of nominal, where sessions state it."""
    time_utc_s: float | None
    """First session after it, or as stated, s since 1970."""
    cause: JumpCause
    """Why, as far as the stiffness tells."""
    kind: Literal["jump"]

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
    """The tendon was tensioned."""

    __slots__ = ()

    confirmed_utc_s: float | None
    """Session that confirmed it, s since 1970."""
    probability: float | None
    """Posterior probability when it was confirmed."""
    sessions: int | None
    """Sessions that speak for it: one where it is beyond every error; 0 for a stated one."""
    size_rad: Gaussian | None
    """Change of the offset; `None` for a stated one."""
    stiffness_change_ratio: Gaussian | None
    """Change of the stiffness over it, as a fraction of nominal, where sessions state it."""
    time_utc_s: float | None
    """First session after it, or as stated, s since 1970."""
    kind: Literal["tensioned"]
    stated: bool
    """Whether somebody said so; else the offset fell."""

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
    """How long such ropes last was stated, and says nothing of this one."""

    __slots__ = ()

    joint: str
    """Joint."""
    kind: Literal["life-not-used"]
    why: LifeNotUsed
    """Why."""

    _fields = {
        "joint": "",
        "kind": "",
        "why": "",
    }


class TrendNoteLongBefore(Record):
    """The first session comes so long after the tensioning that the date may be wrong."""

    __slots__ = ()

    days: float
    """Days without a session after it."""
    joint: str
    """Joint."""
    kind: Literal["long-before"]
    time_utc_s: float
    """Day stated, s since 1970."""

    _fields = {
        "days": "",
        "joint": "",
        "kind": "",
        "time_utc_s": "",
    }


class TrendNoteOtherBaseline(Record):
    """Another baseline, taken as a tensioning."""

    __slots__ = ()

    joint: str
    """Joint."""
    kind: Literal["other-baseline"]
    time_utc_s: float
    """First session with it, s since 1970."""

    _fields = {
        "joint": "",
        "kind": "",
        "time_utc_s": "",
    }


class TrendNoteOverlapping(Record):
    """Overlaps the session before it, left out."""

    __slots__ = ()

    kind: Literal["overlapping"]
    more: int
    """How many more."""
    source: str
    """File and place of the first."""

    _fields = {
        "kind": "",
        "more": "",
        "source": "",
    }


class TrendNoteRepeated(Record):
    """The same session again, counted once."""

    __slots__ = ()

    kind: Literal["repeated"]
    more: int
    """How many more."""
    source: str
    """File and place of the first."""

    _fields = {
        "kind": "",
        "more": "",
        "source": "",
    }


class TrendNoteTensioningNotStated(Record):
    """Nobody said when the tendon was tensioned: its clock begins with the first session."""

    __slots__ = ()

    joint: str
    """Joint."""
    kind: Literal["tensioning-not-stated"]

    _fields = {
        "joint": "",
        "kind": "",
    }


class TrendResult(Record):
    """The trend of a robot's tendons."""

    __slots__ = ()

    horizon_s: float
    """How far forecasts look, s from the last session."""
    joints: list[JointTrend]
    """One entry per joint with records."""
    needs_attention: bool
    """Whether a limit is passed or a sudden change was confirmed (exit code 3)."""
    notes: list[TrendNote]
    """What was dropped or assumed."""
    robot: str | None
    """Robot, where it is known."""
    schema: Literal["sinew/trend/1"]
    """Name and number of this schema."""
    sinew_version: str
    """Version of the program that made it."""

    _fields = {
        "horizon_s": "",
        "joints": "JointTrend",
        "needs_attention": "",
        "notes": "TrendNote",
        "robot": "",
        "schema": "",
        "sinew_version": "",
    }


class TrueTendon(Record):
    """A tendon that crosses several joints, or has a name of its own."""

    __slots__ = ()

    drive_ratio: float
    """Position in the tendon's coordinate over that at the motor's shaft."""
    joint: str
    """Joint that it is paired with, in whose rad its values are."""
    moment_arms: dict[str, float]
    """By how much the coordinate moves per rad of every joint that the tendon crosses."""
    motor: str
    """Its motor."""
    name: str
    """Its name."""

    _fields = {
        "drive_ratio": "",
        "joint": "",
        "moment_arms": "",
        "motor": "",
        "name": "",
    }


class UnitSlip(Record):
    """Another unit in which the value would be usual."""

    __slots__ = ()

    unit: str
    """The unit it looks as if it were in."""
    value: float
    """The value in the unit that is meant."""

    _fields = {
        "unit": "",
        "value": "",
    }


class UnusableBreaks(Record):
    """A tension that breaks the base rope."""

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
    """A gauge length that can't be."""

    __slots__ = ()

    kind: Literal["gauge-length"]
    length_m: float
    """Length found, m."""

    _fields = {
        "kind": "",
        "length_m": "",
    }


class UnusableNoGaugeLength(Record):
    """An elongation without the length it belongs to."""

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
    """No reading under load."""

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
    """No column of elongation or strain."""

    __slots__ = ()

    kind: Literal["no-strain"]

    _fields = {
        "kind": "",
    }


class UnusableNoTension(Record):
    """The rope law without tensions."""

    __slots__ = ()

    kind: Literal["no-tension"]

    _fields = {
        "kind": "",
    }


class UnusableNoTime(Record):
    """No column of times."""

    __slots__ = ()

    kind: Literal["no-time"]

    _fields = {
        "kind": "",
    }


class UnusableNothingToShift(Record):
    """No temperature, or neither modulus nor strain to shift."""

    __slots__ = ()

    kind: Literal["nothing-to-shift"]

    _fields = {
        "kind": "",
    }


class UnusableStrainTooLarge(Record):
    """A strain that no fibre, rope or plastic reaches."""

    __slots__ = ()

    kind: Literal["strain-too-large"]
    strain_ratio: float
    """Largest strain, m/m."""

    _fields = {
        "kind": "",
        "strain_ratio": "",
    }


class UnusableSwapped(Record):
    """The force creeps and the strain stays."""

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
    """A temperature outside the rope law's range."""

    __slots__ = ()

    kind: Literal["temperature"]
    temperature_c: float
    """Temperature, °C."""

    _fields = {
        "kind": "",
        "temperature_c": "",
    }


class UnusableTooFewReadings(Record):
    """Too few readings."""

    __slots__ = ()

    kind: Literal["too-few-readings"]
    needed: int
    """Readings needed."""
    readings: int
    """Readings there are."""

    _fields = {
        "kind": "",
        "needed": "",
        "readings": "",
    }


class WarningAnchorDisagrees(Record):
    """A push against an end stop shows another offset than motion does."""

    __slots__ = ()

    by_motion_rad: Gaussian
    """By motion, corrected for the encoders, rad."""
    by_push_rad: Gaussian
    """By the push, rad."""
    joint: str
    """Joint."""
    kind: Literal["anchor-disagrees"]

    _fields = {
        "by_motion_rad": "Gaussian",
        "by_push_rad": "Gaussian",
        "joint": "",
        "kind": "",
    }


class WarningBeyondPretension(Record):
    """A loop carried more than twice its pretension, so that one of its strands was slack and the loop half as
    stiff.
    """

    __slots__ = ()

    joint: str
    """Tendon."""
    kind: Literal["beyond-pretension"]
    limit_nm: float
    """Torque up to which both strands stay taut, `2 r f0`, N·m."""
    torque_nm: float
    """Largest size of the torque that the loop carried, N·m."""

    _fields = {
        "joint": "",
        "kind": "",
        "limit_nm": "",
        "torque_nm": "",
    }


class WarningChangeMayEnd(Record):
    """A change came so late that it may be a contact."""

    __slots__ = ()

    before_end_s: float
    """So long before the end, s."""
    joint: str
    """Joint."""
    kind: Literal["change-may-end"]
    time_s: float
    """When, s."""

    _fields = {
        "before_end_s": "",
        "joint": "",
        "kind": "",
        "time_s": "",
    }


class WarningDriftUnknown(Record):
    """The temperature differs from the baseline's, and what that does to an offset is most of its interval."""

    __slots__ = ()

    frame_is_stated: bool
    """Whether robot.toml states the frame's expansion."""
    half_width_95_rad: float
    """Half of the 95 % interval for that, rad."""
    joint: str
    """Joint of which it leaves most unknown."""
    kind: Literal["drift-unknown"]
    warmer_k: float
    """Warmer than the baseline, K."""

    _fields = {
        "frame_is_stated": "",
        "half_width_95_rad": "",
        "joint": "",
        "kind": "",
        "warmer_k": "",
    }


class WarningExternalForce(Record):
    """A constant force from outside acts on the arm."""

    __slots__ = ()

    force_n: list[Gaussian]
    """Along the axes of the base, N, if it does."""
    kind: Literal["external-force"]
    probability: float
    """Probability that it does."""

    _fields = {
        "force_n": "Gaussian",
        "kind": "",
        "probability": "",
    }


class WarningExternalForceContradicted(Record):
    """The recording contradicts the constant force that was stated; what it shows was used instead."""

    __slots__ = ()

    force_n: list[Gaussian] | None
    """Along the axes of the base, N; `None` where it shows no force."""
    kind: Literal["external-force-contradicted"]

    _fields = {
        "force_n": "Gaussian",
        "kind": "",
    }


class WarningFarFromPrior(Record):
    """A parameter is far from what was believed."""

    __slots__ = ()

    deviations: float
    """How far, standard deviations of what was believed."""
    is_motor_torque_scale: bool
    """Whether it is the scale of the motor torque, which is no matter of robot.toml alone."""
    joint: str | None
    """Joint or body; `None` for the payload."""
    kind: Literal["far-from-prior"]
    name: str
    """Parameter."""

    _fields = {
        "deviations": "",
        "is_motor_torque_scale": "",
        "joint": "",
        "kind": "",
        "name": "",
    }


class WarningFewPoses(Record):
    """Too few distinct poses to tell a payload or a wrong mass from stretch."""

    __slots__ = ()

    kind: Literal["few-poses"]
    poses: int
    """Distinct poses."""

    _fields = {
        "kind": "",
        "poses": "",
    }


class WarningFewPosesOfBaseline(Record):
    """Too few distinct poses for a baseline."""

    __slots__ = ()

    kind: Literal["few-poses-of-baseline"]
    poses: int
    """Distinct poses."""

    _fields = {
        "kind": "",
        "poses": "",
    }


class WarningFramesMissing(Record):
    """Frames without every position were left out."""

    __slots__ = ()

    frames: int
    """How many."""
    kind: Literal["frames-missing"]

    _fields = {
        "frames": "",
        "kind": "",
    }


class WarningMotorTorqueLeftOut(Record):
    """A joint's motor torque can't be one, and was left out."""

    __slots__ = ()

    fault: WitnessFault
    """Why."""
    joint: str
    """Joint."""
    kind: Literal["motor-torque-left-out"]

    _fields = {
        "fault": "WitnessFault",
        "joint": "",
        "kind": "",
    }


class WarningMuchLeftOut(Record):
    """Much of the time was left out."""

    __slots__ = ()

    kind: Literal["much-left-out"]
    share: float
    """Share, 0 to 1."""

    _fields = {
        "kind": "",
        "share": "",
    }


class WarningNegativePayload(Record):
    """The payload weighs less than nothing."""

    __slots__ = ()

    kind: Literal["negative-payload"]
    payload_kg: Gaussian
    """Payload, kg."""

    _fields = {
        "kind": "",
        "payload_kg": "Gaussian",
    }


class WarningNoBaseline(Record):
    """There is no baseline: offsets are against the encoders' zero."""

    __slots__ = ()

    kind: Literal["no-baseline"]

    _fields = {
        "kind": "",
    }


class WarningNoJointEncoder(Record):
    """The position of a joint is not recorded: its motor's stands in, and its tendon is not estimated."""

    __slots__ = ()

    joint: str
    """Joint."""
    kind: Literal["no-joint-encoder"]

    _fields = {
        "joint": "",
        "kind": "",
    }


class WarningNotZeroed(Record):
    """A baseline's encoders were not zeroed as robot.toml states; the zero was estimated instead."""

    __slots__ = ()

    joint: str
    """Joint."""
    kind: Literal["not-zeroed"]
    zero_rad: Gaussian
    """What `theta − q` of the unloaded spring reads right after tensioning, rad."""

    _fields = {
        "joint": "",
        "kind": "",
        "zero_rad": "Gaussian",
    }


class WarningNothingFits(Record):
    """A long time in which nothing fits."""

    __slots__ = ()

    from_s: float
    """From, s."""
    kind: Literal["nothing-fits"]
    to_s: float
    """To, s."""

    _fields = {
        "from_s": "",
        "kind": "",
        "to_s": "",
    }


class WarningPayloadContradicted(Record):
    """The recording contradicts the payload that was stated; it was estimated instead."""

    __slots__ = ()

    kind: Literal["payload-contradicted"]
    payload_kg: Gaussian
    """Payload as estimated, kg."""

    _fields = {
        "kind": "",
        "payload_kg": "Gaussian",
    }


class WarningRopeCreeps(Record):
    """A rope follows its load slowly, and what it carried before isn't known."""

    __slots__ = ()

    half_width_95_rad: float
    """Half of the 95 % interval for that, rad."""
    joint: str
    """Joint."""
    kind: Literal["rope-creeps"]

    _fields = {
        "half_width_95_rad": "",
        "joint": "",
        "kind": "",
    }


class WarningSidesOutOfStep(Record):
    """One side is stamped late against the other."""

    __slots__ = ()

    kind: Literal["sides-out-of-step"]
    motor_late_s: Gaussian
    """How late the motor side is, s; below 0 it is early."""

    _fields = {
        "kind": "",
        "motor_late_s": "Gaussian",
    }


class WarningStandReadsOff(Record):
    """A joint reads off where the arm stands at the end, by more than friction can hold: a slip, or a contact
    that lasts.
    """

    __slots__ = ()

    from_s: float
    """Since when the arm stands, s."""
    hidden_rad: float
    """The largest slip that friction may hold, rad."""
    joint: str
    """Joint."""
    kind: Literal["stand-reads-off"]
    off_rad: float
    """By how much it reads off, rad."""

    _fields = {
        "from_s": "",
        "hidden_rad": "",
        "joint": "",
        "kind": "",
        "off_rad": "",
    }


class WarningStandsAtEnd(Record):
    """The arm stands at the end of the recording: friction may hide a slip there."""

    __slots__ = ()

    from_s: float
    """Since when, s."""
    hidden_rad: float
    """The largest slip that friction may hold, rad."""
    joint: str
    """Joint of which it may hide most."""
    kind: Literal["stands-at-end"]

    _fields = {
        "from_s": "",
        "hidden_rad": "",
        "joint": "",
        "kind": "",
    }


class WarningStiffnessChangedBefore(Record):
    """Stiffness has, or may have, changed before the recording began."""

    __slots__ = ()

    change_ratio: Gaussian
    """By how much if it has."""
    joint: str
    """Joint."""
    kind: Literal["stiffness-changed-before"]
    probability: float
    """Probability that it has."""

    _fields = {
        "change_ratio": "Gaussian",
        "joint": "",
        "kind": "",
        "probability": "",
    }


class WarningStuck(Record):
    """A joint hardly moved while its motor turned."""

    __slots__ = ()

    joint: str
    """Joint."""
    joint_travel_rad: float
    """Travel of the joint, rad."""
    kind: Literal["stuck"]
    motor_travel_rad: float
    """Travel of the motor, rad."""

    _fields = {
        "joint": "",
        "joint_travel_rad": "",
        "kind": "",
        "motor_travel_rad": "",
    }


class WarningTemperatureUnknown(Record):
    """The temperature is not known as well as a recorded one."""

    __slots__ = ()

    deviation_k: float
    """Standard deviation of its change since the baseline, K."""
    half_width_95_rad: float
    """Half of the 95 % interval for that, rad."""
    joint: str
    """Joint whose interval that widens most."""
    kind: Literal["temperature-unknown"]

    _fields = {
        "deviation_k": "",
        "half_width_95_rad": "",
        "joint": "",
        "kind": "",
    }


class WarningTendonCreeps(Record):
    """An offset moved evenly while it was looked at."""

    __slots__ = ()

    duration_s: float
    """In how long, s."""
    joint: str
    """Joint."""
    kind: Literal["tendon-creeps"]
    moved_rad: Gaussian
    """By how much, rad."""
    probability: float
    """Probability that it did."""

    _fields = {
        "duration_s": "",
        "joint": "",
        "kind": "",
        "moved_rad": "Gaussian",
        "probability": "",
    }


class WarningTorqueHardlyChanged(Record):
    """A joint's torque hardly changed: stretch can't be told from a wrong stiffness."""

    __slots__ = ()

    joint: str
    """Joint."""
    kind: Literal["torque-hardly-changed"]
    torque_nm: TorqueRange
    """What it carried, N·m."""

    _fields = {
        "joint": "",
        "kind": "",
        "torque_nm": "TorqueRange",
    }


class WarningUnexplained(Record):
    """Much of the reading fits nothing."""

    __slots__ = ()

    joint: str
    """Joint."""
    kind: Literal["unexplained"]
    noise_rad: float
    """Robust standard deviation, rad."""

    _fields = {
        "joint": "",
        "kind": "",
        "noise_rad": "",
    }


class WitnessFaultContradicts(Record):
    """It doesn't follow the torque of the spring."""

    __slots__ = ()

    contradicts: WitnessFaultContradictsContradicts

    _fields = {
        "contradicts": "WitnessFaultContradictsContradicts",
    }


class WitnessFaultContradictsContradicts(Record):

    __slots__ = ()

    slope: float
    """What it shows of the spring's torque; 1 is right."""

    _fields = {
        "slope": "",
    }


class Wlf(Record):
    """`log a_T = −C₁ ΔT/(C₂ + ΔT)`."""

    __slots__ = ()

    c1: float
    """C₁."""
    c2_k: float
    """C₂, K."""
    misfit_decades: float
    """Root mean square misfit of log10 a_T, decades."""

    _fields = {
        "c1": "",
        "c2_k": "",
        "misfit_decades": "",
    }


AnchorKind = Literal["stop", "joint-mark", "motor-mark"]
BaselineSource = Union[BaselineSourceAssumed, BaselineSourceGiven]
BreakCause = Literal["creep-rupture", "bending-fatigue"]
Cause = Union[Literal["motor-encoder", "joint-encoder", "rope"], CauseUnknown]
Caution = Union[CautionBeyondData, CautionBreakingLoadGuessed, CautionCreepsApart, CautionEndsNotStated, CautionExtrapolated, CautionHighLoad, CautionHot, CautionLoadShare, CautionLowLoad, CautionReplace, CautionStartingGuesses, CautionTightBend, CautionWornOut]
Comparison = Literal["matched", "paper"]
ConditionSource = Literal["held", "stated"]
CreepError = Union[CreepErrorFlat, CreepErrorIncompleteRope, CreepErrorIsotherm, CreepErrorNoEntry, CreepErrorNoForecast, CreepErrorNoGroupColumn, CreepErrorNoPlan, CreepErrorNoRope, CreepErrorNotFinite, CreepErrorNothingAnalysed, CreepErrorOneTemperature, CreepErrorSpecimen, CreepErrorTooFew]
Ends = Literal["not-stated", "spliced", "knotted"]
EventKind = Literal["gap", "clock-jump", "late", "damage", "undecodable", "suspicion"]
Fault = Union[FaultClockGoesBack, FaultDoubtfulStrain, FaultDoubtfulTime, FaultGap, FaultLoadDrift, FaultNoForce, FaultNoRamp, FaultOutlier, FaultRepeatedStamps, FaultShortens, FaultSlip, FaultSlowRamp]
FindingKind = Literal["gap", "unknown-joint", "contradiction", "range", "distance", "arm-mass", "heavy-link", "light-link", "density", "inertia-size", "inertia-not-definite", "inertia-triangle", "frequency", "sag", "too-stiff", "stiffer-than-rope", "motor-inertia", "friction", "unknown-rope", "pretension", "holding-pull", "largest-pull", "pulley-diameter", "elongation-limit", "range-width", "range-reversed", "effort-limit", "negative-limit", "speed-limit", "gravity", "gravity-up"]
Format = Literal["mcap", "csv", "parquet", "db3", "arrays", "messages"]
GroupEquations = Literal["tendon", "joint"]
IntervalKind = Literal["draws", "profile", "bootstrap"]
JointMotion = Literal["revolute", "prismatic"]
JointRefusal = Union[Literal["rigid", "no-joint-position", "no-motor-position", "no-joint-torque", "no-motor-torque", "no-motor-inertia"], JointRefusalNoUsableFrame]
JumpCause = Literal["strand-failure", "slip", "unknown"]
Law = Literal["log-time", "findley", "burgers", "kelvin-voigt", "stretched", "line", "rope"]
LifeNotUsed = Literal["age-unknown", "strain-limit"]
LimitForecast = Union[LimitForecastReplace, LimitForecastRetension]
LimitState = Literal["passed", "not-passed", "cannot-tell"]
LoadQuantity = Literal["force", "stress"]
LossReason = Literal["settling", "joint-position", "joint-velocity", "motor-position", "torque", "external-torque", "range", "duplicate", "late", "undecodable", "without-time"]
Method = Literal["absolute", "paper"]
MissingFromRobot = Literal["tendon", "rope", "pretension"]
MotorTorque = Literal["unused", "measured", "from-current"]
NoEntry = Union[NoEntryNoRopeLaw, NoEntryNotARopeFit, NoEntrySeveralAmplitudes, NoEntrySeveralRopes]
NoForecast = Union[NoForecastLoad, NoForecastNoForce, NoForecastNoLoad, NoForecastNoTemperature, NoForecastTemperature]
NoSlope = Union[NoSlopeNotFitted, NoSlopeTooFewReadings]
NotIdentifiable = Union[NotIdentifiableAbove, NotIdentifiableAnything, NotIdentifiableBelow]
Origin = Literal["measured", "observed", "motor-torque", "stated", "taken-as-known", "estimated"]
PathUnit = Literal["m", "rad"]
Place = Literal["rope", "ends"]
PriorBasis = Union[PriorBasisRope, PriorBasisUnknown]
Quantity = Literal["q", "theta", "dq", "tau_el", "tau_m", "tau_ext", "temperature"]
Quantity2 = Literal["positions", "elastic-torque", "transmission", "external-torque", "offset"]
RecordingWarning = Union[RecordingWarningClockJumps, RecordingWarningDamaged, RecordingWarningGaps, RecordingWarningImplausibleOffset, RecordingWarningNonFinite, RecordingWarningOutOfOrder, RecordingWarningReference, RecordingWarningRobot, RecordingWarningSamplesLost, RecordingWarningSuspicion, RecordingWarningTorqueHardlyChanges, RecordingWarningUnknownJoints, RecordingWarningUnwrapped]
Rejection = Union[RejectionBendRatio, RejectionBendRatioNotKnown, RejectionBreakingLoadNotPublished, RejectionBreaks, RejectionDiameterNotPublished, RejectionElongation, RejectionHot, RejectionNotPredicted, RejectionSafetyFactor, RejectionStiffness, RejectionTooHeavy, RejectionTooThick, RejectionTooThin, RejectionWeightNotPublished]
RopeShowOrigin = Literal["measured", "published", "fitted", "starting-guess"]
ScatterSource = Literal["repeats", "other-ropes", "stated", "starting-guess"]
Severity = Literal["odd", "missing", "impossible"]
StrainZero = Union[StrainZeroAsRecorded, StrainZeroBeforeLoad]
StreamRole = Literal["both-sides", "joint-side", "motor-side", "external-torque"]
TemperatureSource = Literal["recorded", "stated", "unknown"]
TendonChangeKind = Literal["slip", "strand-failure", "slip-or-strand-failure", "stiffer", "retensioned", "softer-since-before", "stiffer-since-before"]
TendonForm = Literal["loop", "strand"]
Termination = Literal["linear", "gradient", "step", "cost", "no-progress", "step-limit", "failed"]
TestQuantity = Literal["time", "force", "stress", "elongation", "strain", "modulus", "temperature", "humidity", "area", "gauge-length"]
TopicUse = Literal["joint-side", "motor-side", "external-torque", "robot-description"]
TorqueSource = Literal["observer", "torque-sensor", "motor"]
TrendEvent = Union[TrendEventJump, TrendEventTensioned]
TrendLimitState = Literal["passed", "forecast", "not-before", "not-within-horizon", "too-few-sessions"]
TrendNote = Union[TrendNoteLifeNotUsed, TrendNoteLongBefore, TrendNoteOtherBaseline, TrendNoteOverlapping, TrendNoteRepeated, TrendNoteTensioningNotStated]
TrendVerdict = Literal["retension", "replace", "inspect", "replace-by-age", "watch", "wait", "no-limit"]
UnknownCause = Literal["missing", "noise", "rate", "both"]
Unusable = Union[UnusableBreaks, UnusableForceNeverPositive, UnusableGaugeLength, UnusableNoGaugeLength, UnusableNoLevel, UnusableNoReading, UnusableNoStage, UnusableNoStrain, UnusableNoTension, UnusableNoTime, UnusableNothingToShift, UnusableStrainTooLarge, UnusableSwapped, UnusableTemperature, UnusableTooFewReadings]
Verdict = Literal["longer", "shorter", "unchanged", "cannot-tell"]
Warning = Union[WarningAnchorDisagrees, WarningBeyondPretension, WarningChangeMayEnd, WarningDriftUnknown, WarningExternalForce, WarningExternalForceContradicted, WarningFarFromPrior, WarningFewPoses, WarningFewPosesOfBaseline, WarningFramesMissing, WarningMotorTorqueLeftOut, WarningMuchLeftOut, WarningNegativePayload, WarningNoBaseline, WarningNoJointEncoder, WarningNotZeroed, WarningNothingFits, WarningPayloadContradicted, WarningRopeCreeps, WarningSidesOutOfStep, WarningStandReadsOff, WarningStandsAtEnd, WarningStiffnessChangedBefore, WarningStuck, WarningTemperatureUnknown, WarningTendonCreeps, WarningTorqueHardlyChanged, WarningUnexplained]
WhyFixed = Literal["no-change-of-load", "fewer-than-three-loads", "fewer-than-five-loads", "one-load", "one-temperature", "fewer-than-three-temperatures", "too-little-flow", "no-retraction", "none-warm", "with-rate-of-flow"]
WitnessFault = Union[Literal["constant", "untested"], WitnessFaultContradicts]
Forecaster = Union[Literal["combined"], Law]

_CLASSES: Mapping[str, Any] = {
    "Ambiguity": Ambiguity,
    "Analysis": Analysis,
    "AnchorReading": AnchorReading,
    "AnchoredOffset": AnchoredOffset,
    "Arrhenius": Arrhenius,
    "At": At,
    "BaselineMergeResult": BaselineMergeResult,
    "BaselineResult": BaselineResult,
    "BaselineSourceAssumed": BaselineSourceAssumed,
    "BaselineSourceGiven": BaselineSourceGiven,
    "Basis": Basis,
    "Beyond": Beyond,
    "Bounded": Bounded,
    "Candidate": Candidate,
    "CatalogueValue": CatalogueValue,
    "CauseUnknown": CauseUnknown,
    "CautionBeyondData": CautionBeyondData,
    "CautionBreakingLoadGuessed": CautionBreakingLoadGuessed,
    "CautionCreepsApart": CautionCreepsApart,
    "CautionEndsNotStated": CautionEndsNotStated,
    "CautionExtrapolated": CautionExtrapolated,
    "CautionHighLoad": CautionHighLoad,
    "CautionHot": CautionHot,
    "CautionLoadShare": CautionLoadShare,
    "CautionLowLoad": CautionLowLoad,
    "CautionReplace": CautionReplace,
    "CautionStartingGuesses": CautionStartingGuesses,
    "CautionTightBend": CautionTightBend,
    "CautionWornOut": CautionWornOut,
    "Combination": Combination,
    "Conditions": Conditions,
    "ContactScore": ContactScore,
    "Coverage": Coverage,
    "CreepAnalysisResult": CreepAnalysisResult,
    "CreepAnalyzeReading": CreepAnalyzeReading,
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
    "CreepShiftResult": CreepShiftResult,
    "CreepWithheldResult": CreepWithheldResult,
    "CycleClock": CycleClock,
    "Damage": Damage,
    "Difference": Difference,
    "Doubt": Doubt,
    "DutySummary": DutySummary,
    "Ending": Ending,
    "Estimate": Estimate,
    "EstimateDocument": EstimateDocument,
    "EstimateEachResult": EstimateEachResult,
    "EstimateResult": EstimateResult,
    "Event": Event,
    "Expected": Expected,
    "Failure": Failure,
    "FaultClockGoesBack": FaultClockGoesBack,
    "FaultDoubtfulStrain": FaultDoubtfulStrain,
    "FaultDoubtfulTime": FaultDoubtfulTime,
    "FaultGap": FaultGap,
    "FaultLoadDrift": FaultLoadDrift,
    "FaultNoForce": FaultNoForce,
    "FaultNoRamp": FaultNoRamp,
    "FaultOutlier": FaultOutlier,
    "FaultRepeatedStamps": FaultRepeatedStamps,
    "FaultShortens": FaultShortens,
    "FaultSlip": FaultSlip,
    "FaultSlowRamp": FaultSlowRamp,
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
    "Holds": Holds,
    "Injection": Injection,
    "Interval95": Interval95,
    "Isochrone": Isochrone,
    "IsochronePoint": IsochronePoint,
    "JointCheck": JointCheck,
    "JointEstimate": JointEstimate,
    "JointInfo": JointInfo,
    "JointRefusalNoUsableFrame": JointRefusalNoUsableFrame,
    "JointScore": JointScore,
    "JointTrend": JointTrend,
    "Judged": Judged,
    "LeftAlone": LeftAlone,
    "LeftOut": LeftOut,
    "Life": Life,
    "LifeForecast": LifeForecast,
    "LimitForecastReplace": LimitForecastReplace,
    "LimitForecastRetension": LimitForecastRetension,
    "LiveCourse": LiveCourse,
    "LiveTendon": LiveTendon,
    "Load": Load,
    "Loss": Loss,
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
    "Parameter": Parameter,
    "PayloadChange": PayloadChange,
    "PerhapsNever": PerhapsNever,
    "Pose": Pose,
    "PosesResult": PosesResult,
    "PredictionResult": PredictionResult,
    "PretensionResult": PretensionResult,
    "PriorBasisRope": PriorBasisRope,
    "PriorBasisUnknown": PriorBasisUnknown,
    "Procedure": Procedure,
    "Published": Published,
    "PulleyPlace": PulleyPlace,
    "Rank": Rank,
    "Reading": Reading,
    "RecordingInfo": RecordingInfo,
    "RecordingInfoResult": RecordingInfoResult,
    "RecordingOutcome": RecordingOutcome,
    "RecordingWarningClockJumps": RecordingWarningClockJumps,
    "RecordingWarningDamaged": RecordingWarningDamaged,
    "RecordingWarningGaps": RecordingWarningGaps,
    "RecordingWarningImplausibleOffset": RecordingWarningImplausibleOffset,
    "RecordingWarningNonFinite": RecordingWarningNonFinite,
    "RecordingWarningOutOfOrder": RecordingWarningOutOfOrder,
    "RecordingWarningReference": RecordingWarningReference,
    "RecordingWarningRobot": RecordingWarningRobot,
    "RecordingWarningSamplesLost": RecordingWarningSamplesLost,
    "RecordingWarningSuspicion": RecordingWarningSuspicion,
    "RecordingWarningTorqueHardlyChanges": RecordingWarningTorqueHardlyChanges,
    "RecordingWarningUnknownJoints": RecordingWarningUnknownJoints,
    "RecordingWarningUnwrapped": RecordingWarningUnwrapped,
    "Recovery": Recovery,
    "Rejected": Rejected,
    "RejectionBendRatio": RejectionBendRatio,
    "RejectionBendRatioNotKnown": RejectionBendRatioNotKnown,
    "RejectionBreakingLoadNotPublished": RejectionBreakingLoadNotPublished,
    "RejectionBreaks": RejectionBreaks,
    "RejectionDiameterNotPublished": RejectionDiameterNotPublished,
    "RejectionElongation": RejectionElongation,
    "RejectionHot": RejectionHot,
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
    "RopeListResult": RopeListResult,
    "RopeResult": RopeResult,
    "RopeSummary": RopeSummary,
    "RoutingCheck": RoutingCheck,
    "Scatter": Scatter,
    "Schedule": Schedule,
    "Score": Score,
    "SegmentEstimate": SegmentEstimate,
    "SelectionResult": SelectionResult,
    "Series": Series,
    "SessionEstimate": SessionEstimate,
    "SessionPoint": SessionPoint,
    "Settings": Settings,
    "SharedError": SharedError,
    "Shift": Shift,
    "SignalCount": SignalCount,
    "SignalSource": SignalSource,
    "SimulateComparison": SimulateComparison,
    "SimulatedResult": SimulatedResult,
    "Source": Source,
    "SourceColumn": SourceColumn,
    "Span": Span,
    "Spot": Spot,
    "Step": Step,
    "StiffnessSinceBefore": StiffnessSinceBefore,
    "StrainZeroAsRecorded": StrainZeroAsRecorded,
    "StrainZeroBeforeLoad": StrainZeroBeforeLoad,
    "StreamTiming": StreamTiming,
    "Superposition": Superposition,
    "Suspicion": Suspicion,
    "TendonChange": TendonChange,
    "TendonCheck": TendonCheck,
    "TendonCreep": TendonCreep,
    "TendonEstimate": TendonEstimate,
    "TendonRouting": TendonRouting,
    "TopicInfo": TopicInfo,
    "TorqueRange": TorqueRange,
    "TorqueStatistics": TorqueStatistics,
    "Touch": Touch,
    "TrendEventJump": TrendEventJump,
    "TrendEventTensioned": TrendEventTensioned,
    "TrendNoteLifeNotUsed": TrendNoteLifeNotUsed,
    "TrendNoteLongBefore": TrendNoteLongBefore,
    "TrendNoteOtherBaseline": TrendNoteOtherBaseline,
    "TrendNoteOverlapping": TrendNoteOverlapping,
    "TrendNoteRepeated": TrendNoteRepeated,
    "TrendNoteTensioningNotStated": TrendNoteTensioningNotStated,
    "TrendResult": TrendResult,
    "TrueTendon": TrueTendon,
    "UnitSlip": UnitSlip,
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
    "WarningAnchorDisagrees": WarningAnchorDisagrees,
    "WarningBeyondPretension": WarningBeyondPretension,
    "WarningChangeMayEnd": WarningChangeMayEnd,
    "WarningDriftUnknown": WarningDriftUnknown,
    "WarningExternalForce": WarningExternalForce,
    "WarningExternalForceContradicted": WarningExternalForceContradicted,
    "WarningFarFromPrior": WarningFarFromPrior,
    "WarningFewPoses": WarningFewPoses,
    "WarningFewPosesOfBaseline": WarningFewPosesOfBaseline,
    "WarningFramesMissing": WarningFramesMissing,
    "WarningMotorTorqueLeftOut": WarningMotorTorqueLeftOut,
    "WarningMuchLeftOut": WarningMuchLeftOut,
    "WarningNegativePayload": WarningNegativePayload,
    "WarningNoBaseline": WarningNoBaseline,
    "WarningNoJointEncoder": WarningNoJointEncoder,
    "WarningNotZeroed": WarningNotZeroed,
    "WarningNothingFits": WarningNothingFits,
    "WarningPayloadContradicted": WarningPayloadContradicted,
    "WarningRopeCreeps": WarningRopeCreeps,
    "WarningSidesOutOfStep": WarningSidesOutOfStep,
    "WarningStandReadsOff": WarningStandReadsOff,
    "WarningStandsAtEnd": WarningStandsAtEnd,
    "WarningStiffnessChangedBefore": WarningStiffnessChangedBefore,
    "WarningStuck": WarningStuck,
    "WarningTemperatureUnknown": WarningTemperatureUnknown,
    "WarningTendonCreeps": WarningTendonCreeps,
    "WarningTorqueHardlyChanged": WarningTorqueHardlyChanged,
    "WarningUnexplained": WarningUnexplained,
    "WitnessFaultContradicts": WitnessFaultContradicts,
    "WitnessFaultContradictsContradicts": WitnessFaultContradictsContradicts,
    "Wlf": Wlf,
    "BaselineSource": {"given": BaselineSourceGiven, "assumed": BaselineSourceAssumed},
    "Cause": {"unknown": CauseUnknown},
    "Caution": {"low-load": CautionLowLoad, "high-load": CautionHighLoad, "hot": CautionHot, "breaking-load-guessed": CautionBreakingLoadGuessed, "extrapolated": CautionExtrapolated, "creeps-apart": CautionCreepsApart, "worn-out": CautionWornOut, "replace": CautionReplace, "tight-bend": CautionTightBend, "load-share": CautionLoadShare, "ends-not-stated": CautionEndsNotStated, "beyond-data": CautionBeyondData, "starting-guesses": CautionStartingGuesses},
    "CreepError": {"too-few": CreepErrorTooFew, "no-plan": CreepErrorNoPlan, "flat": CreepErrorFlat, "not-finite": CreepErrorNotFinite, "specimen": CreepErrorSpecimen, "nothing-analysed": CreepErrorNothingAnalysed, "no-group-column": CreepErrorNoGroupColumn, "no-rope": CreepErrorNoRope, "incomplete-rope": CreepErrorIncompleteRope, "no-entry": CreepErrorNoEntry, "no-forecast": CreepErrorNoForecast, "isotherm": CreepErrorIsotherm, "one-temperature": CreepErrorOneTemperature},
    "Fault": {"slip": FaultSlip, "outlier": FaultOutlier, "load-drift": FaultLoadDrift, "no-force": FaultNoForce, "no-ramp": FaultNoRamp, "slow-ramp": FaultSlowRamp, "repeated-stamps": FaultRepeatedStamps, "clock-goes-back": FaultClockGoesBack, "gap": FaultGap, "doubtful-strain": FaultDoubtfulStrain, "shortens": FaultShortens, "doubtful-time": FaultDoubtfulTime},
    "JointRefusal": {"no-usable-frame": JointRefusalNoUsableFrame},
    "LimitForecast": {"retension": LimitForecastRetension, "replace": LimitForecastReplace},
    "NoEntry": {"several-amplitudes": NoEntrySeveralAmplitudes, "several-ropes": NoEntrySeveralRopes, "no-rope-law": NoEntryNoRopeLaw, "not-a-rope-fit": NoEntryNotARopeFit},
    "NoForecast": {"no-load": NoForecastNoLoad, "no-force": NoForecastNoForce, "no-temperature": NoForecastNoTemperature, "load": NoForecastLoad, "temperature": NoForecastTemperature},
    "NoSlope": {"too-few-readings": NoSlopeTooFewReadings, "not-fitted": NoSlopeNotFitted},
    "NotIdentifiable": {"anything": NotIdentifiableAnything, "below": NotIdentifiableBelow, "above": NotIdentifiableAbove},
    "PriorBasis": {"unknown": PriorBasisUnknown, "rope": PriorBasisRope},
    "RecordingWarning": {"robot": RecordingWarningRobot, "suspicion": RecordingWarningSuspicion, "unknown-joints": RecordingWarningUnknownJoints, "implausible-offset": RecordingWarningImplausibleOffset, "torque-hardly-changes": RecordingWarningTorqueHardlyChanges, "damaged": RecordingWarningDamaged, "gaps": RecordingWarningGaps, "clock-jumps": RecordingWarningClockJumps, "out-of-order": RecordingWarningOutOfOrder, "samples-lost": RecordingWarningSamplesLost, "non-finite": RecordingWarningNonFinite, "unwrapped": RecordingWarningUnwrapped, "reference": RecordingWarningReference},
    "Rejection": {"too-thick": RejectionTooThick, "too-thin": RejectionTooThin, "too-heavy": RejectionTooHeavy, "bend-ratio": RejectionBendRatio, "safety-factor": RejectionSafetyFactor, "elongation": RejectionElongation, "stiffness": RejectionStiffness, "diameter-not-published": RejectionDiameterNotPublished, "weight-not-published": RejectionWeightNotPublished, "bend-ratio-not-known": RejectionBendRatioNotKnown, "breaking-load-not-published": RejectionBreakingLoadNotPublished, "breaks": RejectionBreaks, "hot": RejectionHot, "not-predicted": RejectionNotPredicted},
    "StrainZero": {"before-load": StrainZeroBeforeLoad, "as-recorded": StrainZeroAsRecorded},
    "TrendEvent": {"jump": TrendEventJump, "tensioned": TrendEventTensioned},
    "TrendNote": {"repeated": TrendNoteRepeated, "overlapping": TrendNoteOverlapping, "tensioning-not-stated": TrendNoteTensioningNotStated, "life-not-used": TrendNoteLifeNotUsed, "long-before": TrendNoteLongBefore, "other-baseline": TrendNoteOtherBaseline},
    "Unusable": {"no-time": UnusableNoTime, "no-strain": UnusableNoStrain, "no-gauge-length": UnusableNoGaugeLength, "gauge-length": UnusableGaugeLength, "too-few-readings": UnusableTooFewReadings, "strain-too-large": UnusableStrainTooLarge, "force-never-positive": UnusableForceNeverPositive, "no-level": UnusableNoLevel, "swapped": UnusableSwapped, "no-stage": UnusableNoStage, "no-reading": UnusableNoReading, "no-tension": UnusableNoTension, "breaks": UnusableBreaks, "temperature": UnusableTemperature, "nothing-to-shift": UnusableNothingToShift},
    "Warning": {"few-poses": WarningFewPoses, "few-poses-of-baseline": WarningFewPosesOfBaseline, "torque-hardly-changed": WarningTorqueHardlyChanged, "change-may-end": WarningChangeMayEnd, "stands-at-end": WarningStandsAtEnd, "stand-reads-off": WarningStandReadsOff, "rope-creeps": WarningRopeCreeps, "tendon-creeps": WarningTendonCreeps, "external-force": WarningExternalForce, "unexplained": WarningUnexplained, "no-joint-encoder": WarningNoJointEncoder, "beyond-pretension": WarningBeyondPretension, "stuck": WarningStuck, "negative-payload": WarningNegativePayload, "payload-contradicted": WarningPayloadContradicted, "external-force-contradicted": WarningExternalForceContradicted, "nothing-fits": WarningNothingFits, "much-left-out": WarningMuchLeftOut, "not-zeroed": WarningNotZeroed, "no-baseline": WarningNoBaseline, "temperature-unknown": WarningTemperatureUnknown, "drift-unknown": WarningDriftUnknown, "anchor-disagrees": WarningAnchorDisagrees, "sides-out-of-step": WarningSidesOutOfStep, "motor-torque-left-out": WarningMotorTorqueLeftOut, "far-from-prior": WarningFarFromPrior, "frames-missing": WarningFramesMissing, "stiffness-changed-before": WarningStiffnessChangedBefore},
    "WitnessFault": {"contradicts": WitnessFaultContradicts},
}
Record._classes = _CLASSES
