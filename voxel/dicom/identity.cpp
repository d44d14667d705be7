// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/dicom/identity.h"

#include <algorithm>

#include "voxel/dicom/dicom_file.h"
#include "voxel/space/file_text.h"

namespace octotomy::voxel {
namespace {

/// A person's name for comparison: lower case, without empty components at its end.
std::string plain_name(const std::string& name) {
  std::string plain = lower_case(trimmed(name));
  plain.resize(plain.find_last_not_of("^= ") + 1);
  return plain;
}

/// Up to four values in quotes: "'1.2.3'", or "'1.2.3' or '1.2.4'".
std::string quoted(const std::vector<std::string>& values) {
  constexpr std::size_t most = 4;
  std::string text;
  for (std::size_t i = 0; i < std::min(values.size(), most); ++i)
    text += (i == 0 ? "'" : " or '") + values[i] + "'";
  return values.size() > most ? text + " or " + std::to_string(values.size() - most) + " more" : text;
}

bool are_both_stated_and_differ(const std::string& a, const std::string& b) {
  return !a.empty() && !b.empty() && a != b;
}

void compare_uids(const char* what, const std::vector<std::string>& a, const std::vector<std::string>& b,
                  IdentityComparison& made) {
  if (a.empty() || b.empty()) return made.unstated.emplace_back(what), void();
  const bool is_shared = std::any_of(a.begin(), a.end(), [&](const std::string& uid) {
    return std::find(b.begin(), b.end(), uid) != b.end();
  });
  if (!is_shared) made.differing.push_back(std::string(what) + " " + quoted(a) + " and " + quoted(b));
}

}  // namespace

Identity identity_of(const DicomFile& file) {
  Identity identity{trimmed(file.readable_text(0x00100020)), trimmed(file.readable_text(0x00100010)), {}, {}};
  if (std::string uid = trimmed(file.text(0x0020000d)); !uid.empty())
    identity.study_uids.push_back(std::move(uid));
  if (std::string uid = trimmed(file.text(0x00200052)); !uid.empty())
    identity.frame_uids.push_back(std::move(uid));
  identity.id_issuer = trimmed(file.readable_text(0x00100021));
  identity.birth_date = trimmed(file.text(0x00100030));
  identity.sex = trimmed(file.text(0x00100040));
  identity.study_date = trimmed(file.text(0x00080020));
  return identity;
}

IdentityComparison compared(const Identity& a, const Identity& b) {
  IdentityComparison made;
  const bool by_id = !a.patient_id.empty() && !b.patient_id.empty();
  const std::string &of_a = by_id ? a.patient_id : a.patient_name,
                    &of_b = by_id ? b.patient_id : b.patient_name;
  if (of_a.empty() || of_b.empty())
    made.unstated.emplace_back("patient");
  else if (by_id ? of_a != of_b : plain_name(of_a) != plain_name(of_b))
    made.differing.push_back("patient '" + of_a + "' and '" + of_b + "'");
  else if (by_id && are_both_stated_and_differ(lower_case(a.id_issuer), lower_case(b.id_issuer)))
    made.differing.push_back("patient '" + of_a + "' of the issuers '" + a.id_issuer + "' and '" +
                             b.id_issuer + "', which number their patients independently");
  if (are_both_stated_and_differ(a.birth_date, b.birth_date))
    made.differing.push_back("patient's birth date '" + a.birth_date + "' and '" + b.birth_date + "'");
  if (are_both_stated_and_differ(a.sex, b.sex))
    made.differing.push_back("patient's sex '" + a.sex + "' and '" + b.sex + "'");
  compare_uids("study", a.study_uids, b.study_uids, made);
  compare_uids("frame of reference", a.frame_uids, b.frame_uids, made);
  return made;
}

}  // namespace octotomy::voxel
