/** Helpers for finding, creating and announcing page elements. */

type Child = Node | string | null | false;
type Properties = Record<string, unknown>;

/** Return the element with an id. Throws if the page has none. */
export function byId<T extends Element = HTMLElement>(id: string): T {
  const element = document.getElementById(id);
  if (element === null) throw new Error(`The page has no element ${id}.`);
  return element as unknown as T;
}

/** Create an element. Names with a dash, ``role`` and ``list`` set attributes, ``on...`` adds listeners, others set properties. */
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

/** Create an icon from the sprite in index.html. */
export function icon(name: string): SVGSVGElement {
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  svg.setAttribute("aria-hidden", "true");
  svg.classList.add("icon");
  const use = document.createElementNS("http://www.w3.org/2000/svg", "use");
  use.setAttribute("href", `#icon-${name}`);
  svg.append(use);
  return svg;
}

/** Announce a text to screen readers. */
export function announce(text: string): void {
  inFront(byId("announcer")).textContent = text;
}

/** Show a short message for four seconds. */
export function toast(text: string): void {
  const note = h("p", { className: "toast" }, text);
  inFront(byId("toasts")).append(note);
  announce(text);
  setTimeout(() => note.remove(), 4000);
}

/** Move an element into the open dialog: the page behind it is covered, and screen readers do not read it. */
function inFront(element: HTMLElement): HTMLElement {
  const dialogs = document.querySelectorAll("dialog[open]");
  const front = dialogs.item(dialogs.length - 1) ?? document.body;
  if (element.parentElement !== front) front.append(element);
  return element;
}

/** Open a modal dialog; a click on its backdrop closes it. */
export function openDialog(dialog: HTMLDialogElement): void {
  dialog.showModal();
  dialog.onclose = () => ["toasts", "announcer"].forEach((id) => inFront(byId(id)));
  dialog.onclick = (event) => {
    if (event.target === dialog) dialog.close();
  };
}

export function save(blob: Blob, name: string): void {
  const address = URL.createObjectURL(blob);
  h("a", { href: address, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(address), 60_000);
}
