// Words, numbers and tables. All text reaches the page as text nodes, never as markup.
"use strict";

const ABSENT = "–";

const BACKENDS = {
  continuum: {label: "Continuum", items: "particles", line: "", dash: []},
  liggghts: {label: "LIGGGHTS", items: "grains", line: "dashed", dash: [7, 3]},
  yade: {label: "YADE", items: "grains", line: "dotted", dash: [2, 2.5]},
};
const backendOf = (name) => BACKENDS[name] ?? {label: String(name), items: "items", line: "", dash: [9, 3, 2, 3]};

// Label and unit of what a run reports; a key that is not here is shown under its own name.
const QUANTITIES = {
  x90: ["x90", "L₀"],
  x95: ["x95", "L₀"],
  centre_of_mass: ["centre of mass", "L₀"],
  runout: ["runout", "L₀"],
  final_height: ["final height", "L₀"],
  stop_time: ["stop time", "s"],
  settled_height: ["settled height", "L₀"],
  settled_volume_fraction: ["settled volume fraction", "1"],
  lost_volume: ["lost volume", "1"],
  at_rest: ["at rest", ""],
  steps: ["steps", ""],
  cap_hits: ["cap hits", ""],
  friction_iterations: ["friction iterations", ""],
  pressure_iterations: ["pressure iterations", ""],
  converged: ["converged", ""],
  mass_error: ["mass error", "1"],
  rayleigh_fraction: ["step / Rayleigh time", "1"],
  hertz_fraction: ["step / Hertz time", "1"],
};
const quantityOf = (key) => QUANTITIES[key] ?? [String(key).replaceAll("_", " "), ""];

/** An element: make("p", {class: "muted"}, "text", childElement, ...). */
function make(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value !== undefined && value !== null) element.setAttribute(name, value);
  }
  element.append(...children.filter((child) => child !== null && child !== undefined));
  return element;
}

const isNumber = (value) => typeof value === "number" && Number.isFinite(value);

/** "3.5e-5" as 3.5 × 10⁻⁵. */
function powerOfTen(text) {
  const [digits, power] = text.split("e");
  const raised = [...String(Number(power))].map((c) => "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"["-0123456789".indexOf(c)]).join("");
  return `${digits} × 10${raised}`;
}

/** Three decimals for what is near one, otherwise as many digits as say something. */
function number(value) {
  if (!isNumber(value)) return ABSENT;
  const size = Math.abs(value);
  let text;
  if (Number.isInteger(value) && size < 1e15) {
    text = value.toLocaleString("en").replaceAll(",", "\u202f");
  } else if (size >= 1e6 || size < 1e-3) {
    text = powerOfTen(value.toExponential(2));
  } else {
    text = size >= 100 ? value.toFixed(1) : value.toFixed(3);
  }
  return text.replace(/^-/, "−");
}

const percent = (value, signed) => {
  if (!isNumber(value)) return ABSENT;
  const text = `${Math.abs(100 * value).toFixed(1)} %`;
  return signed ? (value < 0 ? "−" : "+") + text : text;
};

/** What was put in, not measured: every digit that was given and no more. */
function exactly(value) {
  const size = Math.abs(value);
  const text = value !== 0 && (size < 1e-3 || size >= 1e6) ? powerOfTen(value.toExponential()) : String(value);
  return text.replace(/^-/, "−");
}

/** Any value of the data as text. */
function words(value, numberText = number) {
  if (value === null || value === undefined || value === "") return ABSENT;
  if (typeof value === "boolean") return value ? "yes" : "no";
  if (typeof value === "number") return numberText(value);
  if (Array.isArray(value) && value.every((part) => typeof part !== "object")) {
    return value.map((part) => words(part, numberText)).join(", ");
  }
  return typeof value === "object" ? JSON.stringify(value) : String(value);
}

function badge(verdict) {
  const sign = {PASS: "✓", FAIL: "✕", INCONCLUSIVE: "?"}[verdict];
  const text = sign ? `${sign} ${verdict}` : words(verdict);
  return make("span", {class: sign ? `badge ${verdict}` : "badge"}, make("span", {}, text));
}

/** The line sample that stands for a backend in tables, as in the charts. */
function swatch(backend) {
  const line = make("span", {class: `swatch ${backendOf(backend).line}`, "aria-hidden": "true"});
  line.style.borderTopColor = `var(--${backend in BACKENDS ? backend : "other"})`;
  return line;
}

const headCell = (label, unit) => make("th", {scope: "col"}, label, unit ? make("small", {}, unit) : null);

function scroller(label, table) {
  return make("div", {class: "scroller", role: "region", tabindex: "0", "aria-label": label}, table);
}

/** Mean, spread and number of one ensemble. */
function ensembleCell(label, statistics) {
  const cell = make("td", {"data-label": label, role: "cell"});
  if (!isNumber(statistics?.mean)) {
    cell.append(ABSENT);
    return cell;
  }
  const spread = isNumber(statistics.sd) ? ` ± ${Math.abs(statistics.mean) < 100 ? statistics.sd.toFixed(3) : number(statistics.sd)}` : "";
  const count = isNumber(statistics.n) ? make("small", {}, `n = ${statistics.n}`) : null;
  cell.append(make("span", {class: "number"}, number(statistics.mean) + spread, count));
  return cell;
}

// The roles say again what the elements are, for the phone layout takes the table's display away.
function verdictTable(summary) {
  const table = make("table", {class: "verdicts", role: "table"});
  table.append(make("caption", {}, "Mean ± standard deviation over n runs. Deviation: continuum against the DEM mean."));
  const titles = ["Observable", "Continuum", "LIGGGHTS", "YADE", "DEM mean", "Deviation", "Band", "Verdict", "Why"];
  table.append(make("thead", {role: "rowgroup"}, make("tr", {role: "row"}, ...titles.map(
      (title) => make("th", {scope: "col", role: "columnheader", class: title === "Why" ? "why" : null}, title)))));
  const rows = summary.map((row) => {
    const [label, unit] = quantityOf(row.observable);
    const shown = {L0: "L₀"}[row.unit] ?? row.unit ?? unit;
    return make("tr", {role: "row"},
        make("th", {scope: "row", role: "rowheader"}, shown && shown !== "1" ? `${label} (${shown})` : label),
        ensembleCell("Continuum", row.continuum), ensembleCell("LIGGGHTS", row.liggghts),
        ensembleCell("YADE", row.yade), ensembleCell("DEM mean", row.reference),
        make("td", {"data-label": "Deviation", role: "cell", class: "number"}, percent(row.deviation, true)),
        make("td", {"data-label": "Band", role: "cell", class: "number"},
            isNumber(row.band) ? `±${percent(row.band, false)}` : ABSENT),
        make("td", {"data-label": "Verdict", role: "cell"}, badge(row.verdict)),
        make("td", {"data-label": "Why", role: "cell", class: "why"}, words(row.why)));
  });
  table.append(make("tbody", {role: "rowgroup"}, ...rows));
  return scroller("Verdicts", table);
}

/** Keys that any run has under `part`, the known ones first and in their order. */
function keysOf(runs, part) {
  const present = new Set(runs.flatMap((run) => Object.keys(run[part] ?? {})));
  const known = Object.keys(QUANTITIES).filter((key) => present.delete(key));
  return [...known, ...present];
}

/** One row for each run. `columns`: [label, unit, run => value]. */
function runTable(caption, runs, columns) {
  const table = make("table", {class: "runs"}, make("caption", {}, caption));
  table.append(make("thead", {}, make("tr", {}, headCell("Run"), ...columns.map(([label, unit]) => headCell(label, unit)))));
  const rows = runs.map((run) => make("tr", {},
      make("th", {scope: "row"}, swatch(run.backend), `${backendOf(run.backend).label}, seed\u00a0${words(run.seed)}`),
      ...columns.map(([, , value]) => make("td", {class: "number"}, words(value(run))))));
  table.append(make("tbody", {}, ...rows));
  return scroller(caption, table);
}

function runTables(runs) {
  const from = (part) => keysOf(runs, part).map((key) => {
    const [label, unit] = quantityOf(key);
    return [label, unit === "1" ? "" : unit, (run) => run[part]?.[key]];
  });
  const seconds = (key) => (run) => isNumber(run[key]) ? run[key].toFixed(1) : null;
  const cost = [
    ["CPU", "s", seconds("cpu_s")], ["wall", "s", seconds("wall_s")], ["items", "", (run) => run.count],
    ["time step", "s", (run) => isNumber(run.time_step_s) ? powerOfTen(run.time_step_s.toExponential(1)) : null],
    ...from("solver"), ...from("preflight"), ["version", "", (run) => run.version],
  ];
  return [
    runTable("What each run measured (lengths over L₀)", runs, [["status", "", (run) => run.status], ...from("observables")]),
    runTable("What each run took", runs, cost),
  ];
}

/** Small tables of keys and values: one for the plain values of `data`, one for each object in it, and so down. */
function factTables(title, data) {
  const nested = (value) => value !== null && typeof value === "object" && !Array.isArray(value);
  const entries = Object.entries(data ?? {});
  const rows = entries.filter(([, value]) => !nested(value)).map(([key, value]) =>
      make("tr", {}, make("th", {scope: "row"}, key), make("td", {}, words(value, exactly))));
  const tables = rows.length ? [make("table", {}, make("caption", {}, title), make("tbody", {}, ...rows))] : [];
  for (const [key, value] of entries.filter(([, part]) => nested(part))) {
    tables.push(...factTables(`${title}: ${key}`, value));
  }
  return tables;
}
