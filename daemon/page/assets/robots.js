// The first page: all robots of this sweepd, asked for every two seconds.
import { connection } from "./live.js";
import { bdi, counted, disk_words, element, head, last_told, link_words, panel, row, say, utc } from "./text.js";

const PAUSE_MS = 2000;

function stream_words(robot) {
  if (!robot.stream) return "no RSI now";
  const cycle = robot.stream.cycle_ms ? `, cycle ${robot.stream.cycle_ms} ms` : "";
  return `RSI from ${robot.stream.controller}${cycle}`;
}

function stream_cell(robot) {
  const link = robot.stream && link_words(robot) ? `; the link is ${robot.link.verdict}` : "";
  return element("td", {}, stream_words(robot), link ? element("span", { class: robot.link.verdict === "bad" ? "bad" : "" }, link) : null);
}

function reply_words(robot) {
  if (!robot.replies_expected) return "none are wanted";
  const { in_time, late, superseded, unanswered } = robot.replies;
  const bad = late + superseded + unanswered;
  if (in_time + bad === 0) return "none yet";
  const here = bad === 0 ? `${counted(in_time, "reply", "replies")} left in time` : `${bad} of ${in_time + bad} did not leave in time`;
  const missed = robot.replies.missed_by_controller;
  return missed > 0 ? `${here}; the controller missed ${missed}` : here;
}

function sweep_words(robot) {
  const of = robot.sweeps.filter((sweep) => sweep.joint);
  const seen = of.filter((sweep) => sweep.usable > 0).length;
  return of.length === 0 ? "none" : `${seen} of ${counted(of.length, "joint")}`;
}

function result_words(robot) {
  if (!robot.result) return "none yet";
  const warnings = robot.result.warnings ? `, ${counted(robot.result.warnings, "warning")}` : "";
  const writing = !robot.result.interim && robot.results_pending > robot.results_refused ? ", its files are being written" : "";
  return (robot.result.interim ? "interim: " : "") + robot.result.status + warnings + writing;
}

function result_cell(robot) {
  const waiting = disk_words(robot);
  return element("td", {}, result_words(robot), waiting ? element("span", { class: "bad" }, `; ${waiting}`) : null);
}

function robot_row(robot) {
  const link = element("a", { href: "/?robot=" + encodeURIComponent(robot.robot) }, bdi(robot.robot));
  const cells = [element("th", { scope: "row" }, link), stream_cell(robot), reply_words(robot), sweep_words(robot), result_cell(robot)];
  return row("td", cells);
}

export function show_robots(main) {
  const body = element("tbody");
  const troubles = element("ul", { class: "messages" });
  const table = element("table", { class: "robots" }, head("Robot", "RSI", "Replies", "Swept", "Result"), body);
  const facts = element("p", { class: "quiet" });
  main.append(panel("All robots of this sweepd", element("div", { class: "scroll" }, table), troubles, facts));
  let told = "";
  let heard = null;

  const show = (state) => {
    heard = new Date();
    const fresh = JSON.stringify([state.robots, state.not_served, state.standstills]);
    if (fresh === told) return;
    told = fresh;
    const focused = document.activeElement?.getAttribute("href");
    body.replaceChildren(...state.robots.map(robot_row));
    if (focused) [...body.querySelectorAll("a")].find((link) => link.getAttribute("href") === focused)?.focus();
    troubles.replaceChildren(
      ...state.not_served.map(({ robot, reason }) => element("li", { class: "bad" }, bdi(robot), ` is not served: ${reason}`)),
      ...state.standstills.map((sentence) => element("li", { class: "bad" }, sentence)));
    say(facts, state.robots.length + state.not_served.length === 0 ? "No robot is in the settings." : `sweepd ${state.version}, since ${utc(state.started)}.`);
  };

  const ask = async () => {
    try {
      const answer = await fetch("/api/state", { cache: "no-store" });
      if (!answer.ok) throw new Error(answer.statusText);
      show(await answer.json());
      connection("live", "live");
    } catch {
      connection("lost", "The connection to sweepd is lost. This page tries again by itself.");
      if (heard) say(facts, last_told(heard));
      told = "";
    }
    setTimeout(ask, PAUSE_MS);
  };
  ask();
}
