#pragma once
#include <array>
#include <filesystem>
#include <span>
#include <string>

#include "core/geometry.h"

namespace strandcast {

/// The curl of one strand, to be applied to grown hair: its offset from its smoothed axis, sampled at equal
/// parts u of the axis's length and divided by that length. The axis is the least squares cubic through the
/// root; slower bends than that are the guides' shape, not curl. Offsets are along the normal and binormal of
/// the axis's twist-free frame (kernels/hair.h, carriedNormal). The component along the axis is omitted, so a
/// strand that turns back on itself loses its loops.
struct CurlExample {
  static constexpr int kParts = 256;
  struct Sample {
    float x, y;              ///< along normal and binormal, over the axis's length; 0 at the root
    float slope_x, slope_y;  ///< derivatives with respect to u
  };
  std::array<Sample, kParts + 1> samples;
  float axis_length;  ///< in the strand's unit
  float reach;        ///< largest offset of a sample, over the axis's length
  float turns;        ///< absolute turns about the axis; a planar wave counts one per period
};

/// Throws Error, naming `where`, for a strand of fewer than 5 vertices, with vertices that are not finite, or
/// without length.
CurlExample curlOf(std::span<const Vec3> strand, const std::string& where);
/// The curl of strand `strand`, from 0, of a groom file (io/groom_file.h). Throws Error as readRawGroom()
/// and curlOf(), and where the file has no such strand.
CurlExample readCurlExample(const std::filesystem::path& file, size_t strand);

}  // namespace strandcast
