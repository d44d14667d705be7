// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/io/zip_archive.h"

#include <algorithm>
#include <cctype>
#include <zlib.h>

#include "brep/io/mesh_scanner.h"
#include "brep/mesh/error.h"

namespace octotomy::brep {
namespace {

constexpr std::size_t end_bytes = 22, entry_bytes = 46, local_bytes = 30;
/// deflate compresses at most this many bytes into one.
constexpr std::size_t most_packed = 1032;

/// Reads a number at an offset; throws if it is not within the archive.
template <typename T>
T number_at(std::string_view bytes, std::size_t at) {
  if (at > bytes.size()) refuse_file("the archive is cut short or damaged");
  MeshScanner scanner(bytes.substr(at));
  return scanner.binary<T>(std::endian::little);
}

std::string folded(std::string name) {
  if (name.starts_with('/')) name.erase(0, 1);
  for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return name;
}

/// The offset of the directory and its number of entries.
std::pair<std::size_t, std::size_t> directory_of(std::string_view bytes) {
  // A comment of up to 64 kB may follow the end record.
  const std::size_t at = bytes.rfind("PK\x05\x06");
  if (at == std::string_view::npos || bytes.size() - at < end_bytes)
    refuse_file("is not a zip archive, or is cut short: its end is missing");
  std::size_t count = number_at<std::uint16_t>(bytes, at + 10),
              begin = number_at<std::uint32_t>(bytes, at + 16);
  if ((begin == 0xffffffff || count == 0xffff) && at >= 20 &&
      number_at<std::uint32_t>(bytes, at - 20) == 0x07064b50) {
    const auto end = static_cast<std::size_t>(number_at<std::uint64_t>(bytes, at - 12));
    if (end > bytes.size() || bytes.size() - end < 56) refuse_file("the archive's end record is damaged");
    count = static_cast<std::size_t>(number_at<std::uint64_t>(bytes, end + 32));
    begin = static_cast<std::size_t>(number_at<std::uint64_t>(bytes, end + 48));
  }
  if (begin > bytes.size() || count > (bytes.size() - begin) / entry_bytes)
    refuse_file("the archive's directory is damaged");
  return {begin, count};
}

std::string inflated(std::string_view packed, std::size_t size, const std::string& name) {
  std::string made(size, '\0');
  z_stream stream{};
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
  stream.avail_in = static_cast<uInt>(packed.size());
  stream.next_out = reinterpret_cast<Bytef*>(made.data());
  stream.avail_out = static_cast<uInt>(made.size());
  if (inflateInit2(&stream, -MAX_WBITS) != Z_OK) throw Error(ErrorCode::Resource, "zlib does not start");
  const int status = inflate(&stream, Z_FINISH);
  const bool is_whole = status == Z_STREAM_END && stream.avail_out == 0;
  inflateEnd(&stream);
  if (!is_whole) refuse_file("'" + name + "' in the archive is damaged");
  return made;
}

}  // namespace

ZipArchive::ZipArchive(std::string_view bytes) : bytes_(bytes) {
  auto [at, count] = directory_of(bytes);
  for (std::size_t i = 0; i < count; ++i) {
    if (number_at<std::uint32_t>(bytes, at) != 0x02014b50) refuse_file("the archive's directory is damaged");
    Entry entry;
    entry.flags = number_at<std::uint16_t>(bytes, at + 8);
    entry.method = number_at<std::uint16_t>(bytes, at + 10);
    entry.checksum = number_at<std::uint32_t>(bytes, at + 16);
    entry.packed = number_at<std::uint32_t>(bytes, at + 20);
    entry.size = number_at<std::uint32_t>(bytes, at + 24);
    const std::size_t name_length = number_at<std::uint16_t>(bytes, at + 28),
                      more_length = number_at<std::uint16_t>(bytes, at + 30),
                      comment_length = number_at<std::uint16_t>(bytes, at + 32);
    entry.header = number_at<std::uint32_t>(bytes, at + 42);
    if (name_length + more_length + comment_length > bytes.size() - at - entry_bytes)
      refuse_file("the archive's directory is damaged");
    const std::string name(bytes.substr(at + entry_bytes, name_length));
    // Sizes that do not fit 32 bits follow the name, in this order.
    for (std::size_t field = at + entry_bytes + name_length, end = field + more_length; field + 4 <= end;) {
      const std::uint16_t kind = number_at<std::uint16_t>(bytes, field),
                          length = number_at<std::uint16_t>(bytes, field + 2);
      std::size_t value = field + 4;
      if (kind == 1)
        for (std::size_t* size : {&entry.size, &entry.packed, &entry.header})
          if (*size == 0xffffffff && value + 8 <= std::min(end, field + 4 + length)) {
            *size = static_cast<std::size_t>(number_at<std::uint64_t>(bytes, value));
            value += 8;
          }
      field += 4u + length;
    }
    entries_[folded(name)] = entry;
    at += entry_bytes + name_length + more_length + comment_length;
  }
}

const ZipArchive::Entry* ZipArchive::find(const std::string& name) const {
  const auto found = entries_.find(folded(name));
  return found == entries_.end() ? nullptr : &found->second;
}

bool ZipArchive::has(const std::string& name) const {
  return find(name) != nullptr;
}

std::string ZipArchive::read(const std::string& name) const {
  const Entry* entry = find(name);
  const std::string place = "'" + name + "' in the archive ";
  if (entry == nullptr) refuse_file(place + "is missing");
  if ((entry->flags & 1) != 0) refuse_file(place + "is encrypted");
  if (entry->method != 0 && entry->method != 8)
    refuse_file(place + "is packed by method " + std::to_string(entry->method) + ", which is not read");
  if (entry->header > bytes_.size() || bytes_.size() - entry->header < local_bytes ||
      number_at<std::uint32_t>(bytes_, entry->header) != 0x04034b50)
    refuse_file(place + "is not at the offset that the directory states");
  const std::size_t begin = entry->header + local_bytes +
                            number_at<std::uint16_t>(bytes_, entry->header + 26) +
                            number_at<std::uint16_t>(bytes_, entry->header + 28);
  if (begin > bytes_.size() || entry->packed > bytes_.size() - begin ||
      entry->size / most_packed > entry->packed || entry->size > 0x7fffffff)
    refuse_file(place + "is cut short or damaged");
  const std::string_view packed = bytes_.substr(begin, entry->packed);
  std::string made = entry->method == 8 ? inflated(packed, entry->size, name) : std::string(packed);
  if (crc32(0, reinterpret_cast<const Bytef*>(made.data()), static_cast<uInt>(made.size())) !=
      entry->checksum)
    refuse_file(place + "is damaged: its checksum differs");
  return made;
}

}  // namespace octotomy::brep
