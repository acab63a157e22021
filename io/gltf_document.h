#pragma once
#include <nlohmann/json.hpp>

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/geometry.h"
#include "io/file_report.h"
#include "io/mesh_file.h"

namespace strandcast {

/// Reads a file that a .gltf names, by a path relative to the folder of the .gltf. Empty: external files are
/// refused.
using ReadBeside = std::function<std::vector<std::byte>(const std::filesystem::path& relative)>;

/// A glTF 2.0 asset (Khronos, glTF 2.0 specification) split into its JSON and its buffers. Accessors are read
/// with every index, offset and count checked. Private to groom/, because the header includes the JSON
/// library.
///
/// Images are never opened. A file that requires an unsupported extension is refused, and the error names the
/// extension.
///
/// Accessors: sparse values are applied. An accessor without a bufferView holds zeros. An accessor without
/// elements is accepted with count 0, although the specification asks for at least one; the caller leaves out
/// what uses it.
class GltfDocument {
 public:
  /// Without `read_beside` a file with external buffers is refused.
  GltfDocument(std::span<const std::byte> bytes, const std::string& name, const ReadBeside& read_beside,
               const GltfLimits& limits);

  const nlohmann::json& root() const { return root_; }
  const GltfLimits& limits() const { return limits_; }
  /// Remarks on the asset as a whole, one sentence each.
  const std::vector<std::string>& doubts() const { return doubts_; }

  /// Entry `index` of a top-level array ("nodes", "meshes", ...). Throws Error when there is none.
  const nlohmann::json& entry(const char* array, uint64_t index, const std::string& asked_by) const;
  /// Value of a member that must be a non-negative integer below 2^48. Empty when absent.
  std::optional<uint64_t> unsignedMember(const nlohmann::json& object, const char* key,
                                         const std::string& where) const;
  /// Values of a member that is an array of numbers, all finite as float. Empty when absent.
  std::optional<std::vector<float>> numbers(const nlohmann::json& object, const char* key,
                                            const std::string& where) const;
  /// As above, of exactly `count` numbers.
  std::optional<std::vector<float>> numbers(const nlohmann::json& object, const char* key, size_t count,
                                            const std::string& where) const;

  /// Elements of type VEC3, all finite: 32-bit floats, or 8- or 16-bit integers, normalised or not
  /// (KHR_mesh_quantization).
  std::vector<Vec3> positions(uint64_t accessor) const;
  /// Elements of type SCALAR of 8, 16 or 32 bits. The caller checks them against the count of vertices.
  std::vector<uint32_t> indices(uint64_t accessor) const;
  std::vector<std::array<uint32_t, 4>> joints(uint64_t accessor) const;  ///< VEC4 of 8 or 16 bits
  /// The first `most` elements of `type`, flat. Components are 32-bit floats, all finite; with
  /// `or_normalized` also 8- or 16-bit normalised integers, mapped to 0 to 1 or -1 to 1.
  std::vector<float> floats(uint64_t accessor, const char* type, bool or_normalized,
                            uint64_t most = std::numeric_limits<uint64_t>::max()) const;
  /// Number of elements of an accessor, which must be of `type`.
  uint64_t accessorCount(uint64_t accessor, const char* type = "VEC3") const;

  /// Throws Error located at `part` of the file.
  [[noreturn]] void fail(const std::string& what, const std::string& part,
                         const std::string& remedy = "export the file again") const {
    throw Error(what, name_ + ", " + part, remedy);
  }

 private:
  /// Elements of an accessor, checked to lie inside their buffer.
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
  /// The first `most` elements. The statements about the others are checked as well.
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
  std::vector<std::span<const std::byte>> buffers_;  ///< per buffer; may refer to the bytes of the caller
};

inline constexpr const char* kUncompressed = "export it without mesh compression";

/// Throws Error, which names the extension, when the file requires an unsupported extension that could change
/// the surface. Extensions of materials, textures, lights and metadata do not affect a body and are ignored.
void checkRequiredExtensions(const GltfDocument& document);

/// Reports doubts about the asset. Reports as well each extension that the file uses without requiring it,
/// and that is unsupported and changes the surface, or is unknown. Mesh compression is not reported: the
/// uncompressed fallback is read.
void reportAsset(const GltfDocument& document, GltfReport& report);

/// The extension `name` of a node, primitive or other object; null when the object has none of this name.
const nlohmann::json* extensionOf(const nlohmann::json& object, const char* name);

/// Name of the extension that compresses a buffer view, EXT_meshopt_compression or its successor; null if
/// none.
const char* meshoptOf(const nlohmann::json& view);
/// Whether a buffer without data is the fallback of views compressed by meshopt.
bool isMeshoptFallback(const nlohmann::json& buffer);

}  // namespace strandcast
