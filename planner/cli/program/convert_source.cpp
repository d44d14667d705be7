// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/cli/program/convert_source.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <set>

#include "planner/cli/verb/octree_out.h"
#include "planner/operation/file/label_table.h"
#include "planner/operation/measure/octree_summary.h"
#include "planner/operation/measure/result_json.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/same_patient.h"
#include "voxel/filter/label_map.h"
#include "voxel/tree/slice_bits.h"
#include "voxel/volume/volume_header.h"

namespace octotomy::planner::cli {

namespace fs = std::filesystem;

std::optional<voxel::DicomSource> source_of(const Program& program, const ConvertText& text, bool reads_dicom,
                                            const voxel::Identity& identity,
                                            std::vector<std::string>& findings) {
  if (text.source.empty() && !reads_dicom) return std::nullopt;
  voxel::DicomSource source =
      voxel::dicom_source(text.source.empty() ? text.in : text.source, read_options(program, text.scan));
  const auto decided = [&] {
    voxel::DecidedIdentity made = voxel::decide_identity(source, *voxel::identity_choice(text.identity));
    *text.changes = std::move(made.changes);
    return made.source;
  };
  if (text.source.empty()) return decided();
  for (const voxel::Finding& line : source.audit)
    if (line.verdict != voxel::Verdict::Pass)
      findings.push_back(text.source.string() + ": " + to_string(line.verdict) + ", " + line.check + ": " +
                         line.detail);
  for (std::string& finding :
       need_same_patient({text.source.string(), source.identity}, {text.in.string(), identity},
                         text.other_identity, "--other-identity"))
    findings.push_back(std::move(finding));
  return decided();
}

std::vector<glm::dvec3> corners_of(const voxel::Lattice& lattice) {
  std::vector<glm::dvec3> corners;
  const glm::dvec3 last = glm::dvec3(lattice.dims) - 0.5;
  for (int corner = 0; corner < 8; ++corner)
    corners.push_back(
        lattice.lps_mm({corner & 1 ? last.x : -0.5, corner & 2 ? last.y : -0.5, corner & 4 ? last.z : -0.5}));
  return corners;
}

std::vector<glm::dvec3> corners_of(const std::vector<voxel::DicomSegment>& objects) {
  std::vector<glm::dvec3> corners;
  voxel::SliceBits slice;
  for (const voxel::DicomSegment& each : objects) {
    const int side = each.object.universe().side();
    glm::ivec3 low(side), high(-1);
    for (int z = 0; z < side; ++z) {
      voxel::read_slice(each.object, z, slice);
      for (int y = 0; y < side; ++y)
        for (int word = 0; word < slice.words_per_row; ++word) {
          const std::uint64_t bits = slice.row(y)[word];
          if (bits == 0) continue;
          low = glm::min(low, {64 * word + std::countr_zero(bits), y, z});
          high = glm::max(high, {64 * word + 63 - std::countl_zero(bits), y, z});
        }
    }
    if (high.z < 0) continue;
    voxel::Lattice block{high - low + 1, each.object.universe().lps_from_voxel};
    block.lps_from_voxel[3] = block.lps_from_voxel * glm::dvec4(low, 1.0);
    for (const glm::dvec3& corner : corners_of(block)) corners.push_back(corner);
  }
  return corners;
}

void need_on_source(const ConvertText& text, const voxel::DicomSource& source,
                    const std::vector<glm::dvec3>& points_mm, std::vector<std::string>& findings) {
  if (points_mm.empty()) return;
  const glm::dvec3 low(-0.5), high = glm::dvec3(source.around.dims) - 0.5;
  const glm::dvec3 spacing_mm = source.around.spacing_mm();
  glm::dvec3 least(std::numeric_limits<double>::infinity()), most(-least);
  for (const glm::dvec3& p_mm : points_mm) {
    const glm::dvec3 p_voxel = source.around.voxel(p_mm);
    least = glm::min(least, p_voxel);
    most = glm::max(most, p_voxel);
  }
  const auto largest = [](const glm::dvec3& mm) { return std::max({mm.x, mm.y, mm.z}); };
  const double beyond_mm = largest(glm::max(low - least, most - high) * spacing_mm);
  const double beside_mm = largest(glm::max(least - high, low - most) * spacing_mm);
  const std::string images = " the images of " + text.source.string();
  if (beside_mm >= 0.0) {
    const std::string said = text.in.string() + ": lies wholly beside" + images + ", by " +
                             three_figures(beside_mm) +
                             " mm: was it made of another scan, or is its frame wrong (--frame)?";
    if (!text.other_identity)
      throw std::runtime_error(said + " If this is intended, --other-identity continues and reports a FAIL");
    findings.push_back("FAIL: " + said);
  } else if (beyond_mm > std::min({spacing_mm.x, spacing_mm.y, spacing_mm.z})) {
    // Points may lie less than a voxel outside if the object's voxels differ from those of the images.
    findings.push_back(text.in.string() + ": reaches beyond" + images + " by " + three_figures(beyond_mm) +
                       " mm: was it made of another scan?");
  }
}

void tell(const ConvertText& text, const std::vector<std::string>& findings, Json& json) {
  json["identity"] = {{"choice", text.identity}, {"changes", *text.changes}};
  json["findings"] = findings;
  for (const std::string& finding : findings) warn_finding(finding);
}

LabelObjects read_label_objects(const Program& program, const ConvertText& text, Timings& timings,
                                std::vector<std::string>& findings) {
  ScanIn in = text.scan;
  if (!text.source.empty() && voxel::volume_format(text.in)) {
    // A volume file has only one series, so --series, --slices and --join apply to the source.
    in.series.clear();
    in.slices.clear();
    in.join = false;
  }
  LabelObjects read{read_scan(program, text.in, in, timings), {}, {}};
  read.labels = voxel::labels(read.scene);
  constexpr std::size_t most_labels = 1024;
  if (read.labels.empty() || read.labels.size() > most_labels)
    throw std::runtime_error(text.in.string() + ": holds " + std::to_string(read.labels.size()) +
                             " labels, so it is not a label map: octotomy segment makes objects from a scan");
  std::set<int> occurring;
  for (const voxel::Label& label : read.labels) occurring.insert(label.number);
  const LabelTable table = label_table_of(text.in, occurring);
  findings.insert(findings.end(), table.passed_over.begin(), table.passed_over.end());
  for (std::string& line : findings_of_labels(read.labels)) findings.push_back(std::move(line));
  const voxel::Universe universe = voxel::universe_on(read.scene.lattice);
  for (const voxel::Label& label : read.labels) {
    const auto named = text.keeps_identity() ? table.names.find(label.number) : table.names.end();
    read.objects.push_back(
        {named == table.names.end() ? "label " + std::to_string(label.number) : named->second.substr(0, 64),
         voxel::octree_of_label(universe, read.scene, label.number)});
  }
  return read;
}

voxel::DicomSegment binary_object(const ConvertText& text, const voxel::OctreeFile& file) {
  const auto* octree = std::get_if<voxel::Octree>(&file.tree);
  if (octree == nullptr)
    throw std::runtime_error(text.in.string() +
                             ": only a binary octree is a segmentation: choose an object of the samples with "
                             "octotomy octree --window LOW:HIGH");
  const bool has_own = text.keeps_identity() && !file.name.empty();
  return {!text.label.empty() ? text.label : has_own ? file.name.substr(0, 64) : "Object", *octree};
}

}  // namespace octotomy::planner::cli
