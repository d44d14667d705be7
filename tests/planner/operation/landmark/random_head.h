// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "verify/phantom/chance.h"
#include "voxel/space/progress.h"
#include "voxel/space/scene.h"

namespace octotomy::tests {

/// The special property of a random head, in addition to its proportions, its scan and its position.
enum class HeadKind {
  Plain,
  Tilted,       ///< to 20 degrees about any axis
  Toothless,    ///< above, below or both
  Couch,        ///< with a dense skin, through the whole scan
  Marker,       ///< a ball or a wire in the air before the face
  ThickSlices,  ///< to 3 mm
  Crooked,      ///< chin, maxilla and cheeks beside the skull's mid-plane
  Masked,       ///< a mask along the face, with markers on it
  Defect,       ///< bone of the face or the forehead is missing
  Metal,        ///< a metal crown with streaks
  Noisy,        ///< blur and noise
  Everything    ///< several of these at once
};
inline constexpr std::size_t head_kind_count = 12;
const char* name_of(HeadKind kind);

/// A function that rises along straight pieces between knots, and on beyond them.
struct Knots {
  std::vector<double> from, to;
  double operator()(double at) const;
  double inverse(double value) const;
};

/// The head phantom with other proportions, parts and things beside it, in closed form: a point of the head,
/// in millimetres of its own frame, is looked up in verify::head_solids() at canonical_mm().
class RandomHead {
 public:
  /// Equal kinds and seeds make equal heads.
  RandomHead(HeadKind kind, std::uint64_t seed);

  /// A CT of the head. Voxels are means of sub-samples near surfaces; then blur and noise are added.
  /// Parallel; same bits on any thread count.
  voxel::Scene scan(const voxel::Progress& progress = {}) const;
  /// HU half way between its bone and its soft tissue.
  double half_level_hu() const { return 0.5 * (bone_hu_ + soft_hu); }

  /// Landmarks of the closed form by names of find_landmarks, LPS. A landmark whose bone or tooth the head
  /// lacks is absent. midline_... are no single points and therefore absent.
  const std::map<std::string, glm::dvec3>& truths_mm() const { return truths_mm_; }
  /// The distance of a point from the landmark of a name; infinite if the head has no such landmark, and for
  /// a midline_... point that lies on no bone.
  double error_mm(const std::string& name, const glm::dvec3& p_mm) const;

  glm::dvec3 canonical_mm(const glm::dvec3& head_mm) const;
  glm::dvec3 head_mm(const glm::dvec3& canonical_mm) const;
  bool has_upper_teeth() const { return has_upper_teeth_; }
  bool has_lower_teeth() const { return has_lower_teeth_; }
  /// Whether this head has bone or a tooth at a point.
  bool is_bone(const glm::dvec3& head_mm) const;

 private:
  friend class HeadScan;
  static constexpr double soft_hu = 40.0;
  struct Thing {  ///< a capsule
    glm::dvec3 from_mm{0.0}, to_mm{0.0};
    double radius_mm = 1.0, hu = 1000.0;
  };
  struct Ball {
    glm::dvec3 centre_mm{0.0};
    double radius_mm = 0.0;
  };
  struct Couch {
    double front_mm = 0.0, thick_mm = 0.0, skin_mm = 0.0, half_width_mm = 0.0, curve_mm = 0.0;
    double skin_hu = 0.0, core_hu = 0.0;
  };

  void draw_proportions(verify::Chance& chance, bool is_crooked);
  void draw_things(verify::Chance& chance, HeadKind kind);
  bool was_removed(const glm::dvec3& canonical_mm, bool is_tooth) const;
  void find_truths();

  Knots height_, mid_, back_;             ///< canonical from head: z; x of the middle over z; y
  Knots width_, forward_;                 ///< canonical over head lengths across, and y of the middle, over z
  std::array<double, 2> side_{1.0, 1.0};  ///< canonical over head lengths, right and left
  glm::dmat4 lps_from_head_{1.0};
  bool has_upper_teeth_ = true, has_lower_teeth_ = true;
  std::vector<Thing> things_;  ///< in the head's frame
  std::vector<Ball> defects_;  ///< canonical
  std::optional<Ball> metal_;  ///< canonical
  std::optional<Couch> couch_;
  double mask_mm_ = 0.0, mask_hu_ = 0.0;  ///< thickness; 0: no mask
  double voxel_mm_ = 1.0, slice_mm_ = 1.0, blur_mm_ = 0.0, noise_hu_ = 0.0, bone_hu_ = 560.0,
         tooth_hu_ = 1800.0;
  double below_mm_ = 0.0;  ///< of the chin, where the scan ends
  std::uint64_t seed_ = 0;
  std::map<std::string, glm::dvec3> truths_mm_;
};

}  // namespace octotomy::tests
