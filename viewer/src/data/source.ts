// Where results come from: a server on this machine, or the file that the page is.

export type Axis = "x" | "y" | "z";

export interface Part {
  name: string;
  kind: "shell" | "obstacle";
  thickness: number;
  vertices: { start: number; end: number };
  faces: { start: number; end: number };
}

export interface FieldInfo {
  name: string;
  unit: string;
  map: string;
  of: "vertices" | "faces";
}

export interface Info {
  path: string;
  kind: "run" | "mesh";
  title: string;
  version: string;
  up_axis: Axis;
  parts: Part[];
  vertices: number;
  faces: number;
  fields: FieldInfo[];
}

export interface RunState {
  /** Raised when another run has replaced the result. */
  generation: number;
  /** Of the frames [s]; null where a frame cannot be read. */
  times: (number | null)[];
  ended: boolean;
  /** Whether a run writes to it now; null where that cannot be told. */
  running: boolean | null;
  request?: "pause" | "stop" | null;
  /** Whether a hand may pull at the run. */
  playable?: boolean;
  summary?: Record<string, unknown> | null;
}

export interface FrameData {
  /** Three numbers a vertex [m]. */
  positions: Float32Array;
  /** A number a vertex or face, NaN where there is none; null if no field was asked for. */
  values: Float32Array | null;
}

export interface Range {
  low: number;
  high: number;
}

/** Figures, a list a column; null where there is none. */
export type Columns = Record<string, (number | null)[]>;

export type Element = { vertex: number } | { face: number };

/** A vertex, and where it is to go [m]. */
export interface Hand {
  vertex: number;
  target: [number, number, number];
}

export type Request = "pause" | "continue" | "stop";

export interface Source {
  readonly info: Info;
  state(): Promise<RunState>;
  topology(): Promise<Uint32Array>;
  /** Frame `index`, with the values of field number `field`. */
  frame(index: number, field: number | null): Promise<FrameData>;
  range(field: number): Promise<Range>;
  history(element: Element): Promise<Columns>;
  stats(): Promise<Columns>;
  probes(): Promise<Columns>;
  scene(): Promise<string>;
  /** Asks the run; absent where no run can be asked. */
  request?(word: Request): Promise<void>;
  /** Pulls a vertex to a place [m], or lets go. */
  pull?(hand: Hand | null): Promise<void>;
}
