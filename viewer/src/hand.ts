// The hand: a drag of the pointer pulls at the shell of a run that is played with.

import type { Result } from "./result";
import type { Vector } from "./scene/pick";
import type { Viewport } from "./scene/viewport";

/** What the hand holds. */
interface Hold {
  result: Result;
  vertex: number;
  /** Where it was taken hold of [m]: it is moved in the plane through this point that faces the viewer. */
  start: Vector;
  pointer: number;
}

export class Hand {
  /** Whether a drag pulls rather than turns. */
  isOn = false;
  private hold: Hold | null = null;
  /** What is to be sent, and whether something is being sent: of many motions only the last matters. */
  private next: (() => Promise<void>) | null = null;
  private isSending = false;

  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly viewport: Viewport,
    private readonly visible: () => Result[],
    private readonly tell: (error: unknown) => void,
  ) {
    // Before the controls of the camera see it.
    canvas.addEventListener("pointerdown", (event) => this.take(event), { capture: true });
    canvas.addEventListener("pointermove", (event) => this.move(event));
    for (const end of ["pointerup", "pointercancel"] as const) {
      canvas.addEventListener(end, (event) => this.release(event));
    }
  }

  get holds(): boolean {
    return this.hold !== null;
  }

  private take(event: PointerEvent): void {
    if (!this.isOn || !event.isPrimary || event.button !== 0) {
      return;
    }
    const found = this.viewport.pick(event.clientX, event.clientY);
    const result = found === null ? undefined : this.visible()[found.stage];
    if (found === null || result?.state.playable !== true) {
      return;
    }
    const { vertex, point } = found.hit;
    const part = result.source.info.parts.find(({ vertices }) => vertex >= vertices.start && vertex < vertices.end);
    if (part?.kind !== "shell") {
      return;
    }
    this.hold = { result, vertex, start: point, pointer: event.pointerId };
    this.viewport.setTurning(false);
    this.canvas.setPointerCapture(event.pointerId);
    result.stage.mark(vertex, 0.012 * this.viewport.radius);
    this.viewport.redraw();
  }

  private move(event: PointerEvent): void {
    const { hold } = this;
    if (hold?.pointer !== event.pointerId) {
      return;
    }
    const target = this.viewport.under(event.clientX, event.clientY, hold.start);
    if (target !== null) {
      this.send(async () => hold.result.source.pull?.({ vertex: hold.vertex, target }));
    }
  }

  private release(event: PointerEvent): void {
    const { hold } = this;
    if (hold?.pointer !== event.pointerId) {
      return;
    }
    this.hold = null;
    this.viewport.setTurning(true);
    hold.result.stage.mark(null, 0);
    this.viewport.redraw();
    this.send(async () => hold.result.source.pull?.(null));
  }

  private send(what: () => Promise<void>): void {
    this.next = what;
    if (!this.isSending) {
      void this.sendAll();
    }
  }

  private async sendAll(): Promise<void> {
    this.isSending = true;
    try {
      while (this.next !== null) {
        const { next } = this;
        this.next = null;
        await next();
      }
    } catch (error) {
      this.tell(error);
    } finally {
      this.isSending = false;
    }
  }
}
