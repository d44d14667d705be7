// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <string_view>
#include <vector>

// JSON files written by users. All functions throw std::runtime_error whose message begins with `where`: the
// file, then the position in it.
namespace octotomy::planner {

/// If `where` is empty, the message contains `what` alone.
[[noreturn]] void refuse(const std::string& where, const std::string& what);

/// A value's type for error messages: "a number", "a JSON array".
std::string type_of(const nlohmann::json& value);

/// The largest depth of JSON. Copying and writing recurse once a level, so deeper JSON could exhaust the
/// stack.
inline constexpr int most_json_levels = 512;
/// The depth of brackets outside of strings, computed without parsing. Linear.
int json_levels(std::string_view text);
/// Throws if a text is deeper than most_json_levels.
void need_shallow_json(std::string_view text);

/// A parser's message without the bytes that it read last: they may belong to a file that holds a secret.
/// Line and column stay.
std::string without_last_read(std::string message);

/// Refuses a key that occurs twice in one object; a parser alone would silently use the last one. Call it for
/// each event of a parser, in order.
class OneOfEachKey {
 public:
  void begin() { open_.emplace_back(); }
  void end() { open_.pop_back(); }
  /// Throws std::runtime_error.
  void add(const std::string& key);

 private:
  std::vector<std::set<std::string>> open_;
};

/// Throws std::runtime_error if a text is not JSON, too deep, or has a key twice in one object. The message
/// quotes nothing of the text but that key.
template <typename AnyJson = nlohmann::json>
AnyJson parse_json(std::string_view text) {
  need_shallow_json(text);
  OneOfEachKey keys;
  const auto watch = [&keys](int, typename AnyJson::parse_event_t event, AnyJson& parsed) {
    if (event == AnyJson::parse_event_t::object_start) keys.begin();
    if (event == AnyJson::parse_event_t::object_end) keys.end();
    if (event == AnyJson::parse_event_t::key) keys.add(parsed.template get<std::string>());
    return true;
  };
  try {
    return AnyJson::parse(text, watch);
  } catch (const typename AnyJson::exception& error) {
    refuse("", std::string("is no JSON: ") + without_last_read(error.what()));
  }
}

nlohmann::json read_json(const std::filesystem::path& path);

/// JSON as text. Bytes that are not valid UTF-8, as in file names, become U+FFFD. An indent of -1 writes one
/// line.
template <typename AnyJson>
std::string json_text(const AnyJson& json, int indent = -1) {
  return json.dump(indent, ' ', false, AnyJson::error_handler_t::replace);
}

/// Writes to a temporary file and renames it into place.
void write_json(const nlohmann::ordered_json& json, const std::filesystem::path& path);

/// Throws for an unknown key, with the nearest known one.
void check_keys(const nlohmann::json& object, const std::string& where,
                const std::vector<std::string>& known);

/// The value of a required key; throws if it is absent.
const nlohmann::json& need(const nlohmann::json& object, const std::string& key, const std::string& where);

double number_of(const nlohmann::json& value, const std::string& where);      ///< finite
std::size_t count_of(const nlohmann::json& value, const std::string& where);  ///< an integer from 0
std::string word_of(const nlohmann::json& value, const std::string& where);
glm::dvec2 point_of(const nlohmann::json& value, const std::string& where);  ///< [u, v]

}  // namespace octotomy::planner
