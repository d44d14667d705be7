// SPDX-License-Identifier: AGPL-3.0-or-later
// The report's table of movements, and the cephalometric one.
import {Child, el} from "../../browser/page/base/html";
import {grouped} from "../../browser/page/base/numbers";
import {Row, section, soft, table} from "./elements";
import {png_figure} from "./pictures";
import {CephalometryTable, Displacement, Result} from "./result";

const signed = (mm: number): string =>
    (mm > 0.005 ? "+" : "") + grouped(Math.abs(mm) < 0.005 ? 0 : mm, 2);
const along = (by: Displacement|null): string[] =>
    by ? [signed(by.forward_mm), signed(by.up_mm), signed(by.left_mm)] : ["", "", ""];

/// A row for each moved piece, for each landmark on it and for each point with a prescribed target.
export function movements({movements, movement_words}: Result): Child {
  const rows = movements.flatMap((moved): Row[] => [
    {lead: [el("b", {}, moved.object), ...along(moved.centroid), moved.words]},
    ...moved.landmarks.map((one) => [
      one.name, ...along(one), one.words + (one.since_scan ? `, since the scan ${one.since_scan.words}` : "")
    ]),
    ...(moved.points ?? []).map((one) => [
      `${one.name}, wanted`, ...along(one), `wanted ${one.wanted}, came within ${grouped(one.residual_mm, 2)} mm`
    ])
  ]);
  if (!rows.length) return null;
  return section(
      "Movements", table(["Piece or point", "#forward, mm", "#up, mm", "#left, mm", "In words"], rows),
      soft(movement_words, " A piece's own row is its centroid; landmarks are those that its bone is nearest to."));
}

export function cephalometry(of: CephalometryTable|null, cephalogram: string): Child {
  if (!of) return null;
  const rows = of.measures.map((row) => {
    const interval = (value: {value: number; half_width: number}|null, is_change = false): string => value ?
        `${is_change && value.value > 0.05 ? "+" : ""}${grouped(value.value, 1)} ± ${grouped(value.half_width, 1)}` :
        "–";
    return [
      `${row.name}, ${row.unit === "deg" ? "°" : row.unit}`, el("span", {class: "soft"}, row.says), interval(row.before),
      interval(row.after), interval(row.change, true),
      row.norm === null ? "–" : `${grouped(row.norm, 1)} ± ${grouped(row.deviation, 1)}`
    ];
  });
  return section(
      "Cephalometry",
      cephalogram && el("div", {class: "pictures two"}, png_figure(
          cephalogram, "The radiograph from the right with landmarks and lines of the lateral measures",
          "Radiograph in true scale; pale: the patient, orange: planned.")),
      table(["Measure", "", "#before", "#planned", "#change", "#norm"], rows),
      soft(`After each ±, the half-width due to landmarks placed to ${grouped(of.landmark_deviation_mm, 1)} mm (standard deviation along ` +
           "each axis), in 99 of 100 cases; after each norm, its standard deviation among people."));
}
