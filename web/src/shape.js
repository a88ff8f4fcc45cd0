// A design's deformation as arrays: places between the recorded frames, and the ranges of its colours.

/** What may be shown as colour: name, title with unit, value at rest, digits that tell. */
export const COLOURS = {
  stress: { title: "largest principal stress, MPa", rest: 0, digits: 2 },
  stretch: { title: "largest principal stretch, 1", rest: 1, digits: 4 },
};
/** The share of all values that the ramp covers: the few beyond sit in single sharp folds. */
const COVERED = 0.995;
/** The least share of a path's time that a step takes: falls at a constant pressure are seen too. */
const LEAST_STEP = 0.02;

/** The server's answer with its lists as typed arrays, a clock for each scenario, and the ranges of the colours. */
export function prepare(answer) {
  const scenarios = answer.scenarios.map((scenario) => {
    const frames = scenario.frames.map((frame) => ({
      pressure: frame.pressure,
      positions: Float32Array.from(frame.positions),
      stress: Float32Array.from(frame.stress),
      stretch: Float32Array.from(frame.stretch),
    }));
    return { ...scenario, frames, clock: clockOf(frames.map(({ pressure }) => pressure)) };
  });
  const ranges = {};
  for (const [name, { rest }] of Object.entries(COLOURS)) {
    ranges[name] = [rest, rangeTop(scenarios.flatMap(({ frames }) => frames.map((frame) => frame[name])), rest)];
  }
  return { ...answer, reference: Float32Array.from(answer.reference), scenarios, ranges };
}

/** The times, from 0 to 1, at which the frames stand: in the pace of the pressure. */
export function clockOf(pressures) {
  const most = Math.max(...pressures.map(Math.abs), Number.MIN_VALUE);
  const clock = [0];
  for (let k = 1; k < pressures.length; k += 1) {
    const step = Math.abs(pressures[k] - pressures[k - 1]) / most;
    clock.push(clock[k - 1] + Math.max(step, LEAST_STEP));
  }
  const end = clock.at(-1) || 1;
  return clock.map((time) => time / end);
}

/** The frame at or before a time from 0 to 1, and the share of the way to the next. */
export function placeAt(clock, time) {
  const last = clock.length - 1;
  const next = clock.findIndex((at) => at > time);
  if (next < 0) return { frame: last, share: 0 };
  const frame = Math.max(next - 1, 0);
  return { frame, share: (time - clock[frame]) / (clock[next] - clock[frame]) };
}

/** What `read` gives between two neighbours of `list`. */
export function between(list, { frame, share }, read) {
  const here = read(list[frame]);
  return share === 0 ? here : here + share * (read(list[frame + 1]) - here);
}

/** Writes the array `name` between two frames into `out`. */
export function blend(frames, { frame, share }, name, out) {
  const here = frames[frame][name];
  if (share === 0) return out.set(here);
  const next = frames[frame + 1][name];
  for (let k = 0; k < out.length; k += 1) out[k] = here[k] + share * (next[k] - here[k]);
  return undefined;
}

function rangeTop(arrays, rest) {
  const length = arrays.reduce((sum, array) => sum + array.length, 0);
  const all = new Float32Array(length);
  let at = 0;
  for (const array of arrays) {
    all.set(array, at);
    at += array.length;
  }
  const sorted = all.filter(Number.isFinite).sort();
  const top = sorted[Math.floor(COVERED * (sorted.length - 1))] ?? rest;
  return top > rest ? top : rest + 1e-6;
}
