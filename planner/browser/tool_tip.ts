// SPDX-License-Identifier: AGPL-3.0-or-later
// Tool tips: every element with `data-tip` tells what it is for, on hover and on keyboard focus.
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
    // A dialog is above everything else, so its tips stand within it.
    (target.closest("dialog") ?? document.body).append(tip);
    tip.hidden = false;
    const box = target.getBoundingClientRect();
    const own = tip.getBoundingClientRect();
    const left = Math.max(8, Math.min(innerWidth - own.width - 8, box.left + box.width / 2 - own.width / 2));
    const below = box.bottom + 8 + own.height < innerHeight;
    tip.style.left = `${left}px`;
    tip.style.top = `${below ? box.bottom + 8 : box.top - own.height - 8}px`;
  };
  const over = (event: Event): void => {
    hide();
    const target = (event.target as Element).closest?.<HTMLElement>("[data-tip]");
    if (target) timer = window.setTimeout(() => show(target), 450);
  };
  document.addEventListener("pointerover", over);
  document.addEventListener("focusin", (event) => {
    if ((event.target as Element).matches(":focus-visible")) over(event);
  });
  document.addEventListener("pointerdown", hide);
  document.addEventListener("keydown", hide);
}
