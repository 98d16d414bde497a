// Result folders of any size for tests and benches, written as `koiter run` writes them: a sheet with waves over a floor.

import { mkdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { crc32 } from "node:zlib";

export interface Wanted {
  folder: string;
  title?: string;
  /** Cells of the sheet along each side; two triangles a cell. */
  cells: number;
  frames: number;
  /** Height of the waves [m]. */
  amplitude?: number;
  /** Whether `summary.json` says that the run has ended. */
  ended?: boolean;
}

const DT = 1 / 60;

/** Writes the folder; returns the number of faces. */
export function makeResult(wanted: Wanted): number {
  const { folder, cells, frames, amplitude = 0.1, title = "Waves", ended = true } = wanted;
  const side = cells + 1;
  const sheet = { vertices: side * side, faces: 2 * cells * cells };
  mkdirSync(join(folder, "frames"), { recursive: true });
  const parts = [
    part("sheet", "shell", [0, sheet.vertices], [0, sheet.faces]),
    part("floor", "obstacle", [sheet.vertices, sheet.vertices + 4], [sheet.faces, sheet.faces + 2]),
  ];
  const manifest = {
    format: "koiter-result",
    format_version: 1,
    version: "0.1.0",
    title,
    up_axis: "z",
    scene_text: `title = "${title}"\n`,
    parts,
  };
  writeFileSync(join(folder, "manifest.json"), JSON.stringify(manifest));
  const faces = sheetFaces(cells);
  const first = sheet.vertices;
  faces.push(first, first + 1, first + 2, first, first + 2, first + 3);
  writeFileSync(join(folder, "topology.bin"), topology(sheet.vertices + 4, faces));
  for (let index = 0; index < frames; index++) {
    writeFileSync(frameName(folder, index), frame(cells, index, amplitude));
  }
  writeFileSync(join(folder, "stats.jsonl"), stats(frames));
  writeFileSync(join(folder, "probes.csv"), probes(frames));
  if (ended) {
    const summary = { steps: frames - 1, time: (frames - 1) * DT, converged: true, interrupted: false };
    writeFileSync(join(folder, "summary.json"), JSON.stringify(summary));
  }
  return sheet.faces;
}

export function frameName(folder: string, index: number): string {
  return join(folder, "frames", `${String(index).padStart(5, "0")}.bin`);
}

function part(name: string, kind: string, vertices: [number, number], faces: [number, number]) {
  const range = ([start, end]: [number, number]) => ({ start, end });
  return { name, kind, thickness: 0.001, vertices: range(vertices), faces: range(faces) };
}

function sheetFaces(cells: number): number[] {
  const side = cells + 1;
  const faces: number[] = [];
  for (let j = 0; j < cells; j++) {
    for (let i = 0; i < cells; i++) {
      const a = j * side + i;
      faces.push(a, a + 1, a + side + 1, a, a + side + 1, a + side);
    }
  }
  return faces;
}

/** The height of the sheet: waves that run along x. */
export function height(x: number, y: number, time: number, amplitude: number): number {
  return 0.5 + amplitude * Math.sin(8 * x - 6 * time) * Math.cos(5 * y);
}

function frame(cells: number, index: number, amplitude: number): Buffer {
  const side = cells + 1;
  const [vertices, faces] = [side * side + 4, 2 * cells * cells + 2];
  const fields = ["strain", "mean_curvature"];
  const names = fields.reduce((sum, name) => sum + 4 + name.length, 0);
  const bytes = Buffer.alloc(52 + 24 * vertices + names + fields.length * 4 * faces + 4);
  const time = index * DT;
  bytes.write("KOITERFR", 0, "latin1");
  bytes.writeUInt32LE(1, 8);
  bytes.writeBigUInt64LE(BigInt(index), 12);
  bytes.writeDoubleLE(time, 20);
  bytes.writeBigUInt64LE(BigInt(vertices), 28);
  bytes.writeBigUInt64LE(BigInt(faces), 36);
  bytes.writeUInt32LE(0, 44);
  bytes.writeUInt32LE(fields.length, 48);
  const floor = [-2, -2, 0, 2, -2, 0, 2, 2, 0, -2, 2, 0];
  for (let v = 0; v < side * side; v++) {
    const [x, y] = [(v % side) / cells - 0.5, Math.floor(v / side) / cells - 0.5];
    bytes.writeDoubleLE(x, 52 + 24 * v);
    bytes.writeDoubleLE(y, 60 + 24 * v);
    bytes.writeDoubleLE(height(x, y, time, amplitude), 68 + 24 * v);
  }
  floor.forEach((value, k) => bytes.writeDoubleLE(value, 52 + 24 * side * side + 8 * k));
  let at = 52 + 24 * vertices;
  for (const name of fields) {
    bytes.writeUInt32LE(name.length, at);
    bytes.write(name, at + 4, "latin1");
    at += 4 + name.length;
    for (let f = 0; f < faces - 2; f++) {
      const x = (Math.floor(f / 2) % cells) / cells - 0.5;
      const wave = Math.sin(8 * x - 6 * time);
      bytes.writeFloatLE(name === "strain" ? amplitude * Math.abs(wave) : 60 * amplitude * wave, at + 4 * f);
    }
    at += 4 * faces;
  }
  bytes.writeUInt32LE(crc32(bytes.subarray(0, at)), at);
  return bytes;
}

function topology(vertices: number, faces: number[]): Buffer {
  const bytes = Buffer.alloc(28 + 4 * faces.length + 4);
  bytes.write("KOITERTP", 0, "latin1");
  bytes.writeUInt32LE(1, 8);
  bytes.writeBigUInt64LE(BigInt(vertices), 12);
  bytes.writeBigUInt64LE(BigInt(faces.length / 3), 20);
  faces.forEach((v, k) => bytes.writeUInt32LE(v, 28 + 4 * k));
  const end = bytes.length - 4;
  bytes.writeUInt32LE(crc32(bytes.subarray(0, end)), end);
  return bytes;
}

function stats(frames: number): string {
  const lines = Array.from({ length: Math.max(0, frames - 1) }, (_, k) => {
    const time = (k + 1) * DT;
    return JSON.stringify({
      step: k + 1,
      time,
      dt: DT,
      newton_iterations: 3 + (k % 4),
      contacts: 0,
      min_gap: k > 2 ? 1e-3 / (k + 1) : null,
      converged: true,
      energies: { membrane: 0.1 * Math.sin(time) ** 2, bending: 0.02 * Math.cos(time) ** 2 },
      seconds: { solve: 0.2, assembly: 0.1 },
    });
  });
  return lines.map((line) => `${line}\n`).join("");
}

function probes(frames: number): string {
  const rows = Array.from({ length: frames }, (_, k) => `${k * DT},${Math.sin(k / 10)}\n`);
  return `time,tip.z\n${rows.join("")}`;
}
