// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <deque>
#include <glm/glm.hpp>
#include <limits>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "brep/mesh/solid.h"
#include "planner/operation/table/field.h"
#include "verify/certificate/certificate.h"
#include "verify/witness/reading.h"
#include "voxel/measure/measure.h"
#include "voxel/solid/expression.h"
#include "voxel/space/scene.h"
#include "voxel/tree/grey_octree.h"
#include "voxel/tree/octree.h"

namespace octotomy::planner {

/// The voxel kernel's answer to an operation.
struct VoxelSide {
  explicit VoxelSide(const voxel::Universe& universe) : octree(voxel::Octree::empty(universe)) {}

  voxel::Octree octree;
  /// The object as an expression of windows on samples, so that a motion interpolates the samples only once.
  std::optional<voxel::Expression> symbol;
  voxel::Measures measures;
  std::string lineage;
  std::vector<std::string> makers;  ///< the code that made it and its inputs (verify::Answer)
  std::vector<std::string> findings;
};

/// The mesh kernel's answer to the same operation.
struct MeshSide {
  std::optional<brep::Solid> whole;   ///< also beyond the universe; none if the kernel has no answer
  std::optional<brep::Solid> within;  ///< the part of it within the universe
  std::string lineage;
  std::vector<std::string> makers;  ///< as in VoxelSide
  double shift_mm = 0.0;            ///< how far Booleans moved operands
  std::vector<std::string> findings;
  nlohmann::ordered_json details = nlohmann::ordered_json::object();  ///< further results of the operation
  /// If the object is a choice of another object's parts: that object's name, and the parts left out.
  std::optional<std::pair<std::string, brep::Solid>> parts_of = {};
};

/// A plane along which an object was cut. It was parallel to the universe's planes at the time of the cut.
struct CutPlane {
  int axis = 0;                ///< axis of its normal at that time
  glm::dvec3 normal{1, 0, 0};  ///< its current normal
  double offset_mm = 0.0;      ///< normal . p of its points
  double voxels = 1.0;         ///< error of its area, relative to a cut through voxels
};

/// The samples that show an object's surface: except at cuts, it lies at the lower bound of one of these
/// windows.
struct Shown {
  voxel::GreyOctree grey;
  double threshold = 0.0;
  std::string scan;                                  ///< name of the scan of `grey`
  glm::dmat4 moved_from_still{1.0};                  ///< motion by all steps after the surface was made, LPS
                                                     ///< to LPS
  std::shared_ptr<const voxel::Scene> samples = {};  ///< samples of the scan; none: only `grey` shows the
                                                     ///< surface
  double high = std::numeric_limits<double>::infinity();  ///< the window's upper bound
};

/// The terms of a certificate's bound.
struct BoundTerms {
  std::vector<CutPlane> planes;
  glm::dvec3 spacing_mm{0.0};  ///< spacing of the coarsest scan from which the object derives; zero if there
                               ///< is none
  std::optional<voxel::Box> scan_box_mm;  ///< box of the scan from which it derives; none after a motion
  bool voxels_are_samples = false;
  double shift_mm = 0.0;       ///< how far Booleans on the way moved operands (brep::Booleans)
  std::vector<Shown> windows;  ///< windows of all objects from which it was made; their bounds determine its
                               ///< surface
  /// Objects on the way whose surface was replaced: by an offset, by smoothing or by decimation. Uncertainty
  /// of their surface also applies to this object.
  std::vector<std::string> reshaped;
  /// The mean distance by which two correct answers may differ because each kernel measured distances by
  /// itself (verify::BoundInputs).
  double measured_apart_mm = 0.0;
};

/// A wall of an object that a mask cut, and the motion of all the steps that moved it since, LPS to LPS.
struct CutWall {
  std::string mask;
  brep::Solid wall;
  glm::dmat4 moved_from_still{1.0};
};

/// A reason why an object's certificate cannot be a PASS, even if the kernels agree.
struct Caveat {
  voxel::Verdict verdict = voxel::Verdict::Warn;
  std::string reason;
  bool is_inherited = false;  ///< caveat of an object from which it was made
  bool is_of_place = false;   ///< depends on the object's position, so a moved object does not inherit it
  /// Tissue that is missing at most. None: unknown, or the caveat is about something else.
  std::optional<double> missing_mm3 = {};
};

/// What an operation made, in both kernels.
struct Object {
  Object(std::string name, std::string operation, const voxel::Universe& universe)
      : id(std::move(name)), kind(std::move(operation)), voxel(universe) {}

  std::string id;
  std::string kind;              ///< the operation's name
  std::string definition;        ///< in words: "skull & cut"
  bool is_tool = false;          ///< only helps to make others, as a mask
  bool is_interpolated = false;  ///< a part of it comes from samples between images
  bool is_surely_empty = false;  ///< its definition is empty for all operands, for example a - a
  VoxelSide voxel;
  MeshSide mesh;
  BoundTerms bound;
  verify::Witness witness;  ///< describes `mesh.whole`; empty if there is no independent third reading
  std::optional<verify::Certificate> certificate;  ///< none for tools, and if there is no mesh
  std::vector<std::string> findings;
  /// The finding if the scan's border cuts the object off, because neither kernel has data beyond it. A
  /// motion keeps the finding.
  std::optional<std::string> border_finding;
  std::vector<Caveat> caveats;
  /// Inputs that both kernels share although they were computed only once: values computed by a step,
  /// filtered samples. An error in them cannot show as a disagreement.
  std::vector<std::string> shared_values;
  bool ends_with_universe = false;  ///< its mesh stays cut at the universe's border when it moves on
  std::optional<Shown> shown;
  /// Details of a moved object.
  struct Moved {
    std::string object;      ///< name of the object that was moved
    glm::dmat4 motion{1.0};  ///< LPS to LPS; affine: a step may scale or shear (is_rigid())
    /// Reported facts about the motion: how it was found, residuals of points.
    nlohmann::ordered_json details = nlohmann::ordered_json::object();
  };
  std::optional<Moved> moved;
  /// Set if the object is another one moved, mirrored, scaled or sheared, by one step or by several.
  struct Image {
    std::string object;                 ///< the one that is no image
    glm::dmat4 image_from_object{1.0};  ///< affine
    /// Whether both objects lie wholly within the universe. Then their volumes differ by the determinant.
    bool is_whole = false;
  };
  std::optional<Image> image;
  std::vector<CutWall> walls;  ///< one wall for each mask that cut this object and has a mesh
};

/// The objects that steps have made so far, in order. References stay valid when objects are added.
class Objects {
 public:
  /// Throws std::invalid_argument if no object has this name.
  const Object& at(const std::string& name) const;
  const Object& add(Object object);

  auto begin() const { return objects_.begin(); }
  auto end() const { return objects_.end(); }
  auto rbegin() const { return objects_.rbegin(); }
  auto rend() const { return objects_.rend(); }
  std::size_t size() const { return objects_.size(); }
  const Object& operator[](std::size_t index) const { return objects_[index]; }
  const Object& front() const { return objects_.front(); }
  const Object& back() const { return objects_.back(); }
  /// For adding the certificate, and for tests that modify an object.
  Object& change(std::size_t index) { return objects_[index]; }

  /// The head's orientation: columns are the head's directions left, back and up, LPS.
  glm::dmat3 lps_from_head{1.0};

 private:
  std::deque<Object> objects_;
  std::map<std::string, std::size_t> index_;
};

/// The original object of an image; the object itself if it is no image.
const Object& still_of(const Objects& objects, const Object& object);
/// The motion of all the steps that moved an object since it was made, LPS to LPS.
glm::dmat4 moved_since_made(const Objects& objects, const std::string& object);
/// The position of a mark. A landmark attached to an object moves with that object's motions.
glm::dvec3 mark_mm(const Mark& mark, const Objects& objects);

}  // namespace octotomy::planner
