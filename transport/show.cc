#include "transport/show.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "transport/chunks.h"
#include "transport/message_bytes.h"

namespace strandcast {
namespace {

/// Visits the arrays of a state.
template <class State, class Take>
void hairArrays(State& hair, const Take& take) {
  take(hair.positions);
  take(hair.velocities);
  take(hair.frames);
  take(hair.tensions);
  take(hair.contacts);
}

template <class Item>
std::vector<float> numbersOf(const std::vector<Item>& items) {
  std::vector<float> numbers(items.size() * sizeof(Item) / sizeof(float));
  if (!items.empty()) std::memcpy(numbers.data(), items.data(), items.size() * sizeof(Item));
  return numbers;
}

/// False where the floats are no whole number of items.
template <class Item>
bool takeNumbers(const std::vector<float>& numbers, std::vector<Item>& items) {
  constexpr size_t kNumbers = sizeof(Item) / sizeof(float);
  if (numbers.size() % kNumbers != 0) return false;
  items.resize(numbers.size() / kNumbers);
  if (!numbers.empty())
    std::memcpy(static_cast<void*>(items.data()), numbers.data(), numbers.size() * sizeof(float));
  return true;
}

bool isSoundHair(const StrandState& hair) {
  const size_t vertices = hair.positions.size();
  const auto fits = [&](size_t size) { return size == vertices || size == 0; };
  const bool frames_finite = std::all_of(hair.frames.begin(), hair.frames.end(),
                                         [](const Quat& q) { return q.coeffs().allFinite(); });
  return hair.velocities.size() == vertices && fits(hair.frames.size()) && fits(hair.tensions.size()) &&
         fits(hair.contacts.size()) && allFinite(hair.positions) && allFinite(hair.velocities) &&
         allFinite(hair.tensions) && allFinite(hair.contacts) && frames_finite;
}

bool isSound(const ShowEntry& entry) {
  return static_cast<uint32_t>(entry.kind) < kShowKinds && isSoundName(entry.name) &&
         entry.values.size() <= kMaxShowValues &&
         std::all_of(entry.values.begin(), entry.values.end(), [](double v) { return std::isfinite(v); });
}

}  // namespace

std::vector<uint8_t> showBytes(const Show& show) {
  std::vector<uint8_t> bytes;
  MessageWriter writer(bytes);
  writer.number(show.simulation_time);
  writer.number(static_cast<uint32_t>(show.entries.size()));
  for (const ShowEntry& entry : show.entries) {
    writer.number(static_cast<uint32_t>(entry.kind));
    writer.text(entry.name);
    writer.array(entry.values);
  }
  hairArrays(show.hair, [&](const auto& items) { writer.array(numbersOf(items)); });
  return bytes;
}

std::optional<Show> showOf(std::span<const uint8_t> bytes) {
  Show show;
  MessageReader reader(bytes);
  uint32_t count = 0;
  reader.number(show.simulation_time);
  reader.number(count);
  if (!reader.ok() || !std::isfinite(show.simulation_time) || count > kMaxShowEntries) return std::nullopt;
  for (uint32_t i = 0; i < count && reader.ok(); ++i) {
    ShowEntry& entry = show.entries.emplace_back();
    uint32_t kind = kShowKinds;
    reader.number(kind);
    reader.text(entry.name);
    reader.array(entry.values);
    entry.kind = static_cast<ShowKind>(kind);
    if (!reader.ok() || !isSound(entry)) return std::nullopt;
  }
  bool whole = true;
  hairArrays(show.hair, [&](auto& items) {
    std::vector<float> numbers;
    reader.array(numbers);
    whole = reader.ok() && whole && takeNumbers(numbers, items);
  });
  if (!whole || !reader.atEnd() || !isSoundHair(show.hair)) return std::nullopt;
  return show;
}

std::vector<ShowChunk> splitShow(const Show& show, uint32_t groom_id) {
  const std::vector<uint8_t> bytes = showBytes(show);
  const size_t count = (bytes.size() + kMaxChunkBytes - 1) / kMaxChunkBytes;
  if (count > kMaxChunks) return {};
  std::vector<ShowChunk> chunks(count);
  for (size_t i = 0; i < count; ++i) {
    ShowChunk& chunk = chunks[i];
    chunk.session = show.session;
    chunk.groom_id = groom_id;
    chunk.part = show.hasHair() ? ShowChunk::kStateAndHair : ShowChunk::kState;
    chunk.chunk_index = static_cast<uint32_t>(i);
    chunk.chunk_count = static_cast<uint32_t>(count);
    chunk.revision = show.revision;
    const auto first = bytes.begin() + static_cast<ptrdiff_t>(i * kMaxChunkBytes);
    const auto size = std::min(kMaxChunkBytes, bytes.size() - i * kMaxChunkBytes);
    chunk.payload.assign(first, first + static_cast<ptrdiff_t>(size));
  }
  return chunks;
}

std::optional<Show> ShowAssembler::add(ShowChunk&& chunk) {
  const bool is_last = chunk.chunk_index + 1 == chunk.chunk_count;
  const bool is_sound = chunk.session != 0 && chunk.groom_id == groom_id_ && chunk.part == part_ &&
                        chunk.chunk_count <= kMaxChunks && chunk.chunk_index < chunk.chunk_count &&
                        (is_last ? !chunk.payload.empty() && chunk.payload.size() <= kMaxChunkBytes
                                 : chunk.payload.size() == kMaxChunkBytes);
  if (!is_sound) {
    ++chunks_rejected_;
    return std::nullopt;
  }
  if (!chunks_.empty()) {
    const ShowChunk& first = chunks_.begin()->second;
    if (first.session == chunk.session && first.revision > chunk.revision)
      return std::nullopt;  // an older revision
    if (first.session != chunk.session || first.revision != chunk.revision ||
        first.chunk_count != chunk.chunk_count)
      chunks_.clear();
  }
  const uint32_t index = chunk.chunk_index, count = chunk.chunk_count;
  chunks_.insert_or_assign(index, std::move(chunk));
  if (chunks_.size() < count) return std::nullopt;
  std::vector<uint8_t> bytes;
  for (const auto& [i, piece] : chunks_)
    bytes.insert(bytes.end(), piece.payload.begin(), piece.payload.end());
  std::optional<Show> show = showOf(bytes);
  if (show && show->hasHair() != (part_ == ShowChunk::kStateAndHair)) show.reset();
  if (show) {
    show->session = chunks_.begin()->second.session;
    show->revision = chunks_.begin()->second.revision;
  } else {
    ++chunks_rejected_;
  }
  chunks_.clear();
  return show;
}

}  // namespace strandcast
