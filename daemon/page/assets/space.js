// Where the tool was, drawn on a canvas by a projection of its own: it turns by pointer and keys.
import { colour, element, head, joint_colour, joint_dash, painter, panel, row } from "./text.js";

const MOST_POINTS = 4000;
const STEP_RAD = 0.12;
const MOVED_MM = 0.5;

/** 1, 2 or 5 times a power of ten, not above `length`. */
function round_length(length) {
  const power = 10 ** Math.floor(Math.log10(length));
  return power * [5, 2, 1].find((factor) => factor * power <= length * 1.0001);
}

/** The box that holds all points, and the sphere around it. */
function bounds(points) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (const point of points)
    for (let k = 0; k < 3; ++k) {
      low[k] = Math.min(low[k], point[k]);
      high[k] = Math.max(high[k], point[k]);
    }
  const centre = low.map((value, k) => (value + high[k]) / 2);
  return { low, high, centre, radius: Math.max(Math.hypot(...high.map((value, k) => value - low[k])) / 2, 50) };
}

export function make_space() {
  const canvas = element("canvas", { class: "space", tabindex: "0", role: "img",
    "aria-label": "The tool's path in space. Arrow keys turn it, plus and minus zoom, Home resets. The table below has the numbers." });
  const rows = element("tbody");
  const table = element("details", {}, element("summary", {}, "The sweeps as a table"),
    element("div", { class: "scroll" }, element("table", {}, head("Joint", "From s", "To s", "Range", "Begins at X, Y, Z mm", "Ends at X, Y, Z mm"), rows)));
  const made = panel("Path of the tool", canvas,
    element("p", { class: "quiet" }, "Lengths in mm, in the controller's BASE. Drag or use the arrow keys to turn, + and − to zoom."), table);
  const home = { yaw: -0.65, pitch: 0.45, zoom: 1 };
  let view = { ...home };
  let trace = [];
  let sweeps = [];

  /** Parallel, along the line of sight; all that is drawn fits at zoom 1. */
  function projection(width, height) {
    const all = trace.concat(...sweeps.map((sweep) => sweep.path_mm));
    const box = bounds(all);
    const length = round_length(box.radius);
    const axes = [0, 1, 2].map((k) => box.low.map((value, i) => value + (i === k ? length : 0)));
    const [cy, sy, cp, sp] = [Math.cos(view.yaw), Math.sin(view.yaw), Math.cos(view.pitch), Math.sin(view.pitch)];
    const flat = ([x, y, z]) => [cy * x + sy * y, -cp * z - sp * (cy * y - sy * x)];
    const seen = bounds([...all, box.low, ...axes].map((point) => [...flat(point), 0]));
    const size = seen.high.map((value, k) => value - seen.low[k]);
    const scale = view.zoom * Math.min((width - 90) / Math.max(size[0], 1), (height - 50) / Math.max(size[1], 1));
    const project = (point) => {
      const [across, down] = flat(point);
      return [width / 2 + scale * (across - seen.centre[0]), height / 2 + scale * (down - seen.centre[1])];
    };
    return { corner: box.low, axes, length, project };
  }

  function line(to, points, stroke, dash, width) {
    to.beginPath();
    points.forEach(([x, y], i) => (i === 0 ? to.moveTo(x, y) : to.lineTo(x, y)));
    to.strokeStyle = stroke;
    to.setLineDash(dash);
    to.lineWidth = width;
    to.stroke();
    to.setLineDash([]);
  }

  function draw_axes(to, { corner, axes, length, project }) {
    const from = project(corner);
    to.font = "13px system-ui, sans-serif";
    to.fillStyle = colour("quiet");
    ["X", "Y", "Z"].forEach((name, k) => {
      const [x, y] = project(axes[k]);
      line(to, [from, [x, y]], colour("quiet"), [], 1.5);
      const label = k === 0 ? `${name} ${length} mm` : name;
      to.fillText(label, Math.min(x + 4, to.canvas.clientWidth - to.measureText(label).width - 2), y - 4);
    });
  }

  const draw = painter(() => {
    const ratio = window.devicePixelRatio || 1;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    if (width === 0) return;
    if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
    }
    const to = canvas.getContext("2d");
    to.setTransform(ratio, 0, 0, ratio, 0, 0);
    to.clearRect(0, 0, width, height);
    to.font = "14px system-ui, sans-serif";
    to.fillStyle = colour("quiet");
    if (trace.length === 0 && sweeps.length === 0) return to.fillText("No positions yet.", 14, 26);
    const seen = projection(width, height);
    draw_axes(to, seen);
    line(to, trace.map(seen.project), colour("line"), [], 1.5);
    const labels = new Map();
    for (const sweep of sweeps) {
      if (sweep.path_mm.length === 0) continue;
      // Forth and back the same way: the dashes meet.
      const path = sweep.direction < 0 ? [...sweep.path_mm].reverse() : sweep.path_mm;
      const points = path.map(seen.project);
      const known = sweep.joint && sweep.usable;
      line(to, points, known ? joint_colour(sweep.joint) : colour("quiet"), known ? joint_dash(sweep.joint) : [1, 5], 3);
      if (sweep.joint) labels.set(sweep.joint, points[points.length >> 1]);
    }
    to.font = "bold 14px system-ui, sans-serif";
    for (const [joint, [x, y]] of labels) {
      to.lineWidth = 4;
      to.strokeStyle = colour("back");
      to.strokeText(String(joint), x + 6, y - 6);
      to.fillStyle = joint_colour(joint);
      to.fillText(String(joint), x + 6, y - 6);
    }
    if (trace.length > 0) {
      const [x, y] = seen.project(trace.at(-1));
      to.beginPath();
      to.arc(x, y, 5, 0, 2 * Math.PI);
      to.fillStyle = colour("text");
      to.fill();
    }
  }, 500);

  function turn(yaw, pitch) {
    view.yaw += yaw;
    view.pitch = Math.max(-Math.PI / 2, Math.min(Math.PI / 2, view.pitch + pitch));
    draw(true);
  }
  function zoom(factor) {
    view.zoom = Math.max(0.3, Math.min(20, view.zoom * factor));
    draw(true);
  }

  canvas.addEventListener("pointermove", (event) => {
    if (event.buttons & 1) turn(event.movementX * 0.01, event.movementY * 0.01);
  });
  canvas.addEventListener("pointerdown", (event) => canvas.setPointerCapture(event.pointerId));
  canvas.addEventListener("keydown", (event) => {
    const keys = {
      ArrowLeft: () => turn(-STEP_RAD, 0), ArrowRight: () => turn(STEP_RAD, 0),
      ArrowUp: () => turn(0, -STEP_RAD), ArrowDown: () => turn(0, STEP_RAD),
      "+": () => zoom(1.2), "-": () => zoom(1 / 1.2),
      Home: () => { view = { ...home }; draw(true); },
    };
    if (!keys[event.key] || event.ctrlKey || event.metaKey) return;
    event.preventDefault();
    keys[event.key]();
  });
  new ResizeObserver(() => draw()).observe(canvas);

  const begin = () => {
    trace = [];
    sweeps = [];
    rows.replaceChildren();
    draw();
  };
  const place = (point) => (point ? point.join(", ") : "none");

  return {
    panel: made,
    begin,
    begin_session: begin,
    samples(samples) {
      for (const point of samples.position_mm) {
        if (!point || point.includes(null)) continue;
        const last = trace.at(-1);
        if (last && Math.hypot(...point.map((value, k) => value - last[k])) < MOVED_MM) continue;
        trace.push(point);
      }
      if (trace.length > MOST_POINTS) trace = trace.filter((_, i) => i % 2 === 0 || i === trace.length - 1);
      draw();
    },
    sweep(sweep) {
      sweeps.push(sweep);
      if (sweeps.length > 128) {
        sweeps.shift();
        rows.firstChild.remove();
      }
      const cells = [sweep.joint ?? "not known", sweep.start_s, sweep.end_s, `${sweep.range} ${sweep.unit === "mm" ? "mm" : "°"}`, place(sweep.path_mm[0]), place(sweep.path_mm.at(-1))];
      rows.append(row("td", cells.map(String)));
      draw();
    },
    recolour: () => draw(true),
  };
}
