/* The canonical text of a type's layout, and its hash. Two types with one hash mean the same bytes by the same names.
 */
#ifndef KERVAN_IDL_LAYOUT_H
#define KERVAN_IDL_LAYOUT_H

#include <stdint.h>

#include "model.h"

/* A struct becomes {*key:type;name:type[unit];...}, nested types expanded: names of members and enumerators, keys and
   units are part of a contract, the names of nested types are not. */
void add_layout(text_t *out, const idl_struct_t *type);

/* FNV-1a, 64 bits. */
uint64_t hash_of(const text_t *text);

#endif
