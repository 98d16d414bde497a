// The clock of the timeline.

import { frameAt, naturalPace } from "./data/timeline";

export class Player {
  time = 0;
  isPlaying = false;
  speed = 1;
  private times: number[] = [0];
  private last: number | null = null;

  constructor(private readonly changed: () => void) {}

  get start(): number {
    return this.times[0] ?? 0;
  }

  get end(): number {
    return this.times[this.times.length - 1] ?? 0;
  }

  /** Times of all frames, of all results. */
  setTimes(times: number[]): void {
    this.times = times;
    this.time = Math.min(Math.max(this.time, this.start), this.end);
  }

  seek(time: number): void {
    this.time = Math.min(Math.max(time, this.start), this.end);
    this.changed();
  }

  /** Goes `count` frames on, or back. */
  stepFrames(count: number): void {
    this.pause();
    const { times } = this;
    const index = Math.min(Math.max(frameAt(times, this.time) + count, 0), times.length - 1);
    this.seek(times[index] ?? 0);
  }

  play(): void {
    if (this.times.length < 2) {
      return;
    }
    if (this.time >= this.end) {
      this.time = this.start;
    }
    this.isPlaying = true;
    this.last = null;
    this.changed();
  }

  pause(): void {
    this.isPlaying = false;
    this.changed();
  }

  toggle(): void {
    if (this.isPlaying) {
      this.pause();
    } else {
      this.play();
    }
  }

  /** To be called as the browser draws, with its time [ms]. */
  tick(now: number): void {
    if (!this.isPlaying) {
      return;
    }
    const passed = this.last === null ? 0 : Math.min(0.25, (now - this.last) / 1000);
    this.last = now;
    this.time += (passed * this.speed) / naturalPace(this.times);
    if (this.time > this.end) {
      // Around again.
      this.time = this.start;
    }
    this.changed();
  }
}
