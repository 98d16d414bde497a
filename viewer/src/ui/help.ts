// What keys and fingers do.

import { el } from "./dom";

export interface Key {
  keys: string[];
  shown: string;
  does: string;
  act: () => void;
}

/** Calls what a key does, unless it is typed into something. */
export function listen(keys: Key[]): void {
  window.addEventListener("keydown", (event) => {
    const target = event.target as HTMLElement | null;
    const isTyping = target?.matches('input:not([type="range"]):not([type="checkbox"]), select, textarea') ?? false;
    if (isTyping || event.ctrlKey || event.metaKey || event.altKey) {
      return;
    }
    const key = keys.find((candidate) => candidate.keys.includes(event.key));
    if (key !== undefined) {
      // A space would also press the button that was clicked last.
      event.preventDefault();
      key.act();
    }
  });
}

export function helpDialog(keys: Key[]): HTMLDialogElement {
  const rows = keys.map(({ shown, does }) =>
    el("tr", {}, el("td", {}, el("kbd", { textContent: shown })), el("td", { textContent: does })),
  );
  const close = el("button", { type: "submit", textContent: "Close" });
  return el(
    "dialog",
    {},
    el("h2", { textContent: "Keys and fingers" }),
    el("p", {}, "Drag turns, two fingers or the right button move, wheel or pinch zooms, a click picks."),
    el("table", {}, ...rows),
    el("form", { method: "dialog" }, el("p", {}, close)),
  );
}
