#!/usr/bin/python3
# SPDX-License-Identifier: AGPL-3.0-or-later
"""Says what pydicom, nibabel or numpy read, for the tests to compare with.

other_readers.py dicom FOLDER [FILE.nii.gz]
other_readers.py nifti FILE   [FILE.nii.gz]
other_readers.py raw FILE DIMS TYPE SPACING [FILE.nii.gz]      256x256x113 >u2 1,1,2
other_readers.py seg FILE
other_readers.py derived FOLDER SOURCE
other_readers.py structures FILE LABELS.nii.gz
other_readers.py model FILE

Prints one JSON object: dims, spacing_mm, lps_from_voxel, range; with FILE.nii.gz also how many of its samples
differ ("differing") and by how much its places do ("shift_mm"). Status 77 where a package is missing.
"""
import json
import os
import sys

try:
    import numpy
    if sys.argv[1] in ("dicom", "seg", "derived", "structures", "model"):
        import pydicom
    import nibabel
except ImportError as missing:
    print(missing, file=sys.stderr)
    sys.exit(77)


def slices_of(folder):
    """Images with a place, as pydicom reads them."""
    found = []
    for root, _, names in os.walk(folder):
        for name in names:
            try:
                image = pydicom.dcmread(os.path.join(root, name))
            except pydicom.errors.InvalidDicomError:
                continue
            if "ImagePositionPatient" in image and "PixelData" in image:
                found.append(image)
    return found


def dicom(folder):
    """A series stacked along the normal of its slices: samples[x, y, z] and their places."""
    images = slices_of(folder)
    row, column = numpy.array(images[0].ImageOrientationPatient, float).reshape(2, 3)
    normal = numpy.cross(row, column)

    def height(image):
        return float(numpy.dot(normal, numpy.array(image.ImagePositionPatient, float)))

    images.sort(key=height)
    samples = numpy.stack([
        image.pixel_array.T * float(image.get("RescaleSlope", 1)) + float(image.get("RescaleIntercept", 0))
        for image in images
    ], axis=2)
    places = numpy.eye(4)
    between_rows, between_columns = (float(v) for v in images[0].PixelSpacing)
    places[:3, 0] = row * between_columns
    places[:3, 1] = column * between_rows
    places[:3, 2] = normal * (height(images[-1]) - height(images[0])) / (len(images) - 1)
    places[:3, 3] = numpy.array(images[0].ImagePositionPatient, float)
    return samples, places


def padded(image):
    """Where the scanner measured nothing, of a slice's stored pixels."""
    value = image.get("PixelPaddingValue")
    if value is None:
        return numpy.zeros(image.pixel_array.shape, bool).T
    low, high = sorted((value, image.get("PixelPaddingRangeLimit", value)))
    return ((image.pixel_array >= low) & (image.pixel_array <= high)).T


def measured_of(folder):
    """The measured samples of each slice."""
    for image in slices_of(folder):
        values = image.pixel_array.T * float(image.get("RescaleSlope", 1)) + float(image.get("RescaleIntercept", 0))
        yield values[~padded(image)]


def nifti(path):
    image = nibabel.load(path)
    return numpy.asanyarray(image.dataobj), numpy.diag([-1.0, -1.0, 1.0, 1.0]) @ image.affine


def raw(path, dims, kind, spacing):
    dims = [int(n) for n in dims.split("x")]
    spacing = [float(n) for n in spacing.split(",")]
    samples = numpy.fromfile(path, dtype=kind).reshape(dims, order="F")
    places = numpy.diag(spacing + [1.0])
    places[:3, 3] = [-0.5 * (n - 1) * step for n, step in zip(dims, spacing)]
    return samples, places


def seg(path):
    """A segmentation's set pixels as the volume of its frames, and what it refers to."""
    image = pydicom.dcmread(path)
    frames = image.pixel_array
    if frames.ndim == 2:
        frames = frames[None]
    shared = image.SharedFunctionalGroupsSequence[0]
    row, column = numpy.array(shared.PlaneOrientationSequence[0].ImageOrientationPatient, float).reshape(2, 3)
    between_rows, between_columns = (float(v) for v in shared.PixelMeasuresSequence[0].PixelSpacing)
    positions = [numpy.array(f.PlanePositionSequence[0].ImagePositionPatient, float)
                 for f in image.PerFrameFunctionalGroupsSequence]
    count = 0
    total = numpy.zeros(3)
    for frame, first in zip(frames, positions):
        y, x = numpy.nonzero(frame)
        count += len(x)
        total += len(x) * first + row * between_columns * x.sum() + column * between_rows * y.sum()
    pixel = between_rows * between_columns * float(shared.PixelMeasuresSequence[0].SpacingBetweenSlices)
    series = image.get("ReferencedSeriesSequence", [])
    segment = image.SegmentSequence[0]
    return {
        "modality": image.Modality,
        "frames": len(frames),
        "voxels": count,
        "volume_mm3": count * pixel,
        "centroid_mm": list(total / max(count, 1)),
        "label": segment.SegmentLabel,
        "algorithm": segment.SegmentAlgorithmType,
        "patient": str(image.PatientName),
        "study": image.StudyInstanceUID,
        "frame_of_reference": image.get("FrameOfReferenceUID", None),
        "series": [s.SeriesInstanceUID for s in series],
        "instances": sum(len(s.ReferencedInstanceSequence) for s in series),
        "frames_with_source": sum(
            len(f.DerivationImageSequence) > 0 and len(f.DerivationImageSequence[0].SourceImageSequence) > 0
            for f in image.PerFrameFunctionalGroupsSequence if "DerivationImageSequence" in f),
    }


def derived(folder, source):
    """What a series says of the series that it was made from, looked up there."""
    images = slices_of(folder)
    originals = {image.SOPInstanceUID: image for image in slices_of(source)}
    first = next(iter(originals.values()))
    row, column = numpy.array(first.ImageOrientationPatient, float).reshape(2, 3)
    normal = numpy.cross(row, column)
    farthest = 0.0
    referred = unknown = 0
    for image in images:
        height = numpy.dot(normal, numpy.array(image.ImagePositionPatient, float))
        listed = {item.ReferencedSOPInstanceUID
                  for series in image.ReferencedSeriesSequence
                  for item in series.ReferencedInstanceSequence}
        for item in image.SourceImageSequence:
            referred += 1
            original = originals.get(item.ReferencedSOPInstanceUID)
            if (original is None or original.SOPClassUID != item.ReferencedSOPClassUID
                    or item.ReferencedSOPInstanceUID not in listed):
                unknown += 1
                continue
            distance = height - numpy.dot(normal, numpy.array(original.ImagePositionPatient, float))
            farthest = max(farthest, abs(float(distance)))
    def shared(name):
        return all(str(image.get(name, "")) == str(first.get(name, "")) for image in images)
    return {
        "images": len(images),
        "references": referred,
        "unknown": unknown,
        "farthest_mm": farthest,
        "modality": images[0].Modality,
        "same": [name for name in ("PatientName", "PatientID", "StudyInstanceUID", "FrameOfReferenceUID")
                 if shared(name)],
        "own_series": images[0].SeriesInstanceUID != first.SeriesInstanceUID,
        "own_instances": not any(image.SOPInstanceUID in originals for image in images),
        "image_type": list(images[0].ImageType)[:2],
    }


def inside(points, columns, rows):
    """Which of the grid's pixels have their centres in a polygon, by the even-odd rule."""
    x, y = numpy.meshgrid(columns, rows, indexing="ij")
    found = numpy.zeros(x.shape, bool)
    for (ax, ay), (bx, by) in zip(points, numpy.roll(points, -1, 0)):
        if ay != by:
            found ^= ((ay > y) != (by > y)) & (x < (bx - ax) * (y - ay) / (by - ay) + ax)
    return found


def structures(path, labels):
    """How far the voxels inside a structure set's contours are those of a label map on the same lattice."""
    image = pydicom.dcmread(path)
    samples, places = nifti(labels)
    to_voxel = numpy.linalg.inv(places)
    step_mm = numpy.linalg.norm(places[:3, 2])
    names = {int(region.ROINumber): region.ROIName for region in image.StructureSetROISequence}
    kinds, referred = set(), set()
    voxels = differing = 0
    farthest = 0.0
    for region in image.ROIContourSequence:
        number = int(region.ReferencedROINumber)
        wanted = samples == number
        held = numpy.zeros(samples.shape, bool)
        for contour in region.ContourSequence:
            kinds.add(contour.ContourGeometricType)
            referred |= {item.ReferencedSOPInstanceUID for item in contour.get("ContourImageSequence", [])}
            points = numpy.array(contour.ContourData, float).reshape(-1, 3)
            points = (numpy.c_[points, numpy.ones(len(points))] @ to_voxel.T)[:, :3]
            plane = int(round(points[:, 2].mean()))
            farthest = max(farthest, numpy.abs(points[:, 2] - plane).max() * step_mm)
            held[:, :, plane] ^= inside(points[:, :2], range(samples.shape[0]), range(samples.shape[1]))
        voxels += int(wanted.sum())
        differing += int((held != wanted).sum())
    return {
        "names": names,
        "kinds": sorted(kinds),
        "voxels": voxels,
        "differing": differing,
        "farthest_mm": float(farthest),
        "references": len(referred),
        "patient": str(image.PatientName),
        "study": image.StudyInstanceUID,
        "frame_of_reference": image.FrameOfReferenceUID,
    }


def model(path):
    """What an encapsulated STL states, and the extent of its corners."""
    image = pydicom.dcmread(path)
    document = image.EncapsulatedDocument[:image.EncapsulatedDocumentLength]
    count = int.from_bytes(document[80:84], "little")
    kind = numpy.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("rest", "<u2")])
    corners = numpy.frombuffer(document[84:], kind, count)["corners"].reshape(-1, 3)
    return {
        "type": image.MIMETypeOfEncapsulatedDocument,
        "unit": image.MeasurementUnitsCodeSequence[0].CodeValue,
        "patient": str(image.PatientName),
        "frame_of_reference": image.FrameOfReferenceUID,
        "low": corners.min(0).tolist(),
        "high": corners.max(0).tolist(),
    }


def compared(samples, places, path):
    other, other_places = nifti(path)
    corners = numpy.array([[x * (samples.shape[0] - 1), y * (samples.shape[1] - 1), z * (samples.shape[2] - 1), 1]
                           for x in (0, 1) for y in (0, 1) for z in (0, 1)])
    shift = numpy.abs((places - other_places) @ corners.T).max()
    same_shape = samples.shape == other.shape
    return {"differing": int((samples != other).sum()) if same_shape else None, "shift_mm": float(shift)}


def main():
    kind, arguments = sys.argv[1], sys.argv[2:]
    if kind == "seg":
        print(json.dumps(seg(arguments[0])))
        return
    if kind == "derived":
        print(json.dumps(derived(*arguments)))
        return
    if kind in ("structures", "model"):
        print(json.dumps({"structures": structures, "model": model}[kind](*arguments)))
        return
    used = {"dicom": 1, "nifti": 1, "raw": 4}[kind]
    samples, places = {"dicom": dicom, "nifti": nifti, "raw": raw}[kind](*arguments[:used])
    said = {
        "dims": list(samples.shape),
        "spacing_mm": [float(numpy.linalg.norm(places[:3, axis])) for axis in range(3)],
        "lps_from_voxel": places.tolist(),
        "range": [float(samples.min()), float(samples.max())],
    }
    if kind == "dicom":
        measured = numpy.concatenate([part.ravel() for part in measured_of(arguments[0])])
        said["range"] = [float(measured.min()), float(measured.max())]
    if len(arguments) > used:
        said.update(compared(samples, places, arguments[used]))
    print(json.dumps(said))


main()
