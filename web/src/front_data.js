// What the front's figure shows, as plain points: the front, its growth, and who else is on the same axes.

/** The axes a person may choose: what is read off a candidate, its name with unit, and the scale. */
export const AXES = {
  objectives: {
    x: "bending",
    y: "blocking",
    xName: ["bending F_c", "rad/(m J)^(1/p)"],
    yName: ["blocking F_bf", "N/kPa"],
    scale: "linear",
    literature: false,
  },
  logarithmic: {
    x: "figure_of_merit",
    y: "max_force",
    xName: ["figure of merit", "deg/(kPa m)"],
    yName: ["largest force", "N"],
    scale: "logarithmic",
    literature: true,
  },
  linear: {
    x: "figure_of_merit",
    y: "max_force",
    xName: ["figure of merit", "deg/(kPa m)"],
    yName: ["largest force", "N"],
    scale: "linear",
    literature: true,
  },
};

/** The generation that an id such as `g012-034` was born in; `NaN` where it does not say. */
export const generationOf = (id) => Number(/^g(\d+)-/.exec(id)?.[1] ?? NaN);

/** Those that no other one beats in both objectives, from the one that bends most. */
export function nonDominated(candidates) {
  const sorted = [...candidates].sort((a, b) => b.bending - a.bending || b.blocking - a.blocking);
  let best = -Infinity;
  return sorted.filter((candidate) => {
    const stays = candidate.blocking > best;
    best = Math.max(best, candidate.blocking);
    return stays;
  });
}

/** The edge of what the points of a front dominate, down to both axes: the corners of its steps. */
export function staircase(front) {
  if (front.length === 0) return [];
  const corners = [{ x: front[0].bending, y: 0 }];
  front.forEach(({ bending, blocking }, k) => {
    corners.push({ x: bending, y: blocking });
    const next = front[k + 1];
    corners.push({ x: next ? next.bending : 0, y: blocking });
  });
  return corners;
}

/** Up to four generations before the newest, evenly apart, the first among them. */
export function milestones(newest) {
  if (!(newest > 0)) return [];
  const quarters = [0, 0.25, 0.5, 0.75].map((share) => Math.round(share * newest));
  return [...new Set(quarters)].filter((generation) => generation < newest);
}

/** The fronts after these generations as one broken line; `NaN` parts them. */
export function growth(candidates, generations) {
  const gap = { x: NaN, y: NaN };
  return generations.flatMap((generation) => {
    const known = candidates.filter(({ id }) => generationOf(id) <= generation);
    return [...staircase(nonDominated(known)), gap];
  });
}

/** The points with a place on these axes; a logarithmic scale has none for what is not positive. */
export function placed(items, axes) {
  const least = axes.scale === "logarithmic" ? Number.MIN_VALUE : -Infinity;
  return items
    .map((item) => ({ x: item[axes.x], y: item[axes.y], item }))
    .filter(({ x, y }) => Number.isFinite(x) && Number.isFinite(y) && x >= least && y >= least);
}

/** Where a logarithmic axis begins and ends: around all its values, with some room. */
export function logarithmicLimits(values) {
  const positive = values.filter((value) => value > 0);
  if (positive.length === 0) return [0.1, 10];
  const [least, most] = [(a, b) => Math.min(a, b), (a, b) => Math.max(a, b)].map((pick) => positive.reduce(pick));
  return [least / 1.6, most * 1.6];
}

/** Where a linear axis ends, a round number: beyond the run and nine tenths of the literature. */
export function linearLimit(own, literature) {
  const sorted = literature.filter(Number.isFinite).sort((a, b) => a - b);
  const most = sorted[Math.floor(0.9 * (sorted.length - 1))] ?? 0;
  const limit = 1.05 * own.filter(Number.isFinite).reduce((a, b) => Math.max(a, b), most);
  if (limit === 0) return 1;
  const step = 10 ** Math.floor(Math.log10(limit)) / 2;
  return step * Math.ceil(limit / step);
}
