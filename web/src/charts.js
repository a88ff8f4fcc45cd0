// The chart library, with no more of it than is used, and the looks that all charts share.
import {
  Chart,
  Legend,
  LinearScale,
  LineElement,
  LogarithmicScale,
  PointElement,
  ScatterController,
  Title,
  Tooltip,
} from "chart.js";
import { colour } from "./theme.js";
import { number } from "./format.js";

Chart.register(Legend, LinearScale, LineElement, LogarithmicScale, PointElement, ScatterController, Title, Tooltip);
Chart.defaults.font.family = "system-ui, 'DejaVu Sans', sans-serif";
Chart.defaults.animation = false;
Chart.defaults.maintainAspectRatio = false;

export { Chart };

/** Options of a chart in the colours of now. */
export function baseOptions() {
  return {
    plugins: {
      legend: { display: false },
      tooltip: {
        displayColors: false,
        backgroundColor: colour("ink"),
        titleColor: colour("surface"),
        bodyColor: colour("surface"),
        padding: 8,
        cornerRadius: 4,
      },
    },
    interaction: { mode: "nearest", intersect: true },
  };
}

/** Options of a small chart over `x`: what it shows stands above it, where there is room for words. */
export function smallOptions(title, x) {
  const options = baseOptions();
  options.plugins.title = {
    display: true,
    text: title,
    align: "start",
    color: colour("ink"),
    font: { size: 11, weight: "normal" },
    padding: { top: 2, bottom: 9 },
  };
  options.scales = { x: axis(x, "linear", 11), y: axis("", "linear", 11) };
  options.scales.x.min = 0;
  options.interaction = { mode: "nearest", axis: "x", intersect: false };
  return options;
}

/** An axis with its title and unit, where it has one. */
export function axis(text, type = "linear", size = 12) {
  return {
    type,
    title: { display: text !== "", text, color: colour("ink"), font: { size }, padding: 2 },
    grid: { color: colour("grid"), tickLength: 4 },
    border: { color: colour("line") },
    ticks: {
      color: colour("muted"),
      font: { size: 11 },
      maxRotation: 0,
      maxTicksLimit: size < 12 ? 5 : 8,
      callback: type === "logarithmic" ? decades : (value) => number(value, 4),
    },
  };
}

/** Names the powers of ten alone. */
function decades(value) {
  return Math.abs(Math.log10(value) % 1) < 1e-9 ? String(value) : "";
}
