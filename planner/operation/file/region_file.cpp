// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/file/region_file.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <stdexcept>

#include "planner/operation/file/contour_findings.h"
#include "planner/operation/table/fault.h"
#include "planner/operation/table/json.h"
#include "planner/operation/table/json_file.h"
#include "planner/operation/table/nearest_name.h"
#include "planner/operation/table/number_format.h"
#include "voxel/scan/read_rtstruct.h"
#include "voxel/solid/polygon.h"

namespace octotomy::planner {
namespace {

std::vector<std::vector<glm::dvec2>> polygons_of(const SortedJson& value, const std::string& where) {
  if (!value.is_array()) refuse(where, "must be a list of polygons [[[u, v], ...], ...]");
  std::vector<std::vector<glm::dvec2>> polygons;
  for (const SortedJson& polygon : value) {
    const std::string at = where + "[" + std::to_string(polygons.size()) + "]";
    if (!polygon.is_array()) refuse(at, "must be a list of points [u, v]");
    polygons.emplace_back();
    for (const SortedJson& point : polygon) {
      const std::string place = at + "[" + std::to_string(polygons.back().size()) + "]";
      polygons.back().push_back(point_of(point, place));
    }
  }
  return polygons;
}

voxel::SliceMask slices_of(const SortedJson& json, const std::string& source) {
  check_keys(json, source, {"view", "between", "slices"});
  voxel::SliceMask mask;
  mask.view = voxel::parse_view(word_of(need(json, "view", source), source + ": view"));
  if (json.contains("between")) {
    const std::string between = word_of(json["between"], source + ": between");
    if (between != "shape_based" && between != "nearest")
      refuse(source + ": between", "is shape_based or nearest, not '" + between + "'");
    mask.between =
        between == "nearest" ? voxel::SliceMask::Between::Nearest : voxel::SliceMask::Between::ShapeBased;
  }
  const SortedJson& slices = need(json, "slices", source);
  if (!slices.is_array()) refuse(source + ": slices", "must be a list");
  for (const SortedJson& slice : slices) {
    const std::string where = source + ": slices[" + std::to_string(mask.slices.size()) + "]";
    check_keys(slice, where, {"position_mm", "polygons_mm"});
    mask.slices.push_back({number_of(need(slice, "position_mm", where), where + ".position_mm"),
                           polygons_of(need(slice, "polygons_mm", where), where + ".polygons_mm")});
  }
  std::stable_sort(mask.slices.begin(), mask.slices.end(),
                   [](const auto& a, const auto& b) { return a.position_mm < b.position_mm; });
  voxel::check(mask);
  return mask;
}

/// Points count as in one plane if they are at most this far apart along its normal and planes are ten times
/// as far apart. Some programs rotate or resample contours and write them in single precision.
constexpr double jitter_mm() {
  return 0.1;
}

/// The sum of the vector areas of the triangles at a contour's first point, all turned to the same side. Its
/// direction is the contour's normal. Its length exceeds the area if the contour is not convex; it is above
/// zero even if the contour crosses itself and the areas of its parts cancel.
glm::dvec3 area_of(const std::vector<glm::dvec3>& contour) {
  glm::dvec3 largest(0.0), area(0.0);
  const auto triangle = [&](std::size_t i) {
    return glm::cross(contour[i] - contour[0], contour[i + 1] - contour[0]);
  };
  for (std::size_t i = 1; i + 1 < contour.size(); ++i)
    if (const glm::dvec3 one = triangle(i); glm::length(one) > glm::length(largest)) largest = one;
  for (std::size_t i = 1; i + 1 < contour.size(); ++i) {
    const glm::dvec3 one = triangle(i);
    area += glm::dot(one, largest) < 0.0 ? -one : one;
  }
  return area;
}

/// The view along a contour's normal. If the normal differs from an axis by less than 0.001, the axis is
/// used.
voxel::View view_across(const glm::dvec3& area) {
  voxel::View view;
  view.look = glm::normalize(area);
  const glm::dvec3 size = glm::abs(view.look);
  const int axis = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
  if (view.look[axis] < 0.0) view.look = -view.look;
  constexpr double along_axis = 1e-3;
  if (std::abs(view.look[axis] - 1.0) < along_axis * along_axis) {
    view.look = glm::dvec3(0.0);
    view.look[axis] = 1.0;
  }
  glm::dvec3 up(0.0);
  up[axis == 1 ? 2 : 1] = axis == 1 ? 1.0 : -1.0;
  view.up = glm::normalize(up - glm::dot(up, view.look) * view.look);
  view.right = glm::cross(view.look, view.up);
  return view;
}

using Slices = std::vector<voxel::SliceMask::Slice>;

/// The end of a message on planes that count as one plane because they are too near each other.
std::string too_near(double gap_mm) {
  return plain(gap_mm) + " mm apart, but planes within " + plain(2.0 * off_plane_mm()) +
         " mm count as one plane: draw it on planes that are farther apart, or check that its positions are "
         "in mm";
}

/// The range of a contour's positions along the view, in mm.
struct Span {
  double low_mm = std::numeric_limits<double>::infinity(), high_mm = -low_mm;

  double middle_mm() const { return 0.5 * (low_mm + high_mm); }
  double length_mm() const { return high_mm - low_mm; }
};

Span span_of(const std::vector<glm::dvec3>& contour, const voxel::View& view) {
  Span span;
  for (const glm::dvec3& p : contour) {
    span.low_mm = std::min(span.low_mm, glm::dot(p, view.look));
    span.high_mm = std::max(span.high_mm, glm::dot(p, view.look));
  }
  return span;
}

struct PlaneDistances {
  double least_mm = std::numeric_limits<double>::infinity();  ///< least distance of planes that count as
                                                              ///< different
  double nearest_mm = least_mm;                               ///< least distance of planes, including those
                                                              ///< that count as one
  double one_plane_mm = 2.0 * off_plane_mm();                 ///< planes up to this distance apart count as
                                                              ///< one
};

/// The distances between the planes of all structures that are perpendicular to the view. They are infinite
/// if there is only one plane.
PlaneDistances distances_of_planes(const std::vector<voxel::Structure>& structures, const voxel::View& view) {
  std::vector<double> positions;
  for (const voxel::Structure& structure : structures)
    for (const auto& contour : structure.contours_mm)
      if (const Span span = span_of(contour, view); span.length_mm() <= jitter_mm())
        positions.push_back(span.middle_mm());
  std::sort(positions.begin(), positions.end());
  PlaneDistances distances;
  // Smaller gaps come from rounding to three decimals.
  constexpr double in_plane_mm = 0.1 * off_plane_mm();
  double coarse_mm = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < positions.size(); ++i) {
    const double gap = positions[i] - positions[i - 1];
    if (gap > in_plane_mm) distances.nearest_mm = std::min(distances.nearest_mm, gap);
    if (gap > 2.0 * off_plane_mm()) distances.least_mm = std::min(distances.least_mm, gap);
    if (gap > jitter_mm()) coarse_mm = std::min(coarse_mm, gap);
  }
  if (std::isfinite(coarse_mm) && coarse_mm >= 10.0 * jitter_mm())
    distances = {coarse_mm, coarse_mm, jitter_mm()};
  return distances;
}

/// The largest gap between neighbouring planes that is interpolated: one value for the whole region, or for
/// two planes half the sum of their slabs if that is larger.
class Bridges {
 public:
  Bridges(const voxel::Structure& structure, const voxel::View& view, double bridge_mm) : all_mm_(bridge_mm) {
    for (std::size_t i = 0; i < structure.slabs_mm.size(); ++i)
      if (structure.slabs_mm[i] > 0.0)
        slabs_.push_back({span_of(structure.contours_mm[i], view).middle_mm(), structure.slabs_mm[i]});
    std::sort(slabs_.begin(), slabs_.end());
  }

  /// The largest gap between these two neighbouring planes that is interpolated.
  double across(double low_mm, double high_mm) const {
    const double a = slab_at(low_mm), b = slab_at(high_mm);
    return a > 0.0 && b > 0.0 ? std::max(all_mm_, 0.5 * rounding * (a + b)) : all_mm_;
  }
  /// The thickness that the file states for the contours of a plane; 0 if it states none.
  double slab_at(double position_mm) const {
    const auto found =
        std::lower_bound(slabs_.begin(), slabs_.end(), std::pair(position_mm - 2.0 * off_plane_mm(), 0.0));
    return found != slabs_.end() && found->first <= position_mm + 2.0 * off_plane_mm() ? found->second : 0.0;
  }
  double all_mm() const { return all_mm_; }

  /// Gaps up to a hundredth larger than stated are interpolated, because positions are rounded.
  static constexpr double rounding = 1.01;

 private:
  double all_mm_;
  std::vector<std::pair<double, double>> slabs_;  ///< position and thickness, ascending
};

/// A structure's contours, grouped by plane in ascending order. `source` begins refusals and findings.
Slices planes_of(const voxel::Structure& structure, const voxel::View& view, const PlaneDistances& distances,
                 const std::string& source, std::vector<std::string>& findings) {
  std::vector<voxel::SliceMask::Slice> single;
  double worst_mm = 0.0;
  for (const std::vector<glm::dvec3>& contour : structure.contours_mm) {
    const Span span = span_of(contour, view);
    if (!(span.length_mm() <= distances.one_plane_mm))
      refuse(source, "has contours that are not in parallel planes: one extends by " +
                         three_figures(span.length_mm()) + " mm near " + plain(contour.front().x) + ", " +
                         plain(contour.front().y) + ", " + plain(contour.front().z) + " mm");
    worst_mm = std::max(worst_mm, 0.5 * span.length_mm());
    voxel::SliceMask::Slice slice{span.middle_mm(), {{}}};
    for (const glm::dvec3& p : contour) slice.polygons_mm.back().push_back(view.project(p));
    // A contour without area, such as a line there and back, encloses nothing.
    if (glm::length(area_of(contour)) > 0.0) single.push_back(std::move(slice));
  }
  if (worst_mm > off_plane_mm())
    findings.push_back(source + ": points up to " + three_figures(worst_mm) +
                       " mm off their contour's plane were moved into the plane");
  std::stable_sort(single.begin(), single.end(),
                   [](const auto& a, const auto& b) { return a.position_mm < b.position_mm; });
  Slices planes;
  double before_mm = -std::numeric_limits<double>::infinity();
  for (voxel::SliceMask::Slice& slice : single) {
    const double gap_mm = slice.position_mm - before_mm;
    before_mm = slice.position_mm;
    if (planes.empty() || slice.position_mm - planes.back().position_mm > distances.one_plane_mm) {
      if (gap_mm <= distances.one_plane_mm) refuse(source, "has planes " + too_near(gap_mm));
      planes.push_back(std::move(slice));
    } else {
      planes.back().polygons_mm.push_back(std::move(slice.polygons_mm.front()));
    }
  }
  return planes;
}

/// The median distance of a structure's planes in mm; 0 for a single plane.
double usual_distance_mm(const Slices& planes) {
  std::vector<double> gaps;
  for (std::size_t i = 1; i < planes.size(); ++i)
    gaps.push_back(planes[i].position_mm - planes[i - 1].position_mm);
  if (gaps.empty()) return 0.0;
  const auto middle = gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 2);
  std::nth_element(gaps.begin(), middle, gaps.end());
  return *middle;
}

/// Two planes farther apart than this multiple of the distance have a plane missing between them.
constexpr double misses_plane = 1.5;

/// The structure's planes, with empty planes beside each gap and beyond both ends. Gaps that are interpolated
/// get no empty plane. Beyond an end, the empty plane lies as far away as the thickness of the end plane, and
/// at least one distance of planes.
Slices with_empty(const Slices& planes, double apart_mm, const Bridges& bridges) {
  const double usual_mm = usual_distance_mm(planes);
  const double least_mm = usual_mm > apart_mm && usual_mm <= bridges.all_mm() ? usual_mm : apart_mm;
  const auto end_mm = [&](const voxel::SliceMask::Slice& plane) {
    return std::max(least_mm, bridges.slab_at(plane.position_mm));
  };
  Slices all{{planes.front().position_mm - end_mm(planes.front()), {}}};
  for (const voxel::SliceMask::Slice& plane : planes) {
    const double gap_mm = plane.position_mm - all.back().position_mm;
    if (!all.back().polygons_mm.empty() && gap_mm > misses_plane * apart_mm &&
        gap_mm > bridges.across(all.back().position_mm, plane.position_mm)) {
      all.push_back({all.back().position_mm + apart_mm, {}});
      if (plane.position_mm - all.back().position_mm > misses_plane * apart_mm)
        all.push_back({plane.position_mm - apart_mm, {}});
    }
    all.push_back(plane);
  }
  all.push_back({planes.back().position_mm + end_mm(planes.back()), {}});
  return all;
}

bool overlap(const voxel::SliceMask::Slice& a, const voxel::SliceMask::Slice& b) {
  const auto box = [](const voxel::SliceMask::Slice& slice) {
    glm::dvec2 low(std::numeric_limits<double>::infinity()), high(-low);
    for (const auto& polygon : slice.polygons_mm)
      for (const glm::dvec2& p : polygon) {
        low = glm::min(low, p);
        high = glm::max(high, p);
      }
    return std::pair{low, high};
  };
  const auto [low_a, high_a] = box(a);
  const auto [low_b, high_b] = box(b);
  return glm::all(glm::lessThan(low_a, high_b)) && glm::all(glm::lessThan(low_b, high_a));
}

/// Groups a structure's planes into parts: in a part, each plane's bounding box overlaps that of the plane
/// before it, seen along the normal.
std::vector<Slices> parts_of(const Slices& planes) {
  std::vector<Slices> parts;
  for (const voxel::SliceMask::Slice& plane : planes) {
    const auto before = std::find_if(parts.begin(), parts.end(),
                                     [&](const Slices& part) { return overlap(part.back(), plane); });
    if (before == parts.end())
      parts.push_back({plane});
    else
      before->push_back(plane);
  }
  return parts;
}

/// Whether a plane of `other` lies between two neighbouring planes of `part` between which no plane is missing.
bool interleave(const Slices& part, const Slices& other) {
  const double usual_mm = usual_distance_mm(part);
  for (std::size_t i = 1; i < part.size(); ++i) {
    const double low_mm = part[i - 1].position_mm, high_mm = part[i].position_mm;
    if (high_mm - low_mm > misses_plane * usual_mm) continue;
    for (const voxel::SliceMask::Slice& plane : other)
      if (plane.position_mm > low_mm && plane.position_mm < high_mm) return true;
  }
  return false;
}

bool are_interleaved(const std::vector<Slices>& parts) {
  return std::any_of(parts.begin(), parts.end(), [&](const Slices& part) {
    return std::any_of(parts.begin(), parts.end(),
                       [&](const Slices& other) { return interleave(part, other); });
  });
}

/// Joins parts that are drawn on alternating planes. Each part gets the thickness that it would have alone: a
/// plane extends half the gap to the next plane of its part. At a part's ends and beside gaps that are not
/// interpolated, it extends half the part's usual distance. Nothing is interpolated.
Slices joined_parts(const std::vector<Slices>& parts, const Bridges& bridges) {
  struct Slab {
    double low_mm, high_mm;
    const voxel::SliceMask::Slice* plane;
  };
  std::vector<Slab> slabs;
  std::vector<double> borders;
  double least_mm = std::numeric_limits<double>::infinity();
  for (const Slices& part : parts)
    if (part.size() > 1) least_mm = std::min(least_mm, usual_distance_mm(part));
  for (const Slices& part : parts) {
    const double usual_mm = part.size() > 1 ? usual_distance_mm(part) : least_mm;
    const auto half_mm = [&](std::size_t below) {
      if (below >= part.size() - 1) return 0.5 * usual_mm;  // beyond either end
      const double gap_mm = part[below + 1].position_mm - part[below].position_mm;
      const double bridge_mm = bridges.across(part[below].position_mm, part[below + 1].position_mm);
      return 0.5 * (gap_mm > std::max(misses_plane * usual_mm, bridge_mm) ? usual_mm : gap_mm);
    };
    for (std::size_t i = 0; i < part.size(); ++i) {
      const double at_mm = part[i].position_mm;
      slabs.push_back({at_mm - half_mm(i == 0 ? part.size() : i - 1), at_mm + half_mm(i), &part[i]});
      borders.insert(borders.end(), {slabs.back().low_mm, slabs.back().high_mm});
    }
  }
  std::sort(borders.begin(), borders.end());
  const auto are_one = [](double low_mm, double high_mm) { return high_mm - low_mm < 0.1 * off_plane_mm(); };
  borders.erase(std::unique(borders.begin(), borders.end(), are_one), borders.end());
  // A plane is added at this distance on either side of each border. combine() moves voxel centres farther
  // than this off a border.
  constexpr double beside_mm = 0x1p-22;
  Slices all{{borders.front() - beside_mm, {}}};
  for (std::size_t k = 1; k < borders.size(); ++k) {
    voxel::SliceMask::Slice between{borders[k - 1] + beside_mm, {}};
    const double middle_mm = 0.5 * (borders[k - 1] + borders[k]);
    for (const Slab& slab : slabs)
      if (slab.low_mm < middle_mm && middle_mm < slab.high_mm)
        between.polygons_mm.insert(between.polygons_mm.end(), slab.plane->polygons_mm.begin(),
                                   slab.plane->polygons_mm.end());
    all.push_back(between);
    between.position_mm = borders[k] - beside_mm;
    all.push_back(std::move(between));
  }
  all.push_back({borders.back() + beside_mm, {}});
  return all;
}

/// The largest gap to interpolate, as the caller requests or else as the file states, enlarged by a hundredth
/// because positions are rounded.
double bridge_of(const voxel::Structure& structure, const std::optional<double>& asked_mm) {
  if (asked_mm) return Bridges::rounding * *asked_mm;
  if (structure.is_interpolated) return std::numeric_limits<double>::infinity();
  return Bridges::rounding * structure.slab_mm;
}

/// Reports gaps in the structure: planes of the set between its planes that have none of its contours.
void tell_gaps(const Slices& planes, double apart_mm, const Bridges& bridges, const std::string& where,
               std::vector<std::string>& findings) {
  std::size_t gaps = 0, first = 0;
  double widest_mm = 0.0;
  for (std::size_t i = 1; i < planes.size(); ++i) {
    const double gap_mm = planes[i].position_mm - planes[i - 1].position_mm;
    if (gap_mm <= misses_plane * apart_mm ||
        gap_mm <= bridges.across(planes[i - 1].position_mm, planes[i].position_mm))
      continue;
    if (gaps++ == 0) first = i;
    widest_mm = std::max(widest_mm, gap_mm);
  }
  if (gaps == 0) return;
  const bool is_regular = 2 * gaps > planes.size() - 1;
  findings.push_back(
      where +
      (is_regular ? ": is drawn every " + plain(std::round(1000.0 * usual_distance_mm(planes)) / 1000.0) +
                        " mm, while the set's planes are " + plain(std::round(1000.0 * apart_mm) / 1000.0) +
                        " mm apart"
                  : ": has " + std::to_string(gaps) + (gaps == 1 ? " gap" : " gaps") +
                        " in which planes of the set have none of its contours") +
      ": there it is empty, first between " + plain(planes[first - 1].position_mm) + " and " +
      plain(planes[first].position_mm) + " mm; if the structure continues there, --bridge " +
      plain(std::ceil(1000.0 * widest_mm) / 1000.0) + " (bridge_mm in a plan) interpolates it");
}

/// A list of the structures' names in quotes. A name that several structures have is followed by the
/// structure's number.
std::string list_of(const std::vector<voxel::Structure>& structures) {
  std::map<std::string, int> counts;
  for (const voxel::Structure& structure : structures) ++counts[structure.name];
  std::string list;
  for (const voxel::Structure& structure : structures)
    list += (list.empty() ? "'" : ", '") + structure.name +
            (counts[structure.name] > 1 ? "' (" + std::to_string(structure.number) + ")" : "'");
  return list;
}

/// The structure with this name, else the one with this ROI number; without a name, the only structure.
/// Throws if none or several fit.
const voxel::Structure& chosen(const std::vector<voxel::Structure>& structures, const std::string& name,
                               const std::string& source) {
  if (name.empty() && structures.size() > 1)
    refuse(source, "has several structures: state by 'structure' one of " + list_of(structures));
  if (name.empty()) return structures.front();
  std::vector<const voxel::Structure*> named, numbered;
  for (const voxel::Structure& structure : structures) {
    if (structure.name == name) named.push_back(&structure);
    if (std::to_string(structure.number) == name) numbered.push_back(&structure);
  }
  if (named.size() == 1) return *named.front();
  if (numbered.size() == 1) return *numbered.front();
  if (named.empty() && !numbered.empty())
    refuse(source, "has " + std::to_string(numbered.size()) + " structures with the ROI number " + name +
                       ": name one of " + list_of(structures));
  if (named.empty()) {
    std::vector<std::string> names;
    for (const voxel::Structure& structure : structures) names.push_back(structure.name);
    refuse(source, "has no structure '" + name + "'" + suggestion(name, names));
  }
  std::string numbers;
  for (const voxel::Structure* each : named)
    numbers += (numbers.empty() ? "" : each == named.back() ? " and " : ", ") + std::to_string(each->number);
  refuse(source, "has " + std::to_string(named.size()) + " structures '" + name + "' with the ROI numbers " +
                     numbers + ": choose one by stating its number as 'structure'");
}

/// The normal of a structure's contours, weighted by area; zero if no contour encloses an area.
glm::dvec3 normal_of(const voxel::Structure& structure) {
  glm::dvec3 largest(0.0), sum(0.0);
  for (const auto& contour : structure.contours_mm)
    if (const glm::dvec3 area = area_of(contour); glm::length(area) > glm::length(largest)) largest = area;
  for (const auto& contour : structure.contours_mm) {
    const glm::dvec3 area = area_of(contour);
    sum += glm::dot(area, largest) < 0.0 ? -area : area;
  }
  return sum;
}

/// A phrase that counts the structure's items other than contours, such as "2 points or lines"; empty if
/// there are none.
std::string others_of(const voxel::Structure& structure) {
  std::string text;
  if (structure.others > 0) text = std::to_string(structure.others) + " points or lines";
  if (structure.degenerate > 0)
    text += (text.empty() ? "" : " and ") + std::to_string(structure.degenerate) +
            " contours with fewer than three points";
  return text;
}

DrawnSlices slices_of(const voxel::StructureSet& set, const SlicesOptions& options,
                      const std::string& source) {
  const voxel::Structure& found = chosen(set.structures, options.structure, source);
  const std::string where = source + ": '" + found.name + "'";
  if (!found.flaw.empty()) refuse(where, found.flaw);
  const glm::dvec3 normal = normal_of(found);
  const std::string others = others_of(found);
  if (!(glm::length(normal) > 0.0))
    refuse(where, "has no closed contour" + (others.empty() ? others : ", but " + others));
  DrawnSlices drawn{{}, set.identity, {}};
  if (!found.frame_uids.empty()) drawn.identity->frame_uids = found.frame_uids;
  if (found.degenerate > 0)
    drawn.findings.push_back(where + ": contours that enclose no area were left out: " + others);
  if (found.miscounted > 0)
    drawn.findings.push_back(where + ": " + std::to_string(found.miscounted) +
                             (found.miscounted == 1 ? " contour holds" : " contours hold") +
                             " a number of points other than NumberOfContourPoints states, first " +
                             std::to_string(found.held_points) + " for " +
                             std::to_string(found.stated_points) +
                             ": points may be lost; compare the contours with the program that drew them");
  drawn.mask.view = view_across(normal);
  if (found.moved > 0) {
    const glm::dvec3 by_mm = found.farthest_offset_mm;
    drawn.findings.push_back(
        where + ": " + std::to_string(found.moved) + (found.moved == 1 ? " contour is" : " contours are") +
        " moved by the file's ContourOffsetVector, by up to (" + plain(by_mm.x) + ", " + plain(by_mm.y) +
        ", " + plain(by_mm.z) +
        ") mm; other programs may ignore this offset: compare the contours' position with the scan");
  }
  const PlaneDistances distances = distances_of_planes(set.structures, drawn.mask.view);
  Slices planes = planes_of(found, drawn.mask.view, distances, where, drawn.findings);
  const bool is_slab = !std::isfinite(distances.nearest_mm) && found.slab_mm > 0.0;
  if (is_slab)
    drawn.findings.push_back(where + ": lies in one plane, and has the thickness that the file states, " +
                             plain(found.slab_mm) + " mm");
  else if (!std::isfinite(distances.nearest_mm))
    refuse(where,
           "has no thickness, because the whole set lies in one plane and states no ContourSlabThickness: "
           "draw the structure on the next plane, too");
  if (!is_slab && !std::isfinite(distances.least_mm))
    refuse(where,
           "has no thickness, because the planes of the whole set are " + too_near(distances.nearest_mm));
  drawn.mask.slices = std::move(planes);
  add_contour_findings(drawn.mask, where, drawn.findings);
  planes = std::move(drawn.mask.slices);
  const Bridges bridges(found, drawn.mask.view, bridge_of(found, options.bridge_mm));
  const std::vector<Slices> parts = parts_of(planes);
  if (!are_interleaved(parts)) {
    const double apart_mm = is_slab ? found.slab_mm : distances.least_mm;
    tell_gaps(planes, apart_mm, bridges, where, drawn.findings);
    drawn.mask.slices = with_empty(planes, apart_mm, bridges);
  } else {
    for (const Slices& part : parts) tell_gaps(part, usual_distance_mm(part), bridges, where, drawn.findings);
    drawn.findings.push_back(
        where + ": its " + std::to_string(parts.size()) +
        " parts are drawn on planes that alternate, first at " + plain(planes[0].position_mm) + " and " +
        plain(planes[1].position_mm) +
        " mm: each part gets the thickness that it would have alone, and nothing is interpolated; draw all "
        "parts on the same planes to avoid this");
    drawn.mask.slices = joined_parts(parts, bridges);
  }
  voxel::check(drawn.mask);
  return drawn;
}

}  // namespace

voxel::Region read_region(const voxel::View& view, const std::filesystem::path& path) {
  const SortedJson json = read_json(path);
  if (json.is_array()) return {view, polygons_of(json, path.string())};
  check_keys(json, path.string(), {"polygons_mm"});
  return {view, polygons_of(need(json, "polygons_mm", path.string()), path.string() + ": polygons_mm")};
}

DrawnSlices read_slices(const std::filesystem::path& path, const SlicesOptions& options) {
  const bool is_set = voxel::is_rtstruct(path);
  if (!is_set && !options.structure.empty())
    refuse(path.string(),
           "is not a DICOM structure set, so it has no structures to choose: leave out 'structure'");
  if (!is_set && options.bridge_mm)
    refuse(path.string(),
           "is not a DICOM structure set, and gaps of other files are not filled: leave out 'bridge_mm'");
  try {
    if (is_set) return slices_of(voxel::read_rtstruct(path), options, path.string());
    DrawnSlices drawn{slices_of(read_json(path), path.string())};
    add_contour_findings(drawn.mask, path.string(), drawn.findings);
    return drawn;
  } catch (const std::invalid_argument& error) {
    if (fault_of(error) != Fault::Input) throw;
    refuse(path.string(), error.what());
  }
}

voxel::SliceMask read_slices(const std::filesystem::path& path, const std::string& structure) {
  return read_slices(path, SlicesOptions{structure}).mask;
}

voxel::SliceMask read_slices(const std::filesystem::path& path, const std::string& structure,
                             std::vector<std::string>& findings) {
  DrawnSlices drawn = read_slices(path, SlicesOptions{structure});
  findings.insert(findings.end(), drawn.findings.begin(), drawn.findings.end());
  return std::move(drawn.mask);
}

}  // namespace octotomy::planner
