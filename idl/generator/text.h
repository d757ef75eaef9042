/* A string that grows. All generated files are built in memory first: a refused IDL file leaves nothing behind. */
#ifndef KERVAN_IDL_TEXT_H
#define KERVAN_IDL_TEXT_H

#include <stddef.h>

typedef struct text {
  char *data; /* NUL-terminated once anything was added, NULL before */
  size_t length, capacity;
} text_t;

#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
void text_add(text_t *text, const char *format, ...);

void text_free(text_t *text);

#endif
