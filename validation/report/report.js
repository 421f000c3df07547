// Puts the page together from the embedded data. The summary is drawn at once; a point when its section is opened, when the
// address ends in #all, and before printing, so that a long report opens quickly.
"use strict";

/** Runs one part of the page; a part that fails says so in its place and does not take the others with it. */
function guarded(parent, what, action) {
  try {
    action();
  } catch (error) {
    window.reportErrors += 1;
    parent.append(make("p", {class: "notice"}, `${what} could not be drawn: ${error.message}`));
  }
}

const embedded = (id) => JSON.parse(document.getElementById(id).textContent);
let storedPictures = null;  // parsed when first needed: most of the file
const pictures = () => storedPictures ??= list(embedded("pictures"));
const sections = [];  // {element, draw()} of each point

/** One part of the summary; a part with nothing in it is left out. */
function part(id, title, present, draw) {
  const section = document.getElementById(id);
  section.hidden = !present;
  if (!present) return;
  section.append(make("h2", {id: `${id}-title`}, title));
  document.getElementById("contents").append(make("li", {}, make("a", {href: `#${id}`}, title)));
  guarded(section, title, () => draw(section));
}

function drawSummary(results) {
  part("matrix", "Verdicts", pointsOf(results).length, (section) => section.append(matrices(results, "truth",
      "Truth gate: relative deviation of the continuum from the DEM reference, or from what a law demands. ✓ pass, ✕ fail, ? inconclusive.", truthFigure)));
  part("scatter", "Continuum against reference", allRows(results, "truth").length,
      (section) => { drawRatios(section, results); drawAgreement(section, results); });
  part("metrics", "Whole-suite metrics", list(results.metrics).length, (section) => section.append(metricsTable(results.metrics)));
  part("mutants", "Mutation check", list(results.mutants).length, (section) => section.append(mutantTable(results.mutants)));
  part("discharge", "Discharge: raw and corrected", list(results.beverloo).length, (section) => drawDischarge(section, results.beverloo));
  part("cost", "Cost", pointsOf(results).some((point) => list(point.runs).length), (section) => section.append(costTable(results)));
  part("changes", "What changed since the baseline", true, (section) => drawChanges(section, results));
  part("history", "History of baselines", list(results.history).length, (section) => drawHistory(section, results));
}

const titled = (title) => make("h4", {}, title);

function drawPoint(section, point) {
  const runs = list(point.runs);
  if (isNumber(point.length_unit?.metres)) {
    section.append(make("p", {class: "muted"}, `Lengths are over ${unitText(point.length_unit.symbol)} = ${number(1000 * point.length_unit.metres)} mm.`));
  }
  guarded(section, "The truth gate", () => {
    section.append(titled("Truth: continuum against DEM"));
    section.append(...(point.truth?.length ? [truthTable(point.truth), budgetTable(point.truth)] : [absent("Nothing was compared.")]));
  });
  guarded(section, "The drift gate", () => {
    section.append(titled("Drift: continuum against its baseline"));
    section.append(point.drift?.length ? driftTable(point.drift) : absent("No comparison with a baseline."));
  });
  const block = (title, className, draw) => guarded(section, title, () => {
    const place = make("div", {class: className});
    section.append(titled(title), place);
    draw(place);
  });
  block("Curves", "", (place) => drawCurves(place, point));
  block("The flow and the deposit", "flow", (place) => drawAnimation(place, point, pictures()));
  block("Fields", "fields", (place) => drawFields(place, point, pictures()));
  block("Runs", "", (place) => place.append(...(runs.length ? [...runTables(inCodeOrder(runs), point.length_unit), originTable(inCodeOrder(runs))] : [absent("There were no runs.")])));
  block("Parameters", "facts", (place) => {
    const {name, file, input_hash, kind, family, tags} = point;
    place.append(...factTables("Case", {name, family, kind, tags, file, input_hash}), ...factTables("Parameters", point.parameters),
        ...factTables("Calibration", point.calibration));
  });
}

function addPoint(point) {
  const body = make("div", {class: "body"});
  const summary = make("summary", {}, make("h3", {class: "point-head"}, titleOf(point)),
      make("span", {class: "gates"}, make("small", {}, "truth"), badge(point.verdict), make("small", {}, "drift"), badge(point.drift_verdict)));
  const element = make("details", {id: anchorOf(nameOf(point)), class: "point"}, summary, body);
  let drawn = false;
  const draw = () => {
    if (drawn) return;
    drawn = true;
    element.open = true;  // what is folded away has no width to draw in
    drawPoint(body, point);
    publish();
  };
  element.addEventListener("toggle", () => { if (element.open) draw(); });
  document.getElementById("points").append(element);
  sections.push({element, draw});
}

function publish() {
  for (const figure of figures) figure.seen ||= figure.painted();  // reading pixels back is slow: once each
  document.body.dataset.charts = figures.filter((figure) => figure.seen).length;
  document.body.dataset.errors = window.reportErrors;
}

const drawAgain = () => figures.forEach((figure) => figure.draw());

function drawAll() {
  sections.forEach(({element, draw}) => { element.open = true; draw(); });
}

/** Opens the point that the address names, and goes there. */
function follow() {
  const wanted = decodeURIComponent(location.hash.slice(1));
  if (wanted === "all") {
    document.documentElement.classList.add("all");
    drawAll();
    return;
  }
  const section = sections.find(({element}) => element.id === wanted);
  if (!section) return;
  section.element.open = true;
  section.draw();
  section.element.scrollIntoView();
}

{
  const main = document.querySelector("main");
  guarded(main, "The report", () => {
    const results = embedded("results");
    pointsOf(results).forEach((point) => anchorOf(nameOf(point)));
    guarded(main, "The heading", () => drawHeader(results));
    guarded(main, "The summary", () => drawSummary(results));
    pointsOf(results).forEach((point) => guarded(main, "A point", () => addPoint(point)));
    document.getElementById("points-section").hidden = !sections.length;
    guarded(main, "The provenance", () => document.getElementById("provenance").append(...factTables("Made by", results.provenance)));
    const few = 1;  // a single point need not be looked for
    if (sections.length <= few) drawAll();
    guarded(main, "The point", follow);
  });
  publish();

  window.addEventListener("hashchange", follow);
  document.addEventListener("click", (event) => {  // the same link again changes no address
    const link = event.target.closest?.("a");
    if (link && link.hash && link.hash === location.hash) follow();
  });
  document.getElementById("open-all").addEventListener("click", drawAll);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", drawAgain);
  const printing = (on) => () => {
    document.documentElement.classList.toggle("printing", on);
    if (on) drawAll();
    drawAgain();
  };
  window.addEventListener("beforeprint", printing(true));
  window.addEventListener("afterprint", printing(false));
  let width = window.innerWidth;  // phones change the height alone whenever their address bar moves
  window.addEventListener("resize", () => { if (window.innerWidth !== width) { width = window.innerWidth; drawAgain(); } });
}
