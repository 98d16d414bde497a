// A plot over time, with the time that is shown as a line; a click or a drag goes there.
//
// Curves are drawn when they change. The line and the values beside the names move with the time, without drawing anew: while it
// plays, all time belongs to the picture.

import { CURVES } from "../scene/color-map";
import { logTicks, readable, ticks } from "../scene/ticks";
import { frameAt } from "../data/timeline";
import { el, themeColor } from "./dom";
import { type Curve, extent } from "./plot-data";

const FRAME = { left: 52, right: 8, top: 8, bottom: 22 };
const FONT = "12px system-ui, sans-serif";
/** How curves of the second, third, … result are dashed, on the canvas and beside the names. */
const DASHES = [[], [6, 4], [2, 3], [8, 3, 2, 3]];
const STYLES = ["solid", "dashed", "dotted", "double"];
/** Values beside the names change no more often than this [ms]. */
const READABLE = 150;

export class Plot {
  readonly element: HTMLDivElement;
  private readonly canvas = el("canvas", { className: "plot" });
  private readonly cursor = el("div", { className: "cursor" });
  private readonly names = el("div", { className: "names" });
  private values: HTMLElement[] = [];
  private curves: Curve[] = [];
  private isLog = false;
  private time = 0;
  private toldAt = 0;
  private x: [number, number] = [0, 1];
  private y: [number, number] = [0, 1];

  constructor(seek: (time: number) => void) {
    this.canvas.setAttribute("role", "img");
    this.element = el("div", { className: "plot-box" }, this.canvas, this.cursor, this.names);
    const go = (event: PointerEvent) => {
      const share = (event.offsetX - FRAME.left) / Math.max(1, this.width);
      seek(this.x[0] + Math.min(1, Math.max(0, share)) * (this.x[1] - this.x[0]));
    };
    this.canvas.addEventListener("pointerdown", (event) => {
      this.canvas.setPointerCapture(event.pointerId);
      go(event);
    });
    this.canvas.addEventListener("pointermove", (event) => {
      if (event.buttons > 0) {
        go(event);
      }
    });
    new ResizeObserver(() => this.draw()).observe(this.canvas);
  }

  show(title: string, curves: Curve[], isLog: boolean): void {
    this.curves = curves;
    this.isLog = isLog;
    // Times need no margin.
    this.x = timeRange(curves);
    this.y = extent(curves.map((curve) => curve.y), isLog) ?? [0, 1];
    this.canvas.setAttribute("aria-label", `${title} over time: ${curves.map((c) => c.name).join(", ")}`);
    this.values = curves.map(() => el("span"));
    const rows = curves.map((curve, k) => {
      const line = el("span", { className: "line" });
      line.style.borderTop = `2px ${STYLES[curve.result % STYLES.length]} ${colorOf(curve)}`;
      return el("div", {}, line, curve.name, this.values[k]);
    });
    this.names.replaceChildren(...rows);
    this.draw();
    this.tellValues();
  }

  setTime(time: number): void {
    this.time = time;
    this.cursor.style.transform = `translateX(${this.toX(time) - 0.75}px)`;
    if (performance.now() - this.toldAt > READABLE) {
      this.tellValues();
    } else {
      // The last of many times is told too.
      setTimeout(() => performance.now() - this.toldAt > READABLE && this.tellValues(), READABLE + 10);
    }
  }

  draw(): void {
    const width = this.canvas.clientWidth;
    const height = this.canvas.clientHeight;
    const context = this.canvas.getContext("2d");
    if (context === null || width === 0) {
      return;
    }
    const ratio = window.devicePixelRatio;
    this.canvas.width = Math.round(width * ratio);
    this.canvas.height = Math.round(height * ratio);
    context.scale(ratio, ratio);
    context.font = FONT;
    const bottom = height - FRAME.bottom;
    const scale = this.isLog ? Math.log10 : (value: number) => value;
    const [low, high] = [scale(this.y[0]), scale(this.y[1])];
    const toY = (y: number) => bottom - ((scale(y) - low) / (high - low || 1)) * (bottom - FRAME.top);
    this.drawAxes(context, width, bottom, toY);
    context.save();
    context.beginPath();
    context.rect(FRAME.left, FRAME.top - 2, this.width, bottom - FRAME.top + 4);
    context.clip();
    for (const curve of this.curves) {
      this.drawCurve(context, curve, toY);
    }
    context.restore();
    this.setTime(this.time);
  }

  private get width(): number {
    return this.canvas.clientWidth - FRAME.left - FRAME.right;
  }

  private toX(x: number): number {
    return FRAME.left + ((x - this.x[0]) / (this.x[1] - this.x[0] || 1)) * this.width;
  }

  private tellValues(): void {
    this.toldAt = performance.now();
    this.curves.forEach((curve, k) => {
      const value = valueAt(curve, this.time);
      this.values[k].textContent = value === null ? "" : `: ${readable(value)}`;
    });
  }

  private drawAxes(
    context: CanvasRenderingContext2D,
    width: number,
    bottom: number,
    toY: (y: number) => number,
  ): void {
    context.fillStyle = themeColor("faint");
    context.strokeStyle = themeColor("line");
    context.lineWidth = 1;
    context.textAlign = "right";
    for (const tick of this.isLog ? logTicks(...this.y, 6) : ticks(...this.y, 5)) {
      const y = Math.round(toY(tick)) + 0.5;
      context.beginPath();
      context.moveTo(FRAME.left, y);
      context.lineTo(width - FRAME.right, y);
      context.stroke();
      context.fillText(readable(tick), FRAME.left - 5, y + 4);
    }
    context.textAlign = "center";
    for (const tick of ticks(...this.x, 5)) {
      context.fillText(readable(tick), this.toX(tick), bottom + 15);
    }
  }

  private drawCurve(context: CanvasRenderingContext2D, curve: Curve, toY: (y: number) => number): void {
    context.strokeStyle = colorOf(curve);
    context.lineWidth = 1.6;
    context.setLineDash(DASHES[curve.result % DASHES.length]);
    context.beginPath();
    let isDown = false;
    for (let k = 0; k < curve.x.length; k++) {
      const [x, y] = [curve.x[k], curve.y[k]];
      const isThere = x !== null && y !== null && y !== undefined && (!this.isLog || y > 0);
      if (isThere && isDown) {
        context.lineTo(this.toX(x), toY(y));
      } else if (isThere) {
        context.moveTo(this.toX(x), toY(y));
      }
      isDown = isThere;
    }
    context.stroke();
    context.setLineDash([]);
  }
}

function colorOf(curve: Curve): string {
  return CURVES[curve.color % CURVES.length];
}

function timeRange(curves: Curve[]): [number, number] {
  let [low, high] = [Infinity, -Infinity];
  for (const { x } of curves) {
    for (const time of x) {
      if (time !== null) {
        low = Math.min(low, time);
        high = Math.max(high, time);
      }
    }
  }
  if (low > high) {
    return [0, 1];
  }
  return high > low ? [low, high] : [low, low + 1];
}

/** The value of the last row not later than `time`. */
export function valueAt(curve: Curve, time: number): number | null {
  const first = curve.x[0];
  if (first === null || first === undefined || first > time + 1e-12) {
    return null;
  }
  return curve.y[frameAt(curve.x as number[], time + 1e-12)] ?? null;
}
