// The tables of one point: verdicts, uncertainty budget, drift, runs, facts.
"use strict";

const dataLabel = ({label, unit}) => unit ? `${label} (${unit})` : label;

/**
 * A table under its caption, which stays in sight where the table scrolls. `columns`: {label, unit?, type?: "number" | "why"};
 * `rows`: lists of cells (text, element, or a list of them), the first of which is the row's heading. Of kind "cards" it becomes
 * one card for each row on a phone; the roles say again what the elements are, for that layout takes the table's display away.
 */
function table(caption, columns, rows, kind = "") {
  const head = columns.map(({label, unit, type}) =>
      make("th", {scope: "col", role: "columnheader", class: type}, label, unit ? make("small", {}, unit) : null));
  const body = rows.map((cells) => make("tr", {role: "row"}, ...cells.map((cell, k) => k === 0 ?
      make("th", {scope: "row", role: "rowheader"}, cell) :
      make("td", {role: "cell", "data-label": dataLabel(columns[k]), class: columns[k].type}, make("div", {class: "value"}, cell)))));
  return make("div", {class: "framed"}, make("p", {class: "caption"}, caption),
      make("div", {class: "scroller", role: "group", tabindex: "0", "aria-label": caption},
          make("table", {class: kind, role: "table", "aria-label": caption}, make("thead", {role: "rowgroup"}, make("tr", {role: "row"}, head)),
              make("tbody", {role: "rowgroup"}, body))));
}

const withUnit = (row) => unitText(row.unit) ? `${labelOf(row.observable)} (${unitText(row.unit)})` : labelOf(row.observable);

/** Mean, spread and number of one ensemble. */
function ensembleCell(statistics) {
  if (!isNumber(statistics?.mean)) return ABSENT;
  const size = Math.abs(statistics.mean);  // the spread to the digits of the mean
  const spread = isNumber(statistics.sd) && statistics.n !== 1 ?
      ` ± ${size >= 0.1 && size < 100 && statistics.sd >= 0.001 ? statistics.sd.toFixed(3) : number(statistics.sd)}` : "";
  const count = isNumber(statistics.n) ? make("small", {}, `n = ${statistics.n}`) : null;
  return make("span", {class: "number"}, number(statistics.mean) + spread, count);
}

const verdictCell = (row) => [badge(row.verdict), make("small", {class: "why"}, words(row.why).replaceAll(" %", "\u00a0%"))];

function truthTable(rows) {
  const figure = (label) => ({label, type: "number"});
  return table("Mean ± standard deviation over n runs; deviation from the DEM reference; practical band; k·u, the expanded uncertainty of the comparison",
      [{label: "Observable"}, figure("Continuum"), figure("LIGGGHTS"), figure("YADE"), figure("DEM reference"), figure("Deviation"), figure("Band"),
       figure("k·u"), {label: "Verdict"}],
      rows.map((row) => [withUnit(row), ensembleCell(row.continuum), ensembleCell(row.liggghts), ensembleCell(row.yade), number(row.reference),
        percent(row.deviation, !isDistance(row.observable)), plusMinus(row.band), plusMinus(row.uncertainty), verdictCell(row)]), "cards");
}

function budgetTable(rows) {
  const share = (label, unit) => ({label, unit, type: "number"});
  return table("Uncertainty budget: relative standard uncertainties of both sides, and k·u = k √(u² of DEM + u² of the continuum)",
      [{label: "Observable"}, share("seeds", "DEM"), share("codes", "DEM"), share("measuring", "DEM"), share("u", "DEM"), share("seeds", "continuum"),
       share("grid", "continuum"), share("time step", "continuum"), share("u", "continuum"), share("k"), share("k·u"), {label: "Where the band comes from", type: "why"}],
      rows.map((row) => {
        const dem = row.u_reference ?? {}, own = row.u_numerical ?? {};
        return [labelOf(row.observable), ...[dem.seeds, dem.codes, dem.measuring, dem.combined, own.seeds, own.grid, own.time_step,
          own.combined].map((u) => finePercent(u)), number(row.coverage_factor), finePercent(row.uncertainty), words(row.band_why)];
      }), "cards");
}

function driftTable(rows, caption = "Drift gate: continuum now against the accepted baseline.") {
  return table(caption, [{label: "Observable"}, {label: "Baseline", type: "number"}, {label: "Now", type: "number"},
    {label: "Change", type: "number"}, {label: "Tolerance", type: "number"}, {label: "Verdict"}],
  rows.map((row) => [row.heading ?? withUnit(row), number(row.baseline), number(row.now), finePercent(row.change, true),
    isNumber(row.tolerance) ? `±${finePercent(row.tolerance)}` : ABSENT, verdictCell(row)]), "cards");
}

/** Keys that any run has under `part`, the known ones first and in their order. */
function keysOf(runs, part) {
  const present = new Set(runs.flatMap((run) => Object.keys(run[part] ?? {})));
  const known = Object.keys(QUANTITIES).filter((key) => present.delete(key));
  return [...known, ...present];
}

/** One row for each run. `columns`: [label, unit, run => value]. */
function runTable(caption, runs, columns, kind = "runs") {
  const titles = columns.map(([label, unit]) => ({label, unit, type: kind === "runs" ? "number" : ""}));
  return table(caption, [{label: "Run"}, ...titles], runs.map((run) =>
      [[swatch(run.code), `${codeOf(run.code).label}, seed\u00a0${words(run.seed)}`], ...columns.map(([, , value]) => words(value(run)))]), kind);
}

/** The other way round where there are many keys: one row for each key, one column for each run. */
function keyTable(caption, runs, part) {
  const titles = runs.map((run) => ({label: `${codeOf(run.code).label}, seed\u00a0${words(run.seed)}`, type: "number"}));
  return table(caption, [{label: "Quantity"}, ...titles], keysOf(runs, part).map((key) =>
      [labelOf(key), ...runs.map((run) => words(run[part]?.[key]))]), "runs");
}

function runTables(runs, lengthUnit) {
  const unitOf = (unit) => unit === "length" ? (unitText(lengthUnit?.symbol) || "m") : unit === "1" ? "" : unit;
  const from = (part) => keysOf(runs, part).map((key) => {
    const [label, unit] = quantityOf(key);
    return [label, unitOf(unit), (run) => run[part]?.[key]];
  });
  const seconds = (key) => (run) => isNumber(run[key]) ? run[key].toFixed(1) : null;
  const exponent = (key) => (run) => isNumber(run[key]) ? powerOfTen(run[key].toExponential(1)) : null;
  const cost = [["CPU", "s", seconds("cpu_s")], ["wall", "s", seconds("wall_s")], ["items", "", (run) => run.count],
    ["time step", "s", exponent("time_step_s")], ["thickness", "mm", (run) => isNumber(run.thickness_m) ? 1000 * run.thickness_m : null],
    ["origin", "", (run) => run.origin]];
  const tables = [
    runTable("What each run measured", runs, [["status", "", (run) => run.status], ...from("observables")]),
    runTable("What each run took", runs, cost),
  ];
  for (const [part, caption] of [["solver", "What the solver says of itself"], ["preflight", "Checks before the discrete runs"]]) {
    const told = runs.filter((run) => run[part]);
    if (told.length) tables.push(keyTable(caption, told, part));
  }
  return tables;
}

/** Small tables of keys and values: one for the plain values of `data`, one for each object in it, and so down. */
function factTables(title, data) {
  const nested = (value) => value !== null && typeof value === "object" && !Array.isArray(value);
  const entries = Object.entries(data ?? {});
  const rows = entries.filter(([, value]) => !nested(value)).map(([key, value]) =>
      make("tr", {}, make("th", {scope: "row"}, key), make("td", {}, words(value, exactly))));
  const tables = rows.length ? [make("table", {}, make("caption", {}, title), make("tbody", {}, rows))] : [];
  for (const [key, value] of entries.filter(([, part]) => nested(part))) {
    tables.push(...factTables(`${title}: ${key}`, value));
  }
  return tables;
}

/** What made each run: enough to find it again; all that is known of it is in results.json. */
function originTable(runs) {
  const short = (hash) => hash ? String(hash).slice(0, 12) : null;
  return runTable("What made each run", runs, [["version", "", (run) => run.version], ["host", "", (run) => run.made_by?.host],
    ["compiler", "", (run) => run.made_by?.compiler], ["git", "", (run) => short(run.made_by?.git_hash)], ["input hash", "", (run) => short(run.input_hash)],
    ["command", "", (run) => Array.isArray(run.command) ? run.command.join(" ") : run.command]], "runs origins");
}
