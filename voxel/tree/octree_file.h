// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "voxel/tree/grey_octree.h"
#include "voxel/tree/octree.h"
#include "voxel/tree/partial_octree.h"

// The .octree format, versions 1 to 3. Numbers are little-endian.
//
//   header    32 bytes: magic 89 4f 43 54 52 45 45 0a ("\x89OCTREE\n"), u32 version, u32 kind (1 binary,
//             2 grey, 3 partial), u64 bytes of the file, u32 number of sections, u32 checksum of the 28 bytes
//             before it
//   sections  each 4 letters of name, u32 checksum, u32 raw bytes, u32 stored bytes; then the stored bytes,
//             one zstd frame of the raw ones
//
// A checksum is a CRC-32 (zlib's). A section's covers its number, a u32 counted from 0, and all of the
// section except the checksum. A burst of up to 32 flipped bits is therefore always detected; other damage is
// missed once in 2^32 cases, or once in 2^64 where zstd's own checksum of the raw bytes covers it too. A
// section's raw bytes are at most 2^20. Longer data are cut into sections of the same name, all but the last
// of that length. Sections follow in this order:
//
//   UNIV  u32 depth, i32 background (0 but for grey), 16 f64 of lps_from_voxel, column by column
//   NAME  UTF-8, may be missing
//   META  UTF-8, JSON by convention, may be missing
//   TREE  binary: the packed treecode (packed_treecode.h) of the voxels; partial: of the voxels wholly inside
//   TOUC  partial: the packed treecode of the voxels touched
//   FRAC  partial: u16 fractions of the voxels touched but not wholly inside, in tree order
//   GRID  grey: a bit per block of 16 x 16 x 16 voxels, x fastest, low bits first: set if the block has a
//         brick; blocks without one are background
//   BRIK  grey: the bricks of up to 64 blocks in the grid's order, first the low bytes of all their numbers,
//         then the high bytes. There is a number for each sample, in tree order (leaves, and samples within
//         each, x + 4y + 16z): the sample's difference, modulo 2^16, from the preceding sample in its row of
//         the leaf. The first sample of a row counts from the row before, of a layer from the layer before,
//         of a leaf from the first sample of the leaf before, and of a brick from the background.
//         Differences 0, -1, 1, -2, ... are written 0, 1, 2, 3, ...
//   SCAN  grey, from version 2 on: the packed treecode of the voxels whose samples are the scan's. Without
//         this section, those voxels are the smallest box that contains all samples other than the
//         background. A file that needs no SCAN is of version 1
//   STEP  grey, version 3 only: a double, the size of one step of the samples in the scan's unit: a power of
//         two other than 1

namespace octotomy::voxel {

/// The contents of an .octree file.
struct OctreeFile {
  std::variant<Octree, GreyOctree, PartialOctree> tree;
  std::string name;      ///< name for display, at most 2^20 bytes
  std::string metadata;  ///< JSON by convention; stored unchanged
};

const Universe& universe(const OctreeFile& file);

/// The bytes of a file with these contents. They depend only on the contents, not on how the tree was made or
/// on the number of threads. Parallel. Memory: the packed tree and, for grey, the compressed bricks.
std::vector<std::uint8_t> octree_file_bytes(const OctreeFile& file);

/// Reads the contents from a file's bytes. Every error message begins with `source`. Throws Error (Input)
/// with the section and its first byte, if a checksum, a size or a tree is wrong; also if the file ends
/// early, continues after its end, or has a later version. Every checksum is verified before anything is
/// built. Memory: at most 2^15 times the number of bytes, which is zstd's highest compression, and an empty
/// tree of the universe.
OctreeFile octree_file_of_bytes(std::span<const std::uint8_t> bytes, const std::string& source);

/// Writes a file beside `path` and renames it into place. Throws Error (Input or Resource) with path and
/// reason.
void write_octree(const OctreeFile& file, const std::filesystem::path& path);
/// Throws Error with path and reason; also throws as octree_file_of_bytes() does.
OctreeFile read_octree(const std::filesystem::path& path);

}  // namespace octotomy::voxel
