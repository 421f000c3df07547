// Puts the page together from the embedded data.
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

const titled = (title) => make("h3", {}, title);

function drawHeader(results) {
  const suite = results.suite ? `${results.suite} suite` : "unnamed suite";
  document.title = `Talus validation report: ${suite}`;
  document.getElementById("title").append(
      suite[0].toUpperCase() + suite.slice(1) + (results.title ? `: ${results.title}` : ""));
  const verdicts = (results.cases ?? []).flatMap((aCase) => aCase.summary ?? []).map((row) => row.verdict);
  const count = (verdict) => verdicts.filter((other) => other === verdict).length;
  const sentence = verdicts.length === 0 ? "Nothing was compared." :
      `Of ${verdicts.length} comparisons ${count("PASS")} passed, ${count("FAIL")} failed and ` +
      `${count("INCONCLUSIVE")} ${count("INCONCLUSIVE") === 1 ? "was" : "were"} inconclusive.`;
  document.getElementById("verdict").append(badge(results.verdict ?? "no verdict"), make("span", {}, sentence));
  const made = results.provenance ?? {};
  const dirty = made.git_dirty ? ", with uncommitted changes" : "";
  const hash = made.git_hash ? `git ${String(made.git_hash).slice(0, 12)}${dirty}` : null;
  document.getElementById("made").append(
      [made.version ? `Talus ${made.version}` : null, hash, made.time_utc, made.host].filter(Boolean).join(" · "));
  if (results.complete !== true) {
    const notice = document.getElementById("notice");
    notice.hidden = false;
    notice.append("These results are not complete: the suite was interrupted, or a run in it failed.");
  }
}

function drawCase(aCase, index, pictures) {
  const id = `case-${index}`;
  const section = make("section", {"aria-labelledby": id});
  document.getElementById("cases").append(section);
  const head = make("h2", {id, class: "case-head"}, make("span", {}, words(aCase.title ?? aCase.name)));
  if (aCase.verdict) head.append(badge(aCase.verdict));
  section.append(head);
  if (isNumber(aCase.column_length_m)) {
    section.append(make("p", {class: "muted"}, `Lengths are over the column length L₀ = ${number(1000 * aCase.column_length_m)} mm.`));
  }
  const runs = aCase.runs ?? [];
  guarded(section, "The verdict table", () => {
    section.append(titled("Verdicts"));
    section.append(aCase.summary?.length ? verdictTable(aCase.summary) : make("p", {class: "absent"}, "Nothing was compared."));
  });
  guarded(section, "The curves", () => {
    const charts = make("div", {class: "charts"});
    section.append(titled("Curves"), charts);
    drawCharts(charts, aCase);
  });
  guarded(section, "The deposits", () => {
    const deposits = make("div");
    section.append(titled("Deposits"), deposits);
    drawDeposits(deposits, aCase, pictures);
  });
  guarded(section, "The run tables", () => {
    section.append(titled("Runs"));
    section.append(...(runs.length ? runTables(runs) : [make("p", {class: "absent"}, "There were no runs.")]));
  });
  guarded(section, "The parameters", () => {
    const origin = {name: aCase.name, file: aCase.file, input_hash: aCase.input_hash};
    section.append(titled("Parameters"), make("div", {class: "facts"}, ...factTables("Case", origin),
        ...factTables("Parameters", aCase.parameters), ...factTables("Calibration", aCase.calibration)));
  });
}

function publish() {
  document.body.dataset.charts = figures.filter((figure) => figure.painted()).length;
  document.body.dataset.errors = window.reportErrors;
}

function drawAgain() { figures.forEach((figure) => figure.draw()); }

{
  const embedded = (id) => JSON.parse(document.getElementById(id).textContent);
  const main = document.querySelector("main");
  guarded(main, "The report", () => {
    const results = embedded("results");
    const pictures = embedded("pictures") ?? [];
    guarded(main, "The heading", () => drawHeader(results));
    (results.cases ?? []).forEach((aCase, index) => guarded(main, "A case", () => drawCase(aCase, index, pictures)));
    guarded(main, "The provenance", () =>
      document.getElementById("provenance").append(...factTables("Made by", results.provenance)));
  });
  publish();

  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", drawAgain);
  const printing = (on) => () => { document.documentElement.classList.toggle("printing", on); drawAgain(); };
  window.addEventListener("beforeprint", printing(true));
  window.addEventListener("afterprint", printing(false));
  let width = window.innerWidth;  // phones change the height alone whenever their address bar moves
  window.addEventListener("resize", () => { if (window.innerWidth !== width) { width = window.innerWidth; drawAgain(); } });
}
