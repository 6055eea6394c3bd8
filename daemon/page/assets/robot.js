// One robot: its link, its joints, where it moved, and its table.
import { make_lanes } from "./lanes.js";
import { listen } from "./live.js";
import { make_link } from "./link.js";
import { make_space } from "./space.js";
import { make_table } from "./table.js";
import { bdi, dark, disk_words, element, last_told, link_words, say, utc } from "./text.js";

const DESCRIBES = {
  controller_model:
    "The numbers describe the controller's model, not the arm: RSI's positions are computed by the controller from its angles.",
  arm: "The numbers describe the arm, as a device measured it.",
};

function stream_words(link) {
  if (!link.stream) return link.sessions > 0 ? "RSI has ended. What follows is of the last stream." : "RSI does not stream yet.";
  const cycle = link.stream.cycle_ms ? `, with a cycle of ${link.stream.cycle_ms} ms` : "";
  return `RSI streams from ${link.stream.controller} since ${utc(link.stream.since)}${cycle}.`;
}

export function show_robot(main, name) {
  document.title = `${name} · sweepd`;
  document.getElementById("title").replaceChildren(bdi(name));
  const stream = element("p", { id: "stream" }, "Waiting for sweepd.");
  const describes = element("p", { id: "describes", class: "quiet" });
  const verdict = element("p", { id: "verdict" });
  const disk = element("p", { id: "disk", class: "bad", role: "status" });
  const gaps = element("p", { id: "gaps", class: "bad", role: "status", hidden: "" });
  const link = make_link();
  const lanes = make_lanes();
  const space = make_space();
  const table = make_table();
  const beside = element("div", { class: "stack" }, lanes.panel, table.messages);
  const panels = element("div", { class: "panels", hidden: "" }, space.panel, beside, link.panel, table.panel);
  main.append(stream, describes, verdict, disk, gaps, panels);
  const parts = [link, lanes, space, table];
  let session = 0;
  let missed = 0;

  const in_session = (handle) => (data) => {
    if (data.session !== session) {
      session = data.session;
      for (const part of parts) part.begin_session?.();
    }
    handle(data);
  };

  listen(name, {
    hello: (hello) => {
      session = 0;
      missed = 0;
      gaps.hidden = true;
      panels.hidden = false;
      say(describes, DESCRIBES[hello.describes] ?? "");
      for (const part of parts) part.begin?.(hello);
    },
    link: (state) => {
      say(stream, stream_words(state));
      say(verdict, link_words(state));
      verdict.className = state.link?.verdict === "bad" ? "bad" : "";
      const waiting = disk_words(state);
      say(disk, waiting && `${waiting[0].toUpperCase()}${waiting.slice(1)}.`);
      lanes.streams(state.stream !== null);
      link.streams(state.stream !== null);
      link.state(state);
      table.stream(state.stream);
    },
    cycles: in_session((cycles) => link.cycles(cycles)),
    samples: in_session((samples) => {
      lanes.samples(samples);
      space.samples(samples);
    }),
    sweep: in_session((sweep) => {
      lanes.sweep(sweep);
      space.sweep(sweep);
    }),
    result: (result) => {
      if (result.describes) say(describes, DESCRIBES[result.describes] ?? "");
      lanes.result(result);
      table.result(result);
    },
    gap: (gap) => {
      missed += gap.missed;
      gaps.hidden = false;
      say(gaps, `This page was too slow: ${(missed / 10).toFixed(1)} s are missing here. The recording has them.`);
    },
  }, (moment) => {
    say(stream, last_told(moment));
    lanes.streams(false);
    link.streams(false);
  });
  dark.addEventListener("change", () => parts.forEach((part) => part.recolour?.()));
}
