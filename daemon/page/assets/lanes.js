// A lane for each joint: what moves, which sweeps are recognised, which the result has used.
import { element, head, painter, panel, row, say } from "./text.js";

const MOVES = 0.02; // degrees or mm from one sample to the next
const STOPPED_S = 0.35;
const STEP_S = 20;
const WORDS = { still: "not moved yet", moving: "moving", recognised: "recognised", used: "used", unusable: "not usable" };

export function make_lanes() {
  const body = element("tbody");
  const table = element("table", { class: "lanes" }, head("Joint", "Now", "State", "Last range", "In time"), body);
  const legend = element("p", { class: "quiet" },
    "Dashed: moves now. Outline: recognised. Filled: used in the result. Dotted: not usable.");
  [...table.querySelectorAll("thead th")].forEach((cell, i) => (cell.className = ["", "number now", "", "number", "track"][i]));
  const unknown = element("p", { class: "quiet", hidden: "" }, "The telegrams carry no angles: the plan or the result tells which joint moved.");
  const made = panel("Joints", element("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": "Table of joints" }, table), legend, unknown);
  let joints = [];
  let units = [];
  let now_s = 0;
  let from_s = 0;
  let last = null;
  let newest = null; // result

  const reset = (lane) => Object.assign(lane, { sweeps: [], moved: -1, began: -1 });

  const draw = painter(() => {
    const all = joints.flatMap((lane) => lane.sweeps.map((sweep) => Number(sweep.start_s)));
    // In steps, so that bars stay where they are for a while.
    from_s = STEP_S * Math.floor(Math.max(Math.min(now_s - 60, ...all), now_s - 600, 0) / STEP_S);
    const span = STEP_S * Math.ceil((now_s - from_s + 1) / STEP_S);
    joints.forEach((lane, index) => show(lane, index + 1, span));
  }, 250);

  function bar(span, kind, start_s, end_s, title) {
    const made = element("div", { class: "bar " + kind });
    made.style.left = `${(100 * (start_s - from_s)) / span}%`;
    made.style.width = `${(100 * (end_s - start_s)) / span}%`;
    made.title = title;
    return made;
  }

  function show(lane, joint, span) {
    const moving = lane.moved >= 0 && now_s - lane.moved < STOPPED_S;
    const usable = lane.sweeps.filter((sweep) => sweep.usable);
    const used = usable.filter((sweep) => sweep.used);
    const state = moving ? "moving" : used.length > 0 ? "used" : usable.length > 0 ? "recognised" : lane.sweeps.length > 0 ? "unusable" : "still";
    if (lane.state.dataset.state !== state) lane.state.dataset.state = state;
    const count = used.length || usable.length;
    say(lane.state, (count > 0 && state !== "moving" ? `${count} ` : "") + WORDS[state]);
    say(lane.now, lane.angle === null ? "" : `${lane.angle.toFixed(1)} ${units[joint - 1]}`);
    const shown = (used.length > 0 ? used : usable).at(-1);
    say(lane.range, shown ? `${shown.range} ${shown.unit === "mm" ? "mm" : "°"}` : "");
    lane.lane.style.color = `var(--joint${((joint - 1) % 6) + 1})`;
    const bars = lane.sweeps.map((sweep) => [sweep.used ? "used" : sweep.usable ? "recognised" : "unusable", Number(sweep.start_s), Number(sweep.end_s), sweep.words]);
    if (moving) bars.push(["moving", lane.began, now_s, "moving"]);
    const seen = bars.filter(([, , end_s]) => end_s > from_s);
    const looks = JSON.stringify([from_s, span, seen]);
    if (looks === lane.looks) return;
    lane.looks = looks;
    lane.lane.replaceChildren(...seen.map((one) => bar(span, ...one)));
  }

  function make_lane(joint) {
    const lane = reset({ angle: null });
    lane.now = element("td", { class: "number now" });
    lane.state = element("td", { class: "state", "data-state": "still" }, WORDS.still);
    lane.range = element("td", { class: "number" });
    lane.lane = element("div", { class: "lane", "aria-hidden": "true" });
    body.append(row("td", [element("th", { scope: "row" }, String(joint)), lane.now, lane.state, lane.range, element("td", { class: "track" }, lane.lane)], { "data-joint": joint }));
    return lane;
  }

  function grow(count) {
    while (joints.length < count) {
      joints.push(make_lane(joints.length + 1));
      units[joints.length - 1] ??= "°";
    }
  }

  function mark_used() {
    if (!newest) return;
    for (const [index, lane] of joints.entries())
      for (const sweep of lane.sweeps) {
        if (sweep.started !== newest.session) continue;
        const found = newest.sweeps.find((one) => Number(one.start_s) === Number(sweep.start_s) && one.joint === index + 1);
        if (found?.used !== true) continue;
        sweep.used = true;
        sweep.range = found.range_deg ?? found.range_mm ?? sweep.range;
      }
  }

  return {
    panel: made,
    begin(hello) {
      body.replaceChildren();
      joints = [];
      newest = null;
      units = (hello.limits ?? []).map((limit) => (limit.unit === "mm" ? "mm" : "°"));
      grow(hello.joints);
      this.begin_session();
    },
    begin_session() {
      joints.forEach(reset);
      last = null;
      now_s = 0;
      draw();
    },
    streams(now) {
      if (now) return;
      for (const lane of joints) lane.moved = -1;
      draw();
    },
    samples(samples) {
      samples.t_s.forEach((t_s, i) => {
        const angles = samples.angles[i];
        unknown.hidden = angles.length > 0;
        grow(angles.length);
        angles.forEach((angle, j) => {
          const lane = joints[j];
          if (last && last.length > j && Math.abs(angle - last[j]) > MOVES) {
            if (t_s - lane.moved > STOPPED_S) lane.began = t_s;
            lane.moved = t_s;
          }
          lane.angle = angle;
        });
        last = angles;
        now_s = t_s;
      });
      draw();
    },
    sweep(sweep) {
      if (!sweep.joint) return;
      grow(sweep.joint);
      const lane = joints[sweep.joint - 1];
      lane.sweeps.push(sweep);
      if (lane.sweeps.length > 128) lane.sweeps.shift();
      lane.moved = -1;
      mark_used();
      draw();
    },
    result(result) {
      newest = result;
      grow(Math.max(0, ...result.sweeps.map((sweep) => sweep.joint ?? 0)));
      mark_used();
      draw();
    },
  };
}
