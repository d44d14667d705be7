// Writing: 1 cut the tree's data into raw pieces, 2 compress them in parallel, 3 append them to the header.
// Reading: 1 walk the sections by their stored sizes, 2 check and decompress them in parallel, 3 build the
// tree.
#include "voxel/tree/octree_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <tbb/parallel_for.h>
#include <zlib.h>
#include <zstd.h>

#include "voxel/space/disk_need.h"
#include "voxel/space/error.h"
#include "voxel/space/regular_file.h"
#include "voxel/space/staged_files.h"
#include "voxel/space/write_failure.h"
#include "voxel/tree/packed_treecode.h"

namespace octotomy::voxel {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::array<std::uint8_t, 8> magic{0x89, 'O', 'C', 'T', 'R', 'E', 'E', '\n'};
/// Version 2 adds the section SCAN, and version 3 the section STEP.
constexpr std::uint32_t first_version = 1;
constexpr std::uint32_t last_version = 3;
constexpr std::size_t header_bytes = 32;
constexpr std::size_t section_header_bytes = 16;
constexpr std::size_t largest_raw = std::size_t{1} << 20;
/// Largest ratio of raw to stored bytes: a zstd block of 2^17 equal bytes takes 4 stored bytes.
constexpr std::size_t largest_ratio = std::size_t{1} << 15;
constexpr std::size_t bricks_per_section = 64;
constexpr std::size_t samples_per_brick = 4096;
/// Higher levels make files 5 % smaller and take twice the time.
constexpr int compression_level = 3;

enum class Kind : std::uint32_t { Binary = 1, Grey = 2, Partial = 3 };

template <typename Number>
void put(Number number, std::uint8_t* to) {
  for (std::size_t i = 0; i < sizeof(Number); ++i) to[i] = static_cast<std::uint8_t>(number >> (8 * i));
}

template <typename Number>
Number get(const std::uint8_t* from) {
  Number number = 0;
  for (std::size_t i = 0; i < sizeof(Number); ++i) number |= static_cast<Number>(from[i]) << (8 * i);
  return number;
}

std::uint32_t checksum(std::span<const std::uint8_t> bytes, std::uint32_t before = 0) {
  return static_cast<std::uint32_t>(crc32_z(before, bytes.data(), bytes.size()));
}

// The checksum of section `number`, whose header and stored bytes begin at `section`.
std::uint32_t section_checksum(std::uint32_t number, const std::uint8_t* section, std::size_t stored) {
  std::array<std::uint8_t, 4> number_bytes;
  put(number, number_bytes.data());
  std::uint32_t sum = checksum(number_bytes);
  sum = checksum({section, 4}, sum);
  return checksum({section + 8, 8 + stored}, sum);
}

// Writing ------------------------------------------------------------------------------------------------

/// A section to be written: `make` returns its raw bytes when it is compressed.
struct SectionToWrite {
  const char* name;
  std::function<Bytes()> make;
};

void cut(const char* name, Bytes raw, std::vector<SectionToWrite>& pieces) {
  const auto whole = std::make_shared<const Bytes>(std::move(raw));
  for (std::size_t from = 0; from < whole->size(); from += largest_raw) {
    const std::size_t to = std::min(whole->size(), from + largest_raw);
    pieces.push_back({name, [whole, from, to] {
                        return Bytes(whole->begin() + static_cast<std::ptrdiff_t>(from),
                                     whole->begin() + static_cast<std::ptrdiff_t>(to));
                      }});
  }
}

Bytes bytes_of(const std::string& text) {
  return {text.begin(), text.end()};
}

Bytes universe_bytes(const Universe& universe, std::int16_t background) {
  Bytes raw(8 + 16 * 8);
  put(static_cast<std::uint32_t>(universe.depth), raw.data());
  put(static_cast<std::uint32_t>(std::int32_t{background}), raw.data() + 4);
  for (int i = 0; i < 16; ++i)
    put(std::bit_cast<std::uint64_t>(universe.lps_from_voxel[i / 4][i % 4]), raw.data() + 8 + 8 * i);
  return raw;
}

// The index of the sample by which sample i of a leaf is predicted. Precondition: i > 0.
constexpr std::size_t predictor(std::size_t i) {
  return (i & 3) != 0 ? i - 1 : (i & 12) != 0 ? i - 4 : i - 16;
}

constexpr std::uint16_t folded(std::uint16_t difference) {
  return static_cast<std::uint16_t>((difference << 1) ^ ((difference & 0x8000) != 0 ? 0xffff : 0));
}

constexpr std::uint16_t unfolded(std::uint16_t number) {
  return static_cast<std::uint16_t>((number >> 1) ^ ((number & 1) != 0 ? 0xffff : 0));
}

Bytes brick_bytes(const GreyOctree& grey, std::span<const glm::ivec3> blocks) {
  const std::size_t count = blocks.size() * samples_per_brick;
  Bytes raw(2 * count);
  std::size_t at = 0;
  for (const glm::ivec3& block : blocks) {
    std::int16_t before = grey.background();
    for (const auto& leaf : grey.brick(block).samples) {
      for (std::size_t i = 0; i < leaf.size(); ++i, ++at) {
        const std::int16_t predicted = i == 0 ? before : leaf[predictor(i)];
        const std::uint16_t number = folded(static_cast<std::uint16_t>(leaf[i] - predicted));
        raw[at] = static_cast<std::uint8_t>(number);
        raw[count + at] = static_cast<std::uint8_t>(number >> 8);
      }
      before = leaf.front();
    }
  }
  return raw;
}

// Decodes brick `number` of a section: the inverse of brick_bytes().
void read_brick(const Bytes& raw, std::size_t number, std::int16_t background, GreyBrick& brick) {
  const std::uint8_t* low = raw.data() + number * samples_per_brick;
  const std::uint8_t* high = low + raw.size() / 2;
  std::int16_t before = background;
  for (auto& leaf : brick.samples) {
    for (std::size_t i = 0; i < leaf.size(); ++i) {
      const auto coded = static_cast<std::uint16_t>(*low++ | (*high++ << 8));
      leaf[i] = static_cast<std::int16_t>((i == 0 ? before : leaf[predictor(i)]) + unfolded(coded));
    }
    before = leaf.front();
  }
}

// Calls `visit` for every block of 16 x 16 x 16 voxels in a universe, x fastest.
template <typename Visit>
void for_each_block(const Universe& universe, const Visit& visit) {
  const int side = (universe.side() + 15) / 16;
  std::size_t number = 0;
  for (int z = 0; z < side; ++z)
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) visit(number++, glm::ivec3(x, y, z));
}

std::size_t grid_bytes(const Universe& universe) {
  const auto side = static_cast<std::size_t>((universe.side() + 15) / 16);
  return (side * side * side + 7) / 8;
}

void cut_grey(const GreyOctree& grey, std::vector<SectionToWrite>& pieces) {
  Bytes grid(grid_bytes(grey.universe()), 0);
  const auto blocks = std::make_shared<std::vector<glm::ivec3>>();
  for_each_block(grey.universe(), [&](std::size_t number, const glm::ivec3& block) {
    const MinMax& range = grey.range(2, block);
    if (range.low == range.high && range.low == grey.background()) return;
    grid[number / 8] |= static_cast<std::uint8_t>(1U << (number % 8));
    blocks->push_back(block);
  });
  cut("GRID", std::move(grid), pieces);
  for (std::size_t from = 0; from < blocks->size(); from += bricks_per_section) {
    const std::size_t count = std::min(bricks_per_section, blocks->size() - from);
    pieces.push_back({"BRIK", [grey, blocks, from, count] {
                        return brick_bytes(grey, std::span(*blocks).subspan(from, count));
                      }});
  }
  if (grey.step() != 1.0 || !(grey.scan() == scan_box(grey)))
    cut("SCAN", packed_treecode(grey.scan()), pieces);
  if (grey.step() == 1.0) return;
  Bytes step(8);
  put(std::bit_cast<std::uint64_t>(grey.step()), step.data());
  cut("STEP", std::move(step), pieces);
}

void cut_partial(const PartialOctree& partial, std::vector<SectionToWrite>& pieces) {
  check(partial);
  cut("TREE", packed_treecode(partial.inside), pieces);
  cut("TOUC", packed_treecode(partial.touching), pieces);
  Bytes fractions(2 * partial.fractions.size());
  for (std::size_t i = 0; i < partial.fractions.size(); ++i)
    put(partial.fractions[i], fractions.data() + 2 * i);
  cut("FRAC", std::move(fractions), pieces);
}

std::vector<SectionToWrite> pieces_of(const OctreeFile& file) {
  std::vector<SectionToWrite> pieces;
  const auto* grey = std::get_if<GreyOctree>(&file.tree);
  cut("UNIV", universe_bytes(universe(file), grey != nullptr ? grey->background() : std::int16_t{0}), pieces);
  if (file.name.size() > largest_raw)
    throw InvalidInput("an octree file's name of " + std::to_string(file.name.size()) +
                       " bytes is too long: use at most 2^20");
  cut("NAME", bytes_of(file.name), pieces);
  cut("META", bytes_of(file.metadata), pieces);
  if (const auto* octree = std::get_if<Octree>(&file.tree)) cut("TREE", packed_treecode(*octree), pieces);
  if (grey != nullptr) cut_grey(*grey, pieces);
  if (const auto* partial = std::get_if<PartialOctree>(&file.tree)) cut_partial(*partial, pieces);
  return pieces;
}

Bytes section_of(std::uint32_t number, const SectionToWrite& piece) {
  const Bytes raw = piece.make();
  Bytes section(section_header_bytes + ZSTD_compressBound(raw.size()));
  const std::unique_ptr<ZSTD_CCtx, decltype(&ZSTD_freeCCtx)> context(ZSTD_createCCtx(), &ZSTD_freeCCtx);
  if (context == nullptr) throw std::bad_alloc();
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_compressionLevel, compression_level);
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_checksumFlag, 1);
  const std::size_t stored = ZSTD_compress2(context.get(), section.data() + section_header_bytes,
                                            section.size() - section_header_bytes, raw.data(), raw.size());
  if (ZSTD_isError(stored) != 0)
    throw Error(ErrorCode::Resource, std::string("zstd cannot compress: ") + ZSTD_getErrorName(stored));
  section.resize(section_header_bytes + stored);
  std::copy_n(piece.name, 4, section.begin());
  put(static_cast<std::uint32_t>(raw.size()), section.data() + 8);
  put(static_cast<std::uint32_t>(stored), section.data() + 12);
  put(section_checksum(number, section.data(), stored), section.data() + 4);
  return section;
}

// Reading ------------------------------------------------------------------------------------------------

struct Section {
  std::string name;
  std::size_t start = 0;  ///< in the file
  std::span<const std::uint8_t> stored;
  std::size_t raw_size = 0;
  Bytes raw;
};

class Reader {
 public:
  Reader(std::span<const std::uint8_t> bytes, const std::string& source) : bytes_(bytes), source_(source) {}

  OctreeFile file() {
    read_header();
    walk_sections();
    unpack_sections();
    const Universe universe = read_universe();
    std::string name = text(take("NAME"));
    std::string metadata = text(take("META"));
    return {read_tree(universe), std::move(name), std::move(metadata)};
  }

 private:
  [[noreturn]] void refuse(const std::string& why) const {
    throw Error(ErrorCode::Input, source_ + ": " + why);
  }
  [[noreturn]] void refuse_damaged(const std::string& what) const {
    refuse(what + ": the file is damaged, copy it again from its source");
  }
  std::string named(std::size_t number) const {
    return "section " + std::to_string(number + 1) + " of " + std::to_string(section_count_) + ", " +
           sections_[number].name + ", from byte " + std::to_string(sections_[number].start);
  }

  void read_header() {
    const std::size_t compared = std::min(bytes_.size(), magic.size());
    if (!std::equal(magic.begin(), magic.begin() + static_cast<std::ptrdiff_t>(compared), bytes_.begin()) ||
        bytes_.empty())
      refuse(
          "is not an octree file: it does not begin with the letters OCTREE; make one with octotomy octree");
    if (bytes_.size() < header_bytes)
      refuse_damaged("is cut short within its header, at byte " + std::to_string(bytes_.size()));
    if (get<std::uint32_t>(bytes_.data() + 28) != checksum(bytes_.first(28)))
      refuse_damaged("the header, bytes 0 to 31, does not match its checksum");
    version_ = get<std::uint32_t>(bytes_.data() + 8);
    if (version_ < first_version || version_ > last_version)
      refuse("is of version " + std::to_string(version_) +
             " of the format, and this program reads versions " + std::to_string(first_version) + " to " +
             std::to_string(last_version) + ": use a later octotomy");
    const auto kind = get<std::uint32_t>(bytes_.data() + 12);
    if (kind < 1 || kind > 3) refuse("holds a tree of the unknown kind " + std::to_string(kind));
    kind_ = static_cast<Kind>(kind);
    const auto size = get<std::uint64_t>(bytes_.data() + 16);
    if (bytes_.size() < size)
      refuse_damaged("is cut short: it has " + std::to_string(bytes_.size()) + " of its " +
                     std::to_string(size) + " bytes");
    if (bytes_.size() > size) refuse_damaged("continues after its end, byte " + std::to_string(size));
    section_count_ = get<std::uint32_t>(bytes_.data() + 24);
  }

  void walk_sections() {
    std::size_t at = header_bytes;
    for (std::uint32_t number = 0; number < section_count_; ++number) {
      const std::string which = "section " + std::to_string(number + 1) + " of " +
                                std::to_string(section_count_) + ", from byte " + std::to_string(at);
      if (bytes_.size() - at < section_header_bytes) refuse_damaged(which + ", does not fit into the file");
      const std::uint8_t* header = bytes_.data() + at;
      Section section;
      section.name.assign(header, header + 4);
      section.start = at;
      section.raw_size = get<std::uint32_t>(header + 8);
      const std::size_t stored = get<std::uint32_t>(header + 12);
      at += section_header_bytes;
      if (bytes_.size() - at < stored) refuse_damaged(which + ", is longer than the file");
      section.stored = bytes_.subspan(at, stored);
      at += stored;
      sections_.push_back(std::move(section));
    }
    if (at != bytes_.size()) refuse_damaged("there is no section at byte " + std::to_string(at));
  }

  void unpack_sections() {
    std::vector<std::string> damage(sections_.size());
    tbb::parallel_for(std::size_t{0}, sections_.size(), [&](std::size_t number) {
      if (const auto found = unpack(static_cast<std::uint32_t>(number), sections_[number]))
        damage[number] = *found;
    });
    for (std::size_t number = 0; number < sections_.size(); ++number)
      if (!damage[number].empty()) refuse_damaged(named(number) + ", " + damage[number]);
  }

  // Checks and decompresses a section. Returns the reason if the section is damaged.
  std::optional<std::string> unpack(std::uint32_t number, Section& section) const {
    const std::uint8_t* start = bytes_.data() + section.start;
    if (get<std::uint32_t>(start + 4) != section_checksum(number, start, section.stored.size()))
      return "does not match its checksum";
    if (section.raw_size > largest_raw || section.raw_size > section.stored.size() * largest_ratio)
      return "is larger than a section can be";
    section.raw.resize(section.raw_size);
    const std::size_t size =
        ZSTD_decompress(section.raw.data(), section.raw.size(), section.stored.data(), section.stored.size());
    if (ZSTD_isError(size) != 0) return std::string("does not decompress: ") + ZSTD_getErrorName(size);
    if (size != section.raw_size) return "is shorter than it states";
    return std::nullopt;
  }

  // The joined raw bytes of the consecutive next sections with the given name; empty if the next section has
  // another name.
  Bytes take(const std::string& name) {
    Bytes raw;
    for (; next_ < sections_.size() && sections_[next_].name == name; ++next_) {
      if (raw.empty())
        raw = std::move(sections_[next_].raw);
      else
        raw.insert(raw.end(), sections_[next_].raw.begin(), sections_[next_].raw.end());
      sections_[next_].raw = {};
    }
    return raw;
  }
  Bytes take_needed(const std::string& name) {
    if (next_ == sections_.size() || sections_[next_].name != name)
      refuse("has no section " + name + " where it must stand" +
             (next_ < sections_.size() ? ", but " + named(next_) : std::string()));
    return take(name);
  }
  static std::string text(const Bytes& raw) { return {raw.begin(), raw.end()}; }

  Universe read_universe() {
    const Bytes raw = take_needed("UNIV");
    if (raw.size() != 8 + 16 * 8)
      refuse("section UNIV has " + std::to_string(raw.size()) + " bytes, not 136");
    Universe universe;
    const auto depth = get<std::uint32_t>(raw.data());
    if (depth < 2 || depth > Universe::max_depth)
      refuse("section UNIV: a universe has a depth of 2 to 12, not " + std::to_string(depth));
    universe.depth = static_cast<int>(depth);
    const auto background = static_cast<std::int32_t>(get<std::uint32_t>(raw.data() + 4));
    if (background < INT16_MIN || background > INT16_MAX)
      refuse("section UNIV: the background " + std::to_string(background) + " is no 16-bit sample");
    background_ = static_cast<std::int16_t>(background);
    bool finite = true;
    for (int i = 0; i < 16; ++i) {
      const auto value = std::bit_cast<double>(get<std::uint64_t>(raw.data() + 8 + 8 * i));
      universe.lps_from_voxel[i / 4][i % 4] = value;
      finite = finite && std::isfinite(value);
    }
    const double volume = finite ? std::abs(glm::determinant(glm::dmat3(universe.lps_from_voxel))) : 0.0;
    if (!finite || volume == 0.0 || !std::isfinite(volume))
      refuse("section UNIV: the matrix that places the voxels is singular or not finite");
    return universe;
  }

  std::variant<Octree, GreyOctree, PartialOctree> read_tree(const Universe& universe) {
    try {
      if (kind_ == Kind::Grey) {
        GreyOctree grey = read_grey(universe);
        expect_end();
        return grey;
      }
      Octree inside = octree_of_packed_treecode(universe, take_needed("TREE"));
      if (kind_ == Kind::Binary) {
        expect_end();
        return inside;
      }
      PartialOctree partial{inside, octree_of_packed_treecode(universe, take_needed("TOUC")), {}};
      const Bytes fractions = take("FRAC");
      if (fractions.size() % 2 != 0) refuse("section FRAC ends within a fraction");
      for (std::size_t i = 0; i < fractions.size(); i += 2)
        partial.fractions.push_back(get<std::uint16_t>(fractions.data() + i));
      check(partial);
      expect_end();
      return partial;
    } catch (const InvalidInput& error) {
      refuse(error.what());
    }
  }

  GreyOctree read_grey(const Universe& universe) {
    const Bytes grid = take_needed("GRID");
    if (grid.size() != grid_bytes(universe))
      refuse("section GRID has " + std::to_string(grid.size()) + " bytes, not " +
             std::to_string(grid_bytes(universe)));
    std::vector<glm::ivec3> blocks;
    std::size_t bits = 0;
    for (const std::uint8_t byte : grid) bits += static_cast<std::size_t>(std::popcount(byte));
    // Checks that the file has every brick before any is allocated.
    const std::size_t first = next_;
    std::size_t samples = 0;
    for (; next_ < sections_.size() && sections_[next_].name == "BRIK"; ++next_) {
      const std::size_t bricks = std::min(bricks_per_section, bits - samples / samples_per_brick);
      if (bricks == 0 || sections_[next_].raw.size() != 2 * samples_per_brick * bricks)
        refuse(named(next_) + ", does not hold " + std::to_string(bricks) + " bricks");
      samples += samples_per_brick * bricks;
    }
    if (samples != bits * samples_per_brick)
      refuse("has " + std::to_string(samples / samples_per_brick) + " of its " + std::to_string(bits) +
             " bricks");
    blocks.reserve(bits);
    for_each_block(universe, [&](std::size_t number, const glm::ivec3& block) {
      if (((grid[number / 8] >> (number % 8)) & 1) != 0) blocks.push_back(block);
    });
    if (blocks.size() != bits) refuse("section GRID has bits beyond the universe");
    std::optional<Octree> scan;
    if (version_ > first_version) scan = octree_of_packed_treecode(universe, take_needed("SCAN"));
    const double step = version_ == last_version ? read_step() : 1.0;
    return grey_octree_of_bricks(
        universe, background_, blocks,
        [&](std::size_t i, GreyBrick& brick) {
          read_brick(sections_[first + i / bricks_per_section].raw, i % bricks_per_section, background_,
                     brick);
        },
        std::move(scan), step);
  }

  double read_step() {
    const Bytes raw = take_needed("STEP");
    if (raw.size() != 8) refuse("section STEP has " + std::to_string(raw.size()) + " bytes, not 8");
    const auto step = std::bit_cast<double>(get<std::uint64_t>(raw.data()));
    int exponent = 0;
    if (!(step > 0.0) || !std::isfinite(step) || std::frexp(step, &exponent) != 0.5)
      refuse("section STEP: the step of its samples is not a power of two");
    return step;
  }

  void expect_end() const {
    if (next_ != sections_.size()) refuse(named(next_) + ", is not expected there");
  }

  std::span<const std::uint8_t> bytes_;
  const std::string& source_;
  Kind kind_ = Kind::Binary;
  std::uint32_t version_ = first_version;
  std::uint32_t section_count_ = 0;
  std::vector<Section> sections_;
  std::size_t next_ = 0;
  std::int16_t background_ = 0;
};

}  // namespace

const Universe& universe(const OctreeFile& file) {
  if (const auto* octree = std::get_if<Octree>(&file.tree)) return octree->universe();
  if (const auto* grey = std::get_if<GreyOctree>(&file.tree)) return grey->universe();
  return std::get<PartialOctree>(file.tree).inside.universe();
}

std::vector<std::uint8_t> octree_file_bytes(const OctreeFile& file) {
  const std::vector<SectionToWrite> pieces = pieces_of(file);
  std::vector<Bytes> sections(pieces.size());
  tbb::parallel_for(std::size_t{0}, pieces.size(), [&](std::size_t number) {
    sections[number] = section_of(static_cast<std::uint32_t>(number), pieces[number]);
  });
  std::size_t size = header_bytes;
  for (const Bytes& section : sections) size += section.size();
  Bytes bytes(header_bytes);
  bytes.reserve(size);
  std::copy(magic.begin(), magic.end(), bytes.begin());
  const std::string_view last = pieces.empty() ? "" : pieces.back().name;
  const std::uint32_t version = last == "STEP" ? last_version : last == "SCAN" ? 2 : first_version;
  put(version, bytes.data() + 8);
  put(static_cast<std::uint32_t>(file.tree.index() + 1), bytes.data() + 12);
  put(static_cast<std::uint64_t>(size), bytes.data() + 16);
  put(static_cast<std::uint32_t>(sections.size()), bytes.data() + 24);
  put(checksum(std::span(bytes).first(28)), bytes.data() + 28);
  for (const Bytes& section : sections) bytes.insert(bytes.end(), section.begin(), section.end());
  return bytes;
}

OctreeFile octree_file_of_bytes(std::span<const std::uint8_t> bytes, const std::string& source) {
  return Reader(bytes, source).file();
}

void write_octree(const OctreeFile& file, const std::filesystem::path& path) {
  const Bytes bytes = octree_file_bytes(file);
  need_disk(path, bytes.size());
  StagedFiles staging(path.parent_path());
  const std::filesystem::path staged = staging.folder() / path.filename();
  std::FILE* const stream = std::fopen(staged.c_str(), "wb");
  if (stream == nullptr) refuse_unwritten(path, errno);
  const bool written = std::fwrite(bytes.data(), 1, bytes.size(), stream) == bytes.size();
  const int reason = errno;
  const bool closed = std::fclose(stream) == 0;
  if (!written) errno = reason;
  if (!written || !closed) refuse_unwritten(path, errno);
  staging.commit(path.filename());
}

OctreeFile read_octree(const std::filesystem::path& path) {
  need_regular_file(path);
  errno = 0;
  std::ifstream stream(path, std::ios::binary);
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (!stream || error)
    throw Error(ErrorCode::Input, path.string() + ": cannot be read: " +
                                      (error ? error.message() : std::string(std::strerror(errno))));
  Bytes bytes(size);
  stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (static_cast<std::uintmax_t>(stream.gcount()) != size)
    throw Error(ErrorCode::Resource, path.string() + ": cannot be read to its end");
  return octree_file_of_bytes(bytes, path.string());
}

}  // namespace octotomy::voxel
