# SPDX-License-Identifier: AGPL-3.0-or-later
"""Reads NRRD and MetaImage by their definitions, for tests to compare with; it shares nothing with the program.

read(path) gives (lps_from_voxel, samples[x, y, z] as float64, names_frame, states_unit).
"""
import gzip
import os
import re
import zlib

import numpy

SIDES = {"l": (0, 1), "r": (0, -1), "p": (1, 1), "a": (1, -1), "s": (2, 1), "i": (2, -1)}
MM = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "um": 1e-3, "microns": 1e-3, "inch": 25.4, "nm": 1e-6}
NRRD_TYPES = {"signed char": "i1", "int8": "i1", "uchar": "u1", "uint8_t": "u1", "short": "i2", "int16": "i2",
              "ushort": "u2", "unsigned short int": "u2", "int": "i4", "int32_t": "i4", "uint": "u4",
              "long long": "i8", "int64": "i8", "ulonglong": "u8", "float": "f4", "double": "f8"}
META_TYPES = {"CHAR": "i1", "UCHAR": "u1", "SHORT": "i2", "USHORT": "u2", "INT": "i4", "UINT": "u4", "LONG": "i4",
              "ULONG": "u4", "LONG_LONG": "i8", "ULONG_LONG": "u8", "FLOAT": "f4", "DOUBLE": "f8"}


def turned(space):
    """LPS from the axes that a space's name lists; None where it names none of a patient."""
    words = re.sub(r"-time$", "", space.lower())
    letters = [word[0] for word in words.split("-")] if "-" in words else list(words[:3])
    if len(letters) != 3 or len({SIDES.get(letter, (9,))[0] for letter in letters} - {9}) != 3:
        return None
    matrix = numpy.zeros((3, 3))
    for column, letter in enumerate(letters):
        row, sign = SIDES[letter]
        matrix[row, column] = sign
    return matrix


def file_names(statement, listed):
    words = statement.split()
    if words[0] == "LIST":
        return listed
    if "%" in words[0]:
        first, last, step = (int(word) for word in words[1:4])
        return [words[0] % number for number in range(first, last + (1 if step > 0 else -1), step)]
    return [statement]


def samples_of(parts, encoding, dtype, sizes, skip):
    each = int(numpy.prod(sizes)) // len(parts)
    arrays = []
    for part in parts:
        if encoding == "text":
            words = part.decode().split()
            kind = float if dtype[1] == "f" else int
            arrays.append(numpy.array([kind(word) for word in words[:each]], dtype=dtype))
            continue
        if encoding == "hex":
            part = bytes.fromhex(part.decode())
        elif encoding == "packed":
            part = zlib.decompressobj(zlib.MAX_WBITS | 32).decompress(part)
        bytes_needed = each * numpy.dtype(dtype).itemsize
        begin = len(part) - bytes_needed if skip < 0 else skip
        arrays.append(numpy.frombuffer(part[begin:begin + bytes_needed], dtype=dtype))
    return numpy.concatenate(arrays).reshape(sizes, order="F").astype(numpy.float64)


def read_nrrd(path):
    with open(path, "rb") as file:
        content = file.read()
    head, _, rest = content.partition(b"\n\n")
    fields, listed = {}, []
    for line in head.decode().split("\n")[1:]:
        if "datafile" in fields and fields["datafile"].startswith("LIST"):
            listed += [line] if line else []
        elif ":=" not in line and not line.startswith("#"):
            key, _, value = line.partition(":")
            fields[key.replace(" ", "").lower()] = value.strip()
    sizes = [int(word) for word in fields["sizes"].split()]
    vectors = re.findall(r"none|\([^)]*\)", fields.get("spacedirections", ""))
    axes = [axis for axis in range(len(sizes)) if not vectors or vectors[axis] != "none"][:3]
    matrix = numpy.eye(4)
    numbers = lambda text: [float(word) for word in text.strip("()").split(",")][:3]
    units = re.findall('"([^"]*)"', fields.get("spaceunits" if vectors else "units", ""))
    scale = [MM[units[axis]] for axis in range(3)] if units else [1.0] * 3
    if vectors:
        for column, axis in enumerate(axes):
            matrix[:3, column] = numbers(vectors[axis])
        matrix[:3, 3] = numbers(fields.get("spaceorigin", "(0,0,0)"))
    else:
        for axis in axes:
            spacing = float(fields["spacings"].split()[axis])
            matrix[axis, axis] = spacing
            if "axismins" in fields:
                is_node = "centers" in fields and fields["centers"].split()[axis] == "node"
                matrix[axis, 3] = float(fields["axismins"].split()[axis]) + (0 if is_node else spacing / 2)
    frame = turned(fields["space"]) if "space" in fields else None
    matrix[:3] = (numpy.eye(3) if frame is None else frame) @ numpy.diag(scale) @ matrix[:3]
    encoding = {"raw": "raw", "gzip": "packed", "gz": "packed", "ascii": "text", "txt": "text", "hex": "hex"}[fields["encoding"]]
    if "datafile" in fields:
        parts = [open(os.path.join(os.path.dirname(path), name), "rb").read() for name in file_names(fields["datafile"], listed)]
    else:
        parts = [rest]
    lines = int(fields.get("lineskip", 0))
    parts = [part.split(b"\n", lines)[lines] if lines else part for part in parts]
    dtype = (">" if fields.get("endian") == "big" else "<") + NRRD_TYPES[fields["type"]]
    return matrix, samples_of(parts, encoding, dtype, [sizes[axis] for axis in axes], int(fields.get("byteskip", 0))), frame is not None, bool(units)


def read_meta(path):
    with open(path, "rb") as file:
        content = file.read()
    fields, at = {}, 0
    while "ElementDataFile" not in fields:
        end = content.index(b"\n", at)
        key, _, value = content[at:end].decode().partition("=")
        fields[key.strip()] = value.strip()
        at = end + 1
    numbers = lambda *names: next(([float(word) for word in fields[name].split()] for name in names if name in fields), None)
    axes = int(fields["NDims"])
    sizes = [int(word) for word in fields["DimSize"].split()]
    spacing = numbers("ElementSpacing", "ElementSize") or [1.0] * axes
    directions = numpy.array(numbers("TransformMatrix", "Orientation", "Rotation") or numpy.eye(axes).ravel()).reshape(axes, axes)
    matrix = numpy.eye(4)
    for axis in range(3):
        matrix[:3, axis] = directions[axis][:3] * spacing[axis]
    matrix[:3, 3] = (numbers("Offset", "Position", "Origin") or [0.0] * axes)[:3]
    unit = fields.get("DistanceUnits")
    matrix[:3] *= MM.get(unit, 1.0)
    is_true = lambda name, otherwise: fields.get(name, otherwise)[0] in "Tt1"
    encoding = "text" if not is_true("BinaryData", "True") else "packed" if is_true("CompressedData", "False") else "raw"
    data, skip = fields["ElementDataFile"], int(fields.get("HeaderSize", 0))
    if data.upper() == "LOCAL":
        parts = [content[at:] if skip <= 0 else content]
    else:
        listed = content[at:].decode().split("\n") if data.startswith("LIST") else []
        parts = [open(os.path.join(os.path.dirname(path), name), "rb").read() for name in file_names(data, [n for n in listed if n])]
    big = is_true("BinaryDataByteOrderMSB", fields.get("ElementByteOrderMSB", "False"))
    samples = samples_of(parts, encoding, (">" if big else "<") + META_TYPES[fields["ElementType"][4:]], sizes, skip)
    samples = samples.reshape(sizes[:3], order="F")
    samples = samples * float(fields.get("ElementToIntensityFunctionSlope", 1)) + float(fields.get("ElementToIntensityFunctionOffset", 0))
    return matrix, samples, any(name in fields for name in ("TransformMatrix", "Orientation", "Rotation")), unit in MM


def read(path):
    return read_nrrd(path) if path.endswith((".nrrd", ".nhdr")) else read_meta(path)
