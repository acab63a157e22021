#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/geometry.h"
#include "groom/gltf_limits.h"

namespace strandcast {

/// Reads a file that a .gltf names, by a path relative to its folder. Empty = no such file is read.
using ReadBeside = std::function<std::vector<std::byte>(const std::filesystem::path& relative)>;

/// A glTF 2.0 asset (Khronos, glTF 2.0 specification) taken apart: its JSON and its buffers, and accessors
/// read with every index, offset and count checked. Private to groom/: the header pulls in the JSON library.
///
/// Images are never opened. A file that requires an extension which is not read is refused by that name.
///
/// Accessors: sparse values are applied. An accessor without a bufferView holds zeros. Where one has no
/// elements (the specification asks for one at least) its count is 0, and the caller leaves out what uses it.
class GltfDocument {
 public:
  /// Without `read_beside` a file with external buffers is refused.
  GltfDocument(std::span<const std::byte> bytes, const std::string& name, const ReadBeside& read_beside,
               const GltfLimits& limits);

  const nlohmann::json& root() const { return root_; }
  const GltfLimits& limits() const { return limits_; }
  /// What is to be said of the asset as a whole, a sentence each.
  const std::vector<std::string>& doubts() const { return doubts_; }

  /// Entry `index` of a top-level array ("nodes", "meshes", ...). Throws Error when there is none.
  const nlohmann::json& entry(const char* array, uint64_t index, const std::string& asked_by) const;
  /// A member that must be a non-negative integer. Empty when absent.
  std::optional<uint64_t> unsignedMember(const nlohmann::json& object, const char* key,
                                         const std::string& where) const;
  /// The numbers in a member, all finite as float. Empty when absent.
  std::optional<std::vector<float>> numbers(const nlohmann::json& object, const char* key,
                                            const std::string& where) const;
  /// The same, of which there must be `count`.
  std::optional<std::vector<float>> numbers(const nlohmann::json& object, const char* key, size_t count,
                                            const std::string& where) const;

  /// VEC3, all finite: 32-bit floats, or numbers of 8 or 16 bits, normalised or not (KHR_mesh_quantization).
  std::vector<Vec3> positions(uint64_t accessor) const;
  /// SCALAR of 8, 16 or 32 bits, not yet compared with a count.
  std::vector<uint32_t> indices(uint64_t accessor) const;
  std::vector<std::array<uint32_t, 4>> joints(uint64_t accessor) const;  ///< VEC4 of 8 or 16 bits
  /// Elements of `type` one after the other, the first `most` of them: 32-bit floats, all finite, or, where
  /// `or_normalized`, whole numbers of 8 or 16 bits that stand for 0 to 1 or -1 to 1.
  std::vector<float> floats(uint64_t accessor, const char* type, bool or_normalized,
                            uint64_t most = std::numeric_limits<uint64_t>::max()) const;
  uint64_t accessorCount(uint64_t accessor, const char* type = "VEC3") const;

  [[noreturn]] void fail(const std::string& what, const std::string& part,
                         const std::string& remedy = "export the file again") const {
    throw Error(what, name_ + ", " + part, remedy);
  }

 private:
  /// An accessor's elements: checked to lie inside their buffer.
  struct Elements {
    const std::byte* data = nullptr;  ///< in a buffer, or in `own`
    uint64_t count = 0, stride = 0, component_type = 0;
    bool is_normalized = false;
    std::vector<std::byte> own;  ///< of a sparse accessor, or one without a bufferView
  };
  struct View {
    std::span<const std::byte> bytes;
    std::optional<uint64_t> stride;
  };
  /// The first `most` of them; what is said of the others is checked, too.
  Elements elements(uint64_t accessor, const char* type, uint64_t most) const;
  View view(uint64_t index, const std::string& asked_by) const;
  void replaceSparse(const nlohmann::json& sparse, uint64_t count, uint64_t element_bytes,
                     const std::string& part, std::vector<std::byte>& into) const;
  void parseJson(std::span<const std::byte> text, uint64_t file_offset);
  void checkVersion(const nlohmann::json& asset);
  std::span<const std::byte> splitBinary(std::span<const std::byte> bytes);
  void loadBuffers(std::span<const std::byte> binary, const ReadBeside& read_beside);
  std::vector<std::byte> externalBuffer(const std::string& uri, const std::string& part,
                                        const ReadBeside& read_beside) const;

  std::string name_;
  GltfLimits limits_;
  nlohmann::json root_;
  std::vector<std::string> doubts_;
  std::vector<std::vector<std::byte>> owned_;        ///< decoded or external buffers
  std::vector<std::span<const std::byte>> buffers_;  ///< per buffer; may point into the caller's bytes
};

}  // namespace strandcast
