// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "voxel/scan/dicom_source.h"
#include "voxel/space/scene.h"

namespace octotomy::voxel {

/// Writes a scene in the format of the extension: .nrrd, .nhdr, .nii, .nii.gz, .mha, .mhd. Where labels
/// overlap, the lowest is written. The samples' type, their meaning, the modality and the padding survive a
/// round trip; frame and unit of length are stated. Geometry is kept in double precision; NIfTI's header has
/// single precision, so an extension, which other readers skip, stores the exact geometry. Written to a
/// temporary file and renamed into place, so that a failure leaves an older file intact. The samples of .nhdr
/// and .mhd go into a data file beside the header under a name that was free, so that an older header never
/// refers to them; the older header's samples are removed last. Throws Error (Input or Resource) with path
/// and reason; if the disk has too little space, before anything is written. Also throws as
/// need_own_data_file() does, and std::invalid_argument for MetaImage if the lattice's axes are not
/// perpendicular, because its readers do not support that.
void write_scene(const Scene& scene, const std::filesystem::path& path);

/// A check for .nhdr and .mhd, whose samples are written into a data file beside the header, to be called
/// before samples are computed. Throws Error (Input) if a file with the data file's name exists but is not
/// the own_data_file() of the header at `path`, or if `path` is a link. Cost: reads a header.
void need_own_data_file(const std::filesystem::path& path);

/// The data file to which the .nhdr or .mhd at `path` refers, if it exists beside the header and has a name
/// that write_scene() may choose. None if `path` is damaged, absent or of another format. Cost: reads a
/// header.
std::optional<std::filesystem::path> own_data_file(const std::filesystem::path& path);

/// The file name under which a scene for `path` is written into a folder of staged files, before it is
/// renamed to `path`. For .nhdr and .mhd, the first name whose data file does not exist yet in the folder of
/// `path`.
std::filesystem::path staged_scene_name(const std::filesystem::path& path);

/// A lower bound on the disk space, in bytes, that write_scene() needs (or write_dicom_series(), for a path
/// of another extension): the full size for .nii, the size after the best possible compression for other
/// formats. Passed to need_disk() before the samples are computed.
std::uint64_t least_file_bytes(const Lattice& lattice, std::uint64_t sample_bytes,
                               const std::filesystem::path& path);

struct DicomOptions {
  std::string patient_name = "Phantom^Octotomy";  ///< family^given; unused if the source names its patient
  std::string series_description = "Octotomy";    ///< at most 64 characters
  /// The series that the scene was made from. The files copy its patient, study and frame of reference, and
  /// each slice refers to the images from which it was made. None, as for a phantom: a new study.
  std::optional<DicomSource> source = std::nullopt;
};

/// Throws Error (Input) with a file's path if the folder already holds slices with the names that
/// write_dicom_series() uses. To be called before the samples are computed.
void need_no_slices(const std::filesystem::path& folder);

/// Writes each slice as a file (slice_0001.dcm and so on) into a folder: as CT Image Storage for a CT or a
/// scene without a modality, as MR Image Storage for an MR, and for every other modality as Secondary Capture
/// with that modality, because the classes of other modalities require attributes that a scene does not have
/// (is_written_as_secondary_capture()). The rescale type is the unit that the scene declares; without one, HU
/// for Hounsfield units, else US. A new folder appears with all slices or not at all; into an existing folder
/// the slices are moved one after the other. A lattice whose third axis is not perpendicular to the first two
/// becomes a series with gantry tilt. Samples are stored as int16. Integers have slope 1 and intercept 0; for
/// other samples the slope is the least power of two for which their range fits. Padding is stored as -32768
/// and stated as such. The files contain a window for viewers: level 500, width 2000 in Hounsfield units,
/// else all values. Unique identifiers are computed from the content: the same scene and options produce the
/// same files, byte by byte. Throws Error (Input or Resource) with path and reason; as need_no_slices() does;
/// std::invalid_argument if a sample is not finite, the first two axes are not perpendicular or a text is too
/// long.
void write_dicom_series(const Scene& scene, const std::filesystem::path& folder,
                        const DicomOptions& options = {});

/// Whether write_dicom_series() writes a scene as Secondary Capture: its modality is neither CT nor MR.
bool is_written_as_secondary_capture(const Scene& scene);

/// The largest rounding error of a sample that write_dicom_series() stores in 16 bits; 0 if all samples keep
/// their values. Throws std::invalid_argument if a sample is not finite.
double dicom_rounding(const Scene& scene);

}  // namespace octotomy::voxel
