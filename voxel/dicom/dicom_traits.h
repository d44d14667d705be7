// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <string>

#include "voxel/dicom/dicom_file.h"

namespace octotomy::voxel {

/// How an attribute separates the images of one series.
enum class TraitRole {
  Identity,    ///< images that differ are never joined; only images with the commonest value are used
  Origin,      ///< images that differ are joined only if the caller requests it
  Stack,       ///< splits images at one position into stacks
  Order,       ///< orders the images at one position; splits them if no other attribute does
  Uniformity,  ///< images that differ remain together; the audit lists the images with rarer values
};

/// A DICOM attribute by which the images of a series are compared. Its value is that of the first of `tags`
/// that a file contains.
struct DicomTrait {
  const char* check;  ///< name of its line in the audit
  const char* words;  ///< its name in messages
  TraitRole role;
  std::array<DicomTag, 5> tags;  ///< 0: none
  const char* effect;            ///< consequence if images differ
};

constexpr std::array<DicomTrait, 21> dicom_traits{{
    {"patient", "patient", TraitRole::Identity, {0x00100020, 0x00100010}, "another patient's images"},
    {"patient_issuer",
     "issuer of the patient's number",
     TraitRole::Identity,
     {0x00100021},
     "images of a patient of another issuer who has the same number"},
    {"study", "study", TraitRole::Origin, {0x0020000d}, "images of another study"},
    {"modality", "modality", TraitRole::Identity, {0x00080060}, "images of another modality"},
    {"frame_of_reference",
     "frame of reference",
     TraitRole::Origin,
     {0x00200052},
     "images of another frame of reference, whose positions may have another origin"},
    {"kernel", "kernel", TraitRole::Stack, {0x00181210}, "edges and thin bone differ from slice to slice"},
    {"tube_voltage", "kVp", TraitRole::Stack, {0x00180060}, "values of bone depend on the voltage"},
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
    {"echo", "echo", TraitRole::Stack, {0x00180081, 0x00180086}, "values of tissues depend on the echo"},
    {"diffusion", "b value", TraitRole::Stack, {0x00189087}, "values of tissues depend on the b value"},
    {"time", "time", TraitRole::Order, {0x00189074, 0x0008002a, 0x00080032, 0x00080033}, ""},
    {"stack", "stack", TraitRole::Stack, {0x00209056}, "the slices belong to several stacks"},
    {"image_type",
     "type",
     TraitRole::Stack,
     {0x00080008},
     "some slices are measured, others computed from them"},
    {"patient_name", "name", TraitRole::Uniformity, {0x00100010}, "the patients' identifiers are equal"},
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
