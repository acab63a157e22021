// TressFX .tfx, versions 3 and 4 (AMD TressFX 3.x and 4.x, TressFXFileFormat.h).
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "io/groom_file.h"
#include "io/little_endian.h"
#include "io/strand_edit.h"

namespace strandcast {
namespace {

constexpr uint32_t kHeaderBytes3 = 296;
constexpr uint32_t kHeaderBytes4 = 160;

/// Common contents of the headers of both versions.
struct TfxHeader {
  int version = 4;
  uint32_t header_bytes = kHeaderBytes4;
  uint32_t strands = 0;
  uint32_t vertices_per_strand = 0;
  bool both_ends_immovable = false;
  uint32_t positions = 0;   ///< byte offset
  uint32_t strand_uvs = 0;  ///< byte offset, 0 = none
  FileReport report;        ///< as RawGroom's
  uint64_t vertices() const { return uint64_t{strands} * vertices_per_strand; }
};

/// Reads an offset: 0 (none), or a position between the header and the end of the file.
uint32_t offsetField(const ByteReader& reader, uint64_t field, uint32_t header_bytes) {
  const auto offset = reader.at<uint32_t>(field);
  if (offset != 0 && (offset < header_bytes || offset > reader.size()))
    reader.fail(fmt::format("an array's offset is {}, outside the data between {} and {}", offset,
                            header_bytes, reader.size()),
                field);
  return offset;
}

TfxHeader readTfxHeader(const ByteReader& reader) {
  TfxHeader header;
  const auto version = reader.at<float>(0);
  if (version != 3.0f && version != 4.0f)
    reader.fail(fmt::format("this is not a .tfx file of version 3 or 4 (it starts with {})", version), 0,
                "export it as TressFX 3 or 4");
  header.version = static_cast<int>(version);
  header.header_bytes = header.version == 3 ? kHeaderBytes3 : kHeaderBytes4;
  reader.require(0, header.header_bytes, 1, "header");
  header.strands = reader.at<uint32_t>(4);
  header.vertices_per_strand = reader.at<uint32_t>(8);
  // Thickness, colours and vertex UVs are not used, but an offset outside the file still means damage.
  if (header.version == 3) {
    const auto both_ends = reader.at<uint32_t>(16);
    header.both_ends_immovable = both_ends != 0;
    if (both_ends > 1)
      header.report.warnings.push_back(
          fmt::format("its flag of both ends immovable is {}: it is taken as set", both_ends));
    header.positions = offsetField(reader, 144, kHeaderBytes3);
    uint32_t others = 0;
    for (uint64_t field : {148, 156, 160, 164}) others |= offsetField(reader, field, kHeaderBytes3);
    header.strand_uvs = offsetField(reader, 152, kHeaderBytes3);
    if (others != 0) header.report.addOmission("vertex UVs, thickness or colours");
  } else {
    header.positions = offsetField(reader, 12, kHeaderBytes4);
    header.strand_uvs = offsetField(reader, 16, kHeaderBytes4);
    for (const auto& [field, what] : {std::pair{20, "vertex UVs"}, {24, "thickness"}, {28, "colours"}})
      if (offsetField(reader, static_cast<uint64_t>(field), kHeaderBytes4) != 0)
        header.report.addOmission(what);
  }
  return header;
}

void checkCounts(const ByteReader& reader, const TfxHeader& header) {
  if (header.strands == 0) reader.fail("the file has no strands", 4);
  if (header.vertices_per_strand == 0) reader.fail("the strands have no vertices", 8);
  if (header.positions == 0) reader.fail("the file has no positions", header.version == 3 ? 144 : 12);
  const uint64_t vertex_bytes = header.version == 3 ? 12 : 16;
  if (header.vertices() > (reader.size() - header.positions) / vertex_bytes ||
      header.vertices() > std::numeric_limits<uint32_t>::max())
    reader.fail(fmt::format("{} strands of {} vertices do not fit into the {} bytes behind the header",
                            header.strands, header.vertices_per_strand, reader.size() - header.positions),
                4);
}

void readPositions3(const ByteReader& reader, const TfxHeader& header, StrandSet& strands) {
  strands.positions.resize(header.vertices());
  static_assert(sizeof(Vec3) == 12);
  reader.copy<std::array<float, 3>>(header.positions, header.vertices(), strands.positions.data(),
                                    "positions");
}

/// The w of a position is an inverse mass. Exporters write 0 (pinned) and 1 (free).
void readPositions4(const ByteReader& reader, const TfxHeader& header, StrandSet& strands,
                    FileReport& report) {
  size_t others = 0, mended = 0;
  strands.positions.resize(header.vertices());
  strands.pinned.resize(header.vertices());
  for (size_t i = 0; i < strands.vertices(); ++i) {
    const uint64_t offset = header.positions + uint64_t{16} * i;
    const auto vertex = reader.at<std::array<float, 4>>(offset, "positions");
    strands.positions[i] = Vec3(vertex[0], vertex[1], vertex[2]);
    strands.pinned[i] = vertex[3] == 0 ? 1 : 0;
    const bool is_mass = vertex[3] >= 0 && std::isfinite(vertex[3]);
    mended += is_mass ? 0 : 1;
    others += is_mass && vertex[3] != 0 && vertex[3] != 1 ? 1 : 0;
  }
  if (others > 0) report.addOmission("inverse masses (w) other than 0 and 1");
  if (mended > 0)
    report.warnings.push_back(fmt::format(
        "{} of the inverse masses (w) are negative or not finite: their vertices are taken as free", mended));
}

/// Version 3 stores no masses. Its loader pins the first two vertices of each strand, and the last two if the
/// header says that both ends are immovable.
void pinByConvention(const TfxHeader& header, StrandSet& strands) {
  strands.pinned.assign(strands.vertices(), 0);
  const uint32_t count = header.vertices_per_strand;
  for (size_t s = 0; s < strands.strands(); ++s) {
    uint8_t* pinned = strands.pinned.data() + strands.offsets[s];
    for (uint32_t i = 0; i < std::min(count, 2u); ++i) {
      pinned[i] = 1;
      if (header.both_ends_immovable) pinned[count - 1 - i] = 1;
    }
  }
}

void readStrandUvs(const ByteReader& reader, const TfxHeader& header, StrandSet& strands,
                   FileReport& report) {
  if (header.strand_uvs == 0) return;
  reader.require(header.strand_uvs, header.strands, 8, "strand UVs");
  strands.uvs.resize(header.strands);
  size_t mended = 0;
  for (size_t s = 0; s < strands.uvs.size(); ++s) {
    const uint64_t offset = header.strand_uvs + uint64_t{8} * s;
    strands.uvs[s] = Vec2(reader.at<float>(offset), reader.at<float>(offset + 4));
    if (strands.uvs[s].allFinite()) continue;
    strands.uvs[s] = Vec2::Zero();
    ++mended;
  }
  if (mended > 0)
    report.warnings.push_back(fmt::format("{} of the strand UVs are not finite: 0 stands for them", mended));
}

}  // namespace

RawGroom readTfx(std::span<const std::byte> bytes, const std::string& name) {
  const ByteReader reader(bytes, name);
  if (bytes.empty()) reader.fail("the file is empty", 0);
  const TfxHeader header = readTfxHeader(reader);
  checkCounts(reader, header);

  RawGroom groom;
  groom.format = header.version == 3 ? "tfx3" : "tfx4";
  groom.native_up = UpAxis::kY;
  StrandSet& strands = groom.strands;
  strands.offsets.resize(size_t{header.strands} + 1);
  for (size_t s = 0; s < strands.offsets.size(); ++s)
    strands.offsets[s] = static_cast<uint32_t>(s * header.vertices_per_strand);
  groom.report = header.report;
  if (header.version == 3) {
    readPositions3(reader, header, strands);
    pinByConvention(header, strands);
  } else {
    readPositions4(reader, header, strands, groom.report);
  }
  readStrandUvs(reader, header, strands, groom.report);
  removeNonFinite(strands, groom.report, reader.where(header.positions));
  return groom;
}

std::vector<std::byte> encodeTfx(const StrandSet& strands, const std::string& name) {
  if (strands.strands() == 0)
    throw Error("there are no strands to write", name, "choose a groom with strands");
  const size_t count = strands.verticesOf(0);
  for (size_t s = 1; s < strands.strands(); ++s)
    if (strands.verticesOf(s) != count)
      throw Error(
          fmt::format(
              "a .tfx file needs the same vertex count in every strand, strand 0 has {} and strand {} {}",
              count, s, strands.verticesOf(s)),
          name, "resample the groom (--vertices) or write .hair");
  const size_t uv_offset = kHeaderBytes4 + 16 * strands.vertices();
  const bool has_uvs = strands.uvs.size() == strands.strands();
  if (uv_offset + 8 * strands.strands() > std::numeric_limits<uint32_t>::max())
    throw Error("the groom is too large for the 32-bit offsets of .tfx", name, "write it in several parts");

  ByteWriter writer;
  writer.reserve(uv_offset + 8 * strands.uvs.size());
  writer.put(4.0f);
  writer.put(static_cast<uint32_t>(strands.strands()));
  writer.put(static_cast<uint32_t>(count));
  writer.put(kHeaderBytes4);
  writer.put(has_uvs ? static_cast<uint32_t>(uv_offset) : uint32_t{0});
  writer.zeros(kHeaderBytes4 - 20);
  for (size_t s = 0; s < strands.strands(); ++s) {
    for (size_t i = 0; i < count; ++i) {
      writer.put(strands.strand(s)[i]);
      writer.put(strands.isPinned(s, i) ? 0.0f : 1.0f);
    }
  }
  if (has_uvs) {
    for (const Vec2& uv : strands.uvs) {
      writer.put(uv.x());
      writer.put(uv.y());
    }
  }
  return writer.take();
}

}  // namespace strandcast
