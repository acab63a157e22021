/* A renderer made from idl/strandcast.idl and docs/wire.md alone, over another vendor's DDS (Eclipse Cyclone
 * DDS). Joins groom 1 of a domain, receives the groom and then FRAMES frames, sends poses of the head, repeats a
 * command until it is answered, and prints "key value" lines.
 *
 *   cyclone_reader DOMAIN FRAMES COMMAND_ID
 *
 * Expects frames in float32 whose vertex v of frame n is at (v, n, 1), as tests/transport/sample_messages.h
 * makes them.
 */
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dds/dds.h"
#include "strandcast.h"

enum { kMaxChunks = 4096, kTake = 64, kFramesUnderWay = 64 };
enum { kFloat32 = 0 }; /* GuideChunk.encoding */

typedef strandcast_v7_GroomChunk GroomChunk;
typedef strandcast_v7_GuideChunk GuideChunk;
typedef strandcast_v7_Status Status;

static dds_entity_t checked(dds_entity_t entity, const char* what) {
  if (entity < 0) {
    fprintf(stderr, "%s: %s\n", what, dds_strretcode(-entity));
    exit(2);
  }
  return entity;
}

static dds_qos_t* reliable(int depth, bool is_transient_local) {
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
  dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, depth);
  dds_qset_durability(qos, is_transient_local ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  return qos;
}

static dds_entity_t reader_of(dds_entity_t participant, dds_entity_t subscriber,
                              const dds_topic_descriptor_t* type, const char* name, int depth,
                              bool is_transient_local) {
  dds_qos_t* qos = reliable(depth, is_transient_local);
  const dds_entity_t topic = checked(dds_create_topic(participant, type, name, NULL, NULL), name);
  const dds_entity_t reader = checked(dds_create_reader(subscriber, topic, qos, NULL), name);
  dds_delete_qos(qos);
  return reader;
}

static dds_entity_t subscriber_in(dds_entity_t participant, const char* partition) {
  dds_qos_t* qos = dds_create_qos();
  dds_qset_partition1(qos, partition);
  const dds_entity_t subscriber = checked(dds_create_subscriber(participant, qos, NULL), "subscriber");
  dds_delete_qos(qos);
  return subscriber;
}

static dds_entity_t writer_in(dds_entity_t participant, const char* partition,
                              const dds_topic_descriptor_t* type, const char* name, int depth) {
  dds_qos_t* qos = dds_create_qos();
  dds_qset_partition1(qos, partition);
  const dds_entity_t publisher = checked(dds_create_publisher(participant, qos, NULL), "publisher");
  dds_delete_qos(qos);
  const dds_entity_t topic = checked(dds_create_topic(participant, type, name, NULL, NULL), name);
  qos = reliable(depth, true);
  const dds_entity_t writer = checked(dds_create_writer(publisher, topic, qos, NULL), name);
  dds_delete_qos(qos);
  return writer;
}

/* Takes chunks of the groom, in any order; true when all have come. */
static bool take_groom(dds_entity_t reader, uint32_t* strands, uint32_t* vertices) {
  static bool has[kMaxChunks];
  static uint32_t received, sum_strands, sum_vertices;
  void* samples[kTake] = {NULL};
  dds_sample_info_t infos[kTake];
  const int count = dds_take(reader, samples, infos, kTake, kTake);
  bool is_complete = false;
  for (int i = 0; i < count; ++i) {
    const GroomChunk* chunk = samples[i];
    if (!infos[i].valid_data || chunk->chunk_index >= kMaxChunks || has[chunk->chunk_index]) continue;
    has[chunk->chunk_index] = true;
    sum_strands += chunk->vertex_counts._length;
    sum_vertices += chunk->positions._length / 3;
    if (++received == chunk->chunk_count) {
      is_complete = sum_strands == chunk->total_strands && sum_vertices == chunk->total_vertices;
      *strands = chunk->total_strands;
      *vertices = chunk->total_vertices;
    }
  }
  if (count > 0) dds_return_loan(reader, samples, count);
  return is_complete;
}

static bool is_as_sent(const GuideChunk* chunk) {
  if (chunk->encoding != kFloat32 || chunk->writers != 1 || chunk->payload._length != 12 * chunk->vertex_count)
    return false;
  for (uint32_t v = 0; v < chunk->vertex_count; ++v) {
    float position[3];
    memcpy(position, chunk->payload._buffer + 12 * v, sizeof position);
    if (position[0] != (float)(chunk->first_vertex + v) || position[1] != (float)chunk->frame ||
        position[2] != 1)
      return false;
  }
  return true;
}

/* Vertices received of incomplete frames; a frame is complete when it has all of the groom's. */
static struct {
  uint64_t frame;
  uint32_t vertices;
} under_way[kFramesUnderWay];

static uint64_t first_frame, newest_whole, whole_frames, wrong_chunks;

static void take_guides(dds_entity_t reader, uint32_t groom_vertices) {
  void* samples[kTake] = {NULL};
  dds_sample_info_t infos[kTake];
  const int count = dds_take(reader, samples, infos, kTake, kTake);
  for (int i = 0; i < count; ++i) {
    const GuideChunk* chunk = samples[i];
    if (!infos[i].valid_data) continue;
    wrong_chunks += is_as_sent(chunk) ? 0 : 1;
    if (chunk->chunk_index == 0)
      wrong_chunks += chunk->colliders._length == 2 && chunk->colliders._buffer[0] == 7 &&
                              chunk->collider_poses._length == 14 &&
                              chunk->collider_poses._buffer[2] == (float)chunk->frame &&
                              chunk->bent_colliders._length == 1 && chunk->bent_colliders._buffer[0] == 7 &&
                              chunk->collider_bends._length == 33 &&
                              chunk->collider_bends._buffer[3] == (float)chunk->frame + 1
                          ? 0
                          : 1;
    const size_t place = chunk->frame % kFramesUnderWay;
    if (under_way[place].frame != chunk->frame) {
      under_way[place].frame = chunk->frame;
      under_way[place].vertices = 0;
    }
    under_way[place].vertices += chunk->vertex_count;
    if (under_way[place].vertices != groom_vertices) continue;
    if (first_frame == 0) first_frame = chunk->frame;
    if (chunk->frame > newest_whole) newest_whole = chunk->frame;
    ++whole_frames;
  }
  if (count > 0) dds_return_loan(reader, samples, count);
}

/* Counts of colliders: shapes and words of all chunks. */
static uint32_t shapes, words, spheres_of_the_head;

static void take_colliders(dds_entity_t reader) {
  void* samples[kTake] = {NULL};
  dds_sample_info_t infos[kTake];
  const int count = dds_take(reader, samples, infos, kTake, kTake);
  for (int i = 0; i < count; ++i) {
    const strandcast_v7_ColliderChunk* chunk = samples[i];
    if (!infos[i].valid_data) continue;
    shapes += chunk->kinds._length;
    words += chunk->words._length;
    for (uint32_t s = 0; s < chunk->kinds._length; ++s)
      spheres_of_the_head += chunk->kinds._buffer[s] == 0 && chunk->follows_head._buffer[s] == 1 &&
                             chunk->numbers._buffer[16 * s + 6] == 0.05f;
  }
  if (count > 0) dds_return_loan(reader, samples, count);
}

/* Sets `value` to the first component of a parameter in a status; false if it is not there. */
static bool value_of(const Status* status, const char* name, float* value) {
  uint32_t at = 0;
  const char* known = status->parameter_names;
  for (uint32_t i = 0; i < status->parameter_components._length; ++i) {
    const size_t length = strcspn(known, " ");
    if (length == strlen(name) && strncmp(known, name, length) == 0) {
      *value = status->parameter_values._buffer[at];
      return true;
    }
    at += status->parameter_components._buffer[i];
    known += length + (known[length] == ' ');
  }
  return false;
}

static float told_wind;
static uint32_t told_parameters;

static bool is_answered(dds_entity_t reader, uint64_t id) {
  void* samples[kTake] = {NULL};
  dds_sample_info_t infos[kTake];
  const int count = dds_take(reader, samples, infos, kTake, kTake);
  bool found = false;
  for (int i = 0; i < count; ++i) {
    const Status* status = samples[i];
    if (!infos[i].valid_data || status->last_command != id) continue;
    found = value_of(status, "wind", &told_wind);
    told_parameters = status->parameter_components._length;
  }
  if (count > 0) dds_return_loan(reader, samples, count);
  return found;
}

/* Moves the head. */
static void write_pose(dds_entity_t writer, uint64_t time) {
  static uint32_t number;
  uint32_t ages[] = {0};
  float pose[] = {0.25f, 0, 0, 0, 0.6f, 0, 0.8f};
  strandcast_v7_PoseSamples samples = {.source = 99, .time = time, .groom_id = 1, .newest = ++number};
  samples.names = "head";
  samples.weight_names = "";
  samples.ages._buffer = ages;
  samples.ages._length = samples.ages._maximum = 1;
  samples.poses._buffer = pose;
  samples.poses._length = samples.poses._maximum = 7;
  checked(dds_write(writer, &samples), "write");
}

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  const uint64_t frames = strtoull(argv[2], NULL, 10), id = strtoull(argv[3], NULL, 10);
  const dds_entity_t participant =
      checked(dds_create_participant((dds_domainid_t)atoi(argv[1]), NULL, NULL), "participant");
  const dds_entity_t subscriber = subscriber_in(participant, "groom1");
  const dds_entity_t groom =
      reader_of(participant, subscriber, &strandcast_v7_GroomChunk_desc, "strandcast/groom", 1, true);
  const dds_entity_t colliders =
      reader_of(participant, subscriber, &strandcast_v7_ColliderChunk_desc, "strandcast/colliders", 1, true);
  const dds_entity_t guides =
      reader_of(participant, subscriber, &strandcast_v7_GuideChunk_desc, "strandcast/guides", 4, false);
  const dds_entity_t status =
      reader_of(participant, participant, &strandcast_v7_Status_desc, "strandcast/status", 1, true);
  const dds_entity_t writer =
      writer_in(participant, "groom1", &strandcast_v7_Command_desc, "strandcast/command", 64);
  const dds_entity_t poses =
      writer_in(participant, "groom1", &strandcast_v7_PoseSamples_desc, "strandcast/pose", 16);

  const dds_time_t start = dds_time(), end = start + DDS_SECS(15);
  uint32_t strands = 0, vertices = 0;
  bool has_groom = false, has_answer = false;
  dds_time_t asked = 0, posed = 0;
  while (dds_time() < end && !(has_answer && whole_frames >= frames)) {
    if (!has_groom) {
      has_groom = take_groom(groom, &strands, &vertices);
      if (has_groom) printf("groom_after_ms %.1f\n", (double)(dds_time() - start) * 1e-6);
    } else {
      take_colliders(colliders);
      take_guides(guides, vertices);
      if (dds_time() - posed > DDS_MSECS(100)) {
        posed = dds_time();
        write_pose(poses, (uint64_t)(posed - start));
      }
      if (dds_time() - asked > DDS_MSECS(500) && !has_answer) {
        asked = dds_time();
        double values[] = {3, 0, 0};
        strandcast_v7_Command command = {.id = id, .groom_id = 1, .kind = 0, .name = "wind"};
        command.values._buffer = values;
        command.values._length = command.values._maximum = 3;
        checked(dds_write(writer, &command), "write");
      }
      has_answer = has_answer || is_answered(status, id);
    }
    dds_sleepfor(DDS_USECS(500));
  }
  printf("strands %u\nvertices %u\nanswered %d\n", strands, vertices, has_answer);
  printf("shapes %u\nwords %u\nspheres_of_the_head %u\n", shapes, words, spheres_of_the_head);
  printf("told_parameters %u\ntold_wind %f\n", told_parameters, (double)told_wind);
  printf("frames %llu\nmissing %llu\nwrong_chunks %llu\n", (unsigned long long)whole_frames,
         (unsigned long long)(newest_whole - first_frame + 1 - whole_frames),
         (unsigned long long)wrong_chunks);
  dds_delete(participant);
  return 0;
}
