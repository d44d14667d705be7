// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/measure/octree_summary.h"

#include <array>
#include <cstdio>

#include "planner/operation/table/json_file.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/same_patient.h"
#include "voxel/measure/grey_level_counts.h"

namespace octotomy::planner {
namespace {

Json levels_of(const std::vector<voxel::LevelCount>& counts) {
  Json levels = Json::array();
  for (const voxel::LevelCount& count : counts)
    levels.push_back(
        {{"level", count.level}, {"partial", count.partial}, {"full", count.full}, {"empty", count.empty}});
  return levels;
}

/// The voxels of Full nodes on all levels. If no level has nodes, the root itself is Full, which no level
/// counts.
std::uint64_t voxels_of(const std::vector<voxel::LevelCount>& counts, int depth) {
  std::uint64_t voxels = 0;
  for (const voxel::LevelCount& count : counts) voxels += count.full << (3 * (depth - count.level));
  return voxels;
}

void add(const voxel::Octree& octree, Json& json) {
  json["fields"] = "binary";
  json["levels"] = levels_of(voxel::level_counts(octree));
  json["voxels"] = octree.voxel_count();
  json["volume_mm3"] = static_cast<double>(octree.voxel_count()) * octree.universe().lattice().voxel_mm3();
  json["bytes_memory"] = voxel::bytes_memory(octree);
}

void add(const voxel::GreyOctree& grey, Json& json) {
  const int depth = grey.universe().depth;
  const std::vector<voxel::LevelCount> counts = voxel::level_counts(grey);
  const voxel::MinMax& range = grey.range(voxel::root_height(depth), glm::ivec3(0));
  const bool one_value = range.low == range.high && range.low != grey.background();
  json["fields"] = "grey";
  json["levels"] = levels_of(counts);
  json["voxels"] = one_value ? std::uint64_t{1} << (3 * depth) : voxels_of(counts, depth);
  const auto value = [&](std::int16_t sample) {
    return grey.step() == 1.0 ? Json(sample) : Json(sample * grey.step());
  };
  json["range"] = {value(range.low), value(range.high)};
  json["background"] = value(grey.background());
  json["bytes_memory"] = grey.bytes_memory();
}

void add(const voxel::PartialOctree& partial, Json& json) {
  json["fields"] = "partial";
  json["levels"] = levels_of(voxel::level_counts(partial));
  json["voxels"] = partial.touching.voxel_count();
  json["voxels_inside"] = partial.inside.voxel_count();
  json["volume_partial_mm3"] = voxel::volume_mm3(partial);
  json["bytes_memory"] = voxel::bytes_memory(partial);
}

}  // namespace

Json octree_answer(const voxel::OctreeFile& file, std::optional<std::uint64_t> bytes_file,
                   const Timings& timings) {
  Json json = answer(timings);
  const voxel::Universe& universe = voxel::universe(file);
  json["kind"] = "octree";
  json["name"] = file.name;
  json["depth"] = universe.depth;
  std::visit([&](const auto& tree) { add(tree, json); }, file.tree);
  json["bytes_file"] = bytes_file ? Json(*bytes_file) : Json(nullptr);
  json["spacing_mm"] = to_json(universe.lattice().spacing_mm());
  json["lps_from_voxel"] = to_json(universe.lps_from_voxel);
  const bool is_shallow = json_levels(file.metadata) <= most_json_levels;
  const Json metadata =
      is_shallow ? Json::parse(file.metadata, nullptr, false) : Json(Json::value_t::discarded);
  json["metadata"] = file.metadata.empty()     ? Json(nullptr)
                     : metadata.is_discarded() ? Json(file.metadata)
                                               : metadata;
  json["findings"] = Json::array();
  if (!bytes_file) json["findings"].push_back("bytes_file: no octree file was read or written");
  if (file.metadata.empty()) json["findings"].push_back("metadata: the file holds none");
  return json;
}

Json doubts_of(const std::vector<voxel::Finding>& audit) {
  constexpr std::size_t most = 32;
  std::vector<voxel::Finding> doubts;
  for (const voxel::Finding& finding : audit)
    if (finding.verdict != voxel::Verdict::Pass && doubts.size() < most)
      doubts.push_back(
          {finding.check, finding.verdict,
           quotes_identity(finding.check) ? "what its files state of the patient differs" : finding.detail});
  return to_json(doubts);
}

std::vector<std::string> told_doubts(const Json& answer) {
  constexpr std::size_t most = 32;
  std::vector<std::string> lines;
  // The file may be from another program, so its metadata may have any form.
  const auto text_at = [](const Json& object, const char* key) {
    const bool has = object.is_object() && object.contains(key) && object[key].is_string();
    return has ? object[key].get<std::string>() : std::string();
  };
  const Json metadata = answer.value("metadata", Json());
  if (!metadata.is_object() || !metadata.contains("scan_audit") || !metadata["scan_audit"].is_array())
    return lines;
  for (const Json& line : metadata["scan_audit"]) {
    const std::string verdict = text_at(line, "verdict");
    if ((verdict == "WARN" || verdict == "FAIL") && lines.size() < most)
      lines.push_back(verdict + ", the octree's scan " + text_at(metadata, "scan") + ": " +
                      text_at(line, "check") + ": " + text_at(line, "detail"));
  }
  return lines;
}

std::string octree_text(const std::string& title, const Json& answer) {
  const auto number = [&](const char* key) { return grouped(answer[key].get<double>(), 0); };
  const Json& spacing = answer["spacing_mm"];
  const double side = static_cast<double>(std::uint64_t{1} << answer["depth"].get<int>());
  std::string text = "octree   " + title + ", " + answer["fields"].get<std::string>() + "\n" + "depth    " +
                     std::to_string(answer["depth"].get<int>()) + ", " + grouped(side, 0) +
                     " voxels a side\n" + "spacing  " + grouped(spacing[0].get<double>(), 4) + " x " +
                     grouped(spacing[1].get<double>(), 4) + " x " + grouped(spacing[2].get<double>(), 4) +
                     " mm\n" + "voxels   " + number("voxels") + "\n" + "memory   " + number("bytes_memory") +
                     " bytes\n";
  if (!answer["bytes_file"].is_null()) text += "file     " + number("bytes_file") + " bytes\n";
  text += "level    partial         full        empty\n";
  for (const Json& level : answer["levels"]) {
    std::array<char, 80> row;
    std::snprintf(row.data(), row.size(), "%5d %10llu %12llu %12llu\n", level["level"].get<int>(),
                  level["partial"].get<unsigned long long>(), level["full"].get<unsigned long long>(),
                  level["empty"].get<unsigned long long>());
    text += row.data();
  }
  return text;
}

FileAnswer octree_written(const voxel::OctreeFile& file, const std::filesystem::path& out,
                          const std::stop_token& stop, Timings& timings,
                          const std::vector<std::string>& findings, const Json& more) {
  if (stop.stop_requested()) throw voxel::Stopped("stopped before " + out.string() + " was written");
  {
    const Stopwatch watch(timings, "write");
    voxel::write_octree(file, out);
  }
  FileAnswer written{octree_answer(file, std::filesystem::file_size(out), timings)};
  written.json["path"] = out.string();
  written.json.update(more);
  for (const std::string& finding : findings) written.json["findings"].push_back(finding);
  written.findings = findings;
  return written;
}

}  // namespace octotomy::planner
