// SPDX-License-Identifier: AGPL-3.0-or-later
// Dialogs about the plan: export and print, the report, the audit, the screenshot.
import {add_step, busy, done, download, evaluate, file_url, free_id, try_to} from "../actions";
import {open_dialog} from "../base/dialog";
import {look_of, object_ids} from "../drawn_objects";
import {button, el} from "../base/html";
import {icon} from "../base/icons";
import {makes_body} from "../operations";
import {all_panes} from "../pane/pane_grid";
import {audit_rows} from "../panel/audit";
import {doubtful_places} from "../panel/doubtful_places";
import {scan_facts} from "./start_page";
import {notify, state, step_of} from "../state";

const kinds: [string, string, string][] = [
  ["stl", "STL", "Surface for print"],
  ["ply", "PLY", "Surface with exact points"],
  ["obj", "OBJ", "Surface for modelling"],
  ["inp", "Abaqus, CalculiX", "Finite elements with sets and motion"],
  ["feb", "FEBio", "Finite elements"],
  ["vtu", "ParaView", "Finite elements to look at"],
  ["nrrd", "Label map", "Voxels"],
];

/// Opens the dialog in which the person chooses an object, a format, and whether to write the file once or to
/// add a step that writes it in every run.
export function open_export(): void {
  const dialog = open_dialog("Export and print", "export");
  const objects = object_ids().filter((id) => makes_body(step_of(id)));
  let object = state.selected && objects.includes(state.selected) ?
      state.selected :
      objects.filter((id) => look_of(id).visible).pop() ?? objects[0] ?? "";
  let kind = "stl";
  let is_step = false;
  const written: string[] = [];
  const again =
      ():
          void =>
              dialog.refill(
                  el("label", {class: "field"}, el("span", {}, "Object"),
                     el("select", {
                       name: "object",
                       onchange: (event: Event) => {
                         object = (event.target as HTMLSelectElement).value;
                         again();
                       }
                     },
                        objects.map(
                            (id) =>
                                el("option", {value: id, selected: id === object}, id.replace(/_/g, " "))))),
                  el("div", {class: "kinds", role: "radiogroup", "aria-label": "Kind of file"},
                     kinds.map(
                         ([ending, label, says]) =>
                             el(
                                 "button", {
                                   type: "button",
                                   role: "radio",
                                   "aria-checked": String(ending === kind),
                                   class: ending === kind ? "on" : "",
                                   "data-kind": ending,
                                   onclick: () => {
                                     kind = ending;
                                     again();
                                   }
                                 },
                                 el("b", {}, label), el("small", {}, `.${ending} · ${says}`)))),
                  el("label",
                     {class: "check", "data-tip": "The step writes the file again in every run of the plan."},
                     el("input", {
                       type: "checkbox",
                       checked: is_step,
                       onchange: (event: Event) => {
                         is_step = (event.target as HTMLInputElement).checked;
                       }
                     }),
                     "Also add it to the plan"),
                  el("div", {class: "row end"},
                     button(
                         [icon("export", 15), "Write the file"], "Writes and downloads the file",
                         () => void write(), {class: "primary"})),
                  written.length ?
                      el("ul", {class: "written"},
                         written.map(
                             (name) => el("li", {}, el("a", {href: file_url(name), download: name}, name)))) :
                      null);
  const write = async(): Promise<void> => {
    const path = `${object}.${kind}`;
    const job = busy(`Exporting ${path}`);
    const answer = await try_to<{file: string}>("export", {object, path});
    done(job);
    if (!answer) return;
    written.push(answer.file);
    download(answer.file);
    if (is_step)
      await add_step({id: free_id(`${object}_${kind}`), do: "export", object, path}, `export ${path}`);
    again();
  };
  again();
}

export async function write_report(): Promise<void> {
  const job = busy("Writing the report");
  const answer = await try_to<{folder: string; file: string; left_out: string[]}>(
      "report", {anonymous: state.hides_patient});
  done(job);
  if (!answer) return;
  if (answer.left_out.length)
    notify(`The report lacks the parts that failed: ${answer.left_out.join(", ")}. Its findings state the reasons.`, "warning");
  void evaluate(true);  // the report has certified every object, so the badges can be updated
  // In the sandbox the report's script has another origin than this page, so that it cannot access the page.
  const frame = el("iframe", {src: file_url(answer.file), title: "Report", sandbox: "allow-scripts"});
  const follow = (event: MessageEvent): void => {
    if (event.source === frame.contentWindow && event.data === "Escape") dialog.close();
  };
  const dialog = open_dialog("Report", "report", () => removeEventListener("message", follow));
  addEventListener("message", follow);
  dialog.refill(
      frame,
      el("div", {class: "row end"}, el("small", {class: "path"}, answer.folder),
         el("span", {class: "spring"}),
         button(
             [icon("export", 15), "Download"], "Downloads the report: one file that needs no other",
             () => download(answer.file)),
         el("a", {class: "button primary", href: file_url(answer.file), target: "_blank", rel: "noopener"},
            "Open in a tab to print")));
}

export function open_audit(): void {
  const dialog = open_dialog("The scan's audit", "audit-dialog");
  dialog.refill(
      (state.plan?.scans ?? []).map((scan) => [
        el("h3", {}, scan.name), doubtful_places(scan.name, dialog.close), audit_rows(scan.audit), scan_facts(scan)
      ]));
}

/// Shows the link for a colleague. A page opened with it follows the plan and cannot change it.
export function open_link(): void {
  const dialog = open_dialog("A link to look at this plan", "link-dialog");
  const given = state.hello?.view_token;
  if (!given)
    return dialog.refill(el(
        "p", {class: "says"}, "This program was started without such a link. End it, and start it with ",
        el("code", {class: "path"}, "octotomy serve --share"), "."));
  const link = `${location.origin}/?token=${given}`;
  const field = el("input", {value: link, readOnly: true, "aria-label": "Link", name: "link"});
  dialog.refill(
      el("p", {class: "says"},
         "Whoever opens this link sees the open plan with its patient, follows every change, and can change nothing. " +
             "It ends when the program ends."),
      field,
      el("div", {class: "row end"}, button([icon("copy", 15), "Copy"], "Copies the link", () => {
           field.select();
           void navigator.clipboard.writeText(link).then(() => notify("The link is on the clipboard."), () => undefined);
         }, {class: "primary"})));
}

/// Downloads one PNG of all panes as they are shown.
export function take_screenshot(): void {
  const shown = all_panes().filter((pane) => pane.canvas.clientWidth);
  const boxes = shown.map((pane) => pane.canvas.getBoundingClientRect());
  const left = Math.min(...boxes.map((box) => box.left));
  const top = Math.min(...boxes.map((box) => box.top));
  const ratio = shown[0]?.ratio ?? 1;
  const canvas = document.createElement("canvas");
  canvas.width = (Math.max(...boxes.map((box) => box.right)) - left) * ratio;
  canvas.height = (Math.max(...boxes.map((box) => box.bottom)) - top) * ratio;
  const context = canvas.getContext("2d");
  shown.forEach(
      (pane, i) =>
          context?.drawImage(pane.canvas, (boxes[i]!.left - left) * ratio, (boxes[i]!.top - top) * ratio));
  canvas.toBlob((blob) => {
    if (!blob) return;
    const link = el("a", {href: URL.createObjectURL(blob), download: `${state.plan?.name ?? "plan"}.png`});
    link.click();
    URL.revokeObjectURL(link.href);
    notify("The screenshot is in your downloads.");
  });
}
