// SPDX-License-Identifier: AGPL-3.0-or-later
// VTK's XML polydata and unstructured grids ("VTK XML file formats", The VTK User's Guide): numbers as text,
// as base64 within their element, or appended at the end, raw or base64; plain or in blocks of zlib or LZ4.
// An array starts with a header: its length or, for blocks, their count, size, last size and compressed
// sizes. The XML is searched for the few relevant elements instead of parsed, because raw appended data are
// not XML.
#include <cmath>
#include <lz4.h>
#include <map>
#include <stdexcept>
#include <zlib.h>

#include "brep/io/base64.h"
#include "brep/io/mesh_scanner.h"
#include "brep/io/vtk_cells.h"
#include "brep/mesh/error.h"

namespace octotomy::brep {
namespace {

/// A tag and the text up to the next tag.
struct XmlElement {
  std::string_view name;
  std::map<std::string_view, std::string_view> attributes;
  std::string_view content;

  std::string_view get(std::string_view key, std::string_view otherwise = "") const {
    const auto found = attributes.find(key);
    return found == attributes.end() ? otherwise : found->second;
  }
};

constexpr std::string_view blanks = " \t\r\n";

XmlElement element_of(std::string_view tag, std::string_view content) {
  XmlElement element;
  element.content = content;
  element.name = tag.substr(0, tag.find_first_of(" \t\r\n/", 1));
  for (std::size_t at = element.name.size(); at < tag.size();) {
    const std::size_t key = tag.find_first_not_of(" \t\r\n/", at), equals = tag.find('=', at);
    if (key == tag.npos || equals == tag.npos || equals < key) break;
    const std::size_t open = tag.find_first_of("\"'", equals);
    const std::size_t close = open == tag.npos ? tag.npos : tag.find(tag[open], open + 1);
    if (close == tag.npos)
      throw Error(ErrorCode::Input, "an attribute of <" + std::string(element.name) + "> does not end");
    element.attributes[tag.substr(key, tag.find_last_not_of(blanks, equals - 1) + 1 - key)] =
        tag.substr(open + 1, close - open - 1);
    at = close + 1;
  }
  return element;
}

/// The number of base64 characters for `bytes` bytes, padding included.
std::size_t base64_length(std::size_t bytes) {
  return (bytes + 2) / 3 * 4;
}

enum class Packing { None, Zlib, Lz4 };

class XmlReader {
 public:
  explicit XmlReader(std::string_view bytes) : bytes_(bytes) {}

  MeshContent run() {
    for (std::size_t at = bytes_.find('<'); at != bytes_.npos;) {
      if (bytes_.substr(at).starts_with("<!--")) {
        at = bytes_.find('<', take_comment(at));
        continue;
      }
      const std::size_t end = bytes_.find('>', at), next = end == bytes_.npos ? end : bytes_.find('<', end);
      if (end == bytes_.npos) throw Error(ErrorCode::Input, "a tag does not end");
      const XmlElement element =
          element_of(bytes_.substr(at + 1, end - at - 1),
                     bytes_.substr(end + 1, next == bytes_.npos ? next : next - end - 1));
      if (element.name == "AppendedData") {
        appended_ = bytes_.substr(end + 1);
        appended_.remove_prefix(std::min(appended_.find('_'), appended_.size() - 1) + 1);
        appended_is_raw_ = element.get("encoding") == "raw";
        break;
      }
      take(element);
      at = next;
    }
    if (!is_polydata_ && !is_grid_)
      throw Error(ErrorCode::Input,
                  "the data set is neither PolyData nor UnstructuredGrid; export a surface");
    for (const XmlElement& field : fields_) take_field(field);
    for (const PieceElement& piece : pieces_) add(piece);
    // Processes the cells of all pieces of a grid at once, because faces between two pieces are not on the
    // surface.
    if (is_grid_) add_grid_surface(grid_, types_, made_);
    return std::move(made_);
  }

 private:
  struct PieceElement {
    XmlElement points;
    std::map<std::string_view, XmlElement> polys, strips, cells;
  };

  /// Searches the comment's text for statements. Returns the end of the comment.
  std::size_t take_comment(std::size_t at) {
    const std::size_t end = bytes_.find("-->", at);
    if (end == bytes_.npos) throw Error(ErrorCode::Input, "a comment does not end");
    const std::string_view text = bytes_.substr(at + 4, end - at - 4);
    made_.says.read_text(text, "a comment");
    made_.says.add_writer(text);
    return end;
  }

  void take_file(const XmlElement& element) {
    is_polydata_ = element.get("type") == "PolyData";
    is_grid_ = element.get("type") == "UnstructuredGrid";
    order_ =
        element.get("byte_order", "LittleEndian") == "BigEndian" ? std::endian::big : std::endian::little;
    wide_header_ = element.get("header_type", "UInt32") == "UInt64";
    const std::string_view compressor = element.get("compressor");
    if (compressor == "vtkZLibDataCompressor")
      packing_ = Packing::Zlib;
    else if (compressor == "vtkLZ4DataCompressor")
      packing_ = Packing::Lz4;
    else if (!compressor.empty())
      throw Error(ErrorCode::Input, "data compressed by " + std::string(compressor.substr(0, 40)) +
                                        " are not read; write them uncompressed or with zlib or LZ4");
  }

  void take(const XmlElement& element) {
    if (element.name == "VTKFile") take_file(element);
    if (element.name == "Piece") pieces_.emplace_back();
    // Tags that describe an array stand inside it.
    for (const char* passed :
         {"/DataArray", "/Array", "InformationKey", "/InformationKey", "Value", "/Value"})
      if (element.name == passed) return;
    if (element.name != "DataArray" && element.name != "Array") {
      section_ = element.name;
      return;
    }
    if (section_ == "FieldData") fields_.push_back(element);
    if (pieces_.empty()) return;
    if (section_ == "Points") pieces_.back().points = element;
    if (section_ == "Polys") pieces_.back().polys[element.get("Name")] = element;
    if (section_ == "Strips") pieces_.back().strips[element.get("Name")] = element;
    if (section_ == "Cells") pieces_.back().cells[element.get("Name")] = element;
  }

  /// SPACE names the frame. The letters of a string are numbers, as text or as bytes, and 0 ends it.
  void take_field(const XmlElement& field) {
    const std::string name = lower_case(field.get("Name"));
    const bool is_frame = name == "space", is_unit = name == "unit" || name == "units";
    if ((!is_frame && !is_unit) || field.get("type") != "String") return;
    std::string text;
    if (field.get("format", "ascii") == "ascii") {
      for (const long long letter : numbers_of<long long>(field)) text += static_cast<char>(letter);
    } else {
      text = data_of(field);
    }
    text = text.substr(0, std::min<std::size_t>(text.find('\0'), 40));
    if (is_frame)
      made_.says.add_frame(text, "SPACE=" + text + " in the field");
    else
      made_.says.add_unit(text, "unit " + text + " in the field");
  }

  void add(const PieceElement& piece) {
    if (piece.points.name.empty()) return;
    Triangles& triangles = made_.triangles;
    const std::vector<double> numbers = numbers_of<double>(piece.points);
    if (numbers.size() % 3 != 0)
      throw Error(ErrorCode::Input, "points have " + std::to_string(numbers.size()) + " numbers");
    const auto first = static_cast<long long>(triangles.points_mm.size());
    for (std::size_t i = 0; i < numbers.size(); i += 3) {
      if (!std::isfinite(numbers[i]) || !std::isfinite(numbers[i + 1]) || !std::isfinite(numbers[i + 2]))
        throw Error(ErrorCode::Input, "point " + std::to_string(i / 3) + " is not finite");
      triangles.points_mm.emplace_back(numbers[i], numbers[i + 1], numbers[i + 2]);
    }
    if (is_grid_) return add_cells(piece, first);
    PolygonSplitter splitter(triangles, made_.polygons);
    for (const auto& corners : cells_of(piece.polys, first)) splitter.add(corners);
    for (const auto& corners : cells_of(piece.strips, first)) splitter.add_strip(corners);
  }

  void add_cells(const PieceElement& piece, long long first) {
    CellCorners cells = cells_of(piece.cells, first);
    std::move(cells.begin(), cells.end(), std::back_inserter(grid_));
    if (!piece.cells.contains("types")) return;
    const std::vector<long long> types = numbers_of<long long>(piece.cells.at("types"));
    types_.insert(types_.end(), types.begin(), types.end());
  }

  CellCorners cells_of(const std::map<std::string_view, XmlElement>& arrays, long long first) {
    if (!arrays.contains("connectivity") || !arrays.contains("offsets")) return {};
    const std::vector<long long> list = numbers_of<long long>(arrays.at("connectivity"));
    CellCorners cells;
    long long begin = 0;
    for (const long long end : numbers_of<long long>(arrays.at("offsets"))) {
      if (end < begin || end > static_cast<long long>(list.size()))
        throw Error(ErrorCode::Input, "a cell reaches beyond the list of cells");
      cells.emplace_back(list.begin() + begin, list.begin() + end);
      for (long long& corner : cells.back()) {
        if (corner < 0) throw Error(ErrorCode::Input, "a corner is numbered " + std::to_string(corner));
        corner += first;
      }
      begin = end;
    }
    return cells;
  }

  template <typename Number>
  std::vector<Number> numbers_of(const XmlElement& array) const {
    const std::string_view type = array.get("type");
    std::vector<Number> numbers;
    if (array.get("format", "ascii") == "ascii") {
      MeshScanner scanner(array.content);
      for (std::string_view word = scanner.word(); !word.empty(); word = scanner.word()) {
        if constexpr (std::is_floating_point_v<Number>)
          numbers.push_back(number_of(word));
        else
          numbers.push_back(integer_of(word));
      }
      return numbers;
    }
    const std::string data = data_of(array);
    MeshScanner scanner(data);
    const auto read = [&]<typename Stored>(Stored) {
      numbers.reserve(data.size() / sizeof(Stored));
      while (scanner.rest() >= sizeof(Stored))
        numbers.push_back(static_cast<Number>(scanner.binary<Stored>(order_)));
    };
    if (type == "Float32")
      read(float{});
    else if (type == "Float64")
      read(double{});
    else if (type == "Int8")
      read(std::int8_t{});
    else if (type == "UInt8")
      read(std::uint8_t{});
    else if (type == "Int16")
      read(std::int16_t{});
    else if (type == "UInt16")
      read(std::uint16_t{});
    else if (type == "Int32")
      read(std::int32_t{});
    else if (type == "UInt32")
      read(std::uint32_t{});
    else if (type == "Int64")
      read(std::int64_t{});
    else if (type == "UInt64")
      read(std::uint64_t{});
    else
      throw Error(ErrorCode::Input, "numbers of type '" + std::string(type.substr(0, 40)) + "' are not read");
    return numbers;
  }

  std::size_t header_number(std::string_view header, std::size_t index) const {
    MeshScanner scanner(header);
    scanner.skip(index * header_bytes());
    return wide_header_ ? static_cast<std::size_t>(scanner.binary<std::uint64_t>(order_))
                        : scanner.binary<std::uint32_t>(order_);
  }
  std::size_t header_bytes() const { return wide_header_ ? 8 : 4; }

  /// An array's bytes, without its header.
  std::string data_of(const XmlElement& array) const {
    std::string_view source = array.content;
    bool raw = false;
    if (array.get("format") == "appended") {
      const long long offset = integer_of(array.get("offset"));
      if (offset < 0 || static_cast<std::size_t>(offset) >= appended_.size())
        throw Error(ErrorCode::Input, "an array lies beyond the end of the file");
      source = appended_.substr(static_cast<std::size_t>(offset));
      raw = appended_is_raw_;
    } else {
      source.remove_prefix(std::min(source.find_first_not_of(blanks), source.size()));
    }
    // Decodes the first `count` bytes. If the array is stored in blocks, base64 ends after the header and
    // begins anew.
    const auto head = [&](std::size_t count) {
      return raw ? std::string(source.substr(0, count)) : from_base64(source, count);
    };
    if (packing_ == Packing::None) {
      const std::size_t length = header_number(head(header_bytes()), 0);
      const std::size_t most = source.size();
      if (length > most) throw Error(ErrorCode::Input, "the file ends too early");
      const std::string all = head(header_bytes() + length);
      if (all.size() < header_bytes() + length) throw Error(ErrorCode::Input, "the file ends too early");
      return all.substr(header_bytes());
    }
    const std::size_t blocks = header_number(head(header_bytes()), 0);
    if (blocks > source.size()) throw Error(ErrorCode::Input, "the file ends too early");
    const std::size_t header_length = (3 + blocks) * header_bytes();
    const std::string header = head(header_length);
    source.remove_prefix(std::min(source.size(), raw ? header_length : base64_length(header_length)));
    return inflated(header, blocks, raw ? std::string(source) : from_base64(source, source.size()));
  }

  std::string inflated(const std::string& header, std::size_t blocks, const std::string& packed) const {
    const std::size_t size = header_number(header, 1), last = header_number(header, 2);
    std::string bytes;
    std::size_t at = 0;
    for (std::size_t b = 0; b < blocks; ++b) {
      const std::size_t length = header_number(header, 3 + b);
      const std::size_t wanted = b + 1 == blocks && last > 0 ? last : size;
      // One compressed byte holds at most 1032 bytes in zlib and 255 in LZ4.
      if (at > packed.size() || length > packed.size() - at ||
          wanted / (packing_ == Packing::Zlib ? 1032 : 255) > length)
        throw Error(ErrorCode::Input, "a compressed block is longer than the file");
      bytes += unpacked(std::string_view(packed).substr(at, length), wanted);
      at += length;
    }
    return bytes;
  }

  std::string unpacked(std::string_view packed, std::size_t wanted) const {
    std::string block(wanted, '\0');
    bool is_whole = false;
    if (packing_ == Packing::Zlib) {
      uLongf got = wanted;
      is_whole = uncompress(reinterpret_cast<Bytef*>(block.data()), &got,
                            reinterpret_cast<const Bytef*>(packed.data()), packed.size()) == Z_OK &&
                 got == wanted;
    } else if (packed.size() <= LZ4_MAX_INPUT_SIZE && wanted <= LZ4_MAX_INPUT_SIZE) {
      is_whole = LZ4_decompress_safe(packed.data(), block.data(), static_cast<int>(packed.size()),
                                     static_cast<int>(wanted)) == static_cast<int>(wanted);
    }
    if (!is_whole) throw Error(ErrorCode::Input, "a compressed block is damaged");
    return block;
  }

  std::string_view bytes_, appended_, section_;
  bool is_polydata_ = false, is_grid_ = false, wide_header_ = false, appended_is_raw_ = false;
  Packing packing_ = Packing::None;
  std::endian order_ = std::endian::little;
  std::vector<XmlElement> fields_;
  std::vector<PieceElement> pieces_;
  CellCorners grid_;
  std::vector<long long> types_;
  MeshContent made_;
};

}  // namespace

MeshContent read_vtk_xml(std::string_view bytes) {
  return XmlReader(bytes).run();
}

}  // namespace octotomy::brep
