// SPDX-License-Identifier: AGPL-3.0-or-later
// The report's pictures: scale bars, letters of the patient's sides, outlines of regions, numbered contacts, legends.
import {Attributes, Child, el} from "../../browser/page/base/html";
import {grouped, round_length, three_figures} from "../../browser/page/base/numbers";
import {dot, scaled, Vec2, Vec3} from "../../browser/page/base/vector";
import {edge_letters} from "../../browser/page/base/view_frame";
import {section, svg} from "./elements";
import {Picture, PictureGroup} from "./result";

const data_of = (png: string): string => `data:image/png;base64,${png}`;
export const png_figure = (png: string, alt: string, caption: string): HTMLElement =>
    el("figure", {}, el("img", {alt, src: data_of(png)}), el("figcaption", {}, caption));

/// The title of a view: its name, or its angles in words, such as "35° to the patient's left, 15° above" for
/// "35,15".
function view_title(view: string): string {
  const [azimuth, elevation] = view.split(",");
  if (!azimuth || !elevation) return view;
  const is_right = azimuth.startsWith("-");
  return `${azimuth.replace("-", "")}° to the patient's ${is_right ? "right" : "left"}, ${elevation}° above`;
}

interface Shown {
  before?: string;     // a word in bold type in front of the title
  says: string;  // text for readers who cannot see the picture
  outlined?: boolean;  // draws the outlines of masks' regions
  letters?: number;    // height of letters, in pixels of the picture
  marks_mm?: Vec3[];
}
function figure(picture: Picture, {before, says, outlined, letters = 13, marks_mm = []}: Shown): HTMLElement {
  const size = picture.size_px;
  const title = view_title(picture.view);
  const per_mm = size / picture.width_mm;
  const at = ([u, v]: Vec2): Vec2 =>
      [size / 2 + (u - picture.centre_mm[0]) * per_mm, size / 2 - (v - picture.centre_mm[1]) * per_mm];
  const text = (x: number, y: number, anchor: string, words: string, height = letters): SVGElement => svg(
      "text", {
        x, y, "text-anchor": anchor, "font-size": height, "font-family": "sans-serif", fill: "#44525a", stroke: "#fff",
        "stroke-width": height / 4, "paint-order": "stroke"
      },
      words);
  const bar_mm = round_length(picture.width_mm / 3);
  const bar = (more: Attributes): SVGElement => svg(
      "path", {d: `M${letters} ${size - letters}h${bar_mm * per_mm}`, ...more});
  const marks = marks_mm.map((p): Child => {
    const [x, y] = at([dot(p, picture.right), dot(p, picture.up)]);
    return [
      svg("circle", {cx: x, cy: y, r: letters / 4, fill: "none", stroke: "#222"}),
      text(x + 0.4 * letters, y - 0.3 * letters, "start", String(marks_mm.indexOf(p) + 1), 0.9 * letters)
    ];
  });
  const outlines = (outlined ? picture.outlines_mm : []).map((polygon) => svg("path", {
    class: "outline", d: `M${polygon.map((p) => at(p).map((part) => part.toFixed(2)).join(" ")).join("L")}Z`,
    fill: "#c8452f", "fill-opacity": 0.07, stroke: "#c8452f", "stroke-width": 1.5, "stroke-dasharray": "6 4"
  }));
  const side = edge_letters({...picture, look: scaled(picture.right, 0), centre_mm: [0, 0, 0], pixel_mm: 1});
  return el(
      "figure", {},
      svg("svg", {viewBox: `0 0 ${size} ${size}`, role: "img", "aria-label": `${says}, ${title}`},
          svg("image", {width: size, height: size, href: data_of(picture.png)}), outlines,
          bar({stroke: "#fff", "stroke-width": letters / 2.6}), bar({stroke: "#44525a", "stroke-width": letters / 6.5}),
          text(letters, size - 1.6 * letters, "start", `${grouped(bar_mm, bar_mm < 1 ? 1 : 0)} mm`), marks,
          text(0.6 * letters, size / 2, "start", side.left), text(size - 0.6 * letters, size / 2, "end", side.right),
          text(size / 2, 1.3 * letters, "middle", side.top), text(size / 2, size - 0.6 * letters, "middle", side.bottom)),
      el("figcaption", {}, before ? [el("b", {}, before), ", "] : null, title));
}

const names_of = (group: PictureGroup): string => group.objects.map((object) => object.name).join(", ");
const legend = (group: PictureGroup): HTMLElement =>
    el("div", {class: "legend"},
       group.objects.map((object) => el("span", {}, el("i", {style: `background:${object.colour}`}), object.name)));
/// The scale of the colours of signed distances, with the distances at its ends.
export const colour_scale = (most_mm: number, colours: string[]): HTMLElement => el(
    "div", {class: "legend"}, `${three_figures(-most_mm)} mm, inside`,
    el("span", {class: "scale", style: `background:linear-gradient(90deg,${colours.join()})`}),
    `outside, ${three_figures(most_mm)} mm`);

function group_section(group: PictureGroup): Child {
  const {most_mm} = group;
  const is_scale = most_mm !== null;
  // A picture in a row of four appears at half its size, so its letters are larger.
  const shown = {says: names_of(group), letters: is_scale ? 13 : 24, marks_mm: group.marks_mm};
  return section(
      group.title, is_scale ? colour_scale(most_mm, group.colours) : legend(group),
      el("div", {class: `pictures ${is_scale ? "two" : "four"}`}, group.pictures.map((one) => figure(one, shown))));
}

/// Groups of pictures. If there is a group before the operation, its views stand beside those after the
/// operation.
export function pictures(groups: PictureGroup[]): Child {
  const before = groups.find((group) => group.name === "before");
  const after = groups.find((group) => group.name === "after");
  const pairs = (before?.pictures ?? []).map((picture) => {
    const same = after?.pictures.find((other) => other.view === picture.view);
    return before && after && same ? [
      figure(picture, {before: "Before", says: `before: ${names_of(before)}`, outlined: true}),
      figure(same, {before: "After", says: `after: ${names_of(after)}`})
    ] : null;
  });
  return [
    before && after ? section("Before and after", legend(after), el("div", {class: "pictures two"}, pairs)) : null,
    groups.filter((group) => group.name !== "before" && group.pictures.length).map(group_section)
  ];
}
