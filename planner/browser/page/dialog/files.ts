// SPDX-License-Identifier: AGPL-3.0-or-later
// Scans and plans from the opened folders, and files that are dropped on the page.
import {busy, done, first_greeting, open_plan, token, try_to} from "../actions";
import {open_dialog} from "../base/dialog";
import {button, Child, el} from "../base/html";
import {icon} from "../base/icons";
import {may_edit, notify, set, state} from "../state";

interface Entry {
  name: string;
  kind: string;  // folder, scan, plan, ...
  size?: number;
}

/// Names of files that are read alone: whole scans, objects and meshes. Any other file may be one image of a
/// series.
const whole_files = /\.(nii|nii\.gz|nrrd|nhdr|mha|mhd|raw|octree|stl|ply|obj|off|vtp|vtk|glb)$/i;

/// Opens the folder picker. The server lists only the folders that are open to the page. The chosen path goes
/// to `take`, which opens it by default.
export function open_picker(
    title = "Open a scan or plan", take: (path: string) => void = (path) => void open_found(path)): void {
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
        el("div", {class: "row"}, folders.includes(folder) ? null : el("p", {class: "path"}, folder),
           entries.some((entry) => entry.kind === "file" && !whole_files.test(entry.name)) ?
               button(
                   "Open this folder as scan", "Reads all images of the folder as a DICOM series",
                   () => choose(folder), {class: "small"}) :
               null),
        el("div", {class: "files", role: "list"},
           folders.some((one) => folder.startsWith(`${one.replace(/\/$/, "")}/`)) ?
               row("folder", "..", "", () => void show(parent)) :
               null,
           entries.map(
               (entry) => row(
                   entry.kind, entry.name, entry.size ? size_words(entry.size) : "",
                   () => (entry.kind === "folder" ? void show(join(entry.name)) : choose(join(entry.name))),
                   entry.kind === "folder" ? () => choose(join(entry.name)) : undefined)),
           entries.length ? null : el("p", {class: "says"}, "This folder has no scan or plan.")));
  };
  void first_greeting().then(() => show(state.hello?.folders[0] ?? "."));
}

interface Series {
  choice: string;
  name: string;
  stack: string;
  number: number;
  modality: string;
  slices: number;
  size: [number, number];
  spacing_mm: [number, number, number|null];
  study_date: string;
}

/// Opens a plan or a scan. If the path is a folder with several DICOM series, the person picks one.
async function open_found(path: string): Promise<void> {
  const key = busy("Looking for series");
  const answer = await try_to<{series: Series[]}>("series", {path});
  done(key);
  if (!answer) return;
  const {series} = answer;
  if (series.length < 2) return open_plan({path});
  const dialog = open_dialog(`Which of ${series.length} series?`, "picker");
  dialog.refill(
      el("p", {class: "says"}, "This folder holds several DICOM series. A plan uses one of them."),
      el("div", {class: "files", role: "list"},
         series.map(
             (one) => el(
                 "div", {class: "file-row", role: "listitem"},
                 el("button", {
                   type: "button",
                   class: "file series",
                   onclick: () => {
                     dialog.close();
                     void open_plan({path, series: one.choice});
                   }
                 },
                    icon("file", 16),
                    el("span", {}, [one.name || `Series ${one.number}`, one.stack].filter(Boolean).join(", ")),
                    el("small", {}, series_words(one)))))));
}
/// One line about a series, such as "CT · 90 slices of 512 × 512 · 0.98 × 0.98 × 3.00 mm · 1998-01-31".
function series_words({modality, slices, size, spacing_mm, study_date}: Series): string {
  const spacing = spacing_mm.filter((mm): mm is number => mm !== null).map((mm) => mm.toFixed(2)).join(" × ");
  const date = study_date.replace(/^(\d{4})(\d\d)(\d\d)$/, "$1-$2-$3");
  return [
    modality, `${slices} ${slices === 1 ? "slice" : "slices"} of ${size.join(" × ")}`, `${spacing} mm`,
    date || "no date"
  ].join(" · ");
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
const size_words = (bytes: number): string => bytes >= 2 ** 30 ?
    `${+(bytes / 2 ** 30).toFixed(1)} GB` :
    (bytes > 1e6 ? `${(bytes / 1e6).toFixed(1)} MB` : `${Math.ceil(bytes / 1e3)} KB`);

/// A dropped or chosen file. The path begins with the dropped folder.
interface Given {
  file: File;
  path: string;  // "series/IM0001"
}

/// Lets the person drop files and folders anywhere on the page, and sends them to the server.
export function take_drops(): void {
  // Whether files are dragged: rows of the page's own lists can be dragged, too.
  const has_files = (event: DragEvent): boolean => event.dataTransfer?.types.includes("Files") === true;
  addEventListener("dragover", (event) => {
    if (!has_files(event)) return;
    event.preventDefault();
    document.body.classList.add("dropping");
  });
  addEventListener("dragleave", (event) => {
    if (!event.relatedTarget) document.body.classList.remove("dropping");
  });
  addEventListener("drop", (event) => {
    if (!has_files(event)) return;
    event.preventDefault();
    document.body.classList.remove("dropping");
    if (!may_edit()) return notify("This window only shows the plan.", "warning");
    // Entries and files are read now, because the browser empties the list of items when the event ends.
    const items = [...event.dataTransfer?.items ?? []].filter((item) => item.kind === "file").map((item) => {
      return {entry: item.webkitGetAsEntry(), file: item.getAsFile()};
    });
    void Promise
        .all(items.map(
            ({entry, file}) => entry ? given_below(entry) :
                file                 ? [{file, path: file.name}] :
                                       []))
        .then((all) => send(all.flat()))
        .catch((error: unknown) => notify(`The dropped files cannot be read: ${String(error)}`, "error"));
  });
}

async function given_below(entry: FileSystemEntry): Promise<Given[]> {
  if (entry.isFile) {
    const file = await new Promise<File>((take, fail) => (entry as FileSystemFileEntry).file(take, fail));
    return [{file, path: entry.fullPath.replace(/^\//, "")}];
  }
  const reader = (entry as FileSystemDirectoryEntry).createReader();
  const found: Given[] = [];
  // readEntries() returns the entries in parts; an empty part marks the end.
  for (;;) {
    const part = await new Promise<FileSystemEntry[]>((take, fail) => reader.readEntries(take, fail));
    if (!part.length) return found;
    for (const inner of part) found.push(...await given_below(inner));
  }
}

/// A button with which the person chooses files, or a folder with everything below it.
export function file_chooser(label: string, tip: string, is_folder: boolean): Child {
  const picker: HTMLInputElement = el("input", {
    type: "file",
    hidden: true,
    multiple: true,
    "aria-label": label,
    ...(is_folder ? {webkitdirectory: ""} : {}),
    onchange: () =>
        void send([...picker.files ?? []].map((file) => ({file, path: file.webkitRelativePath || file.name})))
  });
  return [button(label, tip, () => picker.click()), picker];
}

/// The largest file that a page may send, in words.
export const most_upload_words = (): string => size_words(most_upload_bytes());
const most_upload_bytes = (): number => state.hello?.most_upload_bytes ?? 4 * 2 ** 30;
const most_files = 20000;
const sent_at_once = 4;

/// Sends files to the server, which stores them in its folder "uploads". Then opens a single file as a plan
/// or a scan, or the folder of several files as a series.
export async function send(given: Given[]): Promise<void> {
  const files = given.filter(({path}) => !/(^|\/)(\.|DICOMDIR$|Thumbs\.db$)/i.test(path));
  const bytes = files.reduce((sum, {file}) => sum + file.size, 0);
  if (!files.length) return notify("No file was dropped: drop files or a folder.", "warning");
  if (files.length > most_files)
    return notify(
        `These are ${files.length} files; at most ${
            most_files} can be sent. Start the program with the folder instead: octotomy serve FOLDER`,
        "error");
  if (bytes > most_upload_bytes())
    return notify(
        `These files have ${size_words(bytes)}; at most ${
            most_upload_words()} can be sent. Start the program with the folder instead: octotomy serve FOLDER`,
        "error");
  const folder = files.length === 1 ? "" : `${folder_name(files)}/`;
  const names = sent_names(files);
  const key = busy(`Sending ${files.length === 1 ? names[0] : `${files.length} files`}`);
  try {
    const paths: string[] = [];
    let sent_bytes = 0;
    const waiting = files.map(({file}, index) => ({file, index}));
    const send_next = async(): Promise<void> => {
      for (let one = waiting.shift(); one; one = waiting.shift()) {
        paths[one.index] = await send_file(one.file, folder + names[one.index]!);
        sent_bytes += one.file.size;
        set({
          jobs: state.jobs.map((job) => (job.id === key ? {...job, share: sent_bytes / (bytes || 1)} : job))
        });
      }
    };
    await Promise.all(Array.from({length: sent_at_once}, send_next));
    const header = paths.find((path) => /\.(nhdr|mhd|hdr)$/i.test(path));
    await open_found(header ?? (folder ? paths[0]!.replace(/\/[^/]*$/, "") : paths[0]!));
  } catch (error) {
    notify(error instanceof Error ? error.message : String(error), "error");
  } finally {
    done(key);
  }
}

/// Name of a folder for files that are sent together. It contains the date and the time to the second, so
/// that a repetition is unlikely.
function folder_name(files: Given[]): string {
  const top = files[0]!.path.includes("/") ? files[0]!.path.split("/")[0]! : "series";
  const time = new Date().toISOString().slice(0, 19).replace(/[-:]/g, "").replace("T", "-");
  return `${top.replace(/[^\w-]+/g, "_").slice(0, 60)}-${time}`;
}

/// Names for files of several folders in one folder: their own names, or all with their number in front if
/// two are equal.
function sent_names(files: Given[]): string[] {
  const own = files.map(({file}) => file.name);
  return new Set(own).size === own.length ?
      own :
      own.map((name, index) => `${String(index + 1).padStart(5, "0")}-${name}`);
}

async function send_file(file: File, name: string): Promise<string> {
  const answer = await fetch(
      `/upload?token=${encodeURIComponent(token())}&name=${encodeURIComponent(name)}`,
      {method: "POST", body: file});
  if (!answer.ok) throw new Error(`${file.name} was refused: ${(await answer.text()).slice(0, 200)}`);
  return ((await answer.json()) as {path: string}).path;
}
