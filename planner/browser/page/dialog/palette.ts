// SPDX-License-Identifier: AGPL-3.0-or-later
// The command palette (Ctrl K) and the page of keys (?), both made from the table of commands.
import {all_commands, Command} from "../commands";
import {open_dialog} from "../base/dialog";
import {Child, el, fill} from "../base/html";

export function open_palette(): void {
  const dialog = open_dialog("Commands", "palette");
  const commands = all_commands();
  let chosen = 0;
  let found: Command[] = commands;
  const list = el("div", {class: "palette-list", role: "listbox", id: "palette-list", "aria-label": "Commands", tabindex: 0});
  const run = (command: Command|undefined): void => {
    dialog.close();
    command?.run();
  };
  const again = (): void => {
    fill(
        list,
        found.slice(0, 40).map(
            (command, index) =>
                el("div", {
                  role: "option",
                  class: index === chosen ? "chosen" : "",
                  "aria-selected": String(index === chosen),
                  onclick: () => run(command)
                },
                   el("span", {}, command.name, command.says ? el("small", {}, command.says) : null),
                   command.key ? key_cap(command.key) : null)));
    list.querySelector(".chosen")?.scrollIntoView({block: "nearest"});
  };
  const field = el("input", {
    class: "palette-field",
    placeholder: "What do you want to do?",
    "aria-label": "Search commands",
    "aria-controls": "palette-list",
    oninput: () => {
      const words = field.value.toLowerCase().split(/\s+/).filter(Boolean);
      const score = (command: Command): number => {
        const name = command.name.toLowerCase();
        if (words.every((word) => name.includes(word))) return name.startsWith(words[0] ?? "") ? 2 : 1;
        return words.every((word) => `${name} ${command.says?.toLowerCase() ?? ""}`.includes(word)) ? 0.5 : 0;
      };
      found = words.length ?
          commands.filter((command) => score(command) > 0).sort((a, b) => score(b) - score(a)) :
          commands;
      chosen = 0;
      again();
    },
    onkeydown: (event: KeyboardEvent) => {
      if (event.key === "ArrowDown")
        chosen = Math.min(found.length - 1, 39, chosen + 1);
      else if (event.key === "ArrowUp")
        chosen = Math.max(0, chosen - 1);
      else if (event.key !== "Enter")
        return;
      // Without this, Enter would also press a button of the dialog that the command opens.
      event.preventDefault();
      if (event.key === "Enter") return run(found[chosen]);
      again();
    },
  });
  dialog.refill(field, list);
  again();
  field.focus();
}

const key_words: {[key: string]: string} = {
  ctrl: "Ctrl",
  shift: "Shift",
  enter: "Enter"
};
export const key_cap = (key: string): Child =>
    el("span", {class: "keys"},
       key.split("+").map((part) => el("kbd", {}, key_words[part] ?? part.toUpperCase())));

export function open_help(): void {
  const dialog = open_dialog("Keys and help", "help");
  const row = (key: string, words: string): Child => el("tr", {}, el("td", {}, key), el("td", {}, words));
  dialog.refill(el(
      "div", {class: "columns"},
      el("section", {}, el("h3", {}, "In a view"),
         el("table", {}, row("Drag", "turn"), row("Shift drag, middle button", "move the picture"),
            row("Wheel, Ctrl drag", "zoom"), row("Click", "cross-hair to the surface, select the object"),
            row("Double click", "enlarge the pane"), row("Arrow keys", "turn by 5°, with Shift by 15°"),
            row("Arrow keys, with a tool for positions", "move a position, with Shift in small steps; Space clicks there"))),
      el("section", {}, el("h3", {}, "In a slice"),
         el("table", {}, row("Drag", "move the cross-hair"), row("Wheel, Page Up, Page Down", "next slice"),
            row("Right drag", "level and width of the greys"), row("Ctrl wheel", "zoom"))),
      el("section", {}, el("h3", {}, "While moving a piece (G)"),
         el("table", {}, row("W S", "up and down by 0.5 mm"), row("A D", "to the patient's right and left"),
            row("F B", "forward and back"))),
      el("section", {}, el("h3", {}, "Commands"),
         el("table", {},
            all_commands()
                .filter((command) => command.key)
                .map(
                    (command) =>
                        el("tr", {}, el("td", {}, key_cap(command.key!)), el("td", {}, command.name))))),
      el("section", {}, el("h3", {}, "Certificates"),
         el("p", {},
            "Two kernels compute every object: one counts voxels, one measures triangles. A green badge means that they agree within the resolution of the scan, amber that they agree with a warning, red that they disagree. Click a badge to see the place."),
         el("p", {}, "Not a medical device. Nothing leaves this machine."))));
  // The help scrolls. With a tab index it can have the focus, so that keys scroll it.
  document.querySelector<HTMLElement>("dialog.help .dialog-body")!.tabIndex = 0;
}
