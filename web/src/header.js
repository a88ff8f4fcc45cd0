// The run in one line: state, progress, settings; and whether the server still answers.
import { byId, definitions, element } from "./dom.js";
import { count, duration, quantity } from "./format.js";

let lostSince = null;

/** Shows name, state and settings of the run, and the server's warnings. */
export function showHeader(run) {
  document.title = `${run.name} ${run.generation}/${run.generations} – pneumorph`;
  byId("run-name").textContent = run.name;
  const state = byId("state");
  state.textContent = run.state === "stopped" ? "no new result" : run.state;
  state.className = `chip ${run.state}`;
  state.hidden = false;

  const bar = byId("bar");
  bar.max = Math.max(run.generations, 1);
  bar.value = Math.min(run.generation + run.in_generation / Math.max(run.population, 1), run.generations);
  byId("progress-text").textContent = progressOf(run);

  const rows = [
    ["material", run.material],
    ["pressure", quantity(run.pressure, "MPa")],
    ["seed", String(run.seed)],
    ["commit", run.commit],
  ];
  byId("settings").replaceChildren(...definitions(rows.filter(([, value]) => value)));

  const warnings = byId("warnings");
  warnings.replaceChildren(...run.warnings.map((line) => element("li", "", line)));
  warnings.hidden = run.warnings.length === 0;
}

function progressOf(run) {
  const parts = [`${run.generation} of ${run.generations} generations`];
  if (run.state !== "finished" && run.in_generation > 0) {
    parts.push(`${run.in_generation} of ${run.population} of the next`);
  }
  parts.push(`${count(run.evaluated)} evaluated`);
  if (run.state === "running" && Number.isFinite(run.seconds_left)) {
    parts.push(`about ${duration(run.seconds_left)} left`);
  }
  return parts.join(" · ");
}

/** Says since when the server does not answer, or nothing. */
export function showContact(error) {
  const line = byId("connection");
  line.hidden = error === null;
  if (error === null) {
    lostSince = null;
    return;
  }
  lostSince ??= new Date();
  line.textContent =
    `No answer from the server since ${lostSince.toLocaleTimeString()} (${error.message}). ` +
    "What is shown is what was known then. Still trying; over SSH, see whether the forwarding is up.";
}
