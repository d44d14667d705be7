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
/// overlap, the lowest stays. The samples' type, their meaning, the modality and the padding survive a round
/// trip; frame and unit of length are stated. Geometry is kept in double precision; NIfTI files, single
/// precision by themselves, keep it in an extension that other readers skip. Written beside and renamed into
/// place, so that a failure leaves an older file intact. The samples of .nhdr and .mhd go into a data file
/// beside the header under a name that was free, so that an older header never reads them; those of the older
/// header are removed last. Throws Error, Input or Resource, with path and reason, before a byte is written
/// where the disk cannot take it; as need_own_data_file(); std::invalid_argument for MetaImage, whose readers
/// take none, if the lattice's axes are not perpendicular.
void write_scene(const Scene& scene, const std::filesystem::path& path);

/// Of .nhdr and .mhd, whose samples go into a data file beside them: throws Error (Input) where a file of
/// that name is there and the header at `path` has no own_data_file(), or where `path` is a link. For
/// refusals before the samples are made. Cost: reads a header.
void need_own_data_file(const std::filesystem::path& path);

/// The data file that the .nhdr or .mhd at `path` names, if it is there, beside the header, and has a name
/// that write_scene() gives. None where `path` is damaged, absent or of another format. Cost: reads a header.
std::optional<std::filesystem::path> own_data_file(const std::filesystem::path& path);

/// The file name under which a scene for `path` is written into a folder of staged files, before it gets the
/// name of `path`: of .nhdr and .mhd the first for which the name of the data file is free beside `path`.
std::filesystem::path staged_scene_name(const std::filesystem::path& path);

/// Bytes that write_scene(), or for a path of another extension write_dicom_series(), takes of the disk at
/// least while it writes samples of this size: what .nii has, and the rest as packed as it can be.
/// For need_disk(), before the samples are made.
std::uint64_t least_file_bytes(const Lattice& lattice, std::uint64_t sample_bytes,
                               const std::filesystem::path& path);

struct DicomOptions {
  std::string patient_name = "Phantom^Octotomy";  ///< family^given; unused if the source names its patient
  std::string series_description = "Octotomy";    ///< at most 64 characters
  /// The series that the scene was made from. The files take over its patient, study and frame of reference,
  /// and each slice refers to the images behind it. None: a phantom in a study of its own.
  std::optional<DicomSource> source = std::nullopt;
};

/// Throws Error (Input) with the file's path where a folder holds slices as write_dicom_series() names them.
/// For refusals before the samples are made.
void need_no_slices(const std::filesystem::path& folder);

/// Writes each slice as a file (slice_0001.dcm and so on) into a folder: as CT Image Storage of a CT or where
/// the scene states no modality, as MR Image Storage of an MR, and of every other modality as Secondary
/// Capture with that modality, since those kinds' own classes need attributes that a scene does not hold
/// (is_written_as_secondary_capture()). The rescale type is the unit that the scene declares; where it
/// declares none HU of Hounsfield units, else US. A folder that is absent appears whole, with all slices, or
/// not at all; one that is there gets them one after the other. A lattice whose third axis is not
/// perpendicular to the first two becomes a series with gantry tilt. Samples are written as int16: integers
/// with slope 1 and intercept 0, others with the finest slope for which their range fits, a power of two.
/// Padding is stored as -32768 and stated as such. Viewers get a window: level 500, width 2000 in Hounsfield
/// units, else all values. Unique identifiers come from the content: the same scene and options give the same
/// files, byte by byte. Throws Error, Input or Resource, with path and reason, also as need_no_slices();
/// std::invalid_argument if a sample is not finite, the first two axes are not perpendicular or a text is too
/// long.
void write_dicom_series(const Scene& scene, const std::filesystem::path& folder,
                        const DicomOptions& options = {});

/// Whether write_dicom_series() writes a scene as Secondary Capture: its modality is neither CT nor MR.
bool is_written_as_secondary_capture(const Scene& scene);

/// By how much a sample changes at most where write_dicom_series() stores it in 16 bits; 0 where all keep
/// their values. Throws std::invalid_argument if a sample is not finite.
double dicom_rounding(const Scene& scene);

}  // namespace octotomy::voxel
