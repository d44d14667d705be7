// SPDX-License-Identifier: AGPL-3.0-or-later
// Tool tips: every element with `data-tip` shows its purpose on hover and on keyboard focus.
import {el} from "./html";

export function attach_tips(): void {
  const tip = el("div", {class: "tip", role: "tooltip", hidden: true});
  document.body.append(tip);
  let timer = 0;
  const hide = (): void => {
    window.clearTimeout(timer);
    tip.hidden = true;
  };
  const show = (target: HTMLElement): void => {
    const words = target.dataset.tip;
    if (!words || !target.isConnected) return;
    tip.textContent = words;
    // An open dialog covers everything outside of it, so the tips of its controls are added to the dialog.
    (target.closest("dialog") ?? document.body).append(tip);
    tip.hidden = false;
    const box = target.getBoundingClientRect();
    const own = tip.getBoundingClientRect();
    const within = (at: number, size: number, all: number): number =>
        Math.max(8, Math.min(all - size - 8, at - size / 2));
    // A tip of the tool rail stands beside its tool, because below it would hide the next tools.
    const is_beside = target.closest(".rail") !== null;
    const below = box.bottom + 8 + own.height < innerHeight;
    const left = is_beside ? box.right + 8 : within(box.left + box.width / 2, own.width, innerWidth);
    const top = is_beside ? within(box.top + box.height / 2, own.height, innerHeight) :
        below             ? box.bottom + 8 :
                            box.top - own.height - 8;
    tip.style.left = `${left}px`;
    tip.style.top = `${top}px`;
  };
  // Where the pointer was pressed last. A press often puts another control under the pointer. The tip of that
  // control is not shown before the pointer moves.
  let pressed = "";
  const place = (event: Event): string =>
      event instanceof PointerEvent ? `${event.clientX},${event.clientY}` : "focus";
  const over = (event: Event): void => {
    hide();
    if (place(event) === pressed) return;
    const target = (event.target as Element).closest?.<HTMLElement>("[data-tip]");
    if (target) timer = window.setTimeout(() => show(target), 450);
  };
  document.addEventListener("pointerover", over);
  document.addEventListener("focusin", (event) => {
    if ((event.target as Element).matches(":focus-visible")) over(event);
  });
  document.addEventListener("pointerdown", (event) => {
    pressed = place(event);
    hide();
  });
  document.addEventListener("keydown", hide);
}
