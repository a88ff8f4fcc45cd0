// Two small charts above each other: hypervolume and spread by generation.
import { Chart, smallOptions } from "./charts.js";
import { byId } from "./dom.js";
import { number } from "./format.js";
import { colour } from "./theme.js";

const PLOTS = [
  ["hypervolume", "hypervolume, unit of F_c × F_bf"],
  ["spread", "spread of the front, 1"],
];

export class HistoryPlots {
  #history = [];
  #generations = 1;
  #charts = [];

  constructor() {
    this.restyle();
  }

  show(run) {
    this.#history = run.history;
    this.#generations = run.generations;
    this.#charts.forEach((chart, k) => this.#fill(chart, PLOTS[k][0]));
  }

  /** Begins the charts anew, with the colours of now. */
  restyle() {
    this.#charts.forEach((chart) => chart.destroy());
    this.#charts = PLOTS.map(([name, title]) => {
      const options = smallOptions(title, name === "spread" ? "generation" : "");
      options.scales.x.ticks.precision = 0;
      options.scales.y.beginAtZero = true;
      options.plugins.tooltip.callbacks = {
        label: ({ raw: { x, y, row } }) => [
          `generation ${x}: ${number(y)}`,
          `${row.feasible} feasible, front of ${row.front}`,
        ],
      };
      const chart = new Chart(byId(`${name}-plot`), { type: "scatter", data: { datasets: [] }, options });
      this.#fill(chart, name);
      return chart;
    });
  }

  #fill(chart, name) {
    const data = this.#history
      .map((row) => ({ x: row.generation, y: row[name], row }))
      .filter(({ y }) => Number.isFinite(y));
    chart.data.datasets = [
      {
        data,
        showLine: true,
        borderColor: colour("smith"),
        backgroundColor: colour("smith"),
        borderWidth: 1.6,
        radius: data.length > 30 ? 0 : 1.8,
        hoverRadius: 4,
      },
    ];
    chart.options.scales.x.max = Math.max(this.#generations - 1, 1);
    chart.update("none");
  }
}
