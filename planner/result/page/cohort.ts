// SPDX-License-Identifier: AGPL-3.0-or-later
// The page of a cohort, for quality control: subjects without an answer and the reasons, doubtful subjects, findings,
// numbers and plots, outliers, and the pictures of all subjects, which are in the subjects' folders.
import {Child, el} from "../../browser/page/base/html";
import {grouped, three_figures} from "../../browser/page/base/numbers";
import {list, section, table} from "./elements";

interface Spread { mean: number; sd: number; least: number; median: number; greatest: number }
interface Subject {
  label: string;
  reason: string;  // why there is no answer; empty if there is one
  has_picture: boolean; is_doubtful: boolean;
  audit: string;  // findings of a doubtful subject's audits
}
export interface Cohort {
  kind: "cohort"; subjects: Subject[]; findings: string[];
  columns: {
    name: string; unit: string; plots: string[];  // as SVG
    summary: Spread&{
      subjects: number; outliers: {subject: string; value: number}[]; doubtful: string[]; without_doubtful?: Spread;
    };
  }[];
}

const link = (label: string): Child => el("a", {href: `#${label}`}, label);
const picture = ({label, has_picture}: Subject): Child => has_picture ?
    el("img", {loading: "lazy", width: 160, height: 160, src: `../sub-${label}/picture.png`, alt: `Subject ${label}`}) :
    el("span", {class: "none"}, "no picture");
/// A plot as an element. The program wrote its SVG, which takes the colours of the page.
const plot = (text: string): Child =>
    el("div", {class: "plot"}, new DOMParser().parseFromString(text, "image/svg+xml").documentElement);
const reasons = (subjects: Subject[], reason: (one: Subject) => string): Child =>
    el("ul", {}, subjects.map((one) => el("li", {}, link(one.label), `: ${reason(one)}`)));

export function cohort({subjects, findings, columns}: Cohort): Child {
  const doubtful = subjects.filter((one) => one.is_doubtful);
  const missing = subjects.filter((one) => one.reason);
  const outlying = (label: string): Child[] => columns.flatMap(
      ({name, unit, summary}) => summary.outliers.filter((one) => one.subject === label)
                                     .map(({value}) => [el("br"), `${name} ${three_figures(value)} ${unit}`]));
  const labels = new Set(columns.flatMap(({summary}) => summary.outliers.map((one) => one.subject)));
  const outliers = subjects.filter((one) => labels.has(one.label));
  const caption = (one: Subject): string => one.label + (labels.has(one.label) ? ": outlier" : "") +
      (one.is_doubtful ? ": doubtful" : "") + (one.reason ? ": without an answer" : "");
  return [
    el("h1", {}, `Cohort of ${subjects.length} subjects`),
    el("p", {}, `With an answer: ${subjects.length - missing.length}, ${doubtful.length} of them doubtful. `,
       `Without one: ${missing.length}.`),
    doubtful.length ? section(
        "Doubtful",
        el("p", {}, "The audit of a scan has a FAIL. The numbers below count these subjects; look at each before " +
           "you trust them."),
        reasons(doubtful, (one) => one.audit)) : null,
    missing.length ? section("Without an answer", reasons(missing, (one) => one.reason)) : null,
    section("Findings", list(findings)),
    section("Numbers", table(
        ["Number", "Unit", "#Subjects", "#Mean", "#SD", "#Least", "#Median", "#Greatest", "#Outliers", "#Doubtful",
         "#Mean without doubtful"],
        columns.map(({name, unit, summary: of}) => [
          name, unit, grouped(of.subjects), ...[of.mean, of.sd, of.least, of.median, of.greatest].map(three_figures),
          grouped(of.outliers.length), grouped(of.doubtful.length),
          of.without_doubtful ? three_figures(of.without_doubtful.mean) : ""
        ]))),
    section("Outliers", outliers.length ? [
      el("p", {}, "Numbers more than 3.5 robust standard deviations from their median. Each picture is drawn to its " +
         "own scale."),
      el("div", {class: "subjects"}, outliers.map((one) => el(
          "figure", {}, picture(one), el("figcaption", {}, link(one.label), outlying(one.label)))))
    ] : el("p", {}, "None: no number lies more than 3.5 robust standard deviations from its median.")),
    section("Plots", el("div", {class: "plots"}, columns.flatMap((column) => column.plots.map(plot)))),
    section("Subjects", el("div", {class: "subjects"}, subjects.map((one) => el(
        "figure", {id: one.label, class: labels.has(one.label) ? "outlier" : null}, picture(one),
        el("figcaption", {}, caption(one))))))
  ];
}
