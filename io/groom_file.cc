#include "io/groom_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "core/error.h"
#include "io/axes_and_units.h"
#include "io/file_bytes.h"

namespace strandcast {
namespace {

template <class T>
bool startsWith(std::span<const std::byte> bytes, const T& start) {
  return bytes.size() >= sizeof(T) && std::memcmp(bytes.data(), &start, sizeof(T)) == 0;
}

}  // namespace

RawGroom readRawGroom(const std::filesystem::path& file) {
  const std::vector<std::byte> bytes = readFileBytes(file);
  const std::string name = file.string();
  const std::string extension = lowerExtension(file);
  // The content of a file takes precedence over its extension.
  if (startsWith(bytes, std::array<char, 4>{'H', 'A', 'I', 'R'})) return readHair(bytes, name);
  if (startsWith(bytes, 3.0f) || startsWith(bytes, 4.0f)) return readTfx(bytes, name);
  if (extension == ".tfx") return readTfx(bytes, name);
  if (extension == ".hair") return readHair(bytes, name);
  if (extension == ".obj") return readObjStrands(bytes, name);
  const bool usd = startsWith(bytes, std::array<char, 5>{'#', 'u', 's', 'd', 'a'});
  if (usd || extension == ".usda" || extension == ".usd" || extension == ".usdc" || extension == ".usdz")
    return readUsda(bytes, name);
  throw Error("this is no known groom format", name + ", byte 0", "use .tfx, .hair, .obj or .usda");
}

std::string defaultUnitWarning(const RawGroom& raw) {
  if (!raw.unit_is_default) return {};
  return fmt::format(
      "metersPerUnit is not given: by the USD specification a unit is {:g} m then; give --unit-meters if it "
      "is "
      "another",
      raw.unit_meters);
}

void writeGroom(const std::filesystem::path& file, const StrandSet& strands, UpAxis up, float unit_meters,
                std::span<const StrandGroup> groups) {
  const std::string extension = lowerExtension(file);
  StrandSet turned = strands;
  rotateToYUp(turned.positions, up);
  if (extension == ".tfx") return writeFileBytes(file, encodeTfx(turned, file.string()));
  if (extension == ".usda")
    return writeFileBytes(file, encodeUsda(turned, unit_meters, file.string(), groups));
  rotateToZUp(turned.positions);
  if (extension == ".hair") return writeFileBytes(file, encodeHair(turned, file.string()));
  throw Error("grooms cannot be written in this format", file.string(), "use .tfx, .hair or .usda");
}

std::vector<std::string> omissionsOf(const std::filesystem::path& file, const StrandSet& strands) {
  const std::string extension = lowerExtension(file);
  const bool tfx = extension == ".tfx", usda = extension == ".usda";
  bool pins = false;
  for (size_t s = 0; s < strands.strands(); ++s)
    for (size_t i = 2; i < strands.verticesOf(s); ++i) pins = pins || strands.isPinned(s, i);
  std::vector<std::string> out;
  if (pins && !tfx) out.emplace_back("pins");
  if (!strands.uvs.empty() && !tfx && !usda) out.emplace_back("UVs");
  if (!strands.radii.empty() && tfx) out.emplace_back("radii");
  if (!strands.is_guide.empty() && !usda) out.emplace_back("guide marks");
  if (!strands.ids.empty() && !usda) out.emplace_back("ids");
  if (!strands.groups.empty() && !usda) out.emplace_back("groups");
  if (!strands.colours.empty() && !usda) out.emplace_back("colours");
  return out;
}

}  // namespace strandcast
