// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace octotomy::planner {

struct Operation;

/// A named point of the document, at its position in the scan, LPS millimetres.
struct NamedPoint {
  std::string name;
  glm::dvec3 p_mm{0.0};
};

/// The names that the steps of a document have bound so far.
class Scope {
 public:
  /// `scans` are the names of the document's scans; paths of files are relative to `folder`.
  explicit Scope(std::vector<std::string> scans = {}, std::filesystem::path folder = {})
      : scans_(std::move(scans)), folder_(std::move(folder)) {}

  /// Binds the id of a step. Throws std::runtime_error if it is not an identifier or is already bound;
  /// `where` names the step in the message.
  void bind(const std::string& where, const std::string& id, const Operation& operation);
  /// Throws std::runtime_error that suggests the nearest existing name if no earlier step makes this object.
  void need_object(const std::string& where, const std::string& name) const;
  /// Throws std::runtime_error that suggests the nearest existing name if the document has no such scan.
  void need_scan(const std::string& where, const std::string& name) const;
  /// Records that a step writes to a path. Throws std::runtime_error if an earlier step writes to it.
  void take_path(const std::string& where, const std::string& path);
  /// The operation that makes an object. Precondition: need_object() passes.
  const Operation& maker_of(const std::string& name) const { return *operations_.at(name); }

  /// Binds a landmark. Throws std::runtime_error if its name is already bound, empty or contains an '@'.
  void bind_landmark(const std::string& where, const NamedPoint& landmark);
  /// The position of a landmark, LPS mm. Throws std::runtime_error that suggests the nearest existing name if
  /// no earlier step has this landmark.
  glm::dvec3 landmark_mm(const std::string& where, const std::string& name) const;
  const std::vector<NamedPoint>& landmarks() const { return landmarks_; }
  /// Sets the head's orientation: the columns are the head's directions left, back and up, LPS. Throws
  /// std::runtime_error if an earlier step has set it.
  void hold_head(const std::string& where, const glm::dmat3& lps_from_head);
  /// The head's orientation. None if no step sets it; the head's directions are then the scan's axes.
  const std::optional<glm::dmat3>& lps_from_head() const { return lps_from_head_; }
  const std::filesystem::path& folder() const { return folder_; }

 private:
  std::vector<std::string> scans_, objects_;
  std::set<std::string> paths_;
  std::filesystem::path folder_;
  std::vector<NamedPoint> landmarks_;
  std::map<std::string, std::size_t> landmark_of_;  ///< indices by names
  std::optional<glm::dmat3> lps_from_head_;
  std::map<std::string, const Operation*> operations_;
};

/// The place of a value in its document for error messages, and the names that are bound there.
struct FieldLocation {
  std::string where;       ///< "step 'cut'"; may be empty
  Scope* scope = nullptr;  ///< null: names are paths of files, so they are not checked

  /// The place of a field or record within this value.
  FieldLocation at(const std::string& field) const {
    return {where.empty() ? field : where + ", " + field, scope};
  }
  /// Throws std::runtime_error with the place and the fault: "step 'cut', regions: has no region".
  [[noreturn]] void refuse(const std::string& what) const;
  void need_object(const std::string& name) const {
    if (scope != nullptr) scope->need_object(where, name);
  }
  void need_scan(const std::string& name) const {
    if (scope != nullptr) scope->need_scan(where, name);
  }
};

}  // namespace octotomy::planner
