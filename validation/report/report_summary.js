// The summary: everything that stands above the single points.
"use strict";

const pointsOf = (results) => list(results.points);
const nameOf = (point) => point.name ?? `${words(point.case)}/${words(point.point)}`;
function partsOf(point) {
  const [caseName, ...rest] = nameOf(point).split("/");
  return {caseName, pointName: rest.length ? rest.join("/") : caseName};
}
const titleOf = (point) => words(point.title ?? nameOf(point));
const allRows = (results, part) => pointsOf(results).flatMap((point) => list(point[part]));

function gateLine(title, verdict, sentence) {
  return make("p", {class: "overall"}, make("strong", {class: "gate"}, title), badge(verdict), make("span", {}, sentence));
}

const capitalised = (text) => text.charAt(0).toUpperCase() + text.slice(1);
const sentence = (text) => `${capitalised(text).replace(/[.]$/, "")}.`;

function drawHeader(results) {
  const suite = results.suite ? `${results.suite} suite` : "unnamed suite";
  document.title = `Talus validation report: ${suite}`;
  document.getElementById("title").append(capitalised(suite) + (results.title ? `: ${results.title}` : ""));
  const truth = allRows(results, "truth");
  const {drift} = results;
  const baseline = drift?.baseline ? `Baseline accepted ${words(drift.baseline.when)} by ${words(drift.baseline.who)}: ` +
      `${words(drift.baseline.why)}` : null;
  const drifted = allRows(results, "drift");
  document.getElementById("verdict").append(
      gateLine("Truth: agrees with DEM?", results.verdict, truth.length ? tally(truth) : "Nothing was compared."),
      gateLine("Drift: moved since the baseline?", drift?.verdict,
          [drifted.length ? tally(drifted) : "No comparison with a baseline.", drift?.why ? sentence(words(drift.why)) : null, baseline].filter(Boolean).join(" ")));
  const made = results.provenance ?? {};
  const dirty = made.git_dirty ? ", with uncommitted changes" : "";
  const hash = made.git_hash ? `git ${String(made.git_hash).slice(0, 12)}${dirty}` : null;
  document.getElementById("made").append(
      [made.version ? `Talus ${made.version}` : null, hash, made.time_utc, made.host].filter(Boolean).join(" · "));
  const troubles = [results.complete !== true ? "These results are not complete: the suite was interrupted, or a run in it failed." : null,
    results.stale ? `These results are stale, so neither gate passes: ${words(results.stale)}. Run the suite again.` : null].filter(Boolean);
  const notice = document.getElementById("notice");
  notice.hidden = !troubles.length;
  notice.append(troubles.join(" "));
}

/** Points of one case against its observables; each cell holds the verdict's sign, a number, and a link to the point. */
function matrixOf(points, part, caption, figureOf) {
  const rowsOf = (point) => list(point[part]);
  const present = new Set(points.flatMap(rowsOf).map((row) => row.observable));
  const observables = [...Object.keys(QUANTITIES).filter((key) => present.delete(key)), ...present];
  const cell = (point, row) => row ? make("a", {href: `#${anchorOf(nameOf(point))}`, class: `cell ${signOf(row.verdict) ? row.verdict : ""}`,
    "aria-label": `${titleOf(point)}, ${labelOf(row.observable)}: ${words(row.verdict)}, ${figureOf(row)}`},
  make("b", {"aria-hidden": "true"}, signOf(row.verdict) ?? "·"), figureOf(row)) : make("span", {class: "absent"}, ABSENT);
  return table(caption, [{label: "Point"}, {label: "All"}, ...observables.map((key) => ({label: labelOf(key)}))],
      points.map((point) => [pointLink(nameOf(point), ...breakable(partsOf(point).pointName)),
        badge(part === "truth" ? point.verdict : point.drift_verdict),
        ...observables.map((key) => cell(point, rowsOf(point).find((row) => row.observable === key)))]), "matrix");
}

/** A matrix for each case: others share few of its observables. */
function matrices(results, part, caption, figureOf) {
  if (!allRows(results, part).length) return absent("Nothing was compared.");
  const cases = [...new Set(pointsOf(results).map((point) => partsOf(point).caseName))];
  return make("div", {}, make("p", {class: "muted"}, caption), cases.map((name) =>
      matrixOf(pointsOf(results).filter((point) => partsOf(point).caseName === name), part, capitalised(name.replaceAll("_", " ")), figureOf)));
}

const truthFigure = (row) => percent(row.deviation, !isDistance(row.observable));
const driftFigure = (row) => finePercent(row.change, true);

function metricsTable(metrics) {
  const under = (text) => make("small", {}, text);
  const shares = (pair) => list(pair).length === 2 ? `${percent(pair[0])} to ${percent(pair[1])}` : ABSENT;
  const shown = (equivalent) => equivalent === true ? "✓ shown" : equivalent === false ? "not shown" : ABSENT;
  return table("Over all points, in the manner of the NIST fire-model validation guide. Bias factor: the continuum over the reference, 1 is none. " +
      "Below a value: its 95 % confidence interval.",
  [{label: "Observable"}, {label: "Points", type: "number"}, {label: "Bias factor", type: "number"}, {label: "Relative sd of the model", type: "number"},
   {label: "Relative sd of the reference", type: "number"}, {label: "Equivalence", type: "number"}],
  metrics.map((row) => [labelOf(row.observable), number(row.n), [number(row.bias_factor), under(interval(row.bias_interval))],
    [percent(row.model_relative_sd), under(shares(row.model_relative_sd_interval))], percent(row.reference_relative_sd),
    [shown(row.equivalence?.equivalent), row.equivalence ? under(`within ${plusMinus(row.equivalence.band)}, p = ${number(row.equivalence.p)}`) : under("too few points")]]), "cards");
}

function mutantTable(mutants) {
  const survivors = mutants.filter((mutant) => mutant.killed !== true).length;
  const by = (mutant) => list(mutant.by).length ? make("ul", {class: "plain"}, list(mutant.by).map((kill) =>
      make("li", {}, pointLink(kill.name, words(kill.name)), `: ${labelOf(kill.observable)} ${words(kill.verdict)}`))) : ABSENT;
  return make("div", {}, make("p", {}, `Each solver below was broken on purpose; the truth gate must turn red. ` +
      `${mutants.length - survivors} of ${mutants.length} were caught` + (survivors ? `; ${survivors} survived, which is a finding.` : ".")),
  table("Mutation check", [{label: "What was broken"}, {label: "Caught?"}, {label: "Runs", type: "number"}, {label: "Caught by", type: "why"}],
      mutants.map((mutant) => [words(mutant.title ?? mutant.name),
        make("span", {class: `badge ${mutant.killed === true ? "PASS" : "FAIL"}`}, make("span", {}, mutant.killed === true ? "✓ CAUGHT" : "✕ SURVIVED")),
        number(mutant.runs), by(mutant)]), "cards"));
}

const openingText = (metres) => isNumber(metres) ? exactly(Number((1000 * metres).toPrecision(6))) : ABSENT;
const fitTitle = (fit) => [swatch(fit.code), `${codeOf(fit.code).label}${fit.material ? `, ${words(fit.material)}` : ""}`];

function rawRateTable(fits) {
  const rows = fits.flatMap((fit) => list(fit.points).map((point) => [fitTitle(fit),
    openingText(point.opening_m), number(point.rate_kg_s)]));
  return table("Raw: mass rates as measured", [{label: "Code"}, {label: "Opening", unit: "mm", type: "number"}, {label: "Rate", unit: "kg/s", type: "number"}], rows);
}

function beverlooTable(fits) {
  const pair = (value, error) => isNumber(value) ? number(value) + (isNumber(error) ? ` ± ${number(error)}` : "") : ABSENT;
  return table("Corrected: Beverloo's law W = C ρ √g (D − k d)ⁿ fitted to the rates; ± standard error",
      [{label: "Code"}, {label: "C", type: "number"}, {label: "k", type: "number"}, {label: "Exponent n, fitted free", type: "number"}],
      fits.map((fit) => [fitTitle(fit), pair(fit.C, fit.C_error), pair(fit.k, fit.k_error), pair(fit.exponent, fit.exponent_error)]));
}

/** CPU seconds of one run, the mean over the seeds. */
function costTable(results) {
  const mean = (values) => values.length ? values.reduce((sum, value) => sum + value, 0) / values.length : null;
  const rows = pointsOf(results).map((point) => {
    const cost = (code) => mean(list(point.runs).filter((run) => run.code === code).map((run) => run.cpu_s).filter(isNumber));
    const own = cost("continuum");
    const ratio = (code) => isNumber(own) && own > 0 && isNumber(cost(code)) ? `${exactly(Number((cost(code) / own).toPrecision(2)))} ×` : ABSENT;
    const seconds = (code) => isNumber(cost(code)) ? cost(code).toFixed(1) : ABSENT;
    return [pointLink(nameOf(point), nameOf(point)), seconds("continuum"), seconds("liggghts"), seconds("yade"), ratio("liggghts"), ratio("yade")];
  });
  return table("CPU seconds of one run, mean over its seeds; the last two columns: how much dearer than the continuum. What each run took, and on " +
      "what thickness, is in its point's tables.",
  [{label: "Point"}, {label: "Continuum", unit: "s", type: "number"}, {label: "LIGGGHTS", unit: "s", type: "number"}, {label: "YADE", unit: "s", type: "number"},
   {label: "LIGGGHTS", unit: "/ continuum", type: "number"}, {label: "YADE", unit: "/ continuum", type: "number"}], rows);
}

function drawChanges(parent, results) {
  const moved = pointsOf(results).flatMap((point) => list(point.drift).filter((row) => row.verdict !== "PASS")
      .map((row) => ({...row, heading: [pointLink(nameOf(point), nameOf(point)), make("br"), withUnit(row)]})));
  if (!allRows(results, "drift").length) {
    parent.append(absent(results.drift?.why ? words(results.drift.why) : "There is no baseline to compare with."));
    return;
  }
  parent.append(moved.length ? driftTable(moved, "What moved beyond its tolerance, or could not be judged") :
      make("p", {}, "Nothing moved beyond its tolerance."));
  parent.append(matrices(results, "drift", "Drift gate: relative change of the continuum since the baseline.", driftFigure));
}

/** Old and new value of each change; of many, only how many there are until they are asked for. */
function changesCell(changes) {
  const few = 8;
  if (!changes.length) return ABSENT;
  const all = make("ul", {class: "plain"}, changes.map((change) => make("li", {},
      pointLink(change.name, words(change.name)), ` ${labelOf(change.observable)}: ${number(change.old)} → ${number(change.new)}`)));
  return changes.length <= few ? all : make("details", {}, make("summary", {}, `${changes.length} values`), all);
}

function historyTable(history) {
  const rows = [...history].reverse().map((entry) => [words(entry.when), words(entry.who), words(entry.why), words(String(entry.git_hash ?? "").slice(0, 12)),
    changesCell(list(entry.changes))]);
  return table("Accepted baselines, the latest first", [{label: "When"}, {label: "Who"}, {label: "Why", type: "why"}, {label: "git"},
    {label: "What changed, old → new", type: "why"}], rows, "cards");
}
