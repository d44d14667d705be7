// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <string>

#include "voxel/scan/dicom_file.h"

namespace octotomy::voxel {

/// The part that an attribute plays in telling the images of one series apart.
enum class TraitRole {
  Identity,    ///< images that differ never belong together: the commonest stay
  Origin,      ///< images that differ belong together only if the caller asks to join them
  Stack,       ///< images at one place are parted by it into stacks
  Order,       ///< images at one place are parted by their order in it, if nothing else parts them
  Uniformity,  ///< images that differ stay together; the audit names the fewer
};

/// A DICOM attribute in which the images of one stack agree. Its value is the first of the tags that a file
/// has.
struct DicomTrait {
  const char* check;  ///< its line in the audit
  const char* words;  ///< for people
  TraitRole role;
  std::array<DicomTag, 5> tags;  ///< 0: none
  const char* effect;            ///< of images that differ
};

constexpr std::array<DicomTrait, 21> dicom_traits{{
    {"patient", "patient", TraitRole::Identity, {0x00100020, 0x00100010}, "another patient's images"},
    {"patient_issuer",
     "issuer of the patient's number",
     TraitRole::Identity,
     {0x00100021},
     "images of another issuer's patient of the same number"},
    {"study", "study", TraitRole::Origin, {0x0020000d}, "images of another study"},
    {"modality", "modality", TraitRole::Identity, {0x00080060}, "images of another modality"},
    {"frame_of_reference",
     "frame of reference",
     TraitRole::Origin,
     {0x00200052},
     "images of another frame of reference, whose positions may count from another origin"},
    {"kernel", "kernel", TraitRole::Stack, {0x00181210}, "edges and thin bone differ from slice to slice"},
    {"tube_voltage", "kVp", TraitRole::Stack, {0x00180060}, "bone's values change with the voltage"},
    {"contrast_agent", "contrast", TraitRole::Stack, {0x00180010}, "vessels differ from slice to slice"},
    {"acquisition",
     "acquisition",
     TraitRole::Stack,
     {0x00200012},
     "the patient may have moved between the acquisitions"},
    {"phase",
     "phase",
     TraitRole::Stack,
     {0x00209241, 0x00209245, 0x00200100, 0x00209128, 0x00181060},
     "the slices show different times"},
    {"echo", "echo", TraitRole::Stack, {0x00180081, 0x00180086}, "tissues' values change with the echo"},
    {"diffusion", "b value", TraitRole::Stack, {0x00189087}, "tissues' values change with the b value"},
    {"time", "time", TraitRole::Order, {0x00189074, 0x0008002a, 0x00080032, 0x00080033}, ""},
    {"stack", "stack", TraitRole::Stack, {0x00209056}, "the slices are of several stacks"},
    {"image_type", "type", TraitRole::Stack, {0x00080008}, "some slices are measured, others derived"},
    {"patient_name", "name", TraitRole::Uniformity, {0x00100010}, "the identifier is the same"},
    {"patient_birth_date",
     "birth date",
     TraitRole::Uniformity,
     {0x00100030},
     "the identifier is the same, but they may be another patient's"},
    {"patient_sex",
     "sex",
     TraitRole::Uniformity,
     {0x00100040},
     "the identifier is the same, but they may be another patient's"},
    {"acquisition_date",
     "date of acquisition",
     TraitRole::Uniformity,
     {0x00080022},
     "days lie between the images, in which the patient moved and may have changed"},
    {"patient_position",
     "position",
     TraitRole::Uniformity,
     {0x00185100},
     "the patient lay differently: check left and right"},
    {"scanner", "scanner", TraitRole::Uniformity, {0x00081090, 0x00080070}, "several scanners' images"},
}};

using DicomTraitValues = std::array<std::string, dicom_traits.size()>;

}  // namespace octotomy::voxel
