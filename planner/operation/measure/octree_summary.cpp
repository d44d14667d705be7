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

struct LevelRecord {
  int level = 0;
  std::uint64_t partial = 0, full = 0, empty = 0;
};
constexpr auto members_of(const LevelRecord&) {
  using L = LevelRecord;
  return std::tuple(member("level", &L::level), member("partial", &L::partial), member("full", &L::full),
                    member("empty", &L::empty));
}

/// The members of an octree's answer that follow `octotomy` and `timings_ms`.
struct OctreeRecord {
  std::string kind = "octree", name;
  int depth = 0;
  std::string fields;
  std::vector<LevelRecord> levels;
  std::uint64_t voxels = 0;
  std::optional<std::uint64_t> voxels_inside;  ///< of a partial octree
  std::optional<double> volume_partial_mm3;    ///< of a partial octree
  std::optional<double> volume_mm3;            ///< of a binary octree
  std::optional<std::vector<Json>> range;      ///< of a grey octree
  std::optional<Json> background;              ///< of a grey octree
  std::uint64_t bytes_memory = 0;
  std::optional<std::uint64_t> bytes_file;
  glm::dvec3 spacing_mm{1.0};
  Json lps_from_voxel;
  Json metadata;  ///< Any JSON is possible here, because another program may have written the file.
  std::vector<std::string> findings;
};
constexpr auto members_of(const OctreeRecord&) {
  using O = OctreeRecord;
  return std::tuple(member("kind", &O::kind), member("name", &O::name), member("depth", &O::depth),
                    member("fields", &O::fields), member("levels", &O::levels), member("voxels", &O::voxels),
                    member_if_any("voxels_inside", &O::voxels_inside),
                    member_if_any("volume_partial_mm3", &O::volume_partial_mm3),
                    member_if_any("volume_mm3", &O::volume_mm3), member_if_any("range", &O::range),
                    member_if_any("background", &O::background), member("bytes_memory", &O::bytes_memory),
                    member("bytes_file", &O::bytes_file), member("spacing_mm", &O::spacing_mm),
                    member("lps_from_voxel", &O::lps_from_voxel), member("metadata", &O::metadata),
                    member("findings", &O::findings));
}

/// One line of a scan's audit in the metadata of an octree.
struct DoubtLine {
  std::string check, verdict, detail;
};
constexpr auto members_of(const DoubtLine&) {
  using D = DoubtLine;
  return std::tuple(member("check", &D::check), member("verdict", &D::verdict), member("detail", &D::detail));
}
struct ScanMetadata {
  std::string scan;
  std::vector<DoubtLine> scan_audit;
};
constexpr auto members_of(const ScanMetadata&) {
  return std::tuple(member("scan", &ScanMetadata::scan), member("scan_audit", &ScanMetadata::scan_audit));
}

std::vector<LevelRecord> levels_of(const std::vector<voxel::LevelCount>& counts) {
  std::vector<LevelRecord> levels;
  for (const voxel::LevelCount& count : counts)
    levels.push_back({count.level, count.partial, count.full, count.empty});
  return levels;
}

/// The voxels of the Full nodes of all levels. If no level has nodes, the root is Full, and levels do not
/// count the root.
std::uint64_t voxels_of(const std::vector<voxel::LevelCount>& counts, int depth) {
  std::uint64_t voxels = 0;
  for (const voxel::LevelCount& count : counts) voxels += count.full << (3 * (depth - count.level));
  return voxels;
}

void add(const voxel::Octree& octree, OctreeRecord& made) {
  made.fields = "binary";
  made.levels = levels_of(voxel::level_counts(octree));
  made.voxels = octree.voxel_count();
  made.volume_mm3 = static_cast<double>(octree.voxel_count()) * octree.universe().lattice().voxel_mm3();
  made.bytes_memory = voxel::bytes_memory(octree);
}

void add(const voxel::GreyOctree& grey, OctreeRecord& made) {
  const int depth = grey.universe().depth;
  const std::vector<voxel::LevelCount> counts = voxel::level_counts(grey);
  const voxel::MinMax& range = grey.range(voxel::root_height(depth), glm::ivec3(0));
  const bool one_value = range.low == range.high && range.low != grey.background();
  made.fields = "grey";
  made.levels = levels_of(counts);
  made.voxels = one_value ? std::uint64_t{1} << (3 * depth) : voxels_of(counts, depth);
  const auto value = [&](std::int16_t sample) {
    return grey.step() == 1.0 ? Json(sample) : Json(sample * grey.step());
  };
  made.range = {value(range.low), value(range.high)};
  made.background = value(grey.background());
  made.bytes_memory = grey.bytes_memory();
}

void add(const voxel::PartialOctree& partial, OctreeRecord& made) {
  made.fields = "partial";
  made.levels = levels_of(voxel::level_counts(partial));
  made.voxels = partial.touching.voxel_count();
  made.voxels_inside = partial.inside.voxel_count();
  made.volume_partial_mm3 = voxel::volume_mm3(partial);
  made.bytes_memory = voxel::bytes_memory(partial);
}

Json metadata_of(const voxel::OctreeFile& file) {
  if (file.metadata.empty()) return nullptr;
  if (json_levels(file.metadata) > most_json_levels) return file.metadata;
  Json metadata = Json::parse(file.metadata, nullptr, false);
  return metadata.is_discarded() ? Json(file.metadata) : metadata;
}

}  // namespace

Json octree_answer(const voxel::OctreeFile& file, std::optional<std::uint64_t> bytes_file,
                   const Timings& timings) {
  const voxel::Universe& universe = voxel::universe(file);
  OctreeRecord made;
  made.name = file.name;
  made.depth = universe.depth;
  std::visit([&](const auto& tree) { add(tree, made); }, file.tree);
  made.bytes_file = bytes_file;
  made.spacing_mm = universe.lattice().spacing_mm();
  made.lps_from_voxel = to_json(universe.lps_from_voxel);
  made.metadata = metadata_of(file);
  if (!bytes_file) made.findings.emplace_back("bytes_file: null, because no octree file was read or written");
  if (file.metadata.empty()) made.findings.emplace_back("metadata: null, because the octree has none");
  Json json = answer(timings);
  json.update(print_record(made));
  return json;
}

Json doubts_of(const std::vector<voxel::Finding>& audit) {
  constexpr std::size_t most = 32;
  std::vector<voxel::Finding> doubts;
  for (const voxel::Finding& finding : audit)
    if (finding.verdict != voxel::Verdict::Pass && doubts.size() < most)
      doubts.push_back(
          {finding.check, finding.verdict,
           quotes_identity(finding.check) ? "its files state different patients" : finding.detail});
  return to_json(doubts);
}

std::vector<std::string> told_doubts(const Json& answer) {
  constexpr std::size_t most = 32;
  std::vector<std::string> lines;
  const auto metadata = record_of<ScanMetadata>(record_of<OctreeRecord>(answer).metadata);
  for (const auto& [check, verdict, detail] : metadata.scan_audit)
    if ((verdict == "WARN" || verdict == "FAIL") && lines.size() < most)
      lines.push_back(verdict + ", the octree's scan " + metadata.scan + ": " + check + ": " + detail);
  return lines;
}

std::string octree_text(const std::string& title, const Json& answer) {
  const auto octree = record_of<OctreeRecord>(answer);
  const auto number = [](std::uint64_t value) { return grouped(static_cast<double>(value), 0); };
  const glm::dvec3& spacing = octree.spacing_mm;
  std::string text = "octree   " + title + ", " + octree.fields + "\n" + "depth    " +
                     std::to_string(octree.depth) + ", " + number(std::uint64_t{1} << octree.depth) +
                     " voxels a side\n" + "spacing  " + grouped(spacing.x, 4) + " x " +
                     grouped(spacing.y, 4) + " x " + grouped(spacing.z, 4) + " mm\n" + "voxels   " +
                     number(octree.voxels) + "\n" + "memory   " + number(octree.bytes_memory) + " bytes\n";
  if (octree.bytes_file) text += "file     " + number(*octree.bytes_file) + " bytes\n";
  text += "level    partial         full        empty\n";
  for (const LevelRecord& level : octree.levels) {
    std::array<char, 80> row;
    std::snprintf(row.data(), row.size(), "%5d %10llu %12llu %12llu\n", level.level,
                  static_cast<unsigned long long>(level.partial), static_cast<unsigned long long>(level.full),
                  static_cast<unsigned long long>(level.empty));
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
