// What was picked: its numbers, its values now, and their history.

import type { Columns, FrameData } from "../data/source";
import { frameAt } from "../data/timeline";
import type { Result } from "../result";
import type { Hit } from "../scene/pick";
import { readable } from "../scene/ticks";
import { choice, el, labelled, section } from "./dom";
import { Plot } from "./plot";
import { historyCurves } from "./plots-panel";

export interface Picked {
  result: Result;
  hit: Hit;
}

export class PickPanel {
  readonly element: HTMLDetailsElement;
  private readonly body = el("div");
  private readonly table = el("table");
  private readonly plot: Plot;
  private picked: Picked | null = null;
  private history: Columns = {};
  private chosen = "position";
  private time = 0;

  constructor(seek: (time: number) => void) {
    this.plot = new Plot(seek);
    this.element = section("Picked point", true, this.body);
    this.clear();
  }

  clear(): void {
    this.picked = null;
    this.body.replaceChildren(
      el("p", { className: "faint", textContent: "Click on a surface: its values and their history are shown here." }),
    );
  }

  /** Reads the history of what was picked. */
  async show(picked: Picked, frame: FrameData): Promise<void> {
    this.picked = picked;
    this.history = {};
    this.element.open = true;
    this.update(frame);
    this.body.replaceChildren(this.table);
    const { source } = picked.result;
    if (source.info.kind === "mesh") {
      return;
    }
    const [vertex, face] = await Promise.all([
      source.history({ vertex: picked.hit.vertex }),
      source.history({ face: picked.hit.face }),
    ]);
    if (this.picked !== picked) {
      return;
    }
    this.history = { ...face, ...vertex };
    const fields = Object.keys(this.history).filter((name) => !["time", "x", "y", "z"].includes(name));
    const options: [string, string][] = [
      ["position", "position"],
      ...fields.map((name): [string, string] => [name, name.replaceAll("_", " ")]),
    ];
    if (!options.some(([key]) => key === this.chosen)) {
      this.chosen = "position";
    }
    const select = choice(options, this.chosen, (key) => {
      this.chosen = key;
      this.drawHistory();
    });
    this.body.replaceChildren(this.table, labelled("History", select), this.plot.element);
    this.drawHistory();
    this.element.scrollIntoView({ block: "nearest" });
  }

  /** The values in the frame that is shown now. */
  update(frame: FrameData): void {
    if (this.picked === null) {
      return;
    }
    const { result, hit } = this.picked;
    const part = result.source.info.parts.find(({ faces }) => hit.face >= faces.start && hit.face < faces.end);
    const at = [0, 1, 2].map((k) => readable(frame.positions[3 * hit.vertex + k])).join(", ");
    const rows: [string, string][] = [
      ["part", part?.name ?? ""],
      ["vertex", String(hit.vertex - (part?.vertices.start ?? 0))],
      ["face", String(hit.face - (part?.faces.start ?? 0))],
      ["position [m]", at],
    ];
    this.table.replaceChildren(
      ...rows.map(([name, value]) => el("tr", {}, el("td", { textContent: name }), el("td", { textContent: value }))),
    );
    this.table.append(...this.fieldRows());
  }

  setTime(time: number): void {
    if (this.picked !== null) {
      this.time = time;
      this.plot.setTime(time);
      this.tellPosition();
      this.table.querySelectorAll("tr.field").forEach((row) => row.remove());
      this.table.append(...this.fieldRows());
    }
  }

  redraw(): void {
    this.plot.draw();
  }

  /** The position at this time, once the history is here. */
  private tellPosition(): void {
    const { x, y, z, time } = this.history;
    const cell = this.table.rows[3]?.cells[1];
    if (cell === undefined || time === undefined || x === undefined) {
      return;
    }
    const index = Math.max(0, frameAt(time as number[], this.time + 1e-12));
    cell.textContent = [x, y, z].map((values) => readable(values[index] ?? NaN)).join(", ");
  }

  private fieldRows(): HTMLTableRowElement[] {
    const times = (this.history.time ?? []) as number[];
    const index = Math.max(0, frameAt(times, this.time + 1e-12));
    const units = new Map(this.picked?.result.source.info.fields.map((field) => [field.name, field.unit]));
    return Object.keys(this.history)
      .filter((name) => units.has(name))
      .map((name) => {
        const unit = units.get(name) ? ` [${units.get(name)}]` : "";
        const value = this.history[name][index];
        return el(
          "tr",
          { className: "field" },
          el("td", { textContent: name.replaceAll("_", " ") + unit }),
          el("td", { textContent: value === null || value === undefined ? "–" : readable(value) }),
        );
      });
  }

  private drawHistory(): void {
    const wanted = this.chosen === "position" ? ["x", "y", "z"] : [this.chosen];
    this.plot.show(`History of ${this.chosen}`, historyCurves(this.history, wanted), false);
    this.plot.setTime(this.time);
    this.setTime(this.time);
  }
}
