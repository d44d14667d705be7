// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>

#include "planner/cli/numbers.h"
#include "planner/cli/octree_out.h"
#include "planner/cli/scan_in.h"
#include "planner/cli/scan_verbs.h"
#include "planner/plan/octree_summary.h"
#include "planner/plan/region_file.h"
#include "planner/plan/slice_contours.h"
#include "planner/table/json_file.h"
#include "planner/table/number_format.h"
#include "voxel/filter/components.h"
#include "voxel/filter/label_map.h"
#include "voxel/filter/morphology.h"
#include "voxel/filter/otsu.h"
#include "voxel/filter/region_grow.h"
#include "voxel/filter/slice_contour.h"
#include "voxel/filter/tissue.h"
#include "voxel/scan/volume_header.h"
#include "voxel/scan/write_scene.h"
#include "voxel/solid/combine.h"

namespace octotomy::planner::cli {
namespace {

namespace fs = std::filesystem;

struct SegmentText {
  fs::path scan, out, regions, contours;
  std::vector<std::string> windows, seeds;
  std::vector<fs::path> objects;
  std::optional<int> otsu, otsu_class, label, components;
  std::optional<double> tolerance, at_least_mm3, open_mm, close_mm, voxel_mm;
  int neighbours = 6;
  bool largest = false, fill = false;
  ScanIn in;
};

/// An object on its way, and what was done to it.
struct Segment {
  std::string name;
  voxel::Octree octree;
  Json steps = Json::array();
};

Json suggestion_of(const voxel::Scene& scene, int classes, std::vector<double>& thresholds,
                   Timings& timings) {
  const Stopwatch watch(timings, "otsu");
  const voxel::Histogram histogram = voxel::histogram(scene);
  thresholds = voxel::otsu_thresholds(histogram, classes);
  return {{"method", "Otsu 1979, " + std::to_string(classes) + " classes"},
          {"thresholds", thresholds},
          {"histogram", {{"low", histogram.low}, {"bin", histogram.width()}, {"counts", histogram.counts}}}};
}

/// The window of one class of those that thresholds part, from darkest, 1.
WindowText class_window(const std::vector<double>& thresholds, int number) {
  WindowText window;
  const auto which = static_cast<std::size_t>(number) - 1;
  window.low = which == 0 ? std::numeric_limits<std::int16_t>::min() : std::ceil(thresholds[which - 1]);
  if (which < thresholds.size()) window.high = std::ceil(thresholds[which]) - 1.0;
  return window;
}

std::vector<glm::ivec3> seed_voxels(const SegmentText& text, const voxel::Universe& universe) {
  std::vector<glm::ivec3> seeds;
  for (const std::string& seed : text.seeds) {
    const glm::ivec3 voxel(glm::floor(universe.lattice().voxel(parse_point("--seed", seed)) + 0.5));
    if (glm::any(glm::lessThan(voxel, glm::ivec3(0))) ||
        glm::any(glm::greaterThanEqual(voxel, glm::ivec3(universe.side()))))
      throw CLI::ValidationError("--seed", seed + " mm lies outside the scan");
    seeds.push_back(voxel);
  }
  return seeds;
}

voxel::Neighbours neighbours_of(int count) {
  if (count == 18) return voxel::Neighbours::Edges;
  return count == 26 ? voxel::Neighbours::Corners : voxel::Neighbours::Faces;
}

void note(Segment& segment, Json step) {
  step["voxels"] = segment.octree.voxel_count();
  segment.steps.push_back(std::move(step));
}

/// Choices among what a window holds, in the order that --help tells them.
void refine(const Program& program, const SegmentText& text, const std::optional<voxel::SliceMask>& regions,
            Segment& segment) {
  const voxel::Universe universe = segment.octree.universe();
  const voxel::Neighbours neighbours = neighbours_of(text.neighbours);
  const auto go_on = [&] {
    if (program.stop.stop_requested()) throw Stopped("stopped before " + text.out.string() + " was written");
  };
  if (regions) {
    segment.octree = voxel::combine(universe, voxel::Expression(segment.octree) & *regions);
    note(segment, {{"do", "regions"}, {"path", text.regions.string()}});
  }
  if (text.open_mm) {
    go_on();
    segment.octree = voxel::open(segment.octree, *text.open_mm);
    note(segment, {{"do", "open"}, {"radius_mm", *text.open_mm}});
  }
  if (!text.seeds.empty() && !text.tolerance) {
    go_on();
    segment.octree = voxel::components_at(segment.octree, seed_voxels(text, universe), neighbours);
    note(segment, {{"do", "components_at_seeds"}});
  }
  if (text.largest || text.components) {
    go_on();
    const voxel::Components parts = voxel::components(segment.octree, neighbours);
    const auto wanted = static_cast<std::size_t>(text.components.value_or(1));
    if (wanted == 1)
      segment.octree = parts.largest;
    else if (wanted < parts.voxel_counts.size())
      segment.octree =
          voxel::components_of_at_least(segment.octree, parts.voxel_counts[wanted - 1], neighbours);
    note(segment, {{"do", "largest_components"}, {"of", parts.voxel_counts.size()}});
  }
  if (text.at_least_mm3) {
    go_on();
    const double voxels = std::ceil(*text.at_least_mm3 / universe.lattice().voxel_mm3());
    segment.octree =
        voxel::components_of_at_least(segment.octree, static_cast<std::uint64_t>(voxels), neighbours);
    note(segment, {{"do", "components_at_least"}, {"volume_mm3", *text.at_least_mm3}});
  }
  if (text.close_mm) {
    go_on();
    segment.octree = voxel::close(segment.octree, *text.close_mm);
    note(segment, {{"do", "close"}, {"radius_mm", *text.close_mm}});
  }
  if (text.fill) {
    go_on();
    segment.octree = voxel::fill_cavities(segment.octree);
    note(segment, {{"do", "fill"}});
  }
}

/// What the scan's samples give: an object a window, or one grown from seeds.
std::vector<Segment> segments_of_samples(const Program& program, const SegmentText& text,
                                         const voxel::Scene& scene, const voxel::Universe& universe,
                                         const std::vector<WindowText>& windows, Timings& timings) {
  std::optional<voxel::GreyOctree> grey;
  {
    const Stopwatch watch(timings, "octree");
    // Beyond the scan is what no window means: less than any of its samples.
    const double low = std::max(-32768.0, std::floor(std::min(voxel::range(scene).low - 1.0, -1024.0)));
    grey = voxel::grey_octree_of(universe, scene, static_cast<std::int16_t>(low));
  }
  const voxel::Octree within = voxel::combine(universe, voxel::bounds(scene.lattice));
  std::optional<voxel::SliceMask> regions;
  if (!text.regions.empty()) regions = read_slices(text.regions);
  const Stopwatch watch(timings, "segment");
  std::vector<Segment> segments;
  if (text.tolerance) {
    voxel::GrowOptions options;
    options.seeds = seed_voxels(text, universe);
    options.tolerance = *text.tolerance;
    options.neighbours = neighbours_of(text.neighbours);
    segments.push_back({"grown", voxel::grow_region(*grey, options)});
    note(segments.back(), {{"do", "grow"}, {"tolerance", *text.tolerance}});
  }
  for (std::size_t i = 0; i < windows.size(); ++i) {
    voxel::Window leaf{*grey, windows[i].low};
    if (windows[i].high) leaf.high = *windows[i].high;
    const std::string name =
        text.otsu ? "class " + std::to_string(text.otsu_class.value_or(*text.otsu)) : text.windows[i];
    segments.push_back({name, voxel::combine(universe, voxel::Expression(leaf) & within)});
    note(segments.back(), {{"do", "window"},
                           {"low", windows[i].low},
                           {"high", windows[i].high ? Json(*windows[i].high) : Json(nullptr)}});
  }
  for (Segment& segment : segments) refine(program, text, regions, segment);
  return segments;
}

std::vector<Segment> segments_of(const Program& program, const SegmentText& text, const voxel::Scene& scene,
                                 const voxel::Universe& universe, const std::vector<WindowText>& windows,
                                 Timings& timings) {
  std::vector<Segment> segments;
  if (text.label) {
    const Stopwatch watch(timings, "segment");
    segments.push_back(
        {"label " + std::to_string(*text.label), voxel::octree_of_label(universe, scene, *text.label)});
    note(segments.back(), {{"do", "label"}, {"label", *text.label}});
    std::optional<voxel::SliceMask> regions;
    if (!text.regions.empty()) regions = read_slices(text.regions);
    refine(program, text, regions, segments.back());
  } else if (!windows.empty() || text.tolerance) {
    segments = segments_of_samples(program, text, scene, universe, windows, timings);
  }
  for (const fs::path& path : text.objects) {
    const voxel::OctreeFile file = read_timed(path, timings);
    const auto* octree = std::get_if<voxel::Octree>(&file.tree);
    if (octree == nullptr)
      throw std::runtime_error(path.string() + ": only a binary octree is an object of a label map");
    segments.push_back({path.stem().string(), *octree});
    note(segments.back(), {{"do", "read"}, {"path", path.string()}});
  }
  for (const Segment& segment : segments)
    if (segment.octree.is_empty())
      throw std::runtime_error(
          text.scan.string() + ": '" + segment.name + "' holds no voxel" +
          (segment.steps.size() > 1
               ? " after its " + std::to_string(segment.steps.size()) + " steps: leave some out"
               : ": choose another window, or see what --otsu 3 suggests"));
  return segments;
}

/// The contours at a threshold, as mask --slices and segment --regions read them.
Json write_contours(const Program& program, const SegmentText& text, const voxel::Scene& scene,
                    double threshold, Timings& timings) {
  const Stopwatch watch(timings, "contours");
  const glm::dvec3 spacing_mm = scene.lattice.spacing_mm();
  voxel::ContourOptions options;
  options.threshold = threshold;
  options.least_mm2 = spacing_mm.x * spacing_mm.y;  // a voxel's: less is noise
  options.progress.stop = program.stop.get_token();
  const voxel::SliceMask mask = voxel::contour_regions(scene, options);
  std::size_t contours = 0, points = 0;
  for (const voxel::SliceMask::Slice& slice : mask.slices) {
    contours += slice.polygons_mm.size();
    for (const auto& polygon : slice.polygons_mm) points += polygon.size();
  }
  write_json(to_json(mask), text.contours);
  return {{"path", text.contours.string()},
          {"threshold", threshold},
          {"slices", mask.slices.size()},
          {"contours", contours},
          {"points", points}};
}

Json said_of(const Segment& segment) {
  const double voxel_mm3 = segment.octree.universe().lattice().voxel_mm3();
  return {{"name", segment.name},
          {"voxels", segment.octree.voxel_count()},
          {"volume_mm3", static_cast<double>(segment.octree.voxel_count()) * voxel_mm3},
          {"steps", segment.steps}};
}

/// Writes the objects: one as an octree, any number as a label map on the scan's own lattice.
void write_segments(const Program& program, const SegmentText& text, const voxel::Scene& scene,
                    const std::vector<Segment>& segments, Timings& timings, Json& json) {
  if (program.stop.stop_requested()) throw Stopped("stopped before " + text.out.string() + " was written");
  if (is_octree(text.out)) {
    const Json made{{"made_by", std::string("octotomy ") + OCTOTOMY_VERSION},
                    {"scan", text.scan.filename().string()},
                    {"steps", segments.front().steps}};
    const voxel::OctreeFile file{segments.front().octree, segments.front().name, made.dump()};
    const Stopwatch watch(timings, "write");
    voxel::write_octree(file, text.out);
    json.update(octree_answer(file, fs::file_size(text.out), timings));
  } else {
    std::vector<voxel::Octree> octrees;
    for (const Segment& segment : segments) octrees.push_back(segment.octree);
    const Stopwatch watch(timings, "write");
    const voxel::LabelMap map = voxel::label_map(scene.lattice, octrees, {program.stop.get_token(), {}});
    voxel::write_scene(map.scene, text.out);
    json["kind"] = "label map";
    json["labels"] = Json::array();
    for (const voxel::Label& label : voxel::labels(map.scene))
      json["labels"].push_back({{"label", label.number},
                                {"name", segments[static_cast<std::size_t>(label.number) - 1].name},
                                {"samples", label.samples}});
    json["overlaps"] = map.overlaps;
    if (map.overlaps > 0)
      json["findings"].push_back(std::to_string(map.overlaps) +
                                 " samples lie in several objects: they have the first one's label");
  }
  json["path"] = text.out.string();
}

/// What cannot be said together is refused before anything is read.
void check_text(const SegmentText& text) {
  const int ways =
      (text.windows.empty() ? 0 : 1) + (text.otsu ? 1 : 0) + (text.tolerance ? 1 : 0) + (text.label ? 1 : 0);
  if (ways > 1)
    throw CLI::ValidationError("--window", "give one of --window, --otsu, --tolerance with --seed, --label");
  if (ways == 0 && text.objects.empty())
    throw CLI::ValidationError(
        "--window",
        "say what is meant: --window bone, --otsu 3, --seed X,Y,Z --tolerance T, --label N or --object FILE");
  if (text.tolerance && text.seeds.empty())
    throw CLI::ValidationError("--tolerance", "grows from a --seed X,Y,Z: give one");
  if (text.otsu_class && (!text.otsu || *text.otsu_class > *text.otsu))
    throw CLI::ValidationError("--class", "is one of the classes of --otsu, from 1, the darkest");
  if (text.out.empty() && text.contours.empty() && !text.otsu)
    throw CLI::ValidationError("--out", "only --otsu and --contours need none");
  if (is_octree(text.out) && text.windows.size() + text.objects.size() > 1)
    throw CLI::ValidationError("--out", "an .octree holds one object: write several as a label map, .nrrd");
  if (!text.out.empty() && !is_octree(text.out) && !voxel::volume_format(text.out))
    throw std::runtime_error(text.out.string() +
                             ": write an .octree, or a label map as .nrrd, .nii.gz or .mha");
  if (!text.out.empty()) need_folder_of(text.out);
  if (!text.contours.empty()) need_folder_of(text.contours);
}

int segment(const Program& program, const SegmentText& text) {
  check_text(text);
  std::vector<WindowText> windows;
  for (const std::string& window : text.windows) windows.push_back(parse_window(window));
  Timings timings;
  const voxel::Scene scene = read_scan(program, text.scan, text.in, timings);
  for (const std::string& window : text.windows) need_hounsfield(window, scene);
  Json json{{"source", text.scan.string()}, {"unit", voxel::unit(scene)}};
  if (text.otsu) {
    std::vector<double> thresholds;
    json["suggestion"] = suggestion_of(scene, *text.otsu, thresholds, timings);
    windows.push_back(class_window(thresholds, text.otsu_class.value_or(*text.otsu)));
  }
  std::string written;
  if (!text.out.empty()) {
    const voxel::Universe universe =
        is_octree(text.out) ? universe_of(scene.lattice, text.voxel_mm) : voxel::universe_on(scene.lattice);
    const std::vector<Segment> segments = segments_of(program, text, scene, universe, windows, timings);
    write_segments(program, text, scene, segments, timings, json);
    json["objects"] = Json::array();
    for (const Segment& each : segments) json["objects"].push_back(said_of(each));
    written = text.out.string();
  }
  if (!text.contours.empty()) {
    if (windows.empty())
      throw CLI::ValidationError("--contours", "follow the lower bound of a --window: give it");
    json["contours"] = write_contours(program, text, scene, windows.front().low, timings);
    written += (written.empty() ? "" : ", ") + text.contours.string();
  }
  Json whole = answer(timings);
  for (const auto& [key, value] : json.items())
    if (key != "octotomy" && key != "timings_ms") whole[key] = value;
  for (const Json& finding : json.value("findings", Json::array())) warn(finding.get<std::string>());
  std::vector<std::pair<std::string, std::string>> rows;
  if (!written.empty()) rows.emplace_back("written", written);
  if (json.contains("suggestion")) rows.emplace_back("thresholds", json["suggestion"]["thresholds"].dump());
  for (const Json& object : json.value("objects", Json::array()))
    rows.emplace_back(object["name"].get<std::string>(),
                      grouped(object["volume_mm3"].get<double>(), 1) + " mm\u00b3");
  program.say(whole, lines(rows));
  return done;
}

}  // namespace

void add_segment(Program& program) {
  const auto text = std::make_shared<SegmentText>();
  CLI::App& verb = program.verb(
      "segment",
      "Makes objects of a scan: by window or tissue, by suggestion, from seeds; parts chosen, filled",
      "octotomy segment head.nrrd -o skull.octree --window bone --largest\n"
      "  octotomy segment head.nrrd -o tissues.nii.gz --window bone --window soft_tissue --window fat\n"
      "  octotomy segment head.nrrd --otsu 3 --json\n"
      "  octotomy segment tissues.nii.gz -o fat.octree --label 3\n"
      "  octotomy segment head.nrrd --window bone --contours skull.json",
      [&program, text] { return segment(program, *text); });
  std::string names;
  for (const voxel::Tissue& tissue : voxel::tissues())
    names += (names.empty() ? "" : ", ") + std::string(tissue.name);
  verb.add_option("scan", text->scan, "A scan, or with --label a label map")->required()->check(scan_path());
  verb.add_option(
      "-o,--out", text->out,
      "An .octree file for one object, or a label map (.nrrd, .nii.gz, .mha) on the scan's lattice");
  verb.add_option("--window", text->windows,
                  "LOW:HIGH or LOW: in sample units, or a tissue: " + names + "; again for more objects")
      ->expected(1)
      ->take_all();
  verb.add_option("--otsu", text->otsu,
                  "Parts the samples into N classes of least variance; the object is one of them")
      ->check(CLI::Range(2, 8))
      ->type_name("N");
  verb.add_option("--class", text->otsu_class,
                  "Which of the classes, from 1, the darkest; default: the brightest")
      ->check(CLI::Range(1, 8))
      ->type_name("K");
  verb.add_option("--tolerance", text->tolerance,
                  "Grows from the seeds through samples no farther from theirs")
      ->check(between(0.0, 65535.0));
  verb.add_option("--label", text->label, "The object of that number in a label map")
      ->check(CLI::Range(1, 32767));
  verb.add_option("--object", text->objects, "An .octree file to be put into the label map, again for more")
      ->expected(1)
      ->take_all()
      ->check(CLI::ExistingFile);
  const std::string group = "then, in this order";
  verb.add_option("--regions", text->regions,
                  "Keeps what lies within regions drawn on slices, a JSON file as mask --slices reads")
      ->check(CLI::ExistingFile)
      ->group(group);
  verb.add_option("--open", text->open_mm, "Takes away what a ball of that radius, mm, does not reach inside")
      ->check(above_zero())
      ->group(group);
  verb.add_option("--seed", text->seeds, "Keeps the parts that hold X,Y,Z in mm, again for more")
      ->expected(1)
      ->take_all()
      ->group(group);
  verb.add_flag("--largest", text->largest, "Keeps the largest part")->group(group);
  verb.add_option("--components", text->components,
                  "Keeps the N largest parts, and those as large as the Nth")
      ->check(CLI::Range(1, 1000000))
      ->type_name("N")
      ->group(group);
  verb.add_option("--at-least", text->at_least_mm3, "Keeps the parts of so many mm\u00b3")
      ->check(above_zero())
      ->group(group);
  verb.add_option("--close", text->close_mm, "Closes gaps that a ball of that radius, mm, does not pass")
      ->check(above_zero())
      ->group(group);
  verb.add_flag("--fill", text->fill, "Fills cavities")->group(group);
  verb.add_option("--neighbours", text->neighbours, "Parts touch by faces (6), edges (18) or corners (26)")
      ->check(CLI::IsMember({6, 18, 26}))
      ->capture_default_str();
  verb.add_option(
      "--contours", text->contours,
      "Writes the contours of the first window's lower bound on every slice, a JSON file of regions");
  verb.add_option("--voxel", text->voxel_mm,
                  "Edge of an octree's voxels, mm; default: as fine as the scan, at most 512 a side")
      ->check(above_zero());
  add_scan_options(verb, text->in);
}

}  // namespace octotomy::planner::cli
