// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes the contours in which parallel planes cut an object, a mesh or a scan's window, as a file that the operation
// tile and masks read.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <utility>

#include "brep/contour/contour.h"
#include "brep/mesh/mesh.h"
#include "brep/mesh/mesh_point.h"
#include "convert/surface/expression_surface.h"
#include "convert/surface/isosurface.h"
#include "convert/surface/partial_surface.h"
#include "planner/operation/file/mesh_file.h"
#include "planner/operation/file/outputs.h"
#include "planner/operation/file/path_checks.h"
#include "planner/operation/file/plane_contours.h"
#include "planner/operation/file/slice_contours.h"
#include "planner/operation/file/step_on_files.h"
#include "planner/operation/measure/result_json.h"
#include "planner/operation/table/json_file.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"
#include "voxel/space/error.h"
#include "voxel/space/view.h"

namespace octotomy::planner {
namespace {

struct Outline {
  ObjectName file;
  std::string view = "inferior";
  std::vector<double> at_mm;
  std::optional<double> from_mm, to_mm;
  double every_mm = 2.0, thin_mm = 0.0;
  std::filesystem::path out;
  std::optional<SampleWindow> window;  ///< of the verb

  std::vector<std::string> inputs() const { return {file.name}; }
};

constexpr std::size_t most_planes = 5000;

void check(const Outline& outline, const FieldLocation& place) {
  try {
    voxel::parse_view(outline.view);
  } catch (const voxel::InvalidInput& error) {
    place.at("view").refuse(error.what());
  }
  if (outline.from_mm && outline.to_mm && !(*outline.from_mm < *outline.to_mm))
    place.at("to_mm").refuse("must be larger than 'from_mm': exchange the two");
  if (!outline.at_mm.empty() && (outline.from_mm || outline.to_mm))
    place.at("at_mm").refuse("already states all planes: leave 'from_mm' and 'to_mm' out");
  if (place.scope == nullptr) return;
  check_output_path(outline.out, {".json"}, place.at("path"));
}

/// Cuts an object by planes perpendicular to a view, within the range of positions in which the object lies.
struct Cutter {
  std::function<PlaneContours(const ViewPlane& plane)> cut;
  double low_mm = std::numeric_limits<double>::infinity(), high_mm = -low_mm;
  /// The number of contours in all planes so far that ended at the border of an open surface.
  std::shared_ptr<std::size_t> open = std::make_shared<std::size_t>(0);

  void add(double position_mm) {
    low_mm = std::min(low_mm, position_mm);
    high_mm = std::max(high_mm, position_mm);
  }
};

Cutter cutter_of(brep::Mesh surface, const voxel::View& view) {
  Cutter cutter;
  for (const auto v : surface.vertices()) cutter.add(glm::dot(brep::glm_of(surface.point(v)), view.look));
  cutter.cut = [surface = std::move(surface), open = cutter.open](const ViewPlane& plane) {
    return contours_in_plane(surface, plane, open.get());
  };
  return cutter;
}

/// The surface of an .octree file.
brep::Triangles surface_of(const std::string& file, const FileBench& bench,
                           const std::optional<SampleWindow>& window) {
  const voxel::OctreeFile octree = octree_named(file, bench);
  if (const auto* grey = std::get_if<voxel::GreyOctree>(&octree.tree)) {
    if (!window)
      throw std::runtime_error(
          "--window: choose the samples that the contours outline, for example --window 300: (300 and "
          "above)");
    return convert::isosurface(*grey, window->low, window->high_or_infinity());
  }
  if (window)
    throw std::runtime_error(file + ": contains no samples, so --window does not apply: leave it out");
  if (const auto* partial = std::get_if<voxel::PartialOctree>(&octree.tree))
    return convert::isosurface(*partial);
  const auto& binary = std::get<voxel::Octree>(octree.tree);
  return convert::isosurface(binary.universe(), binary);
}

Cutter cutter_of(const Outline& outline, const FileBench& bench, const voxel::View& view,
                 std::vector<std::string>& findings) {
  const std::string& file = outline.file.name;
  if (bench.step != nullptr || is_mesh(file)) {
    if (outline.window)
      throw std::runtime_error(file + ": is a mesh, to which --window does not apply: leave it out");
    return cutter_of(bench.step != nullptr ? brep::mesh_of(triangles_named(file, bench))
                                           : read_surface(file, bench.timings, &findings),
                     view);
  }
  if (is_octree(file)) return cutter_of(brep::mesh_of(surface_of(file, bench, outline.window)), view);
  if (!outline.window)
    throw std::runtime_error(
        "--window: choose the samples that the contours outline, for example --window 300: or --window skin");
  const SampleWindow window = *outline.window;
  auto scene = std::make_shared<const voxel::Scene>(bench.read_scan(file));
  need_hounsfield(window, *scene);
  Cutter cutter;
  const voxel::Box box = voxel::bounds(scene->lattice);
  for (int corner = 0; corner < 8; ++corner)
    cutter.add(glm::dot(
        glm::dvec3(corner & 1 ? box.high_mm.x : box.low_mm.x, corner & 2 ? box.high_mm.y : box.low_mm.y,
                   corner & 4 ? box.high_mm.z : box.low_mm.z),
        view.look));
  cutter.cut = [scene, window](const ViewPlane& plane) {
    return contours_in_plane(*scene, window.low, window.high_or_infinity(), plane);
  };
  return cutter;
}

/// The positions of the planes: the stated ones, or multiples of the distance, so that the planes of several
/// objects coincide.
std::vector<double> positions_of(const Outline& outline, const Cutter& cutter) {
  if (!outline.at_mm.empty()) {
    std::vector<double> positions = outline.at_mm;
    std::sort(positions.begin(), positions.end());
    if (std::adjacent_find(positions.begin(), positions.end()) != positions.end())
      throw std::runtime_error("at_mm: has a position twice");
    return positions;
  }
  const double low_mm = outline.from_mm.value_or(cutter.low_mm),
               high_mm = outline.to_mm.value_or(cutter.high_mm);
  const double first = std::ceil(low_mm / outline.every_mm), last = std::floor(high_mm / outline.every_mm);
  if (last - first >= static_cast<double>(most_planes))
    throw std::runtime_error("every_mm: makes more than " + std::to_string(most_planes) +
                             " planes: choose a larger distance, or state 'from_mm' and 'to_mm'");
  std::vector<double> positions;
  for (double k = first; k <= last; ++k) positions.push_back(k * outline.every_mm);
  return positions;
}

/// The slices with contours. At either end an empty slice marks where the object ends.
voxel::SliceMask cut_in(const Outline& outline, const Cutter& cutter, const voxel::View& view) {
  voxel::SliceMask mask;
  mask.view = view;
  for (const double position_mm : positions_of(outline, cutter))
    mask.slices.push_back({position_mm, cutter.cut({view, position_mm})});
  const auto is_empty = [](const auto& slice) { return slice.polygons_mm.empty(); };
  while (!mask.slices.empty() && is_empty(mask.slices.back())) mask.slices.pop_back();
  while (!mask.slices.empty() && is_empty(mask.slices.front())) mask.slices.erase(mask.slices.begin());
  if (mask.slices.empty())
    throw std::runtime_error(outline.file.name + ": no plane meets the object, which reaches from " +
                             plain(std::round(100.0 * cutter.low_mm) / 100.0) + " to " +
                             plain(std::round(100.0 * cutter.high_mm) / 100.0) +
                             " mm along the view: choose planes within this range, nearer together");
  const double end_mm =
      mask.slices.size() > 1 ? mask.slices[1].position_mm - mask.slices[0].position_mm : outline.every_mm;
  mask.slices.insert(mask.slices.begin(), {mask.slices.front().position_mm - end_mm, {}});
  mask.slices.push_back({mask.slices.back().position_mm + end_mm, {}});
  return mask;
}

FileAnswer on_files(const Outline& outline, const FileBench& bench) {
  need_extension(outline.out, {".json"}, "contours are");
  if (bench.step == nullptr) need_outputs({outline.out}, {outline.file.name});
  const voxel::View view = voxel::parse_view(outline.view);
  std::vector<std::string> findings;
  const Cutter cutter = cutter_of(outline, bench, view, findings);
  voxel::SliceMask mask = [&] {
    const Stopwatch watch(bench.timings, "cut");
    return cut_in(outline, cutter, view);
  }();
  if (*cutter.open > 0)
    findings.push_back(
        outline.file.name + ": the surface is open, and " + std::to_string(*cutter.open) +
        " contours that end at its border were left out: close the surface by octotomy repair --solid");
  Refinement thinning;
  thinning.thin_mm = outline.thin_mm;
  if (outline.thin_mm > 0.0) mask = refined(mask, thinning, findings);
  Outputs outputs;
  outputs.write(outline.out, [&](const std::filesystem::path& hidden) { write_json(to_json(mask), hidden); });
  outputs.commit();
  std::size_t contours = 0, points = 0;
  Json slices = Json::array();
  for (const auto& slice : mask.slices) {
    double area_mm2 = 0.0;
    std::vector<brep::Contour> lines;
    for (const auto& polygon : slice.polygons_mm) lines.push_back({polygon});
    const std::vector<std::size_t> depth = brep::depths(brep::nest(lines));
    for (std::size_t i = 0; i < lines.size(); ++i) {
      area_mm2 += (depth[i] % 2 == 1 ? -1.0 : 1.0) * std::abs(brep::signed_area_mm2(lines[i]));
      points += lines[i].points_mm.size();
    }
    contours += lines.size();
    slices.push_back(
        {{"position_mm", slice.position_mm}, {"contours", lines.size()}, {"area_mm2", area_mm2}});
  }
  return {{{"path", outline.out.string()},
           {"view", outline.view},
           {"contours", contours},
           {"points", points},
           {"slices", slices},
           {"findings", findings}},
          {{"written", outline.out.string()},
           {"slices", grouped(static_cast<double>(mask.slices.size()), 0)},
           {"contours", grouped(static_cast<double>(contours), 0)},
           {"points", grouped(static_cast<double>(points), 0)}},
          findings};
}

}  // namespace

Operation outline_operation() {
  return Describe<Outline>("outline", "Writes the contours in which parallel planes cut an object.",
                           Makes::File)
      .takes(field("object", &Outline::file,
                   "The object; of the verb a mesh, an .octree file, or a scan with a window.")
                 .required()
                 .positional("file"))
      .takes(field("view", &Outline::view,
                   "The view perpendicular to the planes: its name, or AZ,EL in degrees."))
      .takes(
          field("at_mm", &Outline::at_mm, "Positions of the planes along the view's direction of sight, mm.")
              .comma_separated())
      .takes(field(
          "from_mm", &Outline::from_mm,
          "Instead of at_mm: the position at which planes begin. Default: the beginning of the object."))
      .takes(field("to_mm", &Outline::to_mm,
                   "The position at which planes end. Default: the end of the object."))
      .takes(field("every_mm", &Outline::every_mm,
                   "The distance between planes, which lie at multiples of this distance.")
                 .greater_than(0.0)
                 .to(1000.0)
                 .read_if<Outline>([](const Outline& outline) { return outline.at_mm.empty(); },
                                   "applies only if 'at_mm' states no planes: leave 'at_mm' out"))
      .takes(field("thin_mm", &Outline::thin_mm, "Removes points within this distance of a straight piece.")
                 .from(0.0)
                 .to(1e6))
      .takes(field("path", &Outline::out,
                   "A .json file of regions on slices, in the form that masks and tile read.")
                 .required()
                 .called("out"))
      .verb_takes(field("window", &Outline::window,
                        "For a scan or grey octree: LOW:HIGH or LOW: in sample units, or a tissue."))
      .reads_scans()
      .example(
          R"({"id": "lines", "do": "outline", "object": "skull", "view": "left", "every_mm": 5, "path": "skull.json"})")
      .on_files(
          "octotomy outline skull.stl --view left --every 5 -o skull.json\n"
          "  octotomy outline head.nrrd --window 300: --view 35,15 --at=-20,0,20 -o oblique.json\n"
          "  octotomy mesh skull.json -o tiled.stl",
          on_files)
      .check(check)
      .write(write_step<Outline, on_files>);
}

}  // namespace octotomy::planner
