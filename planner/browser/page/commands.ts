// SPDX-License-Identifier: AGPL-3.0-or-later
// All commands by name: the palette, the keys and the menus read this table.
import {add_step, change_history, edit, evaluate, free_id, open_plan, try_to} from "./actions";
import {ask_text} from "./base/dialog";
import {objects_of_plan} from "./drawn_objects";
import {makes_body, makes_shape} from "./operations";
import {all_panes, fit_all, show_in} from "./pane/pane_grid";
import {change_pane} from "./pane/panes";
import {Step} from "./protocol";
import {guess_landmarks} from "./tool/point_tools";
import {cut_selected} from "./tool/region_tool";
import {new_step} from "./panel/schema_form";
import {operations} from "./operations";
import {hide_patient, may_edit, notify, selected_step, set, shows_one_pane, state, steps, step_of, usual_panes, watch} from "./state";
import {open_second_screen} from "./second_screen";
import {change_theme} from "./base/theme";
import {all_tools, take_tool} from "./tool/tool";
import {plane_names, view_names} from "./base/view_frame";

export interface Command {
  name: string;
  says?: string;
  key?: string;  // "ctrl+z", "?", "m"
  run(): void;
}

/// Dialogs that commands open. main.ts sets them, so that this file need not import them.
export const dialogs = {
  palette: (): void => undefined,
  help: (): void => undefined,
  open: (): void => undefined,
  audit: (): void => undefined,
  procedure: (_name?: string): void => undefined,
  export: (): void => undefined,
  report: (): void => undefined,
  outcome: (): void => undefined,
  screenshot: (): void => undefined,
  link: (): void => undefined,
  merge: (): void => undefined,
  sign: (): void => undefined,
  cephalometry: (): void => undefined,
  tour: (): void => undefined,
};

export async function certify_all(): Promise<void> {
  set({right_tab: "numbers"});
  await evaluate(true);
}

export function remove_step(step: Step): void {
  void edit({remove: step.id}, `${step.id} removed`, null);
}

/// Moves a step to a place in the list, counted from 0. The server refuses an order in which a step comes
/// before a step that it uses.
export function put_step_at(id: string, place: number): void {
  const now = steps().findIndex((step) => step.id === id);
  const moved = steps()[now];
  if (!moved || place === now || place < 0 || place >= steps().length) return;
  const others = steps().filter((step) => step.id !== id);
  void edit({steps: [...others.slice(0, place), moved, ...others.slice(place)]}, `${id} put at ${place + 1}`, id);
}

export async function save(): Promise<void> {
  const plan = await try_to<{path?: string; name?: string}>("save");
  if (plan) notify(`Saved. ${plan.path ?? state.plan?.path ?? ""}`);
}

export async function copy_command(step: Step, as: "shell"|"python"): Promise<void> {
  const answer = await try_to<{shell: string; python: string}>("command", {step: step.id});
  if (!answer) return;
  try {
    await navigator.clipboard.writeText(answer[as]);
    notify(as === "shell" ? "The command is on the clipboard." : "The Python line is on the clipboard.");
  } catch {
    notify(answer[as]);
  }
}

export function mirror_selected(): void {
  const step = selected_step();
  if (!step || !makes_shape(step)) return notify("Select the object to mirror first.", "warning");
  const id = free_id(`${step.id}_mirrored`);
  void add_step({id, do: "mirror", object: step.id, fit: true}, `mirror image of ${step.id}`)
      .then(() => set({looks: {...state.looks, [id]: {visible: true, opacity: 0.6}}}));
}

export function compare_selected(): void {
  const step = selected_step();
  if (state.compare) return clear_compare();
  if (!step || !makes_shape(step)) return notify("Select the object to compare first.", "warning");
  const reference = typeof step.object === "string" ?
      step.object :
      state.plan?.plan.steps.find((one) => makes_shape(one) && one.id !== step.id)?.id;
  if (!reference) return notify("A second object is needed to compare with.", "warning");
  set({compare: {object: step.id, reference, range_mm: 5}, right_tab: "inspector"});
}

const contact_range_mm = 2;
/// Colours two objects by their distance to each other. Two panes show both from the front and from the left;
/// two show one object alone, seen from the side of the other. A second call ends this.
export function map_contacts(): void {
  if (state.compare) return clear_compare();
  const step = selected_step();
  const middle = (id: string): number|null => {
    const bounds = state.plan?.objects.find((one) => one.id === id)?.bounds_mm;
    return bounds ? (bounds[0][2] + bounds[1][2]) / 2 : null;
  };
  const shown =
      objects_of_plan().flatMap((one) => (one.id ? [one.id] : [])).filter((id) => makes_body(step_of(id)));
  const object = step && shown.includes(step.id) ? step.id : shown[shown.length - 1];
  const reference = shown.find((id) => id !== object);
  if (!object || !reference)
    return notify("A contact map needs two objects that are shown, such as the two jaws.", "warning");
  const is_upper = (middle(object) ?? 0) > (middle(reference) ?? 0);
  const [upper, lower] = is_upper ? [object, reference] : [reference, object];
  for (const [index, view] of (["anterior", "left", "superior", "inferior"] as const).entries())
    change_pane(index, {
      mode: "view",
      view,
      shading: "partial_volume",
      only: index === 2 ? lower :
          index === 3   ? upper :
                          undefined
    });
  set({
    compare: {object, reference, range_mm: contact_range_mm, mutual: true},
    right_tab: "inspector",
    maximised: null
  });
  for (const pane of all_panes()) pane.want(false);
}

export function clear_compare(): void {
  set({compare: null, panes: state.panes.map((pane) => ({...pane, only: undefined}))});
  for (const pane of all_panes()) pane.want(false);
}

// Colours end when an undo, or another window, takes one of their objects out of the plan.
watch(["plan"], () => {
  const {compare} = state;
  if (compare && [compare.object, compare.reference].some((id) => !step_of(id))) clear_compare();
});

/// Commands that change only how this window shows the plan.
function looking_commands(): Command[] {
  const of_a_pane: Command[] = [
    {name: "Fit all panes", key: "0", run: fit_all},
    ...view_names.map(
        (view, index) =>
            ({name: `View: ${view}`, key: String(index + 1), run: () => show_in(state.active_pane, view)})),
    ...plane_names.map((plane, index) => ({
                         name: `Slice: ${plane}`,
                         key: index < 3 ? String(index + 7) : "o",
                         run: () => show_in(state.active_pane, plane)
                       })),
  ];
  if (shows_one_pane) return of_a_pane;
  return [
    {
      name: "Cephalometric measures with norms",
      says: "Before and after the plan, with the tracing on the radiograph.",
      run: () => dialogs.cephalometry()
    },
    {
      name: "Compare in colours",
      says: "Colours the selected object by its distance from another.",
      key: "c",
      run: compare_selected
    },
    {
      name: "Contact map",
      says: "Colours two objects, such as the jaws, by their distance to each other.",
      key: "t",
      run: map_contacts
    },
    {
      name: "Cut plane",
      says: "Hides everything on one side of a plane, to show the inside.",
      key: "k",
      run: switch_cut_plane
    },
    {name: "Show the scan's audit", run: () => dialogs.audit()},
    {
      name: state.hides_patient ? "Show the patient" : "Hide the patient",
      says: "Hides or shows name, number and dates on every screen of this browser and in new reports.",
      run: () => hide_patient(!state.hides_patient)
    },
    {
      name: state.hides_names ? "Show the landmarks' names" : "Hide the landmarks' names",
      says: "Their dots stay in the panes.",
      run: () => set({hides_names: !state.hides_names})
    },
    {name: "Screenshot of the panes", run: () => dialogs.screenshot()},
    ...of_a_pane,
    {
      name: "Four views",
      key: "shift+1",
      run: () => {
        set({panes: usual_panes(), maximised: null});
        fit_all();
      }
    },
    {
      name: "Views and slices",
      says: "One view and three slices.",
      key: "shift+2",
      run: () => {
        show_in(0, "anterior");
        show_in(1, "sagittal");
        show_in(2, "axial");
        show_in(3, "coronal");
        set({maximised: null});
      }
    },
    {
      name: "Next pane",
      key: "n",
      run: () => {
        const next = (state.active_pane + 1) % 4;
        set({active_pane: next});
        all_panes()[next]?.canvas.focus();
      }
    },
    {
      name: "Enlarge the pane",
      key: "m",
      run: () => set({maximised: state.maximised === null ? state.active_pane : null})
    },
  ];
}

export function all_commands(): Command[] {
  const always: Command[] = [
    {name: "Keys and help", key: "?", run: () => dialogs.help()},
    {name: "Dark or light", says: "Changes between the dark and the light page.", run: change_theme},
  ];
  if (!may_edit()) return state.plan ? [...looking_commands(), ...always] : always;
  const list: Command[] = [
    {name: "Open a scan or plan", key: "ctrl+o", run: () => dialogs.open()},
    {name: "Guided tour: a Le Fort I in seven steps", run: () => dialogs.tour()},
    ...always,
  ];
  if (!state.plan) return list;
  return [
    ...all_tools().map((tool) => ({
                         name: `Tool: ${tool.title}`,
                         says: tool.says,
                         key: tool.key || undefined,
                         run: () => take_tool(tool.name)
                       })) as Command[],
    {name: "Undo", key: "ctrl+z", run: () => void change_history("undo")},
    {name: "Redo", key: "ctrl+y", run: () => void change_history("redo")},
    {name: "New branch", says: "Begins a branch for changes, so that the present plan stays as it is.", run: () => void new_branch()},
    {name: "Name this version", run: () => void name_version()},
    {name: "Save", key: "ctrl+s", run: () => void save()},
    {
      name: "Merge with another plan",
      says: "Takes over the changes that somebody else has made in a copy of this plan.",
      run: () => dialogs.merge()
    },
    {
      name: "Signatures",
      says: "Shows who has approved the plan and what has changed since, and adds a signature.",
      run: () => dialogs.sign()
    },
    {
      name: "Load the plan's file again",
      says: "Records changes that another program has made to the file as an edit.",
      run: () => void (state.plan && open_plan({path: state.plan.path}))
    },
    {
      name: "Certify",
      says: "Computes all objects in both kernels and compares them.",
      key: "ctrl+enter",
      run: () => void certify_all()
    },
    {
      name: "Cut inside and outside",
      says: "Cuts by the selected mask into the piece and the rest.",
      key: "x",
      run: cut_selected
    },
    {
      name: "Procedure from landmarks",
      says: "Plans a Le Fort I, a sagittal split or a genioplasty by landmarks.",
      run: () => dialogs.procedure()
    },
    {
      name: "First guess of landmarks",
      says: "Looks for a skull's landmarks by its symmetry and extremal points; you keep or correct each.",
      run: () => void guess_landmarks()
    },
    {name: "Mirror the selected object", run: mirror_selected},
    {
      name: "Radiograph and landmarks (cephalometry)",
      says: "Shows the left view as a radiograph in true scale.",
      run: show_cephalometry
    },
    {
      name: "Export",
      says: "Writes surfaces for print, decks of finite elements or label maps.",
      key: "ctrl+e",
      run: () => dialogs.export()
    },
    {
      name: "Outcome of the operation",
      says: "Compares the plan with a scan after the operation: achieved movements, with intervals.",
      run: () => dialogs.outcome()
    },
    {
      name: "Link to look at this plan",
      says: "For a colleague, who follows the plan and cannot change it.",
      run: () => dialogs.link()
    },
    {
      name: "Show the pane in a second window",
      says: "For another screen: one pane, large, that follows this window.",
      run: () => open_second_screen(state.active_pane)
    },
    {name: "Report", says: "Writes the report with every certificate.", run: () => dialogs.report()},
    ...looking_commands(),
    {
      name: "Remove the selected step",
      run: () => {
        const step = selected_step();
        if (step) remove_step(step);
      }
    },
    ...([["earlier", -1], ["later", 1]] as const).map(([word, by]) => ({
      name: `Put the selected step one place ${word}`,
      says: "Changes the order of the plan's steps.",
      run: () => {
        const step = selected_step();
        if (step) put_step_at(step.id, steps().indexOf(step) + by);
      }
    })),
    {
      name: "Copy the selected step as a command",
      run: () => {
        const step = selected_step();
        if (step) void copy_command(step, "shell");
      }
    },
    {
      name: "Copy the selected step as Python",
      run: () => {
        const step = selected_step();
        if (step) void copy_command(step, "python");
      }
    },
    ...list,
    ...operations()
        .filter((schema) => !schema.title?.startsWith("export"))
        .map((schema) => ({
               name: `Add step: ${(schema.title ?? "").replace(/_/g, " ")}`,
               says: schema.description ?? "",
               run: () => set(
                   {draft_step: new_step(schema, free_id(schema.title ?? "step")), right_tab: "inspector"}),
             })),
  ];
}

export const switch_cut_plane = (): void => set(
    {cut_plane: state.cut_plane ? null : {axis: 0, side: 1, offset_mm: state.cross_mm[0]}, right_tab: "inspector"});

function show_cephalometry(): void {
  change_pane(1, {mode: "view", view: "left", shading: "radiograph"});
  set({maximised: 1, active_pane: 1});
  all_panes()[1]?.want(false);
  take_tool("landmark");
}

export async function new_branch(): Promise<void> {
  const name = await ask_text("New branch", "Name", `variant_${(state.plan?.branches.length ?? 0) + 1}`);
  if (name) await change_history("branch", {name});
}
export async function name_version(): Promise<void> {
  const name = await ask_text("Name this version", "Name", "approved");
  if (name) await change_history("name_version", {name});
}

/// The command of a key press; undefined if there is none. Letter keys run no commands while a text is typed.
export function command_of(event: KeyboardEvent): Command|undefined {
  const target = event.target as HTMLElement;
  const is_typing = target.matches("input, textarea, select");
  const words = [
    event.ctrlKey || event.metaKey ? "ctrl" : "",
    event.shiftKey && /^\d$/.test(event.code.replace("Digit", "")) ? "shift" : ""
  ].filter(Boolean);
  const base = event.shiftKey && event.code.startsWith("Digit") ? event.code.replace("Digit", "") :
                                                                  event.key.toLowerCase();
  const pressed = [...words, base].join("+");
  if (is_typing && !words.includes("ctrl")) return undefined;
  return all_commands().find((command) => command.key === pressed);
}
