// SPDX-License-Identifier: AGPL-3.0-or-later
//
// The only unit of this room that includes ITK. It uses the ImageIO classes alone, without ITK's factories,
// images and pipeline: nothing is registered at start-up and the unit compiles in seconds.
#include "voxel/scan/scene_itk.h"

#include "voxel/space/itk_compiler.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <functional>
#include <iterator>
#include <itkMetaDataObject.h>
#include <itkMetaImageIO.h>
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>
#include <limits>
#include <map>
#include <stdexcept>
#include <zlib.h>

#include "voxel/scan/air_level.h"
#include "voxel/scan/audit.h"
#include "voxel/scan/stored_samples.h"
#include "voxel/space/file_text.h"
#include "voxel/space/memory_need.h"
#include "voxel/space/quiet_errors.h"
#include "voxel/space/write_failure.h"

namespace octotomy::voxel {

namespace {

namespace fs = std::filesystem;

// The keys of the scene's meaning and modality in a file; NIfTI has one free text, the description.
constexpr const char* meaning_key = "octotomy_meaning";
constexpr const char* modality_key = "octotomy_modality";
constexpr const char* nifti_text_key = "descrip";
constexpr std::string_view nifti_mark = "octotomy ";

itk::ImageIOBase::Pointer new_io(VolumeFormat format) {
  switch (format) {
    case VolumeFormat::Nifti:
      return itk::NiftiImageIO::New().GetPointer();
    case VolumeFormat::Nrrd:
      return itk::NrrdImageIO::New().GetPointer();
    case VolumeFormat::Meta:
      return itk::MetaImageIO::New().GetPointer();
  }
  return nullptr;
}

/// The last line of ITK's report, which is a stack of causes from outermost to innermost, one per line.
std::string innermost_cause(const std::string& description) {
  std::string cause;
  for (std::size_t at = 0; at < description.size();) {
    const std::size_t end = std::min(description.find('\n', at), description.size());
    if (const std::string line = trimmed(description.substr(at, end - at)); !line.empty()) cause = line;
    at = end + 1;
  }
  if (cause.starts_with("itk::ERROR: ") || cause.starts_with("ITK ERROR: "))
    if (const std::size_t end = cause.find("): "); end != std::string::npos) cause.erase(0, end + 3);
  if (cause.starts_with("[nrrd] "))
    if (const std::size_t end = cause.find(": "); end != std::string::npos) cause.erase(0, end + 2);
  return cause;
}

/// Runs a call into ITK and turns its exceptions into an Error of one line that names the file.
template <typename Call>
void call_itk(const fs::path& path, VolumeFormat format, const char* what, const Call& call) {
  try {
    const QuietErrors quiet;  // MetaIO prints its reasons as well
    errno = 0;
    call();
  } catch (const itk::ExceptionObject& error) {
    const int number = errno;
    refuse(path,
           std::string(what) + " as " + name_of(format) + ": " + innermost_cause(error.GetDescription()) +
               way_out_of(number),
           code_of_errno(number));
  } catch (const Error&) {
    throw;
  } catch (const std::exception& error) {
    refuse(path, std::string(what) + " as " + name_of(format) + ": " + innermost_cause(error.what()));
  }
}

/// Checks the header's claims and returns its lattice.
Lattice lattice_of(const itk::ImageIOBase& io, const fs::path& path, std::uintmax_t most) {
  const unsigned axis_count = io.GetNumberOfDimensions();
  if (axis_count < 2) refuse(path, "has " + std::to_string(axis_count) + " axes; a scan needs three");
  if (io.GetNumberOfComponents() != 1)
    refuse(path, "has " + std::to_string(io.GetNumberOfComponents()) + " values per sample; a scan has one");
  Lattice lattice{glm::ivec3(1), glm::dmat4(1.0)};
  std::uintmax_t bytes = std::max(1u, io.GetComponentSize());
  std::string dims;
  for (unsigned axis = 0; axis < axis_count; ++axis) {
    const std::uintmax_t length = io.GetDimensions(axis);
    dims += (axis == 0 ? "" : " x ") + std::to_string(length);
    if (length < 1 || length > static_cast<std::uintmax_t>(std::numeric_limits<int>::max()))
      refuse(path, "its header claims " + dims + " samples");
    if (axis >= 3 && length > 1)
      refuse(path, "has more than three axes (" + dims + "); extract one volume from it");
    if (bytes > most / length)
      refuse(path, "its header claims " + dims + (axis + 1 < axis_count ? " x ..." : "") + " samples of " +
                       std::to_string(io.GetComponentSize()) +
                       " bytes, more than its data can hold; the file is cut short or damaged");
    bytes *= length;
    if (axis < 3) lattice.dims[static_cast<int>(axis)] = static_cast<int>(length);
  }
  // Adding zero turns -0, a result of turned axes, into 0.
  for (unsigned axis = 0; axis < std::min(axis_count, 3u); ++axis) {
    const std::vector<double> direction = io.GetDirection(axis);
    for (unsigned i = 0; i < std::min<std::size_t>(direction.size(), 3); ++i)
      lattice.lps_from_voxel[static_cast<int>(axis)][static_cast<int>(i)] =
          direction[i] * io.GetSpacing(axis) + 0.0;
    lattice.lps_from_voxel[3][static_cast<int>(axis)] = io.GetOrigin(axis) + 0.0;
  }
  return lattice;
}

/// A volume file that is open.
struct Volume {
  const fs::path& path;
  VolumeFormat format;
  const VolumeHeader& header;
  itk::ImageIOBase& io;
  const SlicesFinal& slices_final;
};

using BytesHeld = std::function<void(std::uintmax_t held)>;

template <typename Stored>
void fill(const Volume& volume, Samples<Stored>& samples, const BytesHeld& held = {}) {
  // The libraries behind ITK unpack into memory of their own.
  if (volume.header.is_plain)
    read_plain_samples(volume.path, volume.format, volume.header, reinterpret_cast<char*>(samples.data()),
                       samples.size() * sizeof(Stored), held);
  else
    volume.io.Read(samples.data());
}

template <typename Stored>
void read_as(const Volume& volume, Scene& scene) {
  Samples<Stored> stored(scene.lattice.sample_count());
  fill(volume, stored);
  take_samples(stored, scene);
}

bool passes_check(const Scene& scene) {
  try {
    check(scene);
    return true;
  } catch (const std::invalid_argument&) {
    return false;  // read_scene() says so when the samples are known to be sound
  }
}

/// Reads samples that are the scene's as they are.
void read_own(const Volume& volume, Scene& scene) {
  auto& samples = scene.samples.emplace<Int16Samples>(scene.lattice.sample_count());
  if (!volume.slices_final || !passes_check(scene)) return fill(volume, samples);
  const std::uintmax_t slice_bytes =
      samples.size() * sizeof(std::int16_t) / static_cast<std::size_t>(scene.lattice.dims.z);
  int told = 0;
  const auto tell = [&](int count) {
    told = count;
    volume.slices_final(scene, count);
  };
  try {
    fill(volume, samples, [&](std::uintmax_t held) {
      if (const auto count = static_cast<int>(held / slice_bytes); count > told) tell(count);
    });
    tell(scene.lattice.dims.z);
  } catch (...) {
    tell(0);
    throw;
  }
}

void read_samples(const Volume& volume, Scene& scene) {
  switch (volume.io.GetComponentType()) {
    case itk::IOComponentEnum::UCHAR:
      return read_as<unsigned char>(volume, scene);
    case itk::IOComponentEnum::CHAR:
      return read_as<signed char>(volume, scene);
    case itk::IOComponentEnum::USHORT:
      return read_as<unsigned short>(volume, scene);
    case itk::IOComponentEnum::SHORT:
      return read_own(volume, scene);
    case itk::IOComponentEnum::UINT:
      return read_as<unsigned int>(volume, scene);
    case itk::IOComponentEnum::INT:
      return read_as<int>(volume, scene);
    case itk::IOComponentEnum::ULONG:
      return read_as<unsigned long>(volume, scene);
    case itk::IOComponentEnum::LONG:
      return read_as<long>(volume, scene);
    case itk::IOComponentEnum::ULONGLONG:
      return read_as<unsigned long long>(volume, scene);
    case itk::IOComponentEnum::LONGLONG:
      return read_as<long long>(volume, scene);
    case itk::IOComponentEnum::FLOAT:
      return read_as<float>(volume, scene);
    case itk::IOComponentEnum::DOUBLE:
      return read_as<double>(volume, scene);
    default:
      refuse(volume.path, "samples of type " +
                              itk::ImageIOBase::GetComponentTypeAsString(volume.io.GetComponentType()) +
                              " are not supported");
  }
}

std::optional<std::string> entry_of(const itk::ImageIOBase& io, const char* key) {
  std::string text;
  if (!itk::ExposeMetaData<std::string>(io.GetMetaDataDictionary(), key, text)) return std::nullopt;
  return text;
}

void audit_frame(const itk::ImageIOBase& io, VolumeFormat format, const VolumeHeader& header, Scene& scene) {
  bool named = true;
  if (format == VolumeFormat::Nrrd) {
    named = header.field("space").has_value();
  } else if (format == VolumeFormat::Meta) {
    named = header.field("transformmatrix") || header.field("orientation") || header.field("rotation");
  } else {
    named =
        entry_of(io, "qform_code").value_or("1") != "0" || entry_of(io, "sform_code").value_or("1") != "0";
  }
  scene.audit.push_back(frame_finding(named));
  if (io.GetNumberOfDimensions() < 3)
    scene.audit.push_back(
        {"slice_spacing", Verdict::Warn, "a single slice; its thickness is assumed to be 1 mm"});
  else if (!scene.lattice.right_handed())
    scene.audit.push_back(
        {"handedness", Verdict::Pass, "voxel axes are left-handed; positions allow for it"});
}

/// Takes meaning and modality from one of our own files, else judges the meaning from the samples.
void take_meaning(const itk::ImageIOBase& io, const VolumeHeader& header, Scene& scene) {
  std::string meaning = header.field(meaning_key).value_or("");
  scene.modality = header.field(modality_key).value_or("");
  if (const std::string text = entry_of(io, nifti_text_key).value_or(""); text.starts_with(nifti_mark)) {
    const std::string rest = text.substr(nifti_mark.size());
    const std::size_t gap = rest.find(' ');
    meaning = rest.substr(0, gap);
    if (gap != std::string::npos) scene.modality = trimmed(rest.substr(gap));
  }
  if (meaning == "HU" || meaning == "raw" || meaning == "label") {
    scene.meaning = meaning == "HU" ? Meaning::Hounsfield : meaning == "raw" ? Meaning::Raw : Meaning::Label;
    scene.audit.push_back({"unit", Verdict::Pass, "the file names its values' unit: " + meaning});
    return;
  }
  const AirLevel air = air_level_of_unnamed(scene);
  scene.meaning = air.meaning;
  scene.audit.push_back(air.finding);
}

const char* word_of(Meaning meaning) {
  return meaning == Meaning::Hounsfield ? "HU" : meaning == Meaning::Raw ? "raw" : "label";
}

/// Whether the axes are perpendicular up to the rounding of single precision. Readers of NIfTI and MetaImage
/// take direction cosines for a rotation or reflection.
bool is_perpendicular(const Lattice& lattice) {
  const glm::dvec3 spacing_mm = lattice.spacing_mm();
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < a; ++b)
      if (std::abs(glm::dot(glm::dvec3(lattice.lps_from_voxel[a]), glm::dvec3(lattice.lps_from_voxel[b]))) >
          4.0 * static_cast<double>(std::numeric_limits<float>::epsilon()) * spacing_mm[a] * spacing_mm[b])
        return false;
  return true;
}

/// A NIfTI extension with the lattice's geometry: its length, its code and the text.
std::string nifti_extension(const Lattice& lattice) {
  std::string text(nifti_geometry_mark);
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) {
      char number[40];
      std::snprintf(number, sizeof number, "%.17g ", lattice.lps_from_voxel[column][row]);
      text += number;
    }
  text.resize((text.size() + 8 + 15) / 16 * 16 - 8, ' ');
  const std::int32_t head[2] = {static_cast<std::int32_t>(text.size() + 8), nifti_text_extension};
  return std::string(reinterpret_cast<const char*>(head), sizeof head) + text;
}

/// The beginning of our own .nii file: ITK's header with a description, which ITK leaves empty, and the
/// extension.
std::string nifti_beginning(std::string header, const Scene& scene) {
  constexpr std::size_t description_at = 148;  // NIfTI-1 header, 80 bytes
  constexpr std::size_t description_bytes = 80;
  constexpr std::size_t samples_at = 108;
  constexpr std::size_t extended_at = 348;
  std::string text = std::string(nifti_mark) + word_of(scene.meaning) + " " + scene.modality;
  text.resize(description_bytes - 1);
  header.replace(description_at, text.size(), text);
  const std::string extension = nifti_extension(scene.lattice);
  const auto offset = static_cast<float>(header.size() + extension.size());
  header.replace(samples_at, sizeof offset, reinterpret_cast<const char*>(&offset), sizeof offset);
  header[extended_at] = 1;
  return header + extension;
}

/// Copies ITK's file with our beginning. Packs it at zlib's fastest level: four times as fast as ITK's NIfTI
/// writer, whose level is fixed, and a few per cent larger.
void finish_nifti(const fs::path& from, const fs::path& to, const Scene& scene) {
  constexpr std::size_t header_bytes = 352;
  std::ifstream in = opened(from);
  std::string part(header_bytes, '\0');
  in.read(part.data(), static_cast<std::streamsize>(part.size()));
  bool written = static_cast<bool>(in);
  part = nifti_beginning(std::move(part), scene);
  // "T": unpacked.
  errno = 0;
  const gzFile out = gzopen(to.c_str(), extension_of(to) == ".gz" ? "wb1" : "wbT");
  written = written && out != nullptr;
  while (written && !part.empty()) {
    written = gzwrite(out, part.data(), static_cast<unsigned>(part.size())) == static_cast<int>(part.size());
    part.resize(std::size_t{1} << 20);
    in.read(part.data(), static_cast<std::streamsize>(part.size()));
    part.resize(static_cast<std::size_t>(in.gcount()));
  }
  if (out != nullptr) written = gzclose(out) == Z_OK && written;
  if (!written) refuse_unwritten(to, errno);
  fs::remove(from);
}

/// Bound on the shift of a lattice's corner by single precision: eight roundings, of the steps, the origin
/// and the operations between quaternion and matrix.
double single_precision_mm(const Lattice& lattice) {
  const glm::dvec3 extent_mm = lattice.spacing_mm() * glm::dvec3(lattice.dims);
  return 8.0 * static_cast<double>(std::numeric_limits<float>::epsilon()) *
         (glm::length(extent_mm) + glm::length(glm::dvec3(lattice.lps_from_voxel[3])));
}

/// Takes the double-precision geometry of our own NIfTI files if the header still agrees with it.
void take_exact_geometry(const VolumeHeader& header, Scene& scene) {
  if (!header.lps_from_voxel) return;
  const Lattice exact{scene.lattice.dims, *header.lps_from_voxel};
  double worst_mm = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 p_voxel =
        glm::dvec3(corner & 1, (corner >> 1) & 1, corner >> 2) * glm::dvec3(exact.dims - 1);
    worst_mm = std::max(worst_mm, glm::distance(exact.lps_mm(p_voxel), scene.lattice.lps_mm(p_voxel)));
  }
  if (worst_mm <= single_precision_mm(exact)) {
    scene.lattice = exact;
    return;
  }
  scene.audit.push_back({"geometry", Verdict::Warn,
                         "the header was changed since it was written: its positions are used, not the older "
                         "ones in double precision"});
}

}  // namespace

Scene read_volume_file(const fs::path& path, VolumeFormat format, const SlicesFinal& slices_final) {
  const VolumeHeader header = read_volume_header(path, format);
  const itk::ImageIOBase::Pointer io = new_io(format);
  io->SetFileName(path.string());
  call_itk(path, format, "its header cannot be read", [&] { io->ReadImageInformation(); });
  Scene scene;
  scene.source = path.string();
  call_itk(path, format, "its header cannot be read",
           [&] { scene.lattice = lattice_of(*io, path, header.most_bytes); });
  take_exact_geometry(header, scene);
  const std::uintmax_t sample_bytes = header.sample_bytes > 0 ? header.sample_bytes : io->GetComponentSize();
  if (!header.is_plain) require_samples(path, format, header, scene.lattice.sample_count() * sample_bytes);
  need_memory(path, scene.lattice.sample_count(), sample_bytes + sizeof(std::int16_t));
  itk::ImageIORegion region(io->GetNumberOfDimensions());
  for (unsigned axis = 0; axis < io->GetNumberOfDimensions(); ++axis)
    region.SetSize(axis, io->GetDimensions(axis));
  io->SetIORegion(region);
  call_itk(path, format, "its samples cannot be read", [&] {
    read_samples({path, format, header, *io, slices_final}, scene);
  });
  audit_frame(*io, format, header, scene);
  take_meaning(*io, header, scene);
  return scene;
}

void write_volume_file(const Scene& scene, const fs::path& path, VolumeFormat format) {
  if (format != VolumeFormat::Nrrd && !is_perpendicular(scene.lattice))
    throw std::invalid_argument(std::string(name_of(format)) +
                                " cannot store axes that are not perpendicular; write .nrrd");
  const itk::ImageIOBase::Pointer io = new_io(format);
  const fs::path written =
      format == VolumeFormat::Nifti ? path.parent_path() / (path.filename().string() + ".by_itk.nii") : path;
  io->SetFileName(written.string());
  io->SetNumberOfDimensions(3);
  io->SetNumberOfComponents(1);
  io->SetPixelType(itk::IOPixelEnum::SCALAR);
  const bool is_int16 = std::holds_alternative<Int16Samples>(scene.samples);
  io->SetComponentType(is_int16 ? itk::IOComponentEnum::SHORT : itk::IOComponentEnum::FLOAT);
  const glm::dvec3 spacing_mm = scene.lattice.spacing_mm();
  itk::ImageIORegion region(3);
  for (int axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<unsigned>(axis);
    io->SetDimensions(i, static_cast<std::size_t>(scene.lattice.dims[axis]));
    region.SetSize(i, static_cast<std::size_t>(scene.lattice.dims[axis]));
    io->SetSpacing(i, spacing_mm[axis]);
    io->SetOrigin(i, scene.lattice.lps_from_voxel[3][axis]);
    const glm::dvec3 direction = glm::dvec3(scene.lattice.lps_from_voxel[axis]) / spacing_mm[axis];
    io->SetDirection(i, std::vector<double>{direction.x, direction.y, direction.z});
  }
  io->SetIORegion(region);
  io->SetUseCompression(true);
  io->SetCompressionLevel(1);  // scans are noise: higher levels cost time and gain a few per cent
  itk::MetaDataDictionary& dictionary = io->GetMetaDataDictionary();
  if (format != VolumeFormat::Nifti) {
    itk::EncapsulateMetaData<std::string>(dictionary, meaning_key, word_of(scene.meaning));
    if (!scene.modality.empty())
      itk::EncapsulateMetaData<std::string>(dictionary, modality_key, scene.modality);
  }
  call_itk(path, format, "cannot be written",
           [&] { std::visit([&](const auto& samples) { io->Write(samples.data()); }, scene.samples); });
  if (format == VolumeFormat::Nifti) finish_nifti(written, path, scene);
}

}  // namespace octotomy::voxel
