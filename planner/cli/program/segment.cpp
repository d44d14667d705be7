// SPDX-License-Identifier: AGPL-3.0-or-later
// The segment operation on files: an object for each window, and further octrees, written as an octree, a
// label map or a DICOM segmentation.
#include "planner/operation/object/segment.h"

#include <CLI/CLI.hpp>

#include "planner/cli/program/verbs.h"
#include "planner/cli/verb/field_options.h"
#include "planner/cli/verb/numbers.h"
#include "planner/cli/verb/octree_out.h"
#include "planner/cli/verb/scan_in.h"
#include "planner/operation/file/outputs.h"
#include "planner/operation/file/slice_contours.h"
#include "planner/operation/file/write_label_table.h"
#include "planner/operation/measure/octree_summary.h"
#include "planner/operation/object/trace.h"
#include "planner/operation/table/json_file.h"
#include "planner/operation/table/number_format.h"
#include "voxel/filter/label_map.h"
#include "voxel/filter/slice_contour.h"
#include "voxel/filter/tissue.h"
#include "voxel/scan/write_dicom_seg.h"
#include "voxel/scan/write_scene.h"
#include "voxel/volume/volume_header.h"

namespace octotomy::planner::cli {
namespace {

namespace fs = std::filesystem;

struct SegmentText {
  fs::path scan, out, contours;
  std::vector<std::string> windows;
  std::vector<fs::path> objects;
  std::optional<double> voxel_mm;
  FieldWords words;  ///< of the operation's other fields
  ScanIn in;
};

/// An object and a record of what was done to it; for a label map also the object on the scan's own samples.
struct Named {
  std::string name;
  Segmented made;
  std::optional<voxel::Octree> on_samples = std::nullopt;
  bool is_named = true;  ///< the name is a word, not the two numbers of a window
};

bool is_dicom_seg(const fs::path& path) {
  return path.extension() == ".dcm";
}

SampleWindow window_of(const std::string& text) {
  try {
    return parse_sample_window(text);
  } catch (const std::runtime_error& error) {
    throw CLI::ValidationError("--window", error.what());
  }
}

/// An object for each window, or the one of the class, seeds or label; then the octrees. Both kinds of file
/// contain the same set: parts are chosen on the octree's voxels, and a label map has the samples inside
/// them.
std::vector<Named> segments_of(const Program& program, const SegmentText& text, Segment asked,
                               const voxel::Scene& scene, Timings& timings) {
  const voxel::Universe universe = universe_of(scene, text.voxel_mm, asked.label.has_value());
  const auto grey_in = [&](const voxel::Universe& where, std::optional<voxel::GreyOctree>& kept) {
    return [&]() -> const voxel::GreyOctree& {
      if (kept) return *kept;
      const Stopwatch watch(timings, "octree");
      // Outside the scan, samples are lower than any sample of it, so that no window includes them.
      const double low = std::max(-32768.0, std::floor(std::min(voxel::range(scene).low - 1.0, -1024.0)));
      return kept.emplace(voxel::grey_octree_of(where, scene, static_cast<std::int16_t>(low),
                                                {program.stop.get_token(), program.progress("octree")}));
    };
  };
  std::optional<voxel::GreyOctree> grey, own_grey;
  const std::stop_token stop = program.stop.get_token();
  const SegmentSource source{text.scan.string(), scene, universe, grey_in(universe, grey), {}, stop};
  std::vector<Named> segments;
  const auto add = [&](const std::string& name, bool is_named) {
    const Stopwatch watch(timings, "segment");
    segments.push_back({name, segmented(asked, source), {}, is_named});
    // If the voxels are the scan's samples, the label map uses them directly.
    if (is_octree(text.out)) return;
    if (!is_dicom_seg(text.out) && on_samples(scene.lattice, universe.lattice())) return;
    const voxel::Universe own = voxel::universe_on(scene.lattice);
    segments.back().on_samples = on_own_samples(
        asked, {text.scan.string(), scene, own, grey_in(own, own_grey), {}, stop}, segments.back().made);
  };
  if (asked.otsu) add("class " + std::to_string(asked.otsu_class.value_or(*asked.otsu)), false);
  if (asked.label)
    add(asked.named ? *asked.named : "label " + std::to_string(*asked.label), asked.named.has_value());
  if (asked.tolerance) add("grown", false);
  for (const std::string& window : text.windows) {
    asked.window = window_of(window);
    add(window, window.find(':') == std::string::npos);  // a tissue's name, not two numbers
  }
  for (const fs::path& path : text.objects) {
    const voxel::OctreeFile file = read_timed(path, timings);
    const auto* octree = std::get_if<voxel::Octree>(&file.tree);
    if (octree == nullptr)
      throw std::runtime_error(path.string() + ": only a binary octree is an object of a label map");
    if (octree->is_empty()) throw std::runtime_error(path.string() + ": holds no voxel");
    segments.push_back(
        {path.stem().string(),
         {*octree, {{{"do", "read"}, {"path", path.string()}, {"voxels", octree->voxel_count()}}}}});
  }
  return segments;
}

/// Writes the contours at a threshold, in the format of mask --slices and segment --regions.
Json write_contours(const Program& program, const SegmentText& text, const voxel::Scene& scene,
                    double threshold, Outputs& outputs, Timings& timings) {
  const Stopwatch watch(timings, "contours");
  const glm::dvec3 spacing_mm = scene.lattice.spacing_mm();
  voxel::ContourOptions options;
  options.threshold = threshold;
  options.least_mm2 = spacing_mm.x * spacing_mm.y;  // the area of a pixel; smaller contours are noise
  options.progress.stop = program.stop.get_token();
  const voxel::SliceMask mask = voxel::contour_regions(scene, options);
  std::size_t contours = 0, points = 0;
  for (const voxel::SliceMask::Slice& slice : mask.slices) {
    contours += slice.polygons_mm.size();
    for (const auto& polygon : slice.polygons_mm) points += polygon.size();
  }
  outputs.write(text.contours, [&](const fs::path& file) { write_json(to_json(mask), file); });
  return {{"path", text.contours.string()},
          {"threshold", threshold},
          {"slices", mask.slices.size()},
          {"contours", contours},
          {"points", points}};
}

/// The JSON of the written object and, for a label map's samples, of the octree of the same set.
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

/// Writes the objects as named segments on the scan's own slices.
void write_seg(const Program& program, const SegmentText& text, const voxel::Scene& scene,
               const std::vector<Named>& segments, Outputs& outputs, Timings& timings, Json& json) {
  const Stopwatch watch(timings, "write");
  const voxel::Octree none = voxel::Octree::empty(voxel::universe_on(scene.lattice));
  std::vector<voxel::DicomSegment> written;
  json["kind"] = "DICOM segmentation";
  json["labels"] = Json::array();
  for (const Named& segment : segments) {
    const voxel::Octree& voxels = segment.made.octree;
    written.push_back(
        {segment.name.substr(0, 64),
         segment.on_samples
             ? *segment.on_samples
             : voxel::chosen_samples(scene.lattice, none, voxel::Octree::empty(voxels.universe()), voxels)});
    const voxel::Octree& object = written.back().object;
    if (object.is_empty())
      throw std::runtime_error("'" + segment.name + "' holds none of the scan's samples: leave it out");
    json["labels"].push_back(
        {{"label", written.size()}, {"name", segment.name}, {"samples", object.voxel_count()}});
  }
  voxel::DicomSegOptions options;
  options.label = written.size() == 1 ? written.front().label : "Objects";
  options.series_description = "Octotomy, segmented";
  options.progress.stop = program.stop.get_token();
  if (is_dicom(scene)) options.source = voxel::dicom_source(text.scan, read_options(program, text.in));
  json["source_images"] = options.source ? Json(options.source->images.size()) : Json(nullptr);
  outputs.write(text.out, [&](const fs::path& file) { voxel::write_dicom_seg(written, file, options); });
}

/// Writes the objects: one as an octree, any number as a label map on the scan's own lattice. Returns the
/// names of a label map's labels.
std::map<int, std::string> write_segments(const Program& program, const SegmentText& text,
                                          const voxel::Scene& scene, const std::vector<Named>& segments,
                                          Outputs& outputs, Timings& timings, Json& json) {
  std::map<int, std::string> names;
  if (program.stop.stop_requested()) throw Stopped("stopped before " + text.out.string() + " was written");
  if (is_octree(text.out)) {
    const Json made{{"made_by", std::string("octotomy ") + OCTOTOMY_VERSION},
                    {"scan", text.scan.filename().string()},
                    {"steps", segments.front().made.steps},
                    {"scan_audit", doubts_of(scene.audit)}};
    const voxel::OctreeFile file{segments.front().made.octree, segments.front().name, json_text(made)};
    const Stopwatch watch(timings, "write");
    outputs.write(text.out, [&](const fs::path& path) {
      voxel::write_octree(file, path);
      json.update(octree_answer(file, fs::file_size(path), timings));
    });
  } else if (is_dicom_seg(text.out)) {
    write_seg(program, text, scene, segments, outputs, timings, json);
  } else {
    std::vector<voxel::Octree> octrees;
    for (const Named& segment : segments) octrees.push_back(segment.on_samples.value_or(segment.made.octree));
    const Stopwatch watch(timings, "write");
    const voxel::LabelMap map = voxel::label_map(scene.lattice, octrees, {program.stop.get_token(), {}});
    json["kind"] = "label map";
    json["labels"] = Json::array();
    for (const voxel::Label& label : voxel::labels(map.scene)) {
      const std::string& name = segments[static_cast<std::size_t>(label.number) - 1].name;
      json["labels"].push_back({{"label", label.number}, {"name", name}, {"samples", label.samples}});
      if (segments[static_cast<std::size_t>(label.number) - 1].is_named) names.emplace(label.number, name);
    }
    if (!names.empty()) need_label_table(text.out, names);
    outputs.write(text.out, [&](const fs::path& file) { voxel::write_scene(map.scene, file); });
    json["overlaps"] = map.overlaps;
    if (map.overlaps > 0)
      json["findings"].push_back(std::to_string(map.overlaps) +
                                 " samples lie in several objects: they have the first one's label");
  }
  json["path"] = text.out.string();
  return names;
}

/// Refuses contradictory options before anything is read.
void check_text(const SegmentText& text, const Segment& asked) {
  const int ways = (text.windows.empty() ? 0 : 1) + (asked.otsu ? 1 : 0) + (asked.tolerance ? 1 : 0) +
                   (asked.label ? 1 : 0) + (asked.named ? 1 : 0);
  if (ways > 1)
    throw CLI::ValidationError("--window",
                               "give one of --window, --otsu, --tolerance with --seed, --label, --named");
  if (ways == 0 && text.objects.empty())
    throw CLI::ValidationError("--window",
                               "choose the objects: --window bone, --otsu 3, --seed X,Y,Z --tolerance T, "
                               "--label N, --named NAME or --object FILE");
  if (text.out.empty() && text.contours.empty() && !asked.otsu)
    throw CLI::ValidationError("--out", "only --otsu and --contours need none");
  if (is_octree(text.out) && text.windows.size() + text.objects.size() > 1)
    throw CLI::ValidationError("--out", "an .octree holds one object: write several as a label map, .nrrd");
  if (!text.out.empty() && !is_octree(text.out) && !is_dicom_seg(text.out) && !voxel::volume_format(text.out))
    throw std::runtime_error(text.out.string() +
                             ": write an .octree, a label map as .nrrd, .nii.gz or .mha, or a DICOM "
                             "segmentation, .dcm");
  if (!text.contours.empty()) {
    need_extension(text.contours, {".json"}, "contours are");
    if (text.windows.empty() && !asked.otsu)
      throw CLI::ValidationError("--contours", "follow the lower bound of a --window: give it");
  }
  std::vector<fs::path> read{text.scan};
  read.insert(read.end(), text.objects.begin(), text.objects.end());
  for (const auto& [field, words] : text.words)
    read.insert(read.end(), words.begin(), words.end());  // a word that is not a file cannot be an output
  need_outputs({text.out, text.contours}, read);
}

int segment(const Program& program, const SegmentText& text) {
  const Action action = read_action(*find_operation("segment"), text.words);
  Segment asked = action.get<Segment>();
  check_text(text, asked);
  std::optional<SampleWindow> first;
  if (!text.windows.empty()) first = window_of(text.windows.front());
  Timings timings;
  program.note_tissues(text.windows);
  const voxel::Scene scene = read_scan(program, text.scan, text.in, timings);
  for (const std::string& window : text.windows) need_hounsfield(window_of(window), scene);
  Json json{{"source", text.scan.string()}, {"unit", voxel::unit(scene)}};
  std::vector<std::string> findings;
  if (asked.named) asked.label = label_of_name(asked, text.scan, scene, {}, findings);
  if (asked.otsu) {
    const Stopwatch watch(timings, "otsu");
    OtsuWindow otsu = otsu_window(scene, *asked.otsu, asked.otsu_class.value_or(*asked.otsu));
    json["suggestion"] = std::move(otsu.suggestion);
    first = asked.window = otsu.window;
  }
  std::string written;
  std::map<int, std::string> names;
  Outputs outputs;
  if (!text.out.empty()) {
    const std::vector<Named> segments = segments_of(program, text, asked, scene, timings);
    names = write_segments(program, text, scene, segments, outputs, timings, json);
    json["objects"] = Json::array();
    for (const Named& each : segments) {
      json["objects"].push_back(said_of(each));
      findings.insert(findings.end(), each.made.findings.begin(), each.made.findings.end());
    }
    written = text.out.string();
  }
  if (!text.contours.empty()) {
    json["contours"] = write_contours(program, text, scene, first->low, outputs, timings);
    written += (written.empty() ? "" : ", ") + text.contours.string();
  }
  outputs.commit();
  if (!names.empty())
    for (std::string& finding : write_label_table(text.out, names)) findings.push_back(std::move(finding));
  for (const std::string& finding : findings) json["findings"].push_back(finding);
  Json whole = answer(timings);
  for (const auto& [key, value] : json.items())
    if (key != "octotomy" && key != "timings_ms") whole[key] = value;
  for (const Json& finding : json.value("findings", Json::array())) warn_finding(finding.get<std::string>());
  std::vector<std::pair<std::string, std::string>> rows;
  if (!written.empty()) rows.emplace_back("written", written);
  if (json.contains("suggestion")) rows.emplace_back("thresholds", json["suggestion"]["thresholds"].dump());
  for (const Json& object : json.value("objects", Json::array())) {
    std::string volume = grouped(object["volume_mm3"].get<double>(), 1) + " mm\u00b3";
    if (object.contains("octree"))
      volume += " of samples, " + grouped(object["octree"]["volume_mm3"].get<double>(), 1) + " as an octree";
    rows.emplace_back(object["name"].get<std::string>(), volume);
  }
  program.say(whole, lines(rows));
  return done;
}

}  // namespace

void add_segment(Program& program) {
  const auto text = std::make_shared<SegmentText>();
  CLI::App& verb = program.verb(
      "segment",
      "Makes objects from a scan: by window or tissue, by suggested thresholds, from seeds; chooses and "
      "fills parts",
      "octotomy segment head.nrrd -o skull.octree --window bone --largest\n"
      "  octotomy segment head.nrrd -o tissues.nii.gz --window bone --window soft_tissue --window fat\n"
      "  octotomy segment dicom_folder -o tissues.dcm --window bone --window soft_tissue\n"
      "  octotomy segment head.nrrd --otsu 3 --json\n"
      "  octotomy segment tissues.nii.gz -o fat.octree --label 3\n"
      "  octotomy segment organs.nii.gz -o mandible.octree --named mandible --names organs.json\n"
      "  octotomy segment head.nrrd --window bone --contours skull.json",
      [&program, text] { return segment(program, *text); });
  std::string names;
  for (const voxel::Tissue& tissue : voxel::tissues())
    names += (names.empty() ? "" : ", ") + std::string(tissue.name);
  verb.add_option("scan", text->scan, "A scan, or with --label a label map")->required()->check(scan_path());
  verb.add_option(
      "-o,--out", text->out,
      "An .octree file for one object; a label map (.nrrd, .nii.gz, .mha) or a DICOM segmentation (.dcm) on "
      "the scan's lattice");
  verb.add_option("--window", text->windows,
                  "LOW:HIGH or LOW: in sample units, or a tissue: " + names + "; again for more objects")
      ->expected(1)
      ->take_all();
  const Operation& operation = *find_operation("segment");
  std::vector<Field> fields;
  for (const Field& field : operation.fields)
    if (field.name != "scan" && field.name != "window") fields.push_back(field);
  add_field_options(verb, operation, fields, text->words);
  verb.add_option("--object", text->objects, "An .octree file to be put into the label map, again for more")
      ->expected(1)
      ->take_all()
      ->check(CLI::ExistingFile);
  verb.add_option(
      "--contours", text->contours,
      "Writes the contours of the first window's lower bound on every slice, a JSON file of regions");
  verb.add_option(
          "--voxel", text->voxel_mm,
          "Edge of the voxels that choose parts, and of an octree's, mm; default: as fine as the scan, "
          "at most 512 a side")
      ->check(above_zero());
  text->words["scan"] = {"scan"};
  add_scan_options(verb, text->in);
}

}  // namespace octotomy::planner::cli
