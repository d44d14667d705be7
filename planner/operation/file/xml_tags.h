// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace octotomy::planner {

/// The begin or end tag of an element in an XML text.
struct XmlTag {
  std::string name;  ///< without "svg:"; "foreign" for elements with the prefix of another namespace
  std::map<std::string, std::string> attributes;
  bool begins = true;
  std::size_t line = 1;
};

/// The tags of an XML file in their order; text between them is skipped. Only XML's own five entities are
/// expanded, nothing outside the file is read, and elements nest at most 1000 deep.
class XmlTags {
 public:
  /// Throws std::runtime_error with file, line and reason if the text is not well-formed.
  XmlTags(std::string file, const std::string& text);

  auto begin() const { return tags_.begin(); }
  auto end() const { return tags_.end(); }
  /// Throws std::runtime_error.
  [[noreturn]] void refuse_at(std::size_t line, const std::string& why) const;

 private:
  std::string file_;
  std::vector<XmlTag> tags_;
};

}  // namespace octotomy::planner
