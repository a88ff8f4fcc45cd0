// The Pareto front: the large points can be clicked, everything else is behind them.
import { byId, choice } from "./dom.js";
import { number, words } from "./format.js";
import { AXES, growth, linearLimit, logarithmicLimits, milestones, nonDominated, placed, staircase } from "./front_data.js";
import { Chart, axis, baseOptions } from "./charts.js";
import { colour, faint } from "./theme.js";

/** The sets of the literature: name, shape, colour, filled or hollow. */
const SETS = [
  ["literature_2022", "literature, in Smith 2022", "circle", "others", false],
  ["literature_2020", "literature, in Hainsworth 2020", "triangle", "others", false],
  ["smith_2022_shell_front", "Smith 2022, shells", "rect", "smith", false],
  ["smith_2022_solid_front", "Smith 2022, solids", "rectRot", "smith", false],
  ["smith_2022_printed", "Smith 2022, printed", "star", "smith", false],
];

/** The line along the front needs no name of its own. */
const EDGE = "edge";

export class FrontPlot {
  #run = { front: [], candidates: [], solids: [], literature: [] };
  #chosen = null;
  #chart;
  #axes;
  #onChoose;

  /** `onChoose(id)` is called for a click on a design. */
  constructor(onChoose) {
    this.#onChoose = onChoose;
    this.#axes = choice(
      byId("axes"),
      [
        ["objectives", "Objectives", "What the search optimizes: bending F_c, blocking F_bf"],
        ["logarithmic", "Literature, log", "Figure of merit and force, logarithmic"],
        ["linear", "Literature, linear", "Figure of merit and force, linear"],
      ],
      () => this.restyle(),
    );
    this.restyle();
  }

  show(run) {
    this.#run = run;
    this.#fill();
  }

  /** Rings the design with this id. */
  choose(id) {
    this.#chosen = id;
    this.#chart.draw();
  }

  /** Begins the chart anew, with the axes and the colours of now. */
  restyle() {
    this.#chart?.destroy();
    const axes = this.#settings();
    const options = baseOptions();
    options.scales = { x: axis(axes.xName.join(", "), axes.scale), y: axis(axes.yName.join(", "), axes.scale) };
    options.plugins.legend = {
      position: "bottom",
      labels: {
        usePointStyle: true,
        boxWidth: 9,
        boxHeight: 7,
        padding: 10,
        color: colour("muted"),
        font: { size: 11 },
        filter: ({ text }) => text !== EDGE,
      },
    };
    options.plugins.tooltip.callbacks = { label: ({ raw }) => tooltip(raw.item, axes) };
    options.plugins.tooltip.filter = ({ raw }, at) => raw.item !== undefined && at === 0;
    options.onHover = (event, _, chart) => {
      chart.canvas.style.cursor = this.#idAt(event) ? "pointer" : "default";
    };
    options.onClick = (event) => {
      const id = this.#idAt(event);
      if (id) this.#onChoose(id);
    };
    const ring = { id: "ring", afterDatasetsDraw: (chart) => this.#drawRing(chart) };
    this.#chart = new Chart(byId("front-plot"), { type: "scatter", data: { datasets: [] }, options, plugins: [ring] });
    this.#fill();
  }

  /** Where in the window the design of the front with this id is drawn; `null` where it is not. */
  pixelOf(id) {
    const place = this.#placeOf(id);
    if (!place) return null;
    const { left, top } = this.#chart.canvas.getBoundingClientRect();
    return { x: left + place.x, y: top + place.y };
  }

  #settings() {
    return AXES[this.#axes?.value ?? "objectives"];
  }

  #fill() {
    const axes = this.#settings();
    const { data, options } = this.#chart;
    data.datasets = datasets(this.#run, axes);
    if (axes.literature) {
      for (const name of ["x", "y"]) {
        const read = (item) => item[axes[name]];
        const others = this.#run.literature.map(read);
        const front = frontOf(this.#run).map(read);
        const [min, max] =
          axes.scale === "linear"
            ? [0, linearLimit(this.#run.candidates.map(read), others)]
            : logarithmicLimits([...front, ...others]);
        Object.assign(options.scales[name], { min, max });
      }
    }
    this.#chart.update("none");
    byId("front-note").textContent = note(this.#run, axes, options.scales);
  }

  #placeOf(id) {
    const candidate = this.#run.candidates.find((one) => one.id === id);
    const axes = this.#settings();
    const [point] = placed(candidate ? [candidate] : [], axes);
    if (!point) return null;
    const { x, y } = this.#chart.scales;
    return { x: x.getPixelForValue(point.x), y: y.getPixelForValue(point.y) };
  }

  /** The design under the mouse, of the front first. */
  #idAt(event) {
    const hits = this.#chart.getElementsAtEventForMode(event, "point", { intersect: true }, true);
    const designs = hits
      .map(({ datasetIndex, index, element }) => ({
        id: this.#chart.data.datasets[datasetIndex].data[index].item?.id,
        distance: Math.hypot(element.x - event.x, element.y - event.y),
      }))
      .filter(({ id }) => id !== undefined)
      .sort((a, b) => a.distance - b.distance);
    return (designs.find(({ id }) => this.#run.front.includes(id)) ?? designs[0])?.id;
  }

  #drawRing(chart) {
    const place = this.#chosen && this.#placeOf(this.#chosen);
    if (!place) return;
    const { ctx, chartArea } = chart;
    ctx.save();
    ctx.strokeStyle = colour("ink");
    ctx.lineWidth = 2;
    ctx.beginPath();
    ctx.arc(place.x, place.y, 10, 0, 2 * Math.PI);
    ctx.stroke();
    const right = place.x > chartArea.right - 90;
    ctx.font = `600 12px ${Chart.defaults.font.family}`;
    ctx.textAlign = right ? "right" : "left";
    ctx.textBaseline = "bottom";
    const [x, y] = [place.x + (right ? -12 : 12), Math.max(place.y - 7, chartArea.top + 14)];
    ctx.lineWidth = 4;
    ctx.strokeStyle = colour("surface");
    ctx.strokeText(this.#chosen, x, y);
    ctx.fillStyle = colour("ink");
    ctx.fillText(this.#chosen, x, y);
    ctx.restore();
  }
}

/** The candidates of the front, in its order. */
function frontOf(run) {
  const known = new Map(run.candidates.map((candidate) => [candidate.id, candidate]));
  return run.front.map((id) => known.get(id)).filter(Boolean);
}

/** The chart's layers, the topmost first. */
function datasets(run, axes) {
  const ids = new Set(run.front);
  const front = frontOf(run);
  const layers = [
    {
      label: "front",
      data: placed(front, axes),
      backgroundColor: colour("front"),
      borderColor: colour("surface"),
      borderWidth: 1.5,
      radius: 6.5,
      hoverRadius: 8,
      hitRadius: 4,
    },
  ];
  const solids = placed(run.solids, axes);
  if (solids.length > 0) {
    layers.push({
      label: "front as solids",
      data: solids,
      pointStyle: "rectRot",
      backgroundColor: colour("solid"),
      borderColor: colour("surface"),
      radius: 6,
      hitRadius: 2,
    });
  }
  const flagged = placed(run.candidates.filter(({ flags }) => flags !== ""), axes);
  if (flagged.length > 0) {
    layers.push({
      label: "flagged",
      data: flagged,
      backgroundColor: "transparent",
      borderColor: faint("warn", 0.75),
      borderWidth: 1.2,
      radius: 3.2,
      hitRadius: 1,
    });
  }
  if (axes.literature) layers.push(...literature(run, axes));
  else layers.push(...lines(run, front));
  layers.push({
    label: "evaluated",
    data: placed(run.candidates.filter(({ id, flags }) => !ids.has(id) && flags === ""), axes),
    backgroundColor: faint("muted", 0.4),
    borderWidth: 0,
    radius: 2,
    hitRadius: 1,
  });
  // Marks on an axis are whole.
  return layers.map((layer) => ({ pointStyle: "circle", clip: layer.showLine ? 0 : 8, ...layer }));
}

function literature(run, axes) {
  return SETS.map(([set, label, pointStyle, hue, filled]) => ({
    label,
    data: placed(run.literature.filter((work) => work.set === set), axes),
    pointStyle,
    backgroundColor: filled ? colour(hue) : "transparent",
    borderColor: colour(hue),
    borderWidth: 1.5,
    radius: pointStyle === "circle" ? 4 : 5,
    hitRadius: 3,
  })).filter(({ data }) => data.length > 0);
}

/** The edge of the front, and that of earlier generations. */
function lines(run, front) {
  const line = { showLine: true, pointRadius: 0, pointHitRadius: 0, pointStyle: "line" };
  const shown = [{
    label: EDGE,
    data: staircase(nonDominated(front)),
    borderColor: faint("front", 0.6),
    borderWidth: 1.2,
    ...line,
  }];
  const generations = milestones(run.generation - 1);
  if (generations.length > 0) {
    shown.push({
      label: `after generation ${generations.join(", ")}`,
      data: growth(run.candidates, generations),
      borderColor: faint("muted", 0.8),
      borderWidth: 1,
      borderDash: [3, 3],
      ...line,
    });
  }
  return shown;
}

function tooltip(item, axes) {
  const line = (value, [name, unit]) => `${name}: ${number(value)} ${unit}`;
  const values = [line(item[axes.x], axes.xName), line(item[axes.y], axes.yName)];
  if (item.work !== undefined) return [`${item.work}, ${words(item.technique)}`, ...values];
  if (item.verdict !== undefined) return [`${item.id} as a solid: ${words(item.verdict)}`, ...values];
  const flags = item.flags === "" ? [] : [`flagged: ${item.flags.split(" ").map(words).join(", ")}`];
  const reached = item.angle_deg === undefined ? [] : [`${number(item.angle_deg, 3)}° at ${number(item.bending_pressure, 3)} MPa, ${number(item.max_force, 3)} N`];
  return [item.id, ...values, ...reached, ...flags];
}

/** What these axes leave out. */
function note(run, axes, scales) {
  if (!axes.literature) return "";
  if (axes.scale === "logarithmic") {
    const { x, y } = scales;
    const isAbsent = (one) => !(one[axes.x] >= x.min && one[axes.x] <= x.max && one[axes.y] >= y.min && one[axes.y] <= y.max);
    const absent = run.candidates.filter(isAbsent).length;
    const front = frontOf(run).filter(isAbsent).length;
    return absent === 0 ? "" : `Not on these axes: ${absent} designs of little or no force or angle, ${front} of them on the front.`;
  }
  const beyond = run.literature.filter(
    (work) => work[axes.x] > scales.x.max || work[axes.y] > scales.y.max,
  );
  const names = [...new Set(beyond.map(({ work }) => work))].join(", ");
  return beyond.length === 0 ? "" : `Beyond these axes: ${names}.`;
}
