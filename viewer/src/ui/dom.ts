// Elements of the page in few words.

type Content = Node | string;

/** An element with properties and children. */
export function el<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  properties: Partial<HTMLElementTagNameMap[K]> = {},
  ...children: Content[]
): HTMLElementTagNameMap[K] {
  const element = Object.assign(document.createElement(tag), properties);
  element.append(...children);
  return element;
}

export function row(...children: Content[]): HTMLDivElement {
  return el("div", { className: "row" }, ...children);
}

export function labelled(text: string, ...controls: Content[]): HTMLDivElement {
  const line = row(el("label", {}, text), ...controls);
  const control = controls[0];
  if (control instanceof HTMLElement) {
    control.setAttribute("aria-label", text);
  }
  return line;
}

export function button(text: string, title: string, act: () => void): HTMLButtonElement {
  const made = el("button", { type: "button", textContent: text, title });
  made.setAttribute("aria-label", title);
  made.addEventListener("click", act);
  return made;
}

/** A button that stays pressed. */
export function toggle(
  text: string,
  title: string,
  pressed: boolean,
  act: (pressed: boolean) => void,
): HTMLButtonElement {
  const made = button(text, title, () => {
    const now = made.getAttribute("aria-pressed") !== "true";
    made.setAttribute("aria-pressed", String(now));
    act(now);
  });
  made.setAttribute("aria-pressed", String(pressed));
  return made;
}

export function choice(
  options: readonly (readonly [value: string, text: string])[],
  value: string,
  act: (value: string) => void,
): HTMLSelectElement {
  const made = el("select", {}, ...options.map(([v, text]) => el("option", { value: v, textContent: text })));
  made.value = value;
  made.addEventListener("change", () => act(made.value));
  return made;
}

export function section(title: string, isOpen: boolean, ...children: Content[]): HTMLDetailsElement {
  return el("details", { open: isOpen }, el("summary", { textContent: title }), ...children);
}

/** The value of a colour of the theme. */
export function themeColor(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}
