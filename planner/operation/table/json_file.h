// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

// Files of JSON that people write. All throw std::runtime_error that begins with `where`: the file, then the
// place in it.
namespace octotomy::planner {

/// If `where` is empty, the message contains `what` alone.
[[noreturn]] void refuse(const std::string& where, const std::string& what);

/// For a refusal: "a number", "a JSON array".
std::string type_of(const nlohmann::json& value);

/// The largest depth of JSON. Copying and writing recurse once a level, so deeper JSON could exhaust the
/// stack.
inline constexpr int most_json_levels = 512;
/// The depth of brackets outside of strings, computed without parsing. Linear.
int json_levels(std::string_view text);
/// Throws if a text is deeper than most_json_levels.
void need_shallow_json(std::string_view text);

/// A parser's message without the bytes that it read last: they may be those of a file that holds a secret.
/// Line and column stay.
std::string without_last_read(std::string message);

/// Throws std::runtime_error if a text is not JSON or too deep. The message quotes nothing of the text.
template <typename AnyJson = nlohmann::json>
AnyJson parse_json(std::string_view text) {
  need_shallow_json(text);
  try {
    return AnyJson::parse(text);
  } catch (const typename AnyJson::exception& error) {
    refuse("", std::string("is no JSON: ") + without_last_read(error.what()));
  }
}

nlohmann::json read_json(const std::filesystem::path& path);

/// JSON as text. Bytes that are no UTF-8, as in names of files, become U+FFFD. An indent of -1: on one line.
template <typename AnyJson>
std::string json_text(const AnyJson& json, int indent = -1) {
  return json.dump(indent, ' ', false, AnyJson::error_handler_t::replace);
}

/// Written beside and renamed into place.
void write_json(const nlohmann::ordered_json& json, const std::filesystem::path& path);

/// Throws for an unknown key, with the nearest known one.
void check_keys(const nlohmann::json& object, const std::string& where,
                const std::vector<std::string>& known);

/// The value of a key that must be there.
const nlohmann::json& need(const nlohmann::json& object, const std::string& key, const std::string& where);

double number_of(const nlohmann::json& value, const std::string& where);      ///< finite
std::size_t count_of(const nlohmann::json& value, const std::string& where);  ///< whole, from 0
std::string word_of(const nlohmann::json& value, const std::string& where);
glm::dvec2 point_of(const nlohmann::json& value, const std::string& where);  ///< [u, v]

}  // namespace octotomy::planner
