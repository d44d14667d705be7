// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Reads a surface that is encapsulated in DICOM (PS3.3, A.85): finds the document, its media type and its unit
// among the file's top attributes, little-endian with explicit or implicit VR, and skips everything else.
// Every length is compared with the rest of the file before it is used; nothing but the document's triangles
// is allocated.
#include "brep/io/dicom_model.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <map>
#include <string>

#include "brep/io/mesh_scanner.h"
#include "brep/mesh/error.h"

namespace octotomy::brep {
namespace {

constexpr std::string_view stl_storage = "1.2.840.10008.5.1.4.1.1.104.3";
constexpr std::string_view obj_storage = "1.2.840.10008.5.1.4.1.1.104.4";
constexpr std::uint32_t open_length = 0xffffffff;
/// Sequences nested deeper than this mean that the file is damaged.
constexpr int most_depth = 16;

/// A value without surrounding blanks and zero bytes.
std::string_view trimmed(std::string_view value) {
  const std::string_view blank(" \0", 2);
  const std::size_t first = value.find_first_not_of(blank);
  if (first == std::string_view::npos) return {};
  return value.substr(first, value.find_last_not_of(blank) - first + 1);
}

/// The values of the attributes of one level, by tag. The value of a sequence is the bytes of its items.
using Values = std::map<std::uint32_t, std::string_view>;

class AttributeWalk {
 public:
  AttributeWalk(std::string_view bytes, bool is_explicit) : scanner_(bytes), is_explicit_(is_explicit) {}

  Values values() {
    Values found;
    while (scanner_.rest() >= 8) {
      const std::uint32_t tag = take_tag();
      const std::uint32_t length = take_length(tag);
      if (length == open_length) {
        const std::string_view whole = scanner_.bytes(0);
        const std::size_t before = scanner_.rest();
        pass_open(0);
        found[tag] = {whole.data(), before - scanner_.rest()};
        continue;
      }
      if (length > scanner_.rest())
        throw Error(ErrorCode::Input,
                    "an attribute reaches beyond the end of the DICOM file: the file is cut short or "
                    "damaged; copy it again");
      found[tag] = scanner_.bytes(length);
    }
    return found;
  }

 private:
  std::uint32_t take_tag() {
    const std::uint32_t group = scanner_.binary<std::uint16_t>(std::endian::little);
    return group << 16 | scanner_.binary<std::uint16_t>(std::endian::little);
  }

  std::uint32_t take_length(std::uint32_t tag) {
    if (!is_explicit_ || tag >> 16 == 0xfffe) return scanner_.binary<std::uint32_t>(std::endian::little);
    const std::string_view vr = scanner_.bytes(2);
    constexpr std::array<std::string_view, 12> wide{"OB", "OD", "OF", "OL", "OV", "OW",
                                                    "SQ", "UC", "UN", "UR", "UT", "SV"};
    if (std::find(wide.begin(), wide.end(), vr) == wide.end() && vr != "UV")
      return scanner_.binary<std::uint16_t>(std::endian::little);
    scanner_.skip(2);
    return scanner_.binary<std::uint32_t>(std::endian::little);
  }

  /// Skips the items of a sequence of undefined length, up to its end mark.
  void pass_open(int depth) {
    constexpr std::uint32_t item = 0xfffee000, item_end = 0xfffee00d, sequence_end = 0xfffee0dd;
    if (depth > most_depth)
      throw Error(ErrorCode::Input, "sequences of the DICOM file lie more than 16 deep: it is damaged");
    for (;;) {
      const std::uint32_t tag = take_tag();
      const std::uint32_t length = take_length(tag);
      if (tag == sequence_end || tag == item_end) return;
      if (length == open_length)
        pass_open(tag == item ? depth : depth + 1);
      else
        scanner_.skip(length);
    }
  }

  MeshScanner scanner_;
  bool is_explicit_;
};

struct Syntax {
  std::string_view rest;  ///< the attributes after the file meta information
  bool is_explicit = true;
};

/// Skips the preamble and the meta information, which is always explicit.
Syntax syntax_of(std::string_view bytes) {
  constexpr std::size_t meta_at = 132;
  MeshScanner scanner(bytes.substr(meta_at));
  scanner.skip(8);
  const auto length = scanner.binary<std::uint32_t>(std::endian::little);
  if (length > scanner.rest())
    throw Error(ErrorCode::Input, "the DICOM file ends within its header: it is cut short; copy it again");
  const Values meta = AttributeWalk(scanner.bytes(length), true).values();
  const auto found = meta.find(0x00020010);
  const std::string_view syntax = found == meta.end() ? "" : trimmed(found->second);
  if (syntax != "1.2.840.10008.1.2" && syntax != "1.2.840.10008.1.2.1")
    throw Error(ErrorCode::Input, "is DICOM in the transfer syntax '" + std::string(syntax.substr(0, 64)) +
                                      "', which is not read for models: convert it to explicit VR, "
                                      "little-endian (dcmconv +te)");
  return {scanner.bytes(scanner.rest()), syntax == "1.2.840.10008.1.2.1"};
}

/// The unit that a UCUM code means, as a word for length_unit(); empty if it is not a unit of length.
std::string word_of_unit(std::string_view code) {
  constexpr std::array<std::string_view, 6> metric{"nm", "um", "mm", "cm", "dm", "m"};
  if (std::find(metric.begin(), metric.end(), code) != metric.end()) return std::string(code);
  if (code == "[in_i]" || code == "[in_us]") return "inch";
  return code == "[ft_i]" ? "foot" : "";
}

/// The first item's code value of a code sequence.
std::string_view unit_code(std::string_view items, bool is_explicit) {
  if (items.size() < 8) return {};
  MeshScanner scanner(items);
  scanner.skip(4);
  const auto length = scanner.binary<std::uint32_t>(std::endian::little);
  const std::string_view inside = length == open_length
                                      ? scanner.bytes(scanner.rest())
                                      : scanner.bytes(std::min<std::size_t>(length, scanner.rest()));
  const Values code = AttributeWalk(inside, is_explicit).values();
  const auto value = code.find(0x00080100);
  return value == code.end() ? std::string_view() : trimmed(value->second);
}

}  // namespace

bool is_dicom_model(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return false;
  // The storage class is in the meta information, at the beginning of the file.
  std::string head(1024, '\0');
  std::ifstream in(path, std::ios::binary);
  in.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(in.gcount()));
  if (head.size() < 132 || head.compare(128, 4, "DICM") != 0) return false;
  return head.find(stl_storage) != std::string::npos || head.find(obj_storage) != std::string::npos;
}

MeshContent read_dicom_model(std::string_view bytes) {
  const Syntax syntax = syntax_of(bytes);
  const Values values = AttributeWalk(syntax.rest, syntax.is_explicit).values();
  const auto text = [&](std::uint32_t tag) {
    const auto found = values.find(tag);
    return found == values.end() ? std::string_view() : trimmed(found->second);
  };
  const auto document = values.find(0x00420011);
  if (document == values.end())
    throw Error(ErrorCode::Input, "the DICOM file holds no encapsulated document");
  std::string_view inside = document->second;
  if (const auto length = values.find(0x00420015); length != values.end() && length->second.size() == 4) {
    const auto stated = MeshScanner(length->second).binary<std::uint32_t>(std::endian::little);
    if (stated > inside.size())
      throw Error(ErrorCode::Input, "the encapsulated document has " + std::to_string(inside.size()) +
                                        " bytes, and the DICOM file states " + std::to_string(stated) +
                                        ": it is cut short; copy it again");
    inside = inside.substr(0, stated);
  }
  const std::string type = lower_case(text(0x00420012));
  const bool is_stl = type == "model/stl" || type == "application/sla";
  if (!is_stl && type != "model/obj")
    throw Error(ErrorCode::Input, "the encapsulated document is of the type '" + type.substr(0, 64) +
                                      "': only model/stl and model/obj are read");
  MeshContent made = is_stl ? read_stl(inside) : read_obj(inside);
  const auto units = values.find(0x004008ea);
  const std::string code(units == values.end() ? "" : unit_code(units->second, syntax.is_explicit));
  if (const std::string unit = word_of_unit(code); !unit.empty())
    made.says.add_unit(unit, "the measurement unit '" + code + "' of the DICOM header");
  else
    made.says.warn(
        "unit",
        code.empty()
            ? "the DICOM header states no measurement unit, which is required: export the model with its unit"
            : "the measurement unit '" + code.substr(0, 16) +
                  "' of the DICOM header is not a unit of length");
  if (!text(0x00200052).empty()) made.says.add_frame("LPS", "DICOM's frame of reference");
  made.says.tell("file", std::string(is_stl ? "STL" : "OBJ") + " in DICOM, of the patient '" +
                             std::string(text(0x00100020).substr(0, 64)) + "', frame of reference '" +
                             std::string(text(0x00200052).substr(0, 64)) + "'");
  return made;
}

}  // namespace octotomy::brep
