// SPDX-License-Identifier: AGPL-3.0-or-later
// Dialogs about the plan: procedures placed by landmarks, export and print, the report, the audit, the
// screenshot.
import {add_step, busy, done, download, evaluate, file_url, free_id, take_plan, try_to} from "./actions";
import {Dialog, open_dialog} from "./dialog";
import {look_of, object_ids} from "./drawn_objects";
import {button, Child, el} from "./html";
import {icon} from "./icons";
import {all_panes} from "./pane_grid";
import {ask_for_landmarks} from "./point_tools";
import {PlanState, ProcedureSays} from "./protocol";
import {audit_rows, scan_facts} from "./start_page";
import {notify, state, step_of} from "./state";
import {Vec3} from "./vector";

const values: {[name: string]: number} = {};
let pending_procedure: string|null = null;

/// Chooses a procedure, has its landmarks placed, takes its values and adds its steps.
export function open_procedure(name?: string): void {
  const dialog = open_dialog("Procedure from landmarks", "procedure");
  const show = (chosen: ProcedureSays|undefined): void => dialog.refill(
      el("div", {class: "presets"},
         (state.hello?.procedures ??
          []).map((one) => button(one.name.replace(/_/g, " "), one.says, () => show(one), {
                    class: one === chosen ? "on" : ""
                  }))),
      chosen ?
          procedure_form(dialog, chosen) :
          el("p", {class: "says"},
             "Each procedure is placed by named landmarks and a few values. What it writes are ordinary steps that you can change."));
  show(state.hello?.procedures.find((one) => one.name === name));
}

function procedure_form(dialog: Dialog, chosen: ProcedureSays): Child {
  const placed = new Map((state.plan?.landmarks ?? []).map((mark) => [mark.name, mark.point]));
  const missing = chosen.landmarks.filter((mark) => !placed.has(mark.name));
  const place = (): void => {
    pending_procedure = chosen.name;
    dialog.close();
    ask_for_landmarks(chosen.landmarks);
  };
  const perform = async(): Promise<void> => {
    const landmarks: {[mark: string]: Vec3} = {};
    for (const mark of chosen.landmarks) landmarks[mark.name] = placed.get(mark.name)!;
    const set_values = Object.fromEntries(
        chosen.values.map((one) => [one.name, values[`${chosen.name}.${one.name}`] ?? one.default]));
    dialog.close();
    const plan = await try_to<PlanState>("procedure", {name: chosen.name, landmarks, values: set_values});
    if (plan) {
      take_plan(plan);
      void evaluate();
    }
  };
  return [
    el("p", {class: "says"}, chosen.says),
    el("ul", {class: "marks"},
       chosen.landmarks.map(
           (mark) =>
               el("li", {class: placed.has(mark.name) ? "placed" : ""},
                  el("b", {}, mark.name.replace(/_/g, " ")), ` ${mark.says}`))),
    missing.length ?
        el("div", {class: "row"},
           button(
               `Place ${missing.length} landmarks`, "Click them one after the other in the panes", place,
               {class: "primary"})) :
        [
          el("div", {class: "grid-2"},
             chosen.values.map(
                 (one) =>
                     el("label", {class: "field", "data-tip": `${one.says}. From ${one.low} to ${one.high}.`},
                        el("span", {}, one.name.replace(/_(mm|deg)$/, "").replace(/_/g, " ")), el("input", {
                          type: "number",
                          step: "any",
                          min: one.low,
                          max: one.high,
                          name: one.name,
                          value: values[`${chosen.name}.${one.name}`] ?? one.default,
                          onchange: (event: Event) => {
                            values[`${chosen.name}.${one.name}`] =
                                Number((event.target as HTMLInputElement).value);
                          }
                        }),
                        el("i", {},
                           one.unit ??
                               (one.name.endsWith("_mm")      ? "mm" :
                                    one.name.endsWith("_deg") ? "°" :
                                                                ""))))),
          el("div", {class: "row end"},
             button(
                 "Plan it", "Adds the procedure's steps to the plan", () => void perform(),
                 {class: "primary"})),
        ],
  ];
}
addEventListener("landmarks-placed", () => {
  if (pending_procedure) open_procedure(pending_procedure);
  pending_procedure = null;
});

const kinds: [string, string, string][] = [
  ["stl", "STL", "Surface for print"],
  ["ply", "PLY", "Surface with exact points"],
  ["obj", "OBJ", "Surface for modelling"],
  ["inp", "Abaqus, CalculiX", "Finite elements with sets and motion"],
  ["feb", "FEBio", "Finite elements"],
  ["vtu", "ParaView", "Finite elements to look at"],
  ["nrrd", "Label map", "Voxels"],
];

/// Export and print: which object, as what, as a file once or as a step that every run writes.
export function open_export(): void {
  const dialog = open_dialog("Export and print", "export");
  const objects = object_ids().filter((id) => step_of(id)?.do !== "mask");
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
  const answer = await try_to<{folder: string; file: string}>("report");
  done(job);
  if (!answer) return;
  const dialog = open_dialog("Report", "report");
  dialog.refill(
      el("iframe", {src: file_url(answer.file), title: "Report", sandbox: "allow-same-origin"}),
      el("div", {class: "row end"}, el("small", {class: "path"}, answer.folder),
         el("span", {class: "spring"}),
         button(
             [icon("export", 15), "Download"], "Downloads the report, one file that needs nothing else",
             () => download(answer.file)),
         el("a", {class: "button primary", href: file_url(answer.file), target: "_blank", rel: "noopener"},
            "Open in a tab to print")));
}

export function open_audit(): void {
  const dialog = open_dialog("The scan's audit", "audit-dialog");
  dialog.refill(
      (state.plan?.scans ?? []).map((scan) => [el("h3", {}, scan.name), audit_rows(scan), scan_facts(scan)]));
}

/// The panes as they are, in one PNG.
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
