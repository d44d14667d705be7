// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "voxel/scan/dicom_source.h"

namespace octotomy::voxel {

/// The patient and study that a written DICOM object states.
enum class IdentityChoice {
  Keep,  ///< patient and study of the source
  /// Patient and study of the source, de-identified by the Basic Application Level Confidentiality Profile of
  /// PS3.15.
  Remove,
  New  ///< a patient without a name, and a new study
};
/// keep, remove, new.
std::optional<IdentityChoice> identity_choice(std::string_view word);
std::string_view word_of(IdentityChoice choice);

/// The source after de-identification, which writers copy, and a line for each change, such as "Patient's
/// Name (0010,0010): emptied".
struct DecidedIdentity {
  std::optional<DicomSource> source;
  std::vector<std::string> changes;
};

/// Decides the identity of written DICOM objects; no other code may change it. Remove empties, removes or
/// replaces attributes as PS3.15, table E.1-1, states for its profile. It keeps other attributes only if
/// their values are numbers or words that the standard defines, because free text may name a person. Remove
/// and New replace the unique identifiers of study, series, images and frame of reference by identifiers
/// computed from the old ones. Objects of one source therefore share their new identifiers, but anyone who
/// has the source can compute these too. Keep changes nothing.
DecidedIdentity decide_identity(std::optional<DicomSource> source, IdentityChoice choice);

/// The modality if the standard defines it, else none.
std::string defined_modality(const std::string& modality);

}  // namespace octotomy::voxel
