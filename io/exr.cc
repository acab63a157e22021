#include "io/exr.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfTestFile.h>

#include <exception>
#include <fstream>

#include "core/error.h"

namespace strandcast {
namespace {

constexpr int64_t kMaxExrPixels = int64_t{1} << 28;

std::string exrSize(int width, int height) { return std::to_string(width) + " x " + std::to_string(height); }

}  // namespace

const std::vector<float>* FloatImage::find(const std::string& name) const {
  for (const Channel& channel : channels)
    if (channel.name == name) return &channel.values;
  return nullptr;
}

void writeExr(const std::filesystem::path& file, const FloatImage& image) {
  const std::string size = exrSize(image.width, image.height);
  if (image.width < 1 || image.height < 1)
    throw Error("a picture without pixels cannot be written", file.string(), "its size is " + size);
  const size_t pixels = static_cast<size_t>(image.width) * static_cast<size_t>(image.height);
  Imf::Header header(image.width, image.height);
  header.compression() = Imf::ZIP_COMPRESSION;
  for (const auto& [name, text] : image.attributes) header.insert(name, Imf::StringAttribute(text));
  Imf::FrameBuffer buffer;
  for (const FloatImage::Channel& channel : image.channels) {
    if (channel.values.size() != pixels)
      throw Error("a channel does not have the picture's size", file.string() + ", " + channel.name,
                  std::to_string(channel.values.size()) + " values, not " + size);
    header.channels().insert(channel.name, Imf::Channel(Imf::FLOAT));
    // The library takes a pointer that is not const; writing does not change what it points to.
    auto* first = reinterpret_cast<char*>(const_cast<float*>(channel.values.data()));
    buffer.insert(channel.name, Imf::Slice(Imf::FLOAT, first, sizeof(float),
                                           sizeof(float) * static_cast<size_t>(image.width)));
  }
  std::filesystem::path part = file;
  part += ".part";
  std::error_code failed;
  try {
    Imf::OutputFile out(part.c_str(), header);
    out.setFrameBuffer(buffer);
    out.writePixels(image.height);
  } catch (const std::exception& error) {
    std::filesystem::remove(part, failed);
    throw Error("the OpenEXR file cannot be written", file.string(), error.what());
  }
  std::filesystem::rename(part, file, failed);
  if (failed) throw Error("the OpenEXR file cannot be written", file.string(), failed.message());
}

FloatImage readExr(const std::filesystem::path& file) {
  std::error_code failed;
  if (!std::filesystem::is_regular_file(file, failed) || !std::ifstream(file))
    throw Error("the OpenEXR file cannot be read", file.string(), "does it exist?");
  FloatImage image;
  try {
    if (!Imf::isOpenExrFile(file.c_str()))
      throw Error("this is no OpenEXR file", file.string(), "give an .exr file");
    if (Imf::isDeepOpenExrFile(file.c_str()))
      throw Error("the OpenEXR file holds deep data", file.string(), "flatten it");
    Imf::InputFile in(file.c_str());
    const Imath::Box2i window = in.header().dataWindow();
    const int64_t width = int64_t{window.max.x} - window.min.x + 1,
                  height = int64_t{window.max.y} - window.min.y + 1;
    if (width < 1 || height < 1 || width > kMaxExrPixels / height)
      throw Error("the OpenEXR file is too large", file.string(),
                  std::to_string(width) + " x " + std::to_string(height) + " pixels");
    image.width = static_cast<int>(width);
    image.height = static_cast<int>(height);
    Imf::FrameBuffer buffer;
    const Imf::ChannelList& list = in.header().channels();
    for (auto c = list.begin(); c != list.end(); ++c)
      if (c.channel().xSampling == 1 && c.channel().ySampling == 1)
        image.channels.push_back(
            {c.name(), std::vector<float>(static_cast<size_t>(width) * static_cast<size_t>(height))});
    for (FloatImage::Channel& channel : image.channels)
      buffer.insert(channel.name, Imf::Slice::Make(Imf::FLOAT, channel.values.data(), window, sizeof(float),
                                                   sizeof(float) * static_cast<size_t>(width)));
    in.setFrameBuffer(buffer);
    in.readPixels(window.min.y, window.max.y);
    for (auto a = in.header().begin(); a != in.header().end(); ++a)
      if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&a.attribute()))
        image.attributes[a.name()] = text->value();
  } catch (const Error&) {
    throw;
  } catch (const std::exception& error) {
    throw Error("the OpenEXR file is damaged", file.string(), error.what());
  }
  return image;
}

}  // namespace strandcast
