// A result inside the page: what `koiter export --to html` writes.
//
// Positions and values are whole numbers of 16 bits over their range, minus those of the frame before, the low bytes of a frame
// first and then the high ones, so many frames a chunk; each chunk is compressed (zlib) and written as base64. The first frame
// of a chunk stands for itself.

import type { Columns, Element, FrameData, Info, Range, RunState, Source } from "./source";

export interface EmbeddedData {
  info: Info;
  times: number[];
  /** Frames a chunk. */
  frames_a_chunk: number;
  /** Zlib in base64: u32 × 3 a face. */
  topology: string;
  /** Of each part, along x, y and z. */
  positions: Scale[][];
  fields: Scale[];
  /** Of the colours of each field. */
  ranges: Range[];
  chunks: string[];
  stats: Columns;
  probes: Columns;
  summary: Record<string, unknown> | null;
  scene: string;
}

/** A number `n` stands for `low + n step`. */
export interface Scale {
  low: number;
  step: number;
}

/** Of 16 bits: stands for no value. */
const NO_VALUE = 0xffff;
/** Chunks kept in memory. */
const KEPT = 4;

/** The result in this page, if it has one. */
export function embeddedSource(): Source | null {
  const element = document.getElementById("koiter-data");
  return element === null ? null : new EmbeddedSource(JSON.parse(element.textContent ?? "") as EmbeddedData);
}

export class EmbeddedSource implements Source {
  readonly info: Info;
  private readonly chunks = new Map<number, Promise<Uint16Array[]>>();

  constructor(private readonly data: EmbeddedData) {
    this.info = data.info;
  }

  async state(): Promise<RunState> {
    const { times, summary } = this.data;
    return { generation: 0, times, ended: true, running: false, summary };
  }

  async topology(): Promise<Uint32Array> {
    return new Uint32Array((await inflate(this.data.topology)).buffer);
  }

  async frame(index: number, field: number | null): Promise<FrameData> {
    const numbers = await this.numbers(index);
    const positions = new Float32Array(3 * this.info.vertices);
    this.info.parts.forEach(({ vertices }, part) => {
      for (let k = 3 * vertices.start; k < 3 * vertices.end; k++) {
        const { low, step } = this.data.positions[part][k % 3];
        positions[k] = low + step * numbers[k];
      }
    });
    return { positions, values: field === null ? null : this.values(numbers, field) };
  }

  async range(field: number): Promise<Range> {
    return this.data.ranges[field];
  }

  async history(element: Element): Promise<Columns> {
    const { info, data } = this;
    const columns: Columns = { time: [...data.times] };
    const isVertex = "vertex" in element;
    const part = info.parts.findIndex(({ vertices }) => isVertex && element.vertex < vertices.end);
    for (let index = 0; index < data.times.length; index++) {
      const numbers = await this.numbers(index);
      if (isVertex) {
        ["x", "y", "z"].forEach((name, axis) => {
          const { low, step } = data.positions[part][axis];
          (columns[name] ??= []).push(low + step * numbers[3 * element.vertex + axis]);
        });
      }
      info.fields.forEach((field, k) => {
        if ((field.of === "vertices") === isVertex) {
          const at = isVertex ? element.vertex : element.face;
          const value = this.values(numbers, k)[at];
          (columns[field.name] ??= []).push(Number.isNaN(value) ? null : value);
        }
      });
    }
    return columns;
  }

  async stats(): Promise<Columns> {
    return this.data.stats;
  }

  async probes(): Promise<Columns> {
    return this.data.probes;
  }

  async scene(): Promise<string> {
    return this.data.scene;
  }

  private values(numbers: Uint16Array, field: number): Float32Array {
    const lengths = this.info.fields.map((f) => (f.of === "vertices" ? this.info.vertices : this.info.faces));
    const start = 3 * this.info.vertices + lengths.slice(0, field).reduce((sum, length) => sum + length, 0);
    const { low, step } = this.data.fields[field];
    const values = new Float32Array(lengths[field]);
    for (let k = 0; k < values.length; k++) {
      const number = numbers[start + k];
      values[k] = number === NO_VALUE ? NaN : low + step * number;
    }
    return values;
  }

  private async numbers(index: number): Promise<Uint16Array> {
    const chunk = Math.floor(index / this.data.frames_a_chunk);
    let frames = this.chunks.get(chunk);
    if (frames === undefined) {
      frames = this.unpack(chunk);
    }
    // Last in the order of the map is used last.
    this.chunks.delete(chunk);
    this.chunks.set(chunk, frames);
    for (const oldest of this.chunks.keys()) {
      if (this.chunks.size <= KEPT) {
        break;
      }
      this.chunks.delete(oldest);
    }
    return (await frames)[index % this.data.frames_a_chunk];
  }

  private async unpack(chunk: number): Promise<Uint16Array[]> {
    const bytes = await inflate(this.data.chunks[chunk]);
    const first = chunk * this.data.frames_a_chunk;
    const count = Math.min(this.data.frames_a_chunk, this.data.times.length - first);
    return undoDifferences(bytes, count);
  }
}

/** The numbers of `count` frames from the bytes of a chunk. */
export function undoDifferences(bytes: Uint8Array, count: number): Uint16Array[] {
  const length = bytes.length / (2 * count);
  const frames: Uint16Array[] = [];
  for (let frame = 0; frame < count; frame++) {
    const numbers = new Uint16Array(length);
    const before = frames[frame - 1];
    const low = 2 * frame * length;
    const high = low + length;
    for (let k = 0; k < length; k++) {
      // Differences wrap round as the numbers do.
      numbers[k] = (before === undefined ? 0 : before[k]) + (bytes[low + k] | (bytes[high + k] << 8));
    }
    frames.push(numbers);
  }
  return frames;
}

/** The bytes of zlib in base64. */
async function inflate(text: string): Promise<Uint8Array> {
  const packed = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}
