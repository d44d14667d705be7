// SPDX-License-Identifier: AGPL-3.0-or-later
// The left column: objects with their looks, the plan's steps, and its history with branches.
import {change_history, try_to} from "../actions";
import {motion_words} from "../base/anatomical";
import {badge} from "./certificate_badge";
import {copy_command, dialogs, name_version, new_branch, put_step_at, remove_step} from "../commands";
import {look_of, object_ids} from "../drawn_objects";
import {makes_body, makes_scan, makes_shape} from "../operations";
import {Attributes, button, Child, el, fill, fill_tabs} from "../base/html";
import {icon} from "../base/icons";
import {show_scan} from "../pane/pane_grid";
import {Json, Motion, ObjectState, Step} from "../protocol";
import {may_edit, ObjectLook, on_leaving_plan, set, shown_scan, state, steps, watch} from "../state";

const object_of = (id: string): ObjectState|undefined =>
    state.plan?.objects.find((object) => object.id === id);

export function make_lists(host: HTMLElement): void {
  const tabs = el("div", {class: "tabs", role: "tablist"});
  const body = el("div", {class: "list", role: "tabpanel"});
  host.append(el("h2", {class: "unseen"}, "The plan"), tabs, body);
  const again = (): void => {
    if (!state.plan) return fill(body);
    fill_tabs(
        tabs, state.left_tab,
        [
          ["steps", "Steps", "Steps of the plan, in order"],
          ["objects", "Objects", "Objects: colour, visibility, opacity"],
          ["history", "History", "History: every change, branches and versions"]
        ],
        (left_tab) => set({left_tab}));
    fill(
        body, scan_choice(),
        state.left_tab === "objects"   ? objects() :
            state.left_tab === "steps" ? step_rows() :
                                         history());
  };
  watch(["plan", "looks", "selected", "left_tab", "scan", "hello"], again);
}

/// A list to choose the scan that the panes show. Null if the plan has only one.
function scan_choice(): Child {
  const names = (state.plan?.scans ?? []).map((scan) => scan.name);
  if (names.length < 2) return null;
  return el(
      "label",
      {class: "field", "data-tip": "The scan whose slices are shown. A donor's scan has its own frame of reference."},
      el("span", {}, "Scan"),
      el("select", {
        "data-key": "scan",
        name: "scan",
        onchange: (event: Event) => show_scan((event.target as HTMLSelectElement).value),
      },
         names.map(
             (name) =>
                 el("option", {value: name, selected: name === shown_scan()}, name.replace(/_/g, " ")))));
}

function change_look(id: string, change: ObjectLook): void {
  set({looks: {...state.looks, [id]: {...state.looks[id], ...change}}});
}

const eye = (id: string): Child => {
  const look = look_of(id);
  return button(
      icon(look.visible ? "eye" : "eye_off", 16), `${look.visible ? "Hide" : "Show"} ${id}`, (event) => {
        event.stopPropagation();
        change_look(id, {visible: !look.visible});
      }, {class: `ghost small${look.visible ? "" : " off"}`, "aria-pressed": String(look.visible)});
};

function objects(): Child {
  return object_ids().map((id) => {
    const look = look_of(id);
    const object = object_of(id);
    const percent = (opacity: number): string => `${Math.round(opacity * 100)} %`;
    const shown = el("span", {}, percent(look.opacity));
    return el(
        "div", {class: `item${state.selected === id ? " selected" : ""}`, onclick: () => set({selected: id})},
        el("div", {class: "item-line"}, el("input", {
             type: "color",
             class: "swatch",
             value: look.colour,
             "aria-label": `Colour of ${id}`,
             "data-tip": "Colour",
             onclick: (event: Event) => event.stopPropagation(),
             onchange: (event: Event) => change_look(id, {colour: (event.target as HTMLInputElement).value}),
           }),
           el("button", {type: "button", class: "name"}, id.replace(/_/g, " ")),
           object?.kind === "mask" ? null : badge(id, object?.certificate, object?.volume), eye(id)),
        el("label", {class: "opacity", "data-tip": "Opacity"}, shown, el("input", {
             type: "range",
             min: 0.05,
             max: 1,
             step: 0.05,
             value: look.opacity,
             "aria-label": `Opacity of ${id}`,
             "data-key": `opacity-${id}`,
             oninput: (event: Event) => {
               const opacity = Number((event.target as HTMLInputElement).value);
               shown.textContent = percent(opacity);
               change_look(id, {opacity});
             },
             onclick: (event: Event) => event.stopPropagation(),
           })),
        object?.error ? el("p", {class: "error"}, object.error) : null);
  });
}

/// A short description of a step, such as its expression or the object that it changes.
export function step_words(step: Step): string {
  const list = (value: Json|undefined): string =>
      (Array.isArray(value) ?
           value.map((one) => (typeof one === "string" ? one : "")).filter(Boolean).join(", ") :
           "");
  switch (step.do) {
    case "window":
      return `samples from ${String(step.low)}${step.high === undefined ? "" : ` to ${String(step.high)}`}`;
    case "mask":
      return `regions in ${
          Array.isArray(step.regions) ?
              (step.regions as {view: string}[]).map((region) => region.view).join(" and ") :
              "a file"}`;
    case "tile":
      return Array.isArray(step.contours) ? `contours on ${step.contours.length} ${step.contours.length === 1 ? "slice" : "slices"}` : "contours of a file";
    case "combine":
      return String(step.expression);
    case "move":
      return `${String(step.object)}: ${
          step.by || step.turn || step.points ? motion_words(step as unknown as Motion) :
              step.translate_mm               ? `by ${(step.translate_mm as number[]).join(", ")} mm` :
                                                "moved"              }`;
    case "measure":
      return step.points_mm ? list(step.points_mm) || "points" :
          step.to           ? `${String(step.object)} to ${String(step.to)}` :
                              String(step.object ?? "");
    case "landmarks":
      return `${Array.isArray(step.points) ? step.points.length : ""} landmarks`;
    case "export":
      return String(step.path);
    default:
      return [step.object, step.scan, step.path].filter((value) => typeof value === "string").join(" ");
  }
}

/// The reason why a step has no result. A step that makes a scan states it in its measurement.
function error_of(step: Step): string|null|undefined {
  if (!makes_scan(step)) return object_of(step.id)?.error;
  return state.plan?.measurements?.find((one) => one.id === step.id && one.value === null)?.sentence;
}

function step_rows(): Child {
  return [
    steps().map((step, index) => {
      const object = object_of(step.id);
      return el(
          "div", {
            class: `item step${state.selected === step.id ? " selected" : ""}`,
            onclick: () => set({selected: step.id, right_tab: "inspector"}),
            ...(may_edit() ? drag_of(step, index) : {})
          },
          el("div", {class: "item-line"},
             makes_shape(step) ? el("span", {class: "chip", style: `background:${look_of(step.id).colour}`}) :
                                 el("span", {class: "chip empty"}, index + 1),
             el("button",
                {type: "button", class: "name", "aria-current": state.selected === step.id ? "step" : null},
                step.id.replace(/_/g, " ")),
             makes_body(step) ? badge(step.id, object?.certificate, object?.volume) : null,
             makes_shape(step) ? eye(step.id) : null, may_edit() ? step_menu(step) : null),
          el("p", {class: "words"}, el("b", {}, step.do.replace(/_/g, " ")), " ", step_words(step)),
          error_of(step) ? el("p", {class: "error"}, error_of(step)) : null);
    }),
    steps().length ? null : el("p", {class: "says"}, "No step yet."),
  ];
}

// The id of the step that the person is dragging; null otherwise.
let dragged: string|null = null;
const drop_classes = ["before-here", "behind-here"] as const;

/// Attributes that make a row draggable. A step dropped on the upper half of a row goes before its step, on
/// the lower half behind it.
function drag_of(step: Step, index: number): Attributes {
  const row_of = (event: DragEvent): HTMLElement => event.currentTarget as HTMLElement;
  const is_behind = (event: DragEvent): boolean => {
    const box = row_of(event).getBoundingClientRect();
    return event.clientY > box.top + box.height / 2;
  };
  const clear = (event: DragEvent): void => row_of(event).classList.remove(...drop_classes);
  return {
    draggable: "true",
    ondragstart: (event: DragEvent) => {
      dragged = step.id;
      row_of(event).classList.add("dragged");
      event.dataTransfer?.setData("text/plain", step.id);
      if (event.dataTransfer) event.dataTransfer.effectAllowed = "move";
    },
    ondragend: (event: DragEvent) => {
      dragged = null;
      row_of(event).classList.remove("dragged");
    },
    ondragover: (event: DragEvent) => {
      if (dragged === null || dragged === step.id) return;
      event.preventDefault();
      event.stopPropagation();  // otherwise the page would accept the drop as files
      clear(event);
      row_of(event).classList.add(drop_classes[is_behind(event) ? 1 : 0]);
    },
    ondragleave: clear,
    ondrop: (event: DragEvent) => {
      clear(event);
      if (dragged === null) return;
      event.preventDefault();
      event.stopPropagation();
      const from = steps().findIndex((one) => one.id === dragged);
      // The dragged step leaves its old place, so later places move forward by one.
      const to = index + (is_behind(event) ? 1 : 0);
      put_step_at(dragged, from < to ? to - 1 : to);
    },
  };
}

// Id of the step whose menu is open; empty if none is. The menu stays open when the list is refilled.
let step_of_menu = "";

export function close_menu(): void {
  step_of_menu = "";
  document.querySelectorAll<HTMLElement>(".menu").forEach((menu) => {
    menu.hidden = true;
  });
}

function step_menu(step: Step): Child {
  const menu =
      el("div", {class: "menu", role: "menu", hidden: step.id !== step_of_menu, onclick: close_menu},
         button(
             "Copy as command", "Copies a command for the terminal that runs this step",
             () => void copy_command(step, "shell"), {role: "menuitem"}),
         button(
             "Copy as Python", "Copies a line of Python that adds this step",
             () => void copy_command(step, "python"), {role: "menuitem"}),
         button(
             "Put earlier", "Puts the step one place earlier, but not before a step that it uses",
             () => put_step_at(step.id, steps().indexOf(step) - 1), {role: "menuitem"}),
         button(
             "Put later", "Puts the step one place later, but not after a step that uses it",
             () => put_step_at(step.id, steps().indexOf(step) + 1), {role: "menuitem"}),
         button(
             "Remove", "Removes the step from the plan; undo restores it", () => remove_step(step),
             {role: "menuitem", class: "danger"}));
  const open = button(icon("more", 16), `More for ${step.id}`, (event) => {
    event.stopPropagation();
    const was_hidden = menu.hidden;
    close_menu();
    if (!was_hidden) return;
    step_of_menu = step.id;
    menu.hidden = false;
  }, {class: "ghost small", "aria-haspopup": "menu"});
  return el("span", {class: "menu-host"}, open, menu);
}

let diff_rows: {from: number; rows: string[]}|null = null;
on_leaving_plan(() => {
  step_of_menu = "";
  dragged = null;
  diff_rows = null;
});

function history(): Child {
  const plan = state.plan;
  if (!plan) return null;
  return [
    !may_edit() ? null : el("div", {class: "row"},
       button(
           [icon("branch", 15), "New branch"],
           "New branch. Changes go to a new branch; the present plan stays on this one", () => void new_branch()),
       button("Name version", "Names this state, so that you find it again", () => void name_version()),
       button("Merge", "Merge with another plan. Takes over the changes that somebody else has made", () => dialogs.merge()),
       button("Sign", "Sign. Shows who has approved the plan, and what has changed since", () => dialogs.sign())),
    plan.branches.length > 1 && may_edit() ?
        el("label", {class: "field"}, el("span", {}, "Branch"),
           el("select", {
             "data-key": "branch",
             name: "branch",
             onchange: (event: Event) =>
                 void change_history("go_to", {where: (event.target as HTMLSelectElement).value})
           },
              plan.branches.map(
                  ([name]) => el("option", {value: name, selected: name === plan.branch}, name)))) :
        null,
    plan.history.map((one) => {
      const is_now = one.id === plan.edit;
      return el(
          "div", {class: `item edit${is_now ? " selected" : ""}`},
          el("div", {class: "item-line"},
             el("button", {
               type: "button",
               class: "name",
               disabled: !may_edit(),
               "data-tip": is_now ? "The present state" : "Go to this state",
               onclick: () => void change_history("go_to", {where: String(one.id)})
             },
                one.what || "first state"),
             one.names.map((name) => el("span", {class: "tag"}, name)),
             is_now ? null :
                      button(
                          "Diff", "What changed from this state to the present one",
                          () => void show_diff(one.id), {class: "ghost small"})),
          el("p", {class: "words"}, time_words(one.made_at)),
          diff_rows?.from === one.id ?
              el("ul", {class: "diff"},
                 diff_rows.rows.map(
                     (row) =>
                         el("li",
                            {class: row[0] === "+" ? "more" :
                                 row[0] === "-"    ? "less" :
                                                     ""},
                            row))) :
              null);
    }),
  ];
}

async function show_diff(from: number): Promise<void> {
  if (diff_rows?.from === from)
    diff_rows = null;
  else {
    const answer = await try_to<{rows: string[]}>("diff", {a: from, b: state.plan?.edit});
    if (answer) diff_rows = {from, rows: answer.rows};
  }
  set({left_tab: "history"});
}

const time_words = (made_at: string): string => {
  const time = new Date(made_at);
  return Number.isNaN(time.getTime()) ?
      made_at :
      time.toLocaleTimeString([], {hour: "2-digit", minute: "2-digit", second: "2-digit"});
};
