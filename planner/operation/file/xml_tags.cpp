// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/file/xml_tags.h"

#include <algorithm>
#include <exception>
#include <expat.h>
#include <memory>
#include <new>
#include <string_view>
#include <type_traits>
#include <utility>

#include "planner/operation/table/json_file.h"

namespace octotomy::planner {
namespace {

/// Elements may be nested this deep; drawings have about ten levels.
constexpr std::size_t most_nested = 1000;

/// Replaces '&' by "&amp;" unless an entity of XML or a character's number begins there. References to
/// entities that a file declares thus remain as text.
std::string without_entities(std::string_view text) {
  std::string made;
  for (std::size_t i = 0; i < text.size(); ++i) {
    made += text[i];
    if (text[i] != '&') continue;
    const std::string_view rest = text.substr(i + 1, 5);
    const auto is = [&](std::string_view known) { return rest.starts_with(known); };
    if (!is("#") && !is("lt;") && !is("gt;") && !is("amp;") && !is("quot;") && !is("apos;")) made += "amp;";
  }
  return made;
}

std::string local_name(std::string_view name) {
  if (name.starts_with("svg:")) name.remove_prefix(4);
  return std::string(name.find(':') == std::string_view::npos ? name : "foreign");
}

/// The state of a parse, which the parser's callbacks change. Callbacks must not throw, because the parser is
/// C code.
struct Reading {
  XML_Parser parser = nullptr;
  std::vector<XmlTag> tags;
  std::size_t depth = 0;
  std::exception_ptr thrown;

  template <typename Add>
  void add(const Add& add_tag) {
    try {
      tags.emplace_back();
      tags.back().line = XML_GetCurrentLineNumber(parser);
      add_tag(tags.back());
    } catch (...) {
      thrown = std::current_exception();
      XML_StopParser(parser, XML_FALSE);
    }
  }
};

void begun(void* reading, const XML_Char* name, const XML_Char** attributes) {
  auto& to = *static_cast<Reading*>(reading);
  to.add([&](XmlTag& tag) {
    tag.name = local_name(name);
    for (; *attributes != nullptr; attributes += 2) tag.attributes[attributes[0]] = attributes[1];
    if (++to.depth > most_nested) XML_StopParser(to.parser, XML_FALSE);
  });
}

void ended(void* reading, const XML_Char* name) {
  auto& to = *static_cast<Reading*>(reading);
  to.add([&](XmlTag& tag) {
    tag.name = local_name(name);
    tag.begins = false;
    --to.depth;
  });
}

/// The reason for a parser's error; `rest` is the text from the faulty place on.
std::string reason(XML_Error error, std::string_view rest) {
  const auto name_at = [&](std::size_t from) {
    return std::string(rest.substr(from, rest.find_first_of(" />", from) - from));
  };
  switch (error) {
    case XML_ERROR_TAG_MISMATCH:
      return "</" + name_at(rest.starts_with("</") ? 2 : 0) +
             "> closes another element than the one that is open there";
    case XML_ERROR_UNCLOSED_TOKEN:
      return std::string("the markup that begins here is not closed by ") + (rest.starts_with("<!--") ? "-->"
                                                                             : rest.starts_with("<![CDATA[")
                                                                                 ? "]]>"
                                                                             : rest.starts_with("<?") ? "?>"
                                                                                                      : ">");
    case XML_ERROR_NO_ELEMENTS:
      return "is not an SVG file: it has no closed element";
    case XML_ERROR_INVALID_TOKEN:
      return "is not XML here: no element follows a '<', or an attribute is not NAME=\"VALUE\"";
    case XML_ERROR_ABORTED:
      return "elements are nested more than " + std::to_string(most_nested) + " deep";
    default:
      return std::string("is no XML here: ") + XML_ErrorString(error);
  }
}

}  // namespace

XmlTags::XmlTags(std::string file, const std::string& text) : file_(std::move(file)) {
  const std::string plain = without_entities(text);
  const std::unique_ptr<std::remove_pointer_t<XML_Parser>, decltype(&XML_ParserFree)> parser(
      XML_ParserCreate(nullptr), &XML_ParserFree);
  if (!parser) throw std::bad_alloc();
  Reading reading;
  reading.parser = parser.get();
  XML_SetUserData(parser.get(), &reading);
  XML_SetElementHandler(parser.get(), begun, ended);
  // Without a handler for external entities, the parser reads no other file. It also reads no parameter
  // entities by default.
  const XML_Status status = XML_Parse(parser.get(), plain.data(), static_cast<int>(plain.size()), XML_TRUE);
  if (reading.thrown) std::rethrow_exception(reading.thrown);
  if (status != XML_STATUS_OK) {
    const auto at =
        std::clamp<XML_Index>(XML_GetCurrentByteIndex(parser.get()), 0, static_cast<XML_Index>(plain.size()));
    refuse_at(
        XML_GetCurrentLineNumber(parser.get()),
        reason(XML_GetErrorCode(parser.get()), std::string_view(plain).substr(static_cast<std::size_t>(at))));
  }
  tags_ = std::move(reading.tags);
}

void XmlTags::refuse_at(std::size_t line, const std::string& why) const {
  refuse(file_ + ", line " + std::to_string(line), why);
}

}  // namespace octotomy::planner
