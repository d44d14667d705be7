// SPDX-License-Identifier: AGPL-3.0-or-later
// Source: PS3.15 2024b, annex E: table E.1-1, column "Basic Prof." Departures: where the profile allows an empty or
// a dummy value, the value is emptied. Attributes that it keeps are kept only if their value is a number or a word that
// PS3.3 defines, because nothing prevents a file from stating names there.
#include "voxel/archive/source_identity.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <utility>

#include "voxel/dicom/dicom_attributes.h"
#include "voxel/scan/dicom_derived.h"

namespace octotomy::voxel {
namespace {

enum class Rule {
  Empty,    ///< Z: the value is emptied
  Drop,     ///< X: the attribute is removed
  Replace,  ///< U: the unique identifier is replaced
  Number,   ///< the attribute is kept if all its values are numbers, else emptied
  Word      ///< the attribute is kept if the standard defines all its values, else removed
};

struct RuledAttribute {
  DicomTag tag;
  const char* name;
  Rule rule;
};

constexpr std::array<RuledAttribute, 26> rules{{{0x00080020, "Study Date", Rule::Empty},
                                                {0x00080030, "Study Time", Rule::Empty},
                                                {0x00080050, "Accession Number", Rule::Empty},
                                                {0x00080090, "Referring Physician's Name", Rule::Empty},
                                                {0x00081030, "Study Description", Rule::Drop},
                                                {0x00100010, "Patient's Name", Rule::Empty},
                                                {0x00100020, "Patient ID", Rule::Empty},
                                                {0x00100030, "Patient's Birth Date", Rule::Empty},
                                                {0x00100040, "Patient's Sex", Rule::Empty},
                                                {0x00101010, "Patient's Age", Rule::Drop},
                                                {0x00101020, "Patient's Size", Rule::Drop},
                                                {0x00101030, "Patient's Weight", Rule::Drop},
                                                {0x00180015, "Body Part Examined", Rule::Word},
                                                {0x00180020, "Scanning Sequence", Rule::Word},
                                                {0x00180021, "Sequence Variant", Rule::Word},
                                                {0x00180022, "Scan Options", Rule::Word},
                                                {0x00180023, "MR Acquisition Type", Rule::Word},
                                                {0x00180080, "Repetition Time", Rule::Number},
                                                {0x00180081, "Echo Time", Rule::Number},
                                                {0x00180083, "Number of Averages", Rule::Number},
                                                {0x00180091, "Echo Train Length", Rule::Number},
                                                {0x00185100, "Patient Position", Rule::Word},
                                                {0x0020000d, "Study Instance UID", Rule::Replace},
                                                {0x00200010, "Study ID", Rule::Empty},
                                                {0x00200052, "Frame of Reference UID", Rule::Replace},
                                                {0x00200060, "Laterality", Rule::Word}}};

/// The values that attributes with Rule::Word may have, from PS3.3, C.7.3.1.1.2, C.8.3.1 and C.7.3.1; and the
/// terms for parts of the head and trunk from PS3.16, annex L.
constexpr std::array<std::string_view, 62> defined_words{
    "HFS",      "HFP",    "HFDR",    "HFDL",   "FFS",       "FFP",      "FFDR",  "FFDL",     "SE",
    "IR",       "GR",     "EP",      "RM",     "SK",        "MTC",      "SS",    "TRSS",     "SP",
    "MP",       "OSP",    "NONE",    "PER",    "RG",        "CG",       "PPG",   "FC",       "PFF",
    "PFP",      "SPSAT",  "FS",      "2D",     "3D",        "L",        "R",     "B",        "U",
    "HEAD",     "SKULL",  "BRAIN",   "FACE",   "NECK",      "JAW",      "TMJ",   "TMJOINT",  "MAXILLA",
    "MANDIBLE", "ORBIT",  "EAR",     "SINUS",  "TEETH",     "HEADNECK", "CHEST", "SPINE",    "CSPINE",
    "LSPINE",   "TSPINE", "ABDOMEN", "PELVIS", "EXTREMITY", "FIBULA",   "LEG",   "WHOLEBODY"};

/// The modalities that PS3.3, C.7.3.1.1.1, defines for images and documents.
constexpr std::array<std::string_view, 28> modalities{
    "CT", "MR",  "CR",  "DX",  "PT",  "NM", "US",  "XA", "RF", "IO", "PX", "ES", "XC",       "OT",
    "SC", "SEG", "M3D", "DOC", "OCT", "OP", "OPT", "SM", "GM", "MG", "TG", "RG", "RTSTRUCT", "RTDOSE"};

std::vector<std::string> values_of(const std::string& text) {
  std::vector<std::string> values(1);
  for (const char c : text)
    if (c == '\\')
      values.emplace_back();
    else
      values.back() += c;
  for (std::string& value : values) {
    while (!value.empty() && value.back() == ' ') value.pop_back();
    while (!value.empty() && value.front() == ' ') value.erase(0, 1);
  }
  return values;
}

bool is_number(const std::string& value) {
  return value.size() <= 16 && value.find_first_not_of("0123456789+-.eE") == std::string::npos;
}

bool is_defined(const std::string& value) {
  return value.empty() || std::find(defined_words.begin(), defined_words.end(), value) != defined_words.end();
}

std::string described(DicomTag tag, const char* name, const char* change) {
  std::array<char, 16> number{};
  std::snprintf(number.data(), number.size(), "(%04x,%04x)", tag >> 16, tag & 0xffff);
  return std::string(name) + " " + number.data() + ": " + change;
}

std::string renewed(const std::string& uid, IdentityChoice choice) {
  if (uid.empty()) return uid;
  // A frame is identified by its file's identifier, '#' and the frame's number.
  const std::size_t hash = uid.find('#');
  DicomDigest digest;
  digest.add(uid.substr(0, hash));
  return digest.uid(std::string(word_of(choice))) + (hash == std::string::npos ? "" : uid.substr(hash));
}

/// Applies a rule to an attribute and adds a line that reports a change, if there was one. Returns whether
/// the attribute stays.
bool apply(const RuledAttribute& ruled, IdentityChoice choice, DicomSource::Text& text,
           std::vector<std::string>& changes) {
  const std::vector<std::string> values = values_of(text.value);
  const auto noted = [&](const char* change) {
    if (!text.value.empty()) changes.push_back(described(ruled.tag, ruled.name, change));
  };
  switch (ruled.rule) {
    case Rule::Empty:
      noted("emptied");
      text.value.clear();
      return true;
    case Rule::Drop:
      noted("removed");
      return false;
    case Rule::Replace:
      noted("replaced");
      text.value = renewed(text.value, choice);
      return true;
    case Rule::Number:
      if (std::all_of(values.begin(), values.end(), is_number)) return true;
      noted("emptied, because it is not a number");
      text.value.clear();
      return true;
    case Rule::Word:
      break;
  }
  if (std::all_of(values.begin(), values.end(), is_defined)) return true;
  noted("removed, because the standard does not define it");
  return false;
}

void name_new_patient(DicomSource& source) {
  source.attributes[0x00100010] = {"PN", "Anonymous"};
  source.attributes[0x00100020] = {"LO", "OCTOTOMY"};
  source.attributes[0x00200010] = {"SH", "1"};
}

void state_removal(DicomSource& source) {
  source.attributes[identity_removed_tag] = {"CS", "YES"};
  source.attributes[0x00120063] = {"LO", "PS3.15 Basic Application Confidentiality Profile"};
}

}  // namespace

std::optional<IdentityChoice> identity_choice(std::string_view word) {
  for (const IdentityChoice choice : {IdentityChoice::Keep, IdentityChoice::Remove, IdentityChoice::New})
    if (word == word_of(choice)) return choice;
  return std::nullopt;
}

std::string_view word_of(IdentityChoice choice) {
  return choice == IdentityChoice::Keep ? "keep" : choice == IdentityChoice::Remove ? "remove" : "new";
}

DecidedIdentity decide_identity(std::optional<DicomSource> source, IdentityChoice choice) {
  DecidedIdentity decided{std::move(source), {}};
  if (choice == IdentityChoice::Keep || !decided.source) return decided;
  DicomSource& made = *decided.source;
  for (auto at = made.attributes.begin(); at != made.attributes.end();) {
    const auto ruled = std::find_if(rules.begin(), rules.end(),
                                    [&](const RuledAttribute& each) { return each.tag == at->first; });
    bool stays = false;
    if (ruled != rules.end()) {
      stays = apply(*ruled, choice, at->second, decided.changes);
    } else if (at->first != character_set_tag && !at->second.value.empty()) {
      decided.changes.push_back(described(at->first, "Attribute", "removed"));
    }
    // No text remains in the source's character set, so the attribute for this set is not needed.
    at = stays ? std::next(at) : made.attributes.erase(at);
  }
  if (choice == IdentityChoice::New) name_new_patient(made);
  if (choice == IdentityChoice::Remove) state_removal(made);
  made.series_uid = renewed(made.series_uid, choice);
  for (DicomSource::Image& image : made.images) image.instance_uid = renewed(image.instance_uid, choice);
  if (!made.images.empty())
    decided.changes.emplace_back("Series and SOP Instance UIDs of the source: replaced");
  made.modality = defined_modality(made.modality);
  made.identity = {};
  made.audit.clear();
  return decided;
}

std::string defined_modality(const std::string& modality) {
  return std::find(modalities.begin(), modalities.end(), modality) != modalities.end() ? modality : "";
}

}  // namespace octotomy::voxel
