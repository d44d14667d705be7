// SPDX-License-Identifier: AGPL-3.0-or-later
// What the table of operations states about the plan's steps, read from the schema that the server sends.
import {Json, Schema, Step} from "./protocol";
import {state} from "./state";

/// The schemas of all operations; none before the server's first message.
export function operations(): Schema[] {
  const items = state.hello?.schema.properties?.steps?.items;
  return items && "anyOf" in items ? items.anyOf : [];
}

/// The schema of a step's operation. An export has one of three schemas, by the extension of its path.
export function schema_of(step: Step): Schema|undefined {
  const all = operations();
  if (step.do !== "export") return all.find((one) => one.properties?.do?.const === step.do);
  const path = String(step.path ?? "");
  const as = /\.(inp|feb|vtu|msh|node)$/.test(path) ? "deck" :
      /\.(stl|ply|obj|off|vtp|glb|vtk)$/.test(path) ? "surface" :
                                                      "label_map";
  return all.find((one) => one.title === `export, as ${as}`);
}

/// Whether a step makes something to draw: a body, or a tool such as a mask.
export const makes_shape = (step: Step): boolean =>
    ["object", "tool"].includes(schema_of(step)?.["x-makes"] ?? "");

/// Whether a step makes a body, which is certified, measured and exported. A mask and other tools are no
/// bodies.
export const makes_body = (step: Step|undefined): boolean =>
    step !== undefined && schema_of(step)?.["x-makes"] === "object";

/// Whether a step measures.
export const makes_measurement = (step: Step): boolean => schema_of(step)?.["x-makes"] === "measurement";

/// Whether a step makes a scan from another scan.
export const makes_scan = (step: Step): boolean => schema_of(step)?.["x-makes"] === "scan";

/// Whether a step moves another object rigidly.
export const moves_object = (step: Step): boolean => schema_of(step)?.["x-moves"] !== undefined;

/// Names of those fields of an operation that contain an object's name or a list of such names.
export const object_fields = (schema: Schema): string[] =>
    Object.entries(schema.properties ?? {})
        .filter(([, field]) => field["x-names"] === "object" || names_in_list(field))
        .map(([name]) => name);
const names_in_list = (field: Schema): boolean =>
    field.items !== undefined && "x-names" in field.items && field.items["x-names"] === "object";

/// Names of the objects that a step uses, in its fields and in its expression.
export function operands(step: Step): string[] {
  const schema = schema_of(step);
  const names = (schema ? object_fields(schema) : []).flatMap((field) => names_of(step[field]));
  if (typeof step.expression === "string") names.push(...(step.expression.match(/[A-Za-z_]\w*/g) ?? []));
  return names;
}
function names_of(value: Json|undefined): string[] {
  const names: (Json|undefined)[] = Array.isArray(value) ? value : [value];
  return names.filter((name): name is string => typeof name === "string");
}
