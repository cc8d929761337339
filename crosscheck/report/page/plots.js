// Draws the plots of a page with uPlot, from the data beside each static picture, which stays for print.
"use strict";
const bytes = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer;
const values = (text, log) => Array.from(new Float32Array(bytes(text)), (y) => (Number.isNaN(y) || (log && y <= 0) ? null : y));
const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const short = (y) => (y == null ? "–" : Math.abs(y) >= 1e5 || (y !== 0 && Math.abs(y) < 1e-3) ? y.toExponential(2) : String(Number(y.toPrecision(5))));
const POINTS_SHOWN = 60;

function axis(label, log) {
  const grid = { stroke: css("--faint"), width: 0.5 };
  const ticks = log ? { values: (_, at) => at.map((y) => (y == null || Math.abs(Math.log10(y) % 1) > 1e-6 ? "" : y.toExponential(0))) } : {};
  return { label, labelSize: 18, labelFont: "12px system-ui", font: "11px system-ui", size: label ? 62 : 40, stroke: css("--ink"), grid, ticks: grid, ...ticks };
}

function drawPanel(place, plot, panel, width, last) {
  const x = Array.from(new Float64Array(bytes(plot.x)));
  const series = panel.series.map((one) => ({
    label: one.name, show: !one.hidden, spanGaps: one.style !== "line" ? false : plot.log_x, value: (_, y) => short(y),
    stroke: css("--c" + (one.color % 8)), width: one.style === "dashed" ? 1.5 : one.style === "line" ? 2 : 0,
    dash: one.style === "dashed" ? [7, 4] : undefined,
    points: { show: one.style === "marks" || x.length <= POINTS_SHOWN, size: 5 },
    paths: one.style === "marks" ? () => null : undefined,
  }));
  const level = (u) => {
    if (panel.level == null) return;
    const y = u.valToPos(panel.level, "y", true);
    u.ctx.save(); u.ctx.strokeStyle = css("--ink"); u.ctx.setLineDash([3, 3]);
    u.ctx.beginPath(); u.ctx.moveTo(u.bbox.left, y); u.ctx.lineTo(u.bbox.left + u.bbox.width, y); u.ctx.stroke(); u.ctx.restore();
  };
  return new uPlot({
    title: panel.title, width, height: Math.round(240 * panel.height) + 60,
    cursor: { sync: { key: plot.key, setSeries: false }, focus: { prox: 24 } },
    scales: { x: { time: false, distr: plot.log_x ? 3 : 1 }, y: { distr: panel.log ? 3 : 1 } },
    axes: [
      { ...axis(last ? plot.x_title : "", plot.log_x), size: last ? 48 : 30 },
      { ...axis(panel.unit, panel.log), space: panel.height < 0.7 ? 18 : 30 },
    ],
    series: [{ label: plot.x_title, value: (_, y) => short(y) }, ...series],
    hooks: { draw: [level], setScale: [(u, key) => key === "x" && follow(plot, u)] },
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
  const width = Math.max(300, live.clientWidth);
  for (const panel of plot.panels) plot.drawn.push(drawPanel(live, plot, panel, width, panel === plot.panels.at(-1)));
  figure.querySelector(".still").hidden = true;
  figure.querySelector(".how").hidden = false;
}

// Drawn when near the window, the first ones before the first frame: a page of many plots opens at once.
const NEAR = 600;
const figures = [...document.querySelectorAll("figure.plot")];
const watcher = new IntersectionObserver((seen) => {
  for (const { isIntersecting, target } of seen) {
    if (!isIntersecting) continue;
    watcher.unobserve(target);
    draw(target, figures.indexOf(target));
  }
}, { rootMargin: `${NEAR}px` });
figures.forEach((figure, k) => {
  const { top, bottom } = figure.getBoundingClientRect();
  if (bottom > 0 && top < innerHeight + NEAR) draw(figure, k);
  else watcher.observe(figure);
});
const again = () => figures.forEach((figure, k) => figure.plot && draw(figure, k));
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", again);
let waiting;
addEventListener("resize", () => { clearTimeout(waiting); waiting = setTimeout(again, 200); });
