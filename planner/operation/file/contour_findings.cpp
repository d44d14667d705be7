// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/file/contour_findings.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "planner/operation/table/number_format.h"
#include "voxel/solid/edge_tree.h"
#include "voxel/solid/polygon.h"
#include "voxel/solid/polygon_overlaps.h"

namespace octotomy::planner {
namespace {

/// Text such as "10, 12 and 3 more".
class Listed {
 public:
  void add(const std::string& word) {
    constexpr int most = 8;
    if (++count_ <= most)
      words_ += (words_.empty() ? "" : ", ") + word;
    else
      ++left_;
  }
  std::string text() const { return words_ + (left_ > 0 ? " and " + std::to_string(left_) + " more" : ""); }

 private:
  std::string words_;
  int count_ = 0, left_ = 0;
};

std::string contours(std::size_t count) {
  return std::to_string(count) + (count == 1 ? " contour" : " contours");
}

glm::dvec3 on_plane(const voxel::View& view, const glm::dvec2& p, double position_mm) {
  return p.x * view.right + p.y * view.up + position_mm * view.look;
}

/// A coordinate in mm as text, rounded to two decimals.
std::string hundredths(double mm) {
  return plain(std::round(100.0 * mm) / 100.0 + 0.0);
}

std::string place(const voxel::View& view, const glm::dvec2& p, double position_mm) {
  const glm::dvec3 at = on_plane(view, p, position_mm);
  return "near (" + hundredths(at.x) + ", " + hundredths(at.y) + ", " + hundredths(at.z) + ") mm";
}

/// Removes repeated contours of a plane except one of each, because the even-odd rule would delete them in
/// pairs. Adds a finding on them.
void take_once(voxel::SliceMask& mask, const std::string& where, std::vector<std::string>& findings) {
  std::size_t count = 0;
  std::string first;
  Listed planes;
  for (voxel::SliceMask::Slice& slice : mask.slices) {
    const std::vector<std::size_t> again = voxel::repeated_polygons(slice.polygons_mm, off_plane_mm());
    if (again.empty()) continue;
    if (count == 0) first = place(mask.view, slice.polygons_mm[again.front()].front(), slice.position_mm);
    count += again.size();
    planes.add(plain(slice.position_mm));
    const std::set<std::size_t> left(again.begin(), again.end());
    std::vector<std::vector<glm::dvec2>> kept;
    for (std::size_t i = 0; i < slice.polygons_mm.size(); ++i)
      if (!left.contains(i)) kept.push_back(std::move(slice.polygons_mm[i]));
    slice.polygons_mm = std::move(kept);
  }
  if (count > 0)
    findings.push_back(where + ": " + contours(count) + (count == 1 ? " repeats" : " repeat") +
                       " another contour of the same plane, so only one of them is used: planes at " +
                       planes.text() + " mm, first " + first);
}

/// Reports contours that cross. The even-odd rule leaves out the area that two contours both enclose. If one
/// contour lies within the other, that area is a hole. For contours that cross, DICOM's exclusive or has the
/// same effect (PS3.3, C.8.8.6.3), but other programs unite them.
void tell_crossings(const voxel::SliceMask& mask, const std::string& where,
                    std::vector<std::string>& findings) {
  std::size_t count = 0;
  std::string first;
  Listed planes, unknown;
  for (const voxel::SliceMask::Slice& slice : mask.slices) {
    const voxel::CrossingPolygons crossing = voxel::crossing_polygons(slice.polygons_mm, off_plane_mm());
    if (!crossing.is_complete) unknown.add(plain(slice.position_mm));
    if (crossing.all.empty()) continue;
    if (count == 0) first = place(mask.view, crossing.all.front().at_mm, slice.position_mm);
    count += crossing.all.size();
    planes.add(std::to_string(crossing.all.size()) + " at " + plain(slice.position_mm) + " mm");
  }
  if (count > 0)
    findings.push_back(where + ": " + contours(count) +
                       (count == 1 ? " crosses itself" : " cross another of the same plane or themselves") +
                       ", so parts enclosed twice are left out: " + planes.text() + ", first " + first +
                       "; if these parts belong to the structure, redraw the contours as one outline");
  if (!unknown.text().empty())
    findings.push_back(
        where +
        ": has too many edges on top of each other to find all contours that cross: check the planes at " +
        unknown.text() + " mm");
}

/// A corner of a contour in its view and in the voxels of a lattice.
struct Corner {
  glm::dvec2 p_mm;
  glm::dvec3 p_voxel;
};

/// The part of a closed line within a box of voxels, clipped at one side of the box after the other
/// (Sutherland and Hodgman, Comm. ACM 17, 1974). If the result has several parts, pairs of edges along the
/// box join them; these enclose no area.
std::vector<Corner> clipped(std::vector<Corner> line, const voxel::Lattice& box) {
  for (int side = 0; side < 6 && !line.empty(); ++side) {
    const int axis = side / 2;
    const double sign = side % 2 == 0 ? -1.0 : 1.0, end = side % 2 == 0 ? -0.5 : box.dims[axis] - 0.5;
    const auto beyond = [&](const Corner& corner) { return sign * (corner.p_voxel[axis] - end); };
    std::vector<Corner> within;
    for (std::size_t i = 0; i < line.size(); ++i) {
      const Corner& a = line[i == 0 ? line.size() - 1 : i - 1];
      const Corner& b = line[i];
      const double at_a = beyond(a), at_b = beyond(b);
      if ((at_a > 0.0) != (at_b > 0.0)) {
        const double t = at_a / (at_a - at_b);
        within.push_back({glm::mix(a.p_mm, b.p_mm, t), glm::mix(a.p_voxel, b.p_voxel, t)});
      }
      if (at_b <= 0.0) within.push_back(b);
    }
    line = std::move(within);
  }
  return line;
}

double area_mm2(const std::vector<Corner>& line) {
  std::vector<glm::dvec2> polygon;
  polygon.reserve(line.size());
  for (const Corner& corner : line) polygon.push_back(corner.p_mm);
  return polygon.size() < 3 ? 0.0 : std::abs(voxel::signed_area(polygon));
}

struct Volumes {
  double drawn_mm3 = 0.0, beyond_mm3 = 0.0;
};

/// The volume that contours enclose, and its part beyond a lattice's samples: the sum of each plane's area
/// times the thickness for which the plane stands. Exact except for crossing contours, and for planes whose
/// slab ends beyond the samples.
Volumes volumes_of(const voxel::SliceMask& mask, const voxel::Lattice& box) {
  Volumes volumes;
  const auto& slices = mask.slices;
  for (std::size_t i = 0; i < slices.size(); ++i) {
    const std::size_t below = i == 0 ? 0 : i - 1, above = i + 1 == slices.size() ? i : i + 1;
    const double gaps = static_cast<double>(above - below);
    const double thick_mm = (slices[above].position_mm - slices[below].position_mm) / std::max(gaps, 1.0);
    const auto& polygons = slices[i].polygons_mm;
    std::vector<voxel::EdgeTree> edges;
    for (const auto& polygon : polygons) edges.emplace_back(std::vector<std::vector<glm::dvec2>>{polygon});
    for (std::size_t own = 0; own < polygons.size(); ++own) {
      const auto& polygon = polygons[own];
      // A contour that lies within an odd number of others bounds a hole.
      double sign = 1.0;
      for (std::size_t other = 0; other < polygons.size(); ++other)
        if (other != own && edges[other].contains(polygon.front())) sign = -sign;
      std::vector<Corner> line;
      for (const glm::dvec2& p : polygon)
        line.push_back({p, box.voxel(on_plane(mask.view, p, slices[i].position_mm))});
      const double whole_mm2 = area_mm2(line);
      volumes.drawn_mm3 += sign * thick_mm * whole_mm2;
      volumes.beyond_mm3 += sign * thick_mm * (whole_mm2 - area_mm2(clipped(std::move(line), box)));
    }
  }
  return volumes;
}

/// Text such as "about 12 % of its volume, 3400 mm3,".
std::string share_of(const Volumes& volumes) {
  const double percent = 100.0 * volumes.beyond_mm3 / volumes.drawn_mm3;
  return "about " + three_figures(percent) + " % of its volume, " + three_figures(volumes.beyond_mm3) +
         " mm3,";
}

}  // namespace

void add_contour_findings(voxel::SliceMask& mask, const std::string& where,
                          std::vector<std::string>& findings) {
  take_once(mask, where, findings);
  tell_crossings(mask, where, findings);
}

std::vector<std::string> findings_of(const voxel::Region& region) {
  const auto& polygons = region.polygons_mm;
  const auto place_of = [](const glm::dvec2& p) {
    return "[" + hundredths(p.x) + ", " + hundredths(p.y) + "] mm of the view";
  };
  const auto count_of = [](std::size_t count) {
    return std::to_string(count) + (count == 1 ? " polygon" : " polygons");
  };
  std::vector<std::string> findings;
  const std::vector<std::size_t> again = voxel::repeated_polygons(polygons, off_plane_mm());
  if (!again.empty())
    findings.push_back(count_of(again.size()) +
                       " drawn twice, so the even-odd rule removes both: delete one of each, first at " +
                       place_of(polygons[again.front()].front()));
  const voxel::CrossingPolygons crossing = voxel::crossing_polygons(polygons, off_plane_mm());
  if (!crossing.all.empty())
    findings.push_back(count_of(crossing.all.size()) +
                       (crossing.all.size() == 1 ? " crosses itself" : " cross another or themselves") +
                       ", so parts enclosed twice are left out, first at " +
                       place_of(crossing.all.front().at_mm) +
                       ": if these parts belong to the region, join the contours");
  return findings;
}

std::optional<std::string> beyond_scan(const voxel::SliceMask& mask, const voxel::Lattice& scan,
                                       const std::string& where) {
  std::size_t planes = 0, drawn = 0;
  double farthest_mm = 0.0;
  std::string at;
  for (const voxel::SliceMask::Slice& slice : mask.slices) {
    double beyond_mm = 0.0;
    for (const auto& polygon : slice.polygons_mm)
      for (const glm::dvec2& p : polygon) {
        const glm::dvec3 p_voxel = scan.voxel(on_plane(mask.view, p, slice.position_mm));
        const glm::dvec3 outside =
            glm::max(-0.5 - p_voxel, p_voxel - (glm::dvec3(scan.dims) - 0.5)) * scan.spacing_mm();
        const double p_beyond_mm = std::max({outside.x, outside.y, outside.z});
        beyond_mm = std::max(beyond_mm, p_beyond_mm);
        if (p_beyond_mm <= std::max(farthest_mm, off_plane_mm())) continue;
        farthest_mm = p_beyond_mm;
        at = place(mask.view, p, slice.position_mm);
      }
    drawn += slice.polygons_mm.empty() ? 0 : 1;
    planes += beyond_mm > off_plane_mm() ? 1 : 0;
  }
  if (planes == 0) return std::nullopt;
  return where + ": reaches beyond the scan in " + std::to_string(planes) + " of " + std::to_string(drawn) +
         " planes, by up to " + three_figures(farthest_mm) + " mm " + at + "; " +
         share_of(volumes_of(mask, scan)) +
         " lies where nothing was measured: check whether it was drawn on another scan";
}

std::optional<std::string> slices_without_contours(const voxel::SliceMask& mask, const voxel::Lattice& scan,
                                                   const std::string& where) {
  double slice_mm = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const glm::dvec3 step_mm(scan.lps_from_voxel[axis]);
    const double along_mm = std::abs(glm::dot(step_mm, mask.view.look));
    // A plane that leans by less than this stays within one slice across the whole scan.
    if (along_mm > 0.9999 * glm::length(step_mm)) slice_mm = along_mm;
  }
  if (slice_mm == 0.0) return std::nullopt;
  std::size_t gaps = 0;
  double widest_mm = 0.0, at_mm = 0.0;
  for (std::size_t i = 1; i < mask.slices.size(); ++i) {
    const auto &below = mask.slices[i - 1], &above = mask.slices[i];
    if (below.polygons_mm.empty() || above.polygons_mm.empty()) continue;
    const double apart_mm = above.position_mm - below.position_mm;
    // Only gaps of two or more missing slices are reported, because people often leave out a single slice.
    if (apart_mm < 2.5 * slice_mm) continue;
    ++gaps;
    if (apart_mm <= widest_mm) continue;
    widest_mm = apart_mm;
    at_mm = below.position_mm;
  }
  if (gaps == 0) return std::nullopt;
  return where + ": " + std::to_string(gaps) + (gaps == 1 ? " gap" : " gaps") +
         " where slices of the scan have no contour, the widest " + three_figures(widest_mm) + " mm from " +
         hundredths(at_mm) + " mm on, while slices are " + three_figures(slice_mm) +
         " mm apart: each contour is used for half the gap on either side; if the structure ends there, draw "
         "an empty slice between";
}

std::optional<std::string> cut_at_cube(const voxel::SliceMask& mask, const voxel::Universe& universe,
                                       const std::string& where) {
  const Volumes volumes = volumes_of(mask, universe.lattice());
  // A difference below one voxel's volume comes from decimals that were rounded at the border.
  const glm::dvec3 voxel_mm = universe.lattice().spacing_mm();
  if (!(volumes.beyond_mm3 > voxel_mm.x * voxel_mm.y * voxel_mm.z)) return std::nullopt;
  return "FAIL: " + where + ": is cut at the border of the octree's cube: " + share_of(volumes) +
         " lies beyond and is left out: choose a larger cube if it is needed";
}

}  // namespace octotomy::planner
