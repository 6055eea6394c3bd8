// Small helpers. What sweepd tells becomes text, never markup.

/** An element; `attributes` are set as they are, `children` are nodes or text. */
export function element(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.append(...children.filter((child) => child !== null && child !== undefined));
  return made;
}

/** Text of unknown writing direction. */
export function bdi(text) {
  return element("bdi", { dir: "auto" }, String(text));
}

/** Sets the text only where it changes, so that a screen reader is not told again. */
export function say(node, text) {
  if (node.textContent !== text) node.textContent = text;
}

/** A panel with a heading. */
export function panel(title, ...children) {
  const heading = element("h2", {}, title);
  heading.id = "h-" + title.toLowerCase().replace(/[^a-z]+/g, "-");
  return element("section", { class: "panel", "aria-labelledby": heading.id }, heading, ...children);
}

export function row(kind, cells, attributes = {}) {
  return element("tr", attributes, ...cells.map((cell) => cell instanceof Node && /^T[DH]$/.test(cell.nodeName) ? cell : element(kind, {}, cell)));
}

export function head(...titles) {
  return element("thead", {}, element("tr", {}, ...titles.map((title) => element("th", { scope: "col" }, title))));
}

/** Microseconds as a person reads them. */
export function time_us(us) {
  if (us === null || us === undefined) return "none";
  return us < 1000 ? `${Math.round(us)} µs` : `${(us / 1000).toFixed(us < 10000 ? 1 : 0)} ms`;
}

/** "2026-11-23T01:49:15.511Z" as a person reads it. */
export const utc = (text) => text.replace("T", " ").replace(/\.\d+Z$/, " UTC");

/** Of a page that has lost sweepd: when all on it was so. */
export const last_told = (moment) => `All this is as sweepd last told it, on ${utc(moment.toISOString())}.`;

export const counted = (count, one, many = one + "s") => `${count} ${count === 1 ? one : many}`;

/** What of a robot is not on the disk, as that has no room or refuses; empty: nothing is refused. */
export function disk_words(robot) {
  return [robot.results_refused > 0 ? "the disk refuses the result's files" : "", robot.recording.paused ? "the recording is paused" : ""].filter(Boolean).join(", ");
}

/** Where the link is not good: what is wrong, and what to do. */
export function link_words(robot) {
  if (!robot.link || robot.link.verdict === "good") return "";
  return `The link ${robot.stream ? "is" : "was"} ${robot.link.verdict}: ${robot.link.reason}.`;
}

export const dark = matchMedia("(prefers-color-scheme: dark)");
const still = matchMedia("(prefers-reduced-motion: reduce)");

const colours = new Map();
dark.addEventListener("change", () => colours.clear());

/** A colour of the style sheet, as it is in the scheme of this moment. */
export function colour(name) {
  if (!colours.has(name)) colours.set(name, getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim());
  return colours.get(name);
}

/** Beside its colour each joint has its own dashes. */
const DASHES = [[], [9, 4], [2, 4], [10, 3, 2, 3], [16, 4], [5, 5]];
export const joint_colour = (joint) => colour(`joint${((joint - 1) % 6) + 1}`);
export const joint_dash = (joint) => DASHES[(joint - 1 + Math.floor((joint - 1) / 6)) % 6];

/**
 * Calls `draw` once for all calls of a while, in milliseconds; of a second where motion is not
 * wanted. All draw at the same moments, which saves frames. With `now` it does not wait for that: a
 * hand turns something.
 */
export function painter(draw, pause_ms) {
  let due = 0;
  const paint = () => {
    due = 0;
    draw();
  };
  return (now = false) => {
    if (due && !now) return;
    clearTimeout(due);
    const pause = still.matches ? 1000 : pause_ms;
    due = setTimeout(() => requestAnimationFrame(paint), now ? 0 : pause - (performance.now() % pause));
  };
}
