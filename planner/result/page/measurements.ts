// SPDX-License-Identifier: AGPL-3.0-or-later
// The tables of measurements, one function for each kind: sizes, lengths, flaps, contacts, airways, guesses of
// landmarks, trials.
import {Child, el} from "../../browser/page/base/html";
import {grouped, three_figures, unit_text} from "../../browser/page/base/numbers";
import {Vec3} from "../../browser/page/base/vector";
import {doubtful, list, pill, plural, recommended, Row, section, soft, svg, table, wide_row} from "./elements";
import {Airway, Measurement, OneWay} from "./result";

const with_unit = (value: number|null, digits: number, unit: string): string =>
    value === null ? "–" : `${grouped(value, digits)}${unit}`;

function sizes(all: Measurement[]): Child {
  const group = (columns: number, words: string): Child => el("th", {class: "n group", colspan: columns}, words);
  const rows = all.filter((one) => one.volume_mm3 !== undefined).flatMap((one): Row[] => [
    [
      one.id, one.object, el("b", {}, recommended(one.volume, 1)), grouped(one.volume_mm3, 1),
      grouped(one.mesh?.volume_mm3, 1), grouped(one.difference_mm3, 1), grouped(one.difference_percent, 2),
      el("b", {}, recommended(one.area, 0)), grouped(one.voxel.area_mm2), grouped(one.mesh && one.area_mm2)
    ],
    ...(one.finding ? [wide_row(10, one.finding)] : [])
  ]);
  if (!rows.length) return null;
  return [
    table(
        ["Measurement", "Object", "#recommended", "#voxel kernel", "#mesh kernel", "#difference", "#%", "#recommended",
         "#Crofton 13", "#isosurface"],
        rows, el("tr", {}, el("td", {colspan: 2}), group(5, "Volume, mm³"), group(3, "Area, mm²"))),
    soft("Recommended: one number by the scan's own samples; the true value lies within its ± in 99 of 100 cases. " +
         "Volume: voxels counted, and the mesh's enclosed volume by the divergence theorem. Area: Crofton formula over 13 " +
         "directions on voxels (up to 9 % low on flat cuts), and the triangles of the isosurface.")
  ];
}

function lengths(all: Measurement[]): Child {
  const rows = all.flatMap((one): Row[] => [
    ...(one.gap_mm === undefined ? [] : [[
      one.id, `gap, ${one.object} to ${one.to}`, `${doubtful(one.gap_mm, one.gap_half_width_mm, 2)} mm`,
      `${grouped(one.gap_mesh_mm, 2)} mm`, `${grouped(one.overlap_mm3, 1)} mm³`
    ]]),
    ...(one.distance_mm === undefined ? [] : [[
      one.id, "distance of two points", `${doubtful(one.distance_mm, one.distance_half_width_mm, 2)} mm`, "", ""
    ]]),
    ...(one.angle_deg === undefined ? [] : [[
      one.id, "angle at the second of three points", `${doubtful(one.angle_deg, one.angle_half_width_deg, 2)}°`, "", ""
    ]])
  ]);
  return rows.length ? table(["Measurement", "", "#voxel kernel", "#mesh kernel", "#overlap"], rows) : null;
}

function flap(one: Measurement): Child {
  const cut = (of: {at_mm: number; tilt_deg: number}): string =>
      `${with_unit(of.at_mm, 1, " mm")}, ${with_unit(of.tilt_deg, 1, "°")}`;
  return [
    el("h3", {}, `Free flap ${one.id}`),
    table(
        ["Segment", "#length", "#shortest side", "#longest side", "#angle to the one before", "#first cut on the donor",
         "#second cut"],
        one.flap_segments!.map((part) => [
          `${part.number}. ${part.object}`, with_unit(part.length_mm, 1, " mm"), with_unit(part.shortest_mm, 1, " mm"),
          with_unit(part.longest_mm, 1, " mm"), with_unit(part.angle_to_last_deg, 1, "°"), cut(part.first_cut),
          cut(part.second_cut)
        ])),
    table(
        ["Osteotomy", "between", "#contact, voxel kernel", "#contact, mesh kernel", "#allowed difference", "certificate"],
        one.osteotomies.flatMap((of): Row[] => [
          [
            `${of.number}. ${of.object}`, of.between.join(" and "), with_unit(of.contact_voxels_mm2, 0, " mm²"),
            with_unit(of.contact_mesh_mm2, 0, " mm²"), with_unit(of.tolerance_mm2, 0, " mm²"), of.verdict ?? "–"
          ],
          ...(of.finding ? [wide_row(6, of.finding)] : [])
        ])),
    soft(`Segments are in their order along the curve and along the donor, which gives ${
        with_unit(one.donor_used_mm, 1, " mm")}. Lengths are along the axis; sides are as far out as the bone may reach. ` +
         "Cuts are given by their place along the donor's axis from its first point and their tilt from a square cut. " +
         `Contact: ${one.contact_estimator}.`)
  ];
}

function contacts(one: Measurement): Child {
  const all = one.contacts!;
  const certain = one.certain_count === null ? "" : `, ${one.certain_count} of them beyond doubt`;
  const nearest =
      all.length || one.nearest_mm === null ? "" : `; the nearest is ${grouped(one.nearest_mm, 2)} mm away`;
  return [
    el("h3", {}, `Contacts ${one.id}`),
    el("p", {}, `${plural(all.length, "place")} of ${one.object} within ${grouped(one.within_mm, 2)} mm of ${
        one.against}${certain}${nearest}. Distances are signed, negative where they overlap.`),
    all.length ? table(
                     ["Contact", "#x, y, z, mm", "#nearest, mesh kernel, mm", "#nearest, voxel kernel, mm", "#depth, mm",
                      "#area, mm²"],
                     all.map((of, i) => [
                       String(i + 1), of.at_mm.map((part) => grouped(part, 1)).join(", "),
                       doubtful(of.nearest_mm, of.half_width_mm, 2), grouped(of.voxel_nearest_mm, 2),
                       grouped(of.depth_mm, 2), grouped(of.area_mm2, 1)
                     ])) :
                 null,
    list(one.findings)
  ];
}

/// A plot of signed distances: for each interval of distances, a bar with the share of the surfaces.
function distance_plot({low_mm, width_mm, shares}: NonNullable<Measurement["histogram"]>): SVGElement {
  const width = 640, height = 150, below = 34, above = 12;
  const most = Math.max(1e-9, ...shares), high_mm = low_mm + width_mm * shares.length;
  const x = (mm: number): number => width * (mm - low_mm) / (high_mm - low_mm || 1);
  const words = (at_x: number, anchor: string, text: string): SVGElement => svg(
      "text", {"font-size": 12, "font-family": "sans-serif", fill: "var(--quiet)", x: at_x.toFixed(2), y: height - below + 16, "text-anchor": anchor},
      text);
  return svg(
      "svg", {role: "img", "aria-label": "Distances, as shares of both surfaces", viewBox: `0 0 ${width} ${height}`, class: "plot"},
      shares.map((share, i) => {
        const tall = (height - above - below) * share / most;
        return svg("rect", {
          x: x(low_mm + i * width_mm).toFixed(2), y: (height - below - tall).toFixed(2), width: (width / shares.length).toFixed(2),
          height: tall.toFixed(2), fill: "var(--accent)"
        });
      }),
      svg("path", {stroke: "var(--quiet)", d: `M0 ${height - below}H${width}`, fill: "none"}),
      low_mm < 0 && high_mm > 0 ?
          [svg("path", {stroke: "var(--quiet)", d: `M${x(0).toFixed(2)} ${above}V${height - below}`, "stroke-dasharray": "3 3"}),
           words(x(0), "middle", "0")] :
          null,
      words(0, "start", `${grouped(low_mm, 2)} mm`), words(width, "end", `${grouped(high_mm, 2)} mm`),
      svg("text", {"font-size": 12, "font-family": "sans-serif", fill: "var(--quiet)", x: width / 2, y: height - 4, "text-anchor": "middle"},
          "signed distance; height: share of the surfaces"));
}

const point = (p: Vec3, digits: number): string => p.map((part) => grouped(part, digits)).join(", ");

/// The comparison of two predictions of the same skin: at landmarks, and over the whole face.
function faces(one: Measurement): Child {
  const face = one.face;
  if (!face) return null;
  return [
    el("h4", {}, `The face by ${one.a} and by ${one.b}, point by point`),
    table(["Landmark", `#moved by ${one.a}, x, y, z, mm`, `#moved by ${one.b}, x, y, z, mm`, "#difference, mm"], [
      ...face.landmarks.map((at): Row => [
        at.name || point(at.at_mm, 1), point(at.a_moved_mm, 2), point(at.b_moved_mm, 2), grouped(at.difference_mm, 2)
      ]),
      ["face, mean", "", "", grouped(face.mean_mm, 2)],
      [`face, largest, at ${point(face.largest_at_mm, 0)} mm`, "", "", grouped(face.largest_mm, 2)]
    ]),
    soft(`Of ${face.skin}: ${face.definition}; ${grouped(face.area_mm2)} mm². Coordinates are LPS.`)
  ];
}

function differences(one: Measurement): Child {
  const title = el("h3", {}, `Comparison ${one.id}`);
  const way = (words: string, of: OneWay|undefined): Row[] => of ? [[
    words, grouped(of.mean_mm, 3), grouped(of.signed_mean_mm, 3), grouped(of.p95_mm, 3), grouped(of.max_mm, 3)
  ]] :
                                                                   [];
  const within = (one.a_to_b?.bands ?? []).map((band, i): Row => [
    `within ${grouped(band.tolerance_mm, 2)} mm`, `${grouped(100 * band.share_within, 1)} %`,
    `${grouped(100 * (one.b_to_a?.bands[i]?.share_within ?? 0), 1)} %`
  ]);
  if (typeof one.mean_mm !== "number")
    return [title, el("p", {}, `${one.a} and ${one.b} are compared by their meshes, which are not there yet.`), list(one.findings)];
  return [
    title,
    table(["", "#mean", "#Hausdorff 95", "#Hausdorff", "#Dice"], [[
      `${one.a} and ${one.b}, mm`, grouped(one.mean_mm, 3), grouped(one.hausdorff95_mm, 3), grouped(one.hausdorff_mm, 3),
      doubtful(one.dice, one.dice_half_width, 4)
    ]]),
    table(["", "#mean", "#signed mean", "#95th percentile", "#largest"],
          [...way(`${one.a} to ${one.b}, mm`, one.a_to_b), ...way(`${one.b} to ${one.a}, mm`, one.b_to_a)]),
    within.length ? table(["", `#${one.a}`, `#${one.b}`], within) : null,
    faces(one),
    one.histogram ? distance_plot(one.histogram) : null,
    soft("Mean: area-weighted, of absolute distances from points to triangles, over both surfaces. Hausdorff 95: the larger of " +
         "both directed, area-weighted 95th percentiles. Signed distances are positive outside of the other surface."),
    list(one.findings)
  ];
}

/// A plot of an airway's area along its centre line, by both kernels, with the narrowest section.
function airway_plot(of: Airway): SVGElement {
  const width = 640, height = 180, left = 52, below = 34, above = 12;
  const most = Math.max(1, ...of.sections.map((section) => section.area_mm2));
  const x = (mm: number): string => (left + (width - left - 8) * mm / of.length_mm).toFixed(2);
  const y = (mm2: number): string => (above + (height - above - below) * (1 - mm2 / most)).toFixed(2);
  const line = (areas: [number, number|null][], stroke: string, dashes: string|null): SVGElement => svg("path", {
    fill: "none", stroke, "stroke-width": 1.6, "stroke-dasharray": dashes,
    d: areas.flatMap(([mm, mm2]) => mm2 === null ? [] : [`${x(mm)} ${y(mm2)}`]).map((p, i) => `${i ? "L" : "M"}${p}`).join("")
  });
  const text = (at_x: number, at_y: number, anchor: string, words: string): SVGElement => svg(
      "text", {"font-size": 12, "font-family": "sans-serif", fill: "var(--quiet)", x: at_x, y: at_y, "text-anchor": anchor},
      words);
  return svg(
      "svg", {
        role: "img", "aria-label": "Area of the airway along its centre line", viewBox: `0 0 ${width} ${height}`,
        class: "plot"
      },
      svg("path", {stroke: "var(--quiet)", d: `M${left} ${above}V${height - below}H${width}`, fill: "none"}),
      line(of.sections.map((one) => [one.along_mm, one.voxel_mm2]), "var(--warn)", "4 3"),
      line(of.sections.map((one) => [one.along_mm, one.mesh_mm2]), "var(--accent)", null),
      svg("circle", {
        r: 4, fill: "none", stroke: "var(--bad)", "stroke-width": 2, cx: x(of.narrowest.along_mm), cy: y(of.narrowest.area_mm2)
      }),
      text(left - 6, above + 8, "end", three_figures(most)), text(left - 6, height - below, "end", "0"),
      text(left, height - below + 16, "start", "0"),
      text(width, height - below + 16, "end", `${three_figures(of.length_mm)} mm`),
      text((left + width) / 2, height - 6, "middle",
           "mm² along the centre line; blue: mesh kernel, orange: voxel kernel, circle: narrowest"));
}

function airway(one: Measurement): Child {
  const of = one.airway!;
  const least = of.narrowest;
  const [x, y, z] = least.at_mm.map((part) => grouped(part, 1)) as [string, string, string];
  return [
    el("h3", {}, `Airway ${one.id}`),
    table(["", "#recommended", "#voxel kernel", "#mesh kernel"], [
      ["volume, mm³", doubtful(of.volume_mm3, of.volume_half_width_mm3, 0), grouped(of.volume_mm3),
       grouped(of.volume_mesh_mm3)],
      ["narrowest section, mm²", doubtful(least.area_mm2, least.half_width_mm2, 1), grouped(least.voxel_mm2, 1),
       grouped(least.mesh_mm2, 1)]
    ]),
    el("p", {}, `Narrowest ${grouped(least.along_mm, 1)} mm along its centre line of ${grouped(of.length_mm, 1)} mm, at x ${
        x}, y ${y}, z ${z} mm. Sections nearer to an end than the airway's radius are ignored, because the centre line is ` +
       "unreliable there."),
    airway_plot(of), list(one.findings)
  ];
}

function landmarks(one: Measurement): Child {
  const digits = (p: Vec3): string[] => p.map((part) => grouped(part, 1));
  return [
    el("h3", {}, `First guess of landmarks, ${one.id}`),
    el("p", {}, "By the skull's symmetry and its extremal points. Nobody has confirmed them, and no number of this plan " +
       "rests on them."),
    table(["", "", "#x, mm", "#y, mm", "#z, mm", "#within, mm"],
          one.landmarks.map((guess) => [guess.name, guess.says, ...digits(guess.point_mm), grouped(guess.uncertainty_mm, 1)])),
    one.missing!.length ? el("p", {}, "Not found:") : null, list(one.missing!.map((lost) => `${lost.name}: ${lost.why}`)),
    list(one.findings)
  ];
}

function trials(one: Measurement): Child {
  const errors = one.errors;
  const sources = ["landmarks", "kerf", "segmentation", "seating"];
  return [
    el("h3", {}, `Values under random errors: ${one.id}`),
    table(
        ["Number", "of", "#planned", "#landmarks", "#saw", "#segmentation", "#seating"],
        one.doubts!.map((of) => [
          of.what, of.of,
          doubtful(of.value, of.half_width, of.unit === "mm3" ? 0 : 1) + ` ${unit_text(of.unit)}`.replace(" °", "°"),
          ...sources.map((name) => three_figures(of.sources.find((source) => source.name === name)?.half_width))
        ])),
    doubt_plot(one.doubts!),
    soft(`After each ±, the half-width that holds in 99 of 100 of ${one.trials} trials with errors of these standard ` +
         `deviations: landmarks ${errors.landmark_mm} mm and a piece's seating ${errors.seating_mm} mm along each axis, its ` +
         `turn ${errors.seating_deg}° about each, the saw's width ${errors.kerf_mm} mm, where bone ends ${
             errors.segmentation_mm} mm. The further columns are the half-widths of each source alone. Gaps and overlaps ` +
         "are computed to first order."),
    list(one.findings)
  ];
}

/// A table of the measurements that have a verdict, such as those of printed parts; null if there are none.
function verdicts(all: Measurement[]): Child {
  const rows = all.filter((one) => one.verdict !== undefined).map((one) => [
    one.id, one.object, one.verdict ? pill(one.verdict) : "not measured", list(one.findings)
  ]);
  return rows.length ? table(["Proof", "Object", "Verdict", "Findings"], rows) : null;
}

/// The volumes of all measured objects in large type, at the top of the report; null if there are none.
export function tiles(all: Measurement[]): Child {
  const each = all.flatMap(({id, object, volume_mm3}) => volume_mm3 === undefined ? [] : [
    el("div", {}, el("b", {}, `${grouped(volume_mm3 / 1000, 2)} cm³`), el("span", {}, `${id} (${object})`))
  ]);
  return each.length ? el("div", {class: "tiles"}, each) : null;
}

/// A plot of the half-widths of several numbers. Lengths of bars can be compared between numbers of the same
/// unit.
function doubt_plot(all: NonNullable<Measurement["doubts"]>): Child {
  const shown = all.filter((of) => of.half_width > 0);
  if (!shown.length) return null;
  const row = 18, left = 200, width = 640, height = row * shown.length + 4;
  const most = (unit: string): number => Math.max(...shown.filter((of) => of.unit === unit).map((of) => of.half_width));
  return svg(
      "svg", {role: "img", "aria-label": "Half-widths of the numbers", viewBox: `0 0 ${width} ${height}`, class: "plot"},
      shown.map((of, i) => [
        svg("text", {"font-size": 12, "font-family": "sans-serif", fill: "var(--quiet)", x: left - 6, y: i * row + 14, "text-anchor": "end"},
            `${of.what}, ${of.of}`.slice(0, 34)),
        svg("rect", {x: left, y: i * row + 4, height: row - 6, width: (0.75 * (width - left) * of.half_width / most(of.unit)).toFixed(2), fill: "var(--accent)"}),
        svg("text", {
          "font-size": 12, "font-family": "sans-serif", fill: "var(--quiet)", y: i * row + 14,
          x: (left + 6 + 0.75 * (width - left) * of.half_width / most(of.unit)).toFixed(2)
        }, `± ${three_figures(of.half_width)} ${unit_text(of.unit)}`)
      ]));
}

/// The tables and plots of a measurement; null if its kind has none.
export function measurement(one: Measurement): Child {
  if (one.contacts !== undefined) return contacts(one);
  if (one.airway !== undefined) return airway(one);
  if (one.mean_mm !== undefined) return differences(one);
  if (one.doubts !== undefined) return trials(one);
  if (one.flap_segments !== undefined) return flap(one);
  if (one.missing !== undefined) return landmarks(one);
  if (one.volume_mm3 !== undefined) return sizes([one]);
  return one.verdict !== undefined ? verdicts([one]) : lengths([one]);
}

export function measurements(all: Measurement[]): Child {
  const each = (key: keyof Measurement, draw: (one: Measurement) => Child): Child =>
      all.filter((one) => one[key] !== undefined).map(draw);
  return section(
      "Measurements", verdicts(all), sizes(all), lengths(all), each("flap_segments", flap), each("contacts", contacts),
      each("airway", airway), each("mean_mm", differences), each("missing", landmarks), each("doubts", trials));
}
