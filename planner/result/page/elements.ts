// SPDX-License-Identifier: AGPL-3.0-or-later
// The elements of all pages: tables, lists, verdicts as labels, SVG. Text enters as text nodes and
// attributes, so that no name in a result can become markup.
import {Attributes, Child, el, put} from "../../browser/page/base/html";
import {grouped, three_figures} from "../../browser/page/base/numbers";
import {Counts, Interval, Verdict} from "./result";

/// A row of a table: its cells; or `lead`, cells without a line below, because a wide_row() follows; or a
/// finished row.
export type Row = Child[]|{lead: Child[]}|HTMLElement;

/// A table with heads and rows. A head that begins with "#" marks a column of numbers, which is aligned
/// right.
export function table(heads: readonly string[], rows: readonly Row[], above: Child = null): HTMLElement {
  const columns = heads.map((head) => head.startsWith("#") ? "n" : null);
  const drawn = (cells: Child[], css: string|null): Child =>
      el("tr", {class: css}, cells.map((cell, i) => el("td", {class: columns[i]}, cell)));
  return el(
      "table", {},
      el("thead", {}, above,
         el("tr", {}, heads.map(
             (head, i) => head ? el("th", {scope: "col", class: columns[i]}, head.replace("#", "")) : el("td")))),
      el("tbody", {}, rows.map(
          (row) => Array.isArray(row) ? drawn(row, null) : "lead" in row ? drawn(row.lead, "lead") : row)));
}
/// A row with a single cell that spans several columns.
export const wide_row = (columns: number, ...children: Child[]): HTMLElement =>
    el("tr", {}, el("td", {colspan: columns}, children));
/// A heading followed by its contents; null if there are none.
export const section = (title: string, ...children: Child[]): Child =>
    children.some((child) => child && !(Array.isArray(child) && !child.length)) ? [el("h2", {}, title), children] : null;
export const soft = (...children: Child[]): HTMLElement => el("p", {class: "soft small"}, children);
/// Lines as a list; null if there are none.
export const list = (lines: readonly string[]|null|undefined): Child =>
    lines?.length ? el("ul", {class: "findings small"}, lines.map((line) => el("li", {}, line))) : null;
export const footer = (version: string, ...children: Child[]): HTMLElement =>
    el("footer", {}, `Octotomy ${version}. `, children);
export const facts = (...pairs: [string, Child][]): HTMLElement =>
    el("dl", {class: "facts"}, pairs.map(([name, value]) => [el("dt", {}, name), el("dd", {}, value)]));
/// The stages of a run, each with its time in ms, on one line.
export const times = (timings: {[stage: string]: number}): string =>
    Object.entries(timings).map(([stage, ms]) => `${stage} ${grouped(ms)} ms`).join(" · ");

/// An SVG element. Values of attributes may come from data, names of elements and attributes may not.
export function svg(tag: string, attributes: Attributes = {}, ...children: Child[]): SVGElement {
  const made = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes))
    if (value !== null && value !== undefined) made.setAttribute(name, String(value));
  put(made, children);
  return made;
}

/// A verdict as a coloured label. For an object that is not resolved the label states this, and a PASS is
/// grey.
export function pill(verdict: Verdict, resolved = true): HTMLElement {
  const css = resolved || verdict !== "PASS" ? verdict.toLowerCase() : "below";
  return el("span", {class: `pill ${css}`}, resolved ? verdict : `${verdict}, not resolved`);
}
/// A bar whose length is the share of `value` in `allowed`, at most 1.
export function gauge(value: number, allowed: number, verdict: Verdict): HTMLElement {
  const share = allowed > 0 ? Math.min(1, Math.abs(value) / allowed) : value === 0 ? 0 : 1;
  const bar = el("i", {style: `width:${(100 * share).toFixed(2)}%`});
  return el("span", {class: `gauge ${verdict.toLowerCase()}`}, bar);
}
export const plural = (count: number, one: string): string => `${count} ${one}${count === 1 ? "" : "s"}`;

/// A number with its half-width, if there is one.
export const doubtful =
    (value: number|null|undefined, half_width: number|null|undefined, digits: number): string =>
        grouped(value, digits) + (typeof half_width === "number" ? ` ± ${three_figures(half_width)}` : "");
export const recommended = (interval: Interval|undefined, digits: number): string =>
    doubtful(interval?.value, interval?.half_width, digits);

/// A sentence on the agreement of the kernels, with the counts of certificates and of measurements with a
/// verdict. Null if there is neither a certificate nor a failed measurement.
export function overall_verdict(counts: Counts): Child {
  const all = counts.PASS + counts.WARN + counts.FAIL;
  const failed = counts.measured?.FAIL ?? 0;
  if (!all && !failed) return null;
  const [css, title] = counts.FAIL ? ["fail", "The two kernels disagree"] :
      failed                       ? ["fail", "A measurement fails"] :
      counts.WARN                  ? ["warn", "The two kernels agree, with doubts"] :
      counts.PASS > counts.pass_not_resolved ?
                                     ["pass", "The two kernels agree"] :
                                     ["below", "The two kernels agree on objects that voxels do not resolve"];
  const few = (count: number, words: string): string => count ? words : "";
  return el(
      "div", {class: `verdict ${css}`}, el("b", {}, title),
      el("span", {class: "soft"}, `${plural(all, "certificate")}: ${counts.PASS} pass`,
         few(counts.WARN, `, ${counts.WARN} warn`), few(counts.FAIL, `, ${counts.FAIL} fail`),
         few(counts.not_resolved, `; ${counts.not_resolved} not resolved`),
         few(counts.without_certificate, `; ${plural(counts.without_certificate, "object")} without a certificate`),
         few(failed, `; ${plural(failed, "measurement")} with a FAIL`)));
}
