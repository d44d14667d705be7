// SPDX-License-Identifier: AGPL-3.0-or-later
// Scans and plans from the opened folders, and files that are dropped on the page.
import {first_greeting, open_plan, token, try_to} from "../actions";
import {open_dialog} from "../base/dialog";
import {button, Child, el} from "../base/html";
import {icon} from "../base/icons";
import {notify, state} from "../state";

interface Entry {
  name: string;
  kind: string;  // folder, scan, plan, ...
  size?: number;
}

/// The folder picker: the server shows only folders that were opened with it. What is chosen is opened,
/// unless it is wanted for something else.
export function open_picker(
    title = "Open a scan or plan", take: (path: string) => void = (path) => void open_plan({path})): void {
  const dialog = open_dialog(title, "picker");
  const choose = (path: string): void => {
    dialog.close();
    take(path);
  };
  const show = async(folder: string): Promise<void> => {
    const folders = state.hello?.folders ?? [];
    const answer = await try_to<{entries: Entry[]}>("list", {folder});
    const entries = (answer?.entries ?? [])
                        .filter((entry) => entry.kind !== "other")
                        .sort(
                            (a, b) => Number(b.kind === "folder") - Number(a.kind === "folder") ||
                                a.name.localeCompare(b.name));
    const join = (name: string): string => `${folder.replace(/\/$/, "")}/${name}`;
    const parent = folder.replace(/\/[^/]+\/?$/, "");
    dialog.refill(
        el("div", {class: "presets"},
           folders.map(
               (one) =>
                   button(one, `Folder ${one}`, () => void show(one), {class: one === folder ? "on" : ""}))),
        folders.includes(folder) ? null : el("p", {class: "path"}, folder),
        el("div", {class: "files", role: "list"},
           folders.some((one) => folder !== one && folder.startsWith(one)) ?
               row("folder", "..", "", () => void show(parent)) :
               null,
           entries.map(
               (entry) => row(
                   entry.kind, entry.name, entry.size ? size_words(entry.size) : "",
                   () => (entry.kind === "folder" ? void show(join(entry.name)) : choose(join(entry.name))),
                   entry.kind === "folder" ? () => choose(join(entry.name)) : undefined)),
           entries.length ? null : el("p", {class: "says"}, "No scan or plan lies here.")));
  };
  void first_greeting().then(() => show(state.hello?.folders[0] ?? "."));
}

function row(kind: string, name: string, size: string, open: () => void, as_scan?: () => void): Child {
  return el(
      "div", {class: "file-row", role: "listitem"},
      el("button", {type: "button", class: "file", onclick: open},
         icon(
             kind === "folder"   ? "folder" :
                 kind === "plan" ? "report" :
                                   "file",
             16),
         el("span", {}, name), el("small", {}, size || kind)),
      as_scan ?
          button("Open as scan", "Reads the folder as a DICOM series", as_scan, {class: "ghost small"}) :
          null);
}
const size_words = (bytes: number): string =>
    (bytes > 1e6 ? `${(bytes / 1e6).toFixed(1)} MB` : `${Math.ceil(bytes / 1e3)} KB`);

/// Takes files that are dropped anywhere on the page.
export function take_drops(): void {
  addEventListener("dragover", (event) => {
    event.preventDefault();
    document.body.classList.add("dropping");
  });
  addEventListener("dragleave", (event) => {
    if (!event.relatedTarget) document.body.classList.remove("dropping");
  });
  addEventListener("drop", (event) => {
    event.preventDefault();
    document.body.classList.remove("dropping");
    const file = event.dataTransfer?.files[0];
    if (file) void upload(file);
  });
}

export async function upload(file: File): Promise<void> {
  notify(`Reading ${file.name} …`);
  const answer = await fetch(
      `/upload?token=${encodeURIComponent(token())}&name=${encodeURIComponent(file.name)}`,
      {method: "POST", body: file});
  if (!answer.ok) return notify(`${file.name} was refused: ${(await answer.text()).slice(0, 200)}`, "error");
  const {path} = (await answer.json()) as {path: string};
  await open_plan({path});
}
