// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/plan/sha256.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <memory>
#include <openssl/evp.h>
#include <stdexcept>
#include <utility>
#include <vector>

#include "voxel/scan/read_image_stack.h"
#include "voxel/space/file_text.h"

namespace octotomy::planner {
namespace {

namespace fs = std::filesystem;

class Digest {
 public:
  Digest() : context_(EVP_MD_CTX_new(), &EVP_MD_CTX_free) {
    if (!context_ || EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) != 1)
      throw std::runtime_error("libcrypto offers no SHA-256 here: check its configuration");
  }
  void add(const char* bytes, std::size_t count) { EVP_DigestUpdate(context_.get(), bytes, count); }
  std::string hex() {
    std::array<unsigned char, EVP_MAX_MD_SIZE> sum{};
    unsigned length = 0;
    EVP_DigestFinal_ex(context_.get(), sum.data(), &length);
    std::string text;
    for (unsigned i = 0; i < length; ++i) {
      text += "0123456789abcdef"[sum[i] >> 4];
      text += "0123456789abcdef"[sum[i] & 15];
    }
    return text;
  }

 private:
  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context_;
};

std::string sha256_of_file(const fs::path& path) {
  std::ifstream file = voxel::opened(path);
  if (!file)
    throw std::runtime_error(path.string() + ": cannot be opened: check that it exists and may be read");
  Digest digest;
  std::vector<char> buffer(std::size_t{1} << 20);
  while (file.read(buffer.data(), static_cast<std::streamsize>(buffer.size())) || file.gcount() > 0)
    digest.add(buffer.data(), static_cast<std::size_t>(file.gcount()));
  if (file.bad()) throw std::runtime_error(path.string() + ": reading failed for its SHA-256");
  return digest.hex();
}

}  // namespace

std::string sha256_of(std::string_view bytes) {
  Digest digest;
  digest.add(bytes.data(), bytes.size());
  return digest.hex();
}

std::string sha256_of_path(const fs::path& path) {
  std::error_code ignored;
  if (fs::is_regular_file(path, ignored)) return sha256_of_file(path);
  std::vector<fs::path> files;
  if (fs::is_directory(path, ignored)) {
    for (const auto& entry : fs::recursive_directory_iterator(path))
      if (entry.is_regular_file(ignored)) files.push_back(entry.path());
  } else {
    files = voxel::image_files(path);
  }
  if (files.empty()) return sha256_of_file(path);
  const fs::path folder = fs::is_directory(path, ignored) ? path : path.parent_path();
  std::vector<std::pair<std::string, std::string>> lines;
  lines.reserve(files.size());
  for (const fs::path& file : files)
    lines.emplace_back(file.lexically_relative(folder).generic_string(), sha256_of_file(file));
  std::sort(lines.begin(), lines.end());
  Digest digest;
  for (const auto& [name, sum] : lines) {
    digest.add(name.c_str(), name.size() + 1);  // including its terminating zero byte
    digest.add(sum.data(), sum.size());
    digest.add("\n", 1);
  }
  return digest.hex();
}

}  // namespace octotomy::planner
