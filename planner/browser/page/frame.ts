// SPDX-License-Identifier: AGPL-3.0-or-later
// The page's frame: the bar on top, the rail of tools, the status line, jobs, notices and the message about a
// lost connection.
import {change_history, try_to} from "./actions";
import {certify_all, compare_selected, dialogs, map_contacts, mirror_selected, new_branch, switch_cut_plane} from "./commands";
import {button, Child, el, fill} from "./base/html";
import {grouped} from "./base/numbers";
import {icon, IconName, is_icon} from "./base/icons";
import {cut_selected} from "./tool/region_tool";
import {dismiss, may_edit, set, shows_one_pane, state, watch} from "./state";
import {patient_button} from "./panel/patient";
import {change_theme} from "./base/theme";
import {active_tool, all_tools, take_tool} from "./tool/tool";

export function make_bar(host: HTMLElement): void {
  const again = (): void => {
    const plan = state.plan;
    const act = (name: IconName, label: string, tip: string, run: () => void, more = {}): Child => button(
        [icon(name, 16), el("span", {class: "label"}, label)], tip, run, {"aria-label": label, ...more});
    const brand: Child[] = [el("span", {class: "logo"}), el("b", {}, "Octotomy")];
    const name = plan ? el(state.page === "plan" ? "h1" : "span", {class: "plan-name", title: plan.path}, plan.name) : null;
    const always = [
      button(icon("theme", 17), "Dark or light", change_theme, {class: "ghost"}),
      button(icon("help", 17), "Keys and help. ?", () => dialogs.help(), {class: "ghost"})
    ];
    if (!may_edit())
      return fill(
          host, el("span", {class: "brand row"}, brand), name,
          plan ? patient_button() : null, shows_one_pane ? null : el("span", {class: "tag"}, "to look only"),
          el("span", {class: "spring"}), shows_one_pane ? null : always);
    fill(
        host,
        button(brand, "Start page", () => set({page: "start"}), {class: "brand ghost", "aria-label": "Octotomy, start page"}),
        name,
        plan ? patient_button() : null,
        plan ? button(
                   [icon("branch", 14), plan.branch], "New branch. This branch keeps the plan as it is",
                   () => void new_branch(),
                   {class: "ghost small", "aria-label": `New branch beside ${plan.branch}`}) :
               null,
        plan ? el("span", {class: "group"},
                  button(
                      icon("undo", 17), "Undo. Ctrl Z", () => void change_history("undo"),
                      {disabled: !plan.can_undo, class: "ghost"}),
                  button(
                      icon("redo", 17), "Redo. Ctrl Y", () => void change_history("redo"),
                      {disabled: !plan.can_redo, class: "ghost"})) :
               null,
        el("span", {class: "spring"}),
        button(
            [icon("search", 15), el("span", {class: "label"}, "Search commands"), el("kbd", {}, "Ctrl K")],
            "Every command by its name", () => dialogs.palette(),
            {class: "search", "aria-label": "Search commands"}),
        el("span", {class: "spring"}),
        plan ? act("procedure", "Procedure", "Procedure. Plans an operation by landmarks and a few values",
                   () => dialogs.procedure()) :
               null,
        plan ? act("certify", "Certify", "Certify. Computes all objects in both kernels and compares them. Ctrl Enter",
                   () => void certify_all()) :
               null,
        plan ? act("export", "Export", "Export and print. Ctrl E", () => dialogs.export()) : null,
        plan ? act("report", "Report", "Report. Writes every number with its certificate",
                   () => dialogs.report(), {class: "primary"}) :
               null,
        plan && state.hello?.view_token ?
            button(icon("share", 17), "A link to look at this plan, for a colleague", () => dialogs.link(), {class: "ghost"}) :
            null,
        always);
  };
  watch(["plan", "page", "hides_patient", "hello"], again);
  again();
}

/// Adapts the page's layout to a window that may only show the plan, and to a window with one pane.
export function follow_access(): void {
  const again = (): void => {
    document.body.classList.toggle("looks-only", !may_edit());
    document.body.classList.toggle("one-pane", shows_one_pane);
  };
  watch(["hello"], again);
  again();
}

export function make_rail(host: HTMLElement): void {
  const again = (): void => {
    const rail_button = (name: IconName, tip: string, on: boolean, run: () => void): Child =>
        button(icon(name, 20), tip, run, {class: on ? "on" : "", "aria-pressed": String(on)});
    fill(
        host,
        all_tools()
            .filter((tool) => is_icon(tool.name))
            .map(
                (tool) => rail_button(
                    tool.name as IconName,
                    `${tool.title}${tool.key ? ` (${tool.key.toUpperCase()})` : ""}. ${tool.says}`,
                    state.tool === tool.name,
                    () => {
                      set({right_tab: "inspector"});  // also if the tool is chosen already
                      take_tool(tool.name);
                    })),
        el("hr", {}),
        rail_button(
            "cut", "Cut (X). Cuts by the selected mask into the piece inside and the rest", false,
            cut_selected),
        rail_button(
            "mirror", "Mirror. Makes the selected object's mirror image about the plane that fits best",
            false, mirror_selected),
        rail_button(
            "compare", "Compare (C). Colours the selected object by its distance from another",
            state.compare !== null && !state.compare.mutual, compare_selected),
        rail_button(
            "contact", "Contacts (T). Colours two objects, such as the jaws, by their distance to each other",
            state.compare?.mutual === true, map_contacts),
        rail_button(
            "plane", "Cut plane (K). Hides everything on one side, to show the inside",
            state.cut_plane !== null,
            switch_cut_plane),
        el("span", {class: "spring"}),
        rail_button("camera", "Screenshot. The panes as a picture", false, () => dialogs.screenshot()));
  };
  watch(["tool", "plan", "compare", "cut_plane"], again);
  again();
}

export function make_status(host: HTMLElement): void {
  const again = (): void => {
    const tool = active_tool();
    const cross = state.cross_mm.map((x) => grouped(x, 1)).join("  ");
    fill(
        host,
        el("span", {class: "hint"},
           state.marked ?
               [
                 el("b", {}, "Marked: "), state.marked.says, " ",
                 button("clear", "Takes the mark away", () => set({marked: null}), {class: "link"})
               ] :
               tool && tool.name !== "navigate" ?
               [el("b", {}, `${tool.title}: `), tool.says] :
               "Drag turns a view. Wheel zooms a view and goes through slices. Click moves the cross-hair."),
        el("span", {class: "spring"}), state.pointer ? el("span", {class: "pointer"}, state.pointer) : null,
        el("span", {"data-tip": "The cross-hair: x to the patient's left, y to the back, z to the head."},
           `✛ ${cross} mm`),
        jobs());
  };
  watch(["tool", "pointer", "cross_mm", "marked", "jobs", "link"], again);
}

function jobs(): Child {
  const job = state.jobs[state.jobs.length - 1];
  if (!job)
    return el(
        "span", {class: "idle"}, el("i", {class: `lamp ${state.link}`}),
        state.link === "open" ? "ready" : "no connection");
  const share = job.share > 0 ? `${Math.round(job.share * 100)} %` : "";
  const left = job.left_s ? `, ${Math.ceil(job.left_s)} s left` : "";
  return el(
      "span", {class: "job", role: "status"}, el("span", {class: "spinner"}), el("span", {class: "doing"}, `${job.what} ${share}${left}`),
      job.share > 0 ? el("progress", {value: job.share, max: 1}) : null,
      job.id > 0 ? button(
                       icon("close", 12), `Cancel ${job.what}`, () => void try_to("cancel", {target: job.id}),
                       {class: "ghost small"}) :
                   null);
}

export function make_notices(host: HTMLElement): void {
  watch(
      ["notices"],
      () => fill(
          host,
          state.notices.map(
              (notice) => el(
                  "div",
                  {class: `notice ${notice.level}`, role: notice.level === "error" ? "alert" : "status"},
                  el("span", {}, notice.message), notice.act ? button(notice.act.label, notice.act.label, () => {
                    dismiss(notice.key);
                    notice.act?.run();
                  }) :
                                                                null,
                  button(icon("close", 14), "Close", () => dismiss(notice.key), {class: "ghost small"})))));
}

export function make_lost(host: HTMLElement): void {
  const again = (): void => {
    host.hidden = state.link !== "lost";
    if (!host.hidden)
      fill(
          host, el("span", {class: "spinner"}),
          state.lost_because ?
              `The planner's program has ended the connection: ${state.lost_because}. Trying again …` :
              "The connection to the planner's program is lost. No work is lost: the plan is on disk. Trying again …");
  };
  watch(["link", "lost_because"], again);
  again();
}
