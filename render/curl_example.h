#pragma once
#include <array>
#include <filesystem>
#include <span>
#include <string>

#include "core/geometry.h"

namespace strandcast {

/// The curl of one strand, to be laid on grown hair: how far the strand is beside its smoothed axis, at equal
/// parts u of the axis's length and in parts of it. The axis is the cubic curve through the root that is
/// nearest to the strand (least squares), so that what bends no more often than that is shape and stays the
/// guides'. "Beside" is along the normal and binormal of the axis's twist-free frame (kernels/hair.h,
/// carriedNormal); what lies along the axis is left out, so a strand that turns back on itself loses its
/// loops.
struct CurlExample {
  static constexpr int kParts = 256;
  struct Sample {
    float x, y;              ///< along normal and binormal, parts of the axis's length; 0 at the root
    float slope_x, slope_y;  ///< by u
  };
  std::array<Sample, kParts + 1> samples;
  float axis_length;  ///< in the strand's unit
  float reach;        ///< the farthest sample, part of the axis's length
  float turns;        ///< about the axis, whichever way; a wave to and fro counts as one
};

/// Throws Error, naming `where`, for a strand of fewer than 5 vertices, or whose vertices are not finite, or
/// that has no length.
CurlExample curlOf(std::span<const Vec3> strand, const std::string& where);
/// Of strand `strand`, from 0 on, of a groom file (groom/groom_file.h). Throws Error as readRawGroom, and
/// where the file has no such strand.
CurlExample readCurlExample(const std::filesystem::path& file, size_t strand);

}  // namespace strandcast
