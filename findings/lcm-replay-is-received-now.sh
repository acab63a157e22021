#!/usr/bin/env bash
# LCM 1.3.1: replayed from a log, a message's recv_utime is when it is replayed, not when it was recorded.
# Package: liblcm-dev 1.3.1 (Debian 12)
# Expected: the time that the log keeps for each event, which is when the logger received it.
# Seen: the present time. The time in the log is not handed on.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
# have PACKAGE VERSION: it is installed in this version, or is unpacked below root/.
have() {
  case $(dpkg-query -W -f "\${Version}" "$1" 2>/dev/null) in "$2"*) return ;; esac
  { apt-get download "$1" && deb=$(ls "$1"_*.deb) && dpkg -x "$deb" root; } >/dev/null 2>&1 || deb=
  case $([ -n "$deb" ] && dpkg-deb -f "$deb" Version) in "$2"*) return ;; esac
  echo "skipped: $1 $2 cannot be had"
  exit 77
}
have liblcm-dev 1.3.1
have liblcm1 1.3.1
lib=root/usr/lib/$(gcc -print-multiarch)
export LD_LIBRARY_PATH=$work/$lib
cat > replay.c <<'C'
#include <lcm/lcm.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
static const int64_t kRecorded = 1000000000000000;  // September 2001, microseconds since 1970
static int64_t received;
static void take(const lcm_recv_buf_t *message, const char *channel, void *user) { received = message->recv_utime; }
int main(void) {
  lcm_eventlog_t *log = lcm_eventlog_create("take.log", "w");
  lcm_eventlog_event_t event = {0, kRecorded, 4, 1, "POSE", "x"};
  lcm_eventlog_write_event(log, &event);
  lcm_eventlog_destroy(log);
  lcm_t *replay = lcm_create("file://take.log?speed=0");
  if (!replay) return 77;
  lcm_subscribe(replay, "POSE", take, NULL);
  lcm_handle(replay);
  int64_t now = (int64_t)time(NULL) * 1000000;
  printf("recorded at %lld us, replayed as received at %lld us, now %lld us\n", (long long)kRecorded, (long long)received,
         (long long)now);
  return received != kRecorded && llabs(now - received) < 60000000 ? 0 : 1;
}
C
gcc -I root/usr/include replay.c -o replay -L "$lib" -l:liblcm.so.1
./replay
