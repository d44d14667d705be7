// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/lettering.h"

#include <array>
#include <string_view>

namespace octotomy::voxel {
namespace {

// A glyph is a list of strokes, separated by spaces. A stroke is a list of points. A point has two symbols, x
// then y, each 0..9, or a letter from a = 10 on. Straight lines join the points. A point after a '*' is the
// control point of a quadratic curve between its neighbours. The baseline is y = 4; small letters reach 10,
// capitals 13, and descenders begin at 0.
constexpr double baseline = 4.0;
constexpr double cap_units = 9.0;
constexpr double gap_units = 2.5;    ///< between letters
constexpr double blank_units = 3.0;  ///< width of a space
constexpr int curve_segments = 8;

struct Glyph {
  int width = 0;
  const char* strokes = "";
};

constexpr std::array<Glyph, 94> glyphs{{
    {0, "0d07 0404"},                                               // !
    {2, "0d0b 2d2b"},                                               // "
    {5, "141d 444d 0757 0a5a"},                                     // #
    {5, "5b*5d3d2d*0d0b*092939*5956*543424*0406 3e33"},             // $
    {6, "046d 1d*0d0c*0b1b*2b2c*2d1d 56*4645*4454*6465*6656"},      // %
    {6, "641a*0d2d*4d3a*0806*0424*5467"},                           // &
    {0, "0d0b"},                                                    // '
    {2, "2e*0c08*0422"},                                            // (
    {2, "0e*2c28*2402"},                                            // )
    {4, "282c 094b 0b49"},                                          // *
    {6, "353b 0868"},                                               // +
    {1, "1402"},                                                    // ,
    {4, "0848"},                                                    // -
    {0, "0404"},                                                    // .
    {5, "025e"},                                                    // /
    {5, "2d*0d0a07*042434*54575a*5d3d2d"},                          // 0
    {5, "1b3d34 1454"},                                             // 1
    {5, "0b*0d2d3d*5d5b*590454"},                                   // 2
    {5, "0c*0d2d3d*5d5b*593929 39*5956*543424*0405"},               // 3
    {5, "444d0757"},                                                // 4
    {5, "5d0d0939*595756*543424*0405"},                             // 5
    {5, "5c*5d3d*0d0807*042434*5456*593929*0907"},                  // 6
    {5, "0d5d24"},                                                  // 7
    {5, "29*090b*0d2d3d*5d5b*593929*0906*042434*5456*5939"},        // 8
    {5, "05*0424*54595a*5d3d2d*0d0b*082838*585a"},                  // 9
    {0, "0404 0a0a"},                                               // :
    {1, "1402 1a1a"},                                               // ;
    {4, "4b0845"},                                                  // <
    {5, "0656 0a5a"},                                               // =
    {4, "0b4805"},                                                  // >
    {5, "0b*0d2d*5d4a2827 2424"},                                   // ?
    {8, "7444*0408*0d4d*8d89*8676*66676a 68*6a4a*2a28*2646*6668"},  // @
    {6, "043d64 1757"},                                             // A
    {6, "040d3d*5d5b*593909 39*6966*643404"},                       // B
    {6, "6b*6d3d*0d0a07*0434*6466"},                                // C
    {6, "040d2d*6d6a67*642404"},                                    // D
    {5, "5d0d0454 0949"},                                           // E
    {5, "5d0d04 0949"},                                             // F
    {6, "6b*6d3d*0d0a07*0434*64666838"},                            // G
    {6, "040d 646d 0969"},                                          // H
    {2, "141d 0424 0d2d"},                                          // I
    {4, "4d46*4424*0406"},                                          // J
    {6, "040d 6d07 2964"},                                          // K
    {5, "0d0454"},                                                  // L
    {8, "040d478d84"},                                              // M
    {6, "040d646d"},                                                // N
    {6, "3d*0d0a07*0434*64676a*6d3d"},                              // O
    {6, "040d3d*6d6b*683808"},                                      // P
    {6, "3d*0d0a07*0434*64676a*6d3d 4663"},                         // Q
    {6, "040d3d*6d6b*683808 3864"},                                 // R
    {6, "6b*6d3d*0d0b*0939*6966*6434*0406"},                        // S
    {6, "0d6d 343d"},                                               // T
    {6, "0d07*0434*64676d"},                                        // U
    {6, "0d346d"},                                                  // V
    {8, "0d244a648d"},                                              // W
    {6, "046d 0d64"},                                               // X
    {6, "0d386d 3438"},                                             // Y
    {6, "0d6d0464"},                                                // Z
    {2, "2e0e0222"},                                                // [
    {5, "0e52"},                                                    // backslash
    {2, "0e2e2202"},                                                // ]
    {4, "0a2d4a"},                                                  // ^
    {5, "0353"},                                                    // _
    {1, "0d1b"},                                                    // `
    {5, "3a2a*0a07*042434*5457*5a3a 5a54"},                         // a
    {5, "3a2a*0a07*042434*5457*5a3a 0d04"},                         // b
    {5, "59*5a3a2a*0a07*042434*5455"},                              // c
    {5, "3a2a*0a07*042434*5457*5a3a 5d54"},                         // d
    {5, "0757*5a3a2a*0a07*042434*5455"},                            // e
    {4, "4d3d*1d1b14 0a3a"},                                        // f
    {5, "3a2a*0a07*042434*5457*5a3a 5a53*503020*0001"},             // g
    {5, "0d04 07*0a2a3a*5a5754"},                                   // h
    {0, "040a 0c0d"},                                               // i
    {2, "2a22*2000 2c2d"},                                          // j
    {5, "0d04 5a06 2854"},                                          // k
    {1, "0d05*0414"},                                               // l
    {8, "040a 08*0a2a*4a4744 48*4a6a*8a8784"},                      // m
    {5, "040a 07*0a2a3a*5a5754"},                                   // n
    {5, "3a2a*0a07*042434*5457*5a3a"},                              // o
    {5, "3a2a*0a07*042434*5457*5a3a 000a"},                         // p
    {5, "3a2a*0a07*042434*5457*5a3a 505a"},                         // q
    {3, "040a 07*0a3a"},                                            // r
    {4, "49*4a2a*0a08*0727*4745*4424*0405"},                        // s
    {3, "1d16*1434 0a3a"},                                          // t
    {5, "0a07*042434*5457 5a54"},                                   // u
    {4, "0a244a"},                                                  // v
    {8, "0a2449648a"},                                              // w
    {4, "044a 0a44"},                                               // x
    {4, "0a24 4a1000"},                                             // y
    {4, "0a4a0444"},                                                // z
    {3, "3e*1e1b*1808*1815*1232"},                                  // {
    {0, "0e02"},                                                    // |
    {3, "0e*2e2b*2838*2825*2202"},                                  // }
    {6, "07*1938*5769"},                                            // ~
}};
constexpr Glyph unknown{5, "040d5d5404"};

/// The glyph of the code point at `at`; none for a blank. Moves `at` behind the code point.
const Glyph* take_glyph(std::string_view text, std::size_t& at) {
  const auto first = static_cast<unsigned char>(text[at++]);
  while (at < text.size() && (static_cast<unsigned char>(text[at]) & 0xc0) == 0x80) ++at;
  if (first == ' ') return nullptr;
  return first > ' ' && first < 0x7f ? &glyphs[static_cast<std::size_t>(first - '!')] : &unknown;
}

double units_of(char symbol) {
  return symbol <= '9' ? symbol - '0' : symbol - 'a' + 10;
}

/// The strokes of a glyph, in units of the glyph's grid, counted from the left end of the baseline, y up.
void add_strokes(const Glyph& glyph, std::vector<Polyline>& strokes) {
  const std::string_view text = glyph.strokes;
  Polyline stroke;
  for (std::size_t at = 0; at < text.size();) {
    if (text[at] == ' ') {
      strokes.push_back(std::move(stroke));
      stroke.clear();
      ++at;
      continue;
    }
    const auto take_point = [&] {
      const glm::dvec2 point(units_of(text[at]), units_of(text[at + 1]) - baseline);
      at += 2;
      return point;
    };
    if (text[at] != '*') {
      stroke.push_back(take_point());
      continue;
    }
    ++at;
    const glm::dvec2 from = stroke.back(), control = take_point(), to = take_point();
    for (int i = 1; i <= curve_segments; ++i) {
      const double t = static_cast<double>(i) / curve_segments;
      stroke.push_back((1 - t) * (1 - t) * from + 2 * t * (1 - t) * control + t * t * to);
    }
  }
  strokes.push_back(std::move(stroke));
}

}  // namespace

std::vector<Polyline> strokes_of_text(const std::string& text, const glm::dvec2& start_px, double cap_px) {
  const double unit_px = cap_px / cap_units;
  std::vector<Polyline> strokes;
  double x = 0.0;
  for (std::size_t at = 0; at < text.size();) {
    const Glyph* glyph = take_glyph(text, at);
    if (glyph == nullptr) {
      x += blank_units + gap_units;
      continue;
    }
    const std::size_t first = strokes.size();
    add_strokes(*glyph, strokes);
    for (std::size_t i = first; i < strokes.size(); ++i)
      for (glm::dvec2& point : strokes[i]) point = start_px + unit_px * glm::dvec2(x + point.x, -point.y);
    x += glyph->width + gap_units;
  }
  return strokes;
}

double text_width_px(const std::string& text, double cap_px) {
  double units = 0.0;
  for (std::size_t at = 0; at < text.size();) {
    const Glyph* glyph = take_glyph(text, at);
    units += (glyph != nullptr ? glyph->width : blank_units) + gap_units;
  }
  return units > 0.0 ? (units - gap_units) * cap_px / cap_units : 0.0;
}

std::string shortened(const std::string& text, double width_px, double cap_px) {
  if (text_width_px(text, cap_px) <= width_px) return text;
  std::string fits;
  for (std::size_t at = 0; at < text.size();) {
    take_glyph(text, at);
    std::string longer = text.substr(0, at) + "...";
    if (text_width_px(longer, cap_px) > width_px) break;
    fits = std::move(longer);
  }
  return fits;
}

}  // namespace octotomy::voxel
