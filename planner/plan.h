// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "voxel/expression.h"
#include "voxel/read_scene.h"
#include "voxel/region_mask.h"

namespace octotomy::planner {

struct ScanSource {
  std::filesystem::path path;         ///< relative paths are relative to the plan's folder
  std::optional<std::string> sha256;  ///< checked where given
  voxel::ReadOptions read = {};       ///< the series, and what the file does not say of itself
};

struct WindowStep {
  std::string scan;
  double low = 300.0;
  std::optional<double> high;  ///< none: no upper limit
};
struct RegionText {
  std::string view;
  std::vector<std::vector<glm::dvec2>> polygons_mm;
};
struct MaskStep {
  std::vector<RegionText> regions;
};
struct CombineStep {
  std::string expression;
};
struct RotateText {
  double degrees = 0.0;
  glm::dvec3 axis{0, 0, 1};
  glm::dvec3 about_mm{0.0};
};
/// The rotation is done first, then the translation.
struct MoveStep {
  std::string object;
  glm::dvec3 translate_mm{0.0};
  std::optional<RotateText> rotate;
};
/// An object's size; with `to`, the gap between two objects; or the distance of two points, or the angle at
/// the second of three.
struct MeasureStep {
  std::string object;  ///< empty where points are measured
  std::optional<std::string> to;
  std::vector<glm::dvec3> points_mm;
};
/// What an export writes: the object's surface, tetrahedra that fill it, or its voxels as a label map.
enum class ExportKind { Mesh, Tetrahedra, Label };
/// What holds and moves the object of a deck: soft tissue on bone. Nothing where both lists are empty.
struct Attachment {
  std::vector<std::string> moved;  ///< results of move steps: the object follows them
  std::vector<std::string> fixed;
  std::optional<double> element_mm;  ///< edge of the smallest elements; none: the universe's voxels
  /// Linear elastic. 15 kPa is Chabanas, Luboz and Payan's for the face (2003); of their Poisson's ratio of
  /// 0.49 linear tetrahedra would be too stiff.
  double youngs_modulus_mpa = 0.015;
  double poisson_ratio = 0.45;

  bool any() const { return !moved.empty() || !fixed.empty(); }
};
struct PlaneText {
  glm::dvec3 point_mm{0.0};
  glm::dvec3 normal{1, 0, 0};
};
/// Elements of about a size at a point or, where named, along an object's surface.
struct FinerText {
  glm::dvec3 point_mm{0.0};
  std::string object;
  double size_mm = 1.0;
};
/// Linear elastic.
struct RegionMaterial {
  double youngs_modulus_mpa = 0.0;
  double poisson_ratio = 0.0;
};
struct ExportStep {
  std::string object;
  std::filesystem::path path;  ///< within the result folder
  ExportKind kind = ExportKind::Mesh;
  Attachment attachment{};  ///< of decks
  /// Of decks that nothing holds: where the meshers fail, an octree's elements are taken, and marked.
  bool fallback = false;
  bool second_order = false;           ///< of decks: ten-node tetrahedra
  std::vector<FinerText> finer{};      ///< of decks that are not of voxels
  std::optional<PlaneText> midline{};  ///< of decks: the surface's nodes along it are a set
  /// Of decks: further objects that fill the same deck, each a region of its own, with shared nodes where
  /// they touch.
  std::vector<std::string> regions{};
  /// Of decks of several regions: smooth elements of about this size, in place of the voxels'.
  std::optional<double> smooth_mm{};
  bool contact = false;  ///< of decks of several regions: they may part and slide where they touch
  /// Of decks of several regions: pairs that may, as lips or cheek and teeth do; others share nodes.
  std::vector<std::pair<std::string, std::string>> sliding{};
  std::map<std::string, RegionMaterial> materials{};  ///< of regions, the object's own too, by their names
};

struct Step {
  std::string id;
  std::variant<WindowStep, MaskStep, CombineStep, MoveStep, MeasureStep, ExportStep> action;
};

/// An operation as pure data: ordered steps, each of which names its result.
struct Plan {
  std::string name;
  std::string text;              ///< the JSON it was read from
  std::filesystem::path file;    ///< empty where the plan was not read from a file
  std::filesystem::path folder;  ///< where the plan lies
  std::map<std::string, ScanSource> scans;
  std::optional<double>
      voxel_mm;  ///< edge of the universe's voxels; none: as fine as the scan, at most 512 a side
  std::vector<Step> steps;
};

/// Reads a plan. Keys, steps and names that are not known, and keys said twice, are refused with the nearest
/// known one; names must be bound before they are used. Expressions are parsed, polygons checked to have an
/// area, export extensions to be writable (.stl .ply .obj .off, .inp .vtu, .nrrd .nii.gz .mha), before
/// anything is evaluated. Throws std::runtime_error saying file, step, key and what to try.
Plan read_plan(const std::filesystem::path& path);
/// The same of a text; `folder` is what relative paths are relative to.
Plan parse_plan(const std::string& json, const std::filesystem::path& folder);

/// The scan's path, made absolute against the plan's folder.
std::filesystem::path scan_path(const Plan& plan, const ScanSource& scan);

/// The word of a step's `do`.
std::string verb(const Step& step);
/// The volume of interest and the motion that a step's text describes.
voxel::RegionMask mask_of(const MaskStep& step);
voxel::Motion motion_of(const MoveStep& step);

}  // namespace octotomy::planner
