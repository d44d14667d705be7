// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace octotomy::bench {

/// Points joined by a line; positive numbers.
struct Curve {
  std::string name;
  std::vector<std::pair<double, double>> points;
};

struct LogPlot {
  std::string title, x_label, y_label;
  std::vector<Curve> curves;
};

/// Draws curves on two logarithmic axes as SVG, each named with its fitted slope, the power of x by which y
/// grows. Throws std::runtime_error if the file cannot be written.
void write_svg(const LogPlot& plot, const std::filesystem::path& path);

/// The power p of the line y = c x^p fitted to a curve's points by least squares of their logarithms.
/// Precondition: two points of different x.
double fitted_power(const Curve& curve);

}  // namespace octotomy::bench
