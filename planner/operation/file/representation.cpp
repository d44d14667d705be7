// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/file/representation.h"

#include <array>
#include <span>
#include <stdexcept>

#include "planner/operation/table/nearest_name.h"
#include "voxel/codes/bi_tree.h"
#include "voxel/codes/binary_array.h"
#include "voxel/codes/cuberille_faces.h"
#include "voxel/codes/explicit_octree.h"
#include "voxel/codes/linear_octree.h"
#include "voxel/codes/marginal_index.h"
#include "voxel/codes/masked_octree.h"
#include "voxel/codes/multivalued_octree.h"
#include "voxel/codes/run_length.h"
#include "voxel/codes/segment_index.h"
#include "voxel/space/error.h"
#include "voxel/tree/packed_treecode.h"
#include "voxel/tree/treecode.h"

namespace octotomy::planner {
namespace {

using voxel::Octree;
using voxel::Universe;

struct Codec {
  std::string_view name;
  std::string (*encode)(const Octree& octree);
  Octree (*decode)(const Universe& universe, std::string_view content);
};

std::string closed(std::string text) {
  if (text.empty() || text.back() != '\n') text += '\n';
  return text;
}

std::span<const std::uint8_t> bytes_of(std::string_view content) {
  return {reinterpret_cast<const std::uint8_t*>(content.data()), content.size()};
}

std::string packed(const Octree& octree) {
  const std::vector<std::uint8_t> code = voxel::packed_treecode(octree);
  return {code.begin(), code.end()};
}

std::string bits(const Octree& octree) {
  const voxel::BinaryArray array = voxel::binary_array(octree);
  return {array.bytes.begin(), array.bytes.end()};
}

Octree octree_of_bits(const Universe& universe, std::string_view content) {
  const std::span<const std::uint8_t> bytes = bytes_of(content);
  return octree_of(voxel::BinaryArray{universe, {bytes.begin(), bytes.end()}});
}

constexpr std::string_view multivalued = "multivalued";

constexpr std::array<Codec, 13> codecs{{
    {"treecode", [](const Octree& octree) { return closed(voxel::treecode(octree)); },
     voxel::octree_of_treecode},
    {"linear", [](const Octree& octree) { return closed(text(voxel::linear_octree(octree))); },
     [](const Universe& universe, std::string_view content) {
       return octree_of(voxel::parse_linear_octree(universe, content));
     }},
    {"explicit", [](const Octree& octree) { return closed(text(voxel::explicit_octree(octree))); },
     [](const Universe& universe, std::string_view content) {
       return octree_of(voxel::parse_explicit_octree(universe, content));
     }},
    {"masked", [](const Octree& octree) { return closed(text(voxel::masked_octree(octree))); },
     [](const Universe& universe, std::string_view content) {
       return octree_of(voxel::parse_masked_octree(universe, content));
     }},
    {"bitree", [](const Octree& octree) { return closed(text(voxel::bi_tree(octree))); },
     [](const Universe& universe, std::string_view content) {
       return octree_of(voxel::parse_bi_tree(universe, content));
     }},
    {multivalued, [](const Octree& octree) { return closed(text(voxel::multivalued_octree({octree}))); },
     [](const Universe& universe, std::string_view content) {
       return object_of(voxel::parse_multivalued_octree(universe, content), 1);
     }},
    {"runs", [](const Octree& octree) { return closed(text(voxel::run_length(octree))); },
     [](const Universe& universe, std::string_view content) {
       return octree_of(voxel::parse_run_length(universe, content));
     }},
    {"segments", [](const Octree& octree) { return closed(text(voxel::segment_index(octree))); },
     [](const Universe& universe, std::string_view content) {
       return octree_of(voxel::parse_segment_index(universe, content));
     }},
    {"marginal", [](const Octree& octree) { return closed(text(voxel::marginal_index(octree))); },
     [](const Universe& universe, std::string_view content) {
       return octree_of(voxel::parse_marginal_index(universe, content));
     }},
    {"faces", [](const Octree& octree) { return closed(text(voxel::cuberille_faces(octree))); },
     [](const Universe& universe, std::string_view content) {
       return octree_of(voxel::parse_cuberille_faces(universe, content));
     }},
    {"array", [](const Octree& octree) { return closed(text(voxel::binary_array(octree))); },
     [](const Universe& universe, std::string_view content) {
       return octree_of(voxel::parse_binary_array(universe, content));
     }},
    {"packed", packed,
     [](const Universe& universe, std::string_view content) {
       return voxel::octree_of_packed_treecode(universe, bytes_of(content));
     }},
    {"bits", bits, octree_of_bits},
}};

const Codec& codec(std::string_view name) {
  for (const Codec& known : codecs)
    if (known.name == name) return known;
  throw voxel::InvalidInput("unknown representation '" + std::string(name) + "'" +
                            suggestion(name, representation_names()));
}

}  // namespace

std::vector<std::string> representation_names() {
  std::vector<std::string> names;
  names.reserve(codecs.size());
  for (const Codec& known : codecs) names.emplace_back(known.name);
  return names;
}

std::string represented(const std::vector<voxel::Octree>& objects, std::string_view name) {
  const Codec& known = codec(name);
  if (objects.size() == 1) return known.encode(objects.front());
  if (name != multivalued)
    throw voxel::InvalidInput("the form " + std::string(name) +
                              " can contain only one object: choose multivalued for several objects");
  return closed(text(voxel::multivalued_octree(objects)));
}

voxel::Octree octree_of_representation(const voxel::Universe& universe, std::string_view name,
                                       std::string_view content, int number) {
  const Codec& known = codec(name);
  if (name == multivalued) return object_of(voxel::parse_multivalued_octree(universe, content), number);
  return known.decode(universe, content);
}

}  // namespace octotomy::planner
