// One result in the page: its frames, its figures, how it is drawn.

import type { Plane } from "three";
import { FrameCache } from "./data/frame-cache";
import type { Columns, FrameData, Range, RunState, Source } from "./data/source";
import { frameAt, steadyTimes } from "./data/timeline";
import { coveringRange, distances } from "./scene/mesh-math";
import type { ValueColors } from "./scene/shading";
import { Stage } from "./scene/stage";

/** What colours mean: `parts`, `field:NAME`, `displacement`, `height`, or `distance` to another result. */
export type Coloring = string;

export interface Values {
  values: Float32Array | null;
  of: "vertices" | "faces";
}

const AXES = { x: 0, y: 1, z: 2 } as const;
const NONE: Values = { values: null, of: "vertices" };

export class Result {
  readonly cache: FrameCache;
  times: number[] = [];
  state: RunState;
  stats: Columns = {};
  probes: Columns = {};
  private first: Float32Array | null = null;

  private constructor(
    readonly source: Source,
    readonly stage: Stage,
    state: RunState,
    cacheBytes: number,
  ) {
    this.state = state;
    this.times = steadyTimes(state.times);
    this.cache = new FrameCache((index, field) => source.frame(index, field), cacheBytes);
  }

  static async open(source: Source, colors: ValueColors, planes: Plane[], cacheBytes: number): Promise<Result> {
    const [state, faces] = await Promise.all([source.state(), source.topology()]);
    return new Result(source, new Stage(source.info, faces, colors, planes), state, cacheBytes);
  }

  get name(): string {
    const { title, path } = this.source.info;
    return title || path;
  }

  get isLive(): boolean {
    return this.state.running === true || (this.state.running === null && !this.state.ended);
  }

  frameAt(time: number): number {
    return frameAt(this.times, time);
  }

  /** Asks how far the run is; whether there is anything new. Another run in its place means the page must begin anew. */
  async poll(): Promise<{ grew: boolean; replaced: boolean }> {
    const before = this.state;
    const state = await this.source.state();
    this.state = state;
    if (state.generation !== before.generation) {
      return { grew: true, replaced: true };
    }
    const grew = state.times.length !== before.times.length;
    if (grew) {
      this.times = steadyTimes(state.times);
    }
    return { grew, replaced: false };
  }

  async readFigures(): Promise<void> {
    [this.stats, this.probes] = await Promise.all([this.source.stats(), this.source.probes()]);
  }

  /** Number of the field that a colouring needs of each frame. */
  fieldOf(coloring: Coloring): number | null {
    const name = coloring.startsWith("field:") ? coloring.slice("field:".length) : null;
    const index = this.source.info.fields.findIndex((field) => field.name === name);
    return index < 0 ? null : index;
  }

  frame(index: number, coloring: Coloring): Promise<FrameData> {
    return this.cache.get(index, this.fieldOf(coloring));
  }

  /** Values of a frame under a colouring; `reference` is the frame that distances are taken from. */
  async values(frame: FrameData, coloring: Coloring, reference: FrameData | null): Promise<Values> {
    const field = this.fieldOf(coloring);
    if (field !== null) {
      return { values: frame.values, of: this.source.info.fields[field].of };
    }
    switch (coloring) {
      case "displacement":
        this.first ??= (await this.cache.get(0, null)).positions;
        return { values: distances(frame.positions, this.first), of: "vertices" };
      case "height": {
        const axis = AXES[this.source.info.up_axis];
        return { values: frame.positions.filter((_, k) => k % 3 === axis), of: "vertices" };
      }
      case "distance":
        if (reference === null || reference.positions.length !== frame.positions.length) {
          return NONE;
        }
        return { values: distances(frame.positions, reference.positions), of: "vertices" };
      default:
        return NONE;
    }
  }

  /** The range of colours over the run. */
  async range(coloring: Coloring, reference: Result | null): Promise<Range | null> {
    const field = this.fieldOf(coloring);
    if (field !== null) {
      return this.source.range(field);
    }
    if (coloring === "parts" || this.times.length === 0) {
      return null;
    }
    const last = this.times.length - 1;
    const frame = await this.cache.get(last, null);
    const other = reference && (await reference.cache.get(reference.frameAt(this.times[last]), null));
    const { values } = await this.values(frame, coloring, other);
    return values === null ? null : coveringRange(this.ofShells(values));
  }

  /** Values at the vertices of shells: obstacles may be far away. */
  private ofShells(values: Float32Array): Float32Array {
    const kept = this.source.info.parts
      .filter((part) => part.kind === "shell")
      .flatMap((part) => [...values.subarray(part.vertices.start, part.vertices.end)]);
    return Float32Array.from(kept);
  }
}
