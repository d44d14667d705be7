// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace octotomy::planner {

/// A published fault of a library whose decoders or network code read data of unknown origin, and what it means for
/// this program.
struct KnownFault {
  std::string library, name;  ///< for example GDCM, CVE-2024-22373
  std::string effect;         ///< what the data of an attacker do
  std::string repaired_in;    ///< the first version without the fault; empty: no release is
  /// Where the faulty code stands: in no part of the program; in a linked library, but never called; called in the
  /// process that decodes; called in the program itself, whose memory and calls are not confined.
  enum class Place { NotLinked, NotCalled, InDecoder, InProgram } place;
  std::string reason;  ///< why it is not called, or not linked; of InProgram: on which data it is called
};

/// The faults that `versions` (library_versions()) may have: the library is not linked, or its version is before the
/// first without the fault. A distribution may have repaired a fault without a new number.
std::vector<KnownFault> faults_of(const nlohmann::ordered_json& versions);

/// Whether a version, numbers with dots, is before another one. Missing numbers count as zero.
bool is_before(const std::string& version, const std::string& other);

}  // namespace octotomy::planner
