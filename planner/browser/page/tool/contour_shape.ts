// SPDX-License-Identifier: AGPL-3.0-or-later
// The geometry of contours while they are edited: closed lines of points [u, v] in mm. No function changes
// its arguments.
import {Vec2} from "../base/vector";

export type Polygon = Vec2[];

const sub = (a: Vec2, b: Vec2): Vec2 => [a[0] - b[0], a[1] - b[1]];
export const gap = (a: Vec2, b: Vec2): number => Math.hypot(a[0] - b[0], a[1] - b[1]);
const between = (a: Vec2, b: Vec2, share: number): Vec2 => [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])];
const to_hundredths = (p: Vec2): Vec2 => [Math.round(p[0] * 100) / 100, Math.round(p[1] * 100) / 100];

/// Signed area of a closed line; positive if the line is counter-clockwise.
export const area_mm2 = (line: Polygon): number => line.reduce((sum, a, i) => {
  const b = line[(i + 1) % line.length]!;
  return sum + (a[0] * b[1] - a[1] * b[0]) / 2;
}, 0);

/// Whether a closed line encloses a point, by the even-odd rule.
export function contains(line: Polygon, p: Vec2): boolean {
  let inside = false;
  line.forEach((a, i) => {
    const b = line[(i + 1) % line.length]!;
    if ((a[1] > p[1]) !== (b[1] > p[1]) && p[0] < a[0] + ((p[1] - a[1]) / (b[1] - a[1])) * (b[0] - a[0])) inside = !inside;
  });
  return inside;
}

/// The point of a closed line nearest to `p`: the index of its segment, the point, and its distance.
export function nearest_on(line: Polygon, p: Vec2): {piece: number; at: Vec2; mm: number} {
  let best = {piece: 0, at: line[0]!, mm: Infinity};
  line.forEach((a, piece) => {
    const b = line[(piece + 1) % line.length]!;
    const along = sub(b, a), rel = sub(p, a);
    const square = along[0] ** 2 + along[1] ** 2;
    const at = between(a, b, square ? Math.max(0, Math.min(1, (rel[0] * along[0] + rel[1] * along[1]) / square)) : 0);
    if (gap(at, p) < best.mm) best = {piece, at, mm: gap(at, p)};
  });
  return best;
}

/// Thins an open line: all left-out points lie within `within_mm` of the result (Douglas and Peucker 1973).
export function simplified(line: Polygon, within_mm: number): Polygon {
  if (line.length < 3) return line;
  const first = line[0]!, last = line[line.length - 1]!;
  const beside = (p: Vec2): number => nearest_on([first, last], p).mm;
  let farthest = 0, most = 0;
  for (let i = 1; i + 1 < line.length; ++i)
    if (beside(line[i]!) > most) [farthest, most] = [i, beside(line[i]!)];
  if (most <= within_mm) return [first, last];
  return [...simplified(line.slice(0, farthest + 1), within_mm).slice(0, -1), ...simplified(line.slice(farthest), within_mm)];
}

/// Closes a drawn line, thins it and rounds it to hundredths of a millimetre. Null if it encloses less than
/// 0.5 mm².
export function closed_line(drawn: Polygon, within_mm: number): Polygon|null {
  if (drawn.length < 3) return null;
  // simplified() keeps both ends. A closed line has none, so it is split at its first point and the point
  // farthest from that.
  const far = drawn.reduce((best, p, i) => (gap(p, drawn[0]!) > gap(drawn[best]!, drawn[0]!) ? i : best), 0);
  const halves = [simplified(drawn.slice(0, far + 1), within_mm), simplified([...drawn.slice(far), drawn[0]!], within_mm)];
  const line = tidy([...halves[0]!.slice(0, -1), ...halves[1]!.slice(0, -1)]);
  return line.length > 2 && Math.abs(area_mm2(line)) >= 0.5 ? line : null;
}

/// Rounds a closed line to hundredths of a millimetre and drops points that then equal the previous one.
export function tidy(line: Polygon): Polygon {
  const all = line.map(to_hundredths);
  return all.filter((p, i) => gap(p, all[(i + all.length - 1) % all.length]!) > 0);
}

/// Replaces a part of a closed line by a stroke that begins and ends near it. The longer part of the line
/// stays. Null if the result encloses less than 0.5 mm².
export function spliced(line: Polygon, stroke: Polygon, within_mm: number): Polygon|null {
  const from = nearest_on(line, stroke[0]!), to = nearest_on(line, stroke[stroke.length - 1]!);
  // The line's points from one segment to another, in the line's order.
  const onward = (start: {piece: number}, end: {piece: number}): Polygon => {
    const part: Polygon = [];
    for (let i = (start.piece + 1) % line.length, left = line.length; left > 0; i = (i + 1) % line.length, --left) {
      part.push(line[i]!);
      if (i === end.piece) break;
    }
    return part;
  };
  const long = (part: Polygon): number => part.reduce((sum, p, i) => (i ? sum + gap(p, part[i - 1]!) : 0), 0);
  const ahead = onward(to, from), behind = onward(from, to).reverse();
  const kept = long(ahead) >= long(behind) ? ahead : behind;
  const made = tidy([from.at, ...simplified(stroke, within_mm).slice(1, -1), to.at, ...kept]);
  return made.length > 2 && Math.abs(area_mm2(made)) >= 0.5 ? made : null;
}

/// Divides segments within `reach_mm` of a position into pieces of at most `most_mm`, but at most 200 pieces
/// each.
export function refined(line: Polygon, at: Vec2, reach_mm: number, most_mm: number): Polygon {
  return line.flatMap((a, i) => {
    const b = line[(i + 1) % line.length]!;
    const parts = nearest_on([a, b], at).mm < reach_mm ? Math.min(200, Math.ceil(gap(a, b) / most_mm)) : 1;
    return Array.from({length: Math.max(1, parts)}, (_, k) => between(a, b, k / Math.max(1, parts)));
  });
}

/// Moves a point of a line. Points nearer than `reach_mm` move with it, the less the farther they are.
export function dragged(line: Polygon, point: number, to: Vec2, reach_mm: number): Polygon {
  const from = line[point]!, by = sub(to, from);
  return line.map((p, i) => {
    const share = i === point ? 1 : reach_mm > 0 && gap(p, from) < reach_mm ? 0.5 + 0.5 * Math.cos(Math.PI * gap(p, from) / reach_mm) : 0;
    return [p[0] + share * by[0], p[1] + share * by[1]];
  });
}

/// Smooths a line within `reach_mm` of a position. Points move towards the middle of their neighbours and
/// then back by slightly more, so that the line does not shrink (Taubin 1995).
export function smoothed(line: Polygon, at: Vec2, reach_mm: number): Polygon {
  const step = (all: Polygon, share: number): Polygon => all.map((p, i) => {
    if (gap(p, at) >= reach_mm) return p;
    const middle = between(all[(i + all.length - 1) % all.length]!, all[(i + 1) % all.length]!, 0.5);
    return between(p, middle, share);
  });
  return step(step(line, 0.5), -0.52);
}

/// Whether a corner of one closed line lies within the other, as when one encloses the other.
export const overlap = (a: Polygon, b: Polygon): boolean => {
  const inside = a.filter((p) => contains(b, p)).length, around = b.filter((p) => contains(a, p)).length;
  return inside > 0 || around > 0;
};
