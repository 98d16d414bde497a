import assert from "node:assert/strict";
import test from "node:test";
import {
  cornerNormals,
  corners,
  coveringRange,
  distances,
  edges,
  emptyBox,
  faceToVertex,
  include,
  vertexNormals,
} from "../src/scene/mesh-math";
import { pick } from "../src/scene/pick";

// Two triangles of a roof: its ridge is the edge from (0, 0, 1) to (0, 1, 1).
const positions = new Float32Array([0, 0, 1, 0, 1, 1, -1, 0, 0, 1, 0, 0]);
const faces = new Uint32Array([0, 1, 2, 1, 0, 3]);

test("normals of the ridge are the mean of both sides, facets have their own", () => {
  const normals = new Float32Array(12);
  vertexNormals(positions, faces, normals);
  const flat = new Float32Array(18);
  const at = new Float32Array(18);
  corners(positions, faces, at);
  cornerNormals(at, flat);
  assert.deepEqual([...normals.slice(0, 3)].map(Math.round), [0, 0, 1]);
  const half = Math.SQRT1_2;
  [-half, 0, half].forEach((value, k) => assert.ok(Math.abs(flat[k] - value) < 1e-6));
  [half, 0, half].forEach((value, k) => assert.ok(Math.abs(flat[9 + k] - value) < 1e-6));
});

test("a collapsed face has no normal instead of NaN", () => {
  const normals = new Float32Array(9).fill(7);
  vertexNormals(new Float32Array(9), new Uint32Array([0, 1, 2]), normals);
  assert.deepEqual([...normals], new Array(9).fill(0));
});

test("values of faces are averaged where faces have them", () => {
  assert.deepEqual([...faceToVertex(new Float32Array([1, 3]), faces, 4)], [2, 2, 1, 3]);
  assert.deepEqual([...faceToVertex(new Float32Array([1, NaN]), faces, 5)], [1, 1, 1, NaN, NaN]);
});

test("each edge stands once", () => {
  const pairs = edges(faces, 4);
  const named = new Set<string>();
  for (let k = 0; k < pairs.length; k += 2) {
    named.add(`${pairs[k]}-${pairs[k + 1]}`);
  }
  assert.deepEqual([...named].sort(), ["0-1", "0-2", "0-3", "1-2", "1-3"]);
});

test("boxes, distances and ranges", () => {
  const box = emptyBox();
  include(box, positions, 1, 3);
  assert.deepEqual(box, { min: [-1, 0, 0], max: [0, 1, 1] });
  const moved = positions.map((value, k) => (k % 3 === 2 ? value + 2 : value));
  assert.deepEqual([...distances(positions, moved)], [2, 2, 2, 2]);
  assert.deepEqual(coveringRange(new Float32Array([0, NaN])), { low: 0, high: 1 });
  assert.deepEqual(coveringRange(new Float32Array([1, -3, 2])), { low: -2, high: 2 });
});

test("a ray meets the nearest face from either side, unless it is cut away", () => {
  const down = pick([0.25, 0.25, 9], [0, 0, -1], positions, faces, 0, 2);
  assert.equal(down?.face, 1);
  assert.equal(down?.vertex, 0);
  assert.ok(Math.abs((down?.point[2] ?? 0) - 0.75) < 1e-6);
  const up = pick([-0.25, 0.25, -9], [0, 0, 1], positions, faces, 0, 2);
  assert.equal(up?.face, 0);
  assert.equal(pick([5, 5, 9], [0, 0, -1], positions, faces, 0, 2), null);
  assert.equal(pick([0.25, 0.25, 9], [0, 0, -1], positions, faces, 0, 2, (p) => p[0] < 0), null);
  assert.equal(pick([0.25, 0.25, 9], [0, 0, 1], positions, faces, 0, 2), null);
});
