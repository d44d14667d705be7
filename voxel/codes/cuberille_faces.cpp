// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/codes/cuberille_faces.h"

#include <algorithm>
#include <stdexcept>
#include <tuple>

#include "voxel/space/error.h"
#include "voxel/space/text_cursor.h"
#include "voxel/tree/logical_build.h"
#include "voxel/tree/slice_build.h"
#include "voxel/tree/voxel_boundary.h"

namespace octotomy::voxel {
namespace {

constexpr std::array<const char*, direction_count> names{"x+", "x-", "y+", "y-", "z+", "z-"};

std::tuple<int, int, int> x_fastest(const glm::ivec3& voxel) {
  return {voxel.z, voxel.y, voxel.x};
}

[[noreturn]] void refuse(int direction, const glm::ivec3& voxel, const std::string& why) {
  throw InvalidInput("cuberille, " + std::string(names[static_cast<std::size_t>(direction)]) +
                     " face of voxel (" + std::to_string(voxel.x) + "," + std::to_string(voxel.y) + "," +
                     std::to_string(voxel.z) + "): " + why);
}

void check(const CuberilleFaces& faces) {
  check_depth(faces.universe.depth);
  const int side = faces.universe.side();
  for (int direction = 0; direction < direction_count; ++direction) {
    const auto& list = faces.lists[static_cast<std::size_t>(direction)];
    for (std::size_t i = 0; i < list.size(); ++i) {
      if (glm::any(glm::lessThan(list[i], glm::ivec3(0))) ||
          glm::any(glm::greaterThanEqual(list[i], glm::ivec3(side))))
        refuse(direction, list[i], "lies outside the universe of " + std::to_string(side) + " voxels a side");
      if (i > 0 && x_fastest(list[i]) <= x_fastest(list[i - 1]))
        refuse(direction, list[i], "does not come after its predecessor, x fastest");
    }
  }
}

// Each x- face and the next x+ face of its row are the ends of a run.
Octree octree_between_x_faces(const CuberilleFaces& faces) {
  const auto& starts = faces.lists[static_cast<std::size_t>(Direction::MinusX)];
  const auto& ends = faces.lists[static_cast<std::size_t>(Direction::PlusX)];
  constexpr int minus_x = static_cast<int>(Direction::MinusX);
  constexpr int plus_x = static_cast<int>(Direction::PlusX);
  if (ends.size() > starts.size()) refuse(plus_x, ends[starts.size()], "no x- face begins its run");
  for (std::size_t i = 0; i < starts.size(); ++i) {
    if (i == ends.size() || ends[i].y != starts[i].y || ends[i].z != starts[i].z || ends[i].x < starts[i].x)
      refuse(minus_x, starts[i], "no x+ face ends its run");
    if (i > 0 && x_fastest(starts[i]) <= x_fastest(ends[i - 1]))
      refuse(minus_x, starts[i], "begins a run within another");
  }
  std::size_t next = 0;
  return octree_of_slices(faces.universe, [&](int z, SliceBits& slice) {
    const std::size_t before = next;
    for (; next < starts.size() && starts[next].z == z; ++next)
      set_row(slice, starts[next].y, starts[next].x, ends[next].x);
    return next != before;
  });
}

}  // namespace

glm::ivec3 step(Direction direction) {
  const int number = static_cast<int>(direction);
  glm::ivec3 result(0);
  result[number / 2] = number % 2 == 0 ? 1 : -1;
  return result;
}

std::string name_of(Direction direction) {
  return std::string(names[static_cast<std::size_t>(direction)]);
}

std::size_t CuberilleFaces::face_count() const {
  std::size_t count = 0;
  for (const auto& list : lists) count += list.size();
  return count;
}

CuberilleFaces cuberille_faces(const Octree& octree) {
  CuberilleFaces faces{octree.universe(), {}};
  for (const VoxelFace& face : voxel_boundary(octree))
    faces.lists[static_cast<std::size_t>(2 * face.axis + (face.side < 0 ? 1 : 0))].push_back(face.voxel);
  for (auto& list : faces.lists)
    std::sort(list.begin(), list.end(),
              [](const glm::ivec3& a, const glm::ivec3& b) { return x_fastest(a) < x_fastest(b); });
  return faces;
}

Octree octree_of(const CuberilleFaces& faces) {
  check(faces);
  Octree octree = octree_between_x_faces(faces);
  // The x faces determine the object; the other lists must agree with it.
  const CuberilleFaces expected = cuberille_faces(octree);
  for (int direction = 0; direction < direction_count; ++direction) {
    const auto& given = faces.lists[static_cast<std::size_t>(direction)];
    const auto& exposed = expected.lists[static_cast<std::size_t>(direction)];
    for (std::size_t i = 0; i < std::max(given.size(), exposed.size()); ++i) {
      if (i < given.size() && i < exposed.size() && given[i] == exposed[i]) continue;
      const bool missing =
          i == given.size() || (i < exposed.size() && x_fastest(exposed[i]) < x_fastest(given[i]));
      if (missing) refuse(direction, exposed[i], "is missing: the x faces make it part of the boundary");
      refuse(direction, given[i], "is not on the boundary of the object between the x faces");
    }
  }
  return octree;
}

std::string text(const CuberilleFaces& faces) {
  std::string result;
  for (std::size_t direction = 0; direction < direction_count; ++direction) {
    result += names[direction];
    const auto& list = faces.lists[direction];
    for (std::size_t i = 0; i < list.size(); ++i)
      result += (i == 0 ? " (" : ", (") + std::to_string(list[i].x) + "," + std::to_string(list[i].y) + "," +
                std::to_string(list[i].z) + ")";
    result += '\n';
  }
  return result;
}

CuberilleFaces parse_cuberille_faces(const Universe& universe, std::string_view text) {
  check_depth(universe.depth);
  CuberilleFaces faces{universe, {}};
  const auto largest = static_cast<std::uint64_t>(universe.side() - 1);
  TextCursor cursor("cuberille", text);
  for (std::size_t direction = 0; direction < direction_count; ++direction) {
    cursor.skip_spaces();
    cursor.expect(names[direction]);
    auto& list = faces.lists[direction];
    for (cursor.skip_blanks(); cursor.accept(list.empty() ? "(" : ","); cursor.skip_blanks()) {
      if (!list.empty()) {
        cursor.skip_blanks();
        cursor.expect("(");
      }
      glm::ivec3 voxel;
      for (int axis = 0; axis < 3; ++axis) {
        if (axis > 0) cursor.expect(",");
        voxel[axis] = static_cast<int>(cursor.number(largest));
      }
      cursor.expect(")");
      list.push_back(voxel);
    }
  }
  cursor.expect_end();
  return faces;
}

}  // namespace octotomy::voxel
