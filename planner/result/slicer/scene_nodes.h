// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <map>
#include <string>

namespace octotomy::planner {

/// The nodes of a scene of 3D Slicer (MRML, version 5), each with its storage and display nodes. `file` is
/// the name of a file in the scene's folder Data.
class SceneNodes {
 public:
  void add_volume(const std::string& name, const std::string& file);
  void add_segmentation(const std::string& name, const std::string& file);
  /// Adds a transform. Returns its identifier for add_model().
  std::string add_transform(const std::string& name, const std::string& file);
  /// Adds a model. `transform` is the identifier of the transform that moves it; empty if none does.
  void add_model(const std::string& name, const std::string& file, const glm::vec3& colour,
                 const std::string& transform);
  /// Adds markups of a type such as "Fiducial", "Plane" or "ClosedCurve". Curves are straight between their
  /// points.
  void add_markups(const std::string& type, const std::string& name, const std::string& file);

  /// The text of scene.mrml.
  std::string text() const;

 private:
  std::string next(const std::string& kind);
  /// Adds a storage node for a file, and a display node with these attributes. Returns the references to
  /// both.
  std::string stored(const std::string& storage, const std::string& file, const std::string& display,
                     const std::string& attributes);
  void add(const std::string& element, const std::string& id, const std::string& name,
           const std::string& references, const std::string& attributes = {});

  std::string text_;
  std::map<std::string, int> counts_;
};

}  // namespace octotomy::planner
