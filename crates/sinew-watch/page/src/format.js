// Numbers, times and spans as Sinew's reports show them (crates/sinew-files/src/number.rs).

const MAX_DECIMALS = 4;

function decimals(size, digits) {
  if (!Number.isFinite(size) || size === 0) return 2;
  return Math.min(Math.max(digits - 1 - Math.floor(Math.log10(Math.abs(size))), 0), MAX_DECIMALS);
}

function fixed(value, places) {
  if (!Number.isFinite(value)) return "–";
  const text = value.toFixed(places);
  return /^-?[0.]+$/.test(text) ? text.replace("-", "") : text.replace("-", "−");
}

export const rounded = (value, digits) => fixed(value, decimals(value, digits));

// `10.02 ± 0.26` for a standard deviation of 0.13: the half-width of the 95 % interval.
export function plusMinus(gaussian, factor = 1) {
  if (!gaussian) return "–";
  const mean = factor * gaussian.mean, half = 1.96 * factor * gaussian.std;
  if (!(half > 0)) return rounded(mean, 3);
  const places = decimals(half, 2);
  return `${fixed(mean, places)} ± ${fixed(half, places)}`;
}

// Probability in whole per cent, never 0 or 100.
export function chance(probability) {
  const percent = Math.round(100 * probability);
  if (!Number.isFinite(percent)) return "–";
  return percent > 99 ? "> 99 %" : percent < 1 ? "< 1 %" : `${percent} %`;
}

const local = options => new Intl.DateTimeFormat(undefined, options);
const DAY = local({ year: "numeric", month: "short", day: "numeric" });
const DAY_AND_TIME = local({ year: "numeric", month: "short", day: "numeric", hour: "2-digit", minute: "2-digit" });
const TIME = local({ hour: "2-digit", minute: "2-digit", second: "2-digit" });

const shown = form => utc_s => Number.isFinite(utc_s) ? form.format(new Date(1000 * utc_s)) : "–";
export const day = shown(DAY);
export const dayAndTime = shown(DAY_AND_TIME);
export const time = shown(TIME);
export const utc = utc_s => new Date(1000 * utc_s).toISOString().slice(0, 19).replace("T", " ") + " UTC";

// Duration with a suitable unit.
export function span(s) {
  if (!Number.isFinite(s)) return "–";
  const units = [["day", 86400], ["h", 3600], ["min", 60], ["s", 1]];
  const [name, size] = units.find(([, size]) => s >= 2 * size) ?? units.at(-1);
  const count = Math.floor(s / size);
  return name === "day" ? `${count} days` : `${count} ${name}`;
}

export const count = n => String(n).replace(/\B(?=(\d{3})+$)/g, "\u202f");

// Temperature of a robot, with its largest contribution to the interval of an offset.
export function temperature({ temperature_c, tendons }) {
  const now = temperature_c === null ? "not recorded" : `${rounded(temperature_c, 3)} °C`;
  const unknown_rad = tendon => tendon.unknown_temperature_rad ?? 0;
  const most = tendons.reduce((most, tendon) => unknown_rad(tendon) > unknown_rad(most) ? tendon : most, {});
  if (!unknown_rad(most)) return now;
  const then = temperature_c === null ? "" : "; not recorded at tensioning";
  const half = rounded(1.96e3 * unknown_rad(most), 2);
  return `${now}${then}; contributes ± ${half} mrad to the interval at ${most.joint}. A change beyond the tolerance in robot.toml biases the offset`;
}
