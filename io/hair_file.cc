// Cem Yuksel's HAIR format (http://www.cemyuksel.com/research/hairmodels).
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>

#include "io/groom_file.h"
#include "io/little_endian.h"
#include "io/strand_edit.h"

namespace strandcast {
namespace {

constexpr uint32_t kHeaderBytes = 128, kDefaultThicknessAt = 20;
// Defaults as encodeHair() writes them.
constexpr float kDefaultThickness = 1, kDefaultTransparency = 0, kDefaultColour = 0.5f;
enum ArrayBits : uint32_t { kSegments = 1, kPoints = 2, kThickness = 4, kTransparency = 8, kColours = 16 };

/// Counts of the header and the offsets of arrays that follow from its bits.
struct HairHeader {
  uint32_t strands = 0;
  uint32_t points = 0;
  uint32_t arrays = 0;
  uint32_t default_segments = 0;
  uint64_t segments_at = 0, points_at = 0, thickness_at = 0;
};

HairHeader readHeader(const ByteReader& reader) {
  if (reader.at<std::array<char, 4>>(0) != std::array<char, 4>{'H', 'A', 'I', 'R'})
    reader.fail("this is not a .hair file (it does not start with HAIR)", 0,
                "check the file and its extension");
  reader.require(0, kHeaderBytes, 1, "header");
  HairHeader header;
  header.strands = reader.at<uint32_t>(4);
  header.points = reader.at<uint32_t>(8);
  header.arrays = reader.at<uint32_t>(12);
  header.default_segments = reader.at<uint32_t>(16);
  if (header.strands == 0) reader.fail("the file has no strands", 4);
  if (header.points == 0) reader.fail("the file has no points", 8);
  if (!(header.arrays & kPoints)) reader.fail("the file has no array of points", 12);

  uint64_t offset = kHeaderBytes;
  const auto array = [&](uint32_t bit, uint64_t count, uint64_t element_bytes, const char* what) {
    const uint64_t start = offset;
    if (!(header.arrays & bit)) return start;
    reader.require(offset, count, element_bytes, what);
    offset += count * element_bytes;
    return start;
  };
  header.segments_at = array(kSegments, header.strands, 2, "segment counts");
  header.points_at = array(kPoints, header.points, 12, "points");
  header.thickness_at = array(kThickness, header.points, 4, "thickness");
  array(kTransparency, header.points, 4, "transparency");
  array(kColours, header.points, 12, "colours");
  return header;
}

/// Converts segment counts to offsets. Their sum must be the header's number of points.
void readOffsets(const ByteReader& reader, const HairHeader& header, StrandSet& strands) {
  const bool has_segments = (header.arrays & kSegments) != 0;
  // Each strand has a point, so this bounds the memory by the points that the file holds.
  if (header.strands > header.points)
    reader.fail(fmt::format("{} strands cannot share {} points", header.strands, header.points), 4);
  strands.offsets.reserve(size_t{header.strands} + 1);
  uint64_t points = 0;
  for (uint32_t s = 0; s < header.strands; ++s) {
    const uint64_t at = has_segments ? header.segments_at + uint64_t{2} * s : 16;
    points += 1 + uint64_t{has_segments ? reader.at<uint16_t>(at) : header.default_segments};
    if (points > header.points)
      reader.fail(
          fmt::format("the segment counts ask for more than the {} points of the header", header.points), at);
    strands.offsets.push_back(static_cast<uint32_t>(points));
  }
  if (points != header.points)
    reader.fail(
        fmt::format("the segment counts add up to {} points, the header says {}", points, header.points), 8);
}

void readPoints(const ByteReader& reader, const HairHeader& header, StrandSet& strands) {
  strands.positions.resize(header.points);
  reader.copy<std::array<float, 3>>(header.points_at, header.points, strands.positions.data(), "points");
}

bool isThickness(float value) { return value >= 0 && std::isfinite(value); }

/// Replaces an invalid thickness by the header's default, or by 0 where the default is invalid, too.
void readThickness(const ByteReader& reader, const HairHeader& header, StrandSet& strands,
                   FileReport& report) {
  if (!(header.arrays & kThickness)) return;
  const auto standard = reader.at<float>(kDefaultThicknessAt);
  strands.radii.resize(header.points);
  size_t mended = 0;
  for (size_t i = 0; i < strands.radii.size(); ++i) {
    auto thickness = reader.at<float>(header.thickness_at + uint64_t{4} * i);
    if (!isThickness(thickness)) {
      thickness = isThickness(standard) ? standard : 0;
      ++mended;
    }
    strands.radii[i] = thickness / 2;
  }
  if (mended > 0)
    report.warnings.push_back(fmt::format("{} of the thicknesses are negative or not finite: {} for them",
                                          mended,
                                          isThickness(standard) ? "the file's default stands" : "0 stands"));
}

/// Reports unread arrays, and defaults of absent arrays that differ from those encodeHair() writes.
FileReport reportOn(const ByteReader& reader, const HairHeader& header) {
  FileReport out;
  const auto has = [&](uint32_t bit) { return (header.arrays & bit) != 0; };
  const auto differs = [&](uint64_t at, float from) { return reader.at<float>(at) != from; };
  if (has(kTransparency)) out.addOmission("transparency");
  if (has(kColours)) out.addOmission("colours");
  if (const auto thickness = reader.at<float>(kDefaultThicknessAt); !isThickness(thickness))
    out.addOmission(fmt::format("the default thickness, which is {:g}", thickness));
  else if (!has(kThickness) && thickness != kDefaultThickness)
    out.addOmission("default thickness");
  if (!has(kTransparency) && differs(24, kDefaultTransparency)) out.addOmission("default transparency");
  if (!has(kColours) &&
      (differs(28, kDefaultColour) || differs(32, kDefaultColour) || differs(36, kDefaultColour)))
    out.addOmission("default colour");
  return out;
}

}  // namespace

RawGroom readHair(std::span<const std::byte> bytes, const std::string& name) {
  const ByteReader reader(bytes, name);
  if (bytes.empty()) reader.fail("the file is empty", 0);
  const HairHeader header = readHeader(reader);
  RawGroom groom;
  groom.format = "hair";
  groom.native_up = UpAxis::kZ;
  readOffsets(reader, header, groom.strands);
  readPoints(reader, header, groom.strands);
  groom.report = reportOn(reader, header);
  readThickness(reader, header, groom.strands, groom.report);
  removeNonFinite(groom.strands, groom.report, reader.where(header.points_at));
  return groom;
}

std::vector<std::byte> encodeHair(const StrandSet& strands, const std::string& name) {
  if (strands.strands() == 0)
    throw Error("there are no strands to write", name, "choose a groom with strands");
  const size_t first_count = strands.verticesOf(0);
  bool equal = true;
  for (size_t s = 0; s < strands.strands(); ++s) {
    const size_t count = strands.verticesOf(s);
    if (count == 0 || count > 65536)
      throw Error(fmt::format("strand {} has {} vertices, a .hair file holds 1 to 65536", s, count), name,
                  "resample the groom (--vertices)");
    equal = equal && count == first_count;
  }
  const bool has_radii = strands.radii.size() == strands.vertices();

  ByteWriter writer;
  writer.reserve(kHeaderBytes + 2 * strands.strands() + 16 * strands.vertices());
  writer.raw("HAIR", 4);
  writer.put(static_cast<uint32_t>(strands.strands()));
  writer.put(static_cast<uint32_t>(strands.vertices()));
  writer.put(static_cast<uint32_t>(kPoints | (equal ? 0u : kSegments) | (has_radii ? kThickness : 0u)));
  writer.put(equal ? static_cast<uint32_t>(first_count - 1) : uint32_t{0});
  writer.put(kDefaultThickness);
  writer.put(kDefaultTransparency);
  for (int channel = 0; channel < 3; ++channel) writer.put(kDefaultColour);
  std::array<char, 88> info{};
  constexpr char kInfo[] = "written by Strandcast";
  std::copy(std::begin(kInfo), std::end(kInfo), info.begin());
  writer.raw(info.data(), info.size());
  if (!equal)
    for (size_t s = 0; s < strands.strands(); ++s)
      writer.put(static_cast<uint16_t>(strands.verticesOf(s) - 1));
  for (const Vec3& point : strands.positions) writer.put(point);
  if (has_radii)
    for (const float radius : strands.radii) writer.put(radius * 2);
  return writer.take();
}

}  // namespace strandcast
