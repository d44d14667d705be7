// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/landmark/skull_profile.h"

#include <algorithm>
#include <array>

namespace octotomy::planner {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
/// Lengths in an adult's or a child's face, in millimetres, that distinguish its parts.
constexpr double least_opening = 14.0, most_opening = 50.0;  ///< height of the nose's opening
constexpr double edge = 5.0;          ///< least step from bone to the surface behind it
constexpr double spine_reach = 10.0;  ///< the nasal spine lies within this distance below the opening's floor
constexpr double least_alveolar = 10.0, most_alveolar = 45.0;  ///< from the spine to the upper incisors' edge
constexpr double tooth_step = 1.5;                             ///< least backward step at a tooth's edge,
                                                               ///< within tooth_step_over
constexpr double tooth_step_over = 2.0;
constexpr double crown = 9.0;             ///< height of an incisor
constexpr double receding = 28.0;         ///< largest distance of the chin behind the nasal spine
constexpr double least_mandible = 20.0;   ///< least height of the mandible in the mid-line
constexpr double chin = 22.0;             ///< its height
constexpr double between_chins = 3.0;     ///< half the allowed distance between the foremost point of a chin
                                          ///< and the point farthest in front of its chord
constexpr double hollow = 1.0;            ///< least depth of a concavity between its neighbours
constexpr double most_nasal_bone = 25.0;  ///< above the opening
constexpr double widest_end = 25.0;  ///< largest width, from front to back, of the lowest row of bone that
                                     ///< ends naturally
constexpr double scan_end = 2.0;     ///< bone that ends within this distance of the scan's end is cut off by
                                     ///< it
constexpr double least_brow = 12.0, most_brow = 45.0;  ///< above the nose's tip
constexpr double stands_out = 0.7;  ///< least distance of a spine's tip in front of the bone below it
constexpr double spine_end = 1.1;   ///< largest distance of the spine's upper end behind its foremost point
constexpr double spine_line =
    12.0;  ///< the line before which the spine stands ends at this distance below the opening's floor
constexpr double flat = 0.4;  ///< rows whose depths differ by less than this cannot be ranked
/// Shares of the height from nasion to spine: the least distance of an upper incisor's edge from the spine,
/// and of a lower incisor's edge from the chin. Without teeth, the ridges lie at 0.33 and 0.6.
constexpr double most_upper_tooth = 0.85;
constexpr double least_upper_tooth = 0.38, least_lower_tooth = 0.7;
/// Beyond the share sure_lower_tooth an edge is certainly a tooth's. Between this and least_lower_tooth it is
/// a tooth's if it lies at most closed_bite below the upper incisors.
constexpr double sure_lower_tooth = 0.92, closed_bite = 6.0;
constexpr double notch = 5.0;  ///< largest rise of the middle of an intact chin's lower border
/// The region in which the two sides are compared: like_height above and below a row, and like_begin to
/// like_end from the middle. The middle is searched for within most_aside of the mid-plane.
constexpr double like_height = 8.0, like_begin = 3.0, like_end = 24.0, most_aside = 9.0;

/// The foremost row of first..last. Rows within a third of a millimetre count as equal; of these, returns the
/// middle one.
int foremost(const Profile& profile, int first, int last) {
  double best = infinite;
  for (int k = first; k <= last; ++k) best = std::min(best, profile.back_mm[static_cast<std::size_t>(k)]);
  int begin = -1, end = -1;
  for (int k = first; k <= last; ++k)
    if (profile.back_mm[static_cast<std::size_t>(k)] <= best + 0.3) {
      if (begin < 0) begin = k;
      end = k;
    }
  return begin < 0 ? first : (begin + end) / 2;
}

class Reader {
 public:
  Reader(const Profile& profile, const NasalOpening& nose)
      : profile_(profile), nose_(nose), is_notched_(profile.chin_notch_mm > notch) {}

  FoundPlaces read() {
    above_nose();
    below_nose();
    return std::move(found_);
  }

 private:
  double back(int k) const {
    return k < 0 || k >= profile_.rows() ? infinite : profile_.back_mm[static_cast<std::size_t>(k)];
  }
  int rows_of(double length_mm) const { return static_cast<int>(std::lround(length_mm / profile_.step_mm)); }
  int within(int k) const { return std::clamp(k, 0, profile_.rows() - 1); }
  /// Places a landmark at row k, the last row above an edge. Reports it as missing if the scan ends there.
  void place_end(const char* name, int k) {
    if (profile_.up_mm(k) < profile_.cut_mm + scan_end) return miss(name, "the scan ends there");
    place(name, k);
  }
  void place(const char* name, int k) {
    found_.places[name] = {profile_.middle_mm[static_cast<std::size_t>(k)], back(k), profile_.up_mm(k)};
  }
  /// Adds to the doubt the distance to the farthest row that is equally far in front, in the profile rotated
  /// so that the extremum is foremost. Noise and the samples' spacing may shift the extremum to that row,
  /// even across rows that are less far in front.
  template <typename Depth>
  void add_flat(const char* name, int k, int first, int last, const Depth& depth) {
    int low = k, high = k;
    for (int i = first; i <= last; ++i)
      if (depth(i) >= depth(k) - flat) low = std::min(low, i), high = std::max(high, i);
    found_.doubt_mm[name] += std::max(k - low, high - k) * profile_.step_mm;
  }
  void miss(const char* name, const char* why) { found_.missing[name] = why; }

  /// The nose's root is the point deepest behind the tangent from the nasal bones' foremost point to the
  /// brow; this does not depend on the head's pitch.
  void above_nose() {
    const int top = profile_.row(nose_.top_mm);
    const int tip = foremost(profile_, within(top - rows_of(most_nasal_bone)), top);
    int brow = -1;
    const auto slope = [&](int k) { return (back(k) - back(tip)) / (tip - k); };
    for (int k = within(tip - rows_of(least_brow)); k >= within(tip - rows_of(most_brow)); --k)
      if (brow < 0 || slope(k) < slope(brow)) brow = k;
    if (brow < 0 || !(slope(brow) < infinite))
      return miss("nasion", "there is no brow over the nose in this scan");
    place_hollow("nasion", brow, tip, "the profile has no hollow between nose and brow");
  }

  void below_nose() {
    const int floor = profile_.row(nose_.floor_mm);
    const int ans = foremost(profile_, floor, within(floor + rows_of(spine_reach)));
    // The spine's tip is the highest row of those that are equally far in front.
    int tip = ans;
    while (tip > floor && back(tip - 1) <= back(ans) + 0.5) --tip;
    place_spine(floor, tip);
    const int last = end_of_front(tip);
    const glm::dvec3* nasion = found_.find("nasion");
    nose_height_ = nasion == nullptr ? 0.0 : nasion->z - profile_.up_mm(tip);
    const int incisor = incisor_below(tip, last);
    if (incisor < 0) {
      for (const char* name : {"incisor", "a_point", "lower_incisor"})
        miss(name, "no edge of the upper incisors is visible below the nasal spine");
    } else if ((incisor - tip) * profile_.step_mm < least_upper_tooth * nose_height_) {
      for (const char* name : {"incisor", "a_point", "lower_incisor"})
        miss(name,
             "the bone ends too near to the nasal spine for the edge of a tooth: the upper incisors are "
             "missing");
    } else {
      place_end("incisor", incisor);
      place_hollow("a_point", tip, incisor - rows_of(crown));
    }
    mandible(incisor < 0 ? tip : incisor, last);
  }

  /// Places the tip of the nasal spine at the first row that projects in front of the rows below it, or at
  /// `foremost_row` if there is none. If the spine continues into the bone below it, its upper end is the
  /// tip. A second rule, which does not depend on the head's pitch, finds the row farthest in front of the
  /// line from the opening's floor to the bone below. Its distance from the tip contributes to the tip's
  /// doubt, which is at most 3 mm. If neither rule finds a spine, the tip is missing.
  void place_spine(int floor, int foremost_row) {
    const int end = within(floor + rows_of(spine_line));
    int first = -1;
    double most = infinite;
    for (int k = floor, at = floor; k <= end + rows_of(2.0) && first < 0; ++k) {
      if (back(k) < most) most = back(k), at = k;
      if (back(k) > most + stands_out && k > at) first = at;
    }
    const auto before = [&](int k) {
      return back(floor) + (back(end) - back(floor)) * (k - floor) / std::max(end - floor, 1) - back(k);
    };
    int second = floor;
    for (int k = floor; k < end; ++k)
      if (before(k) > before(second)) second = k;
    const bool is_prominent = before(second) >= 1.0;
    if (first < 0 && !is_prominent)
      return miss("ans", "no spine projects in front of the bone below the nose's opening");
    // If a spine continues into the bone below it, its upper end is the tip.
    const int lies = first < 0 ? foremost_row : first;
    int tip = lies;
    while (tip > floor && back(tip - 1) <= back(lies) + spine_end) --tip;
    place("ans", tip);
    const double apart = std::max(lies - tip, is_prominent ? std::abs(tip - second) : 0) * profile_.step_mm;
    found_.doubt_mm["ans"] = 0.5 * std::min(apart, 6.0);
  }

  /// The last row of the face: below it all bone lies far behind, over a height greater than that of an open
  /// mouth.
  int end_of_front(int tip) const {
    int last = tip, gap = 0;
    for (int k = tip; k < profile_.rows() && gap < rows_of(most_alveolar); ++k) {
      const bool is_front = back(k) < back(tip) + receding;
      gap = is_front ? 0 : gap + 1;
      if (is_front) last = k;
    }
    return last;
  }

  /// The last row before the first backward step that is about as large as the largest one; -1: none.
  int incisor_below(int tip, int last) const {
    const int over = rows_of(tooth_step_over);
    const int first = tip + rows_of(least_alveolar), lowest = std::min(last, tip + rows_of(most_alveolar));
    // In an open mouth the profile falls back to the cervical spine, so a deeper fall is not a stronger sign
    // of an edge.
    const auto fall = [&](int k) { return std::min(back(k + over) - back(k), edge); };
    double most = 0.0;
    for (int k = first; k <= lowest; ++k) most = std::max(most, fall(k));
    if (most < tooth_step) return -1;
    int k = first;
    while (fall(k) < 0.6 * most) ++k;
    // The profile may step back at the edge of the ridge as far as at the edge of the teeth. The lower edge
    // is that of the teeth.
    const int near = tip + static_cast<int>(least_upper_tooth * nose_height_ / profile_.step_mm) + 1;
    const int far =
        std::min(lowest, tip + static_cast<int>(most_upper_tooth * nose_height_ / profile_.step_mm));
    for (int lower = near; lower <= far && k < near; ++lower)
      if (fall(lower) >= std::max(0.6 * most, tooth_step)) k = lower;
    // The row of the step: the greatest fall from one row to the next.
    int at = k;
    for (int i = k; i < k + over; ++i)
      if (back(i + 1) - back(i) > back(at + 1) - back(at)) at = i;
    return at;
  }

  void mandible(int above, int last) {
    const char* none = "there is no chin below the teeth in this scan";
    if ((last - above) < rows_of(least_mandible)) {
      for (const char* name : {"menton", "pogonion", "b_point", "lower_incisor"}) miss(name, none);
      return;
    }
    if (is_notched_)
      for (const char* name : {"menton", "pogonion"})
        miss(name,
             "the chin's lower border rises in the middle: bone is missing there, or other material adjoins "
             "it");
    else
      place_end("menton", last);
    int first = above + 1;
    while (first < last && back(first) >= back(above) + edge + crown) ++first;
    const bool is_seen = first > above + 1 && found_.find("incisor") != nullptr;
    const double over_chin = (last - first) * profile_.step_mm;
    const bool is_closed = (first - above) * profile_.step_mm <= closed_bite;
    if (is_seen && over_chin < least_lower_tooth * nose_height_)
      miss("lower_incisor",
           "the bone ends too near to the chin for the edge of a tooth: the lower incisors are missing");
    else if (is_seen && !is_closed && over_chin < sure_lower_tooth * nose_height_)
      miss("lower_incisor", "the bite is open, and the bone's edge below it may not be that of a tooth");
    else if (is_seen)
      place("lower_incisor", first);
    else
      miss("lower_incisor", "seen from the front it is hidden behind the upper incisors");
    const int high = std::max(first + rows_of(crown), last - rows_of(chin));
    const int foremost_chin = pogonion_between(high, last);
    if (foremost_chin < 0) {
      miss("pogonion", "no point of the chin stands in front of the bone above it");
      return miss("b_point", "no point of the chin stands in front of the bone above it");
    }
    if (!is_notched_) place("pogonion", foremost_chin);
    if (found_.find("lower_incisor") == nullptr)
      return miss(
          "b_point",
          "it is searched for between the lower incisors and the chin, and one of them was not found");
    place_hollow("b_point", first + rows_of(crown), foremost_chin);
  }

  /// The foremost row, if the bone above it lies behind it by at least `hollow`. For a flat or receding chin
  /// or an open jaw there is no such row: then the row farthest in front of the line between both ends, which
  /// hardly depends on the head's pitch. -1 if no row lies in front of that line by at least `hollow`.
  int pogonion_between(int high, int last) {
    const int row = foremost(profile_, high, last);
    double above = back(row);
    for (int k = high; k < row; ++k) above = std::max(above, back(k));
    if (above >= back(row) + hollow) {
      add_flat("pogonion", row, high, last, [&](int k) { return -back(k); });
      return row;
    }
    const auto before = [&](int k) {
      return back(high) + (back(last) - back(high)) * (k - high) / std::max(last - high, 1) - back(k);
    };
    int best = high;
    for (int k = high; k <= last; ++k)
      if (before(k) > before(best)) best = k;
    if (!(before(best) >= hollow)) return -1;
    found_.doubt_mm["pogonion"] += between_chins;
    add_flat("pogonion", best, high, last, before);
    return best;
  }

  /// The row farthest behind the line between two rows; missing if none lies behind it by at least `hollow`.
  void place_hollow(const char* name, int first, int last,
                    const char* why = "the profile has no hollow there") {
    const double run = last - first, rise = back(last) - back(first);
    // The distance perpendicular to the line, in millimetres.
    const auto depth = [&](int k) {
      return (back(k) - back(first) - rise * (k - first) / run) /
             std::hypot(1.0, rise / (run * profile_.step_mm));
    };
    int at = -1;
    for (int k = first + 1; k < last; ++k)
      if (back(k) < infinite && (at < 0 || depth(k) > depth(at))) at = k;
    if (at < 0 || !(depth(at) >= hollow)) return miss(name, why);
    place(name, at);
    add_flat(name, at, first, last, [&](int k) { return back(k) < infinite ? depth(k) : -infinite; });
  }

  const Profile& profile_;
  NasalOpening nose_;
  bool is_notched_;
  double nose_height_ = 0.0;  ///< the height from spine to nasion; 0: unknown
  FoundPlaces found_;
};

/// The position, left of the mid-plane, about which the two sides of the face are most alike near a row. It
/// is 0, the mid-plane, unless another position is clearly better.
double middle_at(const HeadMap& front, int row) {
  const int high = static_cast<int>(like_height / front.step_mm()),
            step = std::max(1, static_cast<int>(1.0 / front.step_mm()));
  const auto unlike = [&](double aside) {
    std::vector<double> off;
    for (int j = row - high; j <= row + high; j += step)
      for (double out = like_begin; out <= like_end; out += 1.0) {
        const double left = front.at(front.column(aside + out), j),
                     right = front.at(front.column(aside - out), j);
        if (std::isfinite(left) && std::isfinite(right))
          off.push_back(std::abs(left - right));
        else if (std::isfinite(left) != std::isfinite(right))
          off.push_back(15.0);
      }
    if (off.size() < 20) return infinite;
    // The mean of the two thirds with the smaller differences, because streaks and holes are on one side
    // only.
    const auto kept = static_cast<std::ptrdiff_t>(off.size() * 2 / 3);
    std::nth_element(off.begin(), off.begin() + kept, off.end());
    double sum = 0.0;
    for (auto at = off.begin(); at != off.begin() + kept; ++at) sum += std::min(*at, 15.0);
    return sum / static_cast<double>(kept);
  };
  double best = unlike(0.0) * 0.85, at = 0.0;
  for (double aside = -most_aside; aside <= most_aside; aside += 0.5)
    if (const double here = unlike(aside); here < best) best = here, at = aside;
  return at;
}

/// Whether the bone on both sides of the mid-line stands in front of the surface in the mid-line at this
/// height.
bool is_between_rims(const HeadMap& front, int row, double back_mm) {
  for (const double side : {-1.0, 1.0}) {
    bool is_rim = false;
    for (double x = 4.0; x <= 25.0 && !is_rim; x += front.step_mm())
      is_rim = front.at(front.column(side * x), row) < back_mm - edge;
    if (!is_rim) return false;
  }
  return true;
}

}  // namespace

int Profile::row(double up) const {
  return std::clamp(static_cast<int>(std::lround((top_mm - up) / step_mm)), 0, rows() - 1);
}

Profile profile_of(const HeadMap& front, double within_mm) {
  Profile profile;
  profile.step_mm = front.step_mm();
  profile.top_mm = front.y_mm(front.size().y - 1);
  // Computes the middle of a row every 4 mm, then the median of five of these.
  const int apart = std::max(1, static_cast<int>(std::lround(4.0 / front.step_mm())));
  std::vector<double> middles;
  for (int j = front.size().y - 1; j >= 0; j -= apart) middles.push_back(middle_at(front, j));
  const auto middle = [&](int row) {
    const int at = (front.size().y - 1 - row) / apart, last = static_cast<int>(middles.size()) - 1;
    std::array<double, 5> five{};
    for (int k = 0; k < 5; ++k)
      five[static_cast<std::size_t>(k)] = middles[static_cast<std::size_t>(std::clamp(at + k - 2, 0, last))];
    std::sort(five.begin(), five.end());
    return five[2];
  };
  for (int j = front.size().y - 1; j >= 0; --j) {
    double foremost_mm = infinite;
    profile.middle_mm.push_back(middle(j));
    const double at = profile.middle_mm.back();
    for (int i = front.column(at - within_mm); i <= front.column(at + within_mm); ++i)
      if (const double back_mm = front.at(i, j); back_mm < foremost_mm) foremost_mm = back_mm;
    profile.back_mm.push_back(foremost_mm);
  }
  return profile;
}

double chin_notch(const HeadMap& front, const Profile& profile, const NasalOpening& nose) {
  // Only bone of the face counts, because a neck lies far behind.
  const double floor_mm = profile.back_mm[static_cast<std::size_t>(profile.row(nose.floor_mm))];
  int lowest = profile.rows() - 1;
  while (lowest > 0 && !(profile.back_mm[static_cast<std::size_t>(lowest)] < floor_mm + receding)) --lowest;
  const double middle = profile.middle_mm[static_cast<std::size_t>(lowest)];
  const auto end = [&](double aside) {
    for (int j = 0; j < front.size().y; ++j)
      if (front.at(front.column(middle + aside), j) < floor_mm + receding) return front.y_mm(j);
    return infinite;
  };
  double beside = infinite;
  for (double aside = 5.0; aside <= 16.0; aside += 1.0) beside = std::min({beside, end(aside), end(-aside)});
  return end(0.0) - beside;
}

FoundPlaces places_of_profile(const Profile& profile, const NasalOpening& nose) {
  return Reader(profile, nose).read();
}

double cut_height(const HeadMap& side) {
  for (int j = 0; j < side.size().y; ++j) {
    int count = 0;
    for (int i = 0; i < side.size().x; ++i) count += std::isfinite(side.at(i, j)) ? 1 : 0;
    if (count == 0) continue;
    return count * side.step_mm() > widest_end ? side.y_mm(j) : -infinite;
  }
  return -infinite;
}

std::optional<NasalOpening> find_nasal_opening(const Profile& profile, const HeadMap& front) {
  const auto back = [&](int k) { return profile.back_mm[static_cast<std::size_t>(k)]; };
  const int over = static_cast<int>(std::lround(tooth_step_over / profile.step_mm));
  for (int k = 0; k + over < profile.rows(); ++k) {
    // The lower end of the nasal bones, where the profile falls back abruptly.
    if (!(back(k) < infinite) || back(k + over) - back(k) < edge) continue;
    int top = k;
    for (int i = k; i < k + over; ++i)
      if (back(i + 1) - back(i) > back(top + 1) - back(top)) top = i;
    // The opening ends where bone stands in front of all its rows except the last ones; these are excluded
    // because the floor slopes.
    int floor = top + static_cast<int>(least_opening / profile.step_mm);
    double nearest = infinite;
    for (int seen = top + over; floor < profile.rows(); ++floor) {
      for (; seen < floor - 2 * over; ++seen) nearest = std::min(nearest, back(seen));
      if (back(floor) < nearest - edge) break;
    }
    const double height = (floor - top) * profile.step_mm;
    if (floor >= profile.rows() || height > most_opening) continue;
    const double middle = profile.up_mm((top + floor) / 2);
    if (is_between_rims(front, front.row(middle), back((top + floor) / 2)))
      return NasalOpening{profile.up_mm(top), profile.up_mm(floor)};
  }
  return std::nullopt;
}

}  // namespace octotomy::planner
