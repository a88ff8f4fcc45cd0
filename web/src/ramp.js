// Numbers as colours: a ramp of even steps in lightness, also for those who see fewer hues.
// Nine stops of viridis (van der Walt & Smith 2015, public domain), from its second on: its darkest is lost on a dark page.

const STOPS = [
  [72, 40, 120], [62, 74, 137], [49, 104, 142], [38, 130, 142], [31, 158, 137],
  [53, 183, 121], [110, 206, 88], [181, 222, 43], [253, 231, 37],
];
const STEPS = 256;

/** The ramp as `STEPS` triples of sRGB shares, from the least to the largest. */
export const RAMP = Float32Array.from({ length: 3 * STEPS }, (_, k) => {
  const at = (Math.floor(k / 3) / (STEPS - 1)) * (STOPS.length - 1);
  const low = Math.min(Math.floor(at), STOPS.length - 2);
  const [a, b] = [STOPS[low][k % 3], STOPS[low + 1][k % 3]];
  return (a + (at - low) * (b - a)) / 255;
});

/** Where in `RAMP` the colour of `value` begins; values beyond the range take its ends. */
export function rampIndex(value, [least, most]) {
  const share = (value - least) / (most - least || 1);
  return 3 * Math.round((STEPS - 1) * Math.min(Math.max(share || 0, 0), 1));
}

/** Draws the ramp into a canvas, the largest on top. */
export function drawRamp(canvas) {
  const context = canvas.getContext("2d");
  for (let y = 0; y < canvas.height; y += 1) {
    const k = rampIndex(canvas.height - 1 - y, [0, canvas.height - 1]);
    const [r, g, b] = RAMP.subarray(k, k + 3).map((share) => 255 * share);
    context.fillStyle = `rgb(${r} ${g} ${b})`;
    context.fillRect(0, y, canvas.width, 1);
  }
}
