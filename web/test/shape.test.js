// The clock of a path and the states between its frames, against what a hand computes.
import assert from "node:assert/strict";
import { test } from "node:test";
import { between, blend, clockOf, placeAt, prepare } from "../src/shape.js";

test("time runs with the pressure, and a snap takes some", () => {
  const clock = clockOf([0, 0.1, 0.1, 0.2]);
  assert.equal(clock[0], 0);
  assert.equal(clock.at(-1), 1);
  assert.ok(clock[2] > clock[1]);
  assert.ok(Math.abs(clock[1] - (clock[3] - clock[2])) < 1e-12);
});

test("a path that is a single state stands still", () => {
  assert.deepEqual(clockOf([0]), [0]);
  assert.deepEqual(placeAt([0], 0.7), { frame: 0, share: 0 });
});

test("between two frames everything is linear", () => {
  const clock = [0, 0.5, 1];
  assert.deepEqual(placeAt(clock, 0), { frame: 0, share: 0 });
  assert.deepEqual(placeAt(clock, 0.75), { frame: 1, share: 0.5 });
  assert.deepEqual(placeAt(clock, 1), { frame: 2, share: 0 });
  assert.equal(between([{ p: 1 }, { p: 3 }], { frame: 0, share: 0.25 }, ({ p }) => p), 1.5);
  const out = new Float32Array(2);
  blend([{ x: [0, 2] }, { x: [4, 4] }], { frame: 0, share: 0.5 }, "x", out);
  assert.deepEqual([...out], [2, 3]);
});

test("ranges begin at rest and end where nearly all values do", () => {
  const stress = Array.from({ length: 1000 }, (_, k) => (k === 999 ? 1e6 : k / 1000));
  const frame = { pressure: 0, positions: [], stress, stretch: [1, 1] };
  const { ranges } = prepare({ reference: [], scenarios: [{ name: "bending", rows: [], frames: [frame] }] });
  assert.equal(ranges.stress[0], 0);
  assert.ok(ranges.stress[1] < 1);
  // A part at rest has no largest stretch, but a range all the same.
  assert.equal(ranges.stretch[0], 1);
  assert.ok(ranges.stretch[1] > 1);
});
