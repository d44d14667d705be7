// SPDX-License-Identifier: AGPL-3.0-or-later
// A piece's motion as numbers in the head's words.
import {Direction, directions, motion_words, Turn, turns} from "../base/anatomical";
import {common_colour, only_moved_colour, only_other_colour, overlap_colour} from "../drawn_objects";
import {Child, el} from "../base/html";
import {
  centre_of,
  commit_motion,
  current,
  difference_choices,
  difference_to,
  piece,
  preview_motion,
  show_difference
} from "../tool/piece_motion";
import {Motion} from "../protocol";
import {state} from "../state";
import {grouped} from "../base/numbers";
import {distance, Vec3} from "../base/vector";

const titles: Record<Direction|Turn, [string, string]> = {
  forward_mm: ["Forward", "negative: back"],
  left_mm: ["Left", "to the patient's left; negative: right"],
  up_mm: ["Up", "negative: down"],
  pitch_deg: ["Pitch", "the front goes up"],
  yaw_deg: ["Yaw", "the front goes to the patient's left"],
  roll_deg: ["Roll", "the patient's left side goes up"],
};

/// Whether a turn is about a point, to the last digit that is shown.
const is_at = (about: string|Vec3|undefined, p: Vec3): boolean => Array.isArray(about) && distance(about, p) < 0.05;

/// Fields for a piece's motion in anatomical directions; null if the selected step moves no piece.
export function movement_fields(): Child {
  const one = piece();
  if (!one) return null;
  if (one.step && !one.step.by && !one.step.turn &&
      Object.keys(one.step).some((key) => !["id", "do", "object"].includes(key)))
    return null;
  const move = current();
  const field = (word: Direction|Turn): Child => {
    const unit = word.endsWith("mm") ? "mm" : "°";
    const values = (unit === "mm" ? move.by : move.turn) as {[field: string]: number | undefined} | undefined;
    const changed = (value: number): Motion => unit === "mm" ? {...move, by: {...move.by, [word]: value}} : {
      ...move,
      turn: {...move.turn, about_mm: move.turn?.about_mm ?? centre_of(one.source), [word]: value}
    };
    const take = (event: Event, end: boolean): void => {
      const value = Number((event.target as HTMLInputElement).value);
      if (!Number.isFinite(value)) return;
      if (end)
        void commit_motion(changed(value));
      else
        preview_motion(changed(value));
    };
    return el(
        "label", {class: "number-field", "data-tip": `${titles[word][0]}: ${titles[word][1]}`},
        el("span", {}, titles[word][0]), el("input", {
          type: "number",
          step: unit === "mm" ? 0.5 : 0.5,
          value: (values?.[word] ?? 0).toString(),
          "data-key": `move-${word}`,
          name: word,
          "aria-label": `${titles[word][0]}, ${titles[word][1]}`,
          oninput: (event: Event) => take(event, false),
          onchange: (event: Event) => take(event, true),
        }),
        el("i", {}, unit));
  };
  const landmarks = state.plan?.landmarks ?? [];
  const about = move.turn?.about_mm;
  const is_typed = Array.isArray(about) && !is_at(about, centre_of(one.source));
  return el(
      "section", {class: "card"}, el("h3", {}, one.step ? `Motion of ${one.source}` : `Move ${one.source}`),
      el("div", {class: "grid-3"}, directions.map(field)), el("div", {class: "grid-3"}, turns.map(field)),
      el("label", {class: "field"}, el("span", {}, "Turn about"),
         el("select", {
           "data-key": "move-about",
           onchange: (event: Event) => {
             const value = (event.target as HTMLSelectElement).value;
             const about_mm = value === "" ? centre_of(one.source) :
                 value === "cross"         ? state.cross_mm :
                                             value;
             if (value !== "typed") void commit_motion({...move, turn: {...move.turn, about_mm}});
           },
         },
            el("option", {value: "", selected: about === undefined || is_at(about, centre_of(one.source))}, "its middle"),
            el("option", {value: "cross"}, "the cross-hair"),
            is_typed ? el("option", {value: "typed", selected: true}, about.map((x) => grouped(x, 1)).join(", ")) : null,
            landmarks.map(
                (mark) =>
                    el("option", {value: mark.name, selected: about === mark.name},
                       mark.name.replace(/_/g, " "))))),
      difference_switch(), difference_reading(one.source),
      el("p", {class: "reading", role: "status"}, motion_words(move),
         state.preview && state.overlap_mm3 !== null ?
             el("b", {style: `color:${state.overlap_mm3 > 0.5 ? overlap_colour : "var(--good)"}`},
                ` overlap ${state.overlap_mm3.toFixed(0)} mm³`) :
             null),
      state.preview?.move ? state.tried?.findings?.map((finding) => el("p", {class: "sentence warn"}, finding)) : null);
}

/// A switch for the object with which the moving piece is compared in two colours.
function difference_switch(): Child {
  const to = difference_to();
  return el(
      "label", {
        class: "field",
        "data-tip": "Draws in two colours what only the piece and what only the other object contains, while the piece moves"
      },
      el("span", {}, "Difference to"),
      el("select", {
        "data-key": "move-difference",
        onchange: (event: Event) => show_difference((event.target as HTMLSelectElement).value || null),
      },
         el("option", {value: "", selected: !to}, "none"),
         difference_choices().map(
             (id) => el("option", {value: id, selected: id === to}, id.replace(/_/g, " ")))));
}

/// The volumes of the parts of the newest picture's difference, each with its colour.
function difference_reading(source: string): Child {
  const {difference, preview} = state;
  if (!preview || !difference) return null;
  const row = (colour: string, words: string, mm3: number): Child =>
      el("p", {class: "reading difference"}, el("b", {style: `color:${colour}`}, "■ "),
         `${words}: ${mm3.toFixed(0)} mm³`);
  const other = difference.to.replace(/_/g, " ");
  return [
    row(only_moved_colour, `only ${source.replace(/_/g, " ")}`, difference.only_moved_mm3),
    row(only_other_colour, `only ${other}`, difference.only_other_mm3),
    row(common_colour, "both", difference.common_mm3),
  ];
}
