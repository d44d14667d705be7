// SPDX-License-Identifier: AGPL-3.0-or-later
// The credibility page: each number with its evidence, and the standard's factors.
import {Child, el} from "../../browser/page/base/html";
import {three_figures, unit_text} from "../../browser/page/base/numbers";
import {Json} from "../../browser/page/protocol";
import {footer, list, section, table} from "./elements";

type Evidence = {[key: string]: Json};
export interface Credibility {
  kind: "credibility";
  credibility: {
    octotomy: string; terms: string; claim: string; context_of_use: {plan: string|null; statement_is: string};
    credibility_factors: {group: string; factor: string; evidence: Evidence[]; gap: string|null}[];
    numbers: {
      step: string; quantity: string; value: number; unit: string; supported_by: Evidence[]; contradicted_by: Evidence[];
      gaps: string[];
    }[];
  };
}

const spaced = (key: string): string => key.replace(/_/g, " ");
/// A value of any type as text on one line, such as "volume mm3 4.00, shift mm 0.0625".
function words(value: Json): string {
  if (typeof value === "number") return Number.isInteger(value) ? String(value) : three_figures(value);
  if (Array.isArray(value)) return value.map(words).join(", ");
  if (value && typeof value === "object")
    return Object.entries(value).map(([key, one]) => `${spaced(key)} ${words(one)}`).join(", ");
  return String(value);
}
const is_empty = (value: Json): boolean =>
    value === null || (typeof value === "object" && !Object.keys(value).length);
/// A line for each piece of evidence, such as "certificate, object skull, verdict PASS".
const lines_of = (all: Evidence[]): string[] => all.map(
    (one) => Object.entries(one).filter(([key, value]) => key !== "factor" && !is_empty(value))
                 .map(([key, value]) => key === "check" ? words(value) : `${spaced(key)} ${words(value)}`).join(", "));
const evidence = (all: Evidence[]): Child => list(lines_of(all)) ?? "nothing";

export function credibility({credibility: of}: Credibility): Child {
  const to_state = (name: string): Child => el("p", {}, el("b", {}, name), `: ${of.context_of_use.statement_is}.`);
  return [
    el("header", {}, el("div", {}, el("h1", {}, `Credibility: ${of.context_of_use.plan ?? "–"}`),
                        el("p", {class: "soft"}, `${of.claim} Terms: ${of.terms}.`))),
    to_state("Context of use"), to_state("Question of interest"),
    to_state("Model risk, of model influence and decision consequence"),
    section("Numbers and their evidence", table(
        ["Number", "#value", "supported by", "contradicted by", "gaps"],
        of.numbers.map((one) => [
          [el("b", {}, one.step), `, ${one.quantity}`],
          `${one.unit ? three_figures(one.value) : words(one.value)} ${unit_text(one.unit)}`.replace(" °", "°"),
          evidence(one.supported_by), list(lines_of(one.contradicted_by)), list(one.gaps)
        ]))),
    section("Credibility factors", table(
        ["Credibility factor", "This run", "Not in this run"],
        of.credibility_factors.map((one) => [
          [`${one.group}: `, el("b", {}, one.factor)], evidence(one.evidence), one.gap ?? "–"
        ]))),
    footer(of.octotomy, "The same as data: credibility.json.")
  ];
}
