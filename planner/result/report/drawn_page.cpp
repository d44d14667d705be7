// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/result/report/drawn_page.h"

#include <algorithm>

#include "planner/operation/table/json_file.h"
#include "planner/plan/sha256.h"

namespace octotomy::planner {

std::string drawn_page(const std::string& title, const Json& data, const std::string& where_else) {
  // Only "<" could end the script's element. In JSON it occurs only in strings, where it can be escaped.
  std::string text;
  for (const char symbol : json_text(data))
    if (symbol == '<')
      text += "\\u003c";
    else
      text += symbol;
  std::string page =
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width,initial-scale=1\"><meta http-equiv=\"Content-Security-Policy\" "
      "content=\"default-src 'none'; style-src 'unsafe-inline'; img-src data: file: 'self'; script-src " +
      page_script_source() + "\"><title>" + escaped(title) + " \u00b7 Octotomy</title><style>";
  page += page_style();
  page += "</style></head><body><main><h1>" + escaped(title) + "</h1><p>A script in this page draws it. " +
          escaped(where_else) + "</p></main><script type=\"application/json\" id=\"data\">" + text +
          "</script><script>";
  page += page_script();
  return page + "</script></body></html>\n";
}

std::string page_script_source() {
  static const std::string source = [] {
    const std::string digits = sha256_of(page_script());
    std::vector<std::uint8_t> bytes;
    for (std::size_t i = 0; i < digits.size(); i += 2)
      bytes.push_back(static_cast<std::uint8_t>(std::stoi(digits.substr(i, 2), nullptr, 16)));
    return "'sha256-" + base64(bytes) + "'";
  }();
  return source;
}

std::string escaped(std::string_view text) {
  std::string safe;
  for (const char symbol : text) {
    switch (symbol) {
      case '&':
        safe += "&amp;";
        break;
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '"':
        safe += "&quot;";
        break;
      default:
        safe += symbol;
    }
  }
  return safe;
}

std::string base64(const std::vector<std::uint8_t>& bytes) {
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t three = 0;
    for (std::size_t k = 0; k < 3; ++k) three = (three << 8) | (k < count ? bytes[i + k] : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += k <= count ? digits[(three >> (18 - 6 * k)) & 63] : '=';
  }
  return text;
}

}  // namespace octotomy::planner
