/** Short ways to the elements of the page. */

type Child = Node | string | null | false;
type Properties = Record<string, unknown>;

/** The element with an id; the page has it. */
export function byId<T extends Element = HTMLElement>(id: string): T {
  const element = document.getElementById(id);
  if (element === null) throw new Error(`The page has no element ${id}.`);
  return element as unknown as T;
}

/** A new element. Properties are set as such; names with a dash and ``role`` are attributes, ``on...`` are listeners. */
export function h<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  properties: Properties = {},
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value as EventListener);
    else if (name.includes("-") || name === "role" || name === "list") element.setAttribute(name, String(value));
    else Object.assign(element, { [name]: value });
  }
  element.append(...children.filter((child): child is Node | string => child !== null && child !== false));
  return element;
}

/** One of the icons of the page. */
export function icon(name: string): SVGSVGElement {
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  svg.setAttribute("aria-hidden", "true");
  svg.classList.add("icon");
  const use = document.createElementNS("http://www.w3.org/2000/svg", "use");
  use.setAttribute("href", `#icon-${name}`);
  svg.append(use);
  return svg;
}

/** Tell people who listen to the page. */
export function announce(text: string): void {
  byId("announcer").textContent = text;
}

/** A short message at the edge of the page. */
export function toast(text: string): void {
  const note = h("p", { className: "toast" }, text);
  byId("toasts").append(note);
  announce(text);
  setTimeout(() => note.remove(), 4000);
}

/** Open a dialog that a click outside closes too. */
export function openDialog(dialog: HTMLDialogElement): void {
  dialog.showModal();
  dialog.onclick = (event) => {
    if (event.target === dialog) dialog.close();
  };
}

export function save(blob: Blob, name: string): void {
  const address = URL.createObjectURL(blob);
  h("a", { href: address, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(address), 60_000);
}
