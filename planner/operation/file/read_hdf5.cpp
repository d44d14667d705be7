// SPDX-License-Identifier: AGPL-3.0-or-later
// Names of the structures are those of the HDF5 File Format Specification, version 3.0, whose sections are in
// brackets.
#include "planner/operation/file/read_hdf5.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <set>
#include <stdexcept>
#include <zlib.h>

namespace octotomy::planner {
namespace {

constexpr std::string_view hdf5_signature("\x89HDF\r\n\x1a\n", 8);
constexpr std::uint64_t undefined = ~std::uint64_t{0};
constexpr std::size_t most_messages = 256, most_blocks = 64, longest_text = 4096;
/// At most this number of nodes, symbol tables and chunks are read from a file, because the trees of damaged
/// files may refer to a node repeatedly.
constexpr std::size_t most_nodes = 1024;
constexpr int most_levels = 8;  ///< of a tree; each level has at least two children in a file that needs it

enum MessageType : std::uint32_t {
  space_message = 0x01,
  link_info_message = 0x02,
  type_message = 0x03,
  link_message = 0x06,
  layout_message = 0x08,
  filters_message = 0x0b,
  continuation_message = 0x10,
  symbols_message = 0x11
};
enum Filter : std::uint32_t { deflate_filter = 1, shuffle_filter = 2, checksum_filter = 3 };

[[noreturn]] void refuse_file(const std::string& what) {
  throw std::runtime_error(what);
}

/// Reads little-endian numbers one after the other. Throws where one would end beyond the bytes.
class Cursor {
 public:
  Cursor(std::string_view bytes, const char* what) : bytes_(bytes), what_(what) {}
  std::uint64_t number(std::size_t width) {
    const std::string_view from = take(width);
    std::uint64_t value = 0;
    for (std::size_t i = width; i-- > 0;) value = value << 8 | static_cast<unsigned char>(from[i]);
    return value;
  }
  std::uint64_t byte() { return number(1); }
  std::string_view take(std::uint64_t count) {
    if (count > bytes_.size())
      refuse_file(std::string("its ") + what_ + " is cut short: the file is damaged");
    const std::string_view taken = bytes_.substr(0, count);
    bytes_.remove_prefix(count);
    return taken;
  }
  std::size_t left() const { return bytes_.size(); }

 private:
  std::string_view bytes_;
  const char* what_;
};

std::string until_zero(std::string_view text) {
  return std::string(text.substr(0, std::min(text.find('\0'), text.size())));
}

}  // namespace

/// The facts that the messages in a dataset's header state.
struct Hdf5File::Dataset {
  enum class Kind { Real, FixedText, FarText } kind = Kind::Real;
  std::size_t element_bytes = 0;
  bool is_big_endian = false;
  std::size_t count = 0;  ///< elements
  enum class Layout { Compact, Contiguous, Chunked } layout = Layout::Contiguous;
  std::string_view compact;
  Address at = 0;
  std::uint64_t bytes = 0;
  std::size_t chunk_count = 0;    ///< elements of a chunk
  bool is_one_chunk = false;      ///< for a single chunk: its own address, and its size `bytes` as stored
                                  ///< after the filters
  std::uint64_t filter_mask = 0;  ///< bits of the filters that were not applied to the single chunk
  std::vector<std::uint64_t> filters;

  void take_type(std::string_view bytes_of_type, const std::string& path);
  void take_layout(std::string_view bytes_of_layout, const std::string& path);
};

namespace {

/// [IV.A.2.b] The number of elements of a dataspace.
std::size_t elements_of(std::string_view bytes, const std::string& path) {
  Cursor in(bytes, "dataspace");
  const auto version = in.byte(), rank = in.byte();
  in.byte();
  const auto kind = in.byte();
  if (version != 1 && version != 2)
    refuse_file(path + " has a dataspace of the unknown version " + std::to_string(version));
  if (version == 1) in.take(4);
  if (version == 2 && kind == 2) return 0;
  if (rank > 1)
    refuse_file(path + " has " + std::to_string(rank) +
                " dimensions, but a transform's numbers have one: save a linear transform");
  const std::uint64_t count = rank == 0 ? 1 : in.number(8);
  if (count > Hdf5File::most_numbers)
    refuse_file(path + " has " + std::to_string(count) +
                " values, more than a linear transform has: save a linear transform");
  return count;
}

/// [IV.A.2.l] The ids of the filters, in the order in which the writer applied them.
std::vector<std::uint64_t> filters_of(std::string_view bytes, const std::string& path) {
  Cursor in(bytes, "filter pipeline");
  const auto version = in.byte(), count = in.byte();
  if (version == 1) in.take(6);
  std::vector<std::uint64_t> filters;
  for (std::uint64_t i = 0; i < count; ++i) {
    const auto id = in.number(2);
    if (id != deflate_filter && id != shuffle_filter && id != checksum_filter)
      refuse_file(path + " is compressed by the filter " + std::to_string(id) +
                  ", which cannot be read: save the file uncompressed or with gzip");
    const auto name_bytes = version == 1 ? in.number(2) : 0;
    in.number(2);
    const auto values = in.number(2);
    in.take((name_bytes + 7) / 8 * 8);
    in.take(4 * (values + (version == 1 ? values % 2 : 0)));
    filters.push_back(id);
  }
  return filters;
}

std::string inflated(std::string_view from, std::size_t most) {
  std::string made(most, '\0');
  uLongf size = most;
  if (uncompress(reinterpret_cast<Bytef*>(made.data()), &size, reinterpret_cast<const Bytef*>(from.data()),
                 from.size()) != Z_OK)
    refuse_file("a compressed chunk cannot be decompressed: the file is damaged");
  made.resize(size);
  return made;
}

/// Reverses the shuffle filter, which stores the first bytes of all elements, then all second bytes, and so
/// on.
std::string unshuffled(const std::string& from, std::size_t element_bytes) {
  const std::size_t count = from.size() / element_bytes;
  std::string made = from;
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t k = 0; k < element_bytes; ++k) made[i * element_bytes + k] = from[k * count + i];
  return made;
}

double real_of(std::string_view bytes, bool is_big_endian) {
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i)
    bits = bits << 8 | static_cast<unsigned char>(bytes[is_big_endian ? i : bytes.size() - 1 - i]);
  return bytes.size() == 8 ? std::bit_cast<double>(bits)
                           : std::bit_cast<float>(static_cast<std::uint32_t>(bits));
}

}  // namespace

bool Hdf5File::begins(std::string_view head) {
  return head.starts_with(hdf5_signature);
}

Hdf5File::Hdf5File(std::string_view bytes) : bytes_(bytes) {
  if (!begins(bytes)) refuse_file("is no HDF5 file");
  Cursor in(bytes.substr(hdf5_signature.size()), "superblock");
  const auto version = in.byte();
  if (version > 3) refuse_file("has a superblock of the unknown version " + std::to_string(version));
  if (version < 2) in.take(4);
  if (in.byte() != 8 || in.byte() != 8)
    refuse_file("has addresses that are not 8 bytes wide, which cannot be read");
  in.take(version < 2 ? 9 : 1);
  if (version == 1) in.take(4);
  if (in.number(8) != 0) refuse_file("has a base address other than 0, which cannot be read");
  // Skips the address of the free space (from version 2 on: of the extension), and that of the end of the
  // file. part() uses the number of bytes instead.
  in.take(16);
  if (version < 2) in.take(16);
  root_ = in.number(8);
}

std::string_view Hdf5File::part(Address at, std::uint64_t count, const char* what) const {
  if (at > bytes_.size() || count > bytes_.size() - at)
    refuse_file(std::string("its ") + what + " at byte " + std::to_string(at) +
                " lies beyond its end: the file is damaged or cut short");
  return bytes_.substr(at, count);
}

void Hdf5File::count_node() const {
  if (++nodes_ > most_nodes)
    refuse_file(
        "has more parts than a linear transform, or parts that refer to each other: the file is damaged or "
        "no linear transform");
}

void Hdf5File::take_messages(std::string_view block, bool is_new, bool has_order, std::vector<Message>& found,
                             std::vector<std::pair<Address, std::uint64_t>>& further) const {
  Cursor in(block, "object header");
  const std::size_t head = is_new ? (has_order ? 6 : 4) : 8;
  while (in.left() >= head) {
    Message message;
    message.type = static_cast<std::uint32_t>(in.number(is_new ? 1 : 2));
    const auto size = in.number(2);
    message.is_shared = (in.byte() & 2) != 0;
    in.take(is_new ? (has_order ? 2 : 0) : 3);
    message.bytes = in.take(size);
    if (message.type == continuation_message) {
      Cursor place(message.bytes, "continuation");
      const Address at = place.number(8);
      further.emplace_back(at, place.number(8));
    }
    if (found.size() == most_messages)
      refuse_file("an object header has too many messages: the file is damaged");
    found.push_back(message);
  }
}

std::vector<Hdf5File::Message> Hdf5File::messages(Address header) const {
  std::vector<Message> found;
  std::vector<std::pair<Address, std::uint64_t>> further;
  const bool is_new = part(header, 4, "object header") == "OHDR";
  bool has_order = false;
  if (is_new) {
    Cursor in(bytes_.substr(header + 4), "object header");
    const auto version = in.byte(), flags = in.byte();
    if (version != 2) refuse_file("an object header has the unknown version " + std::to_string(version));
    has_order = (flags & 4) != 0;
    in.take(((flags & 32) != 0 ? 16 : 0) + ((flags & 16) != 0 ? 4 : 0));
    const auto size = in.number(std::size_t{1} << (flags & 3));
    take_messages(in.take(size), true, has_order, found, further);
  } else {
    Cursor in(bytes_.substr(header), "object header");
    if (in.number(2) != 1) refuse_file("an object header has an unknown version");
    in.take(6);
    const auto size = in.number(4);
    in.take(4);
    take_messages(in.take(size), false, false, found, further);
  }
  for (std::size_t i = 0; i < further.size(); ++i) {
    if (i == most_blocks) refuse_file("an object header has too many continuations: the file is damaged");
    const auto [at, size] = further[i];
    std::string_view block = part(at, size, "object header's continuation");
    if (is_new) {
      if (!block.starts_with("OCHK") || block.size() < 8)
        refuse_file("an object header's continuation is damaged");
      block = block.substr(4, block.size() - 8);  // without signature and checksum
    }
    take_messages(block, is_new, has_order, found, further);
  }
  return found;
}

void Hdf5File::take_symbols(Address tree, Address heap, int levels, Members& found) const {
  // [III.A.1] The children of a node are nodes, or at level 0 symbol tables.
  count_node();
  Cursor in(part(tree, 24, "tree of a group"), "tree of a group");
  if (in.take(4) != "TREE" || in.byte() != 0) refuse_file("the tree of a group is damaged");
  const auto level = in.byte(), used = in.number(2);
  if (levels == 0 || level >= static_cast<std::uint64_t>(levels))
    refuse_file("the tree of a group is too deep: the file is damaged");
  Cursor children(part(tree + 24, used * 16, "tree of a group"), "tree of a group");
  Cursor segment(part(heap, 32, "names of a group"), "names of a group");
  if (segment.take(4) != "HEAP") refuse_file("the names of a group are damaged");
  segment.take(4);
  const auto name_bytes = segment.number(8);
  segment.take(8);
  const std::string_view names = part(segment.number(8), name_bytes, "names of a group");
  for (std::uint64_t i = 0; i < used; ++i) {
    children.take(8);
    const Address child = children.number(8);
    if (level > 0) {
      take_symbols(child, heap, static_cast<int>(level), found);
      continue;
    }
    count_node();
    Cursor table(part(child, 8, "symbol table"), "symbol table");  // [III.B]
    if (table.take(4) != "SNOD") refuse_file("a symbol table is damaged");
    table.take(2);
    const auto symbols = table.number(2);
    Cursor entries(part(child + 8, symbols * 40, "symbol table"), "symbol table");
    for (std::uint64_t k = 0; k < symbols; ++k) {
      const auto name = entries.number(8);
      const Address header = entries.number(8);
      entries.take(24);
      if (name >= names.size())
        refuse_file("a member's name lies beyond the group's list of names: the file is damaged");
      if (found.size() == most_members) refuse_file("a group has too many members");
      found.emplace(until_zero(names.substr(name)), header);
    }
  }
}

Hdf5File::Members Hdf5File::members_at(Address header) const {
  Members found;
  for (const Message& message : messages(header)) {
    Cursor in(message.bytes, "group");
    if (message.type == symbols_message) {
      const Address tree = in.number(8);
      take_symbols(tree, in.number(8), most_levels, found);
    } else if (message.type == link_info_message) {
      in.byte();
      if ((in.byte() & 1) != 0) in.take(8);
      if (in.number(8) != undefined)
        refuse_file("a group has more members than fit into its header, and this form cannot be read");
    } else if (message.type == link_message) {
      in.byte();
      const auto flags = in.byte();
      if ((flags & 8) != 0 && in.byte() != 0) continue;  // a soft or external link, which is skipped
      in.take(((flags & 4) != 0 ? 8 : 0) + ((flags & 16) != 0 ? 1 : 0));
      const std::string name(in.take(in.number(std::size_t{1} << (flags & 3))));
      found.emplace(name, in.number(8));
    }
  }
  return found;
}

Hdf5File::Address Hdf5File::find(const std::string& path) const {
  Address at = root_;
  for (std::size_t from = 0; from < path.size();) {
    const std::size_t end = std::min(path.find('/', from), path.size());
    if (end > from) {
      const Members known = members_at(at);
      const auto next = known.find(path.substr(from, end - from));
      if (next == known.end()) return undefined;
      at = next->second;
    }
    from = end + 1;
  }
  return at;
}

std::vector<std::string> Hdf5File::members(const std::string& path) const {
  const Address at = find(path);
  if (at == undefined) refuse_file("has no " + path);
  std::vector<std::string> names;
  for (const auto& [name, header] : members_at(at)) names.push_back(name);
  return names;
}

bool Hdf5File::has(const std::string& path) const {
  return find(path) != undefined;
}

/// [IV.A.2.d]
void Hdf5File::Dataset::take_type(std::string_view bytes_of_type, const std::string& path) {
  Cursor in(bytes_of_type, "type");
  const auto number = in.byte() & 15, bits = in.number(3);
  element_bytes = in.number(4);
  if (number == 1) {
    is_big_endian = (bits & 1) != 0;
    in.number(2);
    const std::uint64_t form = in.number(6);  // precision, then positions and sizes of exponent and mantissa
    const bool is_double = element_bytes == 8 && form == 0x34000b340040;
    const bool is_float = element_bytes == 4 && form == 0x170008170020;
    if ((!is_double && !is_float) || (bits & 0x40) != 0)
      refuse_file(path + " has real numbers that are not IEEE numbers of 4 or 8 bytes");
  } else if (number == 3) {
    kind = Dataset::Kind::FixedText;
    if (element_bytes == 0 || element_bytes > longest_text)
      refuse_file(path + " is a text of " + std::to_string(element_bytes) + " bytes");
  } else if (number == 9 && (bits & 15) == 1) {
    kind = Dataset::Kind::FarText;
    if (element_bytes != 16) refuse_file(path + " is a text with an address that is not stored in 16 bytes");
  } else {
    refuse_file(path + " contains neither real numbers nor a text");
  }
}

/// [IV.A.2.i]
void Hdf5File::Dataset::take_layout(std::string_view bytes_of_layout, const std::string& path) {
  Cursor in(bytes_of_layout, "layout");
  const auto version = in.byte(), form = in.byte();
  if (version != 3 && version != 4) refuse_file(path + " has a layout of version " + std::to_string(version));
  if (form > 2) refuse_file(path + " has an unknown layout");
  layout = static_cast<Layout>(form);
  if (form == 0) compact = in.take(in.number(2));
  if (form == 1) {
    at = in.number(8);
    bytes = in.number(8);
  }
  if (form == 2) {
    const auto flags = version == 4 ? in.byte() : 0, rank = in.byte();
    if (rank != 2) refuse_file(path + " has chunks of " + std::to_string(rank - 1) + " dimensions");
    if (version == 3) at = in.number(8);
    const std::size_t width = version == 4 ? in.byte() : 4;
    if (width < 1 || width > 8) refuse_file(path + " has a damaged layout");
    chunk_count = in.number(width);
    in.number(width);
    if (version == 4) {
      if (in.byte() != 1)
        refuse_file(
            path + " is split into several chunks in a form that cannot be read: save the file uncompressed");
      is_one_chunk = true;
      if ((flags & 2) != 0) {
        bytes = in.number(8);
        filter_mask = in.number(4);
      }
      at = in.number(8);
    }
  }
}

Hdf5File::Dataset Hdf5File::dataset(const std::string& path) const {
  const Address at = find(path);
  if (at == undefined) refuse_file("has no " + path);
  Dataset made;
  std::set<std::uint32_t> seen;
  for (const Message& message : messages(at)) {
    if (message.type != space_message && message.type != type_message && message.type != layout_message &&
        message.type != filters_message)
      continue;
    if (message.is_shared)
      refuse_file(path + " shares its description with another value, and this form cannot be read");
    seen.insert(message.type);
    if (message.type == space_message) made.count = elements_of(message.bytes, path);
    if (message.type == filters_message) made.filters = filters_of(message.bytes, path);
    if (message.type == type_message) made.take_type(message.bytes, path);
    if (message.type == layout_message) made.take_layout(message.bytes, path);
  }
  for (const std::uint32_t needed : {space_message, type_message, layout_message})
    if (!seen.contains(needed)) refuse_file(path + " is not a row of values, or the file is damaged");
  if (made.layout == Dataset::Layout::Chunked && (made.chunk_count == 0 || made.chunk_count > most_numbers))
    refuse_file(path + " has chunks of " + std::to_string(made.chunk_count) + " values");
  return made;
}

namespace {

/// The bytes of a chunk as they were before the writer's filters. The last filter applied is reversed first.
std::string unfiltered(std::string_view stored, std::uint64_t mask, const std::vector<std::uint64_t>& filters,
                       std::size_t element_bytes, std::size_t chunk_bytes) {
  std::string bytes(stored);
  for (std::size_t i = filters.size(); i-- > 0;) {
    if (i < 32 && (mask >> i & 1) != 0) continue;
    if (filters[i] == deflate_filter) bytes = inflated(bytes, chunk_bytes + 4);
    if (filters[i] == shuffle_filter) bytes = unshuffled(bytes, element_bytes);
    if (filters[i] == checksum_filter) {
      if (bytes.size() < 4) refuse_file("a chunk is shorter than its checksum: the file is damaged");
      bytes.resize(bytes.size() - 4);
    }
  }
  if (bytes.size() != chunk_bytes)
    refuse_file("a chunk has " + std::to_string(bytes.size()) + " bytes instead of " +
                std::to_string(chunk_bytes));
  return bytes;
}

}  // namespace

void Hdf5File::take_chunks(Address tree, int levels, const Dataset& from, std::string& into) const {
  constexpr std::uint64_t key_bytes = 24;  // size, filter mask, and two offsets
  count_node();
  Cursor in(part(tree, 24, "tree of chunks"), "tree of chunks");
  if (in.take(4) != "TREE" || in.byte() != 1) refuse_file("the tree of chunks is damaged");
  const auto level = in.byte(), used = in.number(2);
  if (levels == 0 || level >= static_cast<std::uint64_t>(levels))
    refuse_file("the tree of chunks is too deep: the file is damaged");
  Cursor children(part(tree + 24, used * (key_bytes + 8), "tree of chunks"), "tree of chunks");
  const std::size_t chunk_bytes = from.chunk_count * from.element_bytes;
  for (std::uint64_t i = 0; i < used; ++i) {
    const auto size = children.number(4), mask = children.number(4), first = children.number(8);
    children.number(8);
    const Address child = children.number(8);
    if (level > 0) {
      take_chunks(child, static_cast<int>(level), from, into);
      continue;
    }
    if (first >= from.count) continue;
    count_node();
    const std::string bytes =
        unfiltered(part(child, size, "chunk"), mask, from.filters, from.element_bytes, chunk_bytes);
    const std::size_t at = first * from.element_bytes;
    into.replace(at, std::min(chunk_bytes, into.size() - at), bytes, 0,
                 std::min(chunk_bytes, into.size() - at));
  }
}

std::string Hdf5File::stored(const Dataset& from, const std::string& path) const {
  const std::size_t needed = from.count * from.element_bytes;
  if (needed == 0) return "";
  if (from.layout == Dataset::Layout::Chunked) {
    if (from.at == undefined) refuse_file(path + " was never written");
    std::string made(needed, '\0');
    if (!from.is_one_chunk) {
      take_chunks(from.at, most_levels, from, made);
      return made;
    }
    const std::size_t chunk_bytes = from.chunk_count * from.element_bytes;
    const std::string chunk = unfiltered(part(from.at, from.bytes == 0 ? chunk_bytes : from.bytes, "chunk"),
                                         from.filter_mask, from.filters, from.element_bytes, chunk_bytes);
    if (chunk.size() < needed)
      refuse_file(path + " has fewer values than its header states: the file is damaged");
    return chunk.substr(0, needed);
  }
  if (from.layout == Dataset::Layout::Contiguous && from.at == undefined)
    refuse_file(path + " was never written");
  const std::string_view bytes =
      from.layout == Dataset::Layout::Compact ? from.compact : part(from.at, from.bytes, "row of values");
  if (bytes.size() < needed)
    refuse_file(path + " has fewer values than its header states: the file is damaged");
  return std::string(bytes.substr(0, needed));
}

std::string Hdf5File::referred_text(std::string_view reference) const {
  // [III.E] Finds a text in a collection of texts by its number.
  Cursor in(reference, "text");
  const auto length = in.number(4);
  const Address at = in.number(8);
  const auto wanted = in.number(4);
  if (length > longest_text) refuse_file("holds a text of " + std::to_string(length) + " bytes");
  Cursor head(part(at, 16, "texts"), "texts");
  if (head.take(4) != "GCOL") refuse_file("the collection of its texts is damaged");
  head.take(4);
  const auto size = head.number(8);
  if (size < 16) refuse_file("the collection of its texts is damaged");
  Cursor objects(part(at, size, "texts").substr(16), "texts");
  while (objects.left() >= 16) {
    const auto number = objects.number(2);
    objects.take(6);
    const auto bytes = objects.number(8);
    if (number == 0) break;
    const std::string_view value = objects.take(bytes);
    if (number == wanted) return std::string(value.substr(0, std::min<std::uint64_t>(length, value.size())));
    objects.take(std::min<std::uint64_t>((8 - bytes % 8) % 8, objects.left()));
  }
  refuse_file("a text is missing: the file is damaged");
}

std::string Hdf5File::text(const std::string& path) const {
  const Dataset from = dataset(path);
  if (from.kind == Dataset::Kind::Real) refuse_file(path + " contains numbers instead of a text");
  if (from.count == 0) return "";
  const std::string first = stored(from, path).substr(0, from.element_bytes);
  std::string found = until_zero(from.kind == Dataset::Kind::FarText ? referred_text(first) : first);
  while (!found.empty() && found.back() == ' ') found.pop_back();
  return found;
}

std::vector<double> Hdf5File::numbers(const std::string& path) const {
  const Dataset from = dataset(path);
  if (from.kind != Dataset::Kind::Real) refuse_file(path + " contains a text instead of numbers");
  const std::string bytes = stored(from, path);
  std::vector<double> made(from.count);
  for (std::size_t i = 0; i < made.size(); ++i) {
    made[i] = real_of(std::string_view(bytes).substr(i * from.element_bytes, from.element_bytes),
                      from.is_big_endian);
    if (!std::isfinite(made[i])) refuse_file(path + " contains a number that is not finite");
  }
  return made;
}

}  // namespace octotomy::planner
