// The charts and the deposits. Every figure is kept as a function that draws it, so that it can be drawn again when
// the colours change (dark, light, paper) or the window does.
"use strict";

const figures = [];  // {draw(), painted(): bool}

// Viridis, in bands: rising lightness, so that it reads without colour as well.
const BANDS = ["#440154", "#46327e", "#365c8d", "#277f8e", "#1fa187", "#4ac16d", "#a0da39", "#fde725"];

const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
const backendColour = (backend) => colour(backend in BACKENDS ? backend : "other");
const font = (size) => `${size}px system-ui, "DejaVu Sans", sans-serif`;

function isPainted(canvas) {
  if (!canvas.width || !canvas.height) return false;
  const pixels = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
  for (let k = 3; k < pixels.length; k += 4) if (pixels[k]) return true;
  return false;
}

/** Points of one line over L0 (or seconds), leaving out what is missing. */
function points(xs, ys, xScale, yScale) {
  const count = Math.min(xs?.length ?? 0, ys?.length ?? 0);
  return Array.from({length: count}, (_, k) => ({x: xs[k] / xScale, y: ys[k] / yScale, whole: isNumber(xs[k]) && isNumber(ys[k])}))
      .filter((point) => point.whole);
}

function lineSet(run, data) {
  return {backend: run.backend, seed: run.seed, label: backendOf(run.backend).label, data,
          borderDash: backendOf(run.backend).dash, borderWidth: 1.75, pointRadius: 0, pointHitRadius: 6, tension: 0};
}

function chartColours(chart) {
  for (const set of chart.data.datasets) {
    set.borderColor = set.backend ? backendColour(set.backend) : colour("muted");
    set.backgroundColor = set.borderColor;
  }
  for (const scale of Object.values(chart.options.scales)) {
    scale.grid.color = colour("grid");
    scale.grid.borderColor = colour("muted");
    scale.ticks.color = colour("muted");
    scale.title.color = colour("text");
  }
}

/** One button for each code, which hides or shows all its seeds. Its line is drawn as in the chart. */
function legend(chart) {
  const {datasets} = chart.data;
  const labels = [...new Set(datasets.map((set) => set.label))];
  return make("div", {class: "legend"}, ...labels.map((label) => {
    const mine = datasets.flatMap((set, k) => set.label === label ? [k] : []);
    const {backend} = datasets[mine[0]];
    const sample = backend ? swatch(backend) : make("span", {class: "swatch thin", "aria-hidden": "true"});
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

function axis(title) {
  return {type: "linear", beginAtZero: true, title: {display: true, text: title, font: {size: 13}}, grid: {},
          ticks: {maxTicksLimit: 9, font: {size: 12}}};
}

function addChart(parent, {caption, description, xTitle, yTitle, sets}) {
  const canvas = make("canvas", {role: "img", "aria-label": description});
  const plot = make("div", {class: "plot"}, canvas);
  parent.append(make("figure", {}, make("figcaption", {}, make("strong", {}, caption)), plot));
  const chart = new Chart(canvas, {
    type: "line",
    data: {datasets: sets},
    options: {
      animation: false, parsing: false, responsive: true, maintainAspectRatio: false,
      devicePixelRatio: Math.max(2, window.devicePixelRatio || 1),
      interaction: {mode: "nearest", axis: "x", intersect: false},
      scales: {x: axis(xTitle), y: axis(yTitle)},
      plugins: {
        legend: {display: false},
        tooltip: {callbacks: {
          title: (items) => items.length ? `${xTitle}: ${number(items[0].parsed.x)}` : "",
          label: ({dataset, parsed}) => `${dataset.label}${dataset.seed === undefined ? "" : `, seed ${dataset.seed}`}: ${number(parsed.y)}`,
        }},
      },
    },
  });
  plot.before(legend(chart));
  const draw = () => { chartColours(chart); chart.resize(); chart.update("none"); };
  draw();
  figures.push({draw, painted: () => chart.data.datasets.some((set) => set.data.length) && isPainted(canvas)});
}

/** "Continuum seed 1: 2.31; ..." for those who cannot see the chart. */
const lastValues = (sets) => sets.filter((set) => set.backend && set.data.length)
    .map((set) => `${set.label} seed ${set.seed}: ${number(set.data.at(-1).y)}`).join("; ");

function drawCharts(parent, aCase) {
  const runs = aCase.runs ?? [];
  const scale = aCase.column_length_m;
  const lengths = (key) => runs.map((run) => lineSet(run, points(run.curves?.time, run.curves?.[key], 1, scale)))
      .filter((set) => set.data.length);
  const fronts = isNumber(scale) ? lengths("front") : [];
  if (fronts.length) {
    addChart(parent, {caption: "Front of the heap in time; one line for each seed", sets: fronts,
      description: `Line chart of the front over L0 against time. At the end: ${lastValues(fronts)}.`,
      xTitle: "time since release t (s)", yTitle: "front / L₀"});
  }
  const profiles = isNumber(scale) ? runs.map((run) => lineSet(run, points(run.final_profile?.x, run.final_profile?.depth, scale, scale)))
      .filter((set) => set.data.length) : [];
  if (profiles.length) {
    const start = runs.map((run) => run.observables?.settled_height).find(isNumber);
    const outline = isNumber(start) ? [{label: "column at release", borderWidth: 1, pointRadius: 0,
      data: [{x: 0, y: start}, {x: 1, y: start}, {x: 1, y: 0}]}] : [];
    const highest = profiles.map((set) => `${set.label} seed ${set.seed}: ${number(Math.max(...set.data.map((point) => point.y)))}`);
    addChart(parent, {caption: "Final profile; one line for each seed", sets: [...profiles, ...outline],
      description: `Line chart of the final depth over L0 against distance over L0. Largest depth: ${highest.join("; ")}.`,
      xTitle: "distance from the back wall x / L₀", yTitle: "depth / L₀"});
  }
  if (!fronts.length && !profiles.length) parent.append(make("p", {class: "absent"}, "These results hold no curves."));
}

/** One deposit at `scale` pixels a metre, floor at the bottom, with axes over L0. */
function drawDeposit(canvas, picture, length, extent) {
  const margin = {left: 42, right: 8, top: 6, bottom: 36};
  const width = canvas.parentElement.clientWidth;
  const scale = (width - margin.left - margin.right) / extent.x;
  const height = Math.ceil(extent.z * scale) + margin.top + margin.bottom;
  const ratio = Math.max(2, window.devicePixelRatio || 1);
  canvas.width = Math.round(width * ratio);
  canvas.height = Math.round(height * ratio);
  canvas.style.height = `${height}px`;
  const pen = canvas.getContext("2d");
  pen.scale(ratio, ratio);
  const floor = height - margin.bottom;
  const across = (x) => margin.left + x * scale;
  const up = (z) => floor - z * scale;

  pen.lineWidth = 0.4;
  pen.strokeStyle = colour("page");
  picture.x.forEach((x, k) => {
    const band = Math.floor(BANDS.length * (picture.x0?.[k] ?? 0) / length);
    pen.fillStyle = BANDS[Math.min(BANDS.length - 1, Math.max(0, band))];
    pen.beginPath();
    pen.arc(across(x), up(picture.z[k]), Math.max(0.6, (picture.radius?.[k] ?? 0) * scale), 0, 2 * Math.PI);
    pen.fill();
    pen.stroke();
  });

  pen.lineWidth = 1;
  pen.strokeStyle = pen.fillStyle = colour("muted");
  pen.font = font(12);
  pen.beginPath();
  pen.moveTo(across(0), up(extent.z));
  pen.lineTo(across(0), floor);
  pen.lineTo(across(extent.x), floor);
  pen.textAlign = "center";
  pen.textBaseline = "top";
  for (let tick = 0; tick * length <= extent.x; tick += 0.5) {
    pen.moveTo(across(tick * length), floor);
    pen.lineTo(across(tick * length), floor + 4);
    pen.fillText(tick.toFixed(1), across(tick * length), floor + 6);
  }
  pen.textAlign = "right";
  pen.textBaseline = "middle";
  for (let tick = 0; tick * length <= extent.z; tick += 0.5) {
    pen.moveTo(across(0) - 4, up(tick * length));
    pen.lineTo(across(0), up(tick * length));
    pen.fillText(tick.toFixed(1), across(0) - 7, up(tick * length));
  }
  pen.stroke();
  pen.fillStyle = colour("text");
  pen.textBaseline = "bottom";
  pen.fillText("x / L₀", across(extent.x), height);
  pen.save();
  pen.translate(12, up(extent.z / 2));
  pen.rotate(-Math.PI / 2);
  pen.textAlign = "center";
  pen.fillText("z / L₀", 0, 0);
  pen.restore();
}

/** The deposit of each code, the lowest seed of each, one below the other to one scale. */
function drawDeposits(parent, aCase, pictures) {
  const length = aCase.column_length_m;
  const drawable = pictures.filter((picture) => picture.case === aCase.name && picture.x?.length && picture.z?.length);
  const order = Object.keys(BACKENDS);
  const place = (name) => order.includes(name) ? order.indexOf(name) : order.length;
  drawable.sort((a, b) => place(a.backend) - place(b.backend) || a.seed - b.seed);
  const shown = drawable.filter((picture, k) => drawable.findIndex((other) => other.backend === picture.backend) === k);
  if (!shown.length || !isNumber(length)) {
    parent.append(make("p", {class: "absent"}, "These results hold no pictures."));
    return;
  }
  const most = (picture, key) => picture[key].reduce((high, value, k) => Math.max(high, value + (picture.radius?.[k] ?? 0)), 0);
  const extent = {x: Math.max(...shown.map((p) => most(p, "x"))), z: Math.max(...shown.map((p) => most(p, "z")))};
  const bands = make("span", {class: "bands", "aria-hidden": "true"});
  for (const shade of BANDS) {
    const band = make("i");
    band.style.background = shade;
    bands.append(band);
  }
  parent.append(make("p", {class: "key"}, "Coloured by where each item stood at release: back wall", bands, "gate"));
  const drawings = shown.map((picture) => {
    const {label, items} = backendOf(picture.backend);
    const canvas = make("canvas", {role: "img", "aria-label":
        `Side view of the ${label} deposit: ${picture.x.length} ${items}, reaching ${number(most(picture, "x") / length)} L0 ` +
        `from the back wall and ${number(most(picture, "z") / length)} L0 high.`});
    parent.append(make("figure", {class: "deposit"},
        make("figcaption", {}, make("strong", {}, label), `, seed ${words(picture.seed)}, t = ${number(picture.time)} s, ` +
            `${number(picture.x.length)} ${items}`), make("div", {}, canvas)));
    return {canvas, draw: () => drawDeposit(canvas, picture, length, extent)};
  });
  const draw = () => drawings.forEach((drawing) => drawing.draw());
  draw();
  figures.push({draw, painted: () => drawings.every((drawing) => isPainted(drawing.canvas))});
}
