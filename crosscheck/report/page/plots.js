// Draws the plots of a page with uPlot, from the data beside each static picture, which stays for print.
"use strict";
const bytes = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer;
const values = (text, log) => Array.from(new Float32Array(bytes(text)), (y) => (Number.isNaN(y) || (log && y <= 0) ? null : y));
const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const short = (y) => (y == null ? "–" : Math.abs(y) >= 1e5 || (y !== 0 && Math.abs(y) < 1e-3) ? y.toExponential(2) : String(Number(y.toPrecision(5))));
const POINTS_SHOWN = 60, MOST_TICKS = 9, LEAST_WIDTH = 300;
const PREFIXES = [[1, ""], [1e-3, "m"], [1e-6, "µ"], [1e-9, "n"]];
function prefixed(y, unit) {
  if (y == null) return "–";
  const [size, prefix] = PREFIXES.find(([one]) => Math.abs(y) > 0.9995 * one) ?? PREFIXES.at(-1);
  return `${Number((y / size).toPrecision(3))} ${prefix}${unit}`;
}

function axis(label, said) {
  const grid = { stroke: css("--faint"), width: 0.5 };
  const ticks = said ? { values: (_, at) => at.map((y) => (y == null ? "" : said(y))) } : {};
  return { label, labelSize: 18, labelFont: "12px system-ui", font: "11px system-ui", size: label ? 62 : 52, stroke: css("--ink"), grid, ticks: grid, ...ticks };
}

function line(u, color, dash, x0, y0, x1, y1) {
  u.ctx.save();
  u.ctx.beginPath(); u.ctx.rect(u.bbox.left, u.bbox.top, u.bbox.width, u.bbox.height); u.ctx.clip();
  u.ctx.strokeStyle = color; u.ctx.setLineDash(dash);
  u.ctx.beginPath(); u.ctx.moveTo(x0, y0); u.ctx.lineTo(x1, y1); u.ctx.stroke(); u.ctx.restore();
}

// A logarithmic axis of x from its first to its last value, with its ticks at values.
function logarithmic(x) {
  const every = 1 + Math.floor(new Set(x).size / MOST_TICKS);
  const ticks = [...new Set(x)].filter((_, k) => k % every === 0);
  const scale = { time: false, distr: 3, range: (_, min, max) => (min < max ? [min, max] : [min / 2, 2 * max]) };
  return [scale, { splits: (_, k, min, max) => ticks.filter((one) => min <= one && one <= max), filter: (_, at) => at }];
}

// The range of an axis of y: its curves and its level, such as a bound.
function reach(panel, min, max) {
  if (min == null) return [panel.log ? 0.1 : 0, 1];
  const low = Math.min(min, panel.level ?? min), high = Math.max(max, panel.level ?? max);
  return panel.log ? uPlot.rangeLog(low, high, 10, false) : uPlot.rangeNum(low, high, 0.1, true);
}

// The level and the upright line across a panel, and the bars of its points.
function drawLines(u, plot, panel, x) {
  const { left, top, width, height } = u.bbox;
  const level = u.valToPos(panel.level, "y", true), upright = u.valToPos(plot.upright, "x", true);
  if (panel.level != null) line(u, css("--ink"), [3, 3], left, level, left + width, level);
  if (plot.upright != null) line(u, css("--middle"), [], upright, top, upright, top + height);
  panel.series.forEach((one, k) => {
    if (!one.low || !u.series[k + 1].show) return;
    const high = new Float32Array(bytes(one.high));
    new Float32Array(bytes(one.low)).forEach((low, i) => {
      if (Number.isNaN(low)) return;
      const at = u.valToPos(x[i], "x", true);
      line(u, css("--c" + (one.color % 8)), [], at, u.valToPos(low, "y", true), at, u.valToPos(high[i], "y", true));
    });
  });
}

function drawPanel(place, plot, panel, width, last) {
  const x = Array.from(new Float64Array(bytes(plot.x)));
  const [scale, ticks] = plot.log_x ? logarithmic(x) : [{ time: false }, {}];
  const said = (y) => (panel.prefixes ? prefixed(y, panel.unit) : short(y));
  const series = panel.series.map((one) => ({
    label: one.name, show: !one.hidden, spanGaps: one.style !== "marks" && plot.log_x, value: (_, y) => said(y),
    stroke: css("--c" + (one.color % 8)), width: one.style === "dashed" ? 1.5 : one.style === "line" ? 2 : 0,
    dash: one.style === "dashed" ? [7, 4] : undefined,
    points: { show: one.style === "marks" || x.length <= POINTS_SHOWN, size: 5 },
    paths: one.style === "marks" ? () => null : undefined,
  }));
  return new uPlot({
    title: panel.title, width, height: Math.round(240 * panel.height) + 60,
    cursor: { sync: { key: plot.key, setSeries: false }, focus: { prox: 24 } },
    scales: { x: scale, y: { distr: panel.log ? 3 : 1, range: (_, min, max) => reach(panel, min, max) } },
    axes: [
      { ...axis(last ? plot.x_title : "", plot.log_x && short), ...ticks, size: last ? 48 : 30 },
      { ...axis(panel.prefixes ? "" : panel.unit, (panel.log || panel.prefixes) && said), space: panel.height < 0.7 ? 18 : 30 },
    ],
    series: [{ label: plot.x_title, value: (_, y) => short(y) }, ...series],
    hooks: { draw: [(u) => drawLines(u, plot, panel, x)], setScale: [(u, key) => key === "x" && follow(plot, u)] },
  }, [x, ...panel.series.map((one) => values(one.y, panel.log))], place);
}

// A zoom along x in one panel moves the others of the same plot.
function follow(plot, source) {
  const { min, max } = source.scales.x;
  for (const other of plot.drawn) {
    if (other !== source && (other.scales.x.min !== min || other.scales.x.max !== max)) other.setScale("x", { min, max });
  }
}

function draw(figure, k) {
  const live = figure.querySelector(".live");
  const plot = figure.plot ?? JSON.parse(live.querySelector("script").textContent);
  figure.plot = plot;
  plot.key = "plot" + k;
  for (const old of plot.drawn ?? []) old.destroy();
  plot.drawn = [];
  live.hidden = false;
  const width = Math.max(LEAST_WIDTH, live.clientWidth);
  for (const panel of plot.panels) plot.drawn.push(drawPanel(live, plot, panel, width, panel === plot.panels.at(-1)));
  for (const name of live.querySelectorAll(".u-legend .u-series:not(:first-child) th")) {
    name.tabIndex = 0;
    name.setAttribute("role", "button");
    name.addEventListener("keydown", (event) => { if (event.key === "Enter" || event.key === " ") { event.preventDefault(); name.click(); } });
  }
  figure.querySelector(".still").hidden = true;
  figure.querySelector(".how").hidden = false;
}

// Drawn when near the window, the first ones before the first frame: a page of many plots opens at once.
const NEAR = 600;
const figures = [];
const watcher = new IntersectionObserver((seen) => {
  for (const { isIntersecting, target } of seen) {
    if (!isIntersecting) continue;
    watcher.unobserve(target);
    draw(target, figures.indexOf(target));
  }
}, { rootMargin: `${NEAR}px` });
function found(place) {
  for (const figure of place.querySelectorAll("figure.plot")) {
    const { top, bottom } = figure.getBoundingClientRect();
    if (bottom > 0 && top < innerHeight + NEAR) draw(figure, figures.push(figure) - 1);
    else watcher.observe(figures[figures.push(figure) - 1]);
  }
}
found(document);
document.addEventListener("unpacked", (event) => found(event.target));
const again = () => figures.forEach((figure, k) => figure.plot && draw(figure, k));
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", again);
// A window of another width: the plots keep their zoom and the curves that are on.
addEventListener("resize", () => {
  for (const figure of figures) {
    const width = Math.max(LEAST_WIDTH, figure.querySelector(".live").clientWidth);
    for (const one of figure.plot?.drawn ?? []) if (one.width !== width) one.setSize({ width, height: one.height });
  }
});
