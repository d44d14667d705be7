// SPDX-License-Identifier: AGPL-3.0-or-later
// Who has read and approved the plan, what has changed since, and a new signature.
import {busy, change_plan, done, try_to} from "../actions";
import {open_dialog} from "../base/dialog";
import {button, Child, el} from "../base/html";

interface Signature {
  by: string;
  as: string;
  note: string;
  at: string;
  changed_since: string[];
}

export async function open_signatures(): Promise<void> {
  const dialog = open_dialog("Signatures", "sign");
  const typed = {by: "", as: "reader", note: ""};
  const again = async(): Promise<void> => {
    const job = busy("Reading the scans' checksums");
    dialog.refill(el("p", {class: "says", role: "status"}, "Reading the scans' checksums …"));
    const found = await try_to<{signatures: Signature[]}>("signatures");
    done(job);
    const field = (key: keyof typeof typed, label: string): Child =>
        el("label", {class: "field"}, el("span", {}, label), el("input", {
             name: key,
             value: typed[key],
             maxlength: 200,
             oninput: (event: Event) => { typed[key] = (event.target as HTMLInputElement).value; }
           }));
    dialog.refill(
        found?.signatures.length ?
            el("ul", {class: "audit"}, found.signatures.map(row_of)) :
            el("p", {class: "says"}, "Nobody has signed this plan."),
        el("form", {
          class: "sign-form",
          onsubmit: (event: Event) => {
            event.preventDefault();
            void sign();
          }
        },
           el("h3", {}, "Sign the plan as it is now"), field("by", "Name"), field("as", "Role"), field("note", "Remark"),
           el("p", {class: "says"},
              "A signature states checksums of the plan and its scans, so that later changes are detected. It does not prove who signed."),
           el("div", {class: "row end"}, button("Sign", "Adds the signature to the plan", () => undefined, {class: "primary", type: "submit"}))));
  };
  const sign = async(): Promise<void> => {
    const job = busy("Signing");
    const plan = await change_plan("sign", typed);
    done(job);
    if (plan) await again();
  };
  await again();
}

function row_of(one: Signature): Child {
  const holds = one.changed_since.length === 0;
  const list = new Intl.ListFormat("en").format(one.changed_since);
  return el(
      "li", {},
      el("span", {class: `badge ${holds ? "pass" : "warn"}`, role: "img", "aria-label": holds ? "holds" : "changed since"},
         holds ? "✓" : "!"),
      el("span", {}, el("b", {}, one.by), `, ${one.as}, ${new Date(one.at).toLocaleString()}: `,
         holds ? "holds" : `${list} changed since`, one.note ? el("p", {class: "says"}, one.note) : null));
}
