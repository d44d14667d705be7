// SPDX-License-Identifier: AGPL-3.0-or-later
#include "tests/bench/log_plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>
#include <sstream>
#include <stdexcept>

namespace octotomy::bench {
namespace {

// The picture in pixels: margins leave room for labels, and for the curves' names on the right.
constexpr double width = 840, height = 460, left = 80, right = 330, top = 46, bottom = 60;
constexpr std::array<const char*, 6> colours{"#1b6ca8", "#c0392b", "#2e8b57",
                                             "#8e44ad", "#b9770e", "#444444"};

struct Axis {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  double from_px = 0.0;
  double to_px = 1.0;

  void take(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  double px(double value) const {
    return from_px + (to_px - from_px) * std::log(value / low) / std::log(high / low);
  }
};

std::string number(double value) {
  std::array<char, 32> text;
  std::snprintf(text.data(), text.size(), "%.4g", value);
  return text.data();
}

std::string text(double x, double y, const std::string& said, const std::string& more = "") {
  std::ostringstream svg;
  svg << "<text x=\"" << number(x) << "\" y=\"" << number(y) << "\" " << more << ">" << said << "</text>\n";
  return svg.str();
}

std::string line(double x1, double y1, double x2, double y2) {
  std::ostringstream svg;
  svg << "<line x1=\"" << number(x1) << "\" y1=\"" << number(y1) << "\" x2=\"" << number(x2) << "\" y2=\""
      << number(y2) << "\" stroke=\"#dddddd\"/>\n";
  return svg.str();
}

// The x values that all curves share, or powers of ten if the curves have different ones.
std::vector<double> x_ticks(const LogPlot& plot, const Axis& x) {
  std::vector<double> common;
  for (const auto& [at, unused] : plot.curves.front().points) common.push_back(at);
  const bool is_common = std::all_of(plot.curves.begin(), plot.curves.end(), [&](const Curve& curve) {
    return curve.points.size() == common.size() &&
           std::equal(common.begin(), common.end(), curve.points.begin(),
                      [](double at, const auto& point) { return at == point.first; });
  });
  if (is_common) return common;
  std::vector<double> decades;
  for (double tick = std::pow(10.0, std::ceil(std::log10(x.low) - 1e-9)); tick <= x.high; tick *= 10.0)
    decades.push_back(tick);
  return decades;
}

// Powers of ten within the axis, as lines across the picture with their values.
std::string decades(const Axis& x, const Axis& y) {
  std::string svg;
  for (double tick = std::pow(10.0, std::ceil(std::log10(y.low))); tick <= y.high; tick *= 10.0)
    svg += line(x.from_px, y.px(tick), x.to_px, y.px(tick)) +
           text(x.from_px - 8, y.px(tick) + 4, number(tick), "text-anchor=\"end\"");
  return svg;
}

}  // namespace

double fitted_power(const Curve& curve) {
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (const auto& [x, y] : curve.points) {
    const double lx = std::log(x);
    const double ly = std::log(y);
    sx += lx;
    sy += ly;
    sxx += lx * lx;
    sxy += lx * ly;
  }
  const auto n = static_cast<double>(curve.points.size());
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

void write_svg(const LogPlot& plot, const std::filesystem::path& path) {
  Axis x{.from_px = left, .to_px = width - right};
  Axis y{.from_px = height - bottom, .to_px = top};
  for (const Curve& curve : plot.curves)
    for (const auto& [at, value] : curve.points) {
      x.take(at);
      y.take(value);
    }
  y.low /= 1.5;
  y.high *= 1.5;

  std::ostringstream svg;
  svg << "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" << width << "\" height=\"" << height
      << "\" font-family=\"sans-serif\" font-size=\"13\">\n<rect width=\"100%\" height=\"100%\" "
         "fill=\"white\"/>\n"
      << text(left, 24, plot.title, "font-size=\"16\"") << decades(x, y);
  for (const double at : x_ticks(plot, x))
    svg << line(x.px(at), y.from_px, x.px(at), y.to_px)
        << text(x.px(at), y.from_px + 20, number(at), "text-anchor=\"middle\"");
  svg << text(0.5 * (x.from_px + x.to_px), height - 14, plot.x_label, "text-anchor=\"middle\"")
      << text(18, 0.5 * (y.from_px + y.to_px), plot.y_label,
              "text-anchor=\"middle\" transform=\"rotate(-90 18 " + number(0.5 * (y.from_px + y.to_px)) +
                  ")\"");
  for (std::size_t i = 0; i < plot.curves.size(); ++i) {
    const Curve& curve = plot.curves[i];
    const std::string colour = colours[i % colours.size()];
    svg << "<polyline fill=\"none\" stroke-width=\"2\" stroke=\"" << colour << "\" points=\"";
    for (const auto& [at, value] : curve.points) svg << number(x.px(at)) << "," << number(y.px(value)) << " ";
    svg << "\"/>\n";
    std::array<char, 16> power;
    std::snprintf(power.data(), power.size(), "%.2f", fitted_power(curve));
    svg << text(x.to_px + 12, top + 14 + 20 * static_cast<double>(i), curve.name + ", power " + power.data(),
                "fill=\"" + colour + "\"");
  }
  svg << "</svg>\n";
  std::ofstream file(path);
  file << svg.str();
  if (!file.flush()) throw std::runtime_error(path.string() + ": cannot be written");
}

}  // namespace octotomy::bench
