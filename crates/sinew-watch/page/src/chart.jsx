// Chart of records over time, with events, limit and prediction interval of the forecast.
import { h } from "preact";
import { useEffect, useMemo, useRef, useState } from "preact/hooks";
import { day, dayAndTime, plusMinus, rounded } from "./format.js";
import { axis, clipped, css, keyTo, labelled, line, plotIn, pointAt, shade } from "./plot.js";

const HEIGHT = 340;

// Columns of uPlot: time, record, then median and bounds of the forecast.
function columns(records, trend) {
  const forecast = trend?.forecast ?? [];
  const times = [...records.map(r => r.time_utc_s), ...forecast.map(p => p.time_utc_s)];
  const none = forecast.map(() => null), before = records.map(() => null);
  const mrad = value => value === null ? null : 1e3 * value;
  return [
    times,
    [...records.map(r => mrad(r.offset_rad)), ...none],
    [...before, ...forecast.map(p => 1e3 * p.offset_rad)],
    [...before, ...forecast.map(p => 1e3 * p.interval_95_rad.high)],
    [...before, ...forecast.map(p => 1e3 * p.interval_95_rad.low)],
  ];
}

// Initial time range: until the upper bound of the limit exceedance, at most as long as the past.
function horizon(records, trend) {
  const forecast = trend?.forecast ?? [];
  if (!forecast.length) return null;
  const last = forecast[0].time_utc_s, end = forecast.at(-1).time_utc_s;
  const past = last - records[0].time_utc_s, high = limitOf(trend)?.after_high_s;
  const ahead = Math.max(14 * 86400, 0.35 * past, high ? Math.min(1.2 * high, past) : 0);
  return [records[0].time_utc_s, Math.min(last + ahead, end)];
}

// Limit that is drawn: the first one with a forecast.
const limitOf = trend => trend?.limits.find(limit => limit.kind === "retension") ?? trend?.limits[0];

function describe(series, trend, joint) {
  const conclusive = series.points.filter(r => r.offset_rad !== null);
  if (conclusive.length === 0) return `${joint}: ${series.records} records, all inconclusive`;
  const [first, last] = [conclusive[0], conclusive.at(-1)];
  const at = r => `${plusMinus({ mean: r.offset_rad, std: r.offset_std_rad }, 1e3)} mrad on ${day(r.time_utc_s)}`;
  const limit = limitOf(trend);
  const stepChanges = trend?.events.filter(event => event.kind === "step-change").length ?? 0;
  return `${joint}: ${series.records - series.inconclusive} records from ${at(first)} to ${at(last)}.` +
    (stepChanges ? ` ${stepChanges} step change${stepChanges > 1 ? "s" : ""}.` : "") +
    (limit ? ` Limit ${rounded(1e3 * limit.limit_rad, 3)} mrad.` : "");
}

// `series`: points of the records; `isPast`: whether the time range ends before the last record, so that there is no forecast;
// `zoom`, `reset`: called for a selected time range, and to show everything.
export function Chart({ series, trend: whole, isPast, joint, zoom, reset }) {
  const records = series.points;
  const trend = useMemo(() => isPast && whole ? { ...whole, forecast: [] } : whole, [whole, isPast]);
  const frame = useRef(null), plot = useRef(null);
  const [held, setAt] = useState(null);
  const data = columns(records, trend);
  // The selected point may have disappeared with the forecast.
  const at = held !== null && held < data[0].length ? held : null;

  useEffect(() => {
    const half = records.map(r => r.offset_rad === null ? null : 1.96e3 * r.offset_std_rad);
    const limit = limitOf(trend), events = trend?.events ?? [];
    const metre = trend?.elongation_m && trend.offset_rad.mean ? trend.elongation_m.mean / trend.offset_rad.mean : null;
    const px = devicePixelRatio;
    const under = clipped(u => {
      const { ctx, bbox } = u;
      ctx.lineWidth = px;
      // 95 % interval of each record.
      ctx.strokeStyle = css("sky");
      records.forEach((record, i) => {
        if (half[i] === null) return;
        const x = u.valToPos(record.time_utc_s, "x", true);
        const y = value => u.valToPos(value, "y", true);
        line(u, x, y(1e3 * record.offset_rad - half[i]), x, y(1e3 * record.offset_rad + half[i]));
      });
      ctx.font = `${12 * px}px sans-serif`;
      ctx.textBaseline = "top";
      events.forEach((event, i) => {
        const x = u.valToPos(event.time_utc_s, "x", true);
        if (x < bbox.left || x > bbox.left + bbox.width) return;
        const isStep = event.kind === "step-change";
        ctx.strokeStyle = ctx.fillStyle = css(isStep ? "alarm" : "good");
        ctx.setLineDash(isStep ? [] : [4 * px, 3 * px]);
        line(u, x, bbox.top, x, bbox.top + bbox.height);
        const words = isStep ? "▲ step change" : "re-tensioned", wide = ctx.measureText(words).width + 6 * px;
        ctx.textAlign = x + wide > bbox.left + bbox.width ? "right" : "left";
        ctx.fillText(words, x + (ctx.textAlign === "left" ? 4 : -4) * px, bbox.top + (4 + 15 * (i % 3)) * px);
      });
      if (limit) {
        const y = u.valToPos(1e3 * limit.limit_rad, "y", true);
        ctx.strokeStyle = ctx.fillStyle = css("watch");
        ctx.setLineDash([8 * px, 4 * px]);
        ctx.lineWidth = 1.5 * px;
        line(u, bbox.left, y, bbox.left + bbox.width, y);
        ctx.textAlign = "left";
        ctx.textBaseline = "bottom";
        const words = limit.kind === "retension" ? `Re-tension: ${rounded(1e3 * limit.elongation_m, 3)} mm` : `Replace: ${rounded(100 * limit.strain_ratio, 3)} % strain`;
        ctx.fillText(words, bbox.left + 6 * px, y - 2 * px);
      }
      // Last record: the forecast is to the right.
      if (trend?.forecast.length) {
        const x = u.valToPos(trend.forecast[0].time_utc_s, "x", true);
        ctx.strokeStyle = css("reference");
        ctx.setLineDash([2 * px, 3 * px]);
        line(u, x, bbox.top, x, bbox.top + bbox.height);
      }
    });
    const conclusive = records.filter(r => r.offset_rad !== null);
    const low = Math.min(0, ...conclusive.map(r => 1e3 * r.offset_rad));
    const limit_mrad = limit ? 1e3 * limit.limit_rad : 0;
    const shown = horizon(records, trend);
    const ahead = (trend?.forecast ?? []).filter(p => p.time_utc_s <= shown[1]).map(p => 1e3 * p.offset_rad);
    const highest = Math.max(...conclusive.map(r => 1e3 * r.offset_rad + 1.96e3 * r.offset_std_rad), 1.1 * limit_mrad, ...ahead, 1);
    const options = {
      cursor: { y: false, focus: { prox: 30 } },
      scales: { x: { time: true }, y: { range: [low - 0.05 * (highest - low), highest + 0.08 * (highest - low)] } },
      series: [
        {},
        { label: "record", stroke: () => css("blue"), width: 0, points: { show: true, size: 5, fill: () => css("blue"), stroke: () => css("blue") } },
        { label: "forecast", stroke: () => css("orange"), width: 1.5, dash: [6, 3], points: { show: false } },
        { label: "97.5 %", width: 0, points: { show: false } },
        { label: "2.5 %", width: 0, points: { show: false } },
      ],
      bands: [{ series: [3, 4], fill: () => shade("orange", 22) }],
      axes: [
        axis(),
        labelled("Offset (mrad)"),
        ...(metre ? [labelled("Elongation (mm)", { side: 1, scale: "y", grid: { show: false },
          values: (u, ticks) => ticks.map(tick => rounded(tick * metre, 2)) })] : []),
      ],
      // Only for mouse events: the hook is also called without a selection when the chart is created or resized.
      hooks: {
        drawAxes: [under],
        setSelect: [u => { if (u.select.width > 0) zoom(u.posToVal(u.select.left, "x"), u.posToVal(u.select.left + u.select.width, "x")); }],
        setCursor: [u => { if (u.cursor.event) setAt(u.cursor.idx ?? null); }],
      },
    };
    const { plot: drawn, end } = plotIn(frame.current, HEIGHT, options, data);
    plot.current = drawn;
    if (shown) plot.current.setScale("x", { min: shown[0] - 0.02 * (shown[1] - shown[0]), max: shown[1] });
    drawn.over.addEventListener("dblclick", reset);
    return end;
  }, [series, trend]);

  const key = event => {
    const to = keyTo(event, at ?? records.length - 1, data[0].length);
    if (to !== undefined) pointAt(plot.current, data[0][to], () => setAt(to));
  };
  let readout = "Point at the curve or use the arrow keys to read values. Drag to zoom, double-click to reset.";
  if (at !== null && at < records.length) {
    const r = records[at];
    const value = r.offset_rad === null ? "inconclusive" : `${plusMinus({ mean: r.offset_rad, std: r.offset_std_rad }, 1e3)} mrad`;
    const more = r.elongation_m === null ? "" : `, ${plusMinus({ mean: r.elongation_m, std: r.elongation_std_m }, 1e3)} mm`;
    readout = `${dayAndTime(r.time_utc_s)}: ${value}${more}`;
  } else if (at !== null) {
    const p = trend.forecast[at - records.length];
    readout = `${day(p.time_utc_s)}, forecast: ${rounded(1e3 * p.offset_rad, 3)} mrad; 95 %: ${rounded(1e3 * p.interval_95_rad.low, 3)} to ${rounded(1e3 * p.interval_95_rad.high, 3)} mrad`;
  }
  return (
    <figure class="chart">
      <div ref={frame} role="slider" tabindex="0" aria-label={describe(series, trend, joint)} aria-valuemin="0"
        aria-valuemax={data[0].length - 1} aria-valuenow={at ?? 0} aria-valuetext={readout} onKeyDown={key} />
      <figcaption>
        <p class="readout">{readout}</p>
        <p class="keys" aria-hidden="true">
          <span><i class="dot" />Session, 95 % CI</span>
          {trend?.forecast.length > 0 && <span><i class="fan" />Forecast, 95 % prediction interval</span>}
        </p>
      </figcaption>
    </figure>
  );
}
