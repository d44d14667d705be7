// SPDX-License-Identifier: AGPL-3.0-or-later
// Numbers as people read them, as `planner/operation/table/number_format.h` writes them in messages.

/// Rounds as C++ prints: a value half way between two decimals goes to the even one. Only a value with few
/// binary digits can lie half way, and sixty decimals represent such a value exactly.
function fixed(value: number, digits: number): string {
  const text = value.toFixed(digits);
  const is_tie = /^50*$/.test(value.toFixed(60).split(".")[1]?.slice(digits) ?? "");
  return is_tie && /[13579]$/.test(text) ? (value - 0.5 * 10 ** -digits).toFixed(digits) : text;
}

/// A number such as "−12 345.6", or a dash if it is null, undefined or not finite. Five digits and more are
/// in groups of three.
export function grouped(value: number|null|undefined, digits = 0): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  const [whole = "", part] = fixed(Math.abs(value), digits).split(".");
  const groups = whole.length > 4 ? whole.replace(/\B(?=(\d{3})+$)/g, "\u202f") : whole;
  const text = part === undefined ? groups : `${groups}.${part}`;
  return value < 0 && /[1-9]/.test(text) ? `−${text}` : text;
}

/// A number with three significant digits, but at most six decimals.
export function three_figures(value: number|null|undefined): string {
  if (!value || !Number.isFinite(value)) return grouped(value);
  return grouped(value, Math.max(0, Math.min(6, 2 - Math.floor(Math.log10(Math.abs(value))))));
}

/// The largest number of the form 1, 2 or 5 times a power of ten that is at most `most`, for scale bars.
export function round_length(most: number): number {
  const ten = 10 ** Math.floor(Math.log10(most) + 1e-12);
  return ([5, 2, 1].find((digit) => digit * ten <= most * (1 + 1e-12)) ?? 1) * ten;
}

/// A unit as it is shown: "mm³" for "mm3", nothing for "1", the unit of numbers without one.
export const unit_text = (unit: string): string =>
    unit.replace(/^1$/, "").replace("mm3", "mm³").replace("mm2", "mm²").replace("deg", "°").replace("per_mm", "per mm");
