// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Two stacks put operators and names into postfix order (Dijkstra's shunting yard).
#include "verify/witness/postfix.h"

#include <cctype>
#include <stdexcept>

#include "voxel/space/error.h"

namespace octotomy::verify {

std::vector<std::string> postfix(std::string_view text) {
  const auto refuse = [&](std::size_t at, const char* wanted) {
    throw voxel::InvalidInput("expression, position " + std::to_string(at + 1) + ": " + wanted + " expected");
  };
  const auto strength = [](char symbol) { return std::string_view("|^&-~").find(symbol); };
  std::vector<std::string> out;
  std::vector<char> waiting;
  bool wants_operand = true;
  for (std::size_t at = 0; at < text.size();) {
    const char c = text[at];
    if (std::isspace(static_cast<unsigned char>(c))) {
      ++at;
    } else if (std::isalnum(static_cast<unsigned char>(c)) || c == '_') {
      if (!wants_operand) refuse(at, "an operator");
      const std::size_t first = at;
      while (at < text.size() && (std::isalnum(static_cast<unsigned char>(text[at])) || text[at] == '_'))
        ++at;
      out.emplace_back(text.substr(first, at - first));
      wants_operand = false;
    } else if (c == '(' || c == '~') {
      if (!wants_operand) refuse(at, "an operator");
      waiting.push_back(c);
      ++at;
    } else if (c == ')' || strength(c) != std::string_view::npos) {
      if (wants_operand) refuse(at, "a name");
      while (!waiting.empty() && waiting.back() != '(' &&
             (c == ')' || strength(waiting.back()) >= strength(c))) {
        out.emplace_back(1, waiting.back());
        waiting.pop_back();
      }
      if (c == ')') {
        if (waiting.empty()) refuse(at, "an operator");
        waiting.pop_back();
      } else {
        waiting.push_back(c);
        wants_operand = true;
      }
      ++at;
    } else {
      refuse(at, "a name or an operator");
    }
  }
  if (wants_operand) refuse(text.size(), "a name");
  for (; !waiting.empty(); waiting.pop_back()) {
    if (waiting.back() == '(') refuse(text.size(), "')'");
    out.emplace_back(1, waiting.back());
  }
  return out;
}

}  // namespace octotomy::verify
