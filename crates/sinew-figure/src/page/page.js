// Interaction of the figures with mouse, touch and keyboard: values, zoom, hiding by the legend.
// The script reads the drawn curves; the page is complete without it.
"use strict";
(() => {
  // Zoom limits; beyond them, the resolution of 0.1 px would become visible.
  const MAX_ZOOM_X = 40, MAX_ZOOM_Y = 20;
  const numbers = text => text.trim().split(/\s+/).map(Number);
  const clamp = (v, low, high) => Math.min(Math.max(v, low), high);
  const minus = text => text.replace("-", "−");

  const set = (element, attributes) => {
    for (const key in attributes) element.setAttribute(key, attributes[key]);
    return element;
  };
  const element = (parent, name, attributes) =>
    parent.appendChild(set(document.createElementNS(parent.namespaceURI, name), attributes));
  const html = (name, properties) => Object.assign(document.createElement(name), properties);
  // Sections of a path as lists of points.
  function sections(d) {
    const all = [];
    let x = 0, y = 0;
    for (const [, letter, rest] of d.matchAll(/([MlV])([^MlVhZ]*)/g)) {
      const [a, b] = numbers(rest);
      if (letter === "M") all.push([]);
      [x, y] = letter === "M" ? [a, b] : letter === "l" ? [x + a, y + b] : [x, a];
      all[all.length - 1].push([x, y]);
    }
    return all;
  }
  // Vertical position of a section at the horizontal position x.
  function crossings(points, x) {
    const found = [];
    for (let i = 0; i < points.length; i++) {
      const [ax, ay] = points[Math.max(i - 1, 0)], [bx, by] = points[i];
      if (x < Math.min(ax, bx) - 1e-6 || x > Math.max(ax, bx) + 1e-6) continue;
      if (Math.abs(bx - ax) < 1e-6) found.push(ay, by);
      else found.push(ay + (by - ay) * (x - ax) / (bx - ax));
    }
    return found;
  }
  // Number with the digits that the drawing resolves.
  function shown(value, resolution) {
    const digits = Math.max(0, Math.floor(-Math.log10(resolution)));
    if (digits > 6 || Math.abs(value) >= 1e6) return minus(value.toPrecision(3));
    const text = value.toFixed(digits);
    return minus(Number(text) === 0 ? text.replace("-", "") : text);
  }
  const UNITS = [[31557600, "year"], [2629800, "month"], [86400, "day"], [3600, "h"], [60, "min"], [1, "s"]];
  function durationText(seconds) {
    const [unit, name] = UNITS.find(u => seconds >= 0.999 * u[0]) ?? UNITS[5];
    const count = Number((seconds / unit).toPrecision(3));
    return `${count} ${name}${count !== 1 && ["year", "month", "day"].includes(name) ? "s" : ""}`;
  }
  // "offset (mrad)" is a quantity with a unit.
  function split(label) {
    const [, name, unit] = label.match(/^(.*?)\s*\(([^()]*)\)$/) ?? [null, label, ""];
    return { name, unit: unit && ` ${unit}` };
  }
  function ticks(low, high, count) {
    const rough = (high - low) / count, power = 10 ** Math.floor(Math.log10(rough));
    const step = power * ([1, 2, 2.5, 5].find(m => rough / power <= m * (1 + 1e-9)) ?? 10);
    const all = [];
    for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; i++) all.push(i * step);
    return { all, step };
  }
  function tickText(step, exponent) {
    const unit = 10 ** exponent;
    let digits = 0;
    while (digits < 12 && Math.abs(step / unit * 10 ** digits - Math.round(step / unit * 10 ** digits)) > 1e-6) digits++;
    return value => minus((Math.abs(value) < 1e-9 * step ? 0 : value / unit).toFixed(digits));
  }
  // Common durations on a logarithmic axis.
  function timeTicks(low, high, px) {
    const [from, to] = [10 ** low, 10 ** high], taken = [];
    const whole = [1, 2, 3, 5, 10, 15, 20, 30, 45].flatMap(n => UNITS.map(([s]) => n * s));
    const even = ticks(from, to, 5).all;
    const inside = [...whole, ...even].filter(s => s >= from * (1 - 1e-9) && s <= to * (1 + 1e-9) && s > 0);
    for (const s of inside) {
      const at = Math.log10(s);
      if (taken.every(other => Math.abs(other - at) / (high - low) * px > 64)) taken.push(at);
    }
    return { all: taken, text: at => durationText(10 ** at) };
  }

  class Panel {
    constructor(group, figure) {
      const data = group.dataset, part = name => group.querySelector(name);
      [this.left, this.top, this.w, this.h] = numbers(data.box);
      [this.x, this.y, this.xLabel, this.yLabel] = [numbers(data.x), numbers(data.y), data.xLabel ?? "", split(data.yLabel ?? "")];
      Object.assign(this, { figure, settings: data, plot: part("svg"), data: part(".data"), axes: part(".axes") });
      // Labels of annotations, which keep their distance from their target.
      this.words = [...this.plot.querySelectorAll(":scope > text")].map(text =>
        ({ text, x: +text.getAttribute("x"), y: +text.getAttribute("y"), atX: text.dataset.x, atY: text.dataset.y }));
      const [sx, sy] = this.adopt(part("use"));
      this.series = [...this.data.querySelectorAll("g[data-name]")].map(g => {
        const of = selector => [...g.querySelectorAll(selector)].flatMap(p => sections(p.getAttribute("d")))
          .map(shape => shape.map(([x, y]) => [sx * x, sy * y]));
        return {
          g, path: g.querySelector("path"), kind: g.getAttribute("class"), name: g.dataset.name, hidden: false,
          labels: g.dataset.labels?.split("|"), shapes: of("path:not(.bars)"), bars: of(".bars"),
        };
      });
      this.keys = [...group.querySelectorAll(".key")];
      for (const key of this.keys) this.makeKey(key);
      this.cross = element(this.plot, "g", { class: "cross", "pointer-events": "none" });
      this.picked = element(this.plot, "rect", { class: "picked", y: 0, height: this.h, width: 0 });
      const { left: x, top: y, w: width, h: height } = this;
      this.hit = element(figure.svg, "rect", { class: "hit", x, y, width, height, fill: "transparent" });
      [this.view, this.heights] = [[0, width], [0, height]];
    }
    // Replaces a reference to the curves of another figure by a copy of them; returns their scale.
    adopt(use) {
      if (!use) return [1, 1];
      const transform = use.getAttribute("transform");
      const copy = document.querySelector(use.getAttribute("href")).cloneNode(true);
      copy.removeAttribute("id");
      use.replaceWith(set(copy, { transform }));
      return numbers(transform.slice("scale(".length, -1));
    }
    makeKey(key) {
      const series = this.series[key.dataset.series];
      set(key, { role: "button", tabindex: 0, "aria-pressed": true });
      const toggle = event => {
        if (event.type === "keydown" && !["Enter", " "].includes(event.key)) return;
        event.preventDefault();
        series.hidden = !series.hidden;
        series.g.style.display = series.hidden ? "none" : "";
        key.setAttribute("aria-pressed", !series.hidden);
        this.fit();
        this.draw();
      };
      key.addEventListener("click", toggle);
      key.addEventListener("keydown", toggle);
    }
    get visible() { return this.series.filter(s => !s.hidden); }
    screenX(x) { return (x - this.view[0]) / (this.view[1] - this.view[0]) * this.w; }
    screenY(y) { return (y - this.heights[0]) / (this.heights[1] - this.heights[0]) * this.h; }
    valueX(x) { return this.x[0] + x / this.w * (this.x[1] - this.x[0]); }
    valueY(y) { return this.y[0] + (1 - y / this.h) * (this.y[1] - this.y[0]); }
    // Vertical range of the visible data.
    fit() {
      this.heights = [0, this.h];
      const [from, to] = this.view, whole = from <= 0 && to >= this.w;
      if (this.settings.rows || whole && !this.series.some(s => s.hidden)) return;
      const seen = [];
      for (const s of this.visible)
        for (const shape of [...s.shapes, ...s.bars]) {
          for (const [x, y] of shape) if (x >= from && x <= to) seen.push(y);
          seen.push(...crossings(shape, from), ...crossings(shape, to));
        }
      if (!seen.length) return;
      const [low, high] = [Math.min, Math.max].map(of => clamp(seen.reduce((a, b) => of(a, b)), 0, this.h));
      const half = Math.max(0.56 * (high - low), 0.5 * this.h / MAX_ZOOM_Y), middle = 0.5 * (low + high);
      this.heights = [middle - half, middle + half];
    }
    draw() {
      const [a, b] = this.view, [c, d] = this.heights, [sx, sy] = [this.w / (b - a), this.h / (d - c)];
      const whole = a === 0 && b === this.w && c === 0 && d === this.h;
      if (whole) this.data.removeAttribute("transform");
      else this.data.setAttribute("transform", `matrix(${sx} 0 0 ${sy} ${-a * sx} ${-c * sy})`);
      for (const { text, x, y, atX, atY } of this.words) {
        const [px, py] = [Number(atX), Number(atY)];
        set(text, { x: atX ? this.screenX(px) + x - px : x, y: atY ? this.screenY(py) + y - py : y });
        text.style.display = atX && (px < a || px > b) || atY && (py < c || py > d) ? "none" : "";
      }
      this.zoomed?.remove();
      this.axes.style.display = whole ? "" : "none";
      if (!whole) this.drawAxes();
    }
    drawAxes() {
      const { left, top, w, h, settings } = this, bottom = top + h, right = left + w;
      const group = this.zoomed = this.axes.cloneNode(true);
      group.style.display = "";
      this.axes.after(group);
      const [grid, marks] = group.querySelectorAll("path"), words = group.querySelector("g");
      const old = [...words.querySelectorAll("text")], size = old[0]?.getAttribute("font-size") ?? 12;
      const put = (x, y, anchor, text) =>
        element(words, "text", { x, y, "font-size": size, "text-anchor": anchor }).append(text);
      let [lines, short] = ["", `M${left} ${top}V${bottom}H${right}`];
      const [low, high] = this.view.map(x => this.valueX(x));
      const even = ticks(low, high, clamp(w / 80, 2, 9));
      const xs = settings.log ? timeTicks(low, high, w) : { ...even, text: tickText(even.step, settings.xExponent ?? 0) };
      const named = settings.rows ? old.filter(text => text.getAttribute("text-anchor") === "end") : [];
      for (const text of old) if (!named.includes(text)) text.remove();
      for (const value of xs.all) {
        const at = left + (value - low) / (high - low) * w;
        lines += `M${at} ${top}V${bottom}`;
        short += `M${at} ${bottom}v4`;
        if (this.xLabel) put(at, bottom + 6 + 0.8 * size, "middle", xs.text(value));
      }
      for (const text of named) lines += `M${left} ${text.getAttribute("y") - 0.36 * size}H${right}`;
      const sides = [[1, settings.yExponent, false]];
      if (settings.right) sides.push([Number(settings.right), settings.rightExponent, true]);
      for (const [factor, exponent, far] of named.length ? [] : sides) {
        const ends = [this.valueY(this.heights[1]) * factor, this.valueY(this.heights[0]) * factor];
        const { all, step } = ticks(Math.min(...ends), Math.max(...ends), clamp(h / 30, 2, 7));
        const text = tickText(step, exponent ?? 0);
        for (const value of all) {
          const at = bottom - (value - ends[0]) / (ends[1] - ends[0]) * h;
          if (far) short += `M${right} ${at}h4`;
          else { lines += `M${left} ${at}H${right}`; short += `M${left} ${at}h-4`; }
          put(far ? right + 7 : left - 7, at + 0.36 * size, far ? "start" : "end", text(value));
        }
      }
      if (settings.right) short += `M${right} ${top}V${bottom}`;
      set(grid, { d: lines });
      set(marks, { d: short });
    }
    // Values of the series at a position: [name, text, colour, y].
    readings(x) {
      const unit = this.yLabel.unit, step = (this.y[1] - this.y[0]) / (10 * this.h), right = this.settings.right;
      const far = right && split(this.settings.rightLabel);
      const number = y => shown(this.valueY(y), step);
      const other = y => right ? ` (${shown(this.valueY(y) * right, Math.abs(step * right))}${far.unit})` : "";
      const all = [];
      // Dots on a named curve, and a line through named dots, are not repeated.
      const known = kind => this.series.some(s => s.name && s.kind === kind);
      for (const s of this.visible) {
        if (!s.name && known(s.kind === "points" ? "line" : "points")) continue;
        const colour = getComputedStyle(s.path ?? s.g)[s.kind === "band" ? "fill" : "stroke"];
        const name = s.name || (s.kind === "band" ? "" : this.yLabel.name);
        if (s.kind === "points") {
          const near = s.shapes.map(([[px, py]], i) => ({ px, py, i })).filter(p => Math.abs(p.px - x) < 0.06);
          for (const { py, i } of near) {
            const bar = s.bars.length === s.shapes.length && s.bars[i].map(p => p[1]);
            const interval = bar ? ` (${number(Math.max(...bar))} to ${number(Math.min(...bar))})` : "";
            const label = s.labels?.[i] || name;
            all.push([label, this.settings.rows ? "" : number(py) + interval + unit, colour, py]);
          }
          continue;
        }
        const found = s.shapes.flatMap(shape => crossings(shape, x));
        if (!found.length || !name || this.settings.rows) continue;
        const [low, high] = [Math.max(...found), Math.min(...found)];
        if (s.kind === "band") all.push([name, `${number(low)} to ${number(high)}${unit}`, colour, null]);
        else all.push([name, number(found.at(-1)) + unit + other(found.at(-1)), colour, found.at(-1)]);
      }
      return all;
    }
    place(x) {
      const value = this.valueX(x), { log, since } = this.settings;
      if (log) return durationText(10 ** value);
      const label = split(this.figure.labelBelow(this));
      const text = shown(value, (this.x[1] - this.x[0]) / (10 * this.w));
      const date = since && new Date(1000 * (Number(since) + 86400 * value)).toISOString().slice(0, 10);
      if (since) return `${date}, ${label.name} ${text}`;
      return label.unit ? text + label.unit : `${label.name} ${text}`.trim();
    }
  }
  // Stacked panels with a common horizontal axis move together.
  class Stack {
    constructor(panels, figure) {
      Object.assign(this, { panels, figure, at: null });
      const [first] = panels;
      const all = panels.flatMap(p => p.series).flatMap(s => s.shapes).flat().map(p => Math.round(10 * p[0]) / 10);
      this.places = [...new Set(all)].filter(x => x >= 0 && x <= first.w).sort((a, b) => a - b);
      const labels = [first.yLabel.name, figure.labelBelow(first)].filter(Boolean);
      set(first.hit, {
        role: "slider", tabindex: 0, "aria-label": `values of ${labels.join(" over ")}`,
        "aria-valuemin": 0, "aria-valuemax": Math.max(this.places.length - 1, 0), "aria-valuenow": 0,
      });
      first.hit.addEventListener("keydown", event => this.key(event));
      first.hit.addEventListener("blur", () => this.point(null));
      for (const panel of panels) this.listen(panel);
    }
    listen(panel) {
      const hit = panel.hit;
      let start = null;
      const place = event => {
        const { left, width } = hit.getBoundingClientRect();
        return clamp((event.clientX - left) / width * panel.w, 0, panel.w);
      };
      const inView = x => panel.view[0] + x / panel.w * (panel.view[1] - panel.view[0]);
      const pick = (from, to) =>
        this.panels.forEach(p => set(p.picked, { x: Math.min(from, to), width: Math.abs(to - from) }));
      hit.addEventListener("mousedown", event => event.preventDefault());
      hit.addEventListener("pointerdown", event => {
        this.figure.last = this;
        this.panels[0].hit.focus({ preventScroll: true, focusVisible: false });
        this.point(this.nearest(inView(place(event))), event);
        if (event.pointerType === "touch" || event.button !== 0) return;
        start = place(event);
        hit.setPointerCapture(event.pointerId);
      });
      hit.addEventListener("pointermove", event => {
        if (start !== null) pick(start, place(event));
        this.point(this.nearest(inView(place(event))), event);
      });
      hit.addEventListener("pointerup", event => {
        if (start === null) return;
        const [from, to] = [start, place(event)];
        start = null;
        pick(0, 0);
        if (Math.abs(to - from) > 6) this.show(inView(Math.min(from, to)), inView(Math.max(from, to)));
      });
      hit.addEventListener("pointercancel", () => { start = null; pick(0, 0); });
      // A touch ends immediately; its values stay until the next touch.
      hit.addEventListener("pointerleave", event => { if (event.pointerType !== "touch") this.point(null); });
      hit.addEventListener("dblclick", () => this.whole());
    }
    nearest(x) {
      const [from, to] = this.panels[0].view;
      const inside = this.places.filter(place => place >= from && place <= to);
      return inside.reduce((best, p) => best === null || Math.abs(p - x) < Math.abs(best - x) ? p : best, null);
    }
    show(from, to) {
      const w = this.panels[0].w, least = w / MAX_ZOOM_X;
      if (to - from < least) [from, to] = [(from + to - least) / 2, (from + to + least) / 2];
      if (to - from > w) [from, to] = [0, w];
      const shift = Math.max(0, -from) - Math.max(0, to - w);
      for (const panel of this.panels) {
        panel.view = [from + shift, to + shift];
        panel.fit();
        panel.draw();
      }
      this.point(this.at);
    }
    zoom(factor) {
      const [from, to] = this.panels[0].view, half = (to - from) / 2 * factor;
      const middle = this.at ?? (from + to) / 2;
      this.show(middle - half, middle + half);
    }
    whole() { this.show(0, this.panels[0].w); }
    key(event) {
      const last = this.places.length - 1, now = this.places.indexOf(this.at), far = event.shiftKey ? 10 : 1;
      const steps = { ArrowRight: now + far, ArrowLeft: now < 0 ? last : now - far, Home: 0, End: last };
      if (event.ctrlKey || event.metaKey || event.altKey) return;
      if (event.key in steps && last >= 0) {
        const at = this.places[clamp(steps[event.key], 0, last)], [from, to] = this.panels[0].view;
        if (at < from) this.show(at, at + to - from);
        if (at > to) this.show(at - to + from, at);
        this.point(at);
      } else if ("+=".includes(event.key)) this.zoom(0.5);
      else if (event.key === "-") this.zoom(2);
      else if (["Escape", "0"].includes(event.key)) { this.point(null); this.whole(); }
      else return;
      this.figure.last = this;
      event.preventDefault();
    }
    // Shows the values of all panels at a position; without a position, hides them.
    point(x, event) {
      this.at = x;
      for (const panel of this.panels) panel.cross.replaceChildren();
      const tip = this.figure.tip;
      if (x === null) { tip.hidden = true; return; }
      const head = this.panels[0].place(x), rows = [];
      for (const panel of this.panels) {
        const px = panel.screenX(x);
        element(panel.cross, "path", { d: `M${px} 0V${panel.h}` });
        for (const reading of panel.readings(x)) {
          rows.push(reading);
          const [, , colour, y] = reading;
          if (y !== null) element(panel.cross, "circle", { cx: px, cy: panel.screenY(y), r: 3.5 }).style.fill = colour;
        }
      }
      tip.replaceChildren(html("strong", { textContent: head }));
      for (const [name, words, colour] of rows) {
        const row = tip.appendChild(html("div"));
        row.appendChild(html("i")).style.background = colour;
        row.append(words ? `${name}: ${words}` : name);
      }
      tip.hidden = false;
      const text = [head, ...rows.map(r => `${r[0]} ${r[1]}`)].join("; ");
      set(this.panels[0].hit, { "aria-valuenow": this.places.indexOf(x), "aria-valuetext": text });
      this.figure.placeTip(this.panels[0], this.panels[0].screenX(x), event);
    }
  }

  class Figure {
    constructor(frame, svg) {
      Object.assign(this, { frame, svg, last: null });
      svg.setAttribute("role", "group");
      this.tip = frame.appendChild(html("div", { className: "tip", hidden: true }));
      this.panels = [...svg.querySelectorAll(".panel")].map(group => new Panel(group, this));
      const alike = (a, b) => a.settings.x === b.settings.x && a.left === b.left && a.w === b.w;
      const first = this.panels.filter((p, i) => this.panels.findIndex(other => alike(p, other)) === i);
      this.stacks = first.map(p => new Stack(this.panels.filter(other => alike(p, other)), this));
      if (this.panels.length) this.addTools();
    }
    addTools() {
      const tools = html("div", { className: "tools" });
      this.svg.parentElement.after(tools);
      const chosen = () => this.last ? [this.last] : this.stacks;
      for (const [sign, name, act] of [
        ["+", "zoom in", s => s.zoom(0.5)], ["−", "zoom out", s => s.zoom(2)], ["all", "show the whole", s => s.whole()],
      ]) {
        const button = html("button", { type: "button", textContent: sign, title: name, ariaLabel: name });
        tools.appendChild(button).addEventListener("click", () => chosen().forEach(act));
      }
      // Announced once per page.
      if (document.querySelectorAll(`.${this.svg.parentElement.classList[1]} + .tools`).length > 1) return;
      tools.append("Drag to zoom, double-click to reset; arrow keys show values; click a name in the legend to hide its curve.");
    }
    // A panel without tick labels shares those of the panel below.
    labelBelow(panel) {
      const below = this.panels.slice(this.panels.indexOf(panel));
      return below.find(p => p.left === panel.left && p.xLabel)?.xLabel ?? "";
    }
    placeTip(panel, px, event) {
      const frame = this.frame.getBoundingClientRect(), box = panel.hit.getBoundingClientRect();
      const x = box.left - frame.left + px / panel.w * box.width, tip = this.tip;
      const y = (event ? event.clientY : box.top) - frame.top;
      const room = frame.width - tip.offsetWidth;
      const beside = x + 14 <= room ? x + 14 : x - 14 - tip.offsetWidth;
      tip.style.left = `${clamp(beside, 0, Math.max(room, 0))}px`;
      tip.style.top = `${Math.max(0, y + 14)}px`;
    }
  }

  for (const svg of document.querySelectorAll("figure .scroll > svg")) new Figure(svg.closest("figure"), svg);
  // Details are expanded for printing.
  let folded = [];
  const open = way => folded.forEach(part => { part.open = way; });
  addEventListener("beforeprint", () => { folded = [...document.querySelectorAll("details:not([open])")]; open(true); });
  addEventListener("afterprint", () => open(false));
})();
