// Line and scatter charts by Chart.js: curves with bands over the runs, profiles, and the two charts of the summary. Every figure
// is kept as a function that draws it, so that it can be drawn again when the colours change (dark, light, paper) or the window does.
"use strict";

const figures = [];  // {draw(), painted(): bool}

const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
const faint = (hex) => `${hex}38`;
/** On paper the charts are scaled down to half a page. */
const chartFont = (size) => document.documentElement.classList.contains("all") ? 1.4 * size : size;
const font = (size) => `${size}px system-ui, "DejaVu Sans", sans-serif`;
/** Sharp on paper; less so where a whole long report is drawn at once, for its canvases share the memory. */
const pixelRatio = () => Math.max(document.documentElement.classList.contains("all") ? 1.5 : 2, window.devicePixelRatio || 1);

function isPainted(canvas) {
  if (!canvas.width || !canvas.height) return false;
  const pixels = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
  for (let k = 3; k < pixels.length; k += 4) if (pixels[k]) return true;
  return false;
}

/** Points of one line, scaled, leaving out what is missing. Throws TypeError for what is no list. */
function points(xs, ys, xScale, yScale) {
  for (const values of [xs, ys]) {
    if (values !== undefined && values !== null && !Array.isArray(values)) throw new TypeError("a curve is not a list of numbers");
  }
  const count = Math.min(xs?.length ?? 0, ys?.length ?? 0);
  return Array.from({length: count}, (_, k) => ({x: xs[k] / xScale, y: ys[k] / yScale, whole: isNumber(xs[k]) && isNumber(ys[k])}))
      .filter((point) => point.whole).map(({x, y}) => ({x, y}));
}

/** The line's value at x; `beyond` outside of it. */
function valueAt(line, x, beyond) {
  const next = line.findIndex((point) => point.x >= x);
  if (next < 0 || (next === 0 && line[0].x > x)) return beyond;
  if (next === 0) return line[0].y;
  const [a, b] = [line[next - 1], line[next]];
  return b.x > a.x ? a.y + (b.y - a.y) * (x - a.x) / (b.x - a.x) : b.y;
}

/** Mean, lowest and highest of several lines where all of them have a value, at the places of the longest of them. */
function envelope(lines, beyond) {
  const longest = lines.reduce((best, line) => line.at(-1).x > best.at(-1).x ? line : best);
  const sampled = longest.map(({x}) => ({x, values: lines.map((line) => valueAt(line, x, beyond))}))
      .filter(({values}) => values.every(isNumber));
  const reduced = (of) => sampled.map(({x, values}) => ({x, y: of(values)}));
  return {mean: reduced((v) => v.reduce((sum, value) => sum + value, 0) / v.length),
          low: reduced((v) => Math.min(...v)), high: reduced((v) => Math.max(...v))};
}

/** Asked for at every drawing: what is set once is kept from before the colours are known. */
const ofLine = ({dataset}) => dataset.borderColor;

function lineSet(code, label, data) {
  return {code, label, data, borderDash: codeOf(code).dash, borderWidth: codeOf(code).line.includes("thin") ? 1 : 2,
          pointRadius: 0, pointHitRadius: 6, pointBackgroundColor: ofLine, pointBorderColor: ofLine, tension: 0, fill: false};
}

/** What one chart holds for the runs' `line(run)`: a line for each continuum run; for a discrete code its runs' mean and band. */
function codeSets(runs, line, beyond) {
  const drawn = inCodeOrder(runs).map((run) => ({run, data: line(run)})).filter(({data}) => data.length);
  const sets = [];
  for (const code of new Set(drawn.map(({run}) => run.code))) {
    const mine = drawn.filter(({run}) => run.code === code);
    const {label} = codeOf(code);
    if (!isDem(code) || mine.length === 1) {
      sets.push(...mine.map(({run, data}) => ({...lineSet(code, label, data), seed: run.seed})));
      continue;
    }
    const {mean, low, high} = envelope(mine.map(({data}) => data), beyond);
    const edge = {code, label, band: true, borderWidth: 0, pointRadius: 0, pointHitRadius: 0};
    sets.push({...lineSet(code, label, mean), runs: mine.length}, {...edge, data: low, fill: false}, {...edge, data: high, fill: "-1"});
  }
  return sets;
}

function chartColours(chart) {
  for (const set of chart.data.datasets) {
    set.borderColor = set.code ? colour(codeOf(set.code).family) : set.verdict ? colour(set.verdict.toLowerCase()) : colour("muted");
    set.backgroundColor = set.band ? faint(set.borderColor) : set.hollow ? colour("page") : set.borderColor;
  }
  for (const scale of Object.values(chart.options.scales)) {
    scale.grid.color = colour("grid");
    scale.grid.borderColor = colour("muted");
    scale.ticks.color = colour("muted");
    scale.title.color = colour("text");
  }
}

/** One button for each label, which hides or shows all that carries it. Its line is drawn as in the chart. */
function legend(chart) {
  const {datasets} = chart.data;
  const labels = [...new Set(datasets.map((set) => set.label))];
  return make("div", {class: "legend"}, labels.map((label) => {
    const mine = datasets.flatMap((set, k) => set.label === label ? [k] : []);
    const {code, verdict} = datasets[mine[0]];
    const sample = code ? swatch(code) : verdict ? make("b", {class: `mark ${verdict}`, "aria-hidden": "true"}, signOf(verdict)) :
        make("span", {class: "swatch thin", "aria-hidden": "true"});
    const button = make("button", {type: "button", "aria-pressed": "true"}, sample, label);
    button.addEventListener("click", () => {
      const shown = button.getAttribute("aria-pressed") !== "true";
      button.setAttribute("aria-pressed", String(shown));
      mine.forEach((k) => chart.setDatasetVisibility(k, shown));
      chart.update("none");
    });
    return button;
  }));
}

function axis(title, more = {}) {
  return {type: "linear", beginAtZero: true, title: {display: true, text: title, font: {size: chartFont(13)}}, grid: {},
          ticks: {maxTicksLimit: 9, font: {size: chartFont(12)}}, ...more};
}

const seedText = ({seed, runs}) => isNumber(seed) || seed ? `, seed ${seed}` : runs ? `, mean of ${runs}` : "";

function addChart(parent, {caption, note, description, scales, sets, tip, plugins = [], type = "line"}) {
  const canvas = make("canvas", {role: "img", "aria-label": description});
  const plot = make("div", {class: "plot"}, canvas);
  parent.append(make("figure", {}, make("figcaption", {}, make("strong", {}, caption), note ? ` ${note}` : null), plot));
  const chart = new Chart(canvas, {
    type, plugins, data: {datasets: sets},
    options: {
      animation: false, parsing: false, responsive: true, maintainAspectRatio: false, devicePixelRatio: pixelRatio(),
      interaction: type === "line" ? {mode: "nearest", axis: "x", intersect: false} : {mode: "nearest", intersect: true},
      scales,
      plugins: {
        legend: {display: false}, filler: {propagate: false},
        tooltip: {
          filter: ({dataset}) => !dataset.band && !dataset.guide,
          callbacks: {
            title: (items) => tip || !items.length ? "" : `${scales.x.title.text}: ${number(items[0].parsed.x)}`,
            label: (item) => tip ? tip(item.raw) : `${item.dataset.label}${seedText(item.dataset)}: ${number(item.parsed.y)}`,
          },
        },
      },
    },
  });
  plot.before(legend(chart));
  const draw = () => { chartColours(chart); chart.resize(); chart.update("none"); };
  draw();
  figures.push({draw, painted: () => chart.data.datasets.some((set) => set.data.length) && isPainted(canvas)});
  return chart;
}

/** "Continuum seed 1: 2.31; ..." for those who cannot see the chart. */
const lastValues = (sets) => sets.filter((set) => !set.band).map((set) => `${set.label}${seedText(set)}: ${number(set.data.at(-1).y)}`).join("; ");

function addProfile(parent, point, scale, unit) {
  const runs = list(point.runs);
  const sets = codeSets(runs, (run) => points(run.final_profile?.x, run.final_profile?.depth, scale, scale), 0);
  if (!sets.length) return false;
  const start = point.kind === "column_collapse" ? runs.map((run) => run.observables?.settled_height).find(isNumber) : undefined;
  const outline = isNumber(start) ? [{label: "column at release", guide: true, borderWidth: 1, pointRadius: 0, fill: false,
    data: [{x: 0, y: start}, {x: 1, y: start}, {x: 1, y: 0}]}] : [];
  const highest = sets.filter((set) => !set.band).map((set) =>
      `${set.label}${seedText(set)}: ${number(set.data.reduce((most, {y}) => Math.max(most, y), 0))}`);
  addChart(parent, {caption: "Final profile", sets: [...sets, ...outline],
    description: `Line chart of the final depth against place. Largest depth: ${highest.join("; ")}.`,
    scales: {x: axis(`place x${unit}`, {beginAtZero: point.kind !== "heap"}), y: axis(`depth${unit}`)}});
  return true;
}

/** Every curve that the runs hold, and the final profile. */
function drawCurves(parent, point) {
  const runs = list(point.runs);
  const lengthScale = isNumber(point.length_unit?.metres) && point.length_unit.metres > 0 ? point.length_unit.metres : 1;
  const lengthText = lengthScale === 1 ? " (m)" : ` / ${unitText(point.length_unit.symbol)}`;
  let drawn = 0;
  const charts = make("div", {class: "charts"});
  parent.append(make("p", {class: "muted"}, "One line for each continuum run. Of a discrete code with several runs the line is their mean, the band goes from the " +
      "lowest of them to the highest."), charts);
  for (const key of keysOf(runs, "curves").filter((name) => name !== "time")) {
    const [label, unit] = quantityOf(key);
    const sets = codeSets(runs, (run) => points(run.curves?.time, run.curves?.[key], 1, unit === "length" ? lengthScale : 1), null);
    if (!sets.length) continue;
    const yTitle = `${label}${unit === "length" ? lengthText : unit && unit !== "1" ? ` (${unit})` : ""}`;
    addChart(charts, {caption: `${label[0].toUpperCase()}${label.slice(1)} in time`, sets,
      description: `Line chart of ${label} against time. At the end: ${lastValues(sets)}.`,
      scales: {x: axis(`time since ${point.kind === "impact" ? "contact" : "release"} t (s)`), y: axis(yTitle)}});
    drawn += 1;
  }
  if (addProfile(charts, point, lengthScale, lengthText)) drawn += 1;
  if (!drawn) parent.replaceChildren(absent("These results hold no curves."));
}
