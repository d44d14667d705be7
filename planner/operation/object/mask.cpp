// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/object/mask.h"

#include <array>
#include <charconv>
#include <cmath>
#include <numbers>

#include "brep/boolean/boolean.h"
#include "brep/mesh/move.h"
#include "brep/shape/prism.h"
#include "planner/operation/file/contour_findings.h"
#include "planner/operation/file/region_file.h"
#include "planner/operation/file/slicer_markup.h"
#include "planner/operation/object/mask_file.h"
#include "planner/operation/object/provenance.h"
#include "planner/operation/object/tiled_slices.h"
#include "planner/operation/table/fault.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"
#include "planner/operation/table/same_patient.h"
#include "verify/witness/witness.h"
#include "voxel/solid/region_mask.h"
#include "voxel/space/error.h"
#include "voxel/space/view.h"

namespace octotomy::planner {
namespace {

voxel::RegionMask mask_of(const Mask& mask) {
  voxel::RegionMask made;
  for (const Mask::Region& region : mask.regions)
    made.regions.push_back({voxel::parse_view(region.view), region.polygons_mm});
  return made;
}

/// The prism of a region. It extends beyond the universe by more than the universe's size, so that neither
/// end of the prism lies in the universe, even after a motion.
brep::Prism prism_of(const Mask::Region& region, const glm::dvec3& low_mm, const glm::dvec3& high_mm) {
  const voxel::View view = voxel::parse_view(region.view);
  const double size_mm = glm::length(high_mm - low_mm);
  const double middle_mm = glm::dot(view.look, (low_mm + high_mm) * 0.5);
  return {view.look,
          view.up,
          view.right,
          region.polygons_mm,
          middle_mm - 1.6 * size_mm,
          middle_mm + 1.6 * size_mm};
}

/// The motion from the scan's views to the mask's views; none if they are the same.
std::optional<glm::dmat4> held(const Mask& mask, const Objects& objects) {
  if (mask.views_of == "scan" || objects.lps_from_head == glm::dmat3(1.0)) return std::nullopt;
  return glm::dmat4(objects.lps_from_head);
}

bool has_regions(const Mask& mask) {
  return !mask.regions.empty() || !mask.planes.empty();
}

/// The paths of the mask's files of curves and planes.
std::vector<std::string> files_of(const Mask& mask) {
  std::vector<std::string> files = mask.planes;
  for (const Mask::Region& region : mask.regions)
    files.insert(files.end(), region.curves.begin(), region.curves.end());
  return files;
}

/// The name of a horizontal view in which the plane is seen edge-on; "anterior" if the plane is horizontal.
std::string view_along(const glm::dvec3& normal) {
  const double level = std::hypot(normal.x, normal.y);
  if (level < 1e-12) return "anterior";
  // The view has look = z x normal, and a look is (-sin azimuth, cos azimuth, 0).
  const double azimuth_deg = std::atan2(normal.y, normal.x) * 180.0 / std::numbers::pi;
  const std::array<std::pair<double, const char*>, 5> named{
      {{0.0, "anterior"}, {90.0, "left"}, {-90.0, "right"}, {180.0, "posterior"}, {-180.0, "posterior"}}};
  for (const auto& [at_deg, name] : named)
    if (azimuth_deg == at_deg) return name;
  std::array<char, 32> text{};
  return std::string(text.data(), std::to_chars(text.data(), text.data() + text.size(), azimuth_deg).ptr) +
         ",0";
}

/// The half-space on the side of a plane to which its normal points, as a region.
Mask::Region region_of(const glm::dvec3& origin_mm, const glm::dvec3& normal) {
  constexpr double far_mm = 2e3;
  Mask::Region region{view_along(normal), {}, {}};
  const voxel::View view = voxel::parse_view(region.view);
  const glm::dvec2 at = view.project(origin_mm), into = glm::normalize(view.project(normal));
  const glm::dvec2 along(-into.y, into.x);
  const glm::dvec2 ahead = 2.0 * far_mm * into, aside = far_mm * along;
  region.polygons_mm = {{at - aside, at + aside, at + aside + ahead, at - aside + ahead}};
  return region;
}

void check(const Mask& mask, const FieldLocation& place) {
  const char* const of_set = "applies only to a structure set: add the set as 'slices'";
  if (mask.slices.empty() && !mask.structure.empty()) place.at("structure").refuse(of_set);
  if (mask.slices.empty() && mask.bridge_mm) place.at("bridge_mm").refuse(of_set);
  if (mask.slices.empty() && mask.other_identity) place.at("other_identity").refuse(of_set);
  if (place.scope == nullptr) return;
  if (!has_regions(mask) && mask.slices.empty())
    place.refuse("'regions' is missing: add 'regions', 'planes' or 'slices'");
  if (!has_regions(mask)) return;
  for (std::size_t i = 0; i < mask.regions.size(); ++i)
    if (mask.regions[i].polygons_mm.empty() && mask.regions[i].curves.empty())
      place.at("regions[" + std::to_string(i) + "]")
          .refuse("'polygons_mm' is missing: add it, or name files of closed curves as 'curves'");
  std::size_t index = 0;
  for (const Mask::Region& region : mask.regions) try {
      voxel::parse_view(region.view);
      ++index;
    } catch (const voxel::InvalidInput& error) {
      place.at("regions[" + std::to_string(index) + "]").at("view").refuse(error.what());
    }
  for (const std::string& file : files_of(mask))
    if (!std::filesystem::exists(place.scope->folder() / file)) return;
  Mask read;
  try {
    read = with_files_read(mask, place.scope->folder(), glm::dmat3(1.0));
  } catch (const std::exception& error) {
    rethrow_at(place.where + ": ", error);
  }
  try {
    voxel::check(mask_of(read));
    for (const Mask::Region& region : read.regions)
      brep::solid_of(prism_of(region, glm::dvec3(0.0), glm::dvec3(1.0)));
  } catch (const std::invalid_argument& error) {
    if (fault_of(error) != Fault::Input) throw;
    place.at("regions").refuse(error.what());
  }
}

std::string definition(const Mask& mask, const Objects&) {
  std::string views;
  for (const Mask::Region& region : mask.regions)
    views += (views.empty() ? "regions in " : ", ") + region.view;
  for (const std::string& plane : mask.planes)
    views += (views.empty() ? "beyond " : ", beyond ") + std::filesystem::path(plane).filename().string();
  if (mask.slices.empty()) return views;
  return views + (views.empty() ? "" : ", ") +
         (mask.structure.empty() ? "slices" : "'" + mask.structure + "'") + " of " +
         mask.slices.filename().string();
}

/// The scan on which slices were drawn, among the scans that no step made. For a structure set it is the
/// first of the scans whose identity agrees best, because a plan may read several scans. For other files it
/// is the only scan; null if there are several or none.
const ScanRecord* drawn_on(const std::optional<voxel::Identity>& of_set,
                           const std::vector<ScanRecord>& scans) {
  const ScanRecord* nearest = nullptr;
  voxel::Verdict best = voxel::Verdict::Fail;
  for (const ScanRecord& scan : scans) {
    if (!scan.made_by.empty()) continue;
    if (!of_set && nearest != nullptr) return nullptr;
    const voxel::Verdict verdict =
        of_set ? identity_finding({scan.name, scan.identity}, {"", *of_set}).verdict : voxel::Verdict::Fail;
    if (nearest != nullptr && verdict >= best) continue;
    nearest = &scan;
    best = verdict;
  }
  return nearest;
}

/// Findings on the agreement of slices with the scan on which they were drawn. Throws if they state another
/// patient.
std::vector<std::string> findings_of_slices(const Mask& mask, const DrawnSlices& drawn,
                                            const std::vector<ScanRecord>& scans) {
  std::vector<std::string> findings;
  if (const ScanRecord* const scan = drawn_on(drawn.identity, scans)) {
    const std::string file = mask.slices.generic_string();
    if (drawn.identity)
      findings = need_same_patient({"scan '" + scan->name + "'", scan->identity}, {file, *drawn.identity},
                                   mask.other_identity, "\"other_identity\": true");
    if (auto beyond = beyond_scan(drawn.mask, scan->lattice, file)) findings.push_back(std::move(*beyond));
    if (drawn.identity)
      if (auto lacking = slices_without_contours(drawn.mask, scan->lattice, file))
        findings.push_back(std::move(*lacking));
  }
  findings.insert(findings.end(), drawn.findings.begin(), drawn.findings.end());
  return findings;
}

void voxels(const Mask& typed, const VoxelBench& bench, VoxelSide& made) {
  const Mask mask = with_files_read(typed, bench.folder, bench.objects.lps_from_head, made.findings);
  if (!mask.regions.empty()) made.symbol = voxel::Expression(mask_of(mask));
  if (const auto turned = held(mask, bench.objects); turned && made.symbol)
    made.symbol = moved(*made.symbol, *turned);
  if (!mask.slices.empty()) {
    DrawnSlices drawn =
        read_slices(bench.folder / mask.slices, SlicesOptions{mask.structure, mask.bridge_mm});
    const auto found = findings_of_slices(mask, drawn, bench.scans);
    made.findings.insert(made.findings.end(), found.begin(), found.end());
    if (auto cut = cut_at_cube(drawn.mask, bench.universe, mask.slices.generic_string()))
      made.findings.push_back(*cut +
                              "; the cube contains all of the plan's scans, so check that the contours "
                              "belong to one of these scans");
    const voxel::Expression slices = std::move(drawn.mask);
    made.symbol = made.symbol ? *made.symbol & slices : slices;
  }
  made.octree = bench.combined(*made.symbol);
  made.lineage = "regions projected at voxel centres";
  if (made.octree.is_empty())
    throw std::runtime_error(
        "the mask contains no voxel: its regions have no common part, are thinner than a voxel, or lie "
        "outside of the universe, which spans " +
        plain(bench.box_mm()) + ": draw regions that overlap within the universe");
}

/// The intersection of the regions' prisms; none if there are no regions.
std::optional<brep::Solid> solid_of_regions(const Mask& mask, const MeshBench& bench, MeshSide& made) {
  std::optional<brep::Solid> solid;
  for (const Mask::Region& region : mask.regions) {
    brep::Solid prism = brep::solid_of(prism_of(region, bench.low_mm, bench.high_mm));
    if (!solid) {
      solid = std::move(prism);
      continue;
    }
    brep::BooleanResult met =
        brep::boolean(*solid, brep::Operation::Intersection, prism, bench.progress.stop);
    made.shift_mm += met.shift_mm;
    solid = std::move(met.solid);
  }
  if (!solid) return solid;
  const auto turned = held(mask, bench.objects);
  return turned ? brep::moved(*solid, *turned) : *solid;
}

void triangles(const Mask& typed, const MeshBench& bench, MeshSide& made) {
  const Mask mask = with_files_read(typed, bench.folder, bench.objects.lps_from_head);
  std::optional<brep::Solid> tiles;
  if (!mask.slices.empty()) {
    const Stopwatch watch(bench.timings, "tile");
    tiles = tiled_slices(
                read_slices(bench.folder / mask.slices, SlicesOptions{mask.structure, mask.bridge_mm}).mask,
                brep::TileCost::shortest_span, bench.progress.stop)
                .solid;
  }
  const Stopwatch watch(bench.timings, "boolean_mesh");
  const std::optional<brep::Solid> prisms = solid_of_regions(mask, bench, made);
  if (prisms && tiles) {
    brep::BooleanResult met =
        brep::boolean(*prisms, brep::Operation::Intersection, *tiles, bench.progress.stop);
    made.shift_mm += met.shift_mm;
    made.whole = std::move(met.solid);
  } else {
    made.whole = prisms ? *prisms : *tiles;
  }
  made.lineage = !tiles   ? "prisms of the regions"
                 : prisms ? "prisms of the regions, and tiled slices"
                          : "tiled slices";
}

void bound_regions(const Mask& mask, const BoundBench& bench, Object& made) {
  const auto turned = held(mask, bench.objects);
  if (!turned) made.bound.planes = planes_of(mask_of(mask));
  std::vector<verify::DrawnRegion> drawn;
  for (const Mask::Region& region : mask.regions) drawn.push_back({region.view, region.polygons_mm});
  made.witness = verify::witness_of_regions(drawn);
  if (turned) made.witness = verify::carried(made.witness, *turned);
}

void bound(const Mask& typed, const BoundBench& bench, Object& made) {
  std::vector<std::string> findings;
  const Mask mask = with_files_read(typed, bench.folder, bench.objects.lps_from_head, findings);
  for (const std::string& finding : findings)
    if (finding.find(": WARN, ") != std::string::npos)
      made.caveats.push_back({voxel::Verdict::Warn, finding});
  if (!mask.regions.empty()) bound_regions(mask, bench, made);
  if (made.mesh.whole) made.walls = {{made.id, *made.mesh.whole}};
  if (mask.slices.empty()) return;
  const voxel::SliceMask drawn =
      read_slices(bench.folder / mask.slices, SlicesOptions{mask.structure, mask.bridge_mm}).mask;
  const std::vector<CutPlane> flat = planes_of(drawn);
  made.bound.planes.insert(made.bound.planes.end(), flat.begin(), flat.end());
  verify::Witness slices = witness_of(drawn);
  made.witness = mask.regions.empty() ? std::move(slices) : verify::both(made.witness, std::move(slices));
}

}  // namespace

Mask with_files_read(const Mask& mask, const std::filesystem::path& folder, const glm::dmat3& lps_from_head,
                     std::vector<std::string>& findings) {
  Mask read = mask;
  const glm::dmat3 lps_from_view = mask.views_of == "head" ? lps_from_head : glm::dmat3(1.0);
  for (Mask::Region& region : read.regions) {
    if (region.curves.empty()) continue;
    const voxel::View view = voxel::parse_view(region.view);
    for (const std::string& file : region.curves)
      for (auto& polygon :
           read_closed_curves(folder / file, lps_from_view * view.right, lps_from_view * view.up, findings))
        region.polygons_mm.push_back(std::move(polygon));
    region.curves.clear();
  }
  for (const std::string& file : read.planes) {
    const MarkupPlane plane = read_plane(folder / file, findings);
    const glm::dmat3 view_from_lps = glm::transpose(lps_from_view);
    read.regions.push_back(region_of(view_from_lps * plane.origin_mm, view_from_lps * plane.normal));
  }
  read.planes.clear();
  return read;
}

Mask with_files_read(const Mask& mask, const std::filesystem::path& folder, const glm::dmat3& lps_from_head) {
  std::vector<std::string> findings;
  return with_files_read(mask, folder, lps_from_head, findings);
}

Operation mask_operation() {
  return Describe<Mask>("mask", "Makes a volume of interest from regions that are drawn in views.",
                        Makes::Object)
      .takes(records("regions", &Mask::regions,
                     "The regions. The mask is the intersection of their back-projections.",
                     {field("view", &Mask::Region::view, "The view in which the region is drawn.").required(),
                      field("polygons_mm", &Mask::Region::polygons_mm,
                            "Closed polygons of points [u, v] in the view's millimetres."),
                      field("curves", &Mask::Region::curves,
                            "Files of 3D Slicer's closed curves, .mrk.json. Projected along the view, they "
                            "become polygons of the region.")
                          .a_file()})
                 .from(1)
                 .in_plans_only())
      .takes(field("planes", &Mask::planes,
                   "Files of 3D Slicer's planes, .mrk.json. The mask lies on the side to which their normals "
                   "point.")
                 .a_file()
                 .in_plans_only())
      .takes(field("views_of", &Mask::views_of,
                   "The frame of the views: the head's frame at its head position, or the scan's frame, "
                   "which a head position does not rotate.")
                 .one_of({"head", "scan"})
                 .in_plans_only())
      .takes(field("slices", &Mask::slices,
                   "A file of regions on parallel slices, {\"view\", \"slices\": [{\"position_mm\", "
                   "\"polygons_mm\"}]}, or a DICOM structure set. The mask lies within these regions, too.")
                 .a_file())
      .takes(field("structure", &Mask::structure,
                   "For a structure set: the name or ROI number of the structure to use."))
      .takes(field("bridge_mm", &Mask::bridge_mm,
                   "For a structure set: interpolates between planes of the structure up to this distance "
                   "apart. Default: the file's statement.")
                 .greater_than(0.0))
      .takes(field("other_identity", &Mask::other_identity,
                   "Accepts a structure set that states another patient, study or frame of reference than "
                   "the scan; a finding then begins with FAIL."))
      .verb_takes(
          field("region", &Mask::region_files,
                "VIEW:FILE, a region in a view; may be repeated. The mask is the intersection of the "
                "regions' back-projections. The file is JSON, an SVG drawing in mm, or closed curves of "
                "Slicer (.mrk.json). An SVG that is drawn over a .png of render or slice needs no view.")
              .repeated())
      .verb_takes(field("region_pixels", &Mask::region_pixels,
                        "PICTURE.png:X,Y X,Y X,Y, a region in pixels of a .png that render or slice wrote, "
                        "counted from its top left; may be repeated. A semicolon begins another polygon.")
                      .repeated()
                      .called("region-pixels"))
      .verb_takes(field("edit", &Mask::edit,
                        "The .octree file of a mask; the new mask is its part within the regions.")
                      .a_file())
      .verb_takes(field("like", &Mask::like, "A scan or .octree file that determines the mask's voxels."))
      .verb_takes(field("voxel_mm", &Mask::voxel_mm,
                        "Edge of the mask's voxels, mm. Default: that of the scan of --like, else 1.")
                      .greater_than(0.0))
      .verb_takes(field("out", &Mask::out, "An .octree file.").required())
      .on_files(
          "octotomy mask -o cut.octree --region anterior:front.json --region left:side.json --like "
          "head.nrrd\n"
          "  octotomy mask -o mandible.octree --slices rtstruct.dcm --structure Mandible --like ct\n"
          "  octotomy mask -o less.octree --edit cut.octree --region 35,15:oblique.json\n"
          "  octotomy mask -o cut.octree --region-pixels \"front.png:120,80 300,80 300,200\" --region "
          "left.svg\n"
          "A region's file: {\"polygons_mm\": [[[-40,-60],[40,-60],[40,-25],[-40,-25]]]}",
          mask_file)
      .example(R"({"id": "cut", "do": "mask", "regions": [
        {"view": "anterior", "polygons_mm": [[[-40, -60], [40, -60], [40, -25], [-40, -25]]]},
        {"view": "left", "polygons_mm": [[[-90, -60], [-20, -60], [-20, -25], [-90, -25]]]}]})")
      .tool()
      .of_head()
      .check(check)
      .object(definition, voxels, triangles, bound);
}

}  // namespace octotomy::planner
