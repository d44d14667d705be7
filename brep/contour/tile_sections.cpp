// SPDX-License-Identifier: AGPL-3.0-or-later
// 1 turn all contours with the object on their left and move every other section a little; 2 for each slab
// overlay its sections, then put strips where a contour has one counterpart; replace a strip that crosses
// anything by one whose spans are clear of contours, then by one near the shortest spans, then by one that passes
// the other surfaces in space, at last by the overlay; 3 number all points in one sequence.
#include "brep/contour/tile_sections.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <algorithm>
#include <array>
#include <atomic>
#include <cassert>
#include <cmath>
#include <limits>
#include <mutex>
#include <stdexcept>
#include <string>

#include "brep/contour/slab.h"
#include "brep/mesh/error.h"
#include "brep/mesh/morton_tree.h"
#include "brep/mesh/parallel_tasks.h"
#include "brep/mesh/self_intersections.h"

namespace octotomy::brep {
namespace {

using FaceList = std::vector<std::array<std::uint32_t, 3>>;

std::string name(const Section& section, std::size_t s, std::size_t contour) {
  return "contour " + std::to_string(contour) + " of section " + std::to_string(s) + " at " +
         std::to_string(section.z_mm) + " mm";
}

void check(const std::vector<Section>& sections) {
  const auto refuse = [](const std::string& why) { throw InvalidInput("tile_sections: " + why); };
  for (std::size_t s = 0; s < sections.size(); ++s) {
    if (!std::isfinite(sections[s].z_mm) || (s > 0 && !(sections[s - 1].z_mm < sections[s].z_mm)))
      refuse("section " + std::to_string(s) + " is not higher than the one before it: sort them by height");
    for (std::size_t c = 0; c < sections[s].contours.size(); ++c) {
      const Contour& contour = sections[s].contours[c];
      if (!contour.closed) refuse(name(sections[s], s, c) + " is open: close it or leave it out");
      if (contour.points_mm.size() < 3) refuse(name(sections[s], s, c) + " has fewer than three points");
      for (const glm::dvec2& p : contour.points_mm)
        if (!std::isfinite(p.x) || !std::isfinite(p.y))
          refuse(name(sections[s], s, c) + " has a point that is not finite");
    }
  }
}

/// The shift of every other section: a share of the largest coordinate that is 2^22 units of its last place,
/// so that no crossing is lost in rounding, and far below the resolution of any scan. Its direction is
/// unlikely to be parallel to any side; a further attempt uses another one.
glm::dvec2 shift_mm(const std::vector<Section>& sections, int attempt) {
  double reach = 0.0;
  for (const Section& section : sections)
    for (const Contour& contour : section.contours)
      for (const glm::dvec2& p : contour.points_mm) reach = std::max({reach, std::abs(p.x), std::abs(p.y)});
  const double angle = 0.7351 + 1.9 * attempt;
  return 0x1p-30 * reach * glm::dvec2(std::cos(angle), std::sin(angle));
}
constexpr int attempt_count = 4;

/// The contours, moved by `shift` (mm): counter-clockwise at even nesting depth (outer contours), clockwise
/// at odd depth (holes).
std::vector<Contour> directed(const std::vector<Contour>& contours, const glm::dvec2& shift) {
  const std::vector<std::size_t> depth = depths(nest(contours));
  std::vector<Contour> turned = contours;
  for (std::size_t c = 0; c < turned.size(); ++c) {
    if ((signed_area_mm2(turned[c]) > 0.0) != (depth[c] % 2 == 0))
      std::reverse(turned[c].points_mm.begin(), turned[c].points_mm.end());
    for (glm::dvec2& p : turned[c].points_mm) p += shift;
  }
  return turned;
}

std::uint32_t point_count(const std::vector<Contour>& contours) {
  std::size_t count = 0;
  for (const Contour& contour : contours) count += contour.points_mm.size();
  return static_cast<std::uint32_t>(count);
}

/// One slab's surface and counts of how its contours were joined.
struct Tiled {
  SlabSurface surface;
  std::size_t strips = 0, clear_strips = 0, narrowed_strips = 0, crossed_strips = 0, overlaid = 0;
};

/// Whether a strip is a surface. False if all triangles meet at the two points of one span, which the strip
/// of least area may do between rings that hardly overlap.
bool is_surface(const FaceList& strip) {
  std::vector<std::array<std::uint32_t, 2>> edges;
  edges.reserve(3 * strip.size());
  for (const auto& face : strip)
    for (std::size_t k = 0; k < 3; ++k) edges.push_back({face[k], face[(k + 1) % 3]});
  std::sort(edges.begin(), edges.end());
  return std::adjacent_find(edges.begin(), edges.end()) == edges.end();
}

/// Pairs of triangles that cross, at most a number that bounds the memory, because all of a long strip may
/// lie in another surface. Triangles without area are left out: if they cross something, their neighbours do
/// too.
std::vector<std::pair<std::uint32_t, std::uint32_t>> crossing_pairs(const Triangles& surface) {
  constexpr std::size_t most_pairs = 100000;
  std::vector<std::uint8_t> is_flat(surface.faces.size(), 0);
  for (std::size_t f = 0; f < is_flat.size(); ++f) {
    const auto& [a, b, c] = surface.faces[f];
    const glm::dvec3 &p = surface.points_mm[a], &q = surface.points_mm[b], &r = surface.points_mm[c];
    using Point = CGAL::Exact_predicates_inexact_constructions_kernel::Point_3;
    is_flat[f] = CGAL::collinear(Point(p.x, p.y, p.z), Point(q.x, q.y, q.z), Point(r.x, r.y, r.z));
  }
  return self_intersections({surface, MortonTree(surface), is_flat, most_pairs}).first;
}

/// Replaces parts of a slab's surface by strips.
class Strips {
 public:
  Strips(const Slab& slab, TileCost cost, std::optional<double> most_span_mm, SlabSurface& surface)
      : slab_(slab),
        surface_(surface),
        cost_(cost),
        most_span_mm_(most_span_mm),
        strips_(surface.groups.size()),
        sides_(slab.lower, slab.upper),
        attempts_(surface.groups.size(), first_attempt(cost)),
        avoided_(surface.groups.size()),
        known_avoided_(surface.groups.size(), 0),
        fewest_(surface.groups.size(), std::numeric_limits<std::size_t>::max()),
        stale_(surface.groups.size(), 0),
        scores_{std::vector<std::vector<std::uint8_t>>(surface.groups.size()),
                std::vector<std::vector<std::uint8_t>>(surface.groups.size())} {
    for (std::size_t g = 0; g < strips_.size(); ++g) {
      if (!is_pair(surface.groups[g])) continue;
      strips_[g] = strip_of(g);
      if (!is_allowed(strips_[g])) retry(g);
    }
  }

  std::size_t count() const {
    return static_cast<std::size_t>(
        std::count_if(strips_.begin(), strips_.end(), [](const FaceList& strip) { return !strip.empty(); }));
  }

  /// The number of groups of two contours that a strip could join.
  std::size_t wanted() const {
    return static_cast<std::size_t>(std::count_if(surface_.groups.begin(), surface_.groups.end(),
                                                  [&](const auto& group) { return is_pair(group); }));
  }

  /// The number of strips that were found by a clear attempt: their spans cross no contour.
  std::size_t clear_count() const {
    return count_if([](int attempt) { return clear_attempt <= attempt && attempt <= last_clear_attempt; });
  }
  /// The number of strips that were found by an attempt after the clear ones.
  std::size_t narrowed_count() const {
    return count_if([](int attempt) { return attempt > last_clear_attempt; });
  }

  /// Retries strips that cross anything until none does, and drops those for which every attempt crosses
  /// something. Then improves those that were joined by shortest spans only because they pass the other surfaces.
  void settle() {
    while (count() > 0) {
      std::vector<std::uint32_t> group;
      const Triangles all = with_strips(group);
      std::vector<std::uint32_t> crossing;
      for (const auto& [f, g] : crossing_pairs(all))
        for (const std::uint32_t face : {f, g}) {
          crossing.push_back(group[face]);
          avoid(crossing.back(), all.faces[face]);
        }
      std::sort(crossing.begin(), crossing.end());
      crossing.erase(std::unique(crossing.begin(), crossing.end()), crossing.end());
      std::erase_if(crossing, [&](std::uint32_t g) { return strips_[g].empty(); });
      if (crossing.empty()) break;
      for (const std::uint32_t g : crossing) {
        give_up_stale(g);
        retry(g);
      }
    }
    for (std::size_t g = 0; g < strips_.size(); ++g)
      if (!strips_[g].empty() && attempts_[g] >= apart_attempt && cost_ != TileCost::shortest_span)
        improve(g);
    std::vector<std::uint32_t> group;
    surface_.faces = with_strips(group).faces;
    surface_.group = std::move(group);
  }

 private:
  /// Attempts after the best strip, in order. 1: the best strip whose spans cross no contour. 2: the same, with
  /// both contours scaled to one box. Up to 12: both in turn, while avoiding triangles of earlier attempts that
  /// crossed something. Then the best strips near the shortest spans: within an eighth and a thirty-second of
  /// the rings' points, and within two points. Then the shortest spans themselves. Then the least area, which
  /// crosses itself least, near the shortest spans and anywhere. Last, up to 30, the shortest spans that cross no
  /// other surface in space, while avoiding triangles of earlier attempts of this kind.
  static constexpr int clear_attempt = 1, last_clear_attempt = 12, shortest_attempt = 16, area_attempt = 18,
                       apart_attempt = 19, most_attempts = 30;
  /// The strip of greatest volume may cross itself and enclose a region twice, so it is not tried first.
  static int first_attempt(TileCost cost) { return cost == TileCost::greatest_volume ? clear_attempt : 0; }

  template <typename Wanted>
  std::size_t count_if(const Wanted& wanted) const {
    std::size_t count = 0;
    for (std::size_t g = 0; g < strips_.size(); ++g)
      count += !strips_[g].empty() && wanted(attempts_[g]) ? 1 : 0;
    return count;
  }

  /// Replaces a strip that crosses nothing by the best one near it that crosses nothing either.
  void improve(std::size_t g) {
    const Place place = place_of(surface_.groups[g]);
    const Ring below{place.lower.points_mm, slab_.low_mm}, above{place.upper.points_mm, slab_.high_mm};
    const FaceList known = strips_[g];
    FaceList of_rings = known;
    for (auto& face : of_rings) face = in_rings(face, place);
    const std::size_t points = std::max(below.points_mm.size(), above.points_mm.size());
    for (int attempt = last_clear_attempt + 1; attempt < shortest_attempt; ++attempt) {
      strips_[g] = in_slab(tile_about(below, above, cost_, band(points, attempt), of_rings), place);
      std::vector<std::uint32_t> group;
      if (is_allowed(strips_[g]) && crossing_pairs(with_strips(group)).empty()) return;
    }
    strips_[g] = known;
  }

  static std::size_t eighth(std::size_t points) { return std::max<std::size_t>(2, points / 8); }
  static std::size_t band(std::size_t points, int attempt) {
    if (attempt == shortest_attempt) return 0;
    const int narrowing = attempt - last_clear_attempt;
    return narrowing == 1 ? eighth(points) : narrowing == 2 ? std::max<std::size_t>(2, points / 32) : 2;
  }

  /// Skips the remaining attempts of one kind of a group after three in a row of which none crossed less than
  /// the best before. Contours that no strip can join would otherwise take most of the time.
  void give_up_stale(std::size_t g) {
    constexpr int most_stale = 3;
    const bool is_clear = attempts_[g] >= clear_attempt && attempts_[g] <= last_clear_attempt;
    if (!is_clear && attempts_[g] < apart_attempt) return;
    const std::size_t crossing = avoided_[g].size() - known_avoided_[g];
    known_avoided_[g] = avoided_[g].size();
    if (crossing < fewest_[g]) {
      fewest_[g] = crossing;
      stale_[g] = 0;
    } else if (++stale_[g] == most_stale) {
      attempts_[g] = is_clear ? last_clear_attempt : most_attempts;
    }
  }

  /// Forgets which triangles of a group have crossed something.
  void forget(std::size_t g) {
    avoided_[g].clear();
    known_avoided_[g] = 0;
    fewest_[g] = std::numeric_limits<std::size_t>::max();
    stale_[g] = 0;
  }

  /// Whether an attempt would repeat an earlier one.
  bool is_repeated(int attempt) const {
    if (cost_ == TileCost::shortest_span) return attempt > last_clear_attempt && attempt <= shortest_attempt;
    return cost_ == TileCost::least_area && attempt > shortest_attempt && attempt <= area_attempt;
  }

  FaceList attempted(const Ring& below, const Ring& above, std::size_t g) {
    const int attempt = attempts_[g];
    const std::size_t points = std::max(below.points_mm.size(), above.points_mm.size());
    if (attempt == 0) return tile(below, above, cost_);
    if (attempt <= last_clear_attempt) {
      const bool is_aligned = attempt % 2 == 0;
      std::vector<std::uint8_t>& scores = scores_[is_aligned][g];
      return is_aligned ? tile_clear_aligned(below, above, cost_, scores, avoided_[g])
                        : tile_clear(below, above, cost_, sides_, scores, avoided_[g]);
    }
    for (auto& scores : scores_) scores[g] = {};
    if (attempt <= shortest_attempt) return tile_near(below, above, cost_, band(points, attempt));
    if (attempt < area_attempt) return tile_near(below, above, TileCost::least_area, eighth(points));
    if (attempt == area_attempt) return tile(below, above, TileCost::least_area);
    if (attempt == apart_attempt) forget(g);
    return tile_apart(below, above, SurfaceClearance(others(g)), avoided_[g]);
  }

  /// Tries the next strip of a group whose present strip is missing or crosses something. After all attempts
  /// the group has no strip.
  void retry(std::size_t g) {
    strips_[g].clear();
    while (strips_[g].empty() && attempts_[g] < most_attempts) {
      if (is_repeated(++attempts_[g])) continue;
      strips_[g] = strip_of(g);
      if (!is_allowed(strips_[g])) strips_[g].clear();
    }
  }

  bool is_allowed(const FaceList& strip) const {
    if (!is_surface(strip)) return false;
    if (!most_span_mm_) return true;
    const std::uint32_t lower = point_count(slab_.lower);
    return std::all_of(strip.begin(), strip.end(), [&](const auto& face) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = face[k], b = face[(k + 1) % 3];
        if ((a < lower) != (b < lower) && glm::distance(point(a), point(b)) > *most_span_mm_) return false;
      }
      return true;
    });
  }

  /// A point of the sections by its number, without its height.
  const glm::dvec2& point(std::uint32_t number) const {
    for (const auto* section : {&slab_.lower, &slab_.upper})
      for (const Contour& contour : *section) {
        if (number < contour.points_mm.size()) return contour.points_mm[number];
        number -= static_cast<std::uint32_t>(contour.points_mm.size());
      }
    assert(false);
    return slab_.lower.front().points_mm.front();
  }

  /// One contour below and one above, both outlines or both holes.
  bool is_pair(const SlabSurface::Group& group) const {
    return group.lower.size() == 1 && group.upper.size() == 1 &&
           (signed_area_mm2(slab_.lower[group.lower[0]]) > 0.0) ==
               (signed_area_mm2(slab_.upper[group.upper[0]]) > 0.0);
  }

  /// Positions of a group's rings in the array of all points.
  struct Place {
    const Contour &lower, &upper;
    std::uint32_t m, of_lower, of_upper;
  };
  Place place_of(const SlabSurface::Group& group) const {
    assert(is_pair(group));
    const auto first_of = [](const std::vector<Contour>& section, std::uint32_t contour) {
      std::size_t first = 0;
      for (std::uint32_t c = 0; c < contour; ++c) first += section[c].points_mm.size();
      return static_cast<std::uint32_t>(first);
    };
    const Contour& lower = slab_.lower[group.lower[0]];
    return {lower, slab_.upper[group.upper[0]], static_cast<std::uint32_t>(lower.points_mm.size()),
            first_of(slab_.lower, group.lower[0]),
            point_count(slab_.lower) + first_of(slab_.upper, group.upper[0])};
  }

  FaceList strip_of(std::size_t g) {
    const Place place = place_of(surface_.groups[g]);
    const Ring below{place.lower.points_mm, slab_.low_mm}, above{place.upper.points_mm, slab_.high_mm};
    return in_slab(attempted(below, above, g), place);
  }

  /// Numbers a strip's points by the array of all points instead of by the rings.
  static FaceList in_slab(FaceList strip, const Place& place) {
    for (auto& face : strip)
      for (std::uint32_t& v : face) v = v < place.m ? place.of_lower + v : place.of_upper + (v - place.m);
    return strip;
  }
  /// The reverse for one triangle.
  static std::array<std::uint32_t, 3> in_rings(std::array<std::uint32_t, 3> face, const Place& place) {
    for (std::uint32_t& v : face) v = v < place.of_upper ? v - place.of_lower : v - place.of_upper + place.m;
    return face;
  }

  /// Records a triangle of a group's clear strip that crosses another surface. `face` has numbers of the
  /// array of all points; it is stored with the numbers of the group's two rings. Ignored if the group has no
  /// strip or not yet a clear one.
  void avoid(std::size_t g, const std::array<std::uint32_t, 3>& face) {
    if (strips_[g].empty() || attempts_[g] < clear_attempt) return;
    avoided_[g].push_back(in_rings(face, place_of(surface_.groups[g])));
  }

  /// The present surfaces of all other groups.
  Triangles others(std::size_t g) const {
    std::vector<std::uint32_t> group;
    Triangles all = with_strips(group);
    std::size_t kept = 0;
    for (std::size_t f = 0; f < all.faces.size(); ++f)
      if (group[f] != g) all.faces[kept++] = all.faces[f];
    all.faces.resize(kept);
    return all;
  }

  Triangles with_strips(std::vector<std::uint32_t>& group) const {
    Triangles all;
    for (const auto& [section, z] :
         {std::pair(&slab_.lower, slab_.low_mm), std::pair(&slab_.upper, slab_.high_mm)})
      for (const Contour& contour : *section)
        for (const glm::dvec2& p : contour.points_mm) all.points_mm.emplace_back(p, z);
    all.points_mm.insert(all.points_mm.end(), surface_.inner_mm.begin(), surface_.inner_mm.end());
    for (std::size_t f = 0; f < surface_.faces.size(); ++f) {
      if (!strips_[surface_.group[f]].empty()) continue;
      all.faces.push_back(surface_.faces[f]);
      group.push_back(surface_.group[f]);
    }
    for (std::uint32_t g = 0; g < strips_.size(); ++g) {
      all.faces.insert(all.faces.end(), strips_[g].begin(), strips_[g].end());
      group.insert(group.end(), strips_[g].size(), g);
    }
    assert(group.size() == all.faces.size());
    return all;
  }

  const Slab& slab_;
  SlabSurface& surface_;
  TileCost cost_;
  std::optional<double> most_span_mm_;
  std::vector<FaceList> strips_;  ///< strip of each group; empty where the surface is that of overlay()
  SpanClearance sides_;
  std::vector<int> attempts_;      ///< number of each group's present attempt
  std::vector<FaceList> avoided_;  ///< triangles that each group avoids, numbered by its rings
  /// For each group: the number of avoided triangles before the last attempt, the fewest that a clear attempt
  /// has added, and the number of attempts in a row that have not added fewer.
  std::vector<std::size_t> known_avoided_, fewest_;
  std::vector<int> stale_;
  /// By group, the scores of its spans for further clear attempts: first for the contours as they are, second
  /// for contours that were scaled to one box.
  std::array<std::vector<std::vector<std::uint8_t>>, 2> scores_;
};

Tiled tile_slab(const Slab& slab, const TileSectionsOptions& options) {
  Tiled tiled;
  tiled.surface = overlay(slab);
  tiled.overlaid = tiled.surface.groups.size();
  if (!options.cost) return tiled;
  Strips strips(slab, *options.cost, options.most_span_mm, tiled.surface);
  const std::size_t wanted = strips.wanted();
  strips.settle();
  tiled.strips = strips.count();
  tiled.clear_strips = strips.clear_count();
  tiled.narrowed_strips = strips.narrowed_count();
  tiled.crossed_strips = wanted - tiled.strips;
  tiled.overlaid -= wanted;
  return tiled;
}

/// Computes the surfaces of all slabs, including those beyond the ends. Throws SectionsCoincide if points of
/// two sections coincide, so that another shift is needed.
std::vector<Tiled> tile_slabs(const std::vector<std::vector<Contour>>& contours,
                              const std::vector<double>& heights_mm, const TileSectionsOptions& options) {
  assert(!contours.empty() && contours.size() == heights_mm.size());
  std::vector<Tiled> slabs(contours.size() - 1);
  std::atomic<std::size_t> finished = 0;
  std::mutex telling;
  run_parallel_tasks(slabs.size(), [&](std::size_t s) {
    if (options.stop.stop_requested()) return;
    slabs[s] = tile_slab({contours[s], contours[s + 1], heights_mm[s], heights_mm[s + 1]}, options);
    const std::size_t count = ++finished;
    if (!options.progress) return;
    const std::lock_guard lock(telling);
    options.progress(static_cast<double>(count) / static_cast<double>(slabs.size()));
  });
  if (options.stop.stop_requested()) throw Stopped("tiling was stopped");
  return slabs;
}

TiledSections joined(const std::vector<std::vector<Contour>>& contours, const std::vector<double>& heights_mm,
                     std::vector<Tiled> slabs) {
  assert(slabs.size() + 1 == contours.size());
  TiledSections tiled;
  std::vector<std::uint32_t> first;
  for (std::size_t s = 0; s < contours.size(); ++s) {
    first.push_back(static_cast<std::uint32_t>(tiled.surface.points_mm.size()));
    for (const Contour& contour : contours[s])
      for (const glm::dvec2& p : contour.points_mm) tiled.surface.points_mm.emplace_back(p, heights_mm[s]);
  }
  for (std::size_t s = 0; s < slabs.size(); ++s) {
    const std::uint32_t lower = point_count(contours[s]), upper = lower + point_count(contours[s + 1]);
    const auto inner = static_cast<std::uint32_t>(tiled.surface.points_mm.size());
    // Removes points of an overlay that a strip has replaced.
    std::vector<std::uint32_t> number(slabs[s].surface.inner_mm.size(), 0);
    for (const auto& face : slabs[s].surface.faces)
      for (const std::uint32_t v : face)
        if (v >= upper) number[v - upper] = 1;
    std::uint32_t kept = 0;
    for (std::size_t v = 0; v < number.size(); ++v) {
      if (number[v] == 0) continue;
      number[v] = inner + kept++;
      tiled.surface.points_mm.push_back(slabs[s].surface.inner_mm[v]);
    }
    for (auto face : slabs[s].surface.faces) {
      for (std::uint32_t& v : face)
        v = v < lower ? first[s] + v : v < upper ? first[s + 1] + (v - lower) : number[v - upper];
      tiled.surface.faces.push_back(face);
    }
    tiled.strips += slabs[s].strips;
    tiled.clear_strips += slabs[s].clear_strips;
    tiled.narrowed_strips += slabs[s].narrowed_strips;
    tiled.crossed_strips += slabs[s].crossed_strips;
    tiled.overlaid += slabs[s].overlaid;
  }
  return tiled;
}

}  // namespace

TiledSections tile_sections(const std::vector<Section>& sections, const TileSectionsOptions& options) {
  check(sections);
  if (sections.empty()) return {};
  std::vector<double> heights_mm;
  for (const Section& section : sections) heights_mm.push_back(section.z_mm);
  constexpr double lone_mm = 1.0;
  const std::size_t count = heights_mm.size();
  const double below = count > 1 ? heights_mm[1] - heights_mm[0] : lone_mm;
  const double above = count > 1 ? heights_mm[count - 1] - heights_mm[count - 2] : lone_mm;
  heights_mm.insert(heights_mm.begin(), heights_mm.front() - below);
  heights_mm.push_back(heights_mm.back() + above);

  std::string trouble;
  for (int attempt = 0; attempt < attempt_count; ++attempt) {
    const glm::dvec2 shift = shift_mm(sections, attempt);
    std::vector<std::vector<Contour>> contours(1);
    for (std::size_t s = 0; s < count; ++s)
      contours.push_back(directed(sections[s].contours, static_cast<double>(s % 2) * shift));
    contours.emplace_back();
    try {
      return joined(contours, heights_mm, tile_slabs(contours, heights_mm, options));
    } catch (const SectionsCoincide& coincide) {
      trouble = coincide.what();
    }
  }
  throw Error(ErrorCode::Geometry,
              "tile_sections: " + trouble + " at every shift that was tried: move one manually");
}

}  // namespace octotomy::brep
