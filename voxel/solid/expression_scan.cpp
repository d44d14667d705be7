// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/solid/expression_scan.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <optional>
#include <sstream>
#include <tbb/parallel_for.h>

#include "voxel/solid/combine.h"
#include "voxel/solid/grey_owner.h"
#include "voxel/solid/term_walk.h"
#include "voxel/space/error.h"
#include "voxel/space/shared_progress.h"

namespace octotomy::voxel {
namespace {

/// Replaces the expression's windows by windows on the lattices of their scans, on which no sample was
/// interpolated.
Expression on_scan_lattices(const Expression& expression) {
  using Kind = Expression::Kind;
  return evaluate_terms<Expression>(
      expression,
      [](const Expression::Term& term) -> Expression {
        if (const auto* window = std::get_if<Window>(&*term.leaf))
          return Window{window->grey.on_scan_lattice(), window->low, window->high};
        return std::visit([](const auto& leaf) { return Expression(leaf); }, *term.leaf);
      },
      [](const Expression::Term& term, const Expression& a) {
        return term.kind == Kind::Not ? ~a : carried(a, term.moved_from_still);
      },
      [](const Expression::Term& term, const Expression& a, const Expression& b) {
        if (term.kind == Kind::And) return a & b;
        if (term.kind == Kind::Or) return a | b;
        return term.kind == Kind::Minus ? a - b : a ^ b;
      });
}

/// A value below all samples.
double value_below(const Scene& frame) {
  const double low = range(frame).low, below = std::floor(low) - 1.0;
  if (std::holds_alternative<FloatSamples>(frame.samples)) {
    // From 2^24 on, neighbouring floats differ by more than 1.
    constexpr float lowest = -std::numeric_limits<float>::max();
    if (static_cast<float>(low) > lowest)
      return std::min(static_cast<float>(below), std::nextafter(static_cast<float>(low), lowest));
    throw Error(
        ErrorCode::Input,
        "the scan's samples reach down to the lowest float, so that none is left to mark holes: choose "
        "a value for holes");
  }
  if (below < std::numeric_limits<std::int16_t>::min())
    throw Error(ErrorCode::Input,
                "the scan's samples reach down to the lowest value of 16 bits, so that none is left to mark "
                "holes: choose a value for holes");
  return below;
}

/// Throws unless a sample can have the value. If the step is above 0, samples are 16-bit multiples of the
/// step; if it is 0, any finite value is allowed.
void need_sample(double value, double step, const std::string& of) {
  const double steps = step > 0.0 ? value / step : 0.0;
  if (std::isfinite(value) && steps >= -32768.0 && steps <= 32767.0) return;
  std::ostringstream told;
  told << "the value of " << of << ", " << value
       << ", is not a possible value of the scan's samples, which lie from " << -32768.0 * step << " to "
       << 32767.0 * step;
  throw Error(ErrorCode::Input, told.str());
}

template <typename Sample>
Sample stored(double value) {
  if constexpr (std::is_same_v<Sample, float>) return static_cast<float>(value);
  return static_cast<Sample>(std::clamp(std::floor(value + 0.5), -32768.0, 32767.0));
}

}  // namespace

ExpressionScan expression_scan(const Scene& frame, const GreyOctree& of_frame, const Expression& expression,
                               const ExpressionScanOptions& options) {
  const GreyOctree& own = of_frame.on_scan_lattice();
  const glm::ivec3& dims = frame.lattice.dims;
  // The plan's universe is used if its voxels coincide with the samples.
  const std::optional<glm::ivec3> offset =
      whole_voxel_offset(glm::inverse(own.universe().lps_from_voxel) * frame.lattice.lps_from_voxel);
  if (!offset || glm::any(glm::lessThan(*offset, glm::ivec3(0))) ||
      glm::any(glm::greaterThan(*offset + dims, glm::ivec3(own.universe().side()))))
    throw Error(ErrorCode::Input,
                "the scan extends beyond the plan's universe, or has too many samples along an axis for an "
                "octree: crop it, or average it down");
  ExpressionScan made{frame};
  made.hole = options.hole ? *options.hole : frame.padding ? *frame.padding : value_below(frame);
  if (!options.hole) made.scene.padding = made.hole;
  constexpr double largest_of_12_bits = 3071.0;
  made.filled = options.filled                         ? *options.filled
                : frame.meaning == Meaning::Hounsfield ? largest_of_12_bits
                                                       : range(frame).high;
  const double step = own.step();
  need_sample(made.hole, std::holds_alternative<FloatSamples>(frame.samples) ? 0.0 : 1.0, "holes");
  need_sample(made.filled, step, "objects without samples");
  if (std::holds_alternative<Int16Samples>(frame.samples)) made.hole = std::floor(made.hole + 0.5);
  const auto in_steps = [&](double value) {
    return static_cast<std::int16_t>(std::clamp(std::floor(value + 0.5), -32768.0, 32767.0));
  };
  const std::int16_t filled_steps = in_steps(made.filled / step);
  options.progress.at(0.0);
  const Expression expressed = on_scan_lattices(expression);
  const Octree held = combine(own.universe(), expressed);
  const GreyOwners owners(own.universe(), {SampleSource{expressed, std::nullopt, step}});

  std::atomic<std::uint64_t> holes = 0, filled = 0, changed = 0;
  const Progress writing = part_of(options.progress, 0.3, 1.0);
  SharedProgress slices(writing, static_cast<std::size_t>(dims.z));
  std::visit(
      [&](auto& values) {
        using Sample = std::decay_t<decltype(values[0])>;
        const auto hole = stored<Sample>(made.hole);
        tbb::parallel_for(0, dims.z, [&](int z) {
          slices.one_more();
          std::uint64_t holes_here = 0, filled_here = 0, changed_here = 0;
          std::size_t at = static_cast<std::size_t>(z) * static_cast<std::size_t>(dims.y) *
                           static_cast<std::size_t>(dims.x);
          for (int y = 0; y < dims.y; ++y)
            for (int x = 0; x < dims.x; ++x, ++at) {
              Sample& value = values[at];
              const glm::ivec3 voxel = glm::ivec3(x, y, z) + *offset;
              const bool is_held = held.contains(voxel);
              std::optional<OwnedSample> owned;
              if (is_held) owned = owners.at(voxel, glm::dvec3(voxel));
              if (is_held && !owned) ++filled_here;
              const std::int16_t steps = owned ? in_steps(owned->in_steps) : filled_steps;
              // A sample that, in steps, equals the frame's sample at the same place keeps the bits of the
              // frame's sample.
              const bool is_measured = own.scan().contains(voxel);
              if (is_held && is_measured && own.sample(voxel) == steps) continue;
              if (!is_held && !is_measured && frame.padding) continue;
              const Sample now = is_held ? stored<Sample>(steps * step) : hole;
              if (!is_held) ++holes_here;
              if (now != value) ++changed_here;
              value = now;
            }
          holes += holes_here;
          filled += filled_here;
          changed += changed_here;
        });
      },
      made.scene.samples);
  made.hole_samples = holes;
  made.filled_samples = filled;
  made.changed_samples = changed;
  return made;
}

}  // namespace octotomy::voxel
