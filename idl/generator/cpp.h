/* Writes the C++ of a checked IDL file. */
#ifndef KERVAN_IDL_CPP_H
#define KERVAN_IDL_CPP_H

#include "model.h"

/* pkg/msg/Name.hpp: the value types, their visitors and constants. `self` is the file's path as others include it,
   without the suffix: "sensor_msgs/msg/LaserScan". */
void add_header(text_t *out, const idl_pstate_t *state, const char *self);

/* pkg/msg/Name.cpp: the TypeSupport of each struct. */
void add_source(text_t *out, const idl_pstate_t *state, const char *self);

#endif
