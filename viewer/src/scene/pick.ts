// What a ray meets first.

export type Vector = readonly [number, number, number];

export interface Hit {
  /** Face, by its number in the whole. */
  face: number;
  /** Its corner nearest to the point. */
  vertex: number;
  distance: number;
  point: [number, number, number];
}

/** The nearest face from `start` to `end` that the ray meets, from either side; `keep` says which points count. */
export function pick(
  origin: Vector,
  direction: Vector,
  positions: Float32Array,
  faces: Uint32Array,
  start: number,
  end: number,
  keep: (point: Vector) => boolean = () => true,
): Hit | null {
  let best: Hit | null = null;
  for (let face = start; face < end; face++) {
    const distance = meet(origin, direction, positions, faces, 3 * face);
    if (!(distance > 0) || (best !== null && distance >= best.distance)) {
      continue;
    }
    const point: [number, number, number] = [
      origin[0] + distance * direction[0],
      origin[1] + distance * direction[1],
      origin[2] + distance * direction[2],
    ];
    if (keep(point)) {
      best = { face, vertex: nearestCorner(point, positions, faces, 3 * face), distance, point };
    }
  }
  return best;
}

/** Where a ray meets a triangle (Möller and Trumbore 1997), or NaN. */
function meet(o: Vector, d: Vector, p: Float32Array, faces: Uint32Array, f: number): number {
  const a = 3 * faces[f];
  const b = 3 * faces[f + 1];
  const c = 3 * faces[f + 2];
  const e1x = p[b] - p[a];
  const e1y = p[b + 1] - p[a + 1];
  const e1z = p[b + 2] - p[a + 2];
  const e2x = p[c] - p[a];
  const e2y = p[c + 1] - p[a + 1];
  const e2z = p[c + 2] - p[a + 2];
  const px = d[1] * e2z - d[2] * e2y;
  const py = d[2] * e2x - d[0] * e2z;
  const pz = d[0] * e2y - d[1] * e2x;
  const inverse = 1 / (e1x * px + e1y * py + e1z * pz);
  const tx = o[0] - p[a];
  const ty = o[1] - p[a + 1];
  const tz = o[2] - p[a + 2];
  const u = (tx * px + ty * py + tz * pz) * inverse;
  if (!(u >= 0 && u <= 1)) {
    return NaN;
  }
  const qx = ty * e1z - tz * e1y;
  const qy = tz * e1x - tx * e1z;
  const qz = tx * e1y - ty * e1x;
  const v = (d[0] * qx + d[1] * qy + d[2] * qz) * inverse;
  if (!(v >= 0 && u + v <= 1)) {
    return NaN;
  }
  return (e2x * qx + e2y * qy + e2z * qz) * inverse;
}

function nearestCorner(point: Vector, p: Float32Array, faces: Uint32Array, f: number): number {
  let best = faces[f];
  let least = Infinity;
  for (let k = f; k < f + 3; k++) {
    const v = 3 * faces[k];
    const distance = Math.hypot(p[v] - point[0], p[v + 1] - point[1], p[v + 2] - point[2]);
    if (distance < least) {
      least = distance;
      best = faces[k];
    }
  }
  return best;
}
