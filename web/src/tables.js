// How candidates ended, who computes, and what looks like a gap of the model: lists of words and counts.
import { byId, element } from "./dom.js";
import { count, duration, percent, words } from "./format.js";

const MEANINGS = {
  tiny_energy: "a large quotient of small numbers: hardly any angle, or next to no work",
  contact_at_rest: "presses on the plane before there is any pressure",
  unresolved_mesh: "more of the wall folds tighter than its thickness than a shell can be believed with",
  single_sample: "an objective is large at one sample alone: a jump or a first touch",
};

/** One line with a bar behind it, as wide as its share of `most`. */
function bar(label, value, share, kind, title) {
  const fill = element("span", `fill ${kind}`);
  fill.style.width = `${100 * share}%`;
  const line = element("li", "", fill, element("span", "label", label), element("span", "value", value));
  line.title = title;
  return line;
}

/** The lines of a list, or one that says why there are none. */
const orNone = (lines, why) => (lines.length > 0 ? lines : [element("li", "none", why)]);

/** How candidates ended, the most frequent first. */
export function showOutcomes(run) {
  const all = run.outcomes.reduce((sum, { candidates }) => sum + candidates, 0);
  const most = Math.max(1, ...run.outcomes.map(({ candidates }) => candidates));
  const sorted = [...run.outcomes].sort((a, b) => a.rejected - b.rejected || b.candidates - a.candidates);
  const lines = sorted.map(({ outcome, rejected, candidates }) =>
    bar(
      words(outcome),
      `${count(candidates)} · ${percent(candidates / all)}`,
      candidates / most,
      rejected ? "rejected" : "evaluated",
      rejected ? `rejected: ${outcome}` : `evaluated; the path ended: ${outcome}`,
    ),
  );
  byId("outcome-bars").replaceChildren(...orNone(lines, "No candidate has ended yet."));
}

/** Candidates by rank, how fast each one is, and when the run will be over. */
export function showRanks(run) {
  const cell = (text, kind = "") => element("td", kind, text);
  const rows = run.ranks.map(({ rank, candidates, per_hour }) =>
    element("tr", "", cell(String(rank)), cell(count(candidates)), cell(count(per_hour))),
  );
  const total = (name) => run.ranks.reduce((sum, row) => sum + (row[name] || 0), 0);
  if (run.ranks.length > 1) {
    rows.unshift(
      element("tr", "total", cell("all"), cell(count(total("candidates"))), cell(count(total("per_hour")))),
    );
  }
  const head = ["rank", "candidates", "per hour"].map((name) => element("th", "", name));
  const left = element("caption", "", timeLeft(run));
  byId("ranks").replaceChildren(left);
  if (rows.length === 0) return;
  byId("ranks").append(element("thead", "", element("tr", "", ...head)), element("tbody", "", ...rows));
}

function timeLeft(run) {
  if (run.state === "finished") return "The search is over.";
  if (run.state === "stopped") return "No new result for minutes: stopped, or a very hard candidate.";
  return Number.isFinite(run.seconds_left)
    ? `About ${duration(run.seconds_left)} left at this pace.`
    : "Too early to say how long it takes.";
}

/** Each flag with its meaning and how often it was raised, among all and on the front. */
export function showFlags(run) {
  const tally = new Map();
  const front = new Set(run.front);
  for (const { id, flags } of run.candidates) {
    for (const flag of flags.split(" ").filter(Boolean)) {
      const counts = tally.get(flag) ?? { all: 0, front: 0 };
      counts.all += 1;
      counts.front += front.has(id) ? 1 : 0;
      tally.set(flag, counts);
    }
  }
  const all = Math.max(1, run.candidates.length);
  const lines = [...tally]
    .sort(([, a], [, b]) => b.all - a.all)
    .map(([flag, counts]) => {
      const value = `${count(counts.all)}, on the front ${counts.front}`;
      const line = bar(words(flag), value, counts.all / all, "flagged", flag);
      line.append(element("span", "meaning", MEANINGS[flag] ?? ""));
      return line;
    });
  byId("flag-list").replaceChildren(...orNone(lines, "None of the evaluated designs is flagged."));
}
