// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/object/measure_file.h"

#include <limits>
#include <tbb/parallel_invoke.h>

#include "brep/io/write_mesh.h"
#include "brep/mesh/components.h"
#include "brep/mesh/health.h"
#include "brep/mesh/line_volume.h"
#include "brep/mesh/measure.h"
#include "brep/mesh/split_fans.h"
#include "brep/shape/repair.h"
#include "brep/shape/unite_shells.h"
#include "convert/surface/isosurface.h"
#include "planner/operation/file/mesh_file.h"
#include "planner/operation/file/mesh_in.h"
#include "planner/operation/file/octree_in.h"
#include "planner/operation/measure/measured_size.h"
#include "planner/operation/measure/recommended.h"
#include "planner/operation/measure/result_json.h"
#include "planner/operation/measure/surface_questions.h"
#include "planner/operation/measure/wall_thickness.h"
#include "planner/operation/object/provenance.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/plan_universe.h"
#include "voxel/filter/components.h"
#include "voxel/filter/label_map.h"
#include "voxel/measure/cell_counts.h"
#include "voxel/measure/flat_parts.h"
#include "voxel/measure/measure.h"
#include "voxel/solid/combine.h"
#include "voxel/solid/partial_volume.h"
#include "voxel/space/error.h"
#include "voxel/tree/grey_octree_build.h"
#include "voxel/tree/octree_file.h"

namespace octotomy::planner {
namespace {

/// The numbers of a measured size that the printed text contains.
struct FileSize {
  std::optional<double> volume_mm3, volume_half_width_mm3, volume_partial_mm3, area_mm2, area_half_width_mm2;
  std::string volume_estimator, area_estimator;
  std::optional<double> components, euler;
  std::optional<MeasuredInterval> volume, area;  ///< the recommended ones
  std::vector<std::string> findings;
};
constexpr auto members_of(const FileSize&) {
  using S = FileSize;
  return std::tuple(
      member("volume_mm3", &S::volume_mm3), member("volume_half_width_mm3", &S::volume_half_width_mm3),
      member("volume_partial_mm3", &S::volume_partial_mm3), member("area_mm2", &S::area_mm2),
      member("area_half_width_mm2", &S::area_half_width_mm2),
      member("volume_estimator", &S::volume_estimator), member("area_estimator", &S::area_estimator),
      member("components", &S::components), member("euler", &S::euler), member("volume", &S::volume),
      member("area", &S::area), member("findings", &S::findings));
}

FileAnswer said(Json json) {
  const auto size = record_of<FileSize>(json);
  const auto number = [](const std::optional<double>& value, int decimals) {
    return value ? grouped(*value, decimals) : "none";
  };
  std::vector<std::pair<std::string, std::string>> rows;
  const auto add_recommended = [&](const char* name, const std::optional<MeasuredInterval>& found) {
    if (found)
      rows.emplace_back(name, grouped(found->value, 1) + " \u00b1 " +
                                  three_figures(found->half_width.value_or(0.0)) +
                                  (found->unit == "mm3" ? " mm\u00b3" : " mm\u00b2") + " in 99 of 100 cases");
  };
  add_recommended("recommended volume", size.volume);
  add_recommended("recommended area", size.area);
  // The half-width of a single estimator is due to digitising alone and does not define an interval for the
  // true value; the text states this.
  const auto doubtful = [&](const std::optional<double>& value, const std::optional<double>& half_width,
                            const std::string& unit_and_estimator) {
    return number(value, 1) + unit_and_estimator +
           (half_width ? ", by digitising alone \u00b1 " + three_figures(*half_width) : "");
  };
  rows.insert(
      rows.end(),
      {{"volume",
        doubtful(size.volume_mm3, size.volume_half_width_mm3, " mm\u00b3, " + size.volume_estimator)},
       {"partial", number(size.volume_partial_mm3, 1) + " mm\u00b3"},
       {"area", doubtful(size.area_mm2, size.area_half_width_mm2, " mm\u00b2, " + size.area_estimator)},
       {"components", number(size.components, 0)},
       {"euler", number(size.euler, 0)}});
  const std::vector<std::pair<std::string, std::string>> asked = surface_rows(json);
  rows.insert(rows.end(), asked.begin(), asked.end());
  for (const std::string& text : size.findings)
    if (text.starts_with("volume_mm3: ") || text.starts_with("volume_lines_mm3: ") ||
        text.starts_with("WARN "))
      rows.emplace_back("finding", text);
  return {std::move(json), std::move(rows)};
}

/// Throws before any file is read if the requested file of scalars cannot be written.
void need_scalars_of(const Measure& asked) {
  if (!asked.thickness && !asked.curvature)
    throw std::runtime_error(asked.out.string() + ": choose the map to write by --thickness or --curvature");
  need_extension(asked.out, {".vtp", ".ply"}, "scalars are");
  need_folder_of(asked.out);
}

/// The requested measures of a closed mesh besides its size, as JSON. Also writes the file of scalars if one
/// is requested.
Json asked_of_surface(const Measure& asked, const brep::Solid& solid, const FileBench& bench) {
  const std::filesystem::path& out = asked.out;
  std::optional<brep::Mesh> other;
  if (asked.to) other = read_surface(asked.to->name, bench.timings);
  AtVertices shown;
  Json json = surface_answers({asked.section, asked.distance, asked.angle, asked.along,
                               other ? &*other : nullptr, asked.thickness, asked.curvature},
                              solid, bench.progress("thickness"), bench.timings, shown);
  if (out.empty()) return json;
  brep::VertexData data;
  data.scalar_name = shown.name;
  data.scalars = std::move(shown.values);
  write_surface(solid.triangles(), out, bench.timings, data);
  json["path"] = out.string();
  return json;
}

/// The volume along lines through an open surface, if only few lines pass holes.
std::optional<double> volume_by_lines_mm3(const brep::Triangles& triangles) {
  constexpr double most_open_share = 0.1;
  const brep::LineVolumes volumes = brep::line_volumes(triangles, {});
  const auto lines = static_cast<double>(volumes.lines), open = static_cast<double>(volumes.open_lines);
  if (!(open <= most_open_share * lines) || !(volumes.all.a_mm3 > 0.0)) return std::nullopt;
  return volumes.all.a_mm3 * lines / (lines - open);
}

/// Measures triangles that enclose nothing: their area and position.
FileAnswer measure_open(const brep::Triangles& triangles, const brep::Health& health) {
  if (health.faces == 0) throw std::runtime_error("there are no triangles to measure");
  const brep::Size size = brep::size_of(triangles);
  const bool is_inside_out = health.first_defect == brep::Defect::InsideOut;
  const std::optional<double> by_lines_mm3 = is_inside_out ? std::nullopt : volume_by_lines_mm3(triangles);
  std::vector<std::string> findings{
      is_inside_out
          ? "volume_mm3: none: " + health.findings.front() + "; octotomy repair --solid turns it outward"
          : "volume_mm3: null, because the surface is not closed, oriented and manifold: " +
                health.findings.front() + "; octotomy repair --solid closes it"};
  if (by_lines_mm3)
    findings.push_back("volume_lines_mm3: an estimate: " + grouped(*by_lines_mm3, 1) +
                       " mm\u00b3 along lines through the surface, including lines through its holes");
  return said({{"kind", "mesh"},
               {"volume_mm3", nullptr},
               {"volume_partial_mm3", nullptr},
               {"centroid_mm", nullptr},
               {"inertia_mm5", nullptr},
               {"volume_estimator",
                is_inside_out ? "none: the surface faces inward" : "none: the surface is not closed"},
               {"volume_lines_mm3", print_value(by_lines_mm3)},
               {"area_mm2", size.area_mm2},
               {"area_estimator", "triangles"},
               {"extents_mm", {to_json(size.low_mm), to_json(size.high_mm)}},
               {"components", health.components},
               {"euler", health.euler},
               {"findings", findings}});
}

/// With more shells than this, their union by Booleans would take minutes.
constexpr std::size_t most_united = 1000;

/// A closed surface, and how it was made from the given one, in which shells may share points and edges,
/// overlap, or lie in each other.
struct OneSurface {
  brep::Triangles triangles;
  std::string how;  ///< of the volume
};

/// The union of a surface's shells; their sum if they only touch. None if the surface stays open, is inside
/// out or has more than `most_united` shells, or if united_shells() finds no union.
std::optional<OneSurface> one_surface(const brep::Triangles& given, const brep::Health& health,
                                      const std::stop_token& stop) {
  if (health.closed && health.manifold && health.oriented && health.self_intersections == 0)
    return OneSurface{given, ""};
  if (health.first_defect == brep::Defect::InsideOut) return std::nullopt;
  const bool is_turned = health.misoriented_edges > 0;
  const bool is_split = !health.closed || !health.manifold || is_turned;
  brep::Triangles joined = is_turned ? brep::turned_alike(given).surface : given;
  if (is_split) joined = brep::joined_surface(std::move(joined)).surface;
  // After points were joined, shells may touch at these points.
  if (is_split) joined = brep::split_fans(joined).surface;
  const brep::Health now = is_split ? brep::health(joined, {.self_intersections = false}) : health;
  if (!now.closed || !now.manifold || now.misoriented_edges > 0 || now.shells > most_united)
    return std::nullopt;
  std::optional<brep::UnitedShells> united = brep::united_shells(joined, stop);
  // If the union's shells touch in a point, it is not manifold. Then the shells are used unchanged.
  if (!united && is_split && brep::health(joined).self_intersections == 0)
    return OneSurface{std::move(joined), ", of " + std::to_string(now.shells) + " shells that touch"};
  if (!united || united->surface.faces.empty()) return std::nullopt;
  return OneSurface{std::move(united->surface),
                    now.shells > 1 ? ", of the union of " + std::to_string(now.shells) + " shells"
                                   : ", of the surface after joining and orienting its triangles"};
}

FileAnswer measure_mesh(const std::filesystem::path& file, const Measure& asked, const FileBench& bench) {
  Timings& timings = bench.timings;
  brep::Triangles triangles;
  {
    const Stopwatch watch(timings, "read");
    triangles = read_mesh_in(file);
  }
  auto watch = std::make_unique<Stopwatch>(timings, "measure");
  const brep::Health health = brep::health(triangles);
  std::optional<OneSurface> one = one_surface(triangles, health, bench.stop);
  const bool is_sum = !one && health.closed && health.manifold && health.oriented;
  if (is_sum) one = OneSurface{triangles, ", summed over shells that may overlap"};
  if (!one) {
    if (asked.asks_surface() || !asked.out.empty())
      throw std::runtime_error(
          file.string() + ": is not a closed, oriented surface (" + health.findings.front() +
          "), which sections, walls and curvature need: mend it first by octotomy repair --solid");
    return measure_open(triangles, health);
  }
  const brep::Solid solid = brep::trusted_solid(std::move(one->triangles), brep::Proof::Connection);
  MeshSize size = size_of(solid.measures());
  size.volume_estimator += one->how;
  size.area_estimator = "triangles" + one->how;
  watch.reset();
  std::vector<std::string> findings{"volume_partial_mm3: null, because a mesh has no partly filled voxels"};
  if (!is_sum && !one->how.empty())
    findings.push_back("volume_mm3: the file is not a solid (" + health.findings.front() +
                       "), so the union of its closed shells was measured, after their triangles were joined "
                       "and oriented; the unchanged triangles enclose " +
                       grouped(brep::size_of(triangles).volume_mm3, 1) +
                       " mm\u00b3; octotomy repair --solid writes this union");
  if (is_sum)
    findings.push_back("WARN volume_mm3: " + std::to_string(health.self_intersections) +
                       " pairs of triangles cross each other, so overlapping parts count twice: unite them "
                       "by octotomy repair --solid");
  Json json{{"kind", "mesh"}};
  json.update(print_record(size));
  json.update(asked_of_surface(asked, solid, bench));
  json.update({{"volume_partial_mm3", nullptr},
               {"components", health.components},
               {"euler", health.euler},
               {"findings", findings}});
  return said(std::move(json));
}

/// Measures an object from its voxels only. Also stores the measures in `measures`.
Json of_voxels(const voxel::Octree& octree, Timings& timings, voxel::Measures& measures) {
  const Stopwatch watch(timings, "measure");
  measures = voxel::measure(octree);
  Json json = to_json(measures);
  json.update({{"components", voxel::component_count(octree)},
               {"euler", voxel::euler_numbers(octree).by_faces},
               {"euler_of", "voxels that touch by faces"},
               {"findings", Json::array()}});
  return json;
}

/// Another estimate of a size that was counted in voxels, with its texts for findings.
struct Seen {
  SeenSize size;
  std::string says, advice;
};

/// Adds the half-width of a count. The areas of flat parts are known.
void add_half_width(const voxel::Measures& measures, const Digitised& digitised,
                    const voxel::Lattice& lattice, const std::optional<Seen>& seen, Json& json) {
  const std::optional<SeenSize> size = seen ? std::optional(seen->size) : std::nullopt;
  const HalfWidth width = volume_half_width(measures, digitised, size);
  if (width.is_too_coarse)
    json["findings"].push_back(
        too_coarse_finding(digitised.voxel_mm, seen->says, size->volume_mm3, seen->advice));
  const verify::SizeIntervals recommended = intervals_of_count(measures, digitised, lattice, size);
  json.update({{"volume_half_width_mm3", width.value},
               {"volume_half_width_terms", to_json(width)},
               {"volume", print_record(measured(recommended.volume_mm3, "mm3"))},
               {"area", print_record(measured(recommended.area_mm2, "mm2"))}});
}

/// Adds the half-width of a count. The areas of flat parts are computed; the further arguments go to
/// volume_half_width().
void add_half_width(const voxel::Octree& octree, const voxel::Measures& measures,
                    const std::optional<double>& shift_mm, const std::optional<Seen>& seen, Json& json) {
  const voxel::Lattice lattice = octree.universe().lattice();
  add_half_width(measures, {lattice.spacing_mm(), {}, shift_mm, voxel::flat_parts_mm2(octree)}, lattice, seen,
                 json);
}

void add_partial_volume(const voxel::Window& window, Timings& timings, Json& json) {
  const Stopwatch watch(timings, "partial volume");
  json["volume_partial_mm3"] = nullptr;
  try {
    json["volume_partial_mm3"] = voxel::partial_volume_mm3(window);
    json["volume_partial_estimator"] = "trilinear interpolant of the samples";
  } catch (const voxel::InvalidInput& error) {
    json["findings"].push_back(std::string("volume_partial_mm3: ") + error.what());
  }
}

voxel::Window window_of(const voxel::GreyOctree& grey, const std::filesystem::path& file,
                        const Measure& asked) {
  if (!asked.window)
    throw std::runtime_error(
        file.string() + ": contains samples: choose a range by --window LOW:HIGH, for example --window 300:");
  return window_on(grey, *asked.window);
}

void add_thickness(const voxel::Octree& octree, const Measure& asked, const FileBench& bench, Json& json) {
  if (!asked.thickness) return;
  const Stopwatch watch(bench.timings, "thickness");
  json["thickness"] = thickness_json(octree, bench.progress("thickness"));
}

/// Advice in the finding that an object's voxels are too coarse.
constexpr const char* remake = "make the octree with smaller voxels, by --voxel";

FileAnswer measure_octree(const std::filesystem::path& file_path, const Measure& asked,
                          const FileBench& bench) {
  Timings& timings = bench.timings;
  const voxel::OctreeFile file = read_timed(file_path, timings);
  Json json;
  voxel::Measures measures;
  if (const auto* grey = std::get_if<voxel::GreyOctree>(&file.tree)) {
    const voxel::Window window = window_of(*grey, file_path, asked);
    const voxel::Octree inside = voxel::combine(grey->universe(), window);
    json = of_voxels(inside, timings, measures);
    add_partial_volume(window, timings, json);
    const Stopwatch watch(timings, "half_width");
    std::optional<Seen> seen;
    if (const Json& partial_mm3 = json["volume_partial_mm3"]; partial_mm3.is_number())
      seen = {{"interpolant", partial_mm3}, "the interpolant of its samples encloses", remake};
    add_half_width(inside, measures, window_shift_mm(window), seen, json);
    add_thickness(inside, asked, bench, json);
  } else if (asked.window) {
    throw std::runtime_error(file_path.string() +
                             ": contains no samples, so --window does not apply: leave it out");
  } else if (const auto* partial = std::get_if<voxel::PartialOctree>(&file.tree)) {
    const voxel::Octree half = voxel::at_least_half(*partial);
    json = of_voxels(half, timings, measures);
    const double shares_mm3 = voxel::volume_mm3(*partial);
    add_half_width(half, measures, {}, Seen{{"shares", shares_mm3}, "the voxels' filled shares are", remake},
                   json);
    add_thickness(half, asked, bench, json);
    json["volume_estimator"] = "voxels at least half filled, counted";
    json["volume_partial_mm3"] = shares_mm3;
    json["volume_partial_estimator"] = "the voxels' filled shares";
  } else {
    const auto& octree = std::get<voxel::Octree>(file.tree);
    json = of_voxels(octree, timings, measures);
    add_half_width(octree, measures, {}, {}, json);
    add_thickness(octree, asked, bench, json);
    json["volume_partial_mm3"] = nullptr;
    json["findings"].push_back(
        "volume_partial_mm3: null, because the filled shares of voxels are unknown: make an octree with "
        "samples (--grey) or shares (--digitise partial)");
  }
  Json whole{{"kind", "octree"}};
  whole["source"] = file_path.string();
  whole.update(json);
  return said(std::move(whole));
}

/// A scan and its octree, which is built while the scan is read.
struct ScanAndOctree {
  voxel::Scene scene;
  voxel::GreyOctree grey;
};

ScanAndOctree read_to_octree(const std::filesystem::path& file, const Measure& asked,
                             const FileBench& bench) {
  std::optional<voxel::GreyOctreeBuild> build;
  std::optional<voxel::GreyOctree> grey;
  std::optional<double> padding;  // padding as it was known when the build began
  bool has_failed = false;
  voxel::Scene scene = bench.read_scan(file, [&](const voxel::Scene& read, int count) {
    if (count == 0) return build.reset();
    if (has_failed || asked.voxel_mm) return;  // building with finer voxels takes long; a finding states this
    if (!std::holds_alternative<voxel::Int16Samples>(read.samples))
      return;  // the octree's step is not known
               // yet
    try {
      if (!build) {
        build.emplace(universe_of(read.lattice, asked.voxel_mm), read);
        padding = read.padding;
      }
      build->add(count);
      if (count == read.lattice.dims.z) grey = build->finished();
    } catch (...) {
      // This error of the build is ignored here. The octree is built again below, so that errors of the
      // reader are reported first.
      has_failed = true;
      build.reset();
    }
  });
  if (asked.window) need_hounsfield(*asked.window, scene);
  const Stopwatch watch(bench.timings, "octree");
  const voxel::Universe universe = universe_of(scene, asked.voxel_mm);
  if (!grey || !(grey->universe() == universe) || padding != scene.padding)
    grey = voxel::grey_octree_of(universe, scene, voxel::beyond_scan, bench.progress("octree"));
  return {std::move(scene), std::move(*grey)};
}

/// A scan's window, with the values computed from it.
struct WindowShown {
  const voxel::Scene& scene;
  double low = 0.0, high = 0.0;
  const brep::Solid& isosurface;
  const std::optional<verify::TwoPhase>& phases;
  const Digitised& digitised;
};

verify::SizeIntervals recommended_of(const WindowShown& shown) {
  const auto& [scene, low, high, isosurface, phases, digitised] = shown;
  const bool is_labels = scene.meaning == voxel::Meaning::Label;
  const SurfaceSamples source{.lps_from_scan = scene.lattice.lps_from_voxel,
                              .samples = std::shared_ptr<const voxel::Scene>(std::shared_ptr<void>(), &scene),
                              .window_shift_mm = digitised.shift_mm,
                              .along_lps_mm = digitised.sample_mm,
                              .low = low,
                              .high = high};
  verify::SizeIntervals found = isosurface.empty() ? verify::nothing_found(digitised.sample_mm)
                                                   : intervals_of_surface(isosurface, {source});
  if (phases) found = intervals_of_phases(*phases, std::move(found));
  if (is_labels && !isosurface.empty()) found = intervals_of_labels(scene, low, high, std::move(found));
  if (!is_labels && (!phases || phases->evidence.is_ambiguous))
    if (const auto thickness = thickness_of(scene, low, high)) add_thickness(*thickness, 1.0, found);
  add_voxels(digitised.voxel_mm, isosurface.size().area_mm2, found);
  return found;
}

FileAnswer measure_scan(const std::filesystem::path& file, const Measure& asked, const FileBench& bench) {
  Timings& timings = bench.timings;
  const auto read = read_to_octree(file, asked, bench);
  // References with short names, which lambdas can capture.
  const voxel::Scene& scene = read.scene;
  const voxel::GreyOctree& grey = read.grey;
  const voxel::Window window = window_of(grey, file, asked);
  const double low = asked.window->low;
  // Labels are names and are not interpolated. A voxel has the label of its nearest sample, and surfaces lie
  // half-way between samples.
  const bool is_labels = scene.meaning == voxel::Meaning::Label;
  const double high = asked.window->high_or_infinity();
  const std::optional<voxel::Scene> labelled =
      is_labels ? std::optional(indicator_of(scene, low, high)) : std::nullopt;
  const voxel::Octree inside = labelled ? voxel::octree_of_label(grey.universe(), *labelled, 1)
                                        : voxel::combine(grey.universe(), window);
  voxel::Measures measures;
  Json json = of_voxels(inside, timings, measures);
  if (labelled) {
    json["volume_partial_mm3"] = nullptr;
    json["findings"].push_back(
        "volume_partial_mm3: null, because labels are names and cannot be interpolated");
  } else {
    add_partial_volume(window, timings, json);
  }
  Digitised digitised{grey.universe().lattice().spacing_mm(), scene.lattice.spacing_mm()};
  brep::Solid isosurface;
  std::optional<verify::TwoPhase> phases;
  {
    const Stopwatch watch(timings, "isosurface");
    brep::Triangles triangles =
        labelled ? convert::isosurface(*labelled, 0.5, std::numeric_limits<double>::infinity())
                 : convert::isosurface(scene, low, high);
    // These run in parallel, because parts of each use only one thread.
    tbb::parallel_invoke(
        [&] { isosurface = brep::trusted_solid(std::move(triangles), brep::Proof::Construction); },
        [&] {
          if (!is_labels && !asked.window->high) phases = verify::two_phase(scene, low);
          digitised.flat_mm2 = voxel::flat_parts_mm2(inside);
        });
  }
  const Stopwatch watch(timings, "intervals");
  const brep::Size& surface = isosurface.size();
  if (!is_labels) digitised.shift_mm = window_shift_mm(scene, low, high);
  add_half_width(measures, digitised, grey.universe().lattice(),
                 Seen{{"isosurface", surface.volume_mm3, surface.area_mm2},
                      "the isosurface of the samples encloses",
                      "choose smaller voxels by --voxel"},
                 json);
  const bool is_of_phases = phases && !phases->evidence.is_ambiguous;
  const verify::SizeIntervals recommended = recommended_of({scene, low, high, isosurface, phases, digitised});
  for (const std::string& finding : findings_of(
           recommended, is_of_phases, is_of_phases && phases->evidence.has_core,
           {measures.volume_mm3, surface.volume_mm3}, {measures.area_crofton13_mm2, surface.area_mm2}))
    json["findings"].push_back(finding);
  if (const auto cut = cut_finding(cut_mm2(scene, low, high), surface.area_mm2))
    json["findings"].push_back(*cut);
  const HalfWidth width =
      area_half_width({recommended.triangles.area_mm2, recommended.triangles.curvature_mm}, digitised);
  json.update({{"area_half_width_mm2", width.value},
               {"area_half_width_terms", to_json(width)},
               {"volume", print_record(measured(recommended.volume_mm3, "mm3"))},
               {"area", print_record(measured(recommended.area_mm2, "mm2"))},
               {"area_crofton13_mm2", print_value(size_of(measures).area_mm2)},
               {"area_mm2", surface.area_mm2},
               {"area_estimator", mesh_area_estimator},
               {"volume_isosurface_mm3", surface.volume_mm3},
               {"euler", brep::euler_number(isosurface.triangles())},
               {"euler_of", "the isosurface: V - E + F"}});
  Json whole{{"kind", "scan"}};
  whole["window"] = {low, asked.window->high ? Json(high) : Json(nullptr)};
  whole.update(json);
  whole["audit"] = to_json(scene.audit);
  return said(std::move(whole));
}

/// Measures the distance of two points and the angle of three points, which need no file.
FileAnswer measure_points(const Measure& asked) {
  Json json{{"kind", "points"}};
  json.update(point_answers({.distance = asked.distance, .angle = asked.angle}));
  std::vector<std::pair<std::string, std::string>> rows = surface_rows(json);
  return {std::move(json), std::move(rows)};
}

}  // namespace

FileAnswer measure_file(const Measure& asked, const FileBench& bench) {
  if (!asked.object) {
    const bool needs_file = asked.to || !asked.section.empty() || !asked.along.empty() || asked.thickness ||
                            asked.curvature || asked.window || asked.voxel_mm || !asked.out.empty();
    if (needs_file || (asked.distance.empty() && asked.angle.empty()))
      throw std::runtime_error(
          "file is required: name a scan, an octree or a mesh; only --distance and --angle need no file");
    return measure_points(asked);
  }
  const std::filesystem::path file = asked.object->name;
  if (!asked.out.empty()) need_scalars_of(asked);
  const bool has_walls = is_mesh(file) || is_octree(file);
  if (((asked.asks_mesh() || asked.to) && !is_mesh(file)) || (asked.thickness && !has_walls))
    throw std::runtime_error(file.string() +
                             ": sections, paths, angles and curvature need a mesh, walls a mesh or an "
                             "octree: make a mesh by octotomy mesh");
  if (is_mesh(file) && (asked.window || asked.voxel_mm))
    throw std::runtime_error(file.string() + ": a mesh has no samples and no voxels: leave " +
                             (asked.window ? "--window" : "--voxel") + " out");
  if (is_octree(file)) return measure_octree(file, asked, bench);
  return is_mesh(file) ? measure_mesh(file, asked, bench) : measure_scan(file, asked, bench);
}

}  // namespace octotomy::planner
