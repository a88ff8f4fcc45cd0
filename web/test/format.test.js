// Numbers as a person reads them.
import assert from "node:assert/strict";
import { test } from "node:test";
import { count, duration, number, percent, words } from "../src/format.js";

test("numbers keep so many digits, and what is none is a dash", () => {
  assert.equal(number(0.046524), "0.0465");
  assert.equal(number(3.6313), "3.63");
  assert.equal(number(1234.5), "1235");
  assert.equal(number(0.00016682), "1.67e-4");
  assert.equal(number(0), "0");
  assert.equal(number(null), "–");
  assert.equal(number(NaN), "–");
});

test("counts, shares, times and names", () => {
  assert.equal(count(1234567), "1\u2009234\u2009567");
  assert.equal(percent(0.1234), "12\u2009%");
  assert.equal(duration(812), "14 min");
  assert.equal(duration(6000), "1 h 40 min");
  assert.equal(duration(200000), "2 d 7 h");
  assert.equal(duration(null), "–");
  assert.equal(words("Surface/unresolved_surface"), "surface: unresolved surface");
});
