// SPDX-License-Identifier: AGPL-3.0-or-later
// The 3D Manufacturing Format (3MF Consortium, Core Specification 1.3, and the production extension, which
// spreads objects over several parts of the archive):
//   1 The archive's relationships name the model. 2 Its XML defines objects: a mesh, or components that place
//   other objects. 3 The items of the build place objects; without a build, all objects that no component
//   places. A matrix has twelve numbers, four rows of three; it is multiplied from the left by the row of a
//   point's coordinates. Support structures are left out. Other extensions that a file requires are refused,
//   because they may change the solid.
#include <algorithm>
#include <cmath>
#include <exception>
#include <expat.h>
#include <map>
#include <memory>
#include <set>

#include "brep/io/mesh_scanner.h"
#include "brep/io/zip_archive.h"
#include "brep/mesh/error.h"

namespace octotomy::brep {
namespace {

using Attributes = std::map<std::string, std::string>;

/// Identifies an object by its part of the archive and its number there.
using ObjectKey = std::pair<std::string, std::string>;

struct Placed {
  ObjectKey object;
  glm::dmat4x3 matrix{1.0};
};

struct Object3mf {
  Triangles mesh;
  std::vector<Placed> components;
  bool is_solid = true;  ///< not a support structure
};

const std::string& required(const Attributes& attributes, const char* name, const char* element) {
  const auto found = attributes.find(name);
  if (found == attributes.end()) refuse_file(std::string("<") + element + "> has no " + name);
  return found->second;
}

std::string optional(const Attributes& attributes, const char* name, const std::string& otherwise) {
  const auto found = attributes.find(name);
  return found == attributes.end() ? otherwise : found->second;
}

double coordinate(const Attributes& attributes, const char* name) {
  const std::string& text = required(attributes, name, "vertex");
  MeshScanner scanner(text);
  return number_of(scanner.word());
}

glm::dmat4x3 matrix_of(const Attributes& attributes) {
  glm::dmat4x3 made(1.0);
  const std::string text = optional(attributes, "transform", "");
  if (text.empty()) return made;
  MeshScanner scanner(text);
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 3; ++row) made[column][row] = scanner.number();
  if (!scanner.word().empty()) refuse_file("a transform has more than twelve numbers");
  return made;
}

std::string without_slash(std::string path) {
  if (path.starts_with('/')) path.erase(0, 1);
  return path;
}

/// The product that applies `inner` first.
glm::dmat4x3 product(const glm::dmat4x3& outer, const glm::dmat4x3& inner) {
  const glm::dmat3 turn(outer[0], outer[1], outer[2]);
  return {turn * inner[0], turn * inner[1], turn * inner[2], turn * inner[3] + outer[3]};
}

/// A part of the archive with objects.
class ModelPart {
 public:
  ModelPart(std::string path, std::map<ObjectKey, Object3mf>& objects)
      : path_(std::move(path)), objects_(objects) {}

  std::string unit = "millimeter", application, required_extensions;
  std::vector<Placed> items;

  void begin(const std::string& element, const Attributes& attributes) {
    if (element == "model") {
      unit = optional(attributes, "unit", unit);
      required_extensions = optional(attributes, "requiredextensions", "");
    } else if (element == "metadata") {
      in_application_ = optional(attributes, "name", "") == "Application";
    } else if (element == "object") {
      const std::string type = optional(attributes, "type", "model");
      const std::string id(required(attributes, "id", "object"));
      if (objects_.contains({path_, id})) refuse_file("two objects have the id " + id);
      object_ = &objects_[{path_, id}];
      object_->is_solid = type == "model" || type == "surface";
    } else if (element == "vertex" && object_ != nullptr) {
      object_->mesh.points_mm.emplace_back(coordinate(attributes, "x"), coordinate(attributes, "y"),
                                           coordinate(attributes, "z"));
    } else if (element == "triangle" && object_ != nullptr) {
      std::array<std::uint32_t, 3> face{};
      for (std::size_t k = 0; k < 3; ++k) {
        constexpr std::array<const char*, 3> names{{"v1", "v2", "v3"}};
        const long long corner = integer_of(required(attributes, names[k], "triangle"));
        if (corner < 0 || corner >= static_cast<long long>(object_->mesh.points_mm.size()))
          refuse_file("a triangle refers to point " + std::to_string(corner) + " of " +
                      std::to_string(object_->mesh.points_mm.size()));
        face[k] = static_cast<std::uint32_t>(corner);
      }
      object_->mesh.faces.push_back(face);
    } else if (element == "component" && object_ != nullptr) {
      object_->components.push_back(placed(attributes, "component"));
    } else if (element == "item") {
      items.push_back(placed(attributes, "item"));
    }
  }
  void end(const std::string& element) {
    if (element == "object") object_ = nullptr;
    in_application_ = false;
  }
  void text(std::string_view text) {
    if (in_application_ && application.size() < 200) application += text;
  }

 private:
  Placed placed(const Attributes& attributes, const char* element) const {
    return {{without_slash(optional(attributes, "path", path_)), required(attributes, "objectid", element)},
            matrix_of(attributes)};
  }

  std::string path_;
  std::map<ObjectKey, Object3mf>& objects_;
  Object3mf* object_ = nullptr;
  bool in_application_ = false;
};

/// The name without the namespace's prefix.
std::string local_name(const char* name) {
  const std::string_view whole(name);
  const std::size_t colon = whole.rfind(':');
  return std::string(colon == std::string_view::npos ? whole : whole.substr(colon + 1));
}

/// Calls a receiver's begin(), end() and text() while parsing XML. No exception passes through the parser,
/// which is C.
template <typename Receiver>
class XmlPass {
 public:
  explicit XmlPass(Receiver& receiver) : receiver_(receiver) {}

  /// Throws the receiver's exception, or Error (Input) with the line.
  void run(const std::string& xml) {
    const std::unique_ptr<XML_ParserStruct, decltype(&XML_ParserFree)> parser(XML_ParserCreate(nullptr),
                                                                              &XML_ParserFree);
    if (!parser) throw Error(ErrorCode::Resource, "expat does not start");
    parser_ = parser.get();
    XML_SetUserData(parser_, this);
    XML_SetElementHandler(parser_, begun, ended);
    XML_SetCharacterDataHandler(parser_, told);
    XML_SetStartDoctypeDeclHandler(parser_, declared);
    const XML_Status status = XML_Parse(parser_, xml.data(), static_cast<int>(xml.size()), XML_TRUE);
    if (thrown_) std::rethrow_exception(thrown_);
    if (status != XML_STATUS_OK)
      refuse_file("line " + std::to_string(XML_GetCurrentLineNumber(parser_)) +
                  " of the model: " + XML_ErrorString(XML_GetErrorCode(parser_)));
  }

 private:
  template <typename Step>
  static void guarded(void* self, const Step& step) {
    auto& pass = *static_cast<XmlPass*>(self);
    try {
      step(pass.receiver_);
    } catch (...) {
      if (!pass.thrown_) pass.thrown_ = std::current_exception();
      XML_StopParser(pass.parser_, XML_FALSE);
    }
  }
  static void begun(void* self, const XML_Char* name, const XML_Char** attributes) {
    guarded(self, [&](Receiver& receiver) {
      Attributes found;
      for (; *attributes != nullptr; attributes += 2) found[local_name(attributes[0])] = attributes[1];
      receiver.begin(local_name(name), found);
    });
  }
  static void ended(void* self, const XML_Char* name) {
    guarded(self, [&](Receiver& receiver) { receiver.end(local_name(name)); });
  }
  static void told(void* self, const XML_Char* text, int length) {
    guarded(self, [&](Receiver& receiver) {
      receiver.text(std::string_view(text, static_cast<std::size_t>(length)));
    });
  }
  /// Refuses entity declarations: the format has none, and entities may expand without bound.
  static void declared(void* self, const XML_Char*, const XML_Char*, const XML_Char*, int) {
    guarded(self,
            [](Receiver&) { refuse_file("the model declares a document type, which 3MF does not have"); });
  }

  Receiver& receiver_;
  XML_Parser parser_ = nullptr;
  std::exception_ptr thrown_;
};

/// Finds the relationship from the archive's root to its model.
struct Relationships {
  std::string model;
  void begin(const std::string& element, const Attributes& attributes) {
    if (element == "Relationship" && optional(attributes, "Type", "").ends_with("/3dmodel"))
      model = optional(attributes, "Target", "");
  }
  void end(const std::string&) {}
  void text(std::string_view) {}
};

class Reader3mf {
 public:
  explicit Reader3mf(std::string_view bytes) : bytes_(bytes), archive_(bytes) {}

  MeshContent run() {
    std::string path = "3D/3dmodel.model";
    if (archive_.has("_rels/.rels")) {
      Relationships relationships;
      XmlPass(relationships).run(unpacked("_rels/.rels"));
      if (!relationships.model.empty()) path = without_slash(relationships.model);
    }
    ModelPart root = read_part(path);
    made_.says.add_unit(root.unit, "3MF's unit " + root.unit.substr(0, 40));
    made_.says.silent_frame(
        "3MF's frame is the printer's, z up and y to the back. For a standing patient seen from the front "
        "that is LPS, which is assumed; use --frame RAS if its program writes RAS");
    made_.says.add_writer(root.application);
    unit_ = root.unit;
    std::vector<Placed> items = root.items.empty() ? unplaced(path) : root.items;
    if (root.items.empty())
      made_.says.warn("file", "its build places no object: all objects are read untransformed");
    for (const Placed& item : items) add(item, 0);
    if (left_out_ > 0)
      made_.says.tell("file", std::to_string(left_out_) + " support structures are left out");
    if (items.size() > 1)
      made_.says.tell("file", std::to_string(items.size()) + " items are read as one mesh");
    made_.polygons.faces = made_.triangles.faces.size();
    return std::move(made_);
  }

 private:
  std::string unpacked(const std::string& name) {
    std::string text = archive_.read(name);
    // Checks the total, because many entries may share the same bytes.
    if ((unpacked_ += text.size()) / 1100 > bytes_.size())
      refuse_file("the archive unpacks to more bytes than its size allows: it is damaged; export it again");
    return text;
  }

  ModelPart read_part(const std::string& path) {
    read_.insert(path);
    ModelPart part(path, objects_);
    XmlPass(part).run(unpacked(path));
    MeshScanner extensions(part.required_extensions);
    // The production extension is supported; colours and materials do not change the surface.
    for (std::string_view word = extensions.word(); !word.empty(); word = extensions.word())
      if (word != "p" && word != "m" && word != "c")
        refuse_file("requires the extension '" + std::string(word.substr(0, 40)) +
                    "', which is not read: export it without this extension");
    return part;
  }

  const Object3mf& object(const ObjectKey& key) {
    if (!read_.contains(key.first)) {
      const ModelPart part = read_part(key.first);
      if (part.unit != unit_) refuse_file("its parts are in different units");
    }
    const auto found = objects_.find(key);
    if (found == objects_.end())
      refuse_file("places object " + key.second.substr(0, 40) + ", which the file does not contain");
    return found->second;
  }

  std::vector<Placed> unplaced(const std::string& path) const {
    std::set<ObjectKey> placed;
    for (const auto& [key, each] : objects_)
      for (const Placed& component : each.components) placed.insert(component.object);
    std::vector<Placed> items;
    for (const auto& [key, each] : objects_)
      if (key.first == path && !placed.contains(key)) items.push_back({key});
    return items;
  }

  void add(const Placed& placed, int depth) {
    // A cyclic chain of components would never end.
    if (depth > 100) refuse_file("its components are nested more than 100 deep");
    const Object3mf& from = object(placed.object);
    spend(1 + from.mesh.points_mm.size() + from.mesh.faces.size());
    if (!from.is_solid) {
      ++left_out_;
      return;
    }
    const auto first = static_cast<std::uint32_t>(made_.triangles.points_mm.size());
    const glm::dmat3 turn(placed.matrix[0], placed.matrix[1], placed.matrix[2]);
    const bool is_mirrored = glm::determinant(turn) < 0.0;
    for (const glm::dvec3& p : from.mesh.points_mm)
      made_.triangles.points_mm.push_back(turn * p + placed.matrix[3]);
    for (auto face : from.mesh.faces) {
      if (is_mirrored) std::swap(face[1], face[2]);
      for (std::uint32_t& corner : face) corner += first;
      made_.triangles.faces.push_back(face);
    }
    for (const Placed& component : from.components)
      add({component.object, product(placed.matrix, component.matrix)}, depth + 1);
  }

  /// Bounds the total output of a file, because it may place one object many times.
  void spend(std::size_t count) {
    const std::size_t most = 10'000'000 + 1100 * bytes_.size();
    if ((spent_ += count) > most)
      refuse_file("places its objects so often that the result is too large: export one mesh");
  }

  std::string_view bytes_;
  ZipArchive archive_;
  std::map<ObjectKey, Object3mf> objects_;
  std::set<std::string> read_;
  std::string unit_;
  std::size_t unpacked_ = 0, spent_ = 0, left_out_ = 0;
  MeshContent made_;
};

}  // namespace

MeshContent read_3mf(std::string_view bytes) {
  return Reader3mf(bytes).run();
}

}  // namespace octotomy::brep
