#pragma once
#include "scenes/bvh.h"
#include "scenes/bvh_text.h"

namespace strandcast {

/// Reads what is behind MOTION: number of frames, time of a frame, and the frames, which are lines of one
/// value a channel. `clip` has its joints and channels; its report is told of what is mended or left out.
/// - The lines there are count, not what Frames says.
/// - A line with another number of values, or with a word that is not a number, is left out.
/// - Of frames over several lines, one with a word that is not a number is left out.
/// - Frames that are broken over several lines are read where their values are Frames times channels, or
/// where
///   every line is shorter than a frame.
/// - 1/30 s stands for a frame time that is not given or not usable.
/// Throws Error where there is no whole frame.
void readBvhMotion(BvhText& text, BvhClip& clip);

}  // namespace strandcast
