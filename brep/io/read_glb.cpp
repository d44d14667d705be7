// SPDX-License-Identifier: AGPL-3.0-or-later
// Binary glTF 2.0 (Khronos Group): the triangles of the scene's nodes, transformed by the matrices of their
// node and its ancestors.
//   1 Read the chunks: JSON, and the bytes that it describes. 2 Visit the scene's nodes from the roots down.
//   The format requires a tree, so a node visited twice is refused. 3 Read each triangle primitive's
//   positions and indices, of any number type, sparse or not, and apply its node's matrix. Equal points are
//   merged, because exporters write one for each normal. Morph targets and skins are ignored and reported. A
//   file may place one mesh many times; the total output is bounded by the file's length.
#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_access.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <nlohmann/json.hpp>

#include "brep/io/base64.h"
#include "brep/io/mesh_scanner.h"
#include "brep/mesh/equal_points.h"
#include "brep/mesh/error.h"

namespace octotomy::brep {
namespace {

using Json = nlohmann::json;

/// An integer member of an object. Refuses values above `most`.
std::size_t whole(const Json& object, const char* key, std::size_t otherwise,
                  std::size_t most = std::size_t{1} << 40) {
  const auto found = object.find(key);
  if (found == object.end()) return otherwise;
  if (!found->is_number_unsigned() || found->get<std::uint64_t>() > most)
    refuse_file("'" + std::string(key) + "' is not a valid whole number here");
  return found->get<std::size_t>();
}

const Json& list_of(const Json& object, const char* key) {
  static const Json none = Json::array();
  const auto found = object.find(key);
  if (found == object.end()) return none;
  if (!found->is_array()) refuse_file("'" + std::string(key) + "' is no list");
  return *found;
}

/// The entry of a list that another object refers to by its number.
const Json& entry(const Json& document, const char* list, std::size_t number) {
  const Json& all = list_of(document, list);
  if (number >= all.size() || !all[number].is_object())
    refuse_file("there is no entry " + std::to_string(number) + " in '" + list + "'");
  return all[number];
}

template <std::size_t Count>
std::optional<std::array<double, Count>> numbers_of(const Json& object, const char* key) {
  const Json& list = list_of(object, key);
  if (list.empty()) return std::nullopt;
  std::array<double, Count> made{};
  if (list.size() != Count)
    refuse_file("'" + std::string(key) + "' has " + std::to_string(list.size()) + " numbers");
  for (std::size_t i = 0; i < Count; ++i) {
    if (!list[i].is_number()) refuse_file("'" + std::string(key) + "' contains something other than numbers");
    made[i] = list[i].get<double>();
  }
  return made;
}

/// Whether a node is invisible by the extension KHR_node_visibility or, as some writers state it, by the node
/// itself.
bool is_hidden(const Json& node) {
  const auto states = [](const Json& where) {
    return where.is_object() && where.contains("visible") && where["visible"] == false;
  };
  if (states(node)) return true;
  if (!node.contains("extensions") || !node["extensions"].is_object()) return false;
  const Json& extensions = node["extensions"];
  return extensions.contains("KHR_node_visibility") && states(extensions["KHR_node_visibility"]);
}

/// Column-major, as in the format and in GLM.
glm::dmat4 matrix_of(const Json& node) {
  if (const auto m = numbers_of<16>(node, "matrix")) {
    glm::dmat4 made;
    for (std::size_t i = 0; i < 16; ++i) made[static_cast<int>(i / 4)][static_cast<int>(i % 4)] = (*m)[i];
    if (glm::row(made, 3) != glm::dvec4(0, 0, 0, 1))
      refuse_file(
          "a node's matrix does not end in the row 0 0 0 1, so it is not affine: export the mesh without "
          "this matrix");
    return made;
  }
  glm::dmat4 made(1.0);
  if (const auto t = numbers_of<3>(node, "translation"))
    made = glm::translate(made, {(*t)[0], (*t)[1], (*t)[2]});
  if (const auto r = numbers_of<4>(node, "rotation"))
    made *= glm::mat4_cast(glm::dquat((*r)[3], (*r)[0], (*r)[1], (*r)[2]));
  if (const auto s = numbers_of<3>(node, "scale")) made = glm::scale(made, {(*s)[0], (*s)[1], (*s)[2]});
  return made;
}

/// A number type of accessors.
struct Component {
  std::size_t bytes = 0;
  double largest = 1.0;  ///< largest value of a normalised integer
};
Component component_of(std::size_t type) {
  switch (type) {
    case 5120:
      return {1, 127.0};
    case 5121:
      return {1, 255.0};
    case 5122:
      return {2, 32767.0};
    case 5123:
      return {2, 65535.0};
    case 5125:
      return {4, 4294967295.0};
    case 5126:
      return {4, 1.0};
    default:
      refuse_file("numbers of type " + std::to_string(type) + " are not known");
  }
}

double number_at(std::string_view bytes, std::size_t type) {
  MeshScanner scanner(bytes);
  switch (type) {
    case 5120:
      return scanner.binary<std::int8_t>(std::endian::little);
    case 5121:
      return scanner.binary<std::uint8_t>(std::endian::little);
    case 5122:
      return scanner.binary<std::int16_t>(std::endian::little);
    case 5123:
      return scanner.binary<std::uint16_t>(std::endian::little);
    case 5125:
      return scanner.binary<std::uint32_t>(std::endian::little);
    default:
      return scanner.binary<float>(std::endian::little);
  }
}

class GlbReader {
 public:
  explicit GlbReader(std::string_view bytes) : bytes_(bytes) {}

  MeshContent run() {
    read_chunks();
    need_known_extensions();
    read_buffers();
    made_.says.add_frame("LSA", "glTF is y up and z to the front");
    made_.says.add_unit("m", "glTF is in metres");
    const Json& asset = document_.value("asset", Json::object());
    if (asset.is_object() && asset.contains("generator") && asset["generator"].is_string())
      made_.says.add_writer(asset["generator"].get<std::string>());
    made_.scale = 1000.0;
    place_nodes();
    if (hidden_ > 0)
      made_.says.warn("file",
                      std::to_string(hidden_) + " nodes are marked as invisible and are read nevertheless");
    if (overlaid_ > 0)
      made_.says.warn(
          "file", std::to_string(overlaid_) +
                      " nodes state a matrix and also a translation, rotation or scale: the matrix is used");
    if (moved_)
      made_.says.warn("file", "skins and morph targets are left out: the mesh has its shape without them");
    made_.polygons.faces = made_.triangles.faces.size();
    return std::move(made_);
  }

 private:
  void read_chunks() {
    MeshScanner scanner(bytes_);
    if (bytes_.substr(0, 4) != "glTF") refuse_file("a GLB file starts with 'glTF'");
    scanner.skip(4);
    const auto number = [&] { return scanner.binary<std::uint32_t>(std::endian::little); };
    if (const std::uint32_t version = number(); version != 2)
      refuse_file("is glTF " + std::to_string(version) + "; only version 2 can be read");
    if (const std::uint32_t length = number(); length > bytes_.size())
      refuse_file("is " + std::to_string(length) + " bytes by its header and " +
                  std::to_string(bytes_.size()) + " in fact: it is cut short");
    std::string_view json;
    while (scanner.rest() >= 8) {
      const std::uint32_t length = number(), kind = number();
      const std::string_view chunk = scanner.bytes(length);
      if (kind == 0x4e4f534a && json.empty()) json = chunk;
      if (kind == 0x004e4942 && binary_.empty()) binary_ = chunk;
    }
    document_ = Json::parse(json);
    if (!document_.is_object()) refuse_file("its JSON is not an object: the file is damaged");
  }

  void need_known_extensions() {
    const std::array<std::string, 3> packed{"KHR_draco_mesh_compression", "EXT_meshopt_compression",
                                            "EXT_mesh_gpu_instancing"};
    for (const Json& name : list_of(document_, "extensionsUsed"))
      if (name.is_string() &&
          std::find(packed.begin(), packed.end(), name.get<std::string>()) != packed.end())
        refuse_file("uses " + name.get<std::string>() + ", which is not read: export the file without it");
  }

  void read_buffers() {
    bool is_first = true;
    for (const Json& buffer : list_of(document_, "buffers")) {
      const std::string uri = buffer.is_object() ? buffer.value("uri", std::string()) : std::string();
      const std::size_t comma = uri.find(";base64,");
      if (uri.empty() && is_first)
        buffers_.emplace_back(binary_);
      else if (uri.starts_with("data:") && comma != std::string::npos)
        buffers_.push_back(from_base64(std::string_view(uri).substr(comma + 8), uri.size()));
      else
        refuse_file("its data are in another file: export it as one .glb");
      is_first = false;
    }
  }

  /// The bytes of `count` elements of a view, each `bytes` long; sets `stride`, the bytes from one element to
  /// the next.
  std::string_view elements(std::size_t view_number, std::size_t offset, std::size_t count, std::size_t bytes,
                            std::size_t& stride) const {
    const Json& view = entry(document_, "bufferViews", view_number);
    const std::size_t buffer = whole(view, "buffer", 0), begin = whole(view, "byteOffset", 0),
                      length = whole(view, "byteLength", 0);
    stride = whole(view, "byteStride", bytes, 252);
    if (buffer >= buffers_.size() || begin > buffers_[buffer].size() ||
        length > buffers_[buffer].size() - begin)
      refuse_file("a view reaches beyond the file's data: it is cut short or damaged");
    if (stride < bytes || offset > length || (count > 0 && (length - offset) < bytes) ||
        (count > 1 && (length - offset - bytes) / stride < count - 1))
      refuse_file("an accessor reaches beyond its view: the file is damaged");
    return std::string_view(buffers_[buffer]).substr(begin + offset, length - offset);
  }

  /// The numbers of an accessor's elements, `width` for each.
  std::vector<double> numbers(std::size_t number, std::size_t width, const char* type) {
    const Json& accessor = entry(document_, "accessors", number);
    if (accessor.value("type", std::string()) != type)
      refuse_file("an accessor is not of type " + std::string(type));
    const std::size_t kind = whole(accessor, "componentType", 0), count = whole(accessor, "count", 0);
    const Component component = component_of(kind);
    const bool is_normalised = accessor.value("normalized", false);
    spend(count * width);
    std::vector<double> made(count * width, 0.0);
    const auto read = [&](std::string_view bytes) {
      const double value = number_at(bytes, kind);
      return is_normalised && kind != 5126 ? std::max(value / component.largest, -1.0) : value;
    };
    if (accessor.contains("bufferView")) {
      std::size_t stride = 0;
      const std::string_view data =
          elements(whole(accessor, "bufferView", 0), whole(accessor, "byteOffset", 0), count,
                   width * component.bytes, stride);
      for (std::size_t i = 0; i < count; ++i)
        for (std::size_t k = 0; k < width; ++k)
          made[i * width + k] = read(data.substr(i * stride + k * component.bytes, component.bytes));
    }
    if (accessor.contains("sparse")) replace_some(accessor["sparse"], width, component.bytes, made, read);
    return made;
  }

  template <typename Read>
  void replace_some(const Json& sparse, std::size_t width, std::size_t bytes, std::vector<double>& made,
                    const Read& read) const {
    if (!sparse.is_object() || !sparse.contains("indices") || !sparse.contains("values"))
      refuse_file("a sparse accessor has no indices or no values");
    const Json &indices = sparse["indices"], &values = sparse["values"];
    const std::size_t count = whole(sparse, "count", 0), kind = whole(indices, "componentType", 0);
    const std::size_t index_bytes = component_of(kind).bytes;
    std::size_t index_stride = 0, stride = 0;
    const std::string_view where = elements(whole(indices, "bufferView", 0), whole(indices, "byteOffset", 0),
                                            count, index_bytes, index_stride),
                           what = elements(whole(values, "bufferView", 0), whole(values, "byteOffset", 0),
                                           count, width * bytes, stride);
    for (std::size_t i = 0; i < count; ++i) {
      const double index = number_at(where.substr(i * index_stride, index_bytes), kind);
      if (!(index >= 0.0) || index >= static_cast<double>(made.size() / width))
        refuse_file("a sparse accessor changes an element that does not exist");
      for (std::size_t k = 0; k < width; ++k)
        made[static_cast<std::size_t>(index) * width + k] = read(what.substr(i * stride + k * bytes, bytes));
    }
  }

  /// Bounds the total output of a file: elements take bytes, but many accessors and nodes may share them.
  void spend(std::size_t count) {
    const std::size_t most = 10'000'000 + 8 * bytes_.size();
    if (count > most || spent_ > most - count)
      refuse_file("places its meshes so often that the result is too large: export one mesh");
    spent_ += count;
  }

  std::vector<std::size_t> roots() const {
    const Json& nodes = list_of(document_, "nodes");
    std::vector<std::size_t> made;
    const auto add_all = [](const Json& list, std::vector<std::size_t>& to) {
      for (const Json& number : list)
        if (number.is_number_unsigned()) to.push_back(number.get<std::size_t>());
    };
    if (!list_of(document_, "scenes").empty()) {
      add_all(list_of(entry(document_, "scenes", whole(document_, "scene", 0)), "nodes"), made);
      return made;
    }
    std::vector<bool> is_child(nodes.size(), false);
    for (const Json& node : nodes)
      if (node.is_object())
        for (const Json& child : list_of(node, "children"))
          if (child.is_number_unsigned() && child.get<std::size_t>() < nodes.size())
            is_child[child.get<std::size_t>()] = true;
    for (std::size_t i = 0; i < nodes.size(); ++i)
      if (!is_child[i]) made.push_back(i);
    return made;
  }

  void place_nodes() {
    struct PlacedNode {
      std::size_t node;
      glm::dmat4 matrix;
    };
    std::vector<bool> is_met(list_of(document_, "nodes").size(), false);
    std::vector<PlacedNode> open;
    std::vector<std::size_t> children = roots();
    const glm::dmat4 scaled = glm::scale(glm::dmat4(1.0), glm::dvec3(made_.scale));
    std::for_each(children.rbegin(), children.rend(), [&](std::size_t i) { open.push_back({i, scaled}); });
    PointNumbers points(made_.triangles.points_mm);
    while (!open.empty()) {
      const PlacedNode placed = open.back();
      open.pop_back();
      const Json& node = entry(document_, "nodes", placed.node);
      if (is_met[placed.node]) refuse_file("node " + std::to_string(placed.node) + " has two parents");
      is_met[placed.node] = true;
      const glm::dmat4 matrix = placed.matrix * matrix_of(node);
      if (node.contains("mesh")) add_mesh(whole(node, "mesh", 0), matrix, points);
      moved_ = moved_ || node.contains("skin");
      hidden_ += is_hidden(node);
      overlaid_ += node.contains("matrix") &&
                   (node.contains("translation") || node.contains("rotation") || node.contains("scale"));
      const Json& below = list_of(node, "children");
      for (auto child = below.rbegin(); child != below.rend(); ++child) {
        if (!child->is_number_unsigned()) refuse_file("a node's child is not a number");
        open.push_back({child->get<std::size_t>(), matrix});
      }
    }
  }

  void add_mesh(std::size_t number, const glm::dmat4& matrix, PointNumbers& points) {
    for (const Json& primitive : list_of(entry(document_, "meshes", number), "primitives")) {
      if (!primitive.is_object() || !primitive.contains("attributes"))
        refuse_file("a primitive has no attributes");
      const std::size_t mode = whole(primitive, "mode", 4);
      if (mode < 4 || !primitive["attributes"].contains("POSITION")) continue;  // skips points and lines
      if (mode > 6) refuse_file("a primitive has mode " + std::to_string(mode));
      moved_ = moved_ || primitive.contains("targets");
      const std::vector<double> places = numbers(whole(primitive["attributes"], "POSITION", 0), 3, "VEC3");
      std::vector<double> corners;
      if (primitive.contains("indices")) {
        corners = numbers(whole(primitive, "indices", 0), 1, "SCALAR");
      } else {
        for (std::size_t i = 0; i < places.size() / 3; ++i) corners.push_back(static_cast<double>(i));
      }
      add_triangles(places, corners, mode, matrix, points);
    }
  }

  void add_triangles(const std::vector<double>& places, const std::vector<double>& corners, std::size_t mode,
                     const glm::dmat4& matrix, PointNumbers& points) {
    const std::size_t count = places.size() / 3;
    std::vector<std::uint32_t> number(count);
    std::vector<bool> is_used(count, false);
    for (const double corner : corners) {
      if (!(corner >= 0.0) || corner >= static_cast<double>(count))
        refuse_file("a triangle refers to point " + std::to_string(corner) + " of " + std::to_string(count));
      is_used[static_cast<std::size_t>(corner)] = true;
    }
    for (std::size_t i = 0; i < count; ++i) {
      if (!is_used[i]) continue;
      const glm::dvec3 p(matrix * glm::dvec4(places[3 * i], places[3 * i + 1], places[3 * i + 2], 1.0));
      if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
        refuse_file("a point is not finite");
      number[i] = points.number_of(p);
    }
    const bool is_mirrored = glm::determinant(glm::dmat3(matrix)) < 0.0;
    const auto add = [&](std::size_t a, std::size_t b, std::size_t c) {
      const auto at = [&](std::size_t i) { return number[static_cast<std::size_t>(corners[i])]; };
      if (is_mirrored) std::swap(b, c);
      made_.triangles.faces.push_back({at(a), at(b), at(c)});
    };
    for (std::size_t i = 0; i + 2 < corners.size(); i += mode == 4 ? 3 : 1) {
      if (mode == 4) add(i, i + 1, i + 2);
      if (mode == 5) i % 2 == 0 ? add(i, i + 1, i + 2) : add(i + 1, i, i + 2);
      if (mode == 6) add(0, i + 1, i + 2);
    }
  }

  std::string_view bytes_, binary_;
  Json document_;
  std::vector<std::string> buffers_;
  std::size_t spent_ = 0;
  bool moved_ = false;
  std::size_t hidden_ = 0;    ///< nodes that the file declares invisible
  std::size_t overlaid_ = 0;  ///< nodes that have a matrix and also a translation, rotation or scale
  MeshContent made_;
};

}  // namespace

MeshContent read_glb(std::string_view bytes) {
  try {
    return GlbReader(bytes).run();
  } catch (const Json::exception& error) {
    throw Error(ErrorCode::Input, std::string("its JSON is damaged: ") + error.what());
  }
}

}  // namespace octotomy::brep
