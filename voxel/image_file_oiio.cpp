// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/image_file_oiio.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <exception>

extern "C" bool octotomy_encode_image(const char* format, int width, int height, const std::uint8_t* rgb,
                                      std::vector<std::uint8_t>* encoded, std::string* error) {
  try {
    OIIO::ImageSpec spec(width, height, 3, OIIO::TypeDesc::UINT8);
    spec.attribute("oiio:ColorSpace", "sRGB");
    const std::string name = format;
    if (name == "png")
      spec.attribute("png:compressionLevel", 3);  // a tenth larger than the best, in a third of the time
    else
      spec.attribute("Compression", name + ":92");
    const std::unique_ptr<OIIO::ImageOutput> out = OIIO::ImageOutput::create(name);
    OIIO::Filesystem::IOVecOutput memory(*encoded);
    if (!out || !out->supports("ioproxy")) {
      *error = "OpenImageIO cannot write '" + name + "' to memory";
      OIIO::geterror();
      return false;
    }
    if (out->set_ioproxy(&memory) && out->open("image." + name, spec) &&
        out->write_image(OIIO::TypeDesc::UINT8, rgb) && out->close())
      return true;
    *error = out->geterror();
  } catch (const std::exception& failure) {
    *error = failure.what();
  }
  return false;
}
