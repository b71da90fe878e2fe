// Samples of a live series over the last seconds, as columns of a chart.

// Time between two samples above which the curve is interrupted, s: five samples.
const GAP_S = 0.5;

const mrad = rad => 1e3 * rad;

export class Window {
  #width_s; #samples = [];

  constructor(width_s) { this.#width_s = width_s; }

  get last() { return this.#samples.at(-1) ?? null; }

  add(samples) {
    // The clock of a monitor that was started again begins anew.
    if (samples.length && this.last && samples[0].time_s < this.last.time_s) this.#samples = [];
    this.#samples.push(...samples);
    const from_s = (this.last?.time_s ?? 0) - this.#width_s;
    this.#samples.splice(0, this.#samples.findIndex(({ time_s }) => time_s >= from_s));
  }

  // Times relative to the last sample, then one column for each of `of`; null between samples that are a gap apart.
  #columns(of) {
    const columns = [[], ...of.map(() => [])];
    let before_s = Infinity;
    for (const sample of this.#samples) {
      const x = sample.time_s - this.last.time_s;
      if (x - before_s > GAP_S) [x - GAP_S / 2, ...of.map(() => null)].forEach((value, i) => columns[i].push(value));
      [x, ...of.map(value => value(sample))].forEach((value, i) => columns[i].push(value));
      before_s = x;
    }
    return columns;
  }

  difference() { return this.#columns([sample => mrad(sample.motor_minus_joint_rad)]); }

  // Offset, and the ends of its 95 % interval.
  offset() {
    return this.#columns([0, 1.96, -1.96].map(z => ({ offset_rad: x }) => x && mrad(x.mean + z * x.std)));
  }

  // Spans in which the offset is not valid, s relative to the last sample.
  notValid() {
    const spans = [];
    for (const { time_s, valid } of this.#samples) {
      if (valid) continue;
      const x = time_s - this.last.time_s, span = spans.at(-1);
      if (span && x - span[1] < GAP_S) span[1] = x;
      else spans.push([x - 0.1, x]);
    }
    return spans;
  }
}
