#pragma once
#include "io/bvh.h"
#include "io/bvh_text.h"

namespace strandcast {

/// Reads the part after MOTION: number of frames, frame time, and the frames, usually one per line with one
/// value per channel. `clip` has its joints and channels; its report receives what is repaired or left out.
/// - The number of lines counts, not the number that Frames states.
/// - A line with another number of values, or with a word that is not a number, is left out.
/// - Frames broken over several lines are read if the number of values is Frames times channels, or if each
///   line is shorter than a frame.
/// - A frame over several lines that contains a word that is not a number is left out.
/// - 1/30 s replaces a missing or unusable frame time.
///
/// Throws Error when there is no whole frame.
void readBvhMotion(BvhText& text, BvhClip& clip);

}  // namespace strandcast
