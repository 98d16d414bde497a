// Plots beside the picture: figures of the run, probes, and the history of what was picked.

import type { Columns } from "../data/source";
import type { Result } from "../result";
import { choice, el, labelled, section } from "./dom";
import { Plot } from "./plot";
import { type Curve, curves, type Figure, figures } from "./plot-data";

export class PlotsPanel {
  readonly element: HTMLDetailsElement;
  private readonly plot: Plot;
  private readonly body = el("div");
  private chosen = "";

  constructor(
    private readonly results: () => Result[],
    seek: (time: number) => void,
  ) {
    this.plot = new Plot(seek);
    this.element = section("Plots", true, this.body);
    this.element.addEventListener("toggle", () => this.plot.draw());
  }

  /** Shows what the results have now. */
  update(): void {
    const results = this.results();
    const known = new Map<string, Figure>();
    for (const { stats, probes } of results) {
      for (const figure of figures(stats, probes)) {
        known.set(figure.key, known.get(figure.key) ?? figure);
      }
    }
    if (known.size === 0) {
      this.body.replaceChildren(el("p", { className: "faint", textContent: "No figures yet." }));
      return;
    }
    if (!known.has(this.chosen)) {
      this.chosen = [...known.keys()][0];
    }
    const options = [...known.values()].map((figure) => [figure.key, figure.title] as const);
    const select = choice(options, this.chosen, (key) => {
      this.chosen = key;
      this.draw(known);
    });
    select.id = "figure";
    this.body.replaceChildren(labelled("Figure", select), this.plot.element);
    this.draw(known);
  }

  setTime(time: number): void {
    this.plot.setTime(time);
  }

  redraw(): void {
    this.plot.draw();
  }

  private draw(known: Map<string, Figure>): void {
    const figure = known.get(this.chosen);
    if (figure === undefined) {
      return;
    }
    const results = this.results();
    const all = results.flatMap((result, index) =>
      curves(figure, result.stats, result.probes, index).map((curve) => withName(curve, result, results.length)),
    );
    this.plot.show(figure.title, all.slice(0, 24), figure.isLog);
  }
}

function withName(curve: Curve, result: Result, count: number): Curve {
  return count > 1 ? { ...curve, name: `${curve.name} (${result.source.info.path.split("/").pop()})` } : curve;
}

/** Curves of a history, one a column that is wanted. */
export function historyCurves(columns: Columns, wanted: string[]): Curve[] {
  const x = columns.time ?? [];
  return wanted
    .filter((name) => columns[name] !== undefined)
    .map((name, color) => ({ name: name.replaceAll("_", " "), x, y: columns[name], color, result: 0 }));
}
