#include <spdlog/spdlog.h>

#include <algorithm>
#include <atomic>
#include <deque>
#include <iterator>
#include <mutex>

#include "core/error.h"
#include "transport/chunks.h"
#include "transport/codec/guide_encoder.h"
#include "transport/commands.h"
#include "transport/dds.h"
#include "transport/dds_claim.h"
#include "transport/dds_participant.h"
#include "transport/dds_type.h"
#include "transport/pose_inbox.h"
#include "transport/reader_reports.h"
#include "transport/versions.h"

namespace strandcast {
namespace {

namespace dds = eprosima::fastdds::dds;

const eprosima::fastrtps::Duration_t kFinalAckTimeout{1, 0};
/// Time in which a daemon that shares its groom may not have heard of participants without a role.
constexpr std::chrono::milliseconds kSettleTime{1500};
/// Chunks of a show's hair per frame: some 30 MB/s at 60 frames a second.
constexpr int kHairChunksPerFrame = 8;
/// A claimant's writer of claims and its status are discovered in either order, within this time.
constexpr std::chrono::milliseconds kClaimDiscoveryTime{2000};
/// The writers of a participant are discovered within a second; one that was killed remains known for its
/// lease of 3 s.
constexpr std::chrono::milliseconds kWriterDiscoveryTime{3500};

class DdsPublisher final : public Publisher {
 public:
  explicit DdsPublisher(const DdsOptions& options)
      : options_(options),
        poses_(options.groom_id),
        announced_(options.groom_id, options.session, options.codec),
        command_listener_([this](Command& command, const auto&) { receive(command); }),
        status_listener_([this](Status& status, const auto& writer) { receive(status, writer); },
                         {.left = [this](const auto& writer) { others_.remove(writer); },
                          .disposed = [this](const auto& writer) { others_.remove(writer); }}),
        pose_listener_([this](PoseSamples& samples, const auto&) { poses_.push(std::move(samples)); }),
        report_listener_([this](ReaderReport& report, const auto&) {
          if (report.groom_id == options_.groom_id) reports_.add(report);
        }),
        show_listener_([this](ShowChunk& chunk, const auto&) { receive(chunk); }),
        state_shows_(options.groom_id, ShowChunk::kState),
        hair_shows_(options.groom_id, ShowChunk::kStateAndHair),
        neighbours_([this] { warnOnce(); }),
        participant_(DdsNetwork(options), options.groom_id,
                     DdsRole{true, options.groom_id, options.claim.has_value()}, &neighbours_) {
    // Before the reader of statuses, whose thread uses it.
    if (options.claim) claim_.emplace(options.groom_id, options.session, *options.claim, neighbours_);
    participant_.createReader(kStatusTopic, new WireType<Status>, &status_listener_);
    participant_.createReader(kCommandTopic, new WireType<Command>, &command_listener_);
    participant_.createReaderIfPermitted(kPoseTopic, new WireType<PoseSamples>, &pose_listener_);
    participant_.createReaderIfPermitted(kReadersTopic, new WireType<ReaderReport>, &report_listener_);
    status_writer_ = participant_.createWriter(kStatusTopic, new WireType<Status>, nullptr);
    groom_writer_ = participant_.createWriter(kGroomTopic, new WireType<GroomChunk>, nullptr);
    hair_writer_ = participant_.createWriter(kHairsTopic, new WireType<HairChunk>, nullptr);
    body_writer_ = participant_.createWriter(kBodiesTopic, new WireType<BodyChunk>, nullptr);
    collider_writer_ = participant_.createWriter(kCollidersTopic, new WireType<ColliderChunk>, nullptr);
    guide_writer_ = participant_.createWriter(kGuidesTopic, new WireType<GuideChunk>, &readers_);
    if (options.claim) {
      relay_ = participant_.createWriterIfPermitted(kCommandTopic, new WireType<Command>, nullptr);
      show_writer_ = participant_.createWriter(kShowTopic, new WireType<ShowChunk>, &sharers_);
      claim_->join(participant_, options.keys.empty() ? kSettleTime : kSecureConflictListenTime);
    }
    publishStatus({});  // so that rivals learn of this session at once
  }

  ~DdsPublisher() override {
    if (claim_) claim_->stop();
    status_writer_->wait_for_acknowledgments(kFinalAckTimeout);
  }

  void announce(const GroomDescription& groom, const BodyDescription& body) override {
    described_ = announced_.chunksOf(groom, body);
    described_hairs_.clear();
    if (!claim_ || announced_turn_ != 0) {
      write(described_);
      write(described_hairs_);  // the last ones followed the last groom
    }
    announced_.accept(groom);
  }

  void announceHairs(const HairDescription& hairs) override {
    described_hairs_ = announced_.chunksOf(hairs);
    if (!claim_ || announced_turn_ != 0) write(described_hairs_);
  }

  void announceColliders(const ColliderSet& colliders) override {
    checkColliders(colliders, "groom " + std::to_string(options_.groom_id));
    ColliderSet own = colliders;
    own.groom_id = options_.groom_id;
    own.session = options_.session;
    described_colliders_ = splitColliders(own);
    if (!claim_ || announced_turn_ != 0) write(described_colliders_);
  }

  void publish(const GuideFrame& frame) override {
    FrameGuides guides(frame);
    send(frame, guides);
  }
  void publishFrom(GuideFrame& frame, GuideSource& guides) override { send(frame, guides); }
  void send(const GuideFrame& frame, GuideSource& guides) {
    // Not earlier: a claim silences the casting daemon, and only now are there frames to replace its own
    if (claim_) claim_->claim();
    if (claim_ && !updateOwnership()) return;
    repeatWhatReadersLack();
    sendHair();
    announced_.divide(frame, guides, [this](GuideChunk& chunk) { guide_writer_->write(&chunk); });
  }

  void publishStatus(const Status& status) override {
    if (claim_ && claim_->turn() == 0) return;
    Status sample = status;
    sample.groom_id = options_.groom_id;
    sample.session = options_.session;
    status_writer_->write(&sample);
    has_status_ = true;
  }

  std::optional<Command> takeCommand() override {
    std::optional<Command> command = commands_.take();
    // The sender may have discovered only this daemon, and may end before the others discover it.
    if (command && claim_ && claim_->turn() != 0 && relay_ != nullptr) relay_->write(&*command);
    return command;
  }

  std::optional<PoseSamples> takePoses() override { return poses_.take(); }

  CastingState castingState() const override {
    return claim_ ? claim_->castingState() : CastingState::kUnshared;
  }

  bool yields() const override { return claim_ && claim_->yields(); }

  void withdrawClaim() override {
    if (claim_) claim_->resetClaims();
  }

  bool hasUnreachableDaemonOfGroom() const override { return hasUnreachableDaemon(kWriterDiscoveryTime); }

  bool pollClaimLoss() override {
    if (!claim_ || !claim_->hasStalled()) return false;
    if (sharers() == 0) {
      claim_->restartClaims();
      return false;
    }
    claim_->rejoin();
    updateOwnership();
    const std::lock_guard lock(show_mutex_);
    newest_hair_.reset();
    newest_state_.reset();
    return true;
  }

  size_t sharers() const override {
    const uint32_t own = reads_shows_ ? 1 : 0;  // the writer is matched with this daemon's own reader too
    return std::max(sharers_.matched(), own) - own;
  }
  bool wantsHair() const override { return sharers() > 0 && sharers_.everMatched() != hair_sent_to_; }

  void publishShow(const Show& show) override {
    if (!claim_ || claim_->turn() == 0) return;
    if (show.hasHair()) hair_sent_to_ = sharers_.everMatched();
    Show own = show;
    own.session = options_.session;
    own.revision = ++show_revision_;
    std::vector<ShowChunk> chunks = splitShow(own, options_.groom_id);
    if (show.hasHair()) {
      waiting_hair_.assign(std::make_move_iterator(chunks.begin()), std::make_move_iterator(chunks.end()));
      return;
    }
    for (ShowChunk& chunk : chunks) show_writer_->write(&chunk);
  }

  std::optional<Show> takeShow() override {
    // Not earlier: the casting daemon sends the hair to a new reader at once, and it would be outdated by the
    // time the scene is loaded.
    if (!std::exchange(reads_shows_, true))
      participant_.createReader(kShowTopic, new WireType<ShowChunk>, &show_listener_);
    const std::lock_guard lock(show_mutex_);
    for (std::optional<Show>* const newest : {&newest_hair_, &newest_state_}) {
      if (!*newest) continue;
      std::optional<Show> show = std::exchange(*newest, std::nullopt);
      if (show->session == claim_->holder()) return show;
    }
    return std::nullopt;
  }

  uint32_t matchedReaders() const override { return readers_.matched(); }
  ReaderSummary readers() const override {
    ReaderSummary summary = reports_.summary();
    if (reports_.count() < readers_.matched()) summary.largest_pixels = -1;
    return summary;
  }
  EncodingReport encoding() const override { return announced_.encoding(); }
  std::optional<OtherVersion> otherVersion() const override {
    return neighbours_.otherVersion(options_.groom_id, false);
  }
  std::optional<ConflictingDaemon> conflict() const override {
    if (!claim_) return others_.conflictOf(options_.groom_id, options_.session);
    return others_.conflictOf(options_.groom_id, options_.session, [this](const auto& writer, auto heard) {
      if (claim_->isOfClaimant(writer)) return false;
      const std::optional<DdsRole> role = neighbours_.roleOfWriter(writer);
      return role ? !role->claims : heard > kClaimDiscoveryTime;
    });
  }
  size_t possibleConflicts() const override {
    return neighbours_.possibleConflicts(options_.groom_id, options_.claim.has_value());
  }
  std::chrono::milliseconds listenTime() const override {
    if (hasUnreachableDaemon(std::chrono::milliseconds(0))) return kWriterDiscoveryTime + kShortListenTime;
    // Clients of a discovery server discover each other through its slower exchange.
    if (possibleConflicts() == 0 && options_.discovery_server.empty()) return kShortListenTime;
    return (options_.keys.empty() ? kConflictListenTime : kSecureConflictListenTime) *
           (options_.claim ? kSharedListenFactor : 1);
  }

 private:
  /// Always false over UDP: it reaches every machine, and losses are repaired.
  bool hasUnreachableDaemon(std::chrono::milliseconds time) const {
    return options_.profile == DdsProfile::kLocal &&
           neighbours_.hasDaemonWithoutWriters(options_.groom_id, time);
  }

  /// Sends some of the waiting chunks. All at once would overflow the readers' sockets and delay the frame.
  void sendHair() {
    for (int sent = 0; sent < kHairChunksPerFrame && !waiting_hair_.empty(); ++sent) {
      show_writer_->write(&waiting_hair_.front());
      waiting_hair_.pop_front();
    }
  }

  void warnOnce() {
    const auto other = otherVersion();
    if (other && !has_warned_.exchange(true))
      spdlog::warn(warningOf(*other, options_.groom_id, "DDS domain " + std::to_string(options_.domain)));
  }

  void write(AnnouncedGroom::Chunks chunks) {
    groom_chunks_ = replace(*groom_writer_, std::move(chunks.groom), groom_chunks_);
    body_chunks_ = replace(*body_writer_, std::move(chunks.body), body_chunks_);
  }

  void write(std::vector<HairChunk> chunks) {
    hair_chunks_ = replace(*hair_writer_, std::move(chunks), hair_chunks_);
  }

  void write(std::vector<ColliderChunk> chunks) {
    collider_chunks_ = replace(*collider_writer_, std::move(chunks), collider_chunks_);
  }

  /// Fast DDS 2.9.1 sometimes does not deliver a late joiner all samples that are kept for it.
  void repeatWhatReadersLack() {
    const uint32_t overdue = reports_.takeOverdue();
    if ((overdue & ReaderReport::kGroomAndBody) != 0) write(described_);
    if ((overdue & ReaderReport::kHairs) != 0) write(described_hairs_);
    if ((overdue & ReaderReport::kColliders) != 0) write(described_colliders_);
  }

  /// Whether this daemon holds the claim. On a change, announces or withdraws the groom: late joiners must
  /// get that of the casting daemon only.
  bool updateOwnership() {
    const uint64_t turn = claim_->turn();
    if (turn != announced_turn_) {
      write(turn != 0 ? described_ : AnnouncedGroom::Chunks());
      write(turn != 0 ? described_hairs_ : std::vector<HairChunk>());
      write(turn != 0 ? described_colliders_ : std::vector<ColliderChunk>());
      announced_turn_ = turn;
    }
    if (turn == 0 && has_status_) withdrawStatus();
    return turn != 0;
  }

  /// Disposes of the status, so that readers forget this daemon and late joiners do not get its last status.
  void withdrawStatus() {
    Status sample;
    sample.groom_id = options_.groom_id;
    sample.session = options_.session;
    status_writer_->dispose(&sample, eprosima::fastrtps::rtps::InstanceHandle_t());
    has_status_ = false;
  }

  /// Writes all chunks and disposes of surplus ones of the last announcement, so that late joiners do not get
  /// chunks of two revisions. Returns the number of chunks.
  template <class Chunk>
  uint32_t replace(dds::DataWriter& writer, std::vector<Chunk> chunks, uint32_t count_before) {
    for (Chunk& chunk : chunks) {
      if (!writer.write(&chunk)) {
        throw Error("the groom's description cannot be written",
                    "DDS domain " + std::to_string(options_.domain), "see the messages of Fast DDS above");
      }
    }
    const auto count = static_cast<uint32_t>(chunks.size());
    Chunk sample;
    sample.groom_id = options_.groom_id;
    for (uint32_t index = count; index < count_before; ++index) {
      sample.chunk_index = index;
      writer.dispose(&sample, eprosima::fastrtps::rtps::InstanceHandle_t());
    }
    return count;
  }

  void receive(Command& command) {
    if (command.groom_id == options_.groom_id && isSound(command)) commands_.push(std::move(command));
  }

  void receive(ShowChunk& chunk) {
    if (chunk.session == options_.session) return;
    const std::lock_guard lock(show_mutex_);
    const bool has_hair = chunk.part == ShowChunk::kStateAndHair;
    std::optional<Show> show = (has_hair ? hair_shows_ : state_shows_).add(std::move(chunk));
    if (show) (has_hair ? newest_hair_ : newest_state_) = std::move(show);
  }

  void receive(Status& status, const StatusBoard::WriterId& writer) {
    if (status.groom_id == options_.groom_id && status.session != options_.session)
      others_.post(writer, std::move(status));
  }

  const DdsOptions options_;
  CommandQueue commands_;
  PoseInbox poses_;
  StatusBoard others_;  // of this groom
  AnnouncedGroom announced_;
  uint32_t groom_chunks_ = 0, hair_chunks_ = 0, body_chunks_ = 0, collider_chunks_ = 0;
  // Last announced, or to be announced when this daemon takes over
  AnnouncedGroom::Chunks described_;
  std::vector<HairChunk> described_hairs_;
  std::vector<ColliderChunk> described_colliders_;
  uint64_t announced_turn_ = 0;  // DdsClaim::turn() of the last announcement
  bool has_status_ = false;      // whether readers have a status of this session
  // Listeners before the participant, which is destroyed first, with the threads that call them.
  MatchCounter readers_;
  SampleListener<Command> command_listener_;
  SampleListener<Status> status_listener_;
  SampleListener<PoseSamples> pose_listener_;
  ReaderReports reports_;
  SampleListener<ReaderReport> report_listener_;
  MatchCounter sharers_;
  std::mutex show_mutex_;  // guards the shows received
  SampleListener<ShowChunk> show_listener_;
  ShowAssembler state_shows_, hair_shows_;
  std::optional<Show> newest_state_, newest_hair_;
  std::deque<ShowChunk> waiting_hair_;
  bool reads_shows_ = false;
  uint32_t show_revision_ = 0, hair_sent_to_ = 0;  // hair_sent_to_: of MatchCounter::everMatched()
  std::atomic<bool> has_warned_{false};
  DdsNeighbours neighbours_;
  std::optional<DdsClaim> claim_;
  DdsParticipant participant_;
  dds::DataWriter* status_writer_ = nullptr;
  dds::DataWriter* groom_writer_ = nullptr;
  dds::DataWriter* hair_writer_ = nullptr;
  dds::DataWriter* body_writer_ = nullptr;
  dds::DataWriter* collider_writer_ = nullptr;
  dds::DataWriter* guide_writer_ = nullptr;
  dds::DataWriter* show_writer_ = nullptr;
  dds::DataWriter* relay_ = nullptr;  ///< forwards commands to the standbys
};

}  // namespace

bool ddsAvailable(std::string* reason) {
  if (reason) reason->clear();
  return true;
}

std::unique_ptr<Publisher> makeDdsPublisher(const DdsOptions& options) {
  checkGroomId(options.groom_id, "DDS options");
  if (options.session == 0)
    throw Error("a publisher needs a session", "DDS options", "choose one at random, not 0");
  checkCodecOptions(options.codec, "DDS options");
  return std::make_unique<DdsPublisher>(options);
}

}  // namespace strandcast
