// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads the volume files that lines of standard input name, each with an optional frame and unit behind tabs,
// and prints one JSON object a line: what the scene holds, or why the file is refused.
#include <cstdio>
#include <exception>
#include <iostream>
#include <string>

#include "voxel/scan/read_scene.h"

namespace {

using namespace octotomy::voxel;

std::string quoted(const std::string& text) {
  std::string safe = "\"";
  for (const char letter : text) {
    if (letter == '"' || letter == '\\') safe += '\\';
    safe += static_cast<unsigned char>(letter) < ' ' ? '?' : letter;
  }
  return safe + '"';
}

std::string number(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

std::string part(std::string& line) {
  const std::size_t tab = std::min(line.find('\t'), line.size());
  const std::string first = line.substr(0, tab);
  line.erase(0, tab + 1);
  return first;
}

std::string json_of(const Scene& scene) {
  std::string json = "{\"lps\": [";
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column)
      json += (row + column > 0 ? ", " : "") + number(scene.lattice.lps_from_voxel[column][row]);
  json += "], \"dims\": [";
  for (int axis = 0; axis < 3; ++axis)
    json += (axis > 0 ? ", " : "") + std::to_string(scene.lattice.dims[axis]);
  json += "], \"unit\": " + quoted(unit(scene)) +
          ", \"label\": " + (scene.meaning == Meaning::Label ? "true" : "false") + ", \"samples\": [";
  std::visit(
      [&](const auto& samples) {
        for (std::size_t i = 0; i < samples.size(); ++i)
          json += (i > 0 ? ", " : "") + number(static_cast<double>(samples[i]));
      },
      scene.samples);
  json += "], \"audit\": [";
  const char* between = "";
  for (const Finding& line : scene.audit) {
    const char* const verdict = line.verdict == Verdict::Pass   ? "PASS"
                                : line.verdict == Verdict::Warn ? "WARN"
                                                                : "FAIL";
    json += between + ("[" + quoted(line.check) + ", " + quoted(verdict) + ", " + quoted(line.detail) + "]");
    between = ", ";
  }
  return json + "]}";
}

std::string read(std::string line) {
  try {
    const std::string path = part(line), frame = part(line), unit = part(line);
    ReadOptions options;
    if (!frame.empty()) options.frame = parse_frame(frame);
    if (!unit.empty()) options.unit = parse_unit(unit);
    return json_of(read_scene(path, options));
  } catch (const std::exception& error) {
    return "{\"error\": " + quoted(error.what()) + "}";
  }
}

}  // namespace

int main() {
  for (std::string line; std::getline(std::cin, line);) std::cout << read(line) << std::endl;
  return 0;
}
