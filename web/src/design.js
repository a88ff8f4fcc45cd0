// The chosen design: asks for it, plays its deformation, and keeps picture, curves and figures in step.
import { ask } from "./api.js";
import { byId, choice } from "./dom.js";
import { number, words } from "./format.js";
import { Curves } from "./curves.js";
import { showFacts, showNoFacts } from "./facts.js";
import { drawRamp } from "./ramp.js";
import { COLOURS, between, placeAt, prepare } from "./shape.js";
import { View } from "./view.js";

/** Seconds from no pressure to all of it, and at its end. */
const RISE = 4;
const REST = 0.8;
/** Shapes that are kept; one has some megabytes. */
const KEPT = 12;

/** Milliseconds before a shape is asked for: who walks along the front does not want all of them. */
const PASSING = 250;

const calm = matchMedia("(prefers-reduced-motion: reduce)");

export class DesignPanel {
  #view = null;
  #curves = new Curves();
  #shapes = new Map();
  #shape = null;
  #asked = null;
  #time = 0;
  #playing = false;
  #once = false;
  #scenario = null;
  #offered = [];
  #colour;

  constructor() {
    const redraw = () => this.#draw();
    this.#offer([{ name: "bending" }, { name: "blocked", plane: {} }]);
    this.#colour = choice(
      byId("colour"),
      [
        ["stress", "Stress", "C: largest principal stress"],
        ["stretch", "Stretch", "C: largest principal stretch"],
        ["plain", "Plain", "C: no colour"],
      ],
      redraw,
    );
    drawRamp(byId("legend-ramp"));
    byId("play").addEventListener("click", (event) => {
      if (event.detail > 0) event.currentTarget.blur();
      this.togglePlay();
    });
    byId("place").addEventListener("input", (event) => {
      this.#playing = false;
      this.#time = Number(event.target.value) / 1000;
      this.#draw();
    });
    showFacts(null);
    // Where all columns fit beside each other there is room for the genome.
    byId("genome").open = matchMedia("(min-width: 1600px)").matches;
    say("Choose a design: click a point of the front, or press an arrow key.");
  }

  /** Asks for the design with this id and shows what comes; a newer question forgets an older one. */
  async show(id) {
    this.#asked?.abort();
    this.#asked = new AbortController();
    const { signal } = this.#asked;
    this.#forget();
    await Promise.all([this.#showFacts(id, signal), this.#showShape(id, signal)]);
  }

  togglePlay() {
    if (!this.#shape) return;
    this.#playing = !this.#playing;
    this.#once = false;
    if (this.#playing) this.#run();
    this.#draw();
  }

  nextScenario() {
    this.#scenario.next();
  }

  nextColour() {
    this.#colour.next();
  }

  resetView() {
    this.#view?.reset();
  }

  /** Draws all anew in the colours of now. */
  restyle() {
    this.#curves.restyle();
    if (this.#shape) this.#take(this.#shape);
  }

  #forget() {
    this.#playing = false;
    this.#shape = null;
    this.#view?.clear();
    this.#curves.take([]);
    byId("frame").textContent = "";
    byId("caption").textContent = "";
    byId("legend").hidden = true;
    for (const control of [byId("play"), byId("place")]) control.disabled = true;
  }

  async #showFacts(id, signal) {
    try {
      const design = await ask(`design/${encodeURIComponent(id)}`, signal);
      if (!signal.aborted) showFacts(design);
    } catch (error) {
      if (!signal.aborted) showNoFacts(error.message);
    }
  }

  async #showShape(id, signal) {
    const since = performance.now();
    const wait = () => say(`Computing how ${id} deforms… ${Math.round((performance.now() - since) / 1000)} s`, true);
    const clock = setInterval(wait, 1000);
    wait();
    try {
      const shape = this.#shapes.get(id) ?? (await askShape(id, signal));
      if (signal.aborted) return;
      say("");
      this.#keep(id, shape);
      this.#time = calm.matches ? 1 : 0;
      this.#take(shape);
      if (!calm.matches) {
        this.#playing = true;
        this.#once = true;
        this.#run();
      }
    } catch (error) {
      if (!signal.aborted) say(`No picture of ${id}: ${error.message}`);
    } finally {
      clearInterval(clock);
    }
  }

  /** Keeps the shapes seen last. */
  #keep(id, shape) {
    this.#shapes.delete(id);
    this.#shapes.set(id, shape);
    if (this.#shapes.size > KEPT) this.#shapes.delete(this.#shapes.keys().next().value);
  }

  #take(shape) {
    this.#shape = shape;
    try {
      // Only now: it takes a while on machines without a graphics card.
      this.#view ??= new View(byId("view"), showScale);
    } catch {
      say("This browser has no WebGL, which the picture in three dimensions needs.");
    }
    this.#view?.take(shape);
    this.#curves.take(shape.scenarios);
    this.#offer(shape.scenarios);
    for (const control of [byId("play"), byId("place")]) control.disabled = false;
    this.#draw();
  }

  /** Makes the choice one of these scenarios, of the same as before where it is among them. */
  #offer(scenarios) {
    const names = scenarios.map(({ name }) => name);
    if (names.join() === this.#offered.join()) return;
    this.#offered = names;
    const before = this.#scenario?.value;
    const option = ({ name, plane }) => {
      const label = words(name);
      return [name, label[0].toUpperCase() + label.slice(1), plane ? "B: a plane in its way" : "B: free"];
    };
    this.#scenario = choice(byId("scenario"), scenarios.map(option), () => this.#draw());
    if (names.includes(before)) this.#scenario.choose(before);
  }

  /** Plays until the person stops it, or to the end of the path where a design is new. */
  #run() {
    let before = performance.now();
    let rest = 0;
    if (this.#time >= 1) this.#time = 0;
    const shape = this.#shape;
    const step = (now) => {
      if (!this.#playing || this.#shape !== shape) return;
      const seconds = Math.max(0, now - before) / 1000;
      before = now;
      if (this.#time >= 1) {
        rest += seconds;
        if (this.#once) this.#playing = false;
        else if (rest > REST) [this.#time, rest] = [0, 0];
      } else {
        this.#time = Math.min(this.#time + seconds / RISE, 1);
      }
      this.#draw();
      requestAnimationFrame(step);
    };
    requestAnimationFrame(step);
  }

  #draw() {
    byId("play").textContent = this.#playing ? "Pause" : "Play";
    if (!this.#shape) return;
    const scenario = this.#shape.scenarios.find(({ name }) => name === this.#scenario.value) ?? this.#shape.scenarios[0];
    const place = placeAt(scenario.clock, this.#time);
    const read = (name) => between(scenario.rows, place, (row) => row[name]);
    byId("place").value = String(Math.round(1000 * this.#time));
    const force = scenario.plane ? ` · ${number(read("plane_force"))} N` : "";
    byId("frame").textContent = `${read("pressure").toFixed(3)} MPa · ${read("angle_deg").toFixed(1)}°${force}`;
    byId("caption").textContent = captionOf(this.#shape, scenario);
    this.#view?.show(scenario, place, this.#colour.value);
    this.#curves.mark(scenario, place);
    showLegend(this.#shape.ranges[this.#colour.value], COLOURS[this.#colour.value]);
  }
}

/** The prepared shape of a design, asked for when the person has stayed with it for a moment. */
async function askShape(id, signal) {
  await new Promise((resolve) => setTimeout(resolve, PASSING));
  signal.throwIfAborted();
  return prepare(await ask(`shape/${encodeURIComponent(id)}`, signal));
}

/** What is shown, and why the path goes no further where it was not walked to its end. */
function captionOf({ thickness }, { ending, rows }) {
  const wall = `middle of the wall, ${number(thickness)} mm thick`;
  if (ending === "reached") return wall;
  return `${words(ending)} at ${number(rows.at(-1).pressure)} MPa · ${wall}`;
}

/** A line over the picture; `busy` says that it will change by itself. */
function say(text, busy = false) {
  const line = byId("message");
  line.textContent = text;
  line.hidden = text === "";
  line.classList.toggle("busy", busy);
}

function showLegend(range, named) {
  byId("legend").hidden = !range;
  if (!range) return;
  const [least, most] = range;
  byId("legend-title").textContent = named.title;
  byId("legend-top").textContent = `≥ ${number(most, named.digits)}`;
  byId("legend-middle").textContent = number((least + most) / 2, named.digits);
  byId("legend-bottom").textContent = number(least);
}

/** A bar of 1, 2 or 5 times a power of ten of millimetres, some sixty pixels long. */
function showScale(pixels) {
  byId("scale").hidden = pixels === null;
  if (pixels === null) return;
  const wanted = 60 / pixels;
  const power = 10 ** Math.floor(Math.log10(wanted));
  const length = power * [1, 2, 5].findLast((step) => step * power <= wanted);
  byId("scale-bar").style.width = `${length * pixels}px`;
  byId("scale-text").textContent = `${length} mm`;
}
