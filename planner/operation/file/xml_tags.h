// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace octotomy::planner {

/// The begin or end tag of an element in an XML file.
struct XmlTag {
  std::string name;  ///< without "svg:"; "foreign" for elements with the prefix of another namespace
  std::map<std::string, std::string> attributes;
  bool begins = true;
  std::size_t line = 1;
};

/// The tags of an XML file in their order, without the text between them. Only XML's five entities are
/// expanded, no other file is read, and elements may be nested at most 1000 deep.
class XmlTags {
 public:
  /// Parses `text`. Throws std::runtime_error that names `file`, the line and the reason if the text is not
  /// well-formed.
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
