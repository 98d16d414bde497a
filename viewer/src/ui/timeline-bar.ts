// The bar below the picture: play, steps, the slider, time and speed.

import { decimals, frameAt } from "../data/timeline";
import type { Player } from "../player";
import { button, choice, el } from "./dom";

const SPEEDS = ["0.125", "0.25", "0.5", "1", "2", "4", "8"] as const;

export class TimelineBar {
  readonly element: HTMLElement;
  private readonly playButton: HTMLButtonElement;
  private readonly slider = el("input", { type: "range", min: "0", step: "1", value: "0" });
  private readonly output = el("output");
  private times: number[] = [];

  constructor(private readonly player: Player) {
    this.playButton = button("▶", "Play or pause (space)", () => player.toggle());
    this.slider.setAttribute("aria-label", "Frame");
    this.slider.addEventListener("input", () => {
      const time = this.times[Number(this.slider.value)];
      if (time !== undefined) {
        player.isPlaying = false;
        player.seek(time);
      }
    });
    const speeds = SPEEDS.map((speed) => [speed, `${speed}×`] as const);
    const speed = choice(speeds, "1", (value) => {
      player.speed = Number(value);
    });
    speed.title = "Speed";
    speed.setAttribute("aria-label", "Speed");
    this.element = el(
      "div",
      { className: "bar" },
      button("|◀", "First frame (Home)", () => player.seek(player.start)),
      button("‹", "One frame back (←)", () => player.stepFrames(-1)),
      this.playButton,
      button("›", "One frame on (→)", () => player.stepFrames(1)),
      button("▶|", "Last frame (End)", () => player.seek(player.end)),
      this.slider,
      this.output,
      speed,
    );
  }

  setTimes(times: number[]): void {
    this.times = times;
    this.slider.max = String(Math.max(0, times.length - 1));
    this.update();
  }

  update(): void {
    const index = Math.max(0, frameAt(this.times, this.player.time));
    this.slider.value = String(index);
    const told = this.player.time.toFixed(decimals(this.times));
    const count = this.times.length;
    this.output.textContent = count === 0 ? "no frames" : `t = ${told} s · ${index + 1} / ${count}`;
    const isPlaying = this.player.isPlaying;
    this.playButton.textContent = isPlaying ? "❚❚" : "▶";
    this.playButton.setAttribute("aria-pressed", String(isPlaying));
  }
}
