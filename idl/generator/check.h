/* What Kervan does not support is refused here, each with its place, the reason and what to write instead. */
#ifndef KERVAN_IDL_CHECK_H
#define KERVAN_IDL_CHECK_H

#include "idl/processor.h"

/* Prints every refusal of the file being compiled to stderr; returns their number. */
int check(const idl_pstate_t *state);

#endif
