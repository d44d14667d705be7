// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/landmark/face_rules.h"

#include <algorithm>
#include <array>
#include <functional>

namespace octotomy::planner {
namespace {

/// Lengths in a face, in millimetres.
constexpr double rim_step = 8.0;           ///< least depth of the step behind a rim
constexpr double rim_reach = 3.0;          ///< least length of a rim
constexpr double above_spine = 4.0;        ///< height above the nasal spine at which the piriform rim is
                                           ///< measured
constexpr double below_rim = 8.0;          ///< height below the piriform rim at which the buttress is
                                           ///< measured
constexpr double deepest_buttress = 42.0;  ///< from the nasal spine backward; a surface behind this is the
                                           ///< ramus
constexpr double broken = 4.0;             ///< a larger step backward ends a surface
constexpr double most_hole = 9.0;          ///< largest width of a hole in thin bone across which the surface
                                           ///< continues
constexpr double small_hole = 1.1;         ///< of a voxel
constexpr double blurred_step = 3.0;       ///< width of the slope that blur makes of a step
constexpr double two_ends = 3.0;           ///< largest distance between two results for the maxilla's outer
                                           ///< end
constexpr double orbit_above_nose = 6.0;   ///< a height within the orbits, above the top of the nose's
                                           ///< opening
constexpr double least_orbit = 18.0, most_orbit = 42.0;  ///< from the mid-plane
constexpr double orbit_height = 32.0;
constexpr double two_rims = 8.0;  ///< largest distance between the results of two rules for a rim
constexpr double crest = 6.0;     ///< on a crest, no bone within this distance below stands in front of it
/// Places within `as_far_out` of the outermost one count as equally far out, because of noise. Places within
/// `as_far_down` count as equally far down and back, because of an uncertain pitch.
constexpr double as_far_out = 0.25, as_far_down = 1.0;
constexpr double arch_begin = 15.0, arch_end = 78.0;  ///< behind the nasal spine
constexpr double arch_beyond = 16.0;                  ///< the arch of a large head may extend this far beyond
                                                      ///< arch_end
constexpr double arch_end_dip = 0.6;                  ///< behind the arch's outermost place the bone must
                                                      ///< step inward by this
constexpr double least_half_face = 45.0, most_half_face = 80.0;
constexpr double least_angle = 34.0, most_angle = 75.0;  ///< of the mandible's angle from the mid-plane
constexpr double angle_begin = 40.0, angle_end = 88.0;   ///< behind the chin
constexpr double angle_share = 0.6;  ///< the mandible's angle lies below this share of the height from chin
                                     ///< to nasal spine
constexpr double nose_root = 12.0;   ///< over the nose's opening
constexpr double nose_root_width = 2.0, nose_root_depth = 30.0;  ///< distance beside the mid-plane; largest
                                                                 ///< depth behind the nose

using Side = std::pair<const char*, double>;
constexpr std::array<Side, 2> sides{{{"_left", 1.0}, {"_right", -1.0}}};

class Face {
 public:
  Face(const HeadMaps& maps, const NasalOpening& nose, double higher_mm, const Side& side, FoundPlaces& found)
      : maps_(maps), nose_(nose), higher_mm_(higher_mm), side_(side), found_(found) {}

  void find() {
    piriform_and_buttress();
    orbit();
    arch();
    angle();
  }

 private:
  void place(const std::string& name, const glm::dvec3& at) { found_.places[name + side_.first] = at; }
  void doubt(const std::string& name, double mm) { found_.doubt_mm[name + side_.first] = mm; }
  void miss(const std::string& name, const std::string& why) { found_.missing[name + side_.first] = why; }
  /// The backward coordinate at which bone begins, at the distance `out_mm` from the mid-plane on this side.
  double front(double out_mm, int row) const {
    return maps_.front.at(maps_.front.column(side_.second * out_mm), row);
  }
  const HeadMap& from_side() const { return side_.second > 0.0 ? maps_.left : maps_.right; }
  double step() const { return maps_.front.step_mm(); }

  /// Finds the rim of the nose's opening: the first bone from the mid-line outwards that is about as far in
  /// front as the foremost. Then finds the outer end of that surface, the buttress.
  void piriform_and_buttress() {
    const glm::dvec3* ans = found_.find("ans");
    if (ans == nullptr) {
      miss("piriform", "the nasal spine was not found");
      return miss("buttress", "the nasal spine was not found");
    }
    const auto rim_at = [&](int row) {
      double foremost_mm = std::numeric_limits<double>::infinity();
      for (double out = 8.0; out <= 30.0; out += step())
        if (front(out, row) < foremost_mm) foremost_mm = front(out, row);
      double run = 0.0;
      for (double out = 4.0; out <= 30.0; out += step()) {
        run = front(out, row) <= foremost_mm + rim_step ? run + step() : 0.0;
        if (run >= rim_reach) return out - run + step();
      }
      return -1.0;
    };
    const int row = maps_.front.row(ans->z + above_spine + higher_mm_);
    const double rim = rim_at(row);
    if (rim < 0.0) {
      miss("piriform", "no rim of the nose's opening stands in front of its inside");
      return miss("buttress", "no rim of the nose's opening stands in front of its inside");
    }
    // Second rule: the outer end of the largest forward rise of the surface over 1.5 mm.
    double step_back = rim, most = 0.0;
    for (double out = 4.0; out <= 24.0; out += step()) {
      const double deep = front(out, row),
                   rise = std::min(std::isnan(deep) ? 60.0 : deep - front(out + 1.5, row), 60.0);
      const double next = front(out + 1.5, row);
      if (std::isfinite(next) && rise > most) most = rise, step_back = out + 1.5;
    }
    if (std::abs(step_back - rim) > two_rims)
      miss("piriform", "two rules for the rim of the nose's opening gave results more than 8 mm apart");
    else {
      place("piriform", {side_.second * rim, front(rim, row), maps_.front.y_mm(row)});
      doubt("piriform", 0.7 * std::abs(step_back - rim));
    }
    const int lower = maps_.front.row(ans->z + above_spine - below_rim + higher_mm_);
    // Goes outwards from the rim until the surface steps back by `break_mm` or a hole of `hole_mm` follows.
    const double begin = std::max(rim_at(lower), rim) + 1.0;
    const auto end_at = [&](double hole_mm, double break_mm) {
      double out = begin;
      for (double next = out + step(); next < std::min(out + hole_mm, most_half_face); next += step())
        if (std::abs(front(next, lower) - front(out, lower)) < break_mm) out = next;
      return out;
    };
    const double out = end_at(most_hole, broken);
    // The end is unclear if a smaller step or hole gives another end, because the bone behind may be another
    // bone. Blur makes a slope of a step.
    bool is_clear = out - end_at(small_hole, 0.6 * broken) <= two_ends;
    for (double at = begin; at < out - two_ends && is_clear; at += step())
      is_clear = !(front(at + blurred_step, lower) - front(at, lower) > 2.0 * broken);
    if (!is_clear)
      return miss("buttress", "the maxilla has no clear outer end, because its surface has steps or holes");
    if (out + step() >= most_half_face || !(out > rim + 10.0) ||
        front(out, lower) > ans->y + deepest_buttress)
      return miss("buttress", "the maxilla's outer end is not visible from the front");
    place("buttress", {side_.second * out, front(out, lower), maps_.front.y_mm(lower)});
  }

  /// The row of the orbit's rim in a column: the first crest below the row `first` within the orbit; -1:
  /// none.
  int rim_row(double out, int first) const {
    const double inside = front(out, first);
    const int rows = static_cast<int>(orbit_height / step()), below = static_cast<int>(crest / step());
    if (!std::isfinite(inside)) return -1;
    for (int j = first; j > first - rows; --j) {
      const double here = front(out, j);
      if (!(inside - here >= rim_step)) continue;
      bool is_crest = true;
      for (int i = j - 1; i >= j - below && is_crest; --i) is_crest = !(front(out, i) < here - 0.7);
      if (is_crest) return j;
    }
    return -1;
  }

  /// The row at or slightly above a crest's row in which the rim faces as much up as forward; -1 stays -1.
  int edge_row(double out, int crest_row) const {
    if (crest_row < 0) return crest_row;
    int best = crest_row;
    const auto reach = [&](int j) { return maps_.front.y_mm(j) - front(out, j); };
    for (int j = crest_row; j <= crest_row + static_cast<int>(crest / step()); ++j)
      if (reach(j) > reach(best)) best = j;
    return best;
  }

  void orbit() {
    const int first = maps_.front.row(nose_.top_mm + orbit_above_nose);
    // The median of five columns excludes single outliers, such as a foramen.
    std::vector<std::pair<int, double>> rims;
    std::vector<int> rows;
    for (double out = least_orbit; out <= most_orbit; out += step()) {
      rows.push_back(edge_row(out, rim_row(out, first)));
      if (rows.size() < 5) continue;
      std::array<int, 5> five{};
      std::copy(rows.end() - 5, rows.end(), five.begin());
      std::sort(five.begin(), five.end());
      if (five[0] >= 0) rims.emplace_back(five[2], out - 2.0 * step());
    }
    if (rims.empty()) return miss("orbitale", "no rim of an orbit is visible from the front");
    const int lowest = std::min_element(rims.begin(), rims.end())->first;
    std::vector<double> across;
    for (const auto& [row, out] : rims)
      if (row <= lowest + 1) across.push_back(out);
    const double out = across[across.size() / 2];
    place("orbitale", {side_.second * out, front(out, lowest), maps_.front.y_mm(lowest)});
    doubt("orbitale", 0.5 * (across.back() - across.front()));
  }

  using Reach = std::function<std::optional<double>(const glm::dvec3&)>;
  struct Window {
    glm::dvec2 low, high;    ///< back and up
    double as_far = 0.0;     ///< places within this of the farthest count as equally far
    double beyond_mm = 0.0;  ///< the search continues this far beyond the window if the bone has not ended
                             ///< there
  };

  /// The points in a column of this side's map, within the window's heights, whose measure is at least
  /// `least`; each with its measure.
  std::vector<std::pair<double, glm::dvec3>> reaching(int column, const Window& window, const Reach& reach,
                                                      double least) const {
    const HeadMap& map = from_side();
    std::vector<std::pair<double, glm::dvec3>> found;
    for (int j = map.row(window.low.y); j <= map.row(window.high.y); ++j) {
      const glm::dvec3 at(map.at(column, j), map.x_mm(column), map.y_mm(j));
      if (!std::isfinite(at.x)) continue;
      const std::optional<double> value = reach(at);
      if (value && *value >= least) found.emplace_back(*value, at * glm::dvec3(side_.second, 1.0, 1.0));
    }
    return found;
  }

  /// The mean of the places in this side's map whose measure is largest or equally large; none if the window
  /// cuts off the extremum. Sets the doubt to the distance from the mean to the farthest of these places.
  std::optional<glm::dvec3> farthest(const std::string& name, const Window& window, const Reach& reach) {
    const HeadMap& map = from_side();
    double most = -std::numeric_limits<double>::infinity(), end_mm = window.high.x;
    bool is_passed = false;
    std::vector<std::pair<double, glm::dvec3>> near;
    for (int i = map.column(window.low.x); i <= map.column(window.high.x + window.beyond_mm); ++i) {
      if (i > map.column(window.high.x) && is_passed) break;
      end_mm = std::max(end_mm, map.x_mm(i));
      double here = -std::numeric_limits<double>::infinity();
      for (const auto& one : reaching(i, window, reach, most - window.as_far)) {
        near.push_back(one);
        here = std::max(here, one.first);
      }
      if (here > most) is_passed = false;
      most = std::max(most, here);
      if (reaching(i, window, reach, most - arch_end_dip).empty()) is_passed = true;
    }
    std::erase_if(near, [&](const auto& one) { return one.first < most - window.as_far; });
    if (near.empty()) return std::nullopt;
    glm::dvec3 mean(0.0);
    for (const auto& [value, at] : near) mean += at / static_cast<double>(near.size());
    // At the window's end, the largest measure is not an extremum of the bone.
    if (mean.y > end_mm - 1.0 || mean.y < window.low.x + 1.0 || mean.z > window.high.y - 1.0)
      return std::nullopt;
    double far_mm = 0.0;
    for (const auto& [value, at] : near) far_mm = std::max(far_mm, glm::distance(at, mean));
    doubt(name, far_mm);
    return mean;
  }

  void arch() {
    const glm::dvec3* ans = found_.find("ans");
    const glm::dvec3* orbitale = found_.find(std::string("orbitale") + side_.first);
    if (ans == nullptr || orbitale == nullptr)
      return miss("zygoma",
                  "it is searched for between the nasal spine and the orbit, and one of them was not found");
    const auto outermost = farthest(
        "zygoma",
        {{ans->y + arch_begin, ans->z}, {ans->y + arch_end, orbitale->z + 5.0}, as_far_out, arch_beyond},
        [](const glm::dvec3& at) { return std::optional(at.x); });
    if (!outermost || std::abs(outermost->x) < least_half_face)
      return miss("zygoma", "no zygomatic arch is visible from the side");
    place("zygoma", *outermost);
  }

  void angle() {
    const glm::dvec3* menton = found_.find("menton");
    const glm::dvec3* ans = found_.find("ans");
    if (menton == nullptr || ans == nullptr)
      return miss("gonion", "it is searched for between chin and nasal spine, and one of them was not found");
    const auto most = farthest("gonion",
                               {{menton->y + angle_begin, menton->z - 5.0},
                                {menton->y + angle_end, menton->z + angle_share * (ans->z - menton->z)},
                                as_far_down},
                               [](const glm::dvec3& at) -> std::optional<double> {
                                 if (at.x < least_angle || at.x > most_angle) return std::nullopt;
                                 return (at.y - at.z) / std::sqrt(2.0);
                               });
    if (!most) return miss("gonion", "no angle of a mandible is visible from the side");
    place("gonion", *most);
  }

  const HeadMaps& maps_;
  NasalOpening nose_;
  double higher_mm_;
  Side side_;
  FoundPlaces& found_;
};

}  // namespace

void find_face_places(const HeadMaps& maps, const NasalOpening& nose, double higher_mm, FoundPlaces& found) {
  for (const Side& side : sides) Face(maps, nose, higher_mm, side, found).find();
}

void find_nose_root(const HeadMaps& maps, const NasalOpening& nose, FoundPlaces& found) {
  const Profile profile = profile_of(maps.front, nose_root_width);
  const auto back = [&](double up_mm) {
    return profile.back_mm[static_cast<std::size_t>(profile.row(up_mm))];
  };
  const double root_mm = nose.top_mm + nose_root;
  if (back(root_mm) < back(nose.top_mm) + nose_root_depth)
    found.places["midline_front"] = {profile.middle_mm[static_cast<std::size_t>(profile.row(root_mm))],
                                     back(root_mm), root_mm};
  else
    found.missing["midline_front"] = "no bone is visible above the nose's opening";
}

}  // namespace octotomy::planner
