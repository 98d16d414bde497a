// A plot over time, with the time that is shown as a line; a click or a drag goes there.

import { CURVES } from "../scene/color-map";
import { logTicks, readable, ticks } from "../scene/ticks";
import { el, themeColor } from "./dom";
import { type Curve, extent } from "./plot-data";

const FRAME = { left: 52, right: 8, top: 8, bottom: 22 };
const ROW = 15;
const FONT = "12px system-ui, sans-serif";
/** How curves of the second, third, … result are dashed. */
const DASHES = [[], [6, 4], [2, 3], [8, 3, 2, 3]];

export class Plot {
  readonly canvas = el("canvas", { className: "plot" });
  private curves: Curve[] = [];
  private isLog = false;
  private time = 0;
  private x: [number, number] = [0, 1];
  private y: [number, number] = [0, 1];

  constructor(seek: (time: number) => void) {
    this.canvas.setAttribute("role", "img");
    const go = (event: PointerEvent) => {
      const width = this.canvas.clientWidth - FRAME.left - FRAME.right;
      const share = (event.offsetX - FRAME.left) / Math.max(1, width);
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
    const x = extent(curves.map((curve) => curve.x), false);
    // Times need no margin.
    this.x = x === null ? [0, 1] : timeRange(curves);
    this.y = extent(curves.map((curve) => curve.y), isLog) ?? [0, 1];
    this.canvas.setAttribute("aria-label", `${title} over time: ${curves.map((c) => c.name).join(", ")}`);
    this.canvas.style.height = `${190 + ROW * curves.length}px`;
    this.draw();
  }

  setTime(time: number): void {
    this.time = time;
    this.draw();
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
    const bottom = height - FRAME.bottom - ROW * this.curves.length;
    const toX = (x: number) =>
      FRAME.left + ((x - this.x[0]) / (this.x[1] - this.x[0] || 1)) * (width - FRAME.left - FRAME.right);
    const scale = this.isLog ? Math.log10 : (value: number) => value;
    const [low, high] = [scale(this.y[0]), scale(this.y[1])];
    const toY = (y: number) => bottom - ((scale(y) - low) / (high - low || 1)) * (bottom - FRAME.top);
    this.drawAxes(context, width, bottom, toX, toY);
    context.save();
    context.beginPath();
    context.rect(FRAME.left, FRAME.top - 2, width - FRAME.left - FRAME.right, bottom - FRAME.top + 4);
    context.clip();
    for (const curve of this.curves) {
      this.drawCurve(context, curve, toX, toY);
    }
    context.restore();
    context.fillStyle = themeColor("accent");
    context.fillRect(toX(this.time) - 0.75, FRAME.top, 1.5, bottom - FRAME.top);
    this.drawNames(context, height - ROW * this.curves.length);
  }

  private drawAxes(
    context: CanvasRenderingContext2D,
    width: number,
    bottom: number,
    toX: (x: number) => number,
    toY: (y: number) => number,
  ): void {
    context.fillStyle = themeColor("faint");
    context.strokeStyle = themeColor("line");
    context.lineWidth = 1;
    context.textAlign = "right";
    const rows = this.isLog ? logTicks(...this.y, 6) : ticks(...this.y, 5);
    for (const tick of rows) {
      const y = Math.round(toY(tick)) + 0.5;
      context.beginPath();
      context.moveTo(FRAME.left, y);
      context.lineTo(width - FRAME.right, y);
      context.stroke();
      context.fillText(readable(tick), FRAME.left - 5, y + 4);
    }
    context.textAlign = "center";
    for (const tick of ticks(...this.x, 5)) {
      context.fillText(readable(tick), toX(tick), bottom + 15);
    }
    context.textAlign = "left";
  }

  private drawCurve(
    context: CanvasRenderingContext2D,
    curve: Curve,
    toX: (x: number) => number,
    toY: (y: number) => number,
  ): void {
    context.strokeStyle = colorOf(curve);
    context.lineWidth = 1.6;
    context.setLineDash(DASHES[curve.result % DASHES.length]);
    context.beginPath();
    let isDown = false;
    for (let k = 0; k < curve.x.length; k++) {
      const [x, y] = [curve.x[k], curve.y[k]];
      const isThere = x !== null && y !== null && y !== undefined && (!this.isLog || y > 0);
      if (isThere && isDown) {
        context.lineTo(toX(x), toY(y));
      } else if (isThere) {
        context.moveTo(toX(x), toY(y));
      }
      isDown = isThere;
    }
    context.stroke();
    context.setLineDash([]);
  }

  private drawNames(context: CanvasRenderingContext2D, top: number): void {
    this.curves.forEach((curve, k) => {
      const y = top + ROW * k;
      context.strokeStyle = colorOf(curve);
      context.lineWidth = 2;
      context.setLineDash(DASHES[curve.result % DASHES.length]);
      context.beginPath();
      context.moveTo(FRAME.left, y + 5);
      context.lineTo(FRAME.left + 22, y + 5);
      context.stroke();
      context.setLineDash([]);
      context.fillStyle = themeColor("text");
      const value = valueAt(curve, this.time);
      const told = value === null ? "" : `: ${readable(value)}`;
      context.fillText(curve.name + told, FRAME.left + 28, y + 9);
    });
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
  return high > low ? [low, high] : [low, low + 1];
}

/** The value of the last row not later than `time`. */
export function valueAt(curve: Curve, time: number): number | null {
  let found: number | null = null;
  for (let k = 0; k < curve.x.length; k++) {
    const x = curve.x[k];
    if (x !== null && x > time + 1e-12) {
      break;
    }
    found = curve.y[k] ?? null;
  }
  return found;
}
