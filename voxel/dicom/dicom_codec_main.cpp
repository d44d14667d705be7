// SPDX-License-Identifier: AGPL-3.0-or-later
//
// octotomy_dicom_codec: decompresses the DICOM frames that it receives over the socket at its standard input,
// until the socket closes. voxel/dicom/dicom_codec.cpp starts it; users never do. A malicious frame may make
// a codec run code that is hidden in the frame: this process has no access to the network, to other programs
// or to files outside of its own folder.
#include <cstdlib>
#include <dlfcn.h>
#include <exception>
#include <filesystem>
#include <gdcmImage.h>
#include <gdcmSequenceOfFragments.h>
#include <gdcmTrace.h>
#include <gdcmVersion.h>
#include <string>
#include <sys/resource.h>
#include <unistd.h>
#include <vector>

#include "voxel/dicom/dicom_codec_wire.h"
#include "voxel/space/confine.h"

namespace {

using octotomy::voxel::FrameHead;

/// Limits the process's memory, because decoding a damaged frame may request any amount, and prevents core
/// files.
void set_limits() {
  const rlimit no_core{0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
#ifndef OCTOTOMY_SANITIZED  // a sanitizer reserves terabytes of address space
  // The largest accepted frame has 4096 x 4096 pixels of four bytes; codecs make a few copies of it.
  const rlimit memory{std::size_t{4} << 30, std::size_t{4} << 30};
  setrlimit(RLIMIT_AS, &memory);
#endif
}

gdcm::Image image_of(const FrameHead& head, const std::string& syntax,
                     const std::vector<std::string>& parts) {
  auto* fragments = new gdcm::SequenceOfFragments;  // reference-counted; `pixels` owns the first reference
  for (const std::string& part : parts) {
    gdcm::Fragment fragment;
    fragment.SetByteValue(part.data(), static_cast<std::uint32_t>(part.size()));
    fragments->AddFragment(fragment);
  }
  gdcm::DataElement pixels(gdcm::Tag(0x7fe0, 0x0010));
  pixels.SetVR(gdcm::VR::OB);
  pixels.SetValue(*fragments);
  gdcm::Image image;
  image.SetNumberOfDimensions(2);
  image.SetDimension(0, head.columns);
  image.SetDimension(1, head.rows);
  image.SetPixelFormat(gdcm::PixelFormat(
      1, static_cast<unsigned short>(head.allocated_bits), static_cast<unsigned short>(head.stored_bits),
      static_cast<unsigned short>(head.high_bit), static_cast<unsigned short>(head.is_signed)));
  image.SetPhotometricInterpretation(gdcm::PhotometricInterpretation::MONOCHROME2);
  image.SetTransferSyntax(gdcm::TransferSyntax::GetTSType(syntax.c_str()));
  image.SetDataElement(pixels);
  return image;
}

/// The frame's pixels; empty if it cannot be decompressed.
std::string decompress(const FrameHead& head, const std::string& syntax,
                       const std::vector<std::string>& parts) {
  if (gdcm::TransferSyntax::GetTSType(syntax.c_str()) == gdcm::TransferSyntax::TS_END) return {};
  try {
    const gdcm::Image image = image_of(head, syntax, parts);
    std::string pixels(image.GetBufferLength(), '\0');
    return image.GetBuffer(pixels.data()) ? pixels : std::string();
  } catch (const std::exception&) {
    return {};
  }
}

/// The version of a codec library, returned by the library's own function; empty if GDCM does not link the
/// library. Debian's GDCM links OpenJPEG and CharLS; other builds of GDCM contain copies.
std::string version_by(const char* function) {
  using Version = const char* (*)();
  const auto version = reinterpret_cast<Version>(dlsym(RTLD_DEFAULT, function));
  return version == nullptr ? std::string() : version();
}

std::string facts(bool is_confined) {
  std::string text =
      std::string(is_confined ? "confined" : "not confined") + "\nGDCM " + gdcm::Version::GetVersion() + "\n";
  for (const auto& [name, function] :
       {std::pair{"OpenJPEG", "opj_version"}, std::pair{"CharLS", "charls_get_version_string"}})
    if (const std::string version = version_by(function); !version.empty())
      text += std::string(name) + " " + version + "\n";
  return text;
}

bool answer_next(bool is_confined) {
  using octotomy::voxel::receive_all;
  using octotomy::voxel::send_all;
  FrameHead head;
  if (!receive_all(STDIN_FILENO, &head, sizeof head)) return false;
  std::string syntax(head.syntax_length, '\0');
  if (!receive_all(STDIN_FILENO, syntax.data(), syntax.size())) return false;
  std::vector<std::string> parts(head.fragment_count);
  for (std::string& part : parts) {
    std::uint64_t length = 0;
    if (!receive_all(STDIN_FILENO, &length, sizeof length)) return false;
    part.resize(static_cast<std::size_t>(length));
    if (!receive_all(STDIN_FILENO, part.data(), part.size())) return false;
  }
  const std::string answer = head.columns == 0 ? facts(is_confined) : decompress(head, syntax, parts);
  const std::uint64_t length = answer.size();
  return send_all(STDIN_FILENO, &length, sizeof length) &&
         send_all(STDIN_FILENO, answer.data(), answer.size());
}

}  // namespace

int main(int count, char** arguments) {
  set_limits();
  gdcm::Trace::DebugOff();
  gdcm::Trace::WarningOff();
  gdcm::Trace::ErrorOff();
  // One of GDCM's codecs uses temporary files and does not remove them when it fails.
  if (count != 2 || setenv("TMPDIR", arguments[1], 1) != 0) return 1;
  bool is_confined = false;
#ifndef OCTOTOMY_SANITIZED  // a sanitizer traces the process
  // On systems without seccomp or Landlock, the user is protected only by the limits above and by the
  // separate address space.
  is_confined = octotomy::voxel::confine(arguments[1]);
#endif
  while (answer_next(is_confined)) {
  }
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(arguments[1], ignored))
    unlink(entry.path().c_str());
  rmdir(arguments[1]);
}
