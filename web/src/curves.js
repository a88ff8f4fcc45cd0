// Four curves over the pressure, all scenarios in each, and a mark where the shown frame is.
import { Chart, smallOptions } from "./charts.js";
import { byId } from "./dom.js";
import { number } from "./format.js";
import { between } from "./shape.js";
import { colour } from "./theme.js";

/** What is read off a row, in the unit of the title. */
const CURVES = [
  ["angle", "angle, deg", (row) => row.angle_deg],
  ["force", "force on the plane, N", (row) => row.plane_force],
  ["volume", "volume, cm³", (row) => row.volume / 1000],
  ["work", "work, mJ", (row) => row.work],
];
/** Lines of the scenarios, in their order: pixels drawn and left out. */
const DASHES = [[], [6, 4], [2, 3]];

export class Curves {
  #charts = [];
  #scenarios = [];
  #mark = null;

  constructor() {
    this.restyle();
  }

  /** Takes the scenarios of a shape; none empties the charts. */
  take(scenarios) {
    this.#scenarios = scenarios;
    this.#mark = null;
    this.#charts.forEach((chart, k) => this.#fill(chart, CURVES[k][2]));
  }

  /** Marks `place` on the path of `scenario`. */
  mark(scenario, place) {
    this.#mark = { scenario, place };
    this.#charts.forEach((chart) => chart.draw());
  }

  /** Begins the charts anew, with the colours of now. */
  restyle() {
    this.#charts.forEach((chart) => chart.destroy());
    this.#charts = CURVES.map(([name, title, read], k) => {
      const options = smallOptions(title, k < 2 ? "" : "pressure, MPa");
      options.scales.y.beginAtZero = name !== "volume";
      options.plugins.tooltip.callbacks = {
        label: ({ raw: { x, y, row, scenario } }) => [
          `${scenario}: ${number(y)} at ${number(x)} MPa`,
          ...(row.stability === "stable" ? [] : [row.stability]),
        ],
      };
      options.plugins.tooltip.filter = (_, at) => at < 2;
      const mark = { id: "mark", afterDatasetsDraw: (chart) => this.#drawMark(chart, read) };
      const chart = new Chart(byId(`${name}-plot`), { type: "scatter", data: { datasets: [] }, options, plugins: [mark] });
      this.#fill(chart, read);
      return chart;
    });
  }

  #fill(chart, read) {
    chart.data.datasets = this.#scenarios.map(({ name, rows, plane }, k) => ({
      data: rows.map((row) => ({ x: row.pressure, y: read(row), row, scenario: name })),
      showLine: true,
      borderColor: colour(plane ? "smith" : "front"),
      backgroundColor: colour(plane ? "smith" : "front"),
      borderWidth: 2,
      borderDash: DASHES[k % DASHES.length],
      radius: 0,
      hoverRadius: 4,
      // What is not stable is dotted.
      segment: { borderDash: ({ p1DataIndex }) => (rows[p1DataIndex].stability === "stable" ? undefined : [1, 3]) },
      order: plane ? 0 : 1,
    }));
    for (const name of ["x", "y"]) chart.options.scales[name].display = this.#scenarios.length > 0;
    chart.update("none");
  }

  #drawMark(chart, read) {
    if (!this.#mark) return;
    const { scenario, place } = this.#mark;
    const x = chart.scales.x.getPixelForValue(between(scenario.rows, place, (row) => row.pressure));
    const y = chart.scales.y.getPixelForValue(between(scenario.rows, place, read));
    if (!Number.isFinite(x) || !Number.isFinite(y)) return;
    const { ctx } = chart;
    ctx.save();
    ctx.beginPath();
    ctx.arc(x, y, 5, 0, 2 * Math.PI);
    ctx.fillStyle = colour(HUES[scenario.name] ?? "muted");
    ctx.fill();
    ctx.lineWidth = 2;
    ctx.strokeStyle = colour("surface");
    ctx.stroke();
    ctx.restore();
  }
}
