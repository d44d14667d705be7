// SPDX-License-Identifier: AGPL-3.0-or-later
// The right column: the tool in hand and the selected step, the plan's numbers with their certificates, and
// how far each piece and landmark moves.
import {add_step, replace_step, try_to} from "./actions";
import {badge, measured_text} from "./certificate_badge";
import {certify_all} from "./commands";
import {is_overlap, is_piece, makes_shape, object_ids} from "./drawn_objects";
import {button, Child, el, fill} from "./html";
import {icon, is_icon} from "./icons";
import {movement_fields} from "./move_tool";
import {Json, Measurement, Step} from "./protocol";
import {step_form} from "./schema_form";
import {selected_step, set, state, step_of, steps, watch} from "./state";
import {step_words} from "./step_lists";
import {active_tool, take_tool} from "./tool";

export function make_inspector(host: HTMLElement): void {
  const tabs = el("div", {class: "tabs", role: "tablist"});
  const body = el("div", {class: "panel-body", role: "tabpanel"});
  host.append(tabs, body);
  const again = (): void => {
    if (!state.plan) return fill(body);
    const tab = (name: typeof state.right_tab, label: string, tip: string): Child =>
        button(label, tip, () => set({right_tab: name}), {
          role: "tab",
          "aria-selected": String(state.right_tab === name),
          class: state.right_tab === name ? "on" : ""
        });
    fill(
        tabs, tab("inspector", "Inspector", "Inspector: the tool in hand and the selected step"),
        tab("numbers", "Numbers", "Numbers: volumes and measurements with their certificates"),
        tab("movement", "Movement", "Movement: how far each piece and landmark moves"));
    fill(
        body,
        state.right_tab === "numbers"      ? numbers() :
            state.right_tab === "movement" ? movement() :
                                             inspector());
  };
  watch(
      [
        "plan", "selected", "right_tab", "tool", "draft_window", "draft_step", "preview", "overlap_mm3",
        "compare", "cut_plane", "arch_mm"
      ],
      again);
  watch(["plan", "right_tab"], () => void fetch_movement());
}

function inspector(): Child {
  const draft = state.draft_step;
  if (draft)
    return el(
        "section", {class: "card"}, el("h3", {}, `New step: ${draft.do.replace(/_/g, " ")}`),
        el("label", {class: "field"}, el("span", {}, "name"), el("input", {
             value: draft.id,
             "data-key": "draft-id",
             onchange: (event: Event) =>
                 set({draft_step: {...draft, id: (event.target as HTMLInputElement).value}})
           })),
        step_form(draft, (step) => set({draft_step: step})),
        el("div", {class: "row"},
           button(
               "Add step", "Adds the step to the plan",
               () => void add_step(draft, draft.do.replace(/_/g, " ")).then((ok) => {
                 if (ok) set({draft_step: null});
               }),
               {class: "primary"}),
           button("Cancel", "Adds nothing", () => set({draft_step: null}))));
  const step = selected_step();
  const motion =
      step?.do === "move" || state.tool === "move" || (step && is_piece(step)) ? movement_fields() : null;
  return [
    tool_card(), state.cut_plane ? cut_plane_card() : null, state.compare ? compare_card() : null, motion,
    step ? step_card(step, motion !== null && step.do === "move") : hint()
  ];
}

const hint = (): Child => (
    state.tool === "navigate" ? el("p", {class: "says empty"},
                                   "Select a step on the left, or take a tool. Ctrl K finds every command.") :
                                null);

function tool_card(): Child {
  const tool = active_tool();
  if (!tool || tool.name === "navigate") return null;
  return el(
      "section", {class: "card tool-card"},
      el("h3", {}, is_icon(tool.name) ? icon(tool.name, 16) : null, tool.title, el("span", {class: "spring"}),
         button(icon("close", 14), "Put the tool away", () => take_tool("navigate"), {class: "ghost small"})),
      el("p", {class: "says"}, tool.says), tool.panel?.() ?? null);
}

function step_card(step: Step, has_motion: boolean): Child {
  const object = state.plan?.objects.find((one) => one.id === step.id);
  const certificate = object?.certificate;
  const is_number = step.do === "measure";
  const found = is_number ? state.plan?.measurements?.find((one) => one.id === step.id) : undefined;
  return el(
      "section", {class: "card"},
      el("h3", {}, step.id.replace(/_/g, " "), el("small", {}, step.do.replace(/_/g, " ")),
         el("span", {class: "spring"}),
         makes_shape(step) && step.do !== "mask" ? badge(step.id, certificate) : null),
      object?.error ? el("p", {class: "error"}, object.error) : null,
      object?.volume ? el("p", {class: "reading"}, el("b", {}, measured_text(object.volume)),
                          object.area ? `  ·  ${measured_text(object.area)}` : "") :
                                        null,
      found ? el("p", {class: "reading"}, el("b", {}, measured_text(found))) : null,
      certificate ? el("p", {class: `sentence ${certificate.verdict.toLowerCase()}`}, certificate.sentence) :
                    null,
      step_form(
          step, (next) => void replace_step(step.id, next, `${step.id} changed`),
          has_motion ? ["by", "turn"] : []));
}

function cut_plane_card(): Child {
  const cut = state.cut_plane!;
  const bounds = state.plan?.scans[0]?.bounds_mm;
  const names = ["Sagittal", "Coronal", "Axial"];
  return el(
      "section", {class: "card"},
      el("h3", {}, icon("plane", 16), "Cut plane", el("span", {class: "spring"}),
         button(
             icon("close", 14), "Take the cut plane away", () => set({cut_plane: null}),
             {class: "ghost small"})),
      el("div", {class: "presets"},
         names.map(
             (name, axis) => button(
                 name, `${name} plane`,
                 () => set({
                   cut_plane: {...cut, axis: axis as 0 | 1 | 2, offset_mm: state.cross_mm[axis as 0 | 1 | 2]}
                 }),
                 {class: cut.axis === axis ? "on" : ""})),
         button(
             "Other side", "Takes away the other side",
             () => set({cut_plane: {...cut, side: cut.side === 1 ? -1 : 1}}))),
      el("label", {class: "slider"}, el("span", {}, "At"), el("input", {
           type: "range",
           "data-key": "cut-range",
           "aria-label": "Place of the cut plane",
           min: bounds?.[0][cut.axis] ?? -150,
           max: bounds?.[1][cut.axis] ?? 150,
           step: 0.5,
           value: cut.offset_mm,
           oninput: (event: Event) =>
               set({cut_plane: {...cut, offset_mm: Number((event.target as HTMLInputElement).value)}})
         }),
         el("output", {}, `${cut.offset_mm.toFixed(1)} mm`)));
}

function compare_card(): Child {
  const compare = state.compare!;
  const choose = (field: "object"|"reference", label: string): Child =>
      el("label", {class: "field"}, el("span", {}, label),
         el("select", {
           "data-key": `compare-${field}`,
           onchange: (event: Event) =>
               set({compare: {...compare, [field]: (event.target as HTMLSelectElement).value}})
         },
            object_ids().map(
                (id) => el("option", {value: id, selected: id === compare[field]}, id.replace(/_/g, " ")))));
  return el(
      "section", {class: "card"},
      el("h3", {}, icon("compare", 16), "Compare", el("span", {class: "spring"}),
         button(
             icon("close", 14), "Back to the objects' own colours", () => set({compare: null}),
             {class: "ghost small"})),
      el("p", {class: "says"},
         "Colours each surface point of the first object by its distance to the nearest of the second: orange outside of it, blue inside."),
      choose("object", "Object"), choose("reference", "Compared with"),
      el("label", {class: "field"}, el("span", {}, "Last colours at"), el("input", {
           type: "number",
           min: 0.5,
           step: 0.5,
           value: compare.range_mm,
           "data-key": "compare-range",
           onchange: (event: Event) => set({
             compare: {...compare, range_mm: Math.max(0.1, Number((event.target as HTMLInputElement).value))}
           })
         }),
         el("i", {}, "mm")),
      button(
          "Measure both ways", "Adds a step that measures the distances with their definition",
          () =>
              void add_step(
                  {
                    id: `${compare.object}_to_${compare.reference}`,
                    do: "compare",
                    a: compare.object,
                    b: compare.reference
                  },
                  `compare ${compare.object} with ${compare.reference}`)));
}

function numbers(): Child {
  const all = steps();
  const objects =
      (state.plan?.objects ?? []).filter((object) => step_of(object.id) && step_of(object.id)?.do !== "mask");
  const measurements = state.plan?.measurements ?? [];
  const counts = {PASS: 0, WARN: 0, FAIL: 0};
  for (const object of objects)
    if (object.certificate) counts[object.certificate.verdict]++;
  const certified = counts.PASS + counts.WARN + counts.FAIL;
  return [
    el("section", {class: "card"},
       el("h3", {}, "Certificates", el("span", {class: "spring"}),
          button(
              [icon("certify", 15), "Certify"], "Certify. Asks both kernels and compares their answers",
              () => void certify_all(), {class: "primary"})),
       el("p", {class: "says"},
          certified ? `${counts.PASS} agree, ${counts.WARN} in doubt, ${counts.FAIL} disagree; ${
                          objects.length - certified} not asked.` :
                      "No number is certified yet.")),
    el("table", {class: "numbers"}, el("caption", {}, "Objects"), el("tbody", {}, objects.map((object) => {
         const step = step_of(object.id)!;
         return el(
             "tr", {
               class: state.selected === object.id ? "selected" : "",
               onclick: () => set({selected: object.id})
             },
             el("th", {scope: "row"}, object.id.replace(/_/g, " "),
                is_overlap(step, all) ? el("small", {}, " overlap") : null),
             el("td", {}, el("div", {}, measured_text(object.volume)),
                object.area ? el("small", {}, measured_text(object.area)) : null),
             el("td", {class: "badge-cell"}, badge(object.id, object.certificate)));
       }))),
    el("table", {class: "numbers"}, el("caption", {}, "Measurements"),
       el("tbody", {},
          measurements.length ?
              measurements.map(measurement_row) :
              el("tr", {}, el("td", {class: "says"}, "Measure with the distance (D) and angle (A) tools.")))),
  ];
}

function measurement_row(found: Measurement): Child {
  const step = step_of(found.id);
  const object = typeof step?.object === "string" ?
      state.plan?.objects.find((one) => one.id === step.object) :
      undefined;
  return el(
      "tr", {
        class: state.selected === found.id ? "selected" : "",
        onclick: () => set({selected: found.id}),
        "data-tip": found.sentence ?? found.says ?? (step ? step_words(step) : "")
      },
      el("th", {scope: "row"}, found.id.replace(/_/g, " "),
         el("small", {}, ` ${found.says ?? (step ? step_words(step) : "")}`)),
      el("td", {}, measured_text(found)),
      el("td", {class: "badge-cell"}, badge(found.id, object?.certificate)));
}

interface MovementRow {
  name?: string;
  says?: string;
  [field: string]: Json|undefined;
}
const movements = new Map<string, MovementRow[]>();
let fetched_edit = -1;

async function fetch_movement(): Promise<void> {
  const plan = state.plan;
  if (!plan || state.right_tab !== "movement" || fetched_edit === plan.edit) return;
  fetched_edit = plan.edit;
  movements.clear();
  for (const step of steps().filter((one) => ["move", "register", "autorotate"].includes(one.do))) {
    const answer = await try_to<{rows: MovementRow[]}>("movement", {object: step.id});
    if (answer) movements.set(step.id, answer.rows ?? []);
  }
  set({right_tab: "movement"});
}

function movement(): Child {
  if (!movements.size)
    return el("p", {class: "says empty"}, "No piece moves yet. Select a piece and press G to move it.");
  return [...movements].map(
      ([id, rows]) =>
          el("table", {class: "numbers"}, el("caption", {}, id.replace(/_/g, " ")),
             el("tbody", {},
                rows.map(
                    (row) =>
                        el("tr", {}, el("th", {scope: "row"}, row_name(row)),
                           el("td", {class: "words-cell"}, row_words(row)))))));
}
const row_name = (row: MovementRow): string =>
    String(row.name ?? row.what ?? row.landmark ?? "").replace(/_/g, " ");
const row_words = (row: MovementRow): string => String(
    row.says ?? row.words ?? row.sentence ??
    Object.entries(row)
        .filter(([key]) => key !== "name")
        .map(
            ([key, value]) => `${key.replace(/_(mm|deg)$/, "")} ${
                typeof value === "number" ? value.toFixed(1) : String(value)}`)
        .join(", "));
