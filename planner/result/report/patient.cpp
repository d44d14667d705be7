// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/result/report/patient.h"

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "planner/operation/table/json_file.h"
#include "planner/operation/table/same_patient.h"

namespace octotomy::planner {
namespace {

using PatientJson = nlohmann::ordered_json;

constexpr const char* unnamed_plan = "Plan";

std::vector<std::string> parts_of_text(const std::string& text, char separator) {
  std::vector<std::string> parts(1);
  for (const char symbol : text)
    if (symbol == separator)
      parts.emplace_back();
    else
      parts.back() += symbol;
  return parts;
}

/// A DICOM name in readable form. Uses the first of its alphabetic, ideographic and phonetic groups (PS3.5,
/// 6.2.1) that is not empty: family name, given name and middle name.
std::string readable_name(const std::string& name) {
  for (const std::string& group : parts_of_text(name, '=')) {
    std::vector<std::string> components = parts_of_text(group, '^');
    components.resize(3);
    std::string given = components[1];
    if (!components[2].empty()) given += (given.empty() ? "" : " ") + components[2];
    const std::string& family = components[0];
    const std::string whole = family + (family.empty() || given.empty() ? "" : ", ") + given;
    if (!whole.empty()) return whole;
  }
  return "";
}

/// A DICOM date in readable form, "1970-01-31" for "19700131"; empty if the text is no date.
std::string readable_date(const std::string& date) {
  const bool is_date = date.size() == 8 && std::all_of(date.begin(), date.end(), [](char symbol) {
                         return symbol >= '0' && symbol <= '9';
                       });
  return is_date ? date.substr(0, 4) + "-" + date.substr(4, 2) + "-" + date.substr(6) : "";
}

std::string readable_sex(const std::string& sex) {
  return sex == "F" ? "female" : sex == "M" ? "male" : sex == "O" ? "other sex" : "";
}

/// Replaces values of a patient that a text quotes.
void hide_quoted(const std::vector<std::string>& values, std::string& text) {
  for (const std::string& value : values) {
    const std::string quoted = "'" + value + "'", hidden = "(left out)";
    for (std::size_t at = text.find(quoted); at != std::string::npos; at = text.find(quoted, at))
      text.replace(at, quoted.size(), hidden);
  }
}

}  // namespace

PatientJson patient_json(const voxel::Identity& identity) {
  const auto stated = [](const std::string& text) {
    return text.empty() ? PatientJson(nullptr) : PatientJson(text);
  };
  PatientJson json{{"name", stated(readable_name(identity.patient_name))},
                   {"number", stated(identity.patient_id)},
                   {"issuer", stated(identity.id_issuer)},
                   {"birth_date", stated(readable_date(identity.birth_date))},
                   {"sex", stated(readable_sex(identity.sex))},
                   {"study_date", stated(readable_date(identity.study_date))}};
  const bool is_stated =
      !json["name"].is_null() || !json["number"].is_null() || !json["birth_date"].is_null();
  return is_stated ? json : PatientJson(nullptr);
}

std::string patient_text(const voxel::Identity& identity) {
  const PatientJson json = patient_json(identity);
  if (json.is_null()) return "";
  std::string text;
  for (const auto& [key, before] :
       {std::pair{"name", ""}, std::pair{"number", "number "}, std::pair{"issuer", "issued by "},
        std::pair{"birth_date", "born "}, std::pair{"sex", ""}, std::pair{"study_date", "study of "}})
    if (json[key].is_string())
      text += (text.empty() ? "" : ", ") + std::string(before) + json[key].get<std::string>();
  return text;
}

std::vector<std::string> patient_lines(const Evaluation& evaluation) {
  std::vector<std::pair<std::string, std::string>> found;  // patients and names of their scans
  for (const ScanRecord& scan : evaluation.scans) {
    if (!scan.made_by.empty()) continue;
    std::string patient = patient_text(scan.identity);
    if (patient.empty()) patient = "not stated by the scan";
    const auto known =
        std::find_if(found.begin(), found.end(), [&](const auto& each) { return each.first == patient; });
    if (known == found.end())
      found.emplace_back(std::move(patient), scan.name);
    else
      known->second += ", " + scan.name;
  }
  if (found.empty()) return {"not stated: no scan was read"};
  std::vector<std::string> lines;
  for (const auto& [patient, scans] : found)
    lines.push_back(found.size() == 1 ? patient : patient + " (" + scans + ")");
  return lines;
}

void leave_out_patients(Result& result) {
  // Takes the place of the detail of a finding that compares identities. The detail quotes files whose
  // identities the result does not store.
  constexpr const char* left_out = "the files' statements differ; left out as requested";
  std::vector<std::string> values;
  for (ScanRecord& scan : result.evaluation.scans) {
    for (const std::string& value :
         {scan.identity.patient_name, scan.identity.patient_id, scan.identity.birth_date})
      if (!value.empty()) values.push_back(value);
    scan.identity = {};
  }
  for (ScanRecord& scan : result.evaluation.scans)
    for (voxel::Finding& finding : scan.audit)
      if (quotes_identity(finding.check) && finding.verdict != voxel::Verdict::Pass)
        finding.detail = left_out;
      else
        hide_quoted(values, finding.detail);
  for (voxel::Finding& finding : result.findings) hide_quoted(values, finding.detail);
  Objects& objects = result.evaluation.objects;
  for (std::size_t i = 0; i < objects.size(); ++i)
    for (std::string& finding : objects.change(i).findings) {
      for (const std::string check : {"identity: ", "series: "})
        if (const std::size_t at = finding.find(check); at <= std::string("FAIL, ").size())
          finding = finding.substr(0, at + check.size()) + left_out;
      hide_quoted(values, finding);
    }
}

std::string plan_without_names(const std::string& text, std::vector<std::string>& changes) {
  PatientJson plan = PatientJson::parse(text);
  plan["name"] = unnamed_plan;
  if (plan.contains("scans"))
    for (auto& [name, scan] : plan["scans"].items()) scan["path"] = name;
  if (plan.erase("signatures") > 0) changes.emplace_back("plan: signatures removed");
  return json_text(plan, 2) + "\n";
}

std::vector<std::string> leave_out_names(Result& result) {
  std::vector<std::string> changes;
  leave_out_patients(result);
  changes.emplace_back("patient: removed");
  for (ScanRecord& scan : result.evaluation.scans) {
    scan.path = scan.name;
    changes.push_back("scan '" + scan.name + "': path removed");
    for (voxel::Finding& finding : scan.audit) {
      finding.files.clear();
      if (finding.verdict != voxel::Verdict::Pass)
        changes.push_back("scan '" + scan.name + "': details of its audit, '" + finding.check + "', removed");
      finding.detail = "left out as requested; octotomy info prints it";
    }
  }
  result.plan.name = unnamed_plan;
  changes.emplace_back("plan: name removed");
  result.plan.file.clear();
  for (auto& [name, scan] : result.plan.scans) scan.path = name;
  if (!result.plan.text.empty()) result.plan.text = plan_without_names(result.plan.text, changes);
  return changes;
}

bool names_nobody(const Result& result) {
  const auto& scans = result.evaluation.scans;
  return result.anonymous && std::all_of(scans.begin(), scans.end(),
                                         [](const ScanRecord& scan) { return scan.path == scan.name; });
}

}  // namespace octotomy::planner
