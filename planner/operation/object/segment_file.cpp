// SPDX-License-Identifier: AGPL-3.0-or-later
// The segment operation on files: an object for each window, and further octrees, written as an octree, a
// label map or a DICOM segmentation.
#include "planner/operation/file/octree_in.h"
#include "planner/operation/file/outputs.h"
#include "planner/operation/file/path_checks.h"
#include "planner/operation/file/slice_contours.h"
#include "planner/operation/file/write_label_table.h"
#include "planner/operation/measure/octree_summary.h"
#include "planner/operation/object/provenance.h"
#include "planner/operation/object/segment.h"
#include "planner/operation/table/json_file.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/plan_universe.h"
#include "voxel/archive/source_identity.h"
#include "voxel/filter/label_map.h"
#include "voxel/filter/slice_contour.h"
#include "voxel/filter/tissue.h"
#include "voxel/scan/write_dicom_seg.h"
#include "voxel/scan/write_scene.h"
#include "voxel/volume/volume_header.h"

namespace octotomy::planner {
namespace {

namespace fs = std::filesystem;

/// An object, with a record of the operations on it; for a label map also the object on the scan's own
/// samples.
struct Named {
  std::string name;
  Segmented made;
  std::optional<voxel::Octree> on_samples = std::nullopt;
  bool is_of_file = false;  ///< the name comes from a file: it is stated there, or is the file's name
  bool is_named = true;     ///< the name is a word, not the two numbers of a window
};

bool is_dicom_seg(const fs::path& path) {
  return path.extension() == ".dcm";
}

SampleWindow window_of(const std::string& text) {
  try {
    return parse_sample_window(text);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(std::string("--window: ") + error.what());
  }
}

/// Makes an object for each window, or the object of the class, seeds or label; then those of the octrees. An
/// octree and a label map then contain the same set: parts are chosen among the octree's voxels, and the
/// label map has the samples inside them.
std::vector<Named> segments_of(const FileBench& bench, Segment asked, const voxel::Scene& scene) {
  Timings& timings = bench.timings;
  const voxel::Universe universe = universe_of(scene, asked.voxel_mm, asked.label.has_value());
  const auto grey_in = [&](const voxel::Universe& where, std::optional<voxel::GreyOctree>& kept) {
    return [&]() -> const voxel::GreyOctree& {
      if (kept) return *kept;
      const Stopwatch watch(timings, "octree");
      // Samples outside of the scan are lower than all its samples, so no window contains them.
      const double low = std::max(-32768.0, std::floor(std::min(voxel::range(scene).low - 1.0, -1024.0)));
      return kept.emplace(
          voxel::grey_octree_of(where, scene, static_cast<std::int16_t>(low), bench.progress("octree")));
    };
  };
  std::optional<voxel::GreyOctree> grey, own_grey;
  const std::stop_token& stop = bench.stop;
  const SegmentSource source{asked.scan.name, scene, universe, grey_in(universe, grey), {}, stop};
  std::vector<Named> segments;
  const auto add = [&](const std::string& name, bool is_named) {
    const Stopwatch watch(timings, "segment");
    segments.push_back({name, segmented(asked, source), {}, asked.named.has_value(), is_named});
    // If the voxels are the scan's samples, they are used for the label map directly.
    if (is_octree(asked.out)) return;
    if (!is_dicom_seg(asked.out) && on_samples(scene.lattice, universe.lattice())) return;
    const voxel::Universe own = voxel::universe_on(scene.lattice);
    segments.back().on_samples = on_own_samples(
        asked, {asked.scan.name, scene, own, grey_in(own, own_grey), {}, stop}, segments.back().made);
  };
  if (asked.otsu) add("class " + std::to_string(asked.otsu_class.value_or(*asked.otsu)), false);
  if (asked.clusters) add("class " + std::to_string(asked.otsu_class.value_or(*asked.clusters)), false);
  if (asked.label)
    add(asked.named ? *asked.named : "label " + std::to_string(*asked.label), asked.named.has_value());
  if (asked.tolerance) add("grown", false);
  for (const std::string& window : asked.windows) {
    asked.window = window_of(window);
    add(window, window.find(':') == std::string::npos);  // whether the name is a tissue's, not two numbers
  }
  for (const std::string& object : asked.objects) {
    const fs::path path = object;
    const voxel::OctreeFile file = read_timed(path, timings);
    const auto* octree = std::get_if<voxel::Octree>(&file.tree);
    if (octree == nullptr)
      throw std::runtime_error(path.string() + ": only a binary octree can become an object of a label map");
    if (octree->is_empty()) throw std::runtime_error(path.string() + ": holds no voxel");
    segments.push_back(
        {path.stem().string(),
         {*octree, {{{"do", "read"}, {"path", path.string()}, {"voxels", octree->voxel_count()}}}},
         {},
         true});
  }
  return segments;
}

/// Writes the contours at a threshold, in the form that mask --slices and segment --regions read.
Json write_contours(const FileBench& bench, const Segment& asked, const voxel::Scene& scene, double threshold,
                    Outputs& outputs) {
  const Stopwatch watch(bench.timings, "contours");
  const glm::dvec3 spacing_mm = scene.lattice.spacing_mm();
  voxel::ContourOptions options;
  options.threshold = threshold;
  options.least_mm2 = spacing_mm.x * spacing_mm.y;  // the area of a pixel, because smaller contours are noise
  options.progress.stop = bench.stop;
  const voxel::SliceMask mask = voxel::contour_regions(scene, options);
  std::size_t contours = 0, points = 0;
  for (const voxel::SliceMask::Slice& slice : mask.slices) {
    contours += slice.polygons_mm.size();
    for (const auto& polygon : slice.polygons_mm) points += polygon.size();
  }
  outputs.write(asked.contours, [&](const fs::path& file) { write_json(to_json(mask), file); });
  return {{"path", asked.contours.string()},
          {"threshold", threshold},
          {"slices", mask.slices.size()},
          {"contours", contours},
          {"points", points}};
}

/// The JSON of the written object. For a label map's samples, it also describes the octree of the same set.
Json said_of(const Named& segment) {
  const auto put = [](Json& json, const voxel::Octree& octree) {
    json["voxels"] = octree.voxel_count();
    json["volume_mm3"] = static_cast<double>(octree.voxel_count()) * octree.universe().lattice().voxel_mm3();
  };
  Json said{{"name", segment.name}};
  put(said, segment.on_samples.value_or(segment.made.octree));
  said["steps"] = segment.made.steps;
  if (segment.on_samples) put(said["octree"], segment.made.octree);
  return said;
}

/// Writes the objects as named segments of a DICOM segmentation on the scan's own slices.
void write_seg(const FileBench& bench, const Segment& asked, const voxel::Scene& scene,
               const std::vector<Named>& segments, Outputs& outputs, Json& json) {
  const Stopwatch watch(bench.timings, "write");
  const voxel::Octree none = voxel::Octree::empty(voxel::universe_on(scene.lattice));
  std::vector<voxel::DicomSegment> written;
  json["kind"] = "DICOM segmentation";
  json["labels"] = Json::array();
  for (const Named& segment : segments) {
    const voxel::Octree& voxels = segment.made.octree;
    written.push_back(
        {asked.identity == "keep" || !segment.is_of_file ? segment.name.substr(0, 64)
                                                         : "Object " + std::to_string(written.size() + 1),
         segment.on_samples
             ? *segment.on_samples
             : voxel::chosen_samples(scene.lattice, none, voxel::Octree::empty(voxels.universe()), voxels)});
    const voxel::Octree& object = written.back().object;
    if (object.is_empty())
      throw std::runtime_error("'" + segment.name + "' contains none of the scan's samples: leave it out");
    json["labels"].push_back(
        {{"label", written.size()}, {"name", segment.name}, {"samples", object.voxel_count()}});
  }
  voxel::DicomSegOptions options;
  options.label = written.size() == 1 ? written.front().label : "Objects";
  options.series_description = "Octotomy, segmented";
  options.progress.stop = bench.stop;
  voxel::DecidedIdentity decided;
  if (const auto source = bench.dicom_source(asked.scan.name, scene))
    decided = voxel::decide_identity(*source, *voxel::identity_choice(asked.identity));
  options.source = std::move(decided.source);
  json["identity"] = {{"choice", asked.identity}, {"changes", decided.changes}};
  json["source_images"] = options.source ? Json(options.source->images.size()) : Json(nullptr);
  outputs.write(asked.out, [&](const fs::path& file) { voxel::write_dicom_seg(written, file, options); });
}

/// Writes the objects: one as an octree, or any number as a label map on the scan's own lattice. Returns the
/// names of the label map's labels.
std::map<int, std::string> write_segments(const FileBench& bench, const Segment& asked,
                                          const voxel::Scene& scene, const std::vector<Named>& segments,
                                          Outputs& outputs, Json& json) {
  std::map<int, std::string> names;
  if (bench.stop.stop_requested())
    throw voxel::Stopped("stopped before " + asked.out.string() + " was written");
  if (is_octree(asked.out)) {
    const Json made{{"made_by", std::string("octotomy ") + OCTOTOMY_VERSION},
                    {"scan", fs::path(asked.scan.name).filename().string()},
                    {"steps", segments.front().made.steps},
                    {"scan_audit", doubts_of(scene.audit)}};
    const voxel::OctreeFile file{segments.front().made.octree, segments.front().name, json_text(made)};
    const Stopwatch watch(bench.timings, "write");
    outputs.write(asked.out, [&](const fs::path& path) {
      voxel::write_octree(file, path);
      json.update(octree_answer(file, fs::file_size(path), bench.timings));
    });
  } else if (is_dicom_seg(asked.out)) {
    write_seg(bench, asked, scene, segments, outputs, json);
  } else {
    std::vector<voxel::Octree> octrees;
    for (const Named& segment : segments) octrees.push_back(segment.on_samples.value_or(segment.made.octree));
    const Stopwatch watch(bench.timings, "write");
    const voxel::LabelMap map = voxel::label_map(scene.lattice, octrees, {bench.stop, {}});
    json["kind"] = "label map";
    json["labels"] = Json::array();
    for (const voxel::Label& label : voxel::labels(map.scene)) {
      const std::string& name = segments[static_cast<std::size_t>(label.number) - 1].name;
      json["labels"].push_back({{"label", label.number}, {"name", name}, {"samples", label.samples}});
      if (segments[static_cast<std::size_t>(label.number) - 1].is_named) names.emplace(label.number, name);
    }
    if (!names.empty()) need_label_table(asked.out, names);
    outputs.write(asked.out, [&](const fs::path& file) { voxel::write_scene(map.scene, file); });
    json["overlaps"] = map.overlaps;
    if (map.overlaps > 0)
      json["findings"].push_back(std::to_string(map.overlaps) +
                                 " samples lie in several objects and have the label of the first of them");
  }
  json["path"] = asked.out.string();
  return names;
}

/// Throws before anything is read if options contradict each other.
void check_asked(const Segment& asked) {
  const int ways = (asked.windows.empty() ? 0 : 1) + (asked.otsu ? 1 : 0) + (asked.clusters ? 1 : 0) +
                   (asked.tolerance ? 1 : 0) + (asked.label ? 1 : 0) + (asked.named ? 1 : 0);
  if (ways > 1)
    throw std::runtime_error(
        "--window: state only one of --window, --otsu, --clusters, --tolerance with --seed, --label, "
        "--named");
  if (ways == 0 && asked.objects.empty())
    throw std::runtime_error(
        "no object is selected: add --window bone, --otsu 3, --clusters 4, --seed X,Y,Z --tolerance T, "
        "--label N, --named NAME or --object FILE");
  if (asked.out.empty() && asked.contours.empty() && !asked.otsu && !asked.clusters)
    throw std::runtime_error(
        "--out is missing: add it; only --otsu, --clusters and --contours work without it");
  if (is_octree(asked.out) && asked.windows.size() + asked.objects.size() > 1)
    throw std::runtime_error(
        "--out: an .octree can contain only one object: write several as a label map, .nrrd");
  if (!asked.out.empty() && !is_octree(asked.out) && !is_dicom_seg(asked.out) &&
      !voxel::volume_format(asked.out))
    throw std::runtime_error(asked.out.string() +
                             ": has an unknown extension: write an .octree, a label map as .nrrd, .nii.gz or "
                             ".mha, or a DICOM segmentation, .dcm");
  if (!asked.contours.empty()) {
    need_extension(asked.contours, {".json"}, "contours are");
    if (asked.windows.empty() && !asked.otsu)
      throw std::runtime_error(
          "--contours applies only to a --window, whose lower bound the contours follow: add --window");
  }
  std::vector<fs::path> read{asked.scan.name, asked.names, asked.regions};
  read.insert(read.end(), asked.objects.begin(), asked.objects.end());
  need_outputs({asked.out, asked.contours}, read);
}

}  // namespace

std::string names_of_tissues() {
  std::string names;
  for (const voxel::Tissue& tissue : voxel::tissues())
    names += (names.empty() ? "" : ", ") + std::string(tissue.name);
  return names;
}

FileAnswer segment_file(const Segment& given, const FileBench& bench) {
  check_asked(given);
  Segment asked = given;
  std::optional<SampleWindow> first;
  if (!asked.windows.empty()) first = window_of(asked.windows.front());
  const fs::path path = asked.scan.name;
  const voxel::Scene scene = bench.read_scan(path);
  for (const std::string& window : asked.windows) need_hounsfield(window_of(window), scene);
  FileAnswer answer{{{"source", path.string()}, {"unit", voxel::unit(scene)}}};
  std::vector<std::string>& findings = answer.findings;
  if (asked.named) asked.label = label_of_name(asked, path, scene, {}, findings);
  if (asked.otsu) {
    const Stopwatch watch(bench.timings, "otsu");
    OtsuWindow otsu = otsu_window(scene, *asked.otsu, asked.otsu_class.value_or(*asked.otsu));
    answer.json["suggestion"] = std::move(otsu.suggestion);
    first = asked.window = otsu.window;
  }
  if (asked.clusters) {
    const Stopwatch watch(bench.timings, "clusters");
    Clusters found = clusters_of(scene, *asked.clusters, bench.progress("clusters"));
    asked.classes = std::move(found.classes);
    answer.json["suggestion"] = std::move(found.suggestion);
  }
  std::string written;
  std::map<int, std::string> names;
  Outputs outputs;
  std::vector<std::pair<std::string, std::string>> sizes;
  if (!asked.out.empty()) {
    const std::vector<Named> segments = segments_of(bench, asked, scene);
    names = write_segments(bench, asked, scene, segments, outputs, answer.json);
    answer.json["objects"] = Json::array();
    for (const Named& each : segments) {
      const Json& said = answer.json["objects"].emplace_back(said_of(each));
      std::string volume = grouped(said["volume_mm3"].get<double>(), 1) + " mm\u00b3";
      if (said.contains("octree"))
        volume += " of samples, " + grouped(said["octree"]["volume_mm3"].get<double>(), 1) + " as an octree";
      sizes.emplace_back(each.name, volume);
      findings.insert(findings.end(), each.made.findings.begin(), each.made.findings.end());
    }
    written = asked.out.string();
  }
  if (!asked.contours.empty()) {
    answer.json["contours"] = write_contours(bench, asked, scene, first->low, outputs);
    written += (written.empty() ? "" : ", ") + asked.contours.string();
  }
  outputs.commit();
  if (!names.empty())
    for (std::string& finding : write_label_table(asked.out, names)) findings.push_back(std::move(finding));
  // The names of the octree or label map come first.
  std::vector<std::string> all;
  for (const Json& finding : answer.json.value("findings", Json::array())) all.push_back(finding);
  all.insert(all.end(), findings.begin(), findings.end());
  if (!all.empty()) answer.json["findings"] = all;
  findings = std::move(all);
  for (const char* common : {"octotomy", "timings_ms"}) answer.json.erase(common);
  if (!written.empty()) answer.rows.emplace_back("written", written);
  if (asked.otsu) answer.rows.emplace_back("thresholds", answer.json["suggestion"]["thresholds"].dump());
  for (const voxel::FeatureCentre& centre : asked.classes.centres)
    answer.rows.emplace_back("class of", grouped(100.0 * centre.share, 1) + " %: density " +
                                             grouped(centre.density, 1) + ", gradient " +
                                             grouped(centre.gradient, 1) + " / mm");
  answer.rows.insert(answer.rows.end(), sizes.begin(), sizes.end());
  return answer;
}

}  // namespace octotomy::planner
