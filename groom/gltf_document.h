#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/geometry.h"

namespace strandcast {

/// A glTF 2.0 asset (Khronos, glTF 2.0 specification) taken apart: its JSON and its buffers, and accessors
/// read with every index, offset and count checked. Private to groom/: the header pulls in the JSON library.
///
/// The parts that a body does not need (images, materials) are dropped while parsing, so nothing outside the
/// file is ever opened for them, and buffers hold no more bytes than the files given.
class GltfDocument {
 public:
  /// `folder` is where the external buffers of a .gltf lie; without it a file that has any is refused.
  GltfDocument(std::span<const std::byte> bytes, const std::string& name,
               const std::optional<std::filesystem::path>& folder);

  const nlohmann::json& root() const { return root_; }
  /// All bytes that the buffers hold; what reading them can justify.
  uint64_t bufferBytes() const;

  /// Entry `index` of a top-level array ("nodes", "meshes", ...). Throws Error when there is none.
  const nlohmann::json& entry(const char* array, uint64_t index, const std::string& asked_by) const;
  /// A member that must be a non-negative integer. Empty when absent.
  std::optional<uint64_t> unsignedMember(const nlohmann::json& object, const char* key,
                                         const std::string& where) const;
  /// `count` numbers in a member, all finite as float. Empty when absent.
  std::optional<std::vector<float>> numbers(const nlohmann::json& object, const char* key, size_t count,
                                            const std::string& where) const;

  std::vector<Vec3> positions(uint64_t accessor) const;  ///< VEC3 of float, all finite
  std::vector<uint32_t> indices(
      uint64_t accessor) const;  ///< SCALAR of 8, 16 or 32 bits, not yet compared with a count
  std::vector<std::array<uint32_t, 4>> joints(uint64_t accessor) const;  ///< VEC4 of 8 or 16 bits
  /// Elements of `type` one after the other: 32-bit floats, all finite, or, where `or_normalized`, whole
  /// numbers of 8 or 16 bits that stand for 0 to 1 or -1 to 1.
  std::vector<float> floats(uint64_t accessor, const char* type, bool or_normalized) const;
  uint64_t accessorCount(uint64_t accessor, const char* type = "VEC3") const;

  [[noreturn]] void fail(const std::string& what, const std::string& part,
                         const std::string& remedy = "export the file again") const {
    throw Error(what, name_ + ", " + part, remedy);
  }

 private:
  /// An accessor's elements: checked to lie inside their buffer.
  struct Elements {
    const std::byte* data;
    uint64_t count, stride;
    uint64_t component_type;
  };
  Elements elements(uint64_t accessor, const char* type) const;
  void parseJson(std::span<const std::byte> text, uint64_t file_offset);
  std::span<const std::byte> splitBinary(std::span<const std::byte> bytes);
  void loadBuffers(std::span<const std::byte> binary, const std::optional<std::filesystem::path>& folder);
  std::vector<std::byte> externalBuffer(const std::string& uri, const std::string& part,
                                        const std::optional<std::filesystem::path>& folder) const;

  std::string name_;
  nlohmann::json root_;
  std::vector<std::vector<std::byte>> owned_;        ///< decoded or external buffers
  std::vector<std::span<const std::byte>> buffers_;  ///< per buffer; may point into the caller's bytes
};

}  // namespace strandcast
