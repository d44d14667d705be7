// SPDX-License-Identifier: AGPL-3.0-or-later
// Light or dark, as the person or the system has chosen.
import {set, state, watch} from "../state";

export const is_dark = (): boolean => state.theme === "dark" ||
    (state.theme === "system" && matchMedia("(prefers-color-scheme: dark)").matches);

/// Background of views on a dark page. On a light page their background is white, as in `octotomy render`.
export const dark_ground = "#0b0f14";

export function change_theme(): void {
  set({theme: is_dark() ? "light" : "dark"});
}

/// Applies the chosen theme to the page and stores it in the browser.
export function follow_theme(): void {
  const again = (): void => {
    document.documentElement.dataset.theme = is_dark() ? "dark" : "light";
    localStorage.setItem("octotomy-theme", state.theme);
  };
  const kept = localStorage.getItem("octotomy-theme");
  if (kept === "light" || kept === "dark") set({theme: kept});
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => set({theme: state.theme}));
  watch(["theme"], again);
  again();
}
