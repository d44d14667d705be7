// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/network/received_files.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <openssl/evp.h>
#include <unistd.h>

#include "planner/network/connection.h"
#include "voxel/dicom/dicom_file.h"
#include "voxel/space/error.h"

namespace octotomy::planner {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t head_bytes = 1 << 20;  ///< checked beginning of a complete object

[[noreturn]] void refuse(const fs::path& path, int error) {
  throw std::runtime_error(path.string() + ": cannot be written: " + std::strerror(error));
}

}  // namespace

ReceivedFiles::ReceivedFiles(fs::path folder, const ReceiveLimits& limits)
    : folder_(std::move(folder)), limits_(limits) {
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error) throw std::runtime_error(folder_.string() + ": the folder cannot be made: " + error.message());
}

std::vector<ReceivedFile> ReceivedFiles::files() const {
  const std::lock_guard lock(mutex_);
  return files_;
}

struct ReceivedFiles::Part::State {
  fs::path path;
  int file = -1;
  std::uint64_t bytes = 0;
  std::string head;
  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> sum{EVP_MD_CTX_new(), &EVP_MD_CTX_free};
};

ReceivedFiles::Part::Part(ReceivedFiles& owner) : owner_(owner), state_(std::make_unique<State>()) {
  std::uint64_t number = 0;
  {
    const std::lock_guard lock(owner_.mutex_);
    number = ++owner_.parts_;
  }
  state_->path =
      owner_.folder_ / (".receiving-" + std::to_string(::getpid()) + "-" + std::to_string(number) + ".part");
  state_->file = ::open(state_->path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0644);
  if (state_->file < 0) refuse(state_->path, errno);
  EVP_DigestInit_ex(state_->sum.get(), EVP_sha256(), nullptr);
}

ReceivedFiles::Part::~Part() {
  if (state_->file < 0) return;
  ::close(state_->file);
  ::unlink(state_->path.c_str());
  const std::lock_guard lock(owner_.mutex_);
  owner_.bytes_ -= state_->bytes;
}

void ReceivedFiles::Part::write(std::string_view bytes) {
  if (state_->bytes + bytes.size() > owner_.limits_.object_bytes)
    throw PeerError("an object takes more than " + std::to_string(owner_.limits_.object_bytes >> 20) +
                    " MB: raise --object-mb if this is intended");
  {
    const std::lock_guard lock(owner_.mutex_);
    if (owner_.bytes_ + bytes.size() > owner_.limits_.total_bytes)
      throw PeerError("all objects take more than " + std::to_string(owner_.limits_.total_bytes >> 20) +
                      " MB: raise --total-mb if this is intended");
    owner_.bytes_ += bytes.size();
  }
  state_->bytes += bytes.size();
  EVP_DigestUpdate(state_->sum.get(), bytes.data(), bytes.size());
  if (state_->head.size() < head_bytes)
    state_->head.append(bytes.substr(0, head_bytes - state_->head.size()));
  while (!bytes.empty()) {
    const ssize_t put = ::write(state_->file, bytes.data(), bytes.size());
    if (put < 0 && errno != EINTR) refuse(state_->path, errno);
    if (put > 0) bytes.remove_prefix(static_cast<std::size_t>(put));
  }
}

ReceivedFile ReceivedFiles::Part::finish(const std::string& class_uid, const std::string& instance_uid) {
  ReceivedFile made;
  made.bytes = state_->bytes;
  try {
    if (state_->head.size() < 132 || state_->head.compare(128, 4, "DICM") != 0)
      throw PeerError("an object is not a DICOM file");
    const voxel::DicomFile file(state_->head, made.bytes);
    made.class_uid = file.text(0x00080016);
    made.instance_uid = file.text(0x00080018);
  } catch (const voxel::DicomFile::NeedsMore&) {
    // The attributes extend beyond the checked bytes. The identifiers that the peer announced are used.
    made.class_uid = class_uid;
    made.instance_uid = instance_uid;
  } catch (const voxel::DicomFile::Deflated&) {
    throw PeerError("an object has the deflated transfer syntax, which is not supported");
  } catch (const voxel::Error& error) {
    throw PeerError(std::string("an object's attributes are damaged: ") + error.what());
  }
  if (!class_uid.empty() && (made.class_uid != class_uid || made.instance_uid != instance_uid))
    throw PeerError("an object is not the instance that was announced");
  std::array<unsigned char, EVP_MAX_MD_SIZE> sum{};
  unsigned length = 0;
  EVP_DigestFinal_ex(state_->sum.get(), sum.data(), &length);
  constexpr const char* digits = "0123456789abcdef";
  for (unsigned i = 0; i < length; ++i) {
    made.name += digits[sum[i] >> 4];
    made.name += digits[sum[i] & 15];
  }
  made.name += ".dcm";
  if (::rename(state_->path.c_str(), (owner_.folder_ / made.name).c_str()) != 0) refuse(state_->path, errno);
  ::close(state_->file);
  state_->file = -1;
  const std::lock_guard lock(owner_.mutex_);
  owner_.files_.push_back(made);
  return made;
}

}  // namespace octotomy::planner
