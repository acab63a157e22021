#include "io/gltf_document.h"

#include <fmt/format.h>

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <map>

#include "io/byte_reader.h"
#include "io/file_bytes.h"
#include "io/gltf_extensions.h"
#include "io/gltf_report.h"
#include "io/text_number.h"

namespace strandcast {
namespace {

using nlohmann::json;

constexpr int kMaxJsonDepth = 64;  ///< real files stay below 10; a limit protects against hostile nesting
constexpr uint32_t kGlbMagic = 0x46546C67, kJsonChunk = 0x4E4F534A, kBinaryChunk = 0x004E4942;
int base64Digit(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  if (c == '+') return 62;
  if (c == '/') return 63;
  return -1;
}

/// Decodes RFC 4648; empty on a character outside the alphabet.
std::optional<std::vector<std::byte>> decodeBase64(std::string_view text) {
  while (!text.empty() && text.back() == '=') text.remove_suffix(1);
  std::vector<std::byte> bytes;
  bytes.reserve(text.size() / 4 * 3 + 3);
  uint32_t bits = 0;
  int held = 0;
  for (const char c : text) {
    const int digit = base64Digit(c);
    if (digit < 0) return std::nullopt;
    bits = (bits << 6) | static_cast<uint32_t>(digit);
    held += 6;
    if (held < 8) continue;
    held -= 8;
    bytes.push_back(static_cast<std::byte>((bits >> held) & 0xFF));
  }
  return bytes;
}

/// Decodes %20 and the like in a relative URI.
std::string percentDecoded(const std::string& uri) {
  const auto hex = [](char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
  };
  std::string text;
  for (size_t i = 0; i < uri.size(); ++i) {
    if (uri[i] == '%' && i + 2 < uri.size() && hex(uri[i + 1]) >= 0 && hex(uri[i + 2]) >= 0) {
      text += static_cast<char>(hex(uri[i + 1]) * 16 + hex(uri[i + 2]));
      i += 2;
    } else {
      text += uri[i];
    }
  }
  return text;
}

/// Offset at which arrays and objects are nested too deeply; empty if none. A separate pass: a parser
/// callback at each value would scan everything read so far, in time quadratic in the file's size.
std::optional<size_t> tooDeep(std::string_view text) {
  int depth = 0;
  bool in_string = false;
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"') in_string = !in_string;
    if (in_string) {
      if (c == '\\') ++i;
    } else if (c == '[' || c == '{') {
      if (++depth > kMaxJsonDepth) return i;
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
  return std::nullopt;
}

/// Major and minor of a version such as "2.0". They may have any number of digits.
std::optional<std::pair<double, double>> versionOf(std::string_view text) {
  const size_t point = text.find('.');
  const auto part = [](std::string_view digits) -> std::optional<double> {
    if (digits.empty() || digits.find_first_not_of("0123456789") != std::string_view::npos) return {};
    return numberOrInfinite(digits);
  };
  const auto major = part(text.substr(0, point));
  const auto minor = part(point == std::string_view::npos ? "" : text.substr(point + 1));
  if (!major || !minor) return {};
  return std::pair(*major, *minor);
}

}  // namespace

GltfDocument::GltfDocument(std::span<const std::byte> bytes, const std::string& name,
                           const ReadBeside& read_beside, const GltfLimits& limits)
    : name_(name), limits_(limits) {
  const ByteReader reader(bytes, name);
  if (bytes.empty()) reader.fail("the file is empty", 0);
  std::span<const std::byte> binary;
  if (bytes.size() >= 4 && reader.at<uint32_t>(0) == kGlbMagic)
    binary = splitBinary(bytes);
  else
    parseJson(std::as_bytes(std::span(textOfFile(bytes, name))), 0);
  checkRequiredExtensions(*this);
  loadBuffers(binary, read_beside);
}

std::span<const std::byte> GltfDocument::splitBinary(std::span<const std::byte> bytes) {
  const ByteReader reader(bytes, name_);
  const auto version = reader.at<uint32_t>(4);
  if (version != 2)
    reader.fail(fmt::format("this is version {} of glTF", version), 4, "export it as glTF 2.0");
  const uint64_t length = reader.at<uint32_t>(8);
  if (length < 20 || length > reader.size())
    reader.fail(fmt::format("the header says {} bytes, the file has {}", length, reader.size()), 8);
  const auto chunk = [&](uint64_t at, uint32_t type, const char* what) {
    if (reader.at<uint32_t>(at + 4, "chunk header") != type)
      reader.fail(fmt::format("this is not a {}", what), at + 4);
    const uint64_t chunk_bytes = reader.at<uint32_t>(at, "chunk header");
    reader.require(at + 8, chunk_bytes, 1, what);
    return bytes.subspan(at + 8, chunk_bytes);
  };
  const std::span<const std::byte> text = chunk(12, kJsonChunk, "JSON chunk");
  parseJson(text, 20);
  const uint64_t binary_at = 20 + uint64_t{text.size()};
  if (binary_at + 8 > length) return {};
  return chunk(binary_at, kBinaryChunk, "binary chunk");
}

void GltfDocument::parseJson(std::span<const std::byte> text, uint64_t file_offset) {
  const std::string_view characters(reinterpret_cast<const char*>(text.data()), text.size());
  if (const std::optional<size_t> at = tooDeep(characters))
    fail("its JSON is nested too deeply", fmt::format("byte {}", file_offset + *at));
  try {
    root_ = json::parse(characters);
  } catch (const json::parse_error& failure) {
    fail("its JSON cannot be read", fmt::format("byte {}", file_offset + failure.byte));
  } catch (const json::exception&) {
    fail("its JSON holds a number out of range", fmt::format("byte {}", file_offset));
  }
  if (!root_.is_object()) fail("its JSON is not an object", fmt::format("byte {}", file_offset));
  const auto asset = root_.find("asset");
  if (asset == root_.end() || !asset->is_object() || !asset->contains("version") ||
      !(*asset)["version"].is_string() ||
      !(*asset)["version"].get_ref<const std::string&>().starts_with("2."))
    fail("this is not glTF 2.0", "asset.version", "export it as glTF 2.0");
  checkVersion(*asset);
}

void GltfDocument::checkVersion(const json& asset) {
  if (const auto& version = asset["version"].get_ref<const std::string&>(); version != "2.0")
    doubts_.push_back(fmt::format("asset.version is {}: it is read as glTF 2.0", printable(version)));
  const auto least = asset.find("minVersion");
  if (least == asset.end()) return;
  const std::string text = least->is_string() ? least->get<std::string>() : "";
  const auto version = versionOf(text);
  if (!version) doubts_.push_back(fmt::format("asset.minVersion is not a version: '{}'", printable(text)));
  if (version && *version > std::pair(2.0, 0.0))
    fail(fmt::format("the file requires glTF {}, 2.0 is read", printable(text)), "asset.minVersion",
         "export it as glTF 2.0");
}

void GltfDocument::loadBuffers(std::span<const std::byte> binary, const ReadBeside& read_beside) {
  const auto list = root_.find("buffers");
  if (list == root_.end()) return;
  if (!list->is_array()) fail("this is not an array", "buffers");
  std::map<std::string, size_t> read;  // file -> index into owned_
  for (size_t b = 0; b < list->size(); ++b) {
    const std::string part = fmt::format("buffers[{}]", b);
    const json& description = entry("buffers", b, "buffers");
    const auto length = unsignedMember(description, "byteLength", part);
    if (!length) fail("a buffer has no byteLength", part);
    const auto uri = description.find("uri");
    if (uri == description.end()) {
      if (isMeshoptFallback(description)) {  // views of it are refused where they are used
        buffers_.push_back({});
        continue;
      }
      if (b != 0 || binary.empty()) fail("a buffer has neither a uri nor a binary chunk", part);
      buffers_.push_back(binary);
    } else {
      if (!uri->is_string()) fail("a buffer's uri is not a string", part);
      const auto& text = uri->get_ref<const std::string&>();
      const auto [known, is_new] = read.try_emplace(text, owned_.size());
      if (is_new) owned_.push_back(externalBuffer(text, part, read_beside));
      buffers_.push_back(owned_[known->second]);
    }
    if (*length > buffers_.back().size())
      fail(fmt::format("a buffer of {} bytes holds {}", *length, buffers_.back().size()), part);
    buffers_.back() = buffers_.back().first(*length);
  }
}

std::vector<std::byte> GltfDocument::externalBuffer(const std::string& uri, const std::string& part,
                                                    const ReadBeside& read_beside) const {
  if (uri.starts_with("data:")) {
    const size_t comma = uri.find(";base64,");
    auto bytes =
        comma == std::string::npos ? std::nullopt : decodeBase64(std::string_view(uri).substr(comma + 8));
    if (!bytes) fail("a buffer's data uri is not base64", part);
    return std::move(*bytes);
  }
  const std::filesystem::path relative = percentDecoded(uri);
  const bool leaves_folder = std::find(relative.begin(), relative.end(), "..") != relative.end();
  if (!read_beside || relative.empty() || relative.is_absolute() || leaves_folder ||
      uri.find(':') != std::string::npos || relative.native().find('\0') != std::string::npos)
    fail("a buffer names a file that is not read from here", part,
         "export as .glb, which holds everything in one file");
  return read_beside(relative);
}

const json& GltfDocument::entry(const char* array, uint64_t index, const std::string& asked_by) const {
  const auto list = root_.find(array);
  if (list == root_.end() || !list->is_array() || index >= list->size())
    fail(fmt::format("there is no {}[{}]", array, index), asked_by);
  const json& found = (*list)[index];
  if (!found.is_object()) fail("this is not an object", fmt::format("{}[{}]", array, index));
  return found;
}

std::optional<uint64_t> GltfDocument::unsignedMember(const json& object, const char* key,
                                                     const std::string& where) const {
  const auto member = object.find(key);
  if (member == object.end()) return std::nullopt;
  // Offsets and counts stay below 2^48, so that sums of a few cannot overflow.
  if (!member->is_number_unsigned() || member->get<uint64_t>() >> 48)
    fail(fmt::format("{} is not a whole number in range", key), where);
  return member->get<uint64_t>();
}

std::optional<std::vector<float>> GltfDocument::numbers(const json& object, const char* key,
                                                        const std::string& where) const {
  const auto member = object.find(key);
  if (member == object.end()) return std::nullopt;
  if (!member->is_array()) fail(fmt::format("{} is not an array", key), where);
  std::vector<float> values;
  for (const json& value : *member) {
    const double number = value.is_number() ? value.get<double>() : HUGE_VAL;
    if (!(std::abs(number) <= FLT_MAX))
      fail(fmt::format("{} holds something that is not a finite number", key), where);
    values.push_back(static_cast<float>(number));
  }
  return values;
}

std::optional<std::vector<float>> GltfDocument::numbers(const json& object, const char* key, size_t count,
                                                        const std::string& where) const {
  auto values = numbers(object, key, where);
  if (values && values->size() != count)
    fail(fmt::format("{} is not an array of {} numbers", key, count), where);
  return values;
}

}  // namespace strandcast
