// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace octotomy::planner {

/// A published fault of a library whose decoders or network code read data of unknown origin, and its effect
/// on this program.
struct KnownFault {
  std::string library, name;  ///< for example GDCM, CVE-2024-22373
  std::string effect;         ///< the damage that an attacker's data can cause
  std::string repaired_in;    ///< the first version without the fault; empty: none is known
  /// Where the faulty code stands: in no part of the program; in a linked library, but never called; called
  /// in the process that decodes and is confined; called in the program itself, which is not.
  enum class Place { NotLinked, NotCalled, InDecoder, InProgram } place;
  std::string reason;  ///< why it is not called or not linked; for InProgram: on which data it is called
};

/// The faults of the libraries in `versions` (library_versions()) that their version may still have, and the
/// faults of libraries that are not linked. A distribution may have repaired a fault without a new version
/// number.
std::vector<KnownFault> faults_of(const nlohmann::ordered_json& versions);

/// Whether a version, numbers with dots, is before another one. Missing numbers count as zero.
bool is_before(const std::string& version, const std::string& other);

}  // namespace octotomy::planner
