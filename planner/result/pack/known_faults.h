// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace octotomy::planner {

/// A published fault of a library that reads data of unknown origin, and its effect on this program.
struct KnownFault {
  std::string library, name;  ///< for example GDCM, CVE-2024-22373
  std::string effect;         ///< the damage that an attacker's data can do
  std::string repaired_in;    ///< first version without the fault; empty if none is known
  /// Where the faulty code is: in a library that is not linked; in a linked library, but never called; called
  /// in the confined process that decodes; called in the program itself, which is not confined.
  enum class Place { NotLinked, NotCalled, InDecoder, InProgram } place;
  std::string reason;  ///< why it is not called or linked; for InProgram: which data reach it
};

/// Faults that the libraries in `versions` (library_versions()) may have according to their version, and
/// faults of libraries that are not linked. A distribution may have repaired a fault without changing the
/// version.
std::vector<KnownFault> faults_of(const nlohmann::ordered_json& versions);

/// Whether a version comes before another one. Versions are numbers separated by dots; missing numbers count
/// as zero.
bool is_before(const std::string& version, const std::string& other);

}  // namespace octotomy::planner
