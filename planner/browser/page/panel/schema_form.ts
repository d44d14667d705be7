// SPDX-License-Identifier: AGPL-3.0-or-later
// Forms for the plan's steps, made from the JSON schema: fields with their units, ranges, defaults and
// sentences.
import {object_ids} from "../drawn_objects";
import {schema_of} from "../operations";
import {button, Child, el} from "../base/html";
import {Json, Schema, Step} from "../protocol";
import {state} from "../state";

/// A field's name without its unit, which the form shows after the value.
export const label_of = (field: string): string =>
    field.replace(/_(mm|deg|mm2|mm3|mpa)$/, "").replace(/_/g, " ");

/// A form for a step's fields. `changed` receives the whole step after each change. Fields in `elsewhere` are
/// left out, because another card shows them.
export function step_form(
    step: Step, changed: (step: Step) => void, elsewhere: readonly string[] = []): Child {
  const schema = schema_of(step);
  if (!schema?.properties) return el("p", {class: "says"}, "This operation is unknown to the page.");
  const required = new Set(schema.required ?? []);
  const given: Child[] = [];
  const more: Child[] = [];
  for (const [field, about] of Object.entries(schema.properties)) {
    if (field === "id" || field === "do" || elsewhere.includes(field)) continue;
    const set_value = (value: Json|undefined): void => {
      const {[field]: _before, ...rest} = step;
      changed((value === undefined ? rest : {...rest, [field]: value}) as Step);
    };
    const row = field_row(`${step.id}.${field}`, field, about, step[field], required.has(field), set_value);
    (step[field] !== undefined || required.has(field) ? given : more).push(row);
  }
  return [
    el("p", {class: "says"}, schema.description ?? ""),
    given,
    more.length ?
        el("details", {}, el("summary", {}, `${more.length} more ${more.length === 1 ? "field" : "fields"}`),
           more) :
        null,
  ];
}

function field_row(
    key: string,
    field: string,
    about: Schema,
    value: Json|undefined,
    needed: boolean,
    set_value: (value: Json|undefined) => void,
    ): Child {
  const unit = about["x-unit"];
  const tip =
      [
        about.description ?? "", range_words(about),
        about.default !== undefined ? `Default: ${JSON.stringify(about.default)}.` : ""
      ].filter(Boolean)
          .join(" ");
  return el(
      "label", {class: `field${about.type === "boolean" ? " check" : ""}`, "data-tip": tip},
      el("span", {}, label_of(field), needed ? el("b", {class: "needed", title: "needed"}, " •") : null),
      input_for(key, field, about, value, set_value), unit ? el("i", {}, unit) : null);
}

function range_words(about: Schema): string {
  const unit = about["x-unit"] ?? "";
  if (about.minimum !== undefined && about.maximum !== undefined && Math.abs(about.maximum) < 1e6)
    return `From ${about.minimum} to ${about.maximum} ${unit}.`;
  if (about.exclusiveMinimum === 0) return "Above zero.";
  return "";
}

function input_for(
    key: string, field: string, about: Schema, value: Json|undefined,
    set_value: (value: Json|undefined) => void): Child {
  const shared = {"data-key": key, name: field};
  const on_text = (event: Event): string => (event.target as HTMLInputElement).value.trim();
  if (about.type === "boolean")
    return el("input", {
      ...shared,
      type: "checkbox",
      checked: value === true,
      onchange: (e: Event) => set_value((e.target as HTMLInputElement).checked || undefined)
    });
  if (about.enum) return choice(shared, about.enum, value, set_value);
  if (about.type === "number" || about.type === "integer")
    return el("input", {
      ...shared,
      type: "number",
      step: about.type === "integer" ? 1 : "any",
      min: about.minimum,
      max: about.maximum,
      value: value === undefined ? "" : String(value),
      placeholder: about.default === undefined ? "" : String(about.default),
      onchange: (e: Event) => set_value(on_text(e) === "" ? undefined : Number(on_text(e))),
    });
  if (about["x-names"] === "object")
    return choice(shared, object_ids(), value, set_value);
  if (about.type === "string" && field === "scan")
    return choice(shared, state.plan?.scans.map((scan) => scan.name) ?? [], value, set_value);
  if (about.type === "string" && !about.oneOf)
    return el("input", {
      ...shared,
      type: "text",
      value: value === undefined ? "" : String(value),
      placeholder: String(about.default ?? ""),
      onchange: (e: Event) => set_value(on_text(e) || undefined)
    });
  return structured(shared, value, about, set_value);
}

function choice(
    shared: {[name: string]: string}, names: string[], value: Json|undefined,
    set_value: (value: Json|undefined) => void): Child {
  const all = typeof value === "string" && !names.includes(value) ? [value, ...names] : names;
  return el(
      "select",
      {...shared, onchange: (e: Event) => set_value((e.target as HTMLSelectElement).value || undefined)},
      el("option", {value: "", selected: value === undefined}, "–"),
      all.map((name) => el("option", {value: name, selected: value === name}, name.replace(/_/g, " "))));
}

// A text field for points, lists and records. It contains JSON, a name, or numbers separated by commas, and
// is read when the person leaves it. A point also has a button that sets it to the cross-hair.
function structured(
    shared: {[name: string]: string}, value: Json|undefined, about: Schema,
    set_value: (value: Json|undefined) => void): Child {
  const text = value === undefined ? "" : JSON.stringify(value);
  const is_point =
      about.minItems === 3 && about.maxItems === 3 && !(about.items as Schema | undefined)?.oneOf ||
      about.oneOf?.some((one) => one.maxItems === 3) === true;
  const take = (event: Event): void => {
    const field = event.target as HTMLInputElement;
    const typed = field.value.trim();
    try {
      field.setCustomValidity("");
      set_value(typed === "" ? undefined : read_value(typed));
    } catch {
      field.setCustomValidity("Write it as [x, y, z] or as a name.");
      field.reportValidity();
    }
  };
  const field = text.length > 60 ?
      el("details", {class: "long-value"},
         el("summary", {}, Array.isArray(value) ? `${value.length} of them` : "as text"),
         el("textarea", {...shared, "aria-label": shared.name, rows: 5, onchange: take}, text)) :
                                                  el("input", {
                                                    ...shared,
                                                    type: "text",
                                                    value: text,
                                                    placeholder: about.default === undefined ? "" : JSON.stringify(about.default),
                                                    onchange: take
                                                  });
  return is_point ?
      el("span", {class: "with-button"}, field,
         button("✛", "Take the cross-hair's place", () => set_value([...state.cross_mm]), {class: "small"})) :
      field;
}

function read_value(typed: string): Json {
  if (/^[A-Za-z_][\w@ ]*$/.test(typed)) return typed;
  if (/^-?[\d.]+(\s*,\s*-?[\d.]+)+$/.test(typed)) return typed.split(",").map(Number);
  return JSON.parse(typed) as Json;
}

/// A new step with those fields of the operation's example that do not depend on the example's plan.
export function new_step(schema: Schema, id: string): Step {
  const example = schema.examples?.[0];
  const step: Step = {id, do: schema.properties?.do?.const ?? ""};
  const objects = object_ids();
  for (const field of schema.required ?? []) {
    if (field === "id" || field === "do") continue;
    if (field === "scan")
      step[field] = state.plan?.scans[0]?.name ?? "ct";
    else if (schema.properties?.[field]?.["x-names"] === "object")
      step[field] = (state.selected && objects.includes(state.selected) ? state.selected :
                                                                          objects[objects.length - 1]) ??
          "";
    else
      step[field] = example?.[field] ?? null;
  }
  return step;
}
