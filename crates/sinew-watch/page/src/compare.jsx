// Offsets or elongations of several tendons over years in one chart, with annotations.
import { Fragment, h } from "preact";
import { useEffect, useMemo, useRef, useState } from "preact/hooks";
import uPlot from "uplot";
import { Missing, Outdated, useAnswer } from "./answer.jsx";
import { get } from "./api.js";
import { count, day, dayAndTime, plusMinus, utc } from "./format.js";
import { MARKED, MARKS, marksOf } from "./marks.js";
import { axis, clipped, css, keyTo, labelled, line, plotIn, pointAt, shade } from "./plot.js";

const HEIGHT = 380;
const DAY_S = 86400;
const RANGES = [["week", "Week", 7], ["month", "Month", 31], ["year", "Year", 366], ["all", "All", null]];
const QUANTITIES = {
  offset: { name: "Offset", unit: "mrad", of: point => [point.offset_rad, point.offset_std_rad] },
  elongation: { name: "Elongation", unit: "mm", of: point => [point.elongation_m, point.elongation_std_m] },
};
// Colour and dashes of a curve, so that colour is never the only distinction.
const STYLES = [["blue", []], ["orange", [8, 4]], ["green", [2, 3]], ["purple", [10, 3, 2, 3]], ["ink", [4, 2]], ["amber", [12, 4]], ["grey", [1, 2]], ["sky", [6, 2, 2, 2]]];
// Number of tendons in the list above which it is searched, and of annotations of one kind and robot.
const MAX_LISTED = 60, MAX_ENTRIES = 1000;
// Interval in which the chart is loaded again, s.
const EVERY_S = 3600;

// Selection in the address, which can be sent to others.
function selectionOf(search) {
  const query = new URLSearchParams(search);
  const range = RANGES.find(([key]) => key === query.get("range"))?.[0] ?? "all";
  return { tendons: [...new Set(query.getAll("tendon"))].filter(tendon => tendon.includes("/")).slice(0, STYLES.length), range, quantity: QUANTITIES[query.get("in")] ? query.get("in") : "offset" };
}

const split = tendon => { const at = tendon.indexOf("/"); return [tendon.slice(0, at), tendon.slice(at + 1)]; };
const named = tendon => split(tendon).join(", ");

// Tendons that are selected at first: those nearest to their limits.
function urgent(robots) {
  const next = robots.filter(row => row.next).sort((a, b) => b.next.share - a.next.share);
  return next.slice(0, 4).map(row => `${row.robot}/${row.next.joint}`);
}

// Series of the tendons and journal entries of their robots.
async function load(tendons, from_utc_s) {
  const series = tendons.map(tendon => {
    const [robot, joint] = split(tendon);
    return get(["robots", robot, "tendons", joint, "series"], { from_utc_s });
  });
  const robots = [...new Set(tendons.map(tendon => split(tendon)[0]))];
  const entries = robots.flatMap(robot => MARKED.map(event => get(["journal"], { robot, event, most: MAX_ENTRIES })));
  const [all, journals] = await Promise.all([Promise.all(series), Promise.all(entries)]);
  // Where a journal is longer than what is loaded, its older annotations are missing.
  const cut = journals.filter(({ entries }) => entries.length === MAX_ENTRIES).map(({ entries }) => entries.at(-1).time_utc_s);
  return { tendons, series: all, entries: journals.flatMap(({ entries }) => entries), complete_from_utc_s: Math.max(...cut, -Infinity) };
}

// Columns of uPlot: time, then value and ends of the 95 % interval of every tendon.
function columns(series, quantity) {
  const tables = series.map(({ points }) => {
    const values = points.map(point => QUANTITIES[quantity].of(point));
    const column = z => values.map(([x, std]) => x === null ? null : 1e3 * (x + z * std));
    return [points.map(point => point.time_utc_s), column(0), column(1.96), column(-1.96)];
  });
  return uPlot.join(tables);
}

function drawMarks(marks) {
  const px = devicePixelRatio;
  return clipped(u => {
    const { ctx, bbox } = u;
    ctx.font = `bold ${11 * px}px sans-serif`;
    ctx.textAlign = "center";
    ctx.textBaseline = "top";
    ctx.lineWidth = px;
    marks.forEach(({ kind, of, time_utc_s }, i) => {
      const x = u.valToPos(time_utc_s, "x", true), y = bbox.top + (3 + 13 * (i % 3)) * px;
      if (x < bbox.left || x > bbox.left + bbox.width) return;
      ctx.strokeStyle = ctx.fillStyle = css(STYLES[of][0]);
      ctx.setLineDash([2 * px, 4 * px]);
      line(u, x, y + 12 * px, x, bbox.top + bbox.height);
      ctx.fillText(MARKS[kind].letter, x, y);
    });
    ctx.setLineDash([]);
  });
}

function Chart({ loaded, quantity, marks }) {
  const { tendons, series } = loaded;
  const data = useMemo(() => columns(series, quantity), [series, quantity]);
  const frame = useRef(null), plot = useRef(null);
  const [held, setAt] = useState(null);
  const at = held !== null && held < data[0].length ? held : null;
  const { name, unit } = QUANTITIES[quantity];
  useEffect(() => {
    const curves = tendons.flatMap((tendon, i) => {
      const [colour, dash] = STYLES[i], bound = () => ({ width: 0, points: { show: false } });
      return [{ label: tendon, stroke: () => css(colour), width: 1.8, dash, points: { show: series[i].points.length < 60, size: 4, fill: () => css(colour) } }, bound(), bound()];
    });
    const { plot: drawn, end } = plotIn(frame.current, HEIGHT, {
      cursor: { y: false, focus: { prox: 30 } },
      scales: { x: { time: true } },
      axes: [axis(), labelled(`${name} (${unit})`)],
      series: [{}, ...curves],
      bands: tendons.map((_, i) => ({ series: [3 * i + 2, 3 * i + 3], fill: () => shade(STYLES[i][0], 16) })),
      hooks: { drawAxes: [drawMarks(marks)], setCursor: [u => { if (u.cursor.event) setAt(u.cursor.idx ?? null); }] },
    }, data);
    plot.current = drawn;
    return end;
  }, [data, marks]);
  const key = event => {
    const to = keyTo(event, at ?? data[0].length - 1, data[0].length);
    if (to !== undefined) pointAt(plot.current, data[0][to], () => setAt(to));
  };
  // Last value of a tendon up to the selected time.
  const valueOf = i => {
    const before = series[i].points.filter(point => at === null || point.time_utc_s <= data[0][at]);
    const [mean, std] = before.length ? QUANTITIES[quantity].of(before.at(-1)) : [null, null];
    return mean === null ? "–" : `${plusMinus({ mean, std }, 1e3)} ${unit}`;
  };
  const time_utc_s = data[0][at ?? data[0].length - 1];
  const readout = `${dayAndTime(time_utc_s)}: ${tendons.map((tendon, i) => `${named(tendon)} ${valueOf(i)}`).join("; ")}`;
  return (
    <>
      <figure class="chart">
        <div ref={frame} role="slider" tabindex="0" aria-valuemin="0" aria-valuemax={data[0].length - 1} aria-valuenow={at ?? data[0].length - 1}
          aria-valuetext={readout} onKeyDown={key}
          aria-label={`${name} of ${tendons.length} tendons from ${day(data[0][0])} to ${day(data[0].at(-1))}, with ${marks.length} annotations`} />
        <figcaption>
          <p class="keys">
            <span>Line: estimate; band: 95 % interval</span>
            {Object.entries(MARKS).map(([kind, { letter, name }]) => <span key={kind}><b>{letter}</b> {name}</span>)}
          </p>
        </figcaption>
      </figure>
      <table class="legend">
        <caption>{at === null ? "Last values" : dayAndTime(time_utc_s)}; point at the chart or use the arrow keys</caption>
        <tbody>
          {tendons.map((tendon, i) => (
            <tr key={tendon}>
              <th scope="row"><Swatch of={i} /><a href={`/r/${split(tendon).map(encodeURIComponent).join("/")}`}>{named(tendon)}</a></th>
              <td>{valueOf(i)}</td>
            </tr>
          ))}
        </tbody>
      </table>
    </>
  );
}

// Line of a curve.
function Swatch({ of }) {
  const [colour, dash] = STYLES[of];
  return <svg class="swatch" viewBox="0 0 26 8" aria-hidden="true"><path d="M0 4H26" style={`stroke: var(--${colour})`} stroke-dasharray={dash.join(" ")} /></svg>;
}

// All tendons with checkboxes; of many, the selected ones and those that are searched.
function Choice({ all, chosen, choose }) {
  const [search, setSearch] = useState("");
  const words = search.toLowerCase().split(/\s+/).filter(Boolean);
  const matches = all.filter(tendon => !chosen.includes(tendon) && words.every(word => named(tendon).toLowerCase().includes(word)));
  const first = matches.slice(0, MAX_LISTED);
  // In a constant order, so that the focus stays where it is; an address may name tendons that are not monitored any more.
  const listed = [...chosen.filter(tendon => !all.includes(tendon)), ...all.filter(tendon => chosen.includes(tendon) || first.includes(tendon))];
  const isFull = chosen.length === STYLES.length;
  return (
    <fieldset class="choice">
      <legend>Tendons ({chosen.length} of at most {STYLES.length} selected)</legend>
      {all.length > MAX_LISTED && <label class="search">Find <input type="search" value={search} placeholder="robot, joint" onInput={event => setSearch(event.target.value)} /></label>}
      <div class="options">
        {listed.map(tendon => {
          const isOn = chosen.includes(tendon);
          return (
            <label key={tendon}><input type="checkbox" checked={isOn} disabled={!isOn && isFull}
              onChange={() => choose(isOn ? chosen.filter(one => one !== tendon) : [...chosen, tendon])} /> {isOn && <Swatch of={chosen.indexOf(tendon)} />}{named(tendon)}</label>
          );
        })}
      </div>
      {matches.length > MAX_LISTED && <p>{count(matches.length - MAX_LISTED)} more; enter part of a name</p>}
    </fieldset>
  );
}

function Marks({ marks, tendons }) {
  if (marks.length === 0) return <p>No annotations in this time range</p>;
  return (
    <details>
      <summary>{marks.length === 1 ? "1 annotation" : `${count(marks.length)} annotations`}</summary>
      <ul class="events">
        {marks.slice().reverse().map(({ id, kind, of, time_utc_s, text }) => (
          <li key={id}><time title={utc(time_utc_s)}>{day(time_utc_s)}</time> <b>{MARKS[kind].letter}</b> {named(tendons[of])}: {text}</li>
        ))}
      </ul>
    </details>
  );
}

export function Compare({ live }) {
  const [selection, set] = useState(() => selectionOf(location.search));
  const robots = [...live.robots.values()];
  const { range, quantity } = selection;
  // Selected at first, and not changed by new values.
  const first = useRef([]);
  if (first.current.length === 0) first.current = urgent(robots);
  const tendons = selection.tendons.length === 0 && !selection.isEmpty ? first.current : selection.tendons;
  const change = more => {
    const next = { ...selection, tendons, ...more };
    next.isEmpty = next.tendons.length === 0;
    const query = new URLSearchParams([...next.tendons.map(tendon => ["tendon", tendon]), ["range", next.range], ["in", next.quantity]]);
    history.replaceState(null, "", `${location.pathname}?${query}`);
    set(next);
  };
  const now_utc_s = EVERY_S * Math.floor((live.fleet?.time_utc_s ?? 0) / EVERY_S);
  const days = RANGES.find(([key]) => key === range)[2];
  const key = JSON.stringify([tendons, range]);
  const answer = useAnswer(key, now_utc_s, () => live.fleet ? load(tendons, days && now_utc_s - DAY_S * days) : Promise.resolve(null));
  // Until another selection is loaded, the present one remains.
  const shown = useRef(null);
  if (answer.value) shown.current = answer.value;
  const loaded = tendons.length ? shown.current : null;
  const marks = useMemo(() => {
    if (!loaded) return [];
    const times = loaded.series.flatMap(({ points }) => points.map(point => point.time_utc_s));
    const from_utc_s = times.reduce((least, t) => Math.min(least, t), Infinity);
    return marksOf(loaded.entries, loaded.tendons).filter(mark => mark.time_utc_s >= from_utc_s);
  }, [loaded]);
  if (!live.fleet) return <p class="loading">Connecting to monitor …</p>;
  const all = robots.flatMap(row => row.tendons.map(tendon => `${row.robot}/${tendon.joint}`)).sort((a, b) => a.localeCompare(b, undefined, { numeric: true }));
  const isCut = loaded?.series.some(({ points }) => points[0]?.time_utc_s < loaded.complete_from_utc_s);
  const isEmpty = loaded?.series.every(({ points }) => points.every(point => QUANTITIES[quantity].of(point)[0] === null));
  return (
    <>
      <p class="crumbs"><a href="/">Robots</a> ›</p>
      <h1 tabindex="-1">Compare tendons</h1>
      <div class="ranges" role="group" aria-label="time range">
        {RANGES.map(([key, name]) => <button key={key} aria-pressed={range === key} onClick={() => change({ range: key })}>{name}</button>)}
        <label>Quantity <select value={quantity} onChange={event => change({ quantity: event.target.value })}>
          {Object.entries(QUANTITIES).map(([key, { name, unit }]) => <option key={key} value={key}>{name} ({unit})</option>)}
        </select></label>
      </div>
      {loaded && <Outdated answer={answer} />}
      {loaded && !answer.value && !answer.error && <p role="status">Loading selection …</p>}
      {loaded && !answer.value && answer.error && <Missing answer={answer} what="records" />}
      {all.length === 0 ? <p>No robot monitored</p> : tendons.length === 0 ? <p>Select at least one tendon.</p>
        : !loaded ? <Missing answer={answer} what="records" />
          : isEmpty ? <p>No records of the selected tendons in this time range</p>
            : <Chart loaded={loaded} quantity={quantity} marks={marks} />}
      {isCut && <p>Annotations before {day(loaded.complete_from_utc_s)} may be missing: more than {count(MAX_ENTRIES)} journal entries</p>}
      {loaded && !isEmpty && <Marks marks={marks} tendons={loaded.tendons} />}
      <Choice all={all} chosen={tendons} choose={tendons => change({ tendons })} />
    </>
  );
}
