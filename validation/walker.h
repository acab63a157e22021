// A walking character, made by the program: a skin on eleven joints, hair about its head and shoulders, and
// its gait.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/geometry.h"

namespace strandcast {

/// Names of the joints, parents first, as a sender of poses gives them: "joint:hips".
std::vector<std::string> walkerNames();

/// The motion from rest of each joint at a time in ns. The character walks at 1.4 m/s along a circle of 2 m
/// radius, two steps a second. The same time gives the same bits in every process of this program.
std::vector<Pose> walkerAt(uint64_t time_ns);

/// Writes walker.glb, the skin at rest, and hair.obj, `strands` strands of `vertices` vertices: metres, Y up.
/// Throws Error.
void writeWalker(const std::filesystem::path& folder, int strands, int vertices);

}  // namespace strandcast
