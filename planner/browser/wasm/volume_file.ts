// SPDX-License-Identifier: AGPL-3.0-or-later
// NIfTI-1 (.nii, .nii.gz) and NRRD (.nrrd, samples raw or gzip within the file), read in the browser. Offsets
// and meanings of NIfTI's header are from nifti1.h by R. Cox and others; NRRD's fields are from the format's
// definition by G. Kindlmann. Other features are refused by name.

/// A scan: its samples, x fastest, and the matrix from voxels to LPS millimetres, column by column.
export interface Volume {
  dims: [number, number, number];
  lps_from_voxel: number[];
  samples: Int16Array;
  /// Sentences for the user on what was assumed or changed, such as rounded samples or a unit that the file
  /// does not state.
  remarks: string[];
}

type Numbers = Int8Array|Uint8Array|Int16Array|Uint16Array|Int32Array|Uint32Array|Float32Array|Float64Array;
type NumberType = "int8"|"uint8"|"int16"|"uint16"|"int32"|"uint32"|"float"|"double";
const arrays = {
  int8: Int8Array,
  uint8: Uint8Array,
  int16: Int16Array,
  uint16: Uint16Array,
  int32: Int32Array,
  uint32: Uint32Array,
  float: Float32Array,
  double: Float64Array
};

export async function inflated(bytes: Uint8Array): Promise<Uint8Array> {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  try {
    return new Uint8Array(await new Response(stream).arrayBuffer());
  } catch {
    throw new Error("its compressed samples are damaged or cut short");
  }
}

/// Reads `count` numbers from an offset on, in the byte order of the file.
function numbers(bytes: Uint8Array, at: number, count: number, type: NumberType, little: boolean): Numbers {
  const array = arrays[type], size = array.BYTES_PER_ELEMENT;
  if (at + count * size > bytes.length)
    throw new Error(`its samples are cut short: ${bytes.length - at} bytes instead of ${count * size}`);
  const own = bytes.slice(at, at + count * size);
  if (!little && size > 1)
    for (let i = 0; i < own.length; i += size) own.subarray(i, i + size).reverse();
  return new array(own.buffer);
}

/// Converts samples to the kernel's type: applies slope and intercept, rounds halves upward, and limits the
/// values to 16 bits. Adds remarks on changed values.
function to_int16(stored: Numbers, slope: number, intercept: number, remarks: string[]): Int16Array {
  if (stored instanceof Int16Array && slope === 1 && intercept === 0) return stored;
  const samples = new Int16Array(stored.length);
  let rounded = 0, held = 0;
  for (let i = 0; i < stored.length; ++i) {
    const value = stored[i] * slope + intercept, whole = Math.floor(value + 0.5);
    if (whole !== value) ++rounded;
    if (!(whole >= -32768 && whole <= 32767)) ++held;
    samples[i] = Number.isNaN(whole) ? -32768 : Math.max(-32768, Math.min(32767, whole));
  }
  if (rounded > 0) remarks.push(`${rounded} samples were rounded to integers`);
  if (held > 0) remarks.push(`${held} samples were held within -32768..32767`);
  return samples;
}

function checked(dims: number[], axes: number): [number, number, number] {
  if (axes < 2 || axes > 7 || dims.slice(3).some(length => length > 1))
    throw new Error(`it has ${axes} axes; one volume has three`);
  const [x, y, z] = [dims[0], dims[1], dims[2] ?? 1];
  if (![x, y, z].every(length => Number.isInteger(length) && length >= 1 && length <= 4096))
    throw new Error(`its sizes are ${dims.join(" x ")}; each must be 1 to 4096`);
  return [x, y, z];
}

const nifti_types: Record<number, NumberType> =
    {2: "uint8", 4: "int16", 8: "int32", 16: "float", 64: "double", 256: "int8", 512: "uint16", 768: "uint32"};

function rotation_of_quaternion(b: number, c: number, d: number): number[][] {
  const a = Math.sqrt(Math.max(0, 1 - b * b - c * c - d * d));
  return [
    [a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)],
    [2 * (b * c + a * d), a * a + c * c - b * b - d * d, 2 * (c * d - a * b)],
    [2 * (b * d - a * c), 2 * (c * d + a * b), a * a + d * d - b * b - c * c]
  ];
}

export function read_nifti(bytes: Uint8Array): Volume {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  if (bytes.length < 352) throw new Error("it is cut short within its header");
  const little = view.getInt32(0, true) === 348;
  if (!little && view.getInt32(0, false) !== 348)
    throw new Error("it is not a NIfTI-1 file; the program also reads NIfTI-2");
  const int16 = (at: number) => view.getInt16(at, little), float = (at: number) => view.getFloat32(at, little);
  const axes = int16(40);
  const dims = checked(Array.from({length: Math.max(0, axes)}, (_, i) => int16(42 + 2 * i)), axes);
  const type = nifti_types[int16(70)];
  if (type === undefined) throw new Error(`its samples have type ${int16(70)}, which is not read here`);
  // The matrix is the sform or, without one, the qform. Without both, only spacings are known: the axes then
  // point to the left, the front and the head, with the volume's centre at the origin, as in Analyze. RAS
  // becomes LPS.
  let rows: number[][];
  const remarks: string[] = [];
  if (int16(254) > 0)
    rows = [0, 1, 2].map(row => [0, 1, 2, 3].map(column => float(280 + 16 * row + 4 * column)));
  else {
    const spacing = [1, 2, 3].map(axis => Math.abs(float(76 + 4 * axis)) || 1);
    const by_quaternion = int16(252) > 0;
    if (!by_quaternion) remarks.push("the file does not say how the patient lies: axes are taken as left, front, head");
    const turn = by_quaternion ? rotation_of_quaternion(float(256), float(260), float(264)) : [[-1, 0, 0], [0, 1, 0], [0, 0, 1]];
    const centre = [0, 1, 2].map(axis => (axis === 0 ? 0.5 : -0.5) * (dims[axis] - 1) * spacing[axis]);
    const handed = by_quaternion && float(76) < 0 ? -1 : 1;
    rows = [0, 1, 2].map(row => [...[0, 1, 2].map(column => turn[row][column] * spacing[column] * (column === 2 ? handed : 1)),
                                 by_quaternion ? float(268 + 4 * row) : centre[row]]);
  }
  const unit = {1: 1000, 2: 1, 3: 0.001}[bytes[123] & 7];
  if (unit === undefined) remarks.push("the file states no unit of length: millimetres are assumed");
  const lps_from_voxel = [0, 1, 2, 3].flatMap(
      column => [...[0, 1, 2].map(row => rows[row][column] * (row < 2 ? -1 : 1) * (unit ?? 1)), column === 3 ? 1 : 0]);
  // Samples are scaled only by a slope that is finite and not zero.
  const is_scaled = Number.isFinite(float(112)) && float(112) !== 0;
  const slope = is_scaled ? float(112) : 1, intercept = is_scaled ? float(116) : 0;
  if (!Number.isFinite(intercept)) throw new Error("its intercept is not a finite number, but its slope is");
  const count = dims[0] * dims[1] * dims[2];
  const stored = numbers(bytes, Math.max(352, float(108)), count, type, little);
  return {dims, lps_from_voxel, samples: to_int16(stored, slope, intercept, remarks), remarks};
}

const nrrd_types: Record<string, NumberType> = {
  "signed char": "int8", "int8": "int8", "int8_t": "int8",
  "uchar": "uint8", "unsigned char": "uint8", "uint8": "uint8", "uint8_t": "uint8",
  "short": "int16", "short int": "int16", "signed short": "int16", "int16": "int16", "int16_t": "int16",
  "ushort": "uint16", "unsigned short": "uint16", "uint16": "uint16", "uint16_t": "uint16",
  "int": "int32", "signed int": "int32", "int32": "int32", "int32_t": "int32",
  "uint": "uint32", "unsigned int": "uint32", "uint32": "uint32", "uint32_t": "uint32",
  "float": "float", "double": "double"
};

const millimetres: Record<string, number> = {
  "mm": 1, "millimeter": 1, "cm": 10, "centimeter": 10, "m": 1000, "meter": 1000,
  "um": 0.001, "\u00b5m": 0.001, "\u03bcm": 0.001, "micron": 0.001, "micrometer": 0.001, "in": 25.4, "inch": 25.4
};

/// Millimetres in the unit of each axis of a NRRD file. Undefined if the file states no units.
function units_of(text: string|undefined): number[]|undefined {
  return text === undefined ? undefined : [...text.matchAll(/"([^"]*)"/g)].map(([, word]) => {
    const name = word.trim().toLowerCase().replace(/metre/, "meter").replace(/(.{3})s$/, "$1");
    const mm = millimetres[name];
    if (mm === undefined) throw new Error(`its unit '${word}' is not a known unit of length`);
    return mm;
  });
}

/// The rows of numbers in a text such as "(1,0,0) (0,1,0)".
function vectors(text: string): number[][] {
  return [...text.matchAll(/\(([^)]*)\)/g)].map(match => match[1].split(",").map(Number));
}

export async function read_nrrd(bytes: Uint8Array): Promise<Volume> {
  let end = 0;
  while (end + 1 < bytes.length && !(bytes[end] === 10 && (bytes[end + 1] === 10 || bytes[end + 1] === 13))) ++end;
  const lines = new TextDecoder().decode(bytes.subarray(0, end)).split(/\r?\n/);
  if (!lines[0].startsWith("NRRD000")) throw new Error("it is no NRRD file");
  const at = end + (bytes[end + 1] === 13 ? 3 : 2);
  const fields: Record<string, string> = {};
  for (const line of lines.slice(1)) {
    const colon = line.indexOf(": ");
    if (line[0] !== "#" && colon > 0) fields[line.slice(0, colon).toLowerCase()] = line.slice(colon + 2).trim();
  }
  if (fields["data file"] ?? fields["datafile"]) throw new Error("its samples are in another file, which this page does not read: open it in Octotomy");
  const type = nrrd_types[(fields["type"] ?? "").toLowerCase()];
  if (type === undefined) throw new Error(`its samples are of type '${fields["type"]}', which is not read here`);
  const sizes = (fields["sizes"] ?? "").split(/\s+/).map(Number);
  const dims = checked(sizes, sizes.length);
  const remarks: string[] = [];
  const space = (fields["space"] ?? "").toLowerCase();
  const signs = ({
    "left-posterior-superior": [1, 1, 1], "lps": [1, 1, 1],
    "right-anterior-superior": [-1, -1, 1], "ras": [-1, -1, 1],
    "left-anterior-superior": [1, -1, 1], "las": [1, -1, 1]
  } as Record<string, number[]>)[space];
  if (space !== "" && signs === undefined) throw new Error(`its space '${space}' is not a patient's frame`);
  if (signs === undefined) remarks.push("the file does not say how the patient lies: axes are taken as left, back, head");
  const spacing = (fields["spacings"] ?? "1 1 1").split(/\s+/).map(value => Math.abs(Number(value)) || 1);
  const axes = fields["space directions"] ? vectors(fields["space directions"])
                                          : [[spacing[0], 0, 0], [0, spacing[1], 0], [0, 0, spacing[2] ?? 1]];
  const origin = fields["space origin"] ? vectors(fields["space origin"])[0] : [0, 0, 0];
  if (axes.length !== 3 || [...axes, origin].some(axis => axis.length !== 3 || !axis.every(Number.isFinite)))
    throw new Error("its space directions are not three directions of three numbers");
  const units = units_of(fields[fields["space directions"] ? "space units" : "units"]);
  if (units === undefined) remarks.push("the file states no unit of length: millimetres are assumed");
  const signed = (axis: number[]) => axis.map((value, i) => value * (signs?.[i] ?? 1) * (units?.[i] ?? 1));
  const lps_from_voxel = [...axes.flatMap(axis => [...signed(axis), 0]), ...signed(origin), 1];
  const encoding = (fields["encoding"] ?? "").toLowerCase();
  if (!["raw", "gzip", "gz"].includes(encoding)) throw new Error(`its encoding '${encoding}' is not read here`);
  const data = encoding === "raw" ? bytes.subarray(at) : await inflated(bytes.subarray(at));
  const stored = numbers(data, 0, dims[0] * dims[1] * dims[2], type, (fields["endian"] ?? "little") !== "big");
  return {dims, lps_from_voxel, samples: to_int16(stored, 1, 0, remarks), remarks};
}

/// Reads a scan. The format is recognised by the content of the file, not by its name. Throws Error with the
/// reason.
export async function read_volume(bytes: Uint8Array): Promise<Volume> {
  if (bytes[0] === 0x1f && bytes[1] === 0x8b) bytes = await inflated(bytes);
  return new TextDecoder().decode(bytes.subarray(0, 7)) === "NRRD000" ? read_nrrd(bytes) : read_nifti(bytes);
}
