// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Sources: the CVE records of these numbers; GDCM's pull requests 213, 233 and 235; CISA's advisories ICSMA-26-083-01
// (GDCM) and of June 2026 (DCMTK). The release that repaired the faults of 2024 is not confirmed by a record.
#include "planner/result/pack/known_faults.h"

#include <algorithm>
#include <iterator>
#include <sstream>

namespace octotomy::planner {
namespace {

using Place = KnownFault::Place;

const std::vector<KnownFault>& all_faults() {
  static const std::vector<KnownFault> faults = {
      {"GDCM", "CVE-2024-22373", "JPEG 2000 frames write beyond their memory", "3.0.24", Place::InDecoder,
       ""},
      {"GDCM", "pull request 235", "frames in run lengths write beyond their memory", "", Place::InDecoder,
       ""},
      {"GDCM", "CVE-2024-22391", "colour tables write beyond their memory", "3.0.24", Place::NotCalled,
       "GDCM reads no colour table"},
      {"GDCM", "CVE-2024-25569", "raw frames are read beyond their end", "3.0.24", Place::NotCalled,
       "raw frames are read by this program's own reader"},
      {"GDCM", "CVE-2025-11266", "the list of compressed fragments writes beyond its memory", "3.2.2",
       Place::NotCalled, "fragments are read by this program's own reader"},
      {"GDCM", "CVE-2025-52582", "overlays are read beyond their end", "", Place::NotCalled,
       "GDCM reads no overlay"},
      {"GDCM", "CVE-2026-3650", "a file's meta header fills the memory", "", Place::NotCalled,
       "headers are read by this program's own reader"},
      {"DCMTK", "CVE-2026-50003", "a peer chooses the path of a received file", "", Place::NotLinked,
       "this program's own receiver names files by their SHA-256"}};
  return faults;
}

}  // namespace

bool is_before(const std::string& version, const std::string& other) {
  std::istringstream a(version), b(other);
  while (a || b) {
    int left = 0, right = 0;
    a >> left;
    b >> right;
    if (left != right) return left < right;
    a.ignore(1, '.');
    b.ignore(1, '.');
  }
  return false;
}

std::vector<KnownFault> faults_of(const nlohmann::ordered_json& versions) {
  std::vector<KnownFault> found;
  std::copy_if(
      all_faults().begin(), all_faults().end(), std::back_inserter(found), [&](const KnownFault& fault) {
        const auto version = versions.find(fault.library);
        if (version == versions.end()) return fault.place == Place::NotLinked;
        return fault.repaired_in.empty() || is_before(version->get<std::string>(), fault.repaired_in);
      });
  return found;
}

}  // namespace octotomy::planner
