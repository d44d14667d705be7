// SPDX-License-Identifier: AGPL-3.0-or-later
// A step of one length, such as an offset or a shell: a slider that shows what the step makes before it is in the plan.
import {replace_step} from "../actions";
import {Child, el} from "../base/html";
import {grouped} from "../base/numbers";
import {object_fields, schema_of} from "../operations";
import {Schema, Step} from "../protocol";
import {set, state, step_of, watch} from "../state";

const colour = "#ff9f43";
const usual_most_mm = 10, step_mm = 0.1;

/// The length field of a step whose only other required field names one object. Null if the step has no such
/// field or several.
export function length_of(step: Step): {field: string; about: Schema}|null {
  const schema = schema_of(step);
  if (schema?.["x-makes"] !== "object" || object_fields(schema).length !== 1) return null;
  const required = new Set(schema.required ?? []);
  const lengths = Object.entries(schema.properties ?? {})
                      .filter(([field, about]) => about.type === "number" && about["x-unit"] === "mm" &&
                                  (required.has(field) || about.default !== undefined));
  const [length] = lengths;
  const others = [...required].filter((field) => !["id", "do", object_fields(schema)[0], length?.[0]].includes(field));
  return length && lengths.length === 1 && !others.length ? {field: length[0], about: length[1]} : null;
}

// One element for all refills of the panel. A new element would miss the volumes that arrive while a slider
// is dragged.
const tried_line = el("p", {class: "says", role: "status", "data-key": "tried"});
let waiting = "";
function write_tried(): void {
  const tried = state.tried;
  tried_line.className = tried?.refusal ? "error" : "says";
  tried_line.textContent = !tried ? waiting :
      tried.refusal               ? tried.refusal :
      tried.is_coarse             ? `About ${grouped(tried.mm3 / 1000, tried.mm3 < 1e5 ? 1 : 0)} cm³.` :
                                    `${grouped(tried.mm3 / 1000, tried.mm3 < 1e5 ? 2 : 0)} cm³, ${grouped(tried.voxels)} voxels. Not in the plan yet.${
                                        (tried.findings ?? []).map((finding) => ` ${finding}.`).join("")}`;
}
watch(["tried"], write_tried);
/// A line with the volume that the server computed for the preview, or with its reason to refuse. Shows
/// `until_then` before the first answer.
export function tried_text(until_then: string): Child {
  waiting = until_then;
  write_tried();
  return tried_line;
}

/// A slider for a step's length, and a line with the object's volume at that length. `take` receives the step
/// while the slider moves, `done` after its release.
function slider(step: Step, {field, about}: {field: string; about: Schema}, take: (step: Step) => void, done?: (step: Step) => void): Child {
  const value = Number(step[field] ?? about.default ?? 0);
  const most = Math.max(about.maximum ?? usual_most_mm, Math.abs(value));
  const least = about.exclusiveMinimum !== undefined ? step_mm : about.minimum ?? -most;
  const shown = el("output", {}, `${value.toFixed(1)} mm`);
  const changed = (event: Event): Step => ({...step, [field]: Number((event.target as HTMLInputElement).value)});
  return [
    el("label", {class: "slider"}, el("span", {}, "Live"), el("input", {
         type: "range",
         min: least,
         max: most,
         step: step_mm,
         value,
         "aria-label": `${field.replace(/_mm$/, "").replace(/_/g, " ")} in mm, shown while it is dragged`,
         "data-key": `live-${step.id}`,
         oninput: (event: Event) => {
           const next = changed(event);
           shown.textContent = `${Number(next[field]).toFixed(1)} mm`;
           take(next);
         },
         onchange: (event: Event) => done?.(changed(event)),
       }),
       shown),
    state.preview?.by ? tried_text("Computing …") : null,
  ];
}

/// The slider for a step that is not in the plan yet. Null if the step has no single length.
export function live_rows_of_draft(draft: Step): Child {
  const length = length_of(draft);
  return length && slider(draft, length, (step) => set({draft_step: step}));
}
export function live_rows(step: Step): Child {
  const length = length_of(step);
  return length && slider(
      step, length,
      (next) => set({preview: {object: step.id, steps: [{...next, id: "tried"}], by: "step"}}),
      (next) => {
        if (JSON.stringify(next) === JSON.stringify(step)) return set({preview: null, tried: null});
        void replace_step(step.id, next, `${step.id} changed`).then(() => set({preview: null, tried: null}));
      });
}

// A new step with a single length is previewed while the inspector is open.
watch(["draft_step", "right_tab", "plan"], () => {
  const draft = state.right_tab === "inspector" ? state.draft_step : null;
  const is_whole = draft !== null && length_of(draft) !== null && step_of(String(draft.object)) !== undefined;
  const before = state.preview;
  if (!is_whole) {
    if (before?.by === "draft") set({preview: null, tried: null});
    return;
  }
  const steps = [draft];
  if (before?.by !== "draft" || JSON.stringify(before.steps) !== JSON.stringify(steps))
    set({preview: {object: "", steps, colour, by: "draft"}, ...(before?.by === "draft" ? {} : {tried: null})});
});
// The preview of a changed step ends when another step is selected.
watch(["selected", "tool"], () => {
  if (state.preview?.by === "step" && state.preview.object !== state.selected) set({preview: null, tried: null});
});
