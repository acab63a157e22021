#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/strand_set.h"
#include "io/file_report.h"

namespace strandcast {

enum class UpAxis { kAuto, kX, kY, kZ };  ///< kAuto: as .usda states, Z for .hair, Y for others

/// How the coordinates of a file are converted to metres with Y up.
struct GroomReadOptions {
  float unit_meters = 0;      ///< metres per unit of the file, positive; overrides the file. 0: as the file
                              ///< states, else guessed from the bounding box, with a warning
  UpAxis up = UpAxis::kAuto;  ///< Z up becomes (x, z, -y), X up (-y, x, z): quarter turns without mirroring
  bool keep_pins = false;     ///< keep pins as in the files, for writing them again
};

/// A group into which an artist put strands: the hair of a fringe, a beard.
struct StrandGroup {
  int32_t id = 0;  ///< as the file numbers it (Unreal's groom_group_id); files may use one id for two groups
  std::string name;  ///< groom_group_name: any bytes, at most 255; empty where the file has none
};

/// Strands as stored in a file, in its units and axes. Nothing is converted or cleaned, so that writing them
/// again round-trips bit for bit. `positions` and `radii` are in file units here. `pinned`:
/// - .tfx version 4: the vertices with w = 0;
/// - .tfx version 3, which stores none: vertices 0 and 1, and the last two when both ends are immovable;
/// - .hair, .obj and .usda: empty, which means the root.
///
/// `radii` are half the thickness of a .hair file or half the widths of .usda curves. `uvs` are the strand
/// UVs of a .tfx or .usda file. Labels (ids, guide marks, groups, colours) come from .usda files. All these
/// are empty where the file has none.
struct RawGroom {
  StrandSet strands;
  std::vector<StrandGroup> groups;  ///< table for StrandSet::groups, in the order of first strands
  UpAxis native_up = UpAxis::kY;
  float unit_meters = 0;         ///< metres per unit, where the file or its format (.usda) states it; else 0
  bool unit_is_default = false;  ///< the unit comes from the format's default; the file does not state it
  std::string format;            ///< "tfx3", "tfx4", "hair", "obj", "usda"
  FileReport report;
};

/// Reads .tfx (versions 3 and 4), .hair, .obj polylines or .usda curves, selected by content and extension.
/// Throws Error (file, byte offset or line, remedy) on input that is truncated, oversized, out of range, not
/// finite or empty, and on a path that is no regular file. Memory use is at most a small multiple of the
/// file's size.
RawGroom readRawGroom(const std::filesystem::path& file);

/// Readers from memory; `name` stands for the file in errors. The fuzzers' entry points.
///
/// Strands have 1 or more vertices. An OBJ polyline that starts with the vertex index at which the previous
/// one ended continues that strand (some programs write each edge as a polyline of its own).
///
/// Of USD text, those BasisCurves are read that are active, visible and of purpose default or render, placed
/// by their transforms. Linear curves keep their points. Cubic curves are sampled at the ends of segments;
/// bezier curves at the thirds of segments, too. Referenced files, unselected variants and all time samples
/// except the earliest are not read. A unit is 0.01 m without metersPerUnit. UV and labels of a strand are
/// those of its root, its colour is the mean along it. docs/formats.md has the full list.
RawGroom readTfx(std::span<const std::byte> bytes, const std::string& name);
RawGroom readHair(std::span<const std::byte> bytes, const std::string& name);
RawGroom readObjStrands(std::span<const std::byte> bytes, const std::string& name);
RawGroom readUsda(std::span<const std::byte> bytes, const std::string& name);

/// Warning that asks for the unit, when the unit is only the format's default; else empty. It is separate
/// from the readers because the caller may give the unit.
std::string defaultUnitWarning(const RawGroom& raw);

/// Writes a groom in the format of the extension. `up` is the up axis of `strands`; positions are rotated to
/// the axis that readers of the format assume: Z for .hair, Y for .tfx and .usda. Quarter turns are exact:
/// .hair -> .hair and .tfx -> .hair -> .tfx through raw grooms and their native_up give the same positions.
/// - .tfx (version 4) keeps pins and UVs, not radii. All strands must have the same vertex count.
/// - .hair keeps counts and radii (thickness = twice the radius), not pins and UVs. At most 65,536 vertices
///   per strand.
/// - .usda keeps counts, radii (widths), UVs and labels, not pins, and states the unit: `unit_meters`,
/// metres,
///   0 if unknown. `groups`: the table for StrandSet::groups; an index beyond it is written as the id.
///
/// `parts` are not kept. Throws Error for no strands, counts that do not fit, another extension, or a failed
/// write.
void writeGroom(const std::filesystem::path& file, const StrandSet& strands, UpAxis up = UpAxis::kY,
                float unit_meters = 1, std::span<const StrandGroup> groups = {});

/// Attributes of `strands` that writeGroom() cannot store in this file: "pins", "UVs", "radii", "guide
/// marks", "ids", "groups", "colours". A pin of the second vertex alone does not count: it stands for the
/// clamped root frame, which all strands have.
std::vector<std::string> omissionsOf(const std::filesystem::path& file, const StrandSet& strands);

/// Metres per unit that are tried for files of unknown unit: 1, 0.1, 0.01, 0.001, the 0.0025 of HAIR and
/// TressFX files, inches and feet.
std::span<const float> usualUnits();
/// Guesses the unit from a groom's bounding box in file units: the usual unit with which the longest side is
/// nearest to a head of hair (0.1 to 1 m, best 0.3). Inches and feet are never guessed: the size alone does
/// not tell them from centimetres and metres. 1 for an empty box.
float guessUnit(const Box& bounds);

/// Encodes a .tfx file, version 4: positions and strand UVs bit for bit, w = 0 for pinned vertices and 1 for
/// others. Radii and parts are not stored. Throws Error (naming `name`) when there are no strands or their
/// vertex counts differ.
std::vector<std::byte> encodeTfx(const StrandSet& strands, const std::string& name);

/// Encodes a .hair file: positions bit for bit, thickness = twice the radius when there are radii. Pins, UVs
/// and parts are not stored. Throws Error when there are no strands or one has more than 65,536 vertices.
std::vector<std::byte> encodeHair(const StrandSet& strands, const std::string& name);

/// Encodes a .usda file: linear BasisCurves, Y up, UVs and labels per curve, widths = twice the radius when
/// there are radii. Positions are written as the shortest decimals that round-trip. Pins and parts are not
/// stored. `unit_meters`: metres per unit of the positions, 0 if unknown. `groups`: as for writeGroom().
/// Throws Error when there are no strands.
std::vector<std::byte> encodeUsda(const StrandSet& strands, float unit_meters, const std::string& name,
                                  std::span<const StrandGroup> groups = {});

}  // namespace strandcast
