// SPDX-License-Identifier: AGPL-3.0-or-later
// The right column: the chosen tool and the selected step, the plan's numbers with their certificates, and
// how far each piece and landmark moves.
import {add_step, replace_step} from "../actions";
import {live_rows, live_rows_of_draft} from "./live_step";
import {mesh_audit} from "./audit";
import {badge, judged, measured_text} from "./certificate_badge";
import {cleaning_rows} from "./cleaning";
import {is_piece} from "../drawn_objects";
import {makes_body} from "../operations";
import {button, Child, el, fill, fill_tabs} from "../base/html";
import {icon, is_icon} from "../base/icons";
import {mirror_rows} from "./mirror_rows";
import {movement_fields} from "./move_fields";
import {fetch_movement, movement} from "./movement_panel";
import {neck_rows} from "./neck_rows";
import {numbers} from "./numbers_panel";
import {Step} from "../protocol";
import {result_rows} from "./result_rows";
import {step_form} from "./schema_form";
import {may_edit, selected_step, set, state, watch} from "../state";
import {active_tool, take_tool} from "../tool/tool";
import {compare_card, cut_plane_card} from "../pane/view_cards";

export function make_inspector(host: HTMLElement): void {
  const tabs = el("div", {class: "tabs", role: "tablist"});
  const body = el("div", {class: "panel-body", role: "tabpanel"});
  host.append(el("h2", {class: "unseen"}, "Details"), tabs, body);
  const again = (): void => {
    if (!state.plan) return fill(body);
    fill_tabs(
        tabs, state.right_tab,
        [
          ["inspector", "Inspector", "Inspector: the tool in use and the selected step"],
          ["numbers", "Numbers", "Numbers: volumes and measurements with their certificates"],
          ["movement", "Movement", "Movement: how far each piece and landmark moves"]
        ],
        (right_tab) => set({right_tab}));
    fill(
        body,
        state.right_tab === "numbers"      ? numbers() :
            state.right_tab === "movement" ? movement() :
                                             inspector());
  };
  watch(
      [
        "plan", "selected", "right_tab", "tool", "draft_window", "draft_step", "preview", "overlap_mm3", "tried",
        "difference_to", "difference",
        "cleaning", "compare", "cut_plane", "arch_mm"
      ],
      again);
  watch(["plan", "right_tab"], () => void fetch_movement());
}

function inspector(): Child {
  const draft = state.draft_step;
  if (draft)
    return [tool_card(), el(
        "section", {class: "card"}, el("h3", {}, `New step: ${draft.do.replace(/_/g, " ")}`),
        el("label", {class: "field"}, el("span", {}, "name"), el("input", {
             value: draft.id,
             "data-key": "draft-id",
             onchange: (event: Event) =>
                 set({draft_step: {...draft, id: (event.target as HTMLInputElement).value}})
           })),
        live_rows_of_draft(draft), step_form(draft, (step) => set({draft_step: step})), mesh_audit(draft),
        el("div", {class: "row"},
           button(
               "Add step", "Adds the step to the plan",
               () => void add_step(draft, draft.do.replace(/_/g, " ")).then((ok) => {
                 if (ok && state.draft_step === draft) set({draft_step: null});
               }),
               {class: "primary"}),
           button("Cancel", "Adds nothing", () => set({draft_step: null}))))];
  const step = selected_step();
  const motion = !may_edit() ? null :
      step?.do === "move" || state.tool === "move" || (step && is_piece(step)) ? movement_fields() : null;
  return [
    tool_card(), state.cut_plane ? cut_plane_card() : null, state.compare ? compare_card() : null, motion,
    step ? step_card(step, motion !== null && step.do === "move") : hint()
  ];
}

const hint = (): Child => (
    state.tool === "navigate" ? el("p", {class: "says empty"},
                                   may_edit() ? "Select a step on the left, or take a tool. Ctrl K finds every command." : "Select a step to read it.") :
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
  const certificate = judged(object?.certificate, object?.volume);
  const found = state.plan?.measurements?.find((one) => one.id === step.id);
  return el(
      "section", {class: "card"},
      el("h3", {}, step.id.replace(/_/g, " "), el("small", {}, step.do.replace(/_/g, " ")),
         el("span", {class: "spring"}),
         makes_body(step) ? badge(step.id, certificate, object?.volume) : null),
      object?.error ? el("p", {class: "error"}, object.error) : null,
      object?.volume ? el("p", {class: "reading"}, el("b", {}, measured_text(object.volume)),
                          object.area ? `  ·  ${measured_text(object.area)}` : "") :
                                        null,
      found && found.value !== null ? el("p", {class: "reading"}, el("b", {}, measured_text(found)), ` ${found.says ?? ""}`) : null,
      found && found.value === null && found.sentence ? el("p", {class: "says"}, found.sentence) : null,
      object?.findings?.map((finding) => el("p", {class: "sentence warn"}, finding)),
      may_edit() ? [mirror_rows(step), cleaning_rows(step), neck_rows(step), live_rows(step)] : null, result_rows(step),
      certificate ? el("p", {class: `sentence ${certificate.verdict.toLowerCase()}`}, certificate.sentence) :
                    null,
      el("div", {class: "panel-rows", inert: !may_edit()}, step_form(
          step, (next) => void replace_step(step.id, next, `${step.id} changed`),
          has_motion ? ["by", "turn"] : [])),
      may_edit() ? mesh_audit(step) : null);
}
