// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/plan/signature.h"

#include <chrono>
#include <ctime>

#include "planner/operation/table/json.h"
#include "planner/plan/plan_keys.h"
#include "planner/plan/sha256.h"

namespace octotomy::planner {
namespace {

constexpr const char* key = "signatures";

std::string now() {
  const std::time_t seconds = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  char text[32];
  return {text, std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc)};
}

Signature signature_of(const SortedJson& entry, const std::string& where) {
  const Keys keys(entry, where, {"by", "as", "note", "at", "plan_sha256", "scans_sha256"});
  Signature signature{keys.text("by"), keys.text("as"), "", keys.text("at"), keys.text("plan_sha256"), {}};
  if (const SortedJson* note = keys.find("note")) signature.note = word_of(*note, keys.at("note"));
  const SortedJson& scans = keys.need("scans_sha256");
  if (!scans.is_object()) refuse(keys.at("scans_sha256"), "must be an object of sums by scans' names");
  for (const auto& [name, sum] : scans.items())
    signature.scans_sha256[name] = word_of(sum, keys.at("scans_sha256"));
  return signature;
}

}  // namespace

std::string sum_of_plan(const std::string& text) {
  SortedJson plan = SortedJson::parse(text);
  plan.erase(key);
  if (plan.contains("scans"))
    for (SortedJson& scan : plan["scans"]) {
      scan.erase("path");
      scan.erase("sha256");
    }
  return sha256_of(json_text(plan));
}

std::vector<Signature> signatures_of(const std::string& text) {
  std::vector<Signature> signatures;
  const SortedJson plan = SortedJson::parse(text);
  if (!plan.contains(key)) return signatures;
  if (!plan[key].is_array()) refuse(key, "must be a list of signatures, as octotomy plan sign writes it");
  for (const SortedJson& entry : plan[key])
    signatures.push_back(
        signature_of(entry, std::string(key) + "[" + std::to_string(signatures.size()) + "]"));
  return signatures;
}

Signature sign(const Plan& plan, const std::string& by, const std::string& as, const std::string& note) {
  Signature signature{by, as, note, now(), sum_of_plan(plan.text), {}};
  for (const auto& [name, scan] : plan.scans)
    signature.scans_sha256[name] = sha256_of_path(scan_path(plan, scan));
  return signature;
}

std::string with_signature(const std::string& text, const Signature& signature) {
  nlohmann::ordered_json plan = nlohmann::ordered_json::parse(text);
  plan[key].push_back(to_json(signature));
  return json_text(plan, 2) + "\n";
}

std::map<std::string, std::string> sums_of_scans(const Plan& plan) {
  std::map<std::string, std::string> sums;
  for (const auto& [name, scan] : plan.scans)
    if (std::filesystem::exists(scan_path(plan, scan))) sums[name] = sha256_of_path(scan_path(plan, scan));
  return sums;
}

std::vector<std::string> changed_since(const Signature& signature, const std::string& text,
                                       const std::map<std::string, std::string>& sums) {
  std::vector<std::string> changed;
  if (sum_of_plan(text) != signature.plan_sha256) changed.emplace_back("the plan");
  for (const auto& [name, sum] : signature.scans_sha256)
    if (const auto found = sums.find(name); found != sums.end() && found->second != sum)
      changed.push_back("scan " + name);
  return changed;
}

nlohmann::ordered_json to_json(const Signature& signature) {
  return {{"by", signature.by},
          {"as", signature.as},
          {"note", signature.note},
          {"at", signature.at},
          {"plan_sha256", signature.plan_sha256},
          {"scans_sha256", signature.scans_sha256}};
}

}  // namespace octotomy::planner
