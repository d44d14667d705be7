// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/certificate/facet_count.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <gtest/gtest.h>
#include <string>

#include "verify/phantom/implicit_solid.h"

namespace octotomy::verify {
namespace {

struct Block {
  glm::dvec3 half{1.0};
  glm::dmat3 axes{1.0};
};

std::vector<Facet> facets_of(const Block& block) {
  std::vector<Facet> facets;
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {-1.0, 1.0}) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      std::array<glm::dvec3, 4> corner;
      for (std::size_t i = 0; i < 4; ++i) {
        glm::dvec3 p(0.0);
        p[axis] = sign * block.half[axis];
        p[u] = (i == 1 || i == 2 ? 1.0 : -1.0) * sign * block.half[u];
        p[v] = (i >= 2 ? 1.0 : -1.0) * block.half[v];
        corner[i] = block.axes * p;
      }
      Facet facet;
      facet.area = block.axes[axis] * (sign * 4.0 * block.half[u] * block.half[v]);
      for (std::size_t i = 0; i < 4; ++i) facet.sides.push_back({corner[i], corner[(i + 1) % 4]});
      facets.push_back(std::move(facet));
    }
  return facets;
}

/// Lattice points in a block.
int count_in(const Block& block, const glm::dvec3& centre) {
  const double reach = glm::length(block.half);
  const glm::ivec3 low(glm::floor(centre - reach)), high(glm::ceil(centre + reach));
  int count = 0;
  for (int z = low.z; z <= high.z; ++z)
    for (int y = low.y; y <= high.y; ++y)
      for (int x = low.x; x <= high.x; ++x) {
        const glm::dvec3 p = glm::transpose(block.axes) * (glm::dvec3(x, y, z) - centre);
        count += glm::all(glm::lessThan(glm::abs(p), block.half));
      }
  return count;
}

double seen_variance(const Block& block) {
  const double volume = 8.0 * block.half.x * block.half.y * block.half.z;
  constexpr int places = 1500;
  double squares = 0.0;
  for (int i = 0; i < places; ++i) {
    // Additive recurrence: spread evenly over a voxel.
    const glm::dvec3 centre =
        glm::fract(glm::dvec3(i) * glm::dvec3(0.8191725134, 0.6710436067, 0.5497004779));
    const double error = count_in(block, centre) - volume;
    squares += error * error;
  }
  return squares / places;
}

TEST(FacetCount, PredictsTheVarianceOfACountOverAllPlacesOfABlockHoweverItLies) {
  const struct {
    const char* told;
    Block block;
  } cases[] = {{"any way", {{7.3, 9.1, 5.7}, turned({23, 41, 67})}},
               // Every layer of voxels along z errs as the first does.
               {"along z", {{7.3, 9.1, 24.5}, turned({0, 0, 17})}},
               {"a thin plate", {{12.0, 15.0, 0.4}, turned({11, 73, 29})}},
               {"along the lattice, nearly", {{10.4, 8.2, 6.6}, turned({0.5, 0.8, 0.3})}}};
  for (const auto& [told, block] : cases) {
    const double seen = seen_variance(block), predicted = count_variance(facets_of(block));
    EXPECT_NEAR(predicted / seen, 1.0, 0.15)
        << told << ": " << predicted << " predicted, " << seen << " seen";
  }
}

TEST(FacetCount, ErrsInStepAlongALatticeAxis) {
  const Block along{{7.3, 9.1, 24.5}, turned({0, 0, 17})}, across{{7.3, 9.1, 24.5}, turned({31, 47, 17})};
  // As many layers as are alike: the variance grows with their square, not with their number.
  EXPECT_GT(count_variance(facets_of(along)), 5.0 * count_variance(facets_of(across)));
}

/// The transform of one facet at k as the definition has it, side by side with a sine and a cosine each.
std::complex<double> plain_transform(const Facet& facet, const glm::dvec3& k) {
  const double area = glm::length(facet.area);
  const glm::dvec3 normal = facet.area / area;
  const double along = glm::dot(k, normal);
  const glm::dvec3 tangent = k - along * normal;
  std::complex<double> sum = 0.0;
  for (const auto& [from, to] : facet.sides) {
    const glm::dvec3 side = to - from;
    const double half = M_PI * glm::dot(k, side);
    sum += glm::dot(tangent, glm::cross(side, normal)) * (half == 0.0 ? 1.0 : std::sin(half) / half) *
           std::polar(1.0, -M_PI * glm::dot(k, from + to));
  }
  return std::complex<double>(0.0, along / (2.0 * M_PI * glm::dot(tangent, tangent))) * sum;
}

TEST(FacetCount, IsTheSumThatItsDefinitionSaysUpToRounding) {
  // A slanted star far from the origin, of fewer and more sides than are taken at once; some sides are at
  // right angles to many k.
  const glm::dmat3 axes = turned({0.0, 37.0, 11.0});
  for (const int corners : {4, 47, 48, 49, 200}) {
    Facet facet;
    std::vector<glm::dvec3> rim;
    for (int i = 0; i < corners; ++i) {
      const double turn = 2.0 * M_PI * i / corners, radius = i % 3 == 0 ? 9.0 : 8.0;
      rim.push_back(glm::dvec3(900.0, 1200.0, 300.0) +
                    axes * glm::dvec3(radius * std::cos(turn), radius * std::sin(turn), 0.0));
    }
    for (std::size_t i = 0; i < rim.size(); ++i) {
      const std::size_t j = (i + 1) % rim.size();
      facet.sides.push_back({rim[i], rim[j]});
      facet.area += 0.5 * glm::cross(rim[i] - rim[0], rim[j] - rim[0]);
    }
    std::reverse(facet.sides.begin(), facet.sides.end());
    Facet back = facet;
    back.area = -back.area;
    for (auto& [from, to] : back.sides) std::swap(from, to);
    EXPECT_LT(count_variance({facet, back}), 1e-15 * count_variance({facet})) << corners;
    for (auto& [from, to] : back.sides) {
      from.x += 0.25;
      to.x += 0.25;
    }
    double plain = 0.0;
    const std::vector<glm::ivec3> vectors = count_vectors({facet, back});
    for (const glm::ivec3& k : vectors) {
      const glm::dvec3 at(k);
      const double square = glm::dot(at, at);
      const std::complex<double> total = plain_transform(facet, at) + plain_transform(back, at);
      plain += 2.0 * std::norm(total) / (4.0 * M_PI * M_PI * square * square);
    }
    EXPECT_GT(vectors.size(), 1098U);
    EXPECT_NEAR(count_variance({facet, back}), plain, 1e-9 * plain) << corners;
  }
}

TEST(FacetCount, SplittingAFacetChangesNothing) {
  const std::vector<Facet> whole = facets_of({{7.3, 9.1, 5.7}, turned({23, 41, 67})});
  std::vector<Facet> split(whole.begin() + 1, whole.end());
  const auto& sides = whole[0].sides;
  split.push_back({0.5 * whole[0].area, {sides[0], sides[1], {sides[1][1], sides[0][0]}}});
  split.push_back({0.5 * whole[0].area, {sides[2], sides[3], {sides[3][1], sides[2][0]}}});
  const double of_whole = count_variance(whole), of_split = count_variance(split);
  EXPECT_NEAR(of_split, of_whole, 1e-9 * of_whole);
}

TEST(FacetCount, PointsWithinStraightSidesChangeNothing) {
  const std::vector<Facet> whole = facets_of({{7.3, 9.1, 5.7}, turned({23, 41, 67})});
  std::vector<Facet> cut = whole;
  for (Facet& facet : cut) {
    const auto sides = std::move(facet.sides);
    facet.sides.clear();
    for (const auto& [from, to] : sides)
      for (int i = 0; i < 60; ++i)
        facet.sides.push_back({glm::mix(from, to, i / 60.0), glm::mix(from, to, (i + 1) / 60.0)});
    // A corner in the midst of a side, and back: both of its sides count.
    const glm::dvec3 out = facet.sides[30][0] + 0.3 * (facet.sides[30][0] - facet.sides[100][0]);
    facet.sides.push_back({facet.sides[30][0], out});
    facet.sides.push_back({out, facet.sides[30][0]});
  }
  const double of_whole = count_variance(whole);
  EXPECT_NEAR(count_variance(cut), of_whole, 1e-9 * of_whole);
}

}  // namespace
}  // namespace octotomy::verify
