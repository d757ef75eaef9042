/* A DDS program without a line of Kervan: Cyclone's C API and the C types that idlc makes. It stands for every peer
   that is not Kervan's, ROS 2 first of all. */
#ifndef KERVAN_TESTS_C_PEER_H
#define KERVAN_TESTS_C_PEER_H

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct c_peer_options {
  unsigned domain;
  const char *tag;
  bool reliable;
  bool transient_local;
  bool type_information; /* publish XTypes information, as idlc's programs do and ROS 2's do not */
  int count;
} c_peer_options_t;

/* Waits a moment; false when stdin has been closed: the test is done with this process, or died. */
bool c_peer_wanted(void);

/* Each says "ready" on stdout when somebody is matched, goes on while it is wanted, and gives an exit code. */

/* Reads rt/scan; says "sample <number> right", or wrong, for each sample. */
int c_peer_read(const c_peer_options_t *options);

/* Writes the samples 1 to `count` to rt/scan once somebody is matched; best effort over and over. */
int c_peer_write(const c_peer_options_t *options);

/* Writes `count` samples of another, shorter layout under the same type name; says "acknowledged" when they are. */
int c_peer_write_short(const c_peer_options_t *options);

/* Offers samples of that layout under a type name of its own; nobody can be matched. */
int c_peer_write_other(const c_peer_options_t *options);

#ifdef __cplusplus
}
#endif

#endif
