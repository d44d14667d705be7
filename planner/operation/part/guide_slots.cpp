// SPDX-License-Identifier: AGPL-3.0-or-later
//
// A cut meets a guide in a curve on the bone. Where the blade sweeps in the direction in which the guide is
// put on, that curve is the blade's line as seen from there; where it sweeps across, as a cut drawn in a side
// view, the curve has one point for each place along the sweep.
//
// 1 Sample the blade's line, or the sweep. A sample is on bone, over a gap of the bone, or beside the region.
// 2 The longest run of samples that are not beside it, from its first to its last on bone, is the slot;
//   closed ends stay within it by the wall beyond them.
// 3 The opening is the blade as wide as the kerf. It begins before the guide and ends behind it.
#include "planner/operation/part/guide_slots.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "brep/mesh/distance.h"
#include "brep/shape/saw.h"
#include "planner/operation/flap/flap_space.h"
#include "planner/operation/object/mask.h"
#include "planner/operation/object/saw.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"
#include "voxel/solid/saw_blade.h"
#include "voxel/space/view.h"

namespace octotomy::planner {
namespace {

constexpr double step_mm = 0.5;
/// The polygon of a region is swept along the guide's direction if its line of sight lies within this angle
/// of that direction or its opposite. Otherwise it is swept across.
constexpr double most_apart_deg = 45.0;
/// The largest allowed angle between a saw's direction and the guide's insertion direction.
constexpr double most_oblique_deg = 60.0;
constexpr double least_opening_mm = 2.0;
constexpr double on_other_cut_mm = 1.0;

enum class On { Beside, Gap, Bone };

struct CutSample {
  double at_mm = 0.0;  ///< position along the line, or along the sweep
  On on = On::Beside;
  glm::dvec3 bone_mm{0.0};
};

using Line = std::vector<glm::dvec3>;

double angle_deg(const glm::dvec3& a, const glm::dvec3& b) {
  return glm::degrees(std::acos(std::clamp(glm::dot(a, b), -1.0, 1.0)));
}

double length_of(const Line& line) {
  double length_mm = 0.0;
  for (std::size_t i = 1; i < line.size(); ++i) length_mm += glm::distance(line[i - 1], line[i]);
  return length_mm;
}

/// The part of a line between two lengths from its beginning.
Line piece_of(const Line& line, double from_mm, double to_mm) {
  Line piece;
  double before_mm = 0.0;
  for (std::size_t i = 1; i < line.size(); ++i) {
    const double edge_mm = glm::distance(line[i - 1], line[i]);
    const auto at = [&](double s_mm) {
      return glm::mix(line[i - 1], line[i], edge_mm > 0.0 ? (s_mm - before_mm) / edge_mm : 0.0);
    };
    const double low_mm = std::max(from_mm, before_mm), high_mm = std::min(to_mm, before_mm + edge_mm);
    if (low_mm < high_mm) {
      if (piece.empty()) piece.push_back(at(low_mm));
      piece.push_back(at(high_mm));
    }
    before_mm += edge_mm;
  }
  return piece;
}

/// The line with its last edge made longer by `by_mm`.
Line longer(Line line, double by_mm) {
  const std::size_t last = line.size() - 1;
  line[last] += by_mm * glm::normalize(line[last] - line[last - 1]);
  return line;
}

bool is_in(const SlotsAsked& asked, const glm::dvec2& p_mm) {
  return voxel::contains({asked.base.outline_mm}, p_mm);
}

/// The point at which a saw that passes `p_mm` along `direction` meets the bone of the region.
CutSample met_along(const glm::dvec3& p_mm, const glm::dvec3& direction, const SlotsAsked& asked) {
  const ArchFrame& frame = asked.base.frame;
  const double sinks = glm::dot(direction, frame.look);
  double depth_mm = 0.5 * (asked.base.low_mm + asked.base.high_mm);
  CutSample sample;
  constexpr int rounds = 6;  // each round moves the sample closer to the point where an oblique saw meets the
                             // bone
  for (int round = 0; round < rounds; ++round) {
    const glm::dvec3 at_mm = p_mm + direction * ((depth_mm - glm::dot(p_mm, frame.look)) / sinks);
    const glm::dvec2 seen_mm = frame.project(at_mm);
    sample = {0.0, is_in(asked, seen_mm) ? On::Gap : On::Beside, at_mm};
    const std::optional<glm::dvec3> bone_mm = asked.bone_at(seen_mm);
    if (!bone_mm) return sample;
    if (sample.on == On::Gap) sample.on = On::Bone;
    sample.bone_mm = *bone_mm;
    depth_mm = glm::dot(*bone_mm, frame.look);
  }
  return sample;
}

std::vector<CutSample> along_line(const Line& line, const glm::dvec3& direction, const SlotsAsked& asked) {
  std::vector<CutSample> samples;
  const double length_mm = length_of(line);
  const int count = std::max(1, static_cast<int>(std::ceil(length_mm / step_mm)));
  for (int i = 0; i <= count; ++i) {
    const double at_mm = length_mm * i / count;
    const double from_mm = std::min(at_mm, length_mm * (1.0 - 1e-9));
    const glm::dvec3 p_mm = piece_of(line, from_mm, length_mm).front();
    samples.push_back(met_along(p_mm, direction, asked));
    samples.back().at_mm = at_mm;
  }
  return samples;
}

/// The points at which the surface of a cut meets the bone, one for each position of the sweep. For a line
/// that runs into the bone and is swept across it.
std::vector<CutSample> along_sweep(const Line& line, const glm::dvec3& sweep, double from_mm, double to_mm,
                                   const SlotsAsked& asked) {
  const glm::dvec3& look = asked.base.frame.look;
  Line points;
  const double length_mm = length_of(line);
  for (double s_mm = 0.0; s_mm < length_mm; s_mm += step_mm)
    points.push_back(piece_of(line, s_mm, length_mm).front());
  std::vector<CutSample> samples;
  const int count = std::max(1, static_cast<int>(std::ceil((to_mm - from_mm) / step_mm)));
  for (int i = 0; i <= count; ++i) {
    CutSample sample{from_mm + (to_mm - from_mm) * i / count};
    bool was_before = false;
    for (const glm::dvec3& on_line_mm : points) {
      const glm::dvec3 p_mm = on_line_mm + sweep * (sample.at_mm - glm::dot(on_line_mm, sweep));
      const glm::dvec2 seen_mm = asked.base.frame.project(p_mm);
      if (!is_in(asked, seen_mm)) continue;
      const std::optional<glm::dvec3> bone_mm = asked.bone_at(seen_mm);
      if (sample.on == On::Beside) sample.on = On::Gap;
      if (!bone_mm || glm::dot(*bone_mm - p_mm, look) > 0.0) {
        was_before = true;
        continue;
      }
      if (!was_before) break;  // the line begins within the bone, where no saw can enter
      sample.on = On::Bone;
      sample.bone_mm = *bone_mm;
      break;
    }
    samples.push_back(sample);
  }
  return samples;
}

/// The longest run of samples within the region that begins and ends on bone; empty if there is none.
std::vector<CutSample> longest_run(const std::vector<CutSample>& samples) {
  std::vector<CutSample> best, run;
  const auto close = [&] {
    while (!run.empty() && run.back().on != On::Bone) run.pop_back();
    if (run.size() > best.size()) best = run;
    run.clear();
  };
  for (const CutSample& sample : samples) {
    if (sample.on == On::Beside)
      close();
    else if (!run.empty() || sample.on == On::Bone)
      run.push_back(sample);
  }
  close();
  return best;
}

/// The ends of a slot's opening and of its walls, as lengths along the cut.
struct SlotEnds {
  double from_mm, to_mm, walls_from_mm, walls_to_mm;
};

std::optional<SlotEnds> ends_of(const std::vector<CutSample>& run, const SlotsAsked& asked) {
  if (run.empty()) return std::nullopt;
  SlotEnds ends{};
  ends.walls_from_mm = run.front().at_mm;
  ends.walls_to_mm = run.back().at_mm;
  ends.from_mm = ends.walls_from_mm + asked.end_mm;
  ends.to_mm = asked.is_open ? ends.walls_to_mm + asked.margin_mm : ends.walls_to_mm - asked.end_mm;
  if (!(ends.walls_to_mm - ends.walls_from_mm - (asked.is_open ? 1.0 : 2.0) * asked.end_mm >=
        least_opening_mm))
    return std::nullopt;
  return ends;
}

/// A blade that extends from `margin_mm` before the bone to `margin_mm` behind it.
Blade blade_through(Line line, const glm::dvec3& direction, const std::vector<CutSample>& run,
                    const SlotsAsked& asked) {
  double low_mm = std::numeric_limits<double>::infinity(), high_mm = -low_mm;
  for (const CutSample& sample : run)
    if (sample.on == On::Bone) {
      low_mm = std::min(low_mm, glm::dot(sample.bone_mm, direction));
      high_mm = std::max(high_mm, glm::dot(sample.bone_mm, direction));
    }
  low_mm -= asked.margin_mm;
  for (glm::dvec3& p_mm : line) p_mm += direction * (low_mm - glm::dot(p_mm, direction));
  return {std::move(line), direction, high_mm + asked.margin_mm - low_mm};
}

/// The result of sampling a cut: its slot if there is one, and the length over which the cut meets the bone
/// of the region.
struct SlotFound {
  std::optional<SawSlot> slot;
  double met_mm = 0.0;
  std::vector<CutSample> run;
};

SlotFound found_of(std::vector<CutSample> run) {
  SlotFound found;
  if (!run.empty()) found.met_mm = run.back().at_mm - run.front().at_mm;
  found.run = std::move(run);
  return found;
}

SlotFound slot_along_line(const Line& line, const glm::dvec3& direction,
                          const std::vector<CutSample>& samples, const SlotsAsked& asked) {
  SlotFound found = found_of(longest_run(samples));
  const std::optional<SlotEnds> ends = ends_of(found.run, asked);
  if (!ends) return found;
  const double length_mm = length_of(line), past_mm = ends->to_mm - length_mm;
  Line open = piece_of(line, ends->from_mm, std::min(ends->to_mm, length_mm));
  if (past_mm > 0.0) open = longer(open, past_mm);
  const Line walls = piece_of(line, ends->walls_from_mm, ends->walls_to_mm);
  found.slot = SawSlot{{},
                       direction,
                       0.0,
                       std::min(ends->to_mm, ends->walls_to_mm) - ends->from_mm,
                       blade_through(open, direction, found.run, asked),
                       blade_through(walls, direction, found.run, asked)};
  return found;
}

SlotFound slot_along_sweep(const Line& line, const glm::dvec3& sweep, const std::vector<CutSample>& samples,
                           const SlotsAsked& asked) {
  SlotFound found = found_of(longest_run(samples));
  const std::optional<SlotEnds> ends = ends_of(found.run, asked);
  if (!ends) return found;
  const auto swept = [&](double from_mm, double to_mm) {
    // The end of the first edge is moved outward, beyond the guide's front.
    Line points(line.rbegin(), line.rend());
    points = longer(points, 2.0 * asked.margin_mm);
    for (glm::dvec3& p_mm : points) p_mm += sweep * (from_mm - glm::dot(p_mm, sweep));
    return Blade{points, sweep, to_mm - from_mm};
  };
  found.slot = SawSlot{{},
                       glm::normalize(line[1] - line[0]),
                       0.0,
                       std::min(ends->to_mm, ends->walls_to_mm) - ends->from_mm,
                       swept(ends->from_mm, ends->to_mm),
                       swept(ends->walls_from_mm, ends->walls_to_mm)};
  return found;
}

/// Whether a point lies within the regions or within border_mm of their border. A cut that is drawn in two
/// views lies on the borders of both regions.
bool is_within(const voxel::RegionMask& regions, const glm::dvec3& p_mm) {
  constexpr double border_mm = 0.1;
  if (regions.regions.empty() || voxel::contains(regions, p_mm)) return true;
  for (int axis = 0; axis < 3; ++axis)
    for (const double by_mm : {-border_mm, border_mm}) {
      glm::dvec3 beside_mm = p_mm;
      beside_mm[axis] += by_mm;
      if (voxel::contains(regions, beside_mm)) return true;
    }
  return false;
}

/// Excludes samples whose bone lies outside of the mask's other regions, because the mask cuts nothing there.
void leave_out_beside(const voxel::RegionMask& others, std::vector<CutSample>& samples) {
  for (CutSample& sample : samples)
    if (sample.on == On::Bone && !is_within(others, sample.bone_mm)) sample.on = On::Beside;
}

/// The parts of a closed polygon that run from the bone's front into the bone along the insertion direction.
std::vector<Line> stretches_inward(const Line& polygon, const glm::dvec3& along) {
  const std::size_t count = polygon.size();
  const double least = std::cos(glm::radians(most_oblique_deg));
  std::vector<int> way(count, 0);
  for (std::size_t i = 0; i < count; ++i) {
    const glm::dvec3 edge = polygon[(i + 1) % count] - polygon[i];
    const double share = glm::length(edge) > 0.0 ? glm::dot(glm::normalize(edge), along) : 0.0;
    way[i] = share > least ? 1 : share < -least ? -1 : 0;
  }
  std::vector<Line> found;
  for (std::size_t i = 0; i < count; ++i) {
    if (way[i] == 0 || way[(i + count - 1) % count] == way[i]) continue;
    Line line{polygon[i]};
    for (std::size_t k = i; way[k % count] == way[i] && line.size() <= count; ++k)
      line.push_back(polygon[(k + 1) % count]);
    if (way[i] < 0) std::reverse(line.begin(), line.end());
    found.push_back(std::move(line));
  }
  return found;
}

/// Whether a slot already lies at the same place, because a box is drawn in two views.
bool is_double(const SlotFound& found, const std::vector<SawSlot>& slots) {
  for (const SawSlot& slot : slots) {
    std::size_t on = 0, of = 0;
    for (const CutSample& sample : found.run) {
      if (sample.on != On::Bone) continue;
      ++of;
      const Blade& blade = slot.walls;
      const glm::dvec3 flat_mm =
          sample.bone_mm +
          blade.direction * (glm::dot(blade.line_mm.front() - sample.bone_mm, blade.direction));
      double least_mm2 = std::numeric_limits<double>::infinity();
      for (std::size_t i = 1; i < blade.line_mm.size(); ++i)
        least_mm2 = std::min(
            least_mm2, brep::squared_distance_to_segment(flat_mm, blade.line_mm[i - 1], blade.line_mm[i]));
      if (least_mm2 < on_other_cut_mm * on_other_cut_mm) ++on;
    }
    if (2 * on > of) return true;
  }
  return false;
}

std::vector<SawSlot> slots_of_mask(const Mask& mask, const glm::dmat3& lps_from_head, const SlotsAsked& asked,
                                   double& longest_mm) {
  std::vector<SawSlot> slots;
  const auto view_of = [&](const Mask::Region& region) {
    voxel::View view = voxel::parse_view(region.view);
    if (mask.views_of == "head")
      view = {lps_from_head * view.look, lps_from_head * view.up, lps_from_head * view.right};
    return view;
  };
  const auto keep = [&](SlotFound found) {
    longest_mm = std::max(longest_mm, found.met_mm);
    if (!found.slot || is_double(found, slots)) return;
    found.slot->kerf_mm = asked.mask_kerf_mm;
    slots.push_back(std::move(*found.slot));
  };
  for (const bool is_swept_across : {false, true})
    for (std::size_t r = 0; r < mask.regions.size(); ++r) {
      const voxel::View view = view_of(mask.regions[r]);
      const double off_deg = angle_deg(view.look, asked.along);
      const bool is_across = off_deg > most_apart_deg && off_deg < 180.0 - most_apart_deg;
      if (is_across != is_swept_across) continue;
      voxel::RegionMask others;
      for (std::size_t other = 0; other < mask.regions.size(); ++other)
        if (other != r)
          others.regions.push_back({view_of(mask.regions[other]), mask.regions[other].polygons_mm});
      for (const std::vector<glm::dvec2>& drawn : mask.regions[r].polygons_mm) {
        Line polygon;
        for (const glm::dvec2& p_mm : drawn) polygon.push_back(p_mm.x * view.right + p_mm.y * view.up);
        if (!is_across) {
          const glm::dvec3 direction = off_deg < 90.0 ? view.look : -view.look;
          Line closed = polygon;
          // A run ends at the ends of the line, so the ends are moved to samples beside the region.
          const auto beside = std::find_if(closed.begin(), closed.end(), [&](const glm::dvec3& p_mm) {
            return met_along(p_mm, direction, asked).on == On::Beside;
          });
          if (beside != closed.end()) std::rotate(closed.begin(), beside, closed.end());
          closed.push_back(Line::value_type(closed.front()));
          std::vector<CutSample> samples = along_line(closed, direction, asked);
          leave_out_beside(others, samples);
          keep(slot_along_line(closed, direction, samples, asked));
          continue;
        }
        double low_mm = std::numeric_limits<double>::infinity(), high_mm = -low_mm;
        for (const glm::dvec2& p_mm : asked.base.outline_mm)
          for (const double depth_mm : {asked.base.low_mm, asked.base.high_mm}) {
            const ArchFrame& frame = asked.base.frame;
            const double at_mm =
                glm::dot(p_mm.x * frame.right + p_mm.y * frame.up + depth_mm * frame.look, view.look);
            low_mm = std::min(low_mm, at_mm);
            high_mm = std::max(high_mm, at_mm);
          }
        for (const Line& line : stretches_inward(polygon, asked.along)) {
          std::vector<CutSample> samples = along_sweep(line, view.look, low_mm, high_mm, asked);
          leave_out_beside(others, samples);
          keep(slot_along_sweep(line, view.look, samples, asked));
        }
      }
    }
  return slots;
}

std::vector<SawSlot> slots_of_saw(const std::string& cut, const Saw& saw, const SlotsAsked& asked,
                                  double& longest_mm) {
  const glm::dvec3 direction = glm::normalize(*saw.direction);
  const double off_deg = angle_deg(direction, asked.along);
  if (off_deg > most_oblique_deg)
    throw std::runtime_error("the saw of '" + cut + "' goes in at " + three_figures(off_deg) +
                             " degrees to the guide's insertion direction, so no guide on this side can "
                             "guide it: choose another 'side'");
  SlotFound found = slot_along_line(saw.line_mm, direction, along_line(saw.line_mm, direction, asked), asked);
  longest_mm = std::max(longest_mm, found.met_mm);
  if (!found.slot) return {};
  found.slot->kerf_mm = saw.kerf_mm;
  return {std::move(*found.slot)};
}

std::string misses(const std::string& cut) {
  return cut +
         "misses the guide, because no bone of the region lies on it: move 'points' to the cut, or leave the "
         "cut out of 'cuts'";
}

std::string too_short(const std::string& cut, double met_mm, const SlotsAsked& asked) {
  return cut + "meets the bone of the guide's region along " + three_figures(met_mm) +
         " mm, which is too short for a slot with walls of " + three_figures(asked.end_mm) +
         " mm at its ends: make the region larger, or 'slot_end_mm' smaller";
}

/// The slots of a flap's cuts. The saw enters within the plane of a cut, as nearly as possible along the
/// guide's insertion direction, and its kerf lies on one side of the plane. A cut of the resection that
/// misses the region is skipped, because it belongs to another guide.
std::vector<SawSlot> slots_of_flap(const std::string& cut, const std::vector<FlapCut>& cuts,
                                   const SlotsAsked& asked, double& longest_mm) {
  std::vector<SawSlot> slots;
  for (std::size_t i = 0; i < cuts.size(); ++i) {
    const FlapCut& plane = cuts[i];
    const std::string says = "cut " + std::to_string(i + 1) + " of '" + cut + "' ";
    if (!(plane.kerf_mm > 0.0))
      throw std::runtime_error("'kerf_mm' of '" + cut +
                               "' is 0, but a slot needs the width of the saw's cut: state it");
    const glm::dvec3 within = asked.along - plane.away * glm::dot(asked.along, plane.away);
    const ArchFrame& frame = asked.base.frame;
    const glm::dvec3 middle_mm = plane.point_mm + 0.5 * plane.kerf_mm * plane.away;
    const auto beside_mm = [&](const glm::dvec2& p_mm, double depth_mm) {
      return p_mm.x * frame.right + p_mm.y * frame.up + depth_mm * frame.look - middle_mm;
    };
    bool is_before = false, is_behind = false;
    double half_mm = 1.0;
    const bool is_led = glm::length(within) >= std::cos(glm::radians(most_oblique_deg));
    const glm::dvec3 direction = is_led ? glm::normalize(within) : asked.along,
                     across = glm::cross(plane.away, direction);
    for (const glm::dvec2& p_mm : asked.base.outline_mm)
      for (const double depth_mm : {asked.base.low_mm, asked.base.high_mm}) {
        const glm::dvec3 from_mm = beside_mm(p_mm, depth_mm);
        (glm::dot(from_mm, plane.away) < 0.0 ? is_before : is_behind) = true;
        half_mm = std::max(half_mm, 1.0 + std::abs(glm::dot(from_mm, across)));
      }
    SlotFound found;
    if (is_before && is_behind) {
      if (!is_led)
        throw std::runtime_error(says + "lies more than " + three_figures(most_oblique_deg) +
                                 " degrees off the guide's insertion direction, so no guide on this side can "
                                 "guide the saw: choose another 'side'");
      const Line line{middle_mm - half_mm * across, middle_mm + half_mm * across};
      std::vector<CutSample> samples = along_line(line, direction, asked);
      for (CutSample& sample : samples)
        if (sample.on == On::Bone && glm::distance(sample.bone_mm, middle_mm) > plane.reach_mm)
          sample.on = On::Beside;
      found = slot_along_line(line, direction, samples, asked);
    }
    longest_mm = std::max(longest_mm, found.met_mm);
    if (found.slot) {
      found.slot->kerf_mm = plane.kerf_mm;
      slots.push_back(std::move(*found.slot));
    } else if (found.met_mm > 0.0 || !plane.is_of_resection) {
      throw std::runtime_error(found.met_mm > 0.0 ? too_short(says, found.met_mm, asked) : misses(says));
    }
  }
  return slots;
}

}  // namespace

brep::Solid Blade::solid(double width_mm) const {
  return brep::saw_blade({line_mm, direction, depth_mm, width_mm});
}

voxel::Expression Blade::expression(double width_mm) const {
  return voxel::saw_blade({line_mm, direction, depth_mm, width_mm});
}

voxel::RegionMask Blade::sides(double width_mm) const {
  return voxel::saw_blade_sides({line_mm, direction, depth_mm, width_mm});
}

std::vector<SawSlot> slots_of(const std::string& cut, const SlotsAsked& asked, const SettleBench& bench) {
  const Action* maker = bench.maker_of ? bench.maker_of(cut) : nullptr;
  double longest_mm = 0.0;
  std::vector<SawSlot> slots;
  if (const Saw* saw = maker == nullptr ? nullptr : maker->get_if<Saw>())
    slots = slots_of_saw(cut, with_plane_read(*saw, bench.folder), asked, longest_mm);
  else if (const Mask* mask = maker == nullptr ? nullptr : maker->get_if<Mask>())
    slots = slots_of_mask(with_files_read(*mask, bench.folder, bench.objects.lps_from_head),
                          bench.objects.lps_from_head, asked, longest_mm);
  else if (const std::vector<FlapCut> cuts = maker == nullptr ? std::vector<FlapCut>() : flap_cuts(*maker);
           !cuts.empty())
    slots = slots_of_flap(cut, cuts, asked, longest_mm);
  else
    throw std::runtime_error("'" + cut +
                             "' is not a cut: name a saw step, a mask whose walls are cuts, or a flap's "
                             "space of a segment or resection");
  const std::string says = "the cut '" + cut + "' ";
  if (slots.empty())
    throw std::runtime_error(longest_mm > 0.0 ? too_short(says, longest_mm, asked) : misses(says));
  for (SawSlot& slot : slots) slot.cut = cut;
  return slots;
}

}  // namespace octotomy::planner
