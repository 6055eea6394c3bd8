// The link: reply latency, jitter and late replies of the last minute against the cycle.
import { colour, element, head, painter, panel, row, say, time_us } from "./text.js";

const WINDOW_S = 60;
const LEAST_US = 1;

/** In the order of the plot's series, behind the time. */
const SERIES = ["latency_us", "latency_max_us", "jitter_us"];

export function make_link() {
  const plot_place = element("div", { class: "plot", role: "img", "aria-label": "Reply latency and jitter of the last minute; the table below has the numbers" });
  const key = (style, name, text) => {
    const line = element("span", { class: "key " + style });
    line.style.color = `var(--${name})`;
    return element("li", {}, line, text);
  };
  const late_key = element("span", { class: "dot" }, "● ");
  const cycle_key = key("dashed", "text", "cycle");
  const legend = element("ul", { class: "legend" },
    key("", "joint1", "latency, median"), key("dashed", "joint3", "latency, longest"),
    key("dotted", "joint4", "jitter, largest"), cycle_key,
    element("li", {}, late_key, "not answered in time"));
  const body = element("tbody");
  const cells = {};
  for (const [name, label] of [["latency", "Latency, median and longest"], ["jitter", "Jitter, largest"], ["late", "Not answered in time by sweepd"], ["missed", "Not in time at the controller, since sweepd started"], ["lost", "Lost on the way, since sweepd started"]]) {
    cells[name] = element("td", { class: "number", "data-link": name }, "none");
    body.append(row("td", [element("th", { scope: "row" }, label), cells[name]]));
  }
  const caption = element("caption", {}, "The last 10 s");
  const table = element("table", { class: "few" }, caption, body);
  const made = panel("Link", plot_place, legend, table);
  made.classList.add("wide");

  let data = [[], [], [], []];
  let late = [];
  let cycle_us = null;
  let plot = null;
  let ended = false; // time stands still on the plot

  const log_ticks = (_, splits) => splits.map((us) => (us !== null && [1, 10, 100, 1e3, 1e4, 1e5, 1e6].includes(us) ? (us < 1000 ? `${us} µs` : us < 1e6 ? `${us / 1000} ms` : `${us / 1e6} s`) : ""));
  const decades = (_, splits) => splits.map((us) => (Number.isInteger(Math.round(1e6 * Math.log10(us)) / 1e6) ? us : null));

  function options(width) {
    const line = (name, dash) => ({ stroke: colour(name), width: 2, dash, points: { show: false }, spanGaps: false });
    const axis = { stroke: colour("quiet"), grid: { stroke: colour("grid"), width: 1 }, ticks: { stroke: colour("grid") }, font: "12px system-ui, sans-serif" };
    const marks = { stroke: colour("bad"), width: 0, paths: () => null, points: { show: true, size: 9, width: 2, stroke: colour("bad"), fill: colour("bad") } };
    return {
      width, height: 190,
      legend: { show: false }, cursor: { show: false },
      padding: [8, 22, 0, 0],
      scales: {
        x: { time: false, range: [-WINDOW_S, 0] },
        y: { distr: 3, range: (_, __, max) => [LEAST_US, Math.max(10000, 2 * (max ?? 0), 2 * (cycle_us ?? 0))] },
      },
      axes: [
        { ...axis, size: 32, values: (_, splits) => splits.map((s) => (s === 0 ? (ended ? "end" : "now") : `${s} s`)) },
        { ...axis, size: 62, values: log_ticks, filter: decades, grid: { ...axis.grid, filter: decades }, ticks: { ...axis.ticks, filter: decades } },
      ],
      series: [{}, line("joint1"), line("joint3", [8, 4]), line("joint4", [2, 3]), line("text", [14, 5]), marks],
    };
  }

  function columns() {
    const now = data[0].at(-1) ?? 0;
    const ago = data[0].map((at) => at - now);
    const positive = (values) => values.map((us) => (us === null ? null : Math.max(us, LEAST_US)));
    // The cycle is drawn over the whole width, which two ends are enough for.
    const times = [-WINDOW_S, ...ago, 0];
    const padded = data.slice(1).map((values) => [null, ...positive(values), null]);
    const cycle = times.map(() => cycle_us);
    const top = Math.max(5000, cycle_us ?? 0);
    return [times, ...padded, cycle, [null, ...late.map((count) => (count > 0 ? top : null)), null]];
  }

  const draw = painter(() => {
    const width = plot_place.clientWidth;
    if (!plot && width > 0) plot = new window.uPlot(options(width), columns(), plot_place);
    else plot?.setData(columns());
    table_of_now();
  }, 1000);

  function table_of_now() {
    const now = data[0].at(-1);
    const recent = data[0].map((at, i) => i).filter((i) => data[0][i] >= now - 10);
    const known = (column) => recent.map((i) => data[column][i]).filter((us) => us !== null).sort((a, b) => a - b);
    const middle = known(1);
    const longest = known(2).at(-1);
    say(cells.latency, middle.length ? `${time_us(middle[middle.length >> 1])}, ${time_us(longest)}` : "none");
    say(cells.jitter, time_us(known(3).at(-1)));
    const bad = recent.reduce((sum, i) => sum + late[i], 0);
    say(cells.late, String(bad));
    cells.late.className = bad > 0 ? "number bad" : "number";
  }

  function recolour() {
    plot?.destroy();
    plot = null;
    draw(true);
  }

  new ResizeObserver(() => {
    if (plot && plot_place.clientWidth > 0) plot.setSize({ width: plot_place.clientWidth, height: 190 });
    else draw();
  }).observe(plot_place);

  return {
    panel: made,
    begin() {
      data = [[], [], [], []];
      late = [];
      draw();
    },
    streams(now) {
      if (ended === (!now && data[0].length > 0)) return;
      ended = !ended;
      say(caption, ended ? "The last 10 s of the stream" : "The last 10 s");
      recolour();
    },
    state(state) {
      cycle_us = state.stream?.cycle_ms ? state.stream.cycle_ms * 1000 : cycle_us;
      const missed = state.replies.missed_by_controller;
      cycle_key.hidden = cycle_us === null;
      say(cells.missed, missed === null ? (state.sessions > 0 ? "it does not tell" : "none") : String(missed));
      cells.missed.className = missed > 0 ? "number bad" : "number";
      say(cells.lost, String(state.telegrams.lost));
      cells.lost.className = state.telegrams.lost > 0 ? "number bad" : "number";
    },
    cycles(cycles) {
      cycles.at_s.forEach((at_s, i) => {
        data[0].push(at_s);
        SERIES.forEach((name, s) => data[s + 1].push(cycles[name][i]));
        late.push(cycles.late[i] + cycles.superseded[i] + cycles.unanswered[i]);
      });
      const first = data[0].findIndex((at_s) => at_s >= data[0].at(-1) - WINDOW_S);
      data.forEach((column) => column.splice(0, first));
      late.splice(0, first);
      draw();
    },
    recolour,
  };
}
