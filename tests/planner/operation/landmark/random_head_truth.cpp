// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Landmarks of a random head: extremal points of the closed form in windows of the phantom about them, in the
// head's own frame, to a tenth of a millimetre. Nothing here reads a scan or a map.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "tests/planner/operation/landmark/random_head.h"

namespace octotomy::tests {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double fine_mm = 0.2;

struct Window {
  glm::dvec3 low, high;  ///< canonical
};

class Truth {
 public:
  explicit Truth(const RandomHead& head) : head_(head) {}

  std::map<std::string, glm::dvec3> find() {
    midline();
    for (const double side : {1.0, -1.0}) {
      const std::string name = side > 0.0 ? "_left" : "_right";
      keep("zygoma" + name, farthest({{side * 52, -52, -22}, {side * 80, 0, 4}}, {side, 0, 0}));
      keep("gonion" + name,
           farthest({{side * 34, -40, -90}, {side * 66, 0, -50}}, glm::normalize(glm::dvec3(0, 1, -1))));
      orbit(name, side);
      rim(name, side);
    }
    return std::move(found_);
  }

 private:
  void keep(const std::string& name, const std::optional<glm::dvec3>& p) {
    if (p) found_[name] = *p;
  }

  /// The bone within a window that lies farthest along a direction of the head; the middle of what is as far
  /// to a tenth of a millimetre.
  std::optional<glm::dvec3> farthest(const Window& window, const glm::dvec3& along) const {
    const auto crest_within = [&](const glm::dvec3& low, const glm::dvec3& high, double step) {
      constexpr double as_far = 0.1;
      double most = -infinite;
      std::vector<std::pair<double, glm::dvec3>> near;
      for (double x = low.x; x <= high.x; x += step)
        for (double y = low.y; y <= high.y; y += step)
          for (double z = low.z; z <= high.z; z += step) {
            const double far_mm = glm::dot(glm::dvec3(x, y, z), along);
            if (far_mm < most - as_far || !head_.is_bone({x, y, z})) continue;
            most = std::max(most, far_mm);
            near.emplace_back(far_mm, glm::dvec3(x, y, z));
          }
      glm::dvec3 sum(0.0);
      double count = 0.0;
      for (const auto& [far_mm, p] : near)
        if (far_mm >= most - as_far) sum += p, count += 1.0;
      return count > 0.0 ? std::optional(sum / count) : std::nullopt;
    };
    const glm::dvec3 a = head_.head_mm(window.low), b = head_.head_mm(window.high);
    const glm::dvec3 low = glm::min(a, b), high = glm::max(a, b);
    const auto coarse = crest_within(low, high, 1.0);
    if (!coarse) return std::nullopt;
    // A flat end's crest lies within some millimetres across, and within one along. Beyond the window may be
    // another bone, as the upper teeth over the lower ones.
    return crest_within(glm::max(*coarse - 3.0, low), glm::min(*coarse + 3.0, high), 0.25);
  }

  /// The foremost bone at a height, `out` beside the middle in canonical millimetres; infinite: none.
  double front(double z, double out, double last = -40.0) const {
    const double canonical_z = head_.canonical_mm({0, 0, z}).z;
    const double x = head_.head_mm({out, 0, canonical_z}).x;
    const double first_y = head_.head_mm({0, -124, canonical_z}).y,
                 last_y = head_.head_mm({0, last, canonical_z}).y;
    for (double y = first_y; y <= last_y; y += 0.5) {
      if (!head_.is_bone({x, y, z})) continue;
      while (head_.is_bone({x, y - 0.1, z})) y -= 0.1;
      return y;
    }
    return infinite;
  }
  double middle_front(double z) const { return std::min({front(z, 0.0), front(z, 1.5), front(z, -1.5)}); }
  double height(double canonical) const { return head_.head_mm({0, 0, canonical}).z; }
  glm::dvec3 in_middle(double y, double z) const {
    return {head_.head_mm({0, 0, head_.canonical_mm({0, 0, z}).z}).x, y, z};
  }

  /// The foremost row of a window of heights; none where its bone was removed.
  std::optional<glm::dvec3> foremost(double low, double high) const {
    double best = infinite, at = 0.0;
    for (double z = height(low); z <= height(high); z += fine_mm)
      if (const double y = middle_front(z); y < best) best = y, at = z;
    return best < infinite ? std::optional(in_middle(best, at)) : std::nullopt;
  }
  /// The deepest row behind the line between two points of the profile.
  std::optional<glm::dvec3> hollow(const glm::dvec3& below, const glm::dvec3& above) const {
    std::optional<glm::dvec3> best;
    double deepest = 0.3;
    for (double z = below.z + 1.0; z < above.z - 1.0; z += fine_mm) {
      const double y = middle_front(z);
      if (y == infinite) return std::nullopt;
      const double deep = y - glm::mix(below.y, above.y, (z - below.z) / (above.z - below.z));
      if (deep > deepest) deepest = deep, best = in_middle(y, z);
    }
    return best;
  }

  void midline() {
    const auto tip = foremost(-9.0, 2.0), ans = foremost(-34.5, -27.0);
    if (tip) {
      // The line from the tip that touches the brow.
      std::optional<glm::dvec3> brow;
      double least = infinite;
      for (double z = height(14.0); z <= height(45.0); z += fine_mm) {
        const double slope = (middle_front(z) - tip->y) / (z - tip->z);
        if (slope < least) least = slope, brow = in_middle(middle_front(z), z);
      }
      if (brow) keep("nasion", hollow(*tip, *brow));
    }
    keep("ans", ans);
    const auto pogonion = foremost(-102.0, -86.0);
    keep("pogonion", pogonion);
    keep("menton", lowest_chin());
    if (head_.has_upper_teeth()) {
      keep("incisor", edge(-59.3, -50.0, -1.0));
      if (ans) keep("a_point", hollow(in_middle(middle_front(height(-49.0)), height(-49.0)), *ans));
    }
    if (head_.has_lower_teeth()) {
      keep("lower_incisor", edge(-70.0, -59.3, 1.0));
      if (pogonion) keep("b_point", hollow(*pogonion, in_middle(middle_front(height(-70.0)), height(-70.0))));
    }
  }
  std::optional<glm::dvec3> lowest_chin() const {
    const auto p = farthest({{-1.5, -95, -112}, {1.5, -66, -92}}, {0, 0, -1});
    return p ? std::optional(in_middle(p->y, p->z)) : std::nullopt;
  }
  /// The edge of the front teeth between two heights, `up` or down.
  std::optional<glm::dvec3> edge(double low, double high, double up) const {
    const auto p = farthest({{-6.0, -90, low}, {6.0, -72, high}}, {0, 0, up});
    return p ? std::optional(in_middle(p->y, p->z)) : std::nullopt;
  }

  /// The lowest point of the crest of the orbit's lower rim, where the rim's surface looks as much up as
  /// forward.
  void orbit(const std::string& name, double side) {
    std::optional<glm::dvec3> best;
    for (double out = 20.0; out <= 46.0; out += 0.5) {
      std::optional<glm::dvec3> crest;
      double most = -infinite;
      for (double z = height(-20.0); z <= height(2.0); z += 0.4) {
        const double y = front(z, side * out, -62.0);
        if (y == infinite || z - y <= most) continue;
        most = z - y;
        crest = glm::dvec3(head_.head_mm({side * out, 0, head_.canonical_mm({0, 0, z}).z}).x, y, z);
      }
      if (!crest) return;
      if (!best || crest->z < best->z) best = crest;
    }
    keep("orbitale" + name, best);
  }

  /// The rim of the piriform aperture over the spine, and the outer end of the maxilla below it.
  void rim(const std::string& name, double side) {
    const auto ans = found_.find("ans");
    if (ans == found_.end()) return;
    const double z = ans->second.z + 4.0;
    double foremost = infinite;
    for (double out = 8.0; out <= 26.0; out += 0.25) foremost = std::min(foremost, front(z, side * out));
    for (double out = 3.0; out <= 26.0; out += 0.1) {
      const double y = front(z, side * out);
      if (y > foremost + 8.0) continue;
      keep("piriform" + name,
           glm::dvec3(head_.head_mm({side * out, 0, head_.canonical_mm({0, 0, z}).z}).x, y, z));
      break;
    }
    const double low = ans->second.z - 4.0;
    std::optional<glm::dvec3> end;
    for (double out = 20.0; out <= 60.0; out += 0.25) {
      const double y = front(low, side * out, -44.0);
      if (y == infinite) break;
      if (end && y > end->y + 4.0) break;
      end = glm::dvec3(head_.head_mm({side * out, 0, head_.canonical_mm({0, 0, low}).z}).x, y, low);
    }
    keep("buttress" + name, end);
  }

  const RandomHead& head_;
  std::map<std::string, glm::dvec3> found_;
};

}  // namespace

void RandomHead::find_truths() {
  const std::map<std::string, glm::dvec3> found = Truth(*this).find();
  // A part that a defect has cut or moved has no landmarks.
  RandomHead whole = *this;
  whole.defects_.clear();
  const std::map<std::string, glm::dvec3> before = defects_.empty() ? found : Truth(whole).find();
  constexpr double moved_mm = 0.3;
  for (const auto& [name, p] : found) {
    const auto was = before.find(name);
    if (was == before.end() || glm::distance(was->second, p) > moved_mm) continue;
    const glm::dvec3 q = canonical_mm(p);
    const bool is_cut = std::any_of(defects_.begin(), defects_.end(), [&](const Ball& ball) {
      return glm::distance(q, ball.centre_mm) < ball.radius_mm + 0.5;
    });
    if (!is_cut) truths_mm_[name] = glm::dvec3(lps_from_head_ * glm::dvec4(p, 1.0));
  }
}

double RandomHead::error_mm(const std::string& name, const glm::dvec3& p_mm) const {
  if (!name.starts_with("midline_")) {
    const auto at = truths_mm_.find(name);
    return at == truths_mm_.end() ? infinite : glm::distance(at->second, p_mm);
  }
  const glm::dvec3 p = glm::dvec3(glm::inverse(lps_from_head_) * glm::dvec4(p_mm, 1.0));
  constexpr int samples = 4;
  for (int x = -samples; x <= samples; ++x)
    for (int y = -samples; y <= samples; ++y)
      for (int z = -samples; z <= samples; ++z)
        if (is_bone(p + glm::dvec3(x, y, z) * 0.75)) return std::abs(p.x - mid_(p.z));
  return infinite;
}

}  // namespace octotomy::tests
