#!/usr/bin/python3
# SPDX-License-Identifier: AGPL-3.0-or-later
"""Random NIfTI, NRRD and MetaImage headers: the program reads what nibabel and plain_volume.py read.

random_volumes.py PROGRAM [--count N] [--seed S] [--keep FOLDER]

PROGRAM is volume_lines. A file's number is its seed: --seed S --count 1 repeats it. Each file's places, samples
and the audit's lines on frame and unit are compared. Status 1 where any differs, 77 where a package is missing.
"""
import argparse
import collections
import gzip
import json
import os
import subprocess
import sys
import tempfile
import warnings
import zlib

try:
    import nibabel
    import numpy
except ImportError as missing:
    print(missing, file=sys.stderr)
    sys.exit(77)
import plain_volume

LPS_FROM_RAS = numpy.diag([-1.0, -1.0, 1.0, 1.0])
FIRST = {"m": 1000.0, "mm": 1.0, "um": 1e-3}


def rotation(random):
    """Also such that turn by nothing, by quarters and by halves."""
    kind = random.integers(4)
    if kind == 0:
        return numpy.eye(3)
    if kind == 1:
        return numpy.eye(3)[random.permutation(3)] * random.choice([-1.0, 1.0], 3)[:, None]
    matrix, _ = numpy.linalg.qr(random.normal(size=(3, 3)))
    return matrix


def affine(random, may_shear=True):
    matrix = numpy.eye(4)
    matrix[:3, :3] = rotation(random) @ numpy.diag(random.uniform(0.1, 5.0, 3))
    if may_shear and random.integers(4) == 0:
        matrix[:3, :3] = matrix[:3, :3] @ (numpy.eye(3) + numpy.triu(random.uniform(-0.4, 0.4, (3, 3)), 1))
    matrix[:3, 3] = random.uniform(-300.0, 300.0, 3)
    return matrix


def stored(random, dtype, count):
    """Samples of a type, its least and greatest among them now and then."""
    dtype = numpy.dtype(dtype)
    if dtype.kind == "f":
        return (random.normal(size=count) * 10.0 ** random.integers(-3, 5)).astype(dtype)
    limits = numpy.iinfo(dtype)
    bound = int(random.choice([5, 200, 3000, 2**31, 2**62]))
    low, high = max(limits.min, -bound), min(limits.max, bound)
    return random.integers(low, high, count, dtype=dtype.newbyteorder("="), endpoint=True).astype(dtype)


def nifti(random, folder, name):
    """A NIfTI as bytes; what nibabel reads of it."""
    version = int(random.integers(1, 3))
    is_pair = bool(random.integers(4) == 0)
    order = str(random.choice(["<", ">"]))
    kinds = {(1, False): nibabel.Nifti1Image, (1, True): nibabel.Nifti1Pair, (2, False): nibabel.Nifti2Image, (2, True): nibabel.Nifti2Pair}
    kind = kinds[version, is_pair]
    header = kind.header_class(endianness=order)
    is_slice = bool(random.integers(8) == 0)
    sizes = [int(size) for size in random.integers(1, 7, 2 if is_slice else 3)]
    trailing = [] if is_slice else [1] * int(random.integers(3))
    codes = [int(code) for code in random.integers(0, 4, 2)]
    if is_slice and not any(codes):
        codes[0] = 1
    dtype = numpy.dtype(str(random.choice(["u1", "i1", "i2", "u2", "i4", "u4", "i8", "u8", "f4", "f8"]))).newbyteorder(order)
    raw = header.structarr
    raw["datatype"] = nibabel.nifti1.data_type_codes.code[dtype.type]
    raw["bitpix"] = 8 * dtype.itemsize
    raw["dim"] = [len(sizes) + len(trailing)] + sizes + trailing + [1] * (7 - len(sizes) - len(trailing))
    raw["pixdim"][1:] = random.uniform(0.1, 5.0, 7)
    raw["pixdim"][0] = random.choice([1.0, -1.0, 0.0])
    raw["qform_code"], raw["sform_code"] = codes
    # Any quaternion, and those near half a turn, whose first number is nearly 0.
    turn = random.normal(size=4) * ([0.02, 1, 1, 1] if random.integers(4) == 0 else [1, 1, 1, 1])
    turn = turn / numpy.linalg.norm(turn) * numpy.sign(turn[0] or 1.0)
    raw["quatern_b"], raw["quatern_c"], raw["quatern_d"] = 0.9999999 * turn[1:]
    raw["qoffset_x"], raw["qoffset_y"], raw["qoffset_z"] = random.uniform(-300, 300, 3)
    sform = affine(random)
    raw["srow_x"], raw["srow_y"], raw["srow_z"] = sform[:3]
    unit = int(random.choice([0, 1, 2, 3]))
    raw["xyzt_units"] = unit | int(random.choice([0, 8, 16]))
    raw["scl_slope"] = random.choice([0.0, numpy.nan, 1.0, 1.0, random.uniform(-3, 3), 0.5])
    raw["scl_inter"] = random.choice([0.0, 0.0, -1024.0, random.uniform(-100, 100)])
    least = {1: 352, 2: 544}[version]
    raw["vox_offset"] = (0 if is_pair else least) + 16 * int(random.integers(3))
    values = stored(random, dtype, int(numpy.prod(sizes)))
    before = bytes(raw.tobytes()) + bytes(4)
    gap = int(raw["vox_offset"]) - (0 if is_pair else len(before))
    packs = bool(random.integers(2))
    write = (lambda path, content: gzip.open(path + ".gz", "wb").write(content)) if packs else (lambda path, content: open(path, "wb").write(content))
    base = os.path.join(folder, name)
    if is_pair:
        write(base + ".hdr", before)
        write(base + ".img", bytes(gap) + values.tobytes())
    else:
        write(base + ".nii", before + bytes(gap) + values.tobytes())
    path = base + (str(random.choice([".hdr", ".img"])) if is_pair else ".nii") + (".gz" if packs else "")
    image = nibabel.load(path)
    expected = LPS_FROM_RAS @ image.affine
    # nibabel computes a quaternion's first number in single precision: near half a turn it is off by its root.
    tolerance = 2e-3 if codes[0] and not codes[1] else 1e-6 if not codes[1] else 1e-12
    expected[:3] *= {0: 1.0, 1: FIRST["m"], 2: 1.0, 3: FIRST["um"]}[unit]
    return path, expected, numpy.asarray(image.dataobj).astype(numpy.float64).reshape(sizes + [1] * (3 - len(sizes)), order="F"), any(codes), unit != 0, tolerance


def written_samples(random, values, encoding, sizes):
    """The encoded samples of one file."""
    if encoding == "text":
        return (" ".join(repr(value.item()) for value in values) + "\n").encode()
    content = values.tobytes()
    if encoding == "hex":
        return content.hex().encode()
    if encoding == "zlib":
        return zlib.compress(content)
    return gzip.compress(content) if encoding == "packed" else content


def spread(random, folder, name, values, encoding, lines=0, skip=0):
    """Writes data files; returns the statement that names them and the lines of a list."""
    count = int(random.choice([1, 1, 2, 3]))
    if values.size % count:
        count = 1
    way = str(random.choice(["list", "pattern"])) if count > 1 else "one"
    names = [f"{name}_{number:03d}.raw" for number in range(5, 5 + 2 * count, 2)]
    for part, file_name in zip(values.reshape(count, -1), names):
        content = b"a line\n" * lines
        if encoding == "packed" and skip > 0:
            content += gzip.compress(bytes(skip) + part.tobytes())
        else:
            content += (bytes(skip if skip >= 0 else 5) if encoding == "raw" else b"") + written_samples(random, part, encoding, None)
        with open(os.path.join(folder, file_name), "wb") as file:
            file.write(content)
    if way == "list":
        return "LIST", names
    return (f"{name}_%03d.raw 5 {5 + 2 * (count - 1)} 2" if way == "pattern" else names[0]), []


def vector(numbers, random):
    return "(" + (", " if random.integers(2) else ",").join(repr(float(number)) for number in numbers) + ")"


def nrrd(random, folder, name):
    types = list(plain_volume.NRRD_TYPES)
    type_name = str(random.choice(types))
    encoding = str(random.choice(["raw", "gzip", "gz", "ascii", "txt", "hex"]))
    is_text = encoding in ("ascii", "txt")
    order = str(random.choice(["<", ">"]))
    dtype = numpy.dtype(("" if is_text else order) + plain_volume.NRRD_TYPES[type_name])
    sizes = [int(size) for size in random.integers(1, 7, 3)]
    values = stored(random, dtype, int(numpy.prod(sizes)))
    lines = ["NRRD000" + str(random.choice([1, 4, 5])), "# made at random", f"type: {type_name}"]
    letters = [str(random.choice(list(pair))) for pair in ("lr", "pa", "si")]
    random.shuffle(letters)
    words = {"l": "left", "r": "right", "p": "posterior", "a": "anterior", "s": "superior", "i": "inferior"}
    space = str(random.choice(["".join(letters).upper(), "-".join(words[letter] for letter in letters), "scanner-xyz", "3D-right-handed", ""]))
    has_time = bool(space and random.integers(8) == 0)
    extra = 1 if random.integers(4) == 0 else 0  # an axis of one value, none of space
    first = bool(random.integers(2))
    put = lambda parts, other: ([other] + parts if first else parts + [other]) if extra else parts
    body = [f"dimension: {3 + extra}", "sizes: " + " ".join(put([str(size) for size in sizes], "1"))]
    matrix = affine(random)
    if space:
        body.append("space: " + space + ("-time" if has_time else ""))
    if space or random.integers(2):
        rows = [vector(list(matrix[:3, axis]) + [0.0] * has_time, random) for axis in range(3)]
        if not space:
            body.append("space dimension: 3")
        body.append("space directions: " + " ".join(put(rows, "none")))
        if random.integers(8):
            body.append("space origin: " + vector(list(matrix[:3, 3]) + [0.0] * has_time, random))
        body.append("kinds: " + " ".join(put(["domain"] * 3, "list")))
        units = 'space units: ' + " ".join(f'"{random.choice(list(plain_volume.MM))}"' for _ in range(3)) + (' "s"' if has_time else "")
    else:
        body.append("kinds: " + " ".join(put(["domain"] * 3, "scalar")))
        extra_is_first = extra and first
        if extra_is_first:  # plain_volume reads axes by their place
            body = [f"dimension: 3", "sizes: " + " ".join(str(size) for size in sizes)]
        tail = "" if extra_is_first or not extra else " nan"
        body.append("spacings: " + " ".join(repr(float(number)) for number in random.uniform(0.1, 5, 3)) + tail)
        if random.integers(2):
            body.append("axis mins: " + " ".join(repr(float(number)) for number in random.uniform(-100, 100, 3)) + tail)
            if random.integers(2):
                body.append("centers: " + " ".join(str(random.choice(["node", "cell"])) for _ in range(3)) + (" ???" if tail else ""))
        units = "units: " + " ".join(f'"{random.choice(list(plain_volume.MM))}"' for _ in range(3)) + (' ""' if tail else "")
    if random.integers(2):
        body.append(units)
    if dtype.itemsize > 1 and not is_text:
        body.append("endian: " + ("big" if order == ">" else "little"))
    body.append(f"encoding: {encoding}")
    kind = {"gzip": "packed", "gz": "packed", "ascii": "text", "txt": "text"}.get(encoding, encoding)
    is_detached = bool(random.integers(3) == 0)
    listed = []
    random.shuffle(body)
    if is_detached:
        skipped = int(random.choice([0, 0, 2]))
        skip = int(random.choice([0, 7, -1])) if kind == "raw" else int(random.choice([0, 7])) if kind == "packed" else 0
        statement, listed = spread(random, folder, name, values, kind, skipped, skip)
        if skipped:
            body.append(f"line skip: {skipped}")
        if skip:
            body.append(f"byte skip: {skip}")
        body += ["space:=a key, no field", "data file: " + statement] + listed
    path = os.path.join(folder, name + (".nhdr" if is_detached else ".nrrd"))
    with open(path, "wb") as file:
        file.write(("\n".join(lines + body) + "\n").encode())
        if not is_detached:
            file.write(b"a_key:=a value\n\n" + written_samples(random, values, kind, sizes))
    return (path,) + plain_volume.read(path) + (1e-12,)


def meta(random, folder, name):
    type_name = str(random.choice(list(plain_volume.META_TYPES)))
    encoding = str(random.choice(["raw", "zlib", "packed", "text"]))
    order = str(random.choice(["<", ">"]))
    dtype = numpy.dtype(("" if encoding == "text" else order) + plain_volume.META_TYPES[type_name])
    sizes = [int(size) for size in random.integers(1, 7, 3)]
    values = stored(random, dtype, int(numpy.prod(sizes)))
    trailing = int(random.integers(4) == 0)
    axes = 3 + trailing
    matrix = affine(random)
    lengths = numpy.linalg.norm(matrix[:3, :3], axis=0)
    text = lambda numbers: " ".join(repr(float(number)) for number in numbers)
    body = ["ObjectType = Image", f"NDims = {axes}", "DimSize = " + " ".join(str(size) for size in sizes + [1] * trailing)]
    more = [str(random.choice(["ElementSpacing", "ElementSize"])) + " = " + text(list(lengths) + [1.0] * trailing)]
    if random.integers(4):
        full = numpy.eye(axes)
        full[:3, :3] = (matrix[:3, :3] / lengths).T
        more.append(str(random.choice(["TransformMatrix", "Orientation", "Rotation"])) + " = " + text(full.ravel()))
    if random.integers(8):
        more.append(str(random.choice(["Offset", "Position", "Origin"])) + " = " + text(list(matrix[:3, 3]) + [0.0] * trailing))
    unit = str(random.choice(["", "?", "mm", "um", "cm", "m", "inch"]))
    if unit:
        more.append("DistanceUnits = " + unit)
    if random.integers(3) == 0:
        more.append("ElementToIntensityFunctionSlope = " + repr(float(random.choice([1.0, 0.5, random.uniform(-3, 3)]))))
    if random.integers(3) == 0:
        more.append("ElementToIntensityFunctionOffset = " + repr(float(random.choice([-1024.0, random.uniform(-9, 9)]))))
    is_text = encoding == "text"
    more.append("BinaryData = " + ("False" if is_text else "True"))
    if not is_text:
        more.append(str(random.choice(["BinaryDataByteOrderMSB", "ElementByteOrderMSB"])) + " = " + ("True" if order == ">" else "False"))
        more.append("CompressedData = " + ("False" if encoding == "raw" else "True"))
    more.append("ElementType = MET_" + type_name)
    is_detached = bool(random.integers(3) == 0)
    listed, statement = [], "LOCAL"
    if is_detached:
        skip = int(random.choice([0, 9, -1])) if encoding == "raw" else 0
        if skip:
            more.append(f"HeaderSize = {skip}")
        statement, listed = spread(random, folder, name, values, encoding, 0, skip)
    random.shuffle(more)
    path = os.path.join(folder, name + (".mhd" if is_detached else ".mha"))
    with open(path, "wb") as file:
        file.write(("\n".join(body + more + ["ElementDataFile = " + statement] + listed) + "\n").encode())
        if not is_detached:
            file.write(written_samples(random, values, encoding, sizes))
    return (path,) + plain_volume.read(path) + (1e-12,)


def held(samples):
    """Values as a scene holds them: integers of 16 bits, or numbers of single precision."""
    if numpy.all(samples == numpy.trunc(samples)) and samples.min() >= -32768 and samples.max() <= 32767:
        return samples
    return samples.astype(numpy.float32).astype(numpy.float64)


def differences(said, expected, samples, names_frame, states_unit, tolerance):
    """What the program says otherwise, in words."""
    if "error" in said:
        return ["refused: " + said["error"]]
    found = []
    places = numpy.vstack([numpy.array(said["lps"]).reshape(3, 4), [0, 0, 0, 1]])
    corners = numpy.array([[x, y, z, 1] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float).T
    corners[:3] *= (numpy.array(samples.shape) - 1)[:, None]
    shift = numpy.abs((places - expected) @ corners).max()
    columns = numpy.linalg.norm(places[:3, :3] - expected[:3, :3], axis=0) / numpy.linalg.norm(expected[:3, :3], axis=0)
    if columns.max() > tolerance or shift > tolerance * (1.0 + numpy.abs(expected @ corners).max()):
        found.append(f"places differ by {shift:.4g} mm:\n{places}\n{expected}")
    if list(samples.shape) != said["dims"]:
        return found + [f"dims {said['dims']}, right {list(samples.shape)}"]
    right = held(samples).ravel(order="F")
    is_exact = numpy.array_equal(numpy.array(said["samples"]), right)
    if not is_exact and not numpy.allclose(said["samples"], right, rtol=2e-7, atol=0.0):
        found.append(f"samples {said['samples'][:8]}, right {right[:8].tolist()}")
    verdicts = {}
    for check, verdict, _ in said["audit"]:
        verdicts.setdefault(check, set()).add(verdict)
    for check, is_stated in (("orientation", names_frame), ("length_unit", states_unit)):
        if verdicts.get(check) != {"PASS" if is_stated else "WARN"}:
            found.append(f"{check} is {verdicts.get(check)}, though it is {'' if is_stated else 'not '}stated")
    return found


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--count", type=int, default=int(os.environ.get("OCTOTOMY_RANDOM_VOLUMES", "300")))
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--keep")
    asked = parser.parse_args()
    warnings.simplefilter("ignore")
    kinds = [nifti, nrrd, meta]
    tally, bad = collections.Counter(), 0
    with tempfile.TemporaryDirectory() as scratch:
        folder = asked.keep or scratch
        os.makedirs(folder, exist_ok=True)
        program = subprocess.Popen([asked.program], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        for seed in range(asked.seed, asked.seed + asked.count):
            random = numpy.random.default_rng(seed)
            kind = kinds[seed % len(kinds)]
            path, *right = kind(random, folder, f"v{seed}")
            program.stdin.write(path + "\n")
            program.stdin.flush()
            said = json.loads(program.stdout.readline())
            found = differences(said, *right)
            tally[kind.__name__] += 1
            bad += bool(found)
            for line in found:
                print(f"seed {seed}, {os.path.basename(path)}: {line}")
            if not asked.keep:
                for name in os.listdir(folder):
                    os.remove(os.path.join(folder, name))
        program.stdin.close()
        program.wait()
    print(f"{asked.count} headers ({', '.join(f'{count} {name}' for name, count in tally.items())}): {bad} differ")
    return 1 if bad or asked.count == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
