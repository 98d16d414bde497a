// Formulas on arrays of positions (three numbers a vertex) and faces (three indices a face).

/** Normals of vertices: sums of face normals weighted by area, of length 1; zero where faces cancel. */
export function vertexNormals(positions: Float32Array, faces: Uint32Array, out: Float32Array): void {
  out.fill(0);
  for (let f = 0; f < faces.length; f += 3) {
    const a = 3 * faces[f];
    const b = 3 * faces[f + 1];
    const c = 3 * faces[f + 2];
    const ax = positions[a];
    const ay = positions[a + 1];
    const az = positions[a + 2];
    const ux = positions[b] - ax;
    const uy = positions[b + 1] - ay;
    const uz = positions[b + 2] - az;
    const vx = positions[c] - ax;
    const vy = positions[c + 1] - ay;
    const vz = positions[c + 2] - az;
    const x = uy * vz - uz * vy;
    const y = uz * vx - ux * vz;
    const z = ux * vy - uy * vx;
    out[a] += x;
    out[a + 1] += y;
    out[a + 2] += z;
    out[b] += x;
    out[b + 1] += y;
    out[b + 2] += z;
    out[c] += x;
    out[c + 1] += y;
    out[c + 2] += z;
  }
  for (let v = 0; v < out.length; v += 3) {
    // Not `Math.hypot`, which takes ten times as long.
    const length = Math.sqrt(out[v] ** 2 + out[v + 1] ** 2 + out[v + 2] ** 2);
    const scale = length > 0 ? 1 / length : 0;
    out[v] *= scale;
    out[v + 1] *= scale;
    out[v + 2] *= scale;
  }
}

/** Positions of all corners, three vertices a face. */
export function corners(positions: Float32Array, faces: Uint32Array, out: Float32Array): void {
  for (let k = 0; k < faces.length; k++) {
    const v = 3 * faces[k];
    out[3 * k] = positions[v];
    out[3 * k + 1] = positions[v + 1];
    out[3 * k + 2] = positions[v + 2];
  }
}

/** The normal of each face, at its three corners. */
export function cornerNormals(cornerPositions: Float32Array, out: Float32Array): void {
  const p = cornerPositions;
  for (let k = 0; k < p.length; k += 9) {
    const ux = p[k + 3] - p[k];
    const uy = p[k + 4] - p[k + 1];
    const uz = p[k + 5] - p[k + 2];
    const vx = p[k + 6] - p[k];
    const vy = p[k + 7] - p[k + 1];
    const vz = p[k + 8] - p[k + 2];
    const x = uy * vz - uz * vy;
    const y = uz * vx - ux * vz;
    const z = ux * vy - uy * vx;
    const length = Math.sqrt(x * x + y * y + z * z);
    const scale = length > 0 ? 1 / length : 0;
    for (let corner = k; corner < k + 9; corner += 3) {
      out[corner] = x * scale;
      out[corner + 1] = y * scale;
      out[corner + 2] = z * scale;
    }
  }
}

/** Means of the values of the faces about each vertex; NaN where no face has one. */
export function faceToVertex(values: Float32Array, faces: Uint32Array, numVertices: number): Float32Array {
  const sums = new Float32Array(numVertices);
  const counts = new Uint16Array(numVertices);
  for (let k = 0; k < faces.length; k++) {
    const value = values[(k / 3) | 0];
    if (!Number.isNaN(value)) {
      sums[faces[k]] += value;
      counts[faces[k]] += 1;
    }
  }
  for (let v = 0; v < numVertices; v++) {
    sums[v] = counts[v] > 0 ? sums[v] / counts[v] : NaN;
  }
  return sums;
}

/** Each edge once, as pairs of vertices. */
export function edges(faces: Uint32Array, numVertices: number): Uint32Array {
  const found = new Set<number>();
  for (let f = 0; f < faces.length; f += 3) {
    for (let k = 0; k < 3; k++) {
      const a = faces[f + k];
      const b = faces[f + ((k + 1) % 3)];
      // Below 2^53 for all meshes that memory holds.
      found.add(a < b ? a * numVertices + b : b * numVertices + a);
    }
  }
  const pairs = new Uint32Array(2 * found.size);
  let next = 0;
  for (const key of found) {
    pairs[next++] = Math.floor(key / numVertices);
    pairs[next++] = key % numVertices;
  }
  return pairs;
}

export interface Box {
  min: [number, number, number];
  max: [number, number, number];
}

export function emptyBox(): Box {
  return { min: [Infinity, Infinity, Infinity], max: [-Infinity, -Infinity, -Infinity] };
}

/** Widens a box by the vertices from `start` to `end`. */
export function include(box: Box, positions: Float32Array, start: number, end: number): void {
  for (let k = 3 * start; k < 3 * end; k++) {
    const axis = k % 3;
    const value = positions[k];
    if (value < box.min[axis]) {
      box.min[axis] = value;
    }
    if (value > box.max[axis]) {
      box.max[axis] = value;
    }
  }
}

/** Distances of vertices of the same numbers. */
export function distances(a: Float32Array, b: Float32Array): Float32Array {
  const out = new Float32Array(a.length / 3);
  for (let v = 0; v < out.length; v++) {
    const x = a[3 * v] - b[3 * v];
    const y = a[3 * v + 1] - b[3 * v + 1];
    const z = a[3 * v + 2] - b[3 * v + 2];
    out[v] = Math.sqrt(x * x + y * y + z * z);
  }
  return out;
}

/** The range that covers 99 in 100 values: about zero if there are negative ones, else from zero. */
export function coveringRange(values: Float32Array): { low: number; high: number } {
  const known = values.filter((value) => Number.isFinite(value));
  const sizes = known.map(Math.abs).sort();
  const top = sizes.length > 0 ? sizes[Math.floor(0.99 * (sizes.length - 1))] : 0;
  const high = top > 0 ? top : 1;
  return { low: known.some((value) => value < 0) ? -high : 0, high };
}
