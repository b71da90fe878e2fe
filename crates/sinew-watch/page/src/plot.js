// What all charts share: colours of the page, axes, size and colour scheme.
import uPlot from "uplot";

export const css = name => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
export const shade = (name, percent) => `color-mix(in srgb, ${css(name)} ${percent}%, transparent)`;

// Axis with a grid; `more` overrides.
export const axis = more => ({
  stroke: () => css("muted"), grid: { stroke: () => css("grid"), width: 1 }, ticks: { stroke: () => css("axis"), width: 1 },
  font: "12px sans-serif", labelFont: "12px sans-serif", ...more,
});
export const labelled = (label, more) => axis({ label, size: 52, labelSize: 18, ...more });

// Range of an axis with a margin; without values around zero, so that the axis remains.
export const range = (u, low, high) => low === null ? [-1, 1] : uPlot.rangeNum(low, high, 0.1, true);

// Line in the pixels of the canvas.
export function line(u, x0, y0, x1, y1) {
  u.ctx.beginPath();
  u.ctx.moveTo(x0, y0);
  u.ctx.lineTo(x1, y1);
  u.ctx.stroke();
}

// Draws within the plotting area.
export const clipped = draw => u => {
  const { ctx, bbox } = u;
  ctx.save();
  ctx.beginPath();
  ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
  ctx.clip();
  draw(u);
  ctx.restore();
};

// Plot as wide as `element`, drawn again when its size or the colour scheme changes; `end` removes it.
export function plotIn(element, height, options, data) {
  const plot = new uPlot({ ...options, width: element.clientWidth, height, legend: { show: false } }, data, element);
  const fit = new ResizeObserver(() => plot.setSize({ width: element.clientWidth, height }));
  fit.observe(element);
  const dark = matchMedia("(prefers-color-scheme: dark)"), redraw = () => plot.redraw(false);
  dark.addEventListener("change", redraw);
  const end = () => { fit.disconnect(); dark.removeEventListener("change", redraw); plot.destroy(); };
  return { plot, end };
}

// Index of the point that a key leads to from `now`, of `count` points; undefined: not a key of the chart.
export function keyTo(event, now, count) {
  const far = event.shiftKey ? 10 : 1;
  const to = { ArrowRight: now + far, ArrowLeft: now - far, Home: 0, End: count - 1 }[event.key];
  if (to === undefined) return undefined;
  event.preventDefault();
  return Math.min(Math.max(to, 0), count - 1);
}

// Moves the cursor to a time. Points outside the visible range are scrolled into it, because a cursor outside would clear the
// selection; `then` is called once the scales are applied.
export function pointAt(u, x, then) {
  const { min, max } = u.scales.x;
  if (x < min || x > max) {
    const from = Math.min(min, x), to = Math.max(max, x), spare = 0.02 * (to - from);
    u.setScale("x", { min: from - spare, max: to + spare });
  }
  queueMicrotask(() => {
    u.setCursor({ left: u.valToPos(x, "x"), top: 0 });
    then();
  });
}
