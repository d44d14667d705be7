// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the page that the program wrote: its data are JSON in the element "data".
import {Child, fill} from "../../browser/page/base/html";
import {Cohort, cohort} from "./cohort";
import {Credibility, credibility} from "./credibility";
import {report} from "./report";
import {Report} from "./result";
import {Verification, verification} from "./verification";

type Page = Report|Credibility|Verification|Cohort;
function drawn(page: Page): Child {
  switch (page.kind) {
    case "report": return report(page);
    case "credibility": return credibility(page);
    case "verification": return verification(page);
    case "cohort": return cohort(page);
  }
}

// The page is dark or light on a screen, as the system prefers, and light on paper.
const dark = matchMedia("screen and (prefers-color-scheme: dark)");
const follow_theme = (): void => {
  document.documentElement.dataset.theme = dark.matches ? "dark" : "light";
};
dark.addEventListener("change", follow_theme);
addEventListener("beforeprint", () => {
  document.documentElement.dataset.theme = "light";
});
addEventListener("afterprint", follow_theme);
// The planner's page around a report does not receive keys pressed in the report, so Escape is passed on.
addEventListener("keydown", (event) => {
  if (event.key === "Escape" && parent !== window) parent.postMessage("Escape", "*");
});
follow_theme();
fill(document.querySelector("main")!, drawn(JSON.parse(document.getElementById("data")!.textContent!) as Page));
