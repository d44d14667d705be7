// SPDX-License-Identifier: AGPL-3.0-or-later
// Tools, and the one in use. A tool handles the pointer in a pane; events that it ignores go to the pane's
// own navigation.
import type {Child} from "../base/html";
import type {Pane} from "../pane/panes";
import {may_edit, on_leaving_plan, set, state} from "../state";
import {Vec2} from "../base/vector";

export interface Pointer {
  pane: Pane;
  at: Vec2;  // canvas pixels
}

export interface Tool {
  name: string;
  title: string;
  says: string;  // one sentence that explains the tool
  key: string;   // the key that chooses the tool
  cursor: string;
  is_pointed?: boolean;  // works on positions: arrow keys move one in the pane, Space clicks it
  down?(pointer: Pointer): boolean;  // returns true if the tool takes the drag
  move?(pointer: Pointer): void;
  up?(pointer: Pointer): void;
  cancel?(): void;  // undoes `down`, as for a second finger; a tool without it receives `up`
  hover?(pointer: Pointer): void;
  double?(pointer: Pointer): boolean;
  press?(event: KeyboardEvent, pane: Pane): boolean;
  draw?(pane: Pane, context: CanvasRenderingContext2D): void;
  panel?(): Child;  // rows that the inspector shows above the step
  taken?(): void;
  left?(): void;
}

const tools: Tool[] = [];
export const all_tools = (): readonly Tool[] => tools;
export function register_tools(more: Tool[]): void {
  tools.push(...more);
}
export const active_tool = (): Tool|undefined => tools.find((tool) => tool.name === state.tool);

export function take_tool(name: string): void {
  if (name === state.tool || (name !== "navigate" && !may_edit())) return;
  active_tool()?.left?.();
  set({tool: name});
  // The inspector shows the tool's rows.
  if (name !== "navigate") set({right_tab: "inspector"});
  active_tool()?.taken?.();
}

// A tool's unfinished work belongs to the plan that the window leaves.
on_leaving_plan(() => {
  active_tool()?.left?.();
  set({tool: "navigate"});
});
