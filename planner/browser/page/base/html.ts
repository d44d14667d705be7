// SPDX-License-Identifier: AGPL-3.0-or-later
// Functions that make an element in one expression, and fill(), which replaces an element's children and
// gives the focus back to the control that had it.

export type Child = Node|string|number|null|undefined|false|Child[];
type Attribute = string|number|boolean|null|undefined|((event: never) => void);
export interface Attributes {
  [name: string]: Attribute;
}

/// Creates an element. Attributes whose value is a function become event listeners ("onclick" listens to
/// "click"). Attributes that are false, null or undefined are left out.
export function el<Tag extends keyof HTMLElementTagNameMap>(
    tag: Tag, attributes: Attributes = {}, ...children: Child[]): HTMLElementTagNameMap[Tag] {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === null || value === undefined || value === false) continue;
    if (typeof value === "function")
      element.addEventListener(name.slice(2), value as EventListener);
    else if (name === "style")
      element.style.cssText = String(value);  // the page's content security policy forbids style attributes
    else if (name === "value" && "value" in element)
      (element as HTMLInputElement).value = String(value);
    else
      element.setAttribute(name, value === true ? "" : String(value));
  }
  put(element, children);
  return element;
}

/// Appends elements and texts, also from nested lists. Leaves out null, undefined and false.
export function put(element: Element, children: Child[]): void {
  for (const child of children) {
    if (child === null || child === undefined || child === false) continue;
    if (Array.isArray(child))
      put(element, child);
    else
      element.append(child instanceof Node ? child : String(child));
  }
}

// The element under a pressed pointer; null if no pointer is pressed. fill() does not replace the children of
// a host that contains it before the release. Otherwise the click would be lost and a dragged slider would
// stop.
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
// The release waits for a timer, because the click event follows directly after pointerup. An open drop-down
// list sends only a change event when it closes.
for (const end of ["pointerup", "pointercancel", "change"])
  addEventListener(end, () => window.setTimeout(release), true);

// A text that identifies a control after its host was refilled: its `data-key`, else its words, label and
// tip.
const mark_of = (control: HTMLElement): string => control.dataset.key ??
    [control.textContent, control.ariaLabel, control.dataset.tip].join(" ").trim();
const alike = (host: Element, {tagName, mark}: {tagName: string; mark: string}): HTMLElement[] =>
    [...host.querySelectorAll<HTMLElement>(tagName)].filter((control) => mark_of(control) === mark);

// Data to find the focused control of a host after a refill. Null if no control of the host has the focus, or
// if the control has no `data-key` and either no words or no visible focus.
function focused_in(host: Element):
    {tagName: string; mark: string; place: number; typed: string|null}|null {
  const active = document.activeElement;
  if (!(active instanceof HTMLElement) || active === host || !host.contains(active)) return null;
  const known = {tagName: active.tagName, mark: mark_of(active)};
  const {key} = active.dataset;
  if (!key && !(known.mark && active.matches(":focus-visible"))) return null;
  const is_typed =
      key && active instanceof HTMLInputElement && active.type !== "checkbox" && active.type !== "range";
  return {...known, place: alike(host, known).indexOf(active), typed: is_typed ? active.value : null};
}

/// Replaces a host's children. If a pointer is pressed on the host, the replacement waits for the release.
/// The focus moves to the new control with the same `data-key` or, if the focus is visible, with the same
/// words. A text field with a `data-key` also keeps its text.
export function fill(host: Element, ...children: Child[]): void {
  if (pressed && host.contains(pressed)) {
    put_off.set(host, children);
    return;
  }
  put_off.delete(host);
  const focused = focused_in(host);
  const top = host.scrollTop;
  host.replaceChildren();
  put(host, children);
  host.scrollTop = top;
  const again = focused && alike(host, focused)[focused.place];
  if (!again) return;
  if (focused.typed !== null && again instanceof HTMLInputElement) again.value = focused.typed;
  again.focus({preventScroll: true});
}

/// Fills a host with a row of tabs: the name, label and tip of each. The tab named `chosen` is marked; a
/// click on a tab calls `choose`.
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

/// A button with words or an icon, and a tip. For a button with only an icon, the tip's first sentence is its
/// label for screen readers.
export function button(
    label: Child,
    tip: string,
    onclick: (event: MouseEvent) => void,
    more: Attributes = {},
    ): HTMLButtonElement {
  const name = label instanceof SVGElement ? {"aria-label": tip.split(". ")[0] ?? tip} : {};
  return el("button", {type: "button", "data-tip": tip, ...name, onclick, ...more}, label);
}

/// A slider and a number field for one value. `shared` are attributes of both, `of_slider` of the slider
/// only. `take` receives every value of the moving slider, and a typed value after the field has changed.
export function slider(
    label: string, key: string, shared: Attributes, of_slider: Attributes, take: (value: number) => void): Child {
  const number = (event: Event): number => Number((event.target as HTMLInputElement).value);
  const field = el("input", {
    type: "number",
    ...shared,
    "data-key": key,
    name: key,
    onchange: (event: Event) => take(number(event))
  });
  return el(
      "label", {class: "slider"}, el("span", {}, label), el("input", {
        type: "range",
        ...of_slider,
        ...shared,
        "data-key": `${key}-range`,
        oninput: (event: Event) => {
          field.value = String(number(event));
          take(number(event));
        }
      }),
      field);
}
