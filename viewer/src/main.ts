// Where the page begins: it finds its results and puts itself together.

import { App } from "./app";
import { embeddedSource } from "./data/embedded";
import { serverSources } from "./data/server";
import { el } from "./ui/dom";
import { helpDialog, type Key, listen } from "./ui/help";
import { Side } from "./ui/side";
import { PRESETS } from "./scene/views";

async function begin(root: HTMLElement): Promise<void> {
  chooseTheme();
  const embedded = embeddedSource();
  const sources = embedded === null ? await serverSources() : [embedded];
  const app = await App.open(sources);
  const side = new Side(app);
  app.onChange = () => side.update();
  side.update();
  document.title = `${app.results.map((result) => result.name).join(" · ")} – Koiter`;
  const scene = el("div", { className: "scene" }, app.canvas, app.overlay, app.message);
  const keys = keysOf(app, side, root);
  const help = helpDialog(keys);
  keys.push({ keys: ["?"], shown: "?", does: "this help", act: () => help.showModal() });
  root.replaceChildren(scene, app.bar.element, side.element, help);
  listen(keys);
  app.plots.update();
  await app.fit("iso");
  await app.show();
  // For tests and for the console.
  Object.assign(window, { koiter: app });
}

function keysOf(app: App, side: Side, root: HTMLElement): Key[] {
  const { player } = app;
  const key = (keys: string[], shown: string, does: string, act: () => void): Key => ({ keys, shown, does, act });
  return [
    key([" ", "k"], "space", "play or pause", () => player.toggle()),
    key(["ArrowLeft"], "←", "one frame back", () => player.stepFrames(-1)),
    key(["ArrowRight"], "→", "one frame on", () => player.stepFrames(1)),
    key(["PageUp"], "page up", "ten frames back", () => player.stepFrames(-10)),
    key(["PageDown"], "page down", "ten frames on", () => player.stepFrames(10)),
    key(["Home"], "home", "first frame", () => player.seek(player.start)),
    key(["End"], "end", "last frame", () => player.seek(player.end)),
    ...PRESETS.map((preset, k) =>
      key([String(k + 1)], String(k + 1), `look from: ${preset}`, () => void app.fit(preset)),
    ),
    key(["f", "F"], "F", "show everything", () => void app.fit(app.preset)),
    key(["w", "W"], "W", "wireframe", () => side.wire.click()),
    key(["s", "S"], "S", "facets or smooth", () => side.shading.click()),
    key(["h", "H"], "H", "shadows", () => side.shadows.click()),
    key(["d", "D"], "D", "dark or light", () => document.getElementById("dark")?.click()),
    key(["g", "G"], "G", "pull at a run that is played with, or turn", () => document.getElementById("pull")?.click()),
    key(["p", "P"], "P", "save a picture", () => void side.picture()),
    key(["m", "M"], "M", "hide or show the panel", () => root.classList.toggle("narrow")),
  ];
}

/** What was chosen before, else what the system says. */
function chooseTheme(): void {
  let kept: string | null = null;
  try {
    kept = localStorage.getItem("koiter-theme");
  } catch {
    // A page from a file may keep nothing.
  }
  const dark = kept === null ? matchMedia("(prefers-color-scheme: dark)").matches : kept === "dark";
  document.documentElement.dataset.theme = dark ? "dark" : "light";
}

const root = document.getElementById("app") as HTMLElement;
begin(root).catch((error: unknown) => {
  const text = error instanceof Error ? error.message : String(error);
  root.replaceChildren(el("p", { className: "message", textContent: text }));
});

