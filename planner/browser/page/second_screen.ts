// SPDX-License-Identifier: AGPL-3.0-or-later
// A second window that shows one pane large. It has its own connection, so it follows the plan; how the first window
// shows the plan comes over a channel between windows of this browser.
import {PaneSetting, set, shows_one_pane, State, state, watch} from "./state";

/// Parts of the state that the second window takes over from the first one.
const followed = [
  "looks", "selected", "scan", "cross_mm", "grey", "draft_window", "preview", "compare", "cut_plane", "arch_mm", "hides_names", "marked",
  "theme", "hides_patient"
] as const;
type Followed = Pick<State, typeof followed[number]>;

interface Message {
  path: string;  // of the plan: one window may have opened another plan already
  asks_pane?: number;
  pane?: {setting: PaneSetting; side_px: number};
  values?: Partial<Followed>;
}

let channel: BroadcastChannel|null = null;
// The last values that were sent or received, as texts. Only other values are sent.
let known: {[key: string]: string} = {};
const text_of = (value: unknown): string => JSON.stringify(value) ?? "";

function say(said: Omit<Message, "path">): void {
  const message: Message = {path: state.plan?.path ?? "", ...said};
  channel?.postMessage(message);
}

function say_changes(keys: readonly (keyof Followed)[]): void {
  const values: {[key: string]: unknown} = {};
  for (const key of keys) {
    const text = text_of(state[key]);
    if (text === known[key]) continue;
    known[key] = text;
    values[key] = state[key];
  }
  if (Object.keys(values).length) say({values: values as Partial<Followed>});
}

function take_values(values: Partial<Followed>): void {
  for (const [key, value] of Object.entries(values)) known[key] = text_of(value);
  set(values);
}

const side_of = (pane: number): number => {
  const canvas = document.querySelectorAll<HTMLElement>(".pane canvas")[pane];
  return canvas ? Math.min(canvas.clientWidth, canvas.clientHeight) : 0;
};

/// Opens a pane in a second browser window, which can be moved to another screen.
export function open_second_screen(pane: number): void {
  const number = sessionStorage.getItem("octotomy-screen") ?? crypto.randomUUID();
  sessionStorage.setItem("octotomy-screen", number);
  lead(number);
  window.open(`/${location.search}#screen=${number}&pane=${pane}`, `octotomy-${number}-${pane}`, "popup,width=1200,height=900");
}

/// Sends the followed values to second windows. The number is stored for the session, so that second windows
/// still follow after the first one is reloaded.
function lead(number: string): void {
  if (channel) return;
  channel = new BroadcastChannel(`octotomy-${number}`);
  channel.onmessage = ({data}: MessageEvent<Message>): void => {
    if (data.path !== state.plan?.path) return;
    if (data.values) take_values(data.values);
    if (data.asks_pane === undefined) return;
    const setting = state.panes[data.asks_pane];
    known = {};
    if (setting) say({pane: {setting, side_px: side_of(data.asks_pane)}});
    say_changes(followed);
  };
  watch([...followed], () => say_changes(followed));
}

/// Starts following the first window, if the address states that this is the second one. Otherwise continues
/// to lead second windows, if there were any before a reload.
export function begin_screen(): void {
  const address = new URLSearchParams(location.hash.slice(1));
  const number = address.get("screen"), pane = Number(address.get("pane") ?? 0);
  const led = sessionStorage.getItem("octotomy-screen");
  if (!shows_one_pane || !number) return led ? lead(led) : undefined;
  channel = new BroadcastChannel(`octotomy-${number}`);
  let is_led = false, asked_for = "";
  channel.onmessage = ({data}: MessageEvent<Message>): void => {
    if (data.path !== state.plan?.path) return;
    if (data.pane) {
      const {setting, side_px} = data.pane, side = side_of(0);
      const scale = side_px && side ? side_px / side : 1;
      set({panes: state.panes.map((one, index) => index ? one : {...setting, pixel_mm: setting.pixel_mm * scale})});
    }
    if (!data.values) return;
    is_led = true;
    take_values(data.values);
  };
  // Each window opens and leaves plans by itself. For a new plan, this one requests the settings again.
  watch(["plan"], () => {
    const path = state.plan?.path ?? "";
    if (path === asked_for) return;
    asked_for = path;
    is_led = false;
    if (path) say({asks_pane: pane});
  });
  // A click in this window also moves the cross-hair of the first one.
  watch(["cross_mm"], () => {
    if (is_led) say_changes(["cross_mm"]);
  });
}
