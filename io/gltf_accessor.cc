// Accessors of glTF 2.0 (specification, "Accessors", "Sparse Accessors", "Animations";
// KHR_mesh_quantization).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "io/gltf_document.h"
#include "io/gltf_extensions.h"

namespace strandcast {
namespace {

using nlohmann::json;

enum ComponentType : uint64_t {
  kByte = 5120,
  kUnsignedByte = 5121,
  kShort = 5122,
  kUnsignedShort = 5123,
  kUnsignedInt = 5125,
  kFloat = 5126
};

uint64_t componentBytes(uint64_t type) {
  switch (type) {
    case kByte:
    case kUnsignedByte:
      return 1;
    case kShort:
    case kUnsignedShort:
      return 2;
    case kUnsignedInt:
    case kFloat:
      return 4;
    default:
      return 0;
  }
}

/// Components per element; 0 for an unknown type.
uint64_t componentsOf(std::string_view type) {
  return type == "SCALAR" ? 1 : type == "VEC3" ? 3 : type == "VEC4" ? 4 : type == "MAT4" ? 16 : 0;
}

bool isIndexType(uint64_t type) {
  return type == kUnsignedByte || type == kUnsignedShort || type == kUnsignedInt;
}

std::string accessorPart(uint64_t accessor) { return fmt::format("accessors[{}]", accessor); }

/// An integer component as a float, mapped to 0 to 1 or -1 to 1 where it is normalised.
template <class Whole>
float wholeNumber(const std::byte* from, bool is_normalized) {
  Whole whole;
  std::memcpy(&whole, from, sizeof whole);
  const auto value = static_cast<float>(whole);
  if (!is_normalized) return value;
  return std::max(value / static_cast<float>(std::numeric_limits<Whole>::max()), -1.0f);
}

/// A component of any type except 32-bit integers; NaN for those.
float componentAt(const std::byte* from, uint64_t type, bool is_normalized) {
  switch (type) {
    case kFloat: {
      float value = 0;
      std::memcpy(&value, from, sizeof value);
      return value;
    }
    case kByte:
      return wholeNumber<int8_t>(from, is_normalized);
    case kUnsignedByte:
      return wholeNumber<uint8_t>(from, is_normalized);
    case kShort:
      return wholeNumber<int16_t>(from, is_normalized);
    case kUnsignedShort:
      return wholeNumber<uint16_t>(from, is_normalized);
    default:
      return std::numeric_limits<float>::quiet_NaN();
  }
}

}  // namespace

GltfDocument::View GltfDocument::view(uint64_t index, const std::string& asked_by) const {
  const std::string part = fmt::format("bufferViews[{}]", index);
  const json& description = entry("bufferViews", index, asked_by);
  const auto buffer = unsignedMember(description, "buffer", part);
  const auto length = unsignedMember(description, "byteLength", part);
  if (!buffer || *buffer >= buffers_.size()) fail("the view's buffer does not exist", part);
  if (!length) fail("the view has no byteLength", part);
  const uint64_t at = unsignedMember(description, "byteOffset", part).value_or(0);
  const std::span<const std::byte> bytes = buffers_[*buffer];
  if (const char* compression = meshoptOf(description); compression != nullptr && bytes.empty())
    fail(fmt::format("its data is compressed with {}, which is not read", compression), part, kUncompressed);
  if (at > bytes.size() || *length > bytes.size() - at)
    fail(fmt::format("bytes {} to {} lie outside the buffer of {}", at, at + *length, bytes.size()), part);
  auto stride = unsignedMember(description, "byteStride", part);
  if (stride == 0) stride.reset();  // some exporters write 0 for tightly packed elements
  return {bytes.subspan(at, *length), stride};
}

GltfDocument::Elements GltfDocument::elements(uint64_t accessor, const char* type, uint64_t most) const {
  const std::string part = accessorPart(accessor);
  const json& description = entry("accessors", accessor, "a primitive");
  const auto type_member = description.find("type");
  if (type_member == description.end() || *type_member != type)
    fail(fmt::format("the accessor's type is not {}", type), part);
  const uint64_t component = unsignedMember(description, "componentType", part).value_or(0);
  const uint64_t element_bytes = componentBytes(component) * componentsOf(type);
  if (element_bytes == 0) fail(fmt::format("component type {} does not fit here", component), part);
  const auto count = unsignedMember(description, "count", part);
  if (!count) fail("the accessor has no count", part);
  const auto flag = description.find("normalized");
  Elements out;
  out.count = std::min(*count, most);
  out.stride = element_bytes;
  out.component_type = component;
  out.is_normalized = flag != description.end() && flag->is_boolean() && flag->get<bool>();
  const auto view_index = unsignedMember(description, "bufferView", part);
  if (view_index) {
    const View from = view(*view_index, part);
    out.stride = from.stride.value_or(element_bytes);
    if (out.stride < element_bytes)
      fail(fmt::format("a byteStride of {} does not fit elements of {} bytes", out.stride, element_bytes),
           fmt::format("bufferViews[{}]", *view_index));
    const uint64_t at = unsignedMember(description, "byteOffset", part).value_or(0);
    const uint64_t room = from.bytes.size();
    if (*count > 0 &&
        (at > room || element_bytes > room - at || *count - 1 > (room - at - element_bytes) / out.stride))
      fail(fmt::format("{} elements from byte {} on do not fit into a view of {} bytes", *count, at, room),
           part);
    if (out.count > 0) out.data = from.bytes.data() + at;
  }
  const auto sparse = description.find("sparse");
  if (view_index && sparse == description.end()) return out;
  if (*count > limits_.accessor_bytes / element_bytes)
    fail(fmt::format("{} elements that the file does not hold one by one are too many: {} are read", *count,
                     limits_.accessor_bytes / element_bytes),
         part, "export the accessor with a bufferView of its own");
  std::vector<std::byte> own(out.count * element_bytes);
  for (uint64_t i = 0; out.data != nullptr && i < out.count; ++i)
    std::memcpy(own.data() + i * element_bytes, out.data + i * out.stride, element_bytes);
  if (sparse != description.end()) replaceSparse(*sparse, *count, element_bytes, part, own);
  out.own = std::move(own);
  out.data = out.own.data();
  out.stride = element_bytes;
  return out;
}

void GltfDocument::replaceSparse(const json& sparse, uint64_t count, uint64_t element_bytes,
                                 const std::string& part, std::vector<std::byte>& into) const {
  if (!sparse.is_object()) fail("sparse is not an object", part);
  const auto replaced = unsignedMember(sparse, "count", part);
  if (!replaced || *replaced > count) fail(fmt::format("its sparse count is not 0 to {}", count), part);
  if (*replaced == 0) return;
  const auto bytesOf = [&](const char* key, uint64_t each) {
    const auto member = sparse.find(key);
    const auto view_index = member != sparse.end() && member->is_object()
                                ? unsignedMember(*member, "bufferView", part)
                                : std::nullopt;
    if (!view_index) fail(fmt::format("its sparse {} have no bufferView", key), part);
    const std::span<const std::byte> bytes = view(*view_index, part).bytes;
    const uint64_t at = unsignedMember(*member, "byteOffset", part).value_or(0);
    if (at > bytes.size() || *replaced > (bytes.size() - at) / each)
      fail(fmt::format("{} sparse {} do not fit into a view of {} bytes", *replaced, key, bytes.size()),
           part);
    return bytes.data() + at;
  };
  const auto indices = sparse.find("indices");
  const uint64_t index_type = indices != sparse.end() && indices->is_object()
                                  ? unsignedMember(*indices, "componentType", part).value_or(0)
                                  : 0;
  if (!isIndexType(index_type)) fail("its sparse indices are not whole numbers without a sign", part);
  const uint64_t index_bytes = componentBytes(index_type);
  const std::byte* from_index = bytesOf("indices", index_bytes);
  const std::byte* from_value = bytesOf("values", element_bytes);
  for (uint64_t i = 0; i < *replaced; ++i) {
    uint32_t index = 0;  // little endian: a narrow index fills the low bytes of the wide one
    std::memcpy(&index, from_index + i * index_bytes, index_bytes);
    if (index >= count)
      fail(fmt::format("sparse index {} is out of range, there are {}", index, count), part);
    if ((index + uint64_t{1}) * element_bytes > into.size()) continue;  // beyond the requested elements
    std::memcpy(into.data() + index * element_bytes, from_value + i * element_bytes, element_bytes);
  }
}

uint64_t GltfDocument::accessorCount(uint64_t accessor, const char* type) const {
  (void)elements(accessor, type, 0);
  return unsignedMember(entry("accessors", accessor, "a primitive"), "count", accessorPart(accessor)).value();
}

std::vector<Vec3> GltfDocument::positions(uint64_t accessor) const {
  const Elements found = elements(accessor, "VEC3", std::numeric_limits<uint64_t>::max());
  if (found.component_type == kUnsignedInt)
    fail("positions are neither 32-bit floats nor of 8 or 16 bits", accessorPart(accessor));
  const uint64_t bytes = componentBytes(found.component_type);
  std::vector<Vec3> points(found.count);
  for (uint64_t i = 0; i < found.count; ++i) {
    for (uint64_t c = 0; c < 3; ++c)
      points[i][static_cast<Eigen::Index>(c)] =
          componentAt(found.data + i * found.stride + c * bytes, found.component_type, found.is_normalized);
    if (!points[i].allFinite())
      fail(fmt::format("position {} is not a finite number", i), accessorPart(accessor));
  }
  return points;
}

std::vector<uint32_t> GltfDocument::indices(uint64_t accessor) const {
  const Elements found = elements(accessor, "SCALAR", std::numeric_limits<uint64_t>::max());
  if (!isIndexType(found.component_type))
    fail("indices are not whole numbers without a sign", accessorPart(accessor));
  std::vector<uint32_t> values(found.count);
  // Little endian: a narrow index fills the low bytes of the wide one.
  for (uint64_t i = 0; i < found.count; ++i)
    std::memcpy(&values[i], found.data + i * found.stride, componentBytes(found.component_type));
  return values;
}

std::vector<std::array<uint32_t, 4>> GltfDocument::joints(uint64_t accessor) const {
  const Elements found = elements(accessor, "VEC4", std::numeric_limits<uint64_t>::max());
  if (found.component_type != kUnsignedByte && found.component_type != kUnsignedShort)
    fail("joints are not numbers of 8 or 16 bits", accessorPart(accessor));
  const uint64_t bytes = componentBytes(found.component_type);
  std::vector<std::array<uint32_t, 4>> values(found.count);
  for (uint64_t i = 0; i < found.count; ++i)
    for (uint64_t c = 0; c < 4; ++c)
      std::memcpy(&values[i][c], found.data + i * found.stride + c * bytes, bytes);
  return values;
}

std::vector<float> GltfDocument::floats(uint64_t accessor, const char* type, bool or_normalized,
                                        uint64_t most) const {
  const Elements found = elements(accessor, type, most);
  if (found.component_type != kFloat && !(or_normalized && found.is_normalized))
    fail(or_normalized ? "its numbers are neither 32-bit floats nor normalised"
                       : "its numbers are not 32-bit floats",
         accessorPart(accessor));
  const uint64_t components = componentsOf(type), bytes = componentBytes(found.component_type);
  std::vector<float> values;
  values.reserve(found.count * components);
  for (uint64_t i = 0; i < found.count; ++i)
    for (uint64_t c = 0; c < components; ++c) {
      const float value = componentAt(found.data + i * found.stride + c * bytes, found.component_type, true);
      if (!std::isfinite(value))
        fail(fmt::format("element {} is not a finite number", i), accessorPart(accessor));
      values.push_back(value);
    }
  return values;
}

}  // namespace strandcast
