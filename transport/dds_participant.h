#pragma once
#include <sys/types.h>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/DataWriterListener.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>

#include <atomic>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "transport/dds.h"
#include "transport/dds_neighbours.h"
#include "transport/status_board.h"

namespace strandcast {

/// Whether a program of another user than `own` takes part in this DDS domain through shared memory. Segments
/// are accessible to their owner only: Fast DDS 2.9.1 receives nothing of the others' there, and a
/// participant that such a program sends to receives nothing more from any participant. `folder`: location of
/// the segments.
bool anotherUserSharesMemory(int domain, uid_t own, const std::filesystem::path& folder = "/dev/shm");

/// Removes segments of shared memory whose program was killed: Fast DDS 2.9.1 leaves 64 MiB of memory in use
/// by each of them until the machine restarts. Takes those of `own` user that are not locked and older than
/// 10 s. Returns how many it removed.
size_t removeDeadSegments(uid_t own, const std::filesystem::path& folder = "/dev/shm");

/// QoS of one topic of idl/strandcast.idl.
struct TopicProfile {
  const char* name;
  bool is_transient_local;
  int depth;                  // samples kept per instance
  int max_instances;          // per writer or reader
  bool is_per_groom;          // in the groom's partition
  bool is_exclusive = false;  // readers get the samples of the strongest live writer only
  bool is_withdrawn = false;  // writers dispose of their samples when they stop casting
};
extern const TopicProfile kGroomTopic, kHairsTopic, kBodiesTopic, kCollidersTopic, kGuidesTopic, kPoseTopic,
    kCommandTopic, kStatusTopic, kClaimTopic, kShowTopic, kReadersTopic;

/// Transport and discovery of a participant.
struct DdsNetwork {
  int domain = 0;
  bool uses_shared_memory = false;
  std::vector<std::string> peers = {};  // IPv4 addresses
  std::string discovery_server = {};    // "ADDRESS:PORT", or empty: multicast
  std::filesystem::path keys = {};      // folder, or empty: no security

  explicit DdsNetwork(int of_domain) : domain(of_domain) {}
  /// Without shared memory where a program of another user holds a live port, which it logs. Throws Error on
  /// options that exclude each other.
  explicit DdsNetwork(const DdsOptions& options);
};

/// A participant of the domain that owns its readers and writers; all are deleted together.
class DdsParticipant {
 public:
  /// States `role` in its user data, but not with keys: user data is not encrypted. `neighbours` (may be
  /// null) learns of other participants and must outlive this. Writers reach `further_grooms` too. Throws
  /// Error as makeDdsPublisher().
  DdsParticipant(const DdsNetwork& network, uint32_t groom_id, const std::optional<DdsRole>& role = {},
                 DdsNeighbours* neighbours = nullptr, const std::vector<uint32_t>& further_grooms = {});
  ~DdsParticipant();
  DdsParticipant(const DdsParticipant&) = delete;
  DdsParticipant& operator=(const DdsParticipant&) = delete;

  /// The listener must outlive the participant. `type` names the topic's type; the participant takes
  /// ownership. `strength` is used where the topic is exclusive. Throw Error.
  eprosima::fastdds::dds::DataWriter* createWriter(const TopicProfile& profile,
                                                   eprosima::fastdds::dds::TopicDataType* type,
                                                   eprosima::fastdds::dds::DataWriterListener* listener,
                                                   uint32_t strength = 0);
  /// As createWriter(); null where the participant has keys that do not permit the topic.
  eprosima::fastdds::dds::DataWriter* createWriterIfPermitted(
      const TopicProfile& profile, eprosima::fastdds::dds::TopicDataType* type,
      eprosima::fastdds::dds::DataWriterListener* listener);
  eprosima::fastdds::dds::DataReader* createReader(const TopicProfile& profile,
                                                   eprosima::fastdds::dds::TopicDataType* type,
                                                   eprosima::fastdds::dds::DataReaderListener* listener,
                                                   bool is_reliable = true);
  /// As createReader(); null where the participant has keys that do not permit the topic.
  eprosima::fastdds::dds::DataReader* createReaderIfPermitted(
      const TopicProfile& profile, eprosima::fastdds::dds::TopicDataType* type,
      eprosima::fastdds::dds::DataReaderListener* listener);

 private:
  eprosima::fastdds::dds::DataWriter* makeWriter(const TopicProfile& profile,
                                                 eprosima::fastdds::dds::TopicDataType* type,
                                                 eprosima::fastdds::dds::DataWriterListener* listener,
                                                 uint32_t strength);
  eprosima::fastdds::dds::DataReader* makeReader(const TopicProfile& profile,
                                                 eprosima::fastdds::dds::TopicDataType* type,
                                                 eprosima::fastdds::dds::DataReaderListener* listener,
                                                 bool is_reliable);
  eprosima::fastdds::dds::Topic* topic(const TopicProfile& profile,
                                       eprosima::fastdds::dds::TopicDataType* type);
  [[noreturn]] void fail(const std::string& what);

  const int domain_;
  const std::filesystem::path keys_;
  eprosima::fastdds::dds::DomainParticipant* participant_ = nullptr;
  eprosima::fastdds::dds::Publisher* groom_publisher_ = nullptr;   // in the groom's partition
  eprosima::fastdds::dds::Publisher* common_publisher_ = nullptr;  // in no partition
  eprosima::fastdds::dds::Subscriber* groom_subscriber_ = nullptr;
  eprosima::fastdds::dds::Subscriber* common_subscriber_ = nullptr;
};

/// Callbacks on the writers of a topic.
struct WriterHandlers {
  using Handler = std::function<void(const StatusBoard::WriterId& writer)>;
  Handler found = {}, left = {};
  Handler disposed = {};  ///< the writer disposed of its samples; it still exists
};

/// Takes every sample on arrival, in Fast DDS's thread, and passes it to a handler.
template <class Message>
class SampleListener final : public eprosima::fastdds::dds::DataReaderListener {
 public:
  using Handler = std::function<void(Message& sample, const StatusBoard::WriterId& writer)>;
  /// `handler` may move the sample. The callbacks of `writers` may be empty. Several threads may
  /// call all of them at once: they must lock shared state, and must not call DDS while they hold a lock.
  explicit SampleListener(Handler handler, WriterHandlers writers = {})
      : handler_(std::move(handler)), writers_(std::move(writers)) {}

  void on_data_available(eprosima::fastdds::dds::DataReader* reader) override {
    // Writers of this process deliver in their own threads, possibly several at once and with the reader's
    // mutex locked. A lock around the reader's calls could deadlock with it. Each thread has its own sample
    // instead.
    thread_local Message sample;
    eprosima::fastdds::dds::SampleInfo info;
    while (reader->take_next_sample(&sample, &info) == eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK) {
      const StatusBoard::WriterId writer = writerId(info.publication_handle);
      if (info.valid_data)
        handler_(sample, writer);
      else if (writers_.disposed)
        writers_.disposed(writer);
    }
  }
  void on_subscription_matched(eprosima::fastdds::dds::DataReader*,
                               const eprosima::fastdds::dds::SubscriptionMatchedStatus& status) override {
    matched_ = status.current_count;
    const WriterHandlers::Handler& tell = status.current_count_change < 0 ? writers_.left : writers_.found;
    if (tell) tell(writerId(status.last_publication_handle));
  }
  /// Number of writers that the reader is matched with.
  uint32_t matched() const { return static_cast<uint32_t>(matched_.load()); }

 private:
  static StatusBoard::WriterId writerId(const eprosima::fastrtps::rtps::InstanceHandle_t& handle) {
    StatusBoard::WriterId id;
    for (size_t i = 0; i < id.size(); ++i) id[i] = handle.value[i];
    return id;
  }
  Handler handler_;
  WriterHandlers writers_;
  std::atomic<int> matched_{0};
};

/// Counts the readers that a writer is matched with.
class MatchCounter final : public eprosima::fastdds::dds::DataWriterListener {
 public:
  void on_publication_matched(eprosima::fastdds::dds::DataWriter*,
                              const eprosima::fastdds::dds::PublicationMatchedStatus& status) override {
    matched_ = status.current_count;
    ever_matched_ = status.total_count;
  }
  uint32_t matched() const { return static_cast<uint32_t>(matched_.load()); }
  /// Including readers that have left.
  uint32_t everMatched() const { return static_cast<uint32_t>(ever_matched_.load()); }

 private:
  std::atomic<int> matched_{0}, ever_matched_{0};
};

}  // namespace strandcast
