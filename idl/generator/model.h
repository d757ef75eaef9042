/* Questions about idlc's syntax tree that more than one part of the generator asks. */
#ifndef KERVAN_IDL_MODEL_H
#define KERVAN_IDL_MODEL_H

#include <stdbool.h>

#include "idl/processor.h"
#include "text.h"

/* Whether the node was written in the file being compiled, not in one it includes. */
bool in_main_file(const idl_pstate_t *state, const void *node);

/* Calls `visit` for each definition of the file being compiled, in order, going into modules. */
void for_each_definition(const idl_pstate_t *state, void (*visit)(const void *definition, void *argument),
                         void *argument);

/* The file's place in the ROS 2 layout, which is how others include it, without the suffix:
   "sensor_msgs/msg/LaserScan". The last two folders, because idlc does not tell its back ends the include directories.
 */
void add_file_name(text_t *out, const char *path);

/* The name with its modules: "sensor_msgs::msg::LaserScan" for separator "::". */
void add_scoped_name(text_t *out, const void *node, const char *separator);

/* The modules alone, empty for a definition outside of any. */
void add_scope(text_t *out, const void *node, const char *separator);

/* One struct member with its declarator: `long a, b[2];` is two of them. */
typedef struct field {
  const idl_member_t *member;
  const idl_declarator_t *declarator;
} field_t;

/* Iterates over the fields of a struct: start with {0}; false at the end. */
bool next_field(const idl_struct_t *type, field_t *field);

/* The type behind typedefs and arrays: `typedef double row[3]; row m[2];` is double. */
const idl_type_spec_t *innermost_type(const idl_type_spec_t *type);

/* The type of the elements behind typedefs, arrays and sequences. */
const idl_type_spec_t *element_type(const idl_type_spec_t *type);

/* Whether any member has @key. */
bool is_keyed(const idl_struct_t *type);

#endif
