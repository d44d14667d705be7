// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/filter/label_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>
#include <string>

#include "voxel/filter/slice_work.h"
#include "voxel/space/error.h"
#include "voxel/tree/build.h"

namespace octotomy::voxel {
namespace {

// The index of the nearest sample. Half-way between two samples it is the upper one on every machine: the
// tolerance covers the rounding of the coordinates.
glm::ivec3 nearest(const glm::dvec3& p_voxel) {
  constexpr double rounding = 0x1p-20;
  return {glm::floor(p_voxel + 0.5 + rounding)};
}

bool holds(const glm::ivec3& dims, const glm::ivec3& p) {
  return glm::all(glm::greaterThanEqual(p, glm::ivec3(0))) && glm::all(glm::lessThan(p, dims));
}

}  // namespace

Universe universe_on(const Lattice& lattice) {
  const int longest = std::max({lattice.dims.x, lattice.dims.y, lattice.dims.z});
  Universe universe{2, lattice.lps_from_voxel};
  while (universe.depth < Universe::max_depth && universe.side() < longest) ++universe.depth;
  if (universe.side() < longest)
    throw TooLarge("a scan of " + std::to_string(longest) + " samples along an axis takes more than " +
                   std::to_string(universe.side()) + " voxels a side: average the scan down first");
  return universe;
}

Octree chosen_samples(const Lattice& lattice, const Octree& own, const Octree& base, const Octree& made) {
  if (made == base) return own;
  const glm::ivec3 dims = lattice.dims;
  const glm::dmat4 voxel_from_index = glm::inverse(made.universe().lps_from_voxel) * lattice.lps_from_voxel;
  // Whether one of the up to eight voxels around the sample is in `made` and, with `only_added`, not in the
  // base.
  const auto is_near = [&](const glm::dvec3& p_voxel, bool only_added) {
    constexpr double rounding = 0x1p-20;  // a sample this near a voxel's centre counts as lying there
    const glm::ivec3 low(glm::floor(p_voxel + rounding)), high(glm::ceil(p_voxel - rounding));
    for (int z = low.z; z <= high.z; ++z)
      for (int y = low.y; y <= high.y; ++y)
        for (int x = low.x; x <= high.x; ++x)
          if (made.contains({x, y, z}) && !(only_added && base.contains({x, y, z}))) return true;
    return false;
  };
  return octree_of_blocks(own.universe(), [&](const glm::ivec3& block) -> Block {
    std::array<std::uint64_t, 64> words{};
    for (int z = 0; z < 16; ++z)
      for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 16; ++x) {
          const glm::ivec3 index = 16 * block + glm::ivec3(x, y, z);
          if (!holds(dims, index)) continue;
          const glm::dvec3 p_voxel(voxel_from_index * glm::dvec4(index, 1));
          const glm::ivec3 at = nearest(p_voxel);
          const bool is_own = own.contains(index), is_base = base.contains(at);
          if (is_own == is_base ? made.contains(at) : is_near(p_voxel, is_base))
            words[static_cast<std::size_t>(child_index(x >> 2, y >> 2, z >> 2))] |=
                std::uint64_t{1} << child_index(x & 3, y & 3, z & 3);
        }
    return make_leaf_block(0, all_children, words.data());
  });
}

LabelMap label_map(const Lattice& lattice, std::span<const Octree> objects, const Progress& progress) {
  if (objects.size() > 32767)
    throw InvalidInput("a label map can contain at most 32767 objects, not " +
                       std::to_string(objects.size()));
  LabelMap map;
  map.scene.lattice = lattice;
  map.scene.meaning = Meaning::Label;
  map.scene.source = "label map";
  Int16Samples labels(lattice.sample_count());
  std::vector<glm::dmat4> voxel_from_index;
  for (const Octree& object : objects)
    voxel_from_index.push_back(glm::inverse(object.universe().lps_from_voxel) * lattice.lps_from_voxel);
  const glm::ivec3 dims = lattice.dims;
  std::vector<std::uint64_t> overlaps(static_cast<std::size_t>(dims.z), 0);
  for_each_slice(dims.z, progress, [&](int z) {
    for (int y = 0; y < dims.y; ++y)
      for (int x = 0; x < dims.x; ++x) {
        std::int16_t label = 0;
        bool again = false;
        for (std::size_t i = 0; i < objects.size(); ++i) {
          const glm::dvec3 p(voxel_from_index[i] * glm::dvec4(x, y, z, 1));
          if (!objects[i].contains(nearest(p))) continue;
          again = label != 0;
          if (label == 0) label = static_cast<std::int16_t>(i + 1);
          if (again) break;
        }
        labels[sample_index(dims, {x, y, z})] = label;
        overlaps[static_cast<std::size_t>(z)] += again ? 1 : 0;
      }
  });
  for (const std::uint64_t count : overlaps) map.overlaps += count;
  map.scene.samples = std::move(labels);
  return map;
}

std::optional<int> label_of(double sample) {
  constexpr double most_off = 0.01;
  const double number = std::floor(sample + 0.5);
  if (!(std::abs(sample - number) <= most_off) || number < 0.0 || number > most_label) return std::nullopt;
  return static_cast<int>(number);
}

std::vector<Label> labels(const Scene& scene) {
  check(scene);
  std::map<int, Label> found;
  std::visit(
      [&](const auto& samples) {
        auto last = found.end();
        double last_value = std::numeric_limits<double>::quiet_NaN();  // most samples equal the one before
        for (const auto sample : samples) {
          const auto value = static_cast<double>(sample);
          if (value == last_value) {
            ++last->second.samples;
            continue;
          }
          if (scene.padding && value == *scene.padding) continue;
          const std::optional<int> number = label_of(value);
          if (!number)
            throw InvalidInput(scene.source + ": holds " + std::to_string(value) +
                               ", which is no label: labels are whole numbers from 0 to " +
                               std::to_string(most_label) +
                               (value > most_label ? ": renumber the labels" : ""));
          if (last == found.end() || last->first != *number)
            last = found.emplace(*number, Label{*number}).first;
          last_value = value;
          ++last->second.samples;
          last->second.off = std::max(last->second.off, std::abs(value - *number));
        }
      },
      scene.samples);
  for (const auto& [number, several] : scene.overlaps) {
    const auto shared = found.find(number);
    if (shared == found.end()) continue;
    for (const int label : several) {
      found.emplace(label, Label{label}).first->second.samples += shared->second.samples;
    }
    found.erase(shared);
  }
  found.erase(0);
  std::vector<Label> all;
  for (const auto& [number, label] : found) all.push_back(label);
  return all;
}

std::optional<Scene> laid_on(const Scene& scene, const Lattice& lattice) {
  constexpr double nearly = 1e-3;
  const glm::dmat4 to = glm::inverse(lattice.lps_from_voxel) * scene.lattice.lps_from_voxel;
  glm::dmat4 exact(1.0);
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 3; ++row) {
      exact[column][row] = std::round(to[column][row]);
      if (std::abs(to[column][row] - exact[column][row]) > nearly) return std::nullopt;
    }
  if (std::abs(std::abs(glm::determinant(exact)) - 1.0) > nearly) return std::nullopt;
  Scene laid = scene;
  laid.lattice = lattice;
  const glm::ivec3 from = scene.lattice.dims, dims = lattice.dims;
  const bool fits = std::visit(
      [&](auto& samples) {
        const auto stored = samples;
        samples.assign(lattice.sample_count(), 0);
        std::size_t i = 0;
        for (int z = 0; z < from.z; ++z)
          for (int y = 0; y < from.y; ++y)
            for (int x = 0; x < from.x; ++x, ++i) {
              if (stored[i] == 0) continue;
              const glm::ivec3 at(exact * glm::dvec4(x, y, z, 1.0));
              if (glm::any(glm::lessThan(at, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(at, dims)))
                return false;
              samples[(static_cast<std::size_t>(at.z) * static_cast<std::size_t>(dims.y) +
                       static_cast<std::size_t>(at.y)) *
                          static_cast<std::size_t>(dims.x) +
                      static_cast<std::size_t>(at.x)] = stored[i];
            }
        return true;
      },
      laid.samples);
  return fits ? std::optional(std::move(laid)) : std::nullopt;
}

Octree octree_of_label(const Universe& universe, const Scene& scene, int label) {
  check(scene);
  const glm::ivec3 dims = scene.lattice.dims;
  const glm::dmat4 index_from_voxel = glm::inverse(scene.lattice.lps_from_voxel) * universe.lps_from_voxel;
  std::vector<int> wanted{label};
  for (const auto& [number, several] : scene.overlaps)
    if (std::find(several.begin(), several.end(), label) != several.end()) wanted.push_back(number);
  const auto is_wanted = [&](double sample) {
    const std::optional<int> number = label_of(sample);
    return number && std::find(wanted.begin(), wanted.end(), *number) != wanted.end();
  };
  const int side = universe.side();
  return octree_of_blocks(universe, [&](const glm::ivec3& block) -> Block {
    std::array<std::uint64_t, 64> words{};
    for (int z = 0; z < 16; ++z)
      for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 16; ++x) {
          const glm::ivec3 voxel = 16 * block + glm::ivec3(x, y, z);
          if (voxel.x >= side || voxel.y >= side || voxel.z >= side) continue;
          const glm::ivec3 at = nearest(glm::dvec3(index_from_voxel * glm::dvec4(voxel, 1)));
          if (!holds(dims, at)) continue;
          const std::size_t sample = sample_index(dims, at);
          if (std::visit([&](const auto& samples) { return is_wanted(samples[sample]); }, scene.samples))
            words[static_cast<std::size_t>(child_index(x >> 2, y >> 2, z >> 2))] |=
                std::uint64_t{1} << child_index(x & 3, y & 3, z & 3);
        }
    return make_leaf_block(0, all_children, words.data());
  });
}

std::vector<LabelLayer> label_layers(const Scene& scene) {
  const std::vector<Label> all = labels(scene);
  if (all.size() > 32767)
    throw TooLarge(scene.source + ": holds " + std::to_string(all.size()) +
                   " labels, more than 32767: choose fewer labels");
  const auto overlap = [&](int a, int b) {
    return std::any_of(scene.overlaps.begin(), scene.overlaps.end(), [&](const auto& each) {
      return std::count(each.second.begin(), each.second.end(), a) > 0 &&
             std::count(each.second.begin(), each.second.end(), b) > 0;
    });
  };
  std::vector<LabelLayer> layers;
  for (const Label& label : all) {
    const auto is_free = [&](const LabelLayer& layer) {
      return std::none_of(layer.labels.begin(), layer.labels.end(),
                          [&](int other) { return overlap(other, label.number); });
    };
    auto layer = std::find_if(layers.begin(), layers.end(), is_free);
    if (layer == layers.end()) layer = layers.insert(layers.end(), LabelLayer{});
    layer->labels.push_back(label.number);
  }
  for (LabelLayer& layer : layers) {
    std::map<int, std::int16_t> rank;
    for (const int label : layer.labels) {
      const auto number = static_cast<std::int16_t>(rank.size() + 1);
      rank[label] = number;
    }
    for (const auto& [number, several] : scene.overlaps)
      for (const int label : several)
        if (const auto own = rank.find(label); own != rank.end()) rank[number] = own->second;
    layer.ranks.lattice = scene.lattice;
    layer.ranks.meaning = Meaning::Label;
    layer.ranks.source = scene.source;
    Int16Samples samples(scene.lattice.sample_count());
    for_each_slice(scene.lattice.dims.z, {}, [&](int z) {
      const std::size_t area = samples.size() / static_cast<std::size_t>(scene.lattice.dims.z);
      std::visit(
          [&](const auto& from) {
            for (std::size_t i = area * static_cast<std::size_t>(z), first = i, end = i + area; i < end;
                 ++i) {
              if (i > first && from[i] == from[i - 1]) {
                samples[i] = samples[i - 1];
                continue;
              }
              const auto own = rank.find(label_of(from[i]).value_or(0));
              samples[i] = own == rank.end() ? std::int16_t{0} : own->second;
            }
          },
          scene.samples);
    });
    layer.ranks.samples = std::move(samples);
  }
  return layers;
}

}  // namespace octotomy::voxel
