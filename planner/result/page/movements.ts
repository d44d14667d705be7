// SPDX-License-Identifier: AGPL-3.0-or-later
// The report's tables of movements, of landmarks that move by ratios, and of cephalometry.
import {Child, el} from "../../browser/page/base/html";
import {grouped} from "../../browser/page/base/numbers";
import {list, Row, section, soft, table} from "./elements";
import {png_figure} from "./pictures";
import {CephalometryTable, Displacement, Result} from "./result";

const signed = (mm: number): string =>
    (mm > 0.005 ? "+" : "") + grouped(Math.abs(mm) < 0.005 ? 0 : mm, 2);
const along = (by: Displacement|null): string[] =>
    by ? [signed(by.forward_mm), signed(by.up_mm), signed(by.left_mm)] : ["", "", ""];

/// A table of motions: for each moved piece, each landmark on a piece, and each point with a target.
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

/// A table of the landmarks of the skin, which move by a ratio of the bone's motion.
export function ratios({objects}: Result): Child {
  const predictions = objects.filter((one) => one.kind === "landmark_ratios" && one.details?.landmarks);
  if (!predictions.length) return null;
  const rows = predictions.flatMap((one) => one.details!.landmarks!.map((at): Row => [
    one.id, at.name || at.at_mm.map((part) => grouped(part, 1)).join(", "), at.follows || "stays",
    at.ratio === null ? "–" : grouped(at.ratio, 2) + (at.ratio_up === at.ratio ? "" : `, up ${grouped(at.ratio_up, 2)}`),
    at.source, ...along(at), at.half_width_mm === null ? "–" : `± ${grouped(at.half_width_mm, 1)}`
  ]));
  return section(
      "Soft tissue by ratios of landmarks",
      table(["Prediction", "Landmark", "follows", "#ratio", "source", "#forward, mm", "#up, mm", "#left, mm", "#interval, mm"], rows),
      soft("A landmark of the skin moves by its ratio of the bone's motion; between landmarks the displacement is " +
           `interpolated, and beyond ${predictions.map((one) => `${grouped(one.details!.fade_mm, 0)} mm`).join(", ")} of all ` +
           "landmarks it is zero. Interval: 99 of 100 values, if ratios among people have the stated deviation; that of a published ratio is an estimate."));
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
      row.norm === null ? "–" : `${grouped(row.norm, 1)} ± ${grouped(row.deviation, 1)}`,
      el("span", {class: "soft"}, row.source)
    ];
  });
  const described = new Map(of.measures.flatMap((row) => row.norm_of ? [[row.source, row.norm_of] as const] : []));
  return section(
      "Cephalometry",
      cephalogram && el("div", {class: "pictures two"}, png_figure(
          cephalogram, "The radiograph from the right with landmarks and lines of the lateral measures",
          "Radiograph in true scale; pale: the patient, orange: planned.")),
      table(["Measure", "", "#before", "#planned", "#change", "#norm", "source"], rows),
      soft(`After each ±, the half-width due to landmarks placed to ${grouped(of.landmark_deviation_mm, 1)} mm (standard deviation along ` +
           "each axis), in 99 of 100 cases; after each norm, its standard deviation among the people of its source." +
           (of.not_predicted ? ` Nothing predicts where the skin goes for ${of.not_predicted.map((one) => one.name).join(", ")}: ` +
                "a landmark_ratios step does." : "")),
      list([...described].map(([source, people]) => `${source}: ${people}.`)));
}
