// Live strip charts of a tendon: theta − q and the offset of the last minute, at 10 Hz.
import { Fragment, h } from "preact";
import { useEffect, useRef, useState } from "preact/hooks";
import { plusMinus, rounded, time } from "./format.js";
import { followSeries, reopen } from "./live.js";
import { axis, clipped, css, labelled, plotIn, range, shade } from "./plot.js";
import { notValid } from "./robot.jsx";
import { Window } from "./window.js";

const HEIGHT = 150, WIDTH_S = 60;
// Time without a sample after which the series counts as outdated, and after which a first one is missing, ms.
const MAX_AGE_MS = 2000, MAX_WAIT_MS = 5000;

// Spans in which the offset is not valid.
const blindSpans = window => clipped(u => {
  const { ctx, bbox } = u;
  ctx.fillStyle = shade("stale", 28);
  for (const [from, to] of window.notValid()) {
    const [left, right] = [from, to].map(x => u.valToPos(x, "x", true));
    ctx.fillRect(left, bbox.top, Math.max(right - left, 1), bbox.height);
  }
});

function charts(element, window) {
  const x = { padding: [8, 12, 0, 0], scales: { x: { time: false, range: [-WIDTH_S, 0] }, y: { range } }, cursor: { show: false } };
  const stroke = name => () => css(name);
  const [above, below] = element.children;
  const both = [
    plotIn(above, HEIGHT, {
      ...x, axes: [axis({ show: false }), labelled("θ − q (mrad)")],
      series: [{}, { stroke: stroke("blue"), width: 1.5, points: { show: false } }],
    }, window.difference()),
    plotIn(below, HEIGHT + 40, {
      ...x, axes: [labelled("Time before now (s)", { size: 34, values: (u, ticks) => ticks.map(t => String(Math.abs(t))) }), labelled("Offset (mrad)")],
      series: [{}, { stroke: stroke("orange"), width: 2, points: { show: false } },
        { width: 0, points: { show: false } }, { width: 0, points: { show: false } }],
      bands: [{ series: [2, 3], fill: () => shade("orange", 22) }],
      hooks: { drawAxes: [blindSpans(window)] },
    }, window.offset()),
  ];
  return {
    draw() { both[0].plot.setData(window.difference()); both[1].plot.setData(window.offset()); },
    end() { for (const { end } of both) end(); },
  };
}

// `tendon`: present state of the tendon; `isSilent`: whether the robot sends no data.
export function Strip({ robot, joint, tendon, isSilent }) {
  const [paused, setPaused] = useState(false);
  const [now, setNow] = useState({ last: null, at_ms: Date.now() });
  const frame = useRef(null), window = useRef(new Window(WIDTH_S)), drawn = useRef(null);
  useEffect(() => {
    if (paused) return;
    let received_ms = null;
    setNow({ last: null, at_ms: Date.now() });
    window.current = new Window(WIDTH_S);
    drawn.current?.end();
    drawn.current = charts(frame.current, window.current);
    const leave = followSeries(robot, joint, samples => {
      received_ms = Date.now();
      window.current.add(samples);
      drawn.current.draw();
    });
    // The text changes slowly enough to be read.
    const timer = setInterval(() => setNow(({ at_ms }) => ({ last: window.current.last, at_ms: received_ms ?? at_ms })), 500);
    return () => { leave(); clearInterval(timer); };
  }, [robot, joint, paused]);
  useEffect(() => () => drawn.current?.end(), []);
  const { last, at_ms } = now;
  const age_ms = Date.now() - at_ms;
  const validity = notValid(tendon);
  const offset = last?.offset_rad ? `offset ${plusMinus(last.offset_rad, 1e3)} mrad (95 %)` : "no offset";
  const readout = last && `θ − q ${rounded(1e3 * last.motor_minus_joint_rad, 3)} mrad, ${offset}`;
  return (
    <figure class="strip">
      {!last && !paused && isSilent && <p>No data; the charts start when the robot sends data.</p>}
      {!last && !isSilent && age_ms < MAX_WAIT_MS && <p class="loading" role="status">Loading live series …</p>}
      {!last && !isSilent && age_ms >= MAX_WAIT_MS && (
        <p class="error" role="alert">No samples received within {MAX_WAIT_MS / 1000} s <button onClick={() => { setNow({ last: null, at_ms: Date.now() }); reopen(); }}>Retry</button></p>
      )}
      {last && !paused && age_ms > MAX_AGE_MS && (
        <p class="banner alarm" role="status"><strong>Stale: no samples since {time(at_ms / 1000)}.</strong></p>
      )}
      <div ref={frame} class={last ? "" : "hidden"} role="img" aria-label={`${joint}, last minute: motor minus joint position, and offset with its 95 % interval. ${readout ?? ""}`}>
        <div /><div />
      </div>
      <figcaption>
        {readout && <p class="readout">{readout}{paused ? ", paused" : validity ? <>. <strong>{validity}</strong></> : ", valid"}</p>}
        <p class="keys" aria-hidden="true">
          <span><i class="stroke" />θ − q, mean of 0.1 s</span><span><i class="fan" />Offset, 95 % interval</span><span><i class="blind" />Not valid</span>
        </p>
        <button onClick={() => setPaused(!paused)}>{paused ? "Continue live charts" : "Pause live charts"}</button>
      </figcaption>
    </figure>
  );
}
