// The DH table with its uncertainties, the digits of result.json behind them, and what sweepd warns of.
import { bdi, element, head, panel, row, say } from "./text.js";

const NUMBERS = [["b", "_mm", "b", "mm"], ["theta", "_deg", "θ", "°"], ["a", "_mm", "a", "mm"], ["alpha", "_deg", "α", "°"], ["beta", "_deg", "β", "°"]];
const STATUS = {
  complete: "Every joint has an axis, and nothing in the data contradicts the result.",
  doubtful: "Something in the data contradicts the result: do not use the numbers before the reasons under Warnings are understood.",
  partial: "The result is not complete",
  failed: "Nothing is identified",
};
const NONE = "–";
const NO_RESULT = "No result yet: it comes once enough joints were swept.";
/** Of each column, so that points stand below each other. */
const DECIMALS = { value: 4, sigma: 5, specified: 3 };

function shown(digits, decimals) {
  if (digits === null || digits === undefined) return NONE;
  const fixed = Number(digits).toFixed(decimals);
  if (Number(fixed) !== 0) return fixed;
  return Number(digits) > 0 && decimals === DECIMALS.sigma ? `<${(10 ** -decimals).toFixed(decimals)}` : (0).toFixed(decimals);
}

/** Ends the sentence of STATUS. */
function because({ status, reason }) {
  const open = status === "partial" || status === "failed";
  if (!reason) return open ? "." : "";
  return `${open ? ":" : " The reason:"} ${reason}${/[.?!]$/.test(reason) ? "" : "."}`;
}

export function make_table() {
  const body = element("tbody");
  const status = element("p", { id: "result", role: "status" }, NO_RESULT);
  const table = element("table", { class: "dh" },
    element("caption", {}, "Identified values with their standard uncertainty; “set” is by convention, not identified."),
    head("Joint", "Number", "Identified", "Std. unc.", "Difference", "Specified"), body);
  for (const cell of [...table.querySelectorAll("thead th")].slice(2)) cell.className = "number";
  const made = panel("DH table", status, element("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": "Table of DH numbers" }, table));
  made.classList.add("wide");
  const list = element("ul", { class: "messages" });
  const quiet = element("p", { class: "quiet" }, "None.");
  const messages = panel("Warnings", quiet, list);
  let specified = [];
  let result = null;
  let session = null;

  /** The digits themselves are in the title. */
  const cell = (digits, key, decimals) => element("td", { class: "number", "data-number": key, ...(digits ? { title: digits } : {}) }, shown(digits, decimals));

  function number_row(index, [name, suffix, sign, unit], rows, first) {
    const key = name + suffix;
    const found = rows.dh[index] ?? {};
    const by_convention = found.by_convention?.includes(key);
    const cells = [
      element("th", { scope: "row" }, `${sign} ${unit}`),
      cell(found[key], `dh/${index}/${key}`, DECIMALS.value),
      by_convention ? element("td", { class: "number" }, "set") : cell(found[`${name}_sigma${suffix}`], `dh/${index}/${name}_sigma${suffix}`, DECIMALS.sigma),
      cell(rows.difference[index]?.[key], `difference/${index}/${key}`, DECIMALS.value),
      cell(rows.specified[index]?.[key], `specified/${index}/${key}`, DECIMALS.specified),
    ];
    if (first > 0) cells.unshift(element("th", { scope: "rowgroup", rowspan: first }, String(index + 1)));
    return row("td", cells, first > 0 ? { class: "first" } : {});
  }

  function draw() {
    const rows = { dh: result?.dh ?? [], specified: result?.specified ?? specified, difference: result?.difference ?? [] };
    const count = Math.max(rows.dh.length, rows.specified.length);
    body.replaceChildren();
    for (let index = 0; index < count; ++index) {
      const has_beta = (rows.dh[index] ?? {}).beta_deg !== undefined;
      const numbers = NUMBERS.filter(([name]) => name !== "beta" || has_beta);
      numbers.forEach((number, k) => body.append(number_row(index, number, rows, k === 0 ? numbers.length : 0)));
    }
    if (!result) return;
    const now = session !== null && result.session !== session;
    say(status, (now ? "This result is of an earlier stream. " : result.interim ? "Interim result: it grows with each sweep. " : "Last result of this stream. ") +
      `${result.status[0].toUpperCase()}${result.status.slice(1)}. ${STATUS[result.status] ?? ""}` + because(result));
    status.className = result.status === "complete" ? "good" : "bad";
    const told = [...(result.doubts ?? []).map((one) => ["bad", one]), ...(result.warnings ?? []).map((one) => ["", one])];
    list.replaceChildren(...told.map(([kind, one]) => element("li", { class: kind, "data-code": one.code }, bdi(one.message))));
    quiet.hidden = told.length > 0;
  }

  return {
    panel: made,
    messages,
    begin(hello) {
      specified = hello.specified ?? [];
      result = null;
      session = null;
      say(status, NO_RESULT);
      status.className = "";
      list.replaceChildren();
      quiet.hidden = false;
      draw();
    },
    stream(stream) {
      if ((stream?.session ?? session) === session) return;
      session = stream.session;
      draw();
    },
    result(fresh) {
      result = fresh;
      draw();
    },
  };
}
