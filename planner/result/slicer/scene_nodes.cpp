// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/result/slicer/scene_nodes.h"

#include <cmath>

#include "planner/operation/table/number_format.h"
#include "planner/result/report/drawn_page.h"

namespace octotomy::planner {
namespace {

std::string attribute(const std::string& name, const std::string& value) {
  return " " + name + "=\"" + escaped(value) + "\"";
}

}  // namespace

std::string SceneNodes::next(const std::string& kind) {
  return "vtkMRML" + kind + "Node" + std::to_string(++counts_[kind]);
}

void SceneNodes::add(const std::string& element, const std::string& id, const std::string& name,
                     const std::string& references, const std::string& attributes) {
  text_ += " <" + element + attribute("id", id) + attribute("name", name) +
           (references.empty() ? "" : attribute("references", references)) + attributes + " ></" + element +
           ">\n";
}

std::string SceneNodes::stored(const std::string& storage, const std::string& file,
                               const std::string& display, const std::string& attributes) {
  const std::string of_file = next(storage + "Storage");
  add(storage + "Storage", of_file, file, {},
      attribute("fileName", "Data/" + file) + attribute("useCompression", "1"));
  const std::string shown = next(display);
  // VolumeDisplay is the only element whose name differs from the class of its display node.
  add(display == "ScalarVolumeDisplay" ? "VolumeDisplay" : display, shown, file, {},
      attribute("visibility", "true") + attributes);
  return "display:" + shown + ";storage:" + of_file + ";";
}

void SceneNodes::add_volume(const std::string& name, const std::string& file) {
  const std::string references = stored("VolumeArchetype", file, "ScalarVolumeDisplay", "");
  add("Volume", next("ScalarVolume"), name, references);
}

void SceneNodes::add_segmentation(const std::string& name, const std::string& file) {
  const std::string references = stored("Segmentation", file, "SegmentationDisplay", "");
  add("Segmentation", next("Segmentation"), name, references);
}

std::string SceneNodes::add_transform(const std::string& name, const std::string& file) {
  const std::string of_file = next("TransformStorage");
  add("TransformStorage", of_file, file, {}, attribute("fileName", "Data/" + file));
  std::string id = next("LinearTransform");
  add("LinearTransform", id, name, "storage:" + of_file + ";");
  return id;
}

void SceneNodes::add_model(const std::string& name, const std::string& file, const glm::vec3& colour,
                           const std::string& transform) {
  std::string references = stored("Model", file, "ModelDisplay",
                                  attribute("color", plain(std::round(colour.x * 1000.0) / 1000.0) + " " +
                                                         plain(std::round(colour.y * 1000.0) / 1000.0) + " " +
                                                         plain(std::round(colour.z * 1000.0) / 1000.0)));
  if (!transform.empty()) references += "transform:" + transform + ";";
  add("Model", next("Model"), name, references);
}

void SceneNodes::add_markups(const std::string& type, const std::string& name, const std::string& file) {
  const bool is_plane = type == "Plane";
  const std::string references = stored(is_plane ? "MarkupsPlaneJson" : "MarkupsJson", file,
                                        is_plane ? "MarkupsPlaneDisplay" : "MarkupsDisplay", "");
  add("Markups" + type, next("Markups" + type), name, references,
      type.ends_with("Curve") ? attribute("curveType", "linear") : "");
}

std::string SceneNodes::text() const {
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<MRML version=\"Slicer5\" userTags=\"\">\n" + text_ +
         "</MRML>\n";
}

}  // namespace octotomy::planner
