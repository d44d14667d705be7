// SPDX-License-Identifier: AGPL-3.0-or-later
// The badge that shows a number's certificate: both kernels agree, they agree with a warning, they disagree,
// or nothing is certified yet.
import {Child, el} from "../base/html";
import {grouped, unit_text} from "../base/numbers";
import {show_place} from "../pane/pane_grid";
import {Certificate, Measured} from "../protocol";
import {set} from "../state";

const words = {
  PASS: "both kernels agree",
  WARN: "the kernels agree, with a warning",
  FAIL: "the kernels disagree"
} as const;
const signs = {
  PASS: "✓",
  WARN: "!",
  FAIL: "✕"
} as const;

/// Whether the half-width of a number's interval is larger than the number, so that the number's size is
/// unknown.
export const is_wider_than_its_value = (measured: Measured|null|undefined): boolean =>
    measured !== null && measured !== undefined && measured.value !== null &&
    (measured.half_width ?? 0) > Math.abs(measured.value);

/// The certificate for a number's badge. PASS becomes WARN if the half-width of the interval is larger than
/// the number.
export function judged(
    certificate: Certificate|null|undefined, measured: Measured|null|undefined): Certificate|null|undefined {
  if (certificate?.verdict !== "PASS" || !is_wider_than_its_value(measured)) return certificate;
  return {
    ...certificate,
    verdict: "WARN",
    sentence: `The interval is wider than the value: its size is not known. ${certificate.sentence}`
  };
}

/// A badge with a number's verdict. Its tip is the certificate's sentence; a click shows the certificate's
/// place in all panes.
export function badge(
    id: string, of_kernels: Certificate|null|undefined, measured?: Measured|null): Child {
  const certificate = judged(of_kernels, measured);
  if (!certificate)
    return el(
        "span", {
          class: "badge none",
          role: "img",
          "aria-label": `${id}: not certified`,
          "data-tip": "Not certified yet. Certify computes all objects in both kernels and compares them."
        },
        "·");
  const resolved = certificate.resolved === false ? " Not resolved: smaller than the voxels can resolve." : "";
  return el(
      "button", {
        type: "button",
        class: `badge ${certificate.verdict.toLowerCase()}${
            certificate.resolved === false ? " unresolved" : ""}`,
        "aria-label": `${id}: ${words[certificate.verdict]}`,
        "data-tip":
            `${certificate.sentence}${resolved}${certificate.place ? " Click to see the place." : ""}`,
        onclick: (event: MouseEvent) => {
          event.stopPropagation();
          set({selected: id});
          if (certificate.place) show_place(certificate.place, certificate.sentence);
        },
      },
      signs[certificate.verdict]);
}

/// A value with its half-width and unit, such as "56 764 ± 310 mm³": only as many decimals as the half-width
/// justifies, and a dash if there is no value.
export function measured_text(measured: Measured|null|undefined): string {
  if (!measured || measured.value === null || !Number.isFinite(measured.value)) return "–";
  const unit = unit_text(measured.unit);
  const half = measured.half_width ?? null;
  const is_length = unit === "mm" || unit === "°";
  const digits = unit === "per mm" ? 4 : is_length ? 2 : Math.abs(measured.value) < 100 ? 1 : 0;
  const number = grouped(measured.value, digits);
  return half === null || half === 0 ?
      `${number} ${unit}`.trimEnd() :
      `${number} ± ${grouped(half, half < 10 ? Math.max(digits, 1) : 0)} ${unit}`.trimEnd();
}
