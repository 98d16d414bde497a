// The page: what is shown, and what changes it.

import type { Plane } from "three";
import type { Range, Source } from "./data/source";
import { decimals } from "./data/timeline";
import { Hand } from "./hand";
import { Player } from "./player";
import { Result } from "./result";
import { isMap, type MapName } from "./scene/color-map";
import { include } from "./scene/mesh-math";
import type { Shading } from "./scene/part-view";
import { ValueColors } from "./scene/shading";
import { Viewport } from "./scene/viewport";
import type { Preset } from "./scene/views";
import { el, themeColor } from "./ui/dom";
import { type Legend, writeOver } from "./ui/overlay";
import { PickPanel } from "./ui/pick-panel";
import { PlotsPanel } from "./ui/plots-panel";
import { TimelineBar } from "./ui/timeline-bar";

/** Bytes of frames kept for all results together. */
const CACHE_BYTES = 160 << 20;
/** Frames that are fetched ahead while it plays. */
const AHEAD = 6;
/** How often a run in progress is asked for new frames, and one that is played with [ms]. */
const POLL = 1000;
const POLL_PLAYED = 40;
/** Clicks move the pointer less than this [CSS pixels]. */
const STILL = 5;

export class App {
  readonly canvas = el("canvas", { tabIndex: 0 });
  readonly overlay = el("canvas", { className: "overlay" });
  readonly viewport = new Viewport(this.canvas);
  readonly player = new Player(() => this.timeChanged());
  readonly bar = new TimelineBar(this.player);
  readonly plots = new PlotsPanel(() => this.results, (time) => this.player.seek(time));
  readonly picks = new PickPanel((time) => this.player.seek(time));
  readonly message = el("div", { className: "message" });
  readonly hand = new Hand(this.canvas, this.viewport, () => this.visible, (error) => this.tell(error));
  readonly colors = new ValueColors();
  results: Result[] = [];
  /** Which results are seen: all, or one by its number. */
  shown: "all" | number = "all";
  coloring = "parts";
  map: MapName = "viridis";
  range: Range = { low: 0, high: 1 };
  reference = 0;
  preset: Preset = "iso";
  /** Called when what can be chosen has changed. */
  onChange: () => void = () => {};
  /** When figures were read last [ms], and whether there are newer ones. */
  private figuresAt = 0;
  private areFiguresOld = false;
  private isShowing = false;
  private isAsked = false;
  /** Says when what was asked for is drawn. */
  private whenShown: Promise<void> = Promise.resolve();

  static async open(sources: Source[]): Promise<App> {
    const app = new App();
    await app.read(sources);
    return app;
  }

  private constructor() {
    this.canvas.setAttribute("aria-label", "The shapes, from the side that you choose");
    this.message.setAttribute("role", "alert");
    this.viewport.onDrawn = () => this.drawOverlay();
    const tick = (now: number) => {
      this.player.tick(now);
      requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
    this.listenToClicks();
  }

  get planes(): Plane[] {
    return this.viewport.planes;
  }

  get visible(): Result[] {
    return this.shown === "all" ? this.results : this.results.slice(this.shown, this.shown + 1);
  }

  private async read(sources: Source[]): Promise<void> {
    const bytes = CACHE_BYTES / Math.max(1, sources.length);
    const open = sources.map((source) => Result.open(source, this.colors, this.planes, bytes));
    this.results = await Promise.all(open);
    this.setTheme();
    this.viewport.setStages(this.visible.map((result) => result.stage));
    this.timesChanged();
    if (this.isPlayed) {
      this.player.seek(this.player.end);
    }
    await this.fit("iso");
    this.setShadows(true);
    await this.show();
    void this.readFigures();
    void this.pollForEver();
  }

  /** Whether a hand may pull at one of the runs. */
  private get isPlayed(): boolean {
    return this.results.some((result) => result.state.playable === true);
  }

  private async pollForEver(): Promise<void> {
    for (;;) {
      await new Promise((resolve) => setTimeout(resolve, this.isPlayed ? POLL_PLAYED : POLL));
      await this.poll();
    }
  }

  /** Draws the present time, as soon as its frames are here; asked again meanwhile, it then draws the newest time. */
  show(): Promise<void> {
    this.isAsked = true;
    if (!this.isShowing) {
      this.whenShown = this.showUntilDone();
    }
    return this.whenShown;
  }

  private async showUntilDone(): Promise<void> {
    this.isShowing = true;
    try {
      while (this.isAsked) {
        this.isAsked = false;
        await this.showNow();
      }
    } catch (error) {
      this.tell(error);
    } finally {
      this.isShowing = false;
    }
  }

  private async showNow(): Promise<void> {
    const { time } = this.player;
    const visible = this.visible.filter((result) => result.times.length > 0);
    const frames = await Promise.all(visible.map((r) => r.frame(r.frameAt(time), this.coloring)));
    const reference = this.results[this.reference];
    const needsReference = this.coloring === "distance" && reference.times.length > 0;
    const from = needsReference ? await reference.cache.get(reference.frameAt(time), null) : null;
    for (const [k, result] of visible.entries()) {
      const isReference = needsReference && result === reference;
      const coloring = isReference ? "parts" : this.coloring;
      const { values, of } = await result.values(frames[k], coloring, from);
      result.stage.show(frames[k], values, of);
    }
    this.viewport.redraw();
    this.message.textContent = this.whatIsMissing();
    if (this.player.isPlaying) {
      this.fetchAhead();
    }
  }

  private fetchAhead(): void {
    for (const result of this.visible) {
      const index = result.frameAt(this.player.time);
      for (let next = index + 1; next <= index + AHEAD && next < result.times.length; next++) {
        if (result.cache.pending >= AHEAD) {
          return;
        }
        // What cannot be read is told when it is shown.
        result.frame(next, this.coloring).catch(() => {});
      }
    }
  }

  private timeChanged(): void {
    this.viewport.isPlaying = this.player.isPlaying;
    this.bar.update();
    this.plots.setTime(this.player.time);
    this.picks.setTime(this.player.time);
    void this.show();
  }

  /** The timeline has the times of all results. */
  private timesChanged(): void {
    const all = [...new Set(this.visible.flatMap((result) => result.times))].sort((a, b) => a - b);
    this.player.setTimes(all);
    this.bar.setTimes(all);
  }

  /** Looks from a side at the first and the last frame together. */
  async fit(preset: Preset): Promise<void> {
    this.preset = preset;
    const first = this.visible[0];
    if (first === undefined) {
      return;
    }
    const boxes = await Promise.all(this.visible.map((result) => this.bounds(result)));
    const box = boxes[0];
    for (const other of boxes.slice(1)) {
      include(box, Float32Array.from([...other.min, ...other.max]), 0, 2);
    }
    this.viewport.look(preset, first.source.info.up_axis, box);
  }

  private async bounds(result: Result) {
    const count = result.times.length;
    const wanted = count === 0 ? [] : [...new Set([0, count - 1])];
    const frames = await Promise.all(
      // A damaged frame is told of when it is shown.
      wanted.map((index) => result.frame(index, "parts").catch(() => null)),
    );
    const known = frames.filter((frame) => frame !== null);
    if (known.length === 0) {
      return { min: [-1, -1, -1], max: [1, 1, 1] } as ReturnType<typeof result.stage.bounds>;
    }
    const box = result.stage.bounds(known[0]);
    for (const frame of known.slice(1)) {
      const other = result.stage.bounds(frame);
      include(box, Float32Array.from([...other.min, ...other.max]), 0, 2);
    }
    return box;
  }

  async setColoring(coloring: string): Promise<void> {
    try {
      const range = await this.rangeOf(coloring);
      const fields = this.results.flatMap((result) => result.source.info.fields);
      const field = fields.find((candidate) => `field:${candidate.name}` === coloring);
      this.coloring = coloring;
      this.map = field !== undefined && isMap(field.map) ? field.map : "viridis";
      this.setRange(range.low, range.high);
    } catch (error) {
      this.tell(error);
    }
    this.onChange();
    await this.show();
  }

  /** Takes the range of colours from the whole of the runs. */
  async fitRange(): Promise<void> {
    const range = await this.rangeOf(this.coloring);
    this.setRange(range.low, range.high);
    this.onChange();
  }

  private async rangeOf(coloring: string): Promise<Range> {
    const reference = this.results[this.reference];
    const asked = this.visible.filter((result) => coloring !== "distance" || result !== reference);
    const ranges = await Promise.all(asked.map((result) => result.range(coloring, reference)));
    const known = ranges.filter((range) => range !== null);
    return known.length === 0
      ? { low: 0, high: 1 }
      : { low: Math.min(...known.map((r) => r.low)), high: Math.max(...known.map((r) => r.high)) };
  }

  setRange(low: number, high: number): void {
    this.range = { low, high };
    this.colors.set(this.map, low, high);
    this.viewport.redraw();
  }

  setMap(map: MapName): void {
    this.map = map;
    this.setRange(this.range.low, this.range.high);
  }

  setShown(shown: "all" | number): void {
    this.shown = shown;
    this.viewport.setStages(this.visible.map((result) => result.stage));
    this.timesChanged();
    void this.fit(this.preset).then(() => this.show());
  }

  setShading(shading: Shading): void {
    this.forStages((stage) => stage.setShading(shading));
    void this.show();
  }

  setWireframe(isShown: boolean): void {
    const color = themeColor("wire");
    this.forStages((stage) => stage.parts.forEach((part) => part.setWireframe(isShown, color)));
  }

  setShadows(isShown: boolean): void {
    this.forStages((stage) => stage.setShadows(isShown));
  }

  setTheme(): void {
    const [back, obstacles] = [themeColor("back"), themeColor("obstacle")];
    this.forStages((stage) => stage.setBackground(back, obstacles));
    this.plots.redraw();
    this.picks.redraw();
  }

  private forStages(act: (stage: Result["stage"]) => void): void {
    this.results.forEach((result) => act(result.stage));
    this.viewport.redraw();
  }

  /** Shows what went wrong. */
  tell(error: unknown): void {
    this.message.textContent = error instanceof Error ? error.message : String(error);
  }

  /** In words; empty where there are frames to show. */
  private whatIsMissing(): string {
    const empty = this.visible.find((result) => result.times.length === 0);
    if (empty === undefined) {
      return "";
    }
    const why = empty.isLive ? "its run has only begun" : "it has no frames, and no run is writing to it";
    return `${empty.source.info.path}: there is nothing to show yet: ${why}`;
  }

  private async readFigures(): Promise<void> {
    try {
      await Promise.all(this.results.map((result) => result.readFigures()));
    } catch (error) {
      this.tell(error);
    }
    this.plots.update();
    this.plots.setTime(this.player.time);
    this.onChange();
  }

  /** Follows runs that go on. */
  private async poll(): Promise<void> {
    const live = this.results.filter((result) => result.isLive || !result.state.ended);
    if (live.length === 0) {
      return;
    }
    try {
      const wasEmpty = this.player.end === this.player.start;
      const wasAtEnd = this.player.time >= this.player.end;
      const news = await Promise.all(live.map((result) => result.poll()));
      if (news.some(({ replaced }) => replaced)) {
        location.reload();
        return;
      }
      if (news.some(({ grew }) => grew)) {
        this.areFiguresOld = true;
        this.timesChanged();
        if (wasAtEnd && !this.player.isPlaying) {
          this.player.seek(this.player.end);
        }
        if (wasEmpty) {
          await this.fit(this.preset);
        }
      }
      // Figures and buttons need not keep up with a hand.
      const now = performance.now();
      if (now - this.figuresAt < POLL) {
        return;
      }
      this.figuresAt = now;
      if (this.areFiguresOld) {
        this.areFiguresOld = false;
        await this.readFigures();
      }
      this.onChange();
    } catch (error) {
      this.tell(error);
    }
  }

  private listenToClicks(): void {
    let down: PointerEvent | null = null;
    this.canvas.addEventListener("pointerdown", (event) => {
      down = event.isPrimary && event.button === 0 ? event : null;
    });
    this.canvas.addEventListener("pointerup", (event) => {
      if (down !== null && Math.hypot(event.clientX - down.clientX, event.clientY - down.clientY) < STILL) {
        void this.pickAt(event.clientX, event.clientY);
      }
      down = null;
    });
  }

  /** Picks what lies under a point of the page. */
  async pickAt(x: number, y: number): Promise<void> {
    const found = this.viewport.pick(x, y);
    this.results.forEach((result) => result.stage.mark(null, 0));
    this.viewport.redraw();
    if (found === null) {
      this.picks.clear();
      return;
    }
    const result = this.visible[found.stage];
    result.stage.mark(found.hit.vertex, 0.012 * this.viewport.radius);
    const { current } = result.stage;
    if (current !== null) {
      try {
        await this.picks.show({ result, hit: found.hit }, current);
        this.picks.setTime(this.player.time);
      } catch (error) {
        this.tell(error);
      }
    }
  }

  get legend(): Legend | null {
    if (this.coloring === "parts") {
      return null;
    }
    const fields = this.results.flatMap((result) => result.source.info.fields);
    const field = fields.find((candidate) => `field:${candidate.name}` === this.coloring);
    const name = field?.name.replaceAll("_", " ") ?? this.coloring;
    return { name, unit: field === undefined ? "m" : field.unit, map: this.map, ...this.range };
  }

  private drawOverlay(): void {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const ratio = Math.min(2, window.devicePixelRatio);
    const [w, h] = [Math.round(width * ratio), Math.round(height * ratio)];
    if (this.overlay.width !== w || this.overlay.height !== h) {
      Object.assign(this.overlay, { width: w, height: h });
    }
    const context = this.overlay.getContext("2d");
    if (context === null) {
      return;
    }
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, width, height);
    const times = this.visible[0]?.times ?? [];
    const titles = this.visible.map((result) =>
      this.results.length > 1 ? (result.source.info.path.split("/").pop() ?? result.name) : result.name,
    );
    const caption = times.length > 1 ? `t = ${this.player.time.toFixed(decimals(times))} s` : "";
    writeOver(context, width, height, { titles, caption, legend: this.legend });
  }

  /** The picture with what is written over it, drawn with all pixels. */
  compose(target: HTMLCanvasElement): void {
    this.viewport.drawFully();
    if (target.width !== this.canvas.width || target.height !== this.canvas.height) {
      Object.assign(target, { width: this.canvas.width, height: this.canvas.height });
    }
    const context = target.getContext("2d");
    context?.drawImage(this.canvas, 0, 0);
    context?.drawImage(this.overlay, 0, 0, target.width, target.height);
  }
}
