// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <string_view>
#include <vector>

// Reads and writes JSON files of users. All functions throw std::runtime_error whose message begins with
// `where`: the file, then the position in the file.
namespace octotomy::planner {

/// Throws std::runtime_error "WHERE: WHAT". If `where` is empty, the message is `what` alone.
[[noreturn]] void refuse(const std::string& where, const std::string& what);

/// The type of a JSON value for error messages, such as "a number" or "a JSON array".
std::string type_of(const nlohmann::json& value);

/// The largest allowed depth of JSON. Copying and writing need one recursion for each level, so deeper JSON
/// could exhaust the stack.
inline constexpr int most_json_levels = 512;
/// The depth of brackets outside of strings, computed without parsing. Cost: linear.
int json_levels(std::string_view text);
/// Throws if a text is nested deeper than most_json_levels.
void need_shallow_json(std::string_view text);

/// A parser's message without the bytes that it read last, because they may belong to a file with a secret.
/// Line and column remain.
std::string without_last_read(std::string message);

/// Refuses a key that occurs twice in one object, of which a parser would silently use the last. Its
/// functions must be called for each event of a parser, in order.
class OneOfEachKey {
 public:
  void begin() { open_.emplace_back(); }
  void end() { open_.pop_back(); }
  /// Throws std::runtime_error.
  void add(const std::string& key);

 private:
  std::vector<std::set<std::string>> open_;
};

/// Parses a text. Throws std::runtime_error if it is not JSON, is nested too deep, or has a key twice in one
/// object. The message quotes nothing of the text except that key.
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

/// JSON as text. Bytes that are not valid UTF-8, for example in file names, become U+FFFD. An indent of -1
/// writes a single line.
template <typename AnyJson>
std::string json_text(const AnyJson& json, int indent = -1) {
  return json.dump(indent, ' ', false, AnyJson::error_handler_t::replace);
}

/// Writes a JSON file: first to a temporary file, which then replaces `path`.
void write_json(const nlohmann::ordered_json& json, const std::filesystem::path& path);

/// Throws if the object has a key that is not in `known`; the message suggests the nearest known one.
void check_keys(const nlohmann::json& object, const std::string& where,
                const std::vector<std::string>& known);

/// The value of a required key. Throws if the key is missing.
const nlohmann::json& need(const nlohmann::json& object, const std::string& key, const std::string& where);

double number_of(const nlohmann::json& value, const std::string& where);      ///< finite
std::size_t count_of(const nlohmann::json& value, const std::string& where);  ///< an integer from 0
std::string word_of(const nlohmann::json& value, const std::string& where);
glm::dvec2 point_of(const nlohmann::json& value, const std::string& where);  ///< [u, v]

}  // namespace octotomy::planner
