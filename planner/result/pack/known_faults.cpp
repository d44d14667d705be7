// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Sources: the CVE records of these numbers; GDCM's pull requests 213, 233 and 235; CISA's advisories
// ICSMA-26-083-01 (GDCM) and of June 2026 (DCMTK); OpenImageIO's SECURITY.md; Expat's Changes; the release
// notes of libpng 1.6.51 and 1.6.55, of zlib 1.3.1 and of OpenSSL 3.0.20; curl's list of CVEs. The releases
// that repaired GDCM's faults of 2024 and CVE-2023-36183 (NixOS's update to 2.4.13) are not confirmed by a
// record of their projects. The list is not complete: it holds the faults whose record was read.
// OpenImageIO's symbols show which functions of libpng it calls.
#include "planner/result/pack/known_faults.h"

#include <algorithm>
#include <iterator>
#include <sstream>

namespace octotomy::planner {
namespace {

using Place = KnownFault::Place;

constexpr const char* refused = "pictures in that format are refused";
constexpr const char* on_pictures = "on stacks of pictures";
constexpr const char* on_drawings = "on drawings (SVG) and 3MF files";

const std::vector<KnownFault>& all_faults() {
  static const std::vector<KnownFault> faults = {
      {"GDCM", "CVE-2024-22373", "a JPEG 2000 frame overflows its buffer", "3.0.24", Place::InDecoder, ""},
      {"GDCM", "pull request 235", "a frame in run lengths overflows its buffer", "", Place::InDecoder, ""},
      {"GDCM", "CVE-2024-22391", "a colour table overflows its buffer", "3.0.24", Place::NotCalled,
       "GDCM reads no colour table"},
      {"GDCM", "CVE-2024-25569", "raw frames are read beyond their end", "3.0.24", Place::NotCalled,
       "raw frames are read by this program's own reader"},
      {"GDCM", "CVE-2025-11266", "the list of compressed fragments overflows its buffer", "3.2.2",
       Place::NotCalled, "fragments are read by this program's own reader"},
      {"GDCM", "CVE-2025-52582", "overlays are read beyond their end", "", Place::NotCalled,
       "GDCM reads no overlay"},
      {"GDCM", "CVE-2026-3650", "a file's meta header fills the memory", "", Place::NotCalled,
       "headers are read by this program's own reader"},
      {"OpenJPEG", "CVE-2024-56826", "the conversion of colours overflows its buffer", "2.5.3",
       Place::NotCalled, "that code is in the library's own tool, opj_decompress"},
      {"OpenJPEG", "CVE-2026-107080", "the encoder overflows its buffer", "", Place::NotCalled,
       "nothing is encoded as JPEG 2000"},
      {"OpenImageIO", "CVE-2023-24472", "threads race for data in the reader of TIFF", "2.4.8.1",
       Place::InProgram, on_pictures},
      {"OpenImageIO", "CVE-2023-42295", "the number of a BMP picture's pixels overflows", "2.5.3",
       Place::InProgram, on_pictures},
      {"OpenImageIO", "CVE-2023-22845", "a damaged Targa picture is not refused", "2.4.8.1", Place::NotCalled,
       refused},
      {"OpenImageIO", "CVE-2023-36183", "an ICO picture overflows its buffer", "2.4.13", Place::NotCalled,
       refused},
      {"OpenImageIO", "CVE-2026-7582", "a DDS picture overflows its buffer", "3.0.18", Place::NotCalled,
       refused},
      {"OpenImageIO", "CVE-2026-43903", "an SGI picture overflows its buffer", "3.0.18", Place::NotCalled,
       refused},
      {"OpenImageIO", "CVE-2026-63419", "an IFF picture overflows the buffer of a tile", "", Place::NotCalled,
       refused},
      {"libtiff", "CVE-2025-9900", "a picture's height determines the address of a write", "4.7.1",
       Place::InProgram, on_pictures},
      {"libpng", "CVE-2025-65018", "an interlaced picture overflows its buffer", "1.6.51", Place::NotCalled,
       "OpenImageIO calls the full reader, not the simplified one"},
      {"libpng", "CVE-2026-25646", "the reduction of a palette overflows its buffer", "1.6.55",
       Place::NotCalled, "OpenImageIO reduces no palette"},
      {"Expat", "CVE-2023-52425", "a long token is parsed again with each piece of text", "2.6",
       Place::NotCalled, "a text is parsed in one call"},
      {"Expat", "CVE-2024-8176", "a chain of entities exhausts the stack", "2.7", Place::NotCalled,
       "references to entities stay as written, and 3MF files that declare some are refused"},
      {"Expat", "CVE-2025-59375", "a small text takes much memory", "2.7.2", Place::InProgram, on_drawings},
      {"Expat", "CVE-2026-45186", "names of attributes take quadratic time", "2.8.1", Place::InProgram,
       on_drawings},
      {"Expat", "CVE-2026-66046", "attributes take quadratic time", "2.8.4", Place::InProgram, on_drawings},
      {"zlib", "CVE-2023-45853", "a long name of an entry overflows minizip's buffer", "1.3.1",
       Place::NotCalled, "names of entries are paths, which have at most 4096 bytes"},
      {"libcurl", "CVE-2023-38545", "a slow SOCKS5 proxy makes a long host name overflow its buffer", "8.4",
       Place::InProgram, "if the environment names such a proxy"},
      {"libcurl", "CVE-2023-38039", "endless header lines fill the memory", "8.3", Place::NotCalled,
       "this program ends a request at 256 KB of header lines"},
      {"libcurl", "CVE-2024-2398", "pushed header lines leak memory", "8.7", Place::NotCalled,
       "server push is not enabled"},
      {"OpenSSL", "CVE-2026-31790", "RSASVE continues after a failure", "3.0.20", Place::NotCalled,
       "no key is encapsulated by RSASVE"},
      {"SQLite", "CVE-2025-6965", "a statement with many aggregates damages the memory", "3.50.2",
       Place::NotCalled, "all statements are this program's own"},
      {"SQLite", "CVE-2026-11822", "a database's full-text pages damage the memory", "3.53.2",
       Place::NotCalled, "no full-text search is made"},
      {"DCMTK", "CVE-2026-50003", "a peer chooses the path of a received file", "", Place::NotLinked,
       "this program's own receiver names files by their SHA-256"}};
  return faults;
}

}  // namespace

bool is_before(const std::string& version, const std::string& other) {
  std::istringstream a(version), b(other);
  while (a || b) {
    int left = 0, right = 0;
    a >> left;
    b >> right;
    if (left != right) return left < right;
    a.ignore(1, '.');
    b.ignore(1, '.');
  }
  return false;
}

std::vector<KnownFault> faults_of(const nlohmann::ordered_json& versions) {
  std::vector<KnownFault> found;
  std::copy_if(
      all_faults().begin(), all_faults().end(), std::back_inserter(found), [&](const KnownFault& fault) {
        const auto version = versions.find(fault.library);
        if (version == versions.end()) return fault.place == Place::NotLinked;
        return fault.repaired_in.empty() || is_before(version->get<std::string>(), fault.repaired_in);
      });
  return found;
}

}  // namespace octotomy::planner
