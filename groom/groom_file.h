#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "groom/file_report.h"
#include "groom/groom.h"

namespace strandcast {

enum class UpAxis { kAuto, kX, kY, kZ };  ///< kAuto: what .usda says, Z for .hair, Y for the rest

/// How a file's numbers become metres with Y up.
struct GroomReadOptions {
  float unit_meters = 0;  ///< metres per unit of the file, positive, whatever the file says; 0 = as the file
                          ///< says, else guessed from the bounding box, with a warning
  UpAxis up = UpAxis::kAuto;  ///< Z up becomes (x, z, -y), X up (-y, x, z): quarter turns, no mirroring
  bool keep_pins = false;     ///< as the files have them, for writing them again
};

/// Strands as the file has them, in its own units and axes: nothing converted, nothing cleaned, so that
/// writing them again gives the same bits. `positions` and `radii` of the set are in file units here,
/// `pinned` is:
/// - .tfx version 4: the vertices with w = 0;
/// - .tfx version 3, which stores none: vertices 0 and 1, and the last two when both ends are immovable;
/// - .hair, .obj and .usda: empty, that is the root.
/// `radii` are half of a .hair file's thickness or of the widths of .usda curves, `uvs` the strand UVs of a
/// .tfx or .usda file; empty where the file has none.
struct RawGroom {
  StrandSet strands;
  UpAxis native_up = UpAxis::kY;
  float unit_meters = 0;         ///< metres per unit, where the file or its format says it (.usda); else 0
  bool unit_is_default = false;  ///< the file does not say it, its format does
  std::string format;            ///< "tfx3", "tfx4", "hair", "obj", "usda"
  FileReport report;
};

/// Reads .tfx (versions 3 and 4), .hair, .obj polylines or .usda curves by content and extension. Throws
/// Error (file, byte offset or line, remedy) on anything truncated, oversized, out of range, not finite or
/// empty, and on what is no regular file. Never allocates more than a small multiple of the file's size.
RawGroom readRawGroom(const std::filesystem::path& file);

/// The same from memory; `name` stands for the file in errors. The fuzzers' entry points.
///
/// Strands have 1 or more vertices. An OBJ polyline that starts with the vertex index that the one before it
/// ended with continues that strand (some programs write every edge on its own).
///
/// Of USD text those BasisCurves are read that show: active, visible, of purpose default or render, where
/// their transforms place them. Linear ones are read as they are; of cubic ones the points on the curve at
/// the ends of segments, of bezier curves at their thirds too. Other files that it refers to, variants that
/// are not selected and time samples but the earliest are not read. A unit is 0.01 m without metersPerUnit.
/// The UV of a strand is that of its root. docs/formats.md has the whole of it.
RawGroom readTfx(std::span<const std::byte> bytes, const std::string& name);
RawGroom readHair(std::span<const std::byte> bytes, const std::string& name);
RawGroom readObjStrands(std::span<const std::byte> bytes, const std::string& name);
RawGroom readUsda(std::span<const std::byte> bytes, const std::string& name);

/// Where the file's unit is only its format's default, a warning that asks for the unit; else empty. Readers
/// cannot give it, as the unit may be given by hand.
std::string defaultUnitWarning(const RawGroom& raw);

/// Writes by extension, turned from `up`, which is up in `strands`, to what readers of the format take for
/// up: Z for .hair, Y for .tfx and .usda. Quarter turns keep every bit: .hair -> .hair and .tfx -> .hair ->
/// .tfx through raw grooms and their native_up give the same positions.
/// - .tfx (version 4) keeps pins and UVs, not radii; every strand must have the same vertex count;
/// - .hair keeps counts and radii (thickness = twice the radius), not pins and UVs; 65,536 vertices a strand
/// at most;
/// - .usda keeps counts, radii (widths) and UVs, not pins, and says the unit: `unit_meters`, metres, 0 if not
/// known. `parts` are not kept. Throws Error for no strands, counts that do not fit, another extension, or a
/// failed write.
void writeGroom(const std::filesystem::path& file, const StrandSet& strands, UpAxis up = UpAxis::kY,
                float unit_meters = 1);

/// What `strands` have that writeGroom() leaves out of this file: "pins", "UVs", "radii". A pin of the second
/// vertex alone does not count: it is the root's clamp, which all hair has.
std::vector<std::string> leftOutOf(const std::filesystem::path& file, const StrandSet& strands);

/// Reads one or more files (at most 65,535) into one groom in metres, Y up, and cleans it (cleanStrands);
/// `parts` says which file each strand came from. A unit that is given holds for all files. Else each file
/// that says its unit is read in that, or one is guessed for all where none says it; the up axis is each
/// file's own unless given. Warns where a unit or axis that is given is not what a file says, and of a size
/// or place that no hair has. A pin of vertex 1 is dropped where vertex 0 is pinned and vertex 2 free, unless
/// pins are to be kept: the root's frame is clamped instead. Throws Error as readRawGroom, and when a unit is
/// not positive, some files say their unit and others do not, a vertex lies 10 km away, or no strand is left.
Groom loadGroom(const std::vector<std::filesystem::path>& files, const GroomReadOptions& options);

/// Metres per unit that files of unknown unit may have: 1, 0.1, 0.01, 0.001, the 0.0025 of HAIR and TressFX
/// files, inches and feet.
std::span<const float> usualUnits();
/// The usual unit guessed from a groom's bounding box in file units: whichever makes the longest side most
/// nearly a head of hair (0.1 to 1 m, best 0.3), but neither inches nor feet: sizes alone do not tell them
/// from centimetres and metres. 1 for an empty box.
float guessUnit(const Box& bounds);

}  // namespace strandcast
