// The live page: all robots, or the one that ?robot=NAME names.
import { show_robots } from "./robots.js";
import { show_robot } from "./robot.js";

const name = new URLSearchParams(location.search).get("robot");
const main = document.getElementById("main");
main.replaceChildren();
if (name === null) show_robots(main);
else show_robot(main, name);
