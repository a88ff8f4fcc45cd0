// What is known of a design beside its picture: objectives, cost, genome, and its certificate.
import { byId, definitions, element } from "./dom.js";
import { count, number, percent, quantity, words } from "./format.js";

const VERDICTS = {
  trust: "The shell may be trusted: the solid says the same.",
  check: "Shell and solid differ visibly: look before you print.",
  misleads: "The shell misleads: its answers are those of another part.",
};

/** Shows the answer of `api/design/ID`; `null` empties the panels. */
export function showFacts(design) {
  byId("evaluation").replaceChildren(...(design ? evaluationOf(design) : [hint("Choose a design.")]));
  byId("certificate-body").replaceChildren(
    ...(design ? certificateOf(design) : [hint("Choose a design.")]),
  );
  const genes = design?.genome ?? [];
  byId("genome").hidden = genes.length === 0;
  byId("genes").replaceChildren(
    ...definitions(genes.map(({ name, value }) => [name, number(value, 4)])),
  );
}

/** Says why there is nothing to show. */
export function showNoFacts(line) {
  showFacts(null);
  byId("evaluation").replaceChildren(hint(line));
}

const hint = (text) => element("p", "hint", text);
const list = (rows) => element("dl", "facts-list", ...definitions(rows));

/** An objective by its name and its symbol. */
const titleOf = ({ name, symbol }) => [words(name), symbol].filter(Boolean).join(" ");

function evaluationOf({ evaluation, rejection, objectives, actions, cpu_seconds: cpu }) {
  const cost = cpu ? [["computed in", costOf(cpu)]] : [];
  if (!evaluation) {
    const { room, reason, detail, violation } = rejection ?? {};
    return [
      hint("This candidate was rejected."),
      list([
        ["by", words(String(room))],
        ["because of", words(String(reason))],
        ["in detail", String(detail ?? "–")],
        ["violation", number(violation)],
        ...cost,
      ]),
    ];
  }
  const e = evaluation;
  const exploits = e.exploits.map((name) => element("span", "chip flagged", words(name)));
  return [
    ...(exploits.length > 0 ? [element("p", "", ...exploits)] : []),
    list([
      ...objectives.map((one) => [titleOf(one), quantity(e[one.name] ?? e.further?.[one.name], one.unit)]),
      ["figure of merit", quantity(e.figure_of_merit, "deg/(kPa m)")],
      ["largest force", quantity(e.max_force, "N")],
      ["angle", quantity(e.angle_deg, "deg")],
      ...actions.map((action) => [
        `${words(action)} ended`,
        `${words(e[`${action}_ending`])} at ${quantity(e[`${action}_pressure`], "MPa")}`,
      ]),
      ["snaps", count(e.snaps)],
      ["creased wall", percent(e.creased_share)],
      ["unknowns", count(e.unknowns)],
      ["Newton iterations", count(e.newton_iterations)],
      ...cost,
    ]),
  ];
}

function costOf(cpu) {
  const sum = Object.values(cpu).reduce((total, seconds) => total + (seconds || 0), 0);
  const parts = Object.entries(cpu).map(([name, seconds]) => `${words(name)} ${number(seconds, 2)}`);
  return `${number(sum, 2)} CPU s (${parts.join(", ")})`;
}

function certificateOf({ certificate, objectives }) {
  if (!certificate) {
    return [hint("None: this design was not walked as a solid. The table [solid] of the run file asks for it.")];
  }
  const c = certificate;
  const known = c.verdict in VERDICTS;
  const row = (name, shell, solid, deviation) =>
    element("tr", "", ...[name, shell, solid, deviation].map((text) => element("td", "", text)));
  const head = ["", "shell", "solid", "differ by"].map((text) => element("th", "", text));
  return [
    element(
      "p",
      "",
      element("span", `chip ${known ? c.verdict : "misleads"}`, words(c.verdict)),
      ` ${VERDICTS[c.verdict] ?? "There is no solid to compare with."}`,
    ),
    element(
      "table",
      "",
      element("thead", "", element("tr", "", ...head)),
      element(
        "tbody",
        "",
        ...objectives.map(({ name, symbol, unit }) => {
          const [shell, solid] = [c[`${name}_shell`], c[`${name}_solid`]];
          return row(`${symbol ?? words(name)}, ${unit}`, number(shell), number(solid), differ(shell, solid));
        }),
        row("angle along the path", "", "", percent(c.angle)),
        row("force", "", "", percent(c.force)),
        row("work", "", "", percent(c.work)),
        row("growth of the volume", "", "", percent(c.growth)),
      ),
    ),
    list([
      ["common pressure", percent(c.common_pressure)],
      ["a coarser solid differs by", percent(c.coarser_solid)],
      ["solid", `${words(String(c.mesher ?? "–"))}, ${count(c.tetrahedra)} tetrahedra, ${count(c.unknowns)} unknowns`],
    ]),
  ];
}

/** How far a solid's number is from its shell's, as a share of the shell's. */
const differ = (shell, solid) => (shell > 0 ? percent(Math.abs(solid - shell) / shell) : "–");
