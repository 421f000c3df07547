// The charts of the summary: continuum against reference, as a ratio for all observables at once and in its own units for one of
// them; the raw discharge rates; and the baselines, one after the other.
"use strict";

const MARKS = {PASS: "circle", FAIL: "crossRot", INCONCLUSIVE: "rect"};

/** One dataset for each verdict, so that the legend can hide them one by one. */
function verdictSets(items) {
  return ["PASS", "FAIL", "INCONCLUSIVE"].map((verdict) => ({
    verdict, label: verdict, hollow: verdict === "INCONCLUSIVE", data: items.filter((item) => item.row.verdict === verdict),
    showLine: false, pointStyle: MARKS[verdict], pointRadius: verdict === "FAIL" ? 6 : 4.5, pointBorderWidth: verdict === "FAIL" ? 2.5 : 1.5, pointHitRadius: 8,
  })).filter((set) => set.data.length);
}

/** Vertical bars `item.low` to `item.high` behind the marks of every visible dataset. */
const errorBars = {id: "errorBars", beforeDatasetsDraw(chart) {
  const pen = chart.ctx, {x, y} = chart.scales;
  pen.save();
  pen.beginPath();
  pen.rect(chart.chartArea.left, chart.chartArea.top, chart.chartArea.width, chart.chartArea.height);
  pen.clip();
  pen.lineWidth = 1.25;
  chart.data.datasets.forEach((set, k) => {
    if (!set.verdict || !chart.isDatasetVisible(k)) return;
    pen.strokeStyle = colour(set.verdict.toLowerCase());
    pen.beginPath();
    for (const item of set.data.filter(({low, high}) => isNumber(low) && isNumber(high))) {
      pen.moveTo(x.getPixelForValue(item.x), y.getPixelForValue(item.low));
      pen.lineTo(x.getPixelForValue(item.x), y.getPixelForValue(item.high));
    }
    pen.stroke();
  });
  pen.restore();
}};

/** The practical band of each observable, as a strip in its column. */
const bandStrips = (bands) => ({id: "bandStrips", beforeDraw(chart) {
  const pen = chart.ctx, {x, y} = chart.scales;
  pen.save();
  pen.fillStyle = faint(colour("muted"));
  bands.forEach((band, k) => {
    if (!isNumber(band)) return;
    const left = x.getPixelForValue(k - 0.44), right = x.getPixelForValue(k + 0.44);
    const top = Math.max(chart.chartArea.top, y.getPixelForValue(1 + band));
    const bottom = Math.min(chart.chartArea.bottom, y.getPixelForValue(1 - band));
    pen.fillRect(left, top, right - left, bottom - top);
  });
  pen.restore();
}});

/** All observables of all points, but for laws that no discrete code is asked of: continuum / reference, the band as a strip, the bar +- k u. */
function drawRatios(parent, results) {
  const compared = pointsOf(results).flatMap((point) => list(point.truth).filter((row) => isNumber(row.deviation) && !row.exact).map((row) => ({point, row})));
  if (!compared.length) {
    parent.append(absent("There is nothing to plot."));
    return;
  }
  const present = new Set(compared.map(({row}) => row.observable));
  const observables = [...Object.keys(QUANTITIES).filter((key) => present.delete(key)), ...present];
  const items = observables.flatMap((key, column) => {
    const mine = compared.filter(({row}) => row.observable === key);
    return mine.map(({point, row}, k) => {
      const u = isNumber(row.uncertainty) ? row.uncertainty : null;
      return {x: column + 0.7 * ((k + 0.5) / mine.length - 0.5), y: 1 + row.deviation, row, point,
              low: u === null ? null : 1 + row.deviation - u, high: u === null ? null : 1 + row.deviation + u};
    });
  });
  const bands = observables.map((key) => compared.find(({row}) => row.observable === key && isNumber(row.band))?.row.band);
  const farthest = Math.max(0.1, ...items.map(({y}) => Math.abs(y - 1))) * 1.15;
  const reach = Math.min(Math.max(farthest, ...items.map(({low, high}) => Math.max(1 - (low ?? 1), (high ?? 1) - 1)), ...bands.filter(isNumber)), 3 * farthest);
  const worst = [...items].sort((a, b) => Math.abs(b.row.deviation) - Math.abs(a.row.deviation))[0];
  addChart(parent, {type: "scatter", caption: "Continuum over DEM reference, all points and observables.",
    note: "Grey strip: the practical band. Bar: ± k·u, the expanded uncertainty of the comparison. The profile's L1 distance is drawn as 1 + distance.",
    description: `Scatter chart of continuum over reference for ${items.length} comparisons. ${tally(items.map(({row}) => row))} ` +
        `Farthest: ${titleOf(worst.point)}, ${labelOf(worst.row.observable)}, ${percent(worst.row.deviation, true)}.`,
    sets: verdictSets(items), plugins: [bandStrips(bands), errorBars],
    tip: ({point, row}) => [nameOf(point), `${labelOf(row.observable)}: ${percent(row.deviation, true)} (band ${plusMinus(row.band)}, k·u ${plusMinus(row.uncertainty)})`],
    scales: {x: axis("", {beginAtZero: false, min: -0.5, max: observables.length - 0.5, grid: {display: false}, afterBuildTicks: (scale) => {
      scale.ticks = observables.map((_, value) => ({value})); },
    ticks: {autoSkip: false, maxRotation: 90, font: {size: chartFont(12)}, callback: (value) => labelOf(observables[value])}}),
    y: axis("continuum / reference", {beginAtZero: false, min: Math.max(0, 1 - reach), max: 1 + reach})}});
}

/** One observable in its own unit: continuum against reference, with the lines of perfect agreement and of the band. */
function agreementData(results, key) {
  const items = pointsOf(results).flatMap((point) => list(point.truth).filter((row) => row.observable === key &&
      isNumber(row.continuum?.mean) && isNumber(row.reference)).map((row) => {
    const half = isNumber(row.uncertainty) ? row.uncertainty * row.reference : null;
    return {x: row.reference, y: row.continuum.mean, row, point, low: half === null ? null : row.continuum.mean - half,
            high: half === null ? null : row.continuum.mean + half};
  }));
  const most = 1.1 * Math.max(...items.map(({x, y}) => Math.max(x, y)));
  const band = items.map(({row}) => row.band).find(isNumber);
  const guide = (slope, label) => ({label, guide: true, type: "line", pointRadius: 0, borderWidth: 1, fill: false,
    borderDash: slope === 1 ? [] : [5, 4], data: [{x: 0, y: 0}, {x: most, y: slope * most}]});
  return {items, most, sets: [...verdictSets(items), guide(1, "continuum = reference"),
    ...(isNumber(band) ? [guide(1 + band, `band ${plusMinus(band)}`), guide(1 - band, `band ${plusMinus(band)}`)] : [])]};
}

/** A chart of one observable at a time, which a menu chooses: `draw(place, observable)` adds and returns it. */
function chosenChart(parent, text, keys, draw) {
  const present = new Set(keys);
  const observables = [...Object.keys(QUANTITIES).filter((key) => present.delete(key)), ...present];
  if (!observables.length) return;
  const place = make("div");
  const chooser = make("select", {}, observables.map((key) => make("option", {value: key}, labelOf(key))));
  parent.append(make("label", {class: "chooser"}, text, chooser), place);
  let kept = null;
  const show = () => {
    if (kept) { kept.chart.destroy(); figures.splice(figures.indexOf(kept.figure), 1); }
    place.replaceChildren();
    kept = {chart: draw(place, chooser.value), figure: figures.at(-1)};
  };
  chooser.addEventListener("change", show);
  show();
}

function drawAgreement(parent, results) {
  const comparable = allRows(results, "truth").filter((row) => isNumber(row.continuum?.mean) && isNumber(row.reference) && !isDistance(row.observable) && !row.exact);
  chosenChart(parent, "One observable in its own unit: ", comparable.map((row) => row.observable), (place, key) => {
    const {items, most, sets} = agreementData(results, key);
    const unit = unitText(items[0].row.unit);
    const inUnit = unit ? ` (${unit})` : "";
    return addChart(place, {type: "scatter", caption: `Continuum against DEM reference: ${labelOf(key)}.`, note: "Bar: ± k·u.",
      description: `Scatter chart of ${labelOf(key)}, continuum against reference, ${items.length} points.`, sets, plugins: [errorBars],
      tip: ({point, row}) => [nameOf(point), `continuum ${number(row.continuum.mean)}, reference ${number(row.reference)}${inUnit}`],
      scales: {x: axis(`reference${inUnit}`, {max: most}), y: axis(`continuum${inUnit}`, {max: most})}});
  });
}

const HISTORY_MARKS = ["circle", "triangle", "rect", "rectRot", "cross", "crossRot", "star"];

/** What each point's observable was in one baseline after the other and is now, over its first accepted value. */
function historySets(results, key) {
  const accepted = list(results.history).map((entry) => list(entry.changes).filter((change) => change.observable === key));
  const now = new Map(pointsOf(results).map((point) => [point.name, list(point.drift).find((row) => row.observable === key)?.now]));
  return [...new Set(accepted.flat().map((change) => change.name))].map((name, k) => {
    let value;
    const values = [...accepted.map((changes) => value = changes.find((change) => change.name === name)?.new ?? value), now.get(name)];
    const first = values.find(isNumber);
    const data = values.map((y, n) => ({x: n + 1, y})).filter(({y}) => isNumber(y) && first !== 0).map(({x, y}) => ({x, y: y / first}));
    return {...lineSet("continuum", words(name), data), pointRadius: 4.5, pointStyle: HISTORY_MARKS[k % HISTORY_MARKS.length]};
  }).filter((set) => set.data.length);
}

function drawHistory(parent, results) {
  const last = results.history.length + 1;
  const keys = results.history.flatMap((entry) => list(entry.changes)).map((change) => change.observable)
      .filter((key) => historySets(results, key).length);
  chosenChart(parent, "One observable through all baselines: ", keys, (place, key) => {
    const sets = historySets(results, key);
    return addChart(place, {caption: `The continuum's ${labelOf(key)} in all accepted baselines, and now.`, note: "Over what was first accepted; a line for each point.",
      sets, description: `Line chart of the continuum's ${labelOf(key)} through the baselines, over the first. At last: ${lastValues(sets)}.`,
      scales: {x: axis("accepted baseline", {min: 0.5, max: last + 0.5, afterBuildTicks: (scale) => {
        scale.ticks = Array.from({length: last}, (_, n) => ({value: n + 1})); },
      ticks: {font: {size: chartFont(12)}, callback: (value) => value === last ? "now" : String(value)}}),
      y: axis("over the first", {beginAtZero: false, suggestedMin: 0.98, suggestedMax: 1.02})}});
  });
  parent.append(historyTable(results.history));
}

function drawDischarge(parent, fits) {
  const sets = fits.map((fit) => ({...lineSet(fit.code, `${codeOf(fit.code).label}${fit.material ? `, ${words(fit.material)}` : ""}`,
    points(list(fit.points).map((p) => p.opening_m), list(fit.points).map((p) => p.rate_kg_s), 1e-3, 1).sort((a, b) => a.x - b.x)), pointRadius: 4}))
      .filter((set) => set.data.length);
  if (sets.length) {
    addChart(parent, {caption: "Raw discharge rate against opening.", note: "As measured, nothing fitted; both axes logarithmic.", sets,
      description: `Line chart of the discharge rate against the opening. At the widest: ${lastValues(sets)}.`,
      scales: {x: axis("opening D (mm)", {type: "logarithmic", beginAtZero: false}), y: axis("rate W (kg/s)", {type: "logarithmic", beginAtZero: false})}});
  }
  parent.append(make("div", {class: "pair"}, rawRateTable(fits), beverlooTable(fits)));
}
