// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/part/guide_site.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <limits>
#include <map>
#include <stdexcept>

#include "planner/operation/table/number_format.h"
#include "voxel/space/view.h"

namespace octotomy::planner {
namespace {

/// Points may lie this far from the bone, because landmarks are placed by hand.
constexpr double off_bone_mm = 3.0;
/// A point that lies deeper than this behind the visible bone counts as hidden.
constexpr double hidden_mm = 3.0;
/// The largest angle between a guide's insertion direction and its view, and between that direction and the
/// normal of the bone below the guide.
constexpr double most_turned_deg = 60.0;
constexpr double grid_mm = 1.0;
/// A region is refused if at least this share of it lies on a second bone.
constexpr double second_share = 0.05;

voxel::View head_view(const std::string& text, const SettleBench& bench) {
  const voxel::View view = voxel::parse_view(text);
  const glm::dmat3& held = bench.objects.lps_from_head;
  return {held * view.look, held * view.up, held * view.right};
}

double turned_deg(const glm::dvec3& a, const glm::dvec3& b) {
  return glm::degrees(std::acos(std::clamp(glm::dot(a, b), -1.0, 1.0)));
}

/// The insertion direction of the part as a unit vector, LPS. Throws if it or the region's view lies too far
/// off the side.
glm::dvec3 way_of(const SiteAsked& asked, const SettleBench& bench) {
  const voxel::View side = head_view(asked.side, bench);
  const glm::dvec3 along = asked.direction ? glm::normalize(*asked.direction) : side.look;
  if (const double off_deg = turned_deg(along, side.look); off_deg > most_turned_deg)
    throw std::runtime_error("the direction lies " + three_figures(off_deg) + " degrees off the view from '" +
                             asked.side + "', so nobody on that side can put the " + asked.part +
                             " on: turn 'direction', or "
                             "choose another 'side'");
  if (asked.drawn) {
    const double off_deg = turned_deg(head_view(asked.drawn->view, bench).look, side.look);
    if (off_deg > most_turned_deg)
      throw std::runtime_error("the region is drawn in the view '" + asked.drawn->view + "', which lies " +
                               three_figures(off_deg) + " degrees off 'side', '" + asked.side +
                               "': draw it from the side that the surgeon reaches, or choose another 'side'");
  }
  return along;
}

/// A frame that looks along a direction. Its up is as close as possible to the head's up.
ArchFrame frame_along(const glm::dvec3& look, const glm::dmat3& lps_from_head) {
  ArchFrame frame;
  frame.look = look;
  const glm::dvec3 up =
      std::abs(glm::dot(look, lps_from_head[2])) < 0.9 ? lps_from_head[2] : -lps_from_head[1];
  frame.up = glm::normalize(up - look * glm::dot(up, look));
  frame.right = glm::cross(look, frame.up);
  return frame;
}

std::vector<glm::dvec2> disc(const glm::dvec2& middle_mm, double radius_mm) {
  constexpr int sides = 48;
  std::vector<glm::dvec2> outline_mm;
  for (int i = 0; i < sides; ++i) {
    const double turn = 2.0 * glm::pi<double>() * i / sides;
    outline_mm.push_back(middle_mm + radius_mm * glm::dvec2(std::cos(turn), std::sin(turn)));
  }
  return outline_mm;
}

std::vector<glm::dvec2> outline_about(const std::vector<glm::dvec2>& points_mm, double radius_mm,
                                      double ends_mm) {
  if (points_mm.size() == 1) return disc(points_mm[0], radius_mm);
  return band_outline(longer_by(points_mm, ends_mm), 2.0 * radius_mm);
}

struct ViewBox {
  glm::dvec2 low{std::numeric_limits<double>::infinity()};
  glm::dvec2 high{-std::numeric_limits<double>::infinity()};
};

ViewBox box_of(const std::vector<glm::dvec2>& outline_mm, double margin_mm = 0.0) {
  ViewBox box;
  for (const glm::dvec2& p_mm : outline_mm) {
    box.low = glm::min(box.low, p_mm - margin_mm);
    box.high = glm::max(box.high, p_mm + margin_mm);
  }
  return box;
}

/// Computes the outlines of the region and of the space around it, in the frame of the base.
void draw_outlines(const SiteAsked& asked, const SettleBench& bench, GuideSite& site) {
  ArchFrame& frame = site.base.frame;
  if (asked.drawn) {
    const voxel::View view = head_view(asked.drawn->view, bench);
    frame.look = view.look;
    frame.up = view.up;
    frame.right = view.right;
    site.base.outline_mm = asked.drawn->polygons_mm.front();
    const ViewBox box = box_of(site.base.outline_mm, asked.margin_mm);
    site.near.outline_mm = {box.low, {box.high.x, box.low.y}, box.high, {box.low.x, box.high.y}};
  } else {
    frame = frame_along(site.along, bench.objects.lps_from_head);
    for (const glm::dvec3& p_mm : asked.points_mm) frame.points_mm.push_back(frame.project(p_mm));
    constexpr double least_apart_mm = 1.0;
    for (std::size_t i = 1; i < frame.points_mm.size(); ++i)
      if (glm::distance(frame.points_mm[i - 1], frame.points_mm[i]) < least_apart_mm)
        throw std::runtime_error("points " + std::to_string(i) + " and " + std::to_string(i + 1) +
                                 " lie behind each other along the direction in which the " + asked.part +
                                 " is put on: leave out one of them");
    const double ends_mm = asked.ends_mm.value_or(asked.radius_mm);
    site.base.outline_mm = outline_about(frame.points_mm, asked.radius_mm, ends_mm);
    site.near.outline_mm =
        outline_about(frame.points_mm, asked.radius_mm + asked.margin_mm, ends_mm + asked.margin_mm);
  }
  site.near.frame = frame;
  site.base.low_mm = site.near.low_mm = 0.0;
  site.base.high_mm = site.near.high_mm = 1.0;
  try {
    static_cast<void>(site.base.solid());
    static_cast<void>(site.near.solid());
  } catch (const std::invalid_argument&) {
    throw std::runtime_error(asked.drawn
                                 ? "the region's polygon crosses itself or has no area: draw a simple polygon"
                                 : "the region around the points crosses itself: make it narrower, or state "
                                   "the points in their order along a line");
  }
}

/// For each face of a bone, the number of its component.
std::vector<std::uint32_t> pieces_of(const brep::Solid& bone) {
  std::vector<std::uint32_t> piece(bone.triangles().faces.size(), 0);
  const std::vector<brep::Component>& components = bone.components();
  for (std::uint32_t i = 0; i < components.size(); ++i)
    for (const std::uint32_t face : components[i].faces) piece[face] = i;
  return piece;
}

void need_points_seen(const SiteAsked& asked, const brep::Solid& bone,
                      const std::vector<std::uint32_t>& piece, const GuideSite& site) {
  const std::vector<brep::Foot> feet = bone.tree().feet(asked.points_mm);
  for (std::size_t i = 0; i < feet.size(); ++i) {
    const std::string point = "point " + std::to_string(i + 1);
    if (feet[i].distance_mm > off_bone_mm)
      throw std::runtime_error(point + " lies " + three_figures(feet[i].distance_mm) +
                               " mm off the surface of '" + asked.bone + "': choose points on the bone");
    if (!asked.is_on_several && piece[feet[i].face] != piece[feet[0].face])
      throw std::runtime_error("points 1 and " + std::to_string(i + 1) + " lie on two separate pieces of '" +
                               asked.bone + "', but a guide sits on one bone: make a guide for each of them");
    const std::optional<Seen> seen = site.front.first(site.base.frame.project(feet[i].p_mm));
    const double behind_mm = seen ? glm::dot(feet[i].p_mm, site.base.frame.look) - seen->depth_mm : 0.0;
    if (behind_mm > hidden_mm)
      throw std::runtime_error(
          point + " lies " + three_figures(behind_mm) +
          " mm behind other bone along the direction in which the " + asked.part +
          " is put on, where the surgeon cannot reach it: move the point or choose another 'side'");
  }
}

/// Samples of the region's visible bone on a grid.
struct SeenRegion {
  double foremost_mm = std::numeric_limits<double>::infinity();
  std::vector<std::pair<double, Seen>> all;  ///< each with its depth
};

SeenRegion seen_of(const GuideSite& site) {
  SeenRegion region;
  const ViewBox box = box_of(site.base.outline_mm);
  for (double u = box.low.x + 0.5 * grid_mm; u < box.high.x; u += grid_mm)
    for (double v = box.low.y + 0.5 * grid_mm; v < box.high.y; v += grid_mm) {
      if (!voxel::contains({site.base.outline_mm}, glm::dvec2(u, v))) continue;
      const std::optional<Seen> seen = site.front.first({u, v});
      if (!seen) continue;
      region.foremost_mm = std::min(region.foremost_mm, seen->depth_mm);
      region.all.emplace_back(seen->depth_mm, *seen);
    }
  return region;
}

void need_one_bone(const SiteAsked& asked, const SeenRegion& region,
                   const std::vector<std::uint32_t>& piece) {
  std::map<std::uint32_t, std::size_t> counts;
  std::size_t all = 0;
  for (const auto& [depth_mm, seen] : region.all)
    if (depth_mm <= region.foremost_mm + asked.reach_mm) {
      ++counts[piece[seen.face]];
      ++all;
    }
  std::size_t most = 0;
  for (const auto& [of, count] : counts) most = std::max(most, count);
  const double other = 1.0 - static_cast<double>(most) / static_cast<double>(std::max<std::size_t>(all, 1));
  if (other >= second_share)
    throw std::runtime_error("the region lies on two bones: " + three_figures(100.0 * other) +
                             " % of it is on other pieces of '" + asked.bone +
                             "' than the rest: draw it on one bone, or keep one bone by a parts step");
}

void need_facing(const SiteAsked& asked, const SeenRegion& region, const GuideSite& site) {
  // A line of sight stands for an area that grows with the slant of the surface. Normals are weighted by this
  // area, so that their sum has the direction of the mean normal over the surface.
  constexpr double least_slant = 0.05;
  glm::dvec3 sum(0.0);
  for (const auto& [depth_mm, seen] : region.all)
    if (depth_mm <= region.foremost_mm + asked.reach_mm)
      sum += seen.normal / std::max(least_slant, std::abs(glm::dot(seen.normal, site.base.frame.look)));
  if (!(glm::length(sum) > 0.0)) return;
  const double off_deg = turned_deg(-glm::normalize(sum), site.along);
  if (off_deg > most_turned_deg)
    throw std::runtime_error("the direction runs along the sides of '" + asked.bone + "': it lies " +
                             three_figures(off_deg) +
                             " degrees off the mean normal of the region, so nothing holds the " +
                             asked.part + "; point the direction into the bone");
}

}  // namespace

std::optional<glm::dvec3> GuideSite::bone_at(const glm::dvec2& p_mm) const {
  const std::optional<Seen> seen = front.first(p_mm);
  if (!seen || seen->depth_mm > base.high_mm) return std::nullopt;
  const ArchFrame& frame = base.frame;
  return p_mm.x * frame.right + p_mm.y * frame.up + seen->depth_mm * frame.look;
}

GuideSite guide_site(const SiteAsked& asked, const SettleBench& bench) {
  const brep::Solid& bone = bench.object(asked.bone);
  if (bone.empty())
    throw std::runtime_error("'" + asked.bone + "' is empty: a " + asked.part + " needs bone");
  GuideSite site;
  site.along = way_of(asked, bench);
  draw_outlines(asked, bench, site);
  const ViewBox box = box_of(site.near.outline_mm);
  site.front = Front(bone, site.base.frame, box.low, box.high);
  const std::vector<std::uint32_t> piece = pieces_of(bone);
  if (!asked.drawn) need_points_seen(asked, bone, piece, site);
  const SeenRegion region = seen_of(site);
  if (region.all.empty())
    throw std::runtime_error("the region contains no bone of '" + asked.bone +
                             "' that is visible from its side: draw it on the bone");
  if (asked.drawn) need_one_bone(asked, region, piece);
  need_facing(asked, region, site);
  site.base.low_mm = region.foremost_mm - asked.before_mm;
  site.base.high_mm = region.foremost_mm + asked.reach_mm;
  for (std::size_t i = 0; i < asked.points_mm.size() && !asked.drawn; ++i)
    if (const double behind_mm = glm::dot(asked.points_mm[i], site.base.frame.look) - site.base.high_mm;
        behind_mm > off_bone_mm)
      throw std::runtime_error("point " + std::to_string(i + 1) + " lies " +
                               three_figures(behind_mm + asked.reach_mm) +
                               " mm behind the region's foremost bone: raise 'reach_mm'");
  site.near.low_mm = std::min(*site.front.foremost_mm(), site.base.low_mm) - 1.0;
  site.near.high_mm = site.base.high_mm + asked.margin_mm;
  site.end_mm = std::max(site.near.far_end_mm(site.along), site.base.far_end_mm(site.along)) + 1.0;
  site.bone = brep::boolean(bone, brep::Operation::Intersection, site.near.solid(), bench.progress.stop);
  return site;
}

}  // namespace octotomy::planner
