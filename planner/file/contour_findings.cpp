// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/file/contour_findings.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "planner/table/number_format.h"
#include "voxel/solid/polygon_overlaps.h"

namespace octotomy::planner {
namespace {

/// "10, 12 and 3 more".
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

/// A coordinate to a hundredth of a millimetre.
std::string hundredths(double mm) {
  return plain(std::round(100.0 * mm) / 100.0 + 0.0);
}

std::string place(const voxel::View& view, const glm::dvec2& p, double position_mm) {
  const glm::dvec3 at = on_plane(view, p, position_mm);
  return "near (" + hundredths(at.x) + ", " + hundredths(at.y) + ", " + hundredths(at.z) + ") mm";
}

/// Takes contours that are drawn again in their plane once: by the even-odd rule they would delete each
/// other.
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
                       " another of the same plane, which is taken once: planes at " + planes.text() +
                       " mm, first " + first);
}

/// The even-odd rule leaves out what two contours enclose, which is a hole where one lies in the other. Of
/// contours that cross, DICOM's exclusive or says the same (PS3.3, C.8.8.6.3), and other programs join them.
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
                       ", so that parts enclosed twice are left out: " + planes.text() + ", first " + first +
                       "; redraw them as one outline if the parts belong to it");
  if (!unknown.text().empty())
    findings.push_back(where +
                       ": too many edges lie over each other to tell all contours that cross: "
                       "planes at " +
                       unknown.text() + " mm");
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
    findings.push_back(count_of(again.size()) + " drawn twice: nothing is left of both, first at " +
                       place_of(polygons[again.front()].front()));
  const voxel::CrossingPolygons crossing = voxel::crossing_polygons(polygons, off_plane_mm());
  if (!crossing.all.empty())
    findings.push_back(count_of(crossing.all.size()) +
                       (crossing.all.size() == 1 ? " crosses itself" : " cross another or themselves") +
                       ", so that parts enclosed twice are left out, first at " +
                       place_of(crossing.all.front().at_mm) +
                       ": join them where the parts belong to the region");
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
         " planes, by up to " + three_figures(farthest_mm) + " mm " + at +
         ": nothing was measured there; was it drawn on another scan?";
}

}  // namespace octotomy::planner
