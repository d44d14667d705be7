// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/cohort/plots.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "planner/result/report/drawn_page.h"

namespace octotomy::planner {
namespace {

constexpr double width = 460.0, height = 260.0;
constexpr double left = 62.0, right = 14.0, top = 30.0, bottom = 44.0;

std::string number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.6g", value == 0.0 ? 0.0 : value);
  return text.data();
}

/// The text of a tick, with the sign − for negative numbers.
std::string tick_label(double value) {
  return value < 0.0 ? "−" + number(-value) : number(value);
}

/// An axis of a plot, which converts numbers to pixels.
struct Axis {
  double low, high, from_px, to_px;

  double at(double value) const { return from_px + (value - low) / (high - low) * (to_px - from_px); }
  /// About five round numbers between both ends of the axis.
  std::vector<double> ticks() const {
    const double rough = (high - low) / 5.0;
    const double power = std::pow(10.0, std::floor(std::log10(rough)));
    const double share = rough / power;
    const double step = power * (share < 1.5 ? 1.0 : share < 3.5 ? 2.0 : share < 7.5 ? 5.0 : 10.0);
    std::vector<double> found;
    for (double tick = std::ceil(low / step) * step; tick <= high + 1e-9 * step; tick += step)
      found.push_back(std::abs(tick) < 1e-9 * step ? 0.0 : tick);
    return found;
  }
};

/// An axis for numbers from low to high, with a margin on both sides.
Axis axis(double low, double high, double from_px, double to_px) {
  double margin = 0.06 * (high - low);
  if (!(margin > 0.0)) margin = std::max(1e-6, 0.01 * std::abs(low));
  return {low - margin, high + margin, from_px, to_px};
}

std::string text(double x, double y, const std::string& anchor, const std::string& words,
                 const std::string& more = {}) {
  return "<text x='" + number(x) + "' y='" + number(y) + "' text-anchor='" + anchor + "'" + more + ">" +
         escaped(words) + "</text>";
}

std::string line(double x1, double y1, double x2, double y2, const std::string& more) {
  return "<line x1='" + number(x1) + "' y1='" + number(y1) + "' x2='" + number(x2) + "' y2='" + number(y2) +
         "' " + more + "/>";
}

/// A plot with title, axes, ticks and names of the axes; `inside` is the SVG of its content.
std::string framed(const std::string& title, const Axis& x, const Axis& y, const std::string& x_name,
                   const std::string& y_name, const std::string& inside) {
  std::string svg = "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 " + number(width) + " " +
                    number(height) +
                    "' role='img' font-family='sans-serif' font-size='11' fill='currentColor'>" + "<title>" +
                    escaped(title) + "</title>" +
                    text(width / 2.0, 18.0, "middle", title, " font-weight='bold' font-size='12.5'");
  const std::string faint = "stroke='currentColor' stroke-opacity='0.25'";
  for (const double tick : x.ticks()) {
    svg += line(x.at(tick), height - bottom, x.at(tick), height - bottom + 4.0, "stroke='currentColor'");
    svg += text(x.at(tick), height - bottom + 16.0, "middle", tick_label(tick));
  }
  for (const double tick : y.ticks()) {
    svg += line(left, y.at(tick), width - right, y.at(tick), faint);
    svg += text(left - 5.0, y.at(tick) + 4.0, "end", tick_label(tick));
  }
  svg += inside + line(left, height - bottom, width - right, height - bottom, "stroke='currentColor'");
  svg += text((left + width - right) / 2.0, height - 10.0, "middle", x_name);
  const double middle = (top + height - bottom) / 2.0;
  svg += text(14.0, middle, "middle", y_name, " transform='rotate(-90 14 " + number(middle) + ")'");
  return svg + "</svg>\n";
}

}  // namespace

std::string distribution_svg(const std::string& title, const std::string& unit,
                             const std::vector<double>& numbers) {
  const Spread spread = spread_of(numbers);
  const Axis x = axis(spread.least, spread.greatest, left, width - right);
  const auto bins = static_cast<std::size_t>(
      std::clamp(std::ceil(std::sqrt(static_cast<double>(numbers.size()))), 5.0, 60.0));
  const double bin = (x.high - x.low) / static_cast<double>(bins);
  std::vector<double> counts(bins, 0.0);
  for (const double value : numbers)
    ++counts[std::min(bins - 1, static_cast<std::size_t>((value - x.low) / bin))];
  const Axis y{0.0, 1.08 * *std::max_element(counts.begin(), counts.end()), height - bottom, top};
  std::string inside;
  for (std::size_t i = 0; i < bins; ++i) {
    const double from = x.at(x.low + bin * static_cast<double>(i));
    inside += "<rect x='" + number(from + 0.5) + "' y='" + number(y.at(counts[i])) + "' width='" +
              number(std::max(0.5, x.at(x.low + bin * static_cast<double>(i + 1)) - from - 1.0)) +
              "' height='" + number(y.at(0.0) - y.at(counts[i])) + "' fill='#3b82b5' fill-opacity='0.75'/>";
  }
  inside += line(x.at(spread.median), top, x.at(spread.median), height - bottom,
                 "stroke='currentColor' stroke-dasharray='5 3'");
  for (const double value : numbers)
    if (value < spread.lower_fence || value > spread.upper_fence)
      inside += line(x.at(value), height - bottom - 9.0, x.at(value), height - bottom,
                     "stroke='#c2410c' stroke-width='2'");
  return framed(title, x, y, unit, "subjects", inside);
}

std::string agreement_svg(const std::string& title, const std::string& unit, const Agreement& agreement) {
  double least = agreement.points.front().first, greatest = least;
  double low = agreement.low, high = agreement.high;
  for (const auto& [mean, difference] : agreement.points) {
    least = std::min(least, mean);
    greatest = std::max(greatest, mean);
    low = std::min(low, difference);
    high = std::max(high, difference);
  }
  const Axis x = axis(least, greatest, left, width - right);
  const Axis y = axis(low, high, height - bottom, top);
  std::string inside;
  for (const auto& [value, dashes] :
       {std::pair(agreement.bias, ""), std::pair(agreement.low, " stroke-dasharray='5 3'"),
        std::pair(agreement.high, " stroke-dasharray='5 3'")})
    inside += line(left, y.at(value), width - right, y.at(value), "stroke='#c2410c'" + std::string(dashes));
  for (const auto& [mean, difference] : agreement.points)
    inside += "<circle cx='" + number(x.at(mean)) + "' cy='" + number(y.at(difference)) +
              "' r='2.2' fill='#3b82b5' fill-opacity='0.7'/>";
  return framed(title, x, y, "mean, " + unit, "difference, " + unit, inside);
}

}  // namespace octotomy::planner
