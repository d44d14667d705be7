// SPDX-License-Identifier: AGPL-3.0-or-later
// The page of a verification: shares of tolerance by quantity, pictures of the worst certificate,
// certificates, the suite's own tables, the parts not covered.
import {Child, el} from "../../browser/page/base/html";
import {grouped, three_figures} from "../../browser/page/base/numbers";
import {Json} from "../../browser/page/protocol";
import {difference_of, notes_of} from "./certificates";
import {footer, list, overall_verdict, pill, plural, section, soft, svg, table, times} from "./elements";
import {colour_scale, png_figure} from "./pictures";
import {Certificate, Counts, Verdict} from "./result";

export interface Verification {
  kind: "verification"; octotomy: string; subject: string; counts: Counts; not_covered: string[];
  answer: {
    certificates?: Certificate[]; not_recomputed?: {where: string; why: string}[]; timings_ms: {[stage: string]: number};
    [suite: string]: unknown;
  };
  worst: {
    operation: string; verdict: Verdict; resolved: boolean; reasons: string[]; share: number|null; most_mm: number;
    colours: string[]; pictures: {view: string; png: string}[];
  }|null;
}

/// A difference as a share of its tolerance. Infinite if the tolerance is zero and the difference is not.
interface Share { value: number; verdict: Verdict }
const rank = {PASS: 0, WARN: 1, FAIL: 2};
const share_text = (share: number|null): string =>
    share === null || share === Infinity ? "∞" : three_figures(share);
const shares_of_one = (of: Certificate): (Share&{quantity: string})[] =>
    of.comparisons.flatMap(({quantity, difference, tolerance, verdict}) => difference === null || tolerance === null ? [] : [{
      quantity, verdict: verdict ?? "FAIL", value: difference === 0 ? 0 : tolerance > 0 ? difference / tolerance : Infinity
    }]);
const worst_of = (of: Certificate): number => Math.max(0, ...shares_of_one(of).map((share) => share.value));

/// The shares of all certificates of resolved objects, by quantity. The exact tier counts as one quantity.
function shares_of(certificates: Certificate[]): [string, Share[]][] {
  const shares = new Map<string, Share[]>();
  const add = (quantity: string, share: Share): void => {
    if (!shares.get(quantity)?.push(share)) shares.set(quantity, [share]);
  };
  for (const of of certificates.filter((one) => one.resolved))
    if (of.tier === "exact")
      add("exact tier", {value: of.verdict === "PASS" ? 0 : Infinity, verdict: of.verdict});
    else
      for (const share of shares_of_one(of)) add(share.quantity, share);
  for (const all of shares.values()) all.sort((a, b) => a.value < b.value ? -1 : a.value > b.value ? 1 : 0);
  return [...shares].sort(([a], [b]) => a < b ? -1 : 1);
}

/// A histogram of shares on a logarithmic scale from 0.001 to 10. Shares beyond an end are counted at that
/// end.
function histogram(shares: Share[]): SVGElement {
  const bins = 64, low = -3, high = 1, width = 640, height = 34;
  const counts: number[] = new Array(bins).fill(0);
  for (const {value} of shares) {
    const at = value > 0 ? (Math.log10(value) - low) / (high - low) : 0;
    counts[Math.floor(Math.max(0, Math.min(1, at)) * (bins - 1))]++;
  }
  const most = Math.max(...counts);
  const line = (share: number, stroke: string): SVGElement =>
      svg("path", {d: `M${(width * (Math.log10(share) - low) / (high - low)).toFixed(2)} 0V${height}`, stroke});
  const bars = counts.map((count, bin) => {
    if (!count) return null;
    const tall = Math.max(1.5, (height - 2) * Math.sqrt(count / most));
    const share = 10 ** (low + (high - low) * (bin + 0.5) / bins);
    const fill = share <= 1 ? "var(--accent)" : share <= 2 ? "var(--warn)" : "var(--bad)";
    return svg("rect", {x: width * bin / bins, y: height - tall, width: width / bins - 1, height: tall, fill},
               svg("title", {}, String(count)));
  });
  return svg("svg", {viewBox: `0 0 ${width} ${height}`, width: "100%", role: "img", "aria-label": "Histogram of the shares"},
             line(0.01, "var(--line)"), line(0.1, "var(--line)"), bars, line(1, "var(--good)"), line(2, "var(--bad)"));
}

function quantities(certificates: Certificate[]): Child {
  const rows = shares_of(certificates).map(([quantity, all]) => {
    const at = (part: number): string => share_text(all[Math.floor(part * (all.length - 1))]!.value);
    const worst = all.reduce((a, b) => rank[b.verdict] > rank[a.verdict] ? b : a).verdict;
    return [quantity, histogram(all), grouped(all.length), at(0.5), at(0.99), at(1), pill(worst)];
  });
  return rows.length ? section("Observed against allowed", table(
      ["Quantity", "difference / allowed, from 0.001 to 10; green: all that is allowed, red: a failure", "#compared",
       "#median", "#99 %", "#largest", ""], rows),
      soft("The height of a bar is the square root of its count. Objects that voxels do not resolve are left out.")) : null;
}

const worst_pictures = ({worst}: Verification): Child => worst && section(
    "Worst certificate",
    el("p", {}, pill(worst.verdict, worst.resolved), " ", el("code", {}, worst.operation), `, ${share_text(worst.share)} ` +
       "of the allowed difference. The voxel kernel's surface, coloured by its signed distance to the mesh kernel's."),
    list(worst.reasons), colour_scale(worst.most_mm, worst.colours),
    el("div", {class: "pictures four"}, worst.pictures.map((one) => png_figure(one.png, one.view, one.view))));

/// Certificates as tables: all if they are few, otherwise those with the largest shares of a tolerance.
function certificates(all: Certificate[]): Child {
  const most_shown = 30;
  const is_few = all.length <= most_shown;
  const shown = is_few ? all : [...all].sort(
      (a, b) => rank[b.verdict] - rank[a.verdict] || Number(b.resolved) - Number(a.resolved) ||
          (worst_of(a) === worst_of(b) ? 0 : worst_of(b) > worst_of(a) ? 1 : -1)).slice(0, most_shown);
  return all.length ? section(
      is_few ? "Certificates" : `The ${most_shown} worst of ${all.length} certificates`,
      table(["Question", "Tier", "", "#voxel, mm³", "#mesh, mm³", "#difference / allowed, mm³", "#largest share"],
            shown.map((of) => [
              [el("code", {}, of.operation), list(notes_of(of))], of.tier, pill(of.verdict, of.resolved),
              grouped(of.voxel.volume_mm3, 1), grouped(of.mesh.volume_mm3, 1), difference_of(of), share_text(worst_of(of))
            ]))) : null;
}

function value_text(value: Json): string {
  if (value === null || value === undefined) return "–";
  if (typeof value === "boolean") return value ? "yes" : "no";
  if (typeof value === "number") return Number.isInteger(value) ? grouped(value) : three_figures(value);
  return typeof value === "object" ? Object.values(value).map(value_text).join(", ") : value;
}
/// A table of a suite, with a row for each entry. The entries must all have the same keys.
function suite_table(answer: Verification["answer"], key: string, title: string): Child {
  const entries = answer[key] as {[column: string]: Json}[]|undefined;
  if (!Array.isArray(entries) || !entries[0] || typeof entries[0] !== "object") return null;
  const heads = Object.entries(entries[0]).map(
      ([column, value]) => (typeof value === "number" ? "#" : "") + column.replace(/_/g, " "));
  return section(title, table(heads, entries.map((entry) => Object.values(entry).map(value_text))));
}
const suites = {
  checks: "Checks", intervals: "Coverage of intervals", calibration: "Calibration", tightness: "Tightness",
  convergence: "Convergence", faults: "Seeded faults", power: "Detection power", missed: "Missed faults",
  disagreements: "Disagreements", tables: "Recomputed entries"
};

function not_covered({counts, answer, not_covered: lines}: Verification): Child {
  // Inputs and code that both answers of a certificate share, with the number of such certificates.
  const shared = new Map<string, number>();
  for (const entry of (answer.certificates ?? []).flatMap((of) => [...of.shared_makers, ...of.shared_values]))
    shared.set(entry, (shared.get(entry) ?? 0) + 1);
  return section("Not covered", list([
    ...lines,
    ...(counts.not_resolved ? [`${plural(counts.not_resolved, "object")} not resolved: a PASS on fewer than six voxels, ` +
                               "or on a sheet thinner than one, proves little"] : []),
    ...(answer.not_recomputed ?? []).map((gap) => `${gap.where}: ${gap.why}`),
    ...[...shared].sort(([a], [b]) => a < b ? -1 : 1).map(
        ([entry, count]) => `both answers of ${plural(count, "certificate")} share ${entry}`),
    "parts that all certificates share and so cannot check: reading scans, choosing a window's whole samples, plans' names " +
        "and motions' matrices, convert::voxelise, which decides which points lie inside a mesh, and whether a window is the " +
        "tissue that it is meant for"
  ]));
}

export const verification = (of: Verification): Child => [
  el("header", {},
     el("div", {}, el("h1", {}, "Verification"), el("p", {class: "soft"}, `${of.subject} · Octotomy ${of.octotomy}`)),
     overall_verdict(of.counts)),
  quantities(of.answer.certificates ?? []), worst_pictures(of), certificates(of.answer.certificates ?? []),
  Object.entries(suites).map(([key, title]) => suite_table(of.answer, key, title)), not_covered(of),
  footer(of.octotomy, `A planning and research tool, not a medical device. Times: ${times(of.answer.timings_ms)}.`)
];
