// The panel beside the picture.

import type { App } from "../app";
import { fileName, recordFilm, save, savePicture } from "../film";
import type { Axis } from "../data/source";
import type { Result } from "../result";
import { MAPS, type MapName, SHELLS } from "../scene/color-map";
import { readable } from "../scene/ticks";
import { PRESETS } from "../scene/views";
import { button, choice, el, labelled, row, section, toggle } from "./dom";

export class Side {
  readonly element = el("aside", { className: "side" });
  private readonly colorBody = el("div");
  private readonly runBody = el("div");
  private cutAxis: Axis | null = null;
  private cutShare = 0.5;
  private isCutFlipped = false;
  private isFilming = false;
  readonly wire: HTMLButtonElement;
  readonly shading: HTMLButtonElement;
  readonly shadows: HTMLButtonElement;

  constructor(private readonly app: App) {
    this.wire = toggle("Wireframe", "Edges of the triangles (W)", false, (on) => app.setWireframe(on));
    this.shading = toggle("Facets", "Each face as it was computed, or smooth (S)", false, (on) =>
      app.setShading(on ? "faces" : "smooth"),
    );
    this.shadows = toggle("Shadows", "Shadows (H)", true, (on) => app.setShadows(on));
    const { results } = app;
    this.element.append(
      el("h1", { textContent: results.map((result) => result.name).join(" · ") || "Koiter" }),
      this.runBody,
      section("Colours", true, this.colorBody),
      section("View", true, ...this.viewRows()),
      ...(results.length > 1 ? [section("Compare", true, ...this.compareRows())] : []),
      section("Parts", results.length === 1, ...results.map((result) => this.partsOf(result))),
      app.plots.element,
      app.picks.element,
      section("Take away", false, ...this.takeAwayRows()),
      section("About this result", false, ...results.map((result) => this.about(result))),
    );
    this.update();
  }

  /** After what can be chosen has changed. */
  update(): void {
    if (!this.colorBody.contains(document.activeElement)) {
      this.colorBody.replaceChildren(...this.colorRows());
    }
    this.runBody.replaceChildren(...this.app.results.flatMap((result) => this.runRows(result)));
  }

  private colorRows(): HTMLElement[] {
    const { app } = this;
    const names = [...new Set(app.results.flatMap((r) => r.source.info.fields.map((field) => field.name)))];
    const options: [string, string][] = [
      ["parts", "parts"],
      ...names.map((name): [string, string] => [`field:${name}`, name.replaceAll("_", " ")]),
      ["displacement", "displacement"],
      ["height", "height"],
    ];
    if (app.results.length > 1) {
      options.push(["distance", "distance to the other result"]);
    }
    const by = choice(options, app.coloring, (coloring) => {
      by.blur();
      void app.setColoring(coloring).then(() => this.update());
    });
    by.id = "coloring";
    const rows: HTMLElement[] = [labelled("Colour by", by)];
    if (app.coloring !== "parts") {
      const maps = Object.entries(MAPS) as [MapName, string][];
      const map = choice(maps, app.map, (name) => app.setMap(name as MapName));
      const ends = (["low", "high"] as const).map((end) => {
        const input = el("input", { type: "number", step: "any", value: String(Number(app.range[end].toPrecision(5))) });
        input.setAttribute("aria-label", `${end} end of the colours`);
        input.addEventListener("change", () => {
          const value = input.valueAsNumber;
          if (Number.isFinite(value)) {
            const range = { ...app.range, [end]: value };
            app.setRange(range.low, range.high);
          }
        });
        return input;
      });
      const whole = button("Whole run", "Range of the whole run", () => void app.fitRange());
      rows.push(labelled("Map", map), labelled("From, to", ...ends), row(whole));
    }
    return rows;
  }

  private viewRows(): HTMLElement[] {
    const { app } = this;
    const presets = PRESETS.map((preset, k) =>
      button(preset, `Look from: ${preset} (${k + 1})`, () => void app.fit(preset)),
    );
    const fit = button("Fit", "Show everything (F)", () => void app.fit(app.preset));
    const at = el("input", { type: "range", min: "0", max: "1", step: "0.005", value: "0.5" });
    at.setAttribute("aria-label", "Where the section is");
    at.addEventListener("input", () => {
      this.cutShare = at.valueAsNumber;
      this.cut();
    });
    const axes = [["", "none"], ["x", "x"], ["y", "y"], ["z", "z"]] as const;
    const axis = choice(axes, "", (value) => {
      this.cutAxis = value === "" ? null : (value as Axis);
      this.cut();
    });
    axis.id = "section";
    const flip = toggle("Flip", "The other half", false, (on) => {
      this.isCutFlipped = on;
      this.cut();
    });
    const dark = toggle("Dark", "Dark or light (D)", isDark(), (on) => setTheme(app, on));
    dark.id = "dark";
    return [
      row(...presets, fit),
      row(this.wire, this.shading, this.shadows, dark),
      labelled("Section", axis, at, flip),
    ];
  }

  private cut(): void {
    this.app.viewport.cut(this.cutAxis, this.cutShare, this.isCutFlipped);
  }

  private compareRows(): HTMLElement[] {
    const { app } = this;
    const names = app.results.map((result, k): [string, string] => [String(k), label(result)]);
    const layout = choice([["all", "side by side"], ...names], "all", (value) =>
      app.setShown(value === "all" ? "all" : Number(value)),
    );
    layout.id = "layout";
    const reference = choice(names, "0", (value) => {
      app.reference = Number(value);
      void app.setColoring(app.coloring);
    });
    const same = app.results.every((r) => r.source.info.vertices === app.results[0].source.info.vertices);
    const note = el("p", { className: "faint" });
    note.textContent = same
      ? "Distances are between vertices of the same number, at the same time."
      : "The meshes have different numbers of vertices: there are no distances between them.";
    return [labelled("Show", layout), labelled("Distances to", reference), note];
  }

  private partsOf(result: Result): HTMLElement {
    const { app } = this;
    const boxes: HTMLInputElement[] = [];
    const apply = () => {
      result.stage.parts.forEach((part, k) => {
        part.group.visible = boxes[k].checked;
      });
      app.viewport.redraw();
    };
    let shells = 0;
    const rows = result.stage.parts.map(({ part }, k) => {
      const box = el("input", { type: "checkbox", checked: true });
      box.addEventListener("change", apply);
      boxes.push(box);
      const swatch = el("span", { className: "swatch" });
      swatch.style.background = part.kind === "obstacle" ? "var(--obstacle)" : SHELLS[shells++ % SHELLS.length];
      const faces = part.faces.end - part.faces.start;
      const name = el("label", { className: "check name" }, box, " ", swatch, ` ${part.name} `);
      name.append(el("span", { className: "faint", textContent: `${faces} faces` }));
      const only = button("Only", `Show ${part.name} alone, or all again`, () => {
        const isAlone = boxes.every((other, j) => other.checked === (j === k));
        boxes.forEach((other, j) => {
          other.checked = isAlone || j === k;
        });
        apply();
      });
      return row(name, only);
    });
    const title = app.results.length > 1 ? [el("p", { className: "faint", textContent: label(result) })] : [];
    return el("div", {}, ...title, ...rows);
  }

  /** State of a run, and what can be asked of it. */
  private runRows(result: Result): HTMLElement[] {
    const { state, source } = result;
    if (source.info.kind === "mesh") {
      return [];
    }
    const prefix = this.app.results.length > 1 ? `${label(result)}: ` : "";
    const told = el("p", { className: "faint", textContent: prefix + stateInWords(result) });
    if (!result.isLive || source.request === undefined) {
      return [told];
    }
    const ask = (word: "pause" | "continue" | "stop") => () => {
      source.request?.(word).then(
        () => result.poll().then(() => this.update()),
        (error) => this.app.tell(error),
      );
    };
    const isPaused = state.request === "pause";
    const first = isPaused
      ? button("Continue", "Let the run go on", ask("continue"))
      : button("Pause", "Have the run wait after this step", ask("pause"));
    const stop = button("Stop", "End the run after this step, saved to be resumed", ask("stop"));
    const { hand } = this.app;
    const pull = toggle("Pull", "Drags pull at the shells instead of turning the view (G)", hand.isOn, (on) => {
      hand.isOn = on;
    });
    pull.id = "pull";
    return [told, row(first, stop, ...(state.playable === true ? [pull] : []))];
  }

  private takeAwayRows(): HTMLElement[] {
    const film = button("Film", "Record the run from its beginning to its end", () => void this.film(film));
    film.id = "film";
    return [
      row(button("Picture", "Save a PNG (P)", () => void this.picture()), film),
      el("p", {
        className: "faint",
        textContent: "A film takes as long as it lasts. koiter export --to html writes a file that shows all this anywhere.",
      }),
    ];
  }

  async picture(): Promise<void> {
    const target = el("canvas");
    this.app.compose(target);
    await savePicture(target, fileName(this.app.results[0]?.name ?? "", "png")).catch((error) => this.app.tell(error));
  }

  private async film(pressed: HTMLButtonElement): Promise<void> {
    if (this.isFilming) {
      this.isFilming = false;
      return;
    }
    const { app } = this;
    const { player } = app;
    this.isFilming = true;
    pressed.textContent = "End the film";
    player.pause();
    const target = el("canvas");
    app.compose(target);
    const frames = Math.max(...app.visible.map((result) => result.times.length));
    try {
      const blob = await recordFilm(target, {
        framesASecond: 30,
        seconds: Math.min(60, Math.max(2, frames / 30)),
        show: async (share) => {
          player.seek(player.start + share * (player.end - player.start));
          await app.show();
          app.compose(target);
        },
        isEnough: () => !this.isFilming,
      });
      save(blob, fileName(app.results[0]?.name ?? "", blob.type.includes("mp4") ? "mp4" : "webm"));
    } catch (error) {
      app.tell(error);
    }
    this.isFilming = false;
    pressed.textContent = "Film";
  }

  private about(result: Result): HTMLElement {
    const { app } = this;
    const { info } = result.source;
    const rows: [string, string][] = [
      ["folder", info.path],
      ["written by", `Koiter ${info.version}`],
      ["vertices", String(info.vertices)],
      ["faces", String(info.faces)],
      ["frames", String(result.times.length)],
    ];
    for (const [key, value] of Object.entries(result.state.summary ?? {})) {
      if (["number", "boolean"].includes(typeof value)) {
        rows.push([key.replaceAll("_", " "), typeof value === "number" ? readable(value) : String(value)]);
      }
    }
    const table = el("table", {}, ...rows.map(([name, value]) =>
      el("tr", {}, el("td", { textContent: name }), el("td", { textContent: value })),
    ));
    const scene = el("pre");
    const shown = section("Scene", false, scene);
    shown.addEventListener("toggle", () => {
      result.source.scene().then((text) => {
        scene.textContent = text;
      }, (error) => app.tell(error));
    });
    return el("div", {}, table, ...(info.kind === "run" ? [shown] : []));
  }
}

function label(result: Result): string {
  return result.source.info.path.split("/").filter(Boolean).pop() ?? result.name;
}

function stateInWords({ state, isLive, times }: Result): string {
  const frames = `${times.length} ${times.length === 1 ? "frame" : "frames"}`;
  if (isLive) {
    const asked = state.request === "pause" ? ", paused" : state.request === "stop" ? ", about to stop" : "";
    return `running${asked}: ${frames} so far`;
  }
  if (!state.ended) {
    return `${frames}; its run was killed`;
  }
  const { summary } = state;
  if (summary?.interrupted === true) {
    return `${frames}; its run was interrupted and can be resumed`;
  }
  return summary?.converged === false ? `${frames}; some steps did not converge` : `${frames}`;
}

export function isDark(): boolean {
  return document.documentElement.dataset.theme === "dark";
}

export function setTheme(app: App, dark: boolean): void {
  document.documentElement.dataset.theme = dark ? "dark" : "light";
  try {
    localStorage.setItem("koiter-theme", dark ? "dark" : "light");
  } catch {
    // A page from a file may keep nothing.
  }
  app.setTheme();
}
