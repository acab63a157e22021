#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/distance_field.h"

namespace strandcast {

struct StoredField {
  DistanceField field;
  uint64_t key = 0;  ///< of the mesh and the options it was baked from (fieldKey)
};

/// A field as .sdf, little-endian: "STRNDSDF", version 2 (uint32), number of stored bricks (uint32), key
/// (uint64), hash (uint64, ContentHash of all bytes but these 8), the 48 bytes of FieldGrid, then `index`,
/// `samples` and `corners` as DistanceField has them.
std::vector<std::byte> encodeDistanceField(const DistanceField& field, uint64_t key);
/// Makes the hash of an .sdf fit its bytes again; for who changes them, as fuzzers do.
void stampDistanceField(std::span<std::byte> bytes);
/// The fuzzer's entry point; `name` stands for the file in errors. Throws Error (file, byte offset, remedy)
/// when it is no .sdf, of another version, cut short or too long, when a number is not one that a baked field
/// has, so that any field returned can be sampled anywhere, or when the hash is another.
StoredField readDistanceField(std::span<const std::byte> bytes, const std::string& name);

void writeDistanceField(const std::filesystem::path& file, const DistanceField& field, uint64_t key);
StoredField loadDistanceField(const std::filesystem::path& file);

}  // namespace strandcast
