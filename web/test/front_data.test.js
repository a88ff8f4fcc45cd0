// The front, its edge and its growth, on fronts drawn by hand.
import assert from "node:assert/strict";
import { test } from "node:test";
import { AXES, generationOf, growth, linearLimit, logarithmicLimits, milestones, nonDominated, placed, staircase } from "../src/front_data.js";

const design = (id, bending, blocking) => ({ id, bending, blocking, figure_of_merit: bending, max_force: blocking });

test("the front is what nothing beats in both objectives, from the one that bends most", () => {
  const all = [design("a", 1, 3), design("b", 2, 2), design("c", 1.5, 1), design("d", 3, 0), design("e", 3, 0)];
  assert.deepEqual(nonDominated(all).map(({ id }) => id), ["d", "b", "a"]);
});

test("the edge of a front goes around what it dominates", () => {
  const corners = staircase([design("d", 3, 0.5), design("a", 1, 2)]);
  assert.deepEqual(corners, [{ x: 3, y: 0 }, { x: 3, y: 0.5 }, { x: 1, y: 0.5 }, { x: 1, y: 2 }, { x: 0, y: 2 }]);
  // The area under it is the hypervolume about the origin: 1 x 2 + 2 x 0.5.
  const area = corners.slice(1).reduce((sum, { x, y }, k) => sum + (corners[k].x - x) * y, 0);
  assert.equal(area, 3);
});

test("generations are read off ids", () => {
  assert.equal(generationOf("g012-034"), 12);
  assert.ok(Number.isNaN(generationOf("seed")));
  assert.deepEqual(milestones(39), [0, 10, 20, 29]);
  assert.deepEqual(milestones(1), [0]);
  assert.deepEqual(milestones(0), []);
});

test("growth knows no later generation", () => {
  const line = growth([design("g000-000", 1, 1), design("g005-000", 9, 9)], [0]);
  assert.equal(Math.max(...line.map(({ x }) => x).filter(Number.isFinite)), 1);
});

test("logarithmic axes have no place for nothing", () => {
  const items = [design("a", 1, 0), design("b", 1, 1), design("c", 1, null)];
  assert.deepEqual(placed(items, AXES.logarithmic).map(({ item }) => item.id), ["b"]);
  assert.deepEqual(placed(items, AXES.linear).map(({ item }) => item.id), ["a", "b"]);
});

test("one outlier does not decide the axes", () => {
  const others = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 1000];
  assert.ok(linearLimit([12], others) < 20);
  assert.ok(linearLimit([120], others) > 120);
});

test("logarithmic axes have room around what is positive", () => {
  const [least, most] = logarithmicLimits([0, 0.02, 5, NaN]);
  assert.ok(least > 0 && least < 0.02 && most > 5);
  assert.deepEqual(logarithmicLimits([0]), [0.1, 10]);
});
