// SPDX-License-Identifier: AGPL-3.0-or-later
// Elements of the page, made in one expression, and a host that is filled anew without losing the field that
// is typed in.

export type Child = Node|string|number|null|undefined|false|Child[];
type Attribute = string|number|boolean|null|undefined|((event: never) => void);
export interface Attributes {
  [name: string]: Attribute;
}

/// An element: `class`, `style` and others as attributes, functions as `onclick` and so on, false and null
/// left out.
export function el<Tag extends keyof HTMLElementTagNameMap>(
    tag: Tag, attributes: Attributes = {}, ...children: Child[]): HTMLElementTagNameMap[Tag] {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === null || value === undefined || value === false) continue;
    if (typeof value === "function")
      element.addEventListener(name.slice(2), value as EventListener);
    else if (name === "style")
      element.style.cssText = String(value);  // the page's policy refuses the attribute
    else if (name === "value" && "value" in element)
      (element as HTMLInputElement).value = String(value);
    else
      element.setAttribute(name, value === true ? "" : String(value));
  }
  put(element, children);
  return element;
}

function put(element: Element, children: Child[]): void {
  for (const child of children) {
    if (child === null || child === undefined || child === false) continue;
    if (Array.isArray(child))
      put(element, child);
    else
      element.append(child instanceof Node ? child : String(child));
  }
}

// What is pressed stays until it is let go, or its click would be lost and a slider would slip from the hand.
let pressed: Node|null = null;
const put_off = new Map<Element, Child[]>();
function release(): void {
  pressed = null;
  const hosts = [...put_off];
  put_off.clear();
  for (const [host, children] of hosts) fill(host, ...children);
}
addEventListener("pointerdown", (event) => {
  pressed = event.target as Node;
}, true);
// A click comes right after its pointerup. A list that hangs open tells its end by a change alone.
for (const end of ["pointerup", "pointercancel", "change"])
  addEventListener(end, () => window.setTimeout(release), true);

/// Fills a host anew; a host in which something is pressed, as soon as that is let go. The field with the
/// focus keeps it, with its text and caret, if its `data-key` comes again.
export function fill(host: Element, ...children: Child[]): void {
  if (pressed && host.contains(pressed)) {
    put_off.set(host, children);
    return;
  }
  put_off.delete(host);
  const active = document.activeElement;
  const key = active instanceof HTMLElement && host.contains(active) ? active.dataset.key : undefined;
  const typed = active instanceof HTMLInputElement && active.type !== "checkbox" && active.type !== "range" ?
      active.value :
      null;
  const top = host.scrollTop;
  host.replaceChildren();
  put(host, children);
  host.scrollTop = top;
  if (!key) return;
  const again = host.querySelector<HTMLElement>(`[data-key="${CSS.escape(key)}"]`);
  if (!again) return;
  if (typed !== null && again instanceof HTMLInputElement) again.value = typed;
  again.focus({preventScroll: true});
}

/// A row of tabs, of which one is chosen.
export function fill_tabs<Name extends string>(
    host: Element, chosen: Name, tabs: readonly(readonly[Name, string, string])[],
    choose: (name: Name) => void): void {
  fill(
      host,
      tabs.map(
          ([name, label, tip]) => button(
              label, tip, () => choose(name),
              {role: "tab", "aria-selected": String(name === chosen), class: name === chosen ? "on" : ""})));
}

/// A button with words or an icon, and its tip. Where it has an icon alone, the tip's first sentence is its
/// name for screen readers.
export function button(
    label: Child,
    tip: string,
    onclick: (event: MouseEvent) => void,
    more: Attributes = {},
    ): HTMLButtonElement {
  const name = label instanceof SVGElement ? {"aria-label": tip.split(". ")[0] ?? tip} : {};
  return el("button", {type: "button", "data-tip": tip, ...name, onclick, ...more}, label);
}
