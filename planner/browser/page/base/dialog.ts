// SPDX-License-Identifier: AGPL-3.0-or-later
// Dialogs over the page, and a question for one line of text.
import {button, Child, el, fill} from "./html";
import {icon} from "./icons";

export interface Dialog {
  refill(...children: Child[]): void;
  close(): void;
}

/// Opens a modal dialog. Escape, its cross, a press beside it and close() end it; `closed` is called then.
export function open_dialog(title: string, name: string, closed: () => void = () => undefined): Dialog {
  const body = el("div", {class: "dialog-body"});
  const box = el("dialog", {class: `dialog ${name}`, "aria-label": title});
  const close = (): void => box.close();
  box.append(
      el("header", {}, el("h2", {}, title),
         button(icon("close", 16), "Close", close, {class: "ghost small"})),
      body);
  box.addEventListener("close", () => {
    box.remove();
    closed();
  });
  box.addEventListener("pointerdown", (event) => {
    if (event.target === box) close();
  });
  document.body.append(box);
  box.showModal();
  const refill = (...children: Child[]): void => {
    fill(body, ...children);
    // Where it has no control, the body itself takes the keys that scroll it.
    body.tabIndex = body.querySelector("button, a, input, select, textarea, summary, [tabindex]") ? -1 : 0;
  };
  return {refill, close};
}

/// Opens a dialog with a field for one line of text, which contains `usual` at first. Resolves with the
/// trimmed text, or with null if it is empty or the person closes the dialog.
export function ask_text(title: string, label: string, usual: string): Promise<string|null> {
  return new Promise((resolve) => {
    let answer: string|null = null;
    const dialog = open_dialog(title, "ask", () => resolve(answer));
    const field = el("input", {value: usual, name: "answer"});
    const form =
        el("form", {
          onsubmit: (event: Event) => {
            event.preventDefault();
            answer = field.value.trim() || null;
            dialog.close();
          },
        },
           el("label", {class: "field"}, el("span", {}, label), field),
           el("div", {class: "row end"}, el("button", {type: "submit", class: "primary"}, "OK")));
    dialog.refill(form);
    field.select();
  });
}
