// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/contour/chain_code.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "brep/mesh/error.h"

namespace octotomy::brep {
namespace {

constexpr std::array<std::array<int, 2>, 8> directions = {
    {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}}};

std::uint8_t code_of(int x, int y) {
  for (std::uint8_t k = 0; k < 8; ++k)
    if (directions[k][0] == x && directions[k][1] == y) return k;
  throw std::logic_error("chain_code: a step is longer than one sample");
}

int sign(int value) {
  return (value > 0) - (value < 0);
}

/// Appends the steps from one sample to another; sets `from` to `to`.
void walk(glm::ivec2& from, const glm::ivec2& to, std::vector<std::uint8_t>& steps) {
  const glm::ivec2 way(std::abs(to.x - from.x), std::abs(to.y - from.y));
  const glm::ivec2 step(sign(to.x - from.x), sign(to.y - from.y));
  int error = way.x - way.y;
  while (from != to) {
    const int twice = 2 * error;
    glm::ivec2 move(0);
    if (twice > -way.y) {
      error -= way.y;
      move.x = step.x;
    }
    if (twice < way.x) {
      error += way.x;
      move.y = step.y;
    }
    steps.push_back(code_of(move.x, move.y));
    from += move;
  }
}

/// Replaces two straight steps around a corner by the diagonal across it.
std::vector<std::uint8_t> without_corners(const std::vector<std::uint8_t>& steps) {
  std::vector<std::uint8_t> thin;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const bool both_straight = i + 1 < steps.size() && steps[i] % 2 == 0 && steps[i + 1] % 2 == 0;
    const int turn = both_straight ? (steps[i + 1] - steps[i] + 8) % 8 : 0;
    if (turn != 2 && turn != 6) {
      thin.push_back(steps[i]);
      continue;
    }
    thin.push_back(static_cast<std::uint8_t>((steps[i] + (turn == 2 ? 1 : 7)) % 8));
    ++i;
  }
  return thin;
}

void check(const glm::dvec2& spacing_mm) {
  if (!(spacing_mm.x > 0.0) || !(spacing_mm.y > 0.0))
    throw InvalidInput("chain_code: the spacing must be above zero");
}

}  // namespace

ChainCode chain_code(const Contour& contour, const glm::dvec2& spacing_mm) {
  check(spacing_mm);
  if (contour.points_mm.empty()) throw InvalidInput("chain_code: the contour has no points");
  constexpr double furthest = 1 << 30, most_steps = 1 << 24;
  double steps = 0.0;
  glm::dvec2 last = contour.points_mm.front() / spacing_mm;
  for (const glm::dvec2& p_mm : contour.points_mm) {
    const glm::dvec2 p = p_mm / spacing_mm;
    steps += std::max(std::abs(p.x - last.x), std::abs(p.y - last.y));
    last = p;
    if (!(std::max(std::abs(p.x), std::abs(p.y)) <= furthest && steps <= most_steps))
      throw Error(ErrorCode::Resource,
                  "chain_code: the contour takes more than 2^24 steps, or lies more than 2^30 "
                  "steps away: choose larger steps");
  }
  const auto sample = [&](const glm::dvec2& p) { return glm::ivec2(glm::round(p / spacing_mm)); };
  ChainCode code{sample(contour.points_mm.front()), {}, contour.closed};
  glm::ivec2 at = code.start;
  for (const glm::dvec2& p : contour.points_mm) walk(at, sample(p), code.steps);
  if (contour.closed) walk(at, code.start, code.steps);
  code.steps = without_corners(code.steps);
  return code;
}

Contour contour_of(const ChainCode& code, const glm::dvec2& spacing_mm) {
  check(spacing_mm);
  Contour contour{{glm::dvec2(code.start) * spacing_mm}, code.closed};
  glm::ivec2 at = code.start;
  for (std::size_t i = 0; i < code.steps.size(); ++i) {
    if (code.steps[i] > 7)
      throw InvalidInput("chain_code: step " + std::to_string(i) + " is " + std::to_string(code.steps[i]) +
                         ": directions are numbered 0 to 7");
    at += glm::ivec2(directions[code.steps[i]][0], directions[code.steps[i]][1]);
    contour.points_mm.push_back(glm::dvec2(at) * spacing_mm);
  }
  if (!code.closed) return contour;
  if (at != code.start) throw InvalidInput("chain_code: a closed chain does not end where it starts");
  if (contour.points_mm.size() > 1) contour.points_mm.pop_back();
  return contour;
}

double chain_length(const ChainCode& code) {
  double length = 0.0;
  for (const std::uint8_t step : code.steps) length += step % 2 == 0 ? 0.948 : 1.340;
  return length;
}

}  // namespace octotomy::brep
