#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/distance_field.h"

namespace strandcast {

/// A field with the key under which the cache stores it.
struct StoredField {
  DistanceField field;
  uint64_t key = 0;  ///< fieldKey() of the mesh and the options from which the field was baked
};

/// Encodes a field as .sdf, little-endian:
/// - "STRNDSDF", version 2 (uint32), number of stored bricks (uint32), key (uint64);
/// - hash (uint64): ContentHash of all bytes except these 8;
/// - the 48 bytes of FieldGrid;
/// - `index`, `samples` and `corners` in the layout of DistanceField.
std::vector<std::byte> encodeDistanceField(const DistanceField& field, uint64_t key);
/// Recomputes the hash of a modified .sdf. Fuzzers use it to get past the hash check.
void stampDistanceField(std::span<std::byte> bytes);
/// Decodes an .sdf; the fuzzer's entry point. `name` stands for the file in errors. Throws Error (file, byte
/// offset, remedy) when the bytes are not an .sdf, have another version, are cut short or too long, or when
/// the hash does not match. Numbers outside the range of baked fields are an Error, too. Each field that is
/// returned can therefore be sampled at any point.
StoredField readDistanceField(std::span<const std::byte> bytes, const std::string& name);

/// Writes an .sdf file. Throws Error as writeFileBytes().
void writeDistanceField(const std::filesystem::path& file, const DistanceField& field, uint64_t key);
/// Reads an .sdf file. Throws Error as readFileBytes() and readDistanceField().
StoredField loadDistanceField(const std::filesystem::path& file);

}  // namespace strandcast
