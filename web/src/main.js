// Wires the parts of the page: what the server knows, what is drawn, what the person chose.
import { poll } from "./api.js";
import { byId } from "./dom.js";
import { DesignPanel } from "./design.js";
import { FrontPlot } from "./front_plot.js";
import { HistoryPlots } from "./history_plots.js";
import { showHeader, showContact } from "./header.js";
import { showFlags, showOutcomes, showRanks } from "./tables.js";
import { onSchemeChange } from "./theme.js";

let run = { front: [], candidates: [] };
let chosen = null;
let drawn = false;

const front = new FrontPlot(choose);
const history = new HistoryPlots();
const design = new DesignPanel();

function show(answer) {
  run = answer;
  showHeader(run);
  front.show(run);
  history.show(run);
  showOutcomes(run);
  showRanks(run);
  showFlags(run);
  listFront();
  if (!drawn) {
    drawn = true;
    performance.mark("front-drawn");
    choose(idInAddress());
  }
}

/** Shows the design with this id everywhere; the address keeps it, so that a reload finds it again. */
function choose(id) {
  if (!id || id === chosen) return;
  chosen = id;
  window.history.replaceState(null, "", `#${encodeURIComponent(id)}`);
  front.choose(id);
  design.show(id);
  listFront();
}

/** The id that the address ends with; nothing where there is none, or no such word. */
function idInAddress() {
  try {
    return decodeURIComponent(location.hash.slice(1));
  } catch {
    return "";
  }
}

/** The front as a list, and the chosen design where it is not on the front (any more). */
function listFront() {
  const ids = chosen && !run.front.includes(chosen) ? [chosen, ...run.front] : run.front;
  const list = byId("front-list");
  const same = list.options.length === ids.length + 1 && ids.every((id, k) => list.options[k + 1].value === id);
  if (!same) {
    const invitation = new Option(run.front.length > 0 ? `choose one of ${run.front.length}` : "no design yet", "");
    invitation.disabled = true;
    list.replaceChildren(invitation, ...ids.map((id) => new Option(id, id)));
  }
  list.value = chosen ?? "";
}

/** The neighbour on the front; `step` 1 bends more, -1 less. The front is sorted the other way. */
function walk(step) {
  const ids = run.front;
  if (ids.length === 0) return;
  const at = ids.indexOf(chosen);
  const next = at < 0 ? (step > 0 ? ids.length - 1 : 0) : at - step;
  choose(ids[Math.min(Math.max(next, 0), ids.length - 1)]);
}

const KEYS = {
  ArrowLeft: () => walk(-1),
  ArrowRight: () => walk(1),
  Home: () => choose(run.front.at(-1)),
  End: () => choose(run.front[0]),
  " ": () => design.togglePlay(),
  b: () => design.nextScenario(),
  c: () => design.nextColour(),
  r: () => design.resetView(),
};

document.addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
  const at = event.target instanceof Element ? event.target : document.body;
  if (!KEYS[key] || at.closest("select, summary") || (at.closest("input") && key !== " ")) return;
  if (key === " " && at.closest("button")) return;
  event.preventDefault();
  KEYS[key]();
});
for (const [id, step] of [["previous", -1], ["next", 1]]) {
  byId(id).addEventListener("click", (event) => {
    if (event.detail > 0) event.currentTarget.blur();
    walk(step);
  });
}
byId("front-list").addEventListener("change", (event) => {
  choose(event.target.value);
  event.target.blur();
});
window.addEventListener("hashchange", () => choose(idInAddress()));
onSchemeChange(() => {
  front.restyle();
  history.restyle();
  design.restyle();
});

/** What a check of the page needs to know of its canvases. */
window.pneumorph = { pixelOf: (id) => front.pixelOf(id) };

poll(show, showContact);
