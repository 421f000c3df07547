// Words and numbers: what things are called, how a value reads, and the small elements that every part of the page uses.
// All text reaches the page as text nodes, never as markup.
"use strict";

const ABSENT = "–";

// `family` gives the colour; the two extra continuum runs serve only to tell the numerical uncertainty.
const CODES = {
  continuum: {label: "Continuum", family: "continuum", items: "particles", line: "", dash: []},
  liggghts: {label: "LIGGGHTS", family: "liggghts", items: "grains", line: "dashed", dash: [7, 3]},
  yade: {label: "YADE", family: "yade", items: "grains", line: "dotted", dash: [2, 2.5]},
  continuum_coarse: {label: "Continuum, coarse grid", family: "continuum", items: "particles", line: "thin dashed", dash: [9, 5]},
  continuum_short_steps: {label: "Continuum, half steps", family: "continuum", items: "particles", line: "thin dotted", dash: [1.5, 4]},
};
const codeOf = (name) => Object.hasOwn(CODES, name) ? CODES[name] :
    {label: String(name), family: "other", items: "items", line: "", dash: [9, 3, 2, 3]};
const codePlace = (name) => Object.hasOwn(CODES, name) ? Object.keys(CODES).indexOf(name) : Object.keys(CODES).length;
const inCodeOrder = (things) => [...things].sort((a, b) => codePlace(a.code) - codePlace(b.code) || a.seed - b.seed);
const isDem = (code) => !String(code).startsWith("continuum");

// Label and unit of what a run reports; a key that is not here is shown under its own name.
const QUANTITIES = {
  x90: ["x90", "length"], x95: ["x95", "length"], centre_of_mass: ["centre of mass", "length"],
  runout: ["runout", "length"], r90: ["r90", "length"], r95: ["r95", "length"], mean_radius: ["mean radius", "length"],
  final_height: ["final height", "length"], front: ["front", "length"], height: ["height", "length"],
  profile_L1: ["profile, L1 distance", "1"], stop_time: ["stop time", "s"], roundness: ["roundness", "1"],
  beverloo_C: ["Beverloo's C", "1"], discharge_rate: ["discharge rate", "kg/s"], discharge_rate_error: ["its standard error", "kg/s"],
  window_start: ["window start", "s"], window_end: ["window end", "s"], residual: ["left behind", "1"],
  flatness: ["flatness", "1"], emptied_time: ["emptied at", "s"], released_mass: ["released mass", "kg"], mass: ["mass left", "kg"],
  repose_angle: ["repose angle", "°"], repose_angle_fit_error: ["fit error", "°"],
  repose_angle_sector_deviation: ["between sectors", "°"], crest_height: ["crest height", "m"],
  settled_height: ["settled height", "length"], settled_volume_fraction: ["settled volume fraction", "1"],
  volume_fraction: ["volume fraction", "1"], lost_volume: ["lost volume", "1"], at_rest: ["at rest", ""],
  bulk_density: ["bulk density over its limit", "1"], support: ["weight borne by floor and walls", "1"],
  penetration_depth: ["penetration depth", "m"], depth: ["depth of the sphere", "m"], speed: ["speed of the sphere", "m/s"],
  depth_curve_L1: ["depth in time, L1 distance", "1"], contact_speed: ["speed at contact", "m/s"],
  mass_error: ["mass error", "1"], rayleigh_fraction: ["step / Rayleigh time", "1"], hertz_fraction: ["step / Hertz time", "1"],
};
/** Areas between curves have a deviation that is never negative, and no value of their own. */
const isDistance = (observable) => String(observable).endsWith("_L1");
const quantityOf = (key) => Object.hasOwn(QUANTITIES, key) ? QUANTITIES[key] : [String(key).replaceAll("_", " "), ""];
const labelOf = (observable) => quantityOf(observable)[0];
const UNITS = {L0: "L₀", R0: "R₀", deg: "°", 1: ""};
const unitText = (unit) => unit === null || unit === undefined ? "" : Object.hasOwn(UNITS, unit) ? UNITS[unit] : String(unit);

/** An element: make("p", {class: "muted"}, "text", childElement, ...). */
function make(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value !== undefined && value !== null) element.setAttribute(name, value);
  }
  element.append(...children.flat().filter((child) => child !== null && child !== undefined));
  return element;
}

const isNumber = (value) => typeof value === "number" && Number.isFinite(value);
const list = (value) => Array.isArray(value) ? value : [];
const absent = (text) => make("p", {class: "absent"}, text);

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
    text = size >= 100 ? value.toFixed(1) : size < 0.1 ? value.toPrecision(3) : value.toFixed(3);
  }
  return text.replace(/^-/, "−");
}

/** A share as per cent; `signed` for deviations and changes. */
function percent(value, signed = false, decimals = 1) {
  if (!isNumber(value)) return ABSENT;
  const text = `${Math.abs(100 * value).toFixed(decimals)} %`;
  const sign = value < 0 ? "−" : "+";
  return signed ? (Number.parseFloat(text) === 0 ? text : sign + text) : text;
}
/** What is small is not nothing: uncertainties below a tenth of a per cent keep their digits. */
const finePercent = (value, signed = false) => percent(value, signed, isNumber(value) && value !== 0 && Math.abs(value) < 1e-3 ? 3 : 1);
const plusMinus = (value) => isNumber(value) ? `±${percent(value)}` : ABSENT;
const interval = (pair) => list(pair).length === 2 ? `${number(pair[0])} to ${number(pair[1])}` : ABSENT;

/** What was put in, not measured: every digit that was given and no more. */
function exactly(value) {
  const size = Math.abs(value);
  const text = value !== 0 && (size < 1e-3 || size >= 1e6) ? powerOfTen(value.toExponential()) : String(Number(value.toPrecision(14)));
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

const SIGNS = {PASS: "✓", FAIL: "✕", INCONCLUSIVE: "?"};
const signOf = (verdict) => Object.hasOwn(SIGNS, verdict) ? SIGNS[verdict] : null;

function badge(verdict) {
  const sign = signOf(verdict);
  const text = sign ? `${sign} ${verdict}` : words(verdict ?? "no verdict");
  return make("span", {class: sign ? `badge ${verdict}` : "badge"}, make("span", {}, text));
}

/** The line sample that stands for a code in tables, as in the charts. */
function swatch(code) {
  const line = make("span", {class: `swatch ${codeOf(code).line}`, "aria-hidden": "true"});
  line.style.borderTopColor = `var(--${codeOf(code).family})`;
  return line;
}

/** "12 passed, 1 failed, 2 inconclusive" of rows that carry a verdict. */
function tally(rows) {
  const count = (verdict) => rows.filter((row) => row.verdict === verdict).length;
  const parts = [[count("PASS"), "passed"], [count("FAIL"), "failed"], [count("INCONCLUSIVE"), "inconclusive"]];
  const odd = rows.length - parts.reduce((sum, [n]) => sum + n, 0);
  if (odd) parts.push([odd, "without a verdict"]);
  return `Of ${rows.length} ${rows.length === 1 ? "comparison" : "comparisons"}: ` +
      parts.filter(([n], k) => n || k < 2).map(([n, what]) => `${n} ${what}`).join(", ") + ".";
}

const anchors = new Map();  // name of a point -> the id of its section
/** The link target of a point; ids are unique whatever the names. */
function anchorOf(name) {
  if (!anchors.has(name)) {
    const plain = `point-${String(name).replaceAll(/[^A-Za-z0-9_.]+/g, "-").slice(0, 80)}`;
    const taken = new Set(anchors.values());
    anchors.set(name, taken.has(plain) ? `${plain}-${anchors.size}` : plain);
  }
  return anchors.get(name);
}
/** A name that may break into lines after a slash or an underscore. */
const breakable = (name) => String(name).split(/(?<=[/_])/).flatMap((part, k) => k ? [make("wbr"), part] : [part]);
/** A link to a point's section, or plain text where the report has no such point. */
const pointLink = (name, ...content) => anchors.has(name) ? make("a", {href: `#${anchors.get(name)}`}, ...content) : make("span", {}, ...content);
