#include "light/path_film.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>

#include "core/error.h"
#include "core/srgb.h"
#include "io/file_bytes.h"
#include "kernels/scalar_picture.h"

namespace strandcast {
namespace {

/// The head of a saved film; its pixels follow.
struct FilmHead {
  std::array<char, 8> magic;
  uint64_t content;
  uint32_t width, height, goal, pixel_bytes;
};
constexpr std::array<char, 8> kFilmMagic{'s', 'c', 'f', 'i', 'l', 'm', '0', '1'};

}  // namespace

uint64_t PathFilm::allSamples() const {
  uint64_t sum = 0;
  for (const Pixel& pixel : pixels_) sum += pixel.samples;
  return sum;
}

void PathFilm::add(size_t pixel, const PathSample& sample) {
  Pixel& p = pixels_[pixel];
  const Eigen::Array3d all = sample.seen + sample.single + sample.multiple;
  for (int c = 0; c < 3; ++c) {
    p.halves[p.samples % 2][c] += all[c];
    p.single[c] += sample.single[c];
    p.multiple[c] += sample.multiple[c];
  }
  p.depth += sample.depth;
  p.hits += sample.depth > 0;
  p.hair += sample.hair;
  ++p.samples;
}

Eigen::Array3d PathFilm::radiance(size_t pixel) const {
  const Pixel& p = pixels_[pixel];
  const double share = p.samples > 0 ? 1.0 / p.samples : 0;
  return {(p.halves[0][0] + p.halves[1][0]) * share, (p.halves[0][1] + p.halves[1][1]) * share,
          (p.halves[0][2] + p.halves[1][2]) * share};
}

double PathFilm::relativeError() const {
  double squares = 0, sum = 0, entries = 0;
  for (size_t i = 0; i < pixels_.size(); ++i) {
    const Pixel& p = pixels_[i];
    if (p.samples < 2) return std::numeric_limits<double>::infinity();
    if (p.hits == 0) continue;
    const double evens = (p.samples + 1) / 2, odds = p.samples / 2;  // NOLINT(bugprone-integer-division)
    for (int c = 0; c < 3; ++c) {
      // The mean weighs each half by its samples; so does the difference that estimates its error.
      const double weight = std::sqrt(evens * odds) / p.samples;
      const double difference = weight * (p.halves[0][c] / evens - p.halves[1][c] / odds);
      squares += difference * difference;
    }
    sum += radiance(i).sum();
    entries += 3;
  }
  return sum > 0 ? std::sqrt(squares / entries) / (sum / entries) : 0;
}

FloatImage PathFilm::image() const {
  constexpr std::array<const char*, 12> kNames{"R",          "G",        "B",          "single.R",
                                               "single.G",   "single.B", "multiple.R", "multiple.G",
                                               "multiple.B", "Z",        "hair",       "spp"};
  FloatImage image{width_, height_, {}, {}};
  for (const char* name : kNames) image.channels.push_back({name, std::vector<float>(pixels_.size())});
  for (size_t i = 0; i < pixels_.size(); ++i) {
    const Pixel& p = pixels_[i];
    const double share = p.samples > 0 ? 1.0 / p.samples : 0;
    const Eigen::Array3d all = radiance(i);
    for (size_t c = 0; c < 3; ++c) {
      image.channels[c].values[i] = static_cast<float>(all[static_cast<int>(c)]);
      image.channels[3 + c].values[i] = static_cast<float>(p.single[c] * share);
      image.channels[6 + c].values[i] = static_cast<float>(p.multiple[c] * share);
    }
    image.channels[9].values[i] =
        p.hits > 0 ? static_cast<float>(p.depth / p.hits) : std::numeric_limits<float>::infinity();
    image.channels[10].values[i] = static_cast<float>(p.hair * share);
    image.channels[11].values[i] = static_cast<float>(p.samples);
  }
  return image;
}

Image PathFilm::developed(const Eigen::Array3f& gains) const {
  Image image{width_, height_, {}};
  image.rgb.reserve(3 * pixels_.size());
  for (size_t i = 0; i < pixels_.size(); ++i) {
    const Eigen::Array3f r = radiance(i).cast<float>();
    const kernels::f32::real3 shown =
        kernels::f32::toneMappedBy({gains[0], gains[1], gains[2]}, {r[0], r[1], r[2]});
    for (const float value : {shown.x, shown.y, shown.z})
      image.rgb.push_back(static_cast<uint8_t>(std::lround(255 * srgbOf(std::clamp(value, 0.0f, 1.0f)))));
  }
  return image;
}

void PathFilm::save(const std::filesystem::path& file, uint64_t content, uint32_t goal) const {
  const FilmHead head{kFilmMagic,
                      content,
                      static_cast<uint32_t>(width_),
                      static_cast<uint32_t>(height_),
                      goal,
                      static_cast<uint32_t>(sizeof(Pixel))};
  std::vector<std::byte> bytes(sizeof head + pixels_.size() * sizeof(Pixel));
  std::memcpy(bytes.data(), &head, sizeof head);
  std::memcpy(bytes.data() + sizeof head, pixels_.data(), bytes.size() - sizeof head);
  writeFileBytes(file, bytes);
}

uint32_t PathFilm::restore(const std::filesystem::path& file, uint64_t content) {
  std::ifstream in(file, std::ios::binary);
  FilmHead head{};
  std::vector<Pixel> pixels(pixels_.size());
  if (!in.read(reinterpret_cast<char*>(&head), sizeof head) || head.magic != kFilmMagic)
    throw Error("this is no checkpoint of a picture", file.string(), "remove it, or leave out --resume");
  if (head.content != content || head.width != static_cast<uint32_t>(width_) ||
      head.height != static_cast<uint32_t>(height_) || head.pixel_bytes != sizeof(Pixel))
    throw Error("the checkpoint is of another picture", file.string(),
                "give the options that it was made with, or leave out --resume");
  if (!in.read(reinterpret_cast<char*>(pixels.data()),
               static_cast<std::streamsize>(pixels.size() * sizeof(Pixel))) ||
      in.peek() != std::ifstream::traits_type::eof())
    throw Error("the checkpoint is damaged", file.string(), "leave out --resume");
  pixels_ = std::move(pixels);
  return head.goal;
}

}  // namespace strandcast
