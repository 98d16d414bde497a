// Frames in memory: those used last, up to so many bytes; each is fetched once however often it is asked for.

import type { FrameData } from "./source";

export type Fetch = (index: number, field: number | null) => Promise<FrameData>;

export class FrameCache {
  private readonly frames = new Map<string, FrameData>();
  private readonly coming = new Map<string, Promise<FrameData>>();
  private bytes = 0;
  /** Raised by `clear`: what was asked for before is not kept. */
  private generation = 0;

  constructor(
    private readonly fetch: Fetch,
    private readonly maxBytes: number,
  ) {}

  /** The frame, if it is here. */
  peek(index: number, field: number | null): FrameData | undefined {
    const key = keyOf(index, field);
    const frame = this.frames.get(key);
    if (frame !== undefined) {
      // Last in the order of the map is used last.
      this.frames.delete(key);
      this.frames.set(key, frame);
    }
    return frame;
  }

  async get(index: number, field: number | null): Promise<FrameData> {
    const here = this.peek(index, field);
    if (here !== undefined) {
      return here;
    }
    const key = keyOf(index, field);
    let coming = this.coming.get(key);
    if (coming === undefined) {
      coming = this.load(key, index, field);
      this.coming.set(key, coming);
    }
    return coming;
  }

  /** How many frames are on their way. */
  get pending(): number {
    return this.coming.size;
  }

  get size(): number {
    return this.bytes;
  }

  clear(): void {
    this.generation += 1;
    this.frames.clear();
    this.coming.clear();
    this.bytes = 0;
  }

  private async load(key: string, index: number, field: number | null): Promise<FrameData> {
    const generation = this.generation;
    try {
      const frame = await this.fetch(index, field);
      if (generation === this.generation) {
        this.keep(key, frame);
      }
      return frame;
    } finally {
      if (generation === this.generation) {
        this.coming.delete(key);
      }
    }
  }

  private keep(key: string, frame: FrameData): void {
    this.frames.set(key, frame);
    this.bytes += bytesOf(frame);
    for (const [oldest, dropped] of this.frames) {
      // The newest stays even if it alone is too large.
      if (this.bytes <= this.maxBytes || oldest === key) {
        break;
      }
      this.frames.delete(oldest);
      this.bytes -= bytesOf(dropped);
    }
  }
}

function keyOf(index: number, field: number | null): string {
  return `${index}:${field ?? ""}`;
}

function bytesOf(frame: FrameData): number {
  return frame.positions.byteLength + (frame.values?.byteLength ?? 0);
}
