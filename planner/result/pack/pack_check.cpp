// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/result/pack/pack_check.h"

#include <map>
#include <set>

#include "brep/io/zip_archive.h"
#include "brep/mesh/error.h"
#include "planner/operation/table/json_file.h"
#include "planner/plan/sha256.h"
#include "planner/result/pack/pack.h"
#include "voxel/space/error.h"
#include "voxel/space/file_text.h"

namespace octotomy::planner {
namespace {

using Json = nlohmann::ordered_json;

[[noreturn]] void refuse_pack(const std::filesystem::path& path, const std::string& what) {
  throw voxel::Error(voxel::ErrorCode::Input, path.string() + ": " + what);
}

Json parsed(const std::filesystem::path& path, const std::string& name, const std::string& text) {
  Json json;
  try {
    json = parse_json<Json>(text);
  } catch (const std::runtime_error& error) {
    refuse_pack(path, "its entry " + name + ": " + error.what());
  }
  if (!json.is_object())
    refuse_pack(path, "its entry " + name + " is not a JSON object: ask for the archive again");
  return json;
}

/// The SHA-256 of each entry, from the manifest. Throws Json::exception if the manifest does not state them.
std::map<std::string, std::string> sums_of(const Json& manifest) {
  std::map<std::string, std::string> sums;
  for (const Json& file : manifest.at("files"))
    sums.emplace(file.at("path").get<std::string>(), file.at("sha256").get<std::string>());
  return sums;
}

PackContents read_entries(const std::filesystem::path& path, const brep::ZipArchive& archive) {
  if (!archive.has("manifest.json"))
    refuse_pack(path, "has no manifest.json, so it is no archive of octotomy pack");
  PackContents pack;
  pack.manifest = parsed(path, "manifest.json", archive.read("manifest.json"));
  if (!pack.manifest.contains("octotomy_pack"))
    refuse_pack(path, "is no archive of octotomy pack: its manifest.json lacks 'octotomy_pack'");
  if (pack.manifest.at("octotomy_pack") != pack_format)
    refuse_pack(path, "was written in format " + pack.manifest.at("octotomy_pack").dump() +
                          " of octotomy pack, and " + std::to_string(pack_format) +
                          " can be read: install a later Octotomy");
  for (const auto& [name, sum] : sums_of(pack.manifest)) {
    const std::string bytes = archive.read(name);
    if (sha256_of(bytes) != sum)
      refuse_pack(path, "its entry " + name +
                            " was changed after it was packed: its SHA-256 is not the one in manifest.json");
    if (name == "plan.plan.json") pack.plan = bytes;
    if (name == "result/result.json") pack.result = parsed(path, name, bytes);
  }
  if (pack.plan.empty() || pack.result.is_null())
    refuse_pack(path, "lists no plan.plan.json or no result/result.json, so there is nothing to replay");
  return pack;
}

/// The name of a list's element in `where`: the first of these keys that is a text, or else its position.
std::string name_of(const Json& element, std::size_t position) {
  for (const char* key : {"id", "object", "name", "operation"})
    if (element.is_object() && element.contains(key) && element[key].is_string())
      return element[key].get<std::string>();
  return std::to_string(position);
}

/// Adds all numbers, texts, truth values and nulls of a JSON value to `values`, under their path.
void flatten(const Json& json, const std::string& where, std::map<std::string, std::string>& values) {
  const auto below = [&where](const std::string& name) {
    return where.empty() ? name : where + " / " + name;
  };
  if (json.is_object()) {
    for (const auto& [key, member] : json.items()) flatten(member, below(key), values);
  } else if (json.is_array()) {
    std::map<std::string, int> seen;
    for (std::size_t i = 0; i < json.size(); ++i) {
      const std::string name = name_of(json[i], i);
      const int earlier = seen[name]++;
      flatten(json[i], below(earlier == 0 ? name : name + " (" + std::to_string(earlier + 1) + ")"), values);
    }
  } else {
    values[where] = json_text(json);
  }
}

/// A result without values that may differ in a replay: paths of scans, and the version of the program.
Json comparable(Json result) {
  result.erase("octotomy");
  if (result.contains("scans"))
    for (Json& scan : result["scans"]) scan.erase("path");
  return result;
}

}  // namespace

PackContents read_pack(const std::filesystem::path& path) {
  const std::string bytes = voxel::file_bytes(path);
  try {
    return read_entries(path, brep::ZipArchive(bytes));
  } catch (const brep::Error& error) {
    refuse_pack(path, error.what());
  } catch (const Json::exception&) {
    refuse_pack(path, "its manifest.json does not list its entries as octotomy pack does");
  }
}

PackComparison compare_packs(const PackContents& packed, const PackContents& replayed) {
  PackComparison comparison;
  std::map<std::string, std::string> of_packed, of_replayed;
  flatten(comparable(packed.result), {}, of_packed);
  flatten(comparable(replayed.result), {}, of_replayed);
  comparison.values = of_packed.size();
  for (const auto& [where, value] : of_packed) {
    const auto found = of_replayed.find(where);
    const std::string other = found == of_replayed.end() ? "" : found->second;
    if (other != value) comparison.different_values.push_back({where, value, other});
  }
  for (const auto& [where, value] : of_replayed)
    if (of_packed.count(where) == 0) comparison.different_values.push_back({where, "", value});
  const auto sums = sums_of(packed.manifest), others = sums_of(replayed.manifest);
  comparison.entries = sums.size();
  std::set<std::string> names;
  for (const auto& [name, sum] : sums) names.insert(name);
  for (const auto& [name, sum] : others) names.insert(name);
  for (const std::string& name : names) {
    const auto a = sums.find(name), b = others.find(name);
    if (a == sums.end() || b == others.end() || a->second != b->second)
      comparison.different_entries.push_back(name);
  }
  return comparison;
}

Json to_json(const PackComparison& comparison) {
  Json values = Json::array();
  for (const DifferentValue& value : comparison.different_values)
    values.push_back({{"where", value.where}, {"packed", value.packed}, {"replayed", value.replayed}});
  return {{"values", comparison.values},
          {"different_values", values},
          {"entries", comparison.entries},
          {"different_entries", comparison.different_entries}};
}

}  // namespace octotomy::planner
