import assert from "node:assert/strict";
import test from "node:test";
import { undoDifferences } from "../src/data/embedded";
import { colorAt, colorBytes, cssColor } from "../src/scene/color-map";
import { logTicks, readable, ticks } from "../src/scene/ticks";
import { fromDirection } from "../src/scene/views";
import { valueAt } from "../src/ui/plot";
import { curves, extent, figures } from "../src/ui/plot-data";

test("axes have round numbers", () => {
  assert.deepEqual(ticks(0, 1, 5).map(readable), ["0", "0.2", "0.4", "0.6", "0.8", "1"]);
  assert.deepEqual(ticks(-3, 7, 4), [0, 5]);
  assert.deepEqual(ticks(2, 2, 4), [2]);
  assert.deepEqual(logTicks(2e-5, 0.3, 9).map(readable), ["1e-4", "0.001", "0.01", "0.1"]);
});

test("numbers are told in four digits", () => {
  assert.deepEqual([0, 1.23456, 123456, -2e-7, NaN].map(readable), ["0", "1.235", "1.23e5", "-2e-7", "–"]);
});

test("colour maps begin and end as published, and no value is grey", () => {
  assert.deepEqual(colorAt("viridis", 0), [68, 1, 84]);
  assert.deepEqual(colorAt("viridis", 7), [253, 231, 37]);
  assert.equal(cssColor("cividis", NaN), "rgb(153,153,153)");
  assert.equal(colorBytes("coolwarm", 256).length, 1024);
});

test("presets look from where pictures look, whatever is up", () => {
  const round = (v: number[]) => v.map((x) => Math.round(x) + 0);
  assert.deepEqual(round(fromDirection("front", "z")), [0, -1, 0]);
  assert.deepEqual(round(fromDirection("side", "z")), [1, 0, 0]);
  assert.deepEqual(round(fromDirection("top", "z")), [0, 0, 1]);
  assert.deepEqual(round(fromDirection("top", "y")), [0, 1, 0]);
  assert.deepEqual(round(fromDirection("top", "x")), [1, 0, 0]);
});

const stats = {
  time: [0.1, 0.2],
  "energies.bending": [1, 2],
  "energies.membrane": [5, 0],
  "energies.none": [0, 0],
  newton_iterations: [3, 4],
  min_gap: [null, null],
};
const probes = { time: [0, 0.1, 0.2], "tip.x": [1, 2, 3], "tip.z": [4, 5, 6], energy: [7, 8, 9] };

test("figures are those that there are numbers for", () => {
  const keys = figures(stats, probes).map((figure) => figure.key);
  assert.deepEqual(keys, ["energies.", "newton_iterations", "probe:tip", "probe:energy"]);
});

test("curves of a group come largest first, components of a probe together", () => {
  const [energies, , tip] = figures(stats, probes);
  const names = curves(energies, stats, probes, 0).map((curve) => curve.name);
  assert.deepEqual(names, ["membrane", "bending"]);
  assert.deepEqual(curves(tip, stats, probes, 1).map((curve) => [curve.name, curve.result]), [["tip.x", 1], ["tip.z", 1]]);
});

test("extents leave out what a logarithm has not", () => {
  assert.deepEqual(extent([[0, null, 1e-3, 10]], true), [1e-3, 10]);
  assert.equal(extent([[null]], false), null);
  assert.deepEqual(extent([[0, 100]], false), [-4, 104]);
});

test("a curve has the value of the step before a time", () => {
  const [curve] = curves(figures(stats, probes)[1], stats, probes, 0);
  assert.deepEqual([valueAt(curve, 0), valueAt(curve, 0.1), valueAt(curve, 9)], [null, 3, 4]);
});

test("differences of frames wrap round", () => {
  // Two frames of two numbers: 65535, 258; then plus 2 and minus 2.
  const bytes = new Uint8Array([0xff, 2, 0xff, 1, 2, 0xfe, 0, 0xff]);
  assert.deepEqual(undoDifferences(bytes, 2).map((frame) => [...frame]), [[65535, 258], [1, 256]]);
});
